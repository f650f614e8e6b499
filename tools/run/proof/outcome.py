"""Results of the experiments of an FMU: comparison with the reference results, errors, exclusions."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .manifest import Experiment


@dataclass(frozen=True, slots=True)
class WorstPoint:
    """Point in time at which an output of an FMU is worst: largest ratio of error to tolerance.

    time                            : [s]
    computed_value, reference_value : computed and reference value of the output
    tolerance                       : allowed absolute error
    """

    output: str
    time: float
    computed_value: float
    reference_value: float
    tolerance: float

    @property
    def absolute_error(self) -> float:
        """Absolute error of the output at this point."""
        return abs(self.computed_value - self.reference_value)

    @property
    def is_finite(self) -> bool:
        """Whether the computed value is finite."""
        return bool(np.isfinite(self.computed_value))

    @property
    def error_ratio(self) -> float:
        """Error over tolerance [1]; infinite if the value is not finite."""
        return self.absolute_error / self.tolerance if self.is_finite else np.inf

    @property
    def is_within_tolerance(self) -> bool:
        """Whether the error of the output is at most its tolerance."""
        return bool(self.error_ratio <= 1.0)


@dataclass(frozen=True, slots=True)
class ExperimentOutcome:
    """Outcome of an experiment with an FMU: the worst point of each output, or an error.

    interface : FMI interface in which the experiment was executed; empty if it was not executed
    worst_points    : worst point of each output
    compared_time_count : number of compared times
    error_message : error message; empty if none occurred
    """

    experiment: Experiment
    interface: str
    worst_points: Sequence[WorstPoint] = ()
    compared_time_count: int = 0
    error_message: str = ""

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
    def worst_point(self) -> WorstPoint | None:
        """Point with the largest error over tolerance, of all outputs of the experiment.

        None if nothing was compared.
        """
        return max(self.worst_points, key=lambda point: point.error_ratio, default=None)

    @property
    def has_passed(self) -> bool:
        """Whether there is no error and all outputs are within their tolerance."""
        return not self.error_message and all(point.is_within_tolerance for point in self.worst_points)


@dataclass(frozen=True, slots=True)
class Proof:
    """Proof of an FMU: results of all its experiments in an importer, compared with references.

    importer   : name of the importer
    interfaces : FMI interfaces in which experiments were executed
    compared_start_value_count : number of compared start values
    start_value_differences : a line for each start value that differs from modelDescription.xml or from
        `ExpectedFmuContents`
    outcomes   : outcomes of the experiments, for each interface
    """

    fmu: Path
    importer: str
    interfaces: Sequence[str]
    compared_start_value_count: int
    start_value_differences: Sequence[str]
    outcomes: Sequence[ExperimentOutcome]

    @property
    def executed_experiment_count(self) -> int:
        """Number of executed experiments, counted for each interface."""
        return sum(bool(outcome.interface) for outcome in self.outcomes)

    @property
    def worst_point(self) -> WorstPoint | None:
        """Point with the largest error over tolerance, of all experiments of the FMU.

        None if nothing was compared.
        """
        points = [outcome.worst_point for outcome in self.outcomes if outcome.worst_point]
        return max(points, key=lambda point: point.error_ratio, default=None)

    @property
    def has_passed(self) -> bool:
        """Whether all experiments agree with their references, and start values with the expected ones."""
        return not self.failures

    @property
    def failures(self) -> list[str]:
        """Failures of the proof, one line each: start values, errors, experiments with their worst output."""
        lines = list(self.start_value_differences)
        if self.outcomes and not self.executed_experiment_count:
            lines.append(f"{self.importer} executes none of the experiments")
        for outcome in self.outcomes:
            name = outcome.name
            if outcome.error_message:
                lines.append(f"{name}: {outcome.error_message}")
            missed = sorted(
                (p for p in outcome.worst_points if not p.is_within_tolerance), key=lambda p: -p.error_ratio
            )
            if missed:
                worst, *others = missed  # sorted by error over tolerance
                lines.append(
                    f"{name}: {worst.output} = {worst.computed_value:.10g} at {worst.time:g} s, reference "
                    f"{worst.reference_value:.10g}, off by {worst.absolute_error:.2g}, allowed "
                    f"{worst.tolerance:.2g}"
                    + (f"; also {', '.join(p.output for p in others)}" if others else "")
                )
        return lines
