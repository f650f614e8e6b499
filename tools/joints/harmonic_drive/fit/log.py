"""Fit of the friction of a harmonic drive to logs of a robot: motion over time, or tables of steady speeds.

For validation the last 30 % of each log, or every third row of a table, are predicted by a fit to the other
data.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import stats
from scipy.linalg import block_diag

from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal
from jointfmu.quantity.units import CELSIUS_ZERO_IN_KELVIN

from ....common.columns import parse_stated_headings
from ....inputs.fitting.least_squares import SOLUTION_WITHOUT_UNKNOWNS, FitSolution
from ....inputs.fitting.outcome import (
    DerivedFitValues,
    FitPlot,
    FitResult,
    build_fitted_file,
    find_undetermined_parameters,
)
from ..catalogue import find_drive
from ..new import NEW_JOINT_COMMAND
from . import hysteresis
from .drive import change_rated_torque
from .log_checks import (
    check_ratio,
    check_repeated_logs,
    check_torque_scale,
    find_friction_doubt,
    find_gravity_doubt,
)
from .log_friction import (
    BACK_DRIVING_LOSS_NAME,
    FITTABLE_FRICTION_PARAMETERS,
    FittedLogFriction,
    LinearTorqueTerms,
    accept_vanishing_friction,
    add_errors_of_kept_parameters,
    fit_friction_to_samples,
    fit_with_rotor_inertia,
    has_significant_friction,
    is_motion_driven_by_friction,
    refit_without_undetermined_parameters,
    select_friction_parameters,
)
from .log_reading import (
    COLUMN_UNITS,
    MIN_LARGEST_OVER_SMALLEST_SPEED,
    LogSamples,
    join_samples,
    make_measured_log,
    read_log_columns,
)
from .log_ripple import add_friction_ripples, find_friction_ripple_terms, fitted_friction_ripples

CONFIDENCE_LEVEL = 0.95
"""Confidence level of the intervals [1]."""
MAX_ROTOR_OVER_TOTAL_INERTIA, MAX_ROTOR_INERTIA_EXCESS_DEVIATIONS = 1.1, 4.0
"""Bound of the stated rotor inertia: first value times the fitted total inertia, plus second value times the
standard deviation of the total inertia [1]."""


def fit(
    log_paths: Sequence[Path],
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
    torque_constant: float | None = None,
    torque_at: str = "motor",
    drive: str | None = None,
    rated_torque: float | None = None,
    ratio: float | None = None,
    motor_inertia: float | None = None,
) -> FitResult:
    """Fit the friction of a drive to one or more logs of a robot.

    Parameters
    ----------
    start_parameters : parameters to start from; None: those of `drive`, or of `rated_torque` and `ratio`
    fitted_names     : names to fit; None: the parameters that the logs can determine
    columns          : `NAME=HEADING` or `NAME=HEADING [UNIT]`, for files with other headings
    torque_constant  : motor torque over motor current [N.m/A]
    torque_at        : side of the drive to which the torque in the column tau refers: "motor", or "joint"
                       (sensor behind the drive, or a controller that states torques at the joint)
    drive            : name of the drive in the catalogue
    rated_torque     : [N.m] of the drive
    ratio            : speed ratio [1]; None: that of `start_parameters` or `drive`
    motor_inertia    : [kg.m2] of the rotor, whose inertia torque does not load the teeth; None: fitted to the
                       wind-up, if the log has the motor angle; or to the motor torque, if the log has the
                       torque at the joint too

    Raises ValueError with a one-line message for a bad file, unit or value, or a name that cannot be fitted.
    Raises RuntimeError if the fit does not converge.
    """
    names = parse_stated_headings(columns or (), COLUMN_UNITS)
    tables = [read_log_columns(path, names) for path in log_paths]
    file = _select_start_parameters(start_parameters, drive, rated_torque, ratio)
    logs = [make_measured_log(table, torque_constant, file.values, torque_at) for table in tables]
    check_repeated_logs(logs)
    label = ", ".join(path.name for path in log_paths)
    if len({log.has_motor_torque for log in logs}) > 1:
        raise ValueError(f"{label}: some logs have no torque of the motor; expected it in all or in none")
    for log in logs:
        check_ratio(log, file.values)
        check_torque_scale(log, file.values, torque_constant)
    samples = join_samples(
        [log.log_samples.select_samples(log.log_samples.is_friction_developed) for log in logs]
    )
    logs_with_motor_angle = [
        log.log_samples
        for log in logs
        if np.all(np.isfinite(log.log_samples.motor_angle + log.log_samples.q))
    ]
    if not logs_with_motor_angle and (
        alone := [name for name in fitted_names or () if name in hysteresis.ROBOT_LOG_FITTED_PARAMETERS]
    ):
        raise ValueError(f"{label}: {alone[0]} needs the columns q and q_motor in addition to time")
    _check_speeds(label, samples)
    notes = _find_unused_column_notes(samples)
    friction_names = [
        name for name in fitted_names or () if name not in hysteresis.ROBOT_LOG_FITTED_PARAMETERS
    ]
    friction_samples = samples
    if not logs[0].has_motor_torque:
        friction_samples = replace(samples, sensor_torque=np.full(samples.dq.size, np.nan))
        if not has_significant_friction(friction_samples, file.values):
            return _fit_without_friction(
                file, label, samples, logs_with_motor_angle, fitted_names, friction_names
            )
        notes.append(
            "the torque at the joint contains the friction of the drive: it counts as motor torque times "
            "ratio"
        )
        logs_with_motor_angle = [
            replace(log, sensor_torque=np.full(log.q.size, np.nan)) for log in logs_with_motor_angle
        ]
    return _fit_with_friction(
        file,
        label,
        friction_samples,
        logs_with_motor_angle,
        fitted_names,
        friction_names,
        motor_inertia,
        torque_constant,
        notes,
    )


def _find_unused_column_notes(log_samples: LogSamples) -> list[str]:
    """Notes about columns of a log that the fit does not use."""
    if log_samples.has_joint_torque_sensor:
        if np.any(np.isfinite(log_samples.gravity_torque)):
            return ["gravity is not used: link_torque is the measured load"]
        return []
    if np.any(np.isfinite(log_samples.sensor_torque)):
        return ["link_torque is not used for the load: not all logs have it"]
    return []


def _fit_with_friction(
    parameter_file: ParameterFile,
    file_label: str,
    log_samples: LogSamples,
    logs_with_motor_angle: Sequence[LogSamples],
    fitted_names: Sequence[str] | None,
    friction_names: Sequence[str],
    motor_inertia: float | None,
    torque_constant: float | None,
    fit_notes: list[str],
) -> FitResult:
    """Fit friction, and stiffness if the motor angle is measured, to samples with developed friction.

    file_label     : names of the log files, for messages and sources of values
    friction_names : names of the friction parameters to fit; empty: select them
    fit_notes      : notes so far
    """
    if is_motion_driven_by_friction(log_samples, parameter_file.values):
        raise ValueError(
            f"{file_label}: friction drives the motion; reverse the sign of one column or of "
            "--torque-constant"
        )
    rotor_inertia = motor_inertia or 0.0
    names_to_fit, selection_notes = select_friction_parameters(
        log_samples, parameter_file.values, friction_names, rotor_inertia
    )
    fit_notes = [*fit_notes, *selection_notes]
    fitted_log = fit_friction_to_samples(parameter_file, log_samples, names_to_fit, rotor_inertia)
    if rotor_inertia and log_samples.is_of_dynamic_log.any():
        _check_rotor_inertia(rotor_inertia, fitted_log)
    kept_names: list[str] = []
    if not friction_names:
        selected_names = names_to_fit
        fitted_log, names_to_fit, dropped = refit_without_undetermined_parameters(
            parameter_file, log_samples, fitted_log, selected_names
        )
        kept_names = [name for name in selected_names if name not in names_to_fit]
        fit_notes += dropped
    if (
        log_samples.is_of_dynamic_log.any()
        and motor_inertia is None
        and not log_samples.has_joint_torque_sensor
    ):
        if logs_with_motor_angle and (
            rotor_fit := _fit_rotor_inertia(
                parameter_file,
                logs_with_motor_angle[0],
                add_errors_of_kept_parameters(parameter_file, log_samples, fitted_log, kept_names),
            )
        ):
            fitted_log = fit_with_rotor_inertia(parameter_file, log_samples, names_to_fit, *rotor_fit)
        else:
            fit_notes.append(
                "without --motor-inertia the rotor counts as part of the arm: load_loss and the stiffness "
                "have an error equal to the share of the rotor in the inertia"
            )
    log_samples, harmonics = find_friction_ripple_terms(log_samples, fitted_log)
    if harmonics:
        rotor, deviation = fitted_log.rotor_inertia, fitted_log.rotor_inertia_deviation
        fitted_log = (
            fit_with_rotor_inertia(parameter_file, log_samples, names_to_fit, rotor, deviation)
            if deviation > 0.0
            else fit_friction_to_samples(parameter_file, log_samples, names_to_fit, rotor)
        )
    fitted_log = add_errors_of_kept_parameters(parameter_file, log_samples, fitted_log, kept_names)
    fitted_log, vanishing_notes = accept_vanishing_friction(fitted_log)
    fit_notes += vanishing_notes
    if (
        log_samples.has_joint_torque_sensor
        and BACK_DRIVING_LOSS_NAME in fitted_log.friction_solution.names_at_bound
    ):
        fit_notes.append(
            "while the load drives the motor, the friction falls with the load: check --torque-constant, and "
            "the scale of link_torque"
        )
    solution, drawn_pictures = (
        fitted_log.friction_solution,
        [*draw_friction_pictures(log_samples, fitted_log)],
    )
    intervals = _confidence_intervals(fitted_log.friction_solution)
    if logs_with_motor_angle:
        stiffness_fit, link_notes = _fit_stiffness(
            parameter_file, logs_with_motor_angle[0], fitted_log, fitted_names
        )
        fit_notes += link_notes
        if stiffness_fit is not None:
            solution = _combine_solutions(solution, stiffness_fit[0])
            drawn_pictures = [*drawn_pictures, stiffness_fit[1]]
            intervals |= _confidence_intervals(stiffness_fit[0])
    doubts = (
        find_gravity_doubt(log_samples),
        find_friction_doubt(log_samples, fitted_log, parameter_file.values, torque_constant),
    )
    result, ripple_facts, ripple_notes = add_friction_ripples(
        _make_fitted_parameter_file(parameter_file, file_label, log_samples, solution, intervals),
        fitted_friction_ripples(fitted_log, harmonics),
        f"fitted to {file_label}, {_describe_speed_and_temperature_ranges(log_samples)}",
        CONFIDENCE_LEVEL,
    )
    return FitResult(
        result,
        solution,
        ripple_facts | summarise_friction_fit(parameter_file, log_samples, fitted_log, names_to_fit),
        drawn_pictures,
        notes=[*fit_notes, *ripple_notes],
        confidence_intervals=intervals,
        procedure_rejection_reason=next((doubt for doubt in doubts if doubt), None),
    )


def _fit_without_friction(
    parameter_file: ParameterFile,
    file_label: str,
    log_samples: LogSamples,
    logs_with_motor_angle: Sequence[LogSamples],
    fitted_names: Sequence[str] | None,
    friction_names: Sequence[str],
) -> FitResult:
    """Fit a log whose torque is measured at the joint: load, and stiffness if the motor angle is measured.

    Raises ValueError if the user wants to fit a friction parameter.
    """
    if friction_names:
        raise ValueError(
            f"{file_label}: the torque at the joint has no friction of the drive, {friction_names[0]} needs "
            "the torque or the current of the motor too"
        )
    notes = [
        f"the log does not determine {', '.join(FITTABLE_FRICTION_PARAMETERS)}, which keep their values: the "
        "torque at the joint has no friction of the drive; torque (tau) or current (i) of the motor are "
        "needed too"
    ]
    solution, pictures, intervals = SOLUTION_WITHOUT_UNKNOWNS, [_draw_load_picture(log_samples)], {}
    if logs_with_motor_angle:
        stiffness_fit, more_notes = _fit_stiffness(
            parameter_file, logs_with_motor_angle[0], None, fitted_names
        )
        notes += more_notes
        if stiffness_fit is not None:
            solution, intervals = stiffness_fit[0], _confidence_intervals(stiffness_fit[0])
            pictures.append(stiffness_fit[1])
    else:
        notes.append(
            f"the log does not determine {', '.join(hysteresis.ROBOT_LOG_FITTED_PARAMETERS)}, which "
            "keep their values: "
            "the angle of the motor (q_motor) is needed"
        )
    return FitResult(
        _make_fitted_parameter_file(parameter_file, file_label, log_samples, solution, intervals),
        solution,
        summarise_load(log_samples),
        pictures,
        notes=notes,
        confidence_intervals=intervals,
    )


def _make_fitted_parameter_file(
    parameter_file: ParameterFile,
    file_label: str,
    log_samples: LogSamples,
    fit_solution: FitSolution,
    confidence_intervals: Mapping[str, tuple[float, float]],
) -> ParameterFile:
    """Make the parameter file with the fitted values; the sources of the values state their intervals."""
    result = build_fitted_file(
        parameter_file,
        fit_solution.values,
        "calibration",
        file_label,
        _describe_speed_and_temperature_ranges(log_samples),
        [name for name in fit_solution.values if name not in confidence_intervals],
    )
    for name, interval in confidence_intervals.items():
        text = "{:g} % interval {:.4g} to {:.4g}".format(100.0 * CONFIDENCE_LEVEL, *interval)
        result = result.with_values(
            {name: fit_solution.values[name]}, "calibration", f"{result.sources[name]}; {text}"
        )
    return result


def _check_rotor_inertia(rotor_inertia: float, fitted_log: FittedLogFriction) -> None:
    """Check the rotor inertia [kg.m2]. Raises ValueError if it exceeds the total inertia in the log."""
    at_joint = rotor_inertia * fitted_log.fitted_drive.ratio**2
    limit = (
        MAX_ROTOR_OVER_TOTAL_INERTIA * fitted_log.total_inertia
        + MAX_ROTOR_INERTIA_EXCESS_DEVIATIONS * float(np.sqrt(fitted_log.linear_unknown_covariance[0, 0]))
    )
    if at_joint > limit:
        hint = (
            f"; stated at the joint, it is {rotor_inertia / fitted_log.fitted_drive.ratio**2:.3g} kg.m2 "
            "of the rotor"
        )
        raise ValueError(
            f"--motor-inertia = {rotor_inertia:g} kg.m2 times ratio^2 is {at_joint:.4g} kg.m2 at "
            "the joint, outside "
            f"[0, {limit:.4g}] kg.m2, of arm and rotor in the log{hint if rotor_inertia <= limit else ''}"
        )


def _fit_rotor_inertia(
    parameter_file: ParameterFile, log_samples: LogSamples, fitted_log: FittedLogFriction
) -> tuple[float, float] | None:
    """Fit the rotor inertia and its standard deviation [kg.m2]; None if the log does not determine them."""
    if parameter_file.law != "catalogue":
        return None
    square = fitted_log.fitted_drive.ratio**2
    load, spread = fitted_log.evaluate_transmitted_torque_and_deviations(log_samples)
    phi = hysteresis.measured_wind_up(log_samples, abs(fitted_log.fitted_drive.ratio))
    return hysteresis.fit_rotor_inertia(
        parameter_file, phi, -load, -spread, square * log_samples.ddq, fitted_log.total_inertia / square
    )


def _fit_stiffness(
    parameter_file: ParameterFile,
    log_samples: LogSamples,
    fitted_log: FittedLogFriction | None,
    fitted_names: Sequence[str] | None,
) -> tuple[tuple[FitSolution, FitPlot] | None, list[str]]:
    """Fit stiffness and hysteresis to a log with the motor angle.

    fitted_log : friction fitted before; it gives the joint torque if the log has no torque sensor

    Returns two values: (solution, plot of the fit), which is None if the log cannot be fitted; and a list of
    the reasons, for the user.
    """
    if fitted_names and not any(name in hysteresis.ROBOT_LOG_FITTED_PARAMETERS for name in fitted_names):
        return None, []
    names = [
        name
        for name in hysteresis.ROBOT_LOG_FITTED_PARAMETERS
        if name in parameter_file.values_by_name and (not fitted_names or name in fitted_names)
    ]
    if parameter_file.law != "catalogue" or not names:
        return None, ["stiffness and hysteresis are fitted only if the start file has law = catalogue"]
    load, spread = log_samples.sensor_torque, np.zeros((0, log_samples.q.size))
    if not log_samples.has_joint_torque_sensor:
        assert fitted_log is not None
        load, spread = fitted_log.evaluate_transmitted_torque_and_deviations(log_samples)
    return hysteresis.fit_robot_log(
        parameter_file,
        names,
        hysteresis.measured_wind_up(log_samples, abs(parameter_file.values.ratio)),
        -load,
        -spread,
    ), []


def _combine_solutions(first_solution: FitSolution, second_solution: FitSolution) -> FitSolution:
    """Combine two independent fits to one solution; residuals are divided by the noise of each fit."""
    scaled = [
        (fit.residuals / fit.noise, fit.jacobian / fit.noise) for fit in (first_solution, second_solution)
    ]
    return FitSolution(
        unknowns=(*first_solution.unknowns, *second_solution.unknowns),
        values={**first_solution.values, **second_solution.values},
        residuals=np.concatenate([residuals for residuals, _ in scaled]),
        noise=1.0,
        jacobian=block_diag(*(jacobian for _, jacobian in scaled)),
        covariance=block_diag(first_solution.covariance, second_solution.covariance),
        names_at_bound=(*first_solution.names_at_bound, *second_solution.names_at_bound),
        refusal_message=first_solution.refusal_message or second_solution.refusal_message,
    )


def _select_start_parameters(
    start_parameters: ParameterFile | None,
    drive_name: str | None,
    rated_torque: float | None,
    speed_ratio: float | None,
) -> ParameterFile:
    """Start parameters of a fit: of a file, a catalogue drive, or a drive with a rated torque and ratio.

    Raises ValueError unless the drive is stated in exactly one way, and InputRefusal if its ratio is missing.
    """
    given = [
        name
        for name, value in {
            "--params": start_parameters,
            "--drive": drive_name,
            "--rated-torque": rated_torque,
        }.items()
        if value is not None
    ]
    if not given:
        raise ValueError(
            "the log does not state the drive; expected --params FILE, --drive NAME (jointfmu catalogue), or "
            "--rated-torque with --ratio"
        )
    if len(given) > 1:
        raise ValueError(f"{' and '.join(given)} both state the drive; expected one of them")
    if start_parameters is not None:
        file = start_parameters
    elif drive_name is not None:
        file = _make_catalogue_drive(drive_name, speed_ratio)
    else:
        assert rated_torque is not None
        if speed_ratio is None:
            raise InputRefusal(
                f"rated torque = {rated_torque:g} N.m does not state the ratio; state both", "ratio"
            )
        default = load_default("harmonic_drive")
        max_torque_ratio = default.values.max_table_torque / default.values.rated_torque
        file = change_rated_torque(default, rated_torque, max_torque_ratio, "user", "stated with the log")
    return file if speed_ratio is None else file.with_values({"ratio": speed_ratio}, "user", "stated")


def _make_catalogue_drive(drive_name: str, speed_ratio: float | None) -> ParameterFile:
    """Parameters of a drive of the catalogue; a stated ratio selects the drive of this ratio.

    A stated ratio that is the catalogue's ratio plus 1 means that the flexspline is fixed.
    """
    options = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | {
        "catalogue": drive_name
    }
    if speed_ratio is not None:
        is_flexspline_fixed = abs(speed_ratio) == find_drive(drive_name).known_numbers["ratio"].si_value + 1.0
        options |= {"fixed": "flexspline"} if is_flexspline_fixed else {"ratio": f"{abs(speed_ratio):g}"}
    return NEW_JOINT_COMMAND.make_joint(options).parameter_file


def _check_speeds(file_label: str, log_samples: LogSamples) -> None:
    """Raise ValueError if the speeds of a log are too similar to separate the parts of the friction.

    The largest joint speed must be at least MIN_LARGEST_OVER_SMALLEST_SPEED times the smallest one.
    """
    speed = np.abs(log_samples.dq)
    speed = speed[speed > 0.0]
    if speed.size == 0:
        raise ValueError(
            f"{file_label}: the joint never turns far enough in one direction for friction to build up; "
            "record motions with larger angles between reversals"
        )
    if speed.max() < MIN_LARGEST_OVER_SMALLEST_SPEED * speed.min():
        raise ValueError(
            f"{file_label}: the speed varies only from {speed.min():.4g} to {speed.max():.4g} rad/s; "
            f"expected a largest speed of at least {MIN_LARGEST_OVER_SMALLEST_SPEED:g} times the smallest"
        )


def _confidence_intervals(fit_solution: FitSolution) -> dict[str, tuple[float, float]]:
    """Confidence intervals {parameter: (low, high)} of a fit, by Student's t over the logarithm.

    Parameters that the data do not determine have none.
    """
    spare = max(fit_solution.residuals.size - len(fit_solution.unknowns), 1)
    factor = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE_LEVEL, spare))
    loose = find_undetermined_parameters(fit_solution)
    return {
        name: (
            fit_solution.values[name] * np.exp(-factor * d),
            fit_solution.values[name] * np.exp(factor * d),
        )
        for name, d in fit_solution.relative_deviations.items()
        if name not in loose
    }


def _describe_speed_and_temperature_ranges(log_samples: LogSamples) -> str:
    """Describe the ranges of speed and temperature in logs, as text."""
    speed = np.abs(log_samples.dq)
    text = f"speeds of the joint {speed.min():.3g} to {speed.max():.3g} rad/s"
    known = log_samples.temperature[np.isfinite(log_samples.temperature)]
    return text + (f", {known.min():.5g} to {known.max():.5g} K" if known.size else "")


def summarise_friction_fit(
    parameter_file: ParameterFile,
    log_samples: LogSamples,
    fitted_log: FittedLogFriction,
    fitted_names: Sequence[str],
) -> DerivedFitValues:
    """Summarise the friction fit: inertia, offset, gravity, residual, error of held-out samples."""
    ratio = abs(fitted_log.fitted_drive.ratio)
    terms = LinearTorqueTerms.evaluate_at_samples(log_samples, ratio)
    facts = {
        name: (float(value), _LOAD_UNKNOWN_UNITS[name], _LOAD_UNKNOWN_MEANINGS[name])
        for name, value in zip(terms.unknown_names, fitted_log.linear_unknowns, strict=True)
        if name in _LOAD_UNKNOWN_UNITS
    }
    if log_samples.has_joint_torque_sensor and "inertia" in facts:
        rotor = facts.pop("inertia")[0] / ratio**2
        facts["motor_inertia"] = rotor, "kg.m2", "of the rotor, from motor torque and link_torque"
        facts |= summarise_load(log_samples)
    if fitted_log.rotor_inertia_deviation:
        text = f"of the rotor, from the wind-up; standard deviation {fitted_log.rotor_inertia_deviation:.2g}"
        facts["motor_inertia"] = fitted_log.rotor_inertia, "kg.m2", text
    facts["residual"] = (
        _root_mean_square(
            log_samples.motor_torque - fitted_log.evaluate_friction_and_motor_torque(log_samples)[1]
        ),
        "N.m",
        "root mean square, at the motor",
    )
    early, late = (
        log_samples.select_samples(~log_samples.is_held_out),
        log_samples.select_samples(log_samples.is_held_out),
    )
    if late.dq.size and early.dq.size > len(fitted_names) + len(terms.unknown_names):
        early_fit = fit_friction_to_samples(parameter_file, early, fitted_names, fitted_log.rotor_inertia)
        error = _root_mean_square(late.motor_torque - early_fit.evaluate_friction_and_motor_torque(late)[1])
        facts["held_out"] = (
            error,
            "N.m",
            f"the same of {late.dq.size} samples that a fit to the rest predicts",
        )
        guess = _root_mean_square(late.motor_torque - _constant_friction_torque(early, late, ratio))
        facts["held_out_constant"] = (guess, "N.m", "the same of a constant in the place of friction")
    return facts


_LOAD_UNKNOWN_UNITS = {
    "inertia": "kg.m2",
    "offset": "N.m",
    "gravity_cos": "N.m",
    "gravity_sin": "N.m",
    "arm_inertia": "kg.m2",
}
"""Units of the unknowns of the load: {name: unit}."""
_LOAD_UNKNOWN_MEANINGS = {
    "inertia": "of arm and rotor at the joint",
    "offset": "of the motor's torque",
    "gravity_cos": "cos(q) part of gravity at the joint",
    "gravity_sin": "sin(q) part of gravity at the joint",
    "arm_inertia": "of the arm, from link_torque",
}
"""Meanings of the unknowns of the load: {name: text}."""


def summarise_load(log_samples: LogSamples) -> DerivedFitValues:
    """Summarise the load that a torque sensor at the joint measures: inertia of the arm, gravity."""
    rows = np.flatnonzero(log_samples.is_of_dynamic_log)
    if not rows.size:
        return {}
    columns = {"arm_inertia": log_samples.ddq[rows], "sensor_offset": np.ones(rows.size)}
    if np.all(np.isfinite(angle := log_samples.q[rows])):
        columns |= {"gravity_cos": np.cos(angle), "gravity_sin": np.sin(angle)}
    values = np.linalg.lstsq(np.stack([*columns.values()], axis=1), log_samples.sensor_torque[rows])[0]
    return {
        name: (float(value), _LOAD_UNKNOWN_UNITS[name], _LOAD_UNKNOWN_MEANINGS[name])
        for name, value in zip(columns, values, strict=True)
        if name in _LOAD_UNKNOWN_UNITS
    }


def _draw_load_picture(log_samples: LogSamples) -> FitPlot:
    """Picture of the torque at the joint over the speed of the joint, and of the fitted load."""
    facts = summarise_load(log_samples)
    angle = np.where(np.isfinite(log_samples.q), log_samples.q, 0.0)
    parts = {"arm_inertia": log_samples.ddq, "gravity_cos": np.cos(angle), "gravity_sin": np.sin(angle)}
    load = sum((facts[name][0] * parts[name] for name in facts), np.zeros(angle.size))
    load += np.mean(log_samples.sensor_torque - load)
    return FitPlot(
        log_samples.dq,
        log_samples.sensor_torque,
        log_samples.sensor_torque - load,
        (log_samples.dq, load),
        ("speed of the joint [rad/s]", "torque at the joint [N.m]", "log - inertia and gravity [N.m]"),
    )


def _constant_friction_torque(
    earlier_samples: LogSamples, later_samples: LogSamples, speed_ratio: float
) -> Array:
    """Motor torque (n) [N.m] of later samples, by a model with constant friction fitted to earlier ones."""
    models = []
    for samples in (earlier_samples, later_samples):
        terms = LinearTorqueTerms.evaluate_at_samples(samples, speed_ratio)
        models.append(
            (
                np.concatenate([np.ones((samples.dq.size, 1)), terms.design_matrix], axis=1),
                terms.measured_load_torque,
            )
        )
    (early_matrix, early_known), (late_matrix, late_known) = models
    return np.asarray(
        late_matrix @ np.linalg.lstsq(early_matrix, earlier_samples.motor_torque - early_known)[0]
        + late_known
    )


def _root_mean_square(residual_values: Array) -> float:
    """Root mean square of values."""
    return float(np.sqrt(np.mean(residual_values**2)))


MILLI_PER_UNIT = 1e3
"""Factor from SI to milli-units in pictures [1]."""
_FRICTION_AXIS_LABEL, _ERROR_AXIS_LABEL = "friction at the motor [mN m]", "log - law [mN m]"
_NO_LOAD_FRICTION_AXIS_LABEL, _TEMPERATURE_AXIS_LABEL = (
    "friction without load [mN m]",
    "temperature [degrees C]",
)


def draw_friction_pictures(log_samples: LogSamples, fitted_log: FittedLogFriction) -> Iterator[FitPlot]:
    """Draw the friction over speed, time and temperature, as far as the log has these columns."""
    braked, torque = fitted_log.evaluate_friction_and_motor_torque(log_samples)
    misfit = log_samples.motor_torque - torque
    measured = braked + misfit
    yield _draw_friction_over_speed(log_samples, fitted_log, misfit)
    if log_samples.is_of_dynamic_log.any():
        rows = np.flatnonzero(log_samples.is_of_dynamic_log)
        time = log_samples.time[rows]
        yield _draw_friction_picture(time, measured[rows], misfit[rows], (time, braked[rows]), "time [s]")
    if (known := np.flatnonzero(np.isfinite(log_samples.temperature))).size:
        warmth = log_samples.temperature[known] - CELSIUS_ZERO_IN_KELVIN
        ends = np.array([warmth.min(), warmth.max()])
        over, rest = measured[known] / braked[known], MILLI_PER_UNIT * misfit[known]
        yield FitPlot(
            warmth,
            over,
            rest,
            (ends, np.ones(2)),
            (_TEMPERATURE_AXIS_LABEL, "friction, log over law", _ERROR_AXIS_LABEL),
        )


def _draw_friction_over_speed(
    log_samples: LogSamples, fitted_log: FittedLogFriction, friction_misfit: Array
) -> FitPlot:
    """Picture of the no-load friction over speed, at the median temperature; held-out rows are marked."""
    fastest = float(np.max(np.abs(log_samples.dq)))
    speed = np.linspace(-fastest, fastest, 400)
    known = log_samples.temperature[np.isfinite(log_samples.temperature)]
    usual = float(np.median(known)) if known.size else np.nan
    y = fitted_log.no_load_friction(log_samples.dq, usual) + friction_misfit
    line = (speed, fitted_log.no_load_friction(speed, usual))
    picture = _draw_friction_picture(log_samples.dq, y, friction_misfit, line, "speed of the joint [rad/s]")
    marks = None if log_samples.is_of_dynamic_log.any() else log_samples.is_held_out
    labels = (picture.axis_labels[0], _NO_LOAD_FRICTION_AXIS_LABEL, _ERROR_AXIS_LABEL)
    return replace(picture, axis_labels=labels, highlighted_points=marks)


def _draw_friction_picture(
    abscissa_values: Array,
    friction_torque: Array,
    friction_misfit: Array,
    law_curve: tuple[Array, Array],
    abscissa_label: str,
) -> FitPlot:
    """Plot of friction torques (n) [N.m] over an abscissa (n): log, law, and errors (n) [N.m] of the law."""
    return FitPlot(
        abscissa_values,
        MILLI_PER_UNIT * friction_torque,
        MILLI_PER_UNIT * friction_misfit,
        (law_curve[0], MILLI_PER_UNIT * law_curve[1]),
        (abscissa_label, _FRICTION_AXIS_LABEL, _ERROR_AXIS_LABEL),
    )
