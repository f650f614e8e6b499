"""Read text exports of instruments: matrices of heights (Keyence VR, VK), tables with further columns."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ...common.columns import (
    decode_text,
    find_column_separator,
    parse_heading,
    parse_number,
    read_numbered_lines,
    split_table_line,
)
from .csvfile import (
    LENGTH_UNIT_LIST,
    LENGTH_UNITS,
    heights_from_columns,
    parse_length_unit,
    read_number_table,
)
from .heights import MIN_AREAL_POINTS, ArealMap, Profile, ScanHeights

MAX_HEADER_LINES = 60
"""Largest number of lines above a matrix of heights that are searched for its first row."""
MAX_HEADER_BYTES = 2**18
"""Bytes at the start of a file that are searched for its header and its first row of heights."""
HEIGHT_COLUMN_NAMES = ("z", "height", "altitude", "depth", "elevation")
"""Names of a column of heights in a table with more columns, in lower case."""
MISSING_VALUE_OVER_HEIGHT_RANGE = 1000.0
"""Magnitude of a repeated height over the range of the other heights [1]: above, it marks missing points."""
_SPACING_PATTERN = re.compile(r"\s*([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*([^\W\d_]+)\s*")
"""Pattern of a spacing with a unit."""


@dataclass(frozen=True, slots=True)
class ScanOptions:
    """Units, spacing and missing value that the user states about a scan file without them.

    unit_x, unit_z : length unit of x and y, and of z
    point_spacing  : spacing of the points along x and y [m]
    missing_value  : number in the file that marks a missing point, in the unit of the heights
    """

    unit_x: str | None = None
    unit_z: str | None = None
    point_spacing: tuple[float, float] | None = None
    missing_value: float | None = None

    def mark_missing(self, z: Array) -> Array:
        """Heights in the unit of the file, with NaN in place of the missing value."""
        return z if self.missing_value is None else np.where(z == self.missing_value, np.nan, z)

    def refuse_spacing(self, scan_path: Path, refusal_reason: str) -> None:
        """Raise InputRefusal if the user states a spacing, but the file has its own."""
        if self.point_spacing is not None:
            raise InputRefusal(f"{scan_path}: {refusal_reason}; leave the spacing out", "spacing")

    def require_spacing(self, scan_path: Path) -> tuple[float, float]:
        """Spacing [m] along x and y. Raises InputRefusal if the user states none."""
        if self.point_spacing is None:
            raise InputRefusal(f"{scan_path}: states no spacing of its points; state it, e.g. 5um", "spacing")
        return self.point_spacing


def parse_spacing(spacing_texts: list[str]) -> tuple[float, float]:
    """Parse one or two spacings with a unit, `5um`: spacing along x and y [m].

    Raises InputRefusal for more than two, for a missing or unknown unit, and for a spacing that is not
    positive.
    """
    if len(spacing_texts) > 2:
        raise InputRefusal(f"{len(spacing_texts)} spacings; expected one, or two (along x and y)", "spacing")
    sizes = []
    for text in spacing_texts:
        match = _SPACING_PATTERN.fullmatch(text)
        number = parse_number(match[1]) if match else None
        if match is None or number is None:
            raise InputRefusal(
                f"spacing {text!r} is not a length; expected a number and a unit, e.g. 5um", "spacing"
            )
        if match[2] not in LENGTH_UNITS:
            raise InputRefusal(
                f"spacing {text!r}: unit {match[2]!r} is not one of {LENGTH_UNIT_LIST}", "spacing"
            )
        if not number > 0.0:
            raise InputRefusal(f"spacing {text!r} is outside (0, inf)", "spacing")
        sizes.append(number * LENGTH_UNITS[match[2]])
    return sizes[0], sizes[-1]


def count_matrix_header_lines(scan_path: Path) -> int | None:
    """Number of header lines above a matrix of heights, empty lines not counted; None if there is no matrix.

    A matrix has at least MIN_AREAL_POINTS numbers or empty cells in a line. A file whose first line is a
    comment (#) is another format: SurfaceTopography reads its comments.
    """
    with scan_path.open("rb") as file:
        try:
            start = decode_text(file.read(MAX_HEADER_BYTES))
        except UnicodeDecodeError:
            return None
    if start.lstrip().startswith("#"):
        return None
    lines = (line for line in start.splitlines() if line.strip())
    for i, line in enumerate(islice(lines, MAX_HEADER_LINES)):
        mark = find_column_separator(line)
        cells = split_table_line(line, mark) if mark else line.split()
        numbers = [parse_number(cell) for cell in cells if cell.strip()]
        if len(cells) >= MIN_AREAL_POINTS and numbers and None not in numbers:
            return i
    return None


def read_height_matrix(
    scan_path: Path, header_lines: int, scan_options: ScanOptions
) -> tuple[ScanHeights, str]:
    """Read a matrix of heights, one line for each y; return the map and the length unit of the spacing.

    The lines above the matrix may state the calibration (`XY calibration`, 138.6, nm) and the unit of the
    heights (`Unit`, um), as Keyence VK and VR write them. Raises ValueError if the spacing or the unit is
    missing, or given both in the file and as an option.
    """
    header = _read_matrix_header(scan_path, header_lines)
    dx, dy = _matrix_spacing(scan_path, header, scan_options)
    unit_z = header["unit"][0] if header.get("unit") else None
    if unit_z and scan_options.unit_z:
        raise InputRefusal(
            f"{scan_path}: states the unit {unit_z} of its heights; leave the unit out", "unit"
        )
    if not unit_z and not scan_options.unit_z:
        raise InputRefusal(
            f"{scan_path}: states no length unit of its heights; state it, one of {LENGTH_UNIT_LIST}", "unit"
        )
    if scan_options.unit_x and scan_options.unit_x != scan_options.unit_z:
        raise InputRefusal(
            f"{scan_path}: has no columns x and y; leave out the unit {scan_options.unit_x}", "unit_x"
        )
    values = read_number_table(scan_path, header_lines)
    if np.all(np.isnan(values[:, -1])):  # a separator at the end of each line
        values = values[:, :-1]
    z = scan_options.mark_missing(values)
    _check_missing_value(scan_path, z)
    factor = parse_length_unit(str(unit_z or scan_options.unit_z), f"{scan_path}: heights")
    return ArealMap(z=z * factor, dx=dx, dy=dy, scan_name=str(scan_path)), "m"


def _read_matrix_header(scan_path: Path, header_lines: int) -> dict[str, list[str]]:
    """Read the header of a matrix: {name in lower case: the cells after it}."""
    rows = []
    for _, line in read_numbered_lines(scan_path, header_lines):
        rows.append([cell.strip() for cell in split_table_line(line, find_column_separator(line))])
    return {row[0].lower(): row[1:] for row in rows}


def _matrix_spacing(
    scan_path: Path, header_cells: Mapping[str, list[str]], scan_options: ScanOptions
) -> tuple[float, float]:
    """Spacing [m] along x and y of a matrix of heights, from its header or from the options."""
    stated = header_cells.get("xy calibration")
    if stated is None:
        return scan_options.require_spacing(scan_path)
    scan_options.refuse_spacing(scan_path, f"states its spacing {' '.join(stated)}")
    number = parse_number(stated[0]) if len(stated) > 1 else None
    if number is None:
        raise ValueError(
            f"{scan_path}: its XY calibration is {' '.join(stated)!r}; expected a number and a unit"
        )
    spacing = number * parse_length_unit(stated[1], f"{scan_path}: XY calibration")
    return spacing, spacing


def _check_missing_value(scan_path: Path, z: Array) -> None:
    """Raise InputRefusal if a height far from all others occurs twice: it marks missing points."""
    valid = z[np.isfinite(z)]
    for extreme in {float(valid.min()), float(valid.max())} if valid.size else ():
        others = valid[valid != extreme]
        count = valid.size - others.size
        if (
            count > 1
            and others.size
            and abs(extreme) > MISSING_VALUE_OVER_HEIGHT_RANGE * max(float(np.ptp(others)), 1e-300)
        ):
            raise InputRefusal(
                f"{scan_path}: {count} heights are {extreme:.10g}, all others {others.min():g} to "
                f"{others.max():g}; state the number that marks a missing point",
                "missing",
            )


def read_height_list(scan_path: Path, scan_options: ScanOptions) -> tuple[ScanHeights, str]:
    """Read a file with one column of heights as a profile.

    Returns the profile and the length unit of its spacing.
    """
    dx, _ = scan_options.require_spacing(scan_path)
    z = scan_options.mark_missing(read_number_table(scan_path)[:, 0])
    _check_missing_value(scan_path, z)
    return Profile(z=z * LENGTH_UNITS[str(scan_options.unit_z)], dx=dx, scan_name=str(scan_path)), "m"


def is_wide_table(scan_path: Path) -> bool:
    """Whether a scan file has a line of more than three column titles, with numbers below."""
    try:
        lines = [line for _, line in read_numbered_lines(scan_path, 2)]
    except ValueError:
        return False
    mark = find_column_separator(lines[0]) if len(lines) == 2 else None
    if mark is None:
        return False
    titles, values = (split_table_line(line, mark) for line in lines)
    return (
        3 < len(titles) == len(values)
        and all(title.strip() and parse_number(title) is None for title in titles)
        and all(parse_number(cell) is not None for cell in values if cell.strip())
    )


def read_wide_table(scan_path: Path, scan_options: ScanOptions) -> tuple[ScanHeights, str]:
    """Read heights and positions from a table with further columns (counter, row number).

    The heights are the column that HEIGHT_COLUMN_NAMES names. The positions are the other columns with a
    length unit whose values vary: one column gives a profile, two give a map. Returns the heights and the
    unit along x. Raises ValueError if the table has no such columns, or more.
    """
    scan_options.refuse_spacing(scan_path, "states the positions of its points")
    if option := scan_options.unit_x or scan_options.unit_z:
        raise InputRefusal(f"{scan_path}: states its units; leave the unit {option} out", "unit")
    (_, line), *_ = read_numbered_lines(scan_path, 1)
    heads = [parse_heading(cell) for cell in split_table_line(line, find_column_separator(line))]
    values = read_number_table(scan_path, 1)
    lengths = [i for i, (_, unit) in enumerate(heads) if unit in LENGTH_UNITS]
    heights = [i for i in lengths if heads[i][0].lower() in HEIGHT_COLUMN_NAMES]
    positions = [i for i in lengths if i not in heights and np.nanmin(values[:, i]) < np.nanmax(values[:, i])]
    if len(heights) != 1 or len(positions) not in (1, 2):
        titles = ", ".join(cell.strip() for cell in split_table_line(line, find_column_separator(line)))
        raise ValueError(
            f"{scan_path}: its columns are {titles}; expected one column of heights "
            f"({', '.join(HEIGHT_COLUMN_NAMES)}) and one or two columns of positions that vary, each with a "
            "length unit"
        )
    used = [*positions, *heights]
    table = values[:, used]
    table[:, -1] = scan_options.mark_missing(table[:, -1])
    units = [str(heads[i][1]) for i in used]
    return heights_from_columns(scan_path, table, [LENGTH_UNITS[unit] for unit in units]), units[0]
