"""Springs and dashpots between node pairs, what solvers for finite elements get of a joint."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array


@dataclass(frozen=True, slots=True)
class Springs:
    """Springs and dashpots of the closed node pairs; x and y lie in the joint's plane, z is its normal.

    nodes      : (n, 2) labels on side 1 and side 2
    position   : (n, 2) [m] from the centroid of the contact
    area       : (n)    [m2]
    pressure   : (n)    [Pa]
    K_n, K_t   : (n)    [N/m] along z; along x and along y
    C_n, C_t   : (n)    [N.s/m] the same
    sums       : what the joint has, and what the pairs add up to: K_ [N/m], C_ [N.s/m]
    correction : [1] factor by which the pairs' stiffness was multiplied to add up to the joint's
    opened     : pairs that are open and left out
    """

    nodes: NDArray[np.int64]
    position: Array
    area: Array
    pressure: Array
    K_n: Array
    K_t: Array
    C_n: Array
    C_t: Array
    sums: dict[str, float]
    correction: float
    opened: int
