"""Every published number beside the computed one."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

from ...joints import KINDS
from ...joints.published import published
from ...parameters import ParameterFile, default
from ..reference import PROVES_NOTHING, Point, guesses, points


@dataclass(frozen=True, slots=True)
class ValidatedPoint:
    """A published point, the computed value, and the verdict.

    error : relative to the published value, or in its unit where the tolerance is absolute; 0 or 1
        for a claim
    guess, guess_error : the trivial guess, from calibration points alone, and its error; None where
        there is none
    """

    point: Point
    computed: float | bool
    error: float
    passed: bool
    guess: float | None = None
    guess_error: float | None = None

    @property
    def nearer(self) -> str:
        """`law` or `guess`, which is nearer to the published value; empty without a guess."""
        if self.guess_error is None:
            return ""
        return "law" if abs(self.error) < abs(self.guess_error) else "guess"

    def as_dict(self) -> dict[str, Any]:
        """JSON-ready, with the verdict as a word."""
        p = self.point
        return asdict(p) | {
            "where": dict(p.where),
            "computed": self.computed if isfinite(self.computed) else None,
            "error": self.error if isfinite(self.error) else None,
            "guess": self.guess,
            "guess_error": self.guess_error,
            "guess_rule": str(p.guess) if p.guess else None,
            "nearer": self.nearer or None,
            "verdict": "pass" if self.passed else "miss",
        }


def compare(point: Point, computed: float | bool, guess: float | None = None) -> ValidatedPoint:
    """Judge one computed value, and the trivial guess beside it."""
    if isinstance(point.value, bool):
        error = float(computed is not point.value)
        return ValidatedPoint(point, computed, error, error == 0.0)
    error = _error(point, computed)
    guessed = None if guess is None else _error(point, guess)
    return ValidatedPoint(point, computed, error, abs(error) <= point.tolerance, guess, guessed)


def _error(point: Point, value: float) -> float:
    return (value - point.value) / (1.0 if point.absolute else abs(point.value))


def validate(sets: Mapping[str, ParameterFile] | None = None) -> list[ValidatedPoint]:
    """Compute every published point with the default parameter sets, or those given by joint."""
    given, rows = sets or {}, []
    for kind in KINDS.values():
        for paper in kind.papers:
            values = (given.get(kind.name) or default(kind.name)).values
            observables = published(kind).observables
            known = points(paper)
            guessed = guesses(known)
            rows += [compare(p, observables[p.quantity](values, **p.where), guessed.get(p.id)) for p in known]
    return rows


def missed(rows: Sequence[ValidatedPoint]) -> list[ValidatedPoint]:
    """Rows that miss, but for those whose value proves nothing: calibrated and circular ones."""
    return [row for row in rows if row.point.role not in PROVES_NOTHING and not row.passed]
