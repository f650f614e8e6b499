"""States of a joint in monotonic loading into slip and opening: the snapshots for the modes of its bodies.

The contact is divided into one cell for each point of the reduced joint. The compliance of the bodies under
loads on cells and bolts comes from finite elements. With the interface law in each cell, motions along and
about all axes give states of the complete joint. States in shear alone are then brought to equilibrium with
the law at all quadrature points: cells alone miss the tangential displacement at the edge of slip, and with
it part of the loss.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from jointfmu.joints.bolted_joint.law import working_preload
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.quantity import Array

from ..elasticity import Cholesky, ElasticBody, Index
from ..whole_joint import AXES, MIRROR, Linear, WholeJoint
from .patch_work import TINY

SHEARED = (0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3)
"""Motions along x, y and about z over the motion at which the linear joint reaches its friction limit [1]."""
OPENED = (-0.6, -0.2, 0.3, 0.6, 0.9, 1.2)
"""Motions along z and about x, y, over the motion at which the linear joint loses its preload force [1]."""
MIXED = 12
"""Number of motions along and about all axes at once."""
STEPS, CLOSE = 40, 1e-9
"""Largest number of steps of Newton's method; residual over the largest prescribed motion [1] at its end."""
SETTLED = 3
"""Number of steps that bring the states in shear to equilibrium at all quadrature points."""


def states(linear: Linear, spring: BoltedJointSpring, normal: Array, preload: float) -> tuple[Array, Array]:
    """Compute the states of a joint under motions of side 2, from the preloaded joint on.

    Returns the motions (s, 6) [m, rad] and the negative deformation (n, s) [m] of the bodies.

    linear           : linear finite-element model of the joint
    spring           : the reduced joint
    normal_stiffness : (q) [Pa/m] of the preloaded interface at the quadrature points
    preload          : [N] per bolt

    Raises RuntimeError if a body can move freely.
    """
    cells = Cells.of(linear.joint, spring, normal)
    joint_states = States.of(cells, linear.joint.bolts - linear.joint.interface.centroid, preload)
    motions = np.array(list(joint_states.motions()))
    deformation = cells.moved @ np.stack([joint_states.forces(motion) for motion in motions], axis=1)
    sheared = ~np.any(motions[:, 2:5], axis=1)
    deformation[:, sheared] = settled(linear, spring, normal, motions[sheared], deformation[:, sheared])
    return motions, deformation


@dataclass(frozen=True)
class Cells:
    """Displacement of the bodies under unit loads on the n cells of the contact and on the b bolts.

    joint            : finite-element model of the joint
    spring           : the reduced joint; its points are the centres of the cells
    normal_stiffness : (q) [Pa/m] of the preloaded interface at the quadrature points
    loads            : (3 n + b, unknowns) [1] averaging operators: mean displacement of each cell along z, x
                       and y, then elongation of each bolt; the transpose distributes unit loads
    displacement     : (unknowns, 3 n + b) [m/N] under unit loads
    """

    joint: WholeJoint
    spring: BoltedJointSpring
    normal: Array
    loads: sp.csr_matrix
    moved: Array

    @classmethod
    def of(cls, joint: WholeJoint, spring: BoltedJointSpring, normal: Array) -> "Cells":
        """Compute the displacement under all unit loads. Raises RuntimeError if a body can move freely."""
        means = cell_means(joint, spring.shape.position, normal)
        stretch = sp.csr_matrix(joint.stretch.T)
        loads = sp.vstack([*(means @ joint.apart(axis) for axis in (2, 0, 1)), stretch]).tocsr()
        first, second = joint.bodies
        displacement1 = _moved(first, joint.held[0], loads[:, : first.size])
        if joint.mirrored:
            sign = np.repeat([1.0, -1.0, 1.0], (means.shape[0], 2 * means.shape[0], stretch.shape[0]))
            displacement2 = np.tile(MIRROR, second.size // 3)[:, None] * displacement1 * sign
        else:
            displacement2 = _moved(second, joint.held[1], loads[:, first.size :])
        return cls(joint, spring, normal, loads, np.concatenate([displacement1, displacement2]))


def _moved(body: ElasticBody, held: Index, loads: sp.csr_matrix) -> Array:
    """Solve for displacements (n, k) [m/N] of a body under unit loads (k, n) [1]; its attachment is fixed."""
    displacement, free = np.zeros(loads.shape[::-1]), np.setdiff1d(np.arange(body.size), held)
    displacement[free] = Cholesky(body.stiffness[free][:, free]).solve(loads[:, free].T.tocsc())
    return displacement


def cell_means(joint: WholeJoint, places: Array, normal: Array) -> sp.csr_matrix:
    """Averaging matrix (n, q) [1] over cells of the contact, weighted by the normal stiffness (q) [Pa/m].

    A quadrature point belongs to the cell with the nearest centre. A cell without quadrature points takes the
    value at the nearest one.

    centres : (n, 2) [m] of the cells
    """
    interface = joint.interface
    position = interface.centred
    cell = cKDTree(places).query(position)[1]
    weight = interface.area * np.maximum(normal, 1e-6 * normal.max())
    empty = np.flatnonzero(np.bincount(cell, weight, minlength=len(places)) == 0.0)
    nearest = cKDTree(position).query(places[empty])[1]
    rows, columns = np.append(cell, empty), np.append(np.arange(cell.size), nearest)
    sums = sp.csr_matrix(
        (np.append(weight, np.ones(empty.size)), (rows, columns)), shape=(len(places), cell.size)
    )
    return (sp.diags(1.0 / np.asarray(sums.sum(axis=1)).ravel()) @ sums).tocsr()


@dataclass(frozen=True)
class States:
    """Joint with the interface law in n cells and b bolts, for monotonic motions of side 2.

    spring            : the reduced joint; it gives the law
    compliance        : of the bodies (3 n + b, 3 n + b) [m/N]
    rigid_displacement : (3 n + b, 6) displacement of cells and bolts by rigid-body motions of side 2
    preload_approach  : approach (n) [m] of the cells in the preloaded joint
    preload           : [N] per bolt
    """

    spring: BoltedJointSpring
    compliance: Array
    rigid: Array
    start: Array
    preload: float

    @classmethod
    def of(cls, cells: Cells, bolts: Array, preload: float) -> "States":
        """Joint preloaded by bolts at positions (b, 2) [m], with the compliance of its cells."""
        spring, compliance = cells.spring, np.asarray(cells.loads @ cells.moved)
        x, y = spring.shape.position.T
        n, b = x.size, len(bolts)
        rigid = np.zeros((3 * n + b, 6))
        rigid[:n, 2:5] = np.stack([np.ones(n), y, -x], axis=1)
        rigid[n : 2 * n, [0, 5]] = np.stack([np.ones(n), -y], axis=1)
        rigid[2 * n : 3 * n, [1, 5]] = np.stack([np.ones(n), x], axis=1)
        rigid[3 * n :, 2:5] = np.stack([np.ones(b), bolts[:, 1], -bolts[:, 0]], axis=1)
        start = spring.tightened(preload, 0.0)
        return cls(spring, 0.5 * (compliance + compliance.T), rigid, start, preload)

    def law(self, g: Array) -> tuple[Array, sp.csr_matrix]:
        """Forces (3 n + b) [N] at displacements g (3 n + b) [m] of cells and bolts, and symmetric tangent.

        Forces are changes from the preloaded joint. The order of g is: opening (n), displacement along x (n),
        displacement along y (n), elongation of the bolts (b).
        """
        spring, n = self.spring, self.start.size
        joint, area = spring.joint, spring.joint.A_0 * spring.shape.share
        foundation = spring.foundation()
        ratio, slip_ratio = foundation.ratio, foundation.friction / foundation.ratio
        approach = self.start - g[:n]
        p, k = spring.curve.derivatives(approach, 1)
        p_preload = spring.curve.derivatives(self.start, 0)[0]
        u, v = g[n : 2 * n], g[2 * n : 3 * n]
        size = np.maximum(np.hypot(u, v), 1e-30)
        secant = foundation.backbone(approach, size) / size
        tangent = ratio * spring.curve.derivatives(approach - size / slip_ratio, 1)[1]
        secant = np.where(size < 1e-6 * np.max(np.abs(self.start)), ratio * k, secant)
        softening = (tangent - secant) / size**2
        preload = np.full(g.size - 3 * n, float(working_preload(joint, self.preload)))
        bolts, elongation = spring.bolts, g[3 * n :]
        bolt = bolts.tangent(preload, elongation)
        pull = bolts.stiffness * (elongation + bolts.gap(preload, elongation))
        force = np.concatenate([-area * (p - p_preload), area * secant * u, area * secant * v, pull])
        diagonal = [area * k, area * (secant + softening * u * u), area * (secant + softening * v * v), bolt]
        cross = np.zeros(g.size)
        cross[n : 2 * n] = area * softening * u * v  # d(force along x) / d(displacement along y)
        slope = sp.diags([cross[: g.size - n], np.concatenate(diagonal), cross[: g.size - n]], [-n, 0, n])
        return force, slope.tocsr()

    def stiffness(self) -> Array:
        """Stiffness (6, 6) [N/m, N, N.m] of the preloaded joint."""
        slope = self.law(np.zeros(len(self.rigid)))[1]
        identity = np.eye(len(self.rigid))
        return np.asarray(
            self.rigid.T @ np.linalg.solve(identity + slope @ self.compliance, slope @ self.rigid)
        )

    def forces(self, motion: Array) -> Array:
        """Solve for the forces (3 n + b) [N] at a motion (6) [m, rad] of side 2's attachment.

        Newton's method may stop before it has converged: a state needs no exact equilibrium.
        """
        prescribed = self.rigid @ motion
        g = np.zeros_like(prescribed)
        force, slope = self.law(g)
        residual = g + self.compliance @ force - prescribed
        for _ in range(STEPS):
            step = -np.linalg.solve(np.eye(g.size) + (slope @ self.compliance).T, residual)
            for halvings in range(5):
                g_trial = g + 0.5**halvings * step
                force, slope = self.law(g_trial)
                trial_residual = g_trial + self.compliance @ force - prescribed
                if np.linalg.norm(trial_residual) < np.linalg.norm(residual):
                    break
            g, residual = g_trial, trial_residual
            if np.max(np.abs(residual)) < CLOSE * np.max(np.abs(prescribed)):
                break
        return force

    def motions(self) -> Iterator[Array]:
        """Motions (6) [m, rad] of side 2 into slip and opening: along and about each axis, then along all."""
        joint, K = self.spring.joint, np.diag(self.stiffness())
        radius = np.sqrt(self.spring.shape.share @ np.sum(self.spring.shape.position**2, axis=1))
        clamping = joint.n_bolts * float(working_preload(joint, self.preload))
        load = clamping * np.array([joint.mu, joint.mu, 1.0, radius, radius, joint.mu * radius])
        unit = load / K
        for axis in range(6):
            for factor in OPENED if axis in (2, 3, 4) else SHEARED:
                yield factor * unit * (np.arange(6) == axis)
        for number in range(MIXED):
            yield (2.0 * ((0.5 + (number + 1.0) * SPREAD) % 1.0) - 1.0) * unit


def closed_by(spring: BoltedJointSpring, normal: Array) -> Array:
    """Approach (q) [m] at which the interface law has the normal stiffness (q) [Pa/m]."""
    curve = spring.curve
    return np.interp(normal, curve.derivatives(curve.displacement, 1)[1], curve.displacement)


def settled(
    linear: Linear, spring: BoltedJointSpring, normal: Array, motions: Array, deformed: Array
) -> Array:
    """Refine the negative deformation (n, s) [m] towards equilibrium with the law at all quadrature points.

    normal_stiffness : (q) [Pa/m] of the preloaded interface at the quadrature points
    motions          : (s, 6) [m, rad] of side 2
    deformation      : negative deformation (n, s) [m] in equilibrium with the law in the cells

    Each iteration uses the stiffness of the preloaded joint. Slip only lowers the stiffness, so the iteration
    converges. A state whose step grows (its contact closes) is not changed.
    """
    joint, law, preloaded = linear.joint, spring.foundation(), closed_by(spring, normal)
    interface, curve = joint.interface, spring.curve
    relative, stretch = [joint.apart(axis) for axis in AXES], sp.csr_matrix(joint.stretch)
    rigid = linear.rigid @ motions.T
    prescribed = [rows @ rigid for rows in (*relative, stretch.T)]
    last_decrement = np.full(len(motions), np.inf)
    p_preload = curve.derivatives(preloaded, 0)[0][:, None]
    displacement = -deformed
    for _ in range(SETTLED):
        u, v, opening, elongation = (
            start + rows @ displacement
            for start, rows in zip(prescribed, (*relative, stretch.T), strict=True)
        )
        approach = preloaded[:, None] - opening
        size = np.maximum(np.hypot(u, v), TINY)
        secant = interface.area[:, None] * law.backbone(approach, size) / size
        loads = relative[0].T @ (secant * u) + relative[1].T @ (secant * v)
        loads += linear.bolt * (stretch @ elongation)
        loads -= relative[2].T @ (interface.area[:, None] * (curve.derivatives(approach, 0)[0] - p_preload))
        residual = -(linear.bodies @ displacement + loads)
        step = linear.solve(residual)
        decrement = np.sum(step * residual, axis=0)
        displacement = displacement + np.where(decrement < last_decrement, step, 0.0)
        last_decrement = np.minimum(decrement, last_decrement)
    return -displacement


SPREAD = 0.8566748838545029 ** np.arange(1.0, 7.0)
"""Steps of a low-discrepancy sequence in six dimensions: powers of the inverse root of x^7 = x + 1."""
