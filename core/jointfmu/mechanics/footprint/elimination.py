"""Few of many weighted nodes that keep sums: Caratheodory's theorem, node by node.

Of n nodes with weights >= 0 and d values each, some d with other weights >= 0 have the same d sums. The
weight of a node goes over to d others that span the values, until one of these has none left and gives its
place away: the steps of the simplex method. Products are einsum's: the same bits for any number of threads.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Nodes = NDArray[np.intp]

LEAST = 1e-11
"""Size over the largest one [1] below which a vector depends on others."""


def eliminated(values: Array, weights: Array) -> Array:
    """Weights (n), at most d above zero, with which values (n, d) have the sums of weights (n) >= 0."""
    places, base = independent(values, values.shape[1])
    rows = np.einsum("nd,kd->nk", values, base)
    inverse = _inverse(rows[places])
    held, out = weights[places], np.zeros_like(weights)
    for node in np.setdiff1d(np.arange(len(values)), places):
        share = np.einsum("kl,k->l", inverse, rows[node])
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


def independent(vectors: Array, most: int) -> tuple[Nodes, Array]:
    """Which of vectors (n, d) say what others do not, the most telling first, and their orthonormal base.

    Gram and Schmidt's process with pivots, twice. The base is (r, d), r <= most.
    """
    rest, base, places = vectors.copy(), np.empty((0, vectors.shape[1])), np.empty(0, np.intp)
    square = np.einsum("nd,nd->n", rest, rest)
    least = LEAST**2 * np.max(square)
    while places.size < most and np.max(square) > least:
        place = int(np.argmax(square))
        axis = rest[place] / np.sqrt(square[place])
        axis -= np.einsum("kd,k->d", base, np.einsum("kd,d->k", base, axis))
        axis /= np.sqrt(np.einsum("d,d->", axis, axis))
        rest -= np.einsum("nd,d->n", rest, axis)[:, None] * axis
        square = np.einsum("nd,nd->n", rest, rest)
        base, places = np.concatenate([base, axis[None]]), np.append(places, place)
    return places, base


def solved(matrix: Array, right: Array) -> Array:
    """Solution (n) of equations with a positive definite matrix (n, n), by Gauss's elimination."""
    rows, out = np.column_stack([matrix, right]), np.zeros_like(right)
    for k in range(len(out) - 1):
        rows[k + 1 :, k:] -= (rows[k + 1 :, k] / rows[k, k])[:, None] * rows[k, k:]
    for k in range(len(out))[::-1]:
        out[k] = (rows[k, -1] - np.einsum("i,i->", rows[k, k:-1], out[k:])) / rows[k, k]
    return out


def _inverse(triangle: Array) -> Array:
    """Inverse of a lower triangular matrix (r, r)."""
    out = np.zeros_like(triangle)
    for i, row in enumerate(triangle):
        out[i, :i] = -np.einsum("k,kl->l", row[:i], out[:i, :i])
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
