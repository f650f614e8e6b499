"""Curves of the package as tables that a solver joins by straight lines."""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from ..curve import Curve
from ..joints.bolted_joint import BoltedJointSpring, pressures

Array = NDArray[np.float64]

STRONGEST = 10.0
"""End of a bolted joint's table: its total force over the one at tightening [1]."""
_DENSE, _FINE = 64, 4000
"""Points at which errors are measured: per segment of a curve, and on either side of a tightened state."""
_BLOCK = 100_000
_FEWEST = 12
"""Fewest of them on a line: a parabola's top is then met within a per cent."""


@dataclass(frozen=True, slots=True)
class Table:
    """A load over a displacement.

    rows      : (n, 3) displacement, load, stiffness of the curve there
    straight  : [1] largest errors of load and stiffness where a solver joins the rows by lines
    monotone  : [1] the same with the monotone cubic of Fritsch and Butland
    """

    rows: Array
    straight: tuple[float, float]
    monotone: tuple[float, float]


def law_table(curve: Curve, error: float) -> Table:
    """Pressure [Pa] over approach [m] from first touch, stiffness [N/m3], up to the hardness.

    One line leads over the closing of the contact, where the law itself does not reach; the errors are
    those above it.
    """
    x, y, k = _dense(curve)
    some = x >= 0.0
    table = thinned(x[some] - curve.displacement[0], y[some], k[some], error)
    rows = np.vstack([[0.0, 0.0, 0.0], table.rows])
    return Table(rows, table.straight, table.monotone)


def load_table(curve: Curve, area: float, error: float) -> Table:
    """`law_table` of an area [m2]: load [N] and stiffness [N/m], and a row without load before it."""
    table = law_table(curve, error)
    rows = table.rows * [1.0, area, area]
    return Table(np.vstack([[-rows[-1, 0], 0.0, 0.0], rows]), table.straight, table.monotone)


def odd_table(curve: Curve, error: float) -> Table:
    """A curve through zero with its mirror image."""
    half = _dense(curve)
    rows = thinned(*half, error).rows
    rows = np.vstack([rows[:0:-1] * [-1.0, -1.0, 1.0], rows])
    x, y, k = (np.concatenate([sign * v[:0:-1], v]) for sign, v in zip((-1.0, -1.0, 1.0), half, strict=True))
    return Table(rows, *_errors(rows, x, y, k, (0.0, 0.0)))


def pull_table(spring: BoltedJointSpring, preload: float, moment: float, error: float) -> Table:
    """Force [N] that holds the bolted joint together over its separation s_rel_z [m], stiffness [N/m].

    From STRONGEST times the force at tightening, pressed together, to where the last node opens; from
    there on the force stays the preload's. The errors refer to the force at tightening where the
    load is smaller, and to the stiffness there. Raises ValueError if nothing is in contact or the
    hardness is reached.
    """
    start = spring.within_law(preload, moment)
    low, high = spring.curve.displacement[[0, -1]]
    shape = spring.shape.merged(moment=moment != 0.0)
    alike = spring.curve.inverse(pressures(spring.joint, shape, preload, moment))
    weight = spring.joint.A_0 * shape.share

    def total(separation: Array) -> Array:
        blocks = np.array_split(separation[:, None], max(separation.size * alike.size // _BLOCK, 1))
        both = [[value @ weight for value in spring.curve.derivatives(alike - s, 1)] for s in blocks]
        return np.concatenate(both, axis=1)

    held, stiff = (float(value[0]) for value in total(np.zeros(1)))
    reach = np.linspace(0.0, float(high - np.max(start)), 400)
    end = float(np.interp(STRONGEST * held, total(-reach)[0], reach))
    opening = float(np.max(start) - low)
    s = np.concatenate([np.linspace(-end, 0.0, _FINE), np.linspace(0.0, opening, _FINE)[1:]])
    force, stiffness = total(s)
    table = thinned(s, held - force, stiffness, error, (held, stiff), keep=(_FINE - 1,))
    return Table(np.vstack([table.rows, [2.0 * opening, held, 0.0]]), table.straight, table.monotone)


def thinned(
    x: Array,
    y: Array,
    k: Array,
    error: float,
    floor: tuple[float, float] = (0.0, 0.0),
    keep: Collection[int] = (),
) -> Table:
    """The fewest of the points (n) of a curve, taken one after the other, whose lines keep to it.

    error : [1] largest error of y by straight lines, relative to y or floor[0], the larger
    floor : load and stiffness to which errors refer at least
    keep  : points that stay
    """
    if not 0.0 < error < 0.5:
        raise ValueError(f"error = {error:g} is outside (0, 0.5)")
    size = np.maximum(np.abs(y), floor[0])
    size = np.where(size > 0.0, size, np.inf)

    def off(i: int, j: int) -> float:
        line = y[i] + (y[j] - y[i]) / (x[j] - x[i]) * (x[i : j + 1] - x[i])
        return float(np.max(np.abs(line - y[i : j + 1]) / size[i : j + 1]))

    last = x.size - 1
    stops = sorted({*keep, last})
    nodes = [0]
    while nodes[-1] < last:
        i = nodes[-1]
        stop = next(s for s in stops if s > i)
        j, step = i + 1, 1
        while step:  # gallop, then bisect
            further = min(j + step, stop)
            if further > j and off(i, further) <= error:
                j, step = further, 2 * step
            else:
                step //= 2
        nodes.append(j)
    index = np.array(nodes)
    between = np.diff(index)[~np.isin(index[1:], stops)]
    if np.any(between < _FEWEST):
        raise ValueError(
            f"error = {error:g} is too small for a table; it would have {index.size} rows or more"
        )
    rows = np.stack([x[index], y[index], k[index]], axis=1)
    return Table(rows, *_errors(rows, x, y, k, floor))


def _errors(
    rows: Array, x: Array, y: Array, k: Array, floor: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Largest errors of load and stiffness by straight lines and by the monotone cubic."""
    which = np.clip(np.searchsorted(rows[:, 0], x, side="right") - 1, 0, len(rows) - 2)
    slope = np.array([(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(rows)])[which]
    cubic = PchipInterpolator(rows[:, 0], rows[:, 1])

    def worst(found: Array, exact: Array, least: float) -> float:
        size = np.maximum(np.abs(exact), least)
        some = size > 0.0
        return float(np.max(np.abs(found - exact)[some] / size[some]))

    straight = worst(np.interp(x, rows[:, 0], rows[:, 1]), y, floor[0]), worst(slope, k, floor[1])
    return straight, (worst(cubic(x), y, floor[0]), worst(cubic(x, 1), k, floor[1]))


def _dense(curve: Curve) -> tuple[Array, Array, Array]:
    """The curve at many points."""
    nodes = curve.displacement
    part = np.arange(_DENSE) / _DENSE
    x = np.append((nodes[:-1, None] + np.diff(nodes)[:, None] * part).ravel(), nodes[-1])
    load, stiffness = curve.derivatives(x, 1)
    return x, load, stiffness
