"""What part of a plane surface each node stands for, from the faces.

A field's sums are those of a nonlinear function, the stiffness k(p), so every node must have a positive
area. Those consistent with the shape functions (their integrals) are positive for linear faces only: they
are zero at the corners of quadratic triangles and negative at those of quadratic quadrilaterals. A quadratic
face is therefore cut through its nodes into linear ones. The sums are those of the trapezoidal rule on all
nodes, second order in their distance, as with linear faces on the same nodes.
"""

from collections.abc import Sequence

import numpy as np

from jointfmu.quantity import Array

from .nodal_result import Nodes

CUTS: dict[int, tuple[tuple[int, ...], ...]] = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2, 3),),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6, 7)),
    9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
"""Linear faces into which a face with so many nodes is cut."""
CORNERS = {3: 3, 4: 4, 6: 3, 8: 4, 9: 4}
_GAUSS = 1.0 / np.sqrt(3.0)


def nodal_areas(place: Array, faces: Sequence[Nodes]) -> Array:
    """Area (n) [m2] of each node, from faces and places (n, 2) [m] in the plane; zero where there is none."""
    area = np.zeros(len(place))
    for block in faces:
        for cut in CUTS[block.shape[1]]:
            nodes = block[:, cut]
            weights = _quadrilaterals(place[nodes]) if len(cut) == 4 else _triangles(place[nodes])
            area += np.bincount(nodes.ravel(), weights.ravel(), len(place))
    return area


def _triangles(corners: Array) -> Array:
    """Integrals (k, 3) of the shape functions of triangles with corners (k, 3, 2)."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return np.repeat(area[:, None] / 3.0, 3, axis=1)


def _quadrilaterals(corners: Array) -> Array:
    """Integrals (k, 4) of the bilinear shape functions of quadrilaterals with corners (k, 4, 2)."""
    total = np.zeros(corners.shape[:2])
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for u, v in signs * _GAUSS:
        along, across = 1.0 + signs[:, 0] * u, 1.0 + signs[:, 1] * v
        slopes = 0.25 * np.stack([signs[:, 0] * across, signs[:, 1] * along])
        jacobian = np.einsum("dn,knc->kdc", slopes, corners)
        total += np.abs(np.linalg.det(jacobian))[:, None] * 0.25 * along * across
    return total
