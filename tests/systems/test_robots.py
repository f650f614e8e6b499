"""Drives as plain MJCF and URDF: written files in MuJoCo, against the spring of the drive."""

import json
import re
from contextlib import chdir
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.exchange.robots.spring_fit import fit_spring
from jointfmu_tools.exchange.robots.transmission import loop_area
from jointfmu_tools.joints.harmonic_drive.transmission import make_transmission
from surroundings import missing_package

import jointfmu

STEPS = 4000
"""Number of steps per quarter of the loop."""


@pytest.fixture(autouse=True)
def folder(tmp_path, enter):
    enter(chdir(tmp_path))
    return tmp_path


def exported(capsys, source, *words):
    assert cli.main(["export", "mjcf", source, "--out", "drive.xml", "--json", *words]) == 0
    return json.loads(capsys.readouterr().out), mujoco.MjModel.from_xml_path("drive.xml")


def pulled(model, torques):
    """Wind-ups under constant torques at the link, motor locked, after several well damped periods."""
    model.opt.gravity[:], model.opt.timestep = 0.0, 1e-4
    model.dof_armature[model.joint("motor").dofadr[0]] = 1e9
    link = model.joint("link").dofadr[0]
    stiffness = model.tendon_stiffness.sum()
    model.dof_damping[link] = 1.4 * np.sqrt(stiffness * model.dof_armature[link])
    data, found = mujoco.MjData(model), []
    mujoco.mj_setConst(model, data)
    for torque in torques:
        data.qfrc_applied[link] = torque
        mujoco.mj_step(model, data)
        found.append(data.qpos[link])
    return np.array(found)


@pytest.mark.parametrize(
    "name",
    [
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("CSG-14-100", "CSG-40-160")),
        "CSG-25-100",
        "HarmonicDriveSpring",
    ],
)
def test_wind_up_at_rated_torque_is_the_fmus(name, capsys):
    """At the end of a ramp of 2 s to rated torque, the wind-up is within 3 % of the FMU's wind-up."""
    said, model = exported(capsys, name)
    drive = jointfmu.load(name)
    rated = drive.values["rated_torque"]
    assert said["torque"] == rated
    ramp = np.append(np.linspace(0.0, rated, 20_000), np.full(2000, rated))
    found = pulled(model, ramp)[-1] / float(drive.wind_up(rated)) - 1.0
    assert abs(found) < 0.03
    assert found == pytest.approx(said["wind_up"], abs=1e-4)  # what the file says of itself
    assert said["area"] is None


@pytest.mark.slow
def test_the_area_of_the_loop_is_the_fmus(folder, capsys):
    """The stated tolerance is 5 %; the known work of the dampers of link and drive is subtracted."""
    drive = jointfmu.drive("CSG-25-100", hysteresis=1.0)
    drive.save("drive.toml")
    said, model = exported(capsys, "drive.toml")
    rated = drive.values["rated_torque"]
    torques = rated * np.concatenate([np.linspace(0, 1, STEPS), np.cos(np.linspace(0, 2 * np.pi, 4 * STEPS))])
    memory, spring, expected = drive.spring.initial_history(), drive.spring, []
    for torque in torques[::20]:
        out, memory = spring.advance_torque(torque, memory)
        expected.append(float(out["phi_rel"]))
    own = np.trapezoid(torques[::20][STEPS // 20 :], expected[STEPS // 20 :])
    x = pulled(model, torques)[STEPS:]
    damping = model.dof_damping[model.joint("link").dofadr[0]] + model.tendon_damping.sum()
    viscous = damping * np.sum(np.diff(x) ** 2) / model.opt.timestep
    found = np.trapezoid(torques[STEPS:], x) - viscous
    assert own > 0.0
    assert found / own == pytest.approx(1.0, abs=0.05)
    assert abs(said["area"]) < 0.05
    assert abs(said["wind_up"]) < 0.03
    text = (folder / "drive.xml").read_text()
    assert f"{100.0 * said['area']:+.2f} % of the FMU's, within 5 %" in text


def test_the_motor_turns_the_link_with_the_ratio(capsys):
    """In slow motion the link follows within the wind-up by its own weight, which is zero here."""
    _, model = exported(capsys, "CSG-14-100")
    data = mujoco.MjData(model)
    motor, link = (model.joint(name).dofadr[0] for name in ("motor", "link"))
    data.qpos[motor], data.qpos[link] = 1.0, -0.01
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive.tolist() == pytest.approx([0.0, 0.0], abs=1e-9)
    data.qpos[link] += 1e-3
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive[motor] == pytest.approx(data.qfrc_passive[link] * 0.01, rel=1e-12)
    assert data.qfrc_passive[link] < 0.0


def test_what_it_cannot_carry_is_said(folder, capsys):
    jointfmu.drive("CSG-20-100", starting_torque=0.1, back_driving_torque=20.0, efficiency=0.75).save(
        "d.toml"
    )
    said, _ = exported(capsys, "d.toml")
    lacks = " ".join(said["lacks"])
    assert "friction that grows with the load: at rated torque" in lacks
    text = (folder / "drive.xml").read_text()
    assert "not included:" in text
    assert all(line in text for line in said["lacks"])
    assert "the temperature of the lubricant" in lacks


@pytest.mark.slow
@pytest.mark.parametrize("name", ["CSG-14-100", "CSG-25-100"])
def test_loops_inside_have_the_area_of_the_fmus(name):
    """Springs that were fitted at rated torque only have the area of smaller loops within 5 %."""
    own = make_transmission(jointfmu.drive(name, hysteresis=1.0).file)
    springs = fit_spring(own, own.rated_torque)
    for share in (0.1, 0.2, 0.3, 0.5, 0.7):
        torques, x = own.compute_loop(share * own.rated_torque)
        assert loop_area(x, springs.compute_torque(x)) == pytest.approx(loop_area(x, torques), rel=0.05), (
            share
        )


@pytest.mark.parametrize("speed", [0.01, 5.0, 60.0])
def test_friction_of_the_motor_is_the_fmus(speed, folder, capsys):
    """Motor turned from rest without load: at low speed, where the damping of the bristles is small, friction
    follows Dahl's curve. After four times the presliding angle (exp(-4) is 2 %), it is that of the FMU.

    The presliding angle is so large that the step of the file does not limit the stiffness of the bristles.
    """
    drive = jointfmu.drive("CSG-20-100", starting_torque=0.1, back_driving_torque=20.0, efficiency=0.75)
    static, presliding = 1.5 * drive.values["friction_coulomb"], 0.3
    drive = drive.with_values(friction_stribeck=static / 3.0, presliding=presliding)
    drive.save("d.toml")
    _, model = exported(capsys, "d.toml")
    model.dof_armature[:], model.opt.timestep = 1e12, 3e-4 / speed
    data, motor = mujoco.MjData(model), model.joint("motor").dofadr[0]
    mujoco.mj_setConst(model, data)
    mujoco.mj_resetData(model, data)
    data.qvel[:] = speed, speed / drive.values["ratio"]
    spring = drive.spring
    _, memory = spring.advance_motion((0.0, 0.0, 0.0, 0.0), spring.initial_history())
    for step in range(1, 5001):
        mujoco.mj_step(model, data)
        if step % 50 == 0:
            x = data.qpos[motor]
            out, memory = spring.advance_motion((x, speed, x / -100.0, speed / -100.0), memory)
            found = model.dof_damping[motor] * speed - data.actuator_force[1]
            if x > 4.0 * presliding:
                assert found == pytest.approx(float(out["tau_friction"]), abs=0.02 * static)
            elif speed == 0.01:
                assert found == pytest.approx(static * -np.expm1(-x / presliding), abs=0.02 * static)
    assert x == pytest.approx(1.5, rel=1e-3)


def test_urdf_says_what_it_misses_and_mujoco_reads_the_rest(folder, capsys):
    """MuJoCo reads friction and mimic pair of the file; damping acts on the joint as on the motor."""
    drive = jointfmu.drive("CSG-20-100", starting_torque=0.1, back_driving_torque=20.0, efficiency=0.75)
    drive.save("d.toml")
    assert cli.main(["export", "urdf", "d.toml", "--out", "drive.urdf", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert "wind_up" not in said
    text, values = (folder / "drive.urdf").read_text(), drive.values
    rated, ratio = values["rated_torque"], values["ratio"]
    assert said["lacks"][0] == f"the wind-up, {float(drive.wind_up(rated)):.4g} rad at {rated:g} N.m"
    assert all(line in text for line in said["lacks"])
    assert "friction that grows with the load" in text
    model = mujoco.MjModel.from_xml_path("drive.urdf")
    link = model.joint("link").dofadr[0]
    assert model.dof_frictionloss[link] == pytest.approx(values["friction_coulomb"] * abs(ratio), rel=1e-8)
    assert model.dof_damping[link] == pytest.approx(values["friction_viscous"] * ratio**2, rel=1e-8)
    assert model.neq == 1
    assert model.eq_data[0, :2].tolist() == pytest.approx([0.0, ratio])
    transmission = ElementTree.fromstring(text.split("-->")[1]).find("ros2_control/transmission")
    assert float(transmission.find("joint/mechanical_reduction").text) == ratio


def test_urdf_states_the_loop(folder, capsys):
    """The area is that of the drive's spring, in four quarter branches."""
    drive = jointfmu.drive("CSG-25-100", hysteresis=1.0)
    drive.save("drive.toml")
    assert cli.main(["export", "urdf", "drive.toml", "--out", "drive.urdf", "--json"]) == 0
    assert "J a loop at 87 N.m" in json.loads(capsys.readouterr().out)["lacks"][1]
    text = (folder / "drive.urdf").read_text()
    stated = float(re.search(r"the hysteresis, (\S+) J a loop at 87 N.m", text)[1])
    memory, losses = drive.spring.initial_history(), []
    for torque in 87.0 * np.cos(np.linspace(0.0, 2.0 * np.pi, 201)):
        out, memory = drive.spring.advance_torque(torque, memory)
        losses.append(float(out["E_loss"]))
    assert stated == pytest.approx(losses[-1] - losses[0], rel=0.02)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["mjcf", "CSG-25-1000"], "'CSG-25-1000' is not a parameter file"),
        (["mjcf", "BoltedJoint"], "is a bolted_joint, no drive of a motor; allowed is a harmonic_drive"),
        (
            ["mjcf", "CSG-25-100", "--torque", "0"],
            r"--torque = 0 N.m is outside \(0, 204\] N.m of CSG-25-100",
        ),
        (["mjcf", "CSG-25-100", "--torque", "nan"], r"--torque = nan N.m is outside"),
        (
            ["mjcf", "CSG-25-100", "--units", "mm-N-MPa-t"],
            "--units = mm-N-MPa-t: mjcf is always in m-N-Pa-kg",
        ),
        (["mjcf", "CSG-25-100", "--error", "0.1"], "--error has no effect for mjcf"),
        (["csv", "curve", "--torque", "3"], "--torque has no effect for csv; it is for mjcf, urdf"),
        (["urdf", "GearMesh"], "is a gear_mesh, no drive of a motor"),
    ],
)
def test_refusals(words, line, capsys):
    assert re.search(line, refused_line(capsys, "export", *words, "--out", "x.xml"))


def test_without_mujoco_it_is_refused_in_one_line(capsys, enter):
    enter(missing_package("mujoco"))
    line = refused_line(capsys, "export", "mjcf", "CSG-14-100", "--out", "x.xml")
    assert "the package mujoco is missing" in line
    assert "jointfmu[mujoco]" in line
