"""`jointfmu law`: one interface law at pressures or largest spots."""

import argparse
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..contact import fractal
from ..contact.interface import at_largest_spot, at_pressure
from ..contact.laws import LAWS, ROUGHNESS_LAW
from ..contact.roughness import DECLARED, check, height
from ..joints import KINDS
from ..judgement import judge, known_height, law_height
from ..parameters import ParameterFile, default, load
from ..quantity import build, flat_fields, flatten
from .common import Commands, command, settings, tell

ROW = ("largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t")
"""Columns of every law; a law that does not define one gives null."""


def add(commands: Commands) -> None:
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
    """The law's parameter set from a joint's parameter file (default: `_first`)
    and settings."""
    file = file or default(_first(law), law)
    names = {name for name, _ in flat_fields(LAWS[law])}
    law_of = KINDS[file.joint].law_of
    own, other = law_of(file.values), file.law != law
    known = flatten(own)
    if other:
        known = flatten(law_of(default(file.joint, law).values)) | known | {"H": float(own.hardness)}
    if law == ROUGHNESS_LAW:
        fractal, stated = (flatten(own), known_height(file)) if other else ({}, None)
        settings = roughness_settings(fractal, stated, known["longest_wave"], settings)
    return build(LAWS[law], {k: v for k, v in known.items() if k in names} | settings)


def roughness_settings(
    known: dict[str, object], stated: float | None, longest: float, settings: dict[str, object]
) -> dict[str, object]:
    """Settings of the law `roughness` with its h, and hurst, out of what else tells them.

    known    : parameters of another law by structured name; D and G of a surface count
    stated   : h [m] that its file states; goes before D and G
    longest  : wave [m] up to which D and G count, unless the settings have longest_wave
    settings : may have Ra1, Ra2, Rq1, Rq2 [m], or surface.D and surface.G of a profile, in place of h
    """
    heights = {name: settings[name] for name in settings if name in DECLARED and name != "h"}
    rest = {name: value for name, value in settings.items() if name not in heights}
    if heights:
        return rest | {"h": height(check(heights | ({"h": rest["h"]} if "h" in rest else {})))}
    own = {name: rest.pop(name) for name in ("surface.D", "surface.G") if name in rest}
    pairs = fractal_surfaces(known | own if own or stated is None else {})
    if not pairs or "h" in rest:
        return rest if stated is None else {"h": stated} | rest
    wave = rest.get("longest_wave", longest)
    h = math.sqrt(sum(fractal.height(D, G, wave, areal) ** 2 for D, G, areal in pairs) / len(pairs))
    exponent = sum(fractal.hurst(D, areal) for D, G, areal in pairs) / len(pairs)
    return {"h": h, "hurst": exponent} | rest


def fractal_surfaces(known: dict[str, Any]) -> list[tuple[float, float, bool]]:
    """(D, G, whether of the area) of every direction in which a law's surface is stated."""
    prefixes = [name[:-2] for name in known if name.endswith(".D")]
    return [(known[f"{p}.D"], known[f"{p}.G"], known[f"{p}.D"] > 2.0) for p in prefixes if f"{p}.G" in known]


def _joints(law: str) -> list[str]:
    """The joints that have a law."""
    return [name for name, kind in KINDS.items() if law in kind.laws]


def _first(law: str) -> str:
    """The joint of whose default file a law is taken: one whose parameter set is the law's, if any."""
    joints = _joints(law)
    own = [name for name in joints if issubclass(KINDS[name].laws[law], LAWS[law])]
    return (own or joints)[0]


def law_file(path: Path, law: str) -> ParameterFile:
    """A parameter file of a joint that has the law."""
    file = load(path)
    if law not in KINDS[file.joint].laws:
        expected = " or ".join(repr(name) for name in _joints(law))
        raise ValueError(f"{path}: joint = {file.joint!r}, expected a parameter file of a {expected}")
    if KINDS[file.joint].law_of(file.values) is None:
        raise ValueError(
            f"{path}: law = {file.law!r} is of no interface; expected a file with an interface law"
        )
    return file


def _law(args: argparse.Namespace) -> int:
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
    found = judge(law, np.ravel(state["pressure"]).tolist(), _height(args, law, file))
    if args.json:
        shown = {"law": args.law, "parameters": flatten(law), "rows": rows}
        print(json.dumps(shown | found.document()))
        return 0
    print("  ".join(f"{name:>12}" for name in names))
    for row in rows:
        cells = ("-" if row[n] is None else f"{row[n]:.6g}" for n in names)
        print("  ".join(f"{cell:>12}" for cell in cells))
    tell(found)
    return 0


def _height(args: argparse.Namespace, law: Any, file: ParameterFile | None) -> float | None:
    """Rms height h [m] that is known of the surfaces; what the default file states is that of its own."""
    if (h := law_height(law)) is not None:
        return h
    others = any(name.startswith("surface") for name, _ in args.settings)
    if file is None and others:
        return None
    return known_height(file or default(_first(args.law), args.law))


def _json_number(column: Any, i: int) -> float | None:
    value = float(np.broadcast_to(column, (i + 1,) if np.ndim(column) == 0 else np.shape(column))[i])
    return value if math.isfinite(value) else None
