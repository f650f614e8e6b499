"""A harmonic drive from its name in the catalogue or from its row, in the units of catalogues."""

import json
import math

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.harmonic_drive.fit.drive import windup

from jointfmu.parameters import load

ROW = ["--ratio", "100", "--K1", "4700", "--K2", "6100", "--K3", "7100", "--T1", "2", "--T2", "6.9"]


@pytest.mark.slow
def test_a_row_keeps_its_angles(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    per_arcmin = 4700.0 * math.pi / 10800.0
    words = ["--K1", f"{per_arcmin:.12g}N.m/arcmin", "--rated-torque", "7.8", "--source", "page 7"]
    words += ["--law", "hu2023"]
    assert cli.main(["new", "harmonic-drive", *ROW, *words, "--out", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    file = load(path)
    assert (file.name, file.values.ratio, file.values.rated_torque) == ("page 7", -100.0, 7.8)
    assert file.origins["rated_torque"] == "catalogue"
    angle = 2.0 / 4700.0 + 4.9 / 6100.0
    assert float(windup(file.values, 6.9)) == pytest.approx(angle, rel=0.01)
    assert "angle_error_T2" in found["facts"]
    assert found["warnings"]


def test_a_row_is_its_three_lines(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    words = ["--K1", "0.47", "--K2", "0.61", "--K3", "7100N.m/rad", "--stiffness-unit", "10^4 N.m/rad"]
    words += ["--T1", "0.203943kgf.m", "--hysteresis", "1"]
    assert cli.main(["new", "harmonic-drive", *ROW, *words, "--out", str(path), "--json"]) == 0
    assert "rated_torque" in json.loads(capsys.readouterr().out)["warnings"][0]
    file = load(path)
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
    assert "estimates, not of the catalogue's row: d" in err
    file = load(path)
    d = file.values
    assert (file.law, file.name, d.ratio) == ("catalogue", "CSG-17-100", -100.0)
    assert (d.K1, d.K2, d.K3, d.T1, d.T2) == (1e4, 1.4e4, 1.6e4, 3.9, 12.0)
    assert (d.rated_torque, d.max_torque, d.hysteresis_loss) == (31.0, 70.0, 0.0)
    assert file.origins["rated_torque"] == "catalogue"
    assert set(file.origins) == set(file.flat)


def test_what_is_stated_takes_the_place_of_the_catalogue(tmp_path):
    path = tmp_path / "my.toml"
    words = ["--catalogue", "CSF-25-80-2UH", "--rated-torque", "63", "--out", str(path)]
    assert cli.main(["new", "harmonic-drive", *words]) == 0
    file = load(path)
    assert (file.values.rated_torque, file.origins["rated_torque"]) == (63.0, "user")
    assert file.origins["max_torque"] == "estimate"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--catalogue", "CSG-17-60"], "nearest are CSG-17-80, CSG-17-50, CSG-17-30"),
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
        (["--K1", "4700N"], "--K1 = '4700N': unit 'N.m/rad' does not measure what 'N' does"),
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
    """Of teeth: 2 R on the flexspline, 2 more on the circular spline; friction is what is printed for R."""
    asked = ["new", "harmonic-drive", "--catalogue", "CSG-17-80", "--starting-torque", "0.029"]
    if "wave-generator" in words:
        assert "stands with --fixed wave-generator" in refused_line(capsys, *asked, *words)
        asked = asked[:4]
    assert cli.main([*asked, *words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["parameters"]["ratio"] == pytest.approx(ratio, rel=1e-15)
    assert found["facts"]["ratio"]["value"] == pytest.approx(ratio, rel=1e-15)
    assert (found["parameters"]["friction_coulomb"] == 0.0) == ("wave-generator" in words)


def test_a_ratio_with_its_sign_leaves_nothing_to_be_fixed(capsys):
    asked = ("new", "harmonic-drive", "--catalogue", "CSG-17-80", "--ratio=-80", "--fixed", "flexspline")
    assert "--fixed flexspline beside --ratio = -80, whose sign is stated" in refused_line(capsys, *asked)
