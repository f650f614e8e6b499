"""Columns of the files that `fit loop` reads, and which of its measurements a file is."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.quantity.units import Sizes, sizes

from .. import columns
from .least_squares import Array

LEAST = 8
"""Fewest rows of a file."""
RUN = "run"
"""Column that tells measurements apart: one number for all rows of one."""
OTHERS = {
    "displacement": ("x", "s", "u", "weg", "verschiebung"),
    "force": ("kraft", "load", "f"),
    "angle": ("phi", "theta", "winkel", "drehwinkel", "rotation"),
    "torque": ("tau", "moment", "drehmoment", "torsionsmoment"),
    "time": ("t", "zeit"),
    "frequency": ("freq", "frequenz", "f"),
    "damping": ("zeta", "dämpfung", "dämpfungsgrad"),
}
"""{column: other names of it, in lower case}."""


@dataclass(frozen=True, slots=True)
class Heads:
    """Names and units of force and motion of a joint: force or torque, displacement or angle."""

    force: str
    motion: str
    forces: Sizes
    motions: Sizes

    @property
    def columns(self) -> Mapping[str, Sizes]:
        """All columns that are read."""
        return {
            self.motion: self.motions,
            self.force: self.forces,
            "time": sizes("s", "ms"),
            "frequency": sizes("Hz", "kHz"),
            "damping": sizes("1"),
            RUN: sizes("1"),
        }

    @property
    def unit(self) -> tuple[str, str]:
        """SI units of force and motion."""
        return next(iter(self.forces)), next(iter(self.motions))


def read(path: str | Path, heads: Heads) -> tuple[str, columns.Columns]:
    """One of "loops", "response", "backbone", "decay" and the columns of the file.

    loops    : motion, force
    response : motion (amplitude), force (amplitude), frequency
    backbone : motion (amplitude), frequency, damping
    decay    : motion, time

    Raises ValueError, one line, for anything else.
    """
    table = columns.read(path, heads.columns, LEAST, OTHERS)
    table.require(heads.motion, heads.columns)
    have = set(table.columns)
    if {"frequency", heads.force} <= have:
        return "response", _positive(table, heads, "frequency", heads.force)
    if {"frequency", "damping"} <= have:
        return "backbone", _positive(table, heads, "frequency", "damping")
    if "frequency" not in have and heads.force in have:
        return "loops", table
    if "frequency" not in have and "time" in have:
        return "decay", table
    beside = (heads.force,), ("time",), ("frequency", heads.force), ("frequency", "damping")
    raise ValueError(
        f"{table.path}: has {', '.join(table.columns)} alone; expected {heads.motion} with "
        f"{', or with '.join(' and '.join(names) for names in beside)}"
    )


def _positive(table: columns.Columns, heads: Heads, *names: str) -> columns.Columns:
    for name in (heads.motion, *names):
        column = table.columns[name]
        if np.any(wrong := column <= 0.0):
            first = int(np.argmax(wrong))
            unit = next(iter(heads.columns[name]))
            raise ValueError(
                f"{table.path}: line {table.lines[first]}: {name} = {column[first]:g} {unit} is outside "
                "(0, inf)"
            )
    return table


def runs(table: columns.Columns) -> list[tuple[str, dict[str, Array]]]:
    """The measurements of a file, told apart by the column `run`: how a message calls each, its columns."""
    if RUN not in table.columns:
        return [("", dict(table.columns))]
    number = table.columns[RUN]
    parts = []
    for each in dict.fromkeys(number.tolist()):
        rows = number == each
        parts.append((f"run {each:g}: ", {name: column[rows] for name, column in table.columns.items()}))
    return parts
