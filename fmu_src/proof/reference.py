"""What the package says of an FMU along a staircase of one input: the results to which FMUs are compared.

Each level of the input is reached half-way between two instants and held until the second. At the instants
all importers give the same: those that hold an input over a step, and those that set it at the step's end.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointfmu.joints.model import Model, Outputs, Spring
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from .series import TimeSeries

DIGITS = 10
"""Of a reference result: their rounding [1] is far below the tolerance."""


@dataclass(frozen=True, slots=True)
class Stimulus:
    """How an FMU is driven.

    input  : that moves
    levels : (n) its values at the instants, the first at the start
    interval : from instant to instant [s]
    """

    input: str
    levels: Array
    interval: float

    @property
    def instants(self) -> Array:
        """(n) [s]."""
        return np.asarray([float(f"{i * self.interval:.12g}") for i in range(self.levels.size)])

    @property
    def stimuli(self) -> TimeSeries:
        """The input over time."""
        held = np.repeat(self.levels, 2)[1:]
        times = [float(f"{0.5 * i * self.interval:.12g}") for i in range(held.size)]
        return TimeSeries(np.array(times), {self.input: held})


def results(model: Model, values: object, start: Mapping[str, float], drive: Stimulus) -> TimeSeries:
    """Outputs at the instants, from rest.

    values : parameter set
    start  : {input: value}

    Raises ValueError or RuntimeError as the joint does, and RuntimeError for an output that is no number.
    """
    with np.errstate(all="ignore"):
        rows = _rows(model, model.spring(values), dict(start), drive)
    outputs = {v.name: np.array([float(row[v.name]) for row in rows]) for v in model.outputs}
    for name, column in outputs.items():
        if not np.all(np.isfinite(column)):
            raise RuntimeError(f"{model.name}: {name} is not finite")
    return TimeSeries(drive.instants, outputs)


def _rows(model: Model, spring: Spring, inputs: dict[str, float], drive: Stimulus) -> list[Outputs]:
    if model.states:
        return _moving(model, spring, inputs, drive)
    memory = None if model.rest is None else model.rest(spring)
    rows = []
    for time, level in zip(drive.instants, drive.levels, strict=True):
        inputs[drive.input] = float(level)
        if model.evolve is None or memory is None:
            rows.append(model.evaluate(spring, {**inputs, "time": float(time)} if model.moves else inputs))
        else:
            row, memory = model.evolve(spring, inputs, memory)
            rows.append(row)
    return rows


def _moving(model: Model, spring: Spring, inputs: dict[str, float], drive: Stimulus) -> list[Outputs]:
    """The motion of a model with states under inputs that rest, by an integration far finer than any step."""
    from scipy.integrate import solve_ivp

    names = [v.name for v in model.outputs]
    inputs = {**inputs, drive.input: float(drive.levels[0])}

    def outputs(time: float, x: Array) -> Outputs:
        known = dict(zip(names[: model.states], map(float, x), strict=True))
        return model.evaluate(spring, {**inputs, **known, "time": time})

    def rates(time: float, x: Array) -> list[float]:
        found = outputs(time, x)
        return [found[name] for name in names[1 : model.states + 1]]

    times, rest = drive.instants, np.zeros(model.states)
    if times.size == 1:
        return [outputs(0.0, rest)]
    found = solve_ivp(rates, (0.0, times[-1]), rest, "DOP853", times, rtol=1e-12, atol=1e-30)
    if not found.success:
        raise RuntimeError(f"{model.name}: {found.message}")
    return [outputs(time, x) for time, x in zip(times, found.y.T, strict=True)]


def rounded(value: float, digits: int = 9) -> float:
    """A number with few digits, which a file shows in full."""
    return float(f"{value:.{digits}g}")


def start_of(model: Model, parameters: ParameterFile) -> dict[str, float]:
    """Start values of the inputs."""
    return {v.name: parameters.start(v.name) for v in model.inputs}
