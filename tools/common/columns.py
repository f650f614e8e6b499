"""Tables of numbers in CSV files. Every column must state its unit.

The heading is the first line that is no comment (#): `torque [N.m], angle [arcmin]`. Semicolons, tabs or
commas separate the columns. Numbers have a decimal point; they may have a decimal comma if commas do not
separate the columns. A unit may also be written `Angle (deg)`, `F / N` or `joint_speed_rad_per_s`. Columns
that the caller does not ask for are ignored. Written files have commas as separators and decimal points.
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

from jointfmu.files.outputs import MESH_FILE, FileKind
from jointfmu.files.reading import read_bytes
from jointfmu.quantity import Array
from jointfmu.quantity.units import UnitSizes, unit_size_in

Column: TypeAlias = NDArray[Any]
"""Array of real or whole numbers."""
ColumnHead: TypeAlias = tuple[str, str | None]
"""Name and unit of a column; None if the column states no unit."""

CONTROL_CHARACTER_PATTERN = re.compile(rb"[\x00-\x08\x0e-\x1f]")
"""Control characters: a file that has them is not a text."""
_HEADING_PATTERN = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[\s*(?P<unit>[^\[\]]*?)\s*\])?\s*$")
"""Pattern of the heading of a column, `name [unit]`, with the unit optional."""
_HEADING_WITH_UNIT_PATTERN = re.compile(r"\S.* \[[^\[\]]+\]")
"""Heading of one column as `format_table` writes it: `name [unit]`."""
MAX_HEADING_BYTES = 65536
"""Number of bytes at the start of a file that are searched for its heading [1]."""
_ALTERNATIVE_HEADING_PATTERN = re.compile(
    r"\s*(?P<name>[^()/]*?)\s*(?:\(\s*(?P<one>[^()]+?)\s*\)|/\s*(?P<two>\S+))\s*$"
)
"""Alternative headings of a column: `name (unit)` and `name / unit`."""


@dataclass(frozen=True, slots=True)
class TableColumns:
    """Columns (n) of numbers read from a file, in SI units.

    values_by_name : {name: values (n)}
    line_numbers   : line number of each row in the file
    heading_units  : {name: unit in the heading of the file}
    heading_cells  : all headings of the file
    """

    table_path: Path
    values_by_name: Mapping[str, Array]
    line_numbers: Sequence[int] = ()
    heading_units: Mapping[str, str] = field(default_factory=dict)
    heading_cells: Sequence[str] = ()

    def require_column(self, column_name: str, allowed_units: Mapping[str, UnitSizes]) -> Array:
        """Values (n) of a column in SI units. Raises ValueError if the file does not have the column."""
        if column_name not in self.values_by_name:
            raise ValueError(
                f"{self.table_path}: has no column {column_name!r}; expected "
                f"{format_expected_heading({column_name: allowed_units[column_name]})}; it has "
                f"{', '.join(cell.strip() for cell in self.heading_cells)[:120]}"
            )
        return self.values_by_name[column_name]

    def check_positive_columns(
        self, column_names: Iterable[str], allowed_units: Mapping[str, UnitSizes]
    ) -> "TableColumns":
        """Return the columns; raise ValueError with the line if a number of the named ones is not > 0."""
        for name in column_names:
            if np.any(wrong := self.values_by_name[name] <= 0.0):
                first = int(np.argmax(wrong))
                value = f"{name} = {self.values_by_name[name][first]:g} {next(iter(allowed_units[name]))}"
                raise ValueError(
                    f"{self.table_path}: line {self.line_numbers[first]}: {value} is outside (0, inf)"
                )
        return self


def has_unit_headings(table_path: Path) -> bool:
    """Whether a file has a heading as `format_table` writes it: every column as `name [unit]`."""
    with table_path.open("rb") as file:
        lines = file.read(MAX_HEADING_BYTES).decode("utf-8", "replace").splitlines()
    head = next((line for line in lines if not line.startswith("#")), "")
    return all(_HEADING_WITH_UNIT_PATTERN.fullmatch(cell) for cell in next(csv.reader([head]), [""]))


TABLE_FILE_KIND = FileKind("table", (".csv",), has_unit_headings)
"""CSV files with a unit in every heading."""
PRESSURE_FIELD_FILE_KIND = FileKind(
    "field", (".csv", ".vtu"), lambda path: has_unit_headings(path) or MESH_FILE.is_program_file(path)
)
"""Files of a contact pressure field: CSV or VTU."""


def format_expected_heading(allowed_units: Mapping[str, UnitSizes]) -> str:
    """Format the expected columns with their allowed units, for error messages."""
    return ", ".join(f"{name} [{' | '.join(units)}]" for name, units in allowed_units.items())


def read_columns(
    table_path: str | Path,
    allowed_units: Mapping[str, UnitSizes],
    min_rows: int,
    column_aliases: Mapping[str, Sequence[str]] | None = None,
    stated_headings: Mapping[str, ColumnHead] | None = None,
) -> TableColumns:
    """Read from a CSV file the columns of `allowed_units` that the file has, in SI units.

    allowed_units   : {name: {allowed unit: its size in SI}}
    min_rows        : rows that the file must have at least
    column_aliases  : {column: other names in lower case}; the unit decides between several names
    stated_headings : {column: (heading in this file, unit)}; unit None: the unit of the heading

    Raises ValueError, one line with file, line and column: no file, no text, no heading, a column that has
    no unit or a wrong unit or stands twice, a row of another length, a value that is not a finite number, or
    fewer than `min_rows` rows.
    """
    table_path = Path(table_path)
    lines = read_numbered_lines(table_path)
    if not lines:
        raise ValueError(f"{table_path}: is empty; expected columns {format_expected_heading(allowed_units)}")
    mark = find_column_separator(lines[0][1])
    head = split_table_line(lines[0][1], mark)
    head = _apply_stated_headings(table_path, head, stated_headings or {})
    places = _find_columns(table_path, head, allowed_units, column_aliases or {})
    if len(lines) - 1 < min_rows:
        raise ValueError(
            f"{table_path}: has {len(lines) - 1} rows of numbers, at least {min_rows} are needed"
        )
    numbers = [number for number, _ in lines[1:]]
    rows = _split_rows([line for _, line in lines[1:]], mark)
    if any(len(row) != len(head) for row in rows):
        for number, row in zip(numbers, rows, strict=True):
            check_cell_count(table_path, number, row, len(head), mark)
    columns = {
        name: _parse_column(table_path, name, numbers, [row[place] for row in rows]) * size
        for name, (place, size, _) in places.items()
    }
    units = {name: unit for name, (_, _, unit) in places.items()}
    return TableColumns(table_path, columns, numbers, units, head)


def read_column_names(table_path: str | Path) -> list[str]:
    """Read the names of a file's columns in lower case; an empty list if the file is empty.

    Raises ValueError if the file cannot be read or is not a text.
    """
    lines = read_numbered_lines(Path(table_path), 1)
    if not lines:
        return []
    return [
        parse_heading(cell)[0].lower()
        for cell in split_table_line(lines[0][1], find_column_separator(lines[0][1]))
    ]


def parse_heading(heading_cell: str) -> ColumnHead:
    """Parse the heading of one column into name and unit: `angle [deg]`, `Angle (deg)` or `angle / deg`."""
    if match := _HEADING_PATTERN.match(heading_cell):
        if match["unit"] is None and (other := _ALTERNATIVE_HEADING_PATTERN.match(heading_cell)):
            return other["name"], other["one"] or other["two"]
        return match["name"], match["unit"]
    return heading_cell.strip(), None


def parse_stated_headings(heading_texts: Sequence[str], column_names: Iterable[str]) -> dict[str, ColumnHead]:
    """Parse texts `NAME=HEADING` or `NAME=HEADING [UNIT]` by which the user assigns headings to columns.

    Returns {column: (heading in the file, unit or None)}.

    Raises ValueError for other text and unknown columns.
    """
    known, found = [*column_names], {}
    for word in heading_texts:
        name, _, text = word.partition("=")
        if name not in known or not text.strip():
            raise ValueError(
                f"--columns {word!r}: expected NAME=HEADING, with a heading of the file and a NAME of "
                f"{', '.join(known)}"
            )
        found[name] = parse_heading(text)
    return found


def read_numbered_lines(table_path: Path, max_lines: int | None = None) -> list[tuple[int, str]]:
    """Read (line number, text) of a file's lines, without comments and empty lines.

    max_lines : number of lines to return; None: all

    Raises ValueError if the file cannot be read or is not a text.
    """
    lines = enumerate(read_text_lines(table_path), 1)
    rows = ((i, line) for i, line in lines if line.strip() and not line.lstrip().startswith("#"))
    return list(islice(rows, max_lines))


def read_text_lines(table_path: Path) -> list[str]:
    """Read all lines of a file. Raises ValueError, one line, if the file cannot be read or is not a text."""
    try:
        return decode_text(read_bytes(table_path, "a CSV file")).splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{table_path}: is not a text file; expected CSV (UTF-8)") from None


def decode_text(file_bytes: bytes) -> str:
    """Decode the bytes of a text file from UTF-8, else from Latin-1.

    Raises UnicodeDecodeError if Latin-1 text has control characters.
    """
    try:
        return file_bytes.decode("utf-8-sig")
    except UnicodeDecodeError:
        if CONTROL_CHARACTER_PATTERN.search(file_bytes):
            raise
        return file_bytes.decode("latin-1")


def find_column_separator(table_line: str) -> str | None:
    """Find the separator of a line: semicolon, else tab, else comma; None if the line has none of them."""
    return next((mark for mark in ";\t," if mark in table_line), None)


def split_table_line(table_line: str, delimiter: str | None) -> list[str]:
    """Split a line of a table into cells; without a separator the line is one cell (blanks are kept)."""
    return next(csv.reader([table_line], delimiter=delimiter or ","))


def _split_rows(table_lines: Sequence[str], delimiter: str | None) -> list[list[str]]:
    """Split the lines of a table into cells. Lines without quotes are split faster."""
    if delimiter is None or any('"' in line for line in table_lines):
        return [split_table_line(line, delimiter) for line in table_lines]
    return [line.split(delimiter) for line in table_lines]


def check_cell_count(
    table_path: Path,
    line_number: int,
    row_cells: Sequence[str],
    expected_count: int,
    delimiter: str | None = None,
) -> None:
    """Raise ValueError with the line number if a row of a table does not have `expected_count` cells.

    delimiter : separator of the cells
    """
    if len(row_cells) != expected_count:
        raise ValueError(
            f"{table_path}: line {line_number} has {len(row_cells)} columns, expected {expected_count}"
            + (
                "; commas separate the columns, so numbers need a decimal point"
                if len(row_cells) > expected_count and delimiter == ","
                else ""
            )
        )


def parse_number(number_cell: str) -> float | None:
    """Parse a cell of a table as a number with decimal point or comma; None if the cell is no number."""
    try:
        return float(number_cell if "." in number_cell else number_cell.replace(",", ".", 1))
    except ValueError:
        return None


def _apply_stated_headings(
    table_path: Path, heading_cells: Sequence[str], stated_headings: Mapping[str, ColumnHead]
) -> list[str]:
    """Replace the headings of columns for which the caller states name and unit.

    Raises ValueError if the file does not have a stated heading.
    """
    indices = {parse_heading(cell)[0].lower(): index for index, cell in enumerate(heading_cells)}
    headings = list(heading_cells)
    for name, (heading_in_file, unit) in stated_headings.items():
        if heading_in_file.lower() not in indices:
            raise ValueError(
                f"{table_path}: has no column {heading_in_file!r} for {name}; it has {', '.join(indices)}"
            )
        index = indices[heading_in_file.lower()]
        unit = unit or parse_heading(heading_cells[index])[1]
        headings[index] = name if unit is None else f"{name} [{unit}]"
    return headings


def _find_columns(
    table_path: Path,
    heading_cells: Sequence[str],
    allowed_units: Mapping[str, UnitSizes],
    column_aliases: Mapping[str, Sequence[str]],
) -> dict[str, tuple[int, float, str]]:
    """Find the columns of `allowed_units` in a heading: {name: (index, size of its unit in SI, unit)}.

    Raises ValueError for a column that stands twice, has no unit or a wrong unit, or if there is no column.
    """
    places: dict[str, tuple[int, float, str]] = {}
    named = {parse_heading(cell)[0].lower() for cell in heading_cells}
    column_aliases = {name: words for name, words in column_aliases.items() if name not in named}
    for place, cell in enumerate(heading_cells):
        name, unit = _identify_column(cell, allowed_units, column_aliases)
        if name not in allowed_units:
            continue
        allowed = ", ".join(allowed_units[name])
        if name in places:
            raise ValueError(f"{table_path}: column {name!r} is given twice; state it once")
        if unit is None:
            raise ValueError(
                f"{table_path}: column {name!r} has no unit, expected e.g. {name} "
                f"[{next(iter(allowed_units[name]))}]"
            )
        try:
            places[name] = place, unit_size_in(unit, allowed_units[name]), unit
        except ValueError:
            raise ValueError(
                f"{table_path}: column {name!r} has unit {unit!r}, allowed are {allowed} or another unit "
                "of the same quantity; convert the column"
            ) from None
    if not places:
        shown = ", ".join(cell.strip() for cell in heading_cells)[:80]
        raise ValueError(
            f"{table_path}: the first line is {shown!r}; expected columns "
            f"{format_expected_heading(allowed_units)}"
        )
    return places


def _identify_column(
    heading_cell: str, allowed_units: Mapping[str, UnitSizes], column_aliases: Mapping[str, Sequence[str]]
) -> ColumnHead:
    """Name of the column and unit that a heading means.

    The unit may be the end of the name: `joint_speed_rad_per_s`.
    """
    name, unit = parse_heading(heading_cell)
    found = (
        name.lower()
        if name.lower() in allowed_units
        else _resolve_alias(name.lower(), unit, allowed_units, column_aliases)
    )
    if found in allowed_units or unit is not None:
        return found, unit
    for mark in re.finditer("_", name):
        word, end = name[: mark.start()].lower(), name[mark.end() :].replace("_per_", "/")
        meant = word if word in allowed_units else _resolve_alias(word, end, allowed_units, column_aliases)
        with suppress(ValueError, KeyError):
            unit_size_in(end, allowed_units[meant])
            return meant, end
    return found, unit


def _resolve_alias(
    heading_name: str,
    heading_unit: str | None,
    allowed_units: Mapping[str, UnitSizes],
    column_aliases: Mapping[str, Sequence[str]],
) -> str:
    """Find the column that a heading means: the column that has the name as an alias and allows the unit.

    If there is none: the name itself.
    """
    for name, words in column_aliases.items():
        if heading_name in words and name in allowed_units and heading_unit is not None:
            with suppress(ValueError):
                unit_size_in(heading_unit, allowed_units[name])
                return name
    return heading_name


def _parse_column(
    table_path: Path, column_name: str, line_numbers: Sequence[int], column_cells: Sequence[str]
) -> Array:
    """Parse the cells of one column as numbers. Raises ValueError with the line of a wrong cell."""
    try:
        values = np.array([float(cell) for cell in column_cells])
    except ValueError:  # decimal commas, or cells that are no numbers
        values = np.array(
            [np.nan if (value := parse_number(cell)) is None else value for cell in column_cells]
        )
    if np.any(wrong := ~np.isfinite(values)):
        first = int(np.argmax(wrong))
        raise ValueError(
            f"{table_path}: line {line_numbers[first]}: {column_name} = {column_cells[first].strip()!r} is "
            "not a finite number with a decimal point"
        )
    return values


def format_table(
    column_headings: Sequence[ColumnHead],
    column_values: Sequence[Column],
    significant_digits: int | None = None,
    header_lines: Sequence[str] = (),
) -> str:
    """Format columns (n) as CSV text: heading `name [unit]`, one line per row.

    significant_digits : significant digits of real numbers; None: as many as restore the number exactly
    header_lines       : lines before the heading
    """
    first = io.StringIO()
    names = [name if unit is None else f"{name} [{unit}]" for name, unit in column_headings]
    csv.writer(first, lineterminator="").writerow(names)
    return "\n".join(
        [
            *header_lines,
            first.getvalue(),
            *format_rows(column_values, [significant_digits] * len(column_headings)),
            "",
        ]
    )


def format_rows(
    column_values: Iterable[Column], significant_digits: Sequence[int | None], delimiter: str = ","
) -> list[str]:
    """Format columns (n) as lines of text, each column with its own digits.

    Rounded numbers have no negative zero.
    """
    formats, values = [], []
    for column, count in zip(column_values, significant_digits, strict=True):
        exact = count is None or column.dtype.kind != "f"
        formats.append("%r" if exact else f"%.{count}g")
        values.append((column if exact else column + 0.0).tolist())
    pattern = delimiter.join(formats)
    return [pattern % row for row in zip(*values, strict=True)]
