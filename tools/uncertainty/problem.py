"""What a user wants to know, as a problem: parameters, distributions, a ramp of load, a joint's fast
curves.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.joints.kind import Kind
from jointfmu.joints.model import Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Interval, flat_fields, problem
from jointfmu.quantity.refusal import Refusal

from ..joint_parts import part
from .study import Uncertain, is_relative, samples_of, split

Evaluate = Callable[[type[Any], Mapping[str, Any], Array, Array], dict[str, Array]]


@dataclass(frozen=True, slots=True)
class Reduced:
    """A joint's curves over a ramp of load.

    load     : the ramped input
    outputs  : what is computed along the ramp
    to       : default end of the ramp, of the parameter set
    most     : where the tabulated law ends, of the parameter set (numbers or samples)
    evaluate : (class of the parameter set, values or samples (n), loads (m), factor (n, 1)) -> outputs
        (n, m) at factor times loads
    exact    : (parameter set, loads (m)) -> outputs (m), by the exported spring itself
    """

    load: Variable
    outputs: Sequence[Variable]
    to: Callable[[Any], float]
    most: Callable[[Any], Any]
    evaluate: Evaluate
    exact: Callable[[Any, Array], dict[str, Array]]

    @property
    def units(self) -> dict[str, str]:
        return {v.name: v.unit for v in self.outputs}


def reduced(kind: Kind) -> Reduced:
    """What the joint's folder says.

    Raises ValueError if it has no reduced evaluation.
    """
    found = part(kind, "reduced")
    if found is None:
        raise ValueError(f"joint = {kind.name!r} has no evaluation for many samples at once")
    curves: Reduced = found.REDUCED
    return curves


INTERVAL = "interval"
"""Word for the interval that the parameter file states in a source."""
_ENDS = re.compile(r"\binterval ([-+.\de]+) to ([-+.\de]+)")
LOAD_END = "up to the end of the tabulated law"


@dataclass(frozen=True, slots=True)
class Problem:
    """What is propagated.

    parameters : class of the parameter set
    values    : the parameter file's, with the plain settings
    uncertain : parameters with a distribution, the load's last if it has one
    loads     : (m) ramp of the load, ascending; one point if the load itself was set
    relative  : whether the load's distribution is a factor on the ramp; None if it has none
    """

    joint: str
    parameters: type[object]
    values: Mapping[str, object]
    uncertain: tuple[Uncertain, ...]
    loads: Array
    relative: bool | None = None

    @property
    def reduced(self) -> Reduced:
        return reduced(KINDS[self.joint])

    def sampled(self, points: Array) -> tuple[dict[str, object], Array]:
        """Values with samples (n) among them, and factors (n) on the load, from points of the unit cube."""
        drawn = samples_of(self.uncertain, points)
        load = drawn.pop(self.reduced.load.name, None)
        factor = np.ones(len(points)) if load is None else load if self.relative else load / self.loads[-1]
        return {**self.values, **drawn}, factor


def pose(file: ParameterFile, given: Mapping[str, object], to: float | None, points: int) -> Problem:
    """The problem of a parameter file and settings (values and distributions by name).

    A parameter of which nothing is set has the range that the file states, evenly.

    Raises ValueError naming what is unknown, outside its interval, or cannot be uncertain.
    """
    kind = KINDS[file.joint]
    curves, declared = reduced(kind), dict(flat_fields(type(file.values)))
    base = dict(file.flat)
    lists = {name for name, item in declared.items() if "series" in item.metadata}
    known = [*(base.keys() - lists), curves.load.name]
    if unknown := [name for name in given if name not in known]:
        allowed = ", ".join(name for name in [*declared, curves.load.name] if name in known)
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {allowed}")
    given = dict.fromkeys(file.ranges, INTERVAL) | dict(given)
    given = {name: of_source(name, value, file) for name, value in given.items()}
    load_text = given.get(curves.load.name)
    relative = isinstance(load_text, str) and is_relative(load_text)
    plain, uncertain = split(given, base | ({curves.load.name: 1.0} if relative else {}))
    fixed = plain.pop(curves.load.name, None)
    stated = file.with_values(plain, "user", "set for the study")
    for parameter in uncertain:
        if parameter.name != curves.load.name:
            _check(parameter, declared[parameter.name])
    order = tuple(sorted(uncertain, key=lambda parameter: parameter.name == curves.load.name))
    if not order:
        raise Refusal("no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings")
    load = next((parameter for parameter in order if parameter.name == curves.load.name), None)
    at = fixed if fixed is not None else None if load is None or relative else float(load.law.median())
    end = to if to is not None or at is not None else file.start(curves.load.name) or None
    loads = _ramp(curves, stated.values, at, end, points, load)
    return Problem(file.joint, type(file.values), stated.flat, order, loads, relative if load else None)


def of_source(name: str, value: object, file: ParameterFile) -> object:
    """A setting; INTERVAL becomes the distribution between the ends of the parameter's range, or those that
    its source states.

    Raises ValueError if it states none.
    """
    if value != INTERVAL:
        return value
    if name in file.ranges:
        return "{!r}..{!r}".format(*file.ranges[name])
    source = file.sources.get(name, "")
    if not (found := _ENDS.search(source)):
        raise ValueError(
            f"{name} = {INTERVAL}: its source states none: {source!r}; expected '... interval LOW to HIGH'"
        )
    return f"{found[1]}..{found[2]}"


def _check(parameter: Uncertain, item: Any) -> None:
    """Raise ValueError if a parameter cannot be uncertain or its distribution leaves the interval."""
    if "allowed" in item.metadata:
        raise ValueError(f"{parameter.name} = {parameter.text}: is a named choice and cannot be uncertain")
    if item.metadata["whole"]:
        raise ValueError(f"{parameter.name} = {parameter.text}: is a whole number and cannot be uncertain")
    for value in (*(end for end in parameter.support if np.isfinite(end)), float(parameter.law.median())):
        tolerated = value == 0.0 and parameter.support[0] == 0.0 and item.metadata["interval"].low == 0.0
        if not tolerated and (text := problem(parameter.name, value, item)):
            raise ValueError(f"{parameter.name} = {parameter.text}: {text}")


def _ramp(
    curves: Reduced, values: object, at: object, to: float | None, points: int, load: Uncertain | None
) -> Array:
    """The loads: a ramp from 0 to `to`, or the one load that was set."""
    allowed = Interval.of(gt=0.0, le=curves.most(values))
    if at is not None:
        if to is not None:
            raise ValueError(f"{curves.load.name} is set and cannot be ramped as well; drop to = {to:g}")
        if not isinstance(at, int | float) or isinstance(at, bool):
            raise ValueError(f"{curves.load.name} = {at!r} is not a number in {curves.load.unit}")
        ends = [end for end in load.support if np.isfinite(end) and end != 0.0] if load else []
        for value in (float(at), *ends):
            if not allowed.contains(value):
                given = f"{curves.load.name} = {value:g} {curves.load.unit}"
                raise ValueError(f"{given} is outside {allowed}: {LOAD_END}")
        return np.array([float(at)])
    end = curves.to(values) if to is None else to
    if not allowed.contains(end):
        raise ValueError(f"to = {end:g} {curves.load.unit} is outside {allowed}: {LOAD_END}")
    if not 2 <= points <= 10_000:
        raise ValueError(f"points = {points} is outside [2, 10000]: points of the ramp")
    return np.linspace(0.0, end, points)
