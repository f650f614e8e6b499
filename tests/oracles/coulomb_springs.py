"""Coulomb friction by many independent springs, each with its own first contact and friction limit.

The springs represent a convex curve p(delta). Each moves by the radial return of plasticity. The code is
independent of the package's sliders.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.jenkins import SliderUpdate

from .sphere_friction import load_levels

Array = NDArray[np.float64]

WORKING, LOWEST, STEP = (5e4, 5e7), 1e-9, 0.04
"""Range of pressures [Pa] with close springs; lowest load level, logarithmic step of the levels [1]."""


@dataclass(frozen=True)
class Springs:
    """Springs that discretise a curve: one for each interval between edges (n + 1) [m], at its mean height.

    pressure_curve : pressure [Pa] over approach [m]; `ratio` K_T/K_N [1], `friction` mu [1]
    """

    pressure_curve: Curve
    ratio: float
    friction: float
    edges: Array

    @classmethod
    def of(cls, curve: Curve, ratio: float, friction: float) -> "Springs":
        """Springs with small intervals in the range of working pressures."""
        end = curve.end_point[1]
        level = load_levels(LOWEST, (WORKING[0] / end, WORKING[1] / end), STEP)
        return cls(curve, ratio, friction, curve.inverse(level * end))

    @cached_property
    def stiffness(self) -> Array:
        """Normal stiffness (n) [Pa/m] of the springs."""
        return np.diff(self.pressure_curve.derivatives(self.edges, 1)[1])

    @cached_property
    def heights(self) -> Array:
        """Heights (n) [m] at which the springs touch; the pressure is exact at the edges."""
        load, slope = self.pressure_curve.derivatives(self.edges, 1)
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        moment, carries = np.diff(self.edges * slope - load), self.stiffness > 1e-12 * slope[-1]
        return np.divide(moment, self.stiffness, out=middle, where=carries)

    def virgin_forces(self, count: int) -> Array:
        """Forces (count, 2, n) [Pa] of springs that have not moved."""
        return np.zeros((count, 2, self.edges.size - 1))

    def advance(self, force: Array, before: Array, after: Array, shift: Array) -> SliderUpdate:
        """Move along a short straight path between approaches (P) [m], by tangential increments (P, 2) [m].

        A spring sticks, or its force returns radially to the friction limit; the heat is force times slip.
        First order in the increment where the direction or the approach changes.
        """
        limit = self.friction * self.stiffness * np.maximum(after[:, None] - self.heights, 0.0)
        slope = self.ratio * np.where(limit > 0.0, self.stiffness, 0.0)
        trial = force + slope[:, None] * shift[:, :, None]
        size = np.hypot(trial[:, 0], trial[:, 1])
        slips = size > limit
        part = np.where(slips, limit / np.maximum(size, 1e-300), 1.0)
        slip = np.divide(size - limit, slope, out=np.zeros_like(size), where=slips & (slope > 0.0))
        x, y = np.moveaxis(trial / np.maximum(size, 1e-300)[:, None], 1, 0)
        bent, kept = np.where(slips, slope * part, 0.0), np.where(slips, 0.0, slope)
        tangent = [np.sum(t, axis=1) for t in (kept + bent * y * y, -bent * x * y, kept + bent * x * x)]
        return SliderUpdate(trial * part[:, None], np.sum(limit * slip, axis=1), np.stack(tangent, axis=-1))
