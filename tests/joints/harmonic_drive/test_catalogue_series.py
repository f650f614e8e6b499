"""Series of the catalogue beside cups and hats: actuators, small sizes, and those of no legible source."""

import csv
import math
from importlib.resources import files

import pytest
from conftest import refused_line
from jointfmu_tools.joints.harmonic_drive import catalogue

import jointfmu

LINES = ("T1", "T2", "K1", "K2", "K3")


def lines(name):
    return [catalogue.find(name).numbers[column].value for column in LINES]


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        # CHA engineering data 1018854, table of torsional stiffness
        ("CHA-14A-30", [2.0, 6.9, 1900.0, 2400.0, 3400.0]),
        ("CHA-32A-50", [29.0, 108.0, 54e3, 78e3, 98e3]),
        ("CHA-58A-160", [168.0, 598.0, 400e3, 610e3, 710e3]),
        # CSF/CSG catalogue p. 50, ratio 1/30
        ("CSF-8-30", [0.29, 0.75, 340.0, 440.0, 540.0]),
        ("CSF-11-30-1U", [0.8, 2.0, 840.0, 1300.0, 1600.0]),
    ],
)
def test_the_printed_lines(name, printed):
    assert lines(name) == printed
    assert {catalogue.find(name).numbers[column].kind for column in LINES} == {"catalogue"}


@pytest.mark.parametrize(
    ("name", "like", "K3"),
    [
        ("FHA-8C-100", "RSF-8B, size 8, ratio 100", 1200.0),
        ("FHA-11C-50", "RSF-11B, size 11, ratio 50", 3200.0),
        ("CSF-8-50", "RSF-8B, size 8, ratio 50", 840.0),
        ("RSF-14B-100", "size 14, ratio 80+", 7100.0),
    ],
)
def test_a_last_line_that_is_not_legible_is_that_of_the_same_lines_below(name, like, K3):
    number = catalogue.find(name).numbers["K3"]
    assert (number.value, number.kind) == (K3, "estimate")
    assert like in number.source


def test_a_last_line_without_such_a_drive_is_the_second():
    number = catalogue.find("RSF-5B-50").numbers["K3"]
    assert (number.value, number.kind) == (140.0, "estimate")


def test_the_limits_of_an_actuator_are_its_own():
    """Its torques are those of the motor, and are not taken from a gear."""
    path = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_accuracy.csv"
    for row in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
        ratio = row["ratio"].replace("50+", "80")
        numbers = catalogue.find(f"CHA-{row['size']}A-{ratio}").numbers
        loss = numbers["hysteresis_loss"]
        assert loss.value == pytest.approx(float(row["hysteresis_below_arcmin"]) * math.pi / 10800.0)
        assert (loss.kind, loss.bound) == ("catalogue", True)
        assert "rated_torque" not in numbers
    assert catalogue.find("HFUC-14-30").numbers["hysteresis_loss"].kind == "estimate"
    assert jointfmu.drive("CHA-14A-30").values["hysteresis_loss"] == 0.0  # a limit is no value


def test_the_wind_up_that_the_maker_computes():
    """CHA engineering data p. 68: T = 60 N.m at T1 = 29, K1 = 6.7e4, K2 = 1.1e5 gives 7.15e-4 rad."""
    sharp = jointfmu.drive("CHA-32A-100", corner=0)
    assert sharp.wind_up(60.0) == pytest.approx(7.15e-4, abs=0.005e-4)


@pytest.mark.parametrize(
    "name", ["CSD-20-100", "SHD-20-100", "SHF-20-100", "CPL-20-100", "FHA-25C-100", "RV-40E-121", "CSF-8-100"]
)
def test_what_no_legible_source_has_is_unknown(name, capsys):
    said = refused_line(capsys, "new", "harmonic-drive", "--catalogue", name)
    assert f"catalogue '{name}' is unknown" in said
