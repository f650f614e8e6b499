"""What `jointfmu surface` prints: lines and a table, or JSON."""

import argparse
import json
import math
import sys
from collections.abc import Sequence

from jointfmu.contact.laws import ROUGHNESS_LAW
from jointfmu.contact.roughness import GAMMA, level
from jointfmu.parameters import ParameterFile

from ...command_line.common import tell
from ...pressure import judge_file
from ...surfaces.heights import Heights
from ...surfaces.joint_parameters import changes, doubt, meaning
from ...surfaces.results import Estimate, Identification, Result
from ...surfaces.roughness import ScanRoughness
from . import synthesize
from .document import UNIT_PRESSURE, as_dict, joints_shown, together, warnings


def show(
    identified: Identification,
    heights: Sequence[Heights],
    file: ParameterFile | None,
    args: argparse.Namespace,
) -> None:
    """Print everything; `file` is the parameter file with the surface, if one is made."""
    if args.json:
        print(json.dumps(as_dict(identified, heights, file, args)))
        return
    _print(identified, heights, file, args)
    for warning in warnings(identified, file, args):
        print(f"warning: {warning}", file=sys.stderr)


def _print(
    identified: Identification,
    heights: Sequence[Heights],
    file: ParameterFile | None,
    args: argparse.Namespace,
) -> None:
    for surface, scan in zip(heights, identified.scans, strict=True):
        print(f"{surface.name}: {synthesize.size(surface)}; {_scan(scan)}")
    print(_level(identified, file))
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
    for joint in joints_shown(args, file):
        print(f"{joint} ({meaning(joint)}, {_values(identified, joint, args)}")
    if file and file.law != ROUGHNESS_LAW:
        tell(judge_file(file), of=f"law {file.law}: ")
    if args.out:
        print(f"wrote {args.out}")
    if args.plot:
        print(f"wrote {args.plot}")


def _scan(scan: ScanRoughness) -> str:
    q, a = ("Sq", "Sa") if scan.areal else ("Rq", "Ra")
    return (
        f"{q} = {1e6 * scan.rms:.4g} um, {a} = {1e6 * scan.mean:.4g} um, "
        f"h = {1e6 * scan.h:.4g} um of waves up to {1e3 * scan.longest_wave:.4g} mm"
    )


def _level(identified: Identification, file: ParameterFile | None) -> str:
    h = together(identified, file)
    known = {name[2] for name in file.roughness} if file else set()
    if "h" in (file.roughness if file else ()) or len(known | {str(n) for n in identified.sides}) == 2:
        what = "both sides" if identified.side != "both" else "two sides like it"
    else:
        what = "one side, the other smooth"
    return (
        f"stiffness per area p/({GAMMA:g} h) = {level(UNIT_PRESSURE, h):.3g} N/m3 per MPa "
        f"(h = {1e6 * h:.4g} um of {what})"
    )


def _values(identified: Identification, joint: str, args: argparse.Namespace) -> str:
    values = changes(identified, joint, args.method)
    method = next(iter(values.values()))[1].method
    why = doubt(identified, joint)
    if why and not args.force:
        return f"{method}): {', '.join(values)} not determined: {why}"
    return f"{method}): " + ", ".join(
        f"{name} = {value:.6g}" if math.isfinite(value) else f"{name} not determined"
        for name, (value, _) in values.items()
    )


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
