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
from .target_model import TargetModel, format_comment_header

DMIG_MATRIX_NAME = "KJOINT"
"""Name of the stiffness matrix of a joint in the NASTRAN file."""


def format_joint_stiffness(
    joint_stiffness: JointStiffness, target_model: TargetModel, comment_lines: Sequence[str]
) -> str:
    """Format a joint as two grids with a CBUSH and its PBUSH, or with a DMIG matrix.

    comment_lines : lines for the head of the file
    """
    first = target_model.first_free_number
    positions = joint_stiffness.node_positions_in_model_units(target_model)
    share = _find_spring_location_fraction(positions)
    K = joint_stiffness.matrix_in_model_axes(target_model)
    lines = [line for i, xyz in enumerate(positions) for line in _format_grid(first + i, xyz)]
    if share is not None and not np.any(K - np.diag(np.diag(K))):
        note = "CBUSH in the basic coordinate system (CID 0)"
        lines += [
            *_format_large_card("CBUSH", first, first, first, first + 1, "", "", "", 0, share),
            *_format_large_card("PBUSH", first, "K", *np.diag(K)),
        ]
    else:
        note = f"DMIG matrix; select it in the case control section: K2GG = {DMIG_MATRIX_NAME}"
        lines += list(_format_matrix(joint_stiffness.matrix_between_nodes(target_model), first))
    return "\n".join([*format_comment_header([*comment_lines, note], "$"), *lines]) + "\n"


def _find_spring_location_fraction(node_positions: Array) -> float | None:
    """Distance from node 1 to the contact centroid over the distance between nodes 1 and 2: S [1] of CBUSH.

    None if the centroid is not on the line between the nodes.
    """
    start, line = node_positions[0], node_positions[1] - node_positions[0]
    length = float(line @ line)
    if not length:
        return None if start.any() else 0.5
    share = -float(start @ line) / length
    offset = float(np.linalg.norm(start + share * line))
    return share if 0.0 <= share <= 1.0 and offset <= 1e-9 * np.sqrt(length) else None


def _format_grid(node_label: int, node_position: Array) -> Iterable[str]:
    """Format a GRID card of NASTRAN: a node with label and position."""
    yield from _format_large_card("GRID", node_label, "", *node_position)


def _format_matrix(stiffness_matrix: Array, first_node_label: int) -> Iterable[str]:
    """Format a symmetric stiffness matrix as NASTRAN's DMIG cards, column by column of its lower triangle.

    IFO = 6 states a symmetric matrix, TIN = 2 double precision.
    """
    yield f"DMIG    {DMIG_MATRIX_NAME:<8}{0:<8}{6:<8}{2:<8}{0:<8}"
    for j in range(12):
        rows = [i for i in range(j, 12) if stiffness_matrix[i, j]]
        if rows:
            yield f"{'DMIG*':<8}{DMIG_MATRIX_NAME:<16}{first_node_label + j // 6:<16}{j % 6 + 1:<16}"
        for i in rows:
            value = f"{stiffness_matrix[i, j]:.9E}".replace("E", "D")
            yield f"{'*':<8}{first_node_label + i // 6:<16}{i % 6 + 1:<16}{value:<16}"


def _format_large_card(card_name: str, *fields: object) -> Iterable[str]:
    """Format a card of NASTRAN with fields of 16 characters, four in a line."""
    cells = [f"{x:.9E}" if isinstance(x, float) else f"{x}" for x in fields]
    for i in range(0, len(cells), 4):
        mark = f"{card_name}*" if i == 0 else "*"
        yield f"{mark:<8}" + "".join(f"{cell:<16}" for cell in cells[i : i + 4]).rstrip()
