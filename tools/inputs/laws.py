"""Interface laws without a joint: the parameter set of a law, from a joint's parameter file and settings."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.interface import HardnessLimitedLaw
from jointfmu.contact.laws import LAWS, ROUGHNESS_LAW
from jointfmu.contact.roughness import HEIGHT_FIELDS, check_heights, combined_height
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file
from jointfmu.quantity import Number, build_parameter_set, flatten_fields, flatten_parameters

from ..common.judgement import find_rms_height, law_rms_height
from . import fractal

LAW_COLUMNS = ("largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t")
"""Columns of the output of every law; a column that a law does not define is null."""
FRACTAL_PROFILE_PARAMETERS = ("surface.D", "surface.G")
"""Fractal parameters of a profile, which must be set together."""
LAW_COLUMN_UNITS = {
    **dict.fromkeys(("largest_spot", "A_r"), "m2"),
    "pressure": "Pa",
    **dict.fromkeys(("F", "friction_limit"), "N"),
    **dict.fromkeys(("K_N", "K_T", "K_loading"), "N/m"),
    **dict.fromkeys(("C_N", "C_T"), "N.s/m"),
    **dict.fromkeys(("W_NP", "W_NE", "W_d", "W_e", "W"), "J"),
    **dict.fromkeys(("approach", "slip_length"), "m"),
    **dict.fromkeys(("eta_n", "eta_t", "elastic_fraction"), "1"),
}
"""{output of a law: SI unit}."""


def build_law_parameters(law: str, parameter_file: ParameterFile | None, settings: dict[str, Any]) -> Any:
    """Build the parameter set of a law from a joint's parameter file and settings.

    parameter_file : parameter file of any joint that has the law; None: the default file of
                     `default_joint(law)`

    If the file has another law, its values are used as far as the law has them, else default values.
    """
    if parameter_file is None and not joints_with_law(law):  # a law that no joint has
        return build_parameter_set(LAWS[law], settings)
    parameter_file = parameter_file or load_default(default_joint(law), law)
    names = {name for name, _ in flatten_fields(LAWS[law])}
    law_of = KINDS[parameter_file.joint].extract_law
    file_law, differs = law_of(parameter_file.values), parameter_file.law != law
    known = flatten_parameters(file_law)
    if differs:
        known = (
            flatten_parameters(law_of(load_default(parameter_file.joint, law).values))
            | known
            | ({"H": float(file_law.hardness)} if isinstance(file_law, HardnessLimitedLaw) else {})
        )
    if law == ROUGHNESS_LAW:
        fractal, stated = (
            (flatten_parameters(file_law), find_rms_height(parameter_file)) if differs else ({}, None)
        )
        settings = roughness_settings(fractal, stated, known["longest_wave"], settings)
    return build_parameter_set(LAWS[law], {k: v for k, v in known.items() if k in names} | settings)


def roughness_settings(
    law_values: dict[str, object],
    stated_height: float | None,
    longest_wave: float,
    settings: dict[str, object],
) -> dict[str, object]:
    """Settings of the law `roughness` with rms height h and Hurst exponent, computed from other parameters.

    law_values    : {structured name: value} of another law; its surface.D and surface.G are used
    stated_height : h [m] of the parameter file; it takes precedence over D and G
    longest_wave  : longest wave [m] that counts for the height, unless the settings have longest_wave
    settings      : may have Ra1, Ra2, Rq1, Rq2 [m], or surface.D and surface.G of a profile, instead of h

    Raises ValueError if one of D and G is missing, if D or G is set together with a height, and for wrong
    heights as `check_heights` does.
    """
    heights = {name: settings[name] for name in HEIGHT_FIELDS if name in settings}
    fractals = {name: settings[name] for name in FRACTAL_PROFILE_PARAMETERS if name in settings}
    others = {name: value for name, value in settings.items() if name not in {*heights, *fractals}}
    if heights and fractals:
        raise ValueError(f"{', '.join(fractals)} with {', '.join(heights)}: expected D and G, or heights")
    if heights:
        return others | (heights if [*heights] == ["h"] else {"h": combined_height(check_heights(heights))})
    if fractals:
        law_values = {
            name: value
            for name, value in (law_values | fractals).items()
            if name in FRACTAL_PROFILE_PARAMETERS
        }
        if missing := [name for name in FRACTAL_PROFILE_PARAMETERS if name not in law_values]:
            raise ValueError(f"{', '.join(fractals)} without {missing[0]}: expected both, or heights")
    elif stated_height is not None:
        return {"h": stated_height} | others
    pairs = fractal_surfaces(law_values)
    if not pairs:
        return others
    wave = others.get("longest_wave", longest_wave)
    h = np.sqrt(sum(fractal.rms_height(D, G, wave, areal) ** 2 for D, G, areal in pairs) / len(pairs))
    exponent = sum(fractal.hurst_exponent(D, areal) for D, G, areal in pairs) / len(pairs)
    return {"h": h, "hurst": exponent} | others


def find_surface_rms_height(
    law: str, parameters: Any, parameter_file: ParameterFile | None, settings: Iterable[str]
) -> Number | None:
    """Rms height h [m] of both surfaces together, for the parameter set of a law; None if it is not known.

    parameters : result of `build_law_parameters` for the same law, file and settings

    If the parameters have no height, the height of the file is used. The height of the default file is not
    used if the settings change the surfaces.
    """
    h = law_rms_height(parameters)
    if (
        h is None
        and joints_with_law(law)
        and (parameter_file or not any(name.startswith("surface") for name in settings))
    ):
        return find_rms_height(parameter_file or load_default(default_joint(law), law))
    return h


def fractal_surfaces(law_values: dict[str, Any]) -> list[tuple[Number, Number, bool]]:
    """Fractal parameters of a law's surface in each stated direction: (D [1], G [m], is areal)."""
    prefixes = [name[:-2] for name in law_values if name.endswith(".D")]
    pairs = [(law_values[f"{p}.D"], law_values[f"{p}.G"]) for p in prefixes if f"{p}.G" in law_values]
    return [(D, G, bool(np.all(D > 2.0))) for D, G in pairs]


def joints_with_law(law: str) -> list[str]:
    """Names of the joints that can have an interface law."""
    return [
        name for name, kind in KINDS.items() if law in kind.laws and law not in kind.laws_without_interface
    ]


def default_joint(law: str) -> str:
    """Joint whose default file gives default values for a law.

    A joint whose parameter set is a subclass of the law's parameter set is preferred.
    """
    joints = joints_with_law(law)
    preferred = [name for name in joints if issubclass(KINDS[name].laws[law], LAWS[law])]
    return (preferred or joints)[0]


def load_law_file(path: Path, law: str) -> ParameterFile:
    """Load a parameter file of a joint whose surfaces have the interface law `law`.

    Raises ValueError for a file of another joint, or if the law of the file is not an interface law.
    """
    file = load_parameter_file(path)
    if file.joint not in joints_with_law(law):
        expected = " or ".join(repr(name) for name in joints_with_law(law))
        raise ValueError(f"{path}: joint = {file.joint!r}, expected a parameter file of a {expected}")
    if KINDS[file.joint].extract_law(file.values) is None:
        raise ValueError(
            f"{path}: law = {file.law!r} is of no interface; expected a file with an interface law"
        )
    return file
