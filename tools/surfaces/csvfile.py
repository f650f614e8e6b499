"""The CSV format of this package for profiles and areal maps (docs/surfaces_reference.md).

# profile: x [um], z [um]          two columns, spacing constant
# points: x [um], y [um], z [nm]   three columns on a full or gappy grid
# grid: dx = 0.5 um, dy = 0.5 um, z [um]   one line of z per y
"""

import contextlib
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from jointfmu.files.outputs import MARK, FileKind
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal
from jointfmu.quantity.units import measured, sizes

from ..columns import (
    Head,
    cells,
    check_length,
    content,
    decoded,
    head,
    number,
    rows,
    separator,
    text_lines,
)
from . import heights as grid
from .heights import Areal, Heights, Profile

SCAN = FileKind("surface", (".csv",))
LENGTHS = sizes("m", "mm", "um", "µm", "μm", "nm")
"""Allowed length units in metres."""
LAYOUTS = {"profile": ("x", "z"), "points": ("x", "y", "z"), "grid": ("z",)}
_HEADER = re.compile(r"#\s*(profile|points|grid)\s*:(.*)")
ALLOWED = ", ".join(filter(str.isascii, LENGTHS))
"""The length units as text."""


def unit(text: str, where: str) -> float:
    """A length unit in metres."""
    try:
        return measured(text, LENGTHS)
    except ValueError:
        raise ValueError(f"{where}: unit {text!r} is not one of {ALLOWED}") from None


def header(path: Path) -> str | None:
    """The line that declares our layout, if the file begins with one; None for any other file."""
    with path.open("rb") as file, contextlib.suppress(UnicodeDecodeError):
        first = decoded(file.readline(1000)).strip()
        return first if _HEADER.match(first) else None
    return None


def read(path: Path, line: str) -> tuple[Heights, str]:
    """A file whose first line declares its layout, and the unit of its lengths along x."""
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
        spacings = {name: _spacing(path, rest, name) for name in ("dx", "dy")}
        dx, dy = (size for size, _ in spacings.values())
        stated = spacings["dx"][1]
        return Areal(z=table(path) * factors["z"], dx=dx, dy=dy, name=str(path)), stated
    return columns(path, table(path), [factors[name] for name in needed]), units["x"]


def titles(path: Path) -> list[Head] | None:
    """Name and unit of two or three columns in the first line (x, z or x, y, z), if numbers are below it."""
    try:
        lines = content(path, 2)
    except ValueError:
        if path.suffix.lower() == ".csv":
            raise
        return None  # no text: an instrument's
    mark = separator(lines[0][1]) if len(lines) == 2 else None
    if mark is None:
        return None
    words, values = (cells(line, mark) for _, line in lines)
    named = len(words) in (2, 3) and all(number(word) is None and word.strip() for word in words)
    below = len(values) == len(words) and all(number(cell) is not None for cell in values)
    return [head(word) for word in words] if named and below else None


def titled(
    path: Path, heads: Sequence[Head], given: Mapping[str, str | None], above: int = 1
) -> tuple[Heights, str]:
    """Columns under so many lines of titles, and the unit of x.

    given : {"x", "z": unit of columns that state none}; y is as x

    Raises ValueError for a column that states no unit and is given none, or both.
    """
    stated = []
    for axis, (name, own) in zip(LAYOUTS["profile" if len(heads) == 2 else "points"], heads, strict=True):
        other = given["z" if axis == "z" else "x"]
        if own and other:
            raise Refusal(f"{path}: column {name!r} states its unit {own}; leave {other} out", "unit")
        if not own and not other:
            raise Refusal(
                f"{path}: column {name!r} states no length unit; state it, one of {ALLOWED}", "unit"
            )
        stated.append(str(own or other))
    factors = [unit(text, f"{path}: {name}") for text, (name, _) in zip(stated, heads, strict=True)]
    return columns(path, table(path, above), factors), stated[0]


def _spacing(path: Path, text: str, name: str) -> tuple[float, str]:
    """A spacing [m] and the unit in which it is stated."""
    match = re.search(rf"\b{name}\s*=\s*([-+\d.]+(?:[eE][-+]?\d+)?)\s*([a-zµμ]*)", text)
    if not match:
        raise ValueError(f"{path}: the header states no {name}; write it as {name} = 0.5 um")
    try:
        return float(match[1]) * unit(match[2], f"{path}: {name}"), match[2]
    except ValueError as error:
        if "unit" in str(error):
            raise
        raise ValueError(f"{path}: {name} = {match[1]!r} is no number; write it as {name} = 0.5 um") from None


def table(path: Path, above: int = 0) -> Array:
    """The numbers of a file below some lines (semicolon, tab, comma or blanks; # begins a comment); empty
    cells are NaN."""
    top = content(path, above + 1)
    if len(top) <= above:
        raise ValueError(f"{path}: is no surface: it holds no numbers")
    first, line = top[above]
    mark = separator(line.partition("#")[0])
    with contextlib.suppress(ValueError):  # empty cells, rows of other lengths, words: row by row below
        return np.loadtxt(text_lines(path)[first - 1 :], delimiter=mark, ndmin=2)
    values: list[Array] = []
    for i, line in ((i, line.partition("#")[0]) for i, line in content(path)[above:]):
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
    if len(factors) == 2:
        return _profile(path, values[:, 0], values[:, 1] * factors[1], factors[0])
    (x, dx), (y, dy) = (_places(path, name, values[:, i], factors[i]) for i, name in enumerate("xy"))
    if (x.max() + 1) * (y.max() + 1) > 4 * x.size:
        raise ValueError(f"{path}: {x.size} points lie on no grid of x and y; resample them to one")
    heights = np.full((y.max() + 1, x.max() + 1), np.nan)
    taken = np.zeros(heights.shape, dtype=bool)
    taken[y, x] = True
    if np.count_nonzero(taken) < x.size:
        raise ValueError(f"{path}: x and y repeat points; expected every point once")
    heights[y, x] = values[:, 2] * factors[2]
    return Areal(z=heights, dx=dx, dy=dy, name=str(path))


def _places(path: Path, name: str, values: Array, factor: float) -> tuple[grid.Places, float]:
    """Place of every point along x or y, which come in any order, and the spacing [m]."""
    at, which = np.unique(values, return_inverse=True)
    place, step = grid.places(path, name, at, factor)
    return place[which], step * factor


def _profile(path: Path, x: Array, z: Array, factor: float) -> Profile:
    """A profile of x, in a unit of `factor` metres, and z [m]; rows may come in any order, and be missing."""
    if x[-1] < x[0]:
        x, z = x[::-1], z[::-1]
    order = np.argsort(x, kind="stable")
    in_order = bool(np.all(order == np.arange(x.size)))
    place, step = grid.places(path, "x", x[order], factor, repeats=in_order)
    heights = np.full(place[-1] + 1, np.nan)
    heights[place] = z[order]
    return Profile(z=heights, dx=step * factor, name=str(path))


def text(heights: Heights) -> str:
    """Heights as the text of a file that `read` reads back (SI, seven digits)."""
    if isinstance(heights, Profile):
        at = np.arange(heights.z.size) * heights.dx
        head = "# profile: x [m], z [m]"
        body = rows([at, heights.z], [10, 7])
    else:
        head = f"# grid: dx = {heights.dx!r} m, dy = {heights.dy!r} m, z [m]"
        body = rows(heights.z.T, [7] * heights.z.shape[1])
    return "\n".join([head, f"# {MARK}", *body, ""])
