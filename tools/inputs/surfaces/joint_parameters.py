"""Parameters of a joint that follow from a measured surface, and their entry in a parameter file."""

import math

from jointfmu.contact.laws import ROUGHNESS_LAW, TABLE_LAW
from jointfmu.joints import KINDS
from jointfmu.joints.kind import RoughSurface
from jointfmu.parameters import ParameterFile

from .results import Estimate, FractalResult, Identification


def fractal_parameters(
    identified_surface: Identification, joint: str, method: str | None = None
) -> dict[str, tuple[float, FractalResult]]:
    """D and G of the rough surfaces of a joint kind: {parameter name: (value, result it comes from)}.

    If the measured surface is textured, a profile is taken along the direction that the joint needs.

    joint  : name of the joint kind, a key of KINDS
    method : one of METHODS; None: the better one
    """
    if joint not in KINDS:
        raise ValueError(f"joint = {joint!r} is not one of {', '.join(KINDS)}")
    values: dict[str, tuple[float, FractalResult]] = {}
    for surface in KINDS[joint].surfaces:
        result = identified_surface.select_best_result(
            _profile_direction(identified_surface, surface), method
        )
        D, G = _dimension_and_roughness(result, surface)
        values |= {
            f"{surface.parameter_prefix}.D": (D.value, result),
            f"{surface.parameter_prefix}.G": (G.value, result),
        }
    return values


def undetermined_reason(identified_surface: Identification, joint: str) -> str | None:
    """Reason why D and G of the rough surfaces of a joint are not determined; None if they are."""
    directions = dict.fromkeys(
        _profile_direction(identified_surface, surface) for surface in KINDS[joint].surfaces
    )
    doubts = (identified_surface.undetermined_reason(direction) for direction in directions)
    return next((text for text in doubts if text), None)


def _profile_direction(identified_surface: Identification, surface: RoughSurface) -> str | None:
    """Direction that the joint needs, if the measured surface is textured; else None: the whole surface."""
    return surface.direction if identified_surface.is_textured else None


def _dimension_and_roughness(
    fractal_result: FractalResult, surface: RoughSurface
) -> tuple[Estimate, Estimate]:
    """Fractal parameters D and G of a result: of the surface or of the profile, as the joint needs them."""
    if surface.is_areal:
        return fractal_result.areal.D_s, fractal_result.areal.G_s
    return fractal_result.profile.D, fractal_result.profile.G


def dimension_meaning(joint: str) -> str:
    """Meaning of D of the first rough surface of a joint, as text."""
    return "D_s of the surface" if KINDS[joint].surfaces[0].is_areal else "D of the profile"


def with_surface(
    parameter_file: ParameterFile,
    identified_surface: Identification,
    method: str | None = None,
    set_undetermined: bool = False,
) -> ParameterFile:
    """Set the parameters of a parameter file that follow from a measured surface, with their sources.

    The function sets the rms heights of the measured sides. For the law `roughness` it also sets slope,
    longest wave and, if it is determined, the Hurst exponent; for fractal laws D and G, if they are
    determined. For the law `table` it sets no parameter: `stiffness_table.with_points` sets the points.

    set_undetermined : set D and G or the Hurst exponent even if they are not determined; ValueError if one is
        not finite
    """
    sure = set_undetermined or undetermined_reason(identified_surface, parameter_file.joint) is None
    if parameter_file.law == ROUGHNESS_LAW:
        parameter_file = _with_roughness_law(parameter_file, identified_surface, method, sure)
    elif parameter_file.law == TABLE_LAW:
        return parameter_file  # its points follow from the heights: nothing to compare
    elif sure:
        parameter_file = _with_fractal_parameters(parameter_file, identified_surface, method)
    for side, scan in identified_surface.roughness_by_side.items():
        name = identified_surface.file_names[min(side, len(identified_surface.file_names)) - 1]
        source = f"measured: {name}; waves up to {scan.longest_wave:.4g} m"
        parameter_file = parameter_file.with_roughness({f"Rq{side}": scan.h}, "measured", source)
    return parameter_file


def _with_roughness_law(
    parameter_file: ParameterFile, identified_surface: Identification, method: str | None, set_hurst: bool
) -> ParameterFile:
    """Set slope, longest wave and, if it is determined, the Hurst exponent of the law `roughness`."""
    shortest, longest = identified_surface.scans[0].shortest_wave, identified_surface.longest_wave
    source = f"measured: {_describe_files(identified_surface)}; waves up to {longest:.4g} m"
    parameter_file = parameter_file.with_values({"longest_wave": longest}, "measured", source)
    parameter_file = parameter_file.with_values(
        {"slope": identified_surface.slope}, "measured", f"{source}, down to {shortest:.3g} m"
    )
    if not set_hurst:
        return parameter_file
    result = identified_surface.select_best_result(method=method)
    return parameter_file.with_values(
        {"hurst": result.fit.H}, "measured", _describe_fit(identified_surface, result)
    )


def _with_fractal_parameters(
    parameter_file: ParameterFile, identified_surface: Identification, method: str | None
) -> ParameterFile:
    """Set D and G of the rough surfaces of the joint; ValueError if one is not finite."""
    surfaces = {surface.parameter_prefix: surface for surface in KINDS[parameter_file.joint].surfaces}
    for name, (value, result) in fractal_parameters(identified_surface, parameter_file.joint, method).items():
        if not math.isfinite(value):
            D, G = result.profile.D.value, result.profile.G
            raise ValueError(
                f"{name} of {' and '.join(identified_surface.file_names)} is not determined (D = {D:.2f}, "
                "the interval of "
                f"G spans {G.interval_decades:.0f} decades): {parameter_file.joint} needs a number"
            )
        prefix, _, symbol = name.rpartition(".")
        source = _describe_source(identified_surface, result, surfaces[prefix], symbol)
        parameter_file = parameter_file.with_values({name: value}, "measured", source)
    return parameter_file


def _describe_files(identified_surface: Identification) -> str:
    """Name the scanned files and the sides that they represent, as text."""
    if len(identified_surface.file_names) == 2:
        return (
            f"{identified_surface.file_names[0]} and {identified_surface.file_names[1]} (equivalent surface)"
        )
    side = identified_surface.side
    return identified_surface.file_names[0] + (
        ""
        if side is None
        else " (both sides alike)"
        if side == "both"
        else f" (side {side}, the other smooth)"
    )


def _describe_fit(identified_surface: Identification, fractal_result: FractalResult) -> str:
    """Describe files, method and range of scales of a result, for the source of a parameter."""
    methods = {"structure": "structure function, lags", "psd": "power spectral density, wavelengths"}
    return (
        f"identified from {_describe_files(identified_surface)} by {methods[fractal_result.method]} "
        f"{fractal_result.fit.min_scale:.3g} to {fractal_result.fit.max_scale:.3g} m"
    )


def _describe_source(
    identified_surface: Identification, fractal_result: FractalResult, surface: RoughSurface, symbol: str
) -> str:
    """Describe files, method, direction and confidence interval, for the source of D or G."""
    D, G = _dimension_and_roughness(fractal_result, surface)
    estimate = D if symbol == "D" else G
    if surface.is_areal:
        extent = "of the surface"
    else:
        extent = (
            "of the profile"
            if fractal_result.direction in ("profile", "areal")
            else f"along {fractal_result.direction}"
        )
    return (
        f"{_describe_fit(identified_surface, fractal_result)}; {extent}; 95 % interval {estimate.low:.4g} to "
        f"{estimate.high:.4g}"
    )
