"""Comparison of all published numbers with the computed ones: errors, verdicts, counts, text."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default

from ...common.shown import align_columns
from .computed import load_published_numbers
from .reference import POINT_ROLES, UNTESTED_ROLES, PublishedPoint, compute_trivial_guesses, read_points

_TABLE_HEADINGS = (
    *("paper", "point", "unit", "published", "computed", "error", "tolerance"),
    *("guess", "its error", "nearer", "number", "role", "verdict"),
)
"""Headings of the printed table."""
_MAX_ROUNDING_OVER_TOLERANCE = 1e-6
"""Error over tolerance [1] below which an error is displayed as zero: it is rounding."""


@dataclass(frozen=True, slots=True)
class ValidatedPoint:
    """Published number with the computed value and the verdict.

    computed_value : computed value, in the unit of the published one
    error          : error of the computed value: relative [1], or in the unit of the published number if its
        tolerance is absolute. For a claim: 0 or 1
    has_passed     : whether the error is within the tolerance
    trivial_guess  : trivial guess from calibration points; None: the point has no guess
    guess_error    : error of the trivial guess: relative [1], or in the unit of the published number
    """

    published_point: PublishedPoint
    computed_value: float | bool
    error: float
    has_passed: bool
    trivial_guess: float | None = None
    guess_error: float | None = None

    @property
    def nearer_estimate(self) -> str:
        """Which estimate is nearer to the published value: `law` (computed value) or `guess`.

        Empty without a guess.
        """
        if self.guess_error is None:
            return ""
        return "law" if abs(self.error) < abs(self.guess_error) else "guess"

    @property
    def verdict(self) -> str:
        """Verdict on the point: `pass` or `miss`.

        For a point that tests nothing (a calibration point, for example): `no test`, or `no test, moved` if
        the computed value is outside the tolerance.
        """
        if self.published_point.role in UNTESTED_ROLES:
            return "no test" if self.has_passed else "no test, moved"
        return "pass" if self.has_passed else "miss"

    def to_json(self) -> dict[str, Any]:
        """JSON object of the published number, the computed value, and the verdict as a word."""
        p = self.published_point
        return asdict(p) | {
            "where": dict(p.where),
            "computed": self.computed_value if isfinite(self.computed_value) else None,
            "error": self.error if isfinite(self.error) else None,
            "guess": self.trivial_guess,
            "guess_error": self.guess_error,
            "guess_rule": str(p.guess) if p.guess else None,
            "nearer": self.nearer_estimate or None,
            "verdict": self.verdict,
        }


def compare_point(
    published_point: PublishedPoint, computed_value: float | bool, trivial_guess: float | None = None
) -> ValidatedPoint:
    """Compare a computed value, and the trivial guess if there is one, with the published number."""
    if isinstance(published_point.value, bool):
        error = float(computed_value is not published_point.value)
        return ValidatedPoint(published_point, computed_value, error, error == 0.0)
    error = _compute_point_error(published_point, computed_value)
    guessed = None if trivial_guess is None else _compute_point_error(published_point, trivial_guess)
    return ValidatedPoint(
        published_point,
        computed_value,
        error,
        abs(error) <= published_point.tolerance,
        trivial_guess,
        guessed,
    )


def _compute_point_error(published_point: PublishedPoint, computed_value: float) -> float:
    """Error of a value with respect to a published number.

    The error is relative [1], or, if `point.absolute` is True, in the unit of the published number.
    """
    return (computed_value - published_point.value) / (
        1.0 if published_point.absolute else abs(published_point.value)
    )


def validate_published_numbers(
    parameter_files: Mapping[str, ParameterFile] | None = None,
) -> list[ValidatedPoint]:
    """Compute all published numbers and compare them.

    parameter_files : {joint: parameter file}; joints without an entry have their default file
    """
    given, rows = parameter_files or {}, []
    for kind in KINDS.values():
        own = load_published_numbers(kind)
        for paper in own.paper_names:
            values = (given.get(kind.name) or load_default(kind.name)).values
            observables, known = own.observable_functions, read_points(paper)
            guessed = compute_trivial_guesses(known)
            rows += [
                compare_point(p, observables[p.quantity](values, **p.where), guessed.get(p.id)) for p in known
            ]
    return rows


def select_missed_points(validated_points: Sequence[ValidatedPoint]) -> list[ValidatedPoint]:
    """Published points whose computed value is outside the tolerance.

    Calibration points and points met by construction are left out.
    """
    return [
        row
        for row in validated_points
        if row.published_point.role not in UNTESTED_ROLES and not row.has_passed
    ]


@dataclass(frozen=True, slots=True)
class PublishedPointCounts:
    """Counts of the compared published points by role and verdict; README, report and pages state them.

    The field names are keys of the document that `jointfmu validate --json` writes.

    numbers        : number of published numbers, without claims
    printed        : number of points that the papers print
    derived        : number of points computed from printed numbers
    roles          : {role: number of points}, with claims
    met            : {role: number of points within their tolerance}
    guessed        : {role: number of points with a trivial guess}
    nearer         : {role: number of points to which the law is nearer than the guess}
    contradictions : ids of claims that the equations of the same paper contradict
    missed         : ids of points outside their tolerance, see `select_missed_points`
    """

    numbers: int
    printed: int
    derived: int
    roles: dict[str, int]
    met: dict[str, int]
    guessed: dict[str, int]
    nearer: dict[str, int]
    contradictions: list[str]
    missed: list[str]


def count_points(validated_points: Sequence[ValidatedPoint]) -> PublishedPointCounts:
    """Count the compared points by role and verdict."""
    numbers = [row.published_point for row in validated_points if row.published_point.role != "claim"]
    printed = sum(point.printed for point in numbers)
    guessed = [row for row in validated_points if row.nearer_estimate]

    def count_roles(validated_points: Sequence[ValidatedPoint]) -> dict[str, int]:
        """Number of points of each role."""
        found = Counter(row.published_point.role for row in validated_points)
        return {role: found[role] for role in POINT_ROLES}

    return PublishedPointCounts(
        numbers=len(numbers),
        printed=printed,
        derived=len(numbers) - printed,
        roles=count_roles(validated_points),
        met=count_roles([row for row in validated_points if row.has_passed]),
        guessed=count_roles(guessed),
        nearer=count_roles([row for row in guessed if row.nearer_estimate == "law"]),
        contradictions=[
            row.published_point.id for row in validated_points if row.published_point.text is not None
        ],
        missed=[row.published_point.id for row in select_missed_points(validated_points)],
    )


def format_validation_table(validated_points: Sequence[ValidatedPoint]) -> str:
    """Format the comparison of published with computed numbers as a table in text."""
    return "\n".join(align_columns([_TABLE_HEADINGS, *map(_format_table_row, validated_points)]))


def _format_table_row(validated_point: ValidatedPoint) -> tuple[str, ...]:
    """Format the cells of the table for one published point."""
    p = validated_point.published_point
    if isinstance(p.value, bool):
        shown = (format_claim(validated_point), str(validated_point.computed_value).lower(), "-", "-")
        source = "text"
    else:
        shown = (
            f"{p.value:.6g}",
            f"{validated_point.computed_value:.6g}",
            format_error(p, validated_point.error),
            format_tolerance(p),
        )
        source = "printed" if p.printed else "derived"
    guess = ("-", "-", "-")
    if validated_point.trivial_guess is not None and validated_point.guess_error is not None:
        guess = (
            f"{validated_point.trivial_guess:.6g}",
            format_error(p, validated_point.guess_error),
            validated_point.nearer_estimate,
        )
    return (
        p.paper,
        p.id,
        p.unit,
        *shown,
        *guess,
        source,
        p.role,
        validated_point.verdict.replace("miss", "MISS"),
    )


def format_error(published_point: PublishedPoint, error: float) -> str:
    """Format the error of a computed value: in per cent, or in the unit of the point.

    The unit is used if the tolerance is absolute.
    """
    scale, unit = _choose_error_scale_and_unit(published_point)
    small = abs(error) <= _MAX_ROUNDING_OVER_TOLERANCE * published_point.tolerance
    return ("0" if small else f"{scale * error:+.3g}") + unit


def format_tolerance(published_point: PublishedPoint) -> str:
    """Format the tolerance of a published point: in per cent, or in the unit of the point."""
    scale, unit = _choose_error_scale_and_unit(published_point)
    return f"{scale * published_point.tolerance:.3g}{unit}"


def _choose_error_scale_and_unit(published_point: PublishedPoint) -> tuple[float, str]:
    """Factor and unit text with which errors and tolerances are printed.

    If the published number is in per cent and its tolerance is absolute, the unit is percentage points.
    """
    if not published_point.absolute:
        return 100.0, " %"
    return 1.0, {"%": " points", "1": ""}.get(published_point.unit, f" {published_point.unit}")


def format_claim(validated_point: ValidatedPoint) -> str:
    """Format whether a claim holds; if the paper's equations contradict its text, also what it states."""
    p = validated_point.published_point
    return str(p.value).lower() + ("" if p.text is None else f" (text: {str(p.text).lower()})")


def format_validation_summary(validated_points: Sequence[ValidatedPoint]) -> str:
    """Summary of the comparison in one line.

    The line counts the points of each role, the points to which the law is nearer than a trivial guess, and
    the missed points.
    """
    found = count_points(validated_points)
    roles = ", ".join(
        f"{n} {role}" + ("" if found.met[role] == n else f" ({found.met[role]} met)")
        for role, n in found.roles.items()
        if role != "claim"
    )
    nearer = ", ".join(f"{found.nearer[role]} of {n} ({role})" for role, n in found.guessed.items() if n)
    return (
        f"{found.numbers} numbers, {found.printed} printed in the papers and "
        f"{found.derived} computed from printed ones: {roles}; {found.roles['claim']} claims; "
        f"nearer than the trivial guess: {nearer or 'none'}; "
        f"text against its own equations: {', '.join(found.contradictions) or 'none'}; "
        f"missed: {', '.join(found.missed) or 'none'}"
    )
