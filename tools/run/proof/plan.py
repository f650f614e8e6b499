"""Plan of an experiment with an FMU: task for an importer, and evaluation of the importer's answer."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jointfmu_fmu_src.proof.standard import (
    MIN_SCALE_OVER_NOMINAL,
    MODEL_EXCHANGE,
    SOLVER_OVER_EXPERIMENT_TOLERANCE,
)

from jointfmu.quantity import Array

from .manifest import Experiment
from .outcome import ExperimentOutcome, WorstPoint
from .values import convert_start_setting, input_values, variable_kind

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


DEFAULT_TOLERANCE = 1e-3
"""Default relative tolerance of an experiment that states none [1]."""
TIME_TOLERANCE = 1e-6
"""Time difference over the step size [1], below which two times count as equal."""
DEFAULT_STEP_COUNT, MAX_STEP_COUNT = 500, 10_000_000
"""Number of steps of an experiment that states no step size, and maximum number of steps."""


@dataclass(frozen=True, slots=True)
class ExperimentPlan:
    """Plan of an experiment in one interface of an FMU: the task for an importer.

    interface              : FMI interface; empty if the experiment is not executed
    nominal_values         : {output: nominal value}
    experiment_task_fields : fields of the `ExperimentTask`; empty if the experiment cannot be executed
    refusal_reason         : why the experiment cannot be executed with this FMU; empty if it can
    """

    experiment: Experiment
    interface: str
    nominal_values: Mapping[str, float]
    experiment_task_fields: dict[str, Any]
    refusal_reason: str = ""

    @classmethod
    def plan_experiment(
        cls,
        fmu: Path,
        fmu_folder: str,
        experiment: Experiment,
        interface: str,
        description: "ModelDescription",
    ) -> "ExperimentPlan":
        """Plan an experiment with an FMU that is unpacked in `fmu_folder`."""
        if not interface:
            return cls(experiment, interface, {}, {})
        variables = {v.name: v for v in description.modelVariables}
        inputs = experiment.stimuli.columns if experiment.stimuli else {}
        outputs = list(experiment.references.columns) if experiment.references else []
        stimuli = experiment.stimuli
        try:
            for name in (*experiment.settings, *inputs, *outputs):
                if name not in variables:
                    raise ValueError(f"the FMU has no variable {name!r}")
            times = _communication_points(experiment, description)
            if stimuli and interface == MODEL_EXCHANGE:
                times = _insert_corner_times(times, stimuli.time)
            values: dict[str, object] = {
                "settings": {
                    n: convert_start_setting(variables[n], value) for n, value in experiment.settings.items()
                },
                "variable_kinds": {n: variable_kind(variables[n]) for n in (*inputs, *outputs)},
            }
            if stimuli:
                for key, left_limit in (("inputs", False), ("inputs_before_jump", True)):
                    values[key] = {n: input_values(variables[n], stimuli, times, left_limit) for n in inputs}
        except ValueError as error:
            return cls(experiment, interface, {}, {}, str(error))
        values |= {
            "times": times.tolist(),
            "outputs": outputs,
            "tolerance": SOLVER_OVER_EXPERIMENT_TOLERANCE * _find_tolerance(experiment),
        }
        if experiment.references:
            values["comparison_times"] = experiment.references.time.tolist()
        nominal = {n: abs(float(getattr(variables[n], "nominal", None) or 1.0)) for n in outputs}
        return cls(experiment, interface, nominal, make_task_fields(fmu, fmu_folder, interface, **values))

    def evaluate_importer_answer(self, importer_answer: Mapping[str, Any] | None) -> ExperimentOutcome:
        """Compare the answer of an importer with the reference results of the experiment.

        importer_answer : {"rows"} or {"error"} from a `worker`; None if the experiment was not executed
        """
        if importer_answer is None:
            return ExperimentOutcome(self.experiment, self.interface, error_message=self.refusal_reason)
        if "error" in importer_answer:
            return ExperimentOutcome(self.experiment, self.interface, error_message=importer_answer["error"])
        expected = self.experiment.references
        if expected is None:
            return ExperimentOutcome(self.experiment, self.interface)
        available = [i for i, row in enumerate(importer_answer["rows"]) if row is not None]
        times = np.array([self.experiment_task_fields["times"][i] for i in available])
        table = np.array([importer_answer["rows"][i] for i in available])
        rises = np.diff(expected.time) > 0.0
        compared = (expected.time >= times[0]) & (expected.time <= times[-1] * (1.0 + 1e-12))
        compared &= np.append(True, rises) & np.append(rises, True)  # at a jump both sides are valid: skip it
        if not np.any(compared):
            error = "no reference result lies at a time that was computed"
            return ExperimentOutcome(self.experiment, self.interface, error_message=error)
        t, tolerance = expected.time[compared], _find_tolerance(self.experiment)
        points = []
        for column, (name, reference) in zip(table.T, expected.columns.items(), strict=True):
            y, y_ref = np.interp(t, times, column), reference[compared]
            size = np.maximum(np.abs(y_ref), MIN_SCALE_OVER_NOMINAL * self.nominal_values[name])
            allowed = tolerance * np.broadcast_to(self.experiment.output_scales.get(name, size), y_ref.shape)
            with np.errstate(invalid="ignore"):
                error_ratio = np.where(np.isfinite(y), np.abs(y - y_ref) / allowed, np.inf)
            i = int(np.argmax(error_ratio))
            points.append(WorstPoint(name, float(t[i]), float(y[i]), float(y_ref[i]), float(allowed[i])))
        return ExperimentOutcome(self.experiment, self.interface, points, int(np.sum(compared)))


def _find_tolerance(experiment: Experiment) -> float:
    """Relative tolerance [1] that an experiment states for its reference results, or the default."""
    return DEFAULT_TOLERANCE if experiment.tolerance is None else experiment.tolerance


def _insert_corner_times(times: Array, corner_times: Array) -> Array:
    """Add the corner times of the inputs [s] to communication points [s]; a corner replaces an equal time."""
    equal = TIME_TOLERANCE * float(np.min(np.diff(times)))
    inner = np.unique(corner_times[(corner_times > times[0] + equal) & (corner_times < times[-1] - equal)])
    positions = np.searchsorted(inner, times)
    bounds = np.concatenate([[-np.inf], inner, [np.inf]])
    distinct = np.minimum(times - bounds[positions], bounds[positions + 1] - times) > equal
    return np.sort(np.append(times[distinct], inner))


def _communication_points(experiment: Experiment, description: "ModelDescription") -> Array:
    """Communication points (n) [s] of an experiment.

    Times that the experiment does not state are taken from its reference results, or from the default
    experiment of the FMU.
    """
    default = description.defaultExperiment
    results = experiment.references or experiment.stimuli
    start = _first_not_none(experiment.start, getattr(default, "startTime", None), 0.0)
    stop = _first_not_none(
        experiment.stop, results.time[-1] if results else None, getattr(default, "stopTime", None), start
    )
    if not stop > start:
        raise ValueError(f"its stop time is {stop:g} s; expected a time after {start:g} s")
    step = _first_not_none(
        experiment.step, getattr(default, "stepSize", None), (stop - start) / DEFAULT_STEP_COUNT
    )
    if not step > 0.0 or (stop - start) / step > MAX_STEP_COUNT:
        raise ValueError(f"its step is {step:g} s; expected at least {(stop - start) / MAX_STEP_COUNT:g} s")
    count = int(np.ceil((stop - start) / step * (1.0 - 1e-12)))
    return np.append(start + step * np.arange(count), stop)


def make_task_fields(fmu: Path, folder: str, interface: str, **other_fields: object) -> dict[str, object]:
    """Make the fields of an `ExperimentTask`, as a JSON object."""
    return {"fmu": str(fmu), "folder": str(folder), "interface": interface, **other_fields}


def _first_not_none(*values: Any) -> float:
    """First of several values that is not None."""
    return float(next(value for value in values if value is not None))
