"""A parameter exchanged for what the data see of it, while a fit searches.

Where a law's level and exponent together make a stiffness that the data know a thousand times better than
either, steps in the two parameters leave the narrow curved valley of that stiffness at once. With the
stiffness as an unknown instead of the level the valley is straight.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from .least_squares import Array, Solution, Unknown, covariance

EXACT, MOST_STEPS = 1e-10, 40
"""Relative accuracy with which the quantity is met [1], and the steps for that."""
STEP = 1e-4
"""Step of the differences in a logarithm [1]."""


@dataclass(frozen=True, slots=True)
class Exchange:
    """What takes the place of an unknown.

    name     : of the unknown
    quantity : what takes its place; a positive function of the values, monotone in the unknown
    unit     : of the quantity
    label    : its name
    """

    name: str
    quantity: Callable[[Mapping[str, float]], float]
    unit: str
    label: str

    def unknown(self, unknowns: Mapping[str, Unknown]) -> Unknown:
        """The quantity as an unknown, at the start of the others."""
        start = self.quantity({name: u.start for name, u in unknowns.items()})
        return Unknown(self.label, self.unit, start, 0.0, np.inf)

    def values(self, found: Mapping[str, float], near: float) -> dict[str, float]:
        """The values of the unknowns in which the quantity stands for its own; the search begins at `near`.

        Raises ValueError if the quantity cannot be met.
        """
        rest = {name: value for name, value in found.items() if name != self.label}
        target = float(np.log(found[self.label]))

        def miss(log: float) -> float:
            return float(np.log(self.quantity({**rest, self.name: float(np.exp(log))}))) - target

        low, high = float(np.log(near)), float(np.log(near)) + STEP
        at_low, at_high = miss(low), miss(high)
        for _ in range(MOST_STEPS):
            if abs(at_high) <= EXACT or at_high == at_low:
                break
            step = -at_high * (high - low) / (at_high - at_low)
            low, high = high, high + float(np.clip(step, -5.0, 5.0))
            at_low, at_high = at_high, miss(high)
        if abs(at_high) > 1e3 * EXACT:
            raise ValueError(f"no {self.name} gives {self.label} = {found[self.label]:g} {self.unit}")
        return {**rest, self.name: float(np.exp(high))}

    def back(self, solution: Solution, unknowns: Mapping[str, Unknown]) -> Solution:
        """A solution over the quantity as one over the unknowns."""
        found = self.values(solution.values, unknowns[self.name].start)
        values = {name: found[name] for name in unknowns}
        turn = np.eye(len(values))
        own = [u.name for u in solution.unknowns].index(self.label)
        turn[own] = self._slopes(values)
        jacobian = solution.jacobian @ turn
        return replace(
            solution,
            unknowns=tuple(unknowns.values()),
            values=values,
            jacobian=jacobian,
            covariance=covariance(jacobian, solution.noise),
        )

    def _slopes(self, values: Mapping[str, float]) -> Array:
        """Derivatives of the quantity in the values, all in logarithms."""

        def moved(name: str, by: float) -> float:
            return float(np.log(self.quantity({**values, name: values[name] * float(np.exp(by))})))

        return np.array([(moved(n, STEP) - moved(n, -STEP)) / (2.0 * STEP) for n in values])
