"""Curves as tables that a solver joins by straight lines; as CSV, and for Modelica's CombiTable1D blocks."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from ..columns import Column, rows, text
from ..thinning import kept
from .placing import Placing, Springs, Units, header

STIFFNESS = 0.01
"""Error of the stiffness [1] above which a table's reader should know."""
_DENSE = 64
"""Points per segment of a curve at which errors are measured."""
_LEAST = 10_000
"""The same of a whole curve at least: some have few segments."""
_FINE = 4 * _LEAST
"""The same where slopes are kept too: the corners of a catalogue's lines are short."""
_FEWEST = 12
"""Fewest of them on a line: a parabola's top is then met within a per cent."""


@dataclass(frozen=True, slots=True)
class LoadTable:
    """A load over a displacement.

    rows      : (n, 3) displacement, load, stiffness of the curve there
    straight  : [1] largest errors of load and stiffness where a solver joins the rows by lines
    monotone  : [1] the same with the monotone cubic of Fritsch and Butland
    """

    rows: Array
    straight: tuple[float, float]
    monotone: tuple[float, float]


def law_table(curve: Curve, error: float) -> LoadTable:
    """Pressure [Pa] over approach [m] from first touch, stiffness [N/m3], up to the hardness.

    One line leads over the closing of the contact, where the law itself does not reach; the errors are
    those above it.
    """
    x, y, k = _dense(curve)
    some = x >= 0.0
    table = thinned(x[some] - curve.displacement[0], y[some], k[some], error)
    rows = np.vstack([[0.0, 0.0, 0.0], table.rows])
    return LoadTable(rows, table.straight, table.monotone)


def load_table(curve: Curve, area: float, error: float) -> LoadTable:
    """`law_table` of an area [m2]: load [N] and stiffness [N/m], and a row without load before it."""
    table = law_table(curve, error)
    rows = table.rows * [1.0, area, area]
    return LoadTable(np.vstack([[-rows[-1, 0], 0.0, 0.0], rows]), table.straight, table.monotone)


def odd_table(curve: Curve, error: float) -> LoadTable:
    """A curve through zero with its mirror image; the stiffness within STIFFNESS, if it has no jump."""
    half = _dense(curve, _FINE)
    try:
        rows = thinned(*half, error, stiffness=STIFFNESS).rows
    except ValueError:
        rows = thinned(*half, error).rows
    rows = np.vstack([rows[:0:-1] * [-1.0, -1.0, 1.0], rows])
    x, y, k = (np.concatenate([sign * v[:0:-1], v]) for sign, v in zip((-1.0, -1.0, 1.0), half, strict=True))
    return LoadTable(rows, *_errors(rows, x, y, k, (0.0, 0.0)))


def thinned(
    x: Array,
    y: Array,
    k: Array,
    error: float,
    floor: tuple[float, float] = (0.0, 0.0),
    keep: Collection[int] = (),
    stiffness: float = np.inf,
) -> LoadTable:
    """The fewest of the points (n) of a curve, taken one after the other, whose lines keep to it.

    error : [1] largest error of y by straight lines, relative to y or floor[0], the larger
    floor : load and stiffness to which errors refer at least
    keep  : points that stay
    stiffness : [1] largest error of a line's slope

    Raises ValueError for errors that a table cannot keep.
    """
    if not 0.0 < error < 0.5:
        raise ValueError(f"error = {error:g} is outside (0, 0.5)")
    size = np.maximum(np.abs(y), floor[0])
    size = np.where(size > 0.0, size, np.inf)

    def off(i: int, j: int) -> float:
        slope = (y[j] - y[i]) / (x[j] - x[i])
        line = y[i] + slope * (x[i : j + 1] - x[i])
        loads = float(np.max(np.abs(line - y[i : j + 1]) / size[i : j + 1])) / error
        if not np.isfinite(stiffness):
            return loads
        return max(loads, float(np.max(np.abs(slope / k[i : j + 1] - 1.0))) / stiffness)

    stops = {*keep, x.size - 1}
    index = kept(stops, lambda i, j: off(i, j) <= 1.0)
    between = np.diff(index)[~np.isin(index[1:], list(stops))]
    if np.any(between < _FEWEST):
        raise ValueError(
            f"error = {error:g} is too small for a table; it would have {index.size} rows or more"
        )
    rows = np.stack([x[index], y[index], k[index]], axis=1)
    return LoadTable(rows, *_errors(rows, x, y, k, floor))


def _errors(
    rows: Array, x: Array, y: Array, k: Array, floor: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Largest errors of load and stiffness by straight lines and by the monotone cubic."""
    which = np.clip(np.searchsorted(rows[:, 0], x, side="right") - 1, 0, len(rows) - 2)
    slope = np.array([(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(rows)])[which]
    cubic = PchipInterpolator(rows[:, 0], rows[:, 1])

    def worst(approximate: Array, exact: Array, least: float) -> float:
        size = np.maximum(np.abs(exact), least)
        some = size > 0.0
        return float(np.max(np.abs(approximate - exact)[some] / size[some]))

    straight = worst(np.interp(x, rows[:, 0], rows[:, 1]), y, floor[0]), worst(slope, k, floor[1])
    return straight, (worst(cubic(x), y, floor[0]), worst(cubic(x, 1), k, floor[1]))


def _dense(curve: Curve, least: int = _LEAST) -> tuple[Array, Array, Array]:
    """The curve at many points."""
    nodes = curve.displacement
    dense = max(_DENSE, least // (nodes.size - 1))
    part = np.arange(dense) / dense
    x = np.append((nodes[:-1, None] + np.diff(nodes)[:, None] * part).ravel(), nodes[-1])
    load, stiffness = curve.derivatives(x, 1)
    return x, load, stiffness


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
    return columns_csv([*springs.nodes.T, *values], [*LABEL_HEADS, *SPRING_HEADS], placing.units, about)


def contact_csv(table: LoadTable, units: Units, about: Sequence[str]) -> str:
    """Overclosure, pressure and stiffness per area."""
    heads = (("overclosure", "m"), ("pressure", "Pa"), ("stiffness", "N/m3"))
    return columns_csv([*table.rows.T], heads, units, about)


def columns_csv(values: Sequence[Column], heads: Heads, units: Units, about: Sequence[str]) -> str:
    """Columns (n) of SI values."""
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
