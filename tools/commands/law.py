"""`jointfmu law`: evaluate one interface law at pressures or at areas of the largest contact spot."""

import argparse
import math
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.interface import at_largest_spot, at_pressure
from jointfmu.contact.laws import LAWS
from jointfmu.quantity import flatten

from ..command_line.common import Answer, Commands, argument, command, settings
from ..judgement import judge
from ..laws import ROW, UNITS, joints_of, law_file, law_parameters, surfaces_height
from ..shown import aligned


def add(commands: Commands) -> None:
    """Declare the command `jointfmu law` with its options."""
    text = "evaluate one interface law at pressures or at areas of the largest contact spot"
    law = command(commands, "law", _law, text)
    laws = [name for name in LAWS if joints_of(name)]
    law.add_argument("law", choices=laws, metavar="LAW", help=f"one of {', '.join(laws)}")
    at = law.add_mutually_exclusive_group(required=True)
    argument(at, "--pressure", float, "nominal pressure [Pa]", "P", nargs="+")
    argument(at, "--largest-spot", float, "area of the largest contact spot [m2]", "A", nargs="+")
    argument(law, "--params", Path, "parameter file of the joint (TOML)")
    settings(law)


def _law(args: argparse.Namespace) -> Answer:
    file = law_file(args.params, args.law) if args.params else None
    law = law_parameters(args.law, file, dict(args.settings))
    with np.errstate(over="ignore"):
        if args.pressure is not None:
            state = at_pressure(law, np.array(args.pressure))
        else:
            state = at_largest_spot(law, np.array(args.largest_spot))
    names = [*ROW, *(name for name in state if name not in ROW)]
    count = len(args.pressure or args.largest_spot)
    rows = [{n: _json_number(state[n], i) if n in state else None for n in names} for i in range(count)]
    h = surfaces_height(args.law, law, file, dict(args.settings))
    judgement = judge(law, np.ravel(state["pressure"]).tolist(), h)
    heads = [f"{name} [{UNITS[name]}]" for name in names]
    cells = [heads, *(["-" if row[n] is None else f"{row[n]:.6g}" for n in names] for row in rows)]
    return Answer(
        document={"law": args.law, "parameters": flatten(law), "rows": rows},
        lines=aligned(cells, 0),
        judgement=judgement,
    )


def _json_number(column: Any, i: int) -> float | None:
    """Entry i of a column, which may be one number for all rows; None if it is not finite."""
    value = float(np.broadcast_to(column, (i + 1,) if np.ndim(column) == 0 else np.shape(column))[i])
    return value if math.isfinite(value) else None
