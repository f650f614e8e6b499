"""A robot's log to the friction of its drive: round trips, a measured table, refusals."""

import json
import math
from importlib.resources import files

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.common import columns
from jointfmu_tools.inputs.fitting import outcome
from jointfmu_tools.joints.harmonic_drive.fit import hysteresis, log
from jointfmu_tools.joints.harmonic_drive.new import NEW
from matplotlib.figure import Figure
from oracles import robot_log
from oracles.robot_log import CASES, TRUE, fit_log

from jointfmu.joints.harmonic_drive.friction import friction_limits, viscous_torque
from jointfmu.parameters import format_parameter_file, load_parameter_file

TABLE = files("jointfmu_models") / "reference" / "ur5e_base_joint_friction.csv"
NAMES = ["dq=joint_speed_rad_per_s [rad/s]", "tau=motor_torque_Nm [N.m]"]
WARM = "temperature=temperature_degC [degC]"


@pytest.fixture
def drive(tmp_path):
    """A parameter file of a drive like the robot's."""
    given = dict.fromkeys(o.name for o in NEW.options) | {"catalogue": "CSG-25-100", "fixed": "flexspline"}
    path = tmp_path / "drive.toml"
    path.write_text(format_parameter_file(NEW.make_joint(given).file), encoding="utf-8")
    return path


# round trips


@pytest.fixture(autouse=True)
def shorter(monkeypatch):
    """Half of the script's minute, nine periods of the slowest wave."""
    monkeypatch.setattr(robot_log, "TIME", 30.0)


def check_friction(found, undetermined=frozenset()):
    """The fit began 40 % off. Four standard deviations: one in 16 000 by chance."""
    assert found.rejection_reason() is None
    assert not any("--motor-inertia" in note for note in found.notes)
    assert found.facts["held_out"][0] < 0.1 * found.facts["held_out_constant"][0]
    for label, deviation in found.solution.relative_deviations.items():
        assert abs(math.log(found.parameters.values_by_name[label] / TRUE[label])) < 4.0 * deviation
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
def test_an_arm_that_swings_gives_its_friction_back(monkeypatch):
    """Inertias and gravity come beside: the rotor's, which nobody states, from the wind-up. In half a minute
    the arm is slow too seldom for Stribeck's part, which steady speeds determine."""
    monkeypatch.setattr(robot_log, "STEP", 8e-3)
    found = fit_log(robot_log.write_swing, {"torque_constant": robot_log.CONSTANT}, 1)
    check_friction(found, {"friction_stribeck"})
    assert found.facts["motor_inertia"][0] == pytest.approx(robot_log.ROTOR, rel=0.05)
    whole = robot_log.ARM + robot_log.ROTOR * 100.0**2
    assert found.facts["inertia"][0] == pytest.approx(whole, rel=0.02)
    assert found.facts["gravity_cos"][0] == pytest.approx(robot_log.GRAVITY, rel=0.02)
    assert abs(found.facts["gravity_sin"][0]) < 0.02 * robot_log.GRAVITY
    assert [picture.axis_labels[0].split(" [")[0] for picture in found.pictures] == [
        "speed of the joint",
        "time",
        "temperature",
        "torque at the joint",
    ]
    assert {*hysteresis.LOG_PARAMETERS} < {*found.solution.values}


def test_a_load_that_is_measured_gives_the_losses(tmp_path):
    """Steady speeds both ways against and with gravity; two files are one log."""
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
        assert found.parameters.values_by_name[name] == pytest.approx(TRUE[name], rel=1e-3)
    assert any("viscous_temperature_coefficient" in note for note in found.notes)
    figure = Figure(outcome.figure_size(found), layout="constrained")
    outcome.draw_fit(figure, found)
    figure.draw_without_rendering()
    legend, data = figure.axes[0].get_legend().get_window_extent(), figure.axes[0].get_window_extent()
    assert legend.y0 >= data.y1  # beside the curves


# a measured robot


def test_the_base_joint_of_a_robot(drive, tmp_path, capsys):
    """Columns are named with their units, the picture is drawn, the rest is said by name; without names the
    headings' own units, joint_speed_rad_per_s, motor_torque_Nm, temperature_degC, give the same."""
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
    assert "expected --torque-constant [N.m/A] beside it" in refused_line(capsys, *asked)
    assert cli.main([*asked, "--torque-constant", "0.1005"]) == 0
    assert "friction_coulomb" in capsys.readouterr().out


# refusals


def written(path, **given):
    """A log of a joint that swings, with some columns as stated."""
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


TIME = np.linspace(0.0, 8.0, 4001)
BACK = np.where(TIME > 4.0, TIME - 3.0, TIME)
HOLE = np.where(TIME > 4.0, TIME + 3.0, TIME)
FRICTION = 0.05 * np.sign(np.cos(2.0 * TIME)) + 0.04 * np.cos(2.0 * TIME)
MISSING = np.where(np.arange(4001) == 7, np.nan, 0.1)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"q": ("rad", 0.0 * TIME), "dq": ("rad/s", 0.0 * TIME)}, "has no motion"),
        ({"q": None, "dq": ("rad/s", 1.0 + 0.0 * TIME)}, "has one speed alone"),
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
        ([], "the log does not tell the ratio; expected --params FILE of the drive, or --ratio"),
        (["--ratio", "100", "--columns", "speed=x"], "expected NAME=HEADING with one of time, q, dq"),
        (["--ratio", "100", "--columns", "dq=x"], "has no column 'x' for dq; it has time, q, dq, tau"),
        (["--ratio", "100", "--free", "K9"], "'K9' is not a parameter to fit"),
        (["--ratio", "100", "--free", "K1"], "K1 needs the columns q and q_motor beside the time"),
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
"""Torque of the motor with 0.6 kg.m2 at the joint; gravity."""


def test_what_a_light_arm_leaves_open_stays_as_it_is(drive, tmp_path, capsys):
    """Its load is above the least one; what is fitted without being determined is no calibration."""
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
    """Torque that has nothing to do with the motion: status 1, one line, and a file by --force alone."""
    noise = np.random.default_rng(0).standard_normal(4001)
    path, out = written(tmp_path / "log.csv", tau=("N.m", 0.3 + 0.02 * noise)), tmp_path / "out.toml"
    asked = ["fit", "log", str(path), "--params", str(drive), "--out", str(out)]
    assert cli.main(asked) == 1
    assert "the fit does not determine the joint" in capsys.readouterr().err
    assert not out.exists()
    assert cli.main([*asked, "--force"]) == 0
    assert out.exists()
