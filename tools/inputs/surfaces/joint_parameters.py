"""Parameters of a joint that follow from a measured surface, and their entry in a parameter file."""

import math

from jointfmu.contact.laws import ROUGHNESS_LAW_NAME, TABLE_LAW_NAME
from jointfmu.joints import KINDS
from jointfmu.joints.kind import RoughSurface
from jointfmu.parameters import ParameterFile

from .results import Estimate, FractalResult, SurfaceIdentification


def fractal_parameters(
    identified_surface: SurfaceIdentification, joint_kind: str, series_method: str | None = None
) -> dict[str, tuple[float, FractalResult]]:
    """Fractal dimension D and roughness G of a joint: {parameter name: (value, result it comes from)}.

    If the measured surface is textured, a profile is taken along the direction that the joint needs.

    joint_kind    : name of the joint kind, a key of KINDS
    series_method : one of SERIES_METHODS; None: the method with the smaller standard error of D
    """
    if joint_kind not in KINDS:
        raise ValueError(f"joint = {joint_kind!r} is not one of {', '.join(KINDS)}")
    values: dict[str, tuple[float, FractalResult]] = {}
    for surface in KINDS[joint_kind].surfaces:
        result = identified_surface.select_best_result(
            _profile_direction(identified_surface, surface), series_method
        )
        D, G = _select_fractal_parameters(result, surface)
        values |= {
            f"{surface.parameter_prefix}.D": (D.estimated_value, result),
            f"{surface.parameter_prefix}.G": (G.estimated_value, result),
        }
    return values


def undetermined_reason(identified_surface: SurfaceIdentification, joint_kind: str) -> str | None:
    """Reason why fractal dimension D and roughness G of a joint are not determined; None if they are."""
    directions = dict.fromkeys(
        _profile_direction(identified_surface, surface) for surface in KINDS[joint_kind].surfaces
    )
    doubts = (identified_surface.undetermined_reason(direction) for direction in directions)
    return next((text for text in doubts if text), None)


def _profile_direction(identified_surface: SurfaceIdentification, rough_surface: RoughSurface) -> str | None:
    """Direction (x or y) of the profile that a joint needs, if the surface is textured; None: no direction.

    Without a texture, the results of the whole surface hold for all directions.
    """
    return rough_surface.profile_direction if identified_surface.is_textured else None


def _select_fractal_parameters(
    fractal_result: FractalResult, rough_surface: RoughSurface
) -> tuple[Estimate, Estimate]:
    """Fractal parameters D and G of a result: of the surface or of the profile, as the joint needs them."""
    if rough_surface.is_areal:
        return fractal_result.areal_fractal.D_s, fractal_result.areal_fractal.G_s
    return fractal_result.profile_fractal.D, fractal_result.profile_fractal.G


def describe_fractal_dimension(joint_kind: str) -> str:
    """Say whether D of a joint's first rough surface is the dimension of the surface or of a profile."""
    return "D_s of the surface" if KINDS[joint_kind].surfaces[0].is_areal else "D of the profile"


def set_surface_parameters(
    parameter_file: ParameterFile,
    identified_surface: SurfaceIdentification,
    series_method: str | None = None,
    set_undetermined: bool = False,
) -> ParameterFile:
    """Set the parameters of a parameter file that follow from a measured surface, with their sources.

    The function sets the rms heights of the measured sides. For the law `roughness` it also sets slope,
    longest wave and, if it is determined, the Hurst exponent; for fractal laws D and G, if they are
    determined. For the law `table` it sets no parameter; use `stiffness_table.set_interface_points`.

    set_undetermined : set D and G or the Hurst exponent even if they are not determined; ValueError if one is
                       not finite
    """
    sure = set_undetermined or undetermined_reason(identified_surface, parameter_file.joint) is None
    if parameter_file.law == ROUGHNESS_LAW_NAME:
        parameter_file = _set_roughness_law_parameters(
            parameter_file, identified_surface, series_method, sure
        )
    elif parameter_file.law == TABLE_LAW_NAME:
        return parameter_file  # its points follow from the heights: nothing to compare
    elif sure:
        parameter_file = _set_fractal_parameters(parameter_file, identified_surface, series_method)
    for side, scan in identified_surface.roughness_by_side.items():
        name = identified_surface.file_names[min(side, len(identified_surface.file_names)) - 1]
        source = f"measured: {name}; waves up to {scan.longest_wave:.4g} m"
        parameter_file = parameter_file.with_roughness(
            {f"Rq{side}": scan.long_wave_rms_height}, "measured", source
        )
    return parameter_file


def _set_roughness_law_parameters(
    parameter_file: ParameterFile,
    identified_surface: SurfaceIdentification,
    series_method: str | None,
    set_hurst_exponent: bool,
) -> ParameterFile:
    """Set slope, longest wave and, if it is determined, the Hurst exponent of the law `roughness`."""
    shortest, longest = identified_surface.scan_roughnesses[0].shortest_wave, identified_surface.longest_wave
    source = f"measured: {_describe_files(identified_surface)}; waves up to {longest:.4g} m"
    parameter_file = parameter_file.with_values({"longest_wave": longest}, "measured", source)
    parameter_file = parameter_file.with_values(
        {"slope": identified_surface.combined_rms_slope}, "measured", f"{source}, down to {shortest:.3g} m"
    )
    if not set_hurst_exponent:
        return parameter_file
    result = identified_surface.select_best_result(series_method=series_method)
    return parameter_file.with_values(
        {"hurst": result.fitted_law.H}, "measured", _describe_fit(identified_surface, result)
    )


def _set_fractal_parameters(
    parameter_file: ParameterFile, identified_surface: SurfaceIdentification, series_method: str | None
) -> ParameterFile:
    """Set fractal dimension D and roughness G of the rough surfaces; ValueError if one is not finite."""
    surfaces = {surface.parameter_prefix: surface for surface in KINDS[parameter_file.joint].surfaces}
    for name, (value, result) in fractal_parameters(
        identified_surface, parameter_file.joint, series_method
    ).items():
        if not math.isfinite(value):
            D, G = result.profile_fractal.D.estimated_value, result.profile_fractal.G
            raise ValueError(
                f"{name} of {' and '.join(identified_surface.file_names)} is not determined (D = {D:.2f}, "
                f"the interval of G spans {G.interval_decades:.0f} decades); state --range with a power law, "
                "or use --law roughness, which needs only the height h"
            )
        prefix, _, symbol = name.rpartition(".")
        source = _describe_source(identified_surface, result, surfaces[prefix], symbol)
        parameter_file = parameter_file.with_values({name: value}, "measured", source)
    return parameter_file


def _describe_files(identified_surface: SurfaceIdentification) -> str:
    """Name the scanned files and the sides that they represent, as text."""
    if len(identified_surface.file_names) == 2:
        return (
            f"{identified_surface.file_names[0]} and {identified_surface.file_names[1]} (equivalent surface)"
        )
    side = identified_surface.contact_side
    return identified_surface.file_names[0] + (
        ""
        if side is None
        else " (both sides alike)"
        if side == "both"
        else f" (side {side}, the other smooth)"
    )


def _describe_fit(identified_surface: SurfaceIdentification, fractal_result: FractalResult) -> str:
    """Describe files, method and range of scales of a result, for the source of a parameter."""
    methods = {"structure": "structure function, lags", "psd": "power spectral density, wavelengths"}
    return (
        f"identified from {_describe_files(identified_surface)} by {methods[fractal_result.series_method]} "
        f"{fractal_result.fitted_law.min_scale:.3g} to {fractal_result.fitted_law.max_scale:.3g} m"
    )


def _describe_source(
    identified_surface: SurfaceIdentification,
    fractal_result: FractalResult,
    rough_surface: RoughSurface,
    parameter_symbol: str,
) -> str:
    """Describe files, method, direction and confidence interval, for the source of D or G."""
    D, G = _select_fractal_parameters(fractal_result, rough_surface)
    estimate = D if parameter_symbol == "D" else G
    if rough_surface.is_areal:
        extent = "of the surface"
    else:
        extent = (
            "of the profile"
            if fractal_result.scan_direction in ("profile", "areal")
            else f"along {fractal_result.scan_direction}"
        )
    return (
        f"{_describe_fit(identified_surface, fractal_result)}; {extent}; 95 % interval "
        f"{estimate.confidence_interval_low:.4g} to {estimate.confidence_interval_high:.4g}"
    )
