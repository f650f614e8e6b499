"""Nodes and elements of an ANSYS archive (.cdb, CDWRITE), read by mapdl-archive."""

from pathlib import Path
from typing import Any

import numpy as np

from .mesh import FiniteElementMesh, cells_of, no_reader

CONTACT = (173, 174)
SOLIDS = (45, 62, 64, 65, 72, 73, 90, 92, 95, 185, 186, 187, 285)
"""Element types with faces; the rest is passed over."""
_HEAD = 10
"""Numbers before the nodes of an element."""
_REPEATED = {
    (8, "tetra"): ("tetra", (0, 1, 2, 4)),
    (8, "pyramid"): ("pyramid", (0, 1, 2, 3, 4)),
    (8, "wedge"): ("wedge", (0, 1, 2, 4, 5, 6)),
    (8, "brick"): ("hexahedron", tuple(range(8))),
    (20, "tetra"): ("tetra10", (0, 1, 2, 4, 8, 9, 11, 16, 17, 18)),
    (20, "pyramid"): ("pyramid13", (0, 1, 2, 3, 4, 8, 9, 10, 11, 16, 17, 18, 19)),
    (20, "wedge"): ("wedge15", (0, 1, 2, 4, 5, 6, 8, 9, 11, 12, 13, 15, 16, 17, 18)),
    (20, "brick"): ("hexahedron20", tuple(range(20))),
}
"""Kind of meshio and nodes of a brick of so many nodes, some of which may be repeated."""
_TETRAS = {4: "tetra", 10: "tetra10"}


def read(path: Path) -> FiniteElementMesh:
    """The contact elements (CONTA173, CONTA174), or the solids if there are none.

    Raises ValueError, one line: mapdl-archive is missing or cannot read the file, no such elements, an
    element with a node that is not there.
    """
    archive = _archive(path)
    types = np.asarray(archive.etype)
    chosen = np.isin(types, CONTACT)
    if not np.any(chosen):
        chosen = np.isin(types, SOLIDS)
    rows: dict[str, list[list[int]]] = {}
    for i in np.flatnonzero(chosen):
        kind, nodes = _cell(archive.elem[i][_HEAD:].tolist(), int(types[i]) in CONTACT)
        if not kind:
            number = archive.elem[i][8]
            raise ValueError(
                f"{path}: element {number} has {len(nodes)} nodes, expected a whole contact or solid"
            )
        rows.setdefault(kind, []).append(nodes)
    if not rows:
        raise ValueError(f"{path}: has no contact elements (CONTA173, CONTA174) and no solids")
    names = np.asarray(archive.nnum, dtype=np.int64)
    try:
        return FiniteElementMesh(
            names, np.asarray(archive.nodes, dtype=np.float64)[:, :3], cells_of(rows, names)
        )
    except ValueError as error:
        raise ValueError(f"{path}: {error}; expected elements of the nodes in the file") from None


def _archive(path: Path) -> Any:
    try:
        import mapdl_archive
    except ImportError as error:
        raise no_reader(path, error) from None
    if not path.is_file():
        raise ValueError(f"{path}: cannot be read (no such file); expected an ANSYS archive (CDWRITE)")
    try:
        archive = mapdl_archive.Archive(path, parse_vtk=False)
        if len(archive.etype) and len(archive.nnum):
            return archive
        reason = "no nodes or elements"
    except Exception as error:  # what its parser lets through
        reason = " ".join(str(error).split())[:120] or type(error).__name__
    raise ValueError(f"{path}: mapdl-archive cannot read it ({reason}); expected NBLOCK and EBLOCK (CDWRITE)")


def _cell(nodes: list[int], contact: bool) -> tuple[str, list[int]]:
    """Kind of meshio and the nodes of an element, each once; no kind if it is none."""
    if contact:
        return _face([node for node in nodes if node])
    if len(nodes) in _TETRAS:
        return _TETRAS[len(nodes)], nodes
    if len(nodes) not in (8, 20):
        return "", nodes
    kind, places = _REPEATED[len(nodes), _shape(nodes)]
    return kind, [nodes[i] for i in places]


def _shape(nodes: list[int]) -> str:
    """What a brick I J K L M N O P with repeated corners is."""
    triangle = nodes[2] == nodes[3]
    if nodes[4] == nodes[5] == nodes[6] == nodes[7]:
        return "tetra" if triangle else "pyramid"
    return "wedge" if triangle else "brick"


def _face(nodes: list[int]) -> tuple[str, list[int]]:
    """A contact face I J K L (M N O P), a triangle if K and L agree."""
    if len(nodes) in (4, 8) and nodes[2] == nodes[3]:
        nodes = [nodes[i] for i in ((0, 1, 2) if len(nodes) == 4 else (0, 1, 2, 4, 5, 7))]
    return {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}.get(len(nodes), ""), nodes
