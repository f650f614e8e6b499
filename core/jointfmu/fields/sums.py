"""What of a field is kept when it is reduced: its sums at loads, and the loads."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from ..curve import Curve, approach_curve
from ..footprint.shape import PressureShape
from ..joints.clamped import Clamped, Pressures
from .nodal_result import Array

PRELOADS = (0.05, 3.0)
"""Range of the preload over the one of the field [1]."""
OPENED = 0.001
"""Part of the preload's force [1] whose nodes may have been opened by the largest moment."""
PRESSED = 0.03
"""How far the joint is pressed together, over how far it is drawn apart until it is fully open [1]."""
COUPLED = 100.0
"""How much larger the deviations of first and mixed moments may be [1]."""
SEED = 1
_FAST = 1e-2
"""Pressure over the one at the end of the closing [1] above which a table gives a start for Newton."""
_TABLE = np.linspace(0.0, 1.0, 33)[:-1]


class Load(NamedTuple):
    """A state of the joint.

    preload : over the field's [1]
    moment  : over the one at which a row of bolts has no force left [1]
    apart   : normal motion over the one that opens the joint fully [1]
    """

    preload: float
    moment: float
    apart: float


@dataclass(frozen=True, slots=True)
class SumsAtLoad:
    """The sums of the functions at a load.

    apart : [m] normal motion
    total : (9) the sums, over `size`
    size  : (9) the sum, or the one at tightening where that is larger; of first and mixed moments those
            with the radius of gyration as their arm, times COUPLED
    """

    load: Load
    total: Array
    apart: float
    size: Array


@dataclass(frozen=True, slots=True)
class Sums:
    """The functions whose sums a joint needs, on its curve of pressure over approach.

    preload   : [N] per bolt, the field's
    pressures : of the joint, those of joints.clamped.Clamping
    table     : pressures and approaches, where Newton's method begins
    """

    joint: Clamped
    curve: Curve
    preload: float
    pressures: Pressures
    table: tuple[Array, Array]

    @classmethod
    def of(cls, joint: Clamped, preload: float, pressures: Pressures) -> "Sums":
        """Of a joint at a preload [N] per bolt."""
        curve = approach_curve(joint)
        x = curve.displacement
        fine = (x[:-1, None] + np.diff(x)[:, None] * _TABLE).ravel()
        return cls(joint, curve, preload, pressures, (curve.derivatives(fine, 0)[0], fine))

    def approach(self, shape: PressureShape, load: Load) -> Array:
        """Approach (n) [m] at tightening: the table's, after one step of Newton's method."""
        force = load.preload * self.preload
        moment = load.moment * force * self.joint.row_distance * self.joint.row_bolts
        p = self.pressures(self.joint, shape, force, moment)
        slow = p < _FAST * self.curve.closed
        start = np.interp(p, *self.table)
        value, slope = self.curve.derivatives(start, 1)
        start += np.where(slow, 0.0, p - value) / np.where(slow, 1.0, slope)
        start[slow] = self.curve.displacement[0]
        few = slow & (p > 0.0)
        start[few] = self.curve.inverse(p[few])
        return np.asarray(start)

    def values(self, shape: PressureShape, approach: Array) -> Array:
        """(n, 9): pressure and its moments, stiffness and its first and second moments, per share."""
        p, k = self.curve.derivatives(approach, 1)
        x, y = shape.position.T
        return np.stack([p, p * x, p * y, k, k * x, k * y, k * y * y, k * x * x, k * x * y], axis=1)

    def row(self, shape: PressureShape, load: Load) -> SumsAtLoad:
        """The sums over a shape at a load."""
        start = self.approach(shape, load)
        apart = load.apart * float(np.max(start) - self.curve.displacement[0])
        arms = np.sqrt(shape.share @ shape.position**2)
        total = shape.share @ self.values(shape, start - apart)
        size = _sizes(total, *arms)
        if apart > 0.0:
            size = np.maximum(size, _sizes(shape.share @ self.values(shape, start), *arms))
        return SumsAtLoad(load, total / size, apart, size)

    def columns(self, some: PressureShape, row: SumsAtLoad) -> Array:
        """(c, 9) the functions at some nodes, over their size."""
        return self.values(some, self.approach(some, row.load) - row.apart) / row.size

    def deviation(self, points: PressureShape, row: SumsAtLoad) -> float:
        """Largest deviation [1] of the points' sums at a load."""
        return float(np.max(np.abs(points.share @ self.columns(points, row) - row.total)))


def _sizes(sums: Array, x: float, y: float) -> Array:
    p, k, x_far, y_far = sums[0], sums[3], COUPLED * x, COUPLED * y
    return np.array([p, p * x_far, p * y_far, k, k * x_far, k * y_far, sums[6], sums[7], k * x_far * y])


def balance(shape: PressureShape) -> Array:
    """(n, 9): what balances a field: one, place, pressures and their moments."""
    both = np.column_stack([shape.equal, shape.tilt])
    moments = [both * shape.position[:, i : i + 1] for i in (0, 1)]
    return np.column_stack([np.ones_like(shape.share), shape.position, both, *moments])


def largest_moment(joint: Clamped, shape: PressureShape) -> float:
    """Over the one at which a row of bolts has no force left [1]: up to where the sums are to be kept.

    There, or where nodes that carried the part OPENED of the preload are open.
    """
    force = shape.share * shape.equal
    touching = force > 0.0
    over = np.abs(shape.tilt[touching]) * joint.row_bolts / joint.n_bolts
    with np.errstate(divide="ignore"):
        opening = shape.equal[touching] / over
    order = np.argsort(opening)
    opened = np.cumsum(force[touching][order])
    return float(min(opening[order][np.searchsorted(opened, OPENED)], 1.0))


def first_loads(limit: float) -> list[Load]:
    """Loads to begin with, up to a moment over the one that unloads a row [1]."""
    inside = [limit * m for m in (-1.0, -0.97, -0.9, -0.8, -0.5, 0.0, 0.5, 0.8, 0.9, 0.97, 1.0)]
    still = [Load(p, m, 0.0) for p in PRELOADS for m in (*inside, *((-1.0, 1.0) if limit < 1.0 else ()))]
    apart = (-PRESSED, -0.4 * PRESSED, 0.05, 0.2, 0.4, 0.55, 0.65, 0.75, 0.85)
    moved = [Load(p, m, s) for p in PRELOADS for m in inside[::2] for s in apart]
    steep = [limit * m for m in (-0.95, -0.85, -0.7, 0.7, 0.85, 0.95)]  # where nodes open row by row
    return still + moved + [Load(PRELOADS[0], m, s) for m in steep for s in (0.3, 0.45, 0.6)]


def further_loads(limit: float) -> Iterator[Load]:
    """Loads without end, every third one at rest."""
    sequence = qmc.Halton(3, seed=SEED)
    low, high = np.log(PRELOADS)
    for i in count():
        a, b, c = sequence.random(1)[0]
        apart = c * (1.0 + PRESSED) - PRESSED if i % 3 else 0.0
        yield Load(float(np.exp(low + a * (high - low))), float(limit * (2.0 * b - 1.0)), float(apart))
