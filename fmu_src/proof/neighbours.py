"""The neighbours of refusals: values of parameters just inside their intervals, which an FMU must take.

Where the joint itself refuses what lies just inside an interval, since other parameters narrow it, the
neighbour is looked for between the interval's end and the value of the parameter file.
"""

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval

from .reference import rounded

NEAR = 1e-6
"""Distance from an open end, in widths of the interval [1]."""
HALVINGS = 5
INWARD = 0.02
"""From the last value that the joint takes towards the file's [1]: round-off decides nothing there."""


def neighbours(
    model: Model, parameters: ParameterFile, taken: Callable[[str, object], bool]
) -> Iterator[tuple[str, Any, str]]:
    """Name and value of a parameter, one at a time, and what it is near to.

    taken : whether the joint takes a value of a parameter

    An open end at zero of an interval without another end has no neighbour: nothing says what is near.
    """
    for name, item in model.parameter_fields().items():
        value, meta = parameters.flat[name], item.metadata
        if isinstance(value, bool):
            if taken(name, not value):
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
            first = end + math.copysign(NEAR * width, value - end) if is_open else end
            found = _inside(float(first), float(value), bool(meta["whole"]), partial(taken, name))
            if found is not None and found != value:
                yield name, found, f"inside {interval}"


def _inside(first: float, value: float, whole: bool, taken: Callable[[float], bool]) -> float | None:
    """The value nearest to `first` that is taken; None if there is none beside the file's own."""
    shown: Callable[[float], float] = round if whole else rounded
    if taken(shown(first)):
        return float(shown(first))
    refused, accepted = first, value
    for _ in range(HALVINGS):
        middle = 0.5 * (refused + accepted)
        refused, accepted = (refused, middle) if taken(shown(middle)) else (middle, accepted)
    inward = float(shown(accepted + INWARD * (value - accepted)))
    return inward if taken(inward) else None
