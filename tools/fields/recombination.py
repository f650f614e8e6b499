"""Few of many weighted nodes that keep sums (Tchakaloff; Litterer and Lyons 2012).

Of many weighted vectors with d components, some d with other positive weights have the same sum; non-negative
least squares finds them. With many nodes groups of them stand for vectors, and half of all nodes go at once.
"""

from itertools import pairwise

import numpy as np
from scipy.optimize import nnls

from jointfmu.quantity import Array

from .nodal_result import Nodes

GROUPS = 2
"""Groups over kept sums [1]."""


def recombined(values: Array, weights: Array, turn: Array) -> tuple[Nodes, Array]:
    """Nodes and their weights (at most d), with which values (n, d) have the sums that weights (n) > 0 give.

    turn : (d, d) makes the d values independent

    Raises RuntimeError if rounding stands in the way.
    """
    left, count = np.arange(len(values)), values.shape[1]
    while left.size > count:
        groups = np.linspace(0, left.size, min(GROUPS * count, left.size) + 1).astype(np.intp)
        sums = [weights[a:b] @ values[a:b] for a, b in pairwise(groups)]
        vectors = (np.array(sums) @ turn).T
        factors, _ = nnls(vectors, np.sum(vectors, axis=1), maxiter=20 * count)
        of_node = np.repeat(factors, np.diff(groups))
        stays = of_node > 0.0
        left, weights, values = left[stays], (weights * of_node)[stays], values[stays]
    return left, weights
