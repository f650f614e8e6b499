"""`jointfmu prove`: the experiments that an FMU carries, executed in an importer."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from ..proof import listing, report
from ..proof.importers import IMPORTERS
from ..proof.run import prove
from .common import command


def add(commands: Any) -> None:
    """Declare the command."""
    text = "run the experiments that an FMU carries (FMI-LS-REF) and compare with its reference results"
    sub = command(commands, "prove", _prove, text)
    sub.add_argument("fmu", type=Path, metavar="FMU", help="path of the FMU")
    sub.add_argument(
        "--in",
        dest="importer",
        choices=list(IMPORTERS),
        default="fmpy",
        metavar="IMPORTER",
        help=f"what runs the FMU: {', '.join(IMPORTERS)} (default: fmpy)",
    )
    sub.add_argument(
        "--listing",
        type=Path,
        metavar="DIR",
        help="if all passes, write the files of the FMI cross-check for lists of exporting tools",
    )


def _prove(args: argparse.Namespace) -> int:
    proof = prove(args.fmu, args.importer)
    folders = listing.write(proof, args.listing) if args.listing and proof.passed else []
    if args.json:
        written = {"listing": [str(folder) for folder in folders]} if args.listing else {}
        print(json.dumps(report.document(proof) | written))
        return int(not proof.passed)
    print("\n".join(report.lines(proof)))
    for folder in folders:
        print(f"wrote {folder}")
    if args.listing and not folders:
        print("no listing is written: not all passed", file=sys.stderr)
    return int(not proof.passed)
