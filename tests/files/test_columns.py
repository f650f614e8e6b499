"""CSV files with units: numbers are read back to the last bit, and each fault is named with its place."""

import csv

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from jointfmu_tools.common.columns import format_rows, format_table, read_columns

from jointfmu.quantity.units import unit_sizes

SPEC = {"load": unit_sizes("N", "kN"), "angle": unit_sizes("rad", "deg", "arcmin")}
HEAD = "load [kN], angle [arcmin]"


def saved(folder, content, encoding="utf-8"):
    path = folder / "a.csv"
    path.write_text(content, encoding=encoding)
    return path


def test_a_unit_at_the_end_of_a_name(tmp_path):
    spec = {
        "speed": unit_sizes("rad/s", "deg/s"),
        "load": unit_sizes("N", "kN"),
        "warmth": {"K": 1.0, "degC": 1.0},
    }
    words = {"speed": ("joint_speed",), "load": ("axial_load",), "warmth": ("oil_temperature",)}
    path = saved(tmp_path, "joint_speed_rad_per_s,axial_load_kN,oil_temperature_degC,note_s\n1,2,3,4\n")
    found = read_columns(path, spec, 1, words)
    assert found.heading_units == {"speed": "rad/s", "load": "kN", "warmth": "degC"}
    assert [float(found.values_by_name[name][0]) for name in spec] == [1.0, 2e3, 3.0]
    wrong = saved(tmp_path, "axial_load_mm,speed [rad/s]\n1,2\n")
    assert list(read_columns(wrong, spec, 1, words).values_by_name) == ["speed"]


@given(st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 2), min_size=1, max_size=20))
def test_round_trip_to_the_last_bit(tmp_path_factory, values):
    load, angle = np.array(values).T
    path = saved(
        tmp_path_factory.mktemp("round"), format_table([("load", "N"), ("angle", "rad")], [load, angle])
    )
    found = read_columns(path, SPEC, 1)
    np.testing.assert_array_equal(found.values_by_name["load"], load)
    np.testing.assert_array_equal(found.values_by_name["angle"], angle)
    assert found.line_numbers == list(range(2, 2 + load.size))


def test_what_is_written():
    columns = [np.array([1, 20]), np.array([-0.0, 2.0 / 3.0]), np.array([1e-30, 1e22])]
    heads = [("node", "1"), ("a [b, c]", None), ("K_N", "N/m")]
    assert format_table(heads, columns, header_lines=["# said before"]).splitlines() == [
        "# said before",
        'node [1],"a [b, c]",K_N [N/m]',
        "1,-0.0,1e-30",
        "20,0.6666666666666666,1e+22",
    ]
    assert format_table(heads, columns, significant_digits=3).splitlines()[1:] == [
        "1,0,1e-30",
        "20,0.667,1e+22",
    ]
    assert format_rows(columns[1:], [2, None], delimiter=" ") == ["0 1e-30", "0.67 1e+22"]
    with pytest.raises(ValueError, match="zip"):
        format_table(heads, [columns[0][:1], *columns[1:]])


def test_an_empty_table_is_its_heading():
    assert format_table([("load", "N")], [np.array([])]) == "load [N]\n"


@pytest.mark.parametrize("mark", [",", ";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_separators_order_and_strangers(tmp_path, mark, encoding):
    cells = ("Angle [deg]", " note", "LOAD[ kN ]"), ("1", "x", " 2"), ("3", "", "4e0")
    head, *rows = map(mark.join, cells)
    lines = ["# by hand", head, "", "  # indented", *rows]
    found = read_columns(saved(tmp_path, "\n".join(lines), encoding), SPEC, 2)
    np.testing.assert_array_equal(found.values_by_name["load"], [2e3, 4e3])
    np.testing.assert_allclose(found.values_by_name["angle"], np.radians([1.0, 3.0]), rtol=4e-16)
    assert found.line_numbers == [5, 6]


def test_cells_in_quotes(tmp_path):
    path = saved(tmp_path, 'load [N],"note, or not"\n"1.5","a, b"\n2,"open\n')
    np.testing.assert_array_equal(read_columns(path, SPEC, 2).values_by_name["load"], [1.5, 2.0])
    first, *rest = csv.reader(format_table([("a,b", "N")], [np.ones(1)]).splitlines())
    assert (first, rest) == (["a,b [N]"], [["1.0"]])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", r"is empty; expected columns load \[N \| kN\], angle \[rad \| deg \| arcmin\]"),
        ("1,2\n3,4", r"the first line is '1, 2'; expected columns load \[N \| kN\], "),
        ("load,angle [deg]\n1,2", r"column 'load' has no unit, expected e.g. load \[N\]"),
        (
            "load [ozf]\n1",
            r"column 'load' has unit 'ozf', allowed are N, kN or another unit of the same quantity; convert",
        ),
        ("load [N],Load [kN]\n1,2", r"column 'load' is given twice; state it once"),
        (f"{HEAD}", r"has 0 rows of numbers, at least 1 are needed"),
        (f"#\n{HEAD}\n1,2\n\n3", r"line 5 has 1 columns, expected 2"),
        (
            f"{HEAD}\n1,2\n3,4,5",
            r"line 3 has 3 columns, expected 2; commas separate the columns, so numbers need",
        ),
        (f"{HEAD}\n1,2\n3,", r"line 3: angle = '' is not a finite number with a decimal point"),
        (f"{HEAD}\n1,2\n inf ,4", r"line 3: load = 'inf' is not a finite number with a decimal point"),
        (f"{HEAD.replace(',', ';')}\n1,5,0;2", r"line 2: load = '1,5,0' is not a finite number"),
        (f"{HEAD.replace(',', ';')}\n1.234,5;2", r"line 2: load = '1.234,5' is not a finite number"),
    ],
)
def test_faults_are_named_with_their_place(tmp_path, content, said):
    path = saved(tmp_path, content)
    with pytest.raises(ValueError, match=f"a.csv: {said}") as error:
        read_columns(path, SPEC, 1)
    assert "\n" not in str(error.value)


def test_files_that_are_none(tmp_path):
    with pytest.raises(ValueError, match=r"none.csv: cannot be read \(No such file .*; expected a CSV file"):
        read_columns(tmp_path / "none.csv", SPEC, 1)
    (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"b.csv: is not a text file; expected CSV \(UTF-8\)"):
        read_columns(tmp_path / "b.csv", SPEC, 1)


def test_a_column_that_is_missing_is_named_with_its_units(tmp_path):
    found = read_columns(saved(tmp_path, "load [N]\n1\n"), SPEC, 1)
    with pytest.raises(ValueError, match=r"a.csv: has no column 'angle'; expected .*; it has load \[N\]$"):
        found.require_column("angle", SPEC)


@pytest.mark.parametrize(
    ("heads", "mark"),
    [("load [kN],angle [arcmin]", ","), ("Load (kN);Angle (arcmin)", ";"), ("load/kN\tangle / arcmin", "\t")],
)
def test_a_unit_is_read_as_people_write_it(tmp_path, heads, mark):
    point = "." if mark == "," else ","
    path = saved(tmp_path, f"\ufeff{heads}\n1{point}5{mark}2\n")
    found = read_columns(path, SPEC, 1)
    assert found.values_by_name["load"] == pytest.approx([1500.0])
    assert found.values_by_name["angle"] == pytest.approx([2.0 * np.pi / 10800.0])


def test_other_names_of_columns_are_told_by_their_units(tmp_path):
    others = {"load": ("f", "kraft"), "angle": ("f", "winkel")}
    found = read_columns(saved(tmp_path, "F [deg],Kraft [N]\n90,2\n"), SPEC, 1, others)
    assert found.values_by_name["load"].tolist() == [2.0]
    assert found.values_by_name["angle"] == pytest.approx([0.5 * np.pi])
    with pytest.raises(ValueError, match="expected columns"):
        read_columns(saved(tmp_path, "F [Hz],Kraft\n90,2\n"), SPEC, 1, others)


def test_quoted_cells_are_read_as_others(tmp_path):
    path = saved(tmp_path, 'load [N],note,angle [rad]\n1,"a, b",2\n3,c,4\n')
    found = read_columns(path, SPEC, 1)
    assert [found.values_by_name[name].tolist() for name in ("load", "angle")] == [[1.0, 3.0], [2.0, 4.0]]
