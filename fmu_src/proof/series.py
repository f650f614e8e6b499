"""Time series, and their CSV files by the FMI cross-check rules: quoted names, time first, no units."""

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array

TIME_COLUMN = "time"
"""Name of the first column."""


@dataclass(frozen=True, slots=True)
class TimeSeries:
    """Time series: `time` (n) [s], `columns` {variable: values (n)}."""

    time: Array
    columns: Mapping[str, Array]

    def interpolate(self, column_name: str, times: Array) -> Array:
        """Interpolate a column linearly at times (m) [s]; constant beyond the ends.

        A repeated time is a jump: there the result is the value after the jump.
        """
        return np.asarray(np.interp(times, self.time, self.columns[column_name]))

    def interpolate_left(self, column_name: str, times: Array) -> Array:
        """Interpolate a column linearly at times (m) [s]; at a jump, take the value before it."""
        return np.asarray(np.interp(-times, -self.time[::-1], self.columns[column_name][::-1]))

    def interpolate_constant(self, column_name: str, times: Array) -> Array:
        """Values of a column at times (m) [s], constant from each row to the next."""
        rows = np.searchsorted(self.time, times, side="right") - 1
        return self.columns[column_name][np.maximum(rows, 0)]


def format_csv(series: TimeSeries, digits: int | None = None) -> str:
    """Format a time series as CSV; `digits` are the significant digits of the columns, None: exact."""
    head = ",".join(f'"{name}"' for name in (TIME_COLUMN, *series.columns))
    number_format = "%r" if digits is None else f"%.{digits}g"
    rows = zip(*(column.tolist() for column in (series.time, *series.columns.values())), strict=True)
    lines = (",".join([repr(time), *(number_format % (value + 0.0) for value in row)]) for time, *row in rows)
    return "\n".join([head, *lines, ""])


def parse_csv(csv_text: str, location: str) -> TimeSeries:
    """Read a time series from CSV text.

    location : name of the file for errors

    Raises ValueError, one line: missing column time, row of another length, no number, decreasing time.
    """
    rows = [row for row in csv.reader(io.StringIO(csv_text)) if row]
    head = [name.strip() for name in rows[0]] if rows else []
    if not head or head[0].lower() != TIME_COLUMN or len(rows) < 2:
        raise ValueError(
            f"{location}: begins with {','.join(head)[:60]!r}; expected {TIME_COLUMN!r} first, and rows"
        )
    if len(set(head)) < len(head):
        raise ValueError(f"{location}: a column is given twice; state it once")
    for row in rows[1:]:
        if len(row) != len(head):
            raise ValueError(f"{location}: {','.join(row)[:60]!r}: expected rows of {len(head)} numbers")
    try:
        table = np.array([[float(cell) for cell in row] for row in rows[1:]])
    except ValueError as error:
        raise ValueError(f"{location}: {error}; expected rows of {len(head)} numbers") from None
    times, columns = table[:, 0], dict(zip(head[1:], table[:, 1:].T, strict=True))
    if np.any(np.diff(times) < 0.0) or not np.all(np.isfinite(times)):
        raise ValueError(f"{location}: the time falls or is not finite; expected rising times")
    return TimeSeries(times, columns)
