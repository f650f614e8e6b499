"""Parameters of a joint that follow from a measured surface, and their entry in a parameter file."""

import math

from jointfmu.contact.laws import ROUGHNESS_LAW
from jointfmu.joints import KINDS
from jointfmu.joints.kind import RoughSurface
from jointfmu.parameters import ParameterFile

from .results import Estimate, Identification, Result


def changes(
    identified: Identification, joint: str, method: str | None = None
) -> dict[str, tuple[float, Result]]:
    """D and G of the rough surfaces of a joint kind: {parameter name: (value, result it comes from)}.

    If the measured surface is textured, a profile is taken along the direction that the joint needs.

    joint  : name of the joint kind, a key of KINDS
    method : one of METHODS; None: the better one
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
    """Reason why D and G of the rough surfaces of a joint are not determined; None if they are."""
    directions = dict.fromkeys(_direction(identified, surface) for surface in KINDS[joint].surfaces)
    doubts = (identified.doubt(direction) for direction in directions)
    return next((text for text in doubts if text), None)


def _direction(identified: Identification, surface: RoughSurface) -> str | None:
    """Direction that the joint needs, if the measured surface is textured; else None: the whole surface."""
    return surface.direction if identified.textured else None


def _dimension_and_roughness(result: Result, surface: RoughSurface) -> tuple[Estimate, Estimate]:
    """D and G that the joint needs: of the surface or of the profile."""
    if surface.areal:
        return result.areal.D_s, result.areal.G_s
    return result.profile.D, result.profile.G


def meaning(joint: str) -> str:
    """Meaning of D of the first rough surface of a joint, as text."""
    return "D_s of the surface" if KINDS[joint].surfaces[0].areal else "D of the profile"


def with_surface(
    file: ParameterFile, identified: Identification, method: str | None = None, force: bool = False
) -> ParameterFile:
    """Set the parameters of a file that follow from a measured surface, with their sources.

    These are the rms heights of the measured sides. With the law `roughness` also slope, longest wave and, if
    it is determined, the Hurst exponent. With other laws also D and G, if they are determined.

    force : set D and G or the Hurst exponent even if they are not determined; ValueError if one is not finite
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
    """Set slope, longest wave and, if it is determined, the Hurst exponent of the law `roughness`."""
    shortest, longest = identified.scans[0].shortest_wave, identified.longest_wave
    source = f"measured: {_files(identified)}; waves up to {longest:.4g} m"
    file = file.with_values({"longest_wave": longest}, "user", source)
    file = file.with_values({"slope": identified.slope}, "user", f"{source}, down to {shortest:.3g} m")
    if not sure:
        return file
    result = identified.best(method=method)
    return file.with_values({"hurst": result.fit.H}, "user", _band(identified, result))


def _with_fractal(file: ParameterFile, identified: Identification, method: str | None) -> ParameterFile:
    """Set D and G of the rough surfaces of the joint; ValueError if one is not finite."""
    surfaces = {surface.prefix: surface for surface in KINDS[file.joint].surfaces}
    for name, (value, result) in changes(identified, file.joint, method).items():
        if not math.isfinite(value):
            D, G = result.profile.D.value, result.profile.G
            raise ValueError(
                f"{name} of {' and '.join(identified.names)} is not determined (D = {D:.2f}, the interval of "
                f"G spans {G.decades:.0f} decades): {file.joint} needs a number"
            )
        prefix, _, symbol = name.rpartition(".")
        source = _source(identified, result, surfaces[prefix], symbol)
        file = file.with_values({name: value}, "user", source)
    return file


def _files(identified: Identification) -> str:
    """Names of the scanned files and the sides that they represent, as text."""
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
    """Text for a source: files, method and range of scales of a result."""
    methods = {"structure": "structure function, lags", "psd": "power spectral density, wavelengths"}
    return (
        f"identified from {_files(identified)} by {methods[result.method]} "
        f"{result.fit.low:.3g} to {result.fit.high:.3g} m"
    )


def _source(identified: Identification, result: Result, surface: RoughSurface, which: str) -> str:
    """Text for the source of D or G: files, method, direction and confidence interval."""
    D, G = _dimension_and_roughness(result, surface)
    estimate = D if which == "D" else G
    if surface.areal:
        extent = "of the surface"
    else:
        extent = "of the profile" if result.direction in ("profile", "areal") else f"along {result.direction}"
    return f"{_band(identified, result)}; {extent}; 95 % interval {estimate.low:.4g} to {estimate.high:.4g}"
