"""CalculiX result files (.frd, ASCII): the last contact result with its mesh.

The format is that of CalculiX GraphiX (cgx, appendix "Result Format"): nodes in the block 2C, elements in
3C, and per result a block of lines -4 (its name), -5 (its components), -1 (a node), -3 (the end).
"""

from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .mesh import bodies, boundary
from .nodal_result import NodalResult, Nodes

TYPES: dict[int, tuple[str, int]] = {
    1: ("hexahedron", 8),
    2: ("wedge", 6),
    3: ("tetra", 4),
    4: ("hexahedron20", 20),
    5: ("wedge15", 15),
    6: ("tetra10", 10),
    7: ("triangle", 3),
    8: ("triangle6", 6),
    9: ("quad", 4),
    10: ("quad8", 8),
    11: ("line", 2),
    12: ("line3", 3),
}
"""Names of meshio and number of nodes of the element types of the format."""
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
    names, place = _nodes(path, lines)
    index = {name: i for i, name in enumerate(names.tolist())}
    cells = _cells(path, lines, index)
    if not cells:
        raise ValueError(f"{path}: has no elements, expected those of the bodies in contact")
    values = np.full(names.size, np.nan)
    for name, value in _pressures(path, lines):
        if name in index:
            values[index[name]] = value
    return NodalResult(
        path=path,
        word="node",
        names=names,
        place=place * length,
        pressure=values * pressure,
        faces=boundary(cells),
        body=bodies(cells, names.size),
        left_out=True,
    )


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ValueError(
            f"{path}: cannot be read ({error.strerror}); expected a CalculiX .frd file"
        ) from None
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


def _cells(path: Path, lines: list[str], index: Mapping[int, int]) -> dict[str, Nodes]:
    cells: dict[str, list[list[int]]] = {}
    cell_type, count = "", 0
    nodes: list[int] = []
    for number, line in _block(lines, _start(path, lines, "    3C", "elements")):
        try:
            if line.startswith(" -1"):
                cell_type, count = TYPES[int(line[13:18])]
                nodes = []
                continue
            nodes += [index[int(line[i : i + 10])] for i in range(3, len(line.rstrip()), 10)]
        except (ValueError, KeyError):
            raise ValueError(
                f"{path}: line {number + 1}: {line[:60]!r} is no element of the format"
            ) from None
        if len(nodes) == count:
            cells.setdefault(cell_type, []).append([nodes[i] for i in ORDER.get(cell_type, range(count))])
    return {
        cell_type: np.array(rows, dtype=np.intp)
        for cell_type, rows in cells.items()
        if not cell_type.startswith("line")
    }


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
