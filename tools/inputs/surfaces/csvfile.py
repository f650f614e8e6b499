"""Read and write the CSV formats of this package for profiles and areal maps (docs/surfaces_reference.md).

The first line declares the layout:

# profile: x [um], z [um]          two columns, constant spacing
# points: x [um], y [um], z [nm]   three columns on a regular grid; points may be missing
# grid: dx = 0.5 um, dy = 0.5 um, z [um]   one line of z for each y
"""

import contextlib
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from jointfmu.files.outputs import PROGRAM_MARK, FileKind
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal
from jointfmu.quantity.units import unit_size_in, unit_sizes

from ...common.columns import (
    ColumnHead,
    check_cell_count,
    decode_text,
    find_column_separator,
    format_rows,
    parse_heading,
    parse_number,
    read_numbered_lines,
    read_text_lines,
    split_table_line,
)
from . import heights as grid
from .heights import ArealMap, Profile, ScanHeights

SURFACE_FILE_KIND = FileKind("surface", (".csv",))
"""CSV files with heights of a surface."""
LENGTH_UNITS = unit_sizes("m", "mm", "um", "µm", "μm", "nm")
"""Allowed length units: {unit: size in metres}."""
LAYOUT_COLUMNS = {"profile": ("x", "z"), "points": ("x", "y", "z"), "grid": ("z",)}
"""{layout of a file: names of its columns}."""
_DECLARATION_PATTERN = re.compile(r"#\s*(profile|points|grid)\s*:(.*)")
"""Pattern of the first line, which declares the layout."""
LENGTH_UNIT_LIST = ", ".join(filter(str.isascii, LENGTH_UNITS))
"""List of the allowed length units, for messages."""


def parse_length_unit(unit_name: str, file_location: str) -> float:
    """Size of a length unit in metres; ValueError, with the location in the file, for an unknown unit."""
    try:
        return unit_size_in(unit_name, LENGTH_UNITS)
    except ValueError:
        raise ValueError(f"{file_location}: unit {unit_name!r} is not one of {LENGTH_UNIT_LIST}") from None


def read_layout_declaration(scan_path: Path) -> str | None:
    """First line of a file if it declares one of the layouts of this package; None for any other file."""
    with scan_path.open("rb") as file, contextlib.suppress(UnicodeDecodeError):
        first = decode_text(file.readline(1000)).strip()
        return first if _DECLARATION_PATTERN.match(first) else None
    return None


def read_declared_file(
    scan_path: Path, declaration_line: str, mark_missing: Callable[[Array], Array] = np.asarray
) -> tuple[ScanHeights, str]:
    """Read a file whose first line declares its layout; return the heights and the unit along x.

    mark_missing : replaces the heights of missing points by NaN
    """
    match = _DECLARATION_PATTERN.match(declaration_line)
    assert match
    layout, declaration = match[1], match[2]
    units = dict(re.findall(r"\b([xyz])\s*\[\s*([^\]\s]+)\s*\]", declaration))
    needed = LAYOUT_COLUMNS[layout]
    if missing := [name for name in needed if name not in units]:
        expected = ", ".join(f"{name} [um]" for name in missing)
        raise ValueError(
            f"{scan_path}: the header has no unit for {', '.join(missing)}; write it as {expected}"
        )
    factors = {name: parse_length_unit(units[name], f"{scan_path}: {name}") for name in needed}
    if layout == "grid":
        spacings = {name: _parse_declared_spacing(scan_path, declaration, name) for name in ("dx", "dy")}
        dx, dy = (size for size, _ in spacings.values())
        unit_x = spacings["dx"][1]
        return ArealMap(
            z=mark_missing(read_number_table(scan_path)) * factors["z"],
            dx=dx,
            dy=dy,
            scan_name=str(scan_path),
        ), unit_x
    table = _mark_missing_points(read_number_table(scan_path), mark_missing)
    return heights_from_columns(scan_path, table, [factors[name] for name in needed]), units["x"]


def _mark_missing_points(point_columns: Array, mark_missing: Callable[[Array], Array]) -> Array:
    """Columns (n, 2 or 3) of positions and heights, with NaN as height at the missing points."""
    return np.column_stack([point_columns[:, :-1], mark_missing(point_columns[:, -1])])


def read_column_titles(scan_path: Path) -> list[ColumnHead] | None:
    """Read names and units of two or three columns (x, z or x, y, z) from the title line of a file.

    None if the first line has no names, or the next line no numbers.
    """
    try:
        lines = read_numbered_lines(scan_path, 2)
    except ValueError:
        if scan_path.suffix.lower() == ".csv":
            raise
        return None  # no text: a file of an instrument
    delimiter = find_column_separator(lines[0][1]) if len(lines) == 2 else None
    if delimiter is None:
        return None
    words, values = (split_table_line(line, delimiter) for _, line in lines)
    has_names = len(words) in (2, 3) and all(parse_number(word) is None and word.strip() for word in words)
    has_numbers = len(values) == len(words) and all(parse_number(cell) is not None for cell in values)
    return [parse_heading(word) for word in words] if has_names and has_numbers else None


def read_titled_file(
    scan_path: Path,
    column_names_and_units: Sequence[ColumnHead],
    option_units: Mapping[str, str | None],
    header_lines: int = 1,
    mark_missing: Callable[[Array], Array] = np.asarray,
) -> tuple[ScanHeights, str]:
    """Read columns below title lines; return the heights and the unit along x.

    column_names_and_units : name and unit of each column, as the file states them
    option_units           : {"x": unit, "z": unit} of columns without a unit in the file; y has the unit of x
    header_lines           : number of title lines
    mark_missing           : replaces the heights of missing points by NaN

    Raises ValueError for a column whose unit is missing, or given both in the file and as option.
    """
    units = []
    for axis, (name, file_unit) in zip(
        LAYOUT_COLUMNS["profile" if len(column_names_and_units) == 2 else "points"],
        column_names_and_units,
        strict=True,
    ):
        option = option_units["z" if axis == "z" else "x"]
        if file_unit and option:
            raise InputRefusal(
                f"{scan_path}: column {name!r} states its unit {file_unit}; leave out the unit {option}",
                "unit",
            )
        if not file_unit and not option:
            raise InputRefusal(
                f"{scan_path}: column {name!r} states no length unit; state it, one of {LENGTH_UNIT_LIST}",
                "unit",
            )
        units.append(str(file_unit or option))
    factors = [
        parse_length_unit(text, f"{scan_path}: {name}")
        for text, (name, _) in zip(units, column_names_and_units, strict=True)
    ]
    table = _mark_missing_points(read_number_table(scan_path, header_lines), mark_missing)
    return heights_from_columns(scan_path, table, factors), units[0]


def _parse_declared_spacing(scan_path: Path, spacing_text: str, spacing_name: str) -> tuple[float, str]:
    """Parse a grid spacing in the declaration of a layout: its value [m], and its unit in the file."""
    match = re.search(rf"\b{spacing_name}\s*=\s*([-+\d.]+(?:[eE][-+]?\d+)?)\s*([a-zµμ]*)", spacing_text)
    if not match:
        raise ValueError(
            f"{scan_path}: the header states no {spacing_name}; write it as {spacing_name} = 0.5 um"
        )
    try:
        return float(match[1]) * parse_length_unit(match[2], f"{scan_path}: {spacing_name}"), match[2]
    except ValueError as error:
        if "unit" in str(error):
            raise
        raise ValueError(
            f"{scan_path}: {spacing_name} = {match[1]!r} is not a number; write it as {spacing_name} = 0.5 um"
        ) from None


def read_number_table(scan_path: Path, header_lines: int = 0) -> Array:
    """Read the numbers of a text file below its header lines; empty cells are NaN.

    The delimiter is a semicolon, tab, comma or blank; # begins a comment.
    """
    top = read_numbered_lines(scan_path, header_lines + 1)
    if len(top) <= header_lines:
        raise ValueError(f"{scan_path}: is not a surface scan: it holds no numbers")
    first, line = top[header_lines]
    delimiter = find_column_separator(line.partition("#")[0])
    with contextlib.suppress(ValueError):  # empty cells, rows of other lengths, words: row by row below
        return np.loadtxt(read_text_lines(scan_path)[first - 1 :], delimiter=delimiter, ndmin=2)
    values: list[Array] = []
    for i, line in ((i, line.partition("#")[0]) for i, line in read_numbered_lines(scan_path)[header_lines:]):
        row = split_table_line(line, delimiter) if delimiter else line.split()
        check_cell_count(scan_path, i, row, values[0].size if values else len(row), delimiter)
        values.append(_parse_numbers(scan_path, i, row))
    return np.array(values)


def _parse_numbers(scan_path: Path, line_number: int, row_cells: Sequence[str]) -> Array:
    """Parse the cells of one row of numbers; empty cells are NaN.

    Raises ValueError for a cell that is no number.
    """
    values = [parse_number(cell) if cell.strip() else np.nan for cell in row_cells]
    if None in values:
        cell = row_cells[values.index(None)].strip()
        raise ValueError(
            f"{scan_path}: is not a surface scan: line {line_number}: {cell!r} is not a number; expected "
            "numbers in columns"
        )
    return np.array(values, dtype=np.float64)


def heights_from_columns(scan_path: Path, grid_columns: Array, unit_sizes: list[float]) -> ScanHeights:
    """Profile from columns x, z, or areal map from columns x, y, z.

    grid_columns : (n, 2) or (n, 3)
    unit_sizes   : units of the columns in metres

    Raises ValueError for points that lie on no regular grid or occur twice.
    """
    if grid_columns.shape[1] != len(unit_sizes):
        raise ValueError(
            f"{scan_path}: has {grid_columns.shape[1]} columns, its header declares {len(unit_sizes)}; state "
            "one unit in the header for each column"
        )
    if len(unit_sizes) == 2:
        return _profile_from_columns(
            scan_path, grid_columns[:, 0], grid_columns[:, 1] * unit_sizes[1], unit_sizes[0]
        )
    (x, dx), (y, dy) = (
        _grid_indices(scan_path, name, grid_columns[:, i], unit_sizes[i]) for i, name in enumerate("xy")
    )
    if (x.max() + 1) * (y.max() + 1) > 4 * x.size:
        raise ValueError(
            f"{scan_path}: {x.size} points do not lie on a grid of x and y; resample them to a grid"
        )
    heights = np.full((y.max() + 1, x.max() + 1), np.nan)
    occupied = np.zeros(heights.shape, dtype=bool)
    occupied[y, x] = True
    if np.count_nonzero(occupied) < x.size:
        raise ValueError(f"{scan_path}: some points (x, y) are repeated; give every point once")
    heights[y, x] = grid_columns[:, 2] * unit_sizes[2]
    return ArealMap(z=heights, dx=dx, dy=dy, scan_name=str(scan_path))


def _grid_indices(
    scan_path: Path, axis_name: str, coordinates: Array, unit_size: float
) -> tuple[grid.GridIndices, float]:
    """Grid index of every point along x or y, and the grid spacing [m]; the points may have any order."""
    positions, inverse = np.unique(coordinates, return_inverse=True)
    index, step = grid.fit_regular_grid(scan_path, axis_name, positions, unit_size)
    return index[inverse], step * unit_size


def _profile_from_columns(scan_path: Path, x: Array, z: Array, unit_size: float) -> Profile:
    """Profile from positions x, in a unit of `unit_size` metres, and heights z [m].

    The points may have any order, and points of the grid may be missing.
    """
    if x[-1] < x[0]:
        x, z = x[::-1], z[::-1]
    order = np.argsort(x, kind="stable")
    in_order = bool(np.all(order == np.arange(x.size)))
    index, step = grid.fit_regular_grid(scan_path, "x", x[order], unit_size, allow_repeats=in_order)
    heights = np.full(index[-1] + 1, np.nan)
    heights[index] = z[order]
    return Profile(z=heights, dx=step * unit_size, scan_name=str(scan_path))


def format_scan_csv(heights: ScanHeights) -> str:
    """Text of a CSV file with heights in metres, with seven digits; `read_declared_file` reads it."""
    if isinstance(heights, Profile):
        x = np.arange(heights.z.size) * heights.dx
        declaration = "# profile: x [m], z [m]"
        body = format_rows([x, heights.z], [10, 7])
    else:
        declaration = f"# grid: dx = {heights.dx!r} m, dy = {heights.dy!r} m, z [m]"
        body = format_rows(heights.z.T, [7] * heights.z.shape[1])
    return "\n".join([declaration, f"# {PROGRAM_MARK}", *body, ""])
