"""Whether bodies in contact have an equilibrium: their loads, supports and contact on rigid motions.

The stiffness matrix of a body that moves freely is singular, and whether its factorisation breaks down is
up to round-off. Rigid motions tell by numbers of order 1: a frictionless contact that only pushes balances
the loads if they are a sum, with weights >= 0, of unit pressures; as the approach of rigid bodies is linear
in the place, pressures at the corners of the contact's convex hull are enough (a linear programme).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import block_diag, null_space, qr
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from jointfmu.quantity import Array

from .elasticity import ElasticBody, Index

UNBALANCED = 1e-6
"""Largest unbalanced force over the sum of the loads' magnitudes [1].

Newton's method ends with 1e-8 or less, factors leave 1e-9; loads without equilibrium leave the order of 1.
"""
UNSEEN = 1e-6
"""Displacement at the supports, or approach, over that of the whole body, both rms, below which a rigid
motion is not held [1]: round-off is 1e-15, supports at a body's corners and its contact are of order 1."""


@dataclass(frozen=True)
class RigidBalance:
    """Forces of the loads and of the contact on the rigid motions of bodies (rms displacement 1 m).

    force   : (m) [N] of the loads on the motions that nothing but the contact stops
    closing : (q, m) [1] approach at the quadrature points by these motions
    loose   : (q, k) [1] approach by the motions that the supports leave in the computation
    scale   : [N] sum of the loads' magnitudes
    corners : quadrature points on the convex hull of the contact
    """

    force: Array
    closing: Array
    loose: Array
    scale: float
    corners: Index

    @classmethod
    def of(
        cls,
        bodies: Sequence[ElasticBody],
        traces: Sequence[sp.csr_matrix],
        loads: Sequence[Array],
        supports: Sequence[Index],
        position: Array,
        *,
        bearing: bool,
    ) -> "RigidBalance":
        """Balance of bodies under loads (n) [N].

        traces   : approach (q) at the quadrature points, at `position` (q, 2) [m], per displacement (n)
        supports : unknowns of each body that stay zero
        bearing  : whether supports may carry a load, or only stop motions that have none
        """
        motions = [rigid_motions(body) for body in bodies]
        force = np.concatenate([m.T @ load for m, load in zip(motions, loads, strict=True)])
        closing = np.hstack([trace @ m for m, trace in zip(motions, traces, strict=True)])
        held = [m[rows] for m, rows in zip(motions, supports, strict=True)]
        left = block_diag(*[null_space(rows, rcond=UNSEEN) if rows.size else np.eye(6) for rows in held])
        free = left if bearing else np.eye(force.size)
        scale = sum(float(np.abs(load).sum()) for load in loads)
        corners = np.asarray(ConvexHull(position).vertices, dtype=np.int64)
        return cls(free.T @ force, closing @ free, closing @ left, scale, corners)

    def check_loads(self) -> None:
        """Raise RuntimeError if a contact that only pushes cannot balance the loads, or none closes it."""
        if not _independent(self.loose):
            raise RuntimeError("supports and contact leave a rigid motion of a body free")
        if self.force.size == 0:
            return
        if not self.scale > 0.0:
            raise RuntimeError("no load presses the contact closed: all loads are 0 N")
        pressed, left = self._pressed()
        if left > UNBALANCED:
            raise RuntimeError(
                f"the loads do not balance: a contact that only pushes leaves {left:.2g} of them over, "
                f"allowed is {UNBALANCED:g}"
            )
        if pressed <= UNBALANCED:
            raise RuntimeError(
                f"no load presses the contact closed: its force is {pressed:.2g} of the loads, needed is "
                f"more than {UNBALANCED:g}"
            )

    def check_contact(self, force: Array) -> None:
        """Raise RuntimeError if contact forces (q) [N] >= 0 do not hold the bodies in balance."""
        if not _independent(self.loose[force > 0.0]):
            raise RuntimeError(
                f"the contact does not hold the bodies: it stays closed at {np.count_nonzero(force)} of "
                f"{force.size} points"
            )
        left = float(np.abs(self.force - self.closing.T @ force).sum())
        if not left <= UNBALANCED * self.scale:
            raise RuntimeError(
                f"the contact is not in balance: it leaves {left / self.scale:.2g} of the loads over, "
                f"allowed is {UNBALANCED:g}"
            )

    def _pressed(self) -> tuple[float, float]:
        """Sum of the corners' forces that balance the loads best, and what is left over, over the scale."""
        push = self.closing[self.corners].T
        rest = np.eye(self.force.size)
        cost = np.concatenate([np.zeros(self.corners.size), np.ones(2 * self.force.size)])
        best = linprog(cost, A_eq=np.hstack([push, rest, -rest]), b_eq=self.force / self.scale)
        if best.status != 0:
            raise RuntimeError(f"the balance of the loads was not found: {best.message}")
        return float(best.x[: self.corners.size].sum()), float(best.fun)


def rigid_motions(body: ElasticBody) -> Array:
    """Six independent rigid motions (n, 6) of a body, orthogonal, of rms displacement 1 m at its nodes."""
    motions: Array = qr(body.rigid_motions(), mode="economic")[0]
    return np.asarray(motions * np.sqrt(body.size / 3.0))


def _independent(approach: Array) -> bool:
    """Whether every combination of motions (columns) brings points (rows) together or apart."""
    if approach.shape[1] == 0:
        return True
    if approach.shape[0] < approach.shape[1]:
        return False
    least = np.linalg.svd(approach, compute_uv=False)[-1]
    return bool(least > UNSEEN * np.sqrt(approach.shape[0]))
