"""Time series, and their CSV files by the FMI cross-check rules: quoted names, time first, no units."""

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array

TIME_COLUMN_NAME = "time"
"""Name of the first column."""


@dataclass(frozen=True, slots=True)
class TimeSeries:
    """Time series of variables: `time` (n) [s], `columns` {variable: values (n)}."""

    time: Array
    columns: Mapping[str, Array]

    def interpolate_linearly(self, column_name: str, query_times: Array) -> Array:
        """Interpolate a column linearly at times (m) [s]; constant beyond the ends.

        A repeated time is a jump: there the result is the value after the jump.
        """
        return np.asarray(np.interp(query_times, self.time, self.columns[column_name]))

    def interpolate_before_jumps(self, column_name: str, query_times: Array) -> Array:
        """Interpolate a column linearly at times (m) [s]; at a jump, take the value before it."""
        return np.asarray(np.interp(-query_times, -self.time[::-1], self.columns[column_name][::-1]))

    def interpolate_stepwise(self, column_name: str, query_times: Array) -> Array:
        """Interpolate a column at times (m) [s]; it is constant from each row to the next."""
        rows = np.searchsorted(self.time, query_times, side="right") - 1
        return self.columns[column_name][np.maximum(rows, 0)]


def format_time_series_csv(time_series: TimeSeries, significant_digits: int | None = None) -> str:
    """Format a time series as CSV.

    significant_digits : significant digits of the columns except time; None: exact
    """
    head = ",".join(f'"{name}"' for name in (TIME_COLUMN_NAME, *time_series.columns))
    number_format = "%r" if significant_digits is None else f"%.{significant_digits}g"
    rows = zip(
        *(column.tolist() for column in (time_series.time, *time_series.columns.values())), strict=True
    )
    lines = (",".join([repr(time), *(number_format % (value + 0.0) for value in row)]) for time, *row in rows)
    return "\n".join([head, *lines, ""])


def parse_time_series_csv(csv_text: str, csv_file_name: str) -> TimeSeries:
    """Read a time series from CSV text.

    csv_file_name : name of the file in error messages

    Raises ValueError with one line if the column time is missing, rows differ in length, a value is no
    number, or time decreases.
    """
    rows = [row for row in csv.reader(io.StringIO(csv_text)) if row]
    head = [name.strip() for name in rows[0]] if rows else []
    if not head:
        raise ValueError(f"{csv_file_name}: is empty; expected columns, {TIME_COLUMN_NAME!r} first")
    if head[0].lower() != TIME_COLUMN_NAME:
        raise ValueError(
            f"{csv_file_name}: the first column is {head[0][:60]!r}, expected {TIME_COLUMN_NAME!r}"
        )
    if len(rows) < 2:
        raise ValueError(f"{csv_file_name}: has no rows below its header")
    if repeated := [name for name in head if head.count(name) > 1]:
        raise ValueError(f"{csv_file_name}: column {repeated[0]!r} is given twice; state it once")
    numbers = []
    for i, row in enumerate(rows[1:], 1):
        if len(row) != len(head):
            raise ValueError(
                f"{csv_file_name}: row {i} below the header has {len(row)} numbers, expected {len(head)}, as "
                f"many as columns; the row is {','.join(row)[:60]!r}"
            )
        try:
            numbers.append([float(cell) for cell in row])
        except ValueError as error:
            raise ValueError(
                f"{csv_file_name}: row {i}: {error}; expected a number for each column"
            ) from None
    table = np.array(numbers)
    times, columns = table[:, 0], dict(zip(head[1:], table[:, 1:].T, strict=True))
    if np.any(wrong := ~np.isfinite(times) | (np.diff(times, prepend=times[0]) < 0.0)):
        i = int(np.argmax(wrong))
        raise ValueError(
            f"{csv_file_name}: row {i + 1}: time = {times[i]:g} s; expected finite times that never decrease"
        )
    return TimeSeries(times, columns)
