"""Linear stiffness of a complete bolted joint between two rigid attachments: members, interface and bolts.

The model is linearised about the preloaded state. The bodies are finite elements, the interface is a layer of
springs between them, each bolt is a spring between its bearing areas. An attachment is a set of nodes of a
body that moves like a rigid body, with the structure to which the joint is fixed.
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
"""Factors of x, y, z for the mirror image in the contact plane."""
SLACK = 1e-6
"""Distance of a node from a face over the size of the body [1], below which the node lies on the face."""


def _faces(body: ElasticBody, side: int) -> NDArray[np.bool_]:
    """Whether each node lies on the outer face, opposite to the contact."""
    return _at(np.abs(body.nodes[2]), float(np.abs(body.nodes[2]).max()))


def _edge(body: ElasticBody, side: int) -> NDArray[np.bool_]:
    """Whether each node lies on the end face of the body: at +x for side 2, at -x for side 1."""
    x = body.nodes[0] if side == 2 else -body.nodes[0]
    return _at(x, float(x.max()))


def _heads(body: ElasticBody, side: int) -> NDArray[np.bool_]:
    """Whether each node lies under a bolt head."""
    under_head = np.zeros(body.nodes.shape[1], dtype=bool)
    for name, facets in body.mesh.boundaries.items():
        if name.startswith("head"):
            under_head[body.basis.get_dofs(facets).flatten()] = True
    return under_head


def _at(place: Array, end: float) -> NDArray[np.bool_]:
    """Whether each coordinate [m] equals a value [m] within FACE_TOLERANCE."""
    return np.asarray(np.abs(place - end) < SLACK * abs(end))


ATTACHED: Mapping[str, Callable[[ElasticBody, int], NDArray[np.bool_]]] = {
    "faces": _faces,
    "edge": _edge,
    "heads": _heads,
}
"""Kinds of attachment, each with a function (body, side) that gives the mask (nodes) of the rigid nodes:
the outer face, the end face (side 1 at -x, side 2 at +x), or the areas under the bolt heads."""


@dataclass(frozen=True)
class WholeJoint:
    """Finite-element model of both bodies of a joint between their attachments.

    bodies              : side 1 and side 2
    attachment_unknowns : for each body, unknowns whose displacement the attachment prescribes
    interface           : quadrature of the contact area
    bolt_head_loads     : for each body, nodal load (n, bolts) [N/N] of a unit bolt force along +z; the same
                          weights give the mean displacement along z under a bolt head
    bolts               : positions (bolts, 2) [m]
    """

    bodies: tuple[ElasticBody, ElasticBody]
    held: tuple[Index, Index]
    interface: Interface
    heads: tuple[Array, Array]
    bolts: Array

    @classmethod
    def of(cls, assembly: Assembly, attached: str, refinement: float = 1.0) -> "WholeJoint":
        """Mesh an assembly.

        attachment : kind of attachment, a key of ATTACHMENT_NODES
        refinement : [1] divides the sizes of all elements
        """
        plan = plan_of(assembly, refinement)
        first, second = (elastic_body(plan, assembly, side, refinement) for side in (1, 2))
        attachments, heads = [], []
        for side, body in enumerate((first, second), start=1):
            nodes = np.flatnonzero(ATTACHED[attached](body, side))
            attachments.append((3 * nodes[:, None] + np.arange(3)).ravel())
            heads.append(head_loads(body, assembly))
        interface = Interface.of(contact_mesh(plan, contact_cells(plan, assembly)))
        bolts = assembly.bolts.positions
        return cls((first, second), (attachments[0], attachments[1]), interface, (heads[0], heads[1]), bolts)

    @property
    def mirrored(self) -> bool:
        """Whether side 2 is the mirror image of side 1: body, mesh, attachment and bolt bearing areas."""
        first, second = self.bodies
        return (
            (first.E, first.nu) == (second.E, second.nu)
            and first.nodes.shape == second.nodes.shape
            and np.array_equal(first.nodes, second.nodes * MIRROR[:, None])
            and np.array_equal(*self.held)
            and np.allclose(*self.heads, rtol=0.0, atol=SLACK)
        )

    def apart(self, axis: int) -> sp.csr_matrix:
        """Matrix (q, n) [1]: displacement of side 2 relative to side 1 along an axis, per unknown.

        The displacement along z (axis 2) is the opening of the contact.
        """
        return sp.hstack(
            [s * trace(b, self.interface, axis) for s, b in zip((-1.0, 1.0), self.bodies, strict=True)]
        ).tocsr()

    def compliances(self, springs: Array, bolt: float) -> Compliances:
        """Compliances of the complete joint.

        springs        : stiffness per area (q, 3) [N/m3] of the interface along x, y, z
        bolt_stiffness : of each bolt [N/m]

        Raises RuntimeError if a body can move freely.
        """
        return self.linear(springs, bolt).compliances()

    @property
    def stretch(self) -> Array:
        """Matrix (n, bolts) [1]: elongation of each bolt per unknown of both bodies."""
        return np.concatenate([-self.heads[0], self.heads[1]])

    def linear(self, springs: Array, bolt: float) -> "Linear":
        """Linear joint with springs as interface, solved for unit motions. Parameters as for `compliances`.

        Raises RuntimeError if a body can move freely.
        """
        bodies = sp.block_diag([body.stiffness for body in self.bodies], format="csr")
        opening = [self.apart(axis) for axis in AXES]
        weights = [sp.diags(self.interface.area * springs[:, axis]) for axis in AXES]
        contact = sum(b.T @ w @ b for b, w in zip(opening, weights, strict=True))
        shanks = bolt * sp.csr_matrix(self.stretch) @ sp.csr_matrix(self.stretch.T)
        return Linear(self, bodies, contact, shanks, bolt, *self._solved(bodies + contact + shanks))

    def _solved(self, stiffness: sp.csr_matrix) -> tuple[Array, Array, Index, "Cholesky | Halves"]:
        """Solve for unit translations and rotations of side 2's attachment about the centroid of the contact.

        Returns the displacement (n, 6) of the elastic bodies, the displacement (n, 6) of rigid bodies, the
        free unknowns, and the factorisation of their stiffness matrix.
        """
        first, second = self.bodies
        x, y = self.interface.centroid
        rigid = np.concatenate([np.zeros((first.size, 6)), second.rigid_motions((float(x), float(y)))])
        prescribed = np.concatenate([self.held[0], first.size + self.held[1]])
        free = np.setdiff1d(np.arange(rigid.shape[0]), prescribed)
        displacement = np.zeros_like(rigid)
        displacement[prescribed] = rigid[prescribed]
        free_stiffness = stiffness[free][:, free]
        if self.mirrored:
            factor: Cholesky | Halves = Halves(free_stiffness, MIRROR[free[: len(free) // 2] % 3])
        else:
            factor = Cholesky(free_stiffness)
        displacement[free] = -factor.solve(stiffness[free][:, prescribed] @ rigid[prescribed])
        return displacement, rigid, free, factor


class Halves:
    """Factorisation of the stiffness (2 n, 2 n) of two bodies that are mirror images of each other.

    Symmetric and antisymmetric displacements decouple: each has its own matrix (n, n).

    mirror : (n) sign of each unknown of the first body in the mirror image
    """

    def __init__(self, matrix: sp.csr_matrix, mirror: Array) -> None:
        n = len(mirror)
        diagonal, coupling = matrix[n:, n:], matrix[n:, :n] @ sp.diags(mirror)
        self._mirror = mirror
        self._symmetric, self._antisymmetric = Cholesky(diagonal + coupling), Cholesky(diagonal - coupling)

    def solve(self, right: Array) -> Array:
        """Solve `matrix @ x = right_side` for x (2 n, k)."""
        first, second = np.split(right, 2)
        first = self._mirror[:, None] * first
        symmetric = self._symmetric.solve(0.5 * (second + first))
        antisymmetric = self._antisymmetric.solve(0.5 * (second - first))
        return np.concatenate(
            [self._mirror[:, None] * (symmetric - antisymmetric), symmetric + antisymmetric]
        )


@dataclass(frozen=True)
class Linear:
    """Linear model of a joint: the interface is a layer of springs.

    body_matrix, contact_matrix, bolt_matrix : stiffness matrices (n, n) [N/m] of bodies, interface, bolts
    bolt_stiffness     : of each bolt [N/m]
    displacement       : (n, 6) for unit motions of side 2's attachment, about the centroid of the contact
    rigid_displacement : (n, 6) for the same motions if the bodies were rigid
    free_unknowns      : unknowns that no attachment prescribes
    factor             : factorisation of the stiffness matrix of the free unknowns
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
        """Solve for displacements (n, s) [m] under loads (n, s) [N], with both attachments fixed."""
        displacement = np.zeros_like(loads)
        displacement[self.free] = self.factor.solve(loads[self.free])
        return displacement

    @property
    def stiffness(self) -> Array:
        """Stiffness matrix (6, 6) [N/m, N, N.m] of the joint about the centroid of its contact."""
        return np.asarray(self.moved.T @ ((self.contact + self.bodies + self.shanks) @ self.moved))

    def compliances(self) -> Compliances:
        """Compliances of the joint, by their sources, about the centroid of its contact."""
        sources, total = (self.contact, self.bodies, self.shanks), np.diag(self.stiffness)
        stored = np.stack([np.sum(self.moved * (matrix @ self.moved), axis=0) for matrix in sources])
        contact, bolts = (
            np.diag(self.rigid.T @ (matrix @ self.rigid)) for matrix in (self.contact, self.shanks)
        )
        bolt_force = self.bolt * (self.joint.stretch.T @ self.moved) @ np.linalg.inv(self.stiffness)
        return Compliances(stored / total**2, 1.0 / contact, bolts, bolt_force)
