"""Curves as tables for linear interpolation, written as CSV and for Modelica's CombiTable1D blocks."""

from bisect import bisect_left
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from ...common.columns import Column, format_rows, format_table
from ..thinning import decimate_table
from .placing import Placement, Springs, UnitSet, format_comment_header

MAX_STIFFNESS_ERROR = 0.01
"""Relative error of the stiffness [1] above which a warning is printed."""
MAX_TABLE_ERROR = 0.5
"""Largest relative error of the load [1] that the user may allow for a table."""
_SAMPLES_PER_SEGMENT = 64
"""Sample points per segment of a curve, at which errors are measured."""
_MIN_CURVE_SAMPLES = 10_000
"""Smallest number of sample points of a whole curve, for curves with few segments."""
_MIN_STIFFNESS_CURVE_SAMPLES = 4 * _MIN_CURVE_SAMPLES
"""Smallest number of sample points if the stiffness error is limited too: some curves have short corners."""
_MIN_SAMPLES_PER_TABLE_LINE = 12
"""Smallest number of sample points on a straight line of a table [1].

The peak of a parabolic error is then found within 1 %."""


@dataclass(frozen=True, slots=True)
class LoadTable:
    """Table of a load over a displacement.

    rows                  : (n, 3) displacement, load, and stiffness of the curve at this displacement
    linear_errors         : [1] largest relative errors of load and stiffness with linear interpolation
    monotone_cubic_errors : [1] the same errors with the monotone cubic of Fritsch and Butland
    """

    rows: Array
    linear_errors: tuple[float, float]
    monotone_cubic_errors: tuple[float, float]


def tabulate_law(curve: Curve, max_error: float) -> LoadTable:
    """Tabulate an interface law: approach [m] from first touch, pressure [Pa], stiffness [N/m3].

    max_error : largest relative error [1] of the pressure with linear interpolation

    The table ends at the largest pressure of the law. Below the pressure range of the law, a straight line
    leads to zero pressure; the error is limited above this line only.
    """
    x, y, k = _sample_curve(curve)
    in_range = x >= 0.0
    table = decimate_curve(x[in_range] - curve.displacement[0], y[in_range], k[in_range], max_error)
    rows = np.vstack([[0.0, 0.0, 0.0], table.rows])
    return LoadTable(rows, table.linear_errors, table.monotone_cubic_errors)


def fit_row_limit(
    tabulate: Callable[[float], LoadTable], min_error: float, max_rows: int
) -> tuple[float, LoadTable]:
    """Find the smallest error [1], with two digits, whose table has at most `max_rows` rows; and this table.

    tabulate  : (largest relative error [1]) -> table; a larger error gives fewer rows
    min_error : an error [1], a power of ten, whose table has more rows

    Raises ValueError if no error below 0.5 is enough.
    """
    errors = [
        digits * min_error / 10.0 * 10.0**decade
        for decade in range(3)
        for digits in range(10, 100)
        if digits * min_error / 10.0 * 10.0**decade < MAX_TABLE_ERROR
    ]
    found: dict[int, LoadTable] = {}

    def is_short_enough(i: int) -> bool:
        """Whether the table with the largest allowed error `errors[i]` has at most `max_rows` rows."""
        found[i] = tabulate(errors[i])
        return len(found[i].rows) <= max_rows

    i = bisect_left(range(len(errors)), True, lo=1, key=is_short_enough)
    if i == len(errors):
        raise ValueError(f"no table with an error below {MAX_TABLE_ERROR:g} has at most {max_rows} rows")
    return float(f"{errors[i]:.2g}"), found[i]


def tabulate_load(curve: Curve, area: float, max_error: float) -> LoadTable:
    """Tabulate the load [N] and stiffness [N/m] of an interface law on an area [m2].

    The first row is the open contact, with zero load.
    """
    table = tabulate_law(curve, max_error)
    rows = table.rows * [1.0, area, area]
    return LoadTable(
        np.vstack([[-rows[-1, 0], 0.0, 0.0], rows]), table.linear_errors, table.monotone_cubic_errors
    )


def tabulate_odd_curve(curve: Curve, max_error: float) -> LoadTable:
    """Tabulate an odd curve through zero, with both signs of the displacement.

    max_error : largest relative error [1] of the load with linear interpolation

    The stiffness error is kept below MAX_STIFFNESS_ERROR, unless the curve has a jump of the stiffness.
    """
    half = _sample_curve(curve, _MIN_STIFFNESS_CURVE_SAMPLES)
    try:
        rows = decimate_curve(*half, max_error, stiffness_error=MAX_STIFFNESS_ERROR).rows
    except ValueError:
        rows = decimate_curve(*half, max_error).rows
    rows = np.vstack([rows[:0:-1] * [-1.0, -1.0, 1.0], rows])
    x, y, k = (np.concatenate([sign * v[:0:-1], v]) for sign, v in zip((-1.0, -1.0, 1.0), half, strict=True))
    return LoadTable(rows, *_interpolation_errors(rows, x, y, k, (0.0, 0.0)))


def decimate_curve(
    displacement: Array,
    curve_loads: Array,
    stiffness: Array,
    max_error: float,
    min_reference: tuple[float, float] = (0.0, 0.0),
    fixed_points: Collection[int] = (),
    stiffness_error: float = np.inf,
) -> LoadTable:
    """Select few of the points (n) of a curve so that linear interpolation stays within an error.

    displacement, curve_loads, stiffness : points (n) of the curve
    max_error : [1] largest error of the load, relative to the load, or to min_reference[0] if that is
                      larger
    min_reference : smallest load and stiffness to which errors are relative
    fixed_points : indices of points that are always selected
    stiffness_error : [1] largest relative error of the slope of a line

    The points are selected one after the other. Raises ValueError if the error is out of range or too small.
    """
    if not 0.0 < max_error < MAX_TABLE_ERROR:
        raise ValueError(f"error = {max_error:g} is outside (0, {MAX_TABLE_ERROR:g})")
    size = np.maximum(np.abs(curve_loads), min_reference[0])
    size = np.where(size > 0.0, size, np.inf)

    def error_ratio(first_point: int, last_point: int) -> float:
        """Largest error on a straight line between two points of the curve, over the allowed error [1]."""
        slope = (curve_loads[last_point] - curve_loads[first_point]) / (
            displacement[last_point] - displacement[first_point]
        )
        line = curve_loads[first_point] + slope * (
            displacement[first_point : last_point + 1] - displacement[first_point]
        )
        loads = (
            float(
                np.max(
                    np.abs(line - curve_loads[first_point : last_point + 1])
                    / size[first_point : last_point + 1]
                )
            )
            / max_error
        )
        if not np.isfinite(stiffness_error):
            return loads
        return max(
            loads,
            float(np.max(np.abs(slope / stiffness[first_point : last_point + 1] - 1.0))) / stiffness_error,
        )

    stops = {*fixed_points, displacement.size - 1}
    index = decimate_table(stops, lambda i, j: error_ratio(i, j) <= 1.0)
    between = np.diff(index)[~np.isin(index[1:], list(stops))]
    if np.any(between < _MIN_SAMPLES_PER_TABLE_LINE):
        raise ValueError(
            f"error = {max_error:g} is too small for a table; it would have {index.size} rows or more"
        )
    rows = np.stack([displacement[index], curve_loads[index], stiffness[index]], axis=1)
    return LoadTable(rows, *_interpolation_errors(rows, displacement, curve_loads, stiffness, min_reference))


def _interpolation_errors(
    table_rows: Array, displacement: Array, load: Array, stiffness: Array, min_reference: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Largest relative errors of load and stiffness: with linear interpolation, with the monotone cubic."""
    which = np.clip(np.searchsorted(table_rows[:, 0], displacement, side="right") - 1, 0, len(table_rows) - 2)
    slope = np.array([(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(table_rows)])[which]
    cubic = PchipInterpolator(table_rows[:, 0], table_rows[:, 1])

    def largest_error(interpolated_values: Array, exact_values: Array, min_reference_value: float) -> float:
        """Largest error of interpolated values, relative to the values or to a smallest reference [1]."""
        size = np.maximum(np.abs(exact_values), min_reference_value)
        positive = size > 0.0
        return float(np.max(np.abs(interpolated_values - exact_values)[positive] / size[positive]))

    straight = (
        largest_error(np.interp(displacement, table_rows[:, 0], table_rows[:, 1]), load, min_reference[0]),
        largest_error(slope, stiffness, min_reference[1]),
    )
    return straight, (
        largest_error(cubic(displacement), load, min_reference[0]),
        largest_error(cubic(displacement, 1), stiffness, min_reference[1]),
    )


def _sample_curve(curve: Curve, min_samples: int = _MIN_CURVE_SAMPLES) -> tuple[Array, Array, Array]:
    """Sample a curve at many points: displacement, load and stiffness."""
    nodes = curve.displacement
    count = max(_SAMPLES_PER_SEGMENT, min_samples // (nodes.size - 1))
    fraction = np.arange(count) / count
    x = np.append((nodes[:-1, None] + np.diff(nodes)[:, None] * fraction).ravel(), nodes[-1])
    load, stiffness = curve.derivatives(x, 1)
    return x, load, stiffness


ColumnHeads = Sequence[tuple[str, str]]
"""Headings of columns: (name, SI unit) of each."""

SIGNIFICANT_DIGITS = 12
"""Significant digits of numbers in tables."""
LABEL_COLUMN_HEADS: ColumnHeads = (("node_1", "1"), ("node_2", "1"))
"""Headings of the columns with the node labels of a pair."""
SPRING_COLUMN_HEADS: ColumnHeads = (
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
"""Headings of the columns of a pair: position, area, pressure, stiffness, damping."""


def format_springs_csv(springs: Springs, placement: Placement, comment_lines: Sequence[str]) -> str:
    """Format the springs as CSV, one row per pair.

    Columns: labels, position in the joint's plane, area, pressure, stiffness and damping along the model's
    axes.
    """
    stiffness = placement.assign_to_axes(springs.K_t, springs.K_n)
    damping = placement.assign_to_axes(springs.C_t, springs.C_n)
    values = [*springs.position.T, springs.area, springs.pressure, *stiffness.T, *damping.T]
    return format_columns_csv(
        [*springs.node_labels.T, *values],
        [*LABEL_COLUMN_HEADS, *SPRING_COLUMN_HEADS],
        placement.units,
        comment_lines,
    )


def format_contact_csv(load_table: LoadTable, unit_set: UnitSet, comment_lines: Sequence[str]) -> str:
    """Format a contact law as CSV: overclosure, pressure, stiffness per area."""
    heads = (("overclosure", "m"), ("pressure", "Pa"), ("stiffness", "N/m3"))
    return format_columns_csv([*load_table.rows.T], heads, unit_set, comment_lines)


def format_columns_csv(
    values: Sequence[Column], column_heads: ColumnHeads, unit_set: UnitSet, comment_lines: Sequence[str]
) -> str:
    """Format columns (n) of SI values as CSV in the units of a unit set."""
    converted = [
        column if unit == "1" else unit_set.convert(column, unit)
        for column, (_, unit) in zip(values, column_heads, strict=True)
    ]
    names = [(name, unit_set.symbol(unit)) for name, unit in column_heads]
    return format_table(
        names, converted, digits=SIGNIFICANT_DIGITS, header_lines=format_comment_header(comment_lines, "#")
    )


def format_modelica_table(table_rows: Array, table_name: str, comment_lines: Sequence[str]) -> str:
    """Format a table (n, columns) of SI values as the table `table_name` in a text file of Modelica.

    The first column must be ascending.
    """
    body = format_rows(table_rows.T, [SIGNIFICANT_DIGITS] * table_rows.shape[1], delimiter=" ")
    return "\n".join(
        [
            "#1",
            *format_comment_header(comment_lines, "#"),
            f"double {table_name}({table_rows.shape[0]},{table_rows.shape[1]})",
            *body,
            "",
        ]
    )
