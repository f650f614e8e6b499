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
from ...inputs.fitting.least_squares import FitSolution, Unknown, parameter_covariance, solve_least_squares
from ...inputs.fitting.outcome import (
    MAX_LAW_OVER_CONSTANT_RESIDUAL,
    MAX_RESIDUAL_CORRELATION,
    FitPlot,
    FitResult,
    build_fitted_file,
    find_undetermined_parameters,
)
from ..fmu.assembly import assemble_system
from ..system import System
from .compiled_system import CompiledSystem
from .correlated_residuals import whiten_jacobian
from .record import MeasuredRecord, list_similar_names, read_record

FIRST_FIT_RECORD_SHARES = (0.125, 0.25, 0.5)
"""Shares of the fitted rows of the record [1] that are fitted first, one after the other."""
FIRST_FITS_TOLERANCE, FINAL_FIT_TOLERANCE = 1e-3, 1e-7
"""Relative change of cost or parameters at which the fit of such a share, and the whole fit, end [1]."""
MAX_LOG_CHANGE_IN_FIRST_FITS = 1.0
"""Largest change of the logarithm of a parameter [1] in the fit of one of the FIRST_FIT_RECORD_SHARES."""
CENTRAL_DIFFERENCE_STEP_LIMITS = 1e-5, 1e-2
"""Smallest and largest step of the central differences, in the logarithm of a parameter [1]."""
DIFFERENCE_STEP_EFFECT_OVER_NOISE = 5.0
"""Root mean square effect of such a step over the noise [1].

Smaller ones vanish in the error of a simulation, which changes by jumps with the parameters, because the
steps of the simulation change. Larger ones shift an oscillation by more than a small angle.
"""
RELATIVE_NOISE_TOLERANCE, MAX_NOISE_UPDATES = 0.02, 5
"""Relative change of the noise of the columns at which the fit ends, largest number of repeats."""
MIN_NOISE_OVER_COLUMN_DEVIATION = 1e-6
"""Smallest noise of a column over standard deviation of its values [1], for a record without noise."""
MAX_ZERO_START_OVER_COLUMN_RANGE = 0.1
"""First measured value of a state over the range of its column [1], up to which the state starts at zero."""
MAX_HELD_OUT_SHARE = 0.9
"""Largest share of the record that may be held out [1]."""
EFFECT_CHECK_LOG_PARAMETER_STEP, MIN_EFFECT_OVER_COLUMN_DEVIATION = 1e-3, 1e-10
"""Change of the logarithm of a parameter, and smallest effect on a column over its standard deviation [1]."""


def fit_system(
    system: System,
    record_path: Path,
    fitted_names: Sequence[str],
    held_out_share: float = 0.0,
    stated_headings: Sequence[str] = (),
) -> FitResult:
    """Fit parameters of a system to a measured record.

    system          : system, whose parameter values are the start values of the fit
    record_path     : record (CSV) with columns time and COMPONENT.VARIABLE of the system
    fitted_names    : names of the parameters, or of states of bodies, whose start values are fitted then
    held_out_share  : fraction [1] of the record, at its end, that is predicted instead of fitted
    stated_headings : `NAME=HEADING` or `NAME=HEADING [UNIT]`, for columns with other headings

    Raises ValueError for bad input, RuntimeError if the fit does not converge or the compiler fails,
    ImportError if a package for compiling is missing.
    """
    if not 0.0 <= held_out_share <= MAX_HELD_OUT_SHARE:
        raise ValueError(
            f"hold_out = {held_out_share:g} is outside [0, {MAX_HELD_OUT_SHARE:g}]: share of the record"
        )
    system_model = assemble_system(system)
    model = system_model.make_fmu_model()
    start_parameter_file = system_model.make_system_parameter_file(model)
    record = read_record(record_path, model, stated_headings)
    unknowns = _make_unknowns(system, model, start_parameter_file, record, fitted_names)
    _check_start_values(record, model, fitted_names)
    count = record.time.size - round(held_out_share * record.time.size)
    if count * len(record.outputs) <= len(unknowns):
        raise ValueError(f"{record_path}: {count} rows to fit are too few for {len(unknowns)} parameters")
    estimation = _RecordSimulation(record, CompiledSystem(system_model), count)
    set_status_text(f"fit of {system.name}")
    estimation.check_parameter_effects(unknowns)
    solution, noise = estimation.fit_parameters(unknowns)
    return _make_fit_result(estimation, solution, noise, model, start_parameter_file)


def _make_unknowns(
    system: System,
    system_model: Model,
    start_parameter_file: ParameterFile,
    measured_record: MeasuredRecord,
    fitted_names: Sequence[str],
) -> list[Unknown]:
    """Make the unknowns of the fit.

    Raises ValueError for a name that the system lacks or that cannot be fitted.
    """
    states = {v.name: v for v in system_model.outputs[: system_model.state_count]}
    numbers = {
        name: item
        for name, item in system_model.parameter_fields().items()
        if "unit" in item.metadata and not item.metadata["whole"]
    }
    unknowns = []
    for name in fitted_names:
        if list(fitted_names).count(name) > 1:
            raise ValueError(f"parameter {name!r} is given twice; state it once")
        if name in states:
            column = measured_record.outputs.get(name, np.zeros(1))
            span = float(np.ptp(column)) or states[name].nominal
            unknowns.append(Unknown(name, states[name].unit, float(column[0]), -np.inf, np.inf, span))
        elif name in numbers:
            meta, value = numbers[name].metadata, float(start_parameter_file.values_by_name[name])
            low, high = meta["interval"].low, meta["interval"].high
            scale = None if low >= 0.0 else abs(value) or 1.0
            try:
                unknowns.append(Unknown(name, meta["unit"], value, low, high, scale))
            except ValueError as error:
                raise ValueError(f"{error}; state a start value in the system file") from None
        elif name in start_parameter_file.values_by_name:
            raise ValueError(
                f"{name} is fixed in the compiled system; {_list_fittable_parameters(name, numbers)}"
            )
        else:
            raise ValueError(
                f"{name!r} is no parameter of {system.name}, {list_similar_names(name, [*numbers, *states])}"
            )
    return unknowns


def _list_fittable_parameters(component_name: str, parameter_names: Iterable[str]) -> str:
    """Parameters of the component of `component_name` that can be fitted, as text."""
    component = component_name.partition(".")[0]
    return f"allowed are {', '.join(n for n in parameter_names if n.startswith(f'{component}.'))}"


def _check_start_values(
    measured_record: MeasuredRecord, system_model: Model, fitted_names: Sequence[str]
) -> None:
    """Raise ValueError if a measured state does not start at zero, and its start value is not fitted."""
    for v in system_model.outputs[: system_model.state_count]:
        column = measured_record.outputs.get(v.name)
        if (
            column is not None
            and v.name not in fitted_names
            and abs(column[0]) > MAX_ZERO_START_OVER_COLUMN_RANGE * np.ptp(column)
        ):
            raise ValueError(
                f"{measured_record.record_path}: {v.name} starts at {column[0]:.4g} {v.unit}, "
                f"the system at 0; add {v.name} to the free parameters to fit its start value"
            )


@dataclass(frozen=True)
class _RecordSimulation:
    """Simulations of a system, to be compared with a measured record.

    fitted_row_count : number of rows that are fitted
    """

    measured_record: MeasuredRecord
    compiled_system: CompiledSystem
    fitted_row_count: int

    def simulate_columns(self, value_by_name: Mapping[str, float], row_count: int) -> Array:
        """Simulated columns (rows, columns) [SI] of the first rows of the record."""
        inputs = {name: column[:row_count] for name, column in self.measured_record.inputs.items()}
        return self.compiled_system.simulate(
            value_by_name, self.measured_record.time[:row_count], inputs, [*self.measured_record.outputs]
        )

    def measured_columns(self, row_count: int) -> Array:
        """Measured columns (rows, columns) [SI] of the first rows of the record."""
        return np.column_stack([column[:row_count] for column in self.measured_record.outputs.values()])

    def compute_misfit(self, value_by_name: Mapping[str, float], row_count: int) -> Array:
        """Simulated minus measured columns (rows, columns) [SI] of the record."""
        return self.simulate_columns(value_by_name, row_count) - self.measured_columns(row_count)

    def check_parameter_effects(self, unknowns: Sequence[Unknown]) -> None:
        """Raise ValueError for a fitted parameter that changes no simulated column of the record."""
        start = {u.parameter_name: u.start_value for u in unknowns}
        reference = self.simulate_columns(start, self.fitted_row_count)
        scale = np.std(self.measured_columns(self.fitted_row_count), axis=0)
        for u in unknowns:
            value = u.from_search_variable(
                u.to_search_variable(u.start_value) + EFFECT_CHECK_LOG_PARAMETER_STEP
            )
            changed = self.simulate_columns(start | {u.parameter_name: value}, self.fitted_row_count)
            if np.max(np.abs(changed - reference) / scale) < MIN_EFFECT_OVER_COLUMN_DEVIATION:
                raise ValueError(
                    f"{u.parameter_name} = {u.start_value:g} {u.si_unit} has no effect on "
                    f"{', '.join(self.measured_record.outputs)}; fit other parameters, or start from a value "
                    "with an effect"
                )

    def fit_parameters(self, unknowns: Sequence[Unknown]) -> tuple[FitSolution, Array]:
        """Fit the parameters; returns the solution, and the standard deviation of each column [SI].

        The covariance of the solution allows for correlated residuals. Its residuals are those of all
        columns, one after the other.
        """
        measured = self.measured_columns(self.fitted_row_count)
        smallest, current = MIN_NOISE_OVER_COLUMN_DEVIATION * np.std(measured, axis=0), list(unknowns)
        column_noise = np.maximum(np.sqrt(np.mean(np.diff(measured, 2, axis=0) ** 2, axis=0) / 6.0), smallest)

        steps = np.full(len(current), CENTRAL_DIFFERENCE_STEP_LIMITS[1])

        def fit_first_rows(
            searched_unknowns: Sequence[Unknown], row_count: int, fit_tolerance: float
        ) -> FitSolution:
            """Fit the unknowns to the first rows of the record."""
            solution = solve_least_squares(
                searched_unknowns,
                lambda values: (self.compute_misfit(values, row_count) / column_noise).T.ravel(),
                residual_deviation=1.0,
                convergence_tolerance=fit_tolerance,
                difference_steps=steps,
            )
            current[:] = [replace(u, start_value=solution.values[u.parameter_name]) for u in current]
            effects = np.sqrt(np.mean(solution.jacobian**2, axis=0))
            with np.errstate(divide="ignore"):
                steps[:] = np.clip(
                    DIFFERENCE_STEP_EFFECT_OVER_NOISE / effects, *CENTRAL_DIFFERENCE_STEP_LIMITS
                )
            return solution

        for share in FIRST_FIT_RECORD_SHARES:
            bounded = [_limit_unknown_bounds(u) for u in current]
            fit_first_rows(bounded, max(int(share * self.fitted_row_count), 2), FIRST_FITS_TOLERANCE)
        for update in range(MAX_NOISE_UPDATES):
            solution = fit_first_rows(current, self.fitted_row_count, FINAL_FIT_TOLERANCE)
            previous, misfit = (
                column_noise,
                solution.residuals.reshape(column_noise.size, -1).T * column_noise,
            )
            column_noise = np.maximum(np.sqrt(np.mean(misfit**2, axis=0)), smallest)
            if update and np.max(np.abs(np.log(column_noise / previous))) < RELATIVE_NOISE_TOLERANCE:
                break
        return replace(solution, unknowns=tuple(unknowns)), column_noise


def _limit_unknown_bounds(fitted_unknown: Unknown) -> Unknown:
    """Copy of an unknown whose bounds are at most MAX_LOG_CHANGE_IN_FIRST_FITS from its start value."""
    middle = fitted_unknown.to_search_variable(fitted_unknown.start_value)
    low, high = (
        fitted_unknown.from_search_variable(middle + d)
        for d in (-MAX_LOG_CHANGE_IN_FIRST_FITS, MAX_LOG_CHANGE_IN_FIRST_FITS)
    )
    bounds = max(fitted_unknown.lower_bound, low), min(fitted_unknown.upper_bound, high)
    return replace(fitted_unknown, lower_bound=bounds[0], upper_bound=bounds[1])


def _make_fit_result(
    estimation: _RecordSimulation,
    fit_solution: FitSolution,
    column_noise: Array,
    system_model: Model,
    start_parameter_file: ParameterFile,
) -> FitResult:
    """Make the result of the fit: confidence intervals, misfits of the columns, plots, notes."""
    record, count = estimation.measured_record, estimation.fitted_row_count
    columns = np.split(fit_solution.residuals, len(record.outputs))
    jacobian, quantile = whiten_jacobian(fit_solution.jacobian, columns)
    fit_solution = replace(
        fit_solution, jacobian=jacobian, noise=1.0, covariance=parameter_covariance(jacobian, 1.0)
    )
    misfit = estimation.compute_misfit(fit_solution.values, record.time.size)
    units = {v.name: v.unit for v in system_model.outputs}
    intervals = {
        u.parameter_name: (u.from_search_variable(middle - half), u.from_search_variable(middle + half))
        for u in fit_solution.unknowns
        for middle, half in [
            (
                u.to_search_variable(fit_solution.values[u.parameter_name]),
                quantile * fit_solution.relative_deviations[u.parameter_name],
            )
        ]
    }
    facts = {"rows": (float(count), "1", "rows of the record that are fitted")}
    notes = [
        f"column {name} is no variable of the system, and is not used" for name in record.unused_headings
    ]
    notes += [
        f"{u.parameter_name} is a start value of this record, and no part of the system file"
        for u in fit_solution.unknowns
        if u.parameter_name in units
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
                "for the correlation, but not for a model that is systematically wrong"
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
    names = {
        u.parameter_name: fit_solution.values[u.parameter_name]
        for u in fit_solution.unknowns
        if u.parameter_name not in units
    }
    first, last = record.time[0], record.time[count - 1]
    return FitResult(
        build_fitted_file(
            start_parameter_file,
            names,
            "measured",
            record.record_path.name,
            f"{first:.4g} to {last:.4g} s",
            find_undetermined_parameters(fit_solution),
        ),
        fit_solution,
        facts,
        [
            _make_column_plot(record, name, units[name], misfit[:, k], count)
            for k, name in enumerate(record.outputs)
        ],
        notes,
        intervals,
        doubt,
    )


def _root_mean_square(residuals: Array) -> float:
    """Root mean square of values (n)."""
    return float(np.sqrt(np.mean(residuals**2)))


def _make_column_plot(
    measured_record: MeasuredRecord,
    column_name: str,
    column_unit: str,
    column_misfit: Array,
    fitted_row_count: int,
) -> FitPlot:
    """Plot of one column over time: measured, fitted and predicted values; below measured minus simulated."""
    column = measured_record.outputs[column_name]
    shown, factor = plots.choose_plot_unit(column_unit, column)
    label = f"{column_name} ({shown})"
    simulated = factor * (column + column_misfit)
    return FitPlot(
        measured_x=measured_record.time,
        measured_y=factor * column,
        misfit=-factor * column_misfit,
        law_curve=(measured_record.time[:fitted_row_count], simulated[:fitted_row_count]),
        axis_labels=("time (s)", label, f"misfit ({shown})"),
        other_laws={"predicted": (measured_record.time[fitted_row_count:], simulated[fitted_row_count:])}
        if fitted_row_count < column.size
        else {},
    )
