"""`jointfmu ramp`: an FMU along a load ramp."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from .. import ramp
from ..parameters import check_writable, write_text
from .common import command, settings


def add(commands: Any) -> None:
    """Declare the command."""
    drive = command(commands, "ramp", _ramp, "run an FMU along a load ramp from zero and print every output")
    drive.add_argument("fmu", type=Path, metavar="FMU", help="path of the FMU")
    drive.add_argument("--input", required=True, metavar="NAME", help="input to drive")
    drive.add_argument("--to", type=float, required=True, metavar="VALUE", help="end of the ramp (SI)")
    drive.add_argument("--step", type=float, required=True, metavar="VALUE", help="step of the ramp (SI)")
    settings(drive)
    drive.add_argument("--csv", type=Path, metavar="FILE", help="write the ramp to a file")


def _ramp(args: argparse.Namespace) -> int:
    if args.csv:
        check_writable(args.csv)
    result = ramp.run(args.fmu, args.input, args.to, args.step, dict(args.settings))
    for message in result.messages:
        print(message, file=sys.stderr)
    if args.csv:
        write_text(args.csv, result.csv())
    if args.json:
        columns = {name: column.tolist() for name, column in result.columns.items()}
        print(json.dumps({"fmu": str(args.fmu), "units": result.units, "columns": columns}))
    elif args.csv:
        print(f"wrote {args.csv}: {len(next(iter(result.columns.values())))} points")
    else:
        sys.stdout.write(result.csv())
    return 0
