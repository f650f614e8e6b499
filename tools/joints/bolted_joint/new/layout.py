"""Number, thread and positions of the bolts of a drawing."""

import re
from collections.abc import Sequence

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.units import conversion_factor

from ....inputs.drawing.part import DrawingOptions
from ....inputs.drawing.quantities import parse_quantity_value, parse_quantity_values
from ....inputs.drawing.tables import Thread, find_thread

_BOLT_COUNT_AND_THREAD_PATTERN = re.compile(
    r"(?:(\d+)\s*x\s*)?(M\d+)(?:\s*x\s*(\d+(?:\.\d+)?))?", re.IGNORECASE
)
"""Pattern of number and thread of bolts, as in 4xM12x1.25."""
_GRID_PATTERN = re.compile(r"(\d+)x(\d+)")
"""Pattern of a bolt grid, as in 2x3."""


def parse_bolts(bolts_text: str) -> tuple[int, Thread]:
    """Parse number and thread of the bolts, as in 4xM12 or, with a fine pitch, 4xM12x1.25.

    Raises ValueError for bad text or an unknown thread.
    """
    match = _BOLT_COUNT_AND_THREAD_PATTERN.fullmatch(bolts_text.strip())
    if not match or match[1] == "0":
        raise ValueError(
            f"--bolts = {bolts_text!r} are no bolts; expected a number and a thread, as in 4xM12"
        )
    pitch = float(match[3]) * conversion_factor("mm", "m") if match[3] else None
    try:
        return int(match[1] or 1), find_thread(match[2].upper(), pitch)
    except ValueError as error:
        raise ValueError(f"--bolts = {bolts_text!r}: {error}") from None


def bolt_positions(drawing_options: DrawingOptions, bolt_count: int) -> Array:
    """Positions (count, 2) [m] of the bolts relative to the middle of the plate.

    Raises ValueError with a one-line message if the options do not give `bolt_count` positions.
    """
    texts, circle = drawing_options["at"], drawing_options["circle"]
    if texts and circle:
        raise ValueError("--at with --circle: expected one of them")
    if drawing_options["grid"] and not (texts and "," not in texts[0]):
        raise ValueError(
            f"--grid = {drawing_options['grid']!r} needs the distances of the outermost bolts, --at LxW"
        )
    if circle:
        radius = 0.5 * parse_quantity_value("circle", circle)
        angle = 2.0 * np.pi * (np.arange(bolt_count) + 0.5) / bolt_count
        return radius * np.column_stack([np.cos(angle), np.sin(angle)])
    if not texts:
        if bolt_count == 1:
            return np.zeros((1, 2))
        raise ValueError(f"the positions of {bolt_count} bolts are missing; expected --at or --circle")
    if any("," in text and "x" in text for text in texts):
        raise ValueError(
            f"--at = {' '.join(texts)!r} has x and comma; write LxW with decimal points, as in 160.5x60"
        )
    if "," in texts[0]:
        return _parse_positions(texts, bolt_count)
    if len(texts) > 1:
        raise ValueError(f"--at = {' '.join(texts)!r}: expected one LxW, or the position X,Y of each bolt")
    spans = parse_quantity_values("at", texts[0], number_separator="x", expected_value_count=2)
    return _grid_positions(spans, bolt_count, drawing_options["grid"])


def _parse_positions(position_texts: Sequence[str], bolt_count: int) -> Array:
    """Parse positions X,Y of bolts in mm: (count, 2) [m]."""
    places = [
        parse_quantity_values("at", text, number_separator=",", expected_value_count=2)
        for text in position_texts
    ]
    if len(places) != bolt_count:
        raise ValueError(f"--at has {len(places)} positions, expected {bolt_count}: one for each of --bolts")
    return np.array(places)


def _grid_positions(grid_side_lengths: Sequence[float], bolt_count: int, grid_text: str | None) -> Array:
    """Positions (count, 2) [m] of bolts on a rectangular grid: on the full grid, or on its rim only."""
    if min(grid_side_lengths) < 0.0:
        raise ValueError(
            f"--at = {min(grid_side_lengths):g} m is outside [0, inf): distance of the outermost bolts"
        )
    if bolt_count == 1 and max(grid_side_lengths) > 0.0:
        raise ValueError("--at LxW for one bolt: expected the number of --bolts, as in 4xM12")
    columns, rows = _grid_size(grid_side_lengths, bolt_count, grid_text)
    x, y = (
        0.5 * span * (np.linspace(-1.0, 1.0, n) if n > 1 else np.zeros(1))
        for span, n in zip(grid_side_lengths, (columns, rows), strict=True)
    )
    i, j = (index.ravel() for index in np.meshgrid(np.arange(columns), np.arange(rows)))
    if bolt_count != columns * rows:
        rim = (i % (columns - 1) == 0) | (j % (rows - 1) == 0)
        i, j = i[rim], j[rim]
    return np.column_stack([x[i], y[j]])


def _grid_size(grid_side_lengths: Sequence[float], bolt_count: int, grid_text: str | None) -> tuple[int, int]:
    """Number of bolts of a rectangular grid along x and along y."""
    if grid_text:
        match = _GRID_PATTERN.fullmatch(grid_text)
        if not match or 0 in (sizes := (int(match[1]), int(match[2]))):
            raise ValueError(
                f"--grid = {grid_text!r} is not a grid; expected the bolts along x and y, as in 3x2"
            )
        columns, rows = sizes
        rim = 2 * (columns + rows) - 4 if min(sizes) > 2 else columns * rows
        if bolt_count not in (columns * rows, rim):
            allowed = f"{columns * rows}" + (f" or, on its rim, {rim}" if rim != columns * rows else "")
            raise ValueError(f"--grid = {grid_text} has {allowed} bolts, but --bolts states {bolt_count}")
    elif grid_side_lengths[1] == 0.0:
        columns, rows = bolt_count, 1
    elif grid_side_lengths[0] == 0.0:
        columns, rows = 1, bolt_count
    elif bolt_count == 4:
        columns, rows = 2, 2
    else:
        raise ValueError(
            f"{bolt_count} bolts fit --at LxW in several ways; state --grid, the bolts along x and y, as in "
            "3x2"
        )
    for n, span, axis in ((columns, grid_side_lengths[0], "x"), (rows, grid_side_lengths[1], "y")):
        if n > 1 and span == 0.0:
            raise ValueError(f"--at: {n} bolts along {axis} need a distance above 0 there")
    return columns, rows
