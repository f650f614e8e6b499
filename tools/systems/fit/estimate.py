"""Fit of parameters of a system to a measured record, by simulations of the compiled system.

Weighted least squares over all measured columns. The first fit takes the standard deviation of the noise of a
column from second differences of its values, the next ones from the residuals (maximum likelihood of
independent columns). The fitted part of the record grows in steps: the phase error of a wrong start frequency
then stays below a period.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.progress import set_status_text
from jointfmu.quantity import Array

from ...common import plots
from ...inputs.fitting.least_squares import Solution, Unknown, covariance, solve
from ...inputs.fitting.outcome import (
    MAX_LAW_OVER_CONSTANT_RESIDUAL,
    MAX_RESIDUAL_CORRELATION,
    FitPlot,
    FitResult,
    fitted_parameters,
)
from ..fmu.assembly import assemble_system
from ..system import System
from .compiled_system import CompiledSystem
from .correlated_residuals import whiten_jacobian
from .record import Record, list_similar_names, read_record

FITTED_SHARES = (0.125, 0.25, 0.5)
"""Shares of the fitted rows of the record [1] that are fitted first, one after the other."""
SHARE_TOLERANCE, TOLERANCE = 1e-3, 1e-7
"""Relative change of cost or parameters at which the fit of such a share, and the whole fit, end [1]."""
MAX_SHARE_CHANGE = 1.0
"""Largest change of the logarithm of a parameter [1] in the fit of one of the FITTED_SHARES."""
DIFFERENCE_STEP_LIMITS = 1e-5, 1e-2
"""Smallest and largest step of the central differences, in the logarithm of a parameter [1]."""
DIFFERENCE_EFFECT = 5.0
"""Root mean square effect of such a step over the noise [1].

Smaller ones vanish in the error of a simulation, which changes by jumps with the parameters, because the
steps of the simulation change. Larger ones shift an oscillation by more than a small angle.
"""
NOISE_TOLERANCE, MAX_NOISE_UPDATES = 0.02, 5
"""Relative change of the noise of the columns at which the fit ends, largest number of repeats."""
MIN_NOISE_OVER_SCATTER = 1e-6
"""Smallest noise of a column over standard deviation of its values [1], for a record without noise."""
MAX_START_OVER_COLUMN_RANGE = 0.1
"""First measured value of a state over the range of its column [1], up to which the state starts at zero."""
MAX_HOLD_OUT = 0.9
"""Largest share of the record that may be held out [1]."""
NO_EFFECT_STEP, MIN_EFFECT = 1e-3, 1e-10
"""Change of the logarithm of a parameter, and smallest effect on a column over its standard deviation [1]."""


def fit_system(
    system: System,
    path: Path,
    free: Sequence[str],
    hold_out: float = 0.0,
    stated_headings: Sequence[str] = (),
) -> FitResult:
    """Fit parameters of a system to a measured record.

    system          : start values
    path            : record (CSV); columns are named as variables of the system, see `record`
    free            : names of the parameters, or of states of bodies, whose start values are fitted then
    hold_out        : fraction [1] of the record, at its end, that is predicted instead of fitted
    stated_headings : see `record.read_record`

    Raises ValueError for bad input, RuntimeError if the fit does not converge or the compiler fails,
    ImportError if a package for compiling is missing.
    """
    if not 0.0 <= hold_out <= MAX_HOLD_OUT:
        raise ValueError(f"hold_out = {hold_out:g} is outside [0, {MAX_HOLD_OUT:g}]: share of the record")
    system_model = assemble_system(system)
    model = system_model.make_model()
    start_file = system_model.make_parameters(model)
    record = read_record(path, model, stated_headings)
    unknowns = _make_unknowns(system, model, start_file, record, free)
    _check_start(record, model, free)
    count = record.time.size - round(hold_out * record.time.size)
    if count * len(record.outputs) <= len(unknowns):
        raise ValueError(f"{path}: {count} rows to fit are too few for {len(unknowns)} parameters")
    estimation = _Estimation(record, CompiledSystem(system_model), count)
    set_status_text(f"fit of {system.name}")
    estimation.check_effects(unknowns)
    solution, noise = estimation.fit(unknowns)
    return _make_result(estimation, solution, noise, model, start_file)


def _make_unknowns(
    system: System, model: Model, start_file: ParameterFile, measured_record: Record, free: Sequence[str]
) -> list[Unknown]:
    """Make the unknowns of the fit.

    Raises ValueError for a name that the system lacks or that cannot be fitted.
    """
    states = {v.name: v for v in model.outputs[: model.state_count]}
    numbers = {
        name: item
        for name, item in model.parameter_fields().items()
        if "unit" in item.metadata and not item.metadata["whole"]
    }
    unknowns = []
    for name in free:
        if list(free).count(name) > 1:
            raise ValueError(f"parameter {name!r} is given twice; state it once")
        if name in states:
            column = measured_record.outputs.get(name, np.zeros(1))
            span = float(np.ptp(column)) or states[name].nominal
            unknowns.append(Unknown(name, states[name].unit, float(column[0]), -np.inf, np.inf, span))
        elif name in numbers:
            meta, value = numbers[name].metadata, float(start_file.values_by_name[name])
            low, high = meta["interval"].low, meta["interval"].high
            scale = None if low >= 0.0 else abs(value) or 1.0
            try:
                unknowns.append(Unknown(name, meta["unit"], value, low, high, scale))
            except ValueError as error:
                raise ValueError(f"{error}; state a start value in the system file") from None
        elif name in start_file.values_by_name:
            raise ValueError(f"{name} is fixed in the compiled system; {_list_free(name, numbers)}")
        else:
            raise ValueError(
                f"{name!r} is no parameter of {system.name}, {list_similar_names(name, [*numbers, *states])}"
            )
    return unknowns


def _list_free(component_name: str, parameter_names: Iterable[str]) -> str:
    """Parameters of the component of `component_name` that can be fitted, as text."""
    component = component_name.partition(".")[0]
    return f"allowed are {', '.join(n for n in parameter_names if n.startswith(f'{component}.'))}"


def _check_start(measured_record: Record, model: Model, free: Sequence[str]) -> None:
    """Raise ValueError if a measured state does not start at zero, and its start value is not fitted."""
    for v in model.outputs[: model.state_count]:
        column = measured_record.outputs.get(v.name)
        if (
            column is not None
            and v.name not in free
            and abs(column[0]) > MAX_START_OVER_COLUMN_RANGE * np.ptp(column)
        ):
            raise ValueError(
                f"{measured_record.path}: {v.name} starts at {column[0]:.4g} {v.unit}, the system at 0; "
                f"add {v.name} to the free parameters to fit its start value"
            )


@dataclass(frozen=True)
class _Estimation:
    """Simulations of a system, to be compared with a measured record.

    fitted_count : number of rows that are fitted
    """

    record: Record
    compiled: CompiledSystem
    fitted_count: int

    def simulate(self, value_by_name: Mapping[str, float], row_count: int) -> Array:
        """Simulated columns (rows, columns) [SI] of the first rows of the record."""
        inputs = {name: column[:row_count] for name, column in self.record.inputs.items()}
        return self.compiled.simulate(
            value_by_name, self.record.time[:row_count], inputs, [*self.record.outputs]
        )

    def measured(self, row_count: int) -> Array:
        """Measured columns (rows, columns) [SI] of the first rows of the record."""
        return np.column_stack([column[:row_count] for column in self.record.outputs.values()])

    def misfit(self, value_by_name: Mapping[str, float], row_count: int) -> Array:
        """Simulated minus measured columns (rows, columns) [SI] of the record."""
        return self.simulate(value_by_name, row_count) - self.measured(row_count)

    def check_effects(self, unknowns: Sequence[Unknown]) -> None:
        """Raise ValueError for a fitted parameter that changes no compared column."""
        start = {u.name: u.start_value for u in unknowns}
        reference = self.simulate(start, self.fitted_count)
        scale = np.std(self.measured(self.fitted_count), axis=0)
        for u in unknowns:
            value = u.from_search(u.to_search(u.start_value) + NO_EFFECT_STEP)
            changed = self.simulate(start | {u.name: value}, self.fitted_count)
            if np.max(np.abs(changed - reference) / scale) < MIN_EFFECT:
                raise ValueError(
                    f"{u.name} = {u.start_value:g} {u.unit} has no effect on "
                    f"{', '.join(self.record.outputs)}; fit other parameters, or start from a value with an "
                    "effect"
                )

    def fit(self, unknowns: Sequence[Unknown]) -> tuple[Solution, Array]:
        """Fit the parameters; returns the solution, and the standard deviation of each column [SI].

        The covariance of the solution allows for correlated residuals. Its residuals are those of all
        columns, one after the other.
        """
        measured = self.measured(self.fitted_count)
        smallest, current = MIN_NOISE_OVER_SCATTER * np.std(measured, axis=0), list(unknowns)
        noise = np.maximum(np.sqrt(np.mean(np.diff(measured, 2, axis=0) ** 2, axis=0) / 6.0), smallest)

        steps = np.full(len(current), DIFFERENCE_STEP_LIMITS[1])

        def solve_rows(searched: Sequence[Unknown], row_count: int, tolerance: float) -> Solution:
            """Solution of the fit to the first rows of the record."""
            solution = solve(
                searched,
                lambda values: (self.misfit(values, row_count) / noise).T.ravel(),
                noise=1.0,
                tolerance=tolerance,
                difference_steps=steps,
            )
            current[:] = [replace(u, start_value=solution.values[u.name]) for u in current]
            effects = np.sqrt(np.mean(solution.jacobian**2, axis=0))
            with np.errstate(divide="ignore"):
                steps[:] = np.clip(DIFFERENCE_EFFECT / effects, *DIFFERENCE_STEP_LIMITS)
            return solution

        for share in FITTED_SHARES:
            bounded = [_limit_change(u) for u in current]
            solve_rows(bounded, max(int(share * self.fitted_count), 2), SHARE_TOLERANCE)
        for update in range(MAX_NOISE_UPDATES):
            solution = solve_rows(current, self.fitted_count, TOLERANCE)
            previous, misfit = noise, solution.residuals.reshape(noise.size, -1).T * noise
            noise = np.maximum(np.sqrt(np.mean(misfit**2, axis=0)), smallest)
            if update and np.max(np.abs(np.log(noise / previous))) < NOISE_TOLERANCE:
                break
        return replace(solution, unknowns=tuple(unknowns)), noise


def _limit_change(unknown: Unknown) -> Unknown:
    """Unknown of the fit with bounds at MAX_SHARE_CHANGE from its start value."""
    middle = unknown.to_search(unknown.start_value)
    low, high = (unknown.from_search(middle + d) for d in (-MAX_SHARE_CHANGE, MAX_SHARE_CHANGE))
    bounds = max(unknown.lower_bound, low), min(unknown.upper_bound, high)
    return replace(unknown, lower_bound=bounds[0], upper_bound=bounds[1])


def _make_result(
    estimation: _Estimation, solution: Solution, noise: Array, model: Model, start_file: ParameterFile
) -> FitResult:
    """Make the result of the fit: intervals, facts, plots, notes."""
    record, count = estimation.record, estimation.fitted_count
    columns = np.split(solution.residuals, len(record.outputs))
    jacobian, quantile = whiten_jacobian(solution.jacobian, columns)
    solution = replace(solution, jacobian=jacobian, noise=1.0, covariance=covariance(jacobian, 1.0))
    misfit = estimation.misfit(solution.values, record.time.size)
    units = {v.name: v.unit for v in model.outputs}
    intervals = {
        u.name: (u.from_search(middle - half), u.from_search(middle + half))
        for u in solution.unknowns
        for middle, half in [
            (u.to_search(solution.values[u.name]), quantile * solution.relative_deviations[u.name])
        ]
    }
    facts = {"rows": (float(count), "1", "rows of the record that are fitted")}
    notes = [
        f"column {name} is no variable of the system, and is not used" for name in record.unused_headings
    ]
    notes += [
        f"{u.name} is a start value of this record, and no part of the system file"
        for u in solution.unknowns
        if u.name in units
    ]
    is_missed, is_held_out_missed = [], []
    for k, (name, column) in enumerate(record.outputs.items()):
        residuals = misfit[:count, k]
        rms, mean = _root_mean_square(residuals), float(np.mean(column[:count]))
        facts[f"residual.{name}"] = (rms, units[name], "rms of measured minus fitted values")
        is_missed.append(rms > MAX_LAW_OVER_CONSTANT_RESIDUAL * float(np.std(column[:count])))
        power = max(float(residuals @ residuals), np.finfo(float).tiny)
        correlation = float(residuals[1:] @ residuals[:-1]) / power
        if correlation > MAX_RESIDUAL_CORRELATION:
            notes.append(
                f"neighbouring residuals of {name} are correlated ({correlation:.2f}): the intervals allow "
                "for it, but not for the error of a system that deviates systematically"
            )
        if count < record.time.size:
            share = 100.0 * (1.0 - count / record.time.size)
            error, trivial = _root_mean_square(misfit[count:, k]), _root_mean_square(column[count:] - mean)
            text = f"rms error of the prediction of the last {share:.3g} %"
            facts[f"held_out.{name}"] = (error, units[name], text)
            facts[f"held_out_mean.{name}"] = (
                trivial,
                units[name],
                "the same, for the mean of the fitted part",
            )
            is_held_out_missed.append(error > MAX_LAW_OVER_CONSTANT_RESIDUAL * trivial)
    doubt = None
    if all(is_missed):
        doubt = "the fitted system misses every measured column by as much as the mean of the column does"
    elif is_held_out_missed and all(is_held_out_missed):
        doubt = "the prediction misses every held-out column by as much as the mean of its fitted part does"
    names = {u.name: solution.values[u.name] for u in solution.unknowns if u.name not in units}
    first, last = record.time[0], record.time[count - 1]
    return FitResult(
        fitted_parameters(start_file, names, "measured", record.path.name, f"{first:.4g} to {last:.4g} s"),
        solution,
        facts,
        [_make_plot(record, name, units[name], misfit[:, k], count) for k, name in enumerate(record.outputs)],
        notes,
        intervals,
        doubt,
    )


def _root_mean_square(values: Array) -> float:
    """Root mean square of values (n)."""
    return float(np.sqrt(np.mean(values**2)))


def _make_plot(record: Record, column_name: str, unit: str, misfit: Array, fitted_row_count: int) -> FitPlot:
    """Plot of one column over time: measured, fitted and predicted values; below measured minus simulated."""
    column = record.outputs[column_name]
    shown, factor = plots.choose_unit(unit, column)
    label = f"{column_name} ({shown})"
    simulated = factor * (column + misfit)
    return FitPlot(
        measured_x=record.time,
        measured_y=factor * column,
        misfit=-factor * misfit,
        law_curve=(record.time[:fitted_row_count], simulated[:fitted_row_count]),
        axis_labels=("time (s)", label, f"misfit ({shown})"),
        other_laws={"predicted": (record.time[fitted_row_count:], simulated[fitted_row_count:])}
        if fitted_row_count < column.size
        else {},
    )
