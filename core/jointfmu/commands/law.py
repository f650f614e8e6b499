"""`jointfmu law`: one interface law at pressures or largest spots."""

import argparse
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..asperity import LAWS
from ..interface import at_largest_spot, at_pressure
from ..joints import KINDS
from ..parameters import ParameterFile, default, load
from ..quantity import build, flat_fields, flatten
from .common import command, settings

ROW = ("largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t")
"""Columns of every law; a law that does not define one gives null."""


def add(commands: Any) -> None:
    """Declare the command."""
    law = command(commands, "law", _law, "evaluate one interface law at pressures or largest spots")
    laws = [name for name in LAWS if _joints(name)]
    law.add_argument("law", choices=laws, metavar="LAW", help=f"one of {', '.join(laws)}")
    at = law.add_mutually_exclusive_group(required=True)
    at.add_argument("--pressure", type=float, nargs="+", metavar="P", help="nominal pressure [Pa]")
    at.add_argument(
        "--largest-spot", type=float, nargs="+", metavar="A", help="area of the largest spot [m2]"
    )
    law.add_argument("--params", type=Path, metavar="FILE", help="parameter file of the joint (TOML)")
    settings(law)


def law_parameters(law: str, file: ParameterFile | None, settings: dict[str, Any]) -> Any:
    """The law's parameter set from a joint's parameter file (default: of the first joint with this law)
    and settings."""
    file = file or default(_joints(law)[0])
    known = flatten(KINDS[file.joint].law_of(file.values))
    names = {name for name, _ in flat_fields(LAWS[law])}
    return build(LAWS[law], {k: v for k, v in known.items() if k in names} | settings)


def _joints(law: str) -> list[str]:
    """The joints that have a law."""
    return [name for name, kind in KINDS.items() if kind.law is LAWS[law]]


def _file(path: Path, law: str) -> ParameterFile:
    """A parameter file of a joint that has the law."""
    file = load(path)
    if file.joint not in _joints(law):
        expected = " or ".join(repr(name) for name in _joints(law))
        raise ValueError(f"{path}: joint = {file.joint!r}, expected a parameter file of a {expected}")
    return file


def _law(args: argparse.Namespace) -> int:
    file = _file(args.params, args.law) if args.params else None
    law = law_parameters(args.law, file, dict(args.settings))
    with np.errstate(over="ignore"):
        if args.pressure is not None:
            state = at_pressure(law, np.array(args.pressure))
        else:
            state = at_largest_spot(law, np.array(args.largest_spot))
    names = [*ROW, *(name for name in state if name not in ROW)]
    count = len(args.pressure or args.largest_spot)
    rows = [{n: _json_number(state[n], i) if n in state else None for n in names} for i in range(count)]
    if args.json:
        print(json.dumps({"law": args.law, "parameters": flatten(law), "rows": rows}))
        return 0
    print("  ".join(f"{name:>12}" for name in names))
    for row in rows:
        cells = ("-" if row[n] is None else f"{row[n]:.6g}" for n in names)
        print("  ".join(f"{cell:>12}" for cell in cells))
    return 0


def _json_number(column: Any, i: int) -> float | None:
    value = float(np.broadcast_to(column, (i + 1,) if np.ndim(column) == 0 else np.shape(column))[i])
    return value if math.isfinite(value) else None
