"""Statement of an uncertainty propagation: parameters, distributions, load ramp, reduced curves of the joint.

Reduced curves are a fast evaluation of the joint for many samples at once.
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
"""Type of `ReducedCurves.evaluate`."""


@dataclass(frozen=True, slots=True)
class Reduced:
    """Reduced curves of a joint: outputs along a load ramp, for many samples at once.

    load     : the ramped input
    outputs  : variables computed along the ramp
    default_end : function: parameter set -> default end of the ramp
    max_load : function: parameter set (numbers or samples) -> largest load of the tabulated law
    evaluate : function: class of the parameter set, {name: value or samples (n)}, loads (m), load factors
        (n, 1) -> outputs (n, m) at factors times loads
    exact    : function: parameter set, loads (m) -> outputs (m), by the spring model of the exported FMU
    """

    load: Variable
    outputs: Sequence[Variable]
    to: Callable[[Any], float]
    most: Callable[[Any], Any]
    evaluate: Evaluate
    exact: Callable[[Any, Array], dict[str, Array]]

    @property
    def units(self) -> dict[str, str]:
        """{output: unit}."""
        return {v.name: v.unit for v in self.outputs}


def reduced(kind: Kind) -> Reduced:
    """Reduced curves of a kind of joint, from its module `reduced`.

    Raises ValueError if the joint has none.
    """
    module = part(kind, "reduced")
    if module is None:
        raise ValueError(f"joint = {kind.name!r} has no evaluation for many samples at once")
    curves: Reduced = module.REDUCED
    return curves


INTERVAL = "interval"
"""Setting that stands for the interval stated in the parameter file: its range, or the text of its source."""
_ENDS = re.compile(r"\binterval ([-+.\de]+) to ([-+.\de]+)")
"""Interval in the text of a source: its two ends."""
LOAD_END = "up to the end of the tabulated law"
"""Meaning of the load interval, for error messages."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Uncertainty propagation problem of a joint.

    joint      : name of the kind of joint
    parameters : class of the parameter set
    values     : {name: value} of the parameter file, with the settings that are plain values
    uncertain  : parameters with a distribution; the load is the last one if it has a distribution
    loads      : load ramp (m), ascending; one point if the load itself was set
    relative   : whether the distribution of the load is a factor on the ramp; None if it has none
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
        """Values of all parameters, {name: value or samples (n)}, and load factors (n).

        points : points (n, d) of the unit cube
        """
        samples = samples_of(self.uncertain, points)
        load = samples.pop(self.reduced.load.name, None)
        factor = np.ones(len(points)) if load is None else load if self.relative else load / self.loads[-1]
        return {**self.values, **samples}, factor


def pose(file: ParameterFile, given: Mapping[str, object], to: float | None, points: int) -> Problem:
    """State the problem of a parameter file and settings.

    settings : {name: value or text of a distribution}
    to       : end of the load ramp; None: end of the joint's law, or of the file
    points   : number of points of the ramp

    A parameter without setting is uniformly distributed over the range that the file states, if it does.

    Raises ValueError for an unknown name, a value outside its interval, or a distribution of a parameter that
    cannot be uncertain.
    """
    kind = KINDS[file.joint]
    curves, declared = reduced(kind), dict(flat_fields(type(file.values)))
    base = dict(file.flat)
    lists = {name for name, item in declared.items() if "series" in item.metadata}
    settable = [*(base.keys() - lists), curves.load.name]
    if unknown := [name for name in given if name not in settable]:
        allowed = ", ".join(name for name in [*declared, curves.load.name] if name in settable)
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {allowed}")
    given = dict.fromkeys(file.ranges, INTERVAL) | dict(given)
    given = {name: of_source(name, value, file) for name, value in given.items()}
    load_text = given.get(curves.load.name)
    relative = isinstance(load_text, str) and is_relative(load_text)
    plain, uncertain = split(given, base | ({curves.load.name: 1.0} if relative else {}))
    set_load = plain.pop(curves.load.name, None)
    nominal = file.with_values(plain, "user", "set for the study")
    for parameter in uncertain:
        if parameter.name != curves.load.name:
            _check(parameter, declared[parameter.name])
    order = tuple(sorted(uncertain, key=lambda parameter: parameter.name == curves.load.name))
    if not order:
        raise Refusal("no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings")
    load = next((parameter for parameter in order if parameter.name == curves.load.name), None)
    median = None if load is None or relative else float(load.law.median())
    single = set_load if set_load is not None else median
    end = to if to is not None or single is not None else file.start(curves.load.name) or None
    loads = _ramp(curves, nominal.values, single, end, points, load)
    return Problem(file.joint, type(file.values), nominal.flat, order, loads, relative if load else None)


def of_source(name: str, value: object, file: ParameterFile) -> object:
    """Replace the setting INTERVAL by the text LOW..HIGH; other settings are returned unchanged.

    The ends are the range of the parameter in the file, else the interval stated in the text of its source.

    Raises ValueError if the file states neither.
    """
    if value != INTERVAL:
        return value
    if name in file.ranges:
        return "{!r}..{!r}".format(*file.ranges[name])
    source = file.sources.get(name, "")
    if not (match := _ENDS.search(source)):
        raise ValueError(
            f"{name} = {INTERVAL}: its source states none: {source!r}; expected '... interval LOW to HIGH'"
        )
    return f"{match[1]}..{match[2]}"


def _check(parameter: Uncertain, item: Any) -> None:
    """Raise ValueError if a parameter cannot be uncertain, or its distribution exceeds its interval.

    item : dataclass field that declares the parameter
    """
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
    """Loads (m): a ramp from 0 to `to`, or the single load that was set.

    values      : parameter set
    single_load : the load that was set, or None
    load        : distribution of the load, or None

    Raises ValueError for a load outside of the tabulated law, or a wrong ramp.
    """
    allowed = Interval.of(gt=0.0, le=curves.most(values))
    if at is not None:
        if to is not None:
            raise ValueError(f"{curves.load.name} is set and cannot be ramped as well; drop to = {to:g}")
        if not isinstance(at, int | float) or isinstance(at, bool):
            raise ValueError(f"{curves.load.name} = {at!r} is not a number in {curves.load.unit}")
        ends = [end for end in load.support if np.isfinite(end) and end != 0.0] if load else []
        for value in (float(at), *ends):
            if not allowed.contains(value):
                text = f"{curves.load.name} = {value:g} {curves.load.unit}"
                raise ValueError(f"{text} is outside {allowed}: {LOAD_END}")
        return np.array([float(at)])
    end = curves.to(values) if to is None else to
    if not allowed.contains(end):
        raise ValueError(f"to = {end:g} {curves.load.unit} is outside {allowed}: {LOAD_END}")
    if not 2 <= points <= 10_000:
        raise ValueError(f"points = {points} is outside [2, 10000]: points of the ramp")
    return np.linspace(0.0, end, points)
