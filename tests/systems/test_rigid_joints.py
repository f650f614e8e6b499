"""Joints with rigid drives, for Isaac Lab and Newton: friction and armature at the joint, mesh folders."""

import json
import os
import re
import shutil
import struct
from contextlib import chdir

import coarse
import mujoco
import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli

import jointfmu

RATIO = -100.0
"""Speed ratio of the drive: motor and link rotate in opposite directions."""
ARM = """<mujoco model="arm"><compiler meshdir="assets/m &amp; m" angle="radian"/>
<option timestep="0.0002" gravity="0 0 0"/>
<asset><mesh name="cube" file="cube.stl"/></asset><worldbody>
<body name="upper" pos="0 0 1"><joint name="j1" axis="0 1 0" armature="0.4" damping="2" frictionloss="0.5"/>
<geom type="mesh" mesh="cube" mass="3"/>
<body name="fore" pos="0.3 0 0"><joint name="j2" axis="0 1 0" armature="0.2"/>
<geom type="mesh" mesh="cube" mass="2"/></body></body></worldbody></mujoco>"""


def cube():
    """Cube with 0.1 m edges as binary STL."""
    corners = 0.1 * np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
    faces = ["021", "123", "456", "657", "014", "154", "276", "237", "042", "246", "153", "357"]
    triangles = [[corners[int(c)] for c in face] for face in faces]
    return bytes(80) + struct.pack("<I", 12) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *np.concatenate(triangle), 0) for triangle in triangles
    )  # fmt: skip


@pytest.fixture
def arm(tmp_path, enter):
    enter(chdir(tmp_path))
    enter(coarse.poses())
    folder = tmp_path / "robot" / "assets" / "m & m"
    folder.mkdir(parents=True)
    (folder / "cube.stl").write_bytes(cube())
    (tmp_path / "robot" / "arm.xml").write_text(ARM)
    drive = jointfmu.drive("CSG-20-100", starting_torque=0.1, back_driving_torque=20.0, efficiency=0.75)
    drive = drive.with_values(friction_stribeck=0.5 * drive.values["friction_coulomb"], friction_viscous=4e-4)
    drive.save("drive.toml")
    return drive


def made(capsys, *words):
    words = ["robot", "robot/arm.xml", "--drive", "j1=drive.toml", "j2=drive.toml", "--out", "out", *words]
    assert cli.main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def motor_friction(drive, speed):
    """Friction torque [N.m] of the drive's law at a steady motor speed [rad/s], far beyond presliding."""
    spring = drive.spring
    _, memory = spring.advance_motion((0.0, 0.0, 0.0, 0.0), spring.initial_history())
    for x in (0.05, 0.1):
        out, memory = spring.advance_motion((x, speed, x / RATIO, speed / RATIO), memory)
    return float(out["tau_friction"])


def test_friction_at_the_joint_is_that_of_the_law(arm, capsys):
    """At creep the static friction; at two high speeds dynamic plus viscous friction, times the ratio."""
    figures = made(capsys)["rigid_joints"]["j1"]
    assert figures["static_friction"] == pytest.approx(abs(RATIO) * motor_friction(arm, 1e-6), rel=1e-3)
    for speed in (200.0, 400.0):
        expected = abs(RATIO) * motor_friction(arm, speed)
        found = figures["dynamic_friction"] + figures["viscous_friction"] * speed / abs(RATIO)
        assert found == pytest.approx(expected, rel=1e-6)
    assert figures["static_friction"] == pytest.approx(1.5 * figures["dynamic_friction"])


def test_actuators_are_what_isaac_lab_takes(arm, capsys):
    said = made(capsys)
    (path,) = (path for path in said["written"] if path.endswith("arm_actuators.json"))
    with open(path, encoding="utf-8") as file:
        groups = json.load(file)["actuators"]
    assert list(groups) == ["j1", "j2"]
    for joint, armature in (("j1", 0.4), ("j2", 0.2)):
        figures = said["rigid_joints"][joint]
        assert groups[joint] == {
            "joint_names_expr": [joint],
            "armature": pytest.approx(armature),
            "friction": figures["static_friction"],
            "dynamic_friction": figures["dynamic_friction"],
            "viscous_friction": figures["viscous_friction"],
        }


def test_the_rigid_robot_turns_against_its_friction(arm, capsys):
    """At constant joint torque, the speed in MuJoCo is the one that the friction allows."""
    said = made(capsys)
    figures = said["rigid_joints"]["j2"]
    model = mujoco.MjModel.from_xml_path("out/arm_rigid.xml")
    np.testing.assert_allclose(model.dof_armature, [0.4, 0.2])
    first = said["rigid_joints"]["j1"]
    assert model.dof_frictionloss[0] == pytest.approx(0.5 + first["dynamic_friction"], rel=1e-5)
    assert model.dof_damping[0] == pytest.approx(2.0 + first["viscous_friction"], rel=1e-5)
    model.dof_armature[0] = 1e9  # the first joint holds still
    data = mujoco.MjData(model)
    for share, speed in ((0.9, 0.0), (3.0, 2.0 * figures["dynamic_friction"] / figures["viscous_friction"])):
        mujoco.mj_resetData(model, data)
        data.qfrc_applied[1] = share * figures["dynamic_friction"]
        mujoco.mj_step(model, data, int(20.0 / figures["viscous_friction"] / model.opt.timestep))
        # the friction constraint of MuJoCo is soft: a joint at rest creeps by a thousandth of 5 rad/s
        assert data.qvel[1] == pytest.approx(speed, rel=0.01, abs=0.01)


def test_the_output_has_one_line_for_each_joint(arm, capsys):
    assert cli.main(["robot", "robot/arm.xml", "--drive", "j1=drive.toml", "--out", "out"]) == 0
    text = capsys.readouterr().out
    pattern = (
        r"^j1 as a rigid joint: armature 0\.4 kg\.m2, static friction \S+ N\.m, dynamic friction \S+ N\.m, "
        r"viscous friction \S+ N\.m\.s/rad$"
    )
    assert len(re.findall(pattern, text, flags=re.MULTILINE)) == 1


def test_export_of_a_drive_states_the_friction_of_a_rigid_joint(arm, capsys):
    assert cli.main(["export", "mjcf", "drive.toml", "--out", "drive.xml", "--json"]) == 0
    friction = json.loads(capsys.readouterr().out)["rigid_joint"]
    expected = abs(RATIO) * motor_friction(arm, 200.0)
    assert friction["dynamic_friction"] + 2.0 * friction["viscous_friction"] == pytest.approx(expected)
    with open("drive.xml", encoding="utf-8") as file:
        text = file.read()
    line = f"as a rigid joint: static friction {friction['static_friction']:.4g} N.m, dynamic friction "
    assert line in text
    assert "armature: 10000 times the inertia of the rotor and the wave generator" in text


def test_folders_of_meshes_stay_relative(arm, capsys, tmp_path):
    """The folder with robot and output can be moved."""
    written = [path for path in made(capsys)["written"] if path.endswith(".xml")]
    shutil.copytree(tmp_path, tmp_path.with_name("moved"))
    for path in written:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        assert 'meshdir="../robot/assets/m &amp; m/"' in text
        assert str(tmp_path) not in text
        assert mujoco.MjModel.from_xml_path(str(tmp_path.with_name("moved") / path)).nmesh == 1


def test_an_edited_list_of_actuators_is_not_overwritten(arm, capsys):
    os.mkdir("out")
    with open("out/arm_actuators.json", "w", encoding="utf-8") as file:
        file.write('{"mine": 1}\n')
    words = ("robot", "robot/arm.xml", "--drive", "j1=drive.toml", "--out", "out")
    line = refused_line(capsys, *words)
    assert "out/arm_actuators.json" in line
    assert "--force" in line
