"""Drives of the catalogue: names, numbers, all series, three lines without rounded corners."""

import csv
import json
import math
from importlib.resources import files

import numpy as np
import pytest
from conftest import Fmu, here_alone, refused_line
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools import cli
from jointfmu_tools.joints.harmonic_drive import catalogue

import jointfmu
from jointfmu.joints.harmonic_drive.prescribed_midline import (
    DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP,
    MIN_CORNER_HALF_WIDTH_OVER_WIND_UP,
)

REFERENCE = files("jointfmu_models") / "reference"


def rows(name):
    text = (REFERENCE / f"harmonic_drive_catalogue_{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def test_every_row_of_stiffness_has_its_drives():
    names = {item.joint_name for item in catalogue.list_drives()}
    for row in rows("stiffness"):
        group = row["series"].removeprefix("HD ")
        series = [group] if "/" not in group else [f"{s}-{row['size']}" for s in group.split("/")]
        ratio = "100" if row["ratio"] == "80+" else row["ratio"]
        for one in series:
            found = catalogue.find_drive(f"{one}-{ratio}")
            assert found.joint_name in names
            assert found.known_numbers["K1"].si_value == float(row["K1_Nm_per_rad"])
            if row["K3"]:
                assert found.known_numbers["K3"].si_value == float(row["K3"])
            assert found.known_numbers["K3"].value_origin == ("catalogue" if row["K3"] else "estimate")
            assert found.known_numbers["T2"].si_value == float(row["T2_Nm"])


def test_every_row_of_torque_is_told_as_printed():
    """The printed torques of every drive are found, except for size 11, which has no stiffness row."""
    for row in rows("torque"):
        name = f"{row['series']}-{row['size']}-{row['ratio']}"
        if row["size"] != "11":
            numbers = catalogue.find_drive(name).known_numbers
            assert numbers["rated_torque"][:2] == (float(row["rated_Nm"]), "catalogue")
            assert numbers["peak_torque"][:2] == (float(row["repeated_peak_Nm"]), "catalogue")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("CSG-17-100", "CSG-17-100"),
        ("csf 25_80", "CSF-25-80"),
        ("SHG-32-160-2SO", "SHG-32-160"),
        ("RSF-8B-50", "RSF-8B-50"),
        ("csg32100", "CSG-32-100"),
    ],
)
def test_names(name, found):
    assert catalogue.find_drive(name).joint_name == found


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("CSG-14-1000", "CSG-14-100, CSG-14-80, CSG-14-50"),
        ("CSG-25-99", "CSG-25-100, CSG-25-120, CSG-25-80"),
        ("CSG-25", "CSG-25-30, CSG-25-50, CSG-25-80"),
        ("CSF26-100", "CSF-25-100, CSF-25-120, CSF-25-80"),
        ("csg32101", "CSG-32-100"),
    ],
)
def test_the_nearest_names_are_told(name, near):
    """The error lists drives of the same series, then with the nearest size, then with the nearest ratio."""
    with pytest.raises(ValueError, match=f"nearest are {near}"):
        catalogue.find_drive(name)


@pytest.mark.parametrize(
    ("name", "ratio", "found"),
    [
        ("CSG-32-100", 50, "CSG-32-50"),
        ("csf-8-30", -50, "CSF-8-50"),
        ("CHA-14A-30", 50, "CHA-14A-50"),
    ],
)
def test_another_ratio_takes_the_row_of_that_ratio(name, ratio, found):
    """Another ratio selects its own row: K1 of CSG-32 is 54 000 N.m/rad at ratio 50, 67 000 at ratio 100."""
    drive, row = jointfmu.drive(name, ratio=ratio), catalogue.find_drive(found)
    assert drive.name == row.joint_name == found
    assert abs(drive.values["ratio"]) == abs(ratio)
    for column in LINES:
        assert drive.values[column] == row.known_numbers[column].si_value
    assert (
        jointfmu.drive(name, ratio=ratio, K1=row.known_numbers["K1"].si_value * 0.9).values["K1"]
        < drive.values["K1"]
    )


def test_a_ratio_that_is_not_in_the_catalogue_is_refused(capsys):
    line = refused_line(capsys, "new", "harmonic-drive", "--catalogue", "CSG-32-100", "--ratio", "51")
    assert "--ratio = 51 is not in the catalogue for CSG-32, allowed are 30, 50, 80, 100, 120, 160" in line


def test_a_torque_that_is_not_printed_is_a_marked_estimate():
    """By the catalogue, CSG torques are 30 % above CSF ones, and SHG torques equal CSG ones."""
    strong = catalogue.find_drive("CSG-20-100").known_numbers["rated_torque"]
    weak = catalogue.find_drive("CSF-20-100").known_numbers["rated_torque"]
    assert (weak.value_origin, strong.value_origin) == ("estimate", "catalogue")
    assert weak.si_value == pytest.approx(strong.si_value / 1.3)
    like = catalogue.find_drive("SHG-14-50").known_numbers["rated_torque"]
    assert (like.si_value, like.value_origin, like.value_source) == (7.0, "estimate", "that of CSG-14-50")
    assert "rated_torque" not in catalogue.find_drive("RSF-3C-100").known_numbers


def test_the_command(capsys):
    assert cli.main(["catalogue", "csg-17"]) == 0
    head, *lines, foot = capsys.readouterr().out.splitlines()
    assert "hysteresis_loss [arcmin]" in head
    assert [line.split()[0] for line in lines] == [
        "CSG-17-30",
        "CSG-17-50",
        "CSG-17-80",
        "CSG-17-100",
        "CSG-17-120",
    ]
    assert lines[3].split()[-8:] == ["31", "70", "~<1", "~<1", "~0.03069", "~0.05962", "~3.269", "~0.7667"]
    assert foot.startswith("~ is an estimate")


def test_json(capsys):
    assert cli.main(["catalogue", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found) == len(catalogue.list_drives()) > 300
    assert all(
        n["kind"] in ("catalogue", "estimate") and n["source"] for d in found for n in d["numbers"].values()
    )


def test_every_actuator_with_limits_has_the_stiffness_of_its_row():
    """21 rows of stiffness agree between two sources; the limits are those of the actuators."""
    arcmin = math.pi / 10800.0
    for row in rows("accuracy"):
        ratio = "100" if row["ratio"] == "50+" else row["ratio"]
        numbers = catalogue.find_drive(f"HFUC-{row['size']}-{ratio}").known_numbers
        for name, head in (
            ("T1", "T1_Nm"),
            ("T2", "T2_Nm"),
            ("K1", "K1_Nm_per_rad"),
            ("K2",) * 2,
            ("K3",) * 2,
        ):
            assert numbers[name][:2] == (float(row[head]), "catalogue")
        for name, head in (("hysteresis_loss", "hysteresis"), ("lost_motion", "lost_motion")):
            assert numbers[name].is_upper_limit
            assert numbers[name].si_value == pytest.approx(float(row[f"{head}_below_arcmin"]) * arcmin)
            assert f"CHA-{row['size']}A" in numbers[name].value_source


def test_a_size_without_limits_has_the_widest_of_all():
    for name, most in (("CSG-45-100", 1.0), ("HFUC-80-50", 1.0), ("RSF-3C-30", 3.0)):
        number = catalogue.find_drive(name).known_numbers["hysteresis_loss"]
        assert number.si_value == pytest.approx(most * math.pi / 10800.0)
        assert "none of which has this size" in number.value_source


def test_single_drives_have_what_is_printed_of_them():
    """Numbers that are not published are estimates, scaled from drives with published numbers."""
    units = {"starting_torque": ("starting_mNm", 1e-3), "running_torque": ("running_mNm", 1e-3)}
    units |= {"back_driving_torque": ("back_driving_Nm", 1.0), "rated_torque": ("rated_Nm", 1.0)}
    units |= {"peak_torque": ("repeated_peak_Nm", 1.0), "efficiency": ("efficiency", 1.0)}
    units |= {"K1": ("K1_Nm_per_rad", 1.0), "K3": ("K3_Nm_per_rad", 1.0)}
    for row in rows("friction"):
        numbers = catalogue.find_drive(row["drive"]).known_numbers
        for name, (head, unit) in units.items():
            if row[head]:
                assert numbers[name].si_value == pytest.approx(unit * float(row[head]), rel=1e-12)
                assert numbers[name].value_origin == "catalogue"
    assert catalogue.find_drive("RT1-H-14-100").known_numbers["K2"][:2] == (6100.0, "estimate")


def test_an_unknown_word_is_refused(capsys):
    assert "'nope'" in refused_line(capsys, "catalogue", "nope")


# Series beside cups and hats: actuators, small sizes, those of no legible source


LINES = ("T1", "T2", "K1", "K2", "K3")


def lines_of(name):
    return [catalogue.find_drive(name).known_numbers[column].si_value for column in LINES]


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
    assert lines_of(name) == printed
    assert {catalogue.find_drive(name).known_numbers[column].value_origin for column in LINES} == {
        "catalogue"
    }


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
    number = catalogue.find_drive(name).known_numbers["K3"]
    assert (number.si_value, number.value_origin) == (K3, "estimate")
    assert like in number.value_source


def test_a_last_line_without_such_a_drive_is_the_second():
    number = catalogue.find_drive("RSF-5B-50").known_numbers["K3"]
    assert (number.si_value, number.value_origin) == (140.0, "estimate")


def test_the_limits_of_an_actuator_are_its_own():
    """Torques of an actuator are those of its motor; gear torques are not used for it."""
    path = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_accuracy.csv"
    for row in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
        ratio = row["ratio"].replace("50+", "80")
        numbers = catalogue.find_drive(f"CHA-{row['size']}A-{ratio}").known_numbers
        loss = numbers["hysteresis_loss"]
        assert loss.si_value == pytest.approx(float(row["hysteresis_below_arcmin"]) * math.pi / 10800.0)
        assert (loss.value_origin, loss.is_upper_limit) == ("catalogue", True)
        assert "rated_torque" not in numbers
    assert catalogue.find_drive("HFUC-14-30").known_numbers["hysteresis_loss"].value_origin == "estimate"
    assert jointfmu.drive("CHA-14A-30").values["hysteresis_loss"] == 0.0  # a limit is no value


def test_the_wind_up_that_the_maker_computes():
    """CHA engineering data, p. 68: T = 60 N.m with T1 = 29, K1 = 6.7e4, K2 = 1.1e5 gives 7.15e-4 rad."""
    sharp = jointfmu.drive("CHA-32A-100", corner=0)
    assert sharp.wind_up(60.0) == pytest.approx(7.15e-4, abs=0.005e-4)


@pytest.mark.parametrize(
    "name", ["CSD-20-100", "SHD-20-100", "SHF-20-100", "CPL-20-100", "FHA-25C-100", "RV-40E-121", "CSF-8-100"]
)
def test_what_no_legible_source_has_is_unknown(name, capsys):
    said = refused_line(capsys, "new", "harmonic-drive", "--catalogue", name)
    assert f"catalogue '{name}' is unknown" in said


# Lines without smooth corners, which are said to have kinks, and the ratio


DRIVE = "CSG-25-100"


def angle(row, T):
    """Wind-up [rad] by the three lines of a catalogue row."""
    first = row["T1"] / row["K1"]
    second = first + (row["T2"] - row["T1"]) / row["K2"]
    return np.interp(
        T, [0.0, row["T1"], row["T2"], 2.0 * row["T2"]], [0.0, first, second, second + row["T2"] / row["K3"]]
    )


def test_without_corners_the_printed_angles_are_met():
    smooth, sharp = jointfmu.drive(DRIVE), jointfmu.drive(DRIVE, corner=0)
    row, T = sharp.values, np.array([14.0, 48.0, 87.0])
    # at a corner a smooth step of half-width c leaves 3/32 c of the jump in compliance: 1e-7 of the angle
    np.testing.assert_allclose(sharp.wind_up(T), angle(row, T), rtol=0.1 * MIN_CORNER_HALF_WIDTH_OVER_WIND_UP)
    assert abs(smooth.wind_up(14.0) / angle(row, 14.0) - 1.0) > 0.01 * DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP
    every = np.linspace(-90.0, 90.0, 1001)
    np.testing.assert_allclose(sharp.torque(sharp.wind_up(every)), every, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(sharp.stiffness([1.0, 13.99, 14.01, 47.9, 48.1]), [31e3, 31e3, 5e4, 5e4, 57e3])


def test_the_kinks_are_said_and_kept_in_the_file(tmp_path, capsys):
    out = tmp_path / "drive.toml"
    assert cli.main(["new", "harmonic-drive", "--catalogue", DRIVE, "--corner", "0", "--out", str(out)]) == 0
    assert "the stiffness jumps at T1 and T2" in capsys.readouterr().err
    assert jointfmu.load(out).values["corner"] == 0.0


@pytest.mark.slow
def test_all_flavours_have_the_kinks(tmp_path):
    file = jointfmu.drive(DRIVE, corner=0).file
    T = np.linspace(0.0, 90.0, 181)
    found = []
    with here_alone():
        paths = build_fmus(["HarmonicDriveCompliance"], ["fmi2", "fmi3", "python"], file, tmp_path)
    for path in paths:
        found.append(jointfmu.run(path, {"tau": T})["phi_rel"])
        expected = angle(file.values_by_name, T)
        np.testing.assert_allclose(
            found[-1], expected, rtol=0.1 * MIN_CORNER_HALF_WIDTH_OVER_WIND_UP, atol=1e-15
        )
        np.testing.assert_allclose(found[-1], found[0], rtol=1e-12)
    one = Fmu(tmp_path / "fmi2" / "HarmonicDriveCompliance.fmu").start(
        {"corner": DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP, "tau": 14.0}
    )
    assert one.get("phi_rel")["phi_rel"] == pytest.approx(jointfmu.drive(DRIVE).wind_up(14.0), rel=1e-9)
    one.free_instance()


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--corner", "-0.1"], "corner"), (["--corner", "0.04", "--law", "hu2023"], "has no corners")],
)
def test_what_is_no_corner(options, said, capsys):
    assert said in refused_line(capsys, "new", "harmonic-drive", "--catalogue", DRIVE, *options)


def test_a_ratio_of_zero_is_refused_and_a_negative_one_taken(capsys):
    asked = ("new", "harmonic-drive", "--catalogue", DRIVE, "--ratio")
    assert "--ratio = 0: expected a number above or below 0" in refused_line(capsys, *asked, "0")
    assert jointfmu.drive(DRIVE, ratio=-100).values["ratio"] == -100.0
    with pytest.raises(ValueError, match=r"ratio = 0 is outside .* allowed are \(-inf, 0\) and \(0, inf\)"):
        jointfmu.drive(DRIVE).with_values(ratio=0.0)
