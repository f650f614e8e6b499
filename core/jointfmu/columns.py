"""Measured columns from CSV: every column states its unit, nothing is guessed.

The first line that is no comment (#) names the columns, `torque [N.m], angle [arcmin]`. Columns are
separated by comma, semicolon or tab; numbers have a decimal point. Columns that are not asked for
are passed over.
"""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Units = Mapping[str, float]
"""{unit: its size in the SI unit}, the SI unit first."""

_HEADING = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[\s*(?P<unit>[^\[\]]*?)\s*\])?\s*$")


@dataclass(frozen=True, slots=True)
class Table:
    """Columns of a file in SI units, in the order of its rows, which are on the named lines."""

    path: Path
    columns: Mapping[str, Array]
    lines: Sequence[int] = ()

    def require(self, name: str, spec: Mapping[str, Units]) -> Array:
        """A column; ValueError if the file has none."""
        if name not in self.columns:
            raise ValueError(f"{self.path}: has no column {name!r}; expected {heading({name: spec[name]})}")
        return self.columns[name]


def heading(spec: Mapping[str, Units]) -> str:
    """The columns with their units as text."""
    return ", ".join(f"{name} [{' | '.join(units)}]" for name, units in spec.items())


def read(path: str | Path, spec: Mapping[str, Units], least: int) -> Table:
    """Read the columns named in `spec` that a file has.

    Raises ValueError, one line with file, line and column: no file, no text, no heading, a column
    without or with a foreign unit or given twice, a row of another length, a value that is no finite
    number, fewer than `least` rows.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror}); expected a CSV file") from None
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text file; expected CSV (UTF-8)") from None
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    if not lines:
        raise ValueError(f"{path}: is empty; expected columns {heading(spec)}")
    separator = max(",;\t", key=lines[0][1].count)
    rows = list(csv.reader((line for _, line in lines), delimiter=separator))
    places = _headings(path, rows[0], spec)
    if len(rows) - 1 < least:
        raise ValueError(f"{path}: has {len(rows) - 1} points, at least {least} are needed")
    numbers = [i for i, _ in lines[1:]]
    columns = {name: _column(path, name, place, rows, numbers) for name, (place, _) in places.items()}
    return Table(path, {name: columns[name] * size for name, (_, size) in places.items()}, numbers)


def _headings(path: Path, cells: Sequence[str], spec: Mapping[str, Units]) -> dict[str, tuple[int, float]]:
    """{name: (place, size of its unit)} of the columns asked for."""
    found: dict[str, tuple[int, float]] = {}
    for place, cell in enumerate(cells):
        match = _HEADING.match(cell)
        name = match["name"].lower() if match else ""
        if not match or name not in spec:
            continue
        allowed = ", ".join(spec[name])
        if name in found:
            raise ValueError(f"{path}: column {name!r} is given twice, allowed is once")
        if match["unit"] is None:
            raise ValueError(
                f"{path}: column {name!r} has no unit, expected e.g. {name} [{next(iter(spec[name]))}]"
            )
        if match["unit"] not in spec[name]:
            raise ValueError(f"{path}: column {name!r} has unit {match['unit']!r}, allowed are {allowed}")
        found[name] = place, spec[name][match["unit"]]
    if not found:
        shown = ", ".join(cell.strip() for cell in cells)[:80]
        raise ValueError(f"{path}: the first line is {shown!r}; expected columns {heading(spec)}")
    return found


def _column(path: Path, name: str, place: int, rows: list[list[str]], numbers: Sequence[int]) -> Array:
    values = np.empty(len(numbers))
    for i, (number, row) in enumerate(zip(numbers, rows[1:], strict=True)):
        if len(row) != len(rows[0]):
            raise ValueError(f"{path}: line {number} has {len(row)} columns, expected {len(rows[0])}")
        try:
            values[i] = float(row[place])
        except ValueError:
            values[i] = np.nan
        if not np.isfinite(values[i]):
            cell = row[place].strip()
            raise ValueError(
                f"{path}: line {number}: {name} = {cell!r} is no finite number with a decimal point"
            )
    return values
