"""Results of the experiments of an FMU: comparison with the reference results, errors, exclusions."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .manifest import Experiment


@dataclass(frozen=True, slots=True)
class WorstPoint:
    """Point in time at which an output of an FMU deviates most from its reference, relative to tolerance.

    time_of_point                   : [s]
    computed_value, reference_value : values of the output at this time
    absolute_tolerance              : allowed absolute difference of both
    """

    output_name: str
    time_of_point: float
    computed_value: float
    reference_value: float
    absolute_tolerance: float

    @property
    def absolute_error(self) -> float:
        """Absolute difference of computed and reference value of the output at the worst point."""
        return abs(self.computed_value - self.reference_value)

    @property
    def is_finite(self) -> bool:
        """Whether the computed value of the output at the worst point is finite."""
        return bool(np.isfinite(self.computed_value))

    @property
    def error_over_tolerance(self) -> float:
        """Absolute error of the output divided by its tolerance [1]; infinite if the value is not finite."""
        return self.absolute_error / self.absolute_tolerance if self.is_finite else np.inf

    @property
    def is_within_tolerance(self) -> bool:
        """Whether the error of the output at the worst point is at most its tolerance."""
        return bool(self.error_over_tolerance <= 1.0)


@dataclass(frozen=True, slots=True)
class ExperimentOutcome:
    """Outcome of an experiment with an FMU: the worst point of each output, or an error.

    fmi_interface       : FMI interface in which the experiment was executed; empty if it was not executed
    worst_points        : worst point of each output
    compared_time_count : number of compared times
    error_message       : error message; empty if none occurred
    """

    experiment: Experiment
    fmi_interface: str
    worst_points: Sequence[WorstPoint] = ()
    compared_time_count: int = 0
    error_message: str = ""

    @property
    def experiment_label(self) -> str:
        """Name of the experiment, and the FMI interface in which it was executed."""
        return (
            f"{self.experiment.experiment_name}, {self.fmi_interface}"
            if self.fmi_interface
            else self.experiment.experiment_name
        )

    @property
    def exclusion_reason(self) -> str:
        """Why the experiment was not executed; empty if it was."""
        text = self.experiment.unsupported_reason or f"is for {' and '.join(self.experiment.fmi_interfaces)}"
        return "" if self.fmi_interface else text

    @property
    def worst_point(self) -> WorstPoint | None:
        """Point with the largest ratio of error to tolerance, of all outputs of the experiment.

        None if nothing was compared.
        """
        return max(self.worst_points, key=lambda point: point.error_over_tolerance, default=None)

    @property
    def has_passed(self) -> bool:
        """Whether the experiment ended without an error, with all outputs within their tolerances."""
        return not self.error_message and all(point.is_within_tolerance for point in self.worst_points)


@dataclass(frozen=True, slots=True)
class ProofResult:
    """Proof of an FMU: results of all its experiments in an importer, compared with references.

    importer_name              : name of the importer
    executed_interfaces        : FMI interfaces in which experiments were executed
    compared_start_value_count : number of compared start values
    start_value_differences    : a line for each start value that differs from modelDescription.xml or from
        `ExpectedFmuContents`
    experiment_outcomes        : outcomes of the experiments, for each interface
    """

    fmu_path: Path
    importer_name: str
    executed_interfaces: Sequence[str]
    compared_start_value_count: int
    start_value_differences: Sequence[str]
    experiment_outcomes: Sequence[ExperimentOutcome]

    @property
    def executed_experiment_count(self) -> int:
        """Number of executed experiments; an experiment in both FMI interfaces counts twice."""
        return sum(bool(outcome.fmi_interface) for outcome in self.experiment_outcomes)

    @property
    def worst_point(self) -> WorstPoint | None:
        """Point with the largest ratio of error to tolerance, of all experiments of the FMU.

        None if nothing was compared.
        """
        points = [outcome.worst_point for outcome in self.experiment_outcomes if outcome.worst_point]
        return max(points, key=lambda point: point.error_over_tolerance, default=None)

    @property
    def has_passed(self) -> bool:
        """Whether all experiments agree with their references, and start values with the expected ones."""
        return not self.failure_messages

    @property
    def failure_messages(self) -> list[str]:
        """Failures of the proof, one line each: wrong start values, errors, experiments out of tolerance."""
        lines = list(self.start_value_differences)
        if self.experiment_outcomes and not self.executed_experiment_count:
            lines.append(f"{self.importer_name} can execute none of the experiments; the table states why")
        for outcome in self.experiment_outcomes:
            name = outcome.experiment_label
            if outcome.error_message:
                lines.append(f"{name}: {outcome.error_message}")
            missed = sorted(
                (p for p in outcome.worst_points if not p.is_within_tolerance),
                key=lambda p: -p.error_over_tolerance,
            )
            if missed:
                worst, *others = missed  # sorted by error over tolerance
                lines.append(
                    f"{name}: {worst.output_name} = {worst.computed_value:.10g} at "
                    f"{worst.time_of_point:g} s, reference {worst.reference_value:.10g}, off by "
                    f"{worst.absolute_error:.2g}, allowed {worst.absolute_tolerance:.2g}"
                    + (f"; also {', '.join(p.output_name for p in others)}" if others else "")
                )
        return lines
