"""Few points that stand for the nodes of a bolted contact, whatever law the interface has.

Force and stiffness of a joint are sums over its nodes of share times a function of the node's approach, with
its position as a factor. Whatever the law, these functions are near to powers of the node's pressure, which
preload and moment make, opened or closed by a displacement and a tilt: the `_functions`. Most of their sums
follow from few others, and as many nodes with other shares keep these (`elimination`). A contact that mirrors
itself keeps doing so. benchmarks/patch_reduction.py prints how far the sums of a law are from those of all
nodes.
"""

import numpy as np

from .elimination import Array, Nodes, eliminated, independent
from .shape import PressureShape

EXPONENTS = (0.7, 0.9, 0.95, 1.0)
"""Exponents n of k ~ p^n [1], 1/3 of Hertz, 1 of an exponential law; rough surfaces are near 1."""
STATES = 80
"""States of the joint at which sums are kept."""
UNTILTED = 0.4
"""Part of them without displacement and tilt [1]."""
LESS = 0.02
"""How much less accurate the others may be [1]."""
APART, TILTED = 0.1, 0.1
"""Largest displacement and tilt [1], over the approach of the node that is pressed most."""
STEEP = 5.0
"""The same displacement with the exponential law, over the length in which it grows by e [1]."""
OPENED = 1e-4
"""Part of the force [1] whose nodes the largest moment opens."""
RESERVED = 0.1
"""Part of its share [1] that a node of largest pressure keeps at least."""
HOLDING = 96
"""Fewest points [1] of which some are spent on the largest pressure."""
LEAST_GROUPS = 10
"""Fewest groups of points that mirror each other [1]; fewer say less than as many points without symmetry."""
ALIKE = 9
"""Decimals to which numbers near 1 of mirrored nodes agree."""
_RATIOS = 1.1673039782614187 ** -np.arange(1.0, 5.0)
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
    group = _mirrored(shape)
    if np.max(np.bincount(group)) * LEAST_GROUPS > count:
        group = np.arange(shape.share.size)
    size, share = np.bincount(group), _sums(group, shape.share)
    root = np.sqrt(share)
    steep = max(float(np.max(np.abs(shape.tilt))), 1.0)
    sums = balanced(*_scaled(shape), shape.equal, shape.tilt / steep)
    exact = independent(root * _means(sums, shape, group), share.size)[1]
    rest = root * _means(_functions(shape), shape, group)
    rest -= np.einsum("mk,kn->mn", np.einsum("mn,kn->mk", rest, exact), exact)
    kept = np.concatenate([exact, independent(rest, count)[1]]).T / root[:, None]
    held = _held(shape, group, share) if count >= HOLDING else np.zeros_like(share)
    weights, number = share, kept.shape[1]
    while number >= len(exact):
        free = np.flatnonzero(weights > held)
        left = eliminated(kept[free, :number], (weights - held)[free])
        weights = held.copy()
        weights[free] += left
        excess = int(np.sum(size[weights > 0.0])) - count
        if excess <= 0:
            return _part(shape, group, _corrected(weights, share, kept[:, : len(exact)]) / share)
        number = min(number, int(np.sum(left > 0.0))) - max(excess // (2 * int(np.max(size))), 1)
    raise ValueError(f"{count} points are too few, expected at least {count + excess} for this contact")


def _held(shape: PressureShape, group: Nodes, share: Array) -> Array:
    """What groups keep of their shares [1] at least."""
    held, highest = np.zeros_like(share), np.unique(group[_highest(shape)])
    held[highest] = RESERVED * share[highest]
    return held


def _part(shape: PressureShape, group: Nodes, factor: Array) -> PressureShape:
    """Nodes with their shares times the factor of their group, without those that have none left."""
    nodes = np.flatnonzero(factor[group] > 0.0)
    some = shape.part(nodes)
    return PressureShape(some.share * factor[group[nodes]], some.position, some.equal, some.tilt)


def _corrected(weights: Array, share: Array, exact: Array) -> Array:
    """The weights with the exact sums put right, by changes in proportion to them."""
    missing = (share - weights) @ exact
    return np.asarray(weights * (1.0 + exact @ np.linalg.solve((exact.T * weights) @ exact, missing)))


def _mirrored(shape: PressureShape) -> Nodes:
    """Groups (n) of nodes that mirror each other at x = 0, at y = 0, where tilt changes its sign, or both."""
    x, y = shape.position.T / np.max(np.abs(shape.position))
    steep = max(float(np.max(np.abs(shape.tilt))), 1.0)
    share, equal, tilt = shape.share * shape.share.size, shape.equal, shape.tilt / steep

    def keys(along: float, across: float) -> Array:
        numbers = np.column_stack([along * x, across * y, share, equal, across * tilt])
        return np.asarray(np.floor(numbers * 10.0**ALIKE + np.sqrt(0.5)))

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


def largest_moment(shape: PressureShape) -> float:
    """Factor of tilt [1] at which nodes are open that carried the part OPENED of the force of equal."""
    low, high = 0.0, 2.0 / float(np.max(np.abs(shape.share * shape.tilt)))
    for _ in range(50):
        middle = 0.5 * (low + high)
        lost = max(
            float(shape.share @ np.maximum(side * middle * shape.tilt - shape.equal, 0.0)) for side in (-1, 1)
        )
        low, high = (middle, high) if lost < OPENED else (low, middle)
    return low


def _functions(shape: PressureShape) -> Array:
    """(m, n) functions at states of the joint: pressure and stiffness of power laws, their moments.

    Those of the pressure are of the normal force and, with the distance from the centre, of the friction in
    a turn about the normal; of the stiffness they are the first and second ones.
    """
    (x, y), limit = _scaled(shape), largest_moment(shape)
    distance = np.hypot(*shape.position.T)
    of_pressure = np.stack([np.ones_like(x), x, y, distance / np.max(distance)])
    of_stiffness = np.stack([*of_pressure[:3], x * x, x * y, y * y])
    even = 2.0 * ((0.5 + np.arange(1, STATES + 1)[:, None] * _RATIOS) % 1.0) - 1.0
    rows = []
    for number, (moment, apart, about_x, about_y) in enumerate(even):
        exponent = EXPONENTS[number % len(EXPONENTS)]
        still = number < UNTILTED * STATES
        away = 0.0 * x if still else APART * apart + TILTED * (about_x * y - about_y * x)
        start = np.maximum(shape.equal + limit * moment * shape.tilt, 0.0)
        pressure, stiffness = _power_law(start, away, exponent)
        values = np.concatenate([pressure * of_pressure, stiffness * of_stiffness])
        values /= np.maximum(np.abs(values) @ shape.share, np.finfo(float).tiny)[:, None]
        rows.append(values if still else LESS * values)
    return np.concatenate(rows)


def _power_law(start: Array, away: Array, exponent: float) -> tuple[Array, Array]:
    """p and k ~ p^exponent of nodes that had the pressure `start` and moved apart, or together, by `away`."""
    if exponent == 1.0:
        p = start * np.exp(-STEEP / APART * away)
        return p, p
    approach = start ** (1.0 - exponent)
    p = np.maximum(approach - np.max(approach) * away, 0.0) ** (1.0 / (1.0 - exponent))
    return p, p**exponent


def _highest(shape: PressureShape) -> Nodes:
    """Nodes that have the largest pressure at some moment."""
    steep = np.concatenate([-np.geomspace(30.0, 0.01, 40), [0.0], np.geomspace(0.01, 30.0, 40)])
    return np.unique([int(np.argmax(shape.equal + m * shape.tilt)) for m in steep])
