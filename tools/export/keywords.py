"""CalculiX and Abaqus keywords: springs and dashpots between node pairs, and tabular contact."""

from collections.abc import Iterable, Sequence

import numpy as np

from jointfmu.quantity.refusal import Refusal

from .placing import Placing, Springs, Units, header
from .tables import LoadTable

CALCULIX_ROWS = 200
"""Largest number of rows of a table in CalculiX (its arrays `xiso(200)`)."""
FAR = 1.0
"""Overclosure [m] by which the table is extrapolated linearly: no solver leaves the table."""


def springs_text(springs: Springs, placing: Placing, about: Sequence[str], dashpots: bool) -> str:
    """Format the springs as SPRING2 elements along the model's axes, and for Abaqus also DASHPOT2 elements.

    comment_lines : lines for the head of the file
    dashpots      : whether to write dashpots

    Pairs that agree to nine digits share an element set.
    """
    units = placing.units
    lines = [*header(about, "**"), *(_nodes(springs, placing) if placing.own else [])]
    elements = [("SPRING", "K", placing.along(units.of(springs.K_t, "N/m"), units.of(springs.K_n, "N/m")))]
    if dashpots:
        values = placing.along(units.of(springs.C_t, "N.s/m"), units.of(springs.C_n, "N.s/m"))
        elements.append(("DASHPOT", "C", values))
    element = placing.first
    for keyword, symbol, columns in elements:
        for axis in range(3):
            groups: dict[str, list[int]] = {}
            for pair, value in enumerate(columns[:, axis]):
                groups.setdefault(f"{value:.8E}", []).append(pair)
            for number, (value, members) in enumerate(groups.items(), 1):
                name = f"JOINT_{symbol}{'XYZ'[axis]}_{number}"
                lines.append(f"*ELEMENT, TYPE={keyword}2, ELSET={name}")
                for pair in members:
                    lines.append(f"{element}, {springs.nodes[pair, 0]}, {springs.nodes[pair, 1]}")
                    element += 1
                lines += [f"*{keyword}, ELSET={name}", f"{axis + 1}, {axis + 1}", value]
    return "\n".join(lines) + "\n"


def _nodes(springs: Springs, placing: Placing) -> Iterable[str]:
    coordinates = placing.coordinates(springs.position)
    for side in (0, 1):
        yield f"*NODE, NSET=JOINT_SIDE_{side + 1}"
        for node, xyz in zip(springs.nodes[:, side], coordinates, strict=True):
            yield f"{node}, " + ", ".join(f"{v:.12E}" for v in xyz)


def contact_text(table: LoadTable, units: Units, about: Sequence[str], most: int | None = None) -> str:
    """Format a surface interaction JOINT with the pressure over the overclosure.

    comment_lines : lines for the head of the file
    max_rows      : largest number of rows that the solver can read; None: no limit

    Raises ValueError if the table has more rows.
    """
    x, p, k = table.rows[-1]
    rows = np.vstack([table.rows[:, :2], [x + FAR, p + k * FAR]])
    if most is not None and len(rows) > most:
        raise Refusal(f"the table has {len(rows)} rows, CalculiX holds {most}; allow a larger error", "error")
    lines = [
        *header(about, "**"),
        "*SURFACE INTERACTION, NAME=JOINT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        *(f"{units.of(y, 'Pa'):.10E}, {units.of(s, 'm'):.10E}" for s, y in rows.tolist()),
    ]
    return "\n".join(lines) + "\n"
