"""Few points that stand for the nodes of a bolted contact, whatever law the interface has.

Force and stiffness of a joint are sums over its nodes of share times a function of the node's approach, with
its position as a factor. Whatever the law, these functions are near to powers of the node's pressure, which
preload and moment make, opened or closed by a displacement and a tilt: the `_functions`. Most of their sums
follow from few others, and as many nodes with other shares keep these (`elimination`). A contact that mirrors
itself keeps doing so. Which nodes these are and how much each keeps of its share is found with rounded
numbers (`reproducible`), the nodes are the contact's own. benchmarks/patch_reduction.py prints how far the
sums of a law are from those of all nodes.
"""

import numpy as np

from ...quantity import Array
from .elimination import Nodes, changes, eliminated, independent
from .reproducible import cleared, over, powers, product, root, rounded, to_power
from .shape import PressureShape

POWERS = (4.0, 8.0, 16.0, 64.0)
"""Powers N of p ~ delta^N [1], which make k ~ p^(1 - 1/N): 1.5 of Hertz, rough surfaces are near 10, the last
is nearly an exponential."""
STATES = 80
"""States of the joint at which sums are kept."""
UNTILTED = 0.4
"""Part of them without displacement and tilt [1]."""
LESS = 0.02
"""How much less accurate the others may be [1]."""
APART, TILTED = 0.1, 0.1
"""Largest displacement and tilt [1], over the approach of the node that is pressed most."""
OPENED = 1e-4
"""Part of the force [1] whose nodes the largest moment opens."""
RESERVED = 0.1
"""Part of its share [1] that a node of largest pressure keeps at least."""
HOLDING = 96
"""Fewest points [1] of which some are spent on the largest pressure."""
LEAST_GROUPS = 10
"""Fewest groups of points that mirror each other [1]; fewer say less than as many points without symmetry."""
_RATIOS = powers(1.0 / 1.1673039782614187, 4)
"""An even sequence in four dimensions: powers of the root of x^5 = x + 1."""


def few_points(shape: PressureShape, count: int) -> PressureShape:
    """Some of the nodes with other shares, at most `count`, or the shape itself where it has no more.

    Kept to round-off: the sums of share, equal and tilt, their first moments, the second moments of share.
    Kept exactly: the largest pressure under any preload and moment, from HOLDING points on, and the symmetry
    of the contact, from LEAST_GROUPS groups on.

    Raises ValueError if count is too small to keep the sums.
    """
    if shape.share.size <= count:
        return shape
    rough = rounded(shape)
    group = _mirrored(rough)
    if np.max(np.bincount(group)) * LEAST_GROUPS > count:
        group = np.arange(shape.share.size)
    nodes, factor = _kept(rough, group, count)
    before, exact = _sums(group, shape.share), _means(_exact(shape), shape, group)
    after, some = np.zeros_like(before), exact[:, nodes]
    after[nodes] = factor * before[nodes]
    after[nodes] += changes(after[nodes], some, over(exact, before) - over(some, after[nodes]))
    return cleared(_part(shape, group, after / before))


def _kept(rough: PressureShape, group: Nodes, count: int) -> tuple[Nodes, Array]:
    """Groups that keep the sums of all, at most `count` nodes, and the factors [1] of their shares."""
    size, share = np.bincount(group), _sums(group, rough.share)
    factor = np.sqrt(share)
    exact = independent(factor * _means(_exact(rough), rough, group), share.size)[1]
    rest = factor * _means(_functions(rough), rough, group)
    rest -= product(product(rest, exact), exact.T)
    kept = np.concatenate([exact, independent(rest, count)[1]]).T / factor[:, None]
    held = _held(rough, group, share) if count >= HOLDING else np.zeros_like(share)
    weights, number = share, kept.shape[1]
    while number >= len(exact):
        free = np.flatnonzero(weights > held)
        left = eliminated(kept[free, :number], (weights - held)[free])
        weights = held.copy()
        weights[free] += left
        excess = int(np.sum(size[weights > 0.0])) - count
        if excess <= 0:
            nodes = np.flatnonzero(weights > 0.0)
            return nodes, weights[nodes] / share[nodes]
        number = min(number, int(np.sum(left > 0.0))) - max(excess // (2 * int(np.max(size))), 1)
    raise ValueError(f"{count} points are too few, expected at least {count + excess} for this contact")


def _held(shape: PressureShape, group: Nodes, share: Array) -> Array:
    """What groups keep of their shares [1] at least."""
    held, most = np.zeros_like(share), np.unique(group[highest(shape)])
    held[most] = RESERVED * share[most]
    return held


def _part(shape: PressureShape, group: Nodes, factor: Array) -> PressureShape:
    """Nodes with their shares times the factor of their group, without those that have none left."""
    nodes = np.flatnonzero(factor[group] > 0.0)
    some = shape.part(nodes)
    return PressureShape(some.share * factor[group[nodes]], some.position, some.equal, some.tilt)


def _mirrored(shape: PressureShape) -> Nodes:
    """Groups (n) of nodes that mirror each other at x = 0, at y = 0, where tilt changes its sign, or both."""
    share, (x, y), equal, tilt = shape.share, shape.position.T, shape.equal, shape.tilt

    def keys(along: float, across: float) -> Array:
        return np.column_stack([along * x, across * y, share, equal, across * tilt]) + 0.0  # no -0.0

    own, group = keys(1.0, 1.0), np.arange(shape.share.size)
    order = np.lexsort(own.T)
    for sides in ((-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        image = keys(*sides)
        there = np.lexsort(image.T)
        if np.array_equal(own[order], image[there]):
            partner = np.empty_like(group)
            partner[order] = there
            group = np.minimum(group, group[partner])
    return np.unique(group, return_inverse=True)[1]


def _means(functions: Array, shape: PressureShape, group: Nodes) -> Array:
    """(m, groups) means of functions (m, n) over the nodes of each group."""
    sums = [_sums(group, shape.share * row) for row in functions]
    return np.array(sums) / _sums(group, shape.share)


def _sums(group: Nodes, values: Array) -> Array:
    """Sums of values (n) over the nodes of each group."""
    return np.asarray(np.bincount(group, values), dtype=np.float64)


def _scaled(shape: PressureShape) -> tuple[Array, Array]:
    """Positions over the largest ones [1]."""
    x, y = (values / max(float(np.max(np.abs(values))), np.finfo(float).tiny) for values in shape.position.T)
    return x, y


def balanced(x: Array, y: Array, equal: Array, tilt: Array) -> Array:
    """(12, n) the functions of points (n) whose sums are exact."""
    one = np.ones_like(x)
    return np.stack([one, x, y, x * x, x * y, y * y, equal, equal * x, equal * y, tilt, tilt * x, tilt * y])


def _exact(shape: PressureShape) -> Array:
    """(12, n) these, over their largest values."""
    steep = max(float(np.max(np.abs(shape.tilt))), 1.0)
    return balanced(*_scaled(shape), shape.equal, shape.tilt / steep)


def largest_moment(shape: PressureShape) -> float:
    """Factor of tilt [1] at which nodes are open that carried the part OPENED of the force of equal."""
    low, high = 0.0, 2.0 / float(np.max(np.abs(shape.share * shape.tilt)))
    for _ in range(50):
        middle = 0.5 * (low + high)
        open_to = np.stack([side * middle * shape.tilt - shape.equal for side in (-1.0, 1.0)])
        lost = np.max(over(np.maximum(open_to, 0.0), shape.share))
        low, high = (middle, high) if lost < OPENED else (low, middle)
    return low


def _functions(shape: PressureShape) -> Array:
    """(m, n) functions at states of the joint: pressure and stiffness of power laws, their moments.

    Those of the pressure are of the normal force and, with the distance from the centre, of the friction in
    a turn about the normal; of the stiffness they are the first and second ones.
    """
    (x, y), limit = _scaled(shape), largest_moment(shape)
    distance = np.sqrt(np.add.reduce(shape.position**2, axis=1))
    of_pressure = np.stack([np.ones_like(x), x, y, distance / np.max(distance)])
    of_stiffness = np.stack([*of_pressure[:3], x * x, x * y, y * y])
    number = np.arange(STATES)[:, None]
    moment, apart, about_x, about_y = 2.0 * ((0.5 + (number + 1.0) * _RATIOS) % 1.0).T[..., None] - 1.0
    power, moves = np.choose(number % len(POWERS), POWERS), number >= UNTILTED * STATES
    away = moves * (APART * apart + TILTED * (about_x * y - about_y * x))
    approach = root(np.maximum(shape.equal + limit * moment * shape.tilt, 0.0), power)
    approach = np.maximum(approach - np.max(approach, axis=1, keepdims=True) * away, 0.0)
    pressure = to_power(approach, power)
    stiffness = np.divide(pressure, approach, out=np.zeros_like(pressure), where=approach > 0.0)
    rows = np.concatenate([pressure[:, None] * of_pressure, stiffness[:, None] * of_stiffness], axis=1)
    sizes = np.add.reduce(np.abs(rows) * shape.share, axis=2, keepdims=True)
    rows *= np.where(moves, LESS, 1.0)[:, None] / np.maximum(sizes, np.finfo(float).tiny)
    return np.asarray(rows.reshape(-1, x.size))


def highest(shape: PressureShape) -> Nodes:
    """Nodes that have the largest pressure at some moment."""
    steep = 0.01 * powers(1.25, 36)
    moments = np.concatenate([-steep, [0.0], steep])
    return np.unique([int(np.argmax(shape.equal + m * shape.tilt)) for m in moments])
