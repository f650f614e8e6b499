"""Results of joints and FMU runs: columns of numbers with units, and tables; text or HTML for notebooks."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.files.outputs import check_output
from jointfmu.files.writing import write_text
from jointfmu.quantity import Array

from ..common import columns, plots
from ..common.shown import align_columns
from ..run.ramps import ramp

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MAX_CELL_LENGTH = 60
"""Largest number of characters of a table cell in printed text [1]; a notebook shows all."""


@dataclass(frozen=True, slots=True)
class Table:
    """Table of text cells with a title and column headings.

    title : first line
    heads : headings of the columns
    rows  : cells (rows, columns)
    lines : lines of text between title and rows

    >>> import jointfmu
    >>> table = jointfmu.load("GearContact").parameters
    >>> table.heads
    ('name', 'value', 'unit', 'meaning', 'kind', 'source')
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    lines: Sequence[str] = ()

    def __str__(self) -> str:
        cells = [
            [cell if len(cell) <= MAX_CELL_LENGTH else f"{cell[: MAX_CELL_LENGTH - 3]}..." for cell in row]
            for row in (self.heads, *self.rows)
        ]
        return "\n".join([self.title, *self.lines, *align_columns(cells)])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """HTML of the table for a notebook."""
        head = "".join(f"<th>{escape(cell)}</th>" for cell in self.heads)
        body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in self.rows)
        lines = "".join(f"<div>{escape(line)}</div>" for line in self.lines)
        return (
            f"<div><b>{escape(self.title)}</b></div>{lines}"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        )


MAX_ROWS_AT_EACH_END = 5
"""Number of rows that are printed at the start and at the end of long columns [1]."""


class TableDisplay(ABC):
    """Base class of objects that are printed, and shown in a notebook, as a table."""

    @abstractmethod
    def _build_table(self) -> Table: ...

    def __repr__(self) -> str:
        return str(self._build_table())

    def _repr_html_(self) -> str:
        """HTML of the table for a notebook."""
        return self._build_table()._repr_html_()


class Frame(TableDisplay, Mapping[str, Array]):
    """Results of a joint, law or FMU: mapping of names to columns (n) of numbers in SI units.

    units    : {name: unit}
    messages : warnings and errors of the FMU, or warnings of the joint or law, one line each

    >>> import jointfmu
    >>> frame = jointfmu.drive("CSG-25-100").evaluate("HarmonicDriveCompliance", tau=[0.0, 48.0, 96.0])
    >>> frame["phi_rel"].shape, frame.units["phi_rel"]
    ((3,), 'rad')
    """

    def __init__(
        self, values: Mapping[str, ArrayLike], units: Mapping[str, str], messages: tuple[str, ...] = ()
    ) -> None:
        arrays = np.broadcast_arrays(
            *(np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in values.values())
        )
        self._columns = dict(zip(values, arrays, strict=True))
        self.units = {name: units[name] for name in values}
        self.messages = messages

    def __getitem__(self, name: str) -> Array:
        if name not in self._columns:
            raise KeyError(f"{name!r} is not a column, allowed are {', '.join(self._columns)}")
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def _build_table(self) -> Table:
        """Build the printed table of the columns; of many rows, only the first and the last ones."""
        count = max((column.size for column in self._columns.values()), default=0)
        shown = (
            [*range(count)]
            if count <= 2 * MAX_ROWS_AT_EACH_END
            else [*range(MAX_ROWS_AT_EACH_END), *range(count - MAX_ROWS_AT_EACH_END, count)]
        )
        rows = [[f"{column[i] + 0.0:.6g}" for column in self._columns.values()] for i in shown]
        if count > 2 * MAX_ROWS_AT_EACH_END:
            rows.insert(MAX_ROWS_AT_EACH_END, ["..."] * len(self))
        heads = [f"{name} [{self.units[name]}]" for name in self._columns]
        return Table(f"{count} points", heads, rows, self.messages)

    @plots.apply_plot_style()
    def plot(self, x: str | None = None, y: str | None = None) -> "Figure":
        """Draw the column y as a function of the column x, by default the last of the first one.

        Returns a matplotlib figure.

        Raises KeyError for a name that is not a column.
        """
        names = list(self)
        x, y = x or names[0], y or names[-1]
        (x_unit, a), (y_unit, b) = (plots.choose_plot_unit(self.units[name], self[name]) for name in (x, y))
        figure = plots.create_figure((6.4, 4.0))
        axes = figure.subplots()
        axes.plot(a * self[x], b * self[y], color=plots.BLUE)
        axes.set(xlabel=f"{x} [{x_unit}]", ylabel=f"{y} [{y_unit}]")
        return figure

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the columns as CSV with headings `name [unit]`; numbers are written exactly.

        force : replace a file that is not a table of jointfmu

        Raises ValueError if the file may not or cannot be written.
        """
        check_output(path, columns.TABLE_FILE_KIND, force)
        heads = [(name, self.units[name]) for name in self]
        write_text(Path(path), columns.format_table(heads, list(self.values())))
        return Path(path)

    def to_pandas(self) -> Any:
        """Convert the columns to a pandas DataFrame, with the units in `attrs["units"]`. Needs pandas."""
        import pandas  # type: ignore[import-untyped]

        table = pandas.DataFrame(dict(self))
        table.attrs["units"] = dict(self.units)
        return table


def run(
    fmu: str | Path,
    inputs: Mapping[str, ArrayLike],
    *,
    time: ArrayLike | None = None,
    settings: Mapping[str, object] | None = None,
) -> Frame:
    """Run an FMU in co-simulation along points of its inputs; returns every output at every point.

    inputs   : {input: values (n) or one value} [SI]
    time     : (n) [s], increasing from the start; by default one second per point
    settings : {parameter or other input: value} [SI]

    Raises ValueError, one line, for a file that is no FMU, an unknown name, inputs of different lengths, or a
    value that the FMU rejects; RuntimeError if the FMU does not instantiate.

    >>> import jointfmu
    >>> fmu = jointfmu.load("GearContact").build("dist", "fmi2")[0]
    >>> frame = jointfmu.run(fmu, {"f": [0.0, 500.0, 1000.0]})
    >>> bool(frame["K_N"][2] > frame["K_N"][1] > 0.0)
    True
    """
    points = {name: np.atleast_1d(np.asarray(x, dtype=np.float64)) for name, x in inputs.items()}
    clock = None if time is None else np.asarray(time, dtype=np.float64)
    result = ramp.run_paths(fmu, points, clock, settings)
    return Frame(result.variable_columns, result.variable_units, result.log_messages)
