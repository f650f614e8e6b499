"""Interface laws on their own: the parameter set of one, out of a joint's parameter file and settings."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.laws import LAWS, ROUGHNESS_LAW
from jointfmu.contact.roughness import DECLARED, check, height
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, default, load
from jointfmu.quantity import Number, build, flat_fields, flatten

from . import fractal
from .judgement import known_height, law_height

ROW = ("largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t")
"""Columns of every law; a law that does not define one gives null."""
PROFILE = ("surface.D", "surface.G")
"""Parameters of a profile that belong together."""
UNITS = {
    **dict.fromkeys(("largest_spot", "A_r"), "m2"),
    "pressure": "Pa",
    **dict.fromkeys(("F", "friction_limit"), "N"),
    **dict.fromkeys(("K_N", "K_T", "K_loading"), "N/m"),
    **dict.fromkeys(("C_N", "C_T"), "N.s/m"),
    **dict.fromkeys(("W_NP", "W_NE", "W_d", "W_e", "W"), "J"),
    **dict.fromkeys(("approach", "slip_length"), "m"),
    **dict.fromkeys(("eta_n", "eta_t", "elastic_fraction"), "1"),
}
"""{what a law gives: unit}."""


def law_parameters(law: str, file: ParameterFile | None, settings: dict[str, Any]) -> Any:
    """The law's parameter set from a joint's parameter file (default: `first_joint`)
    and settings."""
    file = file or default(first_joint(law), law)
    names = {name for name, _ in flat_fields(LAWS[law])}
    law_of = KINDS[file.joint].law_of
    own, other = law_of(file.values), file.law != law
    known = flatten(own)
    if other:
        known = flatten(law_of(default(file.joint, law).values)) | known | {"H": float(own.hardness)}
    if law == ROUGHNESS_LAW:
        fractal, stated = (flatten(own), known_height(file)) if other else ({}, None)
        settings = roughness_settings(fractal, stated, known["longest_wave"], settings)
    return build(LAWS[law], {k: v for k, v in known.items() if k in names} | settings)


def roughness_settings(
    known: dict[str, object], stated: float | None, longest: float, settings: dict[str, object]
) -> dict[str, object]:
    """Settings of the law `roughness` with its h, and hurst, out of what else tells them.

    known    : parameters of another law by structured name; D and G of a surface count
    stated   : h [m] that its file states; goes before D and G
    longest  : wave [m] up to which D and G count, unless the settings have longest_wave
    settings : may have Ra1, Ra2, Rq1, Rq2 [m], or surface.D and surface.G of a profile, in place of h

    Raises ValueError for one of D and G whose other is not known, for both beside a height, and as
    `roughness.check`.
    """
    heights = {name: settings[name] for name in DECLARED if name in settings}
    own = {name: settings[name] for name in PROFILE if name in settings}
    rest = {name: value for name, value in settings.items() if name not in {*heights, *own}}
    if heights and own:
        raise ValueError(f"{', '.join(own)} beside {', '.join(heights)}: expected D and G, or heights")
    if heights:
        return rest | (heights if [*heights] == ["h"] else {"h": height(check(heights))})
    if own:
        known = {name: value for name, value in (known | own).items() if name in PROFILE}
        if missing := [name for name in PROFILE if name not in known]:
            raise ValueError(f"{', '.join(own)} without {missing[0]}: expected both, or heights")
    elif stated is not None:
        return {"h": stated} | rest
    pairs = fractal_surfaces(known)
    if not pairs:
        return rest
    wave = rest.get("longest_wave", longest)
    h = np.sqrt(sum(fractal.height(D, G, wave, areal) ** 2 for D, G, areal in pairs) / len(pairs))
    exponent = sum(fractal.hurst(D, areal) for D, G, areal in pairs) / len(pairs)
    return {"h": h, "hurst": exponent} | rest


def surfaces_height(
    law: str, parameters: Any, file: ParameterFile | None, settings: Iterable[str]
) -> Number | None:
    """Rms height h [m] that is known of the surfaces, for what `law_parameters` gives of the same; what the
    default file states is that of its own surfaces."""
    own = law_height(parameters)
    if own is None and (file or not any(name.startswith("surface") for name in settings)):
        return known_height(file or default(first_joint(law), law))
    return own


def fractal_surfaces(known: dict[str, Any]) -> list[tuple[Number, Number, bool]]:
    """(D, G, whether of the area) of every direction in which a law's surface is stated."""
    prefixes = [name[:-2] for name in known if name.endswith(".D")]
    pairs = [(known[f"{p}.D"], known[f"{p}.G"]) for p in prefixes if f"{p}.G" in known]
    return [(D, G, bool(np.all(D > 2.0))) for D, G in pairs]


def joints_of(law: str) -> list[str]:
    """The joints that have a law."""
    return [name for name, kind in KINDS.items() if law in kind.laws]


def first_joint(law: str) -> str:
    """The joint of whose default file a law is taken: one whose parameter set is the law's, if any."""
    joints = joints_of(law)
    own = [name for name in joints if issubclass(KINDS[name].laws[law], LAWS[law])]
    return (own or joints)[0]


def law_file(path: Path, law: str) -> ParameterFile:
    """A parameter file of a joint that has the law."""
    file = load(path)
    if law not in KINDS[file.joint].laws:
        expected = " or ".join(repr(name) for name in joints_of(law))
        raise ValueError(f"{path}: joint = {file.joint!r}, expected a parameter file of a {expected}")
    if KINDS[file.joint].law_of(file.values) is None:
        raise ValueError(
            f"{path}: law = {file.law!r} is of no interface; expected a file with an interface law"
        )
    return file
