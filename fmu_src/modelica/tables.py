"""Tables for Modelica: a curve of the package with as few nodes as an error allows, and a joint's total."""

from collections.abc import Callable, Collection
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from jointfmu.curve import Curve
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring, shear_ratio
from jointfmu.thinning import kept

Array = NDArray[np.float64]

TOLERANCE = 1e-7
"""Largest relative error of load and stiffness [1] against the package's curve."""
DAMPING_TOLERANCE = 1e-3
"""Largest relative error of a dissipation factor [1], which is interpolated linearly."""
STRONGEST = 10.0
"""End of a bolted joint's table: its total force over the one at tightening [1]."""
_FINE, _COARSE = 800, 120
"""Nodes of a bolted joint's total on either side of the tightened state: of its force, before thinning, and
of its damping."""
_INNER = np.linspace(0.0, 1.0, 9)[1:-1]


class Table(NamedTuple):
    """A quintic spline: rows (n, 5) of displacement, load, stiffness, and its derivative before and after.

    error : [1] largest relative error of load and stiffness against what it was made of
    """

    rows: Array
    error: float


def curve_of(table: Table) -> Curve:
    """The table as a curve of the package."""
    x, y, k, before, after = table.rows.T
    return Curve(x, y, k, after[:-1], before[1:])


def thinned(
    curve: Curve,
    reference: int = -1,
    keep: Collection[int] = (),
    fits: Callable[[int, int], bool] | None = None,
) -> Table:
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
    return Table(np.column_stack(columns), worst)


def _segment_error(curve: Curve, i: int, j: int, floor: tuple[float, float]) -> float:
    """Largest relative error of one quintic from node i to node j."""
    ends = [i, j]
    one = Curve(
        curve.displacement[ends],
        curve.load[ends],
        curve.stiffness[ends],
        curve.bend_start[i : i + 1],
        curve.bend_end[j - 1 : j],
    )
    x = curve.displacement[i : j + 1]
    points = np.concatenate([x[1:-1], (x[:-1, None] + np.diff(x)[:, None] * _INNER).ravel()])
    worst = 0.0
    for exact, rough, least in zip(curve.derivatives(points), one.derivatives(points), floor, strict=True):
        size = np.maximum(np.abs(exact), least)
        some = size > 0.0
        worst = max(worst, float(np.max(np.abs(rough - exact)[some] / size[some], initial=0.0)))
    return worst


class Tightened(NamedTuple):
    """A bolted joint at a fixed preload and moment: all its nodes as one spring.

    table   : force above the tightening force [N] over the approach from the tightened state [m]
    damping : rows (n, 2) of approach [m] and dissipation factor eta_n [1]
    shear   : K_T/K_N [1]
    """

    preload: float
    moment: float
    table: Table
    damping: Array
    shear: float


def tightened(spring: BoltedJointSpring, preload: float, moment: float) -> Tightened:
    """Sum up a bolted joint at a preload [N] per bolt and a moment [N.m].

    With one curve g(c) of the total force over the approach c, the joint's potential is
    G(c) + (rho/2) g'(c) (s_x^2 + s_y^2) at c = -s_z, less the work of the preload: force and stiffness of all
    three axes follow from g and its derivatives.
    """
    start = spring.within_law(preload, moment)
    low, high = spring.curve.displacement[[0, -1]]
    area, share = spring.joint.A_0, spring.shape.share

    def total(c: Array) -> list[Array]:
        each = spring.curve.derivatives(start + c[:, None], 2)
        return [area * (value @ share) for value in each]

    at_rest = total(np.zeros(1))[0][0]
    first, last = float(low - np.max(start)), float(high - np.max(start))
    reach = np.linspace(0.0, last, 200)
    end = float(np.interp(STRONGEST * at_rest, total(reach)[0], reach))
    c = np.unique(np.concatenate([np.linspace(first, 0.0, _FINE), np.linspace(0.0, end, _FINE)]))
    load, stiffness, bend = total(c)
    whole = Curve(c, load, stiffness, bend[:-1], bend[1:])
    zero = int(np.searchsorted(c, 0.0))
    some = np.concatenate([np.linspace(first, 0.0, _COARSE), np.linspace(0.0, end, _COARSE)[1:]])
    eta = np.interp(c, some, [_dissipation(spring, start + x) for x in some])

    def linear(i: int, j: int) -> bool:
        line = np.interp(c[i : j + 1], c[[i, j]], eta[[i, j]])
        return bool(np.all(np.abs(line - eta[i : j + 1]) <= DAMPING_TOLERANCE * eta[i : j + 1]))

    table = thinned(whole, reference=zero, keep=(zero,), fits=linear)
    damping = np.column_stack([table.rows[:, 0], np.interp(table.rows[:, 0], c, eta)])
    table.rows[:, 1] -= load[zero]
    return Tightened(preload, moment, table, damping, float(shear_ratio(spring.joint)))


def _dissipation(spring: BoltedJointSpring, approach: Array) -> float:
    """eta_n [1] with the nodes at approaches (n) [m]."""
    plastic, elastic = spring.works(spring.curve.derivatives(approach, 0)[0])
    return float((plastic @ spring.shape.share) / (elastic @ spring.shape.share))
