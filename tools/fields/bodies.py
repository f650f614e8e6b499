"""Boundary faces of volume cells, and which cells make one body; names and node orders are meshio's."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .nodal_result import Nodes

_TETRA = ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3))
_WEDGE = ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (0, 2, 5, 3))
_PYRAMID = ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 3, 4))
_BRICK = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 3, 7, 4))
_TETRA_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_WEDGE_EDGES = ((0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5), (0, 3), (1, 4), (2, 5))
_PYRAMID_EDGES = ((0, 1), (1, 2), (2, 3), (0, 3), (0, 4), (1, 4), (2, 4), (3, 4))
_BRICK_EDGES = (
    *((0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
_Pairs = tuple[tuple[int, ...], ...]
VOLUMES: dict[str, tuple[int, _Pairs, _Pairs]] = {
    "tetra": (4, _TETRA, ()),
    "tetra10": (4, _TETRA, _TETRA_EDGES),
    "wedge": (6, _WEDGE, ()),
    "wedge15": (6, _WEDGE, _WEDGE_EDGES),
    "pyramid": (5, _PYRAMID, ()),
    "pyramid13": (5, _PYRAMID, _PYRAMID_EDGES),
    "hexahedron": (8, _BRICK, ()),
    "hexahedron20": (8, _BRICK, _BRICK_EDGES),
}
"""Corners, faces by corners, and the edges whose middles follow the corners."""
SURFACES = {"triangle": 3, "quad": 4, "triangle6": 6, "quad8": 8, "quad9": 9}
PASSED = ("vertex", "line", "line3")
"""Cells that have no area."""


def boundary(cells: Mapping[str, Nodes]) -> list[Nodes]:
    """Faces that one volume cell alone has; the surface cells themselves if there are no volumes."""
    volumes = {name: block for name, block in cells.items() if name in VOLUMES}
    if not volumes:
        return [block for name, block in cells.items() if name in SURFACES]
    by_size: dict[int, list[Nodes]] = {}
    for name, block in volumes.items():
        for face in _faces(name):
            by_size.setdefault(len(face), []).append(block[:, face])
    return [_single(np.concatenate(blocks), size) for size, blocks in by_size.items()]


def _faces(name: str) -> list[tuple[int, ...]]:
    """Nodes of each face of a cell: corners, then the middles of its edges."""
    corners, faces, edges = VOLUMES[name]
    middle = {tuple(sorted(edge)): corners + i for i, edge in enumerate(edges)}
    if not middle:
        return list(faces)
    return [(*f, *(middle[_pair(a, b)] for a, b in zip(f, (*f[1:], f[0]), strict=True))) for f in faces]


def _pair(a: int, b: int) -> tuple[int, ...]:
    return tuple(sorted((a, b)))


def _single(faces: Nodes, size: int) -> Nodes:
    """The faces (k, size) that occur once."""
    corners = {3: 3, 4: 4, 6: 3, 8: 4}[size]
    keys = np.sort(faces[:, :corners], axis=1)
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    return np.asarray(faces[np.sort(first[count == 1])])


def bodies(cells: Mapping[str, Nodes], nodes: int) -> NDArray[np.int64]:
    """(n) number of the body that each node belongs to: cells that share a node are one."""
    rows = []
    for block in cells.values():
        rows.append(np.stack([np.repeat(block[:, :1], block.shape[1] - 1, axis=1), block[:, 1:]], axis=-1))
    pairs = np.concatenate([row.reshape(-1, 2) for row in rows])
    links = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(nodes, nodes))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)
