"""Linear elasticity of a body on quadratic hexahedra (scikit-fem), and the sparse Cholesky factorisation of
its stiffness matrices (CHOLMOD, called through CVXOPT).
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from skfem import Basis, Element, ElementHexS2, FacetBasis, LinearForm, MeshHex
from skfem.models.elasticity import lame_parameters

from jointfmu.quantity import Array


class CholeskyFactor:
    """Supernodal Cholesky factor of a sparse symmetric positive definite matrix.

    positive_definite_matrix : (n, n) scipy.sparse; only its lower triangle is read

    Raises
    ------
    RuntimeError : the matrix is not positive definite
    """

    def __init__(self, positive_definite_matrix: sp.spmatrix) -> None:
        from cvxopt import cholmod

        cholmod.options["supernodal"] = 2
        packed = _convert_to_cvxopt(sp.tril(positive_definite_matrix))
        self._factor = cholmod.symbolic(packed)
        try:
            cholmod.numeric(packed, self._factor)
        except ArithmeticError:
            raise RuntimeError(
                "a stiffness matrix is not positive definite: a body can move freely"
            ) from None

    def solve_linear_system(self, right_side: Array | sp.spmatrix) -> Array:
        """Solve `matrix @ x = right_side` for x (n) or (n, k), with the factor of the matrix.

        Sparse right-hand sides take half the time of dense ones: CVXOPT solves four sparse columns at once,
        but dense columns one by one.
        """
        from cvxopt import cholmod
        from cvxopt import matrix as dense

        if sp.issparse(right_side):
            blocks = (
                right_side[:, first : first + MAX_SPARSE_RIGHT_SIDES]
                for first in range(0, right_side.shape[1], MAX_SPARSE_RIGHT_SIDES)
            )
            return np.hstack(
                [
                    np.array(dense(cholmod.spsolve(self._factor, _convert_to_cvxopt(block))))
                    for block in blocks
                ]
            )
        x = dense(np.asfortranarray(right_side, dtype=np.float64))
        cholmod.solve(self._factor, x)
        return np.array(x).reshape(right_side.shape)


MAX_SPARSE_RIGHT_SIDES = 32
"""Largest number of sparse right-hand sides in one call: their solutions are in memory twice."""


def _convert_to_cvxopt(sparse_matrix: sp.spmatrix) -> Any:
    """Convert a sparse matrix (n, k) of scipy to one of CVXOPT."""
    from cvxopt import matrix as dense
    from cvxopt import spmatrix

    entries = sparse_matrix.tocoo()
    rows, columns = (dense(indices.astype(np.int64)) for indices in (entries.row, entries.col))
    return spmatrix(dense(entries.data), rows, columns, entries.shape)


IndexArray = NDArray[np.int64]
"""Array of indices."""

QUADRATURE_DEGREE = 4
"""Polynomial degree that the quadrature integrates exactly: 3 x 3 x 3 points in an element."""
ELEMENTS_PER_BLOCK = 4096
"""Number of elements whose matrices are computed in one array operation."""


@dataclass(frozen=True)
class ElasticBody:
    """Finite-element model of an elastic body: serendipity hexahedra (20 nodes), three unknowns per node.

    mesh    : mesh of scikit-fem [m]
    E       : Young's modulus [Pa]
    nu      : Poisson's ratio [1]
    density : [kg/m3]
    element : scalar nodal element of scikit-fem
    """

    mesh: MeshHex
    E: float
    nu: float
    density: float
    element: Element = field(default_factory=ElementHexS2)

    @cached_property
    def finite_element_basis(self) -> Basis:
        """Scalar finite-element basis. The displacement component k at node i is unknown 3 i + k."""
        return Basis(self.mesh, self.element, intorder=QUADRATURE_DEGREE)

    @property
    def unknown_count(self) -> int:
        """Number of unknowns (three per node)."""
        return 3 * int(self.finite_element_basis.N)

    @property
    def node_positions(self) -> Array:
        """Positions (3, n) [m] of the nodes."""
        return np.asarray(self.finite_element_basis.doflocs)

    @cached_property
    def stiffness_matrix(self) -> sp.csr_matrix:
        """Stiffness matrix (n, n) [N/m] of the unsupported body.

        The integrals are those of skfem.models.elasticity.linear_elasticity. One matrix product gives all
        entries of an element matrix: 35 times faster than the assembly of that form.
        """
        lame, shear = lame_parameters(self.E, self.nu)
        count = self.mesh.nelements
        return _assemble_global_matrix(
            self.finite_element_basis,
            [
                self._element_matrices(slice(i, i + ELEMENTS_PER_BLOCK), lame, shear)
                for i in range(0, count, ELEMENTS_PER_BLOCK)
            ],
        )

    def _element_matrices(self, element_slice: slice, lame_lambda: float, shear_modulus: float) -> Array:
        """Stiffness matrices (m, 20, 20, 3, 3) [N/m] of the selected elements."""
        functions = range(self.finite_element_basis.Nbfun)
        gradient = np.stack([self.finite_element_basis.basis[i][0].grad[:, element_slice] for i in functions])
        n, _, m, _ = gradient.shape
        rows = np.ascontiguousarray(gradient.transpose(2, 0, 1, 3)).reshape(m, 3 * n, -1)
        product = (
            (rows * self.finite_element_basis.dx[element_slice, None, :]) @ rows.transpose(0, 2, 1)
        ).reshape(m, n, 3, n, 3)
        product = product.transpose(0, 1, 3, 2, 4)
        matrix = lame_lambda * product + shear_modulus * product.transpose(0, 1, 2, 4, 3)
        trace = shear_modulus * np.trace(product, axis1=3, axis2=4)
        for k in range(3):
            matrix[..., k, k] += trace
        return np.asarray(matrix)

    @cached_property
    def mass_matrix(self) -> sp.csr_matrix:
        """Consistent mass matrix (n, n) [kg]."""
        functions = np.stack(
            [
                np.broadcast_to(
                    np.asarray(self.finite_element_basis.basis[i][0]), self.finite_element_basis.dx.shape
                )
                for i in range(self.finite_element_basis.Nbfun)
            ]
        )
        rows = functions.transpose(1, 0, 2)
        scalar = self.density * (rows * self.finite_element_basis.dx[:, None, :]) @ rows.transpose(0, 2, 1)
        return sp.kron(
            _assemble_global_matrix(self.finite_element_basis, [scalar[..., None, None]]),
            np.eye(3),
            format="csr",
        )

    def distribute_unit_force(self, loaded_facets: IndexArray) -> Array:
        """Nodal load (n) [N/N] of a unit force along z, distributed uniformly over facets."""
        basis = FacetBasis(self.mesh, self.element, facets=loaded_facets, intorder=QUADRATURE_DEGREE)
        share = LinearForm(lambda v, w: v).assemble(basis)
        load = np.zeros(self.unknown_count)
        load[2::3] = share / share.sum()
        return load

    def rigid_body_motions(self, rotation_centre: tuple[float, float] = (0.0, 0.0)) -> Array:
        """Displacements (n, 6) of unit translations [m/m] along, and unit rotations [m/rad] about, x, y, z.

        rotation_centre : (x, y) [m] of the centre of rotation, which lies in the plane z = 0
        """
        x, y, z = self.node_positions - np.array([[*rotation_centre, 0.0]]).T
        unit, zero = np.ones_like(x), np.zeros_like(x)
        motions = [
            (unit, zero, zero),
            (zero, unit, zero),
            (zero, zero, unit),
            (zero, -z, y),
            (z, zero, -x),
            (-y, x, zero),
        ]
        return np.stack([np.stack(motion, axis=1).ravel() for motion in motions], axis=1)


def _assemble_global_matrix(basis: Basis, element_matrices: list[Array]) -> sp.csr_matrix:
    """Assemble element matrices to a global sparse matrix with k x k blocks.

    element_matrices : blocks of elements; each (m, n, n, k, k): m elements, n nodes, k unknowns per node
    """
    dofs = np.asarray(basis.element_dofs.T, dtype=np.int64)
    key = (dofs[:, :, None] * basis.N + dofs[:, None, :]).ravel()
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    k = element_matrices[0].shape[-1]
    data = np.concatenate(element_matrices).reshape(-1, k * k)[order]
    data = np.add.reduceat(data, first, axis=0).reshape(-1, k, k)
    row, column = np.divmod(key[first], basis.N)
    start = np.searchsorted(row, np.arange(basis.N + 1))
    return sp.bsr_matrix((data, column, start), shape=(k * basis.N, k * basis.N)).tocsr()
