"""Columns of numbers with their units: what evaluating a joint and running an FMU give."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from jointfmu.files.writing import write_text

from .. import columns, plots
from .table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
ENDS = 5
"""Rows at the begin and at the end that are printed."""


class Frame(Mapping[str, Array]):
    """Columns (n) of numbers in SI units by name.

    units    : {name: unit}
    messages : what an FMU logged, one line each

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
            raise KeyError(f"{name!r} is no column, allowed are {', '.join(self._columns)}")
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def _table(self) -> Table:
        count = next(iter(self._columns.values())).size
        shown = [*range(count)] if count <= 2 * ENDS else [*range(ENDS), *range(count - ENDS, count)]
        rows = [[f"{column[i] + 0.0:.6g}" for column in self._columns.values()] for i in shown]
        if count > 2 * ENDS:
            rows.insert(ENDS, ["..."] * len(self))
        heads = [f"{name} [{self.units[name]}]" for name in self._columns]
        return Table(f"{count} points", heads, rows, self.messages)

    def __repr__(self) -> str:
        return str(self._table())

    def _repr_html_(self) -> str:
        """The table for a notebook."""
        return self._table()._repr_html_()

    @plots.style()
    def plot(self, x: str | None = None, y: str | None = None) -> "Figure":
        """Draw one column over another, by default the last over the first; a matplotlib figure.

        Raises KeyError for a name that is no column.
        """
        names = list(self)
        x, y = x or names[0], y or names[-1]
        (x_unit, a), (y_unit, b) = (plots.shown(self.units[name], self[name]) for name in (x, y))
        figure = plots.figure((6.4, 4.0))
        axes = figure.subplots()
        axes.plot(a * self[x], b * self[y], color=plots.BLUE)
        axes.set(xlabel=f"{x} [{x_unit}]", ylabel=f"{y} [{y_unit}]")
        return figure

    def save(self, path: str | Path) -> Path:
        """Write the columns as CSV with a header `name [unit]`, numbers exact."""
        heads = [(name, self.units[name]) for name in self]
        write_text(Path(path), columns.text(heads, list(self.values())))
        return Path(path)

    def to_pandas(self) -> Any:
        """The same as a pandas DataFrame, units in its `attrs`. Needs pandas."""
        import pandas  # type: ignore[import-untyped]

        table = pandas.DataFrame(dict(self))
        table.attrs["units"] = dict(self.units)
        return table
