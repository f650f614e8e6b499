"""Statement of an uncertainty study: parameters with distributions, load ramp, evaluation of the runs."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointfmu.contact.roughness import HEIGHT_FIELDS
from jointfmu.joints import KINDS
from jointfmu.joints.model import Variable
from jointfmu.parameters import ParameterFile, format_parameter_file
from jointfmu.quantity import Array, Interval, find_problem, flatten_fields
from jointfmu.quantity.refusal import InputRefusal

from ...common.names import suggest_names
from .curves import LoadCurves, find_load_curves
from .journal import sha256_hex
from .study import UncertainParameter, draw_samples, is_relative_distribution, split_settings
from .worker import LOAD_INTERVAL_DESCRIPTION, JointRampEvaluator, RampEvaluator

INTERVAL_SETTING = "interval"
"""Setting that stands for the interval stated in the parameter file: its range, or the text of its source."""
_INPUTS_SECTION_PREFIX = "inputs."
"""Prefix of the names of start values of inputs in a parameter file."""
_INTERVAL_PATTERN = re.compile(r"\binterval ([-+.\de]+) to ([-+.\de]+)")
"""Interval in the text of a source: its two ends."""


@dataclass(frozen=True, slots=True)
class UncertaintyStudy:
    """Uncertainty study of a joint or an FMU: uncertain parameters, load ramp, evaluation of a run.

    study_subject        : kind of the joint, or name of the FMU file
    ramped_input         : the ramped input, called the load
    loads                : load ramp (m), ascending for a joint
    output_units         : {output: unit}
    uncertain_parameters : parameters with a distribution; the load is the last one if it has a distribution
    common_settings      : {name: value} that all runs of an FMU share
    run_evaluator        : evaluation of one run
    identifying_record   : JSON object that identifies joint or FMU, and ramp
    derived_meanings     : {output: meaning} of the quantities of a joint that its FMU does not output
    """

    study_subject: str
    ramped_input: Variable
    loads: Array
    output_units: Mapping[str, str]
    uncertain_parameters: tuple[UncertainParameter, ...]
    common_settings: Mapping[str, Any]
    run_evaluator: RampEvaluator
    identifying_record: Mapping[str, Any]
    derived_meanings: Mapping[str, str] = field(default_factory=dict)

    @property
    def variable_units(self) -> dict[str, str]:
        """Units of the load and of the outputs: {variable: unit}."""
        return {self.ramped_input.name: self.ramped_input.unit, **self.output_units}

    def list_run_settings(self, unit_cube_points: Array) -> list[dict[str, Any]]:
        """Settings {name: value} of one run for each of n points of the unit cube (n, d)."""
        samples = draw_samples(self.uncertain_parameters, unit_cube_points)
        rows = zip(*(column.tolist() for column in samples.values()), strict=True)
        return [{**self.common_settings, **dict(zip(samples, row, strict=True))} for row in rows]

    def make_study_record(self, sample_count: int, seed: int) -> dict[str, Any]:
        """JSON object that identifies the study, for its folder."""
        distributions = {
            parameter.name: parameter.distribution_text for parameter in self.uncertain_parameters
        }
        counts = {"samples": sample_count, "seed": seed}
        return {**self.identifying_record, **counts, "parameters": {**distributions, **self.common_settings}}


def define_joint_study(
    parameter_file: ParameterFile,
    study_settings: Mapping[str, object],
    ramp_end: float | None,
    ramp_point_count: int,
) -> UncertaintyStudy:
    """State the uncertainty study of a parameter file: load ramp, and settings with distributions.

    study_settings   : {name: value or text of a distribution}
    ramp_end         : end of the load ramp; None: end of the joint's law, or of the file
    ramp_point_count : number of points of the ramp

    A parameter without a setting is uniformly distributed over its range in the file, if it has one. The load
    is uniformly distributed if its start value in the file has a range and `ramp_end` is None; the nominal
    load is then this start value.

    Raises ValueError for an unknown name, a value outside its interval, or a distribution of a parameter that
    cannot be uncertain.
    """
    curves, declared = (
        find_load_curves(KINDS[parameter_file.joint]),
        dict(flatten_fields(type(parameter_file.values))),
    )
    base = dict(parameter_file.values_by_name)
    lists = {name for name, item in declared.items() if "series" in item.metadata}
    settable = [*(base.keys() - lists), curves.ramped_input.name]
    if unknown := [name for name in study_settings if name not in settable]:
        names = [name for name in [*declared, curves.ramped_input.name] if name in settable]
        raise ValueError(f"unknown name {unknown[0]!r}{_suggest_names(unknown[0], names)}")
    stated = {name for name in parameter_file.ranges if name in base}
    if _INPUTS_SECTION_PREFIX + curves.ramped_input.name in parameter_file.ranges and ramp_end is None:
        stated.add(curves.ramped_input.name)
    study_settings = dict.fromkeys(sorted(stated), INTERVAL_SETTING) | dict(study_settings)
    has_file_range = study_settings.get(curves.ramped_input.name) == INTERVAL_SETTING
    study_settings = {
        name: _format_load_interval(curves, parameter_file)
        if (name, value) == (curves.ramped_input.name, INTERVAL_SETTING)
        else resolve_interval_setting(name, value, parameter_file)
        for name, value in study_settings.items()
    }
    load_text = study_settings.get(curves.ramped_input.name)
    relative = isinstance(load_text, str) and is_relative_distribution(load_text)
    plain, uncertain = split_settings(
        study_settings, base | ({curves.ramped_input.name: 1.0} if relative else {})
    )
    set_load = plain.pop(curves.ramped_input.name, None)
    nominal = parameter_file.with_values(plain, "user", "set for the study")
    for parameter in uncertain:
        if parameter.name != curves.ramped_input.name:
            _check_uncertain_parameter(parameter, declared[parameter.name])
    order = tuple(sorted(uncertain, key=lambda parameter: parameter.name == curves.ramped_input.name))
    if not order:
        raise InputRefusal(
            "no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings"
        )
    load = next((parameter for parameter in order if parameter.name == curves.ramped_input.name), None)
    median = None if load is None or relative else float(load.distribution.median())
    file_load = parameter_file.start_value(curves.ramped_input.name) - curves.lost_load(parameter_file.values)
    nominal_load = file_load if has_file_range and file_load > 0.0 else median
    single = set_load if set_load is not None else nominal_load
    end = (
        ramp_end
        if ramp_end is not None or single is not None
        else parameter_file.start_value(curves.ramped_input.name) or None
    )
    loads = _make_ramp_loads(curves, nominal.values, single, end, ramp_point_count, load)
    record = {
        "joint": parameter_file.joint,
        "parameter_file_sha256": sha256_hex(format_parameter_file(nominal).encode()),
        "load": curves.ramped_input.name,
        "to": float(loads[-1]),
        "points": loads.size,
    }
    model = (
        KINDS[parameter_file.joint]
        .find_model(curves.fmu_name)
        .with_parameters(parameter_file.joint, parameter_file.values)
    )
    exposed = {*model.parameter_fields(), curves.ramped_input.name}
    reopens = any(parameter.name not in exposed for parameter in order)
    ramp = JointRampEvaluator(nominal, loads, relative, reopens)
    meanings = {each.output_variable.name: each.output_variable.doc for each in curves.derived_outputs}
    return UncertaintyStudy(
        parameter_file.joint,
        curves.ramped_input,
        loads,
        curves.quantity_units,
        order,
        {},
        ramp,
        record,
        meanings,
    )


def _suggest_names(unknown_name: str, known_names: Sequence[str]) -> str:
    """Text after an unknown name: h in place of a roughness, else similar names, else all names."""
    if unknown_name.removeprefix("roughness.") in HEIGHT_FIELDS:
        if "h" in known_names:
            return "; the roughness acts through the parameter h: vary h, as in h=+-20%"
        return "; the law of the file does not use the roughness"
    return suggest_names(unknown_name, known_names, 3) or f", allowed are {', '.join(known_names)}"


def _format_load_interval(load_curves: LoadCurves, parameter_file: ParameterFile) -> str:
    """Range of the load as text LOW..HIGH, less the part of the load that the joint loses (by embedding).

    Raises ValueError if the file states no range for the start value of the load, or if the joint loses all.
    """
    name = _INPUTS_SECTION_PREFIX + load_curves.ramped_input.name
    if name not in parameter_file.ranges:
        raise ValueError(
            f"{load_curves.ramped_input.name} = {INTERVAL_SETTING}: the file states no range of {name}; "
            f"state {load_curves.ramped_input.name}=LOW..HIGH"
        )
    loss = load_curves.lost_load(parameter_file.values)
    low, high = (end - loss for end in parameter_file.ranges[name])
    if low <= 0.0:
        raise ValueError(
            f"range of {name}: its lower end {parameter_file.ranges[name][0]:g} "
            f"{load_curves.ramped_input.unit} is outside ({loss:g}, inf) {load_curves.ramped_input.unit}, "
            f"so the joint may lose all of it; state {load_curves.ramped_input.name}=LOW..HIGH"
        )
    return f"{low!r}..{high!r}"


def resolve_interval_setting(
    parameter_name: str, setting_value: object, parameter_file: ParameterFile
) -> object:
    """Replace the setting "interval" of a parameter by the text LOW..HIGH; return other settings unchanged.

    LOW and HIGH are the range of the parameter in the file. Without a range, they are read from the text that
    states the source of the value in the file.

    Raises ValueError if the file states neither.
    """
    if setting_value != INTERVAL_SETTING:
        return setting_value
    for entry in (parameter_name, _INPUTS_SECTION_PREFIX + parameter_name):
        if entry in parameter_file.ranges:
            return "{!r}..{!r}".format(*parameter_file.ranges[entry])
    source = parameter_file.sources.get(parameter_name, "")
    if not (match := _INTERVAL_PATTERN.search(source)):
        raise ValueError(
            f"{parameter_name} = {INTERVAL_SETTING}: the parameter file states no interval of "
            f"{parameter_name}; state {parameter_name}=LOW..HIGH, or write range = [LOW, HIGH] into the file"
        )
    return f"{match[1]}..{match[2]}"


def _check_uncertain_parameter(uncertain_parameter: UncertainParameter, parameter_field: Any) -> None:
    """Raise ValueError if a parameter cannot be uncertain, or its distribution exceeds its interval.

    parameter_field : dataclass field that declares the parameter
    """
    stated = f"{uncertain_parameter.name} = {uncertain_parameter.distribution_text}"
    if "allowed" in parameter_field.metadata:
        raise ValueError(f"{stated}: is a named choice and cannot be uncertain")
    if parameter_field.metadata["whole"]:
        raise ValueError(f"{stated}: is a whole number and cannot be uncertain")
    for value in (
        *(end for end in uncertain_parameter.support_interval if np.isfinite(end)),
        float(uncertain_parameter.distribution.median()),
    ):
        tolerated = (
            value == 0.0
            and uncertain_parameter.support_interval[0] == 0.0
            and parameter_field.metadata["interval"].low == 0.0
        )
        if not tolerated and (text := find_problem(uncertain_parameter.name, value, parameter_field)):
            raise ValueError(f"{stated}: {text}")


def _make_ramp_loads(
    load_curves: LoadCurves,
    parameter_set: object,
    single_load: object,
    ramp_end: float | None,
    ramp_point_count: int,
    uncertain_load: UncertainParameter | None,
) -> Array:
    """Loads (m): a ramp from 0 to `ramp_end`, or the single load that was set.

    parameter_set  : parameter set
    single_load    : the load that was set, or None
    uncertain_load : distribution of the load, or None; its ends must be within the tabulated law

    Raises ValueError for a load outside of the tabulated law, or a wrong ramp.
    """
    allowed = Interval.from_bounds(gt=0.0, le=load_curves.max_load(parameter_set))
    name, unit = load_curves.ramped_input.name, load_curves.ramped_input.unit
    if single_load is not None:
        if ramp_end is not None:
            raise ValueError(f"{name} is set, so there is no ramp; leave out to = {ramp_end:g}")
        if not isinstance(single_load, int | float) or isinstance(single_load, bool):
            raise ValueError(f"{name} = {single_load!r} is not a number in {unit}")
        ends = (
            [end for end in uncertain_load.support_interval if np.isfinite(end) and end != 0.0]
            if uncertain_load
            else []
        )
        for value in (float(single_load), *ends):
            if not allowed.contains(value):
                text = f"{load_curves.ramped_input.name} = {value:g} {load_curves.ramped_input.unit}"
                raise ValueError(f"{text} is outside {allowed}: {LOAD_INTERVAL_DESCRIPTION}")
        return np.array([float(single_load)])
    end = load_curves.default_ramp_end(parameter_set) if ramp_end is None else ramp_end
    if not allowed.contains(end):
        raise ValueError(
            f"to = {end:g} {load_curves.ramped_input.unit} is outside {allowed}: {LOAD_INTERVAL_DESCRIPTION}"
        )
    if not 2 <= ramp_point_count <= 10_000:
        raise ValueError(f"points = {ramp_point_count} is outside [2, 10000]: points of the ramp")
    return np.linspace(0.0, end, ramp_point_count)
