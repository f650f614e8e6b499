"""Read height data: CSV files, and files of instruments (package SurfaceTopography, extra `surface`)."""

import contextlib
import io
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files import archives
from jointfmu.files.reading import check_regular_file
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ...common.columns import find_column_separator, parse_number, split_table_line
from . import csvfile, scan_text
from . import heights as sift
from .heights import ArealMap, Profile, ScanHeights
from .scan_text import ScanOptions

MIN_PLAUSIBLE_PROFILE_LENGTH = 50e-6
"""Shortest plausible profile [m]: the cut-off of a stylus instrument is longer."""
MAX_PLAUSIBLE_RMS_HEIGHT = 50e-6
"""Largest plausible rms height of a surface [m]: rough castings have less."""
PLAUSIBLE_SCAN_LENGTHS = (1e-7, 1.0)
"""Shortest and longest plausible side of a scan [m]."""
SUGGESTED_LENGTH_UNITS = ("mm", "um", "nm")
"""Units that a message may suggest instead of an implausible one."""
TYPICAL_SCAN_LENGTH = 1e-3
"""Length of a typical scan [m]."""
SCAN_TEXT_SUFFIXES = (".csv", ".txt", ".dat", ".xy", ".prf")
"""Suffixes of text files that may have columns of numbers without a header."""

_INTERNAL_NAME_PATTERN = re.compile(r"`|\w_\w|\(\)|<\w")
"""Names of variables and functions in the messages of readers."""


def read_heights(
    scan_path: str | Path,
    length_unit: str | None = None,
    accept_any_size: bool = False,
    unit_x: str | None = None,
    unit_z: str | None = None,
    point_spacing: tuple[float, float] | None = None,
    missing_value: float | None = None,
) -> ScanHeights:
    """Read a profile or an areal map, in metres.

    length_unit     : length unit of x, y and z, for a file without units
    unit_x          : unit of x and y, for columns without units; instead of `length_unit`
    unit_z          : unit of z, for columns without units; instead of `length_unit`
    accept_any_size : accept a size outside of PLAUSIBLE_SCAN_LENGTHS
    point_spacing   : spacing of the points along x and y [m], for a file without spacing
    missing_value   : number in the file that marks a missing point, in the unit of its heights

    Raises ValueError (one line): no file, no surface, a unit or a spacing is missing or given twice, too few
    points, constant heights, all heights missing, a size that suggests another unit.
    """
    scan_path = Path(scan_path)
    check_regular_file(scan_path, "height data")
    if not scan_path.is_file():
        what = "is not a file" if scan_path.exists() else "does not exist"
        raise ValueError(f"{scan_path}: {what}; expected a file with the heights of a surface")
    option_units = {"x": unit_x or length_unit, "z": unit_z or length_unit}
    options = ScanOptions(option_units["x"], option_units["z"], point_spacing, missing_value)
    for name, value in {"unit": length_unit, "unit_x": unit_x, "unit_z": unit_z}.items():
        if value is not None and value not in csvfile.LENGTH_UNITS:
            raise InputRefusal(f"{name} = {value!r} is not one of {csvfile.LENGTH_UNIT_LIST}", name)
    if scan_path.stat().st_size == 0:
        raise ValueError(f"{scan_path}: is not a surface scan: the file is empty")
    is_text = scan_path.suffix.lower() in SCAN_TEXT_SUFFIXES
    if line := csvfile.read_layout_declaration(scan_path):
        if any(option_units.values()):
            value = next(filter(None, option_units.values()))
            raise InputRefusal(f"{scan_path}: states its units; leave the unit {value} out", "unit")
        options.refuse_spacing(scan_path, "states the positions of its points")
        heights, file_unit = csvfile.read_declared_file(scan_path, line, options.mark_missing)
    elif is_text and (titles := csvfile.read_column_titles(scan_path)):
        options.refuse_spacing(scan_path, "states the positions of its points")
        heights, file_unit = csvfile.read_titled_file(
            scan_path, titles, option_units, mark_missing=options.mark_missing
        )
    elif is_text and (count := _count_columns(scan_path)):
        if not (all(option_units.values()) or (count == 1 and options.unit_z)):
            raise _missing_unit_error(scan_path)
        if count == 1:
            heights, file_unit = scan_text.read_height_list(scan_path, options)
        else:
            options.refuse_spacing(scan_path, f"has {count} columns, with the positions of its points")
            names = csvfile.LAYOUT_COLUMNS["profile" if count == 2 else "points"]
            heads = [(name, None) for name in names]
            heights, file_unit = csvfile.read_titled_file(
                scan_path, heads, option_units, header_lines=0, mark_missing=options.mark_missing
            )
    elif is_text and (header_lines := scan_text.count_matrix_header_lines(scan_path)) is not None:
        heights, file_unit = scan_text.read_height_matrix(scan_path, header_lines, options)
    elif is_text and scan_text.is_wide_table(scan_path):
        heights, file_unit = scan_text.read_wide_table(scan_path, options)
    elif unit_x or unit_z:
        name = "unit_x" if unit_x else "unit_z"
        raise InputRefusal(
            f"{scan_path}: has no columns x and z; state one unit for all axes, and leave {name} out", name
        )
    else:
        heights, file_unit = _read_instrument_file(scan_path, length_unit, options)
    if not accept_any_size:
        _check_scan_size(heights, file_unit)
    return heights


def _check_scan_size(heights: ScanHeights, length_unit: str) -> None:
    """Raise ValueError for an implausible size of a scan; the message suggests the likely unit."""
    low, high = (
        PLAUSIBLE_SCAN_LENGTHS
        if isinstance(heights, ArealMap)
        else (MIN_PLAUSIBLE_PROFILE_LENGTH, PLAUSIBLE_SCAN_LENGTHS[1])
    )
    if max(heights.side_lengths) <= high and max(heights.side_lengths) >= low:
        return
    factor = length_unit_size(length_unit)
    number = max(heights.side_lengths) / factor
    likely = min(
        SUGGESTED_LENGTH_UNITS,
        key=lambda name: abs(np.log(number * csvfile.LENGTH_UNITS[name] / TYPICAL_SCAN_LENGTH)),
    )
    size = " x ".join(f"{length:.4g} m" for length in heights.side_lengths)
    likely_size = " x ".join(f"{length / factor:.4g} {likely}" for length in heights.side_lengths)
    raise InputRefusal(
        f"{heights.scan_name}: the field is {size} with lengths in {length_unit}, scans have {low:g} to "
        f"{high:g} m; are the lengths in {likely} ({likely_size})? State the right unit, or confirm the size",
        "force",
    )


def _missing_unit_error(scan_path: Path) -> InputRefusal:
    """Error for a surface file that states no length unit."""
    return InputRefusal(
        f"{scan_path}: states no length unit; state it, one of {csvfile.LENGTH_UNIT_LIST}", "unit"
    )


def _count_columns(scan_path: Path) -> int:
    """Number of columns (1 to 3) of a text file that begins with a line of numbers; 0 for other files."""
    with scan_path.open("rb") as file:
        first = file.readline(10000).decode("utf-8-sig", errors="replace").rstrip("\r\n")
    delimiter = find_column_separator(first)
    row = split_table_line(first, delimiter) if delimiter else first.split()
    return len(row) if len(row) in (1, 2, 3) and all(parse_number(cell) is not None for cell in row) else 0


def _read_instrument_file(
    scan_path: Path, length_unit: str | None, scan_options: ScanOptions
) -> tuple[ScanHeights, str]:
    """Read the default channel of any format of SurfaceTopography; return the heights and the length unit.

    Raises ValueError if the package is missing or cannot read the file, or if the unit is unknown.
    """
    sift.check_surface_file(scan_path)
    archives.check_zip(scan_path)
    try:
        import SurfaceTopography
        import SurfaceTopography.Exceptions
    except ImportError:
        raise ValueError(
            f"{scan_path}: is no table of heights (CSV, text); if it is the file of an instrument, install "
            "the package that reads such files: pip install 'jointfmu[surface]'"
        ) from None
    try:
        quiet = io.StringIO()
        with warnings.catch_warnings(), contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            warnings.simplefilter("ignore")
            topography = _read_topography(scan_path, length_unit, scan_options)
            size, heights = topography.physical_sizes, topography.heights()
    except SurfaceTopography.Exceptions.CannotDetectFileFormat:
        raise ValueError(
            f"{scan_path}: is not a surface scan: neither CSV nor another format that SurfaceTopography reads"
        ) from None
    except InputRefusal:
        raise
    except Exception as error:  # the readers raise exceptions of any kind
        reason = " ".join(str(error).split())[:120]
        if not reason or _INTERNAL_NAME_PATTERN.search(reason):
            reason = "its content does not match its format"
        raise ValueError(
            f"{scan_path}: is not a surface that SurfaceTopography can read ({reason})"
        ) from None
    if topography.unit is None and length_unit is None:
        raise _missing_unit_error(scan_path)
    if topography.unit is not None and length_unit is not None:
        raise InputRefusal(
            f"{scan_path}: states its unit {topography.unit} itself; leave the unit {length_unit} out", "unit"
        )
    file_unit = str(length_unit or topography.unit)
    try:
        factor = length_unit_size(file_unit)
    except ValueError as error:
        raise ValueError(f"{scan_path}: {error}") from None
    z = scan_options.mark_missing(np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan))
    return _convert_heights(scan_path, topography, size, z, factor), file_unit


def _read_topography(scan_path: Path, length_unit: str | None, scan_options: ScanOptions) -> Any:
    """Read the default channel of a file, with the stated spacing if the file states no lateral size.

    Raises InputRefusal if the spacing is missing, or given both in the file and as an option.
    """
    import SurfaceTopography

    try:
        topography = SurfaceTopography.read_topography(str(scan_path))
    except Exception as error:  # the readers raise exceptions of any kind
        if "physical_sizes" not in str(error):
            raise
        spacing = scan_options.require_spacing(scan_path)
        with SurfaceTopography.open_topography(str(scan_path)) as reader:
            channel = reader.default_channel
            file_unit = channel.unit or length_unit
            if file_unit is None:
                raise _missing_unit_error(scan_path) from None
            sizes = tuple(
                n * step / length_unit_size(file_unit)
                for n, step in zip(channel.nb_grid_pts, spacing, strict=False)
            )
            return reader.topography(physical_sizes=sizes)
    scan_options.refuse_spacing(scan_path, "states its lateral size")
    return topography


def length_unit_size(length_unit: str) -> float:
    """Size of a length unit in metres, also for units of SurfaceTopography and for µm in a wrong encoding.

    Raises ValueError for an unknown unit.
    """
    length_unit = length_unit.replace("Â", "").strip(" \0")
    if length_unit in csvfile.LENGTH_UNITS:
        return csvfile.LENGTH_UNITS[length_unit]
    from SurfaceTopography.Support.UnitConversion import get_unit_conversion_factor

    with contextlib.suppress(ValueError):
        if (factor := get_unit_conversion_factor(length_unit, "m")) is not None:
            return float(factor)
    raise ValueError(
        f"its unit {length_unit!r} is not a known unit of length; expected one of {csvfile.LENGTH_UNIT_LIST}"
    )


def _convert_heights(
    scan_path: Path, topography: Any, side_lengths: Any, heights: Array, unit_size: float
) -> ScanHeights:
    """Convert heights of SurfaceTopography to a profile, or a map with axes (y, x); missing points are NaN.

    unit_size : unit of the heights and side lengths [m]
    """
    z = heights * unit_size
    if side_lengths is None or any(length is None for length in side_lengths):
        raise InputRefusal(f"{scan_path}: states no spacing of its points; state it, e.g. 5um", "spacing")
    if z.ndim == 1 and not topography.is_uniform:
        x = np.asarray(topography.positions(), dtype=np.float64) * unit_size
        return csvfile.heights_from_columns(scan_path, np.stack([x, z], axis=1), [1.0, 1.0])
    spacing = [float(length) * unit_size / n for length, n in zip(side_lengths, z.shape, strict=True)]
    if z.ndim == 1:
        return Profile(z=z, dx=spacing[0], scan_name=str(scan_path))
    return ArealMap(z=np.ascontiguousarray(z.T), dx=spacing[0], dy=spacing[1], scan_name=str(scan_path))
