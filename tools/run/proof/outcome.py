"""Results of the experiments of an FMU: comparison with the reference results, errors, exclusions."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .manifest import Experiment


@dataclass(frozen=True, slots=True)
class WorstPoint:
    """Point of an output with the largest ratio of error to tolerance.

    time             : [s]
    value, reference : computed and reference value of the output
    tolerance        : allowed absolute error
    """

    output: str
    time: float
    value: float
    reference: float
    tolerance: float

    @property
    def error(self) -> float:
        """Absolute error."""
        return abs(self.value - self.reference)

    @property
    def is_finite(self) -> bool:
        return bool(np.isfinite(self.value))

    @property
    def error_ratio(self) -> float:
        """Error over tolerance [1]; infinite if the value is not finite."""
        return self.error / self.tolerance if self.is_finite else np.inf

    @property
    def is_within_tolerance(self) -> bool:
        return bool(self.error_ratio <= 1.0)


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of an experiment: the worst point of each output, or an error.

    interface : FMI interface in which the experiment was executed; empty if it was not executed
    points    : worst point of each output
    compared_points : number of compared times
    error     : error message; empty if none occurred
    """

    experiment: Experiment
    interface: str
    points: Sequence[WorstPoint] = ()
    compared_points: int = 0
    error: str = ""

    @property
    def name(self) -> str:
        """Name of the experiment, and interface if it was executed."""
        return f"{self.experiment.name}, {self.interface}" if self.interface else self.experiment.name

    @property
    def exclusion_reason(self) -> str:
        """Why the experiment was not executed; empty if it was."""
        text = self.experiment.unsupported_reason or f"is for {' and '.join(self.experiment.interfaces)}"
        return "" if self.interface else text

    @property
    def worst(self) -> WorstPoint | None:
        """Worst point of all outputs; None if nothing was compared."""
        return max(self.points, key=lambda point: point.error_ratio, default=None)

    @property
    def has_passed(self) -> bool:
        """Whether there is no error and all outputs are within their tolerance."""
        return not self.error and all(point.is_within_tolerance for point in self.points)


@dataclass(frozen=True, slots=True)
class Proof:
    """Result of all experiments of an FMU.

    importer   : name of the importer
    interfaces : FMI interfaces in which experiments were executed
    compared_starts : number of compared start values
    start_differences : a line for each start value that differs from modelDescription.xml or from
        `ExpectedContents`
    outcomes   : outcomes of the experiments, for each interface
    """

    fmu: Path
    importer: str
    interfaces: Sequence[str]
    compared_starts: int
    start_differences: Sequence[str]
    outcomes: Sequence[Outcome]

    @property
    def run_count(self) -> int:
        """Number of executed experiments, counted for each interface."""
        return sum(bool(outcome.interface) for outcome in self.outcomes)

    @property
    def worst(self) -> WorstPoint | None:
        """Point with the largest error over tolerance, of all outcomes; None if nothing was compared."""
        points = [outcome.worst for outcome in self.outcomes if outcome.worst]
        return max(points, key=lambda point: point.error_ratio, default=None)

    @property
    def has_passed(self) -> bool:
        return not self.failures

    @property
    def failures(self) -> list[str]:
        """Failures, one line each: start values, errors, experiments with their worst output."""
        lines = list(self.start_differences)
        if self.outcomes and not self.run_count:
            lines.append(f"{self.importer} executes none of the experiments")
        for outcome in self.outcomes:
            name = outcome.name
            if outcome.error:
                lines.append(f"{name}: {outcome.error}")
            missed = sorted(
                (p for p in outcome.points if not p.is_within_tolerance), key=lambda p: -p.error_ratio
            )
            if missed:
                worst, *others = missed  # sorted by error over tolerance
                lines.append(
                    f"{name}: {worst.output} = {worst.value:.10g} at {worst.time:g} s, reference "
                    f"{worst.reference:.10g}, off by {worst.error:.2g}, allowed {worst.tolerance:.2g}"
                    + (f"; also {', '.join(p.output for p in others)}" if others else "")
                )
        return lines
