"""Reference results of the package for one stepwise varied input, with which FMUs are compared.

The input steps to each level half-way between two sampling instants and stays there until the second. So at
the instants all importers agree: those that hold an input over a step, and those that set it at the step end.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointfmu.joints.model import Model, OutputValues, TabulatedJoint
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from .series import TimeSeries

RESULT_SIGNIFICANT_DIGITS = 10
"""Significant digits of a reference result [1]: the rounding is far below the tolerance."""


@dataclass(frozen=True, slots=True)
class Stimulus:
    """Stepwise variation of one input of an FMU over time.

    input_name        : name of the varied input
    input_levels      : (n) values at the sampling instants, the first at the start
    sampling_interval : time between two sampling instants [s]
    """

    input_name: str
    input_levels: Array
    sampling_interval: float

    @property
    def sampling_instants(self) -> Array:
        """Times (n) [s] of the sampling instants."""
        return np.asarray(
            [float(f"{i * self.sampling_interval:.12g}") for i in range(self.input_levels.size)]
        )

    @property
    def input_time_series(self) -> TimeSeries:
        """Time series of the driven input; its value jumps half-way between the sampling instants."""
        values = np.repeat(self.input_levels, 2)[1:]
        times = [float(f"{0.5 * i * self.sampling_interval:.12g}") for i in range(values.size)]
        return TimeSeries(np.array(times), {self.input_name: values})


def compute_reference_results(
    fmu_model: Model, parameter_set: object, start_values: Mapping[str, float], input_stimulus: Stimulus
) -> TimeSeries:
    """Compute the outputs of an FMU's model at the sampling instants, starting from rest.

    parameter_set  : parameter set of the joint
    start_values   : {input: start value}
    input_stimulus : levels of the driven input

    Raises the errors (ValueError, RuntimeError) of the model, and RuntimeError if an output is not finite.
    """
    with np.errstate(all="ignore"):
        rows = _evaluate_instants(
            fmu_model, fmu_model.tabulate(parameter_set), dict(start_values), input_stimulus
        )
    outputs = {v.name: np.array([float(row[v.name]) for row in rows]) for v in fmu_model.outputs}
    for name, column in outputs.items():
        if not np.all(np.isfinite(column)):
            raise RuntimeError(f"{fmu_model.name}: the reference result of {name} is not finite")
    return TimeSeries(input_stimulus.sampling_instants, outputs)


def _evaluate_instants(
    fmu_model: Model,
    tabulated_joint: TabulatedJoint,
    input_values: dict[str, float],
    input_stimulus: Stimulus,
) -> list[OutputValues]:
    """Evaluate the outputs of a model at the sampling instants: a list of {output: value}."""
    if fmu_model.state_count:
        return _integrate_model(fmu_model, tabulated_joint, input_values, input_stimulus)
    history = None if fmu_model.initial_history is None else fmu_model.initial_history(tabulated_joint)
    rows = []
    for time, level in zip(input_stimulus.sampling_instants, input_stimulus.input_levels, strict=True):
        input_values[input_stimulus.input_name] = float(level)
        if fmu_model.advance is None or history is None:
            rows.append(
                fmu_model.evaluate(
                    tabulated_joint,
                    {**input_values, "time": float(time)} if fmu_model.is_time_dependent else input_values,
                )
            )
        else:
            row, history = fmu_model.advance(tabulated_joint, input_values, history)
            rows.append(row)
    return rows


def _integrate_model(
    fmu_model: Model,
    tabulated_joint: TabulatedJoint,
    input_values: dict[str, float],
    input_stimulus: Stimulus,
) -> list[OutputValues]:
    """Integrate a model with states at constant inputs; returns its outputs at the sampling instants.

    The relative tolerance is 1e-12.
    """
    from scipy.integrate import solve_ivp

    names = [v.name for v in fmu_model.outputs]
    input_values = {**input_values, input_stimulus.input_name: float(input_stimulus.input_levels[0])}

    def evaluate_outputs_at(simulation_time: float, state_values: Array) -> OutputValues:
        """Evaluate the outputs of the model at a time [s] and state."""
        states = dict(zip(names[: fmu_model.state_count], map(float, state_values), strict=True))
        return fmu_model.evaluate(tabulated_joint, {**input_values, **states, "time": simulation_time})

    def evaluate_state_rates(simulation_time: float, state_values: Array) -> list[float]:
        """Evaluate the time derivatives of the states of the model."""
        values = evaluate_outputs_at(simulation_time, state_values)
        return [values[name] for name in names[1 : fmu_model.state_count + 1]]

    times, initial = input_stimulus.sampling_instants, np.zeros(fmu_model.state_count)
    if times.size == 1:
        return [evaluate_outputs_at(0.0, initial)]
    solution = solve_ivp(
        evaluate_state_rates, (0.0, times[-1]), initial, "DOP853", times, rtol=1e-12, atol=1e-30
    )
    if not solution.success:
        raise RuntimeError(
            f"{fmu_model.name}: the integration of the reference result failed: {solution.message}"
        )
    return [evaluate_outputs_at(time, x) for time, x in zip(times, solution.y.T, strict=True)]


def round_to_significant_digits(real_number: float, significant_digits: int = 9) -> float:
    """Round a number to significant digits, so that a file contains it exactly."""
    return float(f"{real_number:.{significant_digits}g}")


def list_start_values(fmu_model: Model, parameter_file: ParameterFile) -> dict[str, float]:
    """Start values {input: value} of an FMU."""
    return {v.name: parameter_file.start_value(v.name) for v in fmu_model.inputs}
