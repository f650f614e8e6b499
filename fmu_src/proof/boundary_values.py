"""Boundary values of parameters, just inside their allowed intervals, which an FMU must accept.

Other parameters can narrow an interval further, so that the joint refuses a value just inside its end. Then
bisection between the end and the value of the parameter file finds a value that is accepted.
"""

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval

from .reference import round_to_significant_digits

OPEN_END_DISTANCE_OVER_INTERVAL_WIDTH = 1e-6
"""Distance of a boundary value from an open end over the width of the interval [1]."""
BISECTION_STEP_COUNT = 5
"""Number of bisection steps [1] for a boundary value that the joint accepts."""
ROUND_OFF_SHIFT_OVER_BISECTION_DISTANCE = 0.02
"""Shift from the last accepted value to the value of the file, over their distance [1]: round-off margin."""


def find_boundary_values(
    fmu_model: Model,
    parameter_file: ParameterFile,
    is_parameter_value_accepted: Callable[[str, object], bool],
) -> Iterator[tuple[str, Any, str]]:
    """Yield (parameter, boundary value, description) for each end of each parameter's allowed interval.

    is_parameter_value_accepted : function (parameter, value) that returns whether the joint accepts the value

    An open end at zero is skipped if the other end is infinite: such an interval has no scale.
    """
    for name, item in fmu_model.parameter_fields().items():
        value, meta = parameter_file.values_by_name[name], item.metadata
        if isinstance(value, bool):
            if is_parameter_value_accepted(name, not value):
                yield name, not value, "the other choice"
            continue
        if "interval" not in meta or isinstance(value, str | tuple):
            continue
        interval: Interval = meta["interval"]
        for end, other, is_open in (
            (interval.low, interval.high, interval.low_open),
            (interval.high, interval.low, interval.high_open),
        ):
            if not math.isfinite(end) or (end == 0.0 and is_open and not math.isfinite(other)):
                continue
            width = abs(other - end) if math.isfinite(other) else max(abs(value - end), 1.0)
            first = (
                end + math.copysign(OPEN_END_DISTANCE_OVER_INTERVAL_WIDTH * width, value - end)
                if is_open
                else end
            )
            boundary_value = _find_nearest_accepted_value(
                float(first), float(value), bool(meta["whole"]), partial(is_parameter_value_accepted, name)
            )
            if boundary_value is not None and boundary_value != value:
                yield name, boundary_value, f"inside {interval}"


def _find_nearest_accepted_value(
    boundary_value: float,
    parameter_file_value: float,
    is_integer: bool,
    is_value_accepted: Callable[[float], bool],
) -> float | None:
    """Find the accepted parameter value nearest to a boundary value, by bisection towards the file's value.

    Returns None if only the value of the parameter file is accepted.
    """
    round_value: Callable[[float], float] = round if is_integer else round_to_significant_digits
    if is_value_accepted(round_value(boundary_value)):
        return float(round_value(boundary_value))
    refused, accepted = boundary_value, parameter_file_value
    for _ in range(BISECTION_STEP_COUNT):
        middle = 0.5 * (refused + accepted)
        refused, accepted = (
            (refused, middle) if is_value_accepted(round_value(middle)) else (middle, accepted)
        )
    inward = float(
        round_value(accepted + ROUND_OFF_SHIFT_OVER_BISECTION_DISTANCE * (parameter_file_value - accepted))
    )
    return inward if is_value_accepted(inward) else None
