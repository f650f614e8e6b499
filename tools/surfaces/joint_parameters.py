"""Which parameters of a joint a surface decides, and a parameter file with them."""

import math

from jointfmu.contact.laws import ROUGHNESS_LAW
from jointfmu.joints import KINDS
from jointfmu.joints.kind import RoughSurface
from jointfmu.parameters import ParameterFile

from .results import Estimate, Identification, Result


def changes(
    identified: Identification, joint: str, method: str | None = None
) -> dict[str, tuple[float, Result]]:
    """{structured name: (value, result it comes from)} of the rough surfaces of a joint, a key of KINDS.

    Profiles are those along the surface's direction where the measured one is textured.
    """
    if joint not in KINDS:
        raise ValueError(f"joint = {joint!r} is not one of {', '.join(KINDS)}")
    values: dict[str, tuple[float, Result]] = {}
    for surface in KINDS[joint].surfaces:
        result = identified.best(_direction(identified, surface), method)
        D, G = _dimension_and_roughness(result, surface)
        values |= {f"{surface.prefix}.D": (D.value, result), f"{surface.prefix}.G": (G.value, result)}
    return values


def doubt(identified: Identification, joint: str) -> str | None:
    """Why D and G of a joint's rough surfaces are not determined; None if all are."""
    directions = dict.fromkeys(_direction(identified, surface) for surface in KINDS[joint].surfaces)
    doubts = (identified.doubt(direction) for direction in directions)
    return next((text for text in doubts if text), None)


def _direction(identified: Identification, surface: RoughSurface) -> str | None:
    return surface.direction if identified.textured else None


def _dimension_and_roughness(result: Result, surface: RoughSurface) -> tuple[Estimate, Estimate]:
    if surface.areal:
        return result.areal.D_s, result.areal.G_s
    return result.profile.D, result.profile.G


def meaning(joint: str) -> str:
    """What D of the joint's first rough surface is."""
    return "D_s of the surface" if KINDS[joint].surfaces[0].areal else "D of the profile"


def with_surface(
    file: ParameterFile, identified: Identification, method: str | None = None, force: bool = False
) -> ParameterFile:
    """The parameter file with what the surface decides, each with its source.

    The heights of the known sides, of which the law `roughness` takes its h. With that law slope, longest
    wave and, if it is determined, the Hurst exponent; else D and G, if they are determined.

    force : D and G (the Hurst exponent) also if they are not determined; ValueError if one is no number
    """
    sure = force or doubt(identified, file.joint) is None
    if file.law == ROUGHNESS_LAW:
        file = _with_law(file, identified, method, sure)
    elif sure:
        file = _with_fractal(file, identified, method)
    for side, scan in identified.sides.items():
        name = identified.names[min(side, len(identified.names)) - 1]
        source = f"measured: {name}; waves up to {scan.longest_wave:.4g} m"
        file = file.with_roughness({f"Rq{side}": scan.h}, "user", source)
    return file


def _with_law(
    file: ParameterFile, identified: Identification, method: str | None, sure: bool
) -> ParameterFile:
    shortest, longest = identified.scans[0].shortest_wave, identified.longest_wave
    source = f"measured: {_files(identified)}; waves up to {longest:.4g} m"
    file = file.with_values({"longest_wave": longest}, "user", source)
    file = file.with_values({"slope": identified.slope}, "user", f"{source}, down to {shortest:.3g} m")
    if not sure:
        return file
    result = identified.best(method=method)
    return file.with_values({"hurst": result.fit.H}, "user", _band(identified, result))


def _with_fractal(file: ParameterFile, identified: Identification, method: str | None) -> ParameterFile:
    surfaces = {surface.prefix: surface for surface in KINDS[file.joint].surfaces}
    for name, (value, result) in changes(identified, file.joint, method).items():
        if not math.isfinite(value):
            D, G = result.profile.D.value, result.profile.G
            raise ValueError(
                f"{name} of {' and '.join(identified.names)} is not determined (D = {D:.2f}, the interval of "
                f"G spans {G.decades:.0f} decades): {file.joint} needs a number"
            )
        prefix, _, which = name.rpartition(".")
        source = _source(identified, result, surfaces[prefix], which)
        file = file.with_values({name: value}, "user", source)
    return file


def _files(identified: Identification) -> str:
    """The scanned files as text, with what they stand for."""
    if len(identified.names) == 2:
        return f"{identified.names[0]} and {identified.names[1]} (equivalent surface)"
    side = identified.side
    return identified.names[0] + (
        ""
        if side is None
        else " (both sides alike)"
        if side == "both"
        else f" (side {side}, the other smooth)"
    )


def _band(identified: Identification, result: Result) -> str:
    how = {"structure": "structure function, lags", "psd": "power spectral density, wavelengths"}
    return (
        f"identified from {_files(identified)} by {how[result.method]} "
        f"{result.fit.low:.3g} to {result.fit.high:.3g} m"
    )


def _source(identified: Identification, result: Result, surface: RoughSurface, which: str) -> str:
    D, G = _dimension_and_roughness(result, surface)
    shown = D if which == "D" else G
    if surface.areal:
        extent = "of the surface"
    else:
        extent = "of the profile" if result.direction in ("profile", "areal") else f"along {result.direction}"
    return f"{_band(identified, result)}; {extent}; 95 % interval {shown.low:.4g} to {shown.high:.4g}"
