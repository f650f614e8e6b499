"""The drives whose catalogue ships: their names, their numbers, and the command that lists them."""

import csv
import json
import math
from importlib.resources import files

import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.harmonic_drive import catalogue

REFERENCE = files("jointfmu_models") / "reference"


def rows(name):
    text = (REFERENCE / f"harmonic_drive_catalogue_{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def test_every_row_of_stiffness_has_its_drives():
    names = {item.name for item in catalogue.items()}
    for row in rows("stiffness"):
        group = row["series"].removeprefix("HD ")
        series = [group] if "/" not in group else [f"{s}-{row['size']}" for s in group.split("/")]
        ratio = "100" if row["ratio"] == "80+" else row["ratio"]
        for one in series:
            found = catalogue.find(f"{one}-{ratio}")
            assert found.name in names
            assert found.numbers["K1"].value == float(row["K1_Nm_per_rad"])
            if row["K3"]:
                assert found.numbers["K3"].value == float(row["K3"])
            assert found.numbers["K3"].kind == ("catalogue" if row["K3"] else "estimate")
            assert found.numbers["T2"].value == float(row["T2_Nm"])


def test_every_row_of_torque_is_told_as_printed():
    """Size 11 has no row of stiffness."""
    for row in rows("torque"):
        name = f"{row['series']}-{row['size']}-{row['ratio']}"
        if row["size"] != "11":
            numbers = catalogue.find(name).numbers
            assert numbers["rated_torque"][:2] == (float(row["rated_Nm"]), "catalogue")
            assert numbers["peak_torque"][:2] == (float(row["repeated_peak_Nm"]), "catalogue")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("CSG-17-100", "CSG-17-100"),
        ("csf 25_80", "CSF-25-80"),
        ("SHG-32-160-2SO", "SHG-32-160"),
        ("RSF-8B-50", "RSF-8B-50"),
        ("CSG-14-1000", None),
    ],
)
def test_names(name, found):
    if found is None:
        with pytest.raises(ValueError, match="nearest are CSG-14-100"):
            catalogue.find(name)
    else:
        assert catalogue.find(name).name == found


def test_a_torque_that_is_not_printed_is_a_marked_estimate():
    """The catalogue gives the CSG 30 % more torque than the CSF; an SHG is as strong as a CSG."""
    strong = catalogue.find("CSG-20-100").numbers["rated_torque"]
    weak = catalogue.find("CSF-20-100").numbers["rated_torque"]
    assert (weak.kind, strong.kind) == ("estimate", "catalogue")
    assert weak.value == pytest.approx(strong.value / 1.3)
    like = catalogue.find("SHG-14-50").numbers["rated_torque"]
    assert (like.value, like.kind, like.source) == (7.0, "estimate", "that of CSG-14-50")
    assert "rated_torque" not in catalogue.find("RSF-3C-100").numbers


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
    assert len(found) == len(catalogue.items()) > 300
    assert all(
        n["kind"] in ("catalogue", "estimate") and n["source"] for d in found for n in d["numbers"].values()
    )


def test_every_actuator_with_limits_has_the_stiffness_of_its_row():
    """Two sources print the lines: 21 rows of them agree, and the limits are those of the actuators."""
    arcmin = math.pi / 10800.0
    for row in rows("accuracy"):
        ratio = "100" if row["ratio"] == "50+" else row["ratio"]
        numbers = catalogue.find(f"HFUC-{row['size']}-{ratio}").numbers
        for name, head in (
            ("T1", "T1_Nm"),
            ("T2", "T2_Nm"),
            ("K1", "K1_Nm_per_rad"),
            ("K2",) * 2,
            ("K3",) * 2,
        ):
            assert numbers[name][:2] == (float(row[head]), "catalogue")
        for name, head in (("hysteresis_loss", "hysteresis"), ("lost_motion", "lost_motion")):
            assert numbers[name].bound
            assert numbers[name].value == pytest.approx(float(row[f"{head}_below_arcmin"]) * arcmin)
            assert f"CHA-{row['size']}A" in numbers[name].source


def test_a_size_without_limits_has_the_widest_of_all():
    for name, most in (("CSG-45-100", 1.0), ("HFUC-80-50", 1.0), ("RSF-3C-30", 3.0)):
        number = catalogue.find(name).numbers["hysteresis_loss"]
        assert number.value == pytest.approx(most * math.pi / 10800.0)
        assert "none of which has this size" in number.source


def test_single_drives_have_what_is_printed_of_them():
    """What is not is an estimate, scaled from those of which it is."""
    units = {"starting_torque": ("starting_mNm", 1e-3), "running_torque": ("running_mNm", 1e-3)}
    units |= {"back_driving_torque": ("back_driving_Nm", 1.0), "rated_torque": ("rated_Nm", 1.0)}
    units |= {"peak_torque": ("repeated_peak_Nm", 1.0), "efficiency": ("efficiency", 1.0)}
    units |= {"K1": ("K1_Nm_per_rad", 1.0), "K3": ("K3_Nm_per_rad", 1.0)}
    for row in rows("friction"):
        numbers = catalogue.find(row["drive"]).numbers
        for name, (head, unit) in units.items():
            if row[head]:
                assert numbers[name].value == pytest.approx(unit * float(row[head]), rel=1e-12)
                assert numbers[name].kind == "catalogue"
    assert catalogue.find("RT1-H-14-100").numbers["K2"][:2] == (6100.0, "estimate")


def test_an_unknown_word_is_refused(capsys):
    assert "'nope'" in refused_line(capsys, "catalogue", "nope")
