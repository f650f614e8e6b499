"""Fit of hysteresis laws to measurements: model, search, derived facts, notes and plots.

The fits of all joints with hysteresis use this module.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ...common.plots import choose_plot_unit
from .branches import MeasuredLoops, sort_points_by_x
from .hysteresis import ForcedResponse, FreeVibration, HysteresisLaw, Oscillator
from .least_squares import (
    FitSolution,
    ResidualFunction,
    Unknown,
    UnknownExchange,
    select_start_values,
    solve_least_squares,
)
from .measurement import Measurement
from .outcome import DerivedFitValues, FitPlot, note_residual_correlation

DAMPING_RATIO_NAME = "damping_ratio"
"""Name of an unknown that is not a parameter of the joint: the damping ratio of the structure [1]."""
MAX_DAMPING_RATIO = 0.3
"""Upper limit of the damping ratio of the structure [1]."""
UNKNOWN_DAMPING_RATIO = Unknown(DAMPING_RATIO_NAME, "1", 1e-3, 1e-9, MAX_DAMPING_RATIO)
"""Damping ratio of the structure as an unknown of a fit."""
FIRST_FIT_TOLERANCE, SECOND_FIT_TOLERANCE = 1e-3, 1e-6
"""Relative change of cost or parameters at which the first and the second fit end [1]."""
FIRST_FIT_RELATIVE_NOISE = 0.01
"""Noise assumed in the first fit, over the size of the data [1]; it only sets the regularisation."""
MAX_LOOP_AREA_MISFIT, MAX_LOG_REST_STIFFNESS_MISFIT = 0.05, 0.2
"""Relative error of the loop area, and error of the logarithm of the stiffness after a reversal [1], from
which a note is printed."""
MIN_OVER_MAX_NOISE = 1e-9
"""Lower limit of the noise of a group, over the largest noise of all groups [1]; for data without noise."""

HysteresisLawFunction = Callable[[Mapping[str, float]], HysteresisLaw]
"""Function {name: value} of the unknowns -> hysteresis law."""


@dataclass(frozen=True, slots=True)
class MeasurementModel:
    """Computed counterpart of a measurement: hysteresis law for given unknowns, inertia, structural damping.

    make_law      : function {name: value} of the unknowns -> hysteresis law
    inertia       : mass [kg] or moment of inertia [kg.m2] on the joint; None for loops
    damping_ratio : damping ratio of the structure [1], if it is not an unknown
    """

    make_law: HysteresisLawFunction
    inertia: float | None
    damping_ratio: float

    def hysteresis_law(self, parameter_values: Mapping[str, float]) -> HysteresisLaw:
        """Hysteresis law for given values of the unknowns."""
        return self.make_law(
            {name: value for name, value in parameter_values.items() if name != DAMPING_RATIO_NAME}
        )

    def residuals(
        self,
        measured_data: MeasuredLoops | FreeVibration | ForcedResponse,
        parameter_values: Mapping[str, float],
        residual_scale: Array,
    ) -> Array:
        """Residuals of the data at values of the unknowns.

        residual_scale : standard deviations (n) of the data, by which the residuals are divided
        """
        law = self.hysteresis_law(parameter_values)
        if isinstance(measured_data, MeasuredLoops):
            return measured_data.residuals(law, residual_scale)
        return measured_data.residuals(self.make_oscillator(law, parameter_values), residual_scale)

    def make_oscillator(
        self, hysteresis_law: HysteresisLaw, parameter_values: Mapping[str, float]
    ) -> Oscillator:
        """Make the oscillator (mass on the joint) with a hysteresis law.

        The damping ratio of the structure may be an unknown in `parameter_values`.
        """
        assert self.inertia is not None
        return Oscillator(
            hysteresis_law, self.inertia, parameter_values.get(DAMPING_RATIO_NAME, self.damping_ratio)
        )


def build_measurement_model(
    measurement: Measurement,
    make_law: HysteresisLawFunction,
    inertia_option: str,
    inertia: float | None,
    damping_ratio: float,
) -> MeasurementModel:
    """Build the model of a measurement; check inertia and damping ratio.

    inertia_option : name of the option for the inertia, used in error messages

    Raises ValueError if the inertia is stated for loops, is missing for a vibration, or if inertia or damping
    ratio are out of range.
    """
    name = inertia_option.replace("_", " ")
    if measurement.measurement_kind == "loops":
        if inertia is not None:
            raise ValueError(
                f"{measurement.measurement_path}: has loops, so {name} has no effect; leave it out"
            )
    elif inertia is None:
        raise InputRefusal(
            f"{measurement.measurement_path}: has a vibration ({measurement.measurement_kind}); state the "
            f"{name}",
            inertia_option,
        )
    elif not 0.0 < inertia < np.inf:
        raise ValueError(f"{name} = {inertia:g} is outside (0, inf)")
    if not 0.0 <= damping_ratio < MAX_DAMPING_RATIO:
        raise ValueError(f"damping ratio = {damping_ratio:g} is outside [0, {MAX_DAMPING_RATIO:g})")
    return MeasurementModel(make_law, inertia, damping_ratio)


def fit_measurement(
    measurement: Measurement,
    unknowns: Sequence[Unknown],
    measurement_model: MeasurementModel,
    alternative_start_values: Mapping[str, Sequence[float]],
    stiffness_exchange: UnknownExchange | None = None,
    is_stiffness_exchanged: bool = False,
    correct_measurement: Callable[[Mapping[str, float]], Measurement] | None = None,
) -> tuple[FitSolution, Array, Measurement]:
    """Fit the unknowns twice: the first fit estimates the noise of each group of data, the second uses it.

    alternative_start_values : {name: alternative start values} of the search
    stiffness_exchange       : unknown that determines the stiffness of the joint at rest: its start value is
                               adjusted to the measured stiffness; None: no adjustment
    is_stiffness_exchanged   : whether the search varies the stiffness at rest in place of that unknown
    correct_measurement      : function: values of the first fit -> corrected measurement, used in the second
                               fit

    Returns the solution, the noise (n) of the data, and the measurement of the second fit.

    Raises ValueError and RuntimeError as `solve_least_squares`; ValueError if the law allows no start values.
    """
    data = measurement.measured_data

    def residuals(residual_scale: Array) -> ResidualFunction:
        """Residual function of the unknowns, for standard deviations of the data."""
        return lambda values: measurement_model.residuals(data, values, residual_scale)

    def apply_stiffness_exchange(residual_function: ResidualFunction) -> ResidualFunction:
        """Make the residuals a function of the stiffness at rest, in place of the unknown that determines it.

        If the search does not exchange an unknown, the function stays as it is.
        """
        if exchange is None:
            return residual_function
        current, start = exchange, original[exchange.exchanged_unknown_name].start_value
        return lambda values: residual_function(current.restore_unknowns(values, start))

    first_scale = data.residual_scale
    measured_stiffness = (
        None if stiffness_exchange is None else measurement.rest_stiffness(measurement_model.inertia)
    )

    def evaluate_start_values(parameter_values: dict[str, float]) -> tuple[Mapping[str, float], float]:
        """Start values, adjusted to the measured stiffness, and their sum of squared residuals."""
        if stiffness_exchange is not None and measured_stiffness is not None:
            others = {
                name: value
                for name, value in parameter_values.items()
                if name != stiffness_exchange.exchanged_unknown_name
            }
            parameter_values |= stiffness_exchange.restore_unknowns(
                others | {stiffness_exchange.quantity_label: measured_stiffness},
                parameter_values[stiffness_exchange.exchanged_unknown_name],
            )
        if any(not u.lower_bound < parameter_values[u.parameter_name] < u.upper_bound for u in unknowns):
            return parameter_values, np.inf
        return parameter_values, float(np.sum(residuals(first_scale)(parameter_values) ** 2))

    original = {
        u.parameter_name: u
        for u in select_start_values(unknowns, alternative_start_values, evaluate_start_values)
    }
    exchange = stiffness_exchange if is_stiffness_exchanged else None
    free = [
        exchange.derived_unknown(original)
        if exchange and u.parameter_name == exchange.exchanged_unknown_name
        else u
        for u in original.values()
    ]
    first = solve_least_squares(
        free,
        apply_stiffness_exchange(residuals(first_scale)),
        residual_deviation=FIRST_FIT_RELATIVE_NOISE,
        convergence_tolerance=FIRST_FIT_TOLERANCE,
    )
    first_residuals = first.residuals
    if correct_measurement is not None:
        measurement = correct_measurement(first.values)
        data = measurement.measured_data
        first_residuals = residuals(first_scale)(first.values)
    square = np.bincount(
        data.noise_group_of_residual, first_residuals[: first_scale.size] ** 2
    ) / np.bincount(data.noise_group_of_residual)
    scale = (
        first_scale
        * np.sqrt(np.maximum(square, MIN_OVER_MAX_NOISE**2 * np.max(square)))[data.noise_group_of_residual]
    )
    free = [replace(u, start_value=_clip_to_bounds(u, first.values[u.parameter_name])) for u in free]
    solution = solve_least_squares(
        free,
        apply_stiffness_exchange(residuals(scale)),
        nuisance_count=data.nuisance_count,
        convergence_tolerance=SECOND_FIT_TOLERANCE,
    )
    return (
        (exchange.express_in_original_unknowns(solution, original) if exchange else solution),
        scale,
        measurement,
    )


def _clip_to_bounds(unknown: Unknown, unclipped_value: float) -> float:
    """Clip a value to slightly inside of the bounds of an unknown."""
    low = max(unknown.lower_bound * (1.0 + 1e-6), 1e-300)
    return float(min(max(unclipped_value, low), unknown.upper_bound * (1.0 - 1e-6)))


def summarize_fit(
    measurement: Measurement, solution: FitSolution, hysteresis_law: HysteresisLaw, residual_scale: Array
) -> DerivedFitValues:
    """Derived values of a fit: number of points, amplitude, offset, loop area, loss factor, noise.

    residual_scale : noise (n) of the data
    """
    data, (_, unit) = measurement.measured_data, measurement.column_names.si_units
    result = {
        "points": (float(data.residual_scale.size), "1", "data points used"),
        "amplitude": (measurement.largest_amplitude, unit, measurement.describe_amplitude),
    }
    if isinstance(data, MeasuredLoops) and hysteresis_law.elastic_spring:
        result["offset"] = (
            data.rest_position(hysteresis_law, residual_scale),
            unit,
            f"{measurement.column_names.motion_column} at rest, taken off",
        )
    if isinstance(data, MeasuredLoops) and data.widest_loops:
        area, size = max(data.widest_loops, key=lambda loop: loop[1])
        result["loop_area"] = (area, "J", "measured, of the widest loop")
        result["loop_area_law"] = (
            float(hysteresis_law.loop_area(np.array([0.5 * size]))[0]),
            "J",
            "of the fitted law there",
        )
    _, loss = hysteresis_law.equivalent_spring(np.array([measurement.largest_amplitude]))
    result["loss_factor"] = (float(loss[0]), "1", "of the fitted law at the largest amplitude")
    group = data.noise_group_of_residual == 0 if isinstance(data, FreeVibration) else slice(None)
    misfit = solution.residuals[: residual_scale.size] * residual_scale
    if isinstance(data, MeasuredLoops):
        misfit = misfit / data.residual_scale
    result["noise"] = (float(np.sqrt(np.mean(misfit[group] ** 2))), "1", _NOISE_TEXTS[type(data)])
    return result


_NOISE_TEXTS = {
    MeasuredLoops: "standard deviation about the fitted law, over the range of the force or torque",
    FreeVibration: "relative standard deviation of the frequencies about the fitted law",
    ForcedResponse: "relative standard deviation of the amplitudes about the fitted law",
}
"""Meaning of the printed noise, by the class of the data."""


def list_misfit_notes(
    measurement: Measurement, solution: FitSolution, hysteresis_law: HysteresisLaw, residual_scale: Array
) -> list[str]:
    """Notes for the user if the law misses the data systematically; else empty.

    residual_scale : noise (n) of the data
    """
    data = measurement.measured_data
    if isinstance(data, ForcedResponse):
        return []
    residuals = solution.residuals[: data.noise_group_of_residual.size]
    same_group = np.diff(data.noise_group_of_residual) == 0
    notes = note_residual_correlation(residuals, "data", same_group)
    if not isinstance(data, MeasuredLoops):
        return notes
    if data.widest_loops:
        area, size = max(data.widest_loops, key=lambda loop: loop[1])
        ratio = float(hysteresis_law.loop_area(np.array([0.5 * size]))[0]) / area
        if abs(ratio - 1.0) > MAX_LOOP_AREA_MISFIT:
            notes.append(f"the fitted law has {ratio:.3g} times the measured area of the widest loop")
    unit = "/".join(measurement.column_names.si_units)
    ratio = data.rest_stiffness_over_law(hysteresis_law, residual_scale)
    if abs(np.log(ratio)) > MAX_LOG_REST_STIFFNESS_MISFIT:
        notes.append(
            f"after a reversal, the fitted law has {1.0 / ratio:.3g} times the stiffness of the data, "
            f"{data.rest_stiffness:.4g} {unit}: the law cannot follow the shape of the loops"
        )
    return notes


_PLOTTED_CURVE_POINTS = 120
"""Number of points of a plotted curve of the law [1]."""


def make_fit_plots(
    measurement: Measurement,
    measurement_model: MeasurementModel,
    parameter_values: Mapping[str, float],
    residual_scale: Array,
) -> Sequence[FitPlot]:
    """Make the plots of data and fitted law, by the kind of the measurement.

    Loops: force over motion. Forced vibration: amplitude over frequency. Free vibration: frequency over
    amplitude, and damping ratio over amplitude.
    """
    law = measurement_model.hysteresis_law(parameter_values)
    match measurement.measured_data:
        case MeasuredLoops() as loops:
            return [_make_loops_plot(measurement, loops, law, residual_scale)]
        case ForcedResponse() as response:
            return [
                _make_response_plot(
                    measurement, response, measurement_model.make_oscillator(law, parameter_values)
                )
            ]
        case FreeVibration() as free:
            return _make_decay_plots(
                measurement, free, measurement_model.make_oscillator(law, parameter_values)
            )


def _make_loops_plot(
    measurement: Measurement, loops: MeasuredLoops, hysteresis_law: HysteresisLaw, residual_scale: Array
) -> FitPlot:
    """Make the plot of measured loops: force over motion."""
    (force_unit, force_scale), (motion_unit, motion_scale) = (
        choose_plot_unit(unit, values)
        for unit, values in zip(
            measurement.column_names.si_units, (loops.joint_force, loops.joint_motion), strict=True
        )
    )
    lines = []
    hysteresis_law = hysteresis_law.with_rest_position(loops.rest_position(hysteresis_law, residual_scale))
    forces, starts, misfit = loops.fit_turning_points(hysteresis_law, residual_scale)
    for k, (force, start) in enumerate(zip(forces, starts, strict=True)):
        motion = np.linspace(
            start, loops.joint_motion[loops.branch_of_sample == k][-1], _PLOTTED_CURVE_POINTS
        )  # NaN separates the branches
        branch = force + hysteresis_law.force_change(motion, np.full(_PLOTTED_CURVE_POINTS, start))
        lines.append(np.append(np.stack([motion, branch]), [[np.nan], [np.nan]], axis=1))
    line = np.concatenate(lines, axis=1)
    names = measurement.column_names
    return FitPlot(
        measured_x=motion_scale * loops.joint_motion,
        measured_y=force_scale * loops.joint_force,
        misfit=force_scale * misfit,
        law_curve=(motion_scale * line[0], force_scale * line[1]),
        axis_labels=(
            f"{names.motion_column} [{motion_unit}]",
            f"{names.force_column} [{force_unit}]",
            f"data - law [{force_unit}]",
        ),
    )


def _make_response_plot(
    measurement: Measurement, forced_response: ForcedResponse, joint_oscillator: Oscillator
) -> FitPlot:
    """Plot of a forced vibration of a mass on the joint: amplitude over frequency, a curve for each force."""
    unit, size = choose_plot_unit(measurement.column_names.si_units[1], forced_response.motion_amplitude)
    lines = []
    for force in np.unique(forced_response.force_amplitude):
        inside = forced_response.force_amplitude == force
        f = np.linspace(
            forced_response.excitation_frequency[inside].min(),
            forced_response.excitation_frequency[inside].max(),
            4 * _PLOTTED_CURVE_POINTS,
        )
        measured = np.interp(
            f,
            *sort_points_by_x(
                forced_response.excitation_frequency[inside], forced_response.motion_amplitude[inside]
            ),
        )
        amplitude = joint_oscillator.response_amplitude(f, np.full_like(f, force), measured)
        lines.append(np.append(np.stack([f, amplitude]), [[np.nan], [np.nan]], axis=1))
    line = np.concatenate(lines, axis=1)
    return FitPlot(
        measured_x=forced_response.excitation_frequency,
        measured_y=size * forced_response.motion_amplitude,
        misfit=100.0 * np.expm1(forced_response.misfit(joint_oscillator)),
        law_curve=(line[0], size * line[1]),
        axis_labels=(
            "frequency [Hz]",
            f"{measurement.column_names.motion_column} [{unit}]",
            "data / law - 1 [%]",
        ),
    )


def _make_decay_plots(
    measurement: Measurement, free_vibration: FreeVibration, joint_oscillator: Oscillator
) -> tuple[FitPlot, FitPlot]:
    """Make plots of a free vibration of a mass on the joint: frequency and damping ratio over amplitude."""
    unit, size = choose_plot_unit(
        measurement.column_names.si_units[1], free_vibration.decay_points.motion_amplitude
    )
    a = free_vibration.decay_points.motion_amplitude
    grid = np.linspace(a.min(), a.max(), _PLOTTED_CURVE_POINTS)
    lines, (frequency, damping) = (
        joint_oscillator.free_vibration(grid),
        np.split(free_vibration.misfit(joint_oscillator), 2),
    )
    x = f"amplitude of the {measurement.column_names.motion_column} [{unit}]"
    return (
        FitPlot(
            measured_x=size * a,
            measured_y=free_vibration.decay_points.frequency,
            misfit=100.0 * frequency,
            law_curve=(size * grid, lines[0]),
            axis_labels=(x, "frequency [Hz]", "data / law - 1 [%]"),
        ),
        FitPlot(
            measured_x=size * a,
            measured_y=100.0 * free_vibration.decay_points.damping_ratio,
            misfit=100.0 * damping,
            law_curve=(size * grid, 100.0 * lines[1]),
            axis_labels=(x, "damping ratio [%]", "data - law [%]"),
        ),
    )
