"""Nodes and elements of an Abaqus or CalculiX input deck (.inp) without parts."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from .mesh import FiniteElementMesh, cells_of

_SOLID = re.compile(r"(?:AC3D|DC3D|C3D)(\d+)")
_SHELL = re.compile(r"(?:S|SC|R3D|M3D|SFM3D|STRI|CPS|CPE|CPEG|CAX)(\d+)")
SOLIDS = {
    4: "tetra",
    5: "pyramid",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    15: "wedge15",
    20: "hexahedron20",
}
SHELLS = {3: "triangle", 4: "quad", 6: "triangle6", 65: "triangle6", 8: "quad8"}
"""Kinds of meshio by the number in the name of an element; their nodes are in the same order."""
COUNT = {"triangle": 3, "triangle6": 6, "quad": 4, "quad8": 8} | {kind: n for n, kind in SOLIDS.items()}
REFUSED = ("INSTANCE", "INCLUDE", "NGEN", "NCOPY", "NFILL", "ELGEN", "ELCOPY", "SYSTEM", "NMAP")
"""Keywords that make or move nodes and elements elsewhere."""


def read(path: Path) -> FiniteElementMesh:
    """The nodes, the solids, and the shells if there are no solids; other elements are passed over.

    Raises ValueError, one line with file and line: no deck, a keyword of REFUSED, a line that is none, an
    element with a node that is not there.
    """
    places: dict[int, tuple[float, float, float]] = {}
    rows: dict[str, list[list[int]]] = {}
    open_row: list[int] = []  # goes on in the next line, after a comma at its end
    for number, keyword, kind, words in _data(path):
        try:
            if keyword == "NODE":
                x, y, z = (float(word or 0.0) for word in (*words[1:4], "", "")[:3])
                places[int(words[0])] = x, y, z
                continue
            row = [*open_row, *(int(word) for word in words if word)]
        except ValueError:
            row = []
        size = 1 + COUNT.get(kind, 0)
        open_row = row if words[-1] == "" and 0 < len(row) < size else []
        if not open_row and len(row) != size:
            raise ValueError(
                f"{path}: line {number}: {', '.join(words)!r} is no line of *{keyword}"
                + (f" with {size - 1} nodes" if kind else "")
            )
        if not open_row:
            rows.setdefault(kind, []).append(row[1:])
    if not places or not rows:
        raise ValueError(f"{path}: has no nodes and elements, expected an input deck with *NODE and *ELEMENT")
    names = np.array(list(places), dtype=np.int64)
    try:
        return FiniteElementMesh(names, np.array(list(places.values())), cells_of(rows, names))
    except ValueError as error:
        raise ValueError(f"{path}: {error}; expected elements of the nodes in the file") from None


def _data(path: Path) -> Iterator[tuple[int, str, str, list[str]]]:
    """(line, keyword, kind of meshio, words) of the data lines of *NODE and *ELEMENT."""
    try:
        text = path.read_text(encoding="latin-1")
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror}); expected an input deck") from None
    keyword = kind = ""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("**"):
            continue
        words = [word.strip() for word in line.split(",")]
        if line.startswith("*"):
            keyword, kind = words[0][1:].upper(), _kind(words[1:])
            if keyword in REFUSED:
                raise ValueError(
                    f"{path}: line {number}: has *{keyword}, expected a deck whose nodes and elements are "
                    "listed once, in one numbering (Abaqus/CAE: do not use parts and assemblies)"
                )
        elif keyword == "NODE" or (keyword == "ELEMENT" and kind):
            yield number, keyword, kind, words


def _kind(parameters: list[str]) -> str:
    """Kind of meshio of the parameter TYPE; empty if the element has no faces here."""
    values = (p.split("=")[1].strip().upper() for p in parameters if p.upper().startswith("TYPE"))
    name = next(values, "")
    for pattern, kinds in ((_SOLID, SOLIDS), (_SHELL, SHELLS)):
        if found := pattern.match(name):
            return kinds.get(int(found[1]), "")
    return ""
