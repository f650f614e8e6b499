"""Stiffness of a whole bolted joint between two rigid attachments: members, interface and bolts together.

Linear, about the tightened state: both bodies by finite elements, the interface as springs between them, each
bolt a spring between its bearing areas. An attachment is a part of a body that moves as one: it has the
motion of what the joint is screwed to.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint.compliances import Compliances
from jointfmu.quantity import Array

from .bolted_contact import elastic_body, head_loads
from .contact import Interface, trace
from .elasticity import Cholesky, ElasticBody, Index
from .geometry import Assembly
from .mesh import contact_cells, contact_mesh, plan_of

AXES = (0, 1, 2)
MIRROR = np.array([1.0, 1.0, -1.0])
"""Of displacements and places in the plane of the contact."""
SLACK = 1e-6
"""Distance from a face over the body's size [1] at which a node lies on it."""


def _faces(body: ElasticBody, side: int) -> NDArray[np.bool_]:
    return _at(np.abs(body.nodes[2]), float(np.abs(body.nodes[2]).max()))


def _edge(body: ElasticBody, side: int) -> NDArray[np.bool_]:
    x = body.nodes[0] if side == 2 else -body.nodes[0]
    return _at(x, float(x.max()))


def _heads(body: ElasticBody, side: int) -> NDArray[np.bool_]:
    held = np.zeros(body.nodes.shape[1], dtype=bool)
    for name, facets in body.mesh.boundaries.items():
        if name.startswith("head"):
            held[body.basis.get_dofs(facets).flatten()] = True
    return held


def _at(place: Array, end: float) -> NDArray[np.bool_]:
    return np.asarray(np.abs(place - end) < SLACK * abs(end))


ATTACHED: Mapping[str, Callable[[ElasticBody, int], NDArray[np.bool_]]] = {
    "faces": _faces,
    "edge": _edge,
    "heads": _heads,
}
"""Nodes that move as one: of the outer face, of the edge (side 1 at -x, side 2 at +x), or under the heads."""


@dataclass(frozen=True)
class WholeJoint:
    """Two meshed bodies between their attachments.

    bodies    : side 1 and 2
    held      : unknowns of each that the attachment moves
    interface : points of the contact
    heads     : for each body, mean displacement (n, bolts) along z of what a bolt presses on
    bolts     : (bolts, 2) [m] their places
    """

    bodies: tuple[ElasticBody, ElasticBody]
    held: tuple[Index, Index]
    interface: Interface
    heads: tuple[Array, Array]
    bolts: Array

    @classmethod
    def of(cls, assembly: Assembly, attached: str, refinement: float = 1.0) -> "WholeJoint":
        """Mesh an assembly; attached is one of ATTACHED, refinement [1] divides the sizes of all elements."""
        plan = plan_of(assembly, refinement)
        first, second = (elastic_body(plan, assembly, side, refinement) for side in (1, 2))
        held, heads = [], []
        for side, body in enumerate((first, second), start=1):
            nodes = np.flatnonzero(ATTACHED[attached](body, side))
            held.append((3 * nodes[:, None] + np.arange(3)).ravel())
            heads.append(head_loads(body, assembly))
        interface = Interface.of(contact_mesh(plan, contact_cells(plan, assembly)))
        bolts = assembly.bolts.positions
        return cls((first, second), (held[0], held[1]), interface, (heads[0], heads[1]), bolts)

    @property
    def mirrored(self) -> bool:
        """Whether side 2 is the mirror image of side 1, with its attachment and what its bolts press on."""
        first, second = self.bodies
        return (
            (first.E, first.nu) == (second.E, second.nu)
            and first.nodes.shape == second.nodes.shape
            and np.array_equal(first.nodes, second.nodes * MIRROR[:, None])
            and np.array_equal(*self.held)
            and np.allclose(*self.heads, rtol=0.0, atol=SLACK)
        )

    def apart(self, axis: int) -> sp.csr_matrix:
        """Displacement (points, n) of side 2 against side 1 along an axis."""
        return sp.hstack(
            [s * trace(b, self.interface, axis) for s, b in zip((-1.0, 1.0), self.bodies, strict=True)]
        ).tocsr()

    def compliances(self, springs: Array, bolt: float) -> Compliances:
        """Of the whole joint; springs (points, 3) [N/m3] of the interface along x, y, z,
        bolt [N/m] the stiffness of each.

        Raises RuntimeError if a body can move freely.
        """
        return self.linear(springs, bolt).compliances()

    @property
    def stretch(self) -> Array:
        """Of each bolt (n, bolts) by the displacement of both bodies."""
        return np.concatenate([-self.heads[0], self.heads[1]])

    def linear(self, springs: Array, bolt: float) -> "Linear":
        """The joint with springs in place of its interface, see `compliances`."""
        bodies = sp.block_diag([body.stiffness for body in self.bodies], format="csr")
        opening = [self.apart(axis) for axis in AXES]
        weights = [sp.diags(self.interface.area * springs[:, axis]) for axis in AXES]
        contact = sum(b.T @ w @ b for b, w in zip(opening, weights, strict=True))
        shanks = bolt * sp.csr_matrix(self.stretch) @ sp.csr_matrix(self.stretch.T)
        return Linear(self, bodies, contact, shanks, bolt, *self._solved(bodies + contact + shanks))

    def _solved(self, stiffness: sp.csr_matrix) -> tuple[Array, Array, Index, "Cholesky | Halves"]:
        """Displacements (n, 6) under unit motions of side 2's attachment about the centroid of the contact,
        and those of rigid sides; unknowns that are free, factors of their stiffness."""
        first, second = self.bodies
        x, y = self.interface.centroid
        rigid = np.concatenate([np.zeros((first.size, 6)), second.rigid_motions((float(x), float(y)))])
        held = np.concatenate([self.held[0], first.size + self.held[1]])
        free = np.setdiff1d(np.arange(rigid.shape[0]), held)
        moved = np.zeros_like(rigid)
        moved[held] = rigid[held]
        own = stiffness[free][:, free]
        factor = Halves(own, MIRROR[free[: len(free) // 2] % 3]) if self.mirrored else Cholesky(own)
        moved[free] = -factor.solve(stiffness[free][:, held] @ rigid[held])
        return moved, rigid, free, factor


class Halves:
    """Factors of the stiffness (2 n, 2 n) of two bodies that mirror each other, by what they do alike and
    oppositely; mirror (n): its sign for each unknown of the first one."""

    def __init__(self, matrix: sp.csr_matrix, mirror: Array) -> None:
        n = len(mirror)
        own, other = matrix[n:, n:], matrix[n:, :n] @ sp.diags(mirror)
        self._mirror, self._alike, self._opposite = mirror, Cholesky(own + other), Cholesky(own - other)

    def solve(self, right: Array) -> Array:
        """Solution (2 n, k) of `matrix @ x = right`."""
        first, second = np.split(right, 2)
        first = self._mirror[:, None] * first
        alike = self._alike.solve(0.5 * (second + first))
        opposite = self._opposite.solve(0.5 * (second - first))
        return np.concatenate([self._mirror[:, None] * (alike - opposite), alike + opposite])


@dataclass(frozen=True)
class Linear:
    """A joint whose interface is springs: stiffness matrices (n, n) [N/m] of bodies, contact and bolts.

    bolt         : [N/m] stiffness of each bolt
    moved, rigid : (n, 6) displacement under unit motions of side 2's attachment about the centroid of the
        contact, and without deformation
    free, factor : unknowns that no attachment holds, and factors of their stiffness
    """

    joint: WholeJoint
    bodies: sp.csr_matrix
    contact: sp.csr_matrix
    shanks: sp.csr_matrix
    bolt: float
    moved: Array
    rigid: Array
    free: Index
    factor: Cholesky | Halves

    def solve(self, loads: Array) -> Array:
        """Displacements (n, s) [m] under loads (n, s) [N] while the attachments rest."""
        moved = np.zeros_like(loads)
        moved[self.free] = self.factor.solve(loads[self.free])
        return moved

    @property
    def stiffness(self) -> Array:
        """Of the joint (6, 6) [N/m, N, N.m] about the centroid of its contact."""
        return np.asarray(self.moved.T @ ((self.contact + self.bodies + self.shanks) @ self.moved))

    def compliances(self) -> Compliances:
        """Of the joint about the centroid of its contact."""
        parts, held = (self.contact, self.bodies, self.shanks), np.diag(self.stiffness)
        stored = np.stack([np.sum(self.moved * (part @ self.moved), axis=0) for part in parts])
        contact, bolts = (np.diag(self.rigid.T @ (part @ self.rigid)) for part in (parts[0], parts[2]))
        force = self.bolt * (self.joint.stretch.T @ self.moved) @ np.linalg.inv(self.stiffness)
        return Compliances(stored / held**2, 1.0 / contact, bolts, force)
