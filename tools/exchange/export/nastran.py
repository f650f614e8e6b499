"""NASTRAN bulk data: stiffness of a complete joint as CBUSH with PBUSH, or as DMIG matrix.

A CBUSH has six stiffnesses and no coupling. Its spring lies on the line between its grids, at the share S of
the distance from the first grid, and transfers its forces by rigid arms. So a CBUSH is exact if K is diagonal
about the centroid of the contact, and the centroid lies on this line. Every other joint is a symmetric DMIG
matrix of both grids.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from jointfmu.quantity import Array

from .joint_stiffness import JointStiffness
from .placing import Placement, format_comment_header

DMIG_NAME = "KJOINT"
"""Name of the stiffness matrix of a joint in the NASTRAN file."""


def format_joint_stiffness(
    stiffness: JointStiffness, placement: Placement, comment_lines: Sequence[str]
) -> str:
    """Format a joint as two grids with a CBUSH and its PBUSH, or with a DMIG matrix.

    comment_lines : lines for the head of the file
    """
    first = placement.first_free_number
    positions = stiffness.model_positions(placement)
    share = _spring_position(positions)
    K = stiffness.model_matrix(placement)
    lines = [line for i, xyz in enumerate(positions) for line in _format_grid(first + i, xyz)]
    if share is not None and not np.any(K - np.diag(np.diag(K))):
        note = "CBUSH in the basic coordinate system (CID 0)"
        lines += [
            *_large_card("CBUSH", first, first, first, first + 1, "", "", "", 0, share),
            *_large_card("PBUSH", first, "K", *np.diag(K)),
        ]
    else:
        note = f"DMIG matrix; select it in the case control section: K2GG = {DMIG_NAME}"
        lines += list(_format_matrix(stiffness.node_matrix(placement), first))
    return "\n".join([*format_comment_header([*comment_lines, note], "$"), *lines]) + "\n"


def _spring_position(node_positions: Array) -> float | None:
    """Share S [1] of the distance from node 1 to node 2 at which the centroid of the contact lies.

    None if the centroid is not on the line between the nodes.
    """
    start, line = node_positions[0], node_positions[1] - node_positions[0]
    length = float(line @ line)
    if not length:
        return None if start.any() else 0.5
    share = -float(start @ line) / length
    offset = float(np.linalg.norm(start + share * line))
    return share if 0.0 <= share <= 1.0 and offset <= 1e-9 * np.sqrt(length) else None


def _format_grid(label: int, position: Array) -> Iterable[str]:
    """Format a GRID card of NASTRAN: a node with label and position."""
    yield from _large_card("GRID", label, "", *position)


def _format_matrix(stiffness_matrix: Array, first_label: int) -> Iterable[str]:
    """Format a symmetric matrix as DMIG columns of its lower triangle (IFO = 6, double precision TIN = 2)."""
    yield f"DMIG    {DMIG_NAME:<8}{0:<8}{6:<8}{2:<8}{0:<8}"
    for j in range(12):
        rows = [i for i in range(j, 12) if stiffness_matrix[i, j]]
        if rows:
            yield f"{'DMIG*':<8}{DMIG_NAME:<16}{first_label + j // 6:<16}{j % 6 + 1:<16}"
        for i in rows:
            value = f"{stiffness_matrix[i, j]:.9E}".replace("E", "D")
            yield f"{'*':<8}{first_label + i // 6:<16}{i % 6 + 1:<16}{value:<16}"


def _large_card(card_name: str, *fields: object) -> Iterable[str]:
    """Format a card of NASTRAN with fields of 16 characters, four in a line."""
    cells = [f"{x:.9E}" if isinstance(x, float) else f"{x}" for x in fields]
    for i in range(0, len(cells), 4):
        mark = f"{card_name}*" if i == 0 else "*"
        yield f"{mark:<8}" + "".join(f"{cell:<16}" for cell in cells[i : i + 4]).rstrip()
