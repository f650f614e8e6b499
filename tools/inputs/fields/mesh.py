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

from .nodal_result import NodalResult, NodeIndices

LINEAR_FACES: dict[int, tuple[tuple[int, ...], ...]] = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2, 3),),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6, 7)),
    9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
"""{number of nodes of a face: corners of the linear faces into which it is divided}."""
FACE_CORNER_COUNTS = {3: 3, 4: 4, 6: 3, 8: 4, 9: 4}
"""{number of nodes of a face: number of its corners}."""
_GAUSS_POINT_COORDINATE = 1.0 / np.sqrt(3.0)
"""Coordinate of the Gauss points of a quadrilateral in its reference square [1]."""


def compute_nodal_areas(node_positions: Array, element_faces: Sequence[NodeIndices]) -> Array:
    """Area [m2] of each of n nodes: integral of its shape functions over the element faces; 0 without a face.

    node_positions : (n, 2) [m] in the contact plane
    element_faces  : node indices of the faces, one array (faces, nodes per face) for each shape of face
    """
    area = np.zeros(len(node_positions))
    for block in element_faces:
        for cut in LINEAR_FACES[block.shape[1]]:
            nodes = block[:, cut]
            weights = (
                _integrate_quadrilateral_shape_functions(node_positions[nodes])
                if len(cut) == 4
                else _integrate_triangle_shape_functions(node_positions[nodes])
            )
            area += np.bincount(nodes.ravel(), weights.ravel(), len(node_positions))
    return area


def _integrate_triangle_shape_functions(corner_positions: Array) -> Array:
    """Integrals [m2] of the 3 shape functions of each of k triangles: (k, 3), from corners (k, 3, 2) [m]."""
    a, b = corner_positions[:, 1] - corner_positions[:, 0], corner_positions[:, 2] - corner_positions[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return np.repeat(area[:, None] / 3.0, 3, axis=1)


def _integrate_quadrilateral_shape_functions(corner_positions: Array) -> Array:
    """Integrals [m2] of the 4 bilinear shape functions of k quadrilaterals: (k, 4); corners (k, 4, 2) [m]."""
    total = np.zeros(corner_positions.shape[:2])
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for u, v in signs * _GAUSS_POINT_COORDINATE:
        along, across = 1.0 + signs[:, 0] * u, 1.0 + signs[:, 1] * v
        slopes = 0.25 * np.stack([signs[:, 0] * across, signs[:, 1] * along])
        jacobian = np.einsum("dn,knc->kdc", slopes, corner_positions)
        total += np.abs(np.linalg.det(jacobian))[:, None] * 0.25 * along * across
    return total


_TETRA_FACES = ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3))
"""Node indices of the faces of a tetrahedron."""
_WEDGE_FACES = ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (0, 2, 5, 3))
"""Node indices of the faces of a wedge."""
_PYRAMID_FACES = ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 3, 4))
"""Node indices of the faces of a pyramid."""
_BRICK_FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 3, 7, 4))
"""Node indices of the faces of a hexahedron."""
_TETRA_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Node indices of the edges of a tetrahedron."""
_WEDGE_EDGES = ((0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5), (0, 3), (1, 4), (2, 5))
"""Node indices of the edges of a wedge."""
_PYRAMID_EDGES = ((0, 1), (1, 2), (2, 3), (0, 3), (0, 4), (1, 4), (2, 4), (3, 4))
"""Node indices of the edges of a pyramid."""
_BRICK_EDGES = (
    *((0, 1), (1, 2), (2, 3), (0, 3), (4, 5), (5, 6), (6, 7), (4, 7)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
"""Node indices of the edges of a hexahedron."""
_NodeIndexTuples = tuple[tuple[int, ...], ...]
VOLUME_CELLS: dict[str, tuple[int, _NodeIndexTuples, _NodeIndexTuples]] = {
    "tetra": (4, _TETRA_FACES, ()),
    "tetra10": (4, _TETRA_FACES, _TETRA_EDGES),
    "wedge": (6, _WEDGE_FACES, ()),
    "wedge15": (6, _WEDGE_FACES, _WEDGE_EDGES),
    "pyramid": (5, _PYRAMID_FACES, ()),
    "pyramid13": (5, _PYRAMID_FACES, _PYRAMID_EDGES),
    "hexahedron": (8, _BRICK_FACES, ()),
    "hexahedron20": (8, _BRICK_FACES, _BRICK_EDGES),
}
"""{volume cell type: (number of corners, corners of each face, edges in the order of mid-side nodes)}."""
SURFACE_CELL_NODE_COUNTS = {"triangle": 3, "quad": 4, "triangle6": 6, "quad8": 8, "quad9": 9}
"""{type of a surface cell: number of its nodes}."""
CELL_NODE_COUNTS = SURFACE_CELL_NODE_COUNTS | {
    name: corners + len(edges) for name, (corners, _, edges) in VOLUME_CELLS.items()
}
"""{cell type: number of nodes}."""
IGNORED_CELL_TYPES = ("vertex", "line", "line3")
"""Cell types without area; they are ignored."""


def boundary_faces(cells_by_type: Mapping[str, NodeIndices]) -> list[NodeIndices]:
    """Faces on the boundary of a mesh: faces of one volume cell only.

    A mesh without volume cells gives its surface cells.
    """
    volumes = {name: block for name, block in cells_by_type.items() if name in VOLUME_CELLS}
    if not volumes:
        return [block for name, block in cells_by_type.items() if name in SURFACE_CELL_NODE_COUNTS]
    by_size: dict[int, list[NodeIndices]] = {}
    for name, block in volumes.items():
        for face in _cell_faces(name):
            by_size.setdefault(len(face), []).append(block[:, face])
    return [_select_unshared_faces(np.concatenate(blocks), size) for size, blocks in by_size.items()]


def _cell_faces(cell_type: str) -> list[tuple[int, ...]]:
    """Node indices of each face of a cell type: corners, then mid-side nodes."""
    corners, faces, edges = VOLUME_CELLS[cell_type]
    middle = {tuple(sorted(edge)): corners + i for i, edge in enumerate(edges)}
    if not middle:
        return list(faces)
    return [
        (*f, *(middle[tuple(sorted((a, b)))] for a, b in zip(f, (*f[1:], f[0]), strict=True))) for f in faces
    ]


def _select_unshared_faces(element_faces: NodeIndices, face_node_count: int) -> NodeIndices:
    """Select the faces that belong to one cell only, from an array (faces, nodes per face)."""
    keys = np.sort(element_faces[:, : FACE_CORNER_COUNTS[face_node_count]], axis=1)
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    return np.asarray(element_faces[np.sort(first[count == 1])])


def label_bodies(cells_by_type: Mapping[str, NodeIndices], node_count: int) -> NDArray[np.int64]:
    """Index of the body of each of n nodes: cells that share a node belong to the same body."""
    rows = []
    for block in cells_by_type.values():
        rows.append(np.stack([np.repeat(block[:, :1], block.shape[1] - 1, axis=1), block[:, 1:]], axis=-1))
    pairs = np.concatenate([row.reshape(-1, 2) for row in rows])
    links = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(node_count, node_count))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)


@dataclass(frozen=True, slots=True)
class FiniteElementMesh:
    """Nodes and cells of a mesh.

    node_numbers   : (n) node numbers in the file
    node_positions : (n, 3) in the unit of the file
    cells_by_type  : {cell type of meshio: (cells, nodes per cell) indices of nodes in these arrays}, surfaces
                     or volumes
    """

    node_numbers: NDArray[np.int64]
    node_positions: Array
    cells_by_type: Mapping[str, NodeIndices]

    @classmethod
    def from_elements(
        cls,
        mesh_path: Path,
        node_numbers: NDArray[np.int64],
        node_positions: Array,
        element_nodes_by_type: Mapping[str, Sequence[Sequence[int]]],
    ) -> "FiniteElementMesh":
        """Mesh from {cell type: node numbers of each cell}; ValueError if a node is not defined."""
        order = np.argsort(node_numbers)
        cells = {}
        for kind, corners in element_nodes_by_type.items():
            wanted = np.array(corners, dtype=np.int64)
            index = order[
                np.minimum(np.searchsorted(node_numbers, wanted, sorter=order), node_numbers.size - 1)
            ]
            if np.any(missing := node_numbers[index] != wanted):
                raise ValueError(
                    f"{mesh_path}: node {wanted[missing][0]} of an element has no coordinates; expected the "
                    "coordinates of all nodes in the file"
                )
            cells[kind] = index.astype(np.intp)
        return cls(node_numbers, node_positions, cells)

    def surface_faces(self) -> list[NodeIndices]:
        """Surface cells of the mesh, or the boundary faces of its volume cells."""
        return boundary_faces(self.cells_by_type)

    def body_of_node(self) -> NDArray[np.int64]:
        """Index of the body to which each of the n nodes belongs."""
        return label_bodies(self.cells_by_type, self.node_numbers.size)

    def arrange_nodal_values(self, listed_nodal_values: Mapping[int, float]) -> Array:
        """Arrange {node number: value} as an array (n) over the nodes; NaN for nodes without a value."""
        return np.array([listed_nodal_values.get(name, np.nan) for name in self.node_numbers.tolist()])

    def find_unknown_nodes(self, node_numbers: Iterable[int]) -> set[int]:
        """Find the node numbers, out of `node_numbers`, that the mesh does not define."""
        return set(node_numbers) - set(self.node_numbers.tolist())

    def build_nodal_result(
        self,
        result_path: Path,
        listed_nodal_values: Mapping[int, float],
        length_unit: float,
        pressure_unit: float,
        omits_open_nodes: bool = False,
    ) -> NodalResult:
        """Build the nodal result from pressures that a file lists for nodes of this mesh.

        result_path                : file with the pressures, for messages
        listed_nodal_values        : {node number: pressure in the unit of the file}
        length_unit, pressure_unit : size of the length unit of the mesh [m], of the pressure unit [Pa]
        omits_open_nodes           : True: the listing leaves out open nodes. False: the contact consists of
                                     the faces whose corners are all listed
        """
        p = self.arrange_nodal_values(listed_nodal_values)
        return NodalResult(
            result_path=result_path,
            node_label="node",
            node_numbers=self.node_numbers,
            node_positions=self.node_positions * length_unit,
            nodal_pressure=p * pressure_unit,
            boundary_faces=self.surface_faces()
            if omits_open_nodes
            else select_faces_with_values(self.surface_faces(), p),
            body_of_node=self.body_of_node(),
            omits_open_nodes=omits_open_nodes,
        )


def select_faces_with_values(element_faces: Sequence[NodeIndices], nodal_values: Array) -> list[NodeIndices]:
    """Select the faces whose corners all have a value, from nodal values (n) with NaN for none."""
    has_value = np.isfinite(nodal_values)
    selected = [
        block[np.all(has_value[block[:, : FACE_CORNER_COUNTS[block.shape[1]]]], axis=1)]
        for block in element_faces
    ]
    return [block for block in selected if block.size]


def make_missing_reader_error(mesh_path: Path, import_error: ImportError) -> ValueError:
    """Error for a missing package that is needed to read a mesh file."""
    return ValueError(
        f"the package {import_error.name} is missing, needed to read {mesh_path}; install it with: pip "
        "install 'jointfmu[field]'"
    )
