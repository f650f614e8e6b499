"""The comparison as text."""

from collections.abc import Sequence

from ..reference import Point
from .count import counts
from .rows import ValidatedPoint

_HEAD = (
    *("paper", "point", "unit", "published", "computed", "error", "tolerance"),
    *("guess", "its error", "nearer", "number", "role", "verdict"),
)
_ROUNDING = 1e-6
"""An error below this share of the tolerance is shown as zero [1]: calibrated points are met to rounding."""


def table(rows: Sequence[ValidatedPoint]) -> str:
    """The comparison as text."""
    lines = [_HEAD, *(_cells(row) for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(_HEAD))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )


def _cells(row: ValidatedPoint) -> tuple[str, ...]:
    p = row.point
    if isinstance(p.value, bool):
        shown = (shown_claim(row), str(row.computed).lower(), "-", "-")
        source = "text"
    else:
        shown = (f"{p.value:.6g}", f"{row.computed:.6g}", shown_error(p, row.error), shown_tolerance(p))
        source = "printed" if p.printed else "derived"
    guess = ("-", "-", "-")
    if row.guess is not None and row.guess_error is not None:
        guess = (f"{row.guess:.6g}", shown_error(p, row.guess_error), row.nearer)
    return (p.paper, p.id, p.unit, *shown, *guess, source, p.role, "pass" if row.passed else "MISS")


def shown_error(point: Point, error: float) -> str:
    """An error as text: in per cent, or in the point's unit where that is how it is judged."""
    scale, unit = _scale(point)
    small = abs(error) <= _ROUNDING * point.tolerance
    return ("0" if small else f"{scale * error:+.3g}") + unit


def shown_tolerance(point: Point) -> str:
    """A tolerance as text, as `shown_error`."""
    scale, unit = _scale(point)
    return f"{scale * point.tolerance:.3g}{unit}"


def _scale(point: Point) -> tuple[float, str]:
    """Factor and unit of errors; a change given in per cent is off by percentage points."""
    if not point.absolute:
        return 100.0, " %"
    return 1.0, {"%": " points", "1": ""}.get(point.unit, f" {point.unit}")


def shown_claim(row: ValidatedPoint) -> str:
    """A claim as text, with the text's own where its equations give the opposite."""
    p = row.point
    return str(p.value).lower() + ("" if p.text is None else f" (text: {str(p.text).lower()})")


def summary(rows: Sequence[ValidatedPoint]) -> str:
    """One line: what was compared, by role; how often the law beats a trivial guess; what missed."""
    found = counts(rows)
    roles = ", ".join(
        f"{n} {role}" + ("" if found.met[role] == n else f" ({found.met[role]} met)")
        for role, n in found.roles.items()
        if role != "claim"
    )
    nearer = ", ".join(f"{found.nearer[role]} of {n} ({role})" for role, n in found.guessed.items() if n)
    return (
        f"{found.numbers} numbers, {found.printed} printed in the papers and {found.derived} computed from "
        f"printed ones: {roles}; {found.roles['claim']} claims; "
        f"nearer than the trivial guess: {nearer or 'none'}; "
        f"text against its own equations: {', '.join(found.contradictions) or 'none'}; "
        f"missed: {', '.join(found.missed) or 'none'}"
    )
