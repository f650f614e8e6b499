"""Fit of a drive's friction to a robot's log: round trips, a measured table, refusals."""

import json
import math
from functools import partial
from importlib.resources import files
from pathlib import Path
from time import process_time

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.common import columns
from jointfmu_tools.inputs.fitting import outcome
from jointfmu_tools.joints.harmonic_drive.fit import hysteresis, log, log_friction
from jointfmu_tools.joints.harmonic_drive.fit.log_friction import motor_friction
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND
from matplotlib.figure import Figure
from oracles import robot_log
from oracles.robot_log import CASES, TRUE_VALUES, fit_log

from jointfmu.joints.harmonic_drive.friction import friction_limits, friction_ripple, viscous_torque
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import format_parameter_file, load_parameter_file

TABLE = files("jointfmu_models") / "reference" / "ur5e_base_joint_friction.csv"
NAMES = ["dq=joint_speed_rad_per_s [rad/s]", "tau=motor_torque_Nm [N.m]"]
WARM = "temperature=temperature_degC [degC]"


@pytest.fixture
def drive(tmp_path):
    """Parameter file of a drive like that of the robot."""
    given = dict.fromkeys(o.name for o in NEW_JOINT_COMMAND.command_options) | {
        "catalogue": "CSG-25-100",
        "fixed": "flexspline",
    }
    path = tmp_path / "drive.toml"
    path.write_text(
        format_parameter_file(NEW_JOINT_COMMAND.make_joint(given).parameter_file), encoding="utf-8"
    )
    return path


# round trips


def check_friction(found, undetermined=frozenset()):
    """Assert that the fitted friction is within four standard deviations; the fit starts 40 % off."""
    assert found.rejection_reason() is None
    assert not any("--motor-inertia" in note for note in found.notes)
    assert found.facts["held_out"][0] < 0.1 * found.facts["held_out_constant"][0]
    for label, deviation in found.solution.relative_deviations.items():
        assert abs(math.log(found.parameters.values_by_name[label] / TRUE_VALUES[label])) < 4.0 * deviation
        if label in undetermined:
            assert label not in found.confidence_intervals
            continue
        low, high = found.confidence_intervals[label]
        assert low < found.parameters.values_by_name[label] < high
        assert f"95 % interval {low:.4g} to {high:.4g}" in found.parameters.sources[label]


@pytest.mark.parametrize("seed", [0, 1])
def test_steady_speeds_give_their_friction_back(seed):
    (steady,) = (case for name, case in CASES.items() if "steady" in name)
    check_friction(fit_log(*steady, seed))


@pytest.mark.slow
def test_an_arm_that_swings_gives_its_friction_back():
    """The fit also finds inertias and gravity, with the unknown rotor inertia from the wind-up. In half a
    minute, nine periods of the slowest wave, the arm is slow too rarely to determine the Stribeck friction,
    which steady speeds do."""
    swing = partial(robot_log.write_swing, duration=30.0, step=8e-3)
    found = fit_log(swing, {"torque_constant": robot_log.CONSTANT}, 1)
    check_friction(found, {"friction_stribeck"})
    assert found.facts["motor_inertia"][0] == pytest.approx(robot_log.ROTOR, rel=0.05)
    whole = robot_log.ARM + robot_log.ROTOR * 100.0**2
    assert found.facts["inertia"][0] == pytest.approx(whole, rel=0.02)
    assert found.facts["gravity_cos"][0] == pytest.approx(robot_log.GRAVITY, rel=0.02)
    assert abs(found.facts["gravity_sin"][0]) < 0.02 * robot_log.GRAVITY
    assert [picture.axis_labels[0].split(" [")[0] for picture in found.fit_plots] == [
        "speed of the joint",
        "time",
        "temperature",
        "torque at the joint",
    ]
    assert {*hysteresis.ROBOT_LOG_FITTED_PARAMETERS} < {*found.solution.values}


def test_a_load_that_is_measured_gives_the_losses(tmp_path):
    """Steady speeds in both senses against and with gravity; two files are one log."""
    file = robot_log.drive()
    start, paths = robot_log.start(), []
    for number, held in enumerate((-40.0, 0.0, 40.0)):
        dq = np.array([-2.0, -1.0, -0.5, -0.02, 0.02, 0.5, 1.0, 2.0])
        w1 = 100.0 * dq
        forward = file.with_values({"ratio": 100.0}, "user", "in the joint's sense").values
        positive, negative = friction_limits(forward, w1, -held)
        torque = np.where(dq > 0.0, positive, -negative) + viscous_torque(forward, w1) + held / 100.0
        heads = [("gravity", "N.m"), ("motor_torque", "mN.m"), ("joint_speed", "rad/s")]
        paths.append(tmp_path / f"{number}.csv")
        paths[-1].write_text(columns.format_table(heads, [np.full(8, held), 1e3 * torque, dq]))
    found = log.fit(paths, start)
    for name in ("friction_coulomb", "friction_stribeck", "friction_viscous", "load_loss", "load_loss_back"):
        assert found.parameters.values_by_name[name] == pytest.approx(TRUE_VALUES[name], rel=1e-3)
    assert any("viscous_temperature_coefficient" in note for note in found.notes)
    figure = Figure(outcome.fit_figure_size(found), layout="constrained")
    outcome.draw_fit_plots(figure, found)
    figure.draw_without_rendering()
    legend, data = figure.axes[0].get_legend().get_window_extent(), figure.axes[0].get_window_extent()
    assert legend.y0 >= data.y1  # beside the curves


@pytest.mark.parametrize("is_measured", [False, True])
def test_losses_of_an_unmeasured_load_are_not_stated_as_determined(tmp_path, is_measured):
    """Without a measured load, (1 + load_loss)/(1 - load_loss_back) is all that the log determines: any
    load_loss_back fits with another load. The kept value of the start file is 40 % off."""
    t = np.arange(0.0, 30.0, 0.01)
    waves = ((0.7, 0.31), (0.4, 0.83))
    q = sum(a * np.sin(2.0 * np.pi * f * t) for a, f in waves)
    dq = sum(2.0 * np.pi * f * a * np.cos(2.0 * np.pi * f * t) for a, f in waves)
    ddq = sum(-((2.0 * np.pi * f) ** 2) * a * np.sin(2.0 * np.pi * f * t) for a, f in waves)
    gravity = robot_log.GRAVITY * np.sin(q)
    load, w1 = gravity + robot_log.ARM * ddq, 100.0 * dq
    truth = robot_log.drive().with_values({"ratio": 100.0}, "user", "in the joint's sense").values
    positive, negative = friction_limits(truth, w1, -load)
    torque = np.where(dq > 0.0, positive, -negative) + viscous_torque(truth, w1)
    torque += load / 100.0 + robot_log.ROTOR * 100.0 * ddq
    torque += 2e-3 * np.random.default_rng(3).standard_normal(t.size)
    heads = [("time", "s"), ("q", "rad"), ("dq", "rad/s"), ("motor_torque", "N.m")]
    data = [t, q, dq, torque]
    if is_measured:
        heads, data = [*heads, ("gravity", "N.m")], [*data, gravity]
    path = tmp_path / "log.csv"
    path.write_text(columns.format_table(heads, data, 9))
    found = log.fit([path], robot_log.start(), motor_inertia=robot_log.ROTOR)
    fitted, deviation = found.parameters.values, found.solution.relative_deviations["load_loss"]
    ratio = (1.0 + TRUE_VALUES["load_loss"]) / (1.0 - TRUE_VALUES["load_loss_back"])
    assert (1.0 + fitted.load_loss) / (1.0 - fitted.load_loss_back) == pytest.approx(ratio, rel=5e-3)
    assert abs(math.log(fitted.load_loss / TRUE_VALUES["load_loss"])) < 4.0 * deviation
    assert ("load_loss" in found.confidence_intervals) == is_measured
    if is_measured:
        assert fitted.load_loss == pytest.approx(TRUE_VALUES["load_loss"], rel=0.05)
    else:
        assert any("a column gravity [N.m]" in note for note in found.notes)


@pytest.mark.parametrize(("ratio", "is_refused"), [(50.0, True), (102.0, True), (100.0, False)])
def test_angles_that_contradict_the_ratio_are_refused(tmp_path, ratio, is_refused):
    """The log is one of a drive with ratio 100, whose wind-up is no contradiction."""
    path = tmp_path / "log.csv"
    robot_log.write_swing(path, 1, duration=10.0, step=8e-3)
    start = robot_log.start().with_values({"ratio": ratio}, "user", "stated")
    if is_refused:
        with pytest.raises(ValueError, match=f"times q, but the ratio of the drive is {ratio:g}"):
            log.fit([path], start, torque_constant=robot_log.CONSTANT)
    else:
        log.fit([path], start, torque_constant=robot_log.CONSTANT)


# a measured robot


def test_the_base_joint_of_a_robot(drive, tmp_path, capsys):
    """Columns are named with units, the picture is drawn, everything else is printed. Without names, the
    units in the headings (joint_speed_rad_per_s, motor_torque_Nm, temperature_degC) give the same."""
    out, plot = tmp_path / "fitted.toml", tmp_path / "fit.png"
    words = ["fit", "log", str(TABLE), "--params", str(drive), "--columns", *NAMES, WARM]
    assert cli.main([*words, "--out", str(out), "--plot", str(plot), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    rows = {row["name"]: row for row in said["unknowns"]}
    assert plot.stat().st_size > 10_000
    assert rows["friction_coulomb"]["determined"]
    assert rows["friction_viscous"]["determined"]
    assert not rows["friction_stribeck"]["determined"]
    for name in ("load_loss", "load_loss_back", "dry_temperature_coefficient"):
        assert any(f"does not determine {name}," in line for line in said["warnings"])
    values = load_parameter_file(out).values
    torque = friction_limits(values, 101.0 * 1.5, 0.0, 318.15)[0] + viscous_torque(
        values, 101.0 * 1.5, 318.15
    )
    assert torque == pytest.approx(0.1375, rel=0.15)
    low, high = rows["friction_coulomb"]["interval"]
    assert low < values.friction_coulomb < high
    assert cli.main(["fit", "log", str(TABLE), "--params", str(drive), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["unknowns"] == said["unknowns"]


def test_a_current_needs_its_constant(drive, capsys, tmp_path):
    rows = [line.rsplit(",", 1)[0] for line in TABLE.read_text(encoding="utf-8").splitlines() if "," in line]
    path = tmp_path / "current.csv"
    path.write_text("\n".join(row for row in rows if not row.startswith("#")), encoding="utf-8")
    asked = ["fit", "log", str(path), "--params", str(drive)]
    assert "expected --torque-constant [N.m/A]" in refused_line(capsys, *asked)
    assert cli.main([*asked, "--torque-constant", "0.1005"]) == 0
    assert "friction_coulomb" in capsys.readouterr().out


# refusals


def written(path, **given):
    """Function that writes a log of a swinging joint with some columns replaced."""
    time = np.linspace(0.0, 8.0, 4001)
    q, dq = np.sin(2.0 * time), 2.0 * np.cos(2.0 * time)
    torque = 0.05 * np.sign(dq) + 0.02 * dq
    own = {"time": ("s", time), "q": ("rad", q), "dq": ("rad/s", dq), "tau": ("N.m", torque)}
    own = {name: value for name, value in (own | given).items() if value is not None}
    text = columns.format_table(
        [(n, u) for n, (u, _) in own.items()], [np.asarray(x) for _, x in own.values()], 9
    )
    path.write_text(text)
    return path


DRIVE = ["--drive", "CSG-25-100"]
TIME = np.linspace(0.0, 8.0, 4001)
BACK = np.where(TIME > 4.0, TIME - 3.0, TIME)
HOLE = np.where(TIME > 4.0, TIME + 3.0, TIME)
FRICTION = 0.05 * np.sign(np.cos(2.0 * TIME)) + 0.04 * np.cos(2.0 * TIME)
MISSING = np.where(np.arange(4001) == 7, np.nan, 0.1)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"q": ("rad", 0.0 * TIME), "dq": ("rad/s", 0.0 * TIME)}, "has no motion"),
        ({"q": None, "dq": ("rad/s", 1.0 + 0.0 * TIME)}, "the speed varies only from"),
        ({"q": ("rad", np.degrees(np.sin(2.0 * TIME)))}, "likely one of them is in degrees"),
        ({"q": ("rad", np.degrees(np.sin(2.0 * TIME))), "dq": None}, "likely angles are in degrees"),
        ({"tau": None, "i": ("A", 1e4 + 0.0 * TIME)}, "a current of 1e+04 A is outside [-1000, 1000] A"),
        ({"tau": ("N.m", 300.0 * np.sin(TIME))}, "expected that of the motor, not of the joint"),
        ({"tau": ("N.m", MISSING)}, "line 9: tau = 'nan' is not a finite number"),
        ({"time": ("s", BACK)}, "runs back; expected rising times"),
        ({"time": ("s", HOLE)}, "a gap of 3.002 s"),
        ({"tau": ("N.m", -FRICTION)}, "friction drives the motion; reverse the sign of one column"),
        ({"tau": None}, "has no torque and no current of the motor; expected tau [N.m | mN.m], i [A | mA]"),
        ({"q": None, "dq": None}, "has neither q nor dq"),
        ({"dq": ("rad", TIME)}, "column 'dq' has unit 'rad'"),
    ],
)
def test_a_log_that_cannot_be_is_refused(drive, tmp_path, capsys, given, text):
    path, out = written(tmp_path / "log.csv", **given), tmp_path / "out.toml"
    said = refused_line(capsys, "fit", "log", path, "--params", drive, "--out", out)
    assert "log.csv" in said
    assert text in said
    assert not out.exists()


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--ratio", "100"], "the log does not state the drive; expected --params FILE, --drive NAME"),
        (["--rated-torque", "87"], "rated torque = 87 N.m does not state the ratio; state both (--ratio)"),
        ([*DRIVE, "--rated-torque", "87"], "--drive and --rated-torque both state the drive"),
        (
            [*DRIVE, "--columns", "speed=x"],
            "a heading of the file and a NAME of time, q, dq",
        ),
        ([*DRIVE, "--columns", "dq=x"], "has no column 'x' for dq; it has time, q, dq, tau"),
        ([*DRIVE, "--free", "K9"], "'K9' is not a parameter to fit"),
        ([*DRIVE, "--free", "K1"], "K1 needs the columns q and q_motor in addition to time"),
    ],
)
def test_words_that_cannot_be_are_refused(tmp_path, capsys, words, text):
    path = written(tmp_path / "log.csv")
    assert text in refused_line(capsys, "fit", "log", path, *words)


def test_an_unknown_rotor_is_told(drive, tmp_path, capsys):
    path = written(tmp_path / "log.csv")
    assert cli.main(["fit", "log", str(path), "--params", str(drive)]) == 0
    assert "without --motor-inertia the rotor counts as part of the arm" in capsys.readouterr().err


LIGHT = FRICTION - 0.6 * 4.0 / 100.0 * np.sin(2.0 * TIME)
LEVEL = ("N.m", 0.0 * TIME)
"""Motor torque of a horizontal joint with an inertia of 0.6 kg.m2 and gravity."""


def test_what_a_light_arm_leaves_open_stays_as_it_is(drive, tmp_path, capsys):
    """The load is above the minimum; parameters that are fitted but not determined are no calibration."""
    noise = 0.1 * np.random.default_rng(0).standard_normal(4001)
    path = written(tmp_path / "log.csv", tau=("N.m", LIGHT + noise), gravity=LEVEL)
    out = tmp_path / "out.toml"
    asked = ["fit", "log", str(path), "--params", str(drive), "--motor-inertia", "1e-6", "--out", str(out)]
    assert cli.main(asked) == 0
    shown, start, found = capsys.readouterr().err, load_parameter_file(drive), load_parameter_file(out)
    for name in ("load_loss", "load_loss_back"):
        assert (
            f"does not determine {name}, which keeps its value: the fit is as good with that value" in shown
        )
        assert (found.values_by_name[name], found.sources[name]) == (
            start.values_by_name[name],
            start.sources[name],
        )
    assert found.origins["friction_coulomb"] == "calibration"
    assert found.origins["friction_stribeck"] == "estimate"
    assert found.sources["friction_stribeck"].endswith("not determined: other values fit as well")


@pytest.mark.parametrize(
    ("given", "hint"), [("0.5", "; stated at the joint, it is 4.9e-05 kg.m2"), ("9", "log")]
)
def test_a_rotor_beyond_the_whole_is_refused(drive, tmp_path, capsys, given, hint):
    path = written(tmp_path / "log.csv", tau=("N.m", LIGHT), gravity=LEVEL)
    line = refused_line(capsys, "fit", "log", path, "--params", drive, "--motor-inertia", given)
    assert (
        f"--motor-inertia = {given} kg.m2 times ratio^2 is {101.0**2 * float(given):.4g} kg.m2 at the joint"
        in line
    )
    assert hint in line


def test_noise_is_not_written(drive, tmp_path, capsys):
    """A log whose torque is unrelated to the motion gives status 1 and one line; a file is written only with
    --force."""
    noise = np.random.default_rng(0).standard_normal(4001)
    path, out = written(tmp_path / "log.csv", tau=("N.m", 0.3 + 0.02 * noise)), tmp_path / "out.toml"
    asked = ["fit", "log", str(path), "--params", str(drive), "--out", str(out)]
    assert cli.main(asked) == 1
    assert "the fit does not determine the joint" in capsys.readouterr().err
    assert not out.exists()
    assert cli.main([*asked, "--force"]) == 0
    assert out.exists()


# torque at the joint

JOINT_LOG = Path(__file__).parents[2] / "fitting" / "data" / "joint_torque_size_32.csv"
SENSOR = {
    "friction_coulomb": 0.116,
    "friction_viscous": 0.00134,
    "load_loss": 0.11,
    "load_loss_back": 0.0605,
}
CONSTANT, ROTOR = 0.21, 1.7e-4


def size_32_file():
    given = dict.fromkeys(o.name for o in NEW_JOINT_COMMAND.command_options) | {"catalogue": "CSG-32-100"}
    return NEW_JOINT_COMMAND.make_joint(given).parameter_file


def joint_columns():
    """Columns time, angle, speed, current and torque at the joint of the synthetic log."""
    return dict(zip(("time", "q", "dq", "i", "link_torque"), np.loadtxt(
        JOINT_LOG, delimiter=",", skiprows=1).T, strict=True))  # fmt: skip


def save_log(path, log_columns, *names):
    units = {"time": "s", "q": "rad", "dq": "rad/s", "i": "A", "link_torque": "N.m", "gravity": "N.m"}
    units["q_motor"] = "rad"
    path.write_text(
        columns.format_table([(n, units[n.lower()]) for n in names], [log_columns[n] for n in names], 9)
    )
    return path


def sensor_log(seed=0):
    """Log with a torque sensor: motion of the synthetic log, current by the FMU's law, with noise."""
    log_columns, rng = joint_columns(), np.random.default_rng(seed)
    drive = size_32_file().with_values(SENSOR | {"friction_stribeck": 0.0}, "user", "made").values
    load = 2.5 * np.gradient(log_columns["dq"], 0.01) + 110.0 * np.cos(log_columns["q"])
    friction_torque = motor_friction(drive, log_columns["dq"], np.full(load.size, np.nan), load)
    torque = friction_torque + load / 100.0 + ROTOR * 100.0 * np.gradient(log_columns["dq"], 0.01)
    log_columns["i"] = torque / CONSTANT + 0.02 * rng.standard_normal(load.size)
    log_columns["link_torque"] = load + 0.3 * rng.standard_normal(load.size)
    return log_columns


def test_a_sensor_at_the_joint_gives_the_losses(tmp_path):
    path = save_log(tmp_path / "log.csv", sensor_log(), "time", "q", "dq", "i", "link_torque")
    found = log.fit([path], size_32_file(), torque_constant=CONSTANT)
    assert found.rejection_reason() is None
    for name, true in SENSOR.items():
        assert found.parameters.values_by_name[name] == pytest.approx(true, rel=0.1)
        low, high = found.confidence_intervals[name]
        assert low < true < high
    assert found.facts["motor_inertia"][0] == pytest.approx(ROTOR, rel=0.05)
    assert found.facts["arm_inertia"][0] == pytest.approx(2.5, rel=0.01)
    assert found.facts["gravity_cos"][0] == pytest.approx(110.0, rel=0.01)
    assert not any("--motor-inertia" in note for note in found.notes)


def test_a_sensor_that_contradicts_the_motor_is_said(tmp_path, capsys):
    """The motor current of this log grows with a load that drives the motor, as with a wrong torque
    constant."""
    path, out = tmp_path / "drive.toml", tmp_path / "out.toml"
    path.write_text(format_parameter_file(size_32_file()), encoding="utf-8")
    words = ["fit", "log", JOINT_LOG, "--params", path, "--torque-constant", "0.21", "--out", out]
    assert cli.main([str(word) for word in words]) == 1
    said = capsys.readouterr().err
    assert "the friction falls with the load: check --torque-constant" in said
    assert "load_loss_back ended on a bound of its interval; " in said
    assert not out.exists()


def test_the_torque_at_the_joint_alone(tmp_path, capsys):
    path = save_log(tmp_path / "log.csv", joint_columns(), "time", "q", "dq", "link_torque")
    line = refused_line(capsys, "fit", "log", path, "--drive", "CSG-32-100")
    assert "has the torque at the joint, link_torque" in line
    assert "--torque-at joint" in line
    words = ["fit", "log", str(path), "--drive", "CSG-32-100", "--torque-at", "joint", "--json"]
    assert cli.main(words) == 0
    said = json.loads(capsys.readouterr().out)
    for name in (*SENSOR, "K1", "hysteresis_loss"):
        assert any("does not determine" in line and name in line for line in said["warnings"])
    assert said["facts"]["arm_inertia"]["value"] == pytest.approx(2.5, rel=0.01)
    assert said["facts"]["gravity_cos"]["value"] == pytest.approx(110.0, rel=0.01)
    assert "friction_viscous needs the torque or the current of the motor" in refused_line(
        capsys, *words[:-1], "--free", "friction_viscous"
    )


def test_a_sensor_and_the_angle_of_the_motor_give_the_stiffness(tmp_path):
    """Stiffness is fitted to sensor and motor angle, without motor torque; the loads of the log are between
    T1 and T2."""
    log_columns, file = sensor_log(), size_32_file()
    load = 2.5 * np.gradient(log_columns["dq"], 0.01) + 110.0 * np.cos(log_columns["q"])
    wind_up = HarmonicDriveSpring.tabulate(file.values).curve.odd_inverse(load)
    log_columns["q_motor"] = -100.0 * (log_columns["q"] + wind_up)
    path = save_log(tmp_path / "log.csv", log_columns, "time", "q", "q_motor", "link_torque")
    found = log.fit([path], file.with_values({"K2": 9e4}, "user", "start"), ["K2"], torque_at="joint")
    assert found.solution.values["K2"] == pytest.approx(file.values.K2, rel=0.02)


def test_a_controller_that_states_motor_torques_at_the_joint(tmp_path):
    """Motor torque times the ratio includes friction; a sensor behind the drive does not."""
    log_columns = sensor_log()
    at_joint = log_columns | {"link_torque": 100.0 * CONSTANT * log_columns["i"]}
    path = save_log(tmp_path / "log.csv", at_joint, "time", "q", "dq", "link_torque")
    found = log.fit([path], size_32_file(), torque_at="joint")
    assert found.parameters.values_by_name["friction_viscous"] == pytest.approx(0.00134, rel=0.02)
    assert found.facts["inertia"][0] == pytest.approx(2.5 + ROTOR * 1e4, rel=0.1)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["LOG", "LOG"], "has the samples of"),
        (["LOG", "--torque-constant", "0.021"], "motor torque times ratio is 0.103 times link_torque"),
        (["LOG", "--torque-constant", "2.1"], "; check --torque-constant = 2.1 N.m/A"),
        (["LOG", "--torque-constant", "-0.21"], "reverse the sign of link_torque, or of the motor's torque"),
    ],
)
def test_a_log_that_misleads_is_refused(tmp_path, capsys, words, text):
    path = save_log(tmp_path / "log.csv", sensor_log(), "time", "q", "dq", "i", "link_torque")
    constant = [] if "--torque-constant" in words else ["--torque-constant", "0.21"]
    files = [path if word == "LOG" else word for word in words]
    line = refused_line(capsys, "fit", "log", *files, *constant, "--drive", "CSG-32-100")
    assert text in line


@pytest.mark.parametrize(
    ("names", "options", "text"),
    [
        (("time", "q", "dq", "i"), ["--torque-constant", "0.021"], "check --torque-constant = 0.021 N.m/A"),
        (
            ("time", "q", "dq", "i", "link_torque"),
            ["--torque-constant", "0.21", "--columns", "gravity=link_torque"],
            "the column gravity depends on acceleration or sense of the motion",
        ),
    ],
)
def test_a_doubtful_fit_is_written_by_force_only(tmp_path, capsys, names, options, text):
    path, out = save_log(tmp_path / "log.csv", sensor_log(), *names), tmp_path / "out.toml"
    words = ["fit", "log", str(path), "--drive", "CSG-32-100", *options, "--out", str(out)]
    assert cli.main(words) == 1
    assert text in capsys.readouterr().err
    assert not out.exists()
    assert cli.main([*words, "--force"]) == 0
    assert out.exists()


@pytest.mark.parametrize(("ratio", "K1"), [(100.0, 67e3), (101.0, 67e3), (50.0, 54e3)])
def test_a_stated_ratio_selects_the_row_of_the_catalogue(tmp_path, ratio, K1):
    path = save_log(tmp_path / "log.csv", joint_columns(), "time", "q", "dq", "link_torque")
    found = log.fit([path], torque_at="joint", drive="CSG-32-100", ratio=ratio)
    assert (found.parameters.values.ratio, found.parameters.values.K1) == (ratio, K1)
    with pytest.raises(ValueError, match="ratio = 70 is not in the catalogue for CSG-32"):
        log.fit([path], torque_at="joint", drive="CSG-32-100", ratio=70.0)


def test_german_headings(tmp_path, capsys):
    log_columns = sensor_log()
    path = save_log(tmp_path / "log.csv", log_columns, "time", "q", "dq", "i")
    text = path.read_text()
    assert text.startswith("time [s],q [rad],dq [rad/s],i [A]")
    named = "Zeit [s],Winkel [rad],Geschwindigkeit [rad/s],Strom [A]"
    path.write_text(text.replace("time [s],q [rad],dq [rad/s],i [A]", named))
    words = ["fit", "log", path, "--drive", "CSG-32-100", "--torque-constant", "0.21"]
    assert cli.main([str(word) for word in words]) == 0
    assert "friction_viscous" in capsys.readouterr().out
    path.write_text(text.replace("i [A]", "Strom"))
    assert "the file has time, q, dq, strom; a heading needs a unit" in refused_line(capsys, *words)


def test_a_long_log_starts_from_a_part_of_its_samples(monkeypatch, tmp_path):
    """The first fit uses every fourth sample; the second fit starts from it and gives the same result."""
    path = save_log(tmp_path / "log.csv", sensor_log(), "time", "q", "dq", "i", "link_torque")
    whole = log.fit([path], size_32_file(), torque_constant=CONSTANT)
    monkeypatch.setattr(log_friction, "FIRST_FIT_SAMPLE_COUNT", 80)
    found = log.fit([path], size_32_file(), torque_constant=CONSTANT)
    for name in SENSOR:
        assert found.solution.values[name] == pytest.approx(whole.solution.values[name], rel=1e-3)
        deviation = whole.solution.relative_deviations[name]
        assert found.solution.relative_deviations[name] == pytest.approx(deviation, rel=1e-2)


@pytest.mark.slow
def test_a_log_of_300_000_rows_takes_seconds(tmp_path):
    """Reading and fitting a log of 300 000 rows takes seconds; it took 11 s, mostly for reading and for
    repeated fits to all samples."""
    time, rng = np.arange(300_000) * 1e-3, np.random.default_rng(0)
    dq = 2.0 * np.pi * (0.22 * np.cos(2.0 * np.pi * 0.31 * time) + 0.33 * np.cos(2.0 * np.pi * 0.83 * time))
    current = np.sign(dq) + 0.6 * dq + 0.02 * rng.standard_normal(time.size)
    path = save_log(tmp_path / "log.csv", {"time": time, "dq": dq, "i": current}, "time", "dq", "i")
    begin = process_time()
    log.fit([path], size_32_file(), torque_constant=CONSTANT)
    assert process_time() - begin < 8.0


# friction over the turn of the motor

RIPPLE = json.loads((JOINT_LOG.parent / "friction_over_motor_angle_50_1.json").read_text())
"""Measured friction [N.m] at the output over one motor turn, both senses, of a 50:1 strain-wave gear."""


def ripple_columns(senses):
    """Table of the measured friction at the motor at three speeds, with a viscous part of 1e-4 N.m.s/rad."""
    angles = 2.0 * np.pi * np.arange(RIPPLE["nbins"]) / RIPPLE["nbins"]
    rows = []
    for sense, name in senses.items():
        for speed in (0.5, 1.0, 2.0):
            torque = np.array(RIPPLE[name]) / 50.0 + 1e-4 * 50.0 * speed
            rows.append(
                np.stack([sense * torque, np.full(angles.size, sense * speed), angles + 2.0 * np.pi], axis=1)
            )
    return np.concatenate(rows).T


@pytest.mark.parametrize(
    ("senses", "mean", "amplitudes"),
    [
        ({1.0: "map_pos"}, 8.0, {1: 1.6, 2: 1.0}),
        ({1.0: "map_pos", -1.0: "map_neg"}, 7.6, {1: 1.3, 2: 0.97}),
    ],
)
def test_a_measured_ripple_is_found(tmp_path, senses, mean, amplitudes):
    """Mean and amplitudes of the first and second harmonic per turn [N.m] at the output; both senses differ
    by a tenth."""
    path = tmp_path / "ripple.csv"
    heads = [("tau", "N.m"), ("dq", "rad/s"), ("q_motor", "rad")]
    path.write_text(columns.format_table(heads, [*ripple_columns(senses)]))
    found = log.fit([path], robot_log.start().with_values({"ratio": -50.0}, "user", "measured"))
    values = found.parameters.values_by_name
    waves = np.mean([np.fft.rfft(RIPPLE[name]) for name in senses.values()], axis=0) / RIPPLE["nbins"]
    assert 50.0 * values["friction_coulomb"] == pytest.approx(mean, rel=0.05)
    for n, rough in amplitudes.items():
        assert 50.0 * values[f"friction_{n}"] == pytest.approx(2.0 * abs(waves[n]), rel=1e-3)
        assert 50.0 * values[f"friction_{n}"] == pytest.approx(rough, rel=0.03)
        phase = np.angle(waves[n]) + 0.5 * np.pi
        assert math.remainder(values[f"friction_{n}_phase"] - phase, 2.0 * np.pi) == pytest.approx(
            0.0, abs=1e-3
        )
        assert found.facts[f"friction_{n}"][1] == "N.m"
    assert found.rejection_reason() is None


def rippled_log(ratio, **ripple):
    """Log of a swing whose friction has a ripple, by the FMU's law."""
    log_columns, rng = joint_columns(), np.random.default_rng(0)
    log_columns = {name: log_columns[name] for name in ("time", "q", "dq")}
    drive = size_32_file().with_values(SENSOR | ripple | {"ratio": abs(ratio)}, "user", "made").values
    q, dq = 0.3 * log_columns["q"], 0.3 * log_columns["dq"]
    load = 2.5 * np.gradient(dq, 0.01) + 110.0 * np.cos(q)
    ripple_torque, _ = friction_ripple(drive, ratio * q)
    positive, negative = friction_limits(drive, abs(ratio) * dq, -load, ripple_torque=ripple_torque)
    torque = np.where(dq > 0.0, positive, -negative) + viscous_torque(drive, abs(ratio) * dq)
    current = (torque + load / abs(ratio) + ROTOR * abs(ratio) * np.gradient(dq, 0.01)) / CONSTANT
    return {"time": log_columns["time"], "q": q, "dq": dq, "i": current + 0.02 * rng.standard_normal(q.size)}


@pytest.mark.parametrize("ratio", [-100.0, 100.0])
def test_a_ripple_in_a_log_is_found_by_the_angle_of_the_joint(tmp_path, ratio):
    ripple = {"friction_1": 0.03, "friction_1_phase": 0.7, "friction_2": 0.02, "friction_2_phase": -1.2}
    path = save_log(tmp_path / "log.csv", rippled_log(ratio, **ripple), "time", "q", "dq", "i")
    file = size_32_file().with_values({"ratio": ratio}, "user", "made")
    found = log.fit([path], file, torque_constant=CONSTANT)
    values = found.parameters.values_by_name
    for n in (1, 2):
        assert values[f"friction_{n}"] == pytest.approx(ripple[f"friction_{n}"], rel=0.1)
        assert values[f"friction_{n}_phase"] == pytest.approx(ripple[f"friction_{n}_phase"], abs=0.1)
    assert values["friction_coulomb"] == pytest.approx(0.116, rel=0.1)


def test_the_deviation_of_the_rotor_inertia_widens_intervals_beside_a_ripple(tmp_path, monkeypatch):
    """As without a ripple: the fit is repeated with the ripple, and its intervals are printed."""
    log_columns = rippled_log(-100.0, friction_1=0.03, friction_1_phase=0.7)
    log_columns["q_motor"] = -100.0 * log_columns["q"]
    path = save_log(tmp_path / "log.csv", log_columns, "time", "q", "dq", "i", "q_motor")
    names, widths = ("friction_coulomb", "friction_viscous", "load_loss"), []
    for deviation in (1e-9, 0.3):
        monkeypatch.setattr(log, "_fit_rotor_inertia", lambda *_, d=deviation: (ROTOR, d * ROTOR))
        found = log.fit([path], size_32_file(), names, torque_constant=CONSTANT)
        assert "friction_1" in found.facts
        low, high = found.confidence_intervals["load_loss"]
        widths.append(math.log(high / low))
    assert widths[1] > 1.3 * widths[0]


def test_no_ripple_is_found_where_there_is_none(tmp_path):
    path = save_log(tmp_path / "log.csv", rippled_log(-100.0), "time", "q", "dq", "i")
    found = log.fit([path], size_32_file(), torque_constant=CONSTANT)
    assert "friction_1" not in found.facts
    assert found.parameters.values_by_name["friction_1"] == 0.0
