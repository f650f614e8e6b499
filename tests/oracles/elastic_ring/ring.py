"""Thin elastic rings: curved beams in cubic Hermite elements.

Everything is per metre of axial width, small displacements on a circle of radius r with arc length s:

    stretch   eps = v' + u/r,   bending   kappa = u'' - v'/r
    energy = 1/2 integral (A eps^2 + D kappa^2) ds,

u the radial (outward) and v the tangential displacement, ' by the arc length.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from skfem import Basis, ElementLineHermite, MeshLine

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Ring:
    """Thin ring, per width: bending stiffness D [N.m] and extensional stiffness A [N/m]."""

    D: float
    A: float

    @classmethod
    def of(cls, E: float, nu: float, thickness: float) -> "Ring":
        """Wide ring (plane strain) with E [Pa], nu [1] and thickness [m]."""
        plane = E / (1.0 - nu**2)
        return cls(D=plane * thickness**3 / 12.0, A=plane * thickness)


@dataclass(frozen=True, slots=True)
class Circle:
    """Equal finite elements around a circle, with four Gauss-Legendre points each.

    theta : (q) [1] angles of the points; weight : (q) [m] arc lengths, sum 2 pi r
    value, slope, bend : (q, n) sparse, nodal values of one component to itself, d/ds and d2/ds2
    nodes : (n/2) [1] angles of the nodes; even unknowns are the values there, odd ones d/ds
    """

    radius: float
    theta: Array
    weight: Array
    value: Any
    slope: Any
    bend: Any
    nodes: Array

    @classmethod
    def of(cls, radius: float, elements: int) -> "Circle":
        """Circle of a radius [m] with a number of elements."""
        length = 2.0 * np.pi * radius
        mesh = MeshLine(np.linspace(0.0, length, elements + 1))
        basis = Basis(mesh, ElementLineHermite(), intorder=7)
        unknowns = basis.element_dofs % (2 * elements)  # the last node is the first one
        points = np.arange(basis.dx.size).reshape(basis.dx.shape)
        rows = np.broadcast_to(points, (len(unknowns), *points.shape))
        columns = np.broadcast_to(unknowns[..., None], rows.shape)

        def matrix(entries: Sequence[Array]) -> Any:
            flat = (np.stack(entries).ravel(), (rows.ravel(), columns.ravel()))
            return sparse.csr_matrix(flat, shape=(points.size, 2 * elements))

        shapes = [function[0] for function in basis.basis]
        return cls(
            radius=radius,
            theta=np.asarray(basis.global_coordinates()).ravel() / radius,
            weight=np.asarray(basis.dx).ravel(),
            value=matrix([np.asarray(s) for s in shapes]),
            slope=matrix([s.grad[0] for s in shapes]),
            bend=matrix([s.hess[0, 0] for s in shapes]),
            nodes=np.arange(elements) * 2.0 * np.pi / elements,
        )

    def stiffness(self, ring: Ring) -> Any:
        """Stiffness matrix (2n, 2n) of a ring's unknowns (u, v)."""
        stretch = sparse.hstack([self.value / self.radius, self.slope])
        bending = sparse.hstack([self.bend, -self.slope / self.radius])
        by = sparse.diags(self.weight)
        return ring.A * stretch.T @ by @ stretch + ring.D * bending.T @ by @ bending

    def load(self, radial: Array, tangential: Array) -> Array:
        """Nodal loads (2n) of tractions (q) [Pa]."""
        return np.concatenate(
            [self.value.T @ (self.weight * radial), self.value.T @ (self.weight * tangential)]
        )

    def unknowns(self, value: Callable[[Array], Array], slope: Callable[[Array], Array]) -> Array:
        """Unknowns (n) that represent a function of the angle, from its values and its derivative."""
        return np.column_stack([value(self.nodes), slope(self.nodes) / self.radius]).ravel()
