"""Edges of a catalogue drive: lines without smooth corners, which are said to have kinks, and the ratio."""

import numpy as np
import pytest
from conftest import Fmu, here_alone, refused_line
from jointfmu_fmu_src.building import build
from jointfmu_tools import cli

import jointfmu
from jointfmu.joints.harmonic_drive.given import CORNER, SHARPEST

DRIVE = "CSG-25-100"


def angle(row, T):
    """Of the catalogue's three lines."""
    first = row["T1"] / row["K1"]
    second = first + (row["T2"] - row["T1"]) / row["K2"]
    return np.interp(
        T, [0.0, row["T1"], row["T2"], 2.0 * row["T2"]], [0.0, first, second, second + row["T2"] / row["K3"]]
    )


def test_without_corners_the_printed_angles_are_met():
    smooth, sharp = jointfmu.drive(DRIVE), jointfmu.drive(DRIVE, corner=0)
    row, T = sharp.values, np.array([14.0, 48.0, 87.0])
    # at a corner a smooth step of half-width c leaves 3/32 c of the jump in compliance: 1e-7 of the angle
    np.testing.assert_allclose(sharp.wind_up(T), angle(row, T), rtol=0.1 * SHARPEST)
    assert abs(smooth.wind_up(14.0) / angle(row, 14.0) - 1.0) > 0.01 * CORNER
    every = np.linspace(-90.0, 90.0, 1001)
    np.testing.assert_allclose(sharp.torque(sharp.wind_up(every)), every, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(sharp.stiffness([1.0, 13.99, 14.01, 47.9, 48.1]), [31e3, 31e3, 5e4, 5e4, 57e3])


def test_the_kinks_are_said_and_kept_in_the_file(tmp_path, capsys):
    out = tmp_path / "drive.toml"
    assert cli.main(["new", "harmonic-drive", "--catalogue", DRIVE, "--corner", "0", "--out", str(out)]) == 0
    assert "kinks at T1 and T2" in capsys.readouterr().err
    assert jointfmu.load(out).values["corner"] == 0.0


@pytest.mark.slow
def test_all_flavours_have_the_kinks(tmp_path):
    file = jointfmu.drive(DRIVE, corner=0).file
    T = np.linspace(0.0, 90.0, 181)
    found = []
    with here_alone():
        paths = build(["HarmonicDriveCompliance"], ["fmi2", "fmi3", "python"], file, tmp_path)
    for path in paths:
        found.append(jointfmu.run(path, {"tau": T})["phi_rel"])
        np.testing.assert_allclose(found[-1], angle(file.flat, T), rtol=0.1 * SHARPEST, atol=1e-15)
        np.testing.assert_allclose(found[-1], found[0], rtol=1e-12)
    one = Fmu(tmp_path / "fmi2" / "HarmonicDriveCompliance.fmu").start({"corner": CORNER, "tau": 14.0})
    assert one.get("phi_rel")["phi_rel"] == pytest.approx(jointfmu.drive(DRIVE).wind_up(14.0), rel=1e-9)
    one.free()


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--corner", "-0.1"], "corner"), (["--corner", "0.04", "--law", "hu2023"], "has no corners")],
)
def test_what_is_no_corner(options, said, capsys):
    assert said in refused_line(capsys, "new", "harmonic-drive", "--catalogue", DRIVE, *options)


def test_a_ratio_of_zero_is_refused_and_a_negative_one_taken(capsys):
    asked = ("new", "harmonic-drive", "--catalogue", DRIVE, "--ratio")
    assert "--ratio = 0 is outside (-inf, 0) and (0, inf)" in refused_line(capsys, *asked, "0")
    assert jointfmu.drive(DRIVE, ratio=-100).values["ratio"] == -100.0
    with pytest.raises(ValueError, match=r"ratio = 0 is outside .* allowed are \(-inf, 0\) and \(0, inf\)"):
        jointfmu.drive(DRIVE).with_values(ratio=0.0)
