"""How far to believe a stiffness: its level beside the roughness, and where the interface law ends.

Every command that reports a stiffness says it, by `judge` at pressures; a joint at loads is judged by its
pressure, in `jointfmu_tools`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.contact.interface import InterfaceLaw, beyond, stiffness_curve
from jointfmu.contact.roughness import GAMMA, ROUGHEST, height, level
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Number

FACTOR = 3.0
"""Ratio to p/(GAMMA h), either way, beyond which a law's level is doubtful [1] (docs/validity.md)."""


@dataclass(frozen=True, slots=True)
class Level:
    """Stiffness of an interface law beside p/(GAMMA h).

    h         : [m] rms height of both surfaces together
    pressure  : (n) [Pa] > 0
    stiffness : (n) [N/m3] of the law, per area, as the joint takes it
    """

    h: float
    pressure: Array
    stiffness: Array

    @property
    def ratio(self) -> Array:
        """Stiffness over p/(GAMMA h) (n) [1]."""
        return np.asarray(self.stiffness / level(self.pressure, self.h))

    @property
    def doubtful(self) -> bool:
        """Whether the ratio is beyond FACTOR at any of the pressures."""
        return bool(np.any((self.ratio > FACTOR) | (self.ratio < 1.0 / FACTOR)))

    def __str__(self) -> str:
        at = f"at {_span(self.pressure / 1e6)} MPa, h = {1e6 * self.h:.3g} um"
        return f"the law's K is {_span(self.ratio)} times p/({GAMMA:g} h) {at}"

    def document(self) -> dict[str, Any]:
        """As one JSON object."""
        columns = (self.pressure, self.stiffness, level(self.pressure, self.h), self.ratio)
        names = ("pressure", "stiffness", "expected", "ratio")
        points = [dict(zip(names, map(float, row), strict=True)) for row in zip(*columns, strict=True)]
        return {"h": self.h, "gamma": GAMMA, "points": points}


@dataclass(frozen=True, slots=True)
class Judgement:
    """What is to be said beside a stiffness; `level` is None where no roughness is known."""

    level: Level | None
    warnings: tuple[str, ...]

    def lines(self) -> Iterator[str]:
        """For people, without the warnings."""
        if self.level is not None:
            yield str(self.level)

    def with_warnings(self, more: Sequence[str]) -> "Judgement":
        """The same with further warnings, which come first."""
        return Judgement(self.level, (*more, *self.warnings))

    def document(self) -> dict[str, Any]:
        """{"level": ... or null, "warnings": [...]} for JSON."""
        return {"level": self.level and self.level.document(), "warnings": list(self.warnings)}


def known_height(file: ParameterFile) -> float | None:
    """Rms height h [m] of both surfaces together: of the law, else stated beside it; or None."""
    own = law_height(KINDS[file.joint].law_of(file.values))
    return height(file.roughness) if own is None else own


def judge(
    law: InterfaceLaw,
    pressures: Sequence[float],
    h: float | None,
    peak: float = 0.0,
    scale: Sequence[float] | float = 1.0,
    limits: bool = True,
) -> Judgement:
    """The judgement of an interface law at nominal pressures [Pa]; those of zero do not count.

    h      : [m] of both surfaces together, None if it is not known
    scale  : the joint's stiffness over the interface law's [1], at each pressure or the same
    peak   : [Pa] greatest pressure, where the mean ones are given
    limits : whether to say where the law ends
    """
    every = np.asarray(pressures, dtype=np.float64)
    pressed = (every > 0.0) & (every < np.inf)
    p, factor = every[pressed], np.broadcast_to(scale, every.shape)[pressed]
    found = None
    if h is not None and p.size:
        found = Level(h, p, factor * stiffness_curve(law, p)[0])
    greatest = float(np.max(p, initial=peak))
    least = float(np.min(p, initial=greatest))
    warnings = beyond(law, greatest, least) if limits and greatest > 0.0 else []
    if h is not None and h > 2.0 * ROUGHEST:
        warnings.insert(
            0, f"h = {h:.3g} m is no roughness: faces that are joined have up to {ROUGHEST:g} m each"
        )
    if found is not None and found.doubtful:
        warnings.append(
            f"the law's K is {_span(found.ratio)} times that of the roughness, K/A_0 = p/({GAMMA:g} h) with "
            f"h = {1e6 * found.h:.3g} um: beyond a factor of {FACTOR:g} a measurement decides, and without "
            "one believe the roughness (docs/validity.md)"
        )
    return Judgement(found, tuple(warnings))


def law_height(law: InterfaceLaw) -> Number | None:
    """h [m] of an interface law that has it; else None."""
    return getattr(law, "h", None)


def _span(values: Array) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    return f"{low:.3g}" if f"{low:.3g}" == f"{high:.3g}" else f"{low:.3g} to {high:.3g}"
