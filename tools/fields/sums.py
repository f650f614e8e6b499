"""Sums of a pressure field in load cases: force, moments and stiffness, which a reduction must keep."""

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
"""Range of the preload in load cases over the preload of the field [1]."""
OPENED = 0.001
"""Largest share of the preload [1] carried by nodes that the largest moment opens."""
PRESSED = 0.03
"""Largest compression of the joint over the motion that opens it fully [1]."""
SEED = 1


class Load(NamedTuple):
    """Load case of the joint.

    preload_ratio : preload over the preload of the field [1]
    moment_ratio  : moment over the moment at which a row of bolts loses its force [1]
    opening_ratio : normal motion over the motion that opens the joint fully [1]; negative in compression
    """

    preload: float
    moment: float
    apart: float


def largest_moment(joint: BoltedInterface, shape: PressureShape) -> float:
    """Largest moment at which the sums must be kept, over the moment that unloads a row of bolts [1].

    It is at most 1. It is smaller if nodes that carry the share MAX_OPENED_SHARE of the preload open earlier.
    """
    force = shape.share * shape.equal
    loaded = force > 0.0
    unloading = np.abs(shape.tilt[loaded]) * joint.row_bolts / joint.n_bolts
    with np.errstate(divide="ignore"):
        opening_moment = shape.equal[loaded] / unloading
    order = np.argsort(opening_moment)
    opened_force = np.cumsum(force[loaded][order])
    return float(min(opening_moment[order][np.searchsorted(opened_force, OPENED)], 1.0))


def first_loads(limit: float) -> list[Load]:
    """Initial load cases of the selection.

    moment_limit : largest moment over the moment that unloads a row of bolts [1]
    """
    moments = [limit * m for m in (-1.0, -0.97, -0.9, -0.8, -0.5, 0.0, 0.5, 0.8, 0.9, 0.97, 1.0)]
    extremes = (-1.0, 1.0) if limit < 1.0 else ()
    preloaded = [Load(p, m, 0.0) for p in PRELOADS for m in (*moments, *extremes)]
    openings = (-PRESSED, -0.4 * PRESSED, 0.05, 0.2, 0.4, 0.55, 0.65, 0.75, 0.85)
    opened = [Load(p, m, s) for p in PRELOADS for m in moments[::2] for s in openings]
    steep = [limit * m for m in (-0.95, -0.85, -0.7, 0.7, 0.85, 0.95)]  # nodes open row by row there
    return preloaded + opened + [Load(PRELOADS[0], m, s) for m in steep for s in (0.3, 0.45, 0.6)]


def further_loads(limit: float) -> Iterator[Load]:
    """Endless quasi-random load cases (Halton sequence), every third one without normal motion."""
    from scipy.stats import qmc  # imported here: its import is slow

    sequence = qmc.Halton(3, seed=SEED)
    low, high = np.log(PRELOADS)
    points = (point for _ in count() for point in sequence.random(TOGETHER))
    for i, (a, b, c) in enumerate(points):
        opening = c * (1.0 + PRESSED) - PRESSED if i % 3 else 0.0
        yield Load(float(np.exp(low + a * (high - low))), float(limit * (2.0 * b - 1.0)), float(opening))


TOGETHER = 64
"""Number of load cases drawn in one call; a call for a single one takes as long."""
COUPLED = 100.0
"""Tolerance of first and mixed moments over the tolerance of the other sums [1]."""
_FAST = 1e-2
"""Pressure over the pressure of complete closure [1], below which the table is interpolated in the cubic root
of the pressure."""
_TABLE = np.linspace(0.0, 1.0, 33)[:-1]
_VALUES = 1 << 15
"""Number of function values in one block of the computation."""
GROUPS = 4096
"""Largest number of groups of neighbouring nodes whose sums are stored."""


@dataclass(frozen=True, slots=True)
class SumsAtLoads:
    """The 9 sums of a field in m load cases, relative to their scale.

    loads   : (m) load cases
    opening : (m) [m] normal motion
    groups  : (m, 9, g) sums over groups of nodes (`nodes_per_group`), over `scale`
    total   : (m, 9) sums over all nodes, over `scale`
    scale   : (m, 9) sum in the load case, or in the preloaded joint where that is larger. For first and mixed
              moments: force or stiffness times the radius of gyration, times COUPLING_FACTOR
    """

    loads: tuple[Load, ...]
    apart: Array
    groups: Array
    total: Array
    size: Array

    def part(self, index: NDArray[np.intp] | NDArray[np.bool_]) -> "SumsAtLoads":
        """Sums in the selected load cases."""
        loads = tuple(self.loads[i] for i in np.arange(len(self.loads))[index])
        return SumsAtLoads(loads, self.apart[index], self.groups[index], self.total[index], self.size[index])

    def joined(self, other: "SumsAtLoads") -> "SumsAtLoads":
        """Sums in the load cases of both objects."""
        return SumsAtLoads(
            self.loads + other.loads,
            np.concatenate([self.apart, other.apart]),
            np.concatenate([self.groups, other.groups]),
            np.concatenate([self.total, other.total]),
            np.concatenate([self.size, other.size]),
        )


@dataclass(frozen=True, slots=True)
class Sums:
    """The 9 functions of a node whose sums a joint needs.

    These are the pressure p times 1, x, y, and the stiffness k = dp/d(approach) times 1, x, y, y^2, x^2, x y.

    curve     : pressure as a function of the approach
    preload   : [N] per bolt of the field
    pressures : function of the joint for nodal pressures, see FieldAdapter
    approach_table : pressures, their cubic roots and approaches, for the start of Newton's method
    """

    joint: BoltedInterface
    curve: Curve
    preload: float
    pressures: Pressures
    table: tuple[Array, Array, Array]

    @classmethod
    def of(cls, joint: BoltedInterface, preload: float, pressures: Pressures) -> "Sums":
        """Functions of a joint at a preload [N] per bolt."""
        curve = approach_curve(joint)
        x = curve.displacement
        fine = np.append(x[:-1, None] + np.diff(x)[:, None] * _TABLE, x[-1])
        p = curve.derivatives(fine, 0)[0]
        return cls(joint, curve, preload, pressures, (p, np.cbrt(p), fine))

    def _pressures(self, shape: PressureShape, loads: Sequence[Load]) -> Array:
        """Nodal pressure (m, n) [Pa] in the load cases without normal motion."""
        force = self.preload * np.array([load.preload for load in loads])
        moment = np.array([load.moment for load in loads]) * force
        moment *= self.joint.row_distance * self.joint.row_bolts
        return self.pressures(self.joint, shape, force, moment)

    def _closed_to(self, p: Array) -> tuple[Array, Array]:
        """Approach (...) [m] and stiffness per area [Pa/m] at a pressure (...) [Pa].

        Both are interpolated in the table and improved by one Newton step. While the contact closes, the
        pressure is proportional to the third power of the approach. Beyond the hardness, the end of the
        curve, it is linear.
        """
        pressure, root, approach = self.table
        start = np.interp(p, pressure, approach)
        closing = p < _FAST * self.curve.closed
        start[closing] = np.interp(np.cbrt(p[closing]), root, approach)
        value, slope, curvature = self.curve.derivatives(start, 2)
        curvature = np.where(start < self.curve.end[0], curvature, 0.0)
        step = np.divide(p - value, slope, out=np.zeros_like(p), where=slope > 0.0)
        return start + step, slope + curvature * step

    def _approach(self, p: Array) -> Array:
        """Approach (...) [m] at a pressure (...) [Pa]."""
        return self._closed_to(p)[0]

    def at(self, shape: PressureShape, loads: Sequence[Load]) -> SumsAtLoads:
        """Compute the sums over a pressure shape in load cases."""
        pairs, index = np.unique([load[:2] for load in loads], axis=0, return_inverse=True)
        index = index.ravel()
        preloaded = [Load(p, m, 0.0) for p, m in pairs]
        group_size, blocks = grouped(shape.share.size), list(_blocks(shape, len(loads), whole=True))
        peak = np.max([np.max(self._pressures(block, preloaded), axis=1) for block in blocks], axis=0)
        max_opening = self._approach(peak) - self.curve.displacement[0]
        opening = np.array([load.apart for load in loads]) * max_opening[index]
        moved = np.flatnonzero(opening)

        def of_block(part: PressureShape) -> tuple[Array, Array]:
            """Group sums of one block of nodes: in the preloaded joint, and after the normal motion."""
            p = self._pressures(part, preloaded)
            start, k = self._closed_to(p)
            preload_sums = _group_sums(part, p, k, group_size)
            p_moved, k_moved = self.curve.derivatives(start[index[moved]] - opening[moved, None], 1)
            return preload_sums, _group_sums(part, p_moved, k_moved, group_size)

        with ThreadPoolExecutor(os.cpu_count()) as pool:  # numpy releases the global interpreter lock
            preload_blocks, moved_blocks = zip(*pool.map(of_block, blocks), strict=True)
        preload_groups = np.concatenate(preload_blocks, axis=2)[index]
        groups = preload_groups.copy()
        groups[moved] = np.concatenate(moved_blocks, axis=2)
        total, preload_total = np.sum(groups, axis=2), np.sum(preload_groups, axis=2)
        radii = np.sqrt(shape.share @ shape.position**2)
        scale = _sizes(total, *radii)
        scale = np.where(opening[:, None] > 0.0, np.maximum(scale, _sizes(preload_total, *radii)), scale)
        groups /= scale[:, :, None]
        return SumsAtLoads(tuple(loads), opening, groups, total / scale, scale)

    def weights(self, shape: PressureShape, limit: float) -> Array:
        """Probability (n) of each node to be in the sample: its mean share of the sums over load cases.

        When the joint is nearly open, few nodes carry the load: the sample needs more of them than their area
        share.

        moment_limit : largest moment over the moment that unloads a row of bolts [1]
        """
        loads = [Load(p, m * limit, 0.0) for p in PRELOADS for m in (-1.0, 0.0, 1.0)]
        start = self._approach(self._pressures(shape, loads))
        max_opening = np.max(start, axis=1) - self.curve.displacement[0]
        probability = np.zeros(shape.share.size)
        for ratio in (0.0, 0.3, 0.6, 0.85):
            for values in self.curve.derivatives(start - (ratio * max_opening)[:, None], 1):
                sums = shape.share * values
                probability += np.sum(sums / np.sum(sums, axis=1, keepdims=True), axis=0)
        probability += np.sum(probability) * shape.share
        return probability / np.sum(probability)

    def columns(self, some: PressureShape, rows: SumsAtLoads) -> Array:
        """Values (c, m 9) of all functions at nodes, over their scale: 9 functions in m load cases."""
        return self.few_columns(some, rows, np.arange(rows.size.size))

    def few_columns(self, some: PressureShape, rows: SumsAtLoads, which: Nodes) -> Array:
        """Values (c, k) of selected functions at nodes: k columns of `function_values`."""
        load, function = np.divmod(which, 9)
        needed, index = np.unique(load, return_inverse=True)
        loads, opening = [rows.loads[i] for i in needed], rows.apart[needed, None]
        out = np.empty((some.share.size, which.size))
        factor, scale = np.array([0, 1, 2, 0, 1, 2, 3, 4, 5])[function], rows.size[load, function]
        first, columns_of = 0, [np.flatnonzero(function < 3), np.flatnonzero(function >= 3)]
        for block in _blocks(some, needed.size):
            approach = self._approach(self._pressures(block, loads)) - opening
            factors, block_out = _arms(block), out[first : first + block.share.size]
            for columns, value in zip(columns_of, self.curve.derivatives(approach, 1), strict=True):
                values = value.T[:, index[columns]] * factors[:, factor[columns]]
                block_out[:, columns] = values / scale[columns]
            first += block.share.size
        return out

    def deviations(self, points: PressureShape, rows: SumsAtLoads) -> Array:
        """Largest deviation (m) [1] of the sums of reduced points in each load case."""
        approach = self._approach(self._pressures(points, rows.loads)) - rows.apart[:, None]
        p, k = self.curve.derivatives(approach, 1)
        total = _group_sums(points, p, k, points.share.size)[:, :, 0]
        return np.asarray(np.max(np.abs(total / rows.size - rows.total), axis=1))


def grouped(nodes: int) -> int:
    """Number of neighbouring nodes in a group; the last group may have fewer."""
    return -(-nodes // GROUPS)


def _blocks(shape: PressureShape, loads: int, whole: bool = False) -> Iterator[PressureShape]:
    """Divide the nodes into blocks whose values in all load cases fit into the processor's cache.

    loads        : number of load cases
    whole_groups : divide only between groups
    """
    unit = grouped(shape.share.size) if whole else 1
    count = unit * max(_VALUES // loads // unit, -(-16 // unit))
    for first in range(0, shape.share.size, count):
        yield shape.part(slice(first, first + count))


def _group_sums(shape: PressureShape, p: Array, k: Array, each: int) -> Array:
    """Sums (m, 9, g) of the 9 functions over groups of nodes.

    p, k       : pressure [Pa] and stiffness [Pa/m] (m, n) of the nodes
    group_size : number of nodes in a group
    """
    count = -(-shape.share.size // each)
    padding = (0, count * each - shape.share.size)  # nodes without share that complete the last group
    factors = np.pad(shape.share[:, None] * _arms(shape), (padding, (0, 0))).reshape(count, each, 6)
    p, k = (np.moveaxis(np.pad(value, ((0, 0), padding)).reshape(-1, count, each), 1, 0) for value in (p, k))
    return np.moveaxis(np.concatenate([p @ factors[:, :, :3], k @ factors], axis=2), 0, 2)


def _arms(shape: PressureShape) -> Array:
    """Factors (n, 6) of the stiffness of a node: 1, x, y, y^2, x^2, x y; the pressure has the first three."""
    x, y = shape.position.T
    return np.stack([np.ones_like(x), x, y, y * y, x * x, x * y], axis=1)


def _sizes(sums: Array, x: float, y: float) -> Array:
    """Scales (m, 9) of sums (m, 9); radius_x and radius_y [m] are the radii of gyration of the contact."""
    p, k, x_scale, y_scale = sums[:, 0], sums[:, 3], COUPLED * x, COUPLED * y
    columns = [p, p * x_scale, p * y_scale, k, k * x_scale, k * y_scale]
    return np.stack([*columns, sums[:, 6], sums[:, 7], k * x_scale * y], axis=1)


def balance(shape: PressureShape) -> Array:
    """Functions (n, 9) whose sums give the balance of a field.

    These are 1, x, y, `preload_shape` and `moment_shape`, and both times x and times y.
    """
    pressures = np.column_stack([shape.equal, shape.tilt])
    moments = [pressures * shape.position[:, i : i + 1] for i in (0, 1)]
    return np.column_stack([np.ones_like(shape.share), shape.position, pressures, *moments])
