"""Intervals with open and closed ends; functions that take floats, arrays and CasADi symbols alike."""

import math
import sys
from dataclasses import dataclass
from math import inf, nextafter
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Number: TypeAlias = Any
"""A float, an array of floats, or a symbol of a computer-algebra tool: what a law accepts."""


@dataclass(frozen=True, slots=True)
class Interval:
    """Interval of real numbers. An open end does not belong to the interval, a closed end does.

    low, high           : floats, arrays or symbols; a float end at infinity is always open
    low_open, high_open : whether the end is open
    """

    low: Number = -inf
    high: Number = inf
    low_open: bool = True
    high_open: bool = True

    def __post_init__(self) -> None:
        if isinstance(self.low, float) and self.low == -inf:
            object.__setattr__(self, "low_open", True)
        if isinstance(self.high, float) and self.high == inf:
            object.__setattr__(self, "high_open", True)

    @classmethod
    def from_bounds(
        cls,
        *,
        gt: Number | None = None,
        ge: Number | None = None,
        lt: Number | None = None,
        le: Number | None = None,
    ) -> "Interval":
        """Interval from `gt` (open) or `ge` (closed) to `lt` (open) or `le` (closed); None: no end.

        Raises ValueError if an end is given twice.
        """
        for open_end, closed_end, names in ((gt, ge, "gt and ge"), (lt, le, "lt and le")):
            if open_end is not None and closed_end is not None:
                raise ValueError(f"{names} = {open_end}, {closed_end} are the same end; state only one")
        low = gt if ge is None else ge
        high = lt if le is None else le
        return cls(-inf if low is None else low, inf if high is None else high, ge is None, le is None)

    def contains(self, tested_value: Number) -> Any:
        """Whether values lie inside the interval, elementwise; False for NaN and infinity.

        True if a value or an end is a symbol of computer algebra: it has no value yet.
        """
        if is_casadi_symbol(tested_value) or is_casadi_symbol(self.low) or is_casadi_symbol(self.high):
            return True
        above = tested_value > self.low if self.low_open else tested_value >= self.low
        below = tested_value < self.high if self.high_open else tested_value <= self.high
        return above & below

    @property
    def is_empty(self) -> bool:
        """Whether the interval contains no number that a message with six digits can show.

        True also if an end is NaN, or the lower end is above the upper one.
        """
        if self.low == self.high:
            return self.low_open or self.high_open
        resolution = 1e-5 * min(abs(self.low), abs(self.high))
        return not self.low < self.high or bool(self.high - self.low <= resolution < inf)

    def intersection(self, other_interval: "Interval") -> "Interval":
        """Intersection of two intervals; a common end is open if it is open in one of them."""
        low, low_open = max((self.low, self.low_open), (other_interval.low, other_interval.low_open))
        high, high_closed = min(
            (self.high, not self.high_open), (other_interval.high, not other_interval.high_open)
        )
        return Interval(low, high, low_open, not high_closed)

    def closed_bounds(self) -> tuple[float, float]:
        """Smallest and largest float of the interval, for the attributes min and max of FMI.

        Infinite if the interval has no end.

        Next to an open end at zero this is the smallest normal float: some FMI tools reject denormal numbers.
        """
        low, high = float(self.low), float(self.high)
        return (
            _next_float(low, inf) if self.low_open and low > -inf else low,
            _next_float(high, -inf) if self.high_open and high < inf else high,
        )

    def __str__(self) -> str:
        left, right = "(" if self.low_open else "[", ")" if self.high_open else "]"
        return f"{left}{self.low:g}, {self.high:g}{right}"


def _next_float(start_value: float, target_value: float) -> float:
    """Next float after a start value in the direction of a target; next to zero the smallest normal float."""
    if start_value == 0.0:
        return sys.float_info.min if target_value > 0.0 else -sys.float_info.min
    return nextafter(start_value, target_value)


def is_casadi_symbol(tested_value: object) -> bool:
    """Whether a value is a symbol of a computer-algebra tool (CasADi)."""
    return type(tested_value) is not float and type(tested_value).__module__.startswith("casadi")


def erf(x: Number) -> Number:
    """Error function erf(x) [1] of floats, arrays or symbols."""
    if is_casadi_symbol(x):
        return sys.modules[type(x).__module__.partition(".")[0]].erf(x)
    return np.vectorize(math.erf, otypes=[float])(x)


def select(condition: Any, value_if_true: Number, value_if_false: Number) -> Number:
    """Select one of two values, element by element, by a condition; a scalar condition keeps the type."""
    if isinstance(condition, bool | np.bool_):
        return value_if_true if condition else value_if_false
    return np.where(condition, value_if_true, value_if_false)
