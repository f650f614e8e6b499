"""System files: refusals, and the mechanics of arms by independent methods."""

import dataclasses
import math
import re
from contextlib import chdir
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import here_alone, refused_line
from jointfmu_fmu_src.building import build_fmus
from jointfmu_fmu_src.partners.laws import GRAVITY, TorqueCurve
from jointfmu_tools import cli
from jointfmu_tools.exchange.modelica.library import render_system
from jointfmu_tools.exchange.modelica.records import create_template_environment
from jointfmu_tools.exchange.modelica.systems import render_system_model
from jointfmu_tools.pages.report.systems import joint_load_outputs, system_charts
from jointfmu_tools.systems import ssp
from jointfmu_tools.systems.arm import Arm, Link
from jointfmu_tools.systems.fmu.arm_links import ArmLinks
from jointfmu_tools.systems.ssp import find_fmu_names
from jointfmu_tools.systems.steps import find_largest_stable_step
from jointfmu_tools.systems.system import list_system_names, load_system, read_system
from jointfmu_tools.systems.wiring import find_connections, find_lag_parameters, find_signals
from numpy.typing import NDArray

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.mechanics.stable_steps import largest_stable_steps
from jointfmu.parameters import format_parameter_file, load_default
from jointfmu.quantity import replace_values as replaced
from jointfmu.quantity.refusal import InputRefusal

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "models/systems/robot_joint.toml").read_text(encoding="utf-8")
DRIVE = 'model = "HarmonicDriveSpring"'
ARM = (ROOT / "models/systems/six_axis_robot.toml").read_text(encoding="utf-8")
CHAIN = '["drive.flange2", "link.flange_b"],'


def changed(folder: Path, *changes: tuple[str, str], text: str = TEXT) -> Path:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "mine.toml").write_text(text, encoding="utf-8")
    return folder / "mine.toml"


def second(model: str, inertia: str = "", unit: str = "") -> str:
    given = (
        f'{inertia} = {{ value = 1.0, unit = "{unit}", kind = "user", source = "a test" }}\n'
        if inertia
        else ""
    )
    return f'[second]\nmodel = "{model}"\n{given}\n[experiment]'


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            [('model = "HarmonicDriveSpring"', 'model = "HarmonicDrive"')],
            "drive.model = 'HarmonicDrive', allowed",
        ),
        ([("hysteresis_loss", "hysteresis")], "drive: unknown name 'hysteresis', allowed are"),
        (
            [("[link]\n", "[link]\nlength = 3\n")],
            "link.length = 3, expected a table { value, unit, kind, source }",
        ),
        (
            [('"drive.flange1"', '"drive.flange3"')],
            "unknown flange 'drive.flange3' of a HarmonicDriveSpring, allow",
        ),
        (
            [('"drive.flange1"', '"gear.flange1"')],
            "connect: unknown component 'gear', allowed are load, motor,",
        ),
        ([('"load",', '"load.flange",')], "'load.flange': a TorqueProfile has no flange, allowed is load"),
        ([(CHAIN, "")], 'drive.flange2 is not connected; connect it to a flange of a body, or "ground"'),
        (
            [(CHAIN, '["drive.flange2", "ground"],')],
            "link is not connected; connect it to a flange of a body",
        ),
        (
            [(CHAIN, '["drive.flange2", "motor.flange_a"],')],
            "motor.flange_a is connected to load and to drive.fl",
        ),
        (
            [
                ('["load", "motor.flange_a"]', '["load", "link.flange_a"]'),
                (CHAIN, CHAIN + '["motor.flange_a", "link.flange_a"],'),
            ],
            "link.flange_a is connected to load and to motor.flange_a",
        ),
        (
            [
                ('["load", "motor.flange_a"],', ""),
                (CHAIN, '["drive.flange2", "motor.flange_a"], ["load", "link.flange_a"],'),
            ],
            "drive.flange2 on motor.flange_a closes a loop; only chains of joints and bodies are possible",
        ),
        (
            [(CHAIN, CHAIN + '["motor.flange_b", "link.flange_a"],')],
            "motor.flange_b is connected to drive.flange1",
        ),
        (
            [
                ('"load", "motor.flange_a"', '"load", "motor.flange_a"'),
                (CHAIN, '["drive.flange2", "second.flange1"],'),
                ("[experiment]", second("HarmonicDriveSpring")),
            ],
            "drive.flange2 and second.flange1 do not fit; allowed is a joint's flange on a body's",
        ),
        (
            [
                ("[experiment]", second("TranslationalMass", "m", "kg")),
                (CHAIN, '["drive.flange2", "second.flange_a"],'),
            ],
            "drive.flange2 and second.flange_a do not fit; allowed are two rotational or two translational "
            "flanges",
        ),
        (
            [("[experiment]", second("ForceProfile")), ('["load",', '["second",')],
            "second and motor.flange_a do not fit; allowed are a force or torque on a body's flange, an",
        ),
        (
            [
                ("[experiment]", second("HarmonicDriveCompliance")),
                (CHAIN, '["second.flange", "link.flange_b"],'),
            ],
            "second: a HarmonicDriveCompliance has a load as input and a motion as output; expected a joint",
        ),
        (
            [("[link]", "[motor2]"), ('"link.flange_b"', '"motor2.flange_b"')],
            "component 'motor2' begins with the name 'motor', which fmpy confuses",
        ),
        ([("[experiment]", "[experiments]")], "has no section [experiment], expected a system's file"),
        ([("value = 2.0, unit", "value = -2.0, unit")], "experiment.stop_time = -2 s is outside (0, inf)"),
        (
            [('J = { value = 0.05, unit = "kg.m2"', 'lag_a = { value = 0.05, unit = "1"')],
            "link.J is not stated, expected the moment of inertia",
        ),
        ([("[link]", "[motor]")], "is not valid TOML (Cannot declare ('motor',) twice"),
        ([("value = 0.05", "value = -0.05")], "link.J = -0.05 kg.m2 is outside (0, inf)"),
        ([("connect = [", "connect = [ 3,")], "connect = 3, expected pairs of ends"),
        ([("schema = 1", "schema = 7")], "schema = 7, expected the line schema = 1"),
        (
            [
                (
                    '[motor]\nmodel = "RotationalInertia"',
                    '[motor]\nmodel = "RotationalInertia"\nparameters = "a.toml"',
                )
            ],
            "motor.parameters = 'a.toml', but a RotationalInertia takes no parameters",
        ),
        (
            [('model = "HarmonicDriveSpring"', 'model = "HarmonicDriveSpring"\nparameters = "none.toml"')],
            "none.toml: cannot be read",
        ),
        (
            [(DRIVE, f'{DRIVE}\ncatalogue = "CSG-18-100"')],
            "drive: catalogue 'CSG-18-100' is unknown; nearest are CSG-",
        ),
        (
            [(DRIVE, f'{DRIVE}\ncatalogue = "CSG-17-100"\nparameters = "my_drive.toml"')],
            "drive has catalogue and parameters, state one of them",
        ),
        ([(DRIVE, f"{DRIVE}\ncatalogue = 17")], "drive.catalogue = 17, expected a text"),
        (
            [(DRIVE, 'model = "GearMesh"\ncatalogue = "m3"')],
            "drive.catalogue = 'm3', but a gear_mesh has no catalogue",
        ),
        (
            [
                (
                    '[motor]\nmodel = "RotationalInertia"',
                    '[motor]\nmodel = "RotationalInertia"\ncatalogue = "CSG-17-100"',
                )
            ],
            "motor.catalogue = 'CSG-17-100', but a RotationalInertia takes no catalogue",
        ),
    ],
)
def test_a_file_that_is_wrong_is_refused_in_one_line(
    tmp_path: Path, changes: list[tuple[str, str]], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = changed(tmp_path, *changes)
    assert said in refused_line(capsys, "system", path, "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([('axis = "z"', 'axis = "x"')], "arm.base.axis = 'x', allowed are y, z"),
        (
            [("mass = { value = 14.0", "mass = { value = -14.0")],
            "arm.base: mass = -14 kg is outside (0, inf)",
        ),
        (
            [('model = "HarmonicDriveSpring"', 'model = "BoltedJoint"')],
            "arm.base.model = 'BoltedJoint', allowed are HarmonicDriveSpring",
        ),
        (
            [("duration = { value = 1.0", "duration = { value = 0.0")],
            "arm.duration = 0 s is outside (0, inf)",
        ),
    ],
)
def test_an_arm_that_is_wrong_is_refused_in_one_line(
    tmp_path: Path, changes: list[tuple[str, str]], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = changed(tmp_path, *changes, text=ARM)
    assert said in refused_line(capsys, "system", path, "--out", tmp_path / "out")


@pytest.mark.parametrize("name", list_system_names())
def test_every_input_has_one_source_and_lags_are_set_at_joints(name: str) -> None:
    found = load_system(name)
    fed = [(w.target_component, w.target_input) for w in find_signals(found)]
    assert len(fed) == len(set(fed))
    pushed = {w.target_component for w in find_signals(found) if w.source_component in found.joints}
    assert set(find_lag_parameters(found)) == pushed
    assert len(find_connections(found)) == len(found.connections)


def test_a_parameter_file_of_its_own_makes_an_fmu_of_its_own(tmp_path: Path) -> None:
    file = load_default("harmonic_drive").with_values({"ratio": 50.0, "mu": 0.1}, "user", "test")
    (tmp_path / "my_drive.toml").write_text(format_parameter_file(file), encoding="utf-8")
    mine = changed(
        tmp_path,
        ('model = "HarmonicDriveSpring"', 'model = "HarmonicDriveSpring"\nparameters = "my_drive.toml"'),
    )
    drive = read_system(mine).joints["drive"]
    assert drive.parameter_file is not None
    assert (
        drive.parameter_file.values_by_name["ratio"],
        drive.parameter_file.values_by_name["hysteresis_loss"],
    ) == (
        50.0,
        2.9e-4,
    )
    assert find_fmu_names(read_system(mine))["drive"] == "mine_drive"
    assert find_fmu_names(load_system("robot_joint"))["drive"] == "HarmonicDriveSpring"
    robot = load_system("six_axis_robot")
    own = {f"six_axis_robot_{one}" for one in robot.joints}
    assert set(find_fmu_names(robot).values()) == own | {"AngleProfile", "RotationalInertia", "TorqueCurve"}


def test_joints_with_the_same_baked_values_share_an_fmu(tmp_path: Path) -> None:
    """The same drive on two axes with different damping, which the archive sets."""
    path = changed(tmp_path, ('"CSG-40-100"', '"csg 32 100"'), text=ARM)
    found = find_fmu_names(read_system(path))
    assert found["base_drive"] == found["shoulder_drive"] == "mine_base_drive"
    assert found["elbow_drive"] == "mine_elbow_drive"


# The arm

ROBOT: Arm = load_system("six_axis_robot").arm


def energies(arm: Arm, q: Array, speed: Array) -> tuple[Array, Array]:
    """Kinetic and potential energy of an arm; Jacobians are differences of the positions of the centres of
    mass."""
    step = 1e-6

    def centres(angles: Array) -> Array:
        turns, places, _ = arm.compute_frames(angles)
        pairs = zip(arm.links, turns, places, strict=True)
        return np.stack([place + link.centre * turn[:, :, 2] for link, turn, place in pairs], axis=1)

    rate = (centres(q + step * speed) - centres(q - step * speed)) / (2.0 * step)
    masses = np.array([link.mass for link in arm.links])
    kinetic = 0.5 * np.sum(masses * np.sum(rate**2, axis=2), axis=1)
    forth, back = arm.compute_frames(q + step * speed)[0], arm.compute_frames(q - step * speed)[0]
    for k, (link, turn) in enumerate(zip(arm.links, arm.compute_frames(q)[0], strict=True)):
        spin = (forth[k] - back[k]) / (2.0 * step) @ turn.transpose(0, 2, 1)  # skew matrix of the turning
        w = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
        own = np.einsum("nji,nj->ni", turn, w)
        kinetic = kinetic + 0.5 * own**2 @ [link.J_across, link.J_across, link.J_along]
    return kinetic, np.sum(masses * centres(q)[:, :, 2], axis=1) * GRAVITY


def test_power_of_the_torques_is_the_rate_of_the_energy() -> None:
    time = np.linspace(0.1, 1.1, 4001)
    q, speed, acceleration = ROBOT.compute_motion(time)
    power = np.sum(ROBOT.inverse_dynamics(q, speed, acceleration) * speed, axis=1)
    kinetic, potential = energies(ROBOT, q, speed)
    rate = np.gradient(kinetic + potential, time)
    assert np.max(np.abs(power - rate)[2:-2]) < 1e-5 * np.max(np.abs(power))  # of central differences


def test_a_double_pendulum_has_the_textbooks_torques() -> None:
    """Vertical, with point masses at the ends: Lagrange's equations."""
    l1, l2, m1, m2 = 0.7, 0.4, 3.0, 2.0
    tiny: dict[str, Any] = {"J_along": 1e-12, "J_across": 1e-12, "travel": 0.0}
    links = [Link(length=l1, mass=m1, centre=l1, **tiny), Link(length=l2, mass=m2, centre=l2, **tiny)]
    arm = Arm(["a", "b"], ["y", "y"], links, 0.0, 1.0)
    rng = np.random.default_rng(3)
    q, v, a = rng.normal(size=(3, 20, 2))
    c, s = np.cos(q[:, 1]), np.sin(q[:, 1])
    inertia = m1 * l1**2 + m2 * (l1**2 + l2**2 + 2 * l1 * l2 * c)
    mixed = m2 * (l2**2 + l1 * l2 * c)
    swirl = m2 * l1 * l2 * s
    both = m2 * GRAVITY * l2 * np.sin(q.sum(axis=1))
    first = inertia * a[:, 0] + mixed * a[:, 1] - swirl * (2 * v[:, 0] * v[:, 1] + v[:, 1] ** 2)
    first -= (m1 + m2) * GRAVITY * l1 * np.sin(q[:, 0]) + both
    other = mixed * a[:, 0] + m2 * l2**2 * a[:, 1] + swirl * v[:, 0] ** 2 - both
    np.testing.assert_allclose(
        arm.inverse_dynamics(q, v, a), np.stack([first, other], axis=1), rtol=1e-9, atol=1e-9
    )
    np.testing.assert_allclose(arm.compute_axis_inertias(q[0]), [inertia[0], m2 * l2**2], rtol=1e-9)


def test_the_tip_is_where_the_links_lead() -> None:
    reach = sum(link.length for link in ROBOT.links)
    zero = np.zeros((1, 6))
    np.testing.assert_allclose(ROBOT.compute_tip_position(zero), [[0.0, 0.0, reach]], atol=1e-15)
    level = np.array([[0.5, math.pi / 2, 0.0, 0.3, 0.0, 0.7]])
    above = reach - ROBOT.links[0].length
    expected = [[above * math.cos(0.5), above * math.sin(0.5), ROBOT.links[0].length]]
    np.testing.assert_allclose(ROBOT.compute_tip_position(level), expected, atol=1e-12)


def test_coupled_links_have_the_inverse_dynamics_of_the_arm() -> None:
    """At random states: accelerations from the torques of inverse dynamics, residuals, tip."""
    links = ArmLinks(ROBOT)
    parameters = links.make_component().parameter_file.values
    q, speed, acceleration = np.random.default_rng(5).normal(size=(3, 20, 6))
    columns = {"phi": q, "w": speed, "a": acceleration, "tau": ROBOT.inverse_dynamics(q, speed, acceleration)}
    values = {
        f"{name}_link.{key}": column[:, k]
        for key, column in columns.items()
        for k, name in enumerate(ROBOT.axis_names)
    }
    found = links.evaluate_outputs(parameters, values)
    for k, name in enumerate(ROBOT.axis_names):
        np.testing.assert_allclose(found[f"{name}_link.a"], acceleration[:, k], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(links.evaluate_residuals(parameters, values), 0.0, atol=1e-9)
    tip = np.stack([found[f"tip.{x}"] for x in "xyz"], axis=1)
    np.testing.assert_allclose(tip, ROBOT.compute_tip_position(q), atol=1e-12)


def test_six_drives_differ_and_wind_up_as_their_catalogue_says() -> None:
    """The wind-ups are the catalogue's wind-ups at T2 of sizes 32, 40, 25, 20, 17, 14; round corners
    change 0.5 %."""
    rows = {
        "base": (29, 108, 67e3, 110e3),
        "shoulder": (54, 196, 130e3, 200e3),
        "elbow": (14, 48, 31e3, 50e3),
        "forearm": (7, 25, 16e3, 25e3),
        "wrist": (3.9, 12, 10e3, 14e3),
        "hand": (2, 6.9, 4700, 6100),
    }
    found = load_system("six_axis_robot")
    for name, (first, second_, k1, k2) in rows.items():
        file = found.joints[f"{name}_drive"].parameter_file
        assert file is not None
        midline = HarmonicDriveSpring.tabulate(replaced(file.values, {"hysteresis_loss": 0.0}))
        angle = float(midline.evaluate_torque(float(second_))["phi_rel"])
        assert angle == pytest.approx(first / k1 + (second_ - first) / k2, rel=5e-3)


def test_curves_of_the_arm_are_the_inverse_dynamics() -> None:
    """Seventeen points leave an error of 4e-4 of the largest torque of an axis."""
    found = load_system("six_axis_robot")
    x = np.linspace(0.0, 1.0, 301)
    q, speed, acceleration = ROBOT.compute_motion(ROBOT.motion_start + ROBOT.motion_duration * x)
    torque = ROBOT.inverse_dynamics(q, speed, acceleration)
    for k, name in enumerate(ROBOT.axis_names):
        given = found.components[f"{name}_load"].stated_values
        curve = TorqueCurve(**given)
        time = ROBOT.motion_start + ROBOT.motion_duration * x
        values = np.array([curve.evaluate_outputs({"time": t, "tau_in": 0.0})["tau"] for t in time])
        inertia = found.stated_values[f"{name}_link.J"]
        left = inertia * acceleration[:, k] - torque[:, k]
        assert np.max(np.abs(values - left)) < 5e-4 * np.max(np.abs(torque[:, k]))
    assert re.search(r"J = .*", ARM) is None  # computed, not stated


def test_the_modelica_model_is_as_warm_and_as_tight_as_the_fmus(tmp_path):
    """The Modelica model has the inputs of the joint's file, or those of the system file."""
    files = {
        "harmonic_drive": {"temperature": 318.15},
        "bolted_joint": {"preload": 12e3, "temperature": 313.15},
    }
    for joint, inputs in files.items():
        stated = dataclasses.replace(load_default(joint), inputs=inputs)
        (tmp_path / f"{joint}.toml").write_text(format_parameter_file(stated), encoding="utf-8")
    own = f'{DRIVE}\nparameters = "harmonic_drive.toml"'
    assert "final T=318.15," in render_system(read_system(changed(tmp_path, (DRIVE, own))))
    held = 'temperature = { value = 303.15, unit = "K", kind = "user", source = "a test" }'
    assert ", T=303.15)" in render_system(read_system(changed(tmp_path, (DRIVE, f"{own}\n{held}"))))
    column = (ROOT / "models/systems/bolted_column.toml").read_text(encoding="utf-8")
    bolted = ('model = "BoltedJoint"\npreload', 'model = "BoltedJoint"\nparameters = "bolted_joint.toml"\n#')
    asked = []
    known = SimpleNamespace(record_name="Known")
    column = read_system(changed(tmp_path, bolted, text=column))
    render_system_model(
        column, create_template_environment(), lambda kind, file, point: asked.append(point) or known
    )
    assert asked == [(12e3, 0.0, 313.15)]


def test_an_interval_beyond_the_largest_stable_step_is_said(tmp_path, capsys):
    """A refusal names the interval for motor and link on the drive, at rest and at the largest torque of a
    run."""
    path, out = changed(tmp_path, ("value = 5.0e-4", "value = 3.0e-3")), tmp_path / "out"
    drive = HarmonicDriveSpring.tabulate(read_system(path).joints["drive"].parameter_file.values)

    def limit(torque: float) -> float:
        at_rest = drive.evaluate_torque(torque)["K_WTS"]
        return largest_stable_steps(at_rest, drive.joint.d, 1.0 / 0.05 + 1.0 / (1e-5 * drive.joint.ratio**2))[
            1
        ]

    said = (
        f"experiment.interval = 0.003 s is longer than {limit(0.0):.3g} s, the largest stable step of drive"
    )
    assert said in refused_line(capsys, "system", path, "--out", out, "--csv", tmp_path / "run.csv")
    assert not out.exists()
    angle, still = np.array([0.0, float(drive.evaluate_torque(5.0)["phi_rel"]), 0.0]), np.zeros(3)
    moved = {"motor.phi": still, "motor.w": still, "link.phi": angle, "link.w": still}
    found = find_largest_stable_step(read_system(path), moved | {"drive.tau1": angle, "drive.tau2": -angle})
    assert found == (pytest.approx(limit(5.0), rel=0.01), "drive")
    assert limit(5.0) < 0.8 * limit(0.0)


@pytest.mark.slow
def test_an_interval_that_is_long_is_a_warning_of_the_build(tmp_path, capsys):
    path, out = changed(tmp_path, ("value = 5.0e-4", "value = 3.0e-3")), tmp_path / "out"
    with here_alone():
        assert cli.main(["system", str(path), "--out", str(out)]) == 0
    assert "warning: experiment.interval = 0.003 s is longer than" in capsys.readouterr().err


def test_a_picture_shows_the_peaks_of_a_run():
    robot, time = load_system("robot_joint"), np.linspace(0.0, 2.0, 4001)
    torque = np.zeros(4001)
    torque[[1233, 1234]] = -3.0, 77.5
    ((output, _),) = joint_load_outputs(robot).values()
    (panel,) = system_charts(robot, {"time": time, output: torque})
    (drawn,) = panel.chart_series
    assert (np.min(drawn.y_values), np.max(drawn.y_values)) == (-3.0, 77.5)
    assert len(drawn.x_values) <= 800
    assert np.all(np.diff(drawn.x_values) > 0.0)


def test_ring_without_fmus_says_what_writes_them(tmp_path, enter, capsys):
    enter(chdir(tmp_path))
    said = refused_line(capsys, "ring", "robot_joint")
    assert "has no HarmonicDriveSpring.fmu; `jointfmu system robot_joint` writes it" in said
    said = refused_line(capsys, "ring", "six_axis_robot", "--joint", "elbow_drive")
    assert "has no six_axis_robot_elbow_drive.fmu" in said


@pytest.mark.slow
def test_the_systems_replace_no_joint_of_the_user(tmp_path):
    """`build --systems` does not replace a joint that was built with --params."""
    file, column = load_default("bolted_joint"), [load_system("bolted_column")]
    with here_alone():
        (path,) = build_fmus(
            ["BoltedJoint"], ["fmi2"], file.with_values({"mu": 0.11}, "user", "mine"), tmp_path
        )
        before = path.read_bytes()
        with pytest.raises(InputRefusal, match="was built from other parameters") as error:
            ssp.build_system_archives(tmp_path, column)
        assert str(error.value).startswith(f"{path}: ")
        assert path.read_bytes() == before
        for overwrite in (True, False):  # then it has the parameters of the systems
            assert path in ssp.build_system_archives(tmp_path, column, overwrite=overwrite)


def test_a_system_is_scaled_to_another_joint():
    """The shipped load of the small drive is below the friction of a large one, which would not turn."""
    system, small = load_system("robot_joint"), load_default("harmonic_drive")
    assert system.with_joint_parameter_file(small).stated_values == system.stated_values
    large = replaced(
        small.values, {"rated_torque": 87.0, "ratio": -50.0, "friction_coulomb": 0.07, "load_loss": 0.1}
    )
    file = dataclasses.replace(small, values=large, name="large")
    scaled = system.with_joint_parameter_file(file)
    before, after = system.stated_values, scaled.stated_values
    rated = 87.0 / 5.0
    assert after["link.m"] == pytest.approx(rated * before["link.m"])
    assert after["link.l"] == before["link.l"]
    assert after["motor.J"] == pytest.approx(4.0 * rated * before["motor.J"])
    assert after["load.pulse_height"] == pytest.approx(2.0 * rated * before["load.pulse_height"])
    assert after["load.ramp_height"] == pytest.approx(2.0 * rated * before["load.ramp_height"] + 0.07)
    assert scaled.components["motor"].value_sources["J"].endswith("; scaled to large")
