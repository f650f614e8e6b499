"""Reduce a pressure field to few nodes, with new area shares that keep its sums at all loads (cubature).

The outputs of a joint are sums over its nodes: area share times a function of the two pressures of the node
(`preload_shape`, `moment_shape`) and of its position. A finite number of load cases gives a finite number of
sums, and most of them are linearly dependent. Some nodes with positive shares keep all sums (`recombine`;
Tchakaloff; Litterer and Lyons 2012). The fewest nodes that keep the sums within the tolerance are selected.
Load cases in which the points miss the tolerance are added until the points meet it in new load cases. The
selection uses rounded numbers (`footprint.reproducible`), so that it is the same on all processors; the
selected nodes are not rounded.
"""

from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np
from scipy.linalg import qr, solve_triangular
from scipy.optimize import nnls

from jointfmu.mechanics.footprint.patches import find_peak_nodes
from jointfmu.mechanics.footprint.reproducible import round_distribution, round_to_digits
from jointfmu.mechanics.footprint.shape import PressureDistribution
from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .clamped import BoltedInterface, PressureFunction
from .nodal_result import NodeIndices
from .sums import (
    PRELOAD_RANGE,
    SEED,
    LoadCase,
    LoadSums,
    SumFunctions,
    balance_functions,
    initial_load_cases,
    max_moment_ratio,
    nodes_per_group,
    random_load_cases,
)

GROUPS_PER_SUM = 2
"""Number of groups of nodes over number of independent sums [1]."""


def recombine(values: Array, weights: Array, transform: Array) -> tuple[NodeIndices, Array]:
    """Select at most d nodes with new weights that keep the weighted sums of d functions (recombination).

    values               : (n, d) of the functions at the nodes
    weights              : (n) > 0
    orthogonal_transform : (d, d) matrix that makes the d functions independent

    Returns the indices of the nodes and their weights. Raises RuntimeError if round-off prevents a solution.
    """
    selected, count = np.arange(len(values)), values.shape[1]
    while selected.size > count:
        bounds = np.linspace(0, selected.size, min(GROUPS_PER_SUM * count, selected.size) + 1).astype(np.intp)
        sums = [weights[a:b] @ values[a:b] for a, b in pairwise(bounds)]
        vectors = (np.array(sums) @ transform).T
        factors, _ = nnls(vectors, np.sum(vectors, axis=1), maxiter=20 * count)
        node_factors = np.repeat(factors, np.diff(bounds))
        positive = node_factors > 0.0
        selected, weights, values = (
            selected[positive],
            (weights * node_factors)[positive],
            values[positive],
        )
    return selected, weights


RELATIVE_TOLERANCE = 1e-6
"""Largest relative deviation of a sum [1] of a reduced field."""
LARGE_FIELD_TOLERANCE = 1e-5
"""Largest relative deviation of a sum [1] of a reduced field with more than MAX_KEPT_NODES nodes."""
GOAL_RATIO, ACCEPTANCE_RATIO, ADDITION_RATIO = 0.05, 0.6, 0.15
"""Deviations over the tolerance [1]: goal in the load cases of the selection; limit in the test load cases
(the margin is for untested ones); deviation from which a test load case is added to the selection."""
ROUNDING_BITS = 25
"""Number of bits to which nodes are rounded for the selection: 3e-8, less than the goal."""
MIN_PIVOT_RATIO = 7e-9
"""Smallest pivot of an independent sum over the largest pivot [1]; sums below it are dependent."""
COUNT_FACTOR = 0.93
"""Factor [1] on the number of kept sums, and so of points, from one attempt to the next."""
INITIAL_RANDOM_LOADS = 100
"""Number of quasi-random load cases in the selection from the start."""
SKETCH_ROWS = 600
"""Number of random combinations of the sample nodes (Halko, Martinsson and Tropp 2011); more than the number
of kept sums."""
MAX_UNREDUCED_NODES = 60
"""Largest number of nodes of a field that is not reduced."""
MAX_KEPT_NODES = 3000
"""Largest number of nodes that are all kept if no reduction meets the tolerance."""
SAMPLE_SIZE = 3000
"""Number of sample nodes for finding the independent sums."""
TEST_LOAD_RANGE, MAX_TEST_EVALUATIONS = (60, 300), 3e6
"""Smallest and largest number of test load cases per round; largest number of test load cases times nodes."""
MAX_ROUNDS = 8


@dataclass(frozen=True, slots=True)
class Reduction:
    """Result of the reduction of a pressure field.

    reduced_shape : pressure shape of the reduced points
    full_shape : pressure shape of all nodes
    largest_deviation : [1] largest deviation of the sums in `test_case_count` load cases outside the
        selection: total force, K_zz (and K_xx, proportional to K_zz), K_rx and K_ry, each over its value or
        its value in the preloaded joint, whichever is larger. Deviations of the moments of the force and of
        coupling stiffnesses count a hundredth
    test_case_count : number of these load cases
    max_tested_moment_ratio : [1] largest moment in these load cases over the moment that unloads a row of
        bolts
    deviation_above_tested_moments : [1] largest deviation at moment ratios from `max_tested_moment_ratio` to
        1
    """

    shape: PressureDistribution
    full_shape: PressureDistribution
    deviation: float = 0.0
    test_count: int = 0
    moment_ratio: float = 1.0
    deviation_beyond: float = 0.0

    @property
    def point_count(self) -> int:
        """Number of reduced points."""
        return int(self.shape.share.size)

    @property
    def node_count(self) -> int:
        """Number of nodes of the field."""
        return int(self.full_shape.share.size)


def reduce_field(
    joint: BoltedInterface, shape: PressureDistribution, preload: float, pressures: PressureFunction
) -> Reduction:
    """Reduce a pressure shape to the fewest points that keep its sums within RELATIVE_TOLERANCE.

    If no points do, all nodes are kept. A field with more than MAX_KEPT_NODES nodes then takes the points
    within LARGE_FIELD_TOLERANCE.

    preload         : [N] per bolt of the field. Load cases cover PRELOAD_RATIO_RANGE of it, from compression
                      to full opening, with moments up to `max_moment_ratio`
    nodal_pressures : function of the joint for nodal pressures, see FieldAdapter

    Raises RuntimeError if the field has too many nodes and no points are within LARGE_FIELD_TOLERANCE.
    """
    nodes = shape.share.size
    if nodes <= MAX_UNREDUCED_NODES:
        return Reduction(shape, shape)
    sums = SumFunctions.from_joint(joint, preload, pressures)
    # sorted by pressure, neighbouring nodes are close on the pressure curve: its evaluation is faster
    order = np.argsort(round_to_digits(shape.preload_shape), kind="stable")
    unrounded = shape.select_nodes(order)
    shape = round_distribution(unrounded, ROUNDING_BITS)
    sample = np.random.default_rng(SEED).choice(
        nodes,
        min(SAMPLE_SIZE, nodes),
        replace=False,
        p=sums.sample_probability(shape, max_moment_ratio(joint, shape)),
    )
    reduction = _search_points(sums, shape, shape.select_nodes(sample), unrounded)
    if reduction is not None and (nodes > MAX_KEPT_NODES or reduction.deviation <= RELATIVE_TOLERANCE):
        return reduction
    if nodes <= MAX_KEPT_NODES:
        return Reduction(unrounded, unrounded)
    raise RuntimeError(
        f"the field of {nodes} nodes cannot be reduced to points that keep its sums within "
        f"{LARGE_FIELD_TOLERANCE:g}; of up to {MAX_KEPT_NODES} all nodes are kept"
    )


def _search_points(
    sums: SumFunctions,
    shape: PressureDistribution,
    sample: PressureDistribution,
    unrounded: PressureDistribution,
) -> Reduction | None:
    """Search points that keep the sums within LARGE_FIELD_TOLERANCE; None if there are none.

    Each round tests the points in new load cases, and adds those to the selection in which the points miss.

    rounded_shape   : pressure shape of all nodes, rounded
    sample_shape    : sample of these nodes, for finding the independent sums
    unrounded_shape : pressure shape of all nodes
    """
    limit = max_moment_ratio(sums.joint, shape)
    loads, tests = (
        random_load_cases(limit),
        int(np.clip(MAX_TEST_EVALUATIONS / shape.share.size, *TEST_LOAD_RANGE)),
    )
    system = _SumSystem.from_loads(
        sums,
        shape,
        unrounded,
        sample,
        sums.compute_sums(shape, [*initial_load_cases(limit), *islice(loads, INITIAL_RANDOM_LOADS)]),
    )
    best, best_deviation = None, LARGE_FIELD_TOLERANCE
    for _ in track_progress(range(MAX_ROUNDS), "points", MAX_ROUNDS):
        points = system.find_points()
        if points is None:
            break
        test_sums = sums.compute_sums(shape, list(islice(loads, tests)))
        deviations = sums.deviations(points, test_sums)
        worst = float(np.max(deviations))
        if worst <= best_deviation:
            best, best_deviation = points, worst
        if worst <= ACCEPTANCE_RATIO * RELATIVE_TOLERANCE:
            break
        system.add_loads(test_sums.select(deviations > ADDITION_RATIO * RELATIVE_TOLERANCE))
    if best is None:
        return None
    deviation_beyond = _deviation_beyond(sums, shape, best, limit)
    return Reduction(best, unrounded, best_deviation, tests, limit, deviation_beyond)


def _deviation_beyond(
    sums: SumFunctions, shape: PressureDistribution, points: PressureDistribution, moment_limit: float
) -> float:
    """Largest deviation [1] at moment ratios from `moment_limit` to 1 (a row of bolts loses its force)."""
    if moment_limit >= 1.0:
        return 0.0
    moments = np.linspace(moment_limit, 1.0, 6)[1:].tolist()
    loads = [LoadCase(p, sign * m, 0.0) for p in PRELOAD_RANGE for m in moments for sign in (-1.0, 1.0)]
    return float(np.max(sums.deviations(points, sums.compute_sums(shape, loads))))


@dataclass(slots=True)
class _SumSystem:
    """The r sums that the reduced points must keep: balance of the field, and sums in load cases.

    rounded_shape   : pressure shape of all nodes, rounded
    unrounded_shape : pressure shape of all nodes
    sample_shape    : sample (c) of the nodes, for finding the independent sums
    mixing_matrix   : random matrix (SKETCH_ROWS, c)
    load_sums       : sums in the load cases
    balance_scale   : divisors of the balance functions
    sketch_matrix   : (SKETCH_ROWS, r) random combinations of the functions at the sample nodes
    """

    sums: SumFunctions
    shape: PressureDistribution
    unrounded: PressureDistribution
    sample: PressureDistribution
    mixing: Array
    load_sums: LoadSums
    balance_scale: Array
    sketch: Array

    @classmethod
    def from_loads(
        cls,
        sums: SumFunctions,
        shape: PressureDistribution,
        unrounded: PressureDistribution,
        sample: PressureDistribution,
        load_sums: LoadSums,
    ) -> "_SumSystem":
        """System of the balance and of the sums in initial load cases."""
        scale = np.maximum(np.max(np.abs(balance_functions(shape)), axis=0), np.finfo(float).tiny)
        mixing = np.random.default_rng(SEED).standard_normal((SKETCH_ROWS, sample.share.size))
        mixing *= np.sqrt(sample.share / SKETCH_ROWS)
        sketch = mixing @ np.concatenate(
            [balance_functions(sample) / scale, sums.function_values(sample, load_sums)], axis=1
        )
        return cls(sums, shape, unrounded, sample, mixing, load_sums, scale, sketch)

    def add_loads(self, load_sums: LoadSums) -> None:
        """Add the sums in more load cases."""
        self.sketch = np.concatenate(
            [self.sketch, self.mixing @ self.sums.function_values(self.sample, load_sums)], axis=1
        )
        self.load_sums = self.load_sums.concatenate(load_sums)

    def function_values(self, shape: PressureDistribution) -> Array:
        """Values (n, r) of all functions at the nodes of a shape."""
        return np.concatenate(
            [balance_functions(shape) / self.balance_scale, self.sums.function_values(shape, self.load_sums)],
            axis=1,
        )

    def find_points(self) -> PressureDistribution | None:
        """Find the fewest nodes that keep the sums; None if no nodes do.

        The nodes with the highest pressure (`find_peak_nodes`) are always kept, with their own share.
        """
        independent, turn = self._independent_sums()
        fixed = find_peak_nodes(self.shape)
        try:
            candidates, share = self._select_groups(independent, turn, fixed)
            selected, share = recombine(self._selected_values(candidates, independent), share, turn)
        except RuntimeError:  # round-off
            return None
        selected = candidates[selected]
        values = self.function_values(self.shape.select_nodes(selected))
        target = np.concatenate(
            [
                self.shape.share @ balance_functions(self.shape) / self.balance_scale,
                self.load_sums.total.ravel(),
            ]
        )
        target -= self.shape.share[fixed] @ self.function_values(self.shape.select_nodes(fixed))
        best, count = None, independent.size
        tolerance = ACCEPTANCE_RATIO * LARGE_FIELD_TOLERANCE
        while count > 1 and np.max(np.abs(share @ values - target)) <= tolerance:
            best, tolerance = (selected, share), GOAL_RATIO * RELATIVE_TOLERANCE
            count = int(COUNT_FACTOR * count)
            try:
                fewer, share = recombine(values[:, independent[:count]], share, turn[:count, :count])
            except RuntimeError:
                break
            selected, values = selected[fewer], values[fewer]
        if best is None:
            return None
        points = self.unrounded.select_nodes(np.concatenate([fixed, best[0]]))
        return _correct_balance(points, np.concatenate([self.shape.share[fixed], best[1]]))

    def _select_groups(
        self, functions: NodeIndices, transform: Array, fixed: NodeIndices
    ) -> tuple[NodeIndices, Array]:
        """Select few groups of nodes, with shares that keep the sums of all nodes except the fixed ones.

        Returns the nodes of these groups and their shares.
        """
        share = self.shape.share.copy()
        share[fixed] = 0.0
        group = np.arange(share.size) // nodes_per_group(share.size)
        old_share = np.asarray(np.bincount(group, share), dtype=np.float64)
        nonempty = np.flatnonzero(old_share)
        sums = self._group_sums(functions)
        np.subtract.at(
            sums, group[fixed], self.shape.share[fixed, None] * self._selected_values(fixed, functions)
        )
        selected, new_share = recombine(
            sums[nonempty] / old_share[nonempty, None], old_share[nonempty], transform
        )
        scale = np.zeros(old_share.size)
        scale[nonempty[selected]] = new_share / old_share[nonempty[selected]]
        share *= scale[group]
        nodes = np.flatnonzero(share)
        return nodes, share[nodes]

    def _group_sums(self, functions: NodeIndices) -> Array:
        """Sums (g, k) of the selected functions over groups of nodes."""
        share, count = self.shape.share[:, None], self.balance_scale.size
        is_balance = functions < count
        load, function = np.divmod(functions[~is_balance] - count, 9)
        values = (balance_functions(self.shape) / self.balance_scale)[:, functions[is_balance]]
        out = np.empty((self.load_sums.groups.shape[2], functions.size))
        out[:, is_balance] = np.add.reduceat(
            share * values, np.arange(0, share.size, nodes_per_group(share.size))
        )
        out[:, ~is_balance] = self.load_sums.groups[load, function].T
        return out

    def _selected_values(self, nodes: NodeIndices, functions: NodeIndices) -> Array:
        """Values (n, k) of the selected functions at nodes."""
        shape, count = self.shape.select_nodes(nodes), self.balance_scale.size
        is_balance = functions < count
        out = np.empty((nodes.size, functions.size))
        out[:, is_balance] = (balance_functions(shape) / self.balance_scale)[:, functions[is_balance]]
        out[:, ~is_balance] = self.sums.selected_values(shape, self.load_sums, functions[~is_balance] - count)
        return out

    def _independent_sums(self) -> tuple[NodeIndices, Array]:
        """Indices of independent sums, the largest pivot first, and the matrix that orthogonalises them."""
        triangle, order = qr(self.sketch, mode="r", pivoting=True)
        size = np.abs(np.diag(triangle))
        count = int(np.sum(size > MIN_PIVOT_RATIO * size[0]))
        return order[:count], solve_triangular(triangle[:count, :count], np.eye(count))


def _correct_balance(shape: PressureDistribution, weights: Array) -> PressureDistribution:
    """Select the nodes with a share > 0 and correct the balance of the field to round-off."""
    points = shape.select_nodes(np.flatnonzero(weights > 0.0))
    share = weights[weights > 0.0] / np.sum(weights)
    return PressureDistribution(
        share=share,
        position=points.position - share @ points.position,
        preload_shape=points.preload_shape / (share @ points.preload_shape),
        moment_shape=points.moment_shape - share @ points.moment_shape,
    )
