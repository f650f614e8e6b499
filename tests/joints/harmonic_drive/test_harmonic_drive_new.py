"""Drives from a catalogue name or a catalogue row, compared with all published values."""

import csv
import json
import math
from importlib.resources import files

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.efficiency import (
    compute_hysteresis_loss,
    compute_lost_motion,
    drives_with_friction,
    make_test_rig,
    open_fmu_test_rig,
    ratio_and_friction_parameters,
)
from jointfmu_tools.joints.harmonic_drive.fit.drive import compute_wind_up
from jointfmu_tools.joints.harmonic_drive.friction import CATALOGUE_MOTOR_SPEED, compute_rated_efficiency
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_parameter_file

ROW = ["--ratio", "100", "--K1", "4700", "--K2", "6100", "--K3", "7100", "--T1", "2", "--T2", "6.9"]


@pytest.mark.slow
def test_a_row_keeps_its_angles(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    per_arcmin = 4700.0 * math.pi / 10800.0
    words = ["--K1", f"{per_arcmin:.12g}N.m/arcmin", "--rated-torque", "7.8", "--source", "page 7"]
    words += ["--law", "hu2023"]
    assert cli.main(["new", "harmonic-drive", *ROW, *words, "--out", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    file = load_parameter_file(path)
    assert (file.name, file.values.ratio, file.values.rated_torque) == ("page 7", -100.0, 7.8)
    assert file.origins["rated_torque"] == "catalogue"
    angle = 2.0 / 4700.0 + 4.9 / 6100.0
    assert float(compute_wind_up(file.values, 6.9)) == pytest.approx(angle, rel=0.01)
    assert "angle_error_T2" in found["facts"]
    assert found["warnings"]


def test_a_row_is_its_three_lines(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    words = ["--K1", "0.47", "--K2", "0.61", "--K3", "7100N.m/rad", "--stiffness-unit", "10^4 N.m/rad"]
    words += ["--T1", "0.203943kgf.m", "--hysteresis", "1"]
    assert cli.main(["new", "harmonic-drive", *ROW, *words, "--out", str(path), "--json"]) == 0
    assert "rated_torque" in json.loads(capsys.readouterr().out)["warnings"][0]
    file = load_parameter_file(path)
    d = file.values
    np.testing.assert_allclose([d.K1, d.K2, d.K3], [4700.0, 6100.0, 7100.0], rtol=1e-15)
    assert pytest.approx(0.203943 * 9.80665) == d.T1
    assert d.hysteresis_loss == pytest.approx(math.radians(1.0 / 60.0))
    assert (d.rated_torque, file.origins["rated_torque"]) == (6.9, "estimate")
    assert d.max_torque == pytest.approx(4.0 * 6.9)


def test_a_drive_by_its_name(capsys, tmp_path):
    path = tmp_path / "my.toml"
    assert cli.main(["new", "harmonic-drive", "--catalogue", "CSG-17-100", "--out", str(path)]) == 0
    out, err = capsys.readouterr()
    assert "ratio              -100  circular spline fixed, output the flexspline: it turns against" in out
    assert "limit for the actuators CHA-17A" in out
    assert "lost_motion" in out
    assert "estimated, not in the catalogue row: d" in err
    file = load_parameter_file(path)
    d = file.values
    assert (file.law, file.name, d.ratio) == ("catalogue", "CSG-17-100", -100.0)
    assert (d.K1, d.K2, d.K3, d.T1, d.T2) == (1e4, 1.4e4, 1.6e4, 3.9, 12.0)
    assert (d.rated_torque, d.max_torque, d.hysteresis_loss) == (31.0, 70.0, 0.0)
    assert file.origins["rated_torque"] == "catalogue"
    assert set(file.origins) == set(file.values_by_name)


def test_what_is_stated_takes_the_place_of_the_catalogue(tmp_path):
    path = tmp_path / "my.toml"
    words = ["--catalogue", "CSF-25-80-2UH", "--rated-torque", "63", "--out", str(path)]
    assert cli.main(["new", "harmonic-drive", *words]) == 0
    file = load_parameter_file(path)
    assert (file.values.rated_torque, file.origins["rated_torque"]) == (63.0, "user")
    assert file.origins["max_torque"] == "estimate"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--catalogue", "CSG-17-60"], "nearest are CSG-17-50, CSG-17-80, CSG-17-100"),
        (["--catalogue", "CSG-17-100", "--K1", "1"], "K1 = 1 N.m/rad winds up"),
        (["--ratio", "100", "--K1", "1"], "--K2, --K3, --T1, --T2 missing"),
    ],
)
def test_a_drive_that_is_not_known_is_refused(capsys, words, text):
    assert text in refused_line(capsys, "new", "harmonic-drive", *words)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--K1", "0"], "--K1 = '0' is outside (0, inf)"),
        (["--K1", "9000"], "K2 = 6100 N.m/rad is outside [9000, inf)"),
        (["--T1", "8"], "T2 = 6.9 N.m is outside (8, inf)"),
        (["--K1", "0.47", "--K2", "0.61", "--K3", "0.71"], "likely they are in 1e4 N.m/rad"),
        (["--K1", "4700N"], "--K1 = '4700N': unit 'N' measures another quantity than 'N.m/rad'"),
    ],
)
def test_a_row_that_cannot_be_is_refused(capsys, words, text):
    assert text in refused_line(capsys, "new", "harmonic-drive", *ROW, *words)


@pytest.mark.parametrize(
    ("words", "ratio"),
    [
        ([], -80.0),
        (["--fixed", "circular-spline"], -80.0),
        (["--fixed", "flexspline"], 81.0),
        (["--fixed", "wave-generator"], 81.0 / 80.0),
        (["--ratio", "-50"], -50.0),
    ],
)
def test_what_is_fixed_decides_the_ratio(capsys, words, ratio):
    """Tooth numbers: 2 R on the flexspline, 2 more on the circular spline; the friction is
    published for R."""
    asked = ["new", "harmonic-drive", "--catalogue", "CSG-17-80", "--starting-torque", "0.029"]
    if "wave-generator" in words:
        assert "has no effect with --fixed wave-generator" in refused_line(capsys, *asked, *words)
        asked = asked[:4]
    assert cli.main([*asked, *words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["parameters"]["ratio"] == pytest.approx(ratio, rel=1e-15)
    assert found["facts"]["ratio"]["value"] == pytest.approx(ratio, rel=1e-15)
    assert (found["parameters"]["friction_coulomb"] == 0.0) == ("wave-generator" in words)


def test_a_ratio_with_its_sign_leaves_nothing_to_be_fixed(capsys):
    asked = ("new", "harmonic-drive", "--catalogue", "CSG-17-80", "--ratio=-80", "--fixed", "flexspline")
    assert "--fixed flexspline with --ratio = -80, whose sign is stated" in refused_line(capsys, *asked)


SPRING = MODELS["HarmonicDriveSpring"]
ARCMIN = math.pi / 10800.0
SCATTER = 0.03
"""Scatter of a published efficiency [1]: the catalogue states +-3 points."""
DRIVES = [item for item in catalogue.list_drives() if "rated_torque" in item.known_numbers]
PRINTED = {item.joint_name: item for item in drives_with_friction()}
TEXT = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_zd.csv"
OTHER = list(csv.DictReader(TEXT.read_text(encoding="utf-8").splitlines()))
"""Drives of another maker, in sizes and ratios of the catalogue."""


def is_printed(item, column):
    return item.known_numbers[column].value_origin == "catalogue"


def made(name, **options):
    return NEW_JOINT_COMMAND.make_joint(
        dict.fromkeys(o.name for o in NEW_JOINT_COMMAND.command_options) | {"catalogue": name} | options
    ).parameter_file


# the loop


@pytest.mark.slow
@pytest.mark.parametrize("size", sorted({item.joint_name.rsplit("-", 1)[0] for item in DRIVES}))
def test_lost_motion_of_every_drive_is_below_the_published_limit(size):
    """Prediction from stiffness and rated torque only; hysteresis at its limit uses up to 15 % of it (tested
    with one ratio of each size).

    No row needs a play of its own. The largest is 0.89 of the limit, so that a first line softer by 11 %,
    or a limit at 5 % of rated torque, would break it.
    """
    for item in (one for one in DRIVES if one.joint_name.rsplit("-", 1)[0] == size):
        file = made(item.joint_name)
        plain = HarmonicDriveSpring.tabulate(file.values)
        least = 0.04 * file.values.rated_torque
        assert compute_lost_motion(plain) == pytest.approx(2.0 * least / file.values.K1, rel=1e-9)
        assert compute_lost_motion(plain) < item.known_numbers["lost_motion"].si_value
    assert compute_hysteresis_loss(plain) == pytest.approx(0.0, abs=1e-15)
    most = item.known_numbers["hysteresis_loss"].si_value
    open_ = HarmonicDriveSpring.tabulate(file.with_values({"hysteresis_loss": most}, "user", "limit").values)
    assert compute_hysteresis_loss(open_) == pytest.approx(most, rel=1e-9)
    assert (
        0.85 * compute_lost_motion(plain)
        < compute_lost_motion(open_)
        <= (1.0 + 1e-9) * compute_lost_motion(plain)
    )


def test_lost_motion_is_midway_in_the_loop_through_rated_torque():
    """Lost motion is the mean angle of both branches at +4 % of rated torque minus the mean at -4 %."""
    spring = HarmonicDriveSpring.tabulate(made("CSG-17-100", hysteresis="1").values)
    rated = spring.joint.rated_torque
    steps = rated * np.concatenate([np.linspace(1.0, -1.0, 51), np.linspace(-0.96, 1.0, 50)])
    memory, angles = spring.advance_torque(rated, spring.initial_history())[1], []
    for torque in steps:
        out, memory = spring.advance_torque(torque, memory)
        angles.append(float(out["phi_rel"]))
    passed = list(zip(angles, steps / rated, strict=True))
    at = {sign: [angle for angle, part in passed if np.isclose(part, 0.04 * sign)] for sign in (1, -1)}
    assert [len(both) for both in at.values()] == [2, 2]
    assert compute_lost_motion(spring) == pytest.approx(np.mean(at[1]) - np.mean(at[-1]), rel=1e-9)


def test_lost_motion_counts_play_and_a_loop_is_what_it_was_made_for():
    file = made("CSG-17-100", hysteresis="0.8")
    spring = HarmonicDriveSpring.tabulate(file.values)
    assert compute_hysteresis_loss(spring) == pytest.approx(0.8 * ARCMIN, rel=1e-9)
    plain = made("CSG-17-100").values
    loose = HarmonicDriveSpring.tabulate(
        made("CSG-17-100").with_values({"lost_motion": 1e-4}, "user", "x").values
    )
    found = compute_lost_motion(loose) - compute_lost_motion(HarmonicDriveSpring.tabulate(plain))
    assert found == pytest.approx(1e-4, rel=1e-3)  # tanh(4) is 0.9993


@pytest.mark.parametrize("row", OTHER, ids=lambda row: f"{row['size']}-{row['ratio']}")
def test_another_maker_prints_the_same_torques_and_no_less_lost_motion(row):
    """Another maker's torques are within 2 % (rounding) of the estimates for CSF, 1/1.3 times CSG. The
    computed lost motion is below 0.7 of the one that this maker prints."""
    drive = made(f"CSF-{row['size']}-{row['ratio']}").values
    assert drive.rated_torque == pytest.approx(float(row["rated_Nm"]), rel=0.02)
    assert drive.max_torque == pytest.approx(float(row["repeated_peak_Nm"]), rel=0.02)
    assert (
        compute_lost_motion(HarmonicDriveSpring.tabulate(drive))
        < 0.7 * float(row["lost_motion_arcmin"]) * ARCMIN
    )


# friction of the drives of which it is printed


@pytest.mark.parametrize("item", PRINTED.values(), ids=PRINTED)
def test_a_printed_drive_has_its_friction(item):
    """Starting, running and back-driving torque and efficiency agree, by construction.

    The efficiency fixes load_loss, the back-driving torque load_loss_back, or both where it is alone, if it
    does not ask for less than nothing. One share for both senses was 3 to 11 % off.
    """
    file, printed = made(item.joint_name), item.known_numbers
    drive = make_test_rig(SPRING, file)
    back, start = printed["back_driving_torque"].si_value, printed["starting_torque"].si_value
    assert drive.starting_torque() == pytest.approx(start, rel=1e-9)
    assert drive.motor_torque(CATALOGUE_MOTOR_SPEED, 0.0) == pytest.approx(
        printed["running_torque"].si_value, rel=1e-9
    )
    found = drive.back_driving_torque(10.0 * back)
    if is_printed(item, "efficiency"):
        rated = printed["rated_torque"].si_value
        assert drive.efficiency(CATALOGUE_MOTOR_SPEED, rated) == pytest.approx(
            printed["efficiency"].si_value, rel=1e-9
        )
        assert compute_rated_efficiency(file.values) == pytest.approx(
            printed["efficiency"].si_value, rel=1e-12
        )
        assert found == pytest.approx(back, rel=1e-6)
    else:
        assert found == pytest.approx(max(back, printed["ratio"].si_value * start), rel=1e-6)
        assert found == pytest.approx(back, rel=0.05)
    kinds = {name: file.origins[name] for name in ("friction_coulomb", "friction_viscous", "load_loss")}
    assert kinds["friction_coulomb"] == "catalogue"
    loss = "derived" if is_printed(item, "efficiency") else "estimate"
    assert kinds["friction_viscous"] == kinds["load_loss"] == loss


@pytest.mark.parametrize("name", [n for n, item in PRINTED.items() if is_printed(item, "efficiency")])
def test_efficiency_at_rated_torque_is_predicted_without_it(name):
    """The efficiency predicted from starting, running and back-driving torque alone is 1.5 to 5.2 points
    above the published value.

    Beyond the catalogue's own scatter of 3 points for two of four; no load_loss is 4.7 to 8.9 points off.
    """
    numbers = {k: v for k, v in PRINTED[name].known_numbers.items() if k != "efficiency"}
    without = type(PRINTED[name])(name, numbers)
    file = made(name).with_values(ratio_and_friction_parameters(without), "user", "without efficiency")
    drive, rated = make_test_rig(SPRING, file), numbers["rated_torque"].si_value
    published = PRINTED[name].known_numbers["efficiency"].si_value
    missed = drive.efficiency(CATALOGUE_MOTOR_SPEED, rated) - published
    assert 0.0 < missed < 2.0 * SCATTER
    guess = make_test_rig(SPRING, file.with_values({"load_loss": 0.0}, "user", "guess"))
    assert missed < 0.7 * (guess.efficiency(CATALOGUE_MOTOR_SPEED, rated) - published)


def test_the_fmu_has_the_friction_of_every_printed_drive(native):
    """The FMU has starting torque, back-driving torque and efficiency of the Python drive."""
    for item in PRINTED.values():
        own, back = (
            make_test_rig(SPRING, made(item.joint_name)),
            item.known_numbers["back_driving_torque"].si_value,
        )
        with open_fmu_test_rig(
            native / "fmi2" / "HarmonicDriveSpring.fmu", ratio_and_friction_parameters(item)
        ) as drive:
            assert drive.starting_torque() == pytest.approx(own.starting_torque(), rel=1e-9)
            # |tau| is smooth over a hundredth of the rated torque, which is the FMU's own
            assert drive.back_driving_torque(10.0 * back) == pytest.approx(
                own.back_driving_torque(10.0 * back), rel=1e-3
            )
            rated = item.known_numbers["rated_torque"].si_value
            assert drive.efficiency(CATALOGUE_MOTOR_SPEED, rated) == pytest.approx(
                own.efficiency(CATALOGUE_MOTOR_SPEED, rated), rel=1e-6
            )


# a drive from its catalogue


def test_what_is_stated_makes_the_friction(tmp_path):
    path = tmp_path / "my.toml"
    words = ["--catalogue", "CSG-17-50", "--starting-torque", "30mN.m", "--running-torque", "0.05"]
    words += ["--efficiency", "0.7", "--out", str(path)]
    assert cli.main(["new", "harmonic-drive", *words]) == 0
    drive = load_parameter_file(path).values
    assert drive.friction_coulomb == pytest.approx(0.03)
    assert drive.friction_viscous == pytest.approx(0.02 / CATALOGUE_MOTOR_SPEED)
    assert compute_rated_efficiency(drive) == pytest.approx(0.7)
    other = made("RT1-H-17-100", starting_torque="0.04", back_driving_torque="5").values
    assert other.load_loss_back == pytest.approx(1.0 - 100.0 * 0.04 / 5.0)
    both = made("CSG-17-50", starting_torque="0.03", efficiency="0.7", back_driving_torque="2").values
    assert both.load_loss_back == pytest.approx(1.0 - 50.0 * 0.03 / 2.0)
    assert compute_rated_efficiency(both) == pytest.approx(0.7)


def test_lost_motion_is_told_beside_its_limit(capsys):
    """The command prints lost motion and its limit: below the limit with the catalogue's stiffness, above it
    with a softer drive."""
    for words, place in (([], "below"), (["--K1", "20000"], "above")):
        assert cli.main(["new", "harmonic-drive", "--catalogue", "CSG-25-100", *words]) == 0
        assert f"; {place} 0.0002909 rad (1 arcmin): limit" in capsys.readouterr().out


START = ("--starting-torque", "0.03")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--motor-drag", "-1"], "--motor-drag = '-1' is outside [0, inf) N.m"),
        (["--motor-drag", "1 N"], "unit 'N' measures another quantity than 'N.m'"),
        (["--temperature", "318"], "is read as 318 degC, outside [-80, 200] degC; if it is in K, write 318K"),
        (["--temperature", "warm"], "is not a temperature; expected 45, 45degC or 318.15K"),
        (["--efficiency", "1.5"], "--efficiency = '1.5' is outside [0.1, 1)"),
        ([*START, "--efficiency", "70"], "--efficiency = '70' is outside [0.1, 1); write percent as 70%"),
        (["--efficiency", "0.03"], "--efficiency = '0.03' is outside [0.1, 1)"),
        (["--hysteresis", "60"], "plausible are 0.01 to 20 arcmin; if it is in arcsec, write 60arcsec"),
        ([*START, "--back-driving-torque", "5000"], "is above the rated torque, 21 N.m; check the unit"),
        (["--starting-torque", "0.03N"], "unit 'N' measures another quantity than 'N.m'"),
        ([*START, "--running-torque", "0.02"], "--running-torque = 0.02 N.m is outside [0.03, inf) N.m"),
        (
            [*START, "--back-driving-torque", "1.4"],
            "--back-driving-torque = 1.4 N.m is outside [1.5, inf) N.m",
        ),
        ([*START, "--efficiency", "0.95"], f"--efficiency = 0.95 is outside (0, {1 / (1 + 1.5 / 21):.6g}]"),
        (["--efficiency", "0.9"], "--efficiency = 0.9 is outside (0, 0.8"),
        (
            ["--catalogue", "RT1-H-17-100", "--starting-torque", "0.06"],
            "--running-torque = 0.051 N.m is outside",
        ),
    ],
)
def test_friction_that_cannot_be_is_refused(capsys, words, text):
    assert text in refused_line(capsys, "new", "harmonic-drive", "--catalogue", "CSG-17-50", *words)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (
            ["--starting-torque", "50"],
            "--starting-torque = '50' is read as 50 N.m at the motor: it leaves an ",
        ),
        (
            ["--motor-drag", "20"],
            "--motor-drag = '20' is read as 20 N.m at the motor: it leaves an efficiency of ",
        ),
        (
            ["--starting-torque", "500"],
            "--starting-torque = '500' is read as 500 N.m, plausible are 0.0001 to 100",
        ),
    ],
)
def test_friction_that_eats_the_torque_is_asked_about(capsys, words, text):
    line = refused_line(capsys, "new", "harmonic-drive", "--catalogue", "CSG-17-100", *words)
    assert text in line
    if "leaves" in text:
        assert "check the unit, as in 50mN.m" in line
