"""Columns of numbers: CSV, and the text file of Modelica's CombiTable1D blocks."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..columns import Column, rows, text
from .placing import Placing, header
from .springs import Springs
from .tables import LoadTable
from .units import Units

Array = NDArray[np.float64]
Heads = Sequence[tuple[str, str]]
"""(name, SI unit) of every column."""

DIGITS = 12
LABEL_HEADS: Heads = (("node_1", "1"), ("node_2", "1"))
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
    values = [*springs.position.T, springs.area, springs.pressure, *stiffness.T, *damping.T]
    return _csv([*springs.nodes.T, *values], [*LABEL_HEADS, *SPRING_HEADS], placing.units, about)


def table_csv(table: Array, heads: Heads, units: Units, about: Sequence[str]) -> str:
    """A table (n, columns) of SI values."""
    return _csv(list(table.T), heads, units, about)


def contact_csv(table: LoadTable, units: Units, about: Sequence[str]) -> str:
    """Overclosure, pressure and stiffness per area."""
    heads = (("overclosure", "m"), ("pressure", "Pa"), ("stiffness", "N/m3"))
    return table_csv(table.rows, heads, units, about)


def _csv(values: Sequence[Column], heads: Heads, units: Units, about: Sequence[str]) -> str:
    shown = [
        column if unit == "1" else units.of(column, unit)
        for column, (_, unit) in zip(values, heads, strict=True)
    ]
    names = [(name, units.symbol(unit)) for name, unit in heads]
    return text(names, shown, digits=DIGITS, above=header(about, "#"))


def modelica_text(table: Array, name: str, about: Sequence[str]) -> str:
    """A table (n, columns) of SI values as `tableName = name` of a text file, first column ascending."""
    body = rows(table.T, [DIGITS] * table.shape[1], between=" ")
    return "\n".join(
        ["#1", *header(about, "#"), f"double {name}({table.shape[0]},{table.shape[1]})", *body, ""]
    )
