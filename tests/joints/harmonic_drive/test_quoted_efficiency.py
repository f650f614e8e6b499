"""Efficiency over load and speed beside readings of catalogues; the page of a drive; the study."""

import csv
import math
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import drive_catalogue
import numpy as np
import pytest
from jointfmu_tools.joints.harmonic_drive.efficiency import spring_bench
from jointfmu_tools.joints.harmonic_drive.friction import SPEED
from jointfmu_tools.joints.harmonic_drive.new import NEW
from jointfmu_tools.joints.harmonic_drive.report import beside
from jointfmu_tools.report.figure import OWN, PREDICTED, SET
from jointfmu_tools.report.joint import write_joint_report

from jointfmu.joints import MODELS
from jointfmu.parameters import default

SPRING = MODELS["HarmonicDriveSpring"]
SCATTER = 0.03
"""Of a published efficiency [1]: the catalogue states +-3 points."""
READ = 0.005
"""Of a factor read from a catalogue's curve [1]; two readings of such a curve differ by up to 0.013."""
TEXT = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_efficiency.csv"
CURVES = list(csv.DictReader(TEXT.read_text(encoding="utf-8").splitlines()))


def of(drive, column):
    return [
        (float(r["rpm"] or 0.0), float(r["share"]), float(r[column]))
        for r in CURVES
        if r["drive"] == drive and r[column]
    ]


# efficiency over load and speed


def turned(ratio, rated, **friction):
    """A drive on the bench; its stiffness plays no part."""
    given = {"ratio": ratio, "rated_torque": rated} | friction
    return spring_bench(SPRING, default("harmonic_drive").with_values(given, "user", "read"))


def fixed_by(full, half, share, rated, ratio, rpm):
    """Friction of a drive with an efficiency at rated torque and one at a share of it, at one speed."""
    no_load = (1.0 / half - 1.0 / full) / (1.0 / share - 1.0)
    return {"friction_coulomb": no_load * rated / ratio, "load_loss": 1.0 / full - 1.0 - no_load}


def test_efficiency_over_load_is_the_published_curve():
    """Two of ten points fix both parameters; the others, down to a tenth of rated torque, are predicted.

    A constant efficiency, or one straight in the load, misses by up to 0.7 and 0.2.
    """
    full = {rpm: e for rpm, _, e in of("ATRIAS", "efficiency")}[2000.0]
    factors = {share: k for _, share, k in of("ATRIAS", "factor")}
    assert len(factors) == 10
    drive = turned(50.0, 172.0, **fixed_by(full, full * factors[0.5], 0.5, 172.0, 50.0, 2000.0))
    for share, factor in factors.items():
        assert drive.efficiency(SPEED, share * 172.0) / full == pytest.approx(factor, abs=READ)
    guess = np.interp(0.2, [0.0, 0.5, 1.0], [0.0, factors[0.5], 1.0])
    assert abs(guess - factors[0.2]) > 30.0 * READ


def test_another_reading_of_such_a_curve_is_one_too():
    factors = {share: k for _, share, k in of("M2", "factor")}
    drive = turned(50.0, 96.0, **fixed_by(0.65, 0.65 * factors[0.5], 0.5, 96.0, 50.0, 2000.0))
    for share, factor in factors.items():
        assert drive.efficiency(SPEED, share * 96.0) / 0.65 == pytest.approx(factor, abs=2.0 * READ)


@pytest.mark.parametrize(("drive", "rated"), [("ATRIAS", 172.0), ("M2", 96.0)])
def test_efficiency_over_speed_is_within_the_scatter(drive, rated):
    """Viscous friction from the slowest and the fastest speed predicts the two between."""
    known = {rpm * math.pi / 30.0: e for rpm, _, e in of(drive, "efficiency")}
    (slow, *between, fast), carried = sorted(known), rated / 50.0
    slope = (1.0 / known[fast] - 1.0 / known[slow]) * carried / (fast - slow)
    dry = (1.0 / known[slow] - 1.0) * carried - slope * slow
    found = turned(50.0, rated, friction_viscous=slope, friction_coulomb=dry)
    for speed in between:
        assert found.efficiency(speed, rated) == pytest.approx(known[speed], abs=SCATTER)
    assert len(between) == 2


@pytest.mark.parametrize("drive", ["FR-40-160", "HFUC-20-80", "SHG-20-80"])
def test_part_load_of_worked_examples_from_the_efficiency_at_rated_torque(drive):
    """With load_loss 0.05, as starting and back-driving torque of four drives give it, within 8 points.

    Published curves differ as much between series; an efficiency that load does not change is 7 to 13 off.
    """
    ((_, _, full),) = of(drive, "efficiency")
    ((_, share, factor),) = of(drive, "factor")
    found = turned(100.0, 40.0, load_loss=0.05, friction_coulomb=(1.0 / full - 1.05) * 0.4)
    missed = abs(found.efficiency(SPEED, share * 40.0) / full - factor)
    assert missed < 0.08
    assert missed < 1.0 - factor


# the page of a drive, and the study


def made(name, **options):
    return NEW.run(dict.fromkeys(o.name for o in NEW.options) | {"catalogue": name} | options).file


def rows_of(name, **options):
    return {row.name: row for row in beside(SPRING, made(name, **options))}


def test_the_page_has_what_is_published_of_the_drive(tmp_path):
    """Which number set a parameter is told by the parameter's source; estimates of friction are left out."""
    rows = rows_of("RT1-H-17-100")
    roles = {name: row.role for name, row in rows.items()}
    turned = ("starting_torque", "running_torque", "efficiency", "back_driving_torque")
    set_by_it = (*turned, "wind-up at T1, 3.9 N m")
    assert all(roles[name] == SET for name in set_by_it)
    assert roles["lost_motion"] == PREDICTED
    assert roles["hysteresis_loss"] == OWN
    assert all(rows[name].computed == pytest.approx(rows[name].published, rel=1e-6) for name in turned)
    assert {"lost_motion", "hysteresis_loss"} == {name for name, row in rows.items() if row.bound}
    measured = rows_of("RT1-H-17-100", starting_torque="0.04", back_driving_torque="5")
    assert measured["starting_torque"].role == measured["back_driving_torque"].role == PREDICTED
    assert not {"starting_torque", "efficiency"} & set(rows_of("CSG-17-100"))
    assert beside(SPRING, default("harmonic_drive")) == []
    write_joint_report(tmp_path / "drive.html", replace(made("RT1-H-17-100"), name="Shoulder"))
    page = (tmp_path / "drive.html").read_text(encoding="utf-8")
    assert "Beside what is published of it" in page
    assert "3.06 N m" in page
    write_joint_report(tmp_path / "other.html", default("harmonic_drive"))
    assert "Beside what is published" not in (tmp_path / "other.html").read_text(encoding="utf-8")


def test_the_study_prints_its_tables(capsys):
    for part in ("single_drives", "over_load", "over_speed", "over_both", "worked_examples"):
        getattr(drive_catalogue, part)()
    out = capsys.readouterr().out
    page = (Path(__file__).resolve().parents[3] / "docs" / "harmonic_drive.md").read_text(encoding="utf-8")
    for line in out.splitlines():
        if line.startswith("| RT1-H"):
            assert line in page
