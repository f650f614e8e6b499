"""Reduction of weighted nodes to a subset with the same sums (Caratheodory's theorem).

For n nodes with weights >= 0 and d values each, there are d nodes with other weights >= 0 that have the same
d weighted sums. The algorithm keeps a basis of d nodes and adds the other nodes one by one. The weight of a
node is transferred to the basis. If a weight in the basis becomes zero, both nodes are exchanged, as in the
simplex method. All decisions are the same on every processor (`reproducible`).
"""

import numpy as np
from numpy.typing import NDArray

from ...quantity import Array
from .reproducible import euclidean_norm, linear_combination, matrix_product, weighted_sums

NodeIndices = NDArray[np.intp]

LINEAR_DEPENDENCE_TOLERANCE = 1e-11
"""Norm over the largest norm [1] below which the remainder of a vector counts as linearly dependent."""
SUM_CORRECTION_DEPENDENCE_TOLERANCE = 1e-7
"""Norm over the largest norm [1] for linear dependence in the correction of sums; far above round-off."""


def reduce_weights(node_values: Array, node_weights: Array) -> Array:
    """Reduce the weights (n) of nodes to at most d nonzero weights, with the same d weighted sums.

    node_values  : (n, d) values that are summed
    node_weights : (n) >= 0
    """
    basis, orthonormal = select_independent(node_values, node_values.shape[1])
    rows = matrix_product(node_values, orthonormal)
    inverse = _invert_triangle(rows[basis])
    basis_weights, out = node_weights[basis], np.zeros_like(node_weights)
    for node in np.setdiff1d(np.arange(len(node_values)), basis):
        share = linear_combination(rows[node], inverse)
        leaving, transfer = _find_leaving_node(share, basis_weights, node_weights[node])
        basis_weights = np.maximum(basis_weights + transfer * share, 0.0)
        if leaving is None:
            continue
        basis_weights[leaving], basis[leaving] = node_weights[node] - transfer, node
        column = inverse[:, leaving] / share[leaving]
        inverse -= column[:, None] * share
        inverse[:, leaving] = column
    out[basis] = basis_weights
    return out


def select_independent(
    candidate_vectors: Array, max_vector_count: int, dependence_tolerance: float = LINEAR_DEPENDENCE_TOLERANCE
) -> tuple[NodeIndices, Array]:
    """Select linearly independent ones of n vectors (n, d) by pivoted Gram-Schmidt orthogonalisation.

    The orthogonalisation is applied twice.
    max_vector_count : largest number of vectors to select
    dependence_tolerance : [1] norm of the remainder over the largest norm below which a vector is dependent

    Returns their indices (r), in the order of the size of their remainder, and an orthonormal basis (r, d).
    """
    remainder, basis, indices = (
        candidate_vectors.copy(),
        np.empty((0, candidate_vectors.shape[1])),
        np.empty(0, np.intp),
    )
    square = np.add.reduce(remainder * remainder, axis=1)
    end = dependence_tolerance * dependence_tolerance * np.max(square)
    while indices.size < max_vector_count and np.max(square) > end:
        pivot = int(np.argmax(square))
        axis = remainder[pivot] / np.sqrt(square[pivot])
        axis -= linear_combination(weighted_sums(basis, axis), basis)
        axis /= euclidean_norm(axis)
        remainder -= weighted_sums(remainder, axis)[:, None] * axis
        square = np.add.reduce(remainder * remainder, axis=1)
        basis, indices = np.concatenate([basis, axis[None]]), np.append(indices, pivot)
    return indices, basis


def solve_linear_system(positive_definite_matrix: Array, right_hand_side: Array) -> Array:
    """Solve a linear system with a positive definite matrix (n, n) by Gaussian elimination.

    Returns the solution (n); the order of all operations is fixed.
    """
    rows, out = np.column_stack([positive_definite_matrix, right_hand_side]), np.zeros_like(right_hand_side)
    for k in range(len(out) - 1):
        rows[k + 1 :, k:] -= (rows[k + 1 :, k] / rows[k, k])[:, None] * rows[k, k:]
    for k in range(len(out))[::-1]:
        out[k] = (rows[k, -1] - np.add.reduce(rows[k, k:-1] * out[k:])) / rows[k, k]
    return out


def find_smallest_weight_changes(
    node_weights: Array, function_values: Array, required_sum_changes: Array
) -> Array:
    """Smallest changes (n) of weights that give required changes (m) of weighted sums of functions (m, n).

    The sum of change^2/|weight| is minimal. Functions that depend linearly on others are ignored.
    """
    root = np.sqrt(np.abs(node_weights))
    rows = function_values * root
    places, base = select_independent(rows, len(rows), SUM_CORRECTION_DEPENDENCE_TOLERANCE)
    factors = weighted_sums(
        _invert_triangle(matrix_product(rows[places], base)), required_sum_changes[places]
    )
    return np.asarray(root * linear_combination(factors, base))


def _invert_triangle(lower_triangle: Array) -> Array:
    """Inverse of a lower triangular matrix (r, r)."""
    out = np.zeros_like(lower_triangle)
    for i, row in enumerate(lower_triangle):
        out[i, :i] = -linear_combination(row[:i], out[:i, :i])
        out[i, i] = 1.0
        out[i] /= row[i]
    return out


def _find_leaving_node(
    weight_change_rates: Array, basis_weights: Array, new_node_weight: float
) -> tuple[int | None, float]:
    """Ratio test of the simplex method: node that leaves the basis, and weight moved to it from a new node.

    The node is returned as its index in the basis.

    weight_change_rates : change of the basis weights per unit of transferred weight [1]
    basis_weights       : weights of the basis nodes
    new_node_weight     : weight of the new node

    The index is None if the basis can take the whole weight. A negative transfer moves weight from the basis
    to the new node.
    """
    ratio = np.divide(
        basis_weights,
        np.abs(weight_change_rates),
        out=np.full_like(basis_weights, np.inf),
        where=weight_change_rates != 0.0,
    )
    decreasing = int(np.argmin(np.where(weight_change_rates < 0.0, ratio, np.inf)))
    if weight_change_rates[decreasing] >= 0.0 or ratio[decreasing] >= new_node_weight:
        return None, new_node_weight
    increasing = int(np.argmin(np.where(weight_change_rates > 0.0, ratio, np.inf)))
    if weight_change_rates[increasing] > -weight_change_rates[decreasing]:  # larger pivot: less round-off
        return increasing, -float(ratio[increasing])
    return decreasing, float(ratio[decreasing])
