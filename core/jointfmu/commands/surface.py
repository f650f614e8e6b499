"""`jointfmu surface`: D and G from measured heights; `jointfmu surface synthesize`: made heights."""

import argparse
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import plots
from ..joints import KINDS
from ..parameters import check_writable, default, dump, load, write_text
from ..quantity import Number
from ..topography.figure import draw
from ..topography.form import FORMS
from ..topography.fractal import zhao_roughness
from ..topography.heights import Areal, Heights
from ..topography.identify import METHODS, identify
from ..topography.joint_parameters import changes, meaning, with_surface
from ..topography.reading import read
from ..topography.results import Estimate, Identification, Result
from . import synthesize
from .common import Parser, command, written

SUBCOMMANDS = ("identify", "synthesize")
"""The first is what the command does where none is named."""


def add(commands: Any) -> None:
    """Declare the command and its sub-commands."""
    text = "identify D and G of a measured surface or of a pair"
    top = commands.add_parser("surface", help=text, description=f"{text}; make a surface")
    steps = top.add_subparsers(dest="step", metavar="STEP", parser_class=Parser)
    top.usage = f"{top.prog} [-h] [{'|'.join(SUBCOMMANDS)}] ..."
    top.epilog = f"{top.prog} FILE ... is {top.prog} {SUBCOMMANDS[0]} FILE ..."
    find = command(steps, SUBCOMMANDS[0], _identify, text)
    find.add_argument("files", nargs="+", type=Path, metavar="FILE", help="one surface, or the two of a pair")
    find.add_argument("--unit", help="length unit of files that state none: m, mm, um, nm")
    find.add_argument("--form", choices=FORMS, default=FORMS[0], help="form to remove (default: tilt)")
    find.add_argument(
        "--range",
        dest="span",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="scaling range: lags and wavelengths [m] (default: the longest straight one)",
    )
    find.add_argument("--method", choices=METHODS, help="method to take for the joint (default: the surer)")
    find.add_argument(
        "--gamma", type=float, default=1.5, help="frequency ratio of Zhao's Eq. 30; only G_eq30 depends on it"
    )
    find.add_argument("--joint", choices=list(KINDS), metavar="JOINT", help=f"one of {', '.join(KINDS)}")
    find.add_argument("--params", type=Path, metavar="FILE", help="parameter file to start from (TOML)")
    written(find)
    find.add_argument("--plot", type=Path, metavar="FILE", help="picture of data, law and range (.png, .svg)")
    synthesize.add(steps, SUBCOMMANDS[1])


def _identify(args: argparse.Namespace) -> int:
    base = _base(args)
    for path, ready in ((args.out, check_writable), (args.plot, plots.check)):
        if path:
            ready(path)
    if not 1.0 < args.gamma < float("inf"):
        raise ValueError(f"gamma = {args.gamma:g} is outside (1, inf)")
    if args.span and not 0.0 < args.span[0] < args.span[1] < float("inf"):
        raise ValueError(f"range {args.span[0]:g} {args.span[1]:g} m, expected 0 < LOW < HIGH")
    heights = [read(path, args.unit) for path in args.files]
    identified = identify(heights, args.form, tuple(args.span) if args.span else None)
    file = with_surface(base, identified, args.method) if base else None
    if args.out and file:
        write_text(args.out, dump(file))
    if args.plot:
        draw(identified, args.plot)
    if args.json:
        print(json.dumps(_as_dict(identified, heights, args)))
    else:
        _print(identified, heights, args)
    return 0


def _rough() -> list[str]:
    """Joints with a rough surface."""
    return [name for name, kind in KINDS.items() if kind.surfaces]


def _base(args: argparse.Namespace) -> Any:
    """The parameter file to start from, if one is to be made."""
    if args.params:
        return load(args.params, args.joint)
    if args.joint:
        return default(args.joint)
    if args.out:
        raise ValueError(f"--out {args.out} needs --joint, one of {', '.join(KINDS)}, or --params")
    return None


def _print(identified: Identification, heights: Sequence[Heights], args: argparse.Namespace) -> None:
    for surface in heights:
        print(f"{surface.name}: {synthesize.size(surface)}")
    if len(heights) == 2:
        print("equivalent surface of the pair: structure functions and spectra added")
    for name, repair in identified.repairs:
        print(f"repaired in {name}: {repair}")
    heads = ("method", "direction", "range [m]", "D, profile", "G, profile [m]", "D_s, surface", "G_s [m]")
    rows = [heads, *(_row(result) for result in identified.results)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(heads))]
    for row in rows:
        print("  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip())
    print("brackets: 95 % confidence intervals")
    for joint in [args.joint] if args.joint else _rough():
        values = changes(identified, joint, args.method)
        text = ", ".join(
            f"{name} = {value:.6g}" if math.isfinite(value) else f"{name} not determined"
            for name, (value, _) in values.items()
        )
        print(f"{joint} ({meaning(joint)}, {next(iter(values.values()))[1].method}): {text}")
    if args.out:
        print(f"wrote {args.out}")
    if args.plot:
        print(f"wrote {args.plot}")
    for warning in identified.warnings:
        print(f"warning: {warning}", file=sys.stderr)


def _row(result: Result) -> tuple[str, ...]:
    profile, areal = result.profile, result.areal
    return (
        result.method,
        result.direction,
        f"{result.fit.low:.2e} to {result.fit.high:.2e}",
        _bracket(profile.D, ".3f"),
        _bracket(profile.G, ".2e"),
        *(
            (_bracket(areal.D_s, ".3f"), _bracket(areal.G_s, ".2e"))
            if result.direction in ("areal", "profile")
            else ("", "")
        ),
    )


def _bracket(estimate: Estimate, style: str) -> str:
    if not math.isfinite(estimate.value):
        return "not determined"
    return f"{estimate.value:{style}} [{estimate.low:{style}}, {estimate.high:{style}}]"


def _as_dict(
    identified: Identification, heights: Sequence[Heights], args: argparse.Namespace
) -> dict[str, Any]:
    return {
        "files": list(identified.names),
        "kind": "areal" if isinstance(heights[0], Areal) else "profile",
        "pair": len(heights) == 2,
        "textured": identified.textured,
        "form": args.form,
        "repairs": [
            {"file": n, "repair": r.name, "count": r.count, "points": r.points} for n, r in identified.repairs
        ],
        "results": [_result_dict(result, args.gamma) for result in identified.results],
        "joints": {
            joint: {
                name: _number(value) for name, (value, _) in changes(identified, joint, args.method).items()
            }
            for joint in ([args.joint] if args.joint else _rough())
        },
        "written": str(args.out) if args.out else None,
        "warnings": list(identified.warnings),
    }


def _result_dict(result: Result, gamma: float) -> dict[str, Any]:
    fit = result.fit
    return {
        "method": result.method,
        "direction": result.direction,
        "range": [fit.low, fit.high],
        "decades": fit.decades,
        "self_affine": fit.straight,
        "drift_of_D": fit.drift,
        "deviation": fit.deviation,
        "profile": {"D": _interval(result.profile.D), "G": _interval(result.profile.G)},
        "surface": {"D_s": _interval(result.areal.D_s), "G_s": _interval(result.areal.G_s)},
        "G_eq30": _number(zhao_roughness(result.profile.G.value, fit.H, gamma)),
    }


def _interval(estimate: Estimate) -> dict[str, float | None]:
    return {"value": _number(estimate.value), "low": _number(estimate.low), "high": _number(estimate.high)}


def _number(value: Number) -> float | None:
    """A number of JSON; null if it is not determined."""
    return float(value) if math.isfinite(float(value)) else None
