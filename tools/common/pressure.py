"""Nominal contact pressure of a joint under load, and the judgement of its stiffness at a load.

The module `pressure` in a joint's folder defines the pressure by its constant NOMINAL_PRESSURE.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.joints.kind import JointKind
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from .joint_parts import load_tool_module
from .judgement import Plausibility, assess_law_stiffness, find_rms_height


@dataclass(frozen=True, slots=True, kw_only=True)
class NominalPressureModel:
    """Nominal contact pressure of a kind of joint as a function of its load.

    load_variable                : name of the input or output that is the load
    stated_load                  : parameter file -> load [SI] that the file states, 0 if it states none;
                                   None: the start value of the input `load_variable`
    default_load                 : parameter set -> load [SI] that is used if the file states none
    mean_pressure                : (parameter set, load) -> nominal pressure [Pa] at which the stiffness is
                                   judged
    peak_pressure                : (parameter set, load) -> greatest nominal pressure [Pa]
    joint_to_law_stiffness_ratio : (parameter set, load) -> joint stiffness over stiffness of the interface
                                   law at the mean pressure [1]
    load_capacity                : parameter file -> (largest load [SI] of the loaded parts, name of this
                                   limit), or None if not known
    is_part_load                 : whether the output of this name is the load of one of these parts
    """

    load_variable: str
    stated_load: Callable[[ParameterFile], float] | None = None
    default_load: Callable[..., float]
    mean_pressure: Callable[..., float]
    peak_pressure: Callable[..., float]
    joint_to_law_stiffness_ratio: Callable[..., float] = lambda parameters, load: 1.0
    load_capacity: Callable[..., tuple[float, str] | None] = lambda parameter_file: None
    is_part_load: Callable[[str], bool] = lambda output_name: False


def uniform_pressure(joint_parameters: Any, joint_load: float) -> float:
    """Nominal pressure [Pa] of a load [N] that is distributed uniformly over the nominal area."""
    return float(joint_load / joint_parameters.A_0)


FLANK_PRESSURE_MODEL = NominalPressureModel(
    load_variable="f",
    default_load=lambda joint: min(3e3, 0.1 * joint.max_pressure * joint.A_0),
    mean_pressure=uniform_pressure,
    peak_pressure=uniform_pressure,
)
"""Nominal pressure of gear flanks under a normal force f [N]."""


def find_nominal_pressure_model(joint_kind: JointKind) -> NominalPressureModel | None:
    """Model of the nominal pressure that the joint's folder defines; None if it defines none."""
    module = load_tool_module(joint_kind, "pressure")
    return module.NOMINAL_PRESSURE if module else None


def judge_joint_stiffness(
    parameter_file: ParameterFile, joint_loads: Sequence[float] | None = None
) -> Plausibility:
    """Compare the stiffness of a joint under loads with the estimate from roughness, and list warnings.

    joint_loads : values of `NominalPressureModel.load_variable` [SI]; None: the load that the file states,
                  or, if it states none, the default load. At the default load the stiffness is only compared
                  with the estimate from roughness. With None, the upper end of the range in the file is also
                  checked against the load capacity
    """
    kind = KINDS[parameter_file.joint]
    nominal = find_nominal_pressure_model(kind)
    if nominal is None or kind.extract_law(parameter_file.values) is None:
        return Plausibility(None, ())
    capacity = nominal.load_capacity(parameter_file)
    range_warnings = []
    if joint_loads is None and (ends := parameter_file.ranges.get(f"inputs.{nominal.load_variable}")):
        name = f"upper end of the range of {nominal.load_variable}"
        range_warnings = warn_overload(name, ends[1], capacity)
    if joint_loads is None:
        stated = (
            nominal.stated_load(parameter_file)
            if nominal.stated_load
            else parameter_file.start_value(nominal.load_variable)
        )
        joint_loads = [stated] if stated > 0.0 else None
    law, h, limits = (
        kind.extract_law(parameter_file.values),
        find_rms_height(parameter_file),
        joint_loads is not None,
    )
    if joint_loads is None:
        joint_loads = [nominal.default_load(parameter_file.values)]
    joint_loads = [load for load in joint_loads if load > 0.0]
    judgement = assess_law_stiffness(
        law,
        [nominal.mean_pressure(parameter_file.values, load) for load in joint_loads],
        h,
        max((nominal.peak_pressure(parameter_file.values, load) for load in joint_loads), default=0.0),
        [nominal.joint_to_law_stiffness_ratio(parameter_file.values, load) for load in joint_loads],
        limits,
    )
    overload = warn_overload(nominal.load_variable, max(joint_loads, default=0.0), capacity)
    return judgement.prepend_warnings(overload or range_warnings)


def warn_overload_in_run(
    parameter_file: ParameterFile, variable_values: Mapping[str, float | Array]
) -> list[str]:
    """List a warning if a load of a run of the FMU is above the load capacity; the largest one is named.

    variable_values : {variable: value, or values (n) of the run} of inputs and outputs [SI]
    """
    nominal = find_nominal_pressure_model(KINDS[parameter_file.joint])
    if nominal is None or (capacity := nominal.load_capacity(parameter_file)) is None:
        return []
    loads = {
        name: float(np.max(values))
        for name, values in variable_values.items()
        if name == nominal.load_variable or nominal.is_part_load(name)
    }
    largest = max(loads, key=lambda name: loads[name], default=None)
    return [] if largest is None else warn_overload(largest, loads[largest], capacity)


def warn_missing_members(parameter_file: ParameterFile, advice: str = "its FMU has the members") -> list[str]:
    """List a warning if a written file has only the interface of a joint, and not its elastic members."""
    if not getattr(parameter_file.values, "has_elastic_members", False):
        return []
    return [
        f"{parameter_file.name!r} is a complete joint (sides = elastic), but this file has the "
        "interface only: between rigid bodies it is far too stiff, because the members are missing; "
        f"{advice}"
    ]


def warn_overload(load_name: str, joint_load: float, load_capacity: tuple[float, str] | None) -> list[str]:
    """List a warning if a load [N] is above the load capacity; otherwise the list is empty.

    load_capacity : (largest load [N], name of this limit), or None if not known
    """
    if load_capacity is None or joint_load <= load_capacity[0]:
        return []
    return [f"{load_name} = {joint_load:g} N is above {load_capacity[0]:.4g} N, {load_capacity[1]}"]
