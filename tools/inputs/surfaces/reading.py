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

from ...common.columns import find_separator, parse_number, split_cells
from . import csvfile, scan_text
from . import heights as sift
from .heights import ArealMap, Heights, Profile
from .scan_text import ScanOptions

MIN_PROFILE_LENGTH = 50e-6
"""Shortest plausible profile [m]: the cut-off of a stylus instrument is longer."""
MAX_RMS_HEIGHT = 50e-6
"""Largest plausible rms height of a surface [m]: rough castings have less."""
PLAUSIBLE_LENGTHS = (1e-7, 1.0)
"""Shortest and longest plausible side of a scan [m]."""
SUGGESTED_UNITS = ("mm", "um", "nm")
"""Units that a message may suggest instead of an implausible one."""
TYPICAL_SCAN_LENGTH = 1e-3
"""Length of a typical scan [m]."""
TEXT_SUFFIXES = (".csv", ".txt", ".dat", ".xy", ".prf")
"""Suffixes of text files that may have columns of numbers without a header."""

_INTERNAL_NAME_PATTERN = re.compile(r"`|\w_\w|\(\)|<\w")
"""Names of variables and functions in the messages of readers."""


def read_heights(
    path: str | Path,
    unit: str | None = None,
    accept_any_size: bool = False,
    unit_x: str | None = None,
    unit_z: str | None = None,
    spacing: tuple[float, float] | None = None,
    missing_value: float | None = None,
) -> Heights:
    """Read a profile or an areal map, in metres.

    unit     : length unit of x, y and z, for a file without units
    unit_x   : unit of x and y, for columns without units; instead of `unit`
    unit_z   : unit of z, for columns without units; instead of `unit`
    accept_any_size : accept a size outside of PLAUSIBLE_LENGTHS
    spacing  : spacing of the points along x and y [m], for a file without spacing
    missing_value : number in the file that marks a missing point, in the unit of its heights

    Raises ValueError (one line): no file, no surface, a unit or a spacing is missing or given twice, too few
    points, constant heights, all heights missing, a size that suggests another unit.
    """
    path = Path(path)
    check_regular_file(path, "height data")
    if not path.is_file():
        raise ValueError(f"{path}: is not a file; expected height data")
    option_units = {"x": unit_x or unit, "z": unit_z or unit}
    options = ScanOptions(option_units["x"], option_units["z"], spacing, missing_value)
    for name, value in {"unit": unit, "unit_x": unit_x, "unit_z": unit_z}.items():
        if value is not None and value not in csvfile.LENGTH_UNITS:
            raise InputRefusal(f"{name} = {value!r} is not one of {csvfile.UNIT_LIST}", name)
    if path.stat().st_size == 0:
        raise ValueError(f"{path}: is not a surface scan: the file is empty")
    is_text = path.suffix.lower() in TEXT_SUFFIXES
    if line := csvfile.read_declaration(path):
        if any(option_units.values()):
            value = next(filter(None, option_units.values()))
            raise InputRefusal(f"{path}: states its units; leave the unit {value} out", "unit")
        options.refuse_spacing(path, "states the positions of its points")
        heights, file_unit = csvfile.read_declared_file(path, line, options.mark_missing)
    elif is_text and (titles := csvfile.read_column_titles(path)):
        options.refuse_spacing(path, "states the positions of its points")
        heights, file_unit = csvfile.read_titled_file(
            path, titles, option_units, mark_missing=options.mark_missing
        )
    elif is_text and (count := _count_columns(path)):
        if not (all(option_units.values()) or (count == 1 and options.unit_z)):
            raise _missing_unit_error(path)
        if count == 1:
            heights, file_unit = scan_text.read_height_list(path, options)
        else:
            options.refuse_spacing(path, f"has {count} columns, with the positions of its points")
            names = csvfile.LAYOUT_COLUMNS["profile" if count == 2 else "points"]
            heads = [(name, None) for name in names]
            heights, file_unit = csvfile.read_titled_file(
                path, heads, option_units, header_lines=0, mark_missing=options.mark_missing
            )
    elif is_text and (header_lines := scan_text.find_matrix(path)) is not None:
        heights, file_unit = scan_text.read_matrix(path, header_lines, options)
    elif is_text and scan_text.find_wide_table(path):
        heights, file_unit = scan_text.read_wide_table(path, options)
    elif unit_x or unit_z:
        name = "unit_x" if unit_x else "unit_z"
        raise InputRefusal(f"{path}: is not a table of columns; expected one unit for all axes", name)
    else:
        heights, file_unit = _read_instrument(path, unit, options)
    if not accept_any_size:
        _check_size(heights, file_unit)
    return heights


def _check_size(heights: Heights, unit: str) -> None:
    """Raise ValueError for an implausible size of a scan; the message suggests the likely unit."""
    low, high = (
        PLAUSIBLE_LENGTHS if isinstance(heights, ArealMap) else (MIN_PROFILE_LENGTH, PLAUSIBLE_LENGTHS[1])
    )
    if max(heights.lengths) <= high and max(heights.lengths) >= low:
        return
    factor = unit_size(unit)
    number = max(heights.lengths) / factor
    likely = min(
        SUGGESTED_UNITS,
        key=lambda name: abs(np.log(number * csvfile.LENGTH_UNITS[name] / TYPICAL_SCAN_LENGTH)),
    )
    size = " x ".join(f"{length:.4g} m" for length in heights.lengths)
    likely_size = " x ".join(f"{length / factor:.4g} {likely}" for length in heights.lengths)
    raise InputRefusal(
        f"{heights.name}: the field is {size} with lengths in {unit}, scans have {low:g} to {high:g} m; "
        f"are the lengths in {likely} ({likely_size})? State the right unit, or confirm the size",
        "force",
    )


def _missing_unit_error(path: Path) -> InputRefusal:
    """Error for a surface file that states no length unit."""
    return InputRefusal(f"{path}: states no length unit; state it, one of {csvfile.UNIT_LIST}", "unit")


def _count_columns(path: Path) -> int:
    """Number of columns (1 to 3) of a text file that begins with a line of numbers; 0 for other files."""
    with path.open("rb") as file:
        first = file.readline(10000).decode("utf-8-sig", errors="replace").rstrip("\r\n")
    delimiter = find_separator(first)
    row = split_cells(first, delimiter) if delimiter else first.split()
    return len(row) if len(row) in (1, 2, 3) and all(parse_number(cell) is not None for cell in row) else 0


def _read_instrument(path: Path, unit: str | None, options: ScanOptions) -> tuple[Heights, str]:
    """Read the default channel of any format of SurfaceTopography; return the heights and the length unit.

    Raises ValueError if the package is missing or cannot read the file, or if the unit is unknown.
    """
    sift.check_surface_file(path)
    archives.check_zip(path)
    try:
        import SurfaceTopography
        import SurfaceTopography.Exceptions
    except ImportError:
        raise ValueError(
            f"{path}: the package SurfaceTopography is missing, needed to read instrument files; "
            "install it with: pip install 'jointfmu[surface]'"
        ) from None
    try:
        quiet = io.StringIO()
        with warnings.catch_warnings(), contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            warnings.simplefilter("ignore")
            topography = _read_topography(path, unit, options)
            size, heights = topography.physical_sizes, topography.heights()
    except SurfaceTopography.Exceptions.CannotDetectFileFormat:
        raise ValueError(
            f"{path}: is not a surface scan: neither our CSV nor a format of SurfaceTopography"
        ) from None
    except InputRefusal:
        raise
    except Exception as error:  # the readers raise exceptions of any kind
        reason = " ".join(str(error).split())[:120]
        if not reason or _INTERNAL_NAME_PATTERN.search(reason):
            reason = "its content does not match its format"
        raise ValueError(f"{path}: is not a surface that SurfaceTopography can read ({reason})") from None
    if topography.unit is None and unit is None:
        raise _missing_unit_error(path)
    if topography.unit is not None and unit is not None:
        raise InputRefusal(
            f"{path}: states its unit {topography.unit} itself; leave the unit {unit} out", "unit"
        )
    file_unit = str(unit or topography.unit)
    try:
        factor = unit_size(file_unit)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    z = options.mark_missing(np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan))
    return _convert_heights(path, topography, size, z, factor), file_unit


def _read_topography(path: Path, unit: str | None, options: ScanOptions) -> Any:
    """Read the default channel of a file, with the stated spacing if the file states no lateral size.

    Raises InputRefusal if the spacing is missing, or given both in the file and as an option.
    """
    import SurfaceTopography

    try:
        topography = SurfaceTopography.read_topography(str(path))
    except Exception as error:  # the readers raise exceptions of any kind
        if "physical_sizes" not in str(error):
            raise
        spacing = options.require_spacing(path)
        with SurfaceTopography.open_topography(str(path)) as reader:
            channel = reader.default_channel
            file_unit = channel.unit or unit
            if file_unit is None:
                raise _missing_unit_error(path) from None
            sizes = tuple(
                n * step / unit_size(file_unit) for n, step in zip(channel.nb_grid_pts, spacing, strict=False)
            )
            return reader.topography(physical_sizes=sizes)
    options.refuse_spacing(path, "states its lateral size")
    return topography


def unit_size(unit: str) -> float:
    """Size of a length unit in metres, also for units of SurfaceTopography and for µm in a wrong encoding.

    Raises ValueError for an unknown unit.
    """
    unit = unit.replace("Â", "").strip(" \0")
    if unit in csvfile.LENGTH_UNITS:
        return csvfile.LENGTH_UNITS[unit]
    from SurfaceTopography.Support.UnitConversion import get_unit_conversion_factor

    with contextlib.suppress(ValueError):
        if (factor := get_unit_conversion_factor(unit, "m")) is not None:
            return float(factor)
    raise ValueError(f"its unit {unit!r} is not a known unit of length")


def _convert_heights(
    path: Path, topography: Any, side_lengths: Any, heights: Array, unit_size: float
) -> Heights:
    """Convert heights of SurfaceTopography to a profile, or a map with axes (y, x); missing points are NaN.

    unit_size : unit of the heights and side lengths [m]
    """
    z = heights * unit_size
    if side_lengths is None or any(length is None for length in side_lengths):
        raise InputRefusal(f"{path}: states no spacing of its points; state it, e.g. 5um", "spacing")
    if z.ndim == 1 and not topography.is_uniform:
        x = np.asarray(topography.positions(), dtype=np.float64) * unit_size
        return csvfile.heights_from_columns(path, np.stack([x, z], axis=1), [1.0, 1.0])
    spacing = [float(length) * unit_size / n for length, n in zip(side_lengths, z.shape, strict=True)]
    if z.ndim == 1:
        return Profile(z=z, dx=spacing[0], name=str(path))
    return ArealMap(z=np.ascontiguousarray(z.T), dx=spacing[0], dy=spacing[1], name=str(path))
