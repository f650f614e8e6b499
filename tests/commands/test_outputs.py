"""Output files of commands: inputs and foreign files are not overwritten unasked; devices can be written."""

import os
import stat
import threading
from contextlib import chdir
from pathlib import Path

import pytest
from clients import needs
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.cli.parser import _iterate_parsers, build_parser

from jointfmu.files.outputs import OUTPUT_FOLDER, PARAMETER_FILE, check_output
from jointfmu.files.writing import write_text

INPUTS = frozenset(
    [
        "params",
        "data",
        "file",
        "files",
        "fmu",
        "assembly",
        "nodes",
        "study",
        "against",
        "beside",
        "moment_file",
        "fmus",
        "robot",
    ]
)
"""Arguments that name an input file. All other arguments that take a path name an output."""
COMMANDS = {one.prog: one for one in _iterate_parsers(build_parser()) if one._actions}
OUTPUTS = [
    (prog, name, kind)
    for prog, one in COMMANDS.items()
    for name, kind in getattr(one, "output_file_kinds", {}).items()
]
FILES = [(prog, name, kind) for prog, name, kind in OUTPUTS if kind is not OUTPUT_FOLDER]
NEW = ["new", "harmonic-drive", "--catalogue", "CSG-17-100", "--out"]


def words(prog, name, path):
    """Command line with every required argument: the output path, and `input.toml` for each input."""
    one = COMMANDS[prog]
    found = prog.split()[1:]
    for action in one._actions:
        if action.dest == name or not (
            action.required or (not action.option_strings and action.nargs != "?")
        ):
            continue
        value = (action.choices and next(iter(action.choices))) or (
            "input.toml" if action.type in (Path, str) else "1"
        )
        count = len(one.output_file_kinds) and 1
        found += [*action.option_strings[:1], *[str(value)] * count]
    if "params" in {action.dest for action in one._actions}:
        found += ["--params", "input.toml"]
    return [*found, f"--{name}", str(path)]


@pytest.mark.parametrize("prog", COMMANDS)
def test_every_path_is_declared_as_input_or_output(prog):
    one = COMMANDS[prog]
    paths = {a.dest for a in one._actions if a.type is Path}
    assert paths - INPUTS == set(getattr(one, "output_file_kinds", {})) - INPUTS


@pytest.mark.parametrize(
    ("prog", "name", "kind"), [one for one in FILES if "input.toml" in words(one[0], one[1], "output")]
)
def test_an_output_that_is_an_input_is_refused(tmp_path, enter, capsys, prog, name, kind):
    enter(chdir(tmp_path))
    source = Path("input.toml")
    source.write_text("precious")
    os.link(source, "hard" + kind.file_name_endings[0])
    os.symlink(source, "soft" + kind.file_name_endings[0])
    for path in ("input.toml", "hard" + kind.file_name_endings[0], "soft" + kind.file_name_endings[0]):
        line = words(prog, name, path)
        assert "is also an input of this command" in refused_line(capsys, *line, "--force")
    assert source.read_text() == "precious"


@pytest.mark.parametrize(("prog", "name", "kind"), FILES)
def test_a_foreign_file_is_not_replaced(tmp_path, enter, capsys, prog, name, kind):
    enter(chdir(tmp_path))
    Path("input.toml").write_text("x")
    path = Path(f"mine{kind.file_name_endings[0]}")
    path.write_text("measured by me\n")
    assert "(--force)" in refused_line(capsys, *words(prog, name, path))
    other = Path("script.py")
    other.write_text("print()\n")
    said = refused_line(capsys, *words(prog, name, other), "--force")
    assert "another kind" in said or "is not that of a picture" in said
    assert (path.read_text(), other.read_text()) == ("measured by me\n", "print()\n")


def test_a_command_runs_twice_and_edits_are_kept(tmp_path, capsys):
    out = tmp_path / "drive.toml"
    for _ in range(2):
        assert cli.main([*NEW, str(out)]) == 0
    capsys.readouterr()
    out.write_text(out.read_text() + "# my note\n")
    assert "(--force)" in refused_line(capsys, *NEW, out)
    assert cli.main([*NEW, str(out), "--force"]) == 0
    assert "my note" not in out.read_text()


def test_two_outputs_in_one_file_are_refused(tmp_path, enter, capsys):
    enter(chdir(tmp_path))
    line = ["ramp", "no.fmu", "--input", "f", "--to", "1", "--step", "1", "--csv", "a.png", "--plot", "A.png"]
    assert "state two files" in refused_line(capsys, *line)


def test_links_pipes_and_devices_are_written_through(tmp_path):
    link, target, pipe = tmp_path / "link.csv", tmp_path / "target.csv", tmp_path / "pipe"
    link.symlink_to(target)
    write_text(link, "one")
    assert (link.is_symlink(), target.read_text()) == (True, "one")
    os.mkfifo(pipe)
    check_output(pipe, PARAMETER_FILE)
    found = []
    reader = threading.Thread(target=lambda: found.append(pipe.read_text()), daemon=True)
    reader.start()
    write_text(pipe, "two")
    reader.join(10.0)
    assert found == ["two"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@needs("Linux")
def test_a_full_device_is_refused_and_stays_a_device(tmp_path):
    link = tmp_path / "full"
    link.symlink_to("/dev/full")
    for path in (link, Path("/dev/full")):
        with pytest.raises(ValueError, match=r"cannot be written \(No space left on device\)"):
            write_text(path, "text")
        assert path.is_char_device()
