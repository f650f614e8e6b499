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

from .reference import round_to_digits

OPEN_END_DISTANCE_OVER_WIDTH = 1e-6
"""Distance of a boundary value from an open end over the width of the interval [1]."""
BISECTION_STEPS = 5
"""Number of bisection steps [1] for a boundary value that the joint accepts."""
INWARD_SHIFT_OVER_DISTANCE = 0.02
"""Shift from the last accepted value to the value of the file, over their distance [1]: round-off margin."""


def find_boundary_values(
    model: Model, parameters: ParameterFile, is_accepted: Callable[[str, object], bool]
) -> Iterator[tuple[str, Any, str]]:
    """Yield (parameter, boundary value, description), for one parameter at a time.

    is_accepted : (parameter, value) -> whether the joint accepts the value

    An open end at zero of an interval with an infinite other end is skipped: the interval has no scale.
    """
    for name, item in model.parameter_fields().items():
        value, meta = parameters.values_by_name[name], item.metadata
        if isinstance(value, bool):
            if is_accepted(name, not value):
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
            first = end + math.copysign(OPEN_END_DISTANCE_OVER_WIDTH * width, value - end) if is_open else end
            boundary_value = _nearest_accepted_value(
                float(first), float(value), bool(meta["whole"]), partial(is_accepted, name)
            )
            if boundary_value is not None and boundary_value != value:
                yield name, boundary_value, f"inside {interval}"


def _nearest_accepted_value(
    boundary_value: float, file_value: float, is_integer: bool, is_accepted: Callable[[float], bool]
) -> float | None:
    """Accepted value nearest to `boundary_value`, by bisection; None if only the file's value is accepted."""
    round_value: Callable[[float], float] = round if is_integer else round_to_digits
    if is_accepted(round_value(boundary_value)):
        return float(round_value(boundary_value))
    refused, accepted = boundary_value, file_value
    for _ in range(BISECTION_STEPS):
        middle = 0.5 * (refused + accepted)
        refused, accepted = (refused, middle) if is_accepted(round_value(middle)) else (middle, accepted)
    inward = float(round_value(accepted + INWARD_SHIFT_OVER_DISTANCE * (file_value - accepted)))
    return inward if is_accepted(inward) else None
