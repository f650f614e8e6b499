"""`jointfmu new` for every joint that has it, and its tables."""

import json
import math
import re
import shlex

import pytest
from clients import needs
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.common.joint_parts import load_tool_module
from jointfmu_tools.inputs.drawing.quantities import (
    QUANTITIES,
    parse_quantity,
    parse_quantity_value,
    parse_quantity_values,
)
from jointfmu_tools.inputs.drawing.reading import parse_number, parse_numbers
from jointfmu_tools.inputs.drawing.tables import (
    MATERIAL_COLUMNS,
    find_table_row,
    read_material_or_finish_table,
    read_property_classes,
    read_threads,
    read_washers,
)
from jointfmu_tools.joints.harmonic_drive.new_cycloidal import NEW_CYCLOIDAL_DRIVE_COMMAND

from jointfmu.joints import KINDS
from jointfmu.parameters import load_parameter_file

NEW = {
    kind.name.replace("_", "-"): found.NEW_JOINT_COMMAND
    for kind in KINDS.values()
    if (found := load_tool_module(kind, "new"))
} | {"cycloidal-drive": NEW_CYCLOIDAL_DRIVE_COMMAND}


def said(capsys, *words):
    assert cli.main([str(word) for word in words]) == 0
    return capsys.readouterr()


def test_there_are_some():
    assert len(NEW) >= 4


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=needs("gmsh") if name == "bolted-joint" else ()) for name in NEW]
)
def test_the_example_makes_a_file_that_loads(capsys, tmp_path, name):
    path = tmp_path / "joint.toml"
    words = ["new", name, *shlex.split(NEW[name].example_options), "--out", path]
    text = said(capsys, *words).out
    assert text.endswith(f"wrote {path}\n")
    file = load_parameter_file(path)
    assert file.joint == {"cycloidal-drive": "harmonic_drive"}.get(name, name.replace("-", "_"))
    found = json.loads(said(capsys, *words, "--json").out)
    assert found["parameters"] == json.loads(json.dumps(file.values_by_name))
    assert found["inputs"] == file.inputs
    assert all(f"# {fact} = " in path.read_text() for fact in found["facts"])
    assert all(fact["unit"] and fact["text"] for fact in found["facts"].values())
    assert set(file.origins.values()) <= {
        "user",
        "derived",
        "estimate",
        "standard",
        "paper",
        "default",
        "catalogue",
        "calibration",
    }


@pytest.mark.parametrize("name", NEW)
def test_what_is_required_is_asked_for(capsys, tmp_path, name):
    options = NEW[name].command_options
    required = [f"--{option.name}" for option in options if option.is_required]
    required = required or [f"--{option.name}" for option in options]  # or one of several ways
    line = refused_line(capsys, "new", name, "--out", tmp_path / "joint.toml")
    assert any(option in line for option in required)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", NEW)
def test_a_place_that_cannot_be_written_is_refused_first(capsys, tmp_path, name):
    line = refused_line(capsys, "new", name, *shlex.split(NEW[name].example_options), "--out", tmp_path)
    assert "is a folder; expected a file to write" in line


@pytest.mark.parametrize("name", NEW)
def test_the_help_has_every_option_and_an_example(capsys, name):
    with pytest.raises(SystemExit, match="0"):
        cli.main(["new", name, "--help"])
    text = capsys.readouterr().out
    assert all(f"--{option.name.replace('_', '-')}" in text for option in NEW[name].command_options)
    assert f"example: jointfmu new {name}" in " ".join(text.split())


# Tables


@pytest.mark.parametrize("name", ["materials", "finishes", "bolts"])
def test_tables_are_printed(capsys, name):
    rows = json.loads(said(capsys, "new", name, "--json").out)
    lines = said(capsys, "new", name).out.splitlines()
    assert len(lines) == len(rows) + 1
    assert [line.startswith(row["name"]) for line, row in zip(lines[1:], rows, strict=True)] == [True] * len(
        rows
    )


def test_materials_are_physical_and_have_sources():
    for material in read_material_or_finish_table("materials").values():
        values = {name: known.si_value for name, known in material.sourced_numbers.items()}
        assert values.keys() == MATERIAL_COLUMNS.keys()
        assert 5e10 < values["E"] < 2.5e11
        assert 0.2 < values["nu"] < 0.4
        assert 2000 < values["density"] < 9000
        assert 5e8 < values["H"] < 1e10
        assert all(known.value_source for known in material.sourced_numbers.values())
        assert material.sourced_numbers["H"].value_origin == "estimate"  # of one usual state
    names = [
        name
        for found in read_material_or_finish_table("materials").values()
        for name in (found.row_name, *found.row_aliases)
    ]
    assert len(names) == len({name.lower() for name in names})


def test_a_finish_is_the_middle_of_its_range():
    for finish in read_material_or_finish_table("finishes").values():
        Ra, low, high = (finish.sourced_numbers[name].si_value for name in ("Ra", "Ra_low", "Ra_high"))
        assert pytest.approx(math.sqrt(low * high), rel=1e-3) == Ra
        assert high > low
        assert 0.0 < finish.sourced_numbers["hurst"].si_value < 1.0


def test_a_row_is_found_by_any_of_its_names():
    assert (
        find_table_row("materials", "Cast-Iron")
        is find_table_row("materials", "GG25")
        is find_table_row("materials", "cast iron")
    )
    with pytest.raises(ValueError, match=r"material 'wood' is unknown, allowed are steel, .* new materials"):
        find_table_row("materials", "wood")
    with pytest.raises(ValueError, match="finish 'rough' is unknown"):
        find_table_row("finishes", "rough")


def test_bolts_grow():
    sizes = list(read_threads().values())
    for column in (
        "nominal_diameter",
        "hole_diameter",
        "hexagon_bearing_diameter",
        "socket_bearing_diameter",
    ):
        values = [getattr(thread, column) for thread in sizes]
        assert values == sorted(values)
    for thread in sizes:
        assert thread.pitch < thread.nominal_diameter < thread.hole_diameter
        assert thread.hole_diameter < thread.hexagon_bearing_diameter < thread.socket_bearing_diameter
        assert thread.nominal_diameter == pytest.approx(float(thread.thread_name[1:]) * 1e-3)
    washers = [read_washers()[thread.thread_name] for thread in sizes]
    for column in ("hole_diameter", "outer_diameter", "thickness"):
        values = [getattr(washer, column) for washer in washers]
        assert values == sorted(values)
    for thread, washer in zip(sizes, washers, strict=True):
        assert thread.nominal_diameter < washer.hole_diameter < thread.socket_bearing_diameter
        assert thread.socket_bearing_diameter < washer.outer_diameter
    for strength in read_property_classes().values():
        assert all(p < y for p, y in zip(strength["proof"], strength["yield"], strict=True))


# Numbers


@pytest.mark.parametrize(
    ("text", "value"),
    [("40", 0.04), ("40mm", 0.04), ("0.04 m", 0.04), ("4e4um", 0.04), (".5", 5e-4), ("1E2", 0.1)],
)
def test_lengths(text, value):
    assert parse_number("grip", text, "mm", "m") == pytest.approx(value, rel=1e-15)


def test_numbers_with_a_sign_between():
    assert parse_numbers(
        "plate", "200x0.1m", "mm", "m", number_separator="x", expected_number_count=2
    ) == pytest.approx([0.2, 0.1])
    assert parse_numbers(
        "at", "-80,3e1", "mm", "m", number_separator=",", expected_number_count=2, lower_bound=None
    ) == pytest.approx([-0.08, 0.03])


@pytest.mark.parametrize("text", ["", "x", "1e999", "0", "-3", "inf", "40furlong", "40N", "4O"])
def test_bad_numbers_are_refused(text):
    with pytest.raises(ValueError, match=r"^--grip = "):
        parse_number("grip", text, "mm", "m")


# Quantities of options


@pytest.mark.parametrize("name", NEW)
def test_every_number_has_its_quantity(name):
    """Each option whose help states a unit is in the table of quantities, with this unit."""
    for option in NEW[name].command_options:
        if option.choices:
            continue  # a word, not a number
        if option.choices:
            continue  # a word, not a number
        if unit := re.search(r"\[(1|[A-Za-z][\w./]*)\b[^]]*\]", option.help_text):
            if option.name == "temperature":
                continue  # has a zero point
            assert QUANTITIES[option.name].default_unit == unit[1], option.name


def test_all_quantities_are_of_options():
    assert {*QUANTITIES} <= {option.name for command in NEW.values() for option in command.command_options}


@pytest.mark.parametrize(
    ("option", "text", "value"),
    [
        ("Ra", "0.8um", 0.8e-6),
        ("Ra", "0.8", 0.8e-6),
        ("Ra", "0.8e-3mm", 0.8e-6),
        ("Rz", "6.3 um", 6.3e-6),
        ("hardness", "160HB", 160 * 9.80665e6),
        ("hardness", "700 HV", 700 * 9.80665e6),
        ("hardness", "1.6GPa", 1.6e9),
        ("preload", "40kN", 40e3),
        ("torque", "84Nm", 84.0),
        ("plate", "0.2m", 0.2),
        ("at", "0", 0.0),
        ("at", "-80", -0.08),
        ("longest_wave", "800um", 0.8e-3),
    ],
)
def test_numbers_with_units(option, text, value):
    assert parse_quantity_value(option, text) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.1..0.3", (0.2, 0.1, 0.3)),
        ("0.1 .. 0.3", (0.2, 0.1, 0.3)),
        ("0.2", (0.2, 0.2, 0.2)),
    ],
)
def test_ranges(text, expected):
    assert parse_quantity("mu", text) == pytest.approx(expected)


def test_the_unit_of_a_range_is_of_both_ends():
    assert parse_quantity("preload", "40..50kN") == pytest.approx((45e3, 40e3, 50e3))
    assert parse_quantity("preload", "40e3N..50kN") == pytest.approx((45e3, 40e3, 50e3))


@pytest.mark.parametrize(
    ("option", "text", "message"),
    [
        ("Ra", "8e-7", "8e-07 um, plausible are 0.005 to 100 um; if it is in m, write 8e-7m (0.8 um)"),
        ("Ra", "800", "read as 800 um, plausible are 0.005 to 100 um; if it is in nm, write 800nm (0.8 um)"),
        ("Ra", "800um", "is outside (0.0001, 100] um: Ra of machined surfaces"),
        ("Ra", "8e-7um", "is outside (0.0001, 100] um: Ra of machined surfaces"),
        ("Ra", "0,8", "'0,8' has a comma; write 0.8 with a decimal point"),
        ("preload", "30,000", "write 30.000 with a decimal point, or 30000 if the comma separates thousands"),
        ("preload", "1,200,000", "write 1200000"),
        ("preload", "40", "plausible are 100 to 3e+06 N; if it is in kN, write 40kN (4e+04 N)"),
        ("hardness", "1.6e9", "if it is in Pa, write 1.6e9Pa (1600 MPa)"),
        ("hardness", "160", "plausible are 300 to 15000 MPa; if it is in HB, write 160HB (1569 MPa)"),
        ("hardness", "60HRC", "unit '60HRC'"),
        ("plate", "0.2", "plausible are 4 to 20000 mm; if it is in m, write 0.2m (200 mm)"),
        ("at", "0.16", "if it is in m, write 0.16m (160 mm)"),
        ("hole", "13500", "plausible are 2 to 150 mm; if it is in um, write 13500um (13.5 mm)"),
        ("bearing", "500", "is outside (0, 400] mm: diameter of a bearing surface"),
        ("longest_wave", "800", "if it is in um, write 800um (0.8 mm)"),
        ("module", "400", "plausible are 0.1 to 60 mm; if it is in um, write 400um (0.4 mm)"),
        ("pressure_angle", "0.35", "if it is in rad, write 0.35rad (20.05 deg)"),
        ("plate", "100..200", "is a range; expected one number"),
        ("mu", "0.3..0.1", "expected LOW..HIGH, LOW below HIGH"),
        ("mu", "0.1..3", "= '3' is outside (0, 2]: coefficient of friction of metals"),
        ("embedding", "-1", "is outside [0, inf) N: preload loss of a bolt"),
        ("thickness", "0.1", "if it is in m, write 0.1m (100 mm)"),
    ],
)  # fmt: skip
def test_a_number_that_is_not_plausible_is_asked_about(option, text, message):
    """The error is one line: the value as read, the plausible range, and what to write."""
    with pytest.raises(ValueError, match=f"^--{option.replace('_', '-')} = ") as refusal:
        parse_quantity(option, text)
    if message == "unit '60HRC'":
        assert "or in HB, HBW, HV" in str(refusal.value)
    else:
        assert message in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_sizes_are_asked_about():
    with pytest.raises(ValueError, match=r"--plate = '0.2' is read as 0.2 mm"):
        parse_quantity_values("plate", "0.2x0.15", number_separator="x", expected_value_count=2)
    assert parse_quantity_values(
        "plate", "0.2mx0.15m", number_separator="x", expected_value_count=2
    ) == pytest.approx([0.2, 0.15])
