"""Read ANSYS listings: nodal contact pressure (PRNSOL,CONT), nodes (NLIST) and contact elements (ELIST).

Nodes and elements may also come from an archive (CDWRITE, .cdb), read by mapdl-archive. A listing is a text
of pages. A table begins with its header: a line of column names that starts with NODE or ELEM. Page headers
may interrupt the table anywhere. Only lines with a number for every column are rows. The summary of extreme
values at the end is ignored.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files.reading import check_regular_file
from jointfmu.quantity.refusal import InputRefusal

from .mesh import FiniteElementMesh, make_missing_reader_error
from .nodal_result import LISTING_NUMBER_PATTERN, NodalResult, read_result_lines

_LISTING_ELEMENT_COLUMNS = 6
"""Number of columns before the nodes of an element in a listing [1].

They are number, material, type, constants, coordinate system, section."""
PRESSURE_COLUMN = "PRES"
"""Name of the column with the contact pressure."""


def read_ansys(listing_paths: Sequence[Path], length_unit: float, pressure_unit: float) -> NodalResult:
    """Read a nodal contact result from ANSYS listings, or from one listing and an archive.

    length_unit, pressure_unit : size of the files' length unit [m] and pressure unit [Pa]

    Raises ValueError with file and line: a file cannot be read, a table is missing, a node has two values, an
    element has a node that is not listed.
    """
    values: dict[int, float] = {}
    coordinates: dict[int, tuple[float, ...]] = {}
    elements: list[list[int]] = []
    meshes = [path for path in listing_paths[1:] if path.suffix.lower() == ".cdb"]
    for path in (path for path in listing_paths if path not in meshes):
        for location, content, row in _read_listing_rows(path):
            if content == "element":
                elements.append([int(x) for x in row[_LISTING_ELEMENT_COLUMNS:]])
            elif content == "more":
                elements[-1] += [int(x) for x in row]
            else:
                is_pressure = content == "pressure"
                table: dict[int, object] = values if is_pressure else coordinates  # type: ignore[assignment]
                name, value = int(row[0]), row[1] if is_pressure else tuple(row[1:])
                if table.setdefault(name, value) != value:
                    quantity = "pressure" if is_pressure else "position"
                    raise ValueError(f"{location}: node {name} has a second {quantity}, expected one")
    first = listing_paths[0]
    if meshes and values:
        return _combine_pressures_with_archive(first, meshes[0], values, length_unit, pressure_unit)
    for entries, text in (
        (values, f"no contact pressure, a table with NODE and {PRESSURE_COLUMN} (PRNSOL,CONT)"),
        (coordinates, "no nodes, a table with NODE, X, Y and Z (NLIST)"),
        (elements, "no contact elements, a table with ELEM and NODES (ESEL,S,ENAME,,174 and ELIST)"),
    ):
        if not entries:
            raise InputRefusal(f"{first}: has {text}; give further listings", "beside")
    return _build_nodal_result(first, values, coordinates, elements, length_unit, pressure_unit)


def _combine_pressures_with_archive(
    listing_path: Path,
    archive_path: Path,
    listed_pressures: dict[int, float],
    length_unit: float,
    pressure_unit: float,
) -> NodalResult:
    """Build the nodal result from listed pressures and an archive: faces with a pressure at all corners."""
    mesh = read_ansys_archive(archive_path)
    if stray := mesh.find_unknown_nodes(node for node, value in listed_pressures.items() if value):
        raise ValueError(
            f"{listing_path}: node {min(stray)} has a pressure, but is not in {archive_path}; expected the "
            "mesh of the same model"
        )
    return mesh.build_nodal_result(listing_path, listed_pressures, length_unit, pressure_unit)


def _build_nodal_result(
    listing_path: Path,
    listed_pressures: dict[int, float],
    node_coordinates: dict[int, tuple[float, ...]],
    contact_elements: Sequence[Sequence[int]],
    length_unit: float,
    pressure_unit: float,
) -> NodalResult:
    """Build the nodal result from listed pressures, coordinates and contact elements."""
    used = sorted({node for element in contact_elements for node in element if node})
    if missing := [node for node in used if node not in node_coordinates]:
        raise ValueError(
            f"{listing_path}: node {missing[0]} of a contact element has no coordinates; list all nodes "
            "(NLIST)"
        )
    if stray := sorted(listed_pressures.keys() - set(used)):
        loaded = [node for node in stray if listed_pressures[node] != 0.0]
        if loaded:
            raise ValueError(
                f"{listing_path}: node {loaded[0]} has a pressure, but is in no listed element; list all "
                "contact elements (ELIST)"
            )
    faces: dict[str, list[list[int]]] = {}
    for element in contact_elements:
        kind, nodes = _convert_contact_element([node for node in element if node])
        if not kind:
            raise ValueError(
                f"{listing_path}: an element has {len(nodes)} nodes, expected contact elements with 3, 4, 6 "
                "or 8: select them before ELIST"
            )
        faces.setdefault(kind, []).append(nodes)
    names = np.array(used, dtype=np.int64)
    mesh = FiniteElementMesh.from_elements(
        listing_path, names, np.array([node_coordinates[name] for name in used]), faces
    )
    return NodalResult(
        result_path=listing_path,
        node_label="node",
        node_numbers=names,
        node_positions=mesh.node_positions * length_unit,
        nodal_pressure=mesh.arrange_nodal_values(listed_pressures) * pressure_unit,
        boundary_faces=mesh.surface_faces(),
    )


def _read_listing_rows(listing_path: Path) -> Iterator[tuple[str, str, list[float]]]:
    """Read all rows of a listing as (file and line, kind of row, numbers).

    The kind of row is "pressure", "place" (node coordinates), "element", or "more" (more nodes of an
    element).
    """
    head: list[str] = []
    previous = ""
    for number, line in enumerate(read_result_lines(listing_path, "an ANSYS listing"), 1):
        words = line.replace("(", " ").split()
        if not words:
            continue
        if words[0] in ("NODE", "ELEM") and not any(map(_is_number, words)):
            head, previous = words, ""
            continue
        if words[0] in ("MINIMUM", "MAXIMUM"):
            head = []
        numbers = _parse_numbers(line)
        if not head or numbers is None:
            continue
        location = f"{listing_path}: line {number}"
        content, row = _classify_row(head, numbers, location, previous)
        if content:
            yield location, content, row
            previous = content


def _is_number(listing_word: str) -> bool:
    """Whether a word of a listing is a number."""
    return LISTING_NUMBER_PATTERN.fullmatch(listing_word) is not None


def _parse_numbers(listing_line: str) -> list[float] | None:
    """Numbers of a listing line that has only numbers, else None.

    A minus sign may follow the number before without a blank: 12-0.5E-003.
    """
    if LISTING_NUMBER_PATTERN.sub("", listing_line).strip():
        return None
    return [
        float(x.replace("D", "E").replace("d", "e")) for x in LISTING_NUMBER_PATTERN.findall(listing_line)
    ]


def _classify_row(
    column_names: list[str], row_numbers: list[float], file_and_line: str, previous_row_kind: str
) -> tuple[str, list[float]]:
    """Kind of a row of a listing, as in `_read_listing_rows`, and the relevant numbers of the row.

    column_names         : words in the head of the table
    previous_row_kind    : kind of the row before
    """
    if column_names[0] == "ELEM":
        if not all(x % 1.0 == 0.0 for x in row_numbers):
            return "", []
        if len(row_numbers) > _LISTING_ELEMENT_COLUMNS:
            return "element", row_numbers
        return ("more", row_numbers) if previous_row_kind in ("element", "more") else ("", [])
    if PRESSURE_COLUMN in column_names and "X" not in column_names:
        if len(row_numbers) != len(column_names):
            raise ValueError(
                f"{file_and_line}: has {len(row_numbers)} numbers, expected {len(column_names)}, one for "
                f"each column: {' '.join(column_names)}"
            )
        return "pressure", [row_numbers[0], row_numbers[column_names.index(PRESSURE_COLUMN)]]
    if column_names[1:4] == ["X", "Y", "Z"]:
        if len(row_numbers) < 4:
            raise ValueError(f"{file_and_line}: has {len(row_numbers)} numbers, expected NODE, X, Y and Z")
        return "place", row_numbers[:4]
    return "", []


CONTACT_ELEMENT_TYPES = (173, 174)
"""Numbers of the ANSYS types of contact elements that are read."""
SOLID_ELEMENT_TYPES = (45, 62, 64, 65, 72, 73, 90, 92, 95, 185, 186, 187, 285)
"""Numbers of the ANSYS types of solid elements that are read; other elements are ignored."""
_ARCHIVE_ELEMENT_COLUMNS = 10
"""Count of numbers before the nodes of an element in an archive."""
_DEGENERATE_BRICK_CELLS = {
    (8, "tetra"): ("tetra", (0, 1, 2, 4)),
    (8, "pyramid"): ("pyramid", (0, 1, 2, 3, 4)),
    (8, "wedge"): ("wedge", (0, 1, 2, 4, 5, 6)),
    (8, "brick"): ("hexahedron", tuple(range(8))),
    (20, "tetra"): ("tetra10", (0, 1, 2, 4, 8, 9, 11, 16, 17, 18)),
    (20, "pyramid"): ("pyramid13", (0, 1, 2, 3, 4, 8, 9, 10, 11, 16, 17, 18, 19)),
    (20, "wedge"): ("wedge15", (0, 1, 2, 4, 5, 6, 8, 9, 11, 12, 13, 15, 16, 17, 18)),
    (20, "brick"): ("hexahedron20", tuple(range(20))),
}
"""{(number of nodes of a brick, shape): (cell type of meshio, indices of its nodes)}.

Repeated nodes of the brick give the other shapes."""
_TETRA_CELLS = {4: "tetra", 10: "tetra10"}
"""Cell types of meshio of tetrahedra, by their number of nodes."""


def read_ansys_archive(archive_path: Path) -> FiniteElementMesh:
    """Read the mesh of an ANSYS archive: contact elements (CONTA173, CONTA174), or solids if there are none.

    Raises ValueError (one line): mapdl-archive is missing or cannot read the file, there are no such
    elements, an element has an undefined node.
    """
    archive = _open_archive(archive_path)
    types = np.asarray(archive.etype)
    chosen = np.isin(types, CONTACT_ELEMENT_TYPES)
    if not np.any(chosen):
        chosen = np.isin(types, SOLID_ELEMENT_TYPES)
    rows: dict[str, list[list[int]]] = {}
    for i in np.flatnonzero(chosen):
        kind, nodes = _convert_element(
            archive.elem[i][_ARCHIVE_ELEMENT_COLUMNS:].tolist(), int(types[i]) in CONTACT_ELEMENT_TYPES
        )
        if not kind:
            number = archive.elem[i][8]
            raise ValueError(
                f"{archive_path}: element {number} has {len(nodes)} different nodes, as no supported contact "
                "element or solid has; write the archive again (CDWRITE)"
            )
        rows.setdefault(kind, []).append(nodes)
    if not rows:
        raise ValueError(
            f"{archive_path}: has no contact elements (CONTA173, CONTA174) and no solids; expected one kind"
        )
    names = np.asarray(archive.nnum, dtype=np.int64)
    return FiniteElementMesh.from_elements(
        archive_path, names, np.asarray(archive.nodes, dtype=np.float64)[:, :3], rows
    )


def _open_archive(archive_path: Path) -> Any:
    """Open an ANSYS archive with mapdl-archive; ValueError if it is missing or cannot read the file."""
    try:
        import mapdl_archive
    except ImportError as error:
        raise make_missing_reader_error(archive_path, error) from None
    check_regular_file(archive_path, "an ANSYS archive (CDWRITE)")
    if not archive_path.is_file():
        raise ValueError(
            f"{archive_path}: cannot be read (no such file); expected an ANSYS archive (CDWRITE)"
        )
    try:
        archive = mapdl_archive.Archive(archive_path, parse_vtk=False)
        if len(archive.etype) and len(archive.nnum):
            return archive
        reason = "no nodes or elements"
    except Exception as error:  # the parser raises exceptions of any kind
        reason = " ".join(str(error).split())[:120] or type(error).__name__
    raise ValueError(
        f"{archive_path}: mapdl-archive cannot read it ({reason}); expected NBLOCK and EBLOCK (CDWRITE)"
    )


def _convert_element(element_node_numbers: list[int], is_contact_element: bool) -> tuple[str, list[int]]:
    """Convert an ANSYS element to a meshio cell type and nodes without repeats; empty if not supported."""
    if is_contact_element:
        return _convert_contact_element([node for node in element_node_numbers if node])
    if len(element_node_numbers) in _TETRA_CELLS:
        return _TETRA_CELLS[len(element_node_numbers)], element_node_numbers
    if len(element_node_numbers) not in (8, 20):
        return "", element_node_numbers
    kind, indices = _DEGENERATE_BRICK_CELLS[
        len(element_node_numbers), _find_brick_shape(element_node_numbers)
    ]
    return kind, [element_node_numbers[i] for i in indices]


def _find_brick_shape(element_node_numbers: list[int]) -> str:
    """Shape of a brick element with repeated corners: hexahedron, wedge, pyramid or tetrahedron.

    The corners are I J K L M N O P.
    """
    triangle = element_node_numbers[2] == element_node_numbers[3]
    if (
        element_node_numbers[4]
        == element_node_numbers[5]
        == element_node_numbers[6]
        == element_node_numbers[7]
    ):
        return "tetra" if triangle else "pyramid"
    return "wedge" if triangle else "brick"


def _convert_contact_element(element_node_numbers: list[int]) -> tuple[str, list[int]]:
    """Convert a contact element I J K L (M N O P) to a meshio cell type and nodes; triangle if K is L."""
    if len(element_node_numbers) in (4, 8) and element_node_numbers[2] == element_node_numbers[3]:
        element_node_numbers = [
            element_node_numbers[i]
            for i in ((0, 1, 2) if len(element_node_numbers) == 4 else (0, 1, 2, 4, 5, 7))
        ]
    return {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}.get(
        len(element_node_numbers), ""
    ), element_node_numbers
