"""Columns of numbers in CSV: every column states its unit, nothing is guessed.

The first line that is no comment (#) names the columns, `torque [N.m], angle [arcmin]`. Columns are
separated by semicolon, tab or comma; numbers have a decimal point or, where the comma divides no
columns, a comma. A unit may also be written `Angle (deg)`, `F / N` or `speed_rad_per_s`. Columns that are
not asked for are passed over. What is written has commas and points.
"""

import csv
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.outputs import MESH, FileKind
from jointfmu.files.reading import read_bytes
from jointfmu.quantity import Array
from jointfmu.quantity.units import Sizes, measured

Column: TypeAlias = NDArray[Any]
"""Real or whole numbers."""
Head: TypeAlias = tuple[str, str | None]
"""Name and unit of a column; None: it states none."""

CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f]")
"""What no text has."""
_HEADING = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[\s*(?P<unit>[^\[\]]*?)\s*\])?\s*$")
_WRITTEN = re.compile(r"\S.* \[[^\[\]]+\]")
"""The heading of a column as `text` writes it."""
HEAD = 65536
"""Bytes of a file in which its heading is looked for."""
_OTHERWISE = re.compile(r"\s*(?P<name>[^()/]*?)\s*(?:\(\s*(?P<one>[^()]+?)\s*\)|/\s*(?P<two>\S+))\s*$")
"""`name (unit)` and `name / unit`."""


@dataclass(frozen=True, slots=True)
class Columns:
    """Columns of a file in SI units, in the order of its rows, which are on the named lines.

    units : {name: unit in the heading}
    """

    path: Path
    columns: Mapping[str, Array]
    lines: Sequence[int] = ()
    units: Mapping[str, str] = field(default_factory=dict)

    def require(self, name: str, spec: Mapping[str, Sizes]) -> Array:
        """A column; ValueError if the file has none."""
        if name not in self.columns:
            raise ValueError(f"{self.path}: has no column {name!r}; expected {heading({name: spec[name]})}")
        return self.columns[name]

    def positive(self, names: Iterable[str], spec: Mapping[str, Sizes]) -> "Columns":
        """The same; ValueError, naming the line, if one of these columns has a number that is not above 0."""
        for name in names:
            if np.any(wrong := self.columns[name] <= 0.0):
                first = int(np.argmax(wrong))
                value = f"{name} = {self.columns[name][first]:g} {next(iter(spec[name]))}"
                raise ValueError(f"{self.path}: line {self.lines[first]}: {value} is outside (0, inf)")
        return self


def is_table(path: Path) -> bool:
    """Whether a file has the heading of a table that `text` writes: every column as `name [unit]`."""
    with path.open("rb") as file:
        lines = file.read(HEAD).decode("utf-8", "replace").splitlines()
    head = next((line for line in lines if not line.startswith("#")), "")
    return all(_WRITTEN.fullmatch(cell) for cell in next(csv.reader([head]), [""]))


TABLE = FileKind("table", (".csv",), is_table)
FIELD = FileKind("field", (".csv", ".vtu"), lambda path: is_table(path) or MESH.is_own(path))


def heading(spec: Mapping[str, Sizes]) -> str:
    """The columns with their units as text."""
    return ", ".join(f"{name} [{' | '.join(units)}]" for name, units in spec.items())


def read(
    path: str | Path,
    spec: Mapping[str, Sizes],
    least: int,
    others: Mapping[str, Sequence[str]] | None = None,
    stated: Mapping[str, Head] | None = None,
) -> Columns:
    """Read the columns named in `spec` that a file has.

    others : {name in `spec`: other names in lower case}; the unit tells which of several is meant
    stated : {name in `spec`: the heading that it has in this file, and its unit, or None for the heading's}

    Raises ValueError, one line with file, line and column: no file, no text, no heading, a column
    without or with a foreign unit or given twice, a row of another length, a value that is no finite
    number, fewer than `least` rows.
    """
    path = Path(path)
    lines = content(path)
    if not lines:
        raise ValueError(f"{path}: is empty; expected columns {heading(spec)}")
    mark = separator(lines[0][1])
    head = cells(lines[0][1], mark)
    head = _renamed(path, head, stated or {})
    places = _places(path, head, spec, others or {})
    if len(lines) - 1 < least:
        raise ValueError(f"{path}: has {len(lines) - 1} points, at least {least} are needed")
    numbers = [number for number, _ in lines[1:]]
    rows = [cells(line, mark) for _, line in lines[1:]]
    for line, row in zip(numbers, rows, strict=True):
        check_length(path, line, row, len(head))
    columns = {
        name: _column(path, name, numbers, [row[place] for row in rows]) * size
        for name, (place, size, _) in places.items()
    }
    return Columns(path, columns, numbers, {name: unit for name, (_, _, unit) in places.items()})


def names(path: str | Path) -> list[str]:
    """Names of a file's columns, in lower case; none if it is empty. Raises ValueError as `read`."""
    lines = content(Path(path), 1)
    if not lines:
        return []
    return [head(cell)[0].lower() for cell in cells(lines[0][1], separator(lines[0][1]))]


def head(cell: str) -> Head:
    """Name and unit of a heading: `angle [deg]`, `Angle (deg)` or `angle / deg`."""
    if match := _HEADING.match(cell):
        if match["unit"] is None and (other := _OTHERWISE.match(cell)):
            return other["name"], other["one"] or other["two"]
        return match["name"], match["unit"]
    return cell.strip(), None


def content(path: Path, most: int | None = None) -> list[tuple[int, str]]:
    """Numbers and texts of a file's lines (the first `most`), without comments and empty ones.

    Raises ValueError as `text_lines`.
    """
    lines = enumerate(text_lines(path), 1)
    told = ((i, line) for i, line in lines if line.strip() and not line.lstrip().startswith("#"))
    return list(islice(told, most))


def text_lines(path: Path) -> list[str]:
    """All lines of a file. Raises ValueError, one line, if the file cannot be read or is no text."""
    try:
        return decoded(read_bytes(path, "a CSV file")).splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text file; expected CSV (UTF-8)") from None


def decoded(raw: bytes) -> str:
    """Text in UTF-8, or else in Latin-1. Raises UnicodeDecodeError if that has control characters."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        if CONTROL.search(raw):
            raise
        return raw.decode("latin-1")


def separator(line: str) -> str | None:
    """What separates the columns of a line: semicolon or tab if it has any, else comma; None: nothing."""
    return next((mark for mark in ";\t," if mark in line), None)


def cells(line: str, mark: str | None) -> list[str]:
    """The cells of a line; without a separator blanks divide nothing."""
    return next(csv.reader([line], delimiter=mark or ","))


def check_length(path: Path, line: int, row: Sequence[str], count: int) -> None:
    """Raise ValueError naming the line if it has not as many columns as it should."""
    if len(row) != count:
        raise ValueError(f"{path}: line {line} has {len(row)} columns, expected {count}")


def number(cell: str) -> float | None:
    """A cell as a number with a decimal point or comma; None if it is none."""
    try:
        return float(cell if "." in cell else cell.replace(",", ".", 1))
    except ValueError:
        return None


def _renamed(path: Path, cells: Sequence[str], stated: Mapping[str, Head]) -> list[str]:
    """The cells of a heading with the names and units that are stated of them."""
    known = {head(cell)[0].lower(): place for place, cell in enumerate(cells)}
    found = list(cells)
    for name, (wanted, unit) in stated.items():
        if wanted.lower() not in known:
            raise ValueError(f"{path}: has no column {wanted!r} for {name}; it has {', '.join(known)}")
        place = known[wanted.lower()]
        unit = unit or head(cells[place])[1]
        found[place] = name if unit is None else f"{name} [{unit}]"
    return found


def _places(
    path: Path, cells: Sequence[str], spec: Mapping[str, Sizes], others: Mapping[str, Sequence[str]]
) -> dict[str, tuple[int, float, str]]:
    """{name: (place, size of its unit, the unit)} of the columns asked for."""
    places: dict[str, tuple[int, float, str]] = {}
    named = {head(cell)[0].lower() for cell in cells}
    others = {name: words for name, words in others.items() if name not in named}
    for place, cell in enumerate(cells):
        name, unit = _called(cell, spec, others)
        if name not in spec:
            continue
        allowed = ", ".join(spec[name])
        if name in places:
            raise ValueError(f"{path}: column {name!r} is given twice, allowed is once")
        if unit is None:
            raise ValueError(
                f"{path}: column {name!r} has no unit, expected e.g. {name} [{next(iter(spec[name]))}]"
            )
        try:
            places[name] = place, measured(unit, spec[name]), unit
        except ValueError:
            raise ValueError(
                f"{path}: column {name!r} has unit {unit!r}, allowed are {allowed} and others that "
                "measure the same"
            ) from None
    if not places:
        shown = ", ".join(cell.strip() for cell in cells)[:80]
        raise ValueError(f"{path}: the first line is {shown!r}; expected columns {heading(spec)}")
    return places


def _called(cell: str, spec: Mapping[str, Sizes], others: Mapping[str, Sequence[str]]) -> Head:
    """Column and unit that a heading means; the unit may be the end of its name, `joint_speed_rad_per_s`."""
    name, unit = head(cell)
    found = name.lower() if name.lower() in spec else _meant(name.lower(), unit, spec, others)
    if found in spec or unit is not None:
        return found, unit
    for mark in re.finditer("_", name):
        word, end = name[: mark.start()].lower(), name[mark.end() :].replace("_per_", "/")
        meant = word if word in spec else _meant(word, end, spec, others)
        with suppress(ValueError, KeyError):
            measured(end, spec[meant])
            return meant, end
    return found, unit


def _meant(
    word: str, unit: str | None, spec: Mapping[str, Sizes], others: Mapping[str, Sequence[str]]
) -> str:
    """The column that has another name, by its unit; else the name itself."""
    for name, words in others.items():
        if word in words and name in spec and unit is not None:
            with suppress(ValueError):
                measured(unit, spec[name])
                return name
    return word


def _column(path: Path, name: str, numbers: Sequence[int], column: Sequence[str]) -> Array:
    values = np.array([np.nan if (value := number(cell)) is None else value for cell in column])
    if np.any(wrong := ~np.isfinite(values)):
        first = int(np.argmax(wrong))
        raise ValueError(
            f"{path}: line {numbers[first]}: {name} = {column[first].strip()!r} is no finite number with a "
            "decimal point"
        )
    return values


def text(
    heads: Sequence[Head], columns: Sequence[Column], digits: int | None = None, above: Sequence[str] = ()
) -> str:
    """Columns (n) as the text of a file: heading `name [unit]`, one line per row.

    digits : of real numbers; None: as many as give the number back to the last bit
    above  : lines before the heading
    """
    first = io.StringIO()
    names = [name if unit is None else f"{name} [{unit}]" for name, unit in heads]
    csv.writer(first, lineterminator="").writerow(names)
    return "\n".join([*above, first.getvalue(), *rows(columns, [digits] * len(heads)), ""])


def rows(columns: Iterable[Column], digits: Sequence[int | None], between: str = ",") -> list[str]:
    """The lines of `text`, each column with its own digits; rounded numbers have no negative zero."""
    formats, values = [], []
    for column, count in zip(columns, digits, strict=True):
        exact = count is None or column.dtype.kind != "f"
        formats.append("%r" if exact else f"%.{count}g")
        values.append((column if exact else column + 0.0).tolist())
    pattern = between.join(formats)
    return [pattern % row for row in zip(*values, strict=True)]
