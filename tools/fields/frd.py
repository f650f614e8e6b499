"""CalculiX result files (.frd, ASCII): the last contact result with its mesh.

The format is that of CalculiX GraphiX (cgx, appendix "Result Format"): nodes in the block 2C, elements in
3C, and per result a block of lines -4 (its name), -5 (its components), -1 (a node), -3 (the end).
"""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.reading import read_bytes
from jointfmu.quantity import Array

from .mesh import NODES, FiniteElementMesh
from .nodal_result import NodalResult

TYPES = {
    **dict(enumerate(("hexahedron", "wedge", "tetra", "hexahedron20", "wedge15", "tetra10"), 1)),
    **dict(enumerate(("triangle", "triangle6", "quad", "quad8", "line", "line3"), 7)),
}
"""Names of meshio of the element types of the format."""
ORDER = {
    "hexahedron20": [*range(12), *range(16, 20), *range(12, 16)],
    "wedge15": [*range(9), *range(12, 15), *range(9, 12)],
}
"""Where the format has the middles of the upright edges before those of the top."""
DATASET, COMPONENT = "CONTACT", "CPRESS"


def read(path: Path, length: float, pressure: float) -> NodalResult:
    """The last contact result of a file; units in SI.

    Raises ValueError naming file and line: no ASCII .frd, no contact result, a line that is none.
    """
    lines = _text(path).splitlines()
    cells = _cells(path, lines)
    if not cells:
        raise ValueError(f"{path}: has no elements, expected those of the bodies in contact")
    mesh = FiniteElementMesh.of(path, *_nodes(path, lines), cells)
    return mesh.result(path, dict(_pressures(path, lines)), length, pressure, left_out=True)


def _text(path: Path) -> str:
    data = read_bytes(path, "a CalculiX .frd file")
    if not data.startswith(b"    1"):
        raise ValueError(
            f"{path}: is no CalculiX result; expected an ASCII .frd file, which begins with '    1C'"
        )
    return data.decode("latin-1")


def _block(lines: list[str], start: int) -> Iterator[tuple[int, str]]:
    """Numbers and lines after `start` up to the end of the block."""
    for number in range(start + 1, len(lines)):
        if lines[number].startswith(" -3"):
            return
        yield number, lines[number]


def _start(path: Path, lines: list[str], key: str, what: str) -> int:
    starts = [i for i, line in enumerate(lines) if line.startswith(key)]
    if not starts:
        raise ValueError(f"{path}: has no {what}, expected a block {key.strip()}")
    if lines[starts[-1]].rstrip().endswith(("2", "3")):
        raise ValueError(f"{path}: line {starts[-1] + 1}: is binary, expected an ASCII .frd file")
    return starts[-1]


def _nodes(path: Path, lines: list[str]) -> tuple[NDArray[np.int64], Array]:
    names, places = [], []
    for number, line in _block(lines, _start(path, lines, "    2C", "nodes")):
        name, values = _row(path, number, line, 3)
        names.append(name)
        places.append(values)
    return np.array(names, dtype=np.int64), np.array(places)


def _row(path: Path, number: int, line: str, least: int) -> tuple[int, list[float]]:
    """Node and numbers of a line -1: I10 after the key, then E12.5 without blanks between."""
    try:
        name = int(line[3:13])
        values = [float(line[i : i + 12]) for i in range(13, len(line.rstrip()), 12)]
    except ValueError:
        values = []
    if len(values) < least or not line.startswith(" -1") or not all(map(isfinite, values)):
        raise ValueError(f"{path}: line {number + 1}: {line[:60]!r} is no node with {least} numbers")
    return name, values


def _cells(path: Path, lines: list[str]) -> dict[str, list[list[int]]]:
    """Nodes of the cells by their kind; lines are passed over."""
    cells: dict[str, list[list[int]]] = {}
    kind, nodes = "", list[int]()
    for number, line in _block(lines, _start(path, lines, "    3C", "elements")):
        try:
            if line.startswith(" -1"):
                kind, nodes = TYPES[int(line[13:18])], []
                continue
            nodes += [int(line[i : i + 10]) for i in range(3, len(line.rstrip()), 10)]
        except (ValueError, KeyError):
            raise ValueError(
                f"{path}: line {number + 1}: {line[:60]!r} is no element of the format"
            ) from None
        if len(nodes) == NODES.get(kind):
            cells.setdefault(kind, []).append([nodes[i] for i in ORDER.get(kind, range(len(nodes)))])
    return cells


def _pressures(path: Path, lines: list[str]) -> Iterator[tuple[int, float]]:
    """Nodes and contact pressures of the last contact result.

    Surface to surface contact lists zeros for all other nodes, node to surface contact leaves those out
    whose gap is too large for a spring.
    """
    starts = [i for i, line in enumerate(lines) if line.startswith(" -4") and line[5:13].strip() == DATASET]
    if not starts:
        there = sorted({line[5:13].strip() for line in lines if line.startswith(" -4")})
        raise ValueError(
            f"{path}: has no result {DATASET} (*CONTACT FILE with CSTR); "
            f"there are {', '.join(there) or 'none'}"
        )
    names: list[str] = []
    for number, line in _block(lines, starts[-1]):
        if line.startswith(" -5"):
            names.append(line[5:13].strip())
            continue
        if COMPONENT not in names:
            raise ValueError(
                f"{path}: line {number + 1}: {DATASET} has no {COMPONENT}; there are {', '.join(names)}"
            )
        name, values = _row(path, number, line, len(names))
        yield name, values[names.index(COMPONENT)]
