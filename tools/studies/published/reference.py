"""Published numbers of papers, read from models/reference/*.toml, and trivial guesses of them."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

import numpy as np

POINT_ROLES = {
    "calibration": "used for calibration",
    "circular": "met by construction",
    "contradiction": "two numbers of the paper that do not agree",
    "constant": "constant of the paper, computed again",
    "self-check": "computed by hand from the paper",
    "interpolation": "between calibrated points",
    "prediction": "predicted",
    "claim": "claim of the text",
}
"""{role of a published number in the comparison: meaning}.

Numbers used for calibration, met by construction (circular), or in contradiction with another number of the
paper are no test of the model.
"""
UNTESTED_ROLES = ("calibration", "circular", "contradiction")
"""Roles of numbers that are no test of the model."""
ROLES_WITH_TRIVIAL_GUESS = ("interpolation", "prediction")
"""Roles of numbers that are also compared with a trivial guess."""
CALIBRATION_TOLERANCE = 1e-6
"""Relative tolerance of a calibration point [1]: the fits are exact apart from rounding."""

_POINTS_PER_GUESS_RULE = {"constant": 1, "power law": 2, "offset": 3, "proportion": 3, "growth": 3}
"""Number of calibration points that each rule of a trivial guess needs: {rule: number}."""
_POWER_LAW_GUESS_RULES = ("power law", "growth")
"""Rules of a trivial guess that use a power law of an argument."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrivialGuess:
    """Trivial guess of a published number from calibration points a, b, c, without the model.

    rule   : `constant`: a; `power law` through a and b; `offset`: a + b - c; `proportion`: a b/c; `growth`:
        from a, with the exponent of the power law from b to c
    points : ids of a, b, c; for a point that is no calibration point, its own guess is used
    over   : argument of the power law, a key of `PublishedPoint.where`; empty for other rules
    """

    rule: str
    points: Sequence[str]
    over: str = ""

    def __post_init__(self) -> None:
        if self.rule not in _POINTS_PER_GUESS_RULE:
            raise ValueError(f"guess: rule = {self.rule!r}, allowed are {', '.join(_POINTS_PER_GUESS_RULE)}")
        if len(self.points) != _POINTS_PER_GUESS_RULE[self.rule]:
            raise ValueError(
                f"guess: {len(self.points)} points, expected {_POINTS_PER_GUESS_RULE[self.rule]} for the "
                f"rule {self.rule}"
            )
        if bool(self.over) != (self.rule in _POWER_LAW_GUESS_RULES):
            raise ValueError(
                f"guess: over = {self.over!r}, expected {'a name' if not self.over else 'none'} for the "
                f"rule {self.rule}"
            )

    def __str__(self) -> str:
        names = list(self.points)
        if self.rule == "power law":
            return f"power law over {self.over} through {names[0]}, {names[1]}"
        if self.rule == "growth":
            return f"{names[0]}, with the power of {self.over} from {names[1]} to {names[2]}"
        if self.rule == "constant":
            return f"as {names[0]}"
        signs = ("+", "-") if self.rule == "offset" else ("*", "/")
        return f"{names[0]} {signs[0]} {names[1]} {signs[1]} {names[2]}"


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedPoint:
    """Number that a paper publishes, or claim of the paper, to compare with the computed one.

    quantity  : name of the computed quantity, a key of `PublishedNumbers.observable_functions`
    where     : {argument of the quantity: value [SI]}
    value     : published number in `unit`; True or False for a claim
    place     : equation, table or figure in the paper
    printed   : whether the paper prints the number or states the claim; otherwise the value was computed from
        printed numbers
    role      : use of the number in the comparison, one of POINT_ROLES
    tolerance : allowed error, relative, or absolute in `unit` if `absolute` is True
    basis     : origin of the tolerance
    guess     : trivial guess to compare with an interpolation or a prediction
    text      : claim in the text of the paper, if the equations of the paper contradict it
    """

    paper: str
    joint: str
    id: str
    quantity: str
    where: Mapping[str, Any]
    value: float | bool
    unit: str
    place: str
    printed: bool
    role: str
    tolerance: float = CALIBRATION_TOLERANCE
    absolute: bool = False
    basis: str = field(default="fitted")
    guess: TrivialGuess | None = None
    text: bool | None = None

    def __post_init__(self) -> None:
        where = f"{self.paper}: {self.id}"
        if self.role not in POINT_ROLES:
            raise ValueError(f"{where}: role = {self.role!r}, allowed are {', '.join(POINT_ROLES)}")
        if (self.role == "claim") != isinstance(self.value, bool):
            raise ValueError(
                f"{where}: role = {self.role!r} with value = {self.value!r}; expected true or false for role "
                "= 'claim', a number for other roles"
            )
        if self.guess and self.role not in ROLES_WITH_TRIVIAL_GUESS:
            raise ValueError(
                f"{where}: role = {self.role!r} has a guess, "
                f"allowed are {', '.join(ROLES_WITH_TRIVIAL_GUESS)}"
            )


def read_points(paper: str) -> list[PublishedPoint]:
    """Read the published numbers of a paper, in the order of its file."""
    text = (files("jointfmu_models") / "reference" / f"{paper}.toml").read_text(encoding="utf-8")
    document = tomllib.loads(text)
    return [_make_point(paper, document["joint"], entry) for entry in document["point"]]


def _make_point(paper: str, joint: str, point_entry: dict[str, Any]) -> PublishedPoint:
    """Make the published number from its entry in the file of a paper."""
    guess = {"guess": TrivialGuess(**point_entry["guess"])} if "guess" in point_entry else {}
    return PublishedPoint(paper=paper, joint=joint, **(point_entry | guess))


def compute_trivial_guesses(published_points: Sequence[PublishedPoint]) -> dict[str, float]:
    """Trivial guesses of the published numbers of one paper, from calibration points: {id: guess}.

    Raises ValueError if a guess names a point that is no calibration point and has no guess.
    """
    known = {p.id: p for p in published_points}

    def find_point_value(point_id: str, requesting_ids: tuple[str, ...]) -> float:
        """Value of a calibration point, or the guess of another point."""
        point = known.get(point_id)
        if point is not None and point.role == "calibration":
            return float(point.value)
        if point is None or point.guess is None or point_id in requesting_ids:
            raise ValueError(
                f"{requesting_ids[-1]}: guess from {point_id!r}, allowed are calibration points and guesses"
            )
        return evaluate_trivial_guess(point, point.guess, (*requesting_ids, point_id))

    def evaluate_trivial_guess(
        published_point: PublishedPoint, trivial_guess: TrivialGuess, requesting_ids: tuple[str, ...]
    ) -> float:
        """Trivial guess of a published number by a rule, for example the power law through two points."""
        a, *more = (find_point_value(name, requesting_ids) for name in trivial_guess.points)
        if trivial_guess.rule in _POWER_LAW_GUESS_RULES:
            x, x_a, *others = (
                p.where[trivial_guess.over]
                for p in (published_point, *(known[name] for name in trivial_guess.points))
            )
            (y, z), (x_y, x_z) = (a, *more)[-2:], (x_a, *others)[-2:]
            power = np.log(z / y) / np.log(x_z / x_y)
            return float(a * (x / x_a) ** power)
        if trivial_guess.rule == "offset":
            return a + more[0] - more[1]
        return a * more[0] / more[1] if trivial_guess.rule == "proportion" else a

    return {p.id: evaluate_trivial_guess(p, p.guess, (p.id,)) for p in published_points if p.guess}
