"""An experiment on its way to an importer, and the importer's answer on its way back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .manifest import Experiment
from .outcome import Outcome, Point

Array = NDArray[np.float64]

TOLERANCE = 1e-3
"""Where an experiment states no tolerance [1]."""
FLOOR = 1e-6
"""Part of an output's nominal value [1] below which its round-off counts, not its own size."""
STEPS, MOST_STEPS = 500, 10_000_000
"""Of an experiment: where nothing states a step, and at most."""
REAL = ("Real", "Float64")
"""Types of real numbers."""


@dataclass(frozen=True, slots=True)
class Plan:
    """An experiment with what an importer needs; if it cannot be executed, `task` is empty.

    nominal : {output: its nominal value}
    refused : why it cannot, although the FMU asks for it
    """

    experiment: Experiment
    nominal: Mapping[str, float]
    task: dict[str, Any]
    refused: str = ""

    @classmethod
    def of(
        cls, fmu: Path, folder: str, experiment: Experiment, description: Any, variables: Mapping[str, Any]
    ) -> "Plan":
        """The plan of an experiment with an unpacked FMU."""
        if experiment.unfit:
            return cls(experiment, {}, {})
        inputs = experiment.stimuli.columns if experiment.stimuli else {}
        outputs = list(experiment.references.columns) if experiment.references else []
        try:
            times = _times(experiment, description)
            _check(experiment, [*experiment.settings, *inputs, *outputs], variables)
            for name in (*inputs, *outputs):
                if variables[name].type not in REAL:
                    raise ValueError(f"{name} is of type {variables[name].type}, real numbers are compared")
        except ValueError as error:
            return cls(experiment, {}, {}, str(error))
        settings = {
            name: float(setting.value) if variables[name].type in REAL else setting.value
            for name, setting in experiment.settings.items()
        }
        given = experiment.stimuli.at(times) if experiment.stimuli else {}
        ready = task(fmu, folder, settings, times, given, outputs)
        nominal = {name: abs(float(variables[name].nominal or 1.0)) for name in outputs}
        return cls(experiment, nominal, ready)

    def outcome(self, answer: Mapping[str, Any] | None) -> Outcome:
        """What an importer's answer means."""
        if answer is None:
            return Outcome(self.experiment, error=self.refused)
        if "error" in answer:
            return Outcome(self.experiment, error=answer["error"])
        expected = self.experiment.references
        if expected is None:
            return Outcome(self.experiment)
        shown = [i for i, row in enumerate(answer["rows"]) if row is not None]
        times = np.array([self.task["times"][i] for i in shown])
        table = np.array([answer["rows"][i] for i in shown])
        inside = (expected.time >= times[0]) & (expected.time <= times[-1] * (1.0 + 1e-12))
        if not np.any(inside):
            return Outcome(self.experiment, error="no reference result lies at a time that was computed")
        at = expected.time[inside]
        tolerance = TOLERANCE if self.experiment.tolerance is None else self.experiment.tolerance
        points = []
        for column, (name, reference) in zip(table.T, expected.columns.items(), strict=True):
            found, due = np.interp(at, times, column), reference[inside]
            allowed = tolerance * np.maximum(np.abs(due), FLOOR * self.nominal[name])
            with np.errstate(invalid="ignore"):
                share = np.where(np.isfinite(found), np.abs(found - due) / allowed, np.inf)
            i = int(np.argmax(share))
            points.append(Point(name, float(at[i]), float(found[i]), float(due[i]), float(allowed[i])))
        return Outcome(self.experiment, points, int(np.sum(inside)))


def _check(experiment: Experiment, names: Sequence[str], variables: Mapping[str, Any]) -> None:
    """Raise ValueError for a name that the FMU does not have, or a foreign unit of a start value."""
    for name in names:
        if name not in variables:
            raise ValueError(f"the FMU has no variable {name!r}")
    for name, setting in experiment.settings.items():
        own = variables[name].unit or "1"
        if setting.unit and setting.unit != own:
            raise ValueError(f"{name} is given in {setting.unit!r}, expected {own!r}")


def _times(experiment: Experiment, description: Any) -> Array:
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


def task(
    fmu: Path,
    folder: str,
    settings: Mapping[str, Any] | None = None,
    times: Sequence[float] | Array = (),
    inputs: Mapping[str, Array] | None = None,
    outputs: Sequence[str] = (),
) -> dict[str, Any]:
    """The fields of an `importers.Task` as JSON takes them."""
    return {
        "fmu": str(fmu),
        "folder": str(folder),
        "settings": dict(settings or {}),
        "times": [float(time) for time in times],
        "inputs": {name: column.tolist() for name, column in (inputs or {}).items()},
        "outputs": list(outputs),
    }


def _first(*values: Any) -> float:
    """The first that is stated."""
    return float(next(value for value in values if value is not None))
