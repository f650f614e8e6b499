"""Interface laws without a joint: the parameter set of a law, from a joint's parameter file and settings."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.interface import HardnessLimitedLaw
from jointfmu.contact.laws import LAWS, ROUGHNESS_LAW_NAME
from jointfmu.contact.laws.hu2023 import Hu2023
from jointfmu.contact.laws.zhao2018 import Zhao2018
from jointfmu.contact.roughness import HEIGHT_FIELDS, check_heights, combined_height
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file
from jointfmu.quantity import Number, build_parameter_set, flatten_fields, flatten_parameters

from ..common.judgement import find_rms_height, law_rms_height
from . import fractal

LAW_OUTPUT_COLUMNS = ("largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t")
"""Columns of the output of every law; a column that a law does not define is null."""
FRACTAL_PROFILE_PARAMETERS = ("surface.D", "surface.G")
"""Fractal parameters of a profile, which must be set together."""
LAW_OUTPUT_UNITS = {
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


def build_law_parameters(
    law_name: str, parameter_file: ParameterFile | None, law_settings: dict[str, Any]
) -> Any:
    """Build the parameter set of a law from a joint's parameter file and settings of the user.

    parameter_file : parameter file of any joint that has the law; None: the default file of
                     `find_default_joint(law_name)`
    law_settings   : {parameter name: value}, in place of the values of the file

    If the file has another law, its values are used as far as the law has them, else default values.
    """
    if parameter_file is None and not find_joints_with_law(law_name):  # a law that no joint has
        return build_parameter_set(LAWS[law_name], law_settings)
    parameter_file = parameter_file or load_default(find_default_joint(law_name), law_name)
    names = {name: None for name, _ in flatten_fields(LAWS[law_name])}
    sources = (*HEIGHT_FIELDS, *FRACTAL_PROFILE_PARAMETERS) if law_name == ROUGHNESS_LAW_NAME else ()
    if unknown := [name for name in law_settings if name not in {*names, *sources}]:
        instead = f"; in place of h also {', '.join(n for n in sources if n != 'h')}" if sources else ""
        raise ValueError(f"unknown name {unknown[0]!r}; allowed are {', '.join(names)}{instead}")
    law_of = KINDS[parameter_file.joint].extract_law
    file_law, differs = law_of(parameter_file.values), parameter_file.law != law_name
    known = flatten_parameters(file_law)
    if differs:
        known = (
            flatten_parameters(law_of(load_default(parameter_file.joint, law_name).values))
            | known
            | ({"H": float(file_law.hardness)} if isinstance(file_law, HardnessLimitedLaw) else {})
        )
    if law_name == ROUGHNESS_LAW_NAME:
        fractal, stated = (
            (flatten_parameters(file_law), find_rms_height(parameter_file)) if differs else ({}, None)
        )
        law_settings = derive_roughness_settings(fractal, stated, known["longest_wave"], law_settings)
    return build_parameter_set(LAWS[law_name], {k: v for k, v in known.items() if k in names} | law_settings)


def explain_law_outputs(law_parameters: Any) -> tuple[list[str], list[str]]:
    """Notes on the printed outputs of a law, and warnings about outputs that do not belong together."""
    notes, warnings = [], []
    if isinstance(law_parameters, Zhao2018):
        notes.append(
            "eta_t: loop of single spheres (Mindlin); friction loops of a joint follow from the curve of the "
            "complete interface, and their loss factor is about 2.7 times eta_t (docs/validity_friction.md)"
        )
    if isinstance(law_parameters, Hu2023) and law_parameters.reading == "printed":
        warnings.append(
            "reading = printed: the pressure is the load over the real area. K_N, K_T and A_r are of one set "
            "of spots, whose load is pressure A_r; F = pressure A_0 is not this load (docs/errata.md)"
        )
    return notes, warnings


def derive_roughness_settings(
    law_parameter_values: dict[str, object],
    stated_rms_height: float | None,
    default_longest_wave: float,
    law_settings: dict[str, object],
) -> dict[str, object]:
    """Settings of the law `roughness`: rms height h and Hurst exponent, computed from other parameters.

    law_parameter_values : {structured name: value} of another law; its fractal dimension surface.D and
                           fractal roughness surface.G are used
    stated_rms_height    : h [m] of the parameter file; it takes precedence over D and G
    default_longest_wave : longest wave [m] that counts for the height, unless the settings have longest_wave
    law_settings         : may have Ra1, Ra2, Rq1, Rq2 [m], or surface.D and surface.G of a profile, instead
                           of h

    Raises ValueError if one of D and G is missing, if D or G is set together with a height, and for heights
    that are not allowed.
    """
    heights = {name: law_settings[name] for name in HEIGHT_FIELDS if name in law_settings}
    fractals = {name: law_settings[name] for name in FRACTAL_PROFILE_PARAMETERS if name in law_settings}
    others = {name: value for name, value in law_settings.items() if name not in {*heights, *fractals}}
    if heights and fractals:
        raise ValueError(
            f"{', '.join(fractals)} together with {', '.join(heights)}: state either surface.D and "
            "surface.G, or heights, and remove the others"
        )
    if heights:
        return others | (heights if [*heights] == ["h"] else {"h": combined_height(check_heights(heights))})
    if fractals:
        law_parameter_values = {
            name: value
            for name, value in (law_parameter_values | fractals).items()
            if name in FRACTAL_PROFILE_PARAMETERS
        }
        if missing := [name for name in FRACTAL_PROFILE_PARAMETERS if name not in law_parameter_values]:
            raise ValueError(f"{', '.join(fractals)} without {missing[0]}: state both, or heights instead")
    elif stated_rms_height is not None:
        return {"h": stated_rms_height} | others
    pairs = find_fractal_parameters(law_parameter_values)
    if not pairs:
        return others
    wave = others.get("longest_wave", default_longest_wave)
    h = np.sqrt(sum(fractal.rms_height(D, G, wave, areal) ** 2 for D, G, areal in pairs) / len(pairs))
    exponent = sum(fractal.hurst_exponent(D, areal) for D, G, areal in pairs) / len(pairs)
    return {"h": h, "hurst": exponent} | others


def find_surface_rms_height(
    law_name: str, law_parameters: Any, parameter_file: ParameterFile | None, law_settings: Iterable[str]
) -> Number | None:
    """Rms height h [m] of both surfaces together, for the parameter set of a law; None if it is not known.

    law_parameters : result of `build_law_parameters` for the same law, file and settings

    If the parameters have no height, the height of the file is used. The height of the default file is not
    used if the settings change the surfaces.
    """
    h = law_rms_height(law_parameters)
    if (
        h is None
        and find_joints_with_law(law_name)
        and (parameter_file or not any(name.startswith("surface") for name in law_settings))
    ):
        return find_rms_height(parameter_file or load_default(find_default_joint(law_name), law_name))
    return h


def find_fractal_parameters(law_parameter_values: dict[str, Any]) -> list[tuple[Number, Number, bool]]:
    """Fractal dimension D [1] and roughness G [m] of a law's surface in each direction: (D, G, is areal).

    `is areal` is True if D > 2: D and G are then those of the surface, and not of its profiles.
    """
    prefixes = [name[:-2] for name in law_parameter_values if name.endswith(".D")]
    pairs = [
        (law_parameter_values[f"{p}.D"], law_parameter_values[f"{p}.G"])
        for p in prefixes
        if f"{p}.G" in law_parameter_values
    ]
    return [(D, G, bool(np.all(D > 2.0))) for D, G in pairs]


def find_joints_with_law(law_name: str) -> list[str]:
    """Names of the joints that can have an interface law."""
    return [
        name
        for name, kind in KINDS.items()
        if law_name in kind.laws and law_name not in kind.laws_without_interface
    ]


def find_default_joint(law_name: str) -> str:
    """Joint whose default file gives default values for a law.

    A joint whose parameter set is a subclass of the law's parameter set is preferred.
    """
    joints = find_joints_with_law(law_name)
    preferred = [name for name in joints if issubclass(KINDS[name].laws[law_name], LAWS[law_name])]
    return (preferred or joints)[0]


def load_law_file(parameter_file_path: Path, law_name: str) -> ParameterFile:
    """Load a parameter file of a joint whose surfaces have the interface law `law_name`.

    Raises ValueError for a file of another joint, or if the law of the file is not an interface law.
    """
    file = load_parameter_file(parameter_file_path)
    if file.joint not in find_joints_with_law(law_name):
        expected = " or ".join(repr(name) for name in find_joints_with_law(law_name))
        raise ValueError(
            f"{parameter_file_path}: joint = {file.joint!r}, expected a parameter file of a {expected}"
        )
    if KINDS[file.joint].extract_law(file.values) is None:
        raise ValueError(
            f"{parameter_file_path}: law = {file.law!r} is not the law of an interface; expected a file "
            "with one"
        )
    return file
