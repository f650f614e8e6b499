"""Command line in a shell: grouped help, completion, and files that a build replaces."""

import io
import json
import re
import signal
import subprocess
import sys
import time
from contextlib import redirect_stderr
from pathlib import Path

import pytest
from clients import needs
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.cli.parser import COMMAND_GROUPS, COMMANDS, COMPLETION_SHELLS, build_parser
from surroundings import Enter, Terminal, environment

from jointfmu import progress


def test_the_help_lists_every_command_once_under_its_heading():
    found = build_parser().format_help()
    for title, names in COMMAND_GROUPS.items():
        section = found.partition(f"\n{title}:\n")[2].partition("\n\n")[0]
        listed = [line.split()[0] for line in section.splitlines() if line[:3].strip() and line[2] != " "]
        assert listed == [*names], title
    assert len({*COMMANDS}) == len(COMMANDS)


def test_long_work_says_what_it_does_on_a_terminal(enter: Enter, capsys: pytest.CaptureFixture[str]):
    enter(environment(**{progress.STATUS_DELAY_ENVIRONMENT_VARIABLE: "inf"}))
    for stream, shown in ((Terminal(), True), (io.StringIO(), False)):
        out = sys.stdout
        with redirect_stderr(stream), progress.show_status("jointfmu new"):
            progress.set_status_text("members by finite elements")
            time.sleep((progress.STATUS_DELAY + 0.8) if shown else 0.0)
            print("done")
        assert ("\rjointfmu new: members by finite elements, 2 s\x1b[K" in stream.getvalue()) == shown
        assert stream.getvalue().endswith("\r\x1b[K" * shown)  # and is gone again
        assert sys.stdout is out
        assert capsys.readouterr().out == "done\n"


def test_an_interrupt_is_deferred_to_the_end_of_the_outermost_context():
    done = []

    def work():
        with progress.defer_interrupt():
            with progress.defer_interrupt():
                signal.raise_signal(signal.SIGINT)
                done.append("inner")
            done.append("outer")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert done == ["inner", "outer"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_long_work_prints_one_line_where_there_is_no_terminal(enter):
    """In a pipe or a notebook, a long command prints a status line, so that it does not seem to hang."""
    enter(environment(**{progress.STATUS_DELAY_ENVIRONMENT_VARIABLE: "0.2"}))
    stream = enter(redirect_stderr(io.StringIO()))
    with progress.show_status("jointfmu report"):
        progress.set_status_text("loops")
        time.sleep(0.6)
    assert stream.getvalue() == "jointfmu report: loops, 0 s\n"
    with progress.show_status("jointfmu report"):
        pass
    assert stream.getvalue().count("\n") == 1


@pytest.mark.parametrize("shell", COMPLETION_SHELLS)
def test_a_shell_has_its_script(shell: str, capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as left:
        cli.main(["--completion", shell])
    assert left.value.code == 0
    assert "--flavour" in capsys.readouterr().out


def completed(script: str, *words: str) -> list[str]:
    """Completions that bash offers for the last word."""
    function = re.findall(r"^complete .*-F (\w+)", script, re.MULTILINE)[0]
    line = " ".join(f"'{word}'" for word in words)
    ask = f"COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; {function}"
    shown = "printf '%s\\n' \"${COMPREPLY[@]}\""
    program = f"{script}\n{ask}\n{shown}"
    done = subprocess.run(["bash", "-c", program], capture_output=True, text=True, timeout=20)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@needs("bash")
def test_bash_completes_commands_options_and_choices(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        cli.main(["--completion", "bash"])
    script = capsys.readouterr().out
    assert completed(script, "jointfmu", "un") == ["uncertainty"]
    assert completed(script, "jointfmu", "build", "--fl") == ["--flavour"]
    assert set(completed(script, "jointfmu", "build", "--parameters", "")) >= {"tunable", "fixed"}


def test_a_shell_that_is_unknown(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        cli.main(["--completion", "fish"])
    assert "'bash', 'zsh'" in capsys.readouterr().err


@pytest.mark.slow
def test_a_second_build_says_what_it_replaces(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def build(*words: str) -> tuple[str, str]:
        out = ["--flavour", "python", "--out", str(tmp_path / "dist"), *words]
        assert cli.main(["build", "HarmonicDriveCompliance", *out]) == 0
        return capsys.readouterr()

    drive = tmp_path / "drive.toml"
    assert cli.main(["new", "harmonic-drive", "--catalogue", "CSG-14-100", "--out", str(drive)]) == 0
    capsys.readouterr()
    assert "replaced" not in build("--params", str(drive))[1]
    assert "replaced" not in build("--params", str(drive))[1]  # the same numbers
    text = drive.read_text()
    drive.write_text(text.replace("K1 = { value = 4700", "K1 = { value = 4800"))
    assert drive.read_text() != text
    path = tmp_path / "dist" / "python" / "HarmonicDriveCompliance.fmu"
    assert f"replaced {path}: K1 was 4700.0, is 4800.0\n" in build("--params", str(drive))[1]
    drive.write_text(text)
    found = json.loads(build("--params", str(drive), "--json")[0])
    assert found["replaced"] == {str(path): {"K1": ["4800.0", "4700.0"]}}
    path.write_text("no FMU")
    assert "replaced" not in build("--params", str(drive), "--force")[1]


@pytest.mark.parametrize("to", ["1e300", "-1e13"])
def test_a_ramp_to_impossible_values_is_refused(to: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """An impossible ramp is refused before the FMU is opened."""
    line = refused_line(capsys, "ramp", tmp_path / "none.fmu", "--input", "tau", "--to", to, "--step", to)
    assert f"to = {float(to):g} is outside [-1e+12, 1e+12] (SI)" in line
