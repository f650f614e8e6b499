"""`jointfmu ramp`: selected columns, table on a terminal, picture."""

import json
from contextlib import redirect_stdout

import pytest
from conftest import refused_line
from jointfmu_tools import cli
from surroundings import Terminal

pytestmark = pytest.mark.slow


@pytest.fixture
def words(native):
    return ["ramp", str(native / "fmi2" / "GearContact.fmu"), "--input", "f", "--to", "1000", "--step", "10"]


def test_columns_are_those_asked_for_behind_the_input(words, capsys):
    assert cli.main([*words, "--columns", "K_N", "s_rel", "--json"]) == 0
    assert [*json.loads(capsys.readouterr().out)["columns"]] == ["f", "K_N", "s_rel"]
    assert "--columns q: unknown output, allowed are f, s_rel" in refused_line(
        capsys, *words, "--columns", "q"
    )
    looped = [*words[:4], "--loop", "1e-6", "--columns", "K_N"]
    assert "--columns is for a ramp" in refused_line(capsys, *looped)


def test_a_terminal_gets_a_table_and_a_pipe_every_point(words, capsys):
    assert cli.main(words) == 0
    assert capsys.readouterr().out.count("\n") == 102
    with redirect_stdout(Terminal()) as out:
        assert cli.main(words) == 0
    head, *rows, more, end = out.getvalue().split("\n")
    assert head.split()[:4] == ["f", "[kN]", "s_rel", "[um]"]
    assert (len(rows), end) == (24, "")
    assert [float(row.split()[0]) for row in (rows[0], rows[-1])] == [0.0, 1.0]
    assert len({len(row) for row in (head, *rows)}) == 1
    assert more == "24 of 101 points; --csv writes all"


def test_a_ramp_is_drawn(words, capsys, tmp_path):
    assert cli.main([*words, "--plot", str(tmp_path / "a.png"), "--csv", str(tmp_path / "a.csv")]) == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert capsys.readouterr().out.count("wrote ") == 2
    assert "'.pdf' is not that of a picture" in refused_line(capsys, *words, "--plot", "a.pdf")


def test_a_ramp_starts_at_the_value_set_for_its_input(native, capsys):
    fmu = str(native / "fmi3" / "BoltedJoint.fmu")
    words = [
        "ramp",
        fmu,
        "--input",
        "temperature",
        "--json",
        "--to",
        "320",
        "--step",
        "10",
        "--set",
        "preload=9e3",
    ]
    assert cli.main([*words, "temperature=293.15"]) == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["columns"]["temperature"] == [293.15, 303.15, 313.15, 320.0]
    assert printed.err == ""
    assert cli.main(words) == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["columns"]["temperature"][0] == 0.0
    assert printed.err.startswith("warning: temperature = 0 K in place of its start value = 293.15 K")
    assert "steps must lead from 350 to 320" in refused_line(capsys, *words, "temperature=350")


@pytest.mark.parametrize(("end", "is_doubtful"), [("2.5", True), ("2500", False)])
def test_a_load_in_the_wrong_unit_is_doubted(words, capsys, end, is_doubtful):
    """The nominal value of the force is 1 kN: 2.5 N is the value of a user who means 2.5 kN."""
    place = words.index("--to") + 1
    assert cli.main([*words[:place], end, *words[place + 1 :]]) == 0
    assert ("usual size of f, 1000 N; values are in N" in capsys.readouterr().err) == is_doubtful
