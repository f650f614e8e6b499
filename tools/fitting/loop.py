"""A measured torque-angle record, loops and all, to its mid-line.

Rising and falling branches are told apart at the turning points of the torque. One linear least
squares then finds, as piecewise linear functions of the torque, the mid-line m(T) and half the gap
h(T) of the branches, and a drift of the angle that is linear in the order of the samples,

    angle_i = m(T_i) + s_i h(T_i) + drift t_i,   s = +1 rising, -1 falling,   t from -1/2 to 1/2,

with h = 0 where the torque turns around: the branches meet there. The drift is left out where the
record does not determine it (a single loop that is not closed).

The mid-line is not m: friction M is against the motion on both branches. After a reversal it turns round, and
has done so on the way to the middle of the range. There M is half the torque between the branches at the same
angle; on the half of a branch that leads away from the middle the spring carries T -+ M. These halves are the
mid-line. At the tips, where the branches meet, m is M/K off.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from jointfmu.quantity import Array

from .branches import extremes

PROMINENCE = 0.1
"""Least reversal of the torque, over its range [1], that counts as a turning point."""
CENTRAL = 0.25
"""Part of the range [1] about its middle in which the friction has turned round on both branches."""
FULL = 0.9
"""Part of the range [1] that a whole branch spans."""
MOST_KNOTS, POINTS_PER_KNOT = 41, 20
MOST_POINTS = 400
"""Points of the backbone at most; more samples are averaged in groups of neighbouring torque."""
SEEN = 0.05
"""Least part of the drift column [1] that the other columns must leave for a drift to be told."""
TENTHS = 10


@dataclass(frozen=True, slots=True)
class Backbone:
    """The mid-line of a record and what was taken off.

    torque, angle : (n) [N.m], [rad], ascending in torque
    count         : (n) samples in each point
    branches      : number of branches used
    loop_area     : [J] dissipated per loop;  backlash : [rad] between the branches at zero torque;
    drift         : [rad] over the whole record; each with its standard deviation, None if the record
                    does not determine it
    """

    torque: Array
    angle: Array
    count: Array
    branches: int
    loop_area: tuple[float, float] | None
    backlash: tuple[float, float] | None
    drift: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class _Branch:
    places: NDArray[np.int64]
    rising: bool
    low: float
    high: float


def backbone(torque: Array, angle: Array) -> Backbone:
    """The mid-line of a record (n) [N.m], (n) [rad] in the order it was measured.

    Raises ValueError: no torque range, no complete branch, or the angle falls somewhere as the
    torque rises.
    """
    if not np.ptp(torque) > 0.0:
        raise ValueError(f"torque is {torque[0]:g} N.m throughout; expected a range of torques")
    used = _whole(_branches(torque))
    if len({b.rising for b in used}) == 1:
        places = np.concatenate([b.places for b in used])
        line = _grouped(torque[places], angle[places])
        return _monotone(Backbone(*line, len(used), None, None, None))
    low, high = (
        pick(side(getattr(b, name) for b in used if b.rising is way) for way in (True, False))
        for pick, side, name in ((max, min, "low"), (min, max, "high"))
    )
    if not high - low >= 0.5 * np.ptp(torque):
        raise ValueError(
            f"rising and falling branch share {low:g} to {high:g} N.m of {np.min(torque):g} to "
            f"{np.max(torque):g} N.m; expected loops over the whole range"
        )
    return _monotone(_separated(torque, angle, used, float(low), float(high)))


def _branches(torque: Array) -> list[_Branch]:
    """All branches between turning points, in order."""
    turns = extremes(torque, PROMINENCE * float(np.ptp(torque)))
    ends = np.concatenate([[0], turns, [torque.size - 1]])
    branches = []
    for first, last in pairwise(ends):
        places = np.arange(first, last + 1)
        part = torque[places]
        branches.append(_Branch(places, bool(part[-1] > part[0]), float(np.min(part)), float(np.max(part))))
    return branches


def _whole(branches: list[_Branch]) -> list[_Branch]:
    """The branches over the whole range; of a direction that has none, all."""
    span = max(b.high for b in branches) - min(b.low for b in branches)
    whole = []
    for rising in (True, False):
        same = [b for b in branches if b.rising is rising]
        whole += [b for b in same if b.high - b.low >= FULL * span] or same
    return sorted(whole, key=lambda b: int(b.places[0]))


def _separated(torque: Array, angle: Array, used: list[_Branch], low: float, high: float) -> Backbone:
    """Mid-line, gap and drift by one linear least squares."""
    places = np.concatenate([b.places for b in used])
    way = np.concatenate([np.where(b.rising, 1.0, -1.0) * np.ones(b.places.size) for b in used])
    inside = (torque[places] >= low) & (torque[places] <= high)
    places, way = places[inside], way[inside]
    T, phi, time = torque[places], angle[places], places / (torque.size - 1.0) - 0.5
    knots = int(np.clip(places.size // POINTS_PER_KNOT, 5, MOST_KNOTS))
    grid = np.linspace(low, high, knots)
    hats = _hats(T, grid)
    free = np.ones(knots, dtype=bool)
    free[[0, -1]] = [not _turns(used, low, span := high - low, 0), not _turns(used, high, span, -1)]
    gap = scipy.sparse.diags(way) @ hats
    design = scipy.sparse.hstack([hats, gap[:, np.flatnonzero(free)], scipy.sparse.csr_matrix(time[:, None])])
    design = design.tocsr()
    drifts = _seen(design)
    if not drifts:
        design = design[:, :-1]
    normal = np.linalg.pinv((design.T @ design).toarray(), hermitian=True)
    values = normal @ (design.T @ phi)
    rest = phi - design @ values
    covariance = normal * float(rest @ rest) / max(places.size - values.size, 1)
    half = slice(knots, knots + int(np.sum(free)))

    def measure(weights: Array) -> tuple[float, float]:
        row = weights[free]
        return float(row @ values[half]), float(np.sqrt(row @ covariance[half, half] @ row))

    area = np.gradient(grid)
    area[[0, -1]] = 0.5 * (grid[1] - grid[0])
    zero = measure(-2.0 * _hats(np.zeros(1), grid).toarray()[0]) if low <= 0.0 <= high else None
    drift = (float(values[-1]), float(np.sqrt(covariance[-1, -1]))) if drifts else None
    clean = phi - (drift[0] * time if drift else 0.0)
    part = (T - 0.5 * (low + high)) / (0.5 * (high - low))
    central = np.abs(part) <= CENTRAL
    friction = _friction(T[central], clean[central], way[central])
    loading = way * part >= 0.0
    line = _grouped((T - friction * way)[loading], clean[loading])
    return Backbone(*line, len(used), measure(-2.0 * area), zero, drift)


def _friction(torque: Array, angle: Array, way: Array) -> float:
    """Half of the torque between branches (n) at equal angles: it is the same for all of these."""
    grid = np.linspace(np.min(angle), np.max(angle), max(angle.size // POINTS_PER_KNOT, 2))
    design = np.column_stack([_hats(angle, grid).toarray(), way])
    return float(np.linalg.lstsq(design, torque)[0][-1])


def _hats(T: Array, grid: Array) -> scipy.sparse.csr_matrix:
    """Piecewise linear basis (n, k) at torques (n)."""
    return scipy.sparse.csr_matrix(BSpline.design_matrix(T, np.pad(grid, 1, mode="edge"), 1))


def _turns(used: list[_Branch], end: float, span: float, side: int) -> bool:
    """Whether a falling and a rising branch meet at an end of the range."""
    following = pairwise(used)
    return any(
        branch.rising is not next_branch.rising
        and branch.places[-1] == next_branch.places[0]
        and branch.rising is (side == -1)
        and abs((branch.high if branch.rising else branch.low) - end) < (1.0 - FULL) * span
        for branch, next_branch in following
    )


def _seen(design: scipy.sparse.csr_matrix) -> bool:
    """Whether the last column stands out of the span of the others."""
    columns, last = design[:, :-1], design[:, -1].toarray()[:, 0]
    normal = np.linalg.pinv((columns.T @ columns).toarray(), hermitian=True)
    left = last - columns @ (normal @ (columns.T @ last))
    return bool(np.linalg.norm(left) > SEEN * np.linalg.norm(last))


def _grouped(torque: Array, angle: Array) -> tuple[Array, Array, Array]:
    """Means of groups of neighbouring torque, and their sizes."""
    order = np.argsort(torque, kind="stable")
    starts = np.linspace(0, order.size, min(order.size, MOST_POINTS) + 1).astype(int)[:-1]
    count = np.diff(np.append(starts, order.size)).astype(float)
    sums = (np.add.reduceat(column[order], starts) for column in (torque, angle))
    T, phi = (total / count for total in sums)
    return T, phi, count


def _monotone(line: Backbone) -> Backbone:
    """The same; ValueError if the angle does not rise from tenth to tenth of the torque's range."""
    edges = np.linspace(line.torque[0], line.torque[-1], TENTHS + 1)
    part = np.clip(np.searchsorted(edges, line.torque, side="right") - 1, 0, TENTHS - 1)
    there = [k for k in range(TENTHS) if np.any(part == k)]
    means = np.array([np.average(line.angle[part == k], weights=line.count[part == k]) for k in there])
    if np.all(np.diff(means) < 0.0):
        raise ValueError("the angle falls as the torque rises; reverse the sign of one column")
    if np.any(falling := np.diff(means) <= 0.0):
        k = there[int(np.argmax(falling))]
        raise ValueError(
            f"the mid-line of the angle does not rise with the torque between {edges[k]:.4g} and "
            f"{edges[min(k + 2, TENTHS)]:.4g} N.m; expected one loop or curve of a spring"
        )
    return line
