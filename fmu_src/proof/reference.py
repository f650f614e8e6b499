"""Reference results of the package for one stepwise varied input, with which FMUs are compared.

The input steps to each level half-way between two sampling instants and stays there until the second. So at
the instants all importers agree: those that hold an input over a step, and those that set it at the step end.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointfmu.joints.model import Model, Outputs, TabulatedJoint
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from .series import TimeSeries

SIGNIFICANT_DIGITS = 10
"""Significant digits of a reference result [1]: the rounding is far below the tolerance."""


@dataclass(frozen=True, slots=True)
class Stimulus:
    """Stepwise variation of one input of an FMU.

    input_name        : name of the driven input
    levels            : (n) values at the sampling instants, the first at the start
    sampling_interval : time between two sampling instants [s]
    """

    input_name: str
    levels: Array
    sampling_interval: float

    @property
    def sampling_instants(self) -> Array:
        """Times (n) [s] of the sampling instants."""
        return np.asarray([float(f"{i * self.sampling_interval:.12g}") for i in range(self.levels.size)])

    @property
    def input_series(self) -> TimeSeries:
        """Time series of the driven input."""
        values = np.repeat(self.levels, 2)[1:]
        times = [float(f"{0.5 * i * self.sampling_interval:.12g}") for i in range(values.size)]
        return TimeSeries(np.array(times), {self.input_name: values})


def compute_results(
    model: Model, parameter_set: object, start_values: Mapping[str, float], stimulus: Stimulus
) -> TimeSeries:
    """Compute the outputs of a model at the sampling instants, starting from rest.

    parameter_set : parameter set of the joint
    start_values  : {input: start value}
    stimulus      : levels of the driven input

    Raises ValueError or RuntimeError as the joint does, and RuntimeError for an output that is not finite.
    """
    with np.errstate(all="ignore"):
        rows = _evaluate_instants(model, model.tabulate(parameter_set), dict(start_values), stimulus)
    outputs = {v.name: np.array([float(row[v.name]) for row in rows]) for v in model.outputs}
    for name, column in outputs.items():
        if not np.all(np.isfinite(column)):
            raise RuntimeError(f"{model.name}: {name} is not finite")
    return TimeSeries(stimulus.sampling_instants, outputs)


def _evaluate_instants(
    model: Model, tabulated_joint: TabulatedJoint, inputs: dict[str, float], stimulus: Stimulus
) -> list[Outputs]:
    """Outputs of a model at the sampling instants, one dictionary each."""
    if model.state_count:
        return _integrate_model(model, tabulated_joint, inputs, stimulus)
    history = None if model.initial_history is None else model.initial_history(tabulated_joint)
    rows = []
    for time, level in zip(stimulus.sampling_instants, stimulus.levels, strict=True):
        inputs[stimulus.input_name] = float(level)
        if model.advance is None or history is None:
            rows.append(
                model.evaluate(
                    tabulated_joint, {**inputs, "time": float(time)} if model.is_time_dependent else inputs
                )
            )
        else:
            row, history = model.advance(tabulated_joint, inputs, history)
            rows.append(row)
    return rows


def _integrate_model(
    model: Model, tabulated_joint: TabulatedJoint, inputs: dict[str, float], stimulus: Stimulus
) -> list[Outputs]:
    """Integrate a model with states at constant inputs, with a relative tolerance of 1e-12: its outputs."""
    from scipy.integrate import solve_ivp

    names = [v.name for v in model.outputs]
    inputs = {**inputs, stimulus.input_name: float(stimulus.levels[0])}

    def outputs_at(time: float, state_values: Array) -> Outputs:
        """Outputs of the model at a time and state."""
        states = dict(zip(names[: model.state_count], map(float, state_values), strict=True))
        return model.evaluate(tabulated_joint, {**inputs, **states, "time": time})

    def state_rates(time: float, state_values: Array) -> list[float]:
        """Time derivatives of the states."""
        values = outputs_at(time, state_values)
        return [values[name] for name in names[1 : model.state_count + 1]]

    times, initial = stimulus.sampling_instants, np.zeros(model.state_count)
    if times.size == 1:
        return [outputs_at(0.0, initial)]
    solution = solve_ivp(state_rates, (0.0, times[-1]), initial, "DOP853", times, rtol=1e-12, atol=1e-30)
    if not solution.success:
        raise RuntimeError(f"{model.name}: {solution.message}")
    return [outputs_at(time, x) for time, x in zip(times, solution.y.T, strict=True)]


def round_to_digits(value: float, digits: int = 9) -> float:
    """Round a number to so few significant digits that a file shows it in full."""
    return float(f"{value:.{digits}g}")


def list_start_values(model: Model, parameters: ParameterFile) -> dict[str, float]:
    """{input: start value} of a model."""
    return {v.name: parameters.start_value(v.name) for v in model.inputs}
