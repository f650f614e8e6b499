"""Results of `jointfmu surface` as a JSON object, or as lines and a table."""

import argparse
import math
from collections.abc import Mapping, Sequence

from jointfmu.contact.laws import ROUGHNESS_LAW
from jointfmu.contact.roughness import GAMMA, height, level
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Number

from ...command_line.common import Answer
from ...fractal import zhao_roughness
from ...judgement import Judgement
from ...pressure import judge_file
from ...shown import aligned
from ...surfaces.form import ScanRoughness
from ...surfaces.heights import Areal, Heights
from ...surfaces.joint_parameters import changes, doubt, meaning
from ...surfaces.results import Estimate, Identification, Result
from . import synthesize

UNIT_PRESSURE = 1e6
"""Pressure [Pa] at which the stiffness per area is reported."""


def as_dict(
    identified: Identification,
    heights: Sequence[Heights],
    file: ParameterFile | None,
    args: argparse.Namespace,
) -> dict[str, object]:
    """JSON object of all results, in SI units.

    file : parameter file with the identified surface, if one is made
    """
    joints = joints_shown(args, file)
    judged = (judge_file(file) if file else Judgement(None, ())).document()
    return {
        "files": list(identified.names),
        "kind": "areal" if isinstance(heights[0], Areal) else "profile",
        "pair": len(heights) == 2,
        "side": identified.side,
        "textured": identified.textured,
        "form": args.form,
        "roughness": _roughness_dict(identified, file),
        "repairs": [
            {"file": n, "repair": r.name, "count": r.count, "points": r.points, "effect": r.effect[2:]}
            for n, r in identified.repairs
        ],
        "results": [_result_dict(result, args.gamma) for result in identified.results],
        "determined": {joint: doubt(identified, joint) is None for joint in joints},
        "not_determined": {joint: why for joint in joints if (why := doubt(identified, joint))},
        "joints": {joint: _joint_dict(identified, joint, args) for joint in joints},
        "law": file.law if file else None,
        "level": judged["level"],
        "written": str(args.out) if args.out else None,
        "warnings": [*warnings(identified, file, args), *judged["warnings"]],
    }


def _joint_dict(
    identified: Identification, joint: str, args: argparse.Namespace
) -> Mapping[str, float | None]:
    determined = args.force or doubt(identified, joint) is None
    values = changes(identified, joint, args.method)
    return {name: _number(value) if determined else None for name, (value, _) in values.items()}


def _roughness_dict(identified: Identification, file: ParameterFile | None) -> dict[str, object]:
    """JSON object of the roughness: heights of each scan and of both sides together, stiffness per area."""
    h = together(identified, file)
    return {
        "scans": [
            {
                "file": name,
                "Sq" if scan.areal else "Rq": scan.rms,
                "Sa" if scan.areal else "Ra": scan.mean,
                "h": scan.h,
                "slope": scan.slope,
            }
            for name, scan in zip(identified.names, identified.scans, strict=True)
        ],
        "longest_wave": identified.longest_wave,
        "shortest_wave": identified.scans[0].shortest_wave,
        "h": h,
        "slope": identified.slope,
        "stiffness_per_MPa": level(UNIT_PRESSURE, h),
    }


def _result_dict(result: Result, gamma: float) -> dict[str, object]:
    fit = result.fit
    return {
        "method": result.method,
        "direction": result.direction,
        "range": [fit.low, fit.high],
        "decades": fit.decades,
        "self_affine": fit.straight,
        "at_bound": fit.at_bound,
        "drift_of_D": fit.drift,
        "deviation": fit.deviation,
        "profile": {"D": _interval(result.profile.D), "G": _interval(result.profile.G)},
        "surface": {"D_s": _interval(result.areal.D_s), "G_s": _interval(result.areal.G_s)},
        "G_eq30": _number(zhao_roughness(result.profile.G.value, fit.H, gamma)),
    }


def _interval(estimate: Estimate) -> dict[str, float | None]:
    return {"value": _number(estimate.value), "low": _number(estimate.low), "high": _number(estimate.high)}


def _number(value: Number) -> float | None:
    """Convert a number for JSON; None if it is not finite, which means not determined."""
    return float(value) if math.isfinite(float(value)) else None


def together(identified: Identification, file: ParameterFile | None) -> float:
    """Rms height h [m] of both sides together: from the parameter file if it has one, else from the scans."""
    return height(file.roughness if file else {}) or identified.h


def joints_shown(args: argparse.Namespace, file: ParameterFile | None) -> list[str]:
    """Joints to report: that of the parameter file, else all joints with a rough surface."""
    return [file.joint] if file else [name for name, kind in KINDS.items() if kind.surfaces]


def warnings(identified: Identification, file: ParameterFile | None, args: argparse.Namespace) -> list[str]:
    """Collect warnings about the identified surface and the written parameter file."""
    lines = list(identified.warnings)
    if not file or not args.out:
        return lines
    why = doubt(identified, file.joint)
    names = "hurst" if file.law == ROUGHNESS_LAW else ", ".join(changes(identified, file.joint))
    alone = ["slope"] if file.law == ROUGHNESS_LAW else []
    if why and not args.force:
        lines.append(f"{names} stay as they were, since they are not determined ({why}); --force writes them")
    else:
        alone.append(names)
    if alone and len(identified.sides) < len({name[-1] for name in file.roughness}):
        side = f"values of side {identified.side} alone"
        lines.append(f"{', '.join(alone)} are {side}; give both scans for the values of the pair")
    return lines


def answer(
    identified: Identification,
    heights: Sequence[Heights],
    file: ParameterFile | None,
    args: argparse.Namespace,
) -> Answer:
    """Build the result of the command: lines, table and warnings.

    file : parameter file with the identified surface, if one is made
    """
    lines = [
        f"{surface.name}: {synthesize.size(surface)}; {_scan(scan)}"
        for surface, scan in zip(heights, identified.scans, strict=True)
    ]
    lines.append(_level(identified, file))
    if len(heights) == 2:
        lines.append("equivalent surface of the pair: structure functions and spectra added")
    lines += [f"repaired in {name}: {repair}" for name, repair in identified.repairs]
    heads = ("method", "direction", "range [m]", "D, profile", "G, profile [m]", "D_s, surface", "G_s [m]")
    lines += aligned([heads, *(_row(result) for result in identified.results)])
    lines.append("brackets: 95 % confidence intervals")
    for joint in joints_shown(args, file):
        lines.append(f"{joint} ({meaning(joint)}, {_values(identified, joint, args)}")
    judgement = judge_file(file) if file and file.law != ROUGHNESS_LAW else Judgement(None, ())
    prefix = f"law {file.law}: " if file else ""
    texts = [*(f"{prefix}{text}" for text in judgement.warnings), *warnings(identified, file, args)]
    return Answer(
        document=as_dict(identified, heights, file, args),
        lines=[*lines, *(f"{prefix}{line}" for line in judgement.lines())],
        notes=[f"warning: {text}" for text in texts],
        written=(args.out, args.plot),
    )


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
