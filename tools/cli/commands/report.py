"""`jointfmu report`: write the page of one joint, from its parameter file or its name."""

import argparse
from pathlib import Path

from jointfmu.files.outputs import HTML_FILE

from ...api.make import load
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import declare_output


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu report` with its options."""
    text = "write a page about one joint: curves, loops, friction, sources of the numbers, validity"
    make = declare_command(command_parsers, "report", _run_report, text)
    declare_argument(
        make,
        "file",
        Path,
        "parameter file (TOML), or name of an FMU (as in BoltedJoint, no file), of a joint, or of a drive of "
        "jointfmu catalogue",
    )
    declare_argument(
        make,
        "--fmu",
        str,
        "FMU of the joint that the page describes, as in HarmonicDriveCompliance (default: the first of the "
        "joint)",
    )
    declare_output(make, "--out", HTML_FILE, "page to write (.html; default: FILE.html in this folder)")


def _run_report(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu report`: write the page of one joint."""
    joint = load(args.file)
    out: Path = args.out or Path(f"{args.file.stem}.html")
    if out.suffix != ".html":
        raise ValueError(f"--out {out} has the suffix {out.suffix!r}, allowed is .html")
    joint.report(out, args.fmu, force=args.force)
    return CommandResult(json_document={"report": str(out)}, written_files=[out])
