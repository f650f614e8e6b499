"""Linear stiffness of a complete bolted joint between two rigid attachments: members, interface and bolts.

The model is linearised about the preloaded state. The bodies are finite elements, the interface is a layer of
springs between them, each bolt is a spring between its bearing areas. An attachment is a set of nodes of a
body that moves like a rigid body, with the structure to which the joint is fixed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint.compliances import Compliances
from jointfmu.quantity import Array

from .bolted_contact import compute_bolt_head_loads, make_elastic_body
from .contact import ContactInterface, displacement_matrix
from .elasticity import ElasticBody, IndexArray
from .geometry import Assembly
from .mesh import find_contact_cells, make_contact_mesh
from .symmetric_factorisation import SymmetricFactorisation, find_reflections
from .symmetric_plan import mesh_symmetric_plan, min_size_at_heads

AXIS_INDICES = (0, 1, 2)
"""Indices of the axes x, y, z."""
MIRROR_SIGNS = np.array([1.0, 1.0, -1.0])
"""Factors of x, y, z for the mirror image in the contact plane."""
FACE_TOLERANCE = 1e-6
"""Distance of a node from a face over the size of the body [1], below which the node lies on the face."""


def _is_on_outer_face(body: ElasticBody, side_number: int) -> NDArray[np.bool_]:
    """Whether each node of a body lies on its outer face, opposite to the contact."""
    return _is_on_face(np.abs(body.node_positions[2]), float(np.abs(body.node_positions[2]).max()))


def _is_on_end_face(body: ElasticBody, side_number: int) -> NDArray[np.bool_]:
    """Whether each node of a body lies on its end face: at +x for side 2, at -x for side 1."""
    x = body.node_positions[0] if side_number == 2 else -body.node_positions[0]
    return _is_on_face(x, float(x.max()))


def _is_under_head(body: ElasticBody, side_number: int) -> NDArray[np.bool_]:
    """Whether each node of a body lies under a bolt head."""
    under_head = np.zeros(body.node_positions.shape[1], dtype=bool)
    for name, facets in body.mesh.boundaries.items():
        if name.startswith("head"):
            under_head[body.finite_element_basis.get_dofs(facets).flatten()] = True
    return under_head


def _is_on_face(node_coordinates: Array, face_coordinate: float) -> NDArray[np.bool_]:
    """Whether each coordinate [m] equals a value [m] within FACE_TOLERANCE."""
    return np.asarray(np.abs(node_coordinates - face_coordinate) < FACE_TOLERANCE * abs(face_coordinate))


ATTACHMENT_NODES: Mapping[str, Callable[[ElasticBody, int], NDArray[np.bool_]]] = {
    "faces": _is_on_outer_face,
    "edge": _is_on_end_face,
    "heads": _is_under_head,
}
"""Kinds of attachment, each with a function (body, side) that gives the mask (nodes) of the rigid nodes:
the outer face, the end face (side 1 at -x, side 2 at +x), or the areas under the bolt heads."""


@dataclass(frozen=True)
class JointFiniteElements:
    """Finite-element model of both bodies of a joint between their attachments.

    bodies              : side 1 and side 2
    attachment_unknowns : for each body, unknowns whose displacement the attachment prescribes
    contact_interface   : quadrature of the contact area
    bolt_head_loads     : for each body, nodal load (n, bolts) [N/N] of a unit bolt force along +z; the same
                          weights give the mean displacement along z under a bolt head
    bolt_positions      : positions (bolts, 2) [m]
    """

    bodies: tuple[ElasticBody, ElasticBody]
    attachment_unknowns: tuple[IndexArray, IndexArray]
    contact_interface: ContactInterface
    bolt_head_loads: tuple[Array, Array]
    bolt_positions: Array

    @classmethod
    def from_assembly(
        cls, assembly: Assembly, attachment_kind: str, refinement: float = 1.0
    ) -> "JointFiniteElements":
        """Mesh an assembly and find the unknowns at its attachments.

        attachment_kind : kind of attachment, a key of ATTACHMENT_NODES
        refinement      : [1] divides the sizes of all elements
        """
        graded_heads = attachment_kind == "heads"
        plan = mesh_symmetric_plan(assembly, refinement, graded_heads)
        first_height = min_size_at_heads(assembly, refinement) if graded_heads else None
        first, second = (make_elastic_body(plan, assembly, side, refinement, first_height) for side in (1, 2))
        attachments, heads = [], []
        for side, body in enumerate((first, second), start=1):
            nodes = np.flatnonzero(ATTACHMENT_NODES[attachment_kind](body, side))
            attachments.append((3 * nodes[:, None] + np.arange(3)).ravel())
            heads.append(compute_bolt_head_loads(body, assembly))
        interface = ContactInterface.from_mesh(make_contact_mesh(plan, find_contact_cells(plan, assembly)))
        bolts = assembly.bolts.bolt_positions
        return cls((first, second), (attachments[0], attachments[1]), interface, (heads[0], heads[1]), bolts)

    @property
    def is_mirrored(self) -> bool:
        """Whether side 2 is the mirror image of side 1: body, mesh, attachment and bolt bearing areas."""
        first, second = self.bodies
        return (
            (first.E, first.nu) == (second.E, second.nu)
            and first.node_positions.shape == second.node_positions.shape
            and np.array_equal(first.node_positions, second.node_positions * MIRROR_SIGNS[:, None])
            and np.array_equal(*self.attachment_unknowns)
            and np.allclose(*self.bolt_head_loads, rtol=0.0, atol=FACE_TOLERANCE)
        )

    @cached_property
    def stiffness_matrices(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Stiffness matrix (n, n) [N/m] of each body without its supports."""
        first, second = self.bodies
        if not self.is_mirrored:
            return first.stiffness_matrix, second.stiffness_matrix
        matrix = first.stiffness_matrix
        sign = np.tile(MIRROR_SIGNS, first.unknown_count // 3)
        row_sign = np.repeat(sign, np.diff(matrix.indptr))
        mirrored = row_sign * matrix.data * sign[matrix.indices]
        return matrix, sp.csr_matrix((mirrored, matrix.indices, matrix.indptr), shape=matrix.shape)

    def relative_displacement_matrix(self, axis_index: int) -> sp.csr_matrix:
        """Matrix (q, n) [1]: displacement of side 2 relative to side 1 along an axis, per unknown.

        The displacement along z (axis 2) is the opening of the contact.
        """
        return sp.hstack(
            [
                s * displacement_matrix(b, self.contact_interface, axis_index)
                for s, b in zip((-1.0, 1.0), self.bodies, strict=True)
            ]
        ).tocsr()

    def compliances(self, interface_stiffness: Array, bolt_stiffness: float) -> Compliances:
        """Compliances of the complete joint, by their sources: interface, members, bolts.

        interface_stiffness : stiffness per area (q, 3) [N/m3] of the interface along x, y, z
        bolt_stiffness      : stiffness of each bolt [N/m]

        Raises RuntimeError if a body can move freely.
        """
        return self.linearise_joint(interface_stiffness, bolt_stiffness).compliances()

    @property
    def elongation_matrix(self) -> Array:
        """Matrix (n, bolts) [1]: elongation of each bolt per unknown of both bodies."""
        return np.concatenate([-self.bolt_head_loads[0], self.bolt_head_loads[1]])

    def linearise_joint(self, interface_stiffness: Array, bolt_stiffness: float) -> "LinearJoint":
        """Linearise the joint, with springs as interface, and solve for unit motions.

        interface_stiffness : stiffness per area (q, 3) [N/m3] of the interface along x, y, z
        bolt_stiffness      : stiffness of each bolt [N/m]

        Raises RuntimeError if a body can move freely.
        """
        bodies = _block_diagonal(*self.stiffness_matrices)
        opening = [self.relative_displacement_matrix(axis) for axis in AXIS_INDICES]
        weights = [
            sp.diags(self.contact_interface.quadrature_area * interface_stiffness[:, axis])
            for axis in AXIS_INDICES
        ]
        contact = sum(b.T @ w @ b for b, w in zip(opening, weights, strict=True))
        shanks = (
            bolt_stiffness * sp.csr_matrix(self.elongation_matrix) @ sp.csr_matrix(self.elongation_matrix.T)
        )
        return LinearJoint(
            self, bodies, contact, shanks, bolt_stiffness, *self._solve_unit_motions(bodies, contact + shanks)
        )

    def _solve_unit_motions(
        self, body_stiffness_matrix: sp.csr_matrix, connection_matrix: sp.csr_matrix
    ) -> tuple[Array, Array, IndexArray, SymmetricFactorisation]:
        """Solve for unit translations and rotations of side 2's attachment about the centroid of the contact.

        body_stiffness_matrix : (n, n) [N/m] of the bodies
        connection_matrix     : stiffness (n, n) [N/m] of interface and bolts

        Returns the displacement (n, 6) of the elastic bodies, the displacement (n, 6) of rigid bodies, the
        free unknowns, and the factorisation of their stiffness matrix.
        """
        first, second = self.bodies
        x, y = self.contact_interface.centroid
        rigid = np.concatenate(
            [np.zeros((first.unknown_count, 6)), second.rigid_body_motions((float(x), float(y)))]
        )
        prescribed = np.concatenate(
            [self.attachment_unknowns[0], first.unknown_count + self.attachment_unknowns[1]]
        )
        free = np.setdiff1d(np.arange(rigid.shape[0]), prescribed)
        displacement = np.zeros_like(rigid)
        displacement[prescribed] = rigid[prescribed]
        matrix = (body_stiffness_matrix + connection_matrix)[free][:, free]
        factor = SymmetricFactorisation(matrix, find_reflections(matrix, self.bodies, free))
        loads = body_stiffness_matrix @ displacement + connection_matrix @ displacement
        displacement[free] = -factor.solve_linear_system(loads[free])
        return displacement, rigid, free, factor


def _block_diagonal(first_matrix: sp.csr_matrix, second_matrix: sp.csr_matrix) -> sp.csr_matrix:
    """Block diagonal matrix of two square stiffness matrices."""
    size = first_matrix.shape[0]
    indices = np.concatenate([first_matrix.indices, second_matrix.indices + size])
    starts = np.concatenate([first_matrix.indptr, second_matrix.indptr[1:] + first_matrix.nnz])
    data = np.concatenate([first_matrix.data, second_matrix.data])
    return sp.csr_matrix((data, indices, starts), shape=(size + second_matrix.shape[0],) * 2)


@dataclass(frozen=True)
class LinearJoint:
    """Linear model of a joint: the interface is a layer of springs.

    body_stiffness_matrix, contact_stiffness_matrix, bolt_stiffness_matrix : (n, n) [N/m] of bodies,
        interface, bolts
    bolt_stiffness : stiffness of each bolt [N/m]
    unit_motion_displacement : displacement (n, 6) for 3 unit translations and 3 unit rotations of side 2's
        attachment, about the centroid of the contact
    rigid_displacement : displacement (n, 6) for the same motions if the bodies were rigid
    free_unknowns : unknowns that no attachment prescribes
    stiffness_factor : factorisation of the stiffness matrix of the free unknowns
    """

    joint_model: JointFiniteElements
    body_stiffness_matrix: sp.csr_matrix
    contact_stiffness_matrix: sp.csr_matrix
    bolt_stiffness_matrix: sp.csr_matrix
    bolt_stiffness: float
    unit_motion_displacement: Array
    rigid_displacement: Array
    free_unknowns: IndexArray
    stiffness_factor: SymmetricFactorisation

    def solve_displacements(self, load_cases: Array) -> Array:
        """Displacements (n, s) [m] of the bodies in s load cases (n, s) [N], with both attachments fixed."""
        displacement = np.zeros_like(load_cases)
        displacement[self.free_unknowns] = self.stiffness_factor.solve_linear_system(
            load_cases[self.free_unknowns]
        )
        return displacement

    @cached_property
    def stiffness_matrix(self) -> Array:
        """Stiffness matrix (6, 6) [N/m, N, N.m] of the joint about the centroid of its contact."""
        displacement = self.unit_motion_displacement
        forces = (
            m @ displacement
            for m in (self.contact_stiffness_matrix, self.body_stiffness_matrix, self.bolt_stiffness_matrix)
        )
        return np.asarray(displacement.T @ sum(forces))

    def compliances(self) -> Compliances:
        """Compliances of the joint about its contact centroid, by source: interface, members, bolts."""
        sources, total = (
            (self.contact_stiffness_matrix, self.body_stiffness_matrix, self.bolt_stiffness_matrix),
            np.diag(self.stiffness_matrix),
        )
        stored = np.stack(
            [
                np.sum(self.unit_motion_displacement * (matrix @ self.unit_motion_displacement), axis=0)
                for matrix in sources
            ]
        )
        contact, bolts = (
            np.diag(self.rigid_displacement.T @ (matrix @ self.rigid_displacement))
            for matrix in (self.contact_stiffness_matrix, self.bolt_stiffness_matrix)
        )
        bolt_force = (
            self.bolt_stiffness
            * (self.joint_model.elongation_matrix.T @ self.unit_motion_displacement)
            @ np.linalg.inv(self.stiffness_matrix)
        )
        return Compliances(stored / total**2, 1.0 / contact, bolts, bolt_force)
