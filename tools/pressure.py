"""What a joint's part `pressure` gives: how its load presses on its interface; its judgement at a load."""

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
    """PRESSURE of a joint's folder.

    load  : the input or output of the joint whose value a working point is
    usual : parameter set -> load where none is asked for
    mean  : (parameter set, load) -> nominal pressure [Pa] at which the interface's stiffness is judged
    peak  : (parameter set, load) -> greatest nominal pressure [Pa]
    scale : (parameter set, load) -> the joint's stiffness over that of its interface law at the mean [1]
    borne : parameter set -> (most that what carries the load bears, what that is), or None if not known
    """

    load: str
    usual: Callable[..., float]
    mean: Callable[..., float]
    peak: Callable[..., float]
    scale: Callable[..., float] = lambda parameters, load: 1.0
    borne: Callable[..., tuple[float, str] | None] = lambda parameters: None


def over_area(parameters: Any, load: float) -> float:
    """Pressure [Pa] of a load [N] that is spread evenly over the nominal area."""
    return float(load / parameters.A_0)


FLANKS = NominalPressure(
    load="f", usual=lambda joint: min(3e3, 0.1 * joint.hardness * joint.A_0), mean=over_area, peak=over_area
)
"""Of flanks under a normal force f."""


def nominal_pressure(kind: Kind) -> NominalPressure | None:
    """What the joint's folder says; None if it says nothing."""
    found = part(kind, "pressure")
    return found.PRESSURE if found else None


def judge_file(file: ParameterFile, loads: Sequence[float] | None = None) -> Judgement:
    """The judgement of a joint under loads (`Pressing.load`, SI).

    loads : without them the start value of the file; if that is zero the usual load, at which the level alone
            is judged
    """
    kind = KINDS[file.joint]
    how = nominal_pressure(kind)
    if how is None or kind.law_of(file.values) is None:
        return Judgement(None, ())
    if loads is None and file.start(how.load) > 0.0:
        loads = [file.start(how.load)]
    law, h, limits = kind.law_of(file.values), known_height(file), loads is not None
    if loads is None:
        loads = [how.usual(file.values)]
    loads = [load for load in loads if load > 0.0]
    found = judge(
        law,
        [how.mean(file.values, load) for load in loads],
        h,
        max((how.peak(file.values, load) for load in loads), default=0.0),
        [how.scale(file.values, load) for load in loads],
        limits,
    )
    return found.with_warnings(overload(how.load, max(loads, default=0.0), how.borne(file.values)))


def without_members(file: ParameterFile) -> list[str]:
    """The warning where what is made of a whole joint is its interface alone."""
    if not getattr(file.values, "elastic", False):
        return []
    return [
        f"{file.name!r} is a whole joint (sides = elastic), this its interface alone: between rigid bodies "
        "far too stiff without the members, which the FMU has"
    ]


def overload(name: str, load: float, borne: tuple[float, str] | None) -> list[str]:
    """The warning if a load [N] is more than what carries it bears: (most [N], what that is)."""
    if borne is None or load <= borne[0]:
        return []
    return [f"{name} = {load:g} N is above {borne[0]:.4g} N, {borne[1]}"]
