"""Check that bodies in contact have an equilibrium: loads, supports and contact forces on rigid-body motions.

The stiffness matrix of an unsupported body is singular. Whether its factorisation fails depends on round-off.
The check on rigid-body motions has numbers of order 1 instead. A frictionless contact can only push: it
balances the loads if they are a sum, with weights >= 0, of unit pressures. The approach of rigid bodies is
linear in the position, so pressures at the corners of the contact's convex hull are enough (a linear
programme).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import block_diag, null_space, qr
from scipy.spatial import ConvexHull

from jointfmu.quantity import Array

from .elasticity import ElasticBody, IndexArray

MAX_RELATIVE_IMBALANCE = 1e-6
"""Largest unbalanced force over the sum of the loads' magnitudes [1].

Newton's method ends at 1e-8 or less, a factorisation leaves 1e-9. Loads without an equilibrium leave a value
of order 1.
"""
MIN_RESTRAINED_OVER_BODY_MOTION = 1e-6
"""Smallest ratio [1] at which supports or contact restrain a rigid-body motion: rms displacement at the
supports, or rms approach, over the rms displacement of the body. Round-off gives 1e-15; supports at the
corners of a body, and its contact, give values of order 1."""


@dataclass(frozen=True)
class RigidBodyBalance:
    """Generalised forces of loads and contact on the rigid-body motions (each of rms displacement 1 m).

    Shapes: q quadrature points, m motions that only the contact can stop, k motions that no support stops.

    generalised_load            : (m) [N] of the loads on the motions that only the contact can stop
    rigid_motion_approach       : (q, m) [1] approach at the quadrature points for these motions
    unsupported_motion_approach : (q, k) [1] approach for the motions that no support stops in the computation
    total_load                  : [N] sum of the loads' magnitudes
    contact_hull_points         : indices of the quadrature points on the convex hull of the contact
    """

    generalised_load: Array
    rigid_motion_approach: Array
    unsupported_motion_approach: Array
    total_load: float
    contact_hull_points: IndexArray

    @classmethod
    def from_loads(
        cls,
        bodies: Sequence[ElasticBody],
        approach_matrices: Sequence[sp.csr_matrix],
        nodal_loads: Sequence[Array],
        supported_unknowns: Sequence[IndexArray],
        quadrature_position: Array,
        *,
        supports_carry_load: bool,
    ) -> "RigidBodyBalance":
        """Evaluate the generalised forces of loads (n) [N] on each body, for n unknowns of the body.

        approach_matrices   : matrices (q, n) [1]: approach at the quadrature points per displacement of each
                              body
        supported_unknowns  : unknowns of each body that stay zero
        quadrature_position : (q, 2) [m] of the quadrature points
        supports_carry_load : True: supports may carry load. False: they only stop motions that are not loaded
        """
        motions = [rigid_motions(body) for body in bodies]
        force = np.concatenate([m.T @ load for m, load in zip(motions, nodal_loads, strict=True)])
        rigid_approach = np.hstack([trace @ m for m, trace in zip(motions, approach_matrices, strict=True)])
        at_supports = [m[rows] for m, rows in zip(motions, supported_unknowns, strict=True)]
        unsupported = block_diag(
            *[
                null_space(rows, rcond=MIN_RESTRAINED_OVER_BODY_MOTION) if rows.size else np.eye(6)
                for rows in at_supports
            ]
        )
        balanced = unsupported if supports_carry_load else np.eye(force.size)
        scale = sum(float(np.abs(load).sum()) for load in nodal_loads)
        corners = np.asarray(ConvexHull(quadrature_position).vertices, dtype=np.int64)
        return cls(
            balanced.T @ force, rigid_approach @ balanced, rigid_approach @ unsupported, scale, corners
        )

    def check_loads(self) -> None:
        """Raise RuntimeError if contact without tension cannot balance the loads, or no load presses it."""
        if not _has_independent_columns(self.unsupported_motion_approach):
            raise RuntimeError("a body can move rigidly: supports and contact do not hold it")
        if self.generalised_load.size == 0:
            return
        if not self.total_load > 0.0:
            raise RuntimeError("no load presses the contact closed: all loads are 0 N")
        contact_force, imbalance = self._optimise_contact_forces()
        if imbalance > MAX_RELATIVE_IMBALANCE:
            raise RuntimeError(
                "a contact without friction and tension cannot balance the loads: a fraction of "
                f"{imbalance:.2g} is left over, allowed is {MAX_RELATIVE_IMBALANCE:g}; expected a resultant "
                "that presses inside the contact"
            )
        if contact_force <= MAX_RELATIVE_IMBALANCE:
            raise RuntimeError(
                f"no load presses the contact closed: its force is {contact_force:.2g} of the loads, needed "
                f"is more than {MAX_RELATIVE_IMBALANCE:g}"
            )

    def check_contact_forces(self, contact_forces: Array) -> None:
        """Raise RuntimeError if contact forces (q) [N] >= 0 do not balance the loads or leave a body free."""
        if not _has_independent_columns(self.unsupported_motion_approach[contact_forces > 0.0]):
            raise RuntimeError(
                "the contact does not hold the bodies: it stays closed at "
                f"{np.count_nonzero(contact_forces)} of {contact_forces.size} points; increase the preload "
                "or reduce the moment"
            )
        imbalance = float(np.abs(self.generalised_load - self.rigid_motion_approach.T @ contact_forces).sum())
        if not imbalance <= MAX_RELATIVE_IMBALANCE * self.total_load:
            raise RuntimeError(
                f"the contact is not in equilibrium: it leaves {imbalance / self.total_load:.2g} times the "
                f"loads unbalanced, allowed is {MAX_RELATIVE_IMBALANCE:g}; try another --refinement"
            )

    def _optimise_contact_forces(self) -> tuple[float, float]:
        """Find forces >= 0 at the corners of the contact that balance the loads best (linear programme).

        Returns the sum of these forces and the remaining imbalance, both over the total load [1].
        """
        corner_approach = self.rigid_motion_approach[self.contact_hull_points].T
        slack = np.eye(self.generalised_load.size)
        cost = np.concatenate(
            [np.zeros(self.contact_hull_points.size), np.ones(2 * self.generalised_load.size)]
        )
        from scipy.optimize import linprog  # slow to import, and a linear joint needs no balance

        best = linprog(
            cost,
            A_eq=np.hstack([corner_approach, slack, -slack]),
            b_eq=self.generalised_load / self.total_load,
        )
        if best.status != 0:
            raise RuntimeError(
                f"the equilibrium of the loads was not found, try another --refinement: {best.message}"
            )
        return float(best.x[: self.contact_hull_points.size].sum()), float(best.fun)


def rigid_motions(body: ElasticBody) -> Array:
    """Six orthogonal rigid-body motions (n, 6) of a body, each of rms displacement 1 m at its nodes."""
    motions: Array = qr(body.rigid_body_motions(), mode="economic")[0]
    return np.asarray(motions * np.sqrt(body.unknown_count / 3.0))


def _has_independent_columns(rigid_motion_approach: Array) -> bool:
    """Whether every rigid-body motion, and every combination of motions (columns), changes the approach.

    The rows are quadrature points of the contact.
    """
    if rigid_motion_approach.shape[1] == 0:
        return True
    if rigid_motion_approach.shape[0] < rigid_motion_approach.shape[1]:
        return False
    smallest = np.linalg.svd(rigid_motion_approach, compute_uv=False)[-1]
    return bool(smallest > MIN_RESTRAINED_OVER_BODY_MOTION * np.sqrt(rigid_motion_approach.shape[0]))
