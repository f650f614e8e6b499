"""Factorisation of the stiffness matrix of symmetric bodies: one small factor for each symmetry class.

Displacements of symmetric bodies split into classes, each symmetric or antisymmetric in every reflection. The
classes decouple. With two reflections, each of the four classes has a quarter of the unknowns.
"""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from jointfmu.quantity import Array

from .elasticity import CholeskyFactor, ElasticBody, IndexArray
from .geometry import LENGTH_TOLERANCE

REFLECTED_AXES = ((0,), (1,), (2,), (0, 2))
"""Axes of the reflections that bodies may have. The last one is half a turn about y: it maps a joint between
opposite edges to itself, with the sides exchanged."""
MAX_RELATIVE_MATRIX_ASYMMETRY = 1e-9
"""Largest asymmetry of a symmetric stiffness matrix over its largest product with a displacement [1]."""
ROUND_OFF_OVER_LARGEST_LOAD = 1e-14
"""Part of a load over the largest load [1] below which the part is round-off."""


class SymmetricFactorisation:
    """Factorisation of a symmetric positive definite matrix (n, n) that reflections do not change.

    reflections : signed permutation matrices (n, n) [1]; none: the complete matrix is factorised
    """

    def __init__(self, stiffness_matrix: sp.csr_matrix, reflections: Sequence[sp.csr_matrix]) -> None:
        bases = [
            _symmetry_basis(stiffness_matrix.shape[0], class_)
            for class_ in _combine_reflection_signs(reflections)
        ]
        # the product of the matrix and a class is in the class: one row of each image is enough
        self._factors = [
            CholeskyFactor(_representative_rows(basis) @ stiffness_matrix @ basis) for basis in bases
        ]
        self._ends = np.cumsum([basis.shape[1] for basis in bases])[:-1]
        self._transform = sp.hstack(bases, format="csr")
        self._transposed = self._transform.T.tocsr()

    def solve_linear_system(self, right_side: Array | sp.csc_matrix) -> Array:
        """Solve `matrix @ x = right_side` for x (n, k)."""
        loads = self._transposed @ right_side
        coordinates = np.zeros(loads.shape)
        largest = _largest_in_columns(right_side)
        starts = np.append(0, self._ends), np.append(self._ends, loads.shape[0])
        for factor, start, end in zip(self._factors, *starts, strict=True):
            part = loads[start:end]
            # most loads of a symmetric joint are of one class: in the others, they are round-off
            loaded = _largest_in_columns(part) > ROUND_OFF_OVER_LARGEST_LOAD * largest
            if np.any(loaded):
                coordinates[start:end, loaded] = factor.solve_linear_system(part[:, loaded])
        return np.asarray(self._transform @ coordinates)


def find_reflections(
    stiffness_matrix: sp.csr_matrix, bodies: Sequence[ElasticBody], matrix_unknowns: IndexArray
) -> list[sp.csr_matrix]:
    """Reflections of the nodes of bodies that do not change a stiffness matrix.

    A reflection in z exchanges two bodies. Returns independent signed permutation matrices (n, n) of the n
    unknowns of the matrix.

    matrix_unknowns : (n) indices of the unknowns of the matrix among all unknowns of the bodies
    """
    position = np.concatenate([body.node_positions.T for body in bodies])
    # bodies share positions on the contact: a fourth coordinate separates them
    side = np.repeat(np.linspace(-1.0, 1.0, len(bodies)), [body.node_positions.shape[1] for body in bodies])
    position = np.column_stack([position, np.ptp(position) * side])
    tree = cKDTree(position)
    number = np.full(3 * len(position), -1)
    number[matrix_unknowns] = np.arange(matrix_unknowns.size)
    displacement = np.random.default_rng(1).standard_normal(matrix_unknowns.size)
    force = stiffness_matrix @ displacement
    found: list[sp.csr_matrix] = []
    reflected: set[int] = set()
    for axes in REFLECTED_AXES:
        sign = np.where(np.isin([0, 1, 2, 2], axes), -1.0, 1.0)
        distance, image_node = tree.query(position * sign)
        image = number[(3 * image_node[:, None] + np.arange(3)).ravel()[matrix_unknowns]]
        if reflected.issuperset(axes) or distance.max() > LENGTH_TOLERANCE or image.min() < 0:
            continue
        signs = sign[matrix_unknowns % 3]
        reflection = sp.csr_matrix((signs, (np.arange(image.size), image)), shape=stiffness_matrix.shape)
        change = reflection @ force - stiffness_matrix @ (reflection @ displacement)
        if np.abs(change).max() < MAX_RELATIVE_MATRIX_ASYMMETRY * np.abs(force).max():
            found.append(reflection)
            reflected.update(axes)
    return found


def _largest_in_columns(stiffness_matrix: Array | sp.spmatrix) -> Array:
    """Largest absolute value (k) in each column of a matrix (n, k)."""
    largest = abs(stiffness_matrix).max(axis=0)
    return largest.toarray().ravel() if sp.issparse(largest) else largest


def _combine_reflection_signs(reflections: Sequence[sp.csr_matrix]) -> Iterator[list[sp.csr_matrix]]:
    """Yield the reflections times 1 (symmetric displacements) or -1 (antisymmetric), in each combination."""
    for signs in product((1.0, -1.0), repeat=len(reflections)):
        yield [sign * reflection for sign, reflection in zip(signs, reflections, strict=True)]


def _symmetry_basis(unknown_count: int, signed_reflections: Sequence[sp.csr_matrix]) -> sp.csc_matrix:
    """Orthonormal basis (size, m) [1] of the displacements that signed reflections do not change."""
    projection = sp.identity(unknown_count, format="csr")
    for reflection in signed_reflections:
        projection = 0.5 * (projection + reflection @ projection)
    projection = projection.tocsc()
    projection.eliminate_zeros()
    projection.sort_indices()
    # unknowns that are images of each other have the same column, up to its sign: the first of them keeps it
    filled = np.flatnonzero(np.diff(projection.indptr))
    columns = projection[:, filled[projection.indices[projection.indptr[filled]] == filled]]
    norm = np.sqrt(columns.multiply(columns).sum(axis=0))
    return (columns @ sp.diags(1.0 / np.asarray(norm).ravel())).tocsc()


def _representative_rows(symmetry_basis: sp.csc_matrix) -> sp.csr_matrix:
    """Matrix (m, n) [1] that maps a displacement in the span of a basis (n, m) to its coordinates.

    Each coordinate is read from one row: the first one in the column of the basis.
    """
    first = symmetry_basis.indptr[:-1]
    entries = (
        1.0 / symmetry_basis.data[first],
        (np.arange(symmetry_basis.shape[1]), symmetry_basis.indices[first]),
    )
    return sp.csr_matrix(entries, shape=symmetry_basis.shape[::-1])
