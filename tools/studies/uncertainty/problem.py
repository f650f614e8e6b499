"""Statement of an uncertainty propagation: parameters, distributions, load ramp, reduced curves of the joint.

Reduced curves are a fast evaluation of the joint for many samples at once.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Interval, find_problem, flat_fields
from jointfmu.quantity.refusal import InputRefusal

from ...common.joint_parts import load_tool_module
from .study import UncertainParameter, draw_samples, is_relative, split_settings

EvaluateFunction = Callable[[type[Any], Mapping[str, Any], Array, Array], dict[str, Array]]
"""Type of `ReducedCurves.evaluate`."""


@dataclass(frozen=True, slots=True)
class ReducedCurves:
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
    default_end: Callable[[Any], float]
    max_load: Callable[[Any], Any]
    evaluate: EvaluateFunction
    exact: Callable[[Any, Array], dict[str, Array]]

    @property
    def units(self) -> dict[str, str]:
        """{output: unit}."""
        return {v.name: v.unit for v in self.outputs}


def reduced_curves(kind: JointKind) -> ReducedCurves:
    """Reduced curves of a kind of joint, from its module `reduced`.

    Raises ValueError if the joint has none.
    """
    module = load_tool_module(kind, "reduced")
    if module is None:
        raise ValueError(f"joint = {kind.name!r} has no evaluation for many samples at once")
    curves: ReducedCurves = module.REDUCED
    return curves


INTERVAL_SETTING = "interval"
"""Setting that stands for the interval stated in the parameter file: its range, or the text of its source."""
_INTERVAL_PATTERN = re.compile(r"\binterval ([-+.\de]+) to ([-+.\de]+)")
"""Interval in the text of a source: its two ends."""
LOAD_LIMIT_TEXT = "up to the end of the tabulated law"
"""Meaning of the load interval, for error messages."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Uncertainty propagation problem of a joint.

    joint      : name of the kind of joint
    parameter_class : class of the parameter set
    values     : {name: value} of the parameter file, with the settings that are plain values
    uncertain_parameters : parameters with a distribution; the load is the last one if it has a distribution
    loads      : load ramp (m), ascending; one point if the load itself was set
    load_is_relative : whether the distribution of the load is a factor on the ramp; None if it has none
    """

    joint: str
    parameter_class: type[object]
    values: Mapping[str, object]
    uncertain_parameters: tuple[UncertainParameter, ...]
    loads: Array
    load_is_relative: bool | None = None

    @property
    def curves(self) -> ReducedCurves:
        return reduced_curves(KINDS[self.joint])

    def sample_values(self, points: Array) -> tuple[dict[str, object], Array]:
        """Values of all parameters, {name: value or samples (n)}, and load factors (n).

        points : points (n, d) of the unit cube
        """
        samples = draw_samples(self.uncertain_parameters, points)
        load = samples.pop(self.curves.load.name, None)
        factor = (
            np.ones(len(points)) if load is None else load if self.load_is_relative else load / self.loads[-1]
        )
        return {**self.values, **samples}, factor


def state_problem(
    file: ParameterFile, settings: Mapping[str, object], ramp_end: float | None, points: int
) -> Problem:
    """State the problem of a parameter file and settings.

    settings : {name: value or text of a distribution}
    ramp_end : end of the load ramp; None: end of the joint's law, or of the file
    points   : number of points of the ramp

    A parameter without setting is uniformly distributed over the range that the file states, if it does.

    Raises ValueError for an unknown name, a value outside its interval, or a distribution of a parameter that
    cannot be uncertain.
    """
    kind = KINDS[file.joint]
    curves, declared = reduced_curves(kind), dict(flat_fields(type(file.values)))
    base = dict(file.values_by_name)
    lists = {name for name, item in declared.items() if "series" in item.metadata}
    settable = [*(base.keys() - lists), curves.load.name]
    if unknown := [name for name in settings if name not in settable]:
        allowed = ", ".join(name for name in [*declared, curves.load.name] if name in settable)
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {allowed}")
    settings = dict.fromkeys(file.ranges, INTERVAL_SETTING) | dict(settings)
    settings = {name: resolve_interval(name, value, file) for name, value in settings.items()}
    load_text = settings.get(curves.load.name)
    relative = isinstance(load_text, str) and is_relative(load_text)
    plain, uncertain = split_settings(settings, base | ({curves.load.name: 1.0} if relative else {}))
    set_load = plain.pop(curves.load.name, None)
    nominal = file.with_values(plain, "user", "set for the study")
    for parameter in uncertain:
        if parameter.name != curves.load.name:
            _check_uncertain(parameter, declared[parameter.name])
    order = tuple(sorted(uncertain, key=lambda parameter: parameter.name == curves.load.name))
    if not order:
        raise InputRefusal(
            "no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings"
        )
    load = next((parameter for parameter in order if parameter.name == curves.load.name), None)
    median = None if load is None or relative else float(load.distribution.median())
    single = set_load if set_load is not None else median
    end = (
        ramp_end if ramp_end is not None or single is not None else file.start_value(curves.load.name) or None
    )
    loads = _ramp_loads(curves, nominal.values, single, end, points, load)
    return Problem(
        file.joint, type(file.values), nominal.values_by_name, order, loads, relative if load else None
    )


def resolve_interval(name: str, value: object, file: ParameterFile) -> object:
    """Replace the setting "interval" by the text LOW..HIGH; other settings are returned unchanged.

    The ends are the range of the parameter in the file, else the interval stated in the text of its source.

    Raises ValueError if the file states neither.
    """
    if value != INTERVAL_SETTING:
        return value
    if name in file.ranges:
        return "{!r}..{!r}".format(*file.ranges[name])
    source = file.sources.get(name, "")
    if not (match := _INTERVAL_PATTERN.search(source)):
        raise ValueError(
            f"{name} = {INTERVAL_SETTING}: its source states none: {source!r}; expected '... interval "
            "LOW to HIGH'"
        )
    return f"{match[1]}..{match[2]}"


def _check_uncertain(parameter: UncertainParameter, item: Any) -> None:
    """Raise ValueError if a parameter cannot be uncertain, or its distribution exceeds its interval.

    item : dataclass field that declares the parameter
    """
    if "allowed" in item.metadata:
        raise ValueError(f"{parameter.name} = {parameter.text}: is a named choice and cannot be uncertain")
    if item.metadata["whole"]:
        raise ValueError(f"{parameter.name} = {parameter.text}: is a whole number and cannot be uncertain")
    for value in (
        *(end for end in parameter.support if np.isfinite(end)),
        float(parameter.distribution.median()),
    ):
        tolerated = value == 0.0 and parameter.support[0] == 0.0 and item.metadata["interval"].low == 0.0
        if not tolerated and (text := find_problem(parameter.name, value, item)):
            raise ValueError(f"{parameter.name} = {parameter.text}: {text}")


def _ramp_loads(
    curves: ReducedCurves,
    values: object,
    single_load: object,
    ramp_end: float | None,
    points: int,
    uncertain_load: UncertainParameter | None,
) -> Array:
    """Loads (m): a ramp from 0 to `ramp_end`, or the single load that was set.

    values         : parameter set
    single_load    : the load that was set, or None
    uncertain_load : distribution of the load, or None

    Raises ValueError for a load outside of the tabulated law, or a wrong ramp.
    """
    allowed = Interval.from_bounds(gt=0.0, le=curves.max_load(values))
    if single_load is not None:
        if ramp_end is not None:
            raise ValueError(
                f"{curves.load.name} is set and is also the ramped input; leave out to = {ramp_end:g}"
            )
        if not isinstance(single_load, int | float) or isinstance(single_load, bool):
            raise ValueError(f"{curves.load.name} = {single_load!r} is not a number in {curves.load.unit}")
        ends = (
            [end for end in uncertain_load.support if np.isfinite(end) and end != 0.0]
            if uncertain_load
            else []
        )
        for value in (float(single_load), *ends):
            if not allowed.contains(value):
                text = f"{curves.load.name} = {value:g} {curves.load.unit}"
                raise ValueError(f"{text} is outside {allowed}: {LOAD_LIMIT_TEXT}")
        return np.array([float(single_load)])
    end = curves.default_end(values) if ramp_end is None else ramp_end
    if not allowed.contains(end):
        raise ValueError(f"to = {end:g} {curves.load.unit} is outside {allowed}: {LOAD_LIMIT_TEXT}")
    if not 2 <= points <= 10_000:
        raise ValueError(f"points = {points} is outside [2, 10000]: points of the ramp")
    return np.linspace(0.0, end, points)
