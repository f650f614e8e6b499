"""Height data from files: our CSV, and what instruments write (SurfaceTopography, extra `surface`)."""

import contextlib
import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files import archives
from jointfmu.files.reading import check_regular
from jointfmu.quantity.refusal import Refusal

from ..columns import cells, number, separator
from . import csvfile
from . import heights as sift
from .heights import Areal, Heights, Profile

SHORTEST = 50e-6
"""Shortest profile [m] that is taken without asking back: a stylus' cut-off is longer."""
ROUGHEST = 50e-6
"""Largest root mean square height [m] of a surface that is taken without asking back: rough castings have
less."""
USUAL = (1e-7, 1.0)
"""Shortest and longest field [m] that is taken without asking back."""
LIKELY = ("mm", "um", "nm")
"""Units that may have been meant."""
TYPICAL = 1e-3
"""Length [m] of a typical scan."""
TEXT = (".csv", ".txt", ".dat", ".xy", ".prf")
"""Suffixes of files that may hold bare columns of numbers."""


def read(
    path: str | Path,
    unit: str | None = None,
    any_size: bool = False,
    unit_x: str | None = None,
    unit_z: str | None = None,
) -> Heights:
    """Heights in metres of a profile or an areal map.

    unit     : length unit of a file that states none (x, y and z alike); refused beside one's own
    unit_x   : the same of x and y in columns, in place of `unit`
    unit_z   : the same of z
    any_size : take a field beyond USUAL as it is

    Raises ValueError with one line: no file, no surface, unit missing or stated twice, too few points,
    constant, all missing; a length that hints at another unit.
    """
    path = Path(path)
    check_regular(path, "height data")
    if not path.is_file():
        raise ValueError(f"{path}: is no file; expected height data")
    given = {"x": unit_x or unit, "z": unit_z or unit}
    for name, one in {"unit": unit, "unit_x": unit_x, "unit_z": unit_z}.items():
        if one is not None and one not in csvfile.LENGTHS:
            raise Refusal(f"{name} = {one!r} is not one of {csvfile.ALLOWED}", name)
    if path.stat().st_size == 0:
        raise ValueError(f"{path}: is no surface: the file is empty")
    text = path.suffix.lower() in TEXT
    if line := csvfile.header(path):
        if any(given.values()):
            one = next(filter(None, given.values()))
            raise Refusal(f"{path}: states its units itself; leave the unit {one} out", "unit")
        heights, stated = csvfile.read(path, line)
    elif text and (titles := csvfile.titles(path)):
        heights, stated = csvfile.titled(path, titles, given)
    elif text and (count := _bare(path)):
        if not all(given.values()):
            raise _without_unit(path)
        names = csvfile.LAYOUTS["profile" if count == 2 else "points"]
        heights, stated = csvfile.titled(path, [(name, None) for name in names], given, above=0)
    elif unit_x or unit_z:
        one = "unit_x" if unit_x else "unit_z"
        raise Refusal(f"{path}: is no table of columns; expected one unit for all axes", one)
    else:
        heights, stated = _instrument(path, unit)
    if not any_size:
        _usual(heights, stated)
    return heights


def _usual(heights: Heights, unit: str) -> None:
    """Refuse a field that nobody scans, naming the unit that was probably meant."""
    low, high = USUAL if isinstance(heights, Areal) else (SHORTEST, USUAL[1])
    if max(heights.lengths) <= high and max(heights.lengths) >= low:
        return
    factor = _metres(unit)
    number = max(heights.lengths) / factor
    meant = min(LIKELY, key=lambda name: abs(np.log(number * csvfile.LENGTHS[name] / TYPICAL)))
    size = " x ".join(f"{length:.4g} m" for length in heights.lengths)
    told = " x ".join(f"{length / factor:.4g} {meant}" for length in heights.lengths)
    raise Refusal(
        f"{heights.name}: the field is {size} with lengths in {unit}, scans have {low:g} to {high:g} m; "
        f"were lengths in {meant} meant ({told})? State the right unit, or that the size is right",
        "force",
    )


def _without_unit(path: Path) -> Refusal:
    return Refusal(f"{path}: states no length unit; state it, one of {csvfile.ALLOWED}", "unit")


def _bare(path: Path) -> int:
    """Number of columns, two or three, if a text file begins with a line of numbers; else 0."""
    with path.open("rb") as file:
        first = file.readline(10000).decode("utf-8-sig", errors="replace").rstrip("\r\n")
    mark = separator(first)
    row = cells(first, mark) if mark else first.split()
    return len(row) if len(row) in (2, 3) and all(number(cell) is not None for cell in row) else 0


def _instrument(path: Path, unit: str | None) -> tuple[Heights, str]:
    """Any format of SurfaceTopography, the default channel, and its unit."""
    sift.check(path)
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
            topography = SurfaceTopography.read_topography(str(path))
            size, heights = topography.physical_sizes, topography.heights()
    except SurfaceTopography.Exceptions.CannotDetectFileFormat:
        raise ValueError(
            f"{path}: is no surface: neither our CSV nor a format of SurfaceTopography"
        ) from None
    except Exception as error:  # the readers raise what they like
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise ValueError(f"{path}: is no surface that SurfaceTopography can read ({reason})") from None
    if topography.unit is None and unit is None:
        raise _without_unit(path)
    if topography.unit is not None and unit is not None:
        raise Refusal(f"{path}: states its unit {topography.unit} itself; leave the unit {unit} out", "unit")
    stated = str(unit or topography.unit)
    try:
        factor = _metres(stated)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return _heights(path, topography, size, heights, factor), stated


def _metres(unit: str) -> float:
    """A length unit in metres, ours or one of SurfaceTopography; also µm whose two bytes were read as two."""
    unit = unit.replace("Â", "").strip(" \0")
    if unit in csvfile.LENGTHS:
        return csvfile.LENGTHS[unit]
    from SurfaceTopography.Support.UnitConversion import get_unit_conversion_factor

    with contextlib.suppress(ValueError):
        if (factor := get_unit_conversion_factor(unit, "m")) is not None:
            return float(factor)
    raise ValueError(f"its unit {unit!r} is no length that is known")


def _heights(path: Path, topography: Any, size: Any, heights: Any, factor: float) -> Heights:
    """Heights on our axes (y, x), missing points as NaN."""
    z = np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan) * factor
    if size is None or any(length is None for length in size):
        raise ValueError(f"{path}: states no lateral size; resave it with its size, or as our CSV")
    if z.ndim == 1 and not topography.is_uniform:
        x = np.asarray(topography.positions(), dtype=np.float64) * factor
        return csvfile.columns(path, np.stack([x, z], axis=1), [1.0, 1.0])
    spacing = [float(length) * factor / n for length, n in zip(size, z.shape, strict=True)]
    if z.ndim == 1:
        return Profile(z=z, dx=spacing[0], name=str(path))
    return Areal(z=np.ascontiguousarray(z.T), dx=spacing[0], dy=spacing[1], name=str(path))
