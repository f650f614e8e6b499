"""`jointfmu validate`: published numbers beside computed ones."""

import argparse
import json
from dataclasses import asdict

from jointfmu.published import validation

from ..command_line.common import Commands, command
from ..fem import installed
from ..fem.validation import natural_frequencies


def add(commands: Commands) -> None:
    """Declare the command."""
    sub = command(commands, "validate", _validate, "compare every published number with the computed one")
    sub.add_argument(
        "--frequencies",
        action="store_true",
        help="add the measured natural frequencies, by finite elements (half a minute)",
    )


def _validate(args: argparse.Namespace) -> int:
    rows = validation.validate()
    if args.frequencies:
        with installed("the finite-element analysis"):
            rows += natural_frequencies()
    misses = validation.missed(rows)
    if args.json:
        counts = asdict(validation.counts(rows))
        print(json.dumps({"rows": [row.as_dict() for row in rows], "counts": counts, "missed": len(misses)}))
        return int(bool(misses))
    print(validation.table(rows))
    print(validation.summary(rows))
    return int(bool(misses))
