"""Results of `jointfmu surface` as a JSON object, or as lines and a table."""

import argparse
import math
from collections.abc import Mapping, Sequence

from jointfmu.contact.laws import ROUGHNESS_LAW_NAME, TABLE_LAW_NAME
from jointfmu.contact.roughness import PERSSON_GAMMA, combined_height, predicted_stiffness
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Number

from ....common.judgement import Plausibility
from ....common.pressure import judge_joint_stiffness
from ....common.shown import align_columns
from ....inputs.fractal import zhao_fractal_roughness
from ....inputs.surfaces.form import ScanRoughness
from ....inputs.surfaces.heights import ArealMap, ScanHeights
from ....inputs.surfaces.joint_parameters import (
    describe_fractal_dimension,
    fractal_parameters,
    undetermined_reason,
)
from ....inputs.surfaces.results import Estimate, FractalResult, SurfaceIdentification
from ....inputs.surfaces.stiffness_table import (
    MAX_PLASTIC_AREA_SHARE,
    PLASTIC_STIFFNESS_FACTOR,
    InterfacePoints,
)
from ...command import CommandResult
from . import synthesize

PRESSURE_OF_STATED_STIFFNESS = 1e6
"""Pressure [Pa] at which the stiffness per area is reported."""


def results_to_json(
    identified_surface: SurfaceIdentification,
    surface_heights: Sequence[ScanHeights],
    parameter_file: ParameterFile | None,
    stiffness_points: InterfacePoints | None,
    args: argparse.Namespace,
) -> dict[str, object]:
    """JSON object of all results of `jointfmu surface`, in SI units.

    parameter_file : parameter file with the identified surface, if one is made
    """
    joints = list_reported_joints(args, parameter_file)
    judged = (judge_joint_stiffness(parameter_file) if parameter_file else Plausibility(None, ())).to_json()
    return {
        "files": list(identified_surface.file_names),
        "kind": "areal" if isinstance(surface_heights[0], ArealMap) else "profile",
        "pair": len(surface_heights) == 2,
        "side": identified_surface.contact_side,
        "textured": identified_surface.is_textured,
        "form": args.form,
        "roughness": _roughness_to_json(identified_surface, parameter_file),
        "repairs": [
            {
                "file": n,
                "repair": r.repair_name,
                "count": r.repaired_point_count,
                "points": r.total_point_count,
                "effect": r.effect_note[2:],
            }
            for n, r in identified_surface.scan_repairs
        ],
        "results": [
            _fractal_result_to_json(result, args.gamma) for result in identified_surface.fractal_results
        ],
        "determined": {joint: undetermined_reason(identified_surface, joint) is None for joint in joints},
        "not_determined": {
            joint: why for joint in joints if (why := undetermined_reason(identified_surface, joint))
        },
        "joints": {joint: _joint_parameters_to_json(identified_surface, joint, args) for joint in joints},
        "law": parameter_file.law if parameter_file else None,
        "table": _stiffness_points_to_json(stiffness_points) if stiffness_points else None,
        "level": judged["level"],
        "written": str(args.out) if args.out else None,
        "warnings": [
            *collect_surface_warnings(identified_surface, parameter_file, stiffness_points, args),
            *judged["warnings"],
        ],
    }


def _stiffness_points_to_json(stiffness_points: InterfacePoints) -> dict[str, object]:
    """JSON object of the points of the interface stiffness as a function of pressure."""
    return {
        "pressure": stiffness_points.nominal_pressure.tolist(),
        "stiffness": stiffness_points.normal_stiffness.tolist(),
        "ratio": stiffness_points.shear_stiffness_ratio,
        "range": list(stiffness_points.stiffness_factor_range),
        "at_hardness": stiffness_points.plastic_area_share.tolist() or None,
        "source": stiffness_points.points_source,
    }


def _joint_parameters_to_json(
    identified_surface: SurfaceIdentification, joint_name: str, args: argparse.Namespace
) -> Mapping[str, float | None]:
    """Surface parameters of a joint: {name: value}; None if the scan does not determine them."""
    determined = args.force or undetermined_reason(identified_surface, joint_name) is None
    values = fractal_parameters(identified_surface, joint_name, args.method)
    return {name: _finite_or_none(value) if determined else None for name, (value, _) in values.items()}


def _roughness_to_json(
    identified_surface: SurfaceIdentification, parameter_file: ParameterFile | None
) -> dict[str, object]:
    """JSON object of the roughness: heights of each scan and of both sides together, stiffness per area."""
    h = find_combined_rms_height(identified_surface, parameter_file)
    return {
        "scans": [
            {
                "file": name,
                "Sq" if scan.is_areal else "Rq": scan.rms_height,
                "Sa" if scan.is_areal else "Ra": scan.mean_absolute_height,
                "h": scan.long_wave_rms_height,
                "Ssk" if scan.is_areal else "Rsk": scan.height_sample.standardized_moment(3),
                "Sku" if scan.is_areal else "Rku": scan.height_sample.standardized_moment(4),
                "slope": scan.rms_slope,
            }
            for name, scan in zip(
                identified_surface.file_names, identified_surface.scan_roughnesses, strict=True
            )
        ],
        "longest_wave": identified_surface.longest_wave,
        "shortest_wave": identified_surface.scan_roughnesses[0].shortest_wave,
        "h": h,
        "slope": identified_surface.combined_rms_slope,
        "stiffness_per_MPa": predicted_stiffness(PRESSURE_OF_STATED_STIFFNESS, h),
        "gaussian": identified_surface.is_gaussian,
        "tail_stiffness_ratio": 1.0 / identified_surface.tail_over_rms_height,
    }


def _fractal_result_to_json(fractal_result: FractalResult, wave_frequency_ratio: float) -> dict[str, object]:
    """JSON object of fractal dimension D and fractal roughness G of one scan, with confidence intervals."""
    fit = fractal_result.fitted_law
    return {
        "method": fractal_result.series_method,
        "direction": fractal_result.scan_direction,
        "range": [fit.min_scale, fit.max_scale],
        "decades": fit.range_decades,
        "self_affine": fit.is_self_affine,
        "at_bound": fit.is_at_bound,
        "drift_of_D": fit.dimension_drift,
        "deviation": fit.excess_deviation,
        "profile": {
            "D": _estimate_to_json(fractal_result.profile_fractal.D),
            "G": _estimate_to_json(fractal_result.profile_fractal.G),
        },
        "surface": {
            "D_s": _estimate_to_json(fractal_result.areal_fractal.D_s),
            "G_s": _estimate_to_json(fractal_result.areal_fractal.G_s),
        },
        "G_eq30": _finite_or_none(
            zhao_fractal_roughness(
                fractal_result.profile_fractal.G.estimated_value, fit.H, wave_frequency_ratio
            )
        ),
    }


def _estimate_to_json(parameter_estimate: Estimate) -> dict[str, float | None]:
    """JSON object of an estimated surface parameter with its confidence interval."""
    return {
        "value": _finite_or_none(parameter_estimate.estimated_value),
        "low": _finite_or_none(parameter_estimate.confidence_interval_low),
        "high": _finite_or_none(parameter_estimate.confidence_interval_high),
    }


def _finite_or_none(computed_number: Number) -> float | None:
    """Convert a number for JSON; None if it is not finite, which means not determined."""
    return float(computed_number) if math.isfinite(float(computed_number)) else None


def find_combined_rms_height(
    identified_surface: SurfaceIdentification, parameter_file: ParameterFile | None
) -> float:
    """Rms height h [m] of both sides together: from the parameter file if it has one, else from the scans."""
    return (
        combined_height(parameter_file.roughness if parameter_file else {})
        or identified_surface.combined_rms_height
    )


def list_reported_joints(args: argparse.Namespace, parameter_file: ParameterFile | None) -> list[str]:
    """Joints whose surface parameters are printed: the parameter file's, else all with a rough surface."""
    return (
        [parameter_file.joint] if parameter_file else [name for name, kind in KINDS.items() if kind.surfaces]
    )


def collect_surface_warnings(
    identified_surface: SurfaceIdentification,
    parameter_file: ParameterFile | None,
    stiffness_points: InterfacePoints | None,
    args: argparse.Namespace,
) -> list[str]:
    """Collect warnings about an identified surface, its stiffness, and the parameter file written for it."""
    lines = list(identified_surface.warnings)
    if stiffness_points and stiffness_points.is_mostly_plastic:
        lines.append(
            f"up to {100.0 * stiffness_points.plastic_area_share.max():.0f} % of the contact is at the "
            f"hardness: from {100.0 * MAX_PLASTIC_AREA_SHARE:g} % on, the stiffness depends on waves below "
            f"the solved grid, so the range is widened by a factor of {PLASTIC_STIFFNESS_FACTOR:g}; measure "
            "the joint for a narrower range (docs/surfaces.md)"
        )
    if parameter_file and parameter_file.law == ROUGHNESS_LAW_NAME and not identified_surface.is_gaussian:
        ratio = 1.0 / identified_surface.tail_over_rms_height
        lines.append(
            f"the heights are not Gaussian: the stiffness is about {ratio:.2g} times that of the law "
            f"{ROUGHNESS_LAW_NAME}; --table FILE writes it for jointfmu new --interface-table"
        )
    if args.out and args.joint and not args.params:
        lines.append(
            f"everything but the surface is of the shipped joint {load_default(args.joint).name!r}: sizes, "
            "material, friction; for your joint, make a file with jointfmu new "
            f"{args.joint.replace('_', '-')}, and state it by --params"
        )
    if not parameter_file or not args.out or parameter_file.law == TABLE_LAW_NAME:
        return lines
    why = undetermined_reason(identified_surface, parameter_file.joint)
    names = (
        "hurst"
        if parameter_file.law == ROUGHNESS_LAW_NAME
        else ", ".join(fractal_parameters(identified_surface, parameter_file.joint))
    )
    alone = ["slope"] if parameter_file.law == ROUGHNESS_LAW_NAME else []
    if why and not args.force:
        lines.append(
            f"{names} keep their values, because they are not determined ({why}); --force writes them"
        )
    else:
        alone.append(names)
    if alone and len(identified_surface.roughness_by_side) < len(
        {name[-1] for name in parameter_file.roughness}
    ):
        side = f"values of side {identified_surface.contact_side} alone"
        lines.append(f"{', '.join(alone)} are {side}; give both scans for the values of the pair")
    return lines


def build_surface_result(
    identified_surface: SurfaceIdentification,
    surface_heights: Sequence[ScanHeights],
    parameter_file: ParameterFile | None,
    stiffness_points: InterfacePoints | None,
    args: argparse.Namespace,
) -> CommandResult:
    """Build the printed result of `jointfmu surface`: lines, table and warnings.

    parameter_file   : parameter file with the identified surface, if one is made
    stiffness_points : stiffness as a function of pressure, if it is computed
    """
    lines = [
        f"{surface.scan_name}: {synthesize.format_surface_size(surface)}; {_format_scan_roughness(scan)}"
        for surface, scan in zip(surface_heights, identified_surface.scan_roughnesses, strict=True)
    ]
    lines.append(_format_stiffness(identified_surface, parameter_file))
    lines.append(_describe_height_tail(identified_surface))
    if stiffness_points and args.solve:
        lines += _format_boundary_element_table(stiffness_points)
    if len(surface_heights) == 2:
        lines.append("equivalent surface of the pair: structure functions and spectra added")
    elif identified_surface.contact_side == "both":
        lines.append("D and G of both sides together: structure function and spectrum of the scan doubled")
    lines += [f"repaired in {name}: {repair}" for name, repair in identified_surface.scan_repairs]
    heads = ("method", "direction", "range [m]", "D, profile", "G, profile [m]", "D_s, surface", "G_s [m]")
    lines += align_columns(
        [heads, *(_format_fractal_row(result) for result in identified_surface.fractal_results)]
    )
    lines.append("brackets: 95 % confidence intervals")
    for joint in list_reported_joints(args, parameter_file):
        fractal = _format_fractal_parameters(identified_surface, joint, args)
        lines.append(f"{joint} ({describe_fractal_dimension(joint)}, {fractal}")
    judgement = (
        judge_joint_stiffness(parameter_file)
        if parameter_file and parameter_file.law not in (ROUGHNESS_LAW_NAME, TABLE_LAW_NAME)
        else Plausibility(None, ())
    )
    prefix = f"law {parameter_file.law}: " if parameter_file else ""
    texts = [
        *(f"{prefix}{text}" for text in judgement.warnings),
        *collect_surface_warnings(identified_surface, parameter_file, stiffness_points, args),
    ]
    return CommandResult(
        json_document=results_to_json(
            identified_surface, surface_heights, parameter_file, stiffness_points, args
        ),
        output_lines=[*lines, *(f"{prefix}{line}" for line in judgement.format_lines())],
        stderr_lines=[f"warning: {text}" for text in texts],
        written_files=(args.out, args.table, args.plot),
    )


def _format_scan_roughness(scan_roughness: ScanRoughness) -> str:
    """Lines on one scan: size, spacing, repaired points, rms height."""
    q, a = ("Sq", "Sa") if scan_roughness.is_areal else ("Rq", "Ra")
    return (
        f"{q} = {1e6 * scan_roughness.rms_height:.4g} um, {a} = "
        f"{1e6 * scan_roughness.mean_absolute_height:.4g} um, h = "
        f"{1e6 * scan_roughness.long_wave_rms_height:.4g} um of waves up to "
        f"{1e3 * scan_roughness.longest_wave:.4g} mm, {q[0]}sk = "
        f"{scan_roughness.height_sample.standardized_moment(3):.2f}, {q[0]}ku = "
        f"{scan_roughness.height_sample.standardized_moment(4):.2f}"
    )


def _describe_height_tail(identified_surface: SurfaceIdentification) -> str:
    """Text on the effect of the skewness and kurtosis of the heights on the stiffness."""
    ratio = 1.0 / identified_surface.tail_over_rms_height
    if identified_surface.is_gaussian:
        return f"highest points: as of Gaussian heights, stiffness {ratio:.2f} times p/(gamma h)"
    shape = "closer together (plateau)" if ratio > 1.0 else "farther apart (peaks)"
    return (
        f"highest points: {shape} than those of Gaussian heights, stiffness about {ratio:.2g} times "
        f"p/(gamma h): law {TABLE_LAW_NAME}"
    )


def _format_boundary_element_table(stiffness_points: InterfacePoints) -> list[str]:
    """Table of the stiffness by boundary elements, with a note on what a scan cannot determine."""
    heads = ("p [MPa]", "k [N/m3]", "at the hardness")
    rows = [
        (f"{p / 1e6:.3g}", f"{k:.3g}", f"{100.0 * share:.0f} %")
        for p, k, share in zip(
            stiffness_points.nominal_pressure,
            stiffness_points.normal_stiffness,
            stiffness_points.plastic_area_share,
            strict=True,
        )
    ]
    low, high = stiffness_points.stiffness_factor_range
    return [
        *align_columns([heads, *rows]),
        f"boundary elements; range of the stiffness: {low:.2f} to {high:.2f} times these values",
        "not in the scan: waves longer than the scan, flatness, and waves shorter than the solved grid; "
        "short waves raise the stiffness of contacts at the hardness",
    ]


def _format_stiffness(identified_surface: SurfaceIdentification, parameter_file: ParameterFile | None) -> str:
    """Format one line of text: the stiffness per area, predicted from the rms height of the surfaces."""
    h = find_combined_rms_height(identified_surface, parameter_file)
    known = {name[2] for name in parameter_file.roughness} if parameter_file else set()
    if (
        "h" in (parameter_file.roughness if parameter_file else ())
        or len(known | {str(n) for n in identified_surface.roughness_by_side}) == 2
    ):
        what = "both sides" if identified_surface.contact_side != "both" else "two sides like it"
    else:
        what = "one side, the other smooth"
    return (
        f"stiffness per area p/({PERSSON_GAMMA:g} h) = "
        f"{predicted_stiffness(PRESSURE_OF_STATED_STIFFNESS, h):.3g} N/m3 per MPa (h = {1e6 * h:.4g} um of "
        f"{what})"
    )


def _format_fractal_parameters(
    identified_surface: SurfaceIdentification, joint_name: str, args: argparse.Namespace
) -> str:
    """Text on fractal dimension D and fractal roughness G of all scans, as parameters of a joint."""
    values = fractal_parameters(identified_surface, joint_name, args.method)
    method = next(iter(values.values()))[1].series_method
    why = undetermined_reason(identified_surface, joint_name)
    if why and not args.force:
        return f"{method}): {', '.join(values)} not determined: {why}"
    return f"{method}): " + ", ".join(
        f"{name} = {value:.6g}" if math.isfinite(value) else f"{name} not determined"
        for name, (value, _) in values.items()
    )


def _format_fractal_row(fractal_result: FractalResult) -> tuple[str, ...]:
    """Row of a table: fractal dimension D and fractal roughness G of one scan."""
    profile, areal = fractal_result.profile_fractal, fractal_result.areal_fractal
    return (
        fractal_result.series_method,
        fractal_result.scan_direction,
        f"{fractal_result.fitted_law.min_scale:.2e} to {fractal_result.fitted_law.max_scale:.2e}",
        _format_estimate(profile.D, ".3f"),
        _format_estimate(profile.G, ".2e"),
        *(
            (_format_estimate(areal.D_s, ".3f"), _format_estimate(areal.G_s, ".2e"))
            if fractal_result.scan_direction in ("areal", "profile")
            else ("", "")
        ),
    )


def _format_estimate(parameter_estimate: Estimate, number_format: str) -> str:
    """Format an estimated surface parameter with its confidence interval."""
    if not math.isfinite(parameter_estimate.estimated_value):
        return "not determined"
    return (
        f"{parameter_estimate.estimated_value:{number_format}} "
        f"[{parameter_estimate.confidence_interval_low:{number_format}}, "
        f"{parameter_estimate.confidence_interval_high:{number_format}}]"
    )
