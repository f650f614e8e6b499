"""The CSV format of this package for profiles and areal maps (docs/surfaces.md).

# profile: x [um], z [um]          two columns, spacing constant
# points: x [um], y [um], z [nm]   three columns on a full or gappy grid
# grid: dx = 0.5 um, dy = 0.5 um, z [um]   one line of z per y
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..columns import cells, check_length, content, number, rows, separator
from ..units import sizes
from .heights import Areal, Array, Heights, Profile

LENGTHS = sizes("m", "mm", "um", "µm", "μm", "nm")
"""Allowed length units in metres."""
LAYOUTS = {"profile": ("x", "z"), "points": ("x", "y", "z"), "grid": ("z",)}
_HEADER = re.compile(r"#\s*(profile|points|grid)\s*:(.*)")
ALLOWED = ", ".join(filter(str.isascii, LENGTHS))
"""The length units as text."""


def unit(text: str, where: str) -> float:
    """A length unit in metres."""
    if text not in LENGTHS:
        raise ValueError(f"{where}: unit {text!r} is not one of {ALLOWED}")
    return LENGTHS[text]


def header(path: Path) -> str | None:
    """The line that declares our layout, if the file begins with one; None for any other file."""
    with path.open("rb") as file:
        first = file.readline(1000).decode("utf-8", errors="replace").strip()
    return first if _HEADER.match(first) else None


def read(path: Path, line: str) -> Heights:
    """A file whose first line declares its layout."""
    match = _HEADER.match(line)
    assert match
    layout, rest = match[1], match[2]
    units = dict(re.findall(r"\b([xyz])\s*\[\s*([^\]\s]+)\s*\]", rest))
    needed = LAYOUTS[layout]
    if missing := [name for name in needed if name not in units]:
        expected = ", ".join(f"{name} [um]" for name in missing)
        raise ValueError(f"{path}: the header states no unit of {', '.join(missing)}; write it as {expected}")
    factors = {name: unit(units[name], f"{path}: {name}") for name in needed}
    if layout == "grid":
        dx, dy = (_spacing(path, rest, name) for name in ("dx", "dy"))
        return Areal(z=table(path) * factors["z"], dx=dx, dy=dy, name=str(path))
    return columns(path, table(path), [factors[name] for name in needed])


def _spacing(path: Path, text: str, name: str) -> float:
    match = re.search(rf"\b{name}\s*=\s*([-+\d.]+(?:[eE][-+]?\d+)?)\s*([a-zµμ]*)", text)
    if not match:
        raise ValueError(f"{path}: the header states no {name}; write it as {name} = 0.5 um")
    try:
        return float(match[1]) * unit(match[2], f"{path}: {name}")
    except ValueError as error:
        if "unit" in str(error):
            raise
        raise ValueError(f"{path}: {name} = {match[1]!r} is no number; write it as {name} = 0.5 um") from None


def table(path: Path) -> Array:
    """The numbers of a file (comma, semicolon, tab or blanks; # begins a comment); empty cells are NaN."""
    lines = [(i, line.partition("#")[0]) for i, line in content(path)]
    if not lines:
        raise ValueError(f"{path}: is no surface: it holds no numbers")
    mark = separator(lines[0][1])
    values: list[Array] = []
    for i, line in lines:
        row = cells(line, mark) if mark else line.split()
        check_length(path, i, row, values[0].size if values else len(row))
        values.append(_numbers(path, i, row))
    return np.array(values)


def _numbers(path: Path, line: int, row: Sequence[str]) -> Array:
    values = [number(cell) if cell.strip() else np.nan for cell in row]
    if None in values:
        cell = row[values.index(None)].strip()
        raise ValueError(
            f"{path}: is no surface: line {line}: {cell!r} is no number; expected numbers in columns"
        )
    return np.array(values, dtype=np.float64)


def columns(path: Path, values: Array, factors: list[float]) -> Heights:
    """Columns x, z (a profile) or x, y, z (an areal map) with their factors to metres."""
    if values.shape[1] != len(factors):
        raise ValueError(f"{path}: has {values.shape[1]} columns, its header declares {len(factors)}")
    values = values * np.asarray(factors)
    if len(factors) == 2:
        x, z = values[np.argsort(values[:, 0], kind="stable")].T
        return Profile(z=z, dx=_step(path, "x", x), name=str(path))
    x, y, z = values.T
    dx, dy = (_step(path, name, np.unique(at)) for name, at in (("x", x), ("y", y)))
    column, row = np.rint((x - x.min()) / dx).astype(int), np.rint((y - y.min()) / dy).astype(int)
    if (column.max() + 1) * (row.max() + 1) > 4 * x.size:
        raise ValueError(f"{path}: {x.size} points lie on no grid of x and y; resample them to one")
    heights = np.full((row.max() + 1, column.max() + 1), np.nan)
    heights[row, column] = z
    return Areal(z=heights, dx=dx, dy=dy, name=str(path))


def _step(path: Path, name: str, at: Array) -> float:
    """Constant spacing of sorted positions; up to 1 % off the grid is taken as rounding."""
    if at.size < 2 or not np.all(np.isfinite(at)):
        raise ValueError(f"{path}: {name} has a gap or a single value; expected positions in rising order")
    gaps = np.diff(at)
    step = float(np.median(gaps))
    if step <= 0.0 or gaps.min() < 0.5 * step:
        raise ValueError(f"{path}: {name} repeats values; expected every position once")
    step = float((at[-1] - at[0]) / np.rint((at[-1] - at[0]) / step))
    off = np.abs((at - at[0]) / step - np.rint((at - at[0]) / step)).max()
    if off > 0.05 or (name == "x" and gaps.max() > 1.5 * step and at.size < 0.8 * (at[-1] - at[0]) / step):
        raise ValueError(
            f"{path}: the spacing of {name} varies ({gaps.min():.4g} to {gaps.max():.4g} m); "
            "resample to a constant one"
        )
    return step


def text(heights: Heights) -> str:
    """Heights as the text of a file that `read` reads back (SI, seven digits)."""
    if isinstance(heights, Profile):
        at = np.arange(heights.z.size) * heights.dx
        head = "# profile: x [m], z [m]"
        body = rows([at, heights.z], [10, 7])
    else:
        head = f"# grid: dx = {heights.dx!r} m, dy = {heights.dy!r} m, z [m]"
        body = rows(heights.z.T, [7] * heights.z.shape[1])
    return "\n".join([head, *body, ""])
