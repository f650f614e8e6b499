"""Reduction of the nodes of a bolted contact to few points, for any interface law.

Force and stiffness of a joint are sums over its nodes: share times position times a function of the approach
of the node. For all laws these functions are close to powers of the pressure by preload and moment, changed
by a normal displacement and a tilt (`_sample_load_functions`). Most sums of such functions depend on few
others. So a subset of the nodes with other shares has nearly the same sums (`elimination`). A symmetric
contact stays symmetric.

The choice of nodes and their shares are computed with rounded numbers (`reproducible`); the result contains
the unrounded nodes. studies/fields_explanation.py prints the deviation from the sums over all nodes.
"""

import numpy as np

from ...quantity import Array
from .distribution import PressureDistribution
from .elimination import NodeIndices, find_smallest_weight_changes, reduce_weights, select_independent
from .reproducible import (
    clear_round_off,
    matrix_product,
    raise_to_power_of_two,
    round_distribution,
    successive_powers,
    take_power_of_two_root,
    weighted_sums,
)

PRESSURE_LAW_EXPONENTS = (4.0, 8.0, 16.0, 64.0)
"""Exponents N of the laws p ~ delta^N [1], with k ~ p^(1 - 1/N). Hertz has 1.5, rough surfaces about 10; the
last one is nearly an exponential."""
SAMPLED_STATE_COUNT = 80
"""Number of sampled states of the joint [1]."""
UNTILTED_SHARE_OF_STATES = 0.4
"""Share of the states without normal displacement and tilt [1]."""
DISPLACED_STATE_WEIGHT = 0.02
"""Weight of the states with displacement and tilt, over the weight of the others [1]."""
MAX_SAMPLED_OPENING_OVER_APPROACH, MAX_SAMPLED_TILT_OPENING_OVER_APPROACH = 0.1, 0.1
"""Largest normal displacement, and largest opening by tilt at the edge, over the largest approach [1]."""
MAX_FORCE_SHARE_LOST_BY_OPENING = 1e-4
"""Share of the force [1] that is lost by opening at the largest moment."""
MIN_PEAK_NODE_SHARE_FACTOR = 0.1
"""Smallest factor [1] on the share of a node with the largest pressure."""
MIN_POINTS_FOR_PEAK_NODES = 96
"""Smallest number of points [1] for which the nodes with the largest pressure are kept."""
MIN_SYMMETRY_GROUPS = 10
"""Smallest number of groups of mirrored points [1]; with fewer groups the symmetry is given up."""
_LOW_DISCREPANCY_INCREMENTS = successive_powers(1.0 / 1.1673039782614187, 4)
"""Increments of a low-discrepancy sequence in four dimensions [1]: powers of 1/x with x^5 = x + 1."""


def reduce_points(pressure_distribution: PressureDistribution, max_point_count: int) -> PressureDistribution:
    """Reduce a pressure distribution to at most `max_point_count` of its nodes with other shares.

    Returns the distribution itself if it has no more nodes. The points keep to round-off: the sums and first
    moments of share, preload_pressure_ratio and moment_pressure_ratio (weighted by share), and the second
    moments of share. They keep exactly: the largest pressure at any preload and moment, if max_point_count is
    at least MIN_POINTS_FOR_PEAK_NODES, and the symmetry of the contact, for at least MIN_SYMMETRY_GROUPS
    groups.

    Raises ValueError if max_point_count is too small to keep the sums.
    """
    if pressure_distribution.area_share.size <= max_point_count:
        return pressure_distribution
    rounded_shape = round_distribution(pressure_distribution)
    group = _find_symmetry_groups(rounded_shape)
    if np.max(np.bincount(group)) * MIN_SYMMETRY_GROUPS > max_point_count:
        group = np.arange(pressure_distribution.area_share.size)
    nodes, factor = _select_node_groups(rounded_shape, group, max_point_count)
    old_shares = _sum_over_groups(group, pressure_distribution.area_share)
    exact = _average_over_groups(
        _scaled_preserved_functions(pressure_distribution), pressure_distribution, group
    )
    new_shares, exact_nodes = np.zeros_like(old_shares), exact[:, nodes]
    new_shares[nodes] = factor * old_shares[nodes]
    new_shares[nodes] += find_smallest_weight_changes(
        new_shares[nodes],
        exact_nodes,
        weighted_sums(exact, old_shares) - weighted_sums(exact_nodes, new_shares[nodes]),
    )
    return clear_round_off(_scale_shares(pressure_distribution, group, new_shares / old_shares))


def _select_node_groups(
    pressure_distribution: PressureDistribution, node_groups: NodeIndices, max_node_count: int
) -> tuple[NodeIndices, Array]:
    """Select groups of nodes, with new shares that keep the sums of `preserved_sum_functions` over all nodes.

    node_groups : (n) group of each node

    Returns the indices of the groups, and the factors [1] on their shares.
    """
    size, share = np.bincount(node_groups), _sum_over_groups(node_groups, pressure_distribution.area_share)
    factor = np.sqrt(share)
    exact = select_independent(
        factor
        * _average_over_groups(
            _scaled_preserved_functions(pressure_distribution), pressure_distribution, node_groups
        ),
        share.size,
    )[1]
    rest = factor * _average_over_groups(
        _sample_load_functions(pressure_distribution), pressure_distribution, node_groups
    )
    rest -= matrix_product(matrix_product(rest, exact), exact.T)
    functions = np.concatenate([exact, select_independent(rest, max_node_count)[1]]).T / factor[:, None]
    min_shares = (
        _minimum_shares(pressure_distribution, node_groups, share)
        if max_node_count >= MIN_POINTS_FOR_PEAK_NODES
        else np.zeros_like(share)
    )
    weights, number = share, functions.shape[1]
    while number >= len(exact):
        free_groups = np.flatnonzero(weights > min_shares)
        reduced = reduce_weights(functions[free_groups, :number], (weights - min_shares)[free_groups])
        weights = min_shares.copy()
        weights[free_groups] += reduced
        excess = int(np.sum(size[weights > 0.0])) - max_node_count
        if excess <= 0:
            nodes = np.flatnonzero(weights > 0.0)
            return nodes, weights[nodes] / share[nodes]
        number = min(number, int(np.sum(reduced > 0.0))) - max(excess // (2 * int(np.max(size))), 1)
    raise ValueError(
        f"{max_node_count} points are too few for this contact; expected at least {max_node_count + excess}"
    )


def _minimum_shares(
    pressure_distribution: PressureDistribution, node_groups: NodeIndices, group_shares: Array
) -> Array:
    """Smallest shares (groups) [1] that the groups must keep: nonzero for nodes with the largest pressure."""
    min_shares = np.zeros_like(group_shares)
    peak_groups = np.unique(node_groups[find_peak_nodes(pressure_distribution)])
    min_shares[peak_groups] = MIN_PEAK_NODE_SHARE_FACTOR * group_shares[peak_groups]
    return min_shares


def _scale_shares(
    pressure_distribution: PressureDistribution, node_groups: NodeIndices, group_share_factors: Array
) -> PressureDistribution:
    """Multiply shares of nodes by the factor (groups) [1] of their group; remove nodes with factor zero."""
    nodes = np.flatnonzero(group_share_factors[node_groups] > 0.0)
    selected = pressure_distribution.select_nodes(nodes)
    return PressureDistribution(
        selected.area_share * group_share_factors[node_groups[nodes]],
        selected.position,
        selected.preload_pressure_ratio,
        selected.moment_pressure_ratio,
    )


def _find_symmetry_groups(pressure_distribution: PressureDistribution) -> NodeIndices:
    """Symmetry group (n) of each node: its mirror images at x = 0, y = 0 or both, if every node has an image.

    The pressure by moment of a mirror image at y = 0 has the opposite sign.
    """
    share = pressure_distribution.area_share
    x, y = pressure_distribution.position.T
    equal = pressure_distribution.preload_pressure_ratio
    tilt = pressure_distribution.moment_pressure_ratio

    def mirrored_node_keys(x_sign: float, y_sign: float) -> Array:
        """Rounded numbers of the nodes, mirrored by the signs; equal keys are mirror images."""
        return np.column_stack([x_sign * x, y_sign * y, share, equal, y_sign * tilt]) + 0.0  # no -0.0

    own_keys, group = mirrored_node_keys(1.0, 1.0), np.arange(pressure_distribution.area_share.size)
    order = np.lexsort(own_keys.T)
    for sides in ((-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        image = mirrored_node_keys(*sides)
        image_order = np.lexsort(image.T)
        if np.array_equal(own_keys[order], image[image_order]):
            partner = np.empty_like(group)
            partner[order] = image_order
            group = np.minimum(group, group[partner])
    return np.unique(group, return_inverse=True)[1]


def _average_over_groups(
    function_values: Array, pressure_distribution: PressureDistribution, node_groups: NodeIndices
) -> Array:
    """Means (m, groups) of functions (m, n) over the nodes of each group, weighted by share."""
    sums = [_sum_over_groups(node_groups, pressure_distribution.area_share * row) for row in function_values]
    return np.array(sums) / _sum_over_groups(node_groups, pressure_distribution.area_share)


def _sum_over_groups(node_groups: NodeIndices, node_values: Array) -> Array:
    """Sums (groups) of values (n) over the nodes of each group."""
    return np.asarray(np.bincount(node_groups, node_values), dtype=np.float64)


def _scale_positions(pressure_distribution: PressureDistribution) -> tuple[Array, Array]:
    """Divide coordinates x and y (n) of the nodes by their largest absolute values [1]."""
    x, y = (
        values / max(float(np.max(np.abs(values))), np.finfo(float).tiny)
        for values in pressure_distribution.position.T
    )
    return x, y


def preserved_sum_functions(
    x: Array, y: Array, preload_pressure_ratio: Array, moment_pressure_ratio: Array
) -> Array:
    """Functions (12, n) of n points; a reduction keeps their sums, weighted by share, to round-off.

    The functions are 1, x, y, x^2, x y, y^2, and each pressure ratio times 1, x and y.
    """
    ones = np.ones_like(x)
    return np.stack(
        [
            ones,
            x,
            y,
            x * x,
            x * y,
            y * y,
            preload_pressure_ratio,
            preload_pressure_ratio * x,
            preload_pressure_ratio * y,
            moment_pressure_ratio,
            moment_pressure_ratio * x,
            moment_pressure_ratio * y,
        ]
    )


def _scaled_preserved_functions(pressure_distribution: PressureDistribution) -> Array:
    """Functions (12, n) of n nodes, scaled to the order of 1; a reduction keeps their sums over the nodes.

    These are 1, x, y, x^2, x y, y^2, and the pressure ratios of preload and moment, each times 1, x and y.
    """
    steep = max(float(np.max(np.abs(pressure_distribution.moment_pressure_ratio))), 1.0)
    return preserved_sum_functions(
        *_scale_positions(pressure_distribution),
        pressure_distribution.preload_pressure_ratio,
        pressure_distribution.moment_pressure_ratio / steep,
    )


def largest_moment_factor(pressure_distribution: PressureDistribution) -> float:
    """Largest factor [1] on the pressure by a moment in the sampled states.

    At this factor the contact opens so far that it loses the share MAX_FORCE_SHARE_LOST_BY_OPENING of its
    force.
    """
    low, high = (
        0.0,
        2.0
        / float(
            np.max(np.abs(pressure_distribution.area_share * pressure_distribution.moment_pressure_ratio))
        ),
    )
    for _ in range(50):
        middle = 0.5 * (low + high)
        open_to = np.stack(
            [
                side * middle * pressure_distribution.moment_pressure_ratio
                - pressure_distribution.preload_pressure_ratio
                for side in (-1.0, 1.0)
            ]
        )
        lost_share = np.max(weighted_sums(np.maximum(open_to, 0.0), pressure_distribution.area_share))
        low, high = (middle, high) if lost_share < MAX_FORCE_SHARE_LOST_BY_OPENING else (low, middle)
    return low


def _sample_load_functions(pressure_distribution: PressureDistribution) -> Array:
    """Functions (m, n) [1] of the nodes whose sums are approximated: pressure and stiffness in all states.

    Each state has a power law, a moment, a normal displacement and a tilt. The pressure is multiplied by 1, x
    and y (normal force, moments) and by the distance from the centre (friction moment in a rotation about the
    normal); the stiffness by 1, x, y, x^2, x y and y^2.
    """
    (x, y), limit = _scale_positions(pressure_distribution), largest_moment_factor(pressure_distribution)
    distance = np.sqrt(np.add.reduce(pressure_distribution.position**2, axis=1))
    of_pressure = np.stack([np.ones_like(x), x, y, distance / np.max(distance)])
    of_stiffness = np.stack([*of_pressure[:3], x * x, x * y, y * y])
    number = np.arange(SAMPLED_STATE_COUNT)[:, None]
    moment, opening, about_x, about_y = (
        2.0 * ((0.5 + (number + 1.0) * _LOW_DISCREPANCY_INCREMENTS) % 1.0).T[..., None] - 1.0
    )
    power = np.choose(number % len(PRESSURE_LAW_EXPONENTS), PRESSURE_LAW_EXPONENTS)
    is_moved = number >= UNTILTED_SHARE_OF_STATES * SAMPLED_STATE_COUNT
    normal_displacement = is_moved * (
        MAX_SAMPLED_OPENING_OVER_APPROACH * opening
        + MAX_SAMPLED_TILT_OPENING_OVER_APPROACH * (about_x * y - about_y * x)
    )
    approach = take_power_of_two_root(
        np.maximum(
            pressure_distribution.preload_pressure_ratio
            + limit * moment * pressure_distribution.moment_pressure_ratio,
            0.0,
        ),
        power,
    )
    approach = np.maximum(approach - np.max(approach, axis=1, keepdims=True) * normal_displacement, 0.0)
    pressure = raise_to_power_of_two(approach, power)
    stiffness = np.divide(pressure, approach, out=np.zeros_like(pressure), where=approach > 0.0)
    rows = np.concatenate([pressure[:, None] * of_pressure, stiffness[:, None] * of_stiffness], axis=1)
    sizes = np.add.reduce(np.abs(rows) * pressure_distribution.area_share, axis=2, keepdims=True)
    rows *= np.where(is_moved, DISPLACED_STATE_WEIGHT, 1.0)[:, None] / np.maximum(sizes, np.finfo(float).tiny)
    return np.asarray(rows.reshape(-1, x.size))


def find_peak_nodes(pressure_distribution: PressureDistribution) -> NodeIndices:
    """Indices of the nodes that have the largest pressure at any of several moments."""
    steep = 0.01 * successive_powers(1.25, 36)
    moments = np.concatenate([-steep, [0.0], steep])
    return np.unique(
        [
            int(
                np.argmax(
                    pressure_distribution.preload_pressure_ratio
                    + m * pressure_distribution.moment_pressure_ratio
                )
            )
            for m in moments
        ]
    )
