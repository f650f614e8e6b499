"""How many published points of which role were compared, and how they came out."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from ..reference import ROLES
from .rows import ValidatedPoint, missed


@dataclass(frozen=True, slots=True)
class Counts:
    """What a comparison consists of; the command, the README, the report and the pages say these numbers.

    numbers, printed, derived : numbers; those that the papers print, those computed from printed ones
    roles, met : points and points met of every role; claims are no numbers
    guessed, nearer : points of every role with a trivial guess, and those that the law is nearer to
    contradictions : ids of claims whose text contradicts its own equations
    missed : ids of the points that miss, calibrated and circular ones left out
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


def counts(rows: Sequence[ValidatedPoint]) -> Counts:
    """Count a comparison."""
    numbers = [row.point for row in rows if row.point.role != "claim"]
    printed = sum(point.printed for point in numbers)
    guessed = [row for row in rows if row.nearer]

    def by_role(some: Sequence[ValidatedPoint]) -> dict[str, int]:
        found = Counter(row.point.role for row in some)
        return {role: found[role] for role in ROLES}

    return Counts(
        numbers=len(numbers),
        printed=printed,
        derived=len(numbers) - printed,
        roles=by_role(rows),
        met=by_role([row for row in rows if row.passed]),
        guessed=by_role(guessed),
        nearer=by_role([row for row in guessed if row.nearer == "law"]),
        contradictions=[row.point.id for row in rows if row.point.text is not None],
        missed=[row.point.id for row in missed(rows)],
    )
