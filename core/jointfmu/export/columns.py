"""Columns of numbers: CSV, and the text file of Modelica's CombiTable1D blocks."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .placing import Placing, header
from .springs import Springs
from .units import Units

Array = NDArray[np.float64]
Heads = Sequence[tuple[str, str]]
"""(name, SI unit) of every column."""

SPRING_HEADS: Heads = (
    ("x", "m"),
    ("y", "m"),
    ("area", "m2"),
    ("pressure", "Pa"),
    ("K_x", "N/m"),
    ("K_y", "N/m"),
    ("K_z", "N/m"),
    ("C_x", "N.s/m"),
    ("C_y", "N.s/m"),
    ("C_z", "N.s/m"),
)


def springs_csv(springs: Springs, placing: Placing, about: Sequence[str]) -> str:
    """One row per pair: labels, place in the joint's plane, area, pressure, springs and dashpots.

    Springs and dashpots lie along the model's axes.
    """
    stiffness = placing.along(springs.K_t, springs.K_n)
    damping = placing.along(springs.C_t, springs.C_n)
    values = np.column_stack([springs.position, springs.area, springs.pressure, stiffness, damping])
    labels = [f"{a},{b}," for a, b in springs.nodes.tolist()]
    return _csv(values, SPRING_HEADS, placing.units, about, "node_1 [1],node_2 [1],", labels)


def table_csv(rows: Array, heads: Heads, units: Units, about: Sequence[str]) -> str:
    """A table (n, columns) of SI values."""
    return _csv(rows, heads, units, about, "", [""] * len(rows))


def _csv(
    rows: Array, heads: Heads, units: Units, about: Sequence[str], before: str, labels: Sequence[str]
) -> str:
    columns = [units.of(column, unit) for column, (_, unit) in zip(rows.T, heads, strict=True)]
    lines = [label + _numbers(row, ",") for label, row in zip(labels, np.stack(columns, axis=1), strict=True)]
    names = ",".join(f"{name} [{units.symbol(unit)}]" for name, unit in heads)
    return "\n".join([*header(about, "#"), before + names, *lines]) + "\n"


def modelica_text(rows: Array, name: str, about: Sequence[str]) -> str:
    """A table (n, columns) of SI values as `tableName = name` of a text file, first column ascending."""
    body = [_numbers(row, " ") for row in rows]
    return "\n".join(
        ["#1", *header(about, "#"), f"double {name}({rows.shape[0]},{rows.shape[1]})", *body, ""]
    )


def _numbers(row: Array, between: str) -> str:
    return between.join(f"{v + 0.0:.12g}" for v in row)
