"""`jointfmu report`: write the page of one joint, from its parameter file or its name."""

import argparse
from pathlib import Path

from jointfmu.files.outputs import PAGE

from ..command_line.common import Answer, Commands, argument, command
from ..command_line.outputs import output
from ..interface.make import load


def add(commands: Commands) -> None:
    """Declare the command `jointfmu report` with its options."""
    text = "write a page about one joint: curves, loops, friction, sources of the numbers, validity"
    make = command(commands, "report", _report, text)
    argument(make, "file", Path, "parameter file (TOML), or name of an FMU, a joint or a catalogue entry")
    argument(make, "--fmu", str, "FMU of the joint that the page describes (default: the first)")
    output(make, "--out", PAGE, "page to write (.html; default: FILE.html in this folder)")


def _report(args: argparse.Namespace) -> Answer:
    joint = load(args.file)
    out: Path = args.out or Path(f"{args.file.stem}.html")
    if out.suffix != ".html":
        raise ValueError(f"--out {out} has the ending {out.suffix!r}, allowed is .html")
    joint.report(out, args.fmu, force=args.force)
    return Answer(document={"report": str(out)}, written=[out])
