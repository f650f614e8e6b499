"""Read the last contact result and its mesh from a CalculiX result file (.frd, ASCII).

The manual of CalculiX GraphiX (cgx, appendix "Result Format") describes the format: block 2C has the nodes,
block 3C the elements. Each result is a block of lines -4 (name), -5 (components), -1 (a node), -3 (end).
"""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.reading import read_bytes
from jointfmu.quantity import Array

from .mesh import CELL_NODE_COUNTS, FiniteElementMesh
from .nodal_result import NodalResult

CELL_TYPE_BY_FRD_NUMBER = {
    **dict(enumerate(("hexahedron", "wedge", "tetra", "hexahedron20", "wedge15", "tetra10"), 1)),
    **dict(enumerate(("triangle", "triangle6", "quad", "quad8", "line", "line3"), 7)),
}
"""Cell type of meshio for each element type of the format."""
MESHIO_NODE_ORDER = {
    "hexahedron20": [*range(12), *range(16, 20), *range(12, 16)],
    "wedge15": [*range(9), *range(12, 15), *range(9, 12)],
}
"""Node order of meshio for cells in which the format lists the mid-side nodes in another order."""
CONTACT_RESULT_NAME, PRESSURE_COMPONENT = "CONTACT", "CPRESS"


def read_frd(frd_path: Path, length_unit: float, pressure_unit: float) -> NodalResult:
    """Read the last contact result of a CalculiX file.

    length_unit, pressure_unit : size of the file's length unit [m] and pressure unit [Pa]

    Raises ValueError with file and line: no ASCII .frd file, no contact result, a line that cannot be read.
    """
    lines = _read_frd_text(frd_path).splitlines()
    cells = _read_cells(frd_path, lines)
    if not cells:
        raise ValueError(f"{frd_path}: has no elements, expected those of the bodies in contact")
    mesh = FiniteElementMesh.from_elements(frd_path, *_read_nodes(frd_path, lines), cells)
    return mesh.build_nodal_result(
        frd_path, dict(_read_pressures(frd_path, lines)), length_unit, pressure_unit, omits_open_nodes=True
    )


def _read_frd_text(frd_path: Path) -> str:
    """Read a CalculiX result file as text; ValueError if it is no ASCII .frd file."""
    data = read_bytes(frd_path, "a CalculiX .frd file")
    if not data.startswith(b"    1"):
        raise ValueError(
            f"{frd_path}: is not a CalculiX result; expected an ASCII .frd file, which begins with '    1C'"
        )
    return data.decode("latin-1")


def _iterate_block_lines(frd_lines: list[str], block_start_index: int) -> Iterator[tuple[int, str]]:
    """Lines of a block of an .frd file, as (line number, line), up to the end of the block."""
    for number in range(block_start_index + 1, len(frd_lines)):
        if frd_lines[number].startswith(" -3"):
            return
        yield number, frd_lines[number]


def _find_block(frd_path: Path, frd_lines: list[str], block_key: str, block_description: str) -> int:
    """Line number of the last block of an .frd file with a key; ValueError if there is none or it is binary.

    block_description : name of the content in the message
    """
    starts = [i for i, line in enumerate(frd_lines) if line.startswith(block_key)]
    if not starts:
        raise ValueError(f"{frd_path}: has no {block_description}, expected a block {block_key.strip()}")
    if frd_lines[starts[-1]].rstrip().endswith(("2", "3")):
        raise ValueError(f"{frd_path}: line {starts[-1] + 1}: is binary, expected an ASCII .frd file")
    return starts[-1]


def _read_nodes(frd_path: Path, frd_lines: list[str]) -> tuple[NDArray[np.int64], Array]:
    """Read node numbers (n) and coordinates (n, 3), in the unit of the file, from an .frd file."""
    names, coordinates = [], []
    for number, line in _iterate_block_lines(frd_lines, _find_block(frd_path, frd_lines, "    2C", "nodes")):
        name, values = _parse_node_line(frd_path, number, line, 3)
        names.append(name)
        coordinates.append(values)
    return np.array(names, dtype=np.int64), np.array(coordinates)


def _parse_node_line(
    frd_path: Path, line_index: int, node_line: str, min_value_count: int
) -> tuple[int, list[float]]:
    """Node number and values of a line -1 of an .frd file: I10 after the key, then E12.5 without blanks.

    Raises ValueError if the line has fewer than `min_value_count` values.
    """
    try:
        name = int(node_line[3:13])
        values = [float(node_line[i : i + 12]) for i in range(13, len(node_line.rstrip()), 12)]
    except ValueError:
        values = []
    if len(values) < min_value_count or not node_line.startswith(" -1") or not all(map(isfinite, values)):
        raise ValueError(
            f"{frd_path}: line {line_index + 1}: {node_line[:60]!r} is not a line with a node number and "
            f"{min_value_count} numbers"
        )
    return name, values


def _read_cells(frd_path: Path, frd_lines: list[str]) -> dict[str, list[list[int]]]:
    """Read the elements of an .frd file: {cell type of meshio: node numbers of each cell}."""
    cells: dict[str, list[list[int]]] = {}
    kind, nodes = "", list[int]()
    for number, line in _iterate_block_lines(
        frd_lines, _find_block(frd_path, frd_lines, "    3C", "elements")
    ):
        try:
            if line.startswith(" -1"):
                kind, nodes = CELL_TYPE_BY_FRD_NUMBER[int(line[13:18])], []
                continue
            nodes += [int(line[i : i + 10]) for i in range(3, len(line.rstrip()), 10)]
        except (ValueError, KeyError):
            raise ValueError(
                f"{frd_path}: line {number + 1}: {line[:60]!r} is not a line of the element block of a "
                "CalculiX .frd file; expected an element of type 1 to 12 and its node numbers: write the "
                "file again"
            ) from None
        if len(nodes) == CELL_NODE_COUNTS.get(kind):
            cells.setdefault(kind, []).append(
                [nodes[i] for i in MESHIO_NODE_ORDER.get(kind, range(len(nodes)))]
            )
    return cells


def _read_pressures(frd_path: Path, frd_lines: list[str]) -> Iterator[tuple[int, float]]:
    """Read the node numbers and contact pressures of the last contact result of an .frd file.

    With surface-to-surface contact, CalculiX lists 0 for all other nodes. With node-to-surface contact, it
    leaves out nodes whose gap is too large for a contact spring.
    """
    starts = [
        i
        for i, line in enumerate(frd_lines)
        if line.startswith(" -4") and line[5:13].strip() == CONTACT_RESULT_NAME
    ]
    if not starts:
        available = sorted({line[5:13].strip() for line in frd_lines if line.startswith(" -4")})
        raise ValueError(
            f"{frd_path}: has no result {CONTACT_RESULT_NAME} (*CONTACT FILE with CSTR); "
            f"there are {', '.join(available) or 'none'}"
        )
    names: list[str] = []
    for number, line in _iterate_block_lines(frd_lines, starts[-1]):
        if line.startswith(" -5"):
            names.append(line[5:13].strip())
            continue
        if PRESSURE_COMPONENT not in names:
            raise ValueError(
                f"{frd_path}: line {number + 1}: {CONTACT_RESULT_NAME} has no {PRESSURE_COMPONENT}; there "
                f"are {', '.join(names)}"
            )
        name, values = _parse_node_line(frd_path, number, line, len(names))
        yield name, values[names.index(PRESSURE_COMPONENT)]
