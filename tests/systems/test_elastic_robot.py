"""Robots with elastic axes: files of `jointfmu robot`, run in MuJoCo and compared with its results."""

import io
import json
import re
import subprocess
import sys
from contextlib import redirect_stdout
from importlib import metadata
from pathlib import Path
from types import SimpleNamespace

import coarse
import fmpy
import mujoco
import numpy as np
import pytest
from clients import needs
from conftest import here_alone, refused_line
from jointfmu_tools import cli
from jointfmu_tools.api import drive
from jointfmu_tools.exchange.robots import elastic, pictures, poses, rigid_tree
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from jointfmu_tools.run.proof.run import prove
from surroundings import environment

from jointfmu.parameters import format_parameter_file

ROBOT = Path(__file__).parents[2] / "models/robots/six_axis.xml"
SIZES = ("CSG-32-100", "CSG-40-100", "CSG-25-100", "CSG-20-100", "CSG-17-100", "CSG-14-100")
DRIVES = [f"joint{i}={size}" for i, size in enumerate(SIZES, 1)]
POSE = ["--pose", "joint2=0.7", "joint3=0.8"]
ARM = ("shoulder", "elbow")
TWO_LINKS = """<mujoco><compiler angle="radian"/><option timestep="0.001"/><worldbody>
<body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0" range="-2 2" armature="0.3"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04" mass="4"/>
<body name="fore" pos="0.4 0 0"><joint name="elbow" axis="0 1 0" range="-2 2" armature="0.1"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="2"/>
<body name="tool" pos="0.3 0 0"><geom type="sphere" size="0.03" mass="0.5"/></body></body></body>
</worldbody></mujoco>"""
SEVEN = """<?xml version="1.0"?><robot name="seven"><link name="l0"/>{}</robot>"""
LINK = """
<joint name="j{0}" type="revolute"><parent link="l{1}"/><child link="l{0}"/><origin xyz="0 0 0.2"/>
  <axis xyz="{2}"/><limit lower="-2" upper="2" effort="100" velocity="3"/></joint>
<link name="l{0}"><inertial><origin xyz="0 0 0.1"/><mass value="{3}"/>
  <inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def made(capsys, robot, out, *words):
    assert cli.main(["robot", str(robot), "--out", str(out), "--json", *words]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.fixture(scope="module")
def six(tmp_path_factory):
    out, shown = tmp_path_factory.mktemp("six"), io.StringIO()
    words = ["robot", str(ROBOT), "--out", str(out), "--json", "--drive", *DRIVES, *POSE, "--payload", "3"]
    with redirect_stdout(shown), coarse.poses():
        assert cli.main(words) == 0
    return json.loads(shown.getvalue()), mujoco.MjModel.from_xml_path(str(out / "six_axis_elastic.xml"))


@pytest.fixture
def few_poses(enter):
    """Use a coarser grid of poses, for tests that need no fine one."""
    enter(coarse.poses())


def held(spec, payload):
    """Elastic robot at its pose with fixed motors and a payload at the tip; it starts to move from there."""
    body = spec.body("flange")
    body.mass, body.inertia, body.explicitinertial = max(payload, 1e-9), [1e-9] * 3, True
    body.ipos, body.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    for joint in spec.joints:
        if joint.name.endswith("_motor"):
            joint.armature = 1e9
    for actuator in [*spec.actuators]:
        spec.delete(actuator)
    model = spec.compile()
    data = mujoco.MjData(model)
    for name, angle in (("joint2", 0.7), ("joint3", 0.8)):
        data.joint(name).qpos[0] = angle
        if spec.joint(f"{name}_motor"):
            data.joint(f"{name}_motor").qpos[0] = -100.0 * angle
    return model, data


def test_the_arm_sags_as_it_says(six):
    """Damped until rest; the error of the tip is of first order in wind-ups of 1 mrad."""
    said, _ = six
    model, data = held(mujoco.MjSpec.from_file(said["written"][0]), 3.0)
    mujoco.mj_forward(model, data)
    start = data.body("flange").xpos.copy()
    model.dof_damping[:] = 2000.0
    model.opt.timestep = 1e-3
    for _ in range(4000):
        mujoco.mj_step(model, data)
    assert np.abs(data.qvel).max() < 1e-6
    for name, expected in said["plain"]["wind_up"].items():
        wound = data.joint(name).qpos[0] + 0.01 * data.joint(f"{name}_motor").qpos[0]
        assert wound == pytest.approx(expected, rel=0.01, abs=1e-6)
    moved = np.linalg.norm(data.body("flange").xpos - start)
    assert moved == pytest.approx(said["plain"]["tip_error"], rel=0.01)


@pytest.mark.filterwarnings("ignore:.*outside the tabulated law")  # the size of two drives is too small
def test_wind_up_is_the_drives_own_at_any_load(six, tmp_path, capsys, few_poses):
    """The wind-up is that of the drive for small loads, beyond the rated torque, and far beyond the largest
    torque."""
    (tmp_path / "arm.xml").write_text(TWO_LINKS)
    sizes, beyond = ("CSF-8-30", "CSG-14-100"), ("the max_torque, 3 N.m", "the rated torque, 10 N.m")
    arm = [*zip(ARM, sizes, strict=True)]
    words = ["--pose", *(f"{n}=0" for n in ARM), "--drive", *(f"{n}={s}" for n, s in arm)]
    said = made(capsys, tmp_path / "arm.xml", tmp_path / "out", "--payload", "3", *words)
    for found, name, size in (*((said, *each) for each in arm), (six[0], "joint3", "CSG-25-100")):
        own, torque = drive(size), found["torque"][name]
        assert found["wind_up"][name] == pytest.approx(own.wind_up(torque), rel=1e-9)
        assert found["stiffness"][name] == pytest.approx(own.stiffness(torque), rel=1e-3)
        assert abs(found["plain"]["wind_up"][name] / found["wind_up"][name] - 1.0) > 0.01
    for note, name, size, text in zip(said["notes"][:2], ARM, sizes, beyond, strict=True):
        assert note.startswith(f"{name}: {said['torque'][name]:.4g} N.m is beyond {text}, of {size}")


@pytest.mark.slow
def test_plugin_and_fmu_wind_up_as_is_said(tmp_path, capsys, few_poses):
    """Plugin and FMU have the drive's own law; motors are locked, motion is damped until rest."""
    words = [
        "--drive",
        "joint2=CSG-40-100",
        "joint3=CSG-40-100",
        *POSE,
        "--payload",
        "3",
        "--plugin",
        "--fmu",
        "--motors",
        "angle",
    ]
    with here_alone():
        said = made(capsys, ROBOT, tmp_path, *words)
    (library,) = (path for path in said["written"] if Path(path).stem == "CSG_40_100")
    mujoco.mj_loadPluginLibrary(library)
    spec = mujoco.MjSpec.from_file(str(tmp_path / "six_axis_plugin.xml"))
    model, data = held(spec, 3.0)
    model.dof_damping[:] = 2000.0
    for _ in range(3000):
        mujoco.mj_step(model, data)
    file = str(tmp_path / "fmi2/six_axis.fmu")
    proved = prove(Path(file))
    assert (proved.failure_messages, proved.executed_experiment_count) == ([], 3)
    outputs = [f"{name}.drive.phi_rel" for name in said["wind_up"]]
    damped = {f"{name}.drive.d": 2000.0 for name in said["wind_up"]}
    swing = fmpy.simulate_fmu(file, stop_time=1.0, output_interval=1e-2, output=outputs, start_values=damped)
    for name, output in zip(said["wind_up"], outputs, strict=True):
        wound = data.joint(name).qpos[0] + 0.01 * data.joint(f"{name}_motor").qpos[0]
        assert abs(wound) > 1e-4
        assert wound == pytest.approx(said["wind_up"][name], rel=2e-3)
        assert swing[output][-1] == pytest.approx(wound, rel=2e-3)


def test_frequencies_are_those_of_the_model_in_mujoco(six, capsys, tmp_path):
    """Springs about the sagged pose, linearised by MuJoCo's finite differences; weight adds less than 1 %."""
    spec = elastic.read_robot(ROBOT)
    axes = elastic.make_axes(
        spec, {f"joint{i}": make_transmission(drive(n).file) for i, n in enumerate(SIZES, 1)}
    )
    rigid = spec.compile()
    pose = elastic.make_robot_pose(rigid, {"joint2": "0.7", "joint3": "0.8"})
    springs = [
        SimpleNamespace(
            joint_name=axis.joint_name, stiffness_at_torque=axis.fitted_spring.stiffness_at_torque
        )
        for axis in axes
    ]
    expected = poses.compute_frequencies(rigid, springs, pose, 3.0, rigid.body("flange").id)
    said, _ = six
    model, data = held(mujoco.MjSpec.from_file(said["written"][0]), 3.0)
    links = [int(model.joint(f"joint{i}").dofadr[0]) for i in range(1, 7)]
    for i in range(1, 7):
        data.joint(f"joint{i}").qpos[0] += said["plain"]["wind_up"][f"joint{i}"]
    stiffness = np.empty((6, 6))
    for column, place in enumerate(links):
        forces = []
        for step in (1e-6, -1e-6):
            data.qpos[place] += step
            mujoco.mj_forward(model, data)
            forces.append((data.qfrc_passive - data.qfrc_bias)[links])
            data.qpos[place] -= step
        stiffness[:, column] = (forces[1] - forces[0]) / 2e-6
    mass = elastic.compute_mass_matrix(model, data.qpos)[np.ix_(links, links)]
    found = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)) / (2.0 * np.pi)
    assert expected == pytest.approx(found, rel=0.01)


def test_a_servo_holds_the_axis_as_before(six):
    """The actuators act on the motors, with gains referred to the link; friction has no control input, and
    the robot's own coordinates and controls come first.
    """
    _, model = six
    assert model.actuator_trnid[:2, 0].tolist() == [model.joint(f"joint{i}_motor").id for i in (1, 2)]
    assert model.actuator_gear[:2, 0].tolist() == pytest.approx([-1.0, -0.01])
    assert (model.nu, model.na) == (2, 6)
    assert [model.joint(i).name for i in range(6)] == [f"joint{i}" for i in range(1, 7)]
    armature = model.dof_armature[model.joint("joint2_motor").dofadr[0]]
    assert armature == pytest.approx(2.0 / 100.0**2)
    assert model.dof_armature[model.joint("joint2").dofadr[0]] == 0.0


@pytest.mark.parametrize(("own", "expected"), [("", [-0.4, 0.6]), ('forcerange="-0.5 0.5"', [-0.4, 0.5])])
def test_a_joints_limit_of_its_actuators_is_theirs(own, expected, tmp_path, capsys, few_poses):
    """60 N.m at the link with a gear of 100; the sign of the ratio reverses the gear, not the force."""
    text = ROBOT.read_text().replace('name="joint1"', 'name="joint1" actuatorfrcrange="-40 60"')
    robot = tmp_path / "robot.xml"
    robot.write_text(text.replace('name="motor1"', f'name="motor1" {own}'))
    words = ["--drive", "joint1=CSG-32-100", "--pose", "joint2=0.5"]
    said = made(capsys, robot, tmp_path / "out", *words)
    assert said["pose"] == {"joint1": 0.0, "joint2": 0.5}
    model = mujoco.MjModel.from_xml_path(said["written"][0])
    assert model.actuator("motor1").forcerange.tolist() == pytest.approx(expected)
    assert model.actuator("motor1").forcelimited


def kicked(path, step=None):
    """Motors that start with random speeds up to about 60 rad/s: those of the runs that diverge in 0.2 s."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = step or model.opt.timestep
    motors = [i for i in range(model.njnt) if model.joint(i).name.endswith("_motor")]
    speeds, failed = np.random.default_rng(1), []
    for _ in range(10):
        data = mujoco.MjData(model)
        data.qvel[model.jnt_dofadr[motors]] = start = 30.0 * speeds.standard_normal(len(motors))
        mujoco.mj_step(model, data, round(0.2 / model.opt.timestep))
        if data.warning.number.any():
            failed.append(start)
    return failed


def test_the_robot_is_stable_up_to_its_longest_step(six, tmp_path, capsys, few_poses):
    """Rotors that turn back have the largest damping of the friction. The file is written for its own step;
    with a much longer step, it diverges."""
    said, _ = six
    text = ROBOT.read_text()
    assert not kicked(said["written"][0])
    assert kicked(said["written"][0], 1.4 * said["longest_step"])
    (tmp_path / "robot.xml").write_text(text.replace('"0.0005"', f'"{0.99 * said["longest_step"]:.4g}"'))
    other = made(capsys, tmp_path / "robot.xml", tmp_path / "out", "--drive", *DRIVES, *POSE)
    assert not any("timestep" in line for line in other["notes"])
    assert not kicked(other["written"][0])


TWO_JOINTS = SEVEN.format(LINK.format(1, 0, "0 1 0", 4) + LINK.format(2, 1, "0 1 0", 2))


def test_a_robot_without_time_step_gets_a_stable_one(tmp_path, capsys, few_poses):
    """A URDF states no step; with MuJoCo's default, 2 ms, the written file would diverge."""
    (tmp_path / "two.urdf").write_text(TWO_JOINTS)
    said = made(capsys, tmp_path / "two.urdf", tmp_path / "out", "--drive", "j1=CSG-25-100", "j2=CSG-17-100")
    step = mujoco.MjModel.from_xml_path(said["written"][0]).opt.timestep
    assert step <= 0.6 * said["longest_step"]
    assert sum("states no timestep" in line for line in said["notes"]) == 1
    assert not kicked(said["written"][0])
    assert kicked(said["written"][0], 2e-3)


def test_notes_of_a_stable_robot(six):
    """Without payload beyond the drives, the notes are the effects that the files lack, and the softer
    friction of a light rotor."""
    said, _ = six
    assert [line.split(":")[:2] for line in said["notes"][1:]] == [
        [drive.partition("=")[2], f" the MJCF does not include {what}"]
        for drive in DRIVES
        for what in ("friction that grows with the load", "the temperature of the lubricant")
    ]
    assert said["notes"][0].startswith("joint6: friction builds up over 0.0204 rad of the motor")


def fallen(model, step, friction="bristles"):
    """Angles of the links after 0.4 s of free fall, motors free except for friction."""
    model.opt.timestep, data = step, mujoco.MjData(model)
    for i, angle in enumerate((0.1, 0.7, 0.8, 0.1, 0.5, 0.2), 1):
        data.joint(f"joint{i}").qpos[0] = angle
        data.joint(f"joint{i}_motor").qpos[0] = -100.0 * angle
    if friction == "constraint":
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
        model.dof_frictionloss[6:] = model.actuator_forcerange[-6:, 1]
    mujoco.mj_step(model, data, round(0.4 / step))
    return data.qpos[:6].copy()


def test_bristles_bear_steps_that_the_drives_bear(six):
    """With bristles, the arm falls to the same pose with a step of 0.5 ms as with 0.05 ms, as documented; the
    friction of a constraint is softer."""
    said, _ = six
    model = mujoco.MjModel.from_xml_path(said["written"][0])
    model.actuator_gainprm[:2], model.actuator_biasprm[:2] = 0.0, 0.0
    fine, coarse = fallen(model, 5e-5), fallen(model, 5e-4)
    assert np.abs(fine - [0.1, 0.7, 0.8, 0.1, 0.5, 0.2]).max() > 0.1
    assert coarse == pytest.approx(fine, abs=1e-3)
    assert np.abs(fallen(model, 5e-4, "constraint") - fine).max() > 0.05


@pytest.mark.slow
def test_friction_is_a_constraint_where_the_integrator_bears_no_bristles(tmp_path, capsys, few_poses):
    """With a short step, bristles have the friction of the drive; for a light rotor, MuJoCo's own friction is
    softer, and the text says so."""
    text = ROBOT.read_text()
    for option, loss, noted in (
        ('integrator="RK4"', 0.0204, []),
        ('timestep="2e-4"', 0.0, []),
        ('timestep="2e-3"', 0.0, ["joint6: friction builds up over 0.326 rad of the motor in the MJCF"]),
    ):
        robot = tmp_path / "robot.xml"
        robot.write_text(text.replace('<option timestep="0.0005"/>', f"<option {option}/>"))
        said = made(capsys, robot, tmp_path / "out", "--drive", "joint6=CSG-14-100")
        model = mujoco.MjModel.from_xml_path(said["written"][0])
        assert model.dof_frictionloss.max() == pytest.approx(loss, rel=0.01)
        assert model.na == (not loss)
        assert [line.split(",")[0] for line in said["notes"] if "builds" in line] == noted
        written = {'integrator="RK4"': 2e-4, 'timestep="2e-4"': 2e-4, 'timestep="2e-3"': 2e-3}
        assert model.opt.timestep == written[option]
        noted = [line for line in said["notes"] if "timestep" in line]
        assert any("is too long for the drives" in line for line in noted) == ("2e-3" in option)


@pytest.mark.slow
def test_without_a_pose_the_arm_is_where_its_tip_sinks_most(tmp_path, capsys, few_poses):
    words = ["--drive", "joint2=CSG-40-100", "joint3=CSG-25-100", "--payload", "3"]
    free = made(capsys, ROBOT, tmp_path / "free", *words)
    posed = made(capsys, ROBOT, tmp_path / "posed", *words, *POSE)
    assert posed["pose"] == {"joint2": 0.7, "joint3": 0.8}
    again = [f"{name}={angle}" for name, angle in free["pose"].items()]
    there = made(capsys, ROBOT, tmp_path / "again", *words, "--pose", *again)
    assert free["tip_error"] == pytest.approx(there["tip_error"], rel=1e-9)
    assert free["tip_error"] > posed["tip_error"]


@pytest.mark.slow
def test_seven_axes_of_a_urdf(tmp_path, capsys, few_poses):
    """URDF has no armature, which is stated for each axis. One axis is vertical, so weight causes
    no wind-up."""
    links = "".join(LINK.format(i, i - 1, "0 1 0" if i % 2 == 0 else "0 0 1", 8 - i) for i in range(1, 8))
    robot = tmp_path / "seven.urdf"
    robot.write_text(SEVEN.format(links))
    words = [f"j{i}=CSG-20-100" for i in range(1, 8)]
    said = made(capsys, robot, tmp_path / "out", "--drive", *words, "--pose", "j2=1.5708")
    assert sum("no armature" in line for line in said["notes"]) == 7
    assert any("at the origin of l7, on the axis of j7, and does not load" in line for line in said["notes"])
    assert list(said["wind_up"]) == [f"j{i}" for i in range(1, 8)]
    assert said["wind_up"]["j1"] == pytest.approx(0.0, abs=1e-9)
    assert said["wind_up"]["j2"] > 1e-4
    model = mujoco.MjModel.from_xml_path(said["written"][0])
    assert model.nv == 14
    assert all(Path(path).stat().st_size > 1000 for path in said["written"])


def test_a_tool_frame_of_a_urdf_is_the_tip(tmp_path):
    """The tool frame is a link on a fixed joint."""
    robot = tmp_path / "one.urdf"
    tool = '<joint name="t" type="fixed"><parent link="l1"/><child link="tool"/></joint><link name="tool"/>'
    robot.write_text(SEVEN.format(LINK.format(1, 0, "0 1 0", 2) + tool))
    spec = elastic.read_robot(robot)
    axes = elastic.make_axes(spec, {"j1": make_transmission(drive("CSG-14-100").file)})
    assert spec.compile().body(elastic.find_body(spec.compile(), None, axes)).name == "tool"


OTHERS = {
    "airo-models": [("ur3e/ur3e.urdf", 6)],
    "openarm-mujoco": [("v2/openarm_bimanual.xml", 7)],
    "robosuite": [(f"robots/{n}/robot.xml", 7) for n in ("panda", "iiwa", "kinova3", "sawyer", "xarm7")],
}
"""{wheel: robot files with their axes}."""


def robot_files(wheel):
    """Paths of the robot files in an installed wheel."""
    return [file for file in metadata.files(wheel) or [] if file.suffix in (".xml", ".urdf")]


@pytest.mark.parametrize(
    ("wheel", "end", "count"),
    [
        # robosuite takes half a gigabyte, so it is no part of the extra `test`
        pytest.param(wheel, *robot, marks=needs("robosuite") if wheel == "robosuite" else ())
        for wheel, robots in OTHERS.items()
        for robot in robots
    ],
)
def test_robots_of_others(wheel, end, count, tmp_path, capsys, few_poses):
    """Robots of other authors with 1 kg payload fall stably with the time step that is stated."""
    (robot,) = (file.locate() for file in robot_files(wheel) if file.as_posix().endswith(end))
    rigid = mujoco.MjModel.from_xml_path(str(robot))
    joints = [rigid.joint(i).name for i in range(rigid.njnt)]
    arm = [joint for joint in joints if rigid.joint(joint).type == mujoco.mjtJoint.mjJNT_HINGE][:count]
    drives = [f"{joint}=CSG-32-100" for joint in arm]
    said = made(capsys, robot, tmp_path, "--drive", *drives)
    assert 1.0 < said["frequencies"]["lowest"] < said["frequencies"]["highest"]
    model = mujoco.MjModel.from_xml_path(said["written"][0])
    assert (model.nv, model.nu) == (rigid.nv + count, rigid.nu)
    model.opt.timestep, data = 0.5 * said["longest_step"], mujoco.MjData(model)
    mujoco.mj_step(model, data, 3000)
    assert not data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number
    for joint in arm:
        wound = data.joint(joint).qpos[0] + 0.01 * data.joint(f"{joint}_motor").qpos[0]
        assert abs(wound) < 0.05


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--drive", "joint9=CSG-14-100"], "'joint9' is not a hinge of the robot; allowed are joint1, "),
        (["--drive", "joint1"], "--drive 'joint1': expected JOINT=NAME"),
        (["--drive", "joint1=CSG-14-100", "joint1=CSG-17-100"], "--drive: joint1 is given twice"),
        (["--drive", "joint1=GearMesh"], "is a gear_mesh, no drive of a motor"),
        (
            ["--drive", "joint1=CSG-14-100", "--payload", "-1"],
            r"-1 kg is outside \[0, 10000\] kg",
        ),
        (
            ["--drive", "joint1=CSG-14-100", "--tip", "toe"],
            "--tip 'toe': no body of the robot; allowed",
        ),
        (["--drive", "joint1=CSG-14-100", "--motors", "angle"], "--motors angle has no effect without --fmu"),
        (["--drive", "joint1=CSG-14-100", "--pose", "joint1=up"], "--pose joint1 = 'up' is not a number"),
        (
            ["--drive", "joint1=CSG-14-100", "--pose", "joint2=90"],
            r"--pose joint2 = 90 rad is outside \[-2, 2\] rad; an angle in degrees is joint2=90deg",
        ),
        (["--drive", "joint1=CSG-14-100", "--payload", "3m"], "measures another quantity than 'kg'"),
        (["--drive", "joint1=CSG-14-101"], "nearest are CSG-14-100"),
    ],
)
def test_refusals(words, line, tmp_path, capsys):
    assert re.search(line, refused_line(capsys, "robot", ROBOT, *words, "--out", tmp_path))


def test_numbers_of_a_robot_may_have_units(tmp_path, capsys, few_poses):
    words = ["--drive", "joint2=csg40100", "--pose", "joint2=40deg", "--payload", "0.5kg"]
    said = made(capsys, ROBOT, tmp_path, *words)
    assert said["pose"]["joint2"] == pytest.approx(np.deg2rad(40.0))
    assert said["payload"] == 0.5


def test_the_effects_that_the_fmu_of_a_robot_lacks_are_listed():
    """The six-axis arm has limits of its joints and two actuators."""
    texts = rigid_tree.list_omitted_effects(mujoco.MjModel.from_xml_path(str(ROBOT)))
    assert [text.split()[0] for text in texts] == ["limits", "actuators"]
    assert "motor1" in texts[1]


def test_drives_of_one_name_that_differ_are_refused(tmp_path, capsys):
    """One name is one plugin, so the second drive would be the first."""
    for folder, size in (("one", "CSG-14-100"), ("other", "CSG-17-100")):
        (tmp_path / folder).mkdir()
        text = format_parameter_file(drive(size).file).replace(f'name = "{size}"', 'name = "mine"')
        (tmp_path / folder / "mine.toml").write_text(text)
    files = [f"joint{i}={tmp_path / folder / 'mine.toml'}" for i, folder in ((1, "one"), (2, "other"))]
    line = refused_line(capsys, "robot", ROBOT, "--drive", *files, "--plugin", "--out", tmp_path / "out")
    assert "the drives of joint1 and joint2 are both named 'mine' but differ" in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            "</actuator>",
            '</actuator><equality><weld name="bar" body1="hand" body2="base"/></equality>',
            "bar closes",
        ),
        ('name="joint2"', 'name="tip"', "two variables would be named tip; rename the joint 'tip'"),
    ],
)
def test_robots_that_cannot_be_an_fmu_are_refused_before_anything_is_written(
    tmp_path, capsys, old, new, line
):
    (tmp_path / "arm.xml").write_text(
        ROBOT.read_text().replace(old, new).replace('joint="joint2"', 'joint="joint3"')
    )
    words = ["--drive", "joint1=CSG-14-100", "--fmu", "--out", tmp_path / "out"]
    assert line in refused_line(capsys, "robot", tmp_path / "arm.xml", *words)
    assert not (tmp_path / "out").exists()


def test_an_older_mujoco_is_refused(tmp_path):
    (tmp_path / "mujoco.py").write_text('__version__ = "3.2.0"\nclass MjModel: pass\n')
    for words in (["robot", ROBOT, "--drive", "joint1=CSG-14-100"], ["export", "mjcf", "CSG-14-100"]):
        command = [sys.executable, "-m", "jointfmu", *words, "--out", tmp_path / "out"]
        with environment(PYTHONPATH=str(tmp_path)):
            done = subprocess.run(command, capture_output=True, text=True, timeout=100)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
        assert "has no springs that yield (springyield); expected 4.0 or newer" in done.stderr


def test_a_file_that_is_no_robot_is_refused(tmp_path, capsys):
    (tmp_path / "no.xml").write_text("<nothing/>")
    line = refused_line(capsys, "robot", tmp_path / "no.xml", "--drive", "a=CSG-14-100", "--out", tmp_path)
    assert "no.xml: cannot be read as a robot" in line


INERTIAL = "<inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
URDF_TEXT = f"""<robot name="two">
<link name="base"/><link name="arm">{INERTIAL}</link><link name="tool">{INERTIAL}</link>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<joint name="tip" type="JOINT"><parent link="arm"/><child link="tool"/><origin xyz="0.3 0 0"/></joint>
</robot>"""


@pytest.mark.parametrize(
    ("old", "new", "part", "advice"),
    [
        (
            f'"tool">{INERTIAL}',
            '"tool">',
            "'tool'",
            "; state the mass and the inertia of this link in its <inertial>",
        ),
        (
            f'"tool">{INERTIAL}',
            f'"tool">{INERTIAL}<collision><geometry><mesh filename="away.stl"/></geometry></collision>',
            "'away.stl'",
            "; expected this file in the folder of the robot file, or in its meshdir",
        ),
    ],
)
def test_what_a_urdf_lacks_is_said_with_what_to_do(tmp_path, capsys, old, new, part, advice):
    file = tmp_path / "two.urdf"
    file.write_text(URDF_TEXT.replace("JOINT", "continuous").replace(old, new))
    line = refused_line(capsys, "robot", file, "--drive", "turn=CSG-14-100", "--out", tmp_path)
    assert "two.urdf: cannot be read as a robot (MJCF or URDF): " in line
    assert part in line
    assert line.endswith(f"{advice}\n")


def test_joints_of_one_name_in_a_urdf_are_refused(tmp_path, capsys):
    file = tmp_path / "two.urdf"
    file.write_text(URDF_TEXT.replace("JOINT", "continuous").replace('"tip"', '"turn"'))
    line = refused_line(capsys, "robot", file, "--drive", "turn=CSG-14-100", "--out", tmp_path)
    assert "two.urdf: the joint of link 'tool' has the name of another joint" in line


def test_a_missing_robot_file_is_said(tmp_path, capsys):
    line = refused_line(
        capsys, "robot", tmp_path / "away.urdf", "--drive", "turn=CSG-14-100", "--out", tmp_path
    )
    assert line.endswith("away.urdf: cannot be read (no such file); expected a robot (MJCF or URDF)\n")


def test_a_link_without_mass_is_said(tmp_path, capsys, few_poses):
    """MuJoCo takes it, because the tool that is fixed to the link has mass."""
    file = tmp_path / "two.urdf"
    complete = URDF_TEXT.replace("JOINT", "fixed")
    for text, noted in (
        (complete, []),
        (
            complete.replace(f'"arm">{INERTIAL}', '"arm">'),
            ["arm: no mass in the file; only bodies that are fixed to it have mass"],
        ),
    ):
        file.write_text(text)
        said = made(capsys, file, tmp_path / "out", "--drive", "turn=CSG-14-100")
        assert [line for line in said["notes"] if "no mass" in line] == noted


def test_a_drive_without_gravity_load_is_named_and_drawn(tmp_path, capsys, few_poses, monkeypatch):
    """A constant frequency is drawn as one value, without its rounding; the payload with its effect."""
    drawn = []
    monkeypatch.setattr(pictures.plots, "save_figure", lambda figure, path: drawn.append(figure))
    words = ["--drive", "joint4=CSG-25-100", "--payload", "300"]
    facts = made(capsys, ROBOT, tmp_path / "one", *words)
    (panel,) = drawn[0].axes
    assert panel.get_title() == f"frequency 1: {facts['frequencies']['lowest']:.4g} Hz in all poses"
    assert panel.get_ylim()[0] == 0.0
    assert np.ptp(panel.lines[0].get_ydata()) == 0.0
    assert all("do not load the drives in this pose" in axes.texts[0].get_text() for axes in drawn[1].axes)
    assert any(
        line.startswith("joint4: weight and payload load no drive in any pose") for line in facts["notes"]
    )
    made(capsys, ROBOT, tmp_path / "two", *words, "--drive", "joint6=CSG-14-100")  # a map of two axes
    titles = [axes.get_title() for axes in drawn[3].axes if axes.get_title()]
    assert titles
    assert all("in all poses" in title for title in titles)


def test_an_overload_in_another_pose_is_said(tmp_path, capsys, few_poses):
    words = ["--drive", "joint3=CSG-25-100", "--payload", "300", "--pose", "joint3=0"]
    notes = made(capsys, ROBOT, tmp_path, *words)["notes"]
    assert any(
        re.match(r"joint3: in another pose of the grid \d+ N.m is beyond the max_torque", n) for n in notes
    )


def test_ringing_after_a_stop_is_that_of_mujoco(six):
    """MuJoCo with springs of the same stiffness and held motors, released from the wind-up of braking."""
    said, _ = six
    spec = elastic.read_robot(ROBOT)
    axes = elastic.make_axes(
        spec, {f"joint{i}": make_transmission(drive(size).file) for i, size in enumerate(SIZES, 1)}
    )
    model = spec.compile()
    pose, tip = elastic.make_robot_pose(model, {"joint2": "0.7", "joint3": "0.8"}), model.body("flange").id
    time = np.arange(0.0, 1.0, 2e-4)
    found = poses.compute_ringing(model, axes, pose, 3.0, tip, time)[1]
    assert said["ringing"]["joint2"] == {
        "amplitude": pytest.approx(found.tip_distance[0]),
        "last_amplitude": pytest.approx(found.final_tip_amplitude),
    }
    load, _ = poses.compute_weight_torques(model, axes, pose, 3.0, tip)
    inertia = poses.compute_link_mass_matrix(model, axes, pose, 3.0, tip)
    stiffness = [axis.stiffness_at_torque(t) for axis, t in zip(axes, load.tolist(), strict=True)]
    for k, (joint, axis) in enumerate(zip(spec.joints, axes, strict=True)):
        joint.armature, joint.stiffness = 0.0, [stiffness[k], 0.0, 0.0]
        joint.damping = [axis.drive.output_damping, 0.0, 0.0]
        joint.springref = float(pose[k] - load[k] / stiffness[k])  # at rest in the pose
    model, data = held(spec, 3.0)
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, 2e-4
    data.qpos[:] = pose
    mujoco.mj_forward(model, data)
    rest = data.body("flange").xpos.copy()
    data.qpos += inertia[:, 1] * axes[1].drive.rated_torque / inertia[1, 1] / stiffness
    distance = []
    for _ in range(1000):
        mujoco.mj_forward(model, data)
        distance.append(np.linalg.norm(data.body("flange").xpos - rest))
        mujoco.mj_step(model, data)
    assert distance == pytest.approx(found.tip_distance[:1000], abs=0.01 * found.tip_distance[0])
