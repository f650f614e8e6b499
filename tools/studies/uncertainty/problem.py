"""Statement of an uncertainty study: parameters with distributions, load ramp, evaluation of the runs."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.joints.model import Variable
from jointfmu.parameters import ParameterFile, format_parameter_file
from jointfmu.quantity import Array, Interval, find_problem, flatten_fields
from jointfmu.quantity.refusal import InputRefusal

from .curves import LoadCurves, find_load_curves
from .journal import sha256_text
from .study import UncertainParameter, draw_samples, is_relative, split_settings
from .worker import LOAD_INTERVAL_MEANING, JointRamp, RampEvaluator

INTERVAL_SETTING = "interval"
"""Setting that stands for the interval stated in the parameter file: its range, or the text of its source."""
_INPUTS_SECTION_PREFIX = "inputs."
"""Prefix of the names of start values of inputs in a parameter file."""
_INTERVAL_PATTERN = re.compile(r"\binterval ([-+.\de]+) to ([-+.\de]+)")
"""Interval in the text of a source: its two ends."""


@dataclass(frozen=True, slots=True)
class UncertaintyProblem:
    """Uncertainty study of a joint or an FMU: uncertain parameters, load ramp, evaluation of a run.

    title     : kind of the joint, or name of the FMU file
    ramped_input : the ramped input, called the load
    loads     : load ramp (m), ascending for a joint
    units     : {output: unit}
    uncertain_parameters : parameters with a distribution; the load is the last one if it has a distribution
    settings  : {name: value} of all runs of an FMU
    evaluator : evaluation of one run
    identifying_record : JSON object that identifies joint or FMU, and ramp
    """

    title: str
    ramped_input: Variable
    loads: Array
    units: Mapping[str, str]
    uncertain_parameters: tuple[UncertainParameter, ...]
    settings: Mapping[str, Any]
    evaluator: RampEvaluator
    identifying_record: Mapping[str, Any]

    @property
    def variable_units(self) -> dict[str, str]:
        """Units of the load and of the outputs: {variable: unit}."""
        return {self.ramped_input.name: self.ramped_input.unit, **self.units}

    def list_runs(self, unit_cube_points: Array) -> list[dict[str, Any]]:
        """Settings of the runs for points (n, d) of the unit cube."""
        samples = draw_samples(self.uncertain_parameters, unit_cube_points)
        rows = zip(*(column.tolist() for column in samples.values()), strict=True)
        return [{**self.settings, **dict(zip(samples, row, strict=True))} for row in rows]

    def study_record(self, sample_count: int, seed: int) -> dict[str, Any]:
        """JSON object that identifies the study, for its folder."""
        distributions = {
            parameter.name: parameter.distribution_text for parameter in self.uncertain_parameters
        }
        counts = {"samples": sample_count, "seed": seed}
        return {**self.identifying_record, **counts, "parameters": {**distributions, **self.settings}}


def state_problem(
    parameter_file: ParameterFile,
    settings: Mapping[str, object],
    ramp_end: float | None,
    ramp_point_count: int,
) -> UncertaintyProblem:
    """State the uncertainty study of a parameter file: load ramp, and settings with distributions.

    settings         : {name: value or text of a distribution}
    ramp_end         : end of the load ramp; None: end of the joint's law, or of the file
    ramp_point_count : number of points of the ramp

    A parameter without setting is uniformly distributed over the range that the file states, if it does. So
    is the load, if its start value in the file has a range, unless `ramp_end` is stated.

    Raises ValueError for an unknown name, a value outside its interval, or a distribution of a parameter that
    cannot be uncertain.
    """
    curves, declared = (
        find_load_curves(KINDS[parameter_file.joint]),
        dict(flatten_fields(type(parameter_file.values))),
    )
    base = dict(parameter_file.values_by_name)
    lists = {name for name, item in declared.items() if "series" in item.metadata}
    settable = [*(base.keys() - lists), curves.load.name]
    if unknown := [name for name in settings if name not in settable]:
        allowed = ", ".join(name for name in [*declared, curves.load.name] if name in settable)
        raise ValueError(f"unknown name {unknown[0]!r}, allowed are {allowed}")
    stated = {name for name in parameter_file.ranges if name in base}
    if _INPUTS_SECTION_PREFIX + curves.load.name in parameter_file.ranges and ramp_end is None:
        stated.add(curves.load.name)
    settings = dict.fromkeys(sorted(stated), INTERVAL_SETTING) | dict(settings)
    settings = {
        name: _load_interval(curves, parameter_file)
        if (name, value) == (curves.load.name, INTERVAL_SETTING)
        else resolve_interval(name, value, parameter_file)
        for name, value in settings.items()
    }
    load_text = settings.get(curves.load.name)
    relative = isinstance(load_text, str) and is_relative(load_text)
    plain, uncertain = split_settings(settings, base | ({curves.load.name: 1.0} if relative else {}))
    set_load = plain.pop(curves.load.name, None)
    nominal = parameter_file.with_values(plain, "user", "set for the study")
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
        ramp_end
        if ramp_end is not None or single is not None
        else parameter_file.start_value(curves.load.name) or None
    )
    loads = _ramp_loads(curves, nominal.values, single, end, ramp_point_count, load)
    record = {
        "joint": parameter_file.joint,
        "parameter_file_sha256": sha256_text(format_parameter_file(nominal).encode()),
        "load": curves.load.name,
        "to": float(loads[-1]),
        "points": loads.size,
    }
    model = (
        KINDS[parameter_file.joint]
        .find_model(curves.model)
        .with_parameters(parameter_file.joint, parameter_file.values)
    )
    exposed = {*model.parameter_fields(), curves.load.name}
    reopens = any(parameter.name not in exposed for parameter in order)
    ramp = JointRamp(nominal, loads, relative, reopens)
    return UncertaintyProblem(parameter_file.joint, curves.load, loads, curves.units, order, {}, ramp, record)


def _load_interval(curves: LoadCurves, parameter_file: ParameterFile) -> str:
    """Range of the load as text LOW..HIGH, less the part of the load that the joint loses (by embedding).

    Raises ValueError if the file states no range for the start value of the load, or if the joint loses all.
    """
    name = _INPUTS_SECTION_PREFIX + curves.load.name
    if name not in parameter_file.ranges:
        raise ValueError(f"{curves.load.name} = {INTERVAL_SETTING}: the file states no range of {name}")
    loss = curves.load_loss(parameter_file.values)
    low, high = (end - loss for end in parameter_file.ranges[name])
    if low <= 0.0:
        raise ValueError(
            f"range of {name}: {parameter_file.ranges[name][0]:g} {curves.load.unit} is outside "
            f"({loss:g}, inf) {curves.load.unit}: the joint loses all of it; "
            f"state {curves.load.name}=LOW..HIGH"
        )
    return f"{low!r}..{high!r}"


def resolve_interval(parameter_name: str, setting: object, parameter_file: ParameterFile) -> object:
    """Replace the setting "interval" by the text LOW..HIGH; other settings are returned unchanged.

    The ends are the range of the parameter in the file, else the interval stated in the text of its source.

    Raises ValueError if the file states neither.
    """
    if setting != INTERVAL_SETTING:
        return setting
    for entry in (parameter_name, _INPUTS_SECTION_PREFIX + parameter_name):
        if entry in parameter_file.ranges:
            return "{!r}..{!r}".format(*parameter_file.ranges[entry])
    source = parameter_file.sources.get(parameter_name, "")
    if not (match := _INTERVAL_PATTERN.search(source)):
        raise ValueError(
            f"{parameter_name} = {INTERVAL_SETTING}: its source states none: {source!r}; expected '... "
            "interval LOW to HIGH'"
        )
    return f"{match[1]}..{match[2]}"


def _check_uncertain(parameter: UncertainParameter, parameter_field: Any) -> None:
    """Raise ValueError if a parameter cannot be uncertain, or its distribution exceeds its interval.

    parameter_field : dataclass field that declares the parameter
    """
    if "allowed" in parameter_field.metadata:
        raise ValueError(
            f"{parameter.name} = {parameter.distribution_text}: is a named choice and cannot be uncertain"
        )
    if parameter_field.metadata["whole"]:
        raise ValueError(
            f"{parameter.name} = {parameter.distribution_text}: is a whole number and cannot be uncertain"
        )
    for value in (
        *(end for end in parameter.support if np.isfinite(end)),
        float(parameter.distribution.median()),
    ):
        tolerated = (
            value == 0.0 and parameter.support[0] == 0.0 and parameter_field.metadata["interval"].low == 0.0
        )
        if not tolerated and (text := find_problem(parameter.name, value, parameter_field)):
            raise ValueError(f"{parameter.name} = {parameter.distribution_text}: {text}")


def _ramp_loads(
    curves: LoadCurves,
    parameter_set: object,
    single_load: object,
    ramp_end: float | None,
    load_count: int,
    uncertain_load: UncertainParameter | None,
) -> Array:
    """Loads (m): a ramp from 0 to `ramp_end`, or the single load that was set.

    parameter_set  : parameter set
    single_load    : the load that was set, or None
    uncertain_load : distribution of the load, or None

    Raises ValueError for a load outside of the tabulated law, or a wrong ramp.
    """
    allowed = Interval.from_bounds(gt=0.0, le=curves.max_load(parameter_set))
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
                raise ValueError(f"{text} is outside {allowed}: {LOAD_INTERVAL_MEANING}")
        return np.array([float(single_load)])
    end = curves.default_end(parameter_set) if ramp_end is None else ramp_end
    if not allowed.contains(end):
        raise ValueError(f"to = {end:g} {curves.load.unit} is outside {allowed}: {LOAD_INTERVAL_MEANING}")
    if not 2 <= load_count <= 10_000:
        raise ValueError(f"points = {load_count} is outside [2, 10000]: points of the ramp")
    return np.linspace(0.0, end, load_count)
