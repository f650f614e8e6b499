"""Fit of the hysteresis of the harmonic drive to loops, decays, responses or logs.

`fit` keeps the midline (curve without hysteresis) of the start parameters (fit it with `torque-angle` first).
It adds the friction torque of the exported drive: the angle between the branches at zero torque determines
`hysteresis_loss`, the change of the torque after a reversal determines `hysteresis_stiffness`.

`fit_robot_log` also determines the stiffness. It needs a log with the angles of both joint and motor. The
wind-up is the joint angle minus the motor angle over the ratio; the torque is that of the teeth. The friction
torque follows the measured wind-up. The zero of the wind-up is a further unknown.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array

from ....inputs.fitting import hysteresis_fit
from ....inputs.fitting.branches import MeasuredLoops
from ....inputs.fitting.hysteresis import HysteresisLaw, NonlinearSpring
from ....inputs.fitting.least_squares import FitSolution, Unknown, solve_least_squares
from ....inputs.fitting.measurement import read_measurement
from ....inputs.fitting.outcome import (
    FitPlot,
    FitResult,
    build_fitted_file,
    find_undetermined_parameters,
    make_fit_unknowns,
)
from . import drive
from .drive import LOOP_COLUMN_NAMES, RAD_PER_ARCMIN
from .log_reading import LogSamples

HYSTERESIS_LOSS_NAME, HYSTERESIS_STIFFNESS_NAME = DEFAULT_FITTED_PARAMETERS = (
    "hysteresis_loss",
    "hysteresis_stiffness",
)
"""Parameters of the hysteresis, which are fitted if the user names none."""
DEFAULT_START_VALUES = {HYSTERESIS_LOSS_NAME: RAD_PER_ARCMIN, HYSTERESIS_STIFFNESS_NAME: 1.0}
"""Start values if the file has no hysteresis: loss [rad], and stiffness over K_WTS at zero torque [1]."""
HYSTERESIS_LOSS_START_VALUES = tuple(RAD_PER_ARCMIN * np.geomspace(0.03, 10.0, 7))
"""Further start values of the hysteresis loss [rad]."""
HYSTERESIS_STIFFNESS_STARTS_OVER_DRIVE_STIFFNESS = (0.3, 1.0, 3.0, 10.0)
"""Start values of the hysteresis stiffness over K_WTS at zero torque [1], besides the value in the file."""


def make_hysteresis_law(drive_parameters: DriveParameters) -> HysteresisLaw:
    """Make the hysteresis law of a drive: midline (elastic torque) and friction torque as in its FMU.

    Raises ValueError if the parameters allow no such hysteresis.
    """
    spring = HarmonicDriveSpring.tabulate(drive_parameters)
    stiffness, limit = spring.hysteresis.stiffness, spring.hysteresis.friction_limit
    curve = spring.curve

    def friction_torque(wind_up: Array) -> Array:
        """Friction torque [N.m] in first loading at wind-ups [rad]."""
        return np.asarray(np.sum(np.minimum(stiffness * wind_up[..., None], limit), axis=-1))

    def friction_work(wind_up: Array) -> Array:
        """Work [J] of the friction torque in first loading up to wind-ups [rad]."""
        stuck = np.minimum(wind_up[..., None], limit / stiffness)
        return np.asarray(np.sum(0.5 * stiffness * stuck**2 + limit * (wind_up[..., None] - stuck), axis=-1))

    def elastic_force(wind_up: Array) -> Array:
        """Torque [N.m] of the midline at wind-ups [rad] of either sign."""
        return np.copysign(curve.derivatives(np.abs(wind_up), 0)[0], wind_up)

    return HysteresisLaw(
        friction_torque,
        friction_work,
        NonlinearSpring(elastic_force, lambda motion: curve.energy(np.abs(motion))),
        drive_parameters.d,
    )


def fit(
    data_path: str | Path,
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    inertia: float | None = None,
) -> FitResult:
    """Fit a drive to a file of loops, decays, responses, or frequency and damping over the amplitude.

    Parameters
    ----------
    start_parameters : parameters to start from; None: the default drive
    fitted_names     : names to fit; None: DEFAULT_FITTED_PARAMETERS
    inertia          : [kg.m2] that vibrates on the drive; required unless the file has loops

    Raises ValueError with a one-line message for a bad file, unit or value, a loop that creates energy, or a
    name that cannot be fitted. Raises RuntimeError if the fit does not converge.
    """
    data = read_measurement(data_path, LOOP_COLUMN_NAMES)
    names = list(fitted_names or DEFAULT_FITTED_PARAMETERS)
    start_file = start_parameters or load_default("harmonic_drive")
    if isinstance(data.measured_data, MeasuredLoops):
        reach = 0.5 * float(np.ptp(data.measured_data.joint_force))
        wind_up = float(drive.compute_wind_up(start_file.values, np.array(reach)))
        LOOP_COLUMN_NAMES.check_stiffness_ratio(
            data.measurement_path, wind_up / data.largest_amplitude, data.stated_units, start_file
        )
    file, rest = _set_start_hysteresis(start_file, names)

    def make_law_with_values(parameter_values: Mapping[str, float]) -> HysteresisLaw:
        """Make the hysteresis law of the drive for values of the fitted parameters."""
        return make_hysteresis_law(file.with_values(parameter_values, "calibration", "fit").values)

    model = hysteresis_fit.build_measurement_model(data, make_law_with_values, "inertia", inertia, 0.0)
    starts = {
        HYSTERESIS_LOSS_NAME: HYSTERESIS_LOSS_START_VALUES,
        HYSTERESIS_STIFFNESS_NAME: tuple(rest * np.array(HYSTERESIS_STIFFNESS_STARTS_OVER_DRIVE_STIFFNESS)),
    }
    solution, scale, _ = hysteresis_fit.fit_measurement(
        data, make_fit_unknowns(file, names, drive.parameter_bounds(file)), model, starts
    )
    result = build_fitted_file(
        file,
        solution.values,
        "calibration",
        data.measurement_path.name,
        data.describe_range,
        find_undetermined_parameters(solution),
    )
    fitted_law = make_hysteresis_law(result.values)
    limit = float(fitted_law.friction_force(np.array([np.inf]))[0])
    law_facts = {"friction_torque": (limit, "N.m", "bound of the friction torque")}
    return FitResult(
        result,
        solution,
        law_facts | hysteresis_fit.summarize_fit(data, solution, fitted_law, scale),
        hysteresis_fit.make_fit_plots(data, model, solution.values, scale),
        notes=hysteresis_fit.list_misfit_notes(data, solution, fitted_law, scale),
    )


def _set_start_hysteresis(
    parameter_file: ParameterFile, fitted_names: Sequence[str]
) -> tuple[ParameterFile, float]:
    """Set non-zero hysteresis in the start parameters; also returns the stiffness [N.m/rad] at zero torque.

    The fit needs non-zero values, because its unknowns are logarithms.
    """
    rest = float(HarmonicDriveSpring.tabulate(parameter_file.values).curve.stiffness[0])
    first = {
        HYSTERESIS_LOSS_NAME: DEFAULT_START_VALUES[HYSTERESIS_LOSS_NAME],
        HYSTERESIS_STIFFNESS_NAME: DEFAULT_START_VALUES[HYSTERESIS_STIFFNESS_NAME] * rest,
    }
    absent = {
        name: value
        for name, value in first.items()
        if name in fitted_names and parameter_file.values_by_name[name] == 0.0
    }
    return parameter_file.with_values(absent, "calibration", "start"), rest


STIFFNESS_PARAMETER_NAMES = ("K1", "K2", "K3")
"""Stiffnesses of the law `catalogue`. The fit to a log needs this law."""
ROBOT_LOG_FITTED_PARAMETERS = (*STIFFNESS_PARAMETER_NAMES, HYSTERESIS_LOSS_NAME)
"""Parameters that `fit_robot_log` can fit."""
ROTOR_INERTIA_NAME = "motor_inertia"
"""Name of the unknown inertia of the rotor, which is fitted if the user does not state it."""
DEFAULT_HYSTERESIS_LOSS = 0.3 * RAD_PER_ARCMIN
"""Start value of hysteresis_loss [rad] if the file has no hysteresis."""
LOWER_BOUND_OVER_START_VALUE = 1e-2
"""Lower bound of hysteresis loss and of rotor inertia, over their start values [1]."""
IGNORED_FIRST_SAMPLE_COUNT = 10
"""Number of first samples that are ignored, because the history of the hysteresis is unknown there."""


def measured_wind_up(log_samples: LogSamples, speed_ratio: float) -> Array:
    """Wind-up (n) [rad] between joint and motor, minus its mean. The motor angle may have either sign."""
    sense = np.sign(
        np.dot(log_samples.q - log_samples.q.mean(), log_samples.motor_angle - log_samples.motor_angle.mean())
    )
    angle = log_samples.q - sense * log_samples.motor_angle / abs(speed_ratio)
    return np.asarray(angle - angle.mean())


def fit_rotor_inertia(
    parameter_file: ParameterFile,
    wind_ups: Array,
    torques: Array,
    torque_errors: Array,
    torque_per_inertia: Array,
    max_inertia: float,
) -> tuple[float, float] | None:
    """Fit the inertia of the rotor to measured wind-ups (n) [rad].

    torques                : (n) [N.m] that cause the wind-ups, for a rotor without inertia
    torque_errors          : (k, n) [N.m] change of the torques by each of k independent errors
    torque_per_inertia     : (n) [N.m/(kg.m2)] change of the torque by the inertia of the rotor
    max_inertia            : [kg.m2] upper bound: the total inertia belongs to the rotor

    Returns inertia and standard deviation [kg.m2]; None if the data do not determine them. Raises
    RuntimeError if the fit does not converge.
    """
    names = [name for name in ROBOT_LOG_FITTED_PARAMETERS if name in parameter_file.values_by_name]
    unknown = Unknown(
        ROTOR_INERTIA_NAME,
        "kg.m2",
        0.1 * max_inertia,
        LOWER_BOUND_OVER_START_VALUE * max_inertia,
        max_inertia,
    )
    solution, _ = _fit_wind_ups(
        parameter_file,
        names,
        wind_ups,
        lambda values: torques + values[ROTOR_INERTIA_NAME] * torque_per_inertia,
        torque_errors,
        [unknown],
    )
    inertia = solution.values[ROTOR_INERTIA_NAME]
    return (
        None
        if ROTOR_INERTIA_NAME in find_undetermined_parameters(solution)
        else (inertia, inertia * solution.relative_deviations[ROTOR_INERTIA_NAME])
    )


def fit_robot_log(
    parameter_file: ParameterFile,
    fitted_names: Sequence[str],
    wind_ups: Array,
    torques: Array,
    torque_errors: Array,
) -> tuple[FitSolution, FitPlot]:
    """Fit stiffness and hysteresis to measured wind-ups (n) [rad] at torques (n) [N.m].

    fitted_names  : names of the fitted parameters, some of ROBOT_LOG_FITTED_PARAMETERS
    torque_errors : (k, n) [N.m] change of the torques by each of k independent errors of the load, of one
                    standard deviation each; their effect is added to the covariance of the fit

    Raises RuntimeError if the fit does not converge.
    """
    solution, law = _fit_wind_ups(
        parameter_file, fitted_names, wind_ups, lambda values: torques, torque_errors
    )
    labels = "torque at the joint [N m]", "wind-up [arcmin]", "log - law [arcmin]"
    return solution, FitPlot(
        torques,
        wind_ups / RAD_PER_ARCMIN,
        (wind_ups - law) / RAD_PER_ARCMIN,
        (torques, law / RAD_PER_ARCMIN),
        labels,
    )


def _fit_wind_ups(
    parameter_file: ParameterFile,
    fitted_names: Sequence[str],
    wind_ups: Array,
    torque_function: Callable[[Mapping[str, float]], Array],
    torque_errors: Array,
    extra_unknowns: Sequence[Unknown] = (),
) -> tuple[FitSolution, Array]:
    """Fit stiffness and hysteresis of a drive to wind-ups (n) [rad].

    Returns the solution and the wind-up (n) [rad] of the law.

    torque_function : {name: value} -> torque (n) [N.m]
    torque_errors   : as in `fit_robot_log`
    extra_unknowns  : unknowns on which the torque depends
    """
    begin = (
        {HYSTERESIS_LOSS_NAME: DEFAULT_HYSTERESIS_LOSS}
        if parameter_file.values_by_name[HYSTERESIS_LOSS_NAME] == 0.0
        else {}
    )
    start = parameter_file.with_values(
        {n: v for n, v in begin.items() if n in fitted_names}, "calibration", "start"
    )
    path = wind_ups - wind_ups[0]

    def law_wind_up(parameter_values: Mapping[str, float], torques: Array) -> Array:
        """Wind-up (n) [rad] by the hysteresis law, shifted to the mean of the measured wind-up."""
        own_values = {name: parameter_values[name] for name in fitted_names}
        spring = HarmonicDriveSpring.tabulate(
            parameter_file.with_values(own_values, "calibration", "fit").values
        )
        wind_up_values = spring.curve.odd_inverse(torques - _hysteresis_torque(spring, path))
        return np.asarray(wind_up_values - np.mean((wind_up_values - wind_ups)[IGNORED_FIRST_SAMPLE_COUNT:]))

    all_unknowns = [
        *make_fit_unknowns(
            start,
            fitted_names,
            {
                HYSTERESIS_LOSS_NAME: (
                    LOWER_BOUND_OVER_START_VALUE * start.values_by_name[HYSTERESIS_LOSS_NAME],
                    np.inf,
                )
            },
        ),
        *extra_unknowns,
    ]
    solution = solve_least_squares(
        all_unknowns,
        lambda values: (wind_ups - law_wind_up(values, torque_function(values)))[IGNORED_FIRST_SAMPLE_COUNT:],
        nuisance_count=1,
    )
    fitted_torque = torque_function(solution.values)
    law = law_wind_up(solution.values, fitted_torque)
    for change in torque_errors:
        difference = (law_wind_up(solution.values, fitted_torque + change) - law)[IGNORED_FIRST_SAMPLE_COUNT:]
        parameter_changes = np.linalg.lstsq(solution.jacobian, difference)[0]
        solution = replace(
            solution, covariance=solution.covariance + np.outer(parameter_changes, parameter_changes)
        )
    return solution, law


def _hysteresis_torque(drive_spring: HarmonicDriveSpring, wind_up_path: Array) -> Array:
    """Friction torque (n) [N.m] of the hysteresis along wind-ups (n) [rad], starting at rest."""
    sliders = drive_spring.hysteresis
    if not sliders.has_friction:
        return np.zeros(wind_up_path.size)
    path_with_turns, sampled = _insert_turning_points(wind_up_path)
    return sliders.follow_increments(np.diff(path_with_turns, prepend=0.0), sliders.friction_limit)[sampled]


def _insert_turning_points(wind_up_path: Array) -> tuple[Array, NDArray[np.int_]]:
    """Insert its turning points into a path (n); also returns the indices (n) of the samples in the new path.

    A turning point between samples is the vertex of a parabola.
    """
    before, after = np.diff(wind_up_path)[:-1], np.diff(wind_up_path)[1:]
    turns = np.flatnonzero(before * after < 0.0)
    step_before, step_after = before[turns], after[turns]
    offset = 0.5 * (step_before + step_after) / (step_before - step_after)  # in steps after the sample
    vertex = wind_up_path[turns + 1] + 0.25 * (step_before + step_after) * offset
    # the vertex lies after the sample if `offset` is positive
    positions = turns + 1 + (offset > 0.0)
    sampled = np.arange(wind_up_path.size) + np.searchsorted(
        positions, np.arange(wind_up_path.size), side="right"
    )
    return np.insert(wind_up_path, positions, vertex), sampled
