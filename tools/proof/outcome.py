"""What became of the experiments of an FMU."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .manifest import Experiment


@dataclass(frozen=True, slots=True)
class WorstPoint:
    """An output where it is furthest from its reference, measured by what is allowed."""

    output: str
    time: float
    value: float
    reference: float
    allowed: float

    @property
    def error(self) -> float:
        return abs(self.value - self.reference)

    @property
    def finite(self) -> bool:
        return bool(np.isfinite(self.value))

    @property
    def share(self) -> float:
        """The error over what is allowed [1]; infinite if the value is no number."""
        return self.error / self.allowed if self.finite else np.inf

    @property
    def passed(self) -> bool:
        return bool(self.share <= 1.0)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an experiment: the worst point of each output, or an error, or why it was left out.

    interface : of the FMU; empty if it was left out
    """

    experiment: Experiment
    interface: str
    points: Sequence[WorstPoint] = ()
    compared: int = 0
    error: str = ""

    @property
    def name(self) -> str:
        return f"{self.experiment.name}, {self.interface}" if self.interface else self.experiment.name

    @property
    def left_out(self) -> str:
        """Why it was not executed; empty if it was."""
        text = self.experiment.unfit or f"is for {' and '.join(self.experiment.interfaces)}"
        return "" if self.interface else text

    @property
    def worst(self) -> WorstPoint | None:
        return max(self.points, key=lambda point: point.share, default=None)

    @property
    def passed(self) -> bool:
        return not self.error and all(point.passed for point in self.points)


@dataclass(frozen=True, slots=True)
class Proof:
    """All of an FMU.

    interfaces : in which it was run
    starts : start values compared
    differing : a line for each that differs from modelDescription.xml
    """

    fmu: Path
    importer: str
    interfaces: Sequence[str]
    starts: int
    differing: Sequence[str]
    outcomes: Sequence[Outcome]

    @property
    def runs(self) -> int:
        return sum(bool(outcome.interface) for outcome in self.outcomes)

    @property
    def worst(self) -> WorstPoint | None:
        """The output that is furthest off, measured by what is allowed."""
        points = [outcome.worst for outcome in self.outcomes if outcome.worst]
        return max(points, key=lambda point: point.share, default=None)

    @property
    def passed(self) -> bool:
        return not self.misses

    @property
    def misses(self) -> list[str]:
        """A line for everything that failed, of an experiment with its worst output."""
        lines = list(self.differing)
        if self.outcomes and not self.runs:
            lines.append(f"{self.importer} executes none of the experiments")
        for outcome in self.outcomes:
            name = outcome.name
            if outcome.error:
                lines.append(f"{name}: {outcome.error}")
            missed = sorted((p for p in outcome.points if not p.passed), key=lambda p: -p.share)
            if missed:
                worst, *others = missed
                lines.append(
                    f"{name}: {worst.output} = {worst.value:.10g} at {worst.time:g} s, reference "
                    f"{worst.reference:.10g}, off by {worst.error:.2g}, allowed {worst.allowed:.2g}"
                    + (f"; also {', '.join(p.output for p in others)}" if others else "")
                )
        return lines
