"""Frictionless unilateral contact of two elastic bodies over a rough interface.

The pressure p(delta) >= 0 of the interface depends on the approach delta of the two faces; it cannot pull.
The displacement u minimises the convex energy

    sum over the bodies (u K u / 2 - f u) + integral of V(delta) dA,   V' = p,
    delta = offset + u_z(side 1) - u_z(side 2) - gap,

with Newton's method and an exact line search. Loads and contact pressure balance on each body, so the few
supports that stop rigid-body motions carry no force. Loads that the contact cannot balance are an error.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree
from skfem import Basis, Element, ElementQuadS2, MeshQuad

from jointfmu.quantity import Array

from .balance import RigidBodyBalance
from .elasticity import ElasticBody, IndexArray
from .newton import ContactEnergy, EnergyMinimum

QUADRATURE_DEGREE = 4
"""Polynomial degree that the quadrature of the contact integrates exactly: 3 x 3 points in an element."""


class PressureLaw(Protocol):
    """Contact pressure as a function of the approach, for example a curve of jointfmu.mechanics.curve."""

    def derivatives(self, x: Array, order: int = 1) -> list[Array]:
        """Pressure [Pa] and its derivatives [Pa/m] at approaches x [m]; 0 where the contact is open."""

    def inverse(self, load: Array) -> Array:
        """Approach [m] at which the interface carries a pressure [Pa]."""


@dataclass(frozen=True)
class ContactInterface:
    """Plane contact area of two bodies: finite-element basis and quadrature points.

    finite_element_basis : finite-element basis of scikit-fem on a plane mesh [m]
    node_positions       : (2, n) [m]; the corners of the mesh come first
    interpolation_matrix : (q, n) [1] matrix from nodal values to values at the quadrature points
    quadrature_area      : (q) [m2] weight of each quadrature point
    quadrature_position  : (q, 2) [m] of the quadrature points
    """

    finite_element_basis: Basis
    node_positions: Array
    interpolation_matrix: sp.csr_matrix
    quadrature_area: Array
    quadrature_position: Array

    @property
    def centroid(self) -> Array:
        """Centroid of the contact area (2) [m]."""
        return np.asarray(self.quadrature_area @ self.quadrature_position / self.quadrature_area.sum())

    @property
    def centred_position(self) -> Array:
        """Positions (q, 2) [m] of the quadrature points relative to the centroid."""
        return self.quadrature_position - self.centroid

    @classmethod
    def from_mesh(cls, contact_mesh: MeshQuad, plane_element: Element | None = None) -> "ContactInterface":
        """Basis and quadrature points on a plane mesh of the contact area.

        plane_element : restriction of the bodies' element to the contact plane; None: quadratic
                        (ElementQuadS2), as of ElementHexS2
        """
        basis = Basis(contact_mesh, plane_element or ElementQuadS2(), intorder=QUADRATURE_DEGREE)
        count, points = basis.dx.shape
        rows = np.arange(basis.dx.size).reshape(count, points)
        shape = [np.broadcast_to(np.asarray(basis.basis[i][0]), basis.dx.shape) for i in range(basis.Nbfun)]
        columns = [np.broadcast_to(basis.element_dofs[i][:, None], rows.shape) for i in range(basis.Nbfun)]
        index = (np.tile(rows.ravel(), basis.Nbfun), np.ravel(columns))
        values = sp.csr_matrix((np.ravel(shape), index), shape=(rows.size, basis.N))
        position = np.asarray(basis.global_coordinates()).reshape(2, -1).T
        return cls(basis, basis.doflocs, values, basis.dx.ravel(), position)


@dataclass(frozen=True)
class ContactModel:
    """Contact problem of two elastic bodies, for any loads.

    bodies            : side 1 (below z = 0) and side 2; side 2 alone if side 1 and its loads are the mirror
                        image
    contact_interface : quadrature of the contact area
    pressure_law      : pressure as a function of the approach
    initial_gap       : distance [m] of the unloaded faces at positions x, y (...) [m]; None: the faces are
                        plane
    fixed_unknowns    : unknowns of each body that stay zero and may carry load. None: the fewest that stop
                        its rigid-body motions; the loads must balance without them
    """

    bodies: tuple[ElasticBody, ...]
    contact_interface: ContactInterface
    pressure_law: PressureLaw
    initial_gap: Callable[[Array, Array], Array] | None = None
    fixed_unknowns: tuple[IndexArray, ...] | None = None

    @property
    def is_mirrored(self) -> bool:
        """Whether side 1 is the mirror image of side 2."""
        return len(self.bodies) == 1

    def approach_matrices(self) -> list[sp.csr_matrix]:
        """Matrices (contact nodes, n) [1] of each body: approach at the contact nodes per displacement."""
        signs = (-2.0,) if self.is_mirrored else (1.0, -1.0)
        return [
            s * nodal_displacement_matrix(body, self.contact_interface)
            for s, body in zip(signs, self.bodies, strict=True)
        ]

    def unloaded_gap(self, x: Array, y: Array) -> Array:
        """Distance [m] of the unloaded faces at positions x, y (...) [m]."""
        return np.zeros(np.shape(x)) if self.initial_gap is None else self.initial_gap(x, y)

    def supported_unknowns(self) -> tuple[IndexArray, ...]:
        """Unknowns of each body (displacements of its nodes) that stay zero."""
        if self.fixed_unknowns is not None:
            return self.fixed_unknowns
        return tuple(
            _select_supports(body, stops_all_motions=i == 0 and not self.is_mirrored)
            for i, body in enumerate(self.bodies)
        )

    @cached_property
    def _free_unknowns(self) -> tuple[IndexArray, ...]:
        """Unknowns of each body (displacements of its nodes) that are not fixed."""
        pairs = zip(self.bodies, self.supported_unknowns(), strict=True)
        return tuple(np.setdiff1d(np.arange(body.unknown_count), fixed) for body, fixed in pairs)

    @cached_property
    def _unloaded_energy(self) -> ContactEnergy:
        """Energy of bodies and contact as a function of the free unknowns, without loads."""
        blocks = [
            body.stiffness_matrix[free][:, free]
            for body, free in zip(self.bodies, self._free_unknowns, strict=True)
        ]
        traces = [
            trace[:, free] for trace, free in zip(self.approach_matrices(), self._free_unknowns, strict=True)
        ]
        return ContactEnergy(
            stiffness_matrix=blocks[0] if self.is_mirrored else sp.block_diag(blocks, format="csr"),
            load_vector=np.zeros(sum(free.size for free in self._free_unknowns)),
            displacement_to_approach_matrix=(
                self.contact_interface.interpolation_matrix @ sp.hstack(traces)
            ).tocsr(),
            quadrature_area=self.contact_interface.quadrature_area * (0.5 if self.is_mirrored else 1.0),
            pressure_law=self.pressure_law.derivatives,
        )

    def solve_equilibrium(
        self,
        nodal_loads: Sequence[Array],
        initial_pressure: float,
        initial_solution: "ContactSolution | None" = None,
    ) -> "ContactSolution":
        """Solve for the equilibrium under loads (n) [N] on each body.

        initial_pressure : [Pa] > 0, uniform, from which Newton's method starts
        initial_solution : equilibrium of this model under other loads; if given, Newton's method starts there

        Raises
        ------
        RuntimeError : there is no equilibrium: the contact cannot balance the loads, or a body is not held
        """
        balance = self.rigid_body_balance(nodal_loads)
        balance.check_loads()
        gap = self.unloaded_gap(*self.contact_interface.quadrature_position.T)
        offset = (
            float(self.pressure_law.inverse(np.asarray(initial_pressure))) + float(gap.max())
            if initial_solution is None
            else initial_solution.approach_offset
        )
        free_load = np.concatenate(
            [load[free] for load, free in zip(nodal_loads, self._free_unknowns, strict=True)]
        )
        energy = replace(self._unloaded_energy, load_vector=free_load)
        minimum = energy.minimise_energy(
            offset - gap, None if initial_solution is None else initial_solution.energy_minimum
        )
        balance.check_contact_forces(
            energy.quadrature_area * self.pressure_law.derivatives(minimum.approach, 1)[0]
        )
        return ContactSolution(
            self, tuple(nodal_loads), self._expand_displacement(minimum.displacement), offset, minimum
        )

    def _expand_displacement(self, free_displacement: Array) -> tuple[Array, ...]:
        """Displacement (n) [m] of each body, from the displacement of the free unknowns of all bodies."""
        pieces = np.split(free_displacement, np.cumsum([free.size for free in self._free_unknowns])[:-1])
        displacement = tuple(np.zeros(body.unknown_count) for body in self.bodies)
        for all_unknowns, free, values in zip(displacement, self._free_unknowns, pieces, strict=True):
            all_unknowns[free] = values
        return displacement

    def rigid_body_balance(self, nodal_loads: Sequence[Array]) -> RigidBodyBalance:
        """Generalised forces of loads (n) [N] and contact on the rigid-body motions of the bodies."""
        interface = self.contact_interface
        return RigidBodyBalance.from_loads(
            self.bodies,
            [interface.interpolation_matrix @ trace for trace in self.approach_matrices()],
            nodal_loads,
            self.supported_unknowns(),
            interface.quadrature_position,
            supports_carry_load=self.fixed_unknowns is not None,
        )


@dataclass(frozen=True)
class ContactSolution:
    """Equilibrium of two bodies in contact.

    nodal_loads         : (n) [N] on each body
    nodal_displacements : (n) [m] of each body, three values per node
    approach_offset     : [m] approach at zero displacement where the gap is zero
    energy_minimum      : minimum of the energy
    """

    contact_model: ContactModel
    nodal_loads: tuple[Array, ...]
    nodal_displacements: tuple[Array, ...]
    approach_offset: float
    energy_minimum: EnergyMinimum

    @property
    def approach(self) -> Array:
        """Approach (q) [m] at the quadrature points."""
        return self.energy_minimum.approach

    @property
    def newton_steps(self) -> int:
        """Number of steps that Newton's method took."""
        return self.energy_minimum.newton_steps

    @property
    def pressure(self) -> Array:
        """Contact pressure (q) [Pa] at the quadrature points."""
        return self.contact_model.pressure_law.derivatives(self.approach, 1)[0]

    @property
    def contact_stiffness(self) -> Array:
        """Normal stiffness per area (q) [Pa/m] of the interface at the q quadrature points."""
        return self.contact_model.pressure_law.derivatives(self.approach, 1)[1]

    @cached_property
    def nodal_approach(self) -> Array:
        """Approach (contact nodes) [m] at the nodes of the contact."""
        nodes = self.contact_model.contact_interface.node_positions
        pairs = zip(self.contact_model.approach_matrices(), self.nodal_displacements, strict=True)
        elastic_approach = sum((trace @ u for trace, u in pairs), start=np.zeros(nodes.shape[1]))
        return np.asarray(self.approach_offset - self.contact_model.unloaded_gap(*nodes) + elastic_approach)

    @property
    def nodal_pressure(self) -> Array:
        """Pressure [Pa] at the nodes of the contact; some of them lie on its edges."""
        return self.contact_model.pressure_law.derivatives(self.nodal_approach, 1)[0]

    def pressure_at(self, contact_positions: Array) -> Array:
        """Contact pressure [Pa] at k positions (k, 2) [m] in the contact."""
        approach = self.contact_model.contact_interface.finite_element_basis.interpolator(
            self.nodal_approach
        )(np.asarray(contact_positions).T)
        return self.contact_model.pressure_law.derivatives(approach, 1)[0]


def displacement_matrix(
    body: ElasticBody, contact_interface: ContactInterface, axis_index: int = 2
) -> sp.csr_matrix:
    """Matrix (q, n) [1]: displacement along an axis at the quadrature points per unknown of a body."""
    return (
        contact_interface.interpolation_matrix
        @ nodal_displacement_matrix(body, contact_interface, axis_index)
    ).tocsr()


def nodal_displacement_matrix(
    body: ElasticBody, contact_interface: ContactInterface, axis_index: int = 2
) -> sp.csr_matrix:
    """Matrix (contact nodes, n) [1]: displacement along an axis at the contact nodes per unknown of a body.

    Raises RuntimeError if a node of the contact is not a node of the body.
    """
    contact_nodes = np.vstack(
        [contact_interface.node_positions, np.zeros((1, contact_interface.node_positions.shape[1]))]
    )
    distance, node = cKDTree(body.node_positions.T).query(contact_nodes.T)
    if distance.max() > 1e-9:
        raise RuntimeError(
            f"mesh: a contact node is {distance.max():g} m away from the nodes of the body; try another "
            "--refinement"
        )
    ones = np.ones(node.size)
    return sp.csr_matrix(
        (ones, (np.arange(node.size), 3 * node + axis_index)), shape=(node.size, body.unknown_count)
    )


def _select_supports(body: ElasticBody, stops_all_motions: bool) -> IndexArray:
    """Select three unknowns of a body that stop its rigid-body motions in the contact plane.

    stops_all_motions : add three unknowns that stop the motion along z and the rotations about x and y.
        Without these three, the body rests on the contact.
    """
    x, y, z = body.node_positions
    first, second, third = (int(np.argmin(a * x + b * y + 1e-3 * z)) for a, b in ((1, 1), (-1, 1), (1, -1)))
    unknowns = [3 * first, 3 * first + 1, 3 * second + 1]
    return np.array(
        unknowns + [3 * node + 2 for node in (first, second, third)] if stops_all_motions else unknowns
    )
