"""`jointfmu validate`: published numbers beside computed ones."""

import argparse
import json
from typing import Any

from .. import validation
from .common import command


def add(commands: Any) -> None:
    """Declare the command."""
    command(commands, "validate", _validate, "compare every published number with the computed one")


def _validate(args: argparse.Namespace) -> int:
    rows = validation.validate()
    misses = validation.missed(rows)
    if args.json:
        print(json.dumps({"rows": [row.as_dict() for row in rows], "missed": len(misses)}))
        return int(bool(misses))
    print(validation.table(rows))
    print(validation.summary(rows))
    return int(bool(misses))
