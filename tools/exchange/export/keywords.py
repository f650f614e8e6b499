"""CalculiX and Abaqus keywords: springs and dashpots between node pairs, and tabular contact."""

from collections.abc import Iterable, Sequence

import numpy as np

from jointfmu.quantity.refusal import InputRefusal

from .placing import Placement, Springs, UnitSet, comment_header
from .tables import LoadTable

MAX_CALCULIX_ROWS = 200
"""Largest number of rows of a table in CalculiX (its arrays `xiso(200)`)."""
EXTRAPOLATED_OVERCLOSURE = 1.0
"""Overclosure [m] by which the table is extended linearly, so that no solver evaluates beyond its end."""


def format_springs(
    springs: Springs, placement: Placement, comment_lines: Sequence[str], has_dashpots: bool
) -> str:
    """Format the springs as SPRING2 elements along the model's axes, and for Abaqus also DASHPOT2 elements.

    comment_lines : lines for the head of the file
    has_dashpots  : whether to write dashpots

    Pairs that agree to nine digits share an element set.
    """
    units = placement.units
    lines = [
        *comment_header(comment_lines, "**"),
        *(_format_nodes(springs, placement) if placement.has_own_nodes else []),
    ]
    elements = [
        (
            "SPRING",
            "K",
            placement.assign_to_axes(units.convert(springs.K_t, "N/m"), units.convert(springs.K_n, "N/m")),
        )
    ]
    if has_dashpots:
        values = placement.assign_to_axes(
            units.convert(springs.C_t, "N.s/m"), units.convert(springs.C_n, "N.s/m")
        )
        elements.append(("DASHPOT", "C", values))
    element = placement.first_number
    for keyword, symbol, columns in elements:
        for axis in range(3):
            groups: dict[str, list[int]] = {}
            for pair, value in enumerate(columns[:, axis]):
                groups.setdefault(f"{value:.8E}", []).append(pair)
            for number, (value, members) in enumerate(groups.items(), 1):
                name = f"JOINT_{symbol}{'XYZ'[axis]}_{number}"
                lines.append(f"*ELEMENT, TYPE={keyword}2, ELSET={name}")
                for pair in members:
                    lines.append(f"{element}, {springs.node_labels[pair, 0]}, {springs.node_labels[pair, 1]}")
                    element += 1
                lines += [f"*{keyword}, ELSET={name}", f"{axis + 1}, {axis + 1}", value]
    return "\n".join(lines) + "\n"


def _format_nodes(springs: Springs, placement: Placement) -> Iterable[str]:
    coordinates = placement.model_coordinates(springs.position)
    for side in (0, 1):
        yield f"*NODE, NSET=JOINT_SIDE_{side + 1}"
        for node, xyz in zip(springs.node_labels[:, side], coordinates, strict=True):
            yield f"{node}, " + ", ".join(f"{v:.12E}" for v in xyz)


def format_contact(
    load_table: LoadTable, unit_set: UnitSet, comment_lines: Sequence[str], max_rows: int | None = None
) -> str:
    """Format the surface interaction named JOINT: a table of pressure over overclosure.

    comment_lines : lines for the head of the file
    max_rows      : largest number of rows that the solver can read; None: no limit

    Raises ValueError if the table has more rows.
    """
    x, p, k = load_table.rows[-1]
    rows = np.vstack(
        [load_table.rows[:, :2], [x + EXTRAPOLATED_OVERCLOSURE, p + k * EXTRAPOLATED_OVERCLOSURE]]
    )
    if max_rows is not None and len(rows) > max_rows:
        raise InputRefusal(
            f"the table has {len(rows)} rows, CalculiX holds {max_rows}; state a larger error, or none",
            "error",
        )
    lines = [
        *comment_header(comment_lines, "**"),
        "*SURFACE INTERACTION, NAME=JOINT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        *(f"{unit_set.convert(y, 'Pa'):.10E}, {unit_set.convert(s, 'm'):.10E}" for s, y in rows.tolist()),
    ]
    return "\n".join(lines) + "\n"
