"""Reduce a pressure field to few nodes, with new area shares that keep its sums at all loads (cubature).

The outputs of a joint are sums over its nodes: area share times a function of the two pressures of the node
(`preload_pressure_ratio`, `moment_pressure_ratio`) and of its position. A finite number of load cases gives a
finite number of sums, and most of them are linearly dependent. Some nodes with positive shares keep all sums
(`recombine_weights`; Tchakaloff; Litterer and Lyons 2012). The fewest nodes that keep the sums within the
tolerance are selected. Load cases in which the points miss the tolerance are added until the points meet it
in new load cases. The selection uses rounded numbers (`footprint.reproducible`), so that it is the same on
all processors; the selected nodes are not rounded.
"""

from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np
from scipy.linalg import qr, solve_triangular
from scipy.optimize import nnls

from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.mechanics.footprint.point_reduction import find_peak_nodes
from jointfmu.mechanics.footprint.reproducible import round_distribution, round_to_digits
from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .bolted_interface import BoltedInterface, NodalPressureFunction
from .nodal_result import NodeIndices
from .sums import (
    LOAD_CASE_SEED,
    PRELOAD_OVER_FIELD_PRELOAD_RANGE,
    ForceAndStiffnessFunctions,
    ForceAndStiffnessSums,
    LoadCase,
    evaluate_equilibrium_functions,
    find_max_moment_over_unloading_moment,
    initial_load_cases,
    nodes_per_group,
    random_load_cases,
)

NODE_GROUPS_PER_INDEPENDENT_SUM = 2
"""Number of node groups in one step of the recombination, over the number of independent sums [1]."""


def recombine_weights(
    function_values: Array, node_weights: Array, orthogonal_transform: Array
) -> tuple[NodeIndices, Array]:
    """Select at most d of n nodes with new weights that keep the weighted sums of d functions.

    This is the recombination of a quadrature rule to fewer nodes.

    function_values      : (n, d) values of the functions at the nodes
    node_weights         : (n) old weights of the nodes > 0
    orthogonal_transform : (d, d) matrix that makes the d functions independent

    Returns the indices of the nodes and their weights. Raises RuntimeError if round-off prevents a solution.
    """
    selected, count = np.arange(len(function_values)), function_values.shape[1]
    while selected.size > count:
        bounds = np.linspace(
            0, selected.size, min(NODE_GROUPS_PER_INDEPENDENT_SUM * count, selected.size) + 1
        ).astype(np.intp)
        sums = [node_weights[a:b] @ function_values[a:b] for a, b in pairwise(bounds)]
        vectors = (np.array(sums) @ orthogonal_transform).T
        factors, _ = nnls(vectors, np.sum(vectors, axis=1), maxiter=20 * count)
        node_factors = np.repeat(factors, np.diff(bounds))
        positive = node_factors > 0.0
        selected = selected[positive]
        node_weights = (node_weights * node_factors)[positive]
        function_values = function_values[positive]
    return selected, node_weights


REDUCTION_TOLERANCE = 1e-6
"""Largest relative deviation of a sum [1] of a reduced field."""
LARGE_FIELD_REDUCTION_TOLERANCE = 1e-5
"""Largest relative deviation of a sum [1] of a reduced field with more than MAX_KEPT_NODES nodes."""
TARGET_DEVIATION_OVER_TOLERANCE, ACCEPTED_DEVIATION_OVER_TOLERANCE, ADDED_CASE_DEVIATION_OVER_TOLERANCE = (
    0.05,
    0.6,
    0.15,
)
"""Deviations over the tolerance [1]: goal in the load cases of the selection; limit in the test load cases
(the margin is for untested ones); deviation from which a test load case is added to the selection."""
NODE_ROUNDING_BITS = 25
"""Number of bits to which nodes are rounded for the selection [1]: 3e-8, less than the tolerance."""
MIN_OVER_MAX_PIVOT = 7e-9
"""Smallest pivot of an independent sum over the largest pivot [1]; sums with smaller pivots are dependent."""
KEPT_SUM_COUNT_OVER_PREVIOUS_COUNT = 0.93
"""Number of kept sums, and so of points, in one attempt over that in the attempt before [1]."""
INITIAL_RANDOM_LOAD_CASES = 100
"""Number of quasi-random load cases in the first selection [1]."""
SKETCH_MATRIX_ROWS = 600
"""Number of random combinations of the sample nodes (Halko, Martinsson and Tropp 2011); more than the number
of kept sums."""
MAX_UNREDUCED_NODES = 60
"""Largest number of nodes of a field that is not reduced."""
MAX_KEPT_NODES = 3000
"""Largest number of nodes that are all kept if no reduction meets the tolerance."""
SAMPLE_NODE_COUNT = 3000
"""Number of sample nodes for finding the independent sums."""
TEST_LOAD_CASE_COUNT_RANGE, MAX_TEST_EVALUATIONS = (60, 300), 3e6
"""Smallest and largest number of test load cases per round; largest number of test load cases times nodes."""
MAX_SELECTION_ROUNDS = 8
"""Largest number of rounds that select points, test them and add load cases [1]."""


@dataclass(frozen=True, slots=True)
class FieldReduction:
    """Pressure field of a contact at all nodes, the few nodes (points) that replace them, and their error.

    reduced_distribution : normalised pressure at the points
    full_distribution    : normalised pressure at all nodes
    largest_deviation    : [1] largest error of the points in load cases that did not select them: normal
                           force, normal stiffness K_zz (and K_xx, proportional to it) and rotational
                           stiffnesses K_rx, K_ry, each over its value or its value in the preloaded joint,
                           whichever is larger. Errors of the moments of the force and of coupling
                           stiffnesses count a hundredth
    test_case_count      : number of these load cases
    max_tested_over_unloading_moment : [1] largest moment in these load cases over the moment that unloads a
                                       row of bolts
    deviation_above_tested_moments   : [1] largest error at moments from there to the moment that unloads a
                                       row of bolts
    """

    reduced_distribution: PressureDistribution
    full_distribution: PressureDistribution
    largest_deviation: float = 0.0
    test_case_count: int = 0
    max_tested_over_unloading_moment: float = 1.0
    deviation_above_tested_moments: float = 0.0

    @property
    def point_count(self) -> int:
        """Number of points that replace the nodes of the field."""
        return int(self.reduced_distribution.area_share.size)

    @property
    def node_count(self) -> int:
        """Number of nodes of the unreduced field."""
        return int(self.full_distribution.area_share.size)


def reduce_field(
    bolted_joint: BoltedInterface,
    normalised_pressure: PressureDistribution,
    preload: float,
    nodal_pressure_function: NodalPressureFunction,
) -> FieldReduction:
    """Reduce a pressure distribution to few nodes with the same force, moments and stiffness of the joint.

    Force, moments and stiffness are sums over the nodes. They are kept within REDUCTION_TOLERANCE. If no
    selection of nodes meets this tolerance, all nodes are kept. For a field with more than MAX_KEPT_NODES
    nodes, LARGE_FIELD_REDUCTION_TOLERANCE is enough.

    preload                 : [N] per bolt of the field. Load cases have PRELOAD_OVER_FIELD_PRELOAD_RANGE
                              times this preload, from compression to full opening, and moments up to
                              `find_max_moment_over_unloading_moment`
    nodal_pressure_function : function of the joint for nodal pressures, see
                              `bolted_interface.nodal_pressures`

    Raises RuntimeError if the field has too many nodes, and no points are within
    LARGE_FIELD_REDUCTION_TOLERANCE.
    """
    nodes = normalised_pressure.area_share.size
    if nodes <= MAX_UNREDUCED_NODES:
        return FieldReduction(normalised_pressure, normalised_pressure)
    sums = ForceAndStiffnessFunctions.from_joint(bolted_joint, preload, nodal_pressure_function)
    # sorted by pressure, neighbouring nodes are close on the pressure curve: its evaluation is faster
    order = np.argsort(round_to_digits(normalised_pressure.preload_pressure_ratio), kind="stable")
    unrounded = normalised_pressure.select_nodes(order)
    normalised_pressure = round_distribution(unrounded, NODE_ROUNDING_BITS)
    sample = np.random.default_rng(LOAD_CASE_SEED).choice(
        nodes,
        min(SAMPLE_NODE_COUNT, nodes),
        replace=False,
        p=sums.compute_sampling_probability(
            normalised_pressure, find_max_moment_over_unloading_moment(bolted_joint, normalised_pressure)
        ),
    )
    reduction = _search_reduced_points(
        sums, normalised_pressure, normalised_pressure.select_nodes(sample), unrounded
    )
    if reduction is not None and (
        nodes > MAX_KEPT_NODES or reduction.largest_deviation <= REDUCTION_TOLERANCE
    ):
        return reduction
    if nodes <= MAX_KEPT_NODES:
        return FieldReduction(unrounded, unrounded)
    raise RuntimeError(
        f"the field of {nodes} nodes cannot be reduced: no set of points keeps its sums within "
        f"{LARGE_FIELD_REDUCTION_TOLERANCE:g}; give a field of at most {MAX_KEPT_NODES} nodes, which are all "
        "kept"
    )


def _search_reduced_points(
    sum_functions: ForceAndStiffnessFunctions,
    rounded_pressure_distribution: PressureDistribution,
    sampled_pressure_distribution: PressureDistribution,
    unrounded_pressure_distribution: PressureDistribution,
) -> FieldReduction | None:
    """Search few nodes (points) that replace all nodes of a pressure field; None if there are none.

    With the points, force, moments and stiffness of the joint keep their values within
    LARGE_FIELD_REDUCTION_TOLERANCE. Each round selects points by some load cases, and tests them in new ones.
    Load cases in which the points miss the tolerance are added to those of the selection.

    rounded_pressure_distribution   : normalised pressure at all nodes, rounded
    sampled_pressure_distribution   : sample of these nodes, for finding the independent sums
    unrounded_pressure_distribution : normalised pressure at all nodes
    """
    limit = find_max_moment_over_unloading_moment(sum_functions.bolted_joint, rounded_pressure_distribution)
    loads = random_load_cases(limit)
    tests = int(
        np.clip(
            MAX_TEST_EVALUATIONS / rounded_pressure_distribution.area_share.size, *TEST_LOAD_CASE_COUNT_RANGE
        )
    )
    system = _PreservedSums.from_load_case_sums(
        sum_functions,
        rounded_pressure_distribution,
        unrounded_pressure_distribution,
        sampled_pressure_distribution,
        sum_functions.compute_load_case_sums(
            rounded_pressure_distribution,
            [*initial_load_cases(limit), *islice(loads, INITIAL_RANDOM_LOAD_CASES)],
        ),
    )
    best, best_deviation = None, LARGE_FIELD_REDUCTION_TOLERANCE
    for _ in track_progress(range(MAX_SELECTION_ROUNDS), "points", MAX_SELECTION_ROUNDS):
        points = system.find_reduced_points()
        if points is None:
            break
        test_sums = sum_functions.compute_load_case_sums(
            rounded_pressure_distribution, list(islice(loads, tests))
        )
        deviations = sum_functions.compute_sum_deviations(points, test_sums)
        worst = float(np.max(deviations))
        if worst <= best_deviation:
            best, best_deviation = points, worst
        if worst <= ACCEPTED_DEVIATION_OVER_TOLERANCE * REDUCTION_TOLERANCE:
            break
        system.add_load_cases(
            test_sums.select_load_cases(
                deviations > ADDED_CASE_DEVIATION_OVER_TOLERANCE * REDUCTION_TOLERANCE
            )
        )
    if best is None:
        return None
    deviation_beyond = _deviation_above_tested_moments(
        sum_functions, rounded_pressure_distribution, best, limit
    )
    return FieldReduction(
        best, unrounded_pressure_distribution, best_deviation, tests, limit, deviation_beyond
    )


def _deviation_above_tested_moments(
    sum_functions: ForceAndStiffnessFunctions,
    normalised_pressure: PressureDistribution,
    reduced_points: PressureDistribution,
    min_over_unloading_moment: float,
) -> float:
    """Largest error [1] of few points, in force, moments and stiffness, at large bending moments.

    The largest moment is that at which a row of bolts loses its force.

    normalised_pressure       : pressure at all nodes
    reduced_points            : pressure at the points that replace the nodes
    min_over_unloading_moment : smallest moment over the largest moment [1]
    """
    if min_over_unloading_moment >= 1.0:
        return 0.0
    moments = np.linspace(min_over_unloading_moment, 1.0, 6)[1:].tolist()
    loads = [
        LoadCase(p, sign * m, 0.0)
        for p in PRELOAD_OVER_FIELD_PRELOAD_RANGE
        for m in moments
        for sign in (-1.0, 1.0)
    ]
    return float(
        np.max(
            sum_functions.compute_sum_deviations(
                reduced_points, sum_functions.compute_load_case_sums(normalised_pressure, loads)
            )
        )
    )


@dataclass(slots=True)
class _PreservedSums:
    """The r sums over all nodes that the few selected nodes must reproduce.

    The sums are area, centroid, force and moments of the field, and force, stiffness and their moments in
    load cases.

    rounded_pressure_distribution   : normalised pressure at all nodes, rounded
    unrounded_pressure_distribution : normalised pressure at all nodes
    sampled_pressure_distribution   : normalised pressure at a sample of c nodes, for finding the independent
        sums
    mixing_matrix                   : random matrix (SKETCH_MATRIX_ROWS, c)
    load_case_sums                  : force, stiffness and their moments in the load cases
    equilibrium_scale               : divisors of the functions of `evaluate_equilibrium_functions`
    sketch_matrix                   : (SKETCH_MATRIX_ROWS, r) random combinations of the functions at the
        sample nodes
    """

    sum_functions: ForceAndStiffnessFunctions
    rounded_pressure_distribution: PressureDistribution
    unrounded_pressure_distribution: PressureDistribution
    sampled_pressure_distribution: PressureDistribution
    mixing_matrix: Array
    load_case_sums: ForceAndStiffnessSums
    equilibrium_scale: Array
    sketch_matrix: Array

    @classmethod
    def from_load_case_sums(
        cls,
        sum_functions: ForceAndStiffnessFunctions,
        rounded_pressure_distribution: PressureDistribution,
        unrounded_pressure_distribution: PressureDistribution,
        sampled_pressure_distribution: PressureDistribution,
        load_case_sums: ForceAndStiffnessSums,
    ) -> "_PreservedSums":
        """Collect the force and stiffness sums that the selected nodes must reproduce.

        load_case_sums : sums over all nodes, in the load cases with which the selection begins
        """
        scale = np.maximum(
            np.max(np.abs(evaluate_equilibrium_functions(rounded_pressure_distribution)), axis=0),
            np.finfo(float).tiny,
        )
        mixing = np.random.default_rng(LOAD_CASE_SEED).standard_normal(
            (SKETCH_MATRIX_ROWS, sampled_pressure_distribution.area_share.size)
        )
        mixing *= np.sqrt(sampled_pressure_distribution.area_share / SKETCH_MATRIX_ROWS)
        sketch = mixing @ np.concatenate(
            [
                evaluate_equilibrium_functions(sampled_pressure_distribution) / scale,
                sum_functions.evaluate_functions(sampled_pressure_distribution, load_case_sums),
            ],
            axis=1,
        )
        return cls(
            sum_functions,
            rounded_pressure_distribution,
            unrounded_pressure_distribution,
            sampled_pressure_distribution,
            mixing,
            load_case_sums,
            scale,
            sketch,
        )

    def add_load_cases(self, load_case_sums: ForceAndStiffnessSums) -> None:
        """Add force, stiffness and their moments in further load cases to the sums to be reproduced."""
        self.sketch_matrix = np.concatenate(
            [
                self.sketch_matrix,
                self.mixing_matrix
                @ self.sum_functions.evaluate_functions(self.sampled_pressure_distribution, load_case_sums),
            ],
            axis=1,
        )
        self.load_case_sums = self.load_case_sums.append_load_cases(load_case_sums)

    def evaluate_functions(self, normalised_pressure: PressureDistribution) -> Array:
        """Values at n nodes of the r functions whose sums over the nodes must be reproduced: array (n, r)."""
        return np.concatenate(
            [
                evaluate_equilibrium_functions(normalised_pressure) / self.equilibrium_scale,
                self.sum_functions.evaluate_functions(normalised_pressure, self.load_case_sums),
            ],
            axis=1,
        )

    def find_reduced_points(self) -> PressureDistribution | None:
        """Find few nodes with new area shares that reproduce the sums over all nodes; None if none do.

        The nodes with the highest pressure (`find_peak_nodes`) always stay, with the share of their own area.
        """
        independent, turn = self._find_independent_sums()
        fixed = find_peak_nodes(self.rounded_pressure_distribution)
        try:
            candidates, share = self._select_node_groups(independent, turn, fixed)
            selected, share = recombine_weights(
                self._evaluate_selected_functions(candidates, independent), share, turn
            )
        except RuntimeError:  # round-off
            return None
        selected = candidates[selected]
        values = self.evaluate_functions(self.rounded_pressure_distribution.select_nodes(selected))
        target = np.concatenate(
            [
                self.rounded_pressure_distribution.area_share
                @ evaluate_equilibrium_functions(self.rounded_pressure_distribution)
                / self.equilibrium_scale,
                self.load_case_sums.total_sums.ravel(),
            ]
        )
        target -= self.rounded_pressure_distribution.area_share[fixed] @ self.evaluate_functions(
            self.rounded_pressure_distribution.select_nodes(fixed)
        )
        best, count = None, independent.size
        tolerance = ACCEPTED_DEVIATION_OVER_TOLERANCE * LARGE_FIELD_REDUCTION_TOLERANCE
        while count > 1 and np.max(np.abs(share @ values - target)) <= tolerance:
            best, tolerance = (selected, share), TARGET_DEVIATION_OVER_TOLERANCE * REDUCTION_TOLERANCE
            count = int(KEPT_SUM_COUNT_OVER_PREVIOUS_COUNT * count)
            try:
                fewer, share = recombine_weights(values[:, independent[:count]], share, turn[:count, :count])
            except RuntimeError:
                break
            selected, values = selected[fewer], values[fewer]
        if best is None:
            return None
        points = self.unrounded_pressure_distribution.select_nodes(np.concatenate([fixed, best[0]]))
        return _restore_equilibrium(
            points, np.concatenate([self.rounded_pressure_distribution.area_share[fixed], best[1]])
        )

    def _select_node_groups(
        self, function_indices: NodeIndices, orthogonal_transform: Array, fixed_nodes: NodeIndices
    ) -> tuple[NodeIndices, Array]:
        """Select few groups of nodes with new area shares that keep the sums over all but `fixed_nodes`.

        Returns the nodes of these groups and their area shares.
        """
        share = self.rounded_pressure_distribution.area_share.copy()
        share[fixed_nodes] = 0.0
        group = np.arange(share.size) // nodes_per_group(share.size)
        old_share = np.asarray(np.bincount(group, share), dtype=np.float64)
        nonempty = np.flatnonzero(old_share)
        sums = self._sum_over_groups(function_indices)
        np.subtract.at(
            sums,
            group[fixed_nodes],
            self.rounded_pressure_distribution.area_share[fixed_nodes, None]
            * self._evaluate_selected_functions(fixed_nodes, function_indices),
        )
        selected, new_share = recombine_weights(
            sums[nonempty] / old_share[nonempty, None], old_share[nonempty], orthogonal_transform
        )
        scale = np.zeros(old_share.size)
        scale[nonempty[selected]] = new_share / old_share[nonempty[selected]]
        share *= scale[group]
        nodes = np.flatnonzero(share)
        return nodes, share[nodes]

    def _sum_over_groups(self, function_indices: NodeIndices) -> Array:
        """Sums (g, k) of k functions of pressure and position over the nodes of each of g groups."""
        share, count = self.rounded_pressure_distribution.area_share[:, None], self.equilibrium_scale.size
        is_balance = function_indices < count
        load, function = np.divmod(function_indices[~is_balance] - count, 9)
        values = (
            evaluate_equilibrium_functions(self.rounded_pressure_distribution) / self.equilibrium_scale
        )[:, function_indices[is_balance]]
        out = np.empty((self.load_case_sums.group_sums.shape[2], function_indices.size))
        out[:, is_balance] = np.add.reduceat(
            share * values, np.arange(0, share.size, nodes_per_group(share.size))
        )
        out[:, ~is_balance] = self.load_case_sums.group_sums[load, function].T
        return out

    def _evaluate_selected_functions(self, node_indices: NodeIndices, function_indices: NodeIndices) -> Array:
        """Values (n, k) at n nodes of k of the functions whose sums over the nodes must be kept."""
        shape, count = (
            self.rounded_pressure_distribution.select_nodes(node_indices),
            self.equilibrium_scale.size,
        )
        is_balance = function_indices < count
        out = np.empty((node_indices.size, function_indices.size))
        out[:, is_balance] = (evaluate_equilibrium_functions(shape) / self.equilibrium_scale)[
            :, function_indices[is_balance]
        ]
        out[:, ~is_balance] = self.sum_functions.evaluate_selected_functions(
            shape, self.load_case_sums, function_indices[~is_balance] - count
        )
        return out

    def _find_independent_sums(self) -> tuple[NodeIndices, Array]:
        """Find linearly independent sums: their indices, and the matrix that orthogonalises them.

        The order is that of decreasing pivots in the QR decomposition of `sketch_matrix`.
        """
        triangle, order = qr(self.sketch_matrix, mode="r", pivoting=True)
        size = np.abs(np.diag(triangle))
        count = int(np.sum(size > MIN_OVER_MAX_PIVOT * size[0]))
        return order[:count], solve_triangular(triangle[:count, :count], np.eye(count))


def _restore_equilibrium(
    normalised_pressure: PressureDistribution, node_weights: Array
) -> PressureDistribution:
    """Select the nodes with a weight > 0; correct their shares, positions and pressures to equilibrium."""
    points = normalised_pressure.select_nodes(np.flatnonzero(node_weights > 0.0))
    share = node_weights[node_weights > 0.0] / np.sum(node_weights)
    return PressureDistribution(
        area_share=share,
        position=points.position - share @ points.position,
        preload_pressure_ratio=points.preload_pressure_ratio / (share @ points.preload_pressure_ratio),
        moment_pressure_ratio=points.moment_pressure_ratio - share @ points.moment_pressure_ratio,
    )
