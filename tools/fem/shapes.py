"""Shapes of modes for ParaView."""

import numpy as np

from .elasticity import Array, ElasticBody, Index
from .modes import NaturalModes
from .vtu import packed


def vtu(bodies: tuple[ElasticBody, ...], modes: NaturalModes) -> bytes:
    """Hexahedra of both bodies; at their corners one displacement [m] per mode, of 1 m at most.

    bodies : as in jointfmu_tools.fem.modes; a mirror image is drawn too
    """
    from skfem.io.meshio import to_meshio

    parts = [(body.mesh.p.T, to_meshio(body.mesh).cells[0].data) for body in bodies]
    if len(parts) == 1:
        points, cells = parts[0]
        parts.insert(0, (points * np.array([1.0, 1.0, -1.0]), cells))
    counts = [len(points) for points, _ in parts]
    data = {}
    for i, (frequency, shape) in enumerate(zip(modes.frequency, modes.shape, strict=True), 1):
        moved = np.concatenate([u[rows] for u, rows in zip(shape, _corners(bodies), strict=True)])
        data[f"mode {i}, {frequency:.1f} Hz"] = moved / np.linalg.norm(moved, axis=1).max()
    points = np.concatenate([points for points, _ in parts])
    cells = _outward(points, np.concatenate([parts[0][1], parts[1][1] + counts[0]]))
    return packed(points, "hexahedron", cells, data)


def _corners(bodies: tuple[ElasticBody, ...]) -> tuple[Index, Index]:
    """Rows of a shape that belong to the corners of the elements, of side 1 and side 2."""
    corners = [body.basis.nodal_dofs[0] for body in bodies]
    return corners[0], corners[-1]


def _outward(points: Array, cells: Index) -> Index:
    """Hexahedra whose first face sees the second one on its positive side, as VTK wants them."""
    a, b, d, e = (points[cells[:, k]] for k in (0, 1, 3, 4))
    wrong = np.einsum("ij,ij->i", np.cross(b - a, d - a), e - a) < 0.0
    return np.where(wrong[:, None], np.roll(cells, 4, axis=1), cells)
