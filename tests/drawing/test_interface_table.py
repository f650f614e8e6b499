"""Measured points of an interface from a file: `new ... --interface-table`."""

import re

import pytest
from jointfmu_tools.cli import main
from jointfmu_tools.inputs.drawing.faces import DEFAULT_MU_LIMITS

from jointfmu.parameters import load_parameter_file

HEAD = "pressure [MPa], stiffness [MPa/um]"
POINTS = ("0.5, 0.8", "1, 1.2", "2000, 4e3")
STEEL = ["--material", "steel"]
CONTACT = ["gear-contact", "--width", "20", "--radii", "12", "30", "--load", "2000", *STEEL]
MESH = ["gear-mesh", "--module", "4", "--teeth", "29", "45", "--width", "10", "--torque", "100", *STEEL]
PLATE = ["bolted-joint", "--plate", "200x100", "--bolts", "4xM12", "--at", "160x60", "--grip", "40", *STEEL]
PLATE += ["--preload", "30e3", "--sides", "rigid"]


@pytest.fixture
def table(tmp_path):
    """Function that writes a file of points and returns its path as text."""

    def write(*lines):
        path = tmp_path / "points.csv"
        path.write_text("\n".join(lines) + "\n")
        return str(path)

    return write


@pytest.fixture
def made(tmp_path, capsys):
    """Function that runs `jointfmu new` and returns the parameter file."""

    def run(*words):
        path = tmp_path / "made.toml"
        assert main(["new", *words, "--out", str(path)]) == 0, capsys.readouterr().err
        return load_parameter_file(path)

    return run


@pytest.mark.parametrize("words", [CONTACT, MESH, PLATE], ids=lambda words: words[0])
def test_the_points_enter_the_parameter_file_in_si(words, table, made):
    file = made(*words, "--interface-table", table("# ultrasound, 3 May", HEAD, *POINTS))
    assert file.law == "table"
    assert file.values.table.pressure == pytest.approx([5e5, 1e6, 2e9], rel=1e-15)
    assert file.values.table.stiffness == pytest.approx([8e11, 1.2e12, 4e15], rel=1e-15)
    assert file.sources["table.stiffness"] == "points of points.csv: ultrasound, 3 May"
    assert file.values.table.ratio == pytest.approx(2.0 * 0.7 / 1.7, rel=1e-12)  # Mindlin, nu = 0.3
    assert file.origins["table.ratio"] == "estimate"
    assert (file.values.table.factor, file.origins["table.factor"]) == (1.0, "default")
    assert not {"table.factor", "table.ratio"} & file.ranges.keys()


def test_limits_and_ratios_become_ranges(table, made):
    head = f"{HEAD}, stiffness_low [MPa/um], stiffness_high [MPa/um], ratio [1]"
    rows = ("0.5, 0.8, 0.72, 1.2, 0.4", "1, 1.2, 1, 1.5, 0.5", "2000, 4e3, 3.8e3, 4e3, 0.6")
    file = made(*CONTACT, "--interface-table", table(head, *rows))
    assert file.ranges["table.factor"] == pytest.approx((1.0 / 1.2, 1.5))
    assert file.ranges["table.ratio"] == (0.4, 0.6)
    assert file.values.table.ratio == pytest.approx(0.5)


def test_a_roughness_beside_the_table_judges_it_and_sets_the_embedding(table, made, capsys):
    path = table(HEAD, *POINTS)
    file = made(*PLATE, "--interface-table", path, "--Rz", "50")
    assert file.roughness == {"Ra1": pytest.approx(8e-6), "Ra2": pytest.approx(8e-6)}
    assert file.heights_prefix == "comparison."
    assert "times the roughness estimate" in capsys.readouterr().out
    assert file.values.embedding > 1.2 * made(*PLATE, "--interface-table", path).values.embedding
    assert file.ranges["mu"] == DEFAULT_MU_LIMITS


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ((HEAD, "1, 1.2"), "has 1 rows of numbers, at least 2 are needed"),
        (
            ("pressure, stiffness [MPa/um]", *POINTS),
            "column 'pressure' has no unit, expected e.g. pressure [Pa]",
        ),
        (
            ("pressure [N], stiffness [MPa/um]", *POINTS),
            "column 'pressure' has unit 'N', allowed are Pa, kPa, MPa",
        ),
        (("pressure [MPa]", "1", "2"), "has no column 'stiffness'; expected stiffness [Pa/m | MPa/um"),
        ((HEAD, "1, 1.2", "2, -1"), "line 3: stiffness = -1e+12 Pa/m is outside (0, inf)"),
        ((HEAD, "1, 1.2", "1, 1.3"), "table.pressure[1] = 1e+06 Pa follows 1e+06 Pa; expected increasing"),
        ((HEAD, "1, 1.2", "2, 1.1"), "table.stiffness[1] = 1.1e+12 Pa/m is below the one before it"),
        ((HEAD, *(f"{p}, 1" for p in range(1, 34))), "has 33 points, allowed are 2 to 32"),
        (
            ("pressure [MPa], stiffness [Pa/m]", "1, 1.2", "2, 1.3"),
            "line 2: pressure over stiffness = 8.33e+05 m, plausible for an interface is 1e-10 to 0.001 m",
        ),
        (
            (f"{HEAD}, stiffness_low [MPa/um]", "1, 1.2, 1.1", "2, 1.3, 1.4"),
            "line 3: stiffness = 1.3e+12 Pa/m is outside [1.4e+12, 1.3e+12]",
        ),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(lines, message, table, capsys):
    assert main(["new", *CONTACT, "--interface-table", table(*lines)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "points.csv" in line
    assert re.search(re.escape(message), line)


def test_a_law_beside_the_table_is_refused(table, capsys):
    assert main(["new", *PLATE, "--law", "zhao2018", "--interface-table", table(HEAD, *POINTS)]) == 2
    assert "--law zhao2018 and --interface-table both state the law" in capsys.readouterr().err
