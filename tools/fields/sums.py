"""What of a field is kept when it is reduced: its sums at loads."""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from jointfmu.mechanics.curve import Curve, approach_curve
from jointfmu.mechanics.footprint.shape import PressureShape
from jointfmu.quantity import Array

from .clamped import BoltedInterface, Pressures
from .nodal_result import Nodes

PRELOADS = (0.05, 3.0)
"""Range of the preload over the one of the field [1]."""
OPENED = 0.001
"""Part of the preload's force [1] whose nodes may have been opened by the largest moment."""
PRESSED = 0.03
"""How far the joint is pressed together, over how far it is drawn apart until it is fully open [1]."""
SEED = 1


class Load(NamedTuple):
    """A state of the joint.

    preload : over the field's [1]
    moment  : over the one at which a row of bolts has no force left [1]
    apart   : normal motion over the one that opens the joint fully [1]
    """

    preload: float
    moment: float
    apart: float


def largest_moment(joint: BoltedInterface, shape: PressureShape) -> float:
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
    from scipy.stats import qmc  # takes as long as all else that is imported

    sequence = qmc.Halton(3, seed=SEED)
    low, high = np.log(PRELOADS)
    drawn = (point for _ in count() for point in sequence.random(TOGETHER))
    for i, (a, b, c) in enumerate(drawn):
        apart = c * (1.0 + PRESSED) - PRESSED if i % 3 else 0.0
        yield Load(float(np.exp(low + a * (high - low))), float(limit * (2.0 * b - 1.0)), float(apart))


TOGETHER = 64
"""Further loads that are drawn at once: each alone takes as long."""
COUPLED = 100.0
"""How much larger the deviations of first and mixed moments may be [1]."""
_FAST = 1e-2
"""Pressure over the one at the end of the closing [1] below which Newton starts from its cubic root."""
_TABLE = np.linspace(0.0, 1.0, 33)[:-1]
_VALUES = 1 << 15
"""Values of a function that are worked on at once."""
GROUPS = 4096
"""Most groups of neighbouring nodes whose own sums are kept."""


@dataclass(frozen=True, slots=True)
class SumsAtLoads:
    """The sums of the functions at loads (m).

    apart  : (m) [m] normal motion
    groups : (m, 9, g) the sums over groups of nodes, those of `grouped`, over `size`
    total  : (m, 9) the sums over all nodes, over `size`
    size   : (m, 9) the sum, or the one at tightening where that is larger; of first and mixed moments those
             with the radius of gyration as their arm, times COUPLED
    """

    loads: tuple[Load, ...]
    apart: Array
    groups: Array
    total: Array
    size: Array

    def part(self, index: NDArray[np.intp] | NDArray[np.bool_]) -> "SumsAtLoads":
        """Those at some of the loads."""
        loads = tuple(self.loads[i] for i in np.arange(len(self.loads))[index])
        return SumsAtLoads(loads, self.apart[index], self.groups[index], self.total[index], self.size[index])

    def joined(self, other: "SumsAtLoads") -> "SumsAtLoads":
        """Those at these loads and at others."""
        return SumsAtLoads(
            self.loads + other.loads,
            np.concatenate([self.apart, other.apart]),
            np.concatenate([self.groups, other.groups]),
            np.concatenate([self.total, other.total]),
            np.concatenate([self.size, other.size]),
        )


@dataclass(frozen=True, slots=True)
class Sums:
    """The functions whose sums a joint needs, on its curve of pressure over approach.

    preload   : [N] per bolt, the field's
    pressures : of the joint, those of joints.clamped.Clamping
    table     : pressures, their cubic roots and approaches, where Newton's method begins
    """

    joint: BoltedInterface
    curve: Curve
    preload: float
    pressures: Pressures
    table: tuple[Array, Array, Array]

    @classmethod
    def of(cls, joint: BoltedInterface, preload: float, pressures: Pressures) -> "Sums":
        """Of a joint at a preload [N] per bolt."""
        curve = approach_curve(joint)
        x = curve.displacement
        fine = np.append(x[:-1, None] + np.diff(x)[:, None] * _TABLE, x[-1])
        p = curve.derivatives(fine, 0)[0]
        return cls(joint, curve, preload, pressures, (p, np.cbrt(p), fine))

    def _pressures(self, shape: PressureShape, loads: Sequence[Load]) -> Array:
        """Pressure (m, n) [Pa] at tightening."""
        force = self.preload * np.array([load.preload for load in loads])
        moment = np.array([load.moment for load in loads]) * force
        moment *= self.joint.row_distance * self.joint.row_bolts
        return self.pressures(self.joint, shape, force, moment)

    def _closed_to(self, p: Array) -> tuple[Array, Array]:
        """Approach (...) [m] and stiffness per area [Pa/m] at a pressure: the table's, after one step of
        Newton's method.

        While the contact closes the pressure grows with the third power of the approach; beyond the hardness,
        the end of the curve, it goes on straight.
        """
        pressure, root, approach = self.table
        start = np.interp(p, pressure, approach)
        slow = p < _FAST * self.curve.closed
        start[slow] = np.interp(np.cbrt(p[slow]), root, approach)
        value, slope, bend = self.curve.derivatives(start, 2)
        bend = np.where(start < self.curve.end[0], bend, 0.0)
        step = np.divide(p - value, slope, out=np.zeros_like(p), where=slope > 0.0)
        return start + step, slope + bend * step

    def _approach(self, p: Array) -> Array:
        """Approach (...) [m] at a pressure."""
        return self._closed_to(p)[0]

    def at(self, shape: PressureShape, loads: Sequence[Load]) -> SumsAtLoads:
        """The sums over a shape at loads."""
        pairs, which = np.unique([load[:2] for load in loads], axis=0, return_inverse=True)
        which = which.ravel()
        tightened = [Load(p, m, 0.0) for p, m in pairs]
        each, blocks = grouped(shape.share.size), list(_blocks(shape, len(loads), whole=True))
        peak = np.max([np.max(self._pressures(part, tightened), axis=1) for part in blocks], axis=0)
        reach = self._approach(peak) - self.curve.displacement[0]
        apart = np.array([load.apart for load in loads]) * reach[which]
        away = np.flatnonzero(apart)

        def of_block(part: PressureShape) -> tuple[Array, Array]:
            p = self._pressures(part, tightened)
            start, k = self._closed_to(p)
            p_moved, k_moved = self.curve.derivatives(start[which[away]] - apart[away, None], 1)
            return _group_sums(part, p, k, each), _group_sums(part, p_moved, k_moved, each)

        with ThreadPoolExecutor(os.cpu_count()) as pool:  # numpy lets others run
            still, moved = zip(*pool.map(of_block, blocks), strict=True)
        rest = np.concatenate(still, axis=2)[which]
        groups = rest.copy()
        groups[away] = np.concatenate(moved, axis=2)
        total, at_rest = np.sum(groups, axis=2), np.sum(rest, axis=2)
        arms = np.sqrt(shape.share @ shape.position**2)
        size = _sizes(total, *arms)
        size = np.where(apart[:, None] > 0.0, np.maximum(size, _sizes(at_rest, *arms)), size)
        groups /= size[:, :, None]
        return SumsAtLoads(tuple(loads), apart, groups, total / size, size)

    def weights(self, shape: PressureShape, limit: float) -> Array:
        """Chance (n) of a node to be a candidate: its part of the joint's sums, in the mean over loads.

        What few nodes carry, when the joint is nearly open, needs more of them than their share.
        """
        loads = [Load(p, m * limit, 0.0) for p in PRELOADS for m in (-1.0, 0.0, 1.0)]
        start = self._approach(self._pressures(shape, loads))
        reach = np.max(start, axis=1) - self.curve.displacement[0]
        chance = np.zeros(shape.share.size)
        for apart in (0.0, 0.3, 0.6, 0.85):
            for part in self.curve.derivatives(start - (apart * reach)[:, None], 1):
                sums = shape.share * part
                chance += np.sum(sums / np.sum(sums, axis=1, keepdims=True), axis=0)
        chance += np.sum(chance) * shape.share
        return chance / np.sum(chance)

    def columns(self, some: PressureShape, rows: SumsAtLoads) -> Array:
        """(c, m 9) the functions at some nodes, over their size."""
        return self.few_columns(some, rows, np.arange(rows.size.size))

    def few_columns(self, some: PressureShape, rows: SumsAtLoads, which: Nodes) -> Array:
        """(c, k) some of these columns."""
        load, function = np.divmod(which, 9)
        needed, at = np.unique(load, return_inverse=True)
        loads, apart = [rows.loads[i] for i in needed], rows.apart[needed, None]
        out = np.empty((some.share.size, which.size))
        arm, size = np.array([0, 1, 2, 0, 1, 2, 3, 4, 5])[function], rows.size[load, function]
        first, parts = 0, [np.flatnonzero(function < 3), np.flatnonzero(function >= 3)]
        for part in _blocks(some, needed.size):
            approach = self._approach(self._pressures(part, loads)) - apart
            arms, here = _arms(part), out[first : first + part.share.size]
            for columns, value in zip(parts, self.curve.derivatives(approach, 1), strict=True):
                here[:, columns] = value.T[:, at[columns]] * arms[:, arm[columns]] / size[columns]
            first += part.share.size
        return out

    def deviations(self, points: PressureShape, rows: SumsAtLoads) -> Array:
        """Largest deviation (m) [1] of the points' sums at each load."""
        approach = self._approach(self._pressures(points, rows.loads)) - rows.apart[:, None]
        p, k = self.curve.derivatives(approach, 1)
        total = _group_sums(points, p, k, points.share.size)[:, :, 0]
        return np.asarray(np.max(np.abs(total / rows.size - rows.total), axis=1))


def grouped(nodes: int) -> int:
    """How many neighbouring nodes make a group; the last one may have fewer."""
    return -(-nodes // GROUPS)


def _blocks(shape: PressureShape, loads: int, whole: bool = False) -> Iterator[PressureShape]:
    """The nodes, a few at a time, so that their values at all loads stay in the processor's cache.

    whole : in whole groups
    """
    each = grouped(shape.share.size) if whole else 1
    count = each * max(_VALUES // loads // each, -(-16 // each))
    for first in range(0, shape.share.size, count):
        yield shape.part(slice(first, first + count))


def _group_sums(shape: PressureShape, p: Array, k: Array, each: int) -> Array:
    """(m, 9, g) sums over groups of `each` nodes, of pressure (m, n) and stiffness with their moments."""
    count = -(-shape.share.size // each)
    empty = (0, count * each - shape.share.size)  # nodes without share, so that the last group is full
    arms = np.pad(shape.share[:, None] * _arms(shape), (empty, (0, 0))).reshape(count, each, 6)
    p, k = (np.moveaxis(np.pad(value, ((0, 0), empty)).reshape(-1, count, each), 1, 0) for value in (p, k))
    return np.moveaxis(np.concatenate([p @ arms[:, :, :3], k @ arms], axis=2), 0, 2)


def _arms(shape: PressureShape) -> Array:
    """(n, 6) what pressure and stiffness are multiplied with; pressure with the first three."""
    x, y = shape.position.T
    return np.stack([np.ones_like(x), x, y, y * y, x * x, x * y], axis=1)


def _sizes(sums: Array, x: float, y: float) -> Array:
    p, k, x_far, y_far = sums[:, 0], sums[:, 3], COUPLED * x, COUPLED * y
    parts = [p, p * x_far, p * y_far, k, k * x_far, k * y_far, sums[:, 6], sums[:, 7], k * x_far * y]
    return np.stack(parts, axis=1)


def balance(shape: PressureShape) -> Array:
    """(n, 9): what balances a field: one, place, pressures and their moments."""
    both = np.column_stack([shape.equal, shape.tilt])
    moments = [both * shape.position[:, i : i + 1] for i in (0, 1)]
    return np.column_stack([np.ones_like(shape.share), shape.position, both, *moments])
