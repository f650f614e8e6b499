"""Sums of a pressure field in load cases: force, moments and stiffness, which a reduction must keep."""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from jointfmu.mechanics.curve import Curve, tabulate_approach
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.quantity import Array

from .bolted_interface import BoltedInterface, NodalPressureFunction
from .nodal_result import NodeIndices

PRELOAD_OVER_FIELD_PRELOAD_RANGE = (0.05, 3.0)
"""Range of the preload in load cases over the preload of the field [1]."""
MAX_OPENED_PRELOAD_SHARE = 0.001
"""Largest share of the preload [1] carried by nodes that the largest moment opens."""
MAX_COMPRESSION_OVER_OPENING_MOTION = 0.03
"""Largest compression of the joint over the motion that opens it fully [1]."""
LOAD_CASE_SEED = 1
"""Seed of the quasi-random load cases."""


class LoadCase(NamedTuple):
    """Load case of the joint: preload, moment and normal motion.

    preload_over_field_preload   : preload over the preload of the field [1]
    moment_over_unloading_moment : moment over the moment at which a row of bolts loses its force [1]
    motion_over_opening_motion   : normal motion over the motion that opens the joint fully [1]; negative in
                                   compression
    """

    preload_over_field_preload: float
    moment_over_unloading_moment: float
    motion_over_opening_motion: float


def find_max_moment_over_unloading_moment(
    bolted_joint: BoltedInterface, normalised_pressure: PressureDistribution
) -> float:
    """Largest moment at which force and stiffness must be kept, over the moment that unloads a bolt row [1].

    The result is at most 1. It is smaller if nodes that carry the share MAX_OPENED_PRELOAD_SHARE of the
    preload open at a smaller moment.
    """
    force = normalised_pressure.area_share * normalised_pressure.preload_pressure_ratio
    loaded = force > 0.0
    unloading = (
        np.abs(normalised_pressure.moment_pressure_ratio[loaded])
        * bolted_joint.row_bolts
        / bolted_joint.n_bolts
    )
    with np.errstate(divide="ignore"):
        opening_moment = normalised_pressure.preload_pressure_ratio[loaded] / unloading
    order = np.argsort(opening_moment)
    opened_force = np.cumsum(force[loaded][order])
    return float(min(opening_moment[order][np.searchsorted(opened_force, MAX_OPENED_PRELOAD_SHARE)], 1.0))


def initial_load_cases(max_moment_over_unloading_moment: float) -> list[LoadCase]:
    """Load cases of the joint in which a reduced pressure field must keep force and stiffness, at the start.

    The search of the reduced field adds load cases in which the selected nodes miss the tolerance.

    max_moment_over_unloading_moment : largest moment over the moment that unloads a row of bolts [1]
    """
    moments = [
        max_moment_over_unloading_moment * m
        for m in (-1.0, -0.97, -0.9, -0.8, -0.5, 0.0, 0.5, 0.8, 0.9, 0.97, 1.0)
    ]
    extremes = (-1.0, 1.0) if max_moment_over_unloading_moment < 1.0 else ()
    preloaded = [LoadCase(p, m, 0.0) for p in PRELOAD_OVER_FIELD_PRELOAD_RANGE for m in (*moments, *extremes)]
    openings = (
        -MAX_COMPRESSION_OVER_OPENING_MOTION,
        -0.4 * MAX_COMPRESSION_OVER_OPENING_MOTION,
        0.05,
        0.2,
        0.4,
        0.55,
        0.65,
        0.75,
        0.85,
    )
    opened = [
        LoadCase(p, m, s) for p in PRELOAD_OVER_FIELD_PRELOAD_RANGE for m in moments[::2] for s in openings
    ]
    steep = [
        max_moment_over_unloading_moment * m for m in (-0.95, -0.85, -0.7, 0.7, 0.85, 0.95)
    ]  # nodes open row by row there
    return (
        preloaded
        + opened
        + [LoadCase(PRELOAD_OVER_FIELD_PRELOAD_RANGE[0], m, s) for m in steep for s in (0.3, 0.45, 0.6)]
    )


def random_load_cases(max_moment_over_unloading_moment: float) -> Iterator[LoadCase]:
    """Endless quasi-random load cases of the joint (Halton sequence), every third one without normal motion.

    max_moment_over_unloading_moment : largest moment over the moment that unloads a row of bolts [1]
    """
    from scipy.stats import qmc  # imported here: its import is slow

    sequence = qmc.Halton(3, seed=LOAD_CASE_SEED)
    low, high = np.log(PRELOAD_OVER_FIELD_PRELOAD_RANGE)
    points = (point for _ in count() for point in sequence.random(LOAD_CASES_PER_DRAW))
    for i, (a, b, c) in enumerate(points):
        opening = (
            c * (1.0 + MAX_COMPRESSION_OVER_OPENING_MOTION) - MAX_COMPRESSION_OVER_OPENING_MOTION
            if i % 3
            else 0.0
        )
        yield LoadCase(
            float(np.exp(low + a * (high - low))),
            float(max_moment_over_unloading_moment * (2.0 * b - 1.0)),
            float(opening),
        )


LOAD_CASES_PER_DRAW = 64
"""Number of load cases drawn in one call, which takes as long as a call for one load case."""
COUPLING_TOLERANCE_FACTOR = 100.0
"""Tolerance of first and mixed moments over the tolerance of the other sums [1]."""
_CUBE_ROOT_INTERPOLATION_LIMIT = 1e-2
"""Pressure over the pressure of complete closure [1], below which the table is interpolated in the cubic root
of the pressure."""
_TABLE_REFINEMENT_FRACTIONS = np.linspace(0.0, 1.0, 33)[:-1]
"""Relative positions in a segment of the pressure curve [1] that become rows of the table."""
_FUNCTION_VALUES_PER_BLOCK = 1 << 15
"""Number of function values in one block of the computation."""
MAX_NODE_GROUPS = 4096
"""Largest number of groups of neighbouring nodes whose sums are stored."""


@dataclass(frozen=True, slots=True)
class ForceAndStiffnessSums:
    """Normal force, stiffness and their moments of a pressure field in m load cases: 9 sums over the nodes.

    The sums are those of the pressure p times 1, x, y, and of the stiffness k times 1, x, y, y^2, x^2, x y.

    load_cases    : (m) load cases
    normal_motion : (m) [m] normal motion of the joint, > 0 if it opens
    group_sums    : (m, 9, g) sums over each of g groups of neighbouring nodes, divided by `sum_scales`
    total_sums    : (m, 9) sums over all nodes, divided by `sum_scales`
    sum_scales    : (m, 9) sum in the load case, or in the preloaded joint where that is larger. For first and
                    mixed moments: force or stiffness times the radius of gyration, times
                    COUPLING_TOLERANCE_FACTOR
    """

    load_cases: tuple[LoadCase, ...]
    normal_motion: Array
    group_sums: Array
    total_sums: Array
    sum_scales: Array

    def select_load_cases(
        self, selected_cases: NDArray[np.intp] | NDArray[np.bool_]
    ) -> "ForceAndStiffnessSums":
        """Copy of the sums with only some of the load cases, by a mask or by indices."""
        loads = tuple(self.load_cases[i] for i in np.arange(len(self.load_cases))[selected_cases])
        return ForceAndStiffnessSums(
            loads,
            self.normal_motion[selected_cases],
            self.group_sums[selected_cases],
            self.total_sums[selected_cases],
            self.sum_scales[selected_cases],
        )

    def append_load_cases(self, other_load_case_sums: "ForceAndStiffnessSums") -> "ForceAndStiffnessSums":
        """Concatenate the sums in the load cases of two objects."""
        return ForceAndStiffnessSums(
            self.load_cases + other_load_case_sums.load_cases,
            np.concatenate([self.normal_motion, other_load_case_sums.normal_motion]),
            np.concatenate([self.group_sums, other_load_case_sums.group_sums]),
            np.concatenate([self.total_sums, other_load_case_sums.total_sums]),
            np.concatenate([self.sum_scales, other_load_case_sums.sum_scales]),
        )


@dataclass(frozen=True, slots=True)
class ForceAndStiffnessFunctions:
    """The 9 functions of pressure and position (x, y) of a node whose sums are force, moments and stiffness.

    The functions are the pressure p times 1, x, y, and the stiffness k = dp/d(approach) times 1, x, y, y^2,
    x^2, x y.

    pressure_curve          : pressure as a function of the approach
    field_preload           : [N] per bolt of the field
    nodal_pressure_function : function of the joint for nodal pressures, `bolted_interface.nodal_pressures`
    approach_table          : pressures, their cubic roots and approaches, for the start of Newton's method
    """

    bolted_joint: BoltedInterface
    pressure_curve: Curve
    field_preload: float
    nodal_pressure_function: NodalPressureFunction
    approach_table: tuple[Array, Array, Array]

    @classmethod
    def from_joint(
        cls, bolted_joint: BoltedInterface, preload: float, nodal_pressure_function: NodalPressureFunction
    ) -> "ForceAndStiffnessFunctions":
        """Prepare the functions of a joint for a pressure field at a preload [N] per bolt."""
        curve = tabulate_approach(bolted_joint)
        x = curve.displacement
        fine = np.append(x[:-1, None] + np.diff(x)[:, None] * _TABLE_REFINEMENT_FRACTIONS, x[-1])
        p = curve.derivatives(fine, 0)[0]
        return cls(bolted_joint, curve, preload, nodal_pressure_function, (p, np.cbrt(p), fine))

    def _compute_preloaded_pressure(
        self, normalised_pressure: PressureDistribution, load_cases: Sequence[LoadCase]
    ) -> Array:
        """Pressures (m, n) [Pa] at n nodes in m load cases: under preload and moment, no normal motion."""
        force = self.field_preload * np.array([load.preload_over_field_preload for load in load_cases])
        moment = np.array([load.moment_over_unloading_moment for load in load_cases]) * force
        moment *= self.bolted_joint.row_distance * self.bolted_joint.row_bolts
        return self.nodal_pressure_function(self.bolted_joint, normalised_pressure, force, moment)

    def _interpolate_approach_and_stiffness(self, nodal_pressure: Array) -> tuple[Array, Array]:
        """Approach [m] and normal stiffness per area [Pa/m] of the interface at pressures of any shape [Pa].

        Both are interpolated in the table and improved by one Newton step. At first contact, the pressure is
        proportional to the third power of the approach. Above the hardness, the end of the curve, the
        pressure is linear in the approach.
        """
        pressure, root, approach = self.approach_table
        start = np.interp(nodal_pressure, pressure, approach)
        closing = nodal_pressure < _CUBE_ROOT_INTERPOLATION_LIMIT * self.pressure_curve.closing_end_pressure
        start[closing] = np.interp(np.cbrt(nodal_pressure[closing]), root, approach)
        value, slope, curvature = self.pressure_curve.derivatives(start, 2)
        curvature = np.where(start < self.pressure_curve.end_point[0], curvature, 0.0)
        step = np.divide(nodal_pressure - value, slope, out=np.zeros_like(nodal_pressure), where=slope > 0.0)
        return start + step, slope + curvature * step

    def _interpolate_approach(self, nodal_pressure: Array) -> Array:
        """Approach [m] of the interface at pressures of any shape [Pa]."""
        return self._interpolate_approach_and_stiffness(nodal_pressure)[0]

    def compute_load_case_sums(
        self, normalised_pressure: PressureDistribution, load_cases: Sequence[LoadCase]
    ) -> ForceAndStiffnessSums:
        """Compute force, stiffness and their moments in load cases, as sums over all nodes of a field."""
        pairs, index = np.unique([load[:2] for load in load_cases], axis=0, return_inverse=True)
        index = index.ravel()
        preloaded = [LoadCase(p, m, 0.0) for p, m in pairs]
        group_size = nodes_per_group(normalised_pressure.area_share.size)
        blocks = list(_divide_into_node_blocks(normalised_pressure, len(load_cases), keep_groups_whole=True))
        peak = np.max(
            [np.max(self._compute_preloaded_pressure(block, preloaded), axis=1) for block in blocks], axis=0
        )
        max_opening = self._interpolate_approach(peak) - self.pressure_curve.displacement[0]
        opening = np.array([load.motion_over_opening_motion for load in load_cases]) * max_opening[index]
        moved = np.flatnonzero(opening)

        def compute_block_sums(node_block: PressureDistribution) -> tuple[Array, Array]:
            """Force, stiffness and their moments of each group of nodes in a block.

            First in the preloaded joint, then after the normal motion.
            """
            p = self._compute_preloaded_pressure(node_block, preloaded)
            start, k = self._interpolate_approach_and_stiffness(p)
            preload_sums = _sum_over_groups(node_block, p, k, group_size)
            p_moved, k_moved = self.pressure_curve.derivatives(start[index[moved]] - opening[moved, None], 1)
            return preload_sums, _sum_over_groups(node_block, p_moved, k_moved, group_size)

        with ThreadPoolExecutor(os.cpu_count()) as pool:  # numpy releases the global interpreter lock
            preload_blocks, moved_blocks = zip(*pool.map(compute_block_sums, blocks), strict=True)
        preload_groups = np.concatenate(preload_blocks, axis=2)[index]
        groups = preload_groups.copy()
        groups[moved] = np.concatenate(moved_blocks, axis=2)
        total, preload_total = np.sum(groups, axis=2), np.sum(preload_groups, axis=2)
        radii = np.sqrt(normalised_pressure.area_share @ normalised_pressure.position**2)
        scale = _compute_sum_scales(total, *radii)
        scale = np.where(
            opening[:, None] > 0.0, np.maximum(scale, _compute_sum_scales(preload_total, *radii)), scale
        )
        groups /= scale[:, :, None]
        return ForceAndStiffnessSums(tuple(load_cases), opening, groups, total / scale, scale)

    def compute_sampling_probability(
        self, normalised_pressure: PressureDistribution, max_moment_over_unloading_moment: float
    ) -> Array:
        """Probability of each of n nodes to be in a random sample: its mean share in force and stiffness.

        The mean is taken over some load cases, also over nearly open ones, in which few nodes carry the load:
        the sample needs more of these nodes than their share of the area.

        max_moment_over_unloading_moment : largest moment over the moment that unloads a row of bolts [1]
        """
        loads = [
            LoadCase(p, m * max_moment_over_unloading_moment, 0.0)
            for p in PRELOAD_OVER_FIELD_PRELOAD_RANGE
            for m in (-1.0, 0.0, 1.0)
        ]
        start = self._interpolate_approach(self._compute_preloaded_pressure(normalised_pressure, loads))
        max_opening = np.max(start, axis=1) - self.pressure_curve.displacement[0]
        probability = np.zeros(normalised_pressure.area_share.size)
        for ratio in (0.0, 0.3, 0.6, 0.85):
            for values in self.pressure_curve.derivatives(start - (ratio * max_opening)[:, None], 1):
                sums = normalised_pressure.area_share * values
                probability += np.sum(sums / np.sum(sums, axis=1, keepdims=True), axis=0)
        probability += np.sum(probability) * normalised_pressure.area_share
        return probability / np.sum(probability)

    def evaluate_functions(
        self, normalised_pressure: PressureDistribution, load_case_sums: ForceAndStiffnessSums
    ) -> Array:
        """Contributions (c, 9 m) of c contact nodes to the sums of the joint in m load cases.

        The 9 sums of a load case are force, stiffness and their moments, see `ForceAndStiffnessFunctions`.
        Each contribution is divided by the scale of its sum.
        """
        return self.evaluate_selected_functions(
            normalised_pressure, load_case_sums, np.arange(load_case_sums.sum_scales.size)
        )

    def evaluate_selected_functions(
        self,
        normalised_pressure: PressureDistribution,
        load_case_sums: ForceAndStiffnessSums,
        function_indices: NodeIndices,
    ) -> Array:
        """Contributions (c, k) of c nodes to k of the sums (force, stiffness or a moment, in a load case).

        function_indices : (k) columns of `evaluate_functions`
        """
        load, function = np.divmod(function_indices, 9)
        needed, index = np.unique(load, return_inverse=True)
        loads, opening = (
            [load_case_sums.load_cases[i] for i in needed],
            load_case_sums.normal_motion[needed, None],
        )
        out = np.empty((normalised_pressure.area_share.size, function_indices.size))
        factor, scale = (
            np.array([0, 1, 2, 0, 1, 2, 3, 4, 5])[function],
            load_case_sums.sum_scales[load, function],
        )
        first, columns_of = 0, [np.flatnonzero(function < 3), np.flatnonzero(function >= 3)]
        for block in _divide_into_node_blocks(normalised_pressure, needed.size):
            approach = self._interpolate_approach(self._compute_preloaded_pressure(block, loads)) - opening
            factors, block_out = _compute_position_factors(block), out[first : first + block.area_share.size]
            for columns, value in zip(columns_of, self.pressure_curve.derivatives(approach, 1), strict=True):
                values = value.T[:, index[columns]] * factors[:, factor[columns]]
                block_out[:, columns] = values / scale[columns]
            first += block.area_share.size
        return out

    def compute_sum_deviations(
        self, reduced_points: PressureDistribution, load_case_sums: ForceAndStiffnessSums
    ) -> Array:
        """Largest error [1] in each of m load cases, if few points replace all nodes of the field.

        The errors are the sums over the points minus the sums over all nodes, divided by `sum_scales`.

        reduced_points : normalised pressure at the points
        load_case_sums : sums over all nodes in the m load cases
        """
        approach = (
            self._interpolate_approach(
                self._compute_preloaded_pressure(reduced_points, load_case_sums.load_cases)
            )
            - load_case_sums.normal_motion[:, None]
        )
        p, k = self.pressure_curve.derivatives(approach, 1)
        total = _sum_over_groups(reduced_points, p, k, reduced_points.area_share.size)[:, :, 0]
        return np.asarray(
            np.max(np.abs(total / load_case_sums.sum_scales - load_case_sums.total_sums), axis=1)
        )


def nodes_per_group(node_count: int) -> int:
    """Number of neighbouring nodes in a group, so that there are at most MAX_NODE_GROUPS groups.

    The last group may have fewer nodes. Forces and stiffnesses are summed over each group and stored.
    """
    return -(-node_count // MAX_NODE_GROUPS)


def _divide_into_node_blocks(
    normalised_pressure: PressureDistribution, load_case_count: int, keep_groups_whole: bool = False
) -> Iterator[PressureDistribution]:
    """Divide the nodes into blocks whose values in all load cases fit into the processor's cache.

    load_case_count   : number of load cases
    keep_groups_whole : divide only between groups
    """
    unit = nodes_per_group(normalised_pressure.area_share.size) if keep_groups_whole else 1
    count = unit * max(_FUNCTION_VALUES_PER_BLOCK // load_case_count // unit, -(-16 // unit))
    for first in range(0, normalised_pressure.area_share.size, count):
        yield normalised_pressure.select_nodes(slice(first, first + count))


def _sum_over_groups(
    normalised_pressure: PressureDistribution,
    nodal_pressure: Array,
    nodal_stiffness: Array,
    node_count_per_group: int,
) -> Array:
    """Force, stiffness and their moments of each of g groups of nodes, in m load cases: 9 sums (m, 9, g).

    nodal_pressure, nodal_stiffness : pressure [Pa] and stiffness [Pa/m] (m, n) of the nodes
    node_count_per_group : number of nodes in a group
    """
    count = -(-normalised_pressure.area_share.size // node_count_per_group)
    padding = (
        0,
        count * node_count_per_group - normalised_pressure.area_share.size,
    )  # nodes without share that complete the last group
    factors = np.pad(
        normalised_pressure.area_share[:, None] * _compute_position_factors(normalised_pressure),
        (padding, (0, 0)),
    ).reshape(count, node_count_per_group, 6)
    nodal_pressure, nodal_stiffness = (
        np.moveaxis(np.pad(value, ((0, 0), padding)).reshape(-1, count, node_count_per_group), 1, 0)
        for value in (nodal_pressure, nodal_stiffness)
    )
    return np.moveaxis(
        np.concatenate([nodal_pressure @ factors[:, :, :3], nodal_stiffness @ factors], axis=2), 0, 2
    )


def _compute_position_factors(normalised_pressure: PressureDistribution) -> Array:
    """Factors 1, x, y, y^2, x^2, x y of the position of each of n nodes: (n, 6), for sums over the nodes."""
    x, y = normalised_pressure.position.T
    return np.stack([np.ones_like(x), x, y, y * y, x * x, x * y], axis=1)


def _compute_sum_scales(unscaled_sums: Array, radius_x: float, radius_y: float) -> Array:
    """Divisors (m, 9) that make errors of the 9 sums (force, stiffness, moments) of m load cases relative.

    unscaled_sums      : (m, 9) sums over all nodes
    radius_x, radius_y : [m] radii of gyration of the contact
    """
    p = unscaled_sums[:, 0]
    k = unscaled_sums[:, 3]
    x_scale = COUPLING_TOLERANCE_FACTOR * radius_x
    y_scale = COUPLING_TOLERANCE_FACTOR * radius_y
    columns = [p, p * x_scale, p * y_scale, k, k * x_scale, k * y_scale]
    return np.stack([*columns, unscaled_sums[:, 6], unscaled_sums[:, 7], k * x_scale * radius_y], axis=1)


def evaluate_equilibrium_functions(normalised_pressure: PressureDistribution) -> Array:
    """Values (n, 9) at n nodes of the functions that sum to area, centroid, force and moments of a field.

    The functions are 1, x, y, e, t, e x, t x, e y, t y, with position x, y, e = `preload_pressure_ratio` and
    t = `moment_pressure_ratio`.
    """
    pressures = np.column_stack(
        [normalised_pressure.preload_pressure_ratio, normalised_pressure.moment_pressure_ratio]
    )
    moments = [pressures * normalised_pressure.position[:, i : i + 1] for i in (0, 1)]
    return np.column_stack(
        [np.ones_like(normalised_pressure.area_share), normalised_pressure.position, pressures, *moments]
    )
