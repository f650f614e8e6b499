"""A harmonic drive from its catalogue row, in the units of catalogues."""

import json
import math

import pytest
from conftest import refused_line

from jointfmu import cli
from jointfmu.joints.harmonic_drive.fit.drive import windup
from jointfmu.parameters import load

ROW = ["--ratio", "100", "--K1", "4700", "--K2", "6100", "--K3", "7100", "--T1", "2", "--T2", "6.9"]


@pytest.mark.slow
def test_a_row_keeps_its_angles(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    per_arcmin = 4700.0 * math.pi / 10800.0
    words = ["--K1", f"{per_arcmin:.12g}N.m/arcmin", "--rated-torque", "7.8", "--source", "page 7"]
    assert cli.main(["new", "harmonic-drive", *ROW, *words, "--out", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    file = load(path)
    assert (file.name, file.values.ratio, file.values.rated_torque) == ("page 7", 100.0, 7.8)
    assert file.origins["rated_torque"] == "catalogue"
    angle = 2.0 / 4700.0 + 4.9 / 6100.0
    assert float(windup(file.values, 6.9)) == pytest.approx(angle, rel=0.01)
    assert "angle_error_T2" in found["facts"]
    assert found["warnings"]


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
