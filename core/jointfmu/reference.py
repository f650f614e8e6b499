"""Published numbers: models/reference/*.toml."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

ROLES = ("calibration", "validation")
CALIBRATION_TOLERANCE = 1e-6
"""Relative miss of a calibration point [1]: the fits are exact, this leaves room for rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """One published number, claim or condition.

    quantity, where : what is computed and its arguments (SI)
    value : number in `unit`, or the truth of a claim
    role  : `calibration` fixes unpublished parameters, `validation` is predicted
    tolerance : relative; absolute in `unit` where `absolute`
    prediction : whether a joint's behaviour is predicted, rather than a constant or a claim checked
    text : what the paper's text claims, where its own equations give the opposite
    """

    paper: str
    joint: str
    id: str
    quantity: str
    where: Mapping[str, Any]
    value: float | bool
    unit: str
    place: str
    role: str
    tolerance: float = CALIBRATION_TOLERANCE
    absolute: bool = False
    basis: str = field(default="fitted")
    prediction: bool = False
    text: bool | None = None

    def __post_init__(self) -> None:
        if self.role not in ROLES:
            raise ValueError(f"{self.paper}: {self.id}: role = {self.role!r}, allowed are {', '.join(ROLES)}")


def points(paper: str) -> list[Point]:
    """All points of a paper, in the order of its file."""
    text = (files("jointfmu_models") / "reference" / f"{paper}.toml").read_text(encoding="utf-8")
    document = tomllib.loads(text)
    return [Point(paper=paper, joint=document["joint"], **entry) for entry in document["point"]]
