"""Declared quantities: SI unit, interval and meaning of every physical parameter, and their checks."""

from .declaration import (
    CheckedParameters,
    check_fields,
    choice_field,
    describe_range,
    find_problem,
    find_problems,
    group_field,
    quantity_field,
    series_field,
)
from .interval import Array, Interval, Number, erf, select
from .parameter_set import (
    ParameterLimit,
    assemble_parameter_set,
    build_parameter_set,
    check_limits,
    flatten_fields,
    flatten_parameters,
    replace_values,
)
from .smooth import smooth_step, smooth_step_integral, smooth_step_slopes

__all__ = [
    "Array",
    "CheckedParameters",
    "Interval",
    "Number",
    "ParameterLimit",
    "assemble_parameter_set",
    "build_parameter_set",
    "check_fields",
    "check_limits",
    "choice_field",
    "describe_range",
    "erf",
    "find_problem",
    "find_problems",
    "flatten_fields",
    "flatten_parameters",
    "group_field",
    "quantity_field",
    "replace_values",
    "select",
    "series_field",
    "smooth_step",
    "smooth_step_integral",
    "smooth_step_slopes",
]
