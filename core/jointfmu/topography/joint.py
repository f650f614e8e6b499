"""Which parameters of a joint a surface decides, and a parameter file with them."""

import math

from ..parameters import JOINTS, ParameterFile
from .results import Identification, Result


def changes(found: Identification, joint: str, method: str | None = None) -> dict[str, tuple[float, Result]]:
    """{structured name: (value, result it comes from)} of a joint, a key of parameters.JOINTS.

    harmonic_drive : surface.D = D_s of the surface (2 < D_s < 3), surface.G = G_s
    bolted_joint   : surface.D = D of the profile (1 < D < 2), surface.G
    gear_contact   : surface1 = profile along x, surface2 = profile along y; both alike from a profile or
        an isotropic map
    """
    if joint not in JOINTS:
        raise ValueError(f"joint = {joint!r} is not one of {', '.join(JOINTS)}")
    main = found.best(method=method)
    if joint == "harmonic_drive":
        areal = main.areal
        return {"surface.D": (areal.D_s.value, main), "surface.G": (areal.G_s.value, main)}
    if joint == "bolted_joint":
        return {"surface.D": (main.profile.D.value, main), "surface.G": (main.profile.G.value, main)}
    textured = found.textured
    pair = [found.best(direction, method) for direction in ("x", "y")] if textured else [main, main]
    return {
        f"surface{i}.{name}": (getattr(one.profile, name).value, one)
        for i, one in enumerate(pair, start=1)
        for name in ("D", "G")
    }


def with_surface(file: ParameterFile, found: Identification, method: str | None = None) -> ParameterFile:
    """The parameter file with D and G of the surface, each with its source.

    Raises ValueError if one is not determined.
    """
    for name, (value, result) in changes(found, file.joint, method).items():
        if not math.isfinite(value):
            D, G = result.profile.D.value, result.profile.G
            raise ValueError(
                f"{name} of {' and '.join(found.names)} is not determined (D = {D:.2f}, the interval of G "
                f"spans {G.decades:.0f} decades): {file.joint} needs a number"
            )
        file = file.with_values({name: value}, "user", _source(found, result, file.joint, name))
    return file


def _source(found: Identification, result: Result, joint: str, name: str) -> str:
    how = {"structure": "structure function, lags", "psd": "power spectral density, wavelengths"}
    if joint == "harmonic_drive":
        shown = result.areal.D_s if name.endswith("D") else result.areal.G_s
        kind = "of the surface"
    else:
        shown = result.profile.D if name.endswith("D") else result.profile.G
        kind = "of the profile" if result.direction in ("profile", "areal") else f"along {result.direction}"
    files = " and ".join(found.names) + (" (equivalent surface)" if len(found.names) == 2 else "")
    return (
        f"identified from {files} by {how[result.method]} {result.fit.low:.3g} to {result.fit.high:.3g} m; "
        f"{kind}; 95 % interval {shown.low:.4g} to {shown.high:.4g}"
    )
