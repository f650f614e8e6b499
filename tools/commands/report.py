"""`jointfmu report`: the page of one joint, from its parameter file or by its name."""

import argparse
import json
from pathlib import Path

from jointfmu.files.writing import check_writable

from ..command_line.common import Commands, command
from ..interface.make import load


def add(commands: Commands) -> None:
    """Declare the command."""
    text = (
        "write a page about one joint: curves, loops, friction, sources of its numbers, how far to trust it"
    )
    make = command(commands, "report", _report, text)
    make.add_argument("file", type=Path, metavar="FILE", help="parameter file (TOML), or a name")
    make.add_argument("--fmu", metavar="NAME", help="which of the joint's FMUs (default: its first)")
    make.add_argument(
        "--out", type=Path, metavar="FILE", help="page to write (.html; default: FILE.html in this folder)"
    )


def _report(args: argparse.Namespace) -> int:
    joint = load(args.file)
    out: Path = args.out or Path(f"{args.file.stem}.html")
    if out.suffix != ".html":
        raise ValueError(f"--out {out} has the ending {out.suffix!r}, allowed is .html")
    check_writable(out)
    joint.report(out, args.fmu)
    print(json.dumps({"report": str(out)}) if args.json else f"wrote {out}")
    return 0
