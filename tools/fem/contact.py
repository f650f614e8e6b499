"""Two elastic bodies pressed together over a rough interface: frictionless unilateral contact.

The interface resists the approach delta of the two faces with the pressure p(delta) >= 0 of its law
and cannot pull. The displacement u minimises the convex energy

    sum over the bodies (u K u / 2 - f u) + integral of V(delta) dA,   V' = p,
    delta = offset + u_z(side 1) - u_z(side 2) - gap,

found by Newton's method with an exact line search. Loads and contact balance on each body, so the few
supports that stop rigid motions carry nothing; loads that the contact cannot balance are refused.
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

from .balance import RigidBalance
from .elasticity import ElasticBody, Index
from .newton import Energy, Minimum

QUADRATURE = 4
"""Degree that the quadrature of the contact integrates exactly: 3 x 3 points in an element."""


class PressureLaw(Protocol):
    """Pressure over approach: a curve of jointfmu.mechanics.curve, or anything of the same kind."""

    def derivatives(self, x: Array, order: int = 1) -> list[Array]:
        """Pressure [Pa] and its derivatives [Pa/m] at approaches x [m]; 0 where the contact is open."""

    def inverse(self, load: Array) -> Array:
        """Approach [m] at which the interface carries a pressure [Pa]."""


@dataclass(frozen=True)
class Interface:
    """The plane contact: quadrature points and their interpolation from the nodes.

    basis   : of scikit-fem on a plane mesh [m]
    nodes   : (2, n) [m]; the corners of the mesh come first
    values  : (q, n) [1] interpolation from the nodes to the quadrature points
    area    : (q) [m2] weight of a quadrature point, `position` (q, 2) [m] its place
    """

    basis: Basis
    nodes: Array
    values: sp.csr_matrix
    area: Array
    position: Array

    @property
    def centroid(self) -> Array:
        """Of the contact (2) [m]."""
        return np.asarray(self.area @ self.position / self.area.sum())

    @property
    def centred(self) -> Array:
        """Places (q, 2) [m] of the quadrature points from the centroid."""
        return self.position - self.centroid

    @classmethod
    def of(cls, mesh: MeshQuad, element: Element | None = None) -> "Interface":
        """Quadrature of a plane mesh; the element is the trace of the bodies' element."""
        basis = Basis(mesh, element or ElementQuadS2(), intorder=QUADRATURE)
        count, points = basis.dx.shape
        rows = np.arange(basis.dx.size).reshape(count, points)
        shape = [np.broadcast_to(np.asarray(basis.basis[i][0]), basis.dx.shape) for i in range(basis.Nbfun)]
        columns = [np.broadcast_to(basis.element_dofs[i][:, None], rows.shape) for i in range(basis.Nbfun)]
        index = (np.tile(rows.ravel(), basis.Nbfun), np.ravel(columns))
        values = sp.csr_matrix((np.ravel(shape), index), shape=(rows.size, basis.N))
        places = np.asarray(basis.global_coordinates()).reshape(2, -1).T
        return cls(basis, basis.doflocs, values, basis.dx.ravel(), places)


@dataclass(frozen=True)
class ContactModel:
    """A contact ready to be solved.

    bodies : side 1 (below z = 0) and side 2; or side 2 alone if side 1 is its mirror image, loads too
    interface, law : the contact
    gap    : distance [m] of the unloaded faces at places x, y (...) [m]; None: they are plane
    held   : unknowns of each body that stay zero and may carry a load; None: as few as stop its rigid
             motions, and the loads need none of them
    """

    bodies: tuple[ElasticBody, ...]
    interface: Interface
    law: PressureLaw
    gap: Callable[[Array, Array], Array] | None = None
    held: tuple[Index, ...] | None = None

    @property
    def mirrored(self) -> bool:
        """Whether side 1 is the mirror image of side 2."""
        return len(self.bodies) == 1

    def traces(self) -> list[sp.csr_matrix]:
        """Approach at the nodes of the contact per displacement (n) of each body."""
        signs = (-2.0,) if self.mirrored else (1.0, -1.0)
        return [s * node_trace(body, self.interface) for s, body in zip(signs, self.bodies, strict=True)]

    def opening(self, x: Array, y: Array) -> Array:
        """Distance [m] of the unloaded faces at places (...) [m]."""
        return np.zeros(np.shape(x)) if self.gap is None else self.gap(x, y)

    def supports(self) -> tuple[Index, ...]:
        """Unknowns of each body that stay zero."""
        if self.held is not None:
            return self.held
        return tuple(
            _supports(body, fully=i == 0 and not self.mirrored) for i, body in enumerate(self.bodies)
        )

    @cached_property
    def _free(self) -> tuple[Index, ...]:
        """Unknowns of each body that move."""
        pairs = zip(self.bodies, self.supports(), strict=True)
        return tuple(np.setdiff1d(np.arange(body.size), fixed) for body, fixed in pairs)

    @cached_property
    def _unloaded(self) -> Energy:
        """The energy in the unknowns that move, without loads."""
        blocks = [body.stiffness[part][:, part] for body, part in zip(self.bodies, self._free, strict=True)]
        traces = [trace[:, part] for trace, part in zip(self.traces(), self._free, strict=True)]
        return Energy(
            stiffness=blocks[0] if self.mirrored else sp.block_diag(blocks, format="csr"),
            load=np.zeros(sum(part.size for part in self._free)),
            trace=(self.interface.values @ sp.hstack(traces)).tocsr(),
            weight=self.interface.area * (0.5 if self.mirrored else 1.0),
            law=self.law.derivatives,
        )

    def solve(
        self, loads: Sequence[Array], start: float, near: "ContactSolution | None" = None
    ) -> "ContactSolution":
        """Equilibrium under loads (n) [N] on each body, from a start with a pressure [Pa] > 0 everywhere.

        near : equilibrium of this model under other loads, to start from instead

        Raises
        ------
        RuntimeError : no equilibrium: loads that the contact cannot balance, or bodies that nothing holds
        """
        balance = self.balance(loads)
        balance.check_loads()
        gap = self.opening(*self.interface.position.T)
        offset = (
            float(self.law.inverse(np.asarray(start))) + float(gap.max()) if near is None else near.offset
        )
        given = np.concatenate([load[part] for load, part in zip(loads, self._free, strict=True)])
        energy = replace(self._unloaded, load=given)
        found = energy.minimise(offset - gap, None if near is None else near.minimum)
        balance.check_contact(energy.weight * self.law.derivatives(found.approach, 1)[0])
        return ContactSolution(self, tuple(loads), self._whole(found.displacement), offset, found)

    def _whole(self, moving: Array) -> tuple[Array, ...]:
        """Displacement (n) of each body, from that of the unknowns that move."""
        parts = np.split(moving, np.cumsum([part.size for part in self._free])[:-1])
        displacement = tuple(np.zeros(body.size) for body in self.bodies)
        for whole, free, values in zip(displacement, self._free, parts, strict=True):
            whole[free] = values
        return displacement

    def balance(self, loads: Sequence[Array]) -> RigidBalance:
        """Forces of loads (n) [N] on the rigid motions of the bodies."""
        at = self.interface
        return RigidBalance.of(
            self.bodies,
            [at.values @ trace for trace in self.traces()],
            loads,
            self.supports(),
            at.position,
            bearing=self.held is not None,
        )


@dataclass(frozen=True)
class ContactSolution:
    """Equilibrium of a contact.

    loads    : (n) [N] on each body
    displacement : (n) [m] of each body, three values per node
    offset   : [m] approach at zero displacement where the gap is zero
    minimum  : of the energy
    """

    model: ContactModel
    loads: tuple[Array, ...]
    displacement: tuple[Array, ...]
    offset: float
    minimum: Minimum

    @property
    def approach(self) -> Array:
        """(q) [m] in equilibrium."""
        return self.minimum.approach

    @property
    def steps(self) -> int:
        """How many steps Newton's method took."""
        return self.minimum.steps

    @property
    def pressure(self) -> Array:
        """(q) [Pa] at the quadrature points."""
        return self.model.law.derivatives(self.approach, 1)[0]

    @property
    def stiffness(self) -> Array:
        """(q) [Pa/m] of the interface at the quadrature points."""
        return self.model.law.derivatives(self.approach, 1)[1]

    @cached_property
    def at_nodes(self) -> Array:
        """Approach [m] at the nodes of the contact."""
        parts = zip(self.model.traces(), self.displacement, strict=True)
        moved = sum((trace @ u for trace, u in parts), start=np.zeros(self.model.interface.nodes.shape[1]))
        return np.asarray(self.offset - self.model.opening(*self.model.interface.nodes) + moved)

    @property
    def node_pressure(self) -> Array:
        """[Pa] at the nodes of the contact, which reach to its edges."""
        return self.model.law.derivatives(self.at_nodes, 1)[0]

    def pressure_at(self, places: Array) -> Array:
        """Pressure (k) [Pa] at places (k, 2) [m] of the contact."""
        approach = self.model.interface.basis.interpolator(self.at_nodes)(np.asarray(places).T)
        return self.model.law.derivatives(approach, 1)[0]


def trace(body: ElasticBody, interface: Interface, axis: int = 2) -> sp.csr_matrix:
    """Displacement along an axis at the quadrature points (q) per unknown (n) of a body."""
    return (interface.values @ node_trace(body, interface, axis)).tocsr()


def node_trace(body: ElasticBody, interface: Interface, axis: int = 2) -> sp.csr_matrix:
    """Displacement along an axis at the nodes of the contact per unknown (n) of a body."""
    flat = np.vstack([interface.nodes, np.zeros((1, interface.nodes.shape[1]))])
    distance, node = cKDTree(body.nodes.T).query(flat.T)
    if distance.max() > 1e-9:
        raise RuntimeError(f"a node of the contact lies {distance.max():g} m beside the body's nodes")
    ones = np.ones(node.size)
    return sp.csr_matrix((ones, (np.arange(node.size), 3 * node + axis)), shape=(node.size, body.size))


def _supports(body: ElasticBody, fully: bool) -> Index:
    """Unknowns that stop the rigid motions of a body in the plane, three of them.

    `fully`: with three more, against motion along z and rotations out of the plane; a body without
    these rests on the contact.
    """
    x, y, z = body.nodes
    corner, along, across = (int(np.argmin(a * x + b * y + 1e-3 * z)) for a, b in ((1, 1), (-1, 1), (1, -1)))
    unknowns = [3 * corner, 3 * corner + 1, 3 * along + 1]
    return np.array(unknowns + [3 * node + 2 for node in (corner, along, across)] if fully else unknowns)
