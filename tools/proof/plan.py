"""An experiment on its way to an importer, and the importer's answer on its way back."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jointfmu_fmu_src.proof.standard import FLOOR, MODEL_EXCHANGE, SOLVER

from jointfmu.quantity import Array

from .manifest import Experiment
from .outcome import Outcome, WorstPoint
from .values import course, kind, setting

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription


TOLERANCE = 1e-3
"""Where an experiment states no tolerance [1]."""
MEETING = 1e-6
"""Part of a step [1] below which two times are one."""
STEPS, MOST_STEPS = 500, 10_000_000
"""Of an experiment: where nothing states a step, and at most."""


@dataclass(frozen=True, slots=True)
class ExperimentPlan:
    """An experiment with what an importer needs; if it cannot be executed, `task` is empty.

    interface : of the FMU; empty if it is left out
    nominal : {output: its nominal value}
    refused : why it cannot, although the FMU asks for it
    """

    experiment: Experiment
    interface: str
    nominal: Mapping[str, float]
    task: dict[str, Any]
    refused: str = ""

    @classmethod
    def of(
        cls, fmu: Path, folder: str, experiment: Experiment, interface: str, description: "ModelDescription"
    ) -> "ExperimentPlan":
        """The plan of an experiment with an unpacked FMU."""
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
            times = _times(experiment, description)
            if stimuli and interface == MODEL_EXCHANGE:
                times = _with_corners(times, stimuli.time)
            values: dict[str, object] = {
                "settings": {n: setting(variables[n], given) for n, given in experiment.settings.items()},
                "kinds": {n: kind(variables[n]) for n in (*inputs, *outputs)},
            }
            if stimuli:
                for key, before in (("inputs", False), ("before", True)):
                    values[key] = {n: course(variables[n], stimuli, times, before) for n in inputs}
        except ValueError as error:
            return cls(experiment, interface, {}, {}, str(error))
        values |= {"times": times.tolist(), "outputs": outputs, "tolerance": SOLVER * _tolerance(experiment)}
        if experiment.references:
            values["due"] = experiment.references.time.tolist()
        nominal = {n: abs(float(getattr(variables[n], "nominal", None) or 1.0)) for n in outputs}
        return cls(experiment, interface, nominal, task(fmu, folder, interface, **values))

    def outcome(self, answer: Mapping[str, Any] | None) -> Outcome:
        if answer is None:
            return Outcome(self.experiment, self.interface, error=self.refused)
        if "error" in answer:
            return Outcome(self.experiment, self.interface, error=answer["error"])
        expected = self.experiment.references
        if expected is None:
            return Outcome(self.experiment, self.interface)
        shown = [i for i, row in enumerate(answer["rows"]) if row is not None]
        times = np.array([self.task["times"][i] for i in shown])
        table = np.array([answer["rows"][i] for i in shown])
        once = np.diff(expected.time) > 0.0
        inside = (expected.time >= times[0]) & (expected.time <= times[-1] * (1.0 + 1e-12))
        inside &= np.append(True, once) & np.append(once, True)  # where it jumps, either side would do
        if not np.any(inside):
            error = "no reference result lies at a time that was computed"
            return Outcome(self.experiment, self.interface, error=error)
        at, tolerance = expected.time[inside], _tolerance(self.experiment)
        points = []
        for column, (name, reference) in zip(table.T, expected.columns.items(), strict=True):
            found, due = np.interp(at, times, column), reference[inside]
            size = np.maximum(np.abs(due), FLOOR * self.nominal[name])
            allowed = tolerance * np.broadcast_to(self.experiment.scales.get(name, size), due.shape)
            with np.errstate(invalid="ignore"):
                share = np.where(np.isfinite(found), np.abs(found - due) / allowed, np.inf)
            i = int(np.argmax(share))
            points.append(WorstPoint(name, float(at[i]), float(found[i]), float(due[i]), float(allowed[i])))
        return Outcome(self.experiment, self.interface, points, int(np.sum(inside)))


def _tolerance(experiment: Experiment) -> float:
    return TOLERANCE if experiment.tolerance is None else experiment.tolerance


def _with_corners(times: Array, corners: Array) -> Array:
    """Times together with those between them where inputs have a corner; it replaces a time that it meets."""
    meet = MEETING * float(np.min(np.diff(times)))
    inner = np.unique(corners[(corners > times[0] + meet) & (corners < times[-1] - meet)])
    places = np.searchsorted(inner, times)
    around = np.concatenate([[-np.inf], inner, [np.inf]])
    far = np.minimum(times - around[places], around[places + 1] - times) > meet
    return np.sort(np.append(times[far], inner))


def _times(experiment: Experiment, description: "ModelDescription") -> Array:
    """Communication points [s]; what an experiment does not state is the FMU's default, or its results'."""
    default = description.defaultExperiment
    results = experiment.references or experiment.stimuli
    start = _first(experiment.start, getattr(default, "startTime", None), 0.0)
    stop = _first(
        experiment.stop, results.time[-1] if results else None, getattr(default, "stopTime", None), start
    )
    if not stop > start:
        raise ValueError(f"its stop time is {stop:g} s; expected one after {start:g} s")
    step = _first(experiment.step, getattr(default, "stepSize", None), (stop - start) / STEPS)
    if not step > 0.0 or (stop - start) / step > MOST_STEPS:
        raise ValueError(f"its step is {step:g} s; expected at least {(stop - start) / MOST_STEPS:g} s")
    count = int(np.ceil((stop - start) / step * (1.0 - 1e-12)))
    return np.append(start + step * np.arange(count), stop)


def task(fmu: Path, folder: str, interface: str, **more: object) -> dict[str, object]:
    """The fields of a `Task`."""
    return {"fmu": str(fmu), "folder": str(folder), "interface": interface, **more}


def _first(*values: Any) -> float:
    """The first that is stated."""
    return float(next(value for value in values if value is not None))
