"""Nominal contact pressure of a joint under load, and the judgement of its stiffness at a load.

The module `pressure` in a joint's folder defines the pressure by its constant PRESSURE.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.joints.kind import Kind
from jointfmu.parameters import ParameterFile

from .joint_parts import part
from .judgement import Judgement, judge, known_height


@dataclass(frozen=True, slots=True, kw_only=True)
class NominalPressure:
    """Nominal contact pressure of a joint as a function of its load.

    load_variable   : name of the input or output that is the load
    default_load    : parameter set -> load [SI] that is used if the user states none
    mean_pressure   : (parameter set, load) -> nominal pressure [Pa] at which the stiffness is judged
    peak_pressure   : (parameter set, load) -> greatest nominal pressure [Pa]
    stiffness_ratio : (parameter set, load) -> joint stiffness over stiffness of the interface law at the mean
                      pressure [1]
    load_capacity   : parameter set -> (largest load [SI] of the loaded parts, name of this limit), or None if
                      not known
    """

    load: str
    usual: Callable[..., float]
    mean: Callable[..., float]
    peak: Callable[..., float]
    scale: Callable[..., float] = lambda parameters, load: 1.0
    borne: Callable[..., tuple[float, str] | None] = lambda parameters: None


def over_area(parameters: Any, load: float) -> float:
    """Pressure [Pa] of a load [N] distributed uniformly over the nominal area."""
    return float(load / parameters.A_0)


FLANKS = NominalPressure(
    load="f", usual=lambda joint: min(3e3, 0.1 * joint.hardness * joint.A_0), mean=over_area, peak=over_area
)
"""Nominal pressure of gear flanks under a normal force f [N]."""


def nominal_pressure(kind: Kind) -> NominalPressure | None:
    """Nominal pressure that the joint's folder defines; None if it defines none."""
    module = part(kind, "pressure")
    return module.PRESSURE if module else None


def judge_file(file: ParameterFile, loads: Sequence[float] | None = None) -> Judgement:
    """Judge the stiffness of a joint under loads.

    loads : values of `NominalPressure.load_variable` [SI]; None: the start value in the file, or, if it is
            zero, the default load. At the default load only the level of the stiffness is judged
    """
    kind = KINDS[file.joint]
    nominal = nominal_pressure(kind)
    if nominal is None or kind.law_of(file.values) is None:
        return Judgement(None, ())
    if loads is None and file.start(nominal.load) > 0.0:
        loads = [file.start(nominal.load)]
    law, h, limits = kind.law_of(file.values), known_height(file), loads is not None
    if loads is None:
        loads = [nominal.usual(file.values)]
    loads = [load for load in loads if load > 0.0]
    judgement = judge(
        law,
        [nominal.mean(file.values, load) for load in loads],
        h,
        max((nominal.peak(file.values, load) for load in loads), default=0.0),
        [nominal.scale(file.values, load) for load in loads],
        limits,
    )
    capacity = nominal.borne(file.values)
    return judgement.with_warnings(overload(nominal.load, max(loads, default=0.0), capacity))


def without_members(file: ParameterFile) -> list[str]:
    """Warning that the written file has only the interface of a joint with elastic members; else empty."""
    if not getattr(file.values, "elastic", False):
        return []
    return [
        f"{file.name!r} is a whole joint (sides = elastic), but this file has its interface alone: between "
        "rigid bodies it is far too stiff, because the members are missing; the FMU has them"
    ]


def overload(name: str, load: float, borne: tuple[float, str] | None) -> list[str]:
    """Warning if a load [N] is above the load capacity; else empty.

    capacity : (largest load [N], name of this limit), or None if not known
    """
    if borne is None or load <= borne[0]:
        return []
    return [f"{name} = {load:g} N is above {borne[0]:.4g} N, {borne[1]}"]
