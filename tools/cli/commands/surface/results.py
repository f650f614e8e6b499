"""Results of `jointfmu surface` as a JSON object, or as lines and a table."""

import argparse
import math
from collections.abc import Mapping, Sequence

from jointfmu.contact.laws import ROUGHNESS_LAW, TABLE_LAW
from jointfmu.contact.roughness import PERSSON_GAMMA, combined_height, predicted_stiffness
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Number

from ....common.judgement import Plausibility
from ....common.pressure import judge_joint_stiffness
from ....common.shown import align_columns
from ....inputs.fractal import zhao_roughness
from ....inputs.surfaces.form import ScanRoughness
from ....inputs.surfaces.heights import ArealMap, Heights
from ....inputs.surfaces.joint_parameters import dimension_meaning, fractal_parameters, undetermined_reason
from ....inputs.surfaces.results import Estimate, FractalResult, Identification
from ....inputs.surfaces.stiffness_table import InterfacePoints
from ...command import CommandResult
from . import synthesize

STATED_STIFFNESS_PRESSURE = 1e6
"""Pressure [Pa] at which the stiffness per area is reported."""


def results_to_json(
    identified_surface: Identification,
    heights: Sequence[Heights],
    parameter_file: ParameterFile | None,
    interface_points: InterfacePoints | None,
    args: argparse.Namespace,
) -> dict[str, object]:
    """JSON object of all results of `jointfmu surface`, in SI units.

    parameter_file : parameter file with the identified surface, if one is made
    """
    joints = reported_joints(args, parameter_file)
    judged = (judge_joint_stiffness(parameter_file) if parameter_file else Plausibility(None, ())).to_json()
    return {
        "files": list(identified_surface.file_names),
        "kind": "areal" if isinstance(heights[0], ArealMap) else "profile",
        "pair": len(heights) == 2,
        "side": identified_surface.side,
        "textured": identified_surface.is_textured,
        "form": args.form,
        "roughness": _roughness_to_json(identified_surface, parameter_file),
        "repairs": [
            {
                "file": n,
                "repair": r.name,
                "count": r.repaired_points,
                "points": r.total_points,
                "effect": r.effect_note[2:],
            }
            for n, r in identified_surface.repairs
        ],
        "results": [_fractal_result_to_json(result, args.gamma) for result in identified_surface.results],
        "determined": {joint: undetermined_reason(identified_surface, joint) is None for joint in joints},
        "not_determined": {
            joint: why for joint in joints if (why := undetermined_reason(identified_surface, joint))
        },
        "joints": {joint: _joint_parameters_to_json(identified_surface, joint, args) for joint in joints},
        "law": parameter_file.law if parameter_file else None,
        "table": _points_to_json(interface_points) if interface_points else None,
        "level": judged["level"],
        "written": str(args.out) if args.out else None,
        "warnings": [*collect_warnings(identified_surface, parameter_file, args), *judged["warnings"]],
    }


def _points_to_json(interface_points: InterfacePoints) -> dict[str, object]:
    """JSON object of the points of stiffness over pressure."""
    return {
        "pressure": interface_points.pressure.tolist(),
        "stiffness": interface_points.stiffness.tolist(),
        "ratio": interface_points.shear_stiffness_ratio,
        "range": list(interface_points.factor_range),
        "at_hardness": interface_points.plastic_area_share.tolist() or None,
        "source": interface_points.source,
    }


def _joint_parameters_to_json(
    identified_surface: Identification, joint_name: str, args: argparse.Namespace
) -> Mapping[str, float | None]:
    """Surface parameters of a joint: {name: value}; None if the scan does not determine them."""
    determined = args.force or undetermined_reason(identified_surface, joint_name) is None
    values = fractal_parameters(identified_surface, joint_name, args.method)
    return {name: _finite_or_none(value) if determined else None for name, (value, _) in values.items()}


def _roughness_to_json(
    identified_surface: Identification, parameter_file: ParameterFile | None
) -> dict[str, object]:
    """JSON object of the roughness: heights of each scan and of both sides together, stiffness per area."""
    h = find_combined_rms_height(identified_surface, parameter_file)
    return {
        "scans": [
            {
                "file": name,
                "Sq" if scan.is_areal else "Rq": scan.rms_height,
                "Sa" if scan.is_areal else "Ra": scan.mean_absolute_height,
                "h": scan.h,
                "Ssk" if scan.is_areal else "Rsk": scan.sample.moment(3),
                "Sku" if scan.is_areal else "Rku": scan.sample.moment(4),
                "slope": scan.slope,
            }
            for name, scan in zip(identified_surface.file_names, identified_surface.scans, strict=True)
        ],
        "longest_wave": identified_surface.longest_wave,
        "shortest_wave": identified_surface.scans[0].shortest_wave,
        "h": h,
        "slope": identified_surface.slope,
        "stiffness_per_MPa": predicted_stiffness(STATED_STIFFNESS_PRESSURE, h),
        "gaussian": identified_surface.is_gaussian,
        "tail_stiffness_ratio": 1.0 / identified_surface.tail_ratio,
    }


def _fractal_result_to_json(fractal_result: FractalResult, gamma: float) -> dict[str, object]:
    """JSON object of D and G of one scan, with their intervals."""
    fit = fractal_result.fit
    return {
        "method": fractal_result.method,
        "direction": fractal_result.direction,
        "range": [fit.min_scale, fit.max_scale],
        "decades": fit.range_decades,
        "self_affine": fit.is_self_affine,
        "at_bound": fit.is_at_bound,
        "drift_of_D": fit.dimension_drift,
        "deviation": fit.excess_deviation,
        "profile": {
            "D": _interval_to_json(fractal_result.profile.D),
            "G": _interval_to_json(fractal_result.profile.G),
        },
        "surface": {
            "D_s": _interval_to_json(fractal_result.areal.D_s),
            "G_s": _interval_to_json(fractal_result.areal.G_s),
        },
        "G_eq30": _finite_or_none(zhao_roughness(fractal_result.profile.G.value, fit.H, gamma)),
    }


def _interval_to_json(estimate: Estimate) -> dict[str, float | None]:
    """JSON object of an estimate with its confidence interval."""
    return {
        "value": _finite_or_none(estimate.value),
        "low": _finite_or_none(estimate.low),
        "high": _finite_or_none(estimate.high),
    }


def _finite_or_none(value: Number) -> float | None:
    """Convert a number for JSON; None if it is not finite, which means not determined."""
    return float(value) if math.isfinite(float(value)) else None


def find_combined_rms_height(
    identified_surface: Identification, parameter_file: ParameterFile | None
) -> float:
    """Rms height h [m] of both sides together: from the parameter file if it has one, else from the scans."""
    return combined_height(parameter_file.roughness if parameter_file else {}) or identified_surface.h


def reported_joints(args: argparse.Namespace, parameter_file: ParameterFile | None) -> list[str]:
    """Joints whose surface parameters are printed: the parameter file's, else all with a rough surface."""
    return (
        [parameter_file.joint] if parameter_file else [name for name, kind in KINDS.items() if kind.surfaces]
    )


def collect_warnings(
    identified_surface: Identification, parameter_file: ParameterFile | None, args: argparse.Namespace
) -> list[str]:
    """Collect warnings about an identified surface and the parameter file written for it."""
    lines = list(identified_surface.warnings)
    if parameter_file and parameter_file.law == ROUGHNESS_LAW and not identified_surface.is_gaussian:
        ratio = 1.0 / identified_surface.tail_ratio
        lines.append(
            f"the heights are not Gaussian: the stiffness is about {ratio:.2g} times that of the law "
            f"{ROUGHNESS_LAW}; --table FILE writes it for jointfmu new --interface-table"
        )
    if not parameter_file or not args.out or parameter_file.law == TABLE_LAW:
        return lines
    why = undetermined_reason(identified_surface, parameter_file.joint)
    names = (
        "hurst"
        if parameter_file.law == ROUGHNESS_LAW
        else ", ".join(fractal_parameters(identified_surface, parameter_file.joint))
    )
    alone = ["slope"] if parameter_file.law == ROUGHNESS_LAW else []
    if why and not args.force:
        lines.append(
            f"{names} keep their values, because they are not determined ({why}); --force writes them"
        )
    else:
        alone.append(names)
    if alone and len(identified_surface.roughness_by_side) < len(
        {name[-1] for name in parameter_file.roughness}
    ):
        side = f"values of side {identified_surface.side} alone"
        lines.append(f"{', '.join(alone)} are {side}; give both scans for the values of the pair")
    return lines


def build_result(
    identified_surface: Identification,
    heights: Sequence[Heights],
    parameter_file: ParameterFile | None,
    interface_points: InterfacePoints | None,
    args: argparse.Namespace,
) -> CommandResult:
    """Build the printed result of `jointfmu surface`: lines, table and warnings.

    parameter_file   : parameter file with the identified surface, if one is made
    interface_points : stiffness over pressure, if it is computed
    """
    lines = [
        f"{surface.name}: {synthesize.format_size(surface)}; {_format_scan(scan)}"
        for surface, scan in zip(heights, identified_surface.scans, strict=True)
    ]
    lines.append(_format_stiffness(identified_surface, parameter_file))
    lines.append(_format_tail(identified_surface))
    if interface_points and args.solve:
        lines += _format_solution(interface_points)
    if len(heights) == 2:
        lines.append("equivalent surface of the pair: structure functions and spectra added")
    lines += [f"repaired in {name}: {repair}" for name, repair in identified_surface.repairs]
    heads = ("method", "direction", "range [m]", "D, profile", "G, profile [m]", "D_s, surface", "G_s [m]")
    lines += align_columns([heads, *(_format_fractal_row(result) for result in identified_surface.results)])
    lines.append("brackets: 95 % confidence intervals")
    for joint in reported_joints(args, parameter_file):
        fractal = _format_fractal_parameters(identified_surface, joint, args)
        lines.append(f"{joint} ({dimension_meaning(joint)}, {fractal}")
    judgement = (
        judge_joint_stiffness(parameter_file)
        if parameter_file and parameter_file.law not in (ROUGHNESS_LAW, TABLE_LAW)
        else Plausibility(None, ())
    )
    prefix = f"law {parameter_file.law}: " if parameter_file else ""
    texts = [
        *(f"{prefix}{text}" for text in judgement.warnings),
        *collect_warnings(identified_surface, parameter_file, args),
    ]
    return CommandResult(
        json_document=results_to_json(identified_surface, heights, parameter_file, interface_points, args),
        lines=[*lines, *(f"{prefix}{line}" for line in judgement.format_lines())],
        notes=[f"warning: {text}" for text in texts],
        written_files=(args.out, args.table, args.plot),
    )


def _format_scan(scan: ScanRoughness) -> str:
    """Lines on one scan: size, spacing, repaired points, rms height."""
    q, a = ("Sq", "Sa") if scan.is_areal else ("Rq", "Ra")
    return (
        f"{q} = {1e6 * scan.rms_height:.4g} um, {a} = {1e6 * scan.mean_absolute_height:.4g} um, "
        f"h = {1e6 * scan.h:.4g} um of waves up to {1e3 * scan.longest_wave:.4g} mm, "
        f"{q[0]}sk = {scan.sample.moment(3):.2f}, {q[0]}ku = {scan.sample.moment(4):.2f}"
    )


def _format_tail(identified_surface: Identification) -> str:
    """Text on the effect of the skewness and kurtosis of the heights on the stiffness."""
    ratio = 1.0 / identified_surface.tail_ratio
    if identified_surface.is_gaussian:
        return f"highest points: as of Gaussian heights, stiffness {ratio:.2f} times p/(gamma h)"
    shape = "closer together (plateau)" if ratio > 1.0 else "farther apart (peaks)"
    return (
        f"highest points: {shape} than those of Gaussian heights, stiffness about {ratio:.2g} times "
        f"p/(gamma h): law {TABLE_LAW}"
    )


def _format_solution(interface_points: InterfacePoints) -> list[str]:
    """Table of the stiffness by boundary elements, and what a scan cannot determine."""
    heads = ("p [MPa]", "k [N/m3]", "at the hardness")
    rows = [
        (f"{p / 1e6:.3g}", f"{k:.3g}", f"{100.0 * share:.0f} %")
        for p, k, share in zip(
            interface_points.pressure,
            interface_points.stiffness,
            interface_points.plastic_area_share,
            strict=True,
        )
    ]
    low, high = interface_points.factor_range
    return [
        *align_columns([heads, *rows]),
        f"boundary elements; sub-areas: {low:.2f} to {high:.2f} times their mean",
        "not in the scan: waves longer than the scan, flatness, and waves shorter than the solved grid; "
        "short waves raise the stiffness of contacts at the hardness",
    ]


def _format_stiffness(identified_surface: Identification, parameter_file: ParameterFile | None) -> str:
    """Format one line of text: the stiffness per area, predicted from the rms height of the surfaces."""
    h = find_combined_rms_height(identified_surface, parameter_file)
    known = {name[2] for name in parameter_file.roughness} if parameter_file else set()
    if (
        "h" in (parameter_file.roughness if parameter_file else ())
        or len(known | {str(n) for n in identified_surface.roughness_by_side}) == 2
    ):
        what = "both sides" if identified_surface.side != "both" else "two sides like it"
    else:
        what = "one side, the other smooth"
    return (
        f"stiffness per area p/({PERSSON_GAMMA:g} h) = "
        f"{predicted_stiffness(STATED_STIFFNESS_PRESSURE, h):.3g} N/m3 per MPa "
        f"(h = {1e6 * h:.4g} um of {what})"
    )


def _format_fractal_parameters(
    identified_surface: Identification, joint_name: str, args: argparse.Namespace
) -> str:
    """Lines on D and G of all scans, as parameters of a joint."""
    values = fractal_parameters(identified_surface, joint_name, args.method)
    method = next(iter(values.values()))[1].method
    why = undetermined_reason(identified_surface, joint_name)
    if why and not args.force:
        return f"{method}): {', '.join(values)} not determined: {why}"
    return f"{method}): " + ", ".join(
        f"{name} = {value:.6g}" if math.isfinite(value) else f"{name} not determined"
        for name, (value, _) in values.items()
    )


def _format_fractal_row(fractal_result: FractalResult) -> tuple[str, ...]:
    """Row of a table with D and G of one scan."""
    profile, areal = fractal_result.profile, fractal_result.areal
    return (
        fractal_result.method,
        fractal_result.direction,
        f"{fractal_result.fit.min_scale:.2e} to {fractal_result.fit.max_scale:.2e}",
        _format_interval(profile.D, ".3f"),
        _format_interval(profile.G, ".2e"),
        *(
            (_format_interval(areal.D_s, ".3f"), _format_interval(areal.G_s, ".2e"))
            if fractal_result.direction in ("areal", "profile")
            else ("", "")
        ),
    )


def _format_interval(estimate: Estimate, number_format: str) -> str:
    """Format an estimate with its confidence interval."""
    if not math.isfinite(estimate.value):
        return "not determined"
    return (
        f"{estimate.value:{number_format}} [{estimate.low:{number_format}}, {estimate.high:{number_format}}]"
    )
