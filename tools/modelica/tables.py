"""Tables for Modelica: a curve of the package with as few nodes as an error allows."""

from collections.abc import Callable, Collection
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from ..thinning import kept

TOLERANCE = 1e-7
"""Largest relative error of load and stiffness [1] against the package's curve."""
_INNER = np.linspace(0.0, 1.0, 9)[1:-1]


class InterpolationTable(NamedTuple):
    """A quintic spline: rows (n, 5) of displacement, load, stiffness, and its derivative before and after.

    error : [1] largest relative error of load and stiffness against what it was made of
    """

    rows: Array
    error: float


def curve_of(table: InterpolationTable) -> Curve:
    """The table as a curve of the package."""
    x, y, k, before, after = table.rows.T
    return Curve(x, y, k, after[:-1], before[1:])


def thinned(
    curve: Curve,
    reference: int = -1,
    keep: Collection[int] = (),
    fits: Callable[[int, int], bool] | None = None,
) -> InterpolationTable:
    """The fewest nodes of a curve, taken one after the other, that reproduce it within TOLERANCE.

    reference : node whose load and stiffness the errors refer to where the curve's own are smaller;
                -1: each value's own
    keep      : nodes that stay
    fits      : a further demand on the segment from one node to another
    """
    kinks = np.flatnonzero(curve.bend_end[:-1] != curve.bend_start[1:]) + 1
    stops = {*kinks.tolist(), *keep, curve.displacement.size - 1}
    floor = (0.0, 0.0) if reference < 0 else (curve.load[reference], curve.stiffness[reference])

    def reproduces(i: int, j: int) -> bool:
        close = _segment_error(curve, i, j, floor) <= TOLERANCE
        return close and (fits is None or fits(i, j))

    index = kept(stops, reproduces)
    worst = max(_segment_error(curve, i, j, floor) for i, j in pairwise(index.tolist()))
    before = np.concatenate([[curve.bend_start[0]], curve.bend_end[index[1:] - 1]])
    after = np.concatenate([curve.bend_start[index[:-1]], [curve.bend_end[-1]]])
    columns = [curve.displacement[index], curve.load[index], curve.stiffness[index], before, after]
    return InterpolationTable(np.column_stack(columns), worst)


def _segment_error(curve: Curve, i: int, j: int, floor: tuple[float, float]) -> float:
    """Largest relative error of one quintic from node i to node j."""
    ends = [i, j]
    quintic = Curve(
        curve.displacement[ends],
        curve.load[ends],
        curve.stiffness[ends],
        curve.bend_start[i : i + 1],
        curve.bend_end[j - 1 : j],
    )
    x = curve.displacement[i : j + 1]
    points = np.concatenate([x[1:-1], (x[:-1, None] + np.diff(x)[:, None] * _INNER).ravel()])
    worst = 0.0
    for exact, rough, least in zip(
        curve.derivatives(points), quintic.derivatives(points), floor, strict=True
    ):
        size = np.maximum(np.abs(exact), least)
        some = size > 0.0
        worst = max(worst, float(np.max(np.abs(rough - exact)[some] / size[some], initial=0.0)))
    return worst
