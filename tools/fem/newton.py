"""Newton's method for elastic bodies on a nonlinear interface."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy.sparse as sp
from scipy.optimize import brentq
from scipy.sparse.linalg import LinearOperator, cg

from jointfmu.progress import track
from jointfmu.quantity import Array

from .elasticity import Cholesky

TOLERANCE = 1e-11
"""Residual force over the force of the loads [1], as sums of magnitudes, at which Newton's method ends."""
MOST_STEPS = 60
ENOUGH = 0.1
"""Part of TOLERANCE [1] that a system is solved to at most."""
PATIENCE = 12
"""Steps of the conjugate gradients after which the factor is renewed."""


@dataclass(frozen=True)
class Minimum:
    """Where an energy is least.

    displacement : u (n); `approach` (q) [m]
    steps        : of Newton's method
    factor       : of a tangent on the way
    """

    displacement: Array
    approach: Array
    steps: int
    factor: Cholesky | None


@dataclass(frozen=True)
class Energy:
    """u K u / 2 - f u + sum weight V(offset + T u) with V' = p, convex in u (n).

    stiffness : K [N/m]
    load      : f (n) [N]
    trace     : T (q, n) [1]
    weight    : (q) [m2]
    law       : approach (q) [m] -> pressure [Pa] and its derivative [Pa/m]
    """

    stiffness: sp.csr_matrix
    load: Array
    trace: sp.csr_matrix
    weight: Array
    law: Callable[[Array], list[Array]]

    def minimise(self, offset: Array, near: Minimum | None = None) -> Minimum:
        """The minimum, found from u = 0 or from that of the same energy under another load.

        The tangent is factorised at the start; the systems of the later steps are solved by conjugate
        gradients with this factor, renewed when they need more than PATIENCE steps.

        Raises RuntimeError if there is no equilibrium.
        """
        K, T = self.stiffness, self.trace
        u = np.zeros(self.load.size) if near is None else near.displacement
        inner, approach = K @ u, offset + T @ u
        scale = float(np.abs(self.load).sum())
        factor, slow, last = None if near is None else near.factor, False, np.inf
        for step in track(range(MOST_STEPS), "contact"):
            p, k = self.law(approach)[:2]
            residual = self.load - inner - T.T @ (self.weight * p)
            size = float(np.abs(residual).sum()) / scale
            if size <= TOLERANCE or (size <= 1e3 * TOLERANCE and size > 0.5 * last):
                return Minimum(u, approach, step, factor)
            last = size
            spring = self.weight * k
            if factor is None or slow:
                factor = Cholesky(K + T.T @ sp.diags_array(spring) @ T)
            accuracy = min(1e-2, max(size, ENOUGH * TOLERANCE / size))
            tangent = LinearOperator(K.shape, partial(self._tangent, spring), dtype=np.float64)
            move, count = _solve(tangent, residual, factor, accuracy)
            slow = count > PATIENCE
            change, push = T @ move, K @ move
            length = self._length(approach, change, float(move @ (inner - self.load)), float(move @ push))
            u, inner, approach = u + length * move, inner + length * push, approach + length * change
        raise RuntimeError(
            f"the contact has not settled after {MOST_STEPS} steps (residual {last:.2g} of the load): "
            "the loads may not balance"
        )

    def _tangent(self, spring: Array, u: Array) -> Array:
        """(K + T' spring T) u, with the contact's stiffness (q) [N/m]."""
        return np.asarray(self.stiffness @ u + self.trace.T @ (spring * (self.trace @ u)))

    def _length(self, approach: Array, change: Array, linear: float, square: float) -> float:
        """Length of the step, at most 1: where the energy's slope along it vanishes, to a tenth."""

        def slope(length: float) -> float:
            p = self.law(approach + length * change)[0]
            return linear + length * square + float(change @ (self.weight * p))

        start = slope(0.0)
        if start >= 0.0 or slope(1.0) <= -0.1 * start:
            return 1.0
        return float(brentq(slope, 0.0, 1.0, xtol=1e-3))


def _solve(matrix: LinearOperator, right: Array, factor: Cholesky, accuracy: float) -> tuple[Array, int]:
    """Solution of a system to a relative accuracy, and the steps it took."""
    count = 0

    def counted(_: Array) -> None:
        nonlocal count
        count += 1

    inverse = LinearOperator(matrix.shape, matvec=factor.solve, dtype=np.float64)
    solution, _ = cg(matrix, right, rtol=accuracy, atol=0.0, maxiter=200, M=inverse, callback=counted)
    return solution, count
