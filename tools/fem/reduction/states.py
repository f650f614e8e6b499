"""States of a joint between its attachments, on its first way into slip and opening: what its modes are of.

The contact is cut into the cells of the joint's points. Loads on cells and bolts move the bodies by finite
elements; with the interface's law at each cell, motions along and about all axes give states of the whole
joint. Those that shear alone then come to equilibrium with the law at all points of the finite elements: what
cells miss of the shift at the edges of slip would miss in the modes, and in the loss.
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
"""Motions along the surface, over that at which the linear joint would carry all friction [1]."""
OPENED = (-0.6, -0.2, 0.3, 0.6, 0.9, 1.2)
"""Motions apart, over that at which the linear joint would lose its clamping force [1]."""
MIXED = 12
"""Motions along and about all axes at once [1]."""
STEPS, CLOSE = 40, 1e-9
"""Of Newton's method [1], and its residual over the largest motion [1]."""
SETTLED = 3
"""Steps of the sheared states to equilibrium at all points [1]."""


def states(linear: Linear, spring: BoltedJointSpring, normal: Array, preload: float) -> tuple[Array, Array]:
    """Motions (s, 6) [m, rad] of side 2 from the tightened joint, and the deformation (n, s) [m] under them,
    less its sign.

    linear : by finite elements
    normal : (q) [Pa/m] stiffness of the tightened interface at the points of the finite elements

    Raises RuntimeError if a body can move freely.
    """
    cells = Cells.of(linear.joint, spring, normal)
    found = States.of(cells, linear.joint.bolts - linear.joint.interface.centroid, preload)
    motions = np.array(list(found.motions()))
    deformed = cells.moved @ np.stack([found.forces(motion) for motion in motions], axis=1)
    sheared = ~np.any(motions[:, 2:5], axis=1)
    deformed[:, sheared] = settled(linear, spring, normal, motions[sheared], deformed[:, sheared])
    return motions, deformed


@dataclass(frozen=True)
class Cells:
    """Loads on the cells of a contact and on the bolts, and how the bodies give way under them.

    joint  : by finite elements
    spring : the joint that is reduced, its points are the middles of the cells
    normal : (q) [Pa/m] stiffness of the tightened interface at the points of the finite elements
    loads  : (3 n + b, unknowns) means over cells along z, x and y, and the stretch of the bolts
    moved  : (unknowns, 3 n + b) [m/N] displacement under unit loads
    """

    joint: WholeJoint
    spring: BoltedJointSpring
    normal: Array
    loads: sp.csr_matrix
    moved: Array

    @classmethod
    def of(cls, joint: WholeJoint, spring: BoltedJointSpring, normal: Array) -> "Cells":
        """Raises RuntimeError if a body can move freely."""
        means = cell_means(joint, spring.shape.position, normal)
        stretch = sp.csr_matrix(joint.stretch.T)
        loads = sp.vstack([*(means @ joint.apart(axis) for axis in (2, 0, 1)), stretch]).tocsr()
        first, second = joint.bodies
        moved = _moved(first, joint.held[0], loads[:, : first.size])
        if joint.mirrored:
            along = np.repeat([1.0, -1.0, 1.0], (means.shape[0], 2 * means.shape[0], stretch.shape[0]))
            other = np.tile(MIRROR, second.size // 3)[:, None] * moved * along
        else:
            other = _moved(second, joint.held[1], loads[:, first.size :])
        return cls(joint, spring, normal, loads, np.concatenate([moved, other]))


def _moved(body: ElasticBody, held: Index, loads: sp.csr_matrix) -> Array:
    """Displacements (n, k) [m/N] of a body by loads (k, n), held at its attachment."""
    moved, free = np.zeros(loads.shape[::-1]), np.setdiff1d(np.arange(body.size), held)
    moved[free] = Cholesky(body.stiffness[free][:, free]).solve(loads[:, free].T.tocsc())
    return moved


def cell_means(joint: WholeJoint, places: Array, normal: Array) -> sp.csr_matrix:
    """Means (n, q) over the cells of places (n, 2) [m], by the stiffness of the interface (q)."""
    at = joint.interface
    position = at.centred
    cell = cKDTree(places).query(position)[1]
    weight = at.area * np.maximum(normal, 1e-6 * normal.max())
    alone = np.flatnonzero(np.bincount(cell, weight, minlength=len(places)) == 0.0)
    nearest = cKDTree(position).query(places[alone])[1]
    rows, columns = np.append(cell, alone), np.append(np.arange(cell.size), nearest)
    sums = sp.csr_matrix(
        (np.append(weight, np.ones(alone.size)), (rows, columns)), shape=(len(places), cell.size)
    )
    return (sp.diags(1.0 / np.asarray(sums.sum(axis=1)).ravel()) @ sums).tocsr()


@dataclass(frozen=True)
class States:
    """The whole joint on its cells, from rest: forces (3 n + b) [N] under motions of side 2.

    compliance : (3 n + b, 3 n + b) [m/N]
    rigid      : (3 n + b, 6) motion of the cells and bolts without deformation
    start      : (n) [m] approaches at tightening, preload [N] of each bolt
    """

    spring: BoltedJointSpring
    compliance: Array
    rigid: Array
    start: Array
    preload: float

    @classmethod
    def of(cls, cells: Cells, bolts: Array, preload: float) -> "States":
        """Of the tightened joint, with bolts at (b, 2) [m]."""
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
        """Forces (3 n + b) [N] at motions (3 n + b) [m] of cells and bolts, and their slope, symmetric."""
        spring, n = self.spring, self.start.size
        joint, area = spring.joint, spring.joint.A_0 * spring.shape.share
        foundation = spring.foundation()
        ratio, reach = foundation.ratio, foundation.friction / foundation.ratio
        now = self.start - g[:n]
        p, k = spring.curve.derivatives(now, 1)
        tight = spring.curve.derivatives(self.start, 0)[0]
        u, v = g[n : 2 * n], g[2 * n : 3 * n]
        size = np.maximum(np.hypot(u, v), 1e-30)
        secant = foundation.backbone(now, size) / size
        tangent = ratio * spring.curve.derivatives(now - size / reach, 1)[1]
        secant = np.where(size < 1e-6 * np.max(np.abs(self.start)), ratio * k, secant)
        bent = (tangent - secant) / size**2
        held = np.full(g.size - 3 * n, float(working_preload(joint, self.preload)))
        bolts, elongation = spring.bolts, g[3 * n :]
        bolt = bolts.tangent(held, elongation)
        pull = bolts.stiffness * (elongation + bolts.gap(held, elongation))
        force = np.concatenate([-area * (p - tight), area * secant * u, area * secant * v, pull])
        own = [area * k, area * (secant + bent * u * u), area * (secant + bent * v * v), bolt]
        cross = np.zeros(g.size)
        cross[n : 2 * n] = area * bent * u * v  # of shifts along y on forces along x
        slope = sp.diags([cross[: g.size - n], np.concatenate(own), cross[: g.size - n]], [-n, 0, n])
        return force, slope.tocsr()

    def stiffness(self) -> Array:
        """(6, 6) of the tightened joint."""
        slope = self.law(np.zeros(len(self.rigid)))[1]
        one = np.eye(len(self.rigid))
        return np.asarray(self.rigid.T @ np.linalg.solve(one + slope @ self.compliance, slope @ self.rigid))

    def forces(self, motion: Array) -> Array:
        """Forces (3 n + b) [N] at a motion (6) of side 2's attachment; as far as Newton's method comes."""
        given = self.rigid @ motion
        g = np.zeros_like(given)
        force, slope = self.law(g)
        left = g + self.compliance @ force - given
        for _ in range(STEPS):
            step = -np.linalg.solve(np.eye(g.size) + (slope @ self.compliance).T, left)
            for half in range(5):
                there = g + 0.5**half * step
                force, slope = self.law(there)
                rest = there + self.compliance @ force - given
                if np.linalg.norm(rest) < np.linalg.norm(left):
                    break
            g, left = there, rest
            if np.max(np.abs(left)) < CLOSE * np.max(np.abs(given)):
                break
        return force

    def motions(self) -> Iterator[Array]:
        """Motions (6) of side 2 into slip and opening along and about all axes, and of all at once."""
        joint, K = self.spring.joint, np.diag(self.stiffness())
        radius = np.sqrt(self.spring.shape.share @ np.sum(self.spring.shape.position**2, axis=1))
        clamping = joint.n_bolts * float(working_preload(joint, self.preload))
        load = clamping * np.array([joint.mu, joint.mu, 1.0, radius, radius, joint.mu * radius])
        unit = load / K
        for axis in range(6):
            for part in OPENED if axis in (2, 3, 4) else SHEARED:
                yield part * unit * (np.arange(6) == axis)
        for number in range(MIXED):
            yield (2.0 * ((0.5 + (number + 1.0) * SPREAD) % 1.0) - 1.0) * unit


def closed_by(spring: BoltedJointSpring, normal: Array) -> Array:
    """Approaches (q) [m] at which the law has a stiffness (q) [Pa/m]."""
    curve = spring.curve
    return np.interp(normal, curve.derivatives(curve.displacement, 1)[1], curve.displacement)


def settled(
    linear: Linear, spring: BoltedJointSpring, normal: Array, motions: Array, deformed: Array
) -> Array:
    """Deformation (n, s), less its sign, nearer to equilibrium with the law at all points: motions (s, 6).

    normal   : (q) [Pa/m] stiffness of the tightened interface at the points
    deformed : (n, s) [m] that with the law at the cells

    By steps with the tightened joint's stiffness: slip only lowers it, so they lead there. A way whose step
    grows, as its contact closes, stays where it is.
    """
    joint, law, closed = linear.joint, spring.foundation(), closed_by(spring, normal)
    at, curve = joint.interface, spring.curve
    along, stretch = [joint.apart(axis) for axis in AXES], sp.csr_matrix(joint.stretch)
    rigid = linear.rigid @ motions.T
    given, before = [rows @ rigid for rows in (*along, stretch.T)], np.full(len(motions), np.inf)
    tight = curve.derivatives(closed, 0)[0][:, None]
    moved = -deformed
    for _ in range(SETTLED):
        u, v, apart, pulled = (
            first + rows @ moved for first, rows in zip(given, (*along, stretch.T), strict=True)
        )
        now = closed[:, None] - apart
        size = np.maximum(np.hypot(u, v), TINY)
        secant = at.area[:, None] * law.backbone(now, size) / size
        loads = along[0].T @ (secant * u) + along[1].T @ (secant * v) + linear.bolt * (stretch @ pulled)
        loads -= along[2].T @ (at.area[:, None] * (curve.derivatives(now, 0)[0] - tight))
        rest = -(linear.bodies @ moved + loads)
        step = linear.solve(rest)
        size = np.sum(step * rest, axis=0)
        moved, before = moved + np.where(size < before, step, 0.0), np.minimum(size, before)
    return -moved


SPREAD = 0.8566748838545029 ** np.arange(1.0, 7.0)
"""An even sequence in six dimensions: powers of the inverse root of x^7 = x + 1."""
