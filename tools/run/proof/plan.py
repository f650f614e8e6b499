"""Plan of an experiment with an FMU: task for an importer, and evaluation of the importer's answer."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jointfmu_fmu_src.proof.standard import (
    MIN_TOLERANCE_SCALE_OVER_NOMINAL,
    MODEL_EXCHANGE,
    SOLVER_TOLERANCE_OVER_EXPERIMENT_TOLERANCE,
)

from jointfmu.quantity import Array

from .manifest import Experiment
from .outcome import ExperimentOutcome, WorstPoint
from .values import convert_start_setting, evaluate_stimulus, variable_data_type

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


DEFAULT_RELATIVE_TOLERANCE = 1e-3
"""Default relative tolerance of an experiment that states none [1]."""
TIME_TOLERANCE_OVER_STEP = 1e-6
"""Time difference over the step size [1], below which two times count as equal."""
DEFAULT_STEP_COUNT, MAX_STEP_COUNT = 500, 10_000_000
"""Number of steps of an experiment that states no step size, and maximum number of steps."""


@dataclass(frozen=True, slots=True)
class ExperimentPlan:
    """Plan of an experiment in one interface of an FMU: the task for an importer.

    fmi_interface          : FMI interface; empty if the experiment is not executed
    nominal_output_values  : {output: nominal value of modelDescription.xml}
    experiment_task_fields : fields {name: value} of the `ExperimentTask` for an importer; empty if the
        experiment is not executed
    refusal_reason         : why the experiment cannot be executed with this FMU; empty if it can
    """

    experiment: Experiment
    fmi_interface: str
    nominal_output_values: Mapping[str, float]
    experiment_task_fields: dict[str, Any]
    refusal_reason: str = ""

    @classmethod
    def plan_experiment(
        cls,
        fmu_path: Path,
        fmu_folder: str,
        experiment: Experiment,
        fmi_interface: str,
        model_description: "ModelDescription",
    ) -> "ExperimentPlan":
        """Plan an experiment with an FMU: communication points, input values and output names.

        fmu_folder : folder in which the FMU is unpacked
        """
        if not fmi_interface:
            return cls(experiment, fmi_interface, {}, {})
        variables = {v.name: v for v in model_description.modelVariables}
        inputs = experiment.stimuli.columns if experiment.stimuli else {}
        outputs = list(experiment.reference_results.columns) if experiment.reference_results else []
        stimuli = experiment.stimuli
        try:
            for name in (*experiment.start_settings, *inputs, *outputs):
                if name not in variables:
                    raise ValueError(f"the FMU has no variable {name!r}")
            times = _communication_points(experiment, model_description)
            if stimuli and fmi_interface == MODEL_EXCHANGE:
                times = _insert_corner_times(times, stimuli.time)
            values: dict[str, object] = {
                "start_values": {
                    n: convert_start_setting(variables[n], value)
                    for n, value in experiment.start_settings.items()
                },
                "variable_data_types": {n: variable_data_type(variables[n]) for n in (*inputs, *outputs)},
            }
            if stimuli:
                for key, left_limit in (("input_values", False), ("input_values_before_jump", True)):
                    values[key] = {
                        n: evaluate_stimulus(variables[n], stimuli, times, left_limit) for n in inputs
                    }
        except ValueError as error:
            return cls(experiment, fmi_interface, {}, {}, str(error))
        values |= {
            "communication_points": times.tolist(),
            "output_names": outputs,
            "solver_tolerance": SOLVER_TOLERANCE_OVER_EXPERIMENT_TOLERANCE
            * _find_relative_tolerance(experiment),
        }
        if experiment.reference_results:
            values["comparison_times"] = experiment.reference_results.time.tolist()
        nominal = {n: abs(float(getattr(variables[n], "nominal", None) or 1.0)) for n in outputs}
        return cls(
            experiment,
            fmi_interface,
            nominal,
            make_task_fields(fmu_path, fmu_folder, fmi_interface, **values),
        )

    def evaluate_importer_answer(self, importer_answer: Mapping[str, Any] | None) -> ExperimentOutcome:
        """Compare the outputs that an importer computed with the reference results of the experiment.

        importer_answer : {"rows": outputs at the communication points} or {"error": text}; None if the
            experiment was not executed
        """
        if importer_answer is None:
            return ExperimentOutcome(self.experiment, self.fmi_interface, error_message=self.refusal_reason)
        if "error" in importer_answer:
            return ExperimentOutcome(
                self.experiment, self.fmi_interface, error_message=importer_answer["error"]
            )
        expected = self.experiment.reference_results
        if expected is None:
            return ExperimentOutcome(self.experiment, self.fmi_interface)
        available = [i for i, row in enumerate(importer_answer["rows"]) if row is not None]
        times = np.array([self.experiment_task_fields["communication_points"][i] for i in available])
        table = np.array([importer_answer["rows"][i] for i in available])
        rises = np.diff(expected.time) > 0.0
        compared = (expected.time >= times[0]) & (expected.time <= times[-1] * (1.0 + 1e-12))
        compared &= np.append(True, rises) & np.append(rises, True)  # at a jump both sides are valid: skip it
        if not np.any(compared):
            error = "no time of the reference results is within the computed times"
            return ExperimentOutcome(self.experiment, self.fmi_interface, error_message=error)
        t, tolerance = expected.time[compared], _find_relative_tolerance(self.experiment)
        points = []
        for column, (name, reference) in zip(table.T, expected.columns.items(), strict=True):
            y, y_ref = np.interp(t, times, column), reference[compared]
            size = np.maximum(
                np.abs(y_ref), MIN_TOLERANCE_SCALE_OVER_NOMINAL * self.nominal_output_values[name]
            )
            allowed = tolerance * np.broadcast_to(self.experiment.output_scales.get(name, size), y_ref.shape)
            with np.errstate(invalid="ignore"):
                error_over_tolerance = np.where(np.isfinite(y), np.abs(y - y_ref) / allowed, np.inf)
            i = int(np.argmax(error_over_tolerance))
            points.append(WorstPoint(name, float(t[i]), float(y[i]), float(y_ref[i]), float(allowed[i])))
        return ExperimentOutcome(self.experiment, self.fmi_interface, points, int(np.sum(compared)))


def _find_relative_tolerance(experiment: Experiment) -> float:
    """Relative tolerance [1] that an experiment states for its reference results, or the default."""
    return (
        DEFAULT_RELATIVE_TOLERANCE if experiment.relative_tolerance is None else experiment.relative_tolerance
    )


def _insert_corner_times(communication_points: Array, corner_times: Array) -> Array:
    """Communication points [s] and the times [s] at which inputs have a kink, sorted, each time once."""
    equal = TIME_TOLERANCE_OVER_STEP * float(np.min(np.diff(communication_points)))
    inner = np.unique(
        corner_times[
            (corner_times > communication_points[0] + equal)
            & (corner_times < communication_points[-1] - equal)
        ]
    )
    positions = np.searchsorted(inner, communication_points)
    bounds = np.concatenate([[-np.inf], inner, [np.inf]])
    distinct = (
        np.minimum(communication_points - bounds[positions], bounds[positions + 1] - communication_points)
        > equal
    )
    return np.sort(np.append(communication_points[distinct], inner))


def _communication_points(experiment: Experiment, model_description: "ModelDescription") -> Array:
    """Communication points (n) [s] of an experiment.

    Times that the experiment does not state are taken from its reference results, or from the default
    experiment of the FMU.
    """
    default = model_description.defaultExperiment
    results = experiment.reference_results or experiment.stimuli
    start = _first_not_none(experiment.start_time, getattr(default, "startTime", None), 0.0)
    stop = _first_not_none(
        experiment.stop_time, results.time[-1] if results else None, getattr(default, "stopTime", None), start
    )
    if not stop > start:
        raise ValueError(f"its stop time is {stop:g} s; expected a time after {start:g} s")
    step = _first_not_none(
        experiment.step_size, getattr(default, "stepSize", None), (stop - start) / DEFAULT_STEP_COUNT
    )
    if not step > 0.0 or (stop - start) / step > MAX_STEP_COUNT:
        raise ValueError(f"its step is {step:g} s; expected at least {(stop - start) / MAX_STEP_COUNT:g} s")
    count = int(np.ceil((stop - start) / step * (1.0 - 1e-12)))
    return np.append(start + step * np.arange(count), stop)


def make_task_fields(
    fmu_path: Path, fmu_folder: str, fmi_interface: str, **other_fields: object
) -> dict[str, object]:
    """Make the fields {name: value} of an `ExperimentTask`, the task for an importer, as a JSON object."""
    return {
        "fmu_path": str(fmu_path),
        "fmu_folder": str(fmu_folder),
        "fmi_interface": fmi_interface,
    } | other_fields


def _first_not_none(*values: Any) -> float:
    """First of several numbers that is not None."""
    return float(next(value for value in values if value is not None))
