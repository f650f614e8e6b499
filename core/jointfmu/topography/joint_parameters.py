"""Which parameters of a joint a surface decides, and a parameter file with them."""

import math

from ..joints import KINDS
from ..joints.kind import RoughSurface
from ..parameters import ParameterFile
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
        direction = surface.direction if identified.textured else None
        result = identified.best(direction, method) if direction else identified.best(method=method)
        D, G = _dimension_and_roughness(result, surface)
        values |= {f"{surface.prefix}.D": (D.value, result), f"{surface.prefix}.G": (G.value, result)}
    return values


def _dimension_and_roughness(result: Result, surface: RoughSurface) -> tuple[Estimate, Estimate]:
    if surface.areal:
        return result.areal.D_s, result.areal.G_s
    return result.profile.D, result.profile.G


def meaning(joint: str) -> str:
    """What D of the joint's first rough surface is."""
    return "D_s of the surface" if KINDS[joint].surfaces[0].areal else "D of the profile"


def with_surface(file: ParameterFile, identified: Identification, method: str | None = None) -> ParameterFile:
    """The parameter file with D and G of the surface, each with its source.

    Raises ValueError if one is not determined.
    """
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


def _source(identified: Identification, result: Result, surface: RoughSurface, which: str) -> str:
    how = {"structure": "structure function, lags", "psd": "power spectral density, wavelengths"}
    D, G = _dimension_and_roughness(result, surface)
    shown = D if which == "D" else G
    if surface.areal:
        extent = "of the surface"
    else:
        extent = "of the profile" if result.direction in ("profile", "areal") else f"along {result.direction}"
    files = " and ".join(identified.names) + (" (equivalent surface)" if len(identified.names) == 2 else "")
    return (
        f"identified from {files} by {how[result.method]} {result.fit.low:.3g} to {result.fit.high:.3g} m; "
        f"{extent}; 95 % interval {shown.low:.4g} to {shown.high:.4g}"
    )
