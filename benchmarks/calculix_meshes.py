"""Bodies of the finite elements as input of CalculiX, and what it prints."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jointfmu_tools.fem.elasticity import ElasticBody

CORNERS = [7, 4, 1, 5, 6, 2, 0, 3]  # of C3D20 among scikit-fem's
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


def c3d20(body: ElasticBody) -> np.ndarray:
    """Nodes (20, n) of the elements in the order of CalculiX: corners, then the middles of EDGES."""
    corners, others = np.split(np.asarray(body.basis.element_dofs), [8])
    rows = list(corners[CORNERS])
    for i, j in EDGES:
        middle = 0.5 * (body.nodes[:, rows[i]] + body.nodes[:, rows[j]])
        away = np.abs(body.nodes[:, others] - middle[:, None]).sum(axis=0)
        assert away.min(axis=0).max() < 1e-12
        rows.append(np.take_along_axis(others, away.argmin(axis=0)[None], axis=0)[0])
    return np.array(rows)


def body_lines(body: ElasticBody, name: int, nodes: int, elements: int, down: float) -> Iterator[str]:
    """A body in mm and MPa, moved down by `down` [m]; 12 digits, as CalculiX reads 20 characters."""
    yield f"*NODE, NSET=N{name}"
    for i, (x, y, z) in enumerate(body.nodes.T * 1e3):
        yield f"{nodes + i + 1}, {x:.12g}, {y:.12g}, {z - 1e3 * down:.12g}"
    cells = c3d20(body)
    yield f"*ELEMENT, TYPE=C3D20, ELSET=E{name}"
    for i, cell in enumerate((cells + nodes + 1).T.tolist()):
        yield f"{elements + i + 1}, {', '.join(map(str, cell[:15]))},"
        yield ", ".join(map(str, cell[15:]))
    face, corner = (2, 4) if name == 1 else (1, 0)
    yield f"*SURFACE, NAME=FACE{name}, TYPE=ELEMENT"
    for i in np.flatnonzero(np.abs(body.nodes[2, cells[corner]]) < 1e-9):
        yield f"{elements + i + 1}, S{face}"
    yield f"*MATERIAL, NAME=M{name}\n*ELASTIC\n{body.E / 1e6:g}, {body.nu:g}"
    yield f"*SOLID SECTION, ELSET=E{name}, MATERIAL=M{name}"


def displacements(path: Path) -> np.ndarray:
    """Displacements (n, 3) [m] that were printed."""
    rows = (line.split() for line in path.read_text().splitlines())
    return np.array([[float(v) for v in r[1:]] for r in rows if len(r) == 4 and r[0].isdigit()]) * 1e-3
