"""Few of many weighted nodes that keep sums: Caratheodory's theorem, node by node.

Of n nodes with weights >= 0 and d values each, some d with other weights >= 0 have the same d sums. The
weight of a node goes over to d others that span the values, until one of these has none left and gives its
place away: the steps of the simplex method. Its choices are the same on every processor (`reproducible`).
"""

import numpy as np
from numpy.typing import NDArray

from ...quantity import Array
from .reproducible import combined, length, over, product

Nodes = NDArray[np.intp]

LEAST = 1e-11
"""Size over the largest one [1] below which a vector depends on others."""
DEPENDENT = 1e-7
"""The same [1] for sums that are put right, far above what rounding leaves of a vector that depends."""


def eliminated(values: Array, weights: Array) -> Array:
    """Weights (n), at most d above zero, with which values (n, d) have the sums of weights (n) >= 0."""
    places, base = independent(values, values.shape[1])
    rows = product(values, base)
    inverse = _inverse(rows[places])
    held, out = weights[places], np.zeros_like(weights)
    for node in np.setdiff1d(np.arange(len(values)), places):
        share = combined(rows[node], inverse)
        place, taken = _leaving(share, held, weights[node])
        held = np.maximum(held + taken * share, 0.0)
        if place is None:
            continue
        held[place], places[place] = weights[node] - taken, node
        column = inverse[:, place] / share[place]
        inverse -= column[:, None] * share
        inverse[:, place] = column
    out[places] = held
    return out


def independent(vectors: Array, most: int, least: float = LEAST) -> tuple[Nodes, Array]:
    """Which of vectors (n, d) say what others do not, the most telling first, and their orthonormal base.

    Gram and Schmidt's process with pivots, twice. The base is (r, d), r <= most.
    """
    rest, base, places = vectors.copy(), np.empty((0, vectors.shape[1])), np.empty(0, np.intp)
    square = np.add.reduce(rest * rest, axis=1)
    end = least * least * np.max(square)
    while places.size < most and np.max(square) > end:
        place = int(np.argmax(square))
        axis = rest[place] / np.sqrt(square[place])
        axis -= combined(over(base, axis), base)
        axis /= length(axis)
        rest -= over(rest, axis)[:, None] * axis
        square = np.add.reduce(rest * rest, axis=1)
        base, places = np.concatenate([base, axis[None]]), np.append(places, place)
    return places, base


def solved(matrix: Array, right: Array) -> Array:
    """Solution (n) of equations with a positive definite matrix (n, n), by Gauss's elimination."""
    rows, out = np.column_stack([matrix, right]), np.zeros_like(right)
    for k in range(len(out) - 1):
        rows[k + 1 :, k:] -= (rows[k + 1 :, k] / rows[k, k])[:, None] * rows[k, k:]
    for k in range(len(out))[::-1]:
        out[k] = (rows[k, -1] - np.add.reduce(rows[k, k:-1] * out[k:])) / rows[k, k]
    return out


def changes(weights: Array, functions: Array, missing: Array) -> Array:
    """What weights (n) change by so that their sums of functions (m, n) change by `missing` (m).

    Changes are in proportion to the weights, and the smallest over their roots. Functions that depend on
    others have no say.
    """
    root = np.sqrt(np.abs(weights))
    rows = functions * root
    places, base = independent(rows, len(rows), DEPENDENT)
    factors = over(_inverse(product(rows[places], base)), missing[places])
    return np.asarray(root * combined(factors, base))


def _inverse(triangle: Array) -> Array:
    """Inverse of a lower triangular matrix (r, r)."""
    out = np.zeros_like(triangle)
    for i, row in enumerate(triangle):
        out[i, :i] = -combined(row[:i], out[:i, :i])
        out[i, i] = 1.0
        out[i] /= row[i]
    return out


def _leaving(share: Array, held: Array, weight: float) -> tuple[int | None, float]:
    """Which place gets empty, and the weight [1] that the others take over until then (negative: give away).

    share  : what the places get of a weight of 1
    held   : weights at the places
    weight : of the node; None if the places take all of it
    """
    over = np.divide(held, np.abs(share), out=np.full_like(held, np.inf), where=share != 0.0)
    first = int(np.argmin(np.where(share < 0.0, over, np.inf)))
    if share[first] >= 0.0 or over[first] >= weight:
        return None, weight
    last = int(np.argmin(np.where(share > 0.0, over, np.inf)))
    if share[last] > -share[first]:  # the steeper of the two: less rounding
        return last, -float(over[last])
    return first, float(over[first])
