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
from .target_model import Springs, TargetModel, UnitSet, format_comment_header

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
_MIN_SAMPLES_BETWEEN_TABLE_ROWS = 12
"""Smallest number of sample points on a straight line of a table [1].

The peak of a parabolic error is then found within 1 %."""


@dataclass(frozen=True, slots=True)
class LoadTable:
    """Table of a load as a function of displacement.

    table_rows                  : (n, 3) displacement, load, and stiffness of the curve at this displacement
    linear_interpolation_errors : [1] largest relative errors of load and stiffness with straight lines
    monotone_cubic_errors       : [1] the same errors with the monotone cubic of Fritsch and Butland
    """

    table_rows: Array
    linear_interpolation_errors: tuple[float, float]
    monotone_cubic_errors: tuple[float, float]


def tabulate_law(load_curve: Curve, max_load_error: float) -> LoadTable:
    """Tabulate an interface law: approach [m] from first touch, pressure [Pa], stiffness [N/m3].

    max_load_error : largest relative error [1] of the pressure with linear interpolation

    The table ends at the largest pressure of the law. Below the pressure range of the law, a straight line
    leads to zero pressure; the error is limited above this line only.
    """
    x, y, k = _sample_curve(load_curve)
    in_range = x >= 0.0
    table = decimate_curve(x[in_range] - load_curve.displacement[0], y[in_range], k[in_range], max_load_error)
    rows = np.vstack([[0.0, 0.0, 0.0], table.table_rows])
    return LoadTable(rows, table.linear_interpolation_errors, table.monotone_cubic_errors)


def tabulate_within_row_limit(
    tabulate_at_error: Callable[[float], LoadTable], too_small_error: float, max_row_count: int
) -> tuple[float, LoadTable]:
    """Find the smallest error [1] (two digits) whose table has at most `max_row_count` rows; and this table.

    tabulate_at_error : (largest relative error [1]) -> table; a larger error gives fewer rows
    too_small_error   : an error [1], a power of ten, whose table has more rows

    Raises ValueError if no error below 0.5 is enough.
    """
    errors = [
        digits * too_small_error / 10.0 * 10.0**decade
        for decade in range(3)
        for digits in range(10, 100)
        if digits * too_small_error / 10.0 * 10.0**decade < MAX_TABLE_ERROR
    ]
    found: dict[int, LoadTable] = {}

    def has_allowed_row_count(error_index: int) -> bool:
        """Whether a table has at most `max_row_count` rows; its allowed error is an entry of `errors`."""
        found[error_index] = tabulate_at_error(errors[error_index])
        return len(found[error_index].table_rows) <= max_row_count

    i = bisect_left(range(len(errors)), True, lo=1, key=has_allowed_row_count)
    if i == len(errors):
        raise ValueError(
            f"the law needs more than {max_row_count} rows for a table with an error of {MAX_TABLE_ERROR:g}; "
            "export it for another program"
        )
    return float(f"{errors[i]:.2g}"), found[i]


def tabulate_load(load_curve: Curve, contact_area: float, max_load_error: float) -> LoadTable:
    """Tabulate load [N] and stiffness [N/m] of an interface with an area [m2] against approach [m].

    The first row is the open contact, with zero load.
    """
    table = tabulate_law(load_curve, max_load_error)
    rows = table.table_rows * [1.0, contact_area, contact_area]
    return LoadTable(
        np.vstack([[-rows[-1, 0], 0.0, 0.0], rows]),
        table.linear_interpolation_errors,
        table.monotone_cubic_errors,
    )


def tabulate_odd_curve(load_curve: Curve, max_load_error: float) -> LoadTable:
    """Tabulate a load curve with f(-x) = -f(x), for displacements x of both signs.

    max_load_error : largest relative error [1] of the load with linear interpolation

    The stiffness error is kept below MAX_STIFFNESS_ERROR, unless the curve has a jump of the stiffness.
    """
    half = _sample_curve(load_curve, _MIN_STIFFNESS_CURVE_SAMPLES)
    try:
        rows = decimate_curve(*half, max_load_error, max_stiffness_error=MAX_STIFFNESS_ERROR).table_rows
    except ValueError:
        rows = decimate_curve(*half, max_load_error).table_rows
    rows = np.vstack([rows[:0:-1] * [-1.0, -1.0, 1.0], rows])
    x, y, k = (np.concatenate([sign * v[:0:-1], v]) for sign, v in zip((-1.0, -1.0, 1.0), half, strict=True))
    return LoadTable(rows, *_interpolation_errors(rows, x, y, k, (0.0, 0.0)))


def decimate_curve(
    displacement: Array,
    curve_loads: Array,
    stiffness: Array,
    max_load_error: float,
    min_error_reference: tuple[float, float] = (0.0, 0.0),
    required_point_indices: Collection[int] = (),
    max_stiffness_error: float = np.inf,
) -> LoadTable:
    """Select few of the points (n) of a curve so that linear interpolation stays within an error.

    displacement, curve_loads, stiffness : points (n) of the curve
    max_load_error         : [1] largest error of the load, relative to the load, or to min_error_reference[0]
                             if that is larger
    min_error_reference    : smallest load and stiffness to which errors are relative
    required_point_indices : indices of points that are always selected
    max_stiffness_error    : [1] largest relative error of the slope of a line

    The points are selected one after the other. Raises ValueError if the error is out of range or too small.
    """
    if not 0.0 < max_load_error < MAX_TABLE_ERROR:
        raise ValueError(
            f"error = {max_load_error:g} is outside (0, {MAX_TABLE_ERROR:g}): relative error of the table"
        )
    size = np.maximum(np.abs(curve_loads), min_error_reference[0])
    size = np.where(size > 0.0, size, np.inf)

    def line_error_over_allowed_error(first_point_index: int, last_point_index: int) -> float:
        """Largest error of a straight line between two points of the curve, over the allowed error [1].

        If the slope is limited, its error over the allowed error counts too.
        """
        slope = (curve_loads[last_point_index] - curve_loads[first_point_index]) / (
            displacement[last_point_index] - displacement[first_point_index]
        )
        line = curve_loads[first_point_index] + slope * (
            displacement[first_point_index : last_point_index + 1] - displacement[first_point_index]
        )
        loads = (
            float(
                np.max(
                    np.abs(line - curve_loads[first_point_index : last_point_index + 1])
                    / size[first_point_index : last_point_index + 1]
                )
            )
            / max_load_error
        )
        if not np.isfinite(max_stiffness_error):
            return loads
        return max(
            loads,
            float(np.max(np.abs(slope / stiffness[first_point_index : last_point_index + 1] - 1.0)))
            / max_stiffness_error,
        )

    stops = {*required_point_indices, displacement.size - 1}
    index = decimate_table(stops, lambda i, j: line_error_over_allowed_error(i, j) <= 1.0)
    between = np.diff(index)[~np.isin(index[1:], list(stops))]
    if np.any(between < _MIN_SAMPLES_BETWEEN_TABLE_ROWS):
        raise ValueError(
            f"table error = {max_load_error:g} is too small for a table: it would need {index.size} rows or "
            "more; state a larger error"
        )
    rows = np.stack([displacement[index], curve_loads[index], stiffness[index]], axis=1)
    return LoadTable(
        rows, *_interpolation_errors(rows, displacement, curve_loads, stiffness, min_error_reference)
    )


def _interpolation_errors(
    table_rows: Array,
    displacement: Array,
    load: Array,
    stiffness: Array,
    min_error_reference: tuple[float, float],
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Largest relative errors of load and stiffness: with linear interpolation, with the monotone cubic."""
    which = np.clip(np.searchsorted(table_rows[:, 0], displacement, side="right") - 1, 0, len(table_rows) - 2)
    slope = np.array([(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(table_rows)])[which]
    cubic = PchipInterpolator(table_rows[:, 0], table_rows[:, 1])

    def largest_error(interpolated_values: Array, exact_values: Array, min_reference_value: float) -> float:
        """Largest error [1] of interpolated values, relative to value or min_reference_value."""
        size = np.maximum(np.abs(exact_values), min_reference_value)
        positive = size > 0.0
        return float(np.max(np.abs(interpolated_values - exact_values)[positive] / size[positive]))

    straight = (
        largest_error(
            np.interp(displacement, table_rows[:, 0], table_rows[:, 1]), load, min_error_reference[0]
        ),
        largest_error(slope, stiffness, min_error_reference[1]),
    )
    return straight, (
        largest_error(cubic(displacement), load, min_error_reference[0]),
        largest_error(cubic(displacement, 1), stiffness, min_error_reference[1]),
    )


def _sample_curve(load_curve: Curve, min_samples: int = _MIN_CURVE_SAMPLES) -> tuple[Array, Array, Array]:
    """Sample a curve at many points: displacement, load and stiffness."""
    nodes = load_curve.displacement
    count = max(_SAMPLES_PER_SEGMENT, min_samples // (nodes.size - 1))
    fraction = np.arange(count) / count
    x = np.append((nodes[:-1, None] + np.diff(nodes)[:, None] * fraction).ravel(), nodes[-1])
    load, stiffness = load_curve.derivatives(x, 1)
    return x, load, stiffness


ColumnHeads = Sequence[tuple[str, str]]
"""Headings of columns: (name, SI unit) of each."""

TABLE_SIGNIFICANT_DIGITS = 12
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


def format_springs_csv(springs: Springs, target_model: TargetModel, comment_lines: Sequence[str]) -> str:
    """Format the springs as CSV, one row per pair.

    Columns: labels, position in the joint's plane, area, pressure, stiffness and damping along the model's
    axes.
    """
    stiffness = target_model.assign_to_axes(springs.K_t, springs.K_n)
    damping = target_model.assign_to_axes(springs.C_t, springs.C_n)
    values = [*springs.position.T, springs.area, springs.pressure, *stiffness.T, *damping.T]
    return format_columns_csv(
        [*springs.node_labels.T, *values],
        [*LABEL_COLUMN_HEADS, *SPRING_COLUMN_HEADS],
        target_model.unit_set,
        comment_lines,
    )


def format_contact_csv(load_table: LoadTable, unit_set: UnitSet, comment_lines: Sequence[str]) -> str:
    """Format a contact law as CSV: overclosure, pressure, stiffness per area."""
    heads = (("overclosure", "m"), ("pressure", "Pa"), ("stiffness", "N/m3"))
    return format_columns_csv([*load_table.table_rows.T], heads, unit_set, comment_lines)


def format_columns_csv(
    si_columns: Sequence[Column], column_heads: ColumnHeads, unit_set: UnitSet, comment_lines: Sequence[str]
) -> str:
    """Format columns (n) of SI values as CSV in the units of a unit set."""
    converted = [
        column if unit == "1" else unit_set.convert_from_si(column, unit)
        for column, (_, unit) in zip(si_columns, column_heads, strict=True)
    ]
    names = [(name, unit_set.unit_symbol(unit)) for name, unit in column_heads]
    return format_table(
        names,
        converted,
        significant_digits=TABLE_SIGNIFICANT_DIGITS,
        header_lines=format_comment_header(comment_lines, "#"),
    )


def format_modelica_table(table_rows: Array, table_name: str, comment_lines: Sequence[str]) -> str:
    """Format a table (n, columns) of SI values as the table `table_name` in a text file of Modelica.

    The first column must be ascending.
    """
    body = format_rows(table_rows.T, [TABLE_SIGNIFICANT_DIGITS] * table_rows.shape[1], delimiter=" ")
    return "\n".join(
        [
            "#1",
            *format_comment_header(comment_lines, "#"),
            f"double {table_name}({table_rows.shape[0]},{table_rows.shape[1]})",
            *body,
            "",
        ]
    )
