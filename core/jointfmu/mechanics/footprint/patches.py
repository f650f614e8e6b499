"""Reduction of the nodes of a bolted contact to few points, for any interface law.

Force and stiffness of a joint are sums over its nodes: share times position times a function of the approach
of the node. For all laws these functions are close to powers of the pressure by preload and moment, changed
by a normal displacement and a tilt (`_sample_functions`). Most sums of such functions depend on few others.
So a subset of the nodes with other shares has nearly the same sums (`elimination`). A symmetric contact stays
symmetric.

The choice of nodes and their shares are computed with rounded numbers (`reproducible`); the result contains
the unrounded nodes. benchmarks/patch_reduction.py prints the deviation from the sums over all nodes.
"""

import numpy as np

from ...quantity import Array
from .elimination import Nodes, changes, eliminated, independent
from .reproducible import cleared, over, powers, product, root, rounded, to_power
from .shape import PressureShape

POWERS = (4.0, 8.0, 16.0, 64.0)
"""Exponents N of the laws p ~ delta^N [1], with k ~ p^(1 - 1/N). Hertz has 1.5, rough surfaces about 10; the
last one is nearly an exponential."""
STATES = 80
"""Number of sampled states of the joint [1]."""
UNTILTED = 0.4
"""Share of the states without normal displacement and tilt [1]."""
LESS = 0.02
"""Weight of the states with displacement and tilt, over that of the others [1]."""
APART, TILTED = 0.1, 0.1
"""Largest normal displacement, and largest opening by tilt at the edge, over the largest approach [1]."""
OPENED = 1e-4
"""Share of the force [1] that is lost by opening at the largest moment."""
RESERVED = 0.1
"""Smallest factor [1] on the share of a node with the largest pressure."""
HOLDING = 96
"""Smallest number of points [1] for which the nodes with the largest pressure are kept."""
LEAST_GROUPS = 10
"""Smallest number of groups of mirrored points [1]; with fewer groups the symmetry is given up."""
_RATIOS = powers(1.0 / 1.1673039782614187, 4)
"""Increments of a low-discrepancy sequence in four dimensions [1]: powers of the root of x^5 = x + 1."""


def few_points(shape: PressureShape, count: int) -> PressureShape:
    """Reduce a pressure distribution to at most `count` of its nodes with other shares.

    Returns the distribution itself if it has no more nodes.
    Kept to round-off: the sums and first moments of share, preload_shape and moment_shape (weighted by
    share), and the second moments of share.
    Kept exactly: the largest pressure at any preload and moment, if count is at least MIN_PEAK_COUNT, and the
    symmetry of the contact, for at least MIN_SYMMETRY_GROUPS groups.

    Raises ValueError if count is too small to keep the sums.
    """
    if shape.share.size <= count:
        return shape
    rounded_shape = rounded(shape)
    group = _mirrored(rounded_shape)
    if np.max(np.bincount(group)) * LEAST_GROUPS > count:
        group = np.arange(shape.share.size)
    nodes, factor = _kept(rounded_shape, group, count)
    old_shares, exact = _sums(group, shape.share), _means(_exact(shape), shape, group)
    new_shares, exact_nodes = np.zeros_like(old_shares), exact[:, nodes]
    new_shares[nodes] = factor * old_shares[nodes]
    new_shares[nodes] += changes(
        new_shares[nodes], exact_nodes, over(exact, old_shares) - over(exact_nodes, new_shares[nodes])
    )
    return cleared(_part(shape, group, new_shares / old_shares))


def _kept(rough: PressureShape, group: Nodes, count: int) -> tuple[Nodes, Array]:
    """Select groups with at most `count` nodes that keep the sums; return groups and factors of their shares.

    group : (n) group of each node
    """
    size, share = np.bincount(group), _sums(group, rough.share)
    factor = np.sqrt(share)
    exact = independent(factor * _means(_exact(rough), rough, group), share.size)[1]
    rest = factor * _means(_functions(rough), rough, group)
    rest -= product(product(rest, exact), exact.T)
    functions = np.concatenate([exact, independent(rest, count)[1]]).T / factor[:, None]
    min_shares = _held(rough, group, share) if count >= HOLDING else np.zeros_like(share)
    weights, number = share, functions.shape[1]
    while number >= len(exact):
        free_groups = np.flatnonzero(weights > min_shares)
        reduced = eliminated(functions[free_groups, :number], (weights - min_shares)[free_groups])
        weights = min_shares.copy()
        weights[free_groups] += reduced
        excess = int(np.sum(size[weights > 0.0])) - count
        if excess <= 0:
            nodes = np.flatnonzero(weights > 0.0)
            return nodes, weights[nodes] / share[nodes]
        number = min(number, int(np.sum(reduced > 0.0))) - max(excess // (2 * int(np.max(size))), 1)
    raise ValueError(f"{count} points are too few, expected at least {count + excess} for this contact")


def _held(shape: PressureShape, group: Nodes, share: Array) -> Array:
    """Smallest shares (groups) [1] that the groups must keep: nonzero for nodes with the largest pressure."""
    min_shares, peak_groups = np.zeros_like(share), np.unique(group[highest(shape)])
    min_shares[peak_groups] = RESERVED * share[peak_groups]
    return min_shares


def _part(shape: PressureShape, group: Nodes, factor: Array) -> PressureShape:
    """Multiply shares by the factor (groups) [1] of their group; remove nodes with the factor zero."""
    nodes = np.flatnonzero(factor[group] > 0.0)
    selected = shape.part(nodes)
    return PressureShape(
        selected.share * factor[group[nodes]], selected.position, selected.equal, selected.tilt
    )


def _mirrored(shape: PressureShape) -> Nodes:
    """Group (n) of each node: mirror images at x = 0, y = 0 or both are in one group, if all nodes have one.

    At y = 0 moment_shape changes its sign.
    """
    share, (x, y), equal, tilt = shape.share, shape.position.T, shape.equal, shape.tilt

    def keys(along: float, across: float) -> Array:
        return np.column_stack([along * x, across * y, share, equal, across * tilt]) + 0.0  # no -0.0

    own_keys, group = keys(1.0, 1.0), np.arange(shape.share.size)
    order = np.lexsort(own_keys.T)
    for sides in ((-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        image = keys(*sides)
        image_order = np.lexsort(image.T)
        if np.array_equal(own_keys[order], image[image_order]):
            partner = np.empty_like(group)
            partner[order] = image_order
            group = np.minimum(group, group[partner])
    return np.unique(group, return_inverse=True)[1]


def _means(functions: Array, shape: PressureShape, group: Nodes) -> Array:
    """Means (m, groups) of functions (m, n) over the nodes of each group, weighted by share."""
    sums = [_sums(group, shape.share * row) for row in functions]
    return np.array(sums) / _sums(group, shape.share)


def _sums(group: Nodes, values: Array) -> Array:
    """Sums (groups) of values (n) over the nodes of each group."""
    return np.asarray(np.bincount(group, values), dtype=np.float64)


def _scaled(shape: PressureShape) -> tuple[Array, Array]:
    """Coordinates x and y (n) of the nodes over their largest absolute values [1]."""
    x, y = (values / max(float(np.max(np.abs(values))), np.finfo(float).tiny) for values in shape.position.T)
    return x, y


def balanced(x: Array, y: Array, equal: Array, tilt: Array) -> Array:
    """Functions (12, n) of points (n) whose sums, weighted by share, are kept to round-off."""
    ones = np.ones_like(x)
    return np.stack([ones, x, y, x * x, x * y, y * y, equal, equal * x, equal * y, tilt, tilt * x, tilt * y])


def _exact(shape: PressureShape) -> Array:
    """Functions (12, n) of `exact_functions` for the nodes, scaled to the order of 1."""
    steep = max(float(np.max(np.abs(shape.tilt))), 1.0)
    return balanced(*_scaled(shape), shape.equal, shape.tilt / steep)


def largest_moment(shape: PressureShape) -> float:
    """Factor [1] on moment_shape at which opening removes the share MAX_LOST_FORCE of the preload force."""
    low, high = 0.0, 2.0 / float(np.max(np.abs(shape.share * shape.tilt)))
    for _ in range(50):
        middle = 0.5 * (low + high)
        open_to = np.stack([side * middle * shape.tilt - shape.equal for side in (-1.0, 1.0)])
        lost_share = np.max(over(np.maximum(open_to, 0.0), shape.share))
        low, high = (middle, high) if lost_share < OPENED else (low, middle)
    return low


def _functions(shape: PressureShape) -> Array:
    """Functions (m, n) [1] of the nodes whose sums are approximated: pressure and stiffness in all states.

    Each state has a power law, a moment, a normal displacement and a tilt. The pressure is multiplied by 1, x
    and y (normal force, moments) and by the distance from the centre (friction moment in a rotation about the
    normal); the stiffness by 1, x, y, x^2, x y and y^2.
    """
    (x, y), limit = _scaled(shape), largest_moment(shape)
    distance = np.sqrt(np.add.reduce(shape.position**2, axis=1))
    of_pressure = np.stack([np.ones_like(x), x, y, distance / np.max(distance)])
    of_stiffness = np.stack([*of_pressure[:3], x * x, x * y, y * y])
    number = np.arange(STATES)[:, None]
    moment, opening, about_x, about_y = 2.0 * ((0.5 + (number + 1.0) * _RATIOS) % 1.0).T[..., None] - 1.0
    power, is_moved = np.choose(number % len(POWERS), POWERS), number >= UNTILTED * STATES
    normal_displacement = is_moved * (APART * opening + TILTED * (about_x * y - about_y * x))
    approach = root(np.maximum(shape.equal + limit * moment * shape.tilt, 0.0), power)
    approach = np.maximum(approach - np.max(approach, axis=1, keepdims=True) * normal_displacement, 0.0)
    pressure = to_power(approach, power)
    stiffness = np.divide(pressure, approach, out=np.zeros_like(pressure), where=approach > 0.0)
    rows = np.concatenate([pressure[:, None] * of_pressure, stiffness[:, None] * of_stiffness], axis=1)
    sizes = np.add.reduce(np.abs(rows) * shape.share, axis=2, keepdims=True)
    rows *= np.where(is_moved, LESS, 1.0)[:, None] / np.maximum(sizes, np.finfo(float).tiny)
    return np.asarray(rows.reshape(-1, x.size))


def highest(shape: PressureShape) -> Nodes:
    """Indices of the nodes that have the largest pressure at any of several moments."""
    steep = 0.01 * powers(1.25, 36)
    moments = np.concatenate([-steep, [0.0], steep])
    return np.unique([int(np.argmax(shape.equal + m * shape.tilt)) for m in moments])
