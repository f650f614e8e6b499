"""Tables of functions that are costly to evaluate, from values and slopes at equal distances."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .interface import SIDE, Law, checked_spots, largest_spot

Array = NDArray[np.float64]

CELL = 1.0 / 12.0
"""Cells of the stiffness tables in ln p [1]: quintics over two cells are accurate to 1e-12 there."""
MOST_CELLS = 1000
"""Cells of all stiffness tables of a law together; wider ones on an extreme range."""


@dataclass(frozen=True, slots=True)
class Blocks:
    """Functions on [start, start + 2 cell n]: a quintic per block of two cells, C1.

    It takes the values and slopes at the three nodes of its block.

    coefficients : (6, q, n) of 1, t, ... t^5 with t from -1 to 1 over the block
    """

    start: float
    cell: float
    coefficients: Array

    @classmethod
    def of(cls, start: float, cell: float, values: Array, slopes: Array) -> "Blocks":
        """From values and slopes (q, 2n + 1) at equally spaced nodes."""
        y0, y1, y2 = values[:, :-1:2], values[:, 1::2], values[:, 2::2]
        s0, s1, s2 = (cell * s for s in (slopes[:, :-1:2], slopes[:, 1::2], slopes[:, 2::2]))
        even, odd = 0.5 * (y0 + y2) - y1, 0.5 * (y2 - y0) - s1
        even_slope, odd_slope = 0.25 * (s2 - s0), 0.5 * (s0 + s2) - s1
        fifth, fourth = 0.5 * (odd_slope - 3.0 * odd), even_slope - even
        return cls(start, cell, np.stack([y1, s1, even - fourth, odd - fifth, fourth, fifth]))

    def __call__(self, x: ArrayLike) -> tuple[Array, Array]:
        """Values and slopes (q, ...) at x (...), kept inside the table."""
        place = (np.asarray(x, dtype=np.float64) - self.start) / (2.0 * self.cell)
        block = np.clip(place.astype(int), 0, self.coefficients.shape[2] - 1)
        t = np.clip(2.0 * (place - block) - 1.0, -1.0, 1.0)
        a = self.coefficients[:, :, block]
        value = a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * (a[4] + t * a[5]))))
        slope = a[1] + t * (2.0 * a[2] + t * (3.0 * a[3] + t * (4.0 * a[4] + t * 5.0 * a[5])))
        return value, slope / self.cell


def stiffness_tables(law: Law, highest: float) -> tuple[Array, list[Blocks]]:
    """Normal and tangential stiffness of the area A_0 [N/m] over the log-pressure, one table per regime.

    Returns the pressures (k) [Pa] at which regimes begin, ascending, and the table above each, up to
    the next or to `highest`. Below the first there is no stiffness.
    """
    spots = checked_spots(law)
    ends = np.array(spots.breaks)
    pressures = spots.total("load", ends) / law.A_0
    inside = pressures < highest
    limits = np.append(pressures[inside], highest)
    cell = max(CELL, float(np.log(highest / limits[0])) / MOST_CELLS)
    tables = []
    for i, (low, high) in enumerate(zip(np.log(limits[:-1]), np.log(limits[1:]), strict=True)):
        cells = 2 * max(int(np.ceil((high - low) / (2.0 * cell))), 1)
        x = np.linspace(low, high, cells + 1)
        u = np.maximum(largest_spot(law, np.exp(x)), ends[i])
        side = np.maximum(u, ends[i] + SIDE)  # one-sided derivative where a regime begins or ends
        if i + 1 < ends.size:
            u, side = np.minimum(u, ends[i + 1]), np.minimum(side, ends[i + 1] - SIDE)
        growth = spots.slope("load", side) / spots.total("load", side)
        names = ("normal", "tangential")
        values = np.stack([spots.total(name, u) for name in names])
        slopes = np.stack([spots.slope(name, side) / growth for name in names])
        tables.append(Blocks.of(low, (high - low) / cells, values, slopes))
    return limits[:-1], tables
