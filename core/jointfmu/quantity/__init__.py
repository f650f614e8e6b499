"""Declared quantities: SI unit, interval and meaning of every physical parameter, and their checks."""

from .declaration import Checked, check, choice, group, problem, problems, quantity, series, span
from .interval import Array, Interval, Number, erf, where
from .parameter_set import Limit, assemble, build, changed, check_limits, flat_fields, flatten
from .smooth import smooth_step, smooth_step_integral, smooth_step_slopes

__all__ = [
    "Array",
    "Checked",
    "Interval",
    "Limit",
    "Number",
    "assemble",
    "build",
    "changed",
    "check",
    "check_limits",
    "choice",
    "erf",
    "flat_fields",
    "flatten",
    "group",
    "problem",
    "problems",
    "quantity",
    "series",
    "smooth_step",
    "smooth_step_integral",
    "smooth_step_slopes",
    "span",
    "where",
]
