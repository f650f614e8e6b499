"""Newton's method for elastic bodies in contact through a nonlinear interface."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, cg

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .elasticity import CholeskyFactor

RELATIVE_TOLERANCE = 1e-11
"""Residual force over applied load [1], both as sums of magnitudes, at which Newton's method converges."""
MAX_NEWTON_STEPS = 60
"""Largest number of steps of Newton's method [1]."""
MIN_LINEAR_OVER_NEWTON_TOLERANCE = 0.1
"""Tightest tolerance of the linear solver over the tolerance of Newton's method [1]."""
MAX_CG_ITERATIONS = 12
"""Number of conjugate-gradient iterations above which the tangent is factorised anew."""


@dataclass(frozen=True)
class EnergyMinimum:
    """Minimum of the energy of bodies in contact.

    displacement   : u (n) [m]
    approach       : (q) [m] at the quadrature points
    newton_steps   : number of steps of Newton's method
    tangent_factor : Cholesky factor of the tangent of an earlier step, used as preconditioner
    """

    displacement: Array
    approach: Array
    newton_steps: int
    tangent_factor: CholeskyFactor | None


@dataclass(frozen=True)
class ContactEnergy:
    """Energy [J] of bodies in contact, convex in the displacement u (n) [m] of the unknowns:

        u K u / 2 - f u + sum over the quadrature points of area times V(offset + T u).

    V [J/m2] is the energy of the interface per area; its derivative is the pressure p. The offset (q) [m] is
    the approach without displacement.

    stiffness_matrix                : K (n, n) [N/m]
    load_vector                     : f (n) [N]
    displacement_to_approach_matrix : T (q, n) [1] approach at the quadrature points per displacement
    quadrature_area                 : area (q) [m2] of each quadrature point
    pressure_law                    : function of the approach (q) [m]: pressure [Pa], its derivative [Pa/m]
    """

    stiffness_matrix: sp.csr_matrix
    load_vector: Array
    displacement_to_approach_matrix: sp.csr_matrix
    quadrature_area: Array
    pressure_law: Callable[[Array], list[Array]]

    def minimise_energy(
        self, approach_offset: Array, initial_minimum: EnergyMinimum | None = None
    ) -> EnergyMinimum:
        """Find the minimum of the energy by Newton's method.

        approach_offset : (q) [m] approach at zero displacement
        initial_minimum : minimum of the same energy under another load, to start from; None: start at zero
                      displacement

        The tangent is factorised in the first step. Later steps use conjugate gradients with this factor as
        preconditioner. If they need more than MAX_CG_ITERATIONS, the tangent is factorised anew.

        Raises RuntimeError if there is no equilibrium.
        """
        K, T = self.stiffness_matrix, self.displacement_to_approach_matrix
        u = np.zeros(self.load_vector.size) if initial_minimum is None else initial_minimum.displacement
        inner, approach = K @ u, approach_offset + T @ u
        total_load = float(np.abs(self.load_vector).sum())
        factor = None if initial_minimum is None else initial_minimum.tangent_factor
        slow = False
        last_residual = np.inf
        for step in track_progress(range(MAX_NEWTON_STEPS), "contact"):
            p, k = self.pressure_law(approach)[:2]
            residual = self.load_vector - inner - T.T @ (self.quadrature_area * p)
            size = float(np.abs(residual).sum()) / total_load
            if size <= RELATIVE_TOLERANCE or (
                size <= 1e3 * RELATIVE_TOLERANCE and size > 0.5 * last_residual
            ):
                return EnergyMinimum(u, approach, step, factor)
            last_residual = size
            spring = self.quadrature_area * k
            if factor is None or slow:
                factor = CholeskyFactor(K + T.T @ sp.diags_array(spring) @ T)
            accuracy = min(1e-2, max(size, MIN_LINEAR_OVER_NEWTON_TOLERANCE * RELATIVE_TOLERANCE / size))
            tangent = LinearOperator(K.shape, partial(self._apply_tangent, spring), dtype=np.float64)
            move, count = _solve_cg(tangent, residual, factor, accuracy)
            slow = count > MAX_CG_ITERATIONS
            change, load_change = T @ move, K @ move
            linear, quadratic = float(move @ (inner - self.load_vector)), float(move @ load_change)
            length = self._step_length(approach, change, linear, quadratic)
            u, inner, approach = u + length * move, inner + length * load_change, approach + length * change
        raise RuntimeError(
            f"the contact has not settled after {MAX_NEWTON_STEPS} steps (residual "
            f"{last_residual:.2g} of the "
            "load): the loads may not balance"
        )

    def _apply_tangent(self, contact_stiffness: Array, displacement: Array) -> Array:
        """Multiply the tangent stiffness of bodies and contact by a vector u: (K + T^T diag(k) T) u.

        K (n, n) stiffness of the bodies [N/m], T (q, n) approach per displacement [1], k (q) contact
        stiffness [N/m].
        """
        return np.asarray(
            self.stiffness_matrix @ displacement
            + self.displacement_to_approach_matrix.T
            @ (contact_stiffness * (self.displacement_to_approach_matrix @ displacement))
        )

    def _step_length(
        self, approach: Array, approach_change: Array, initial_slope: float, slope_rate: float
    ) -> float:
        """Exact line search: step length <= 1 at which the slope of the energy along the step vanishes.

        A full step is taken if its final slope is at most a tenth of the initial one.

        approach                  : (q) [m], at the start of the step
        approach_change           : (q) [m] of the approach by the full step
        initial_slope, slope_rate : [J] of elastic energy minus work of the loads: its slope at the step
                                    length s is initial_slope + s slope_rate
        """

        def energy_slope(step_length: float) -> float:
            """Derivative [J] of the energy with respect to the step length [1]."""
            p = self.pressure_law(approach + step_length * approach_change)[0]
            return (
                initial_slope + step_length * slope_rate + float(approach_change @ (self.quadrature_area * p))
            )

        from scipy.optimize import brentq  # slow to import, and a linear joint needs no search

        start = energy_slope(0.0)
        if start >= 0.0 or energy_slope(1.0) <= -0.1 * start:
            return 1.0
        return float(brentq(energy_slope, 0.0, 1.0, xtol=1e-3))


def _solve_cg(
    system_matrix: LinearOperator,
    right_side: Array,
    preconditioner: CholeskyFactor,
    relative_tolerance: float,
) -> tuple[Array, int]:
    """Solve a linear system by preconditioned conjugate gradients to a relative tolerance.

    Returns the solution and the number of iterations.
    """
    count = 0

    def count_iteration(_: Array) -> None:
        """Count one iteration of the conjugate-gradient solver in `count`; its argument is not used."""
        nonlocal count
        count += 1

    inverse = LinearOperator(system_matrix.shape, matvec=preconditioner.solve_linear_system, dtype=np.float64)
    solution, _ = cg(
        system_matrix,
        right_side,
        rtol=relative_tolerance,
        atol=0.0,
        maxiter=200,
        M=inverse,
        callback=count_iteration,
    )
    return solution, count
