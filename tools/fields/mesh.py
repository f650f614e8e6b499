"""Mesh of a nodal result: faces of the cells, connected bodies, and the area of each node.

Cell types and node orders are those of meshio. A joint sums a nonlinear function of the nodal pressure, the
stiffness k(p), so every node needs a positive area. The integrals of the shape functions are positive for
linear faces only: they are zero at the corners of quadratic triangles and negative at the corners of
quadratic quadrilaterals. A quadratic face is therefore divided into linear faces between its nodes. The sums
then follow the trapezoidal rule on all nodes, with second order in the node distance.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from jointfmu.quantity import Array

from .nodal_result import NodalResult, Nodes

CUTS: dict[int, tuple[tuple[int, ...], ...]] = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2, 3),),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6, 7)),
    9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
"""{number of nodes of a face: corners of the linear faces into which it is divided}."""
CORNERS = {3: 3, 4: 4, 6: 3, 8: 4, 9: 4}
_GAUSS = 1.0 / np.sqrt(3.0)


def nodal_areas(place: Array, faces: Sequence[Nodes]) -> Array:
    """Area (n) [m2] of each node: the integral of its shape functions over the faces; 0 without a face.

    position : (n, 2) [m] in the contact plane
    faces    : blocks (k, nodes of a face) of node indices
    """
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
"""{cell type: (number of corners, corners of each face, edges in the order of their mid-side nodes)}."""
SURFACES = {"triangle": 3, "quad": 4, "triangle6": 6, "quad8": 8, "quad9": 9}
NODES = SURFACES | {name: corners + len(edges) for name, (corners, _, edges) in VOLUMES.items()}
"""{cell type: number of nodes}."""
PASSED = ("vertex", "line", "line3")
"""Cell types without area; they are ignored."""


def boundary(cells: Mapping[str, Nodes]) -> list[Nodes]:
    """Boundary faces of the volume cells: faces of one cell only. Without volumes: the surface cells."""
    volumes = {name: block for name, block in cells.items() if name in VOLUMES}
    if not volumes:
        return [block for name, block in cells.items() if name in SURFACES]
    by_size: dict[int, list[Nodes]] = {}
    for name, block in volumes.items():
        for face in _faces(name):
            by_size.setdefault(len(face), []).append(block[:, face])
    return [_single(np.concatenate(blocks), size) for size, blocks in by_size.items()]


def _faces(name: str) -> list[tuple[int, ...]]:
    """Node indices of each face of a cell type: corners, then mid-side nodes."""
    corners, faces, edges = VOLUMES[name]
    middle = {tuple(sorted(edge)): corners + i for i, edge in enumerate(edges)}
    if not middle:
        return list(faces)
    return [
        (*f, *(middle[tuple(sorted((a, b)))] for a, b in zip(f, (*f[1:], f[0]), strict=True))) for f in faces
    ]


def _single(faces: Nodes, size: int) -> Nodes:
    """Select the faces, of (k, size), that occur only once."""
    keys = np.sort(faces[:, : CORNERS[size]], axis=1)
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    return np.asarray(faces[np.sort(first[count == 1])])


def bodies(cells: Mapping[str, Nodes], nodes: int) -> NDArray[np.int64]:
    """Number (n) of the body of each node: cells that share a node belong to the same body."""
    rows = []
    for block in cells.values():
        rows.append(np.stack([np.repeat(block[:, :1], block.shape[1] - 1, axis=1), block[:, 1:]], axis=-1))
    pairs = np.concatenate([row.reshape(-1, 2) for row in rows])
    links = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(nodes, nodes))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)


@dataclass(frozen=True, slots=True)
class FiniteElementMesh:
    """Nodes and cells of a mesh.

    numbers  : (n) node numbers in the file
    position : (n, 3) in the unit of the file
    cells    : {cell type of meshio: (k, m) indices of nodes in these arrays}, surfaces or volumes
    """

    names: NDArray[np.int64]
    place: Array
    cells: Mapping[str, Nodes]

    @classmethod
    def of(
        cls, path: Path, names: NDArray[np.int64], place: Array, rows: Mapping[str, Sequence[Sequence[int]]]
    ) -> "FiniteElementMesh":
        """Mesh from {cell type: node numbers of each cell}; ValueError if a node is not defined."""
        order = np.argsort(names)
        cells = {}
        for kind, corners in rows.items():
            wanted = np.array(corners, dtype=np.int64)
            index = order[np.minimum(np.searchsorted(names, wanted, sorter=order), names.size - 1)]
            if np.any(missing := names[index] != wanted):
                raise ValueError(
                    f"{path}: node {wanted[missing][0]} of an element is not there; expected elements of the "
                    "nodes in the file"
                )
            cells[kind] = index.astype(np.intp)
        return cls(names, place, cells)

    def faces(self) -> list[Nodes]:
        """Surface cells, or the boundary faces of the volume cells."""
        return boundary(self.cells)

    def body(self) -> NDArray[np.int64]:
        """Number (n) of the body of each node."""
        return bodies(self.cells, self.names.size)

    def values(self, listed: Mapping[int, float]) -> Array:
        """Nodal values (n) from {node number: value}; NaN for nodes without a value."""
        return np.array([listed.get(name, np.nan) for name in self.names.tolist()])

    def stray(self, nodes: Iterable[int]) -> set[int]:
        """Node numbers that the mesh does not have."""
        return set(nodes) - set(self.names.tolist())

    def result(
        self, path: Path, listed: Mapping[int, float], length: float, pressure: float, left_out: bool = False
    ) -> NodalResult:
        """Nodal result from pressures that the file `path` lists.

        listed_values    : {node number: pressure in the unit of the file}
        length_unit, pressure_unit : units of mesh and listing in SI units
        omits_open_nodes : True: the listing leaves out open nodes. False: the contact consists of the faces
                           whose corners are all listed
        """
        p = self.values(listed)
        return NodalResult(
            path=path,
            word="node",
            names=self.names,
            place=self.place * length,
            pressure=p * pressure,
            faces=self.faces() if left_out else listed_faces(self.faces(), p),
            body=self.body(),
            left_out=left_out,
        )


def listed_faces(faces: Sequence[Nodes], values: Array) -> list[Nodes]:
    """Faces whose corners all have a value, from nodal values (n) with NaN for none."""
    has_value = np.isfinite(values)
    selected = [block[np.all(has_value[block[:, : CORNERS[block.shape[1]]]], axis=1)] for block in faces]
    return [block for block in selected if block.size]


def no_reader(path: Path, error: ImportError) -> ValueError:
    """Error for a missing package that is needed to read a file."""
    return ValueError(
        f"the package {error.name} is missing, needed to read {path}; "
        "install it with: pip install 'jointfmu[field]'"
    )
