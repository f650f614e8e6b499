"""Least-squares fit of the friction of a drive to samples of logs. Model of the motor torque [N.m]:

    torque = friction(|ratio| dq, load, temperature) + inertia ddq/|ratio| + gravity/|ratio| + offset

All torques are positive in the direction of the joint angle q, so that the ratio has no sign. With a torque
sensor at the joint, the measured torque over the ratio takes the place of gravity and of the inertia torque
of the arm; the inertia is then that of the rotor. Three terms are linear in their unknowns and are
eliminated: the inertia, an offset of the current, and gravity = a cos(q) + b sin(q) if it is not measured.
The load, the torque that the teeth transmit, is gravity plus the inertia torque of the arm, that is of the
total inertia without the rotor; or the torque of the sensor. The other unknowns are fitted over their
logarithms. The load depends on them: it is fixed during each fit, and updated for the next of
LOAD_ITERATION_COUNT fits.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.friction import REFERENCE_TEMPERATURE, friction_limits, viscous_torque
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....inputs.fitting.least_squares import FitSolution, parameter_covariance, solve_least_squares
from ....inputs.fitting.outcome import make_fit_unknowns
from .log_reading import LogSamples


@dataclass(frozen=True, slots=True)
class LinearTorqueTerms:
    """Terms of the motor torque that are linear in their unknowns: inertia, offset, gravity.

    design_matrix        : (n, k) motor torque at n samples per unit of each of k unknowns
    measured_load_torque : (n) [N.m] motor torque that balances the torque of the sensor at the joint, or
                           else the measured gravity; 0 if neither is measured
    unknown_names        : names (k) of the unknowns
    """

    design_matrix: Array
    measured_load_torque: Array
    unknown_names: tuple[str, ...]

    @classmethod
    def evaluate_at_samples(cls, log_samples: LogSamples, speed_ratio: float) -> "LinearTorqueTerms":
        """Evaluate inertia, offset and gravity terms of the motor torque at samples; speed ratio > 0."""
        columns: dict[str, Array] = {}
        dynamic = log_samples.is_of_dynamic_log.astype(float)
        measured_load = (
            log_samples.sensor_torque if log_samples.has_joint_torque_sensor else log_samples.gravity_torque
        )
        measured = np.isfinite(measured_load)
        if dynamic.any():
            columns = {"inertia": log_samples.ddq / speed_ratio, "offset": dynamic}
            swung = dynamic * np.isfinite(log_samples.q) * ~measured
            if swung.any():
                angle = np.where(np.isfinite(log_samples.q), log_samples.q, 0.0)
                columns |= {
                    "gravity_cos": swung * np.cos(angle) / speed_ratio,
                    "gravity_sin": swung * np.sin(angle) / speed_ratio,
                }
        columns |= {
            f"ripple_{number}": column for number, column in enumerate(log_samples.ripple_terms.T.copy())
        }
        matrix = np.stack([*columns.values()], axis=1) if columns else np.zeros((log_samples.dq.size, 0))
        known = np.where(measured, measured_load, 0.0) / speed_ratio
        return cls(matrix, known, tuple(columns))

    def solve_linear_unknowns(self, frictionless_torque: Array) -> Array:
        """Solve for inertia, offset and gravity (k) by least squares, from motor torques without friction."""
        return (
            np.asarray(np.linalg.lstsq(self.design_matrix, frictionless_torque)[0])
            if self.unknown_names
            else np.zeros(0)
        )

    def evaluate_transmitted_torque(
        self, log_samples: LogSamples, linear_unknowns: Array, speed_ratio: float, rotor_inertia: float
    ) -> Array:
        """Torque (n) [N.m] that the teeth transmit to the arm, at the joint, positive in the direction of q.

        rotor_inertia : [kg.m2]
        """
        if log_samples.has_joint_torque_sensor:
            return log_samples.sensor_torque
        values = dict(zip(self.unknown_names, linear_unknowns.tolist(), strict=True))
        arm = max(values.get("inertia", 0.0) - rotor_inertia * speed_ratio**2, 0.0)
        gravity = [n for n, name in enumerate(self.unknown_names) if name.startswith("gravity")]
        fitted_gravity = speed_ratio * self.design_matrix[:, gravity] @ linear_unknowns[gravity]
        return np.asarray(arm * log_samples.ddq + fitted_gravity + speed_ratio * self.measured_load_torque)


def motor_friction(
    drive_parameters: DriveParameters, joint_speed: Array, temperature: Array, transmitted_torque: Array
) -> Array:
    """Friction torque (...) [N.m] at the motor, of a moving drive.

    joint_speed        : speed (...) [rad/s] of the joint
    temperature        : (...) [K] of the lubricant; NaN: reference temperature of the parameters
    transmitted_torque : (...) [N.m] torque that the teeth transmit to the arm, at the joint
    """
    forward = replace(drive_parameters, ratio=abs(drive_parameters.ratio))
    warmth = np.where(np.isfinite(temperature), temperature, REFERENCE_TEMPERATURE)
    w1 = forward.ratio * joint_speed
    positive, negative = friction_limits(forward, w1, -transmitted_torque, warmth)
    return np.asarray(np.where(w1 > 0.0, positive, -negative) + viscous_torque(forward, w1, warmth))


def filtered_motor_friction(
    drive_parameters: DriveParameters, log_samples: LogSamples, transmitted_torque: Array
) -> Array:
    """Friction torque (n) [N.m] at samples, smoothed by the filter of the log."""
    warmth, carried = log_samples.temperature[:, None], transmitted_torque[:, None]
    return np.asarray(
        np.sum(
            log_samples.window_weights
            * motor_friction(drive_parameters, log_samples.window_speeds, warmth, carried),
            axis=1,
        )
    )


DRY_FRICTION_NAME = "friction_coulomb"
"""Parameter of the dry friction."""
STRIBECK_FRICTION_NAME = "friction_stribeck"
"""Parameter of the Stribeck friction."""
VISCOUS_FRICTION_NAME = "friction_viscous"
"""Parameter of the viscous friction."""
LOAD_LOSS_NAME, BACK_DRIVING_LOSS_NAME = "load_loss", "load_loss_back"
"""Names of the parameters: loss [1] of the transmitted torque if the motor drives, and if the load drives."""
TEMPERATURE_COEFFICIENT_NAMES = ("viscous_temperature_coefficient", "dry_temperature_coefficient")
"""Parameters of the change of friction with temperature."""
FITTABLE_FRICTION_PARAMETERS = (
    DRY_FRICTION_NAME,
    STRIBECK_FRICTION_NAME,
    VISCOUS_FRICTION_NAME,
    LOAD_LOSS_NAME,
    BACK_DRIVING_LOSS_NAME,
    *TEMPERATURE_COEFFICIENT_NAMES,
)
"""Parameters of the friction that can be fitted."""
LOAD_ITERATION_COUNT, RELATIVE_LOAD_TOLERANCE = 4, 1e-4
"""Largest number of fits, each with the load that follows from the fit before; and change of the load over
its size [1] at which the fits end."""
RELATIVE_FIT_TOLERANCE = 1e-6
"""Relative change of cost or parameters at which a fit ends [1]; far below the deviations of a log."""
FIRST_FIT_SAMPLE_COUNT = 1000
"""Approximate number of samples of a long log for a first fit, whose result is the start of the fit to all
samples."""
MIN_TEMPERATURE_RANGE = 5.0
"""Range of temperatures [K] that a log needs for a fit of the temperature coefficients."""
MIN_LOAD_OVER_RATED_TORQUE = 0.02
"""Largest load of a log over the rated torque [1], from which load-dependent losses are fitted."""
FRICTION_START_VALUES = {
    LOAD_LOSS_NAME: 0.05,
    BACK_DRIVING_LOSS_NAME: 0.05,
    TEMPERATURE_COEFFICIENT_NAMES[0]: 0.02,
    TEMPERATURE_COEFFICIENT_NAMES[1]: 0.01,
}
"""Start values if the file has 0: losses [1], temperature coefficients [1/K]."""
LOWER_BOUND_OVER_START_VALUE = 1e-3
"""Lower bound of a fitted parameter over its start value [1]."""
UNDETERMINED_DEVIATION_FACTOR, MAX_REFIT_RESIDUAL_INCREASE = 2.0, 2.0
"""Standard deviation of a parameter, as a factor [1], above which it may be undetermined; and increase of the
residual, in standard deviations for each such parameter [1], up to which the values of the file fit as
well."""
PARAMETERS_ALLOWED_AT_ZERO = (STRIBECK_FRICTION_NAME, VISCOUS_FRICTION_NAME)
"""Parameters that a log may show to be 0: the fit ends on their lower bound."""
MIN_FRICTION_OVER_STANDARD_DEVIATION, MIN_FRICTION_TORQUE_SHARE = 5.0, 0.02
"""Friction over its standard deviation [1], and over the root mean square of the torque [1], from which a
torque at the joint has the friction of the drive."""
FINITE_DIFFERENCE_STEP = 1e-4
"""Step of the logarithms of the parameters [1] for finite differences."""


@dataclass(frozen=True, slots=True)
class FittedLogFriction:
    """Friction model fitted to the samples of logs.

    fitted_drive              : drive with the fitted friction
    friction_solution         : solution of the fit of the friction parameters
    linear_unknowns           : (k) unknowns of the linear terms: inertia [kg.m2], offset, gravity [N.m]
    linear_unknown_covariance : (k, k) of the linear unknowns
    rotor_inertia             : [kg.m2]
    rotor_inertia_deviation   : [kg.m2] standard deviation of the rotor inertia
    """

    fitted_drive: DriveParameters
    friction_solution: FitSolution
    linear_unknowns: Array
    linear_unknown_covariance: Array
    rotor_inertia: float
    rotor_inertia_deviation: float

    @property
    def total_inertia(self) -> float:
        """Inertia [kg.m2] of arm and rotor at the joint, or of the rotor if a sensor measures the load.

        Only a log with a column `time` determines it.
        """
        return float(self.linear_unknowns[0])

    def evaluate_friction_and_motor_torque(self, log_samples: LogSamples) -> tuple[Array, Array]:
        """Friction torque (n) [N.m] and total torque (n) [N.m] of the motor at samples."""
        ratio = abs(self.fitted_drive.ratio)
        terms = LinearTorqueTerms.evaluate_at_samples(log_samples, ratio)
        load = terms.evaluate_transmitted_torque(log_samples, self.linear_unknowns, ratio, self.rotor_inertia)
        friction_torque = filtered_motor_friction(self.fitted_drive, log_samples, load)
        return (
            friction_torque,
            friction_torque + terms.design_matrix @ self.linear_unknowns + terms.measured_load_torque,
        )

    def evaluate_transmitted_torque_and_deviations(self, log_samples: LogSamples) -> tuple[Array, Array]:
        """Torque (n) [N.m] transmitted by the teeth; its standard deviations as changes (m, n) [N.m].

        Each change follows from one of m independent errors of one standard deviation: the principal
        directions of the covariance of the linear unknowns, then the rotor inertia.
        """
        ratio = abs(self.fitted_drive.ratio)
        terms = LinearTorqueTerms.evaluate_at_samples(log_samples, ratio)
        load = terms.evaluate_transmitted_torque(log_samples, self.linear_unknowns, ratio, self.rotor_inertia)
        variances, directions = np.linalg.eigh(self.linear_unknown_covariance)
        ends = self.linear_unknowns + np.sqrt(np.maximum(variances, 0.0))[:, None] * directions.T
        cases = [
            *((end, self.rotor_inertia) for end in ends),
            (self.linear_unknowns, self.rotor_inertia + self.rotor_inertia_deviation),
        ]
        changes = [
            terms.evaluate_transmitted_torque(log_samples, end, ratio, rotor) - load for end, rotor in cases
        ]
        return load, np.reshape(changes, (len(changes), load.size))

    def no_load_friction(self, joint_speed: Array, temperature: float) -> Array:
        """No-load friction torque (n) [N.m] at joint speeds (n) [rad/s] and a temperature [K]."""
        return motor_friction(
            self.fitted_drive, joint_speed, np.full(joint_speed.size, temperature), np.zeros(joint_speed.size)
        )


def select_friction_parameters(
    log_samples: LogSamples,
    drive_parameters: DriveParameters,
    fitted_names: Sequence[str],
    rotor_inertia: float,
) -> tuple[list[str], list[str]]:
    """Select the friction parameters to fit: those that the samples can determine.

    fitted_names  : names that the user states; empty: select from FITTABLE_FRICTION_PARAMETERS
    rotor_inertia : [kg.m2]

    Returns the names, and notes why other parameters are not fitted.
    """
    if fitted_names:
        return list(fitted_names), []
    reasons: dict[str, str] = {}
    terms, linear = _fit_linear_model(log_samples, drive_parameters)
    load = terms.evaluate_transmitted_torque(
        log_samples, linear[2:], abs(drive_parameters.ratio), rotor_inertia
    )  # with constant dry and viscous friction
    if np.max(np.abs(load)) < MIN_LOAD_OVER_RATED_TORQUE * drive_parameters.rated_torque:
        text = f"the load stays below {MIN_LOAD_OVER_RATED_TORQUE:g} times the rated torque"
        reasons |= {LOAD_LOSS_NAME: text, BACK_DRIVING_LOSS_NAME: text}
    else:
        back_driven = (
            load * log_samples.dq
            < -MIN_LOAD_OVER_RATED_TORQUE * drive_parameters.rated_torque * np.abs(log_samples.dq)
        )
        if drive_parameters.load_loss_back < 0.0:
            reasons[BACK_DRIVING_LOSS_NAME] = "the start file sets it equal to load_loss"
        elif not back_driven.any():
            reasons[BACK_DRIVING_LOSS_NAME] = "the load never drives the motor"
    known = log_samples.temperature[np.isfinite(log_samples.temperature)]
    if known.size == 0 or np.ptp(known) < MIN_TEMPERATURE_RANGE:
        span = "the log has no temperature" if known.size == 0 else f"{np.ptp(known):.2g} K of temperature"
        reasons |= dict.fromkeys(
            TEMPERATURE_COEFFICIENT_NAMES, f"{span}, {MIN_TEMPERATURE_RANGE:g} K are needed"
        )
    slowest = abs(drive_parameters.ratio) * np.min(np.abs(log_samples.dq))
    if slowest > 2.0 * drive_parameters.stribeck_speed:
        reasons[STRIBECK_FRICTION_NAME] = (
            f"the motor is never slower than {slowest:.3g} rad/s; speeds below twice "
            f"stribeck_speed are needed"
        )
    notes = [
        f"the log does not determine {name}, which keeps its value: {why}" for name, why in reasons.items()
    ]
    return [name for name in FITTABLE_FRICTION_PARAMETERS if name not in reasons], notes


def _fit_linear_model(
    log_samples: LogSamples, drive_parameters: DriveParameters
) -> tuple[LinearTorqueTerms, Array]:
    """Estimate all terms of the motor torque by one linear fit.

    Dry friction is constant, viscous friction proportional to the speed.

    Returns the linear terms, and an array: dry friction [N.m], viscous coefficient [N.m.s/rad], and the
    unknowns of the linear terms.
    """
    ratio = abs(drive_parameters.ratio)
    terms = LinearTorqueTerms.evaluate_at_samples(log_samples, ratio)
    friction_terms = np.stack([np.sign(log_samples.dq), ratio * log_samples.dq], axis=1)
    matrix = np.concatenate([friction_terms, terms.design_matrix], axis=1)
    return terms, np.linalg.lstsq(matrix, log_samples.motor_torque - terms.measured_load_torque)[0]


def fit_friction_to_samples(
    parameter_file: ParameterFile, log_samples: LogSamples, fitted_names: Sequence[str], rotor_inertia: float
) -> FittedLogFriction:
    """Fit friction parameters, and inertia, offset and gravity of the motor torque, to samples of logs.

    fitted_names  : names of the friction parameters to fit
    rotor_inertia : [kg.m2]
    """
    linear = _fit_linear_model(log_samples, parameter_file.values)[1]
    start_values, linear = _find_start_values(parameter_file, log_samples, linear), linear[2:]
    changed = parameter_file.with_values(
        {n: v for n, v in start_values.items() if n in fitted_names}, "calibration", "start"
    )
    bounds = {name: (LOWER_BOUND_OVER_START_VALUE * value, np.inf) for name, value in start_values.items()}
    noise = None
    step = log_samples.dq.size // FIRST_FIT_SAMPLE_COUNT
    if step > 1:
        few = log_samples.select_samples(np.arange(0, log_samples.dq.size, step))
        first = _fit_with_iterated_load(
            parameter_file, changed, few, fitted_names, bounds, linear, rotor_inertia
        )
        linear, noise = first.linear_unknowns, first.friction_solution.noise
        changed = parameter_file.with_values(first.friction_solution.values, "calibration", "start")
    return _fit_with_iterated_load(
        parameter_file, changed, log_samples, fitted_names, bounds, linear, rotor_inertia, noise
    )


def _fit_with_iterated_load(
    parameter_file: ParameterFile,
    start_file: ParameterFile,
    log_samples: LogSamples,
    fitted_names: Sequence[str],
    value_bounds: Mapping[str, tuple[float, float]],
    linear_unknowns: Array,
    rotor_inertia: float,
    residual_noise: float | None = None,
) -> FittedLogFriction:
    """Fit friction, inertia, offset and gravity in rounds, with the load of the teeth from the round before.

    start_file      : parameter file with the start values
    value_bounds    : {name: lower and upper bound}
    linear_unknowns : start values (k) of the linear terms
    residual_noise  : start value of the standard deviation of a residual [N.m]; None: unknown
    """
    ratio, linear, changed = abs(parameter_file.values.ratio), linear_unknowns, start_file
    terms = LinearTorqueTerms.evaluate_at_samples(log_samples, ratio)
    load = terms.evaluate_transmitted_torque(log_samples, linear, ratio, rotor_inertia)
    for _ in range(LOAD_ITERATION_COUNT):

        def net_torque(parameter_values: Mapping[str, float], transmitted_torque: Array = load) -> Array:
            """Motor torque [N.m] at n samples minus friction and measured load (joint sensor or gravity)."""
            drive = parameter_file.with_values(parameter_values, "calibration", "fit").values
            return np.asarray(
                log_samples.motor_torque
                - terms.measured_load_torque
                - filtered_motor_friction(drive, log_samples, transmitted_torque)
            )

        def residuals(parameter_values: Mapping[str, float], net_torque_function=net_torque) -> Array:  # type: ignore[no-untyped-def]
            remaining = net_torque_function(parameter_values)
            return np.asarray(remaining - terms.design_matrix @ terms.solve_linear_unknowns(remaining))

        solution = solve_least_squares(
            make_fit_unknowns(changed, fitted_names, value_bounds),
            residuals,
            residual_deviation=residual_noise,
            nuisance_count=len(terms.unknown_names),
            convergence_tolerance=RELATIVE_FIT_TOLERANCE,
        )
        degrees_of_freedom = max(log_samples.dq.size - len(fitted_names) - len(terms.unknown_names), 1)
        residual_noise = float(np.sqrt(solution.residuals @ solution.residuals / degrees_of_freedom))
        linear = terms.solve_linear_unknowns(net_torque(solution.values))
        changed = parameter_file.with_values(solution.values, "calibration", "fit")
        previous, load = load, terms.evaluate_transmitted_torque(log_samples, linear, ratio, rotor_inertia)
        if np.max(np.abs(load - previous)) <= RELATIVE_LOAD_TOLERANCE * np.max(np.abs(load)):
            break
    assert residual_noise is not None
    solution = replace(
        solution, noise=residual_noise, covariance=parameter_covariance(solution.jacobian, residual_noise)
    )
    direct = solution.noise**2 * np.linalg.pinv(terms.design_matrix.T @ terms.design_matrix)
    indirect = _propagate_deviations(solution, lambda values: terms.solve_linear_unknowns(net_torque(values)))
    return FittedLogFriction(
        changed.values, solution, linear, direct + indirect.T @ indirect, rotor_inertia, 0.0
    )


def refit_without_undetermined_parameters(
    parameter_file: ParameterFile,
    log_samples: LogSamples,
    fitted_log: FittedLogFriction,
    fitted_names: Sequence[str],
) -> tuple[FittedLogFriction, list[str], list[str]]:
    """Repeat the fit of the friction without the parameters that the log does not determine.

    A parameter of FRICTION_START_VALUES is dropped if its standard deviation exceeds a factor of
    UNDETERMINED_DEVIATION_FACTOR and its value in the file fits as well. If the values of all these
    parameters do not fit, only the one with the largest deviation is dropped. Returns the fit, names of the
    fitted parameters, and notes about the others.
    """
    solution = fitted_log.friction_solution
    deviations = solution.relative_deviations
    undetermined = sorted(
        (
            n
            for n in fitted_names
            if n in FRICTION_START_VALUES and deviations[n] > np.log(UNDETERMINED_DEVIATION_FACTOR)
        ),
        key=deviations.__getitem__,
    )
    for kept in dict.fromkeys((tuple(undetermined), tuple(undetermined[-1:]))):
        determined = [name for name in fitted_names if name not in kept]
        if not (kept and determined):
            continue
        other = fit_friction_to_samples(parameter_file, log_samples, determined, fitted_log.rotor_inertia)
        increase = np.sum(other.friction_solution.residuals**2) - np.sum(solution.residuals**2)
        if increase < len(kept) * (MAX_REFIT_RESIDUAL_INCREASE * solution.noise) ** 2:
            return (
                other,
                determined,
                [
                    _describe_kept_parameter(name, other.fitted_drive, log_samples)
                    for name in fitted_names
                    if name in kept
                ],
            )
    return fitted_log, list(fitted_names), []


def _describe_kept_parameter(
    parameter_name: str, fitted_drive: DriveParameters, log_samples: LogSamples
) -> str:
    """Note on a parameter that keeps its value; for load_loss_back, what the log determines instead."""
    note = (
        f"the log does not determine {parameter_name}, which keeps its value: the fit is as good with that "
        "value"
    )
    is_load_measured = log_samples.has_joint_torque_sensor or np.isfinite(log_samples.gravity_torque).any()
    if parameter_name == BACK_DRIVING_LOSS_NAME and not is_load_measured:
        factor = (1.0 + fitted_drive.load_loss) / (1.0 - fitted_drive.load_loss_back)
        note += (
            f". {LOAD_LOSS_NAME}, inertia and gravity depend on this value: the log determines only (1 + "
            f"{LOAD_LOSS_NAME})/(1 - {parameter_name}) = {factor:.4g}; a column gravity [N.m] or "
            "link_torque [N.m] determines both losses"
        )
    return note


def accept_vanishing_friction(fitted_log: FittedLogFriction) -> tuple[FittedLogFriction, list[str]]:
    """Accept that friction parameters are 0: PARAMETERS_ALLOWED_AT_ZERO that end on their lower bound.

    Returns the fit, with these parameters no longer on a bound, and notes about them.
    """
    solution = fitted_log.friction_solution
    vanishing = [name for name in solution.names_at_bound if name in PARAMETERS_ALLOWED_AT_ZERO]
    others = tuple(name for name in solution.names_at_bound if name not in vanishing)
    notes = [f"the log shows no {name}: its smallest value fits best" for name in vanishing]
    return replace(fitted_log, friction_solution=replace(solution, names_at_bound=others)), notes


def has_significant_friction(log_samples: LogSamples, drive_parameters: DriveParameters) -> bool:
    """Whether samples show friction: its share of the motor torque exceeds chance and a minimum."""
    ratio = abs(drive_parameters.ratio)
    terms, linear = _fit_linear_model(log_samples, drive_parameters)
    sense, speed = np.sign(log_samples.dq), ratio * log_samples.dq
    matrix = np.concatenate([np.stack([sense, speed], axis=1), terms.design_matrix], axis=1)
    torque = log_samples.motor_torque - terms.measured_load_torque
    residual = torque - matrix @ linear
    noise = np.linalg.norm(residual) / np.sqrt(max(residual.size - linear.size, 1))
    covariance = noise**2 * np.linalg.pinv(matrix.T @ matrix)[:2, :2]
    mean = np.array([1.0, float(np.mean(np.abs(speed)))])  # friction at the mean speed
    size, deviation = float(mean @ linear[:2]), float(np.sqrt(mean @ covariance @ mean))
    return size > max(
        MIN_FRICTION_OVER_STANDARD_DEVIATION * deviation,
        MIN_FRICTION_TORQUE_SHARE * float(np.sqrt(np.mean(torque**2))),
    )


def is_motion_driven_by_friction(log_samples: LogSamples, drive_parameters: DriveParameters) -> bool:
    """Whether the fitted friction drives the motion: then the torque has the wrong sign in the log."""
    terms, linear = _fit_linear_model(log_samples, drive_parameters)
    w1 = abs(drive_parameters.ratio) * log_samples.dq
    friction_torque = linear[0] * np.sign(w1) + linear[1] * w1
    residual = (
        log_samples.motor_torque
        - terms.measured_load_torque
        - friction_torque
        - terms.design_matrix @ linear[2:]
    )
    return bool(friction_torque @ w1 < 0.0 and np.sum(friction_torque**2) > np.sum(residual**2))


def fit_with_rotor_inertia(
    parameter_file: ParameterFile,
    log_samples: LogSamples,
    fitted_names: Sequence[str],
    rotor_inertia: float,
    rotor_inertia_deviation: float,
) -> FittedLogFriction:
    """Fit the friction with a known rotor inertia [kg.m2].

    rotor_inertia_deviation : [kg.m2] standard deviation of the inertia; its effect is added to the covariance
    """
    fit = fit_friction_to_samples(parameter_file, log_samples, fitted_names, rotor_inertia)
    shifted = fit_friction_to_samples(
        parameter_file, log_samples, fitted_names, rotor_inertia + rotor_inertia_deviation
    )
    return replace(
        fit,
        friction_solution=_add_independent_error(fit.friction_solution, shifted.friction_solution),
        rotor_inertia_deviation=rotor_inertia_deviation,
    )


def add_errors_of_kept_parameters(
    parameter_file: ParameterFile,
    log_samples: LogSamples,
    fitted_log: FittedLogFriction,
    kept_names: Sequence[str],
) -> FittedLogFriction:
    """Widen the covariances of a fit by the errors of parameters that keep the value of the file.

    kept_names : names of FRICTION_START_VALUES that the log does not determine. Their standard deviation is a
                 factor of UNDETERMINED_DEVIATION_FACTOR: a larger one would have been found in the log
    """
    names = list(fitted_log.friction_solution.values)
    for name in kept_names:
        value = max(parameter_file.values_by_name[name], FRICTION_START_VALUES[name])
        changed = parameter_file.with_values(
            {name: UNDETERMINED_DEVIATION_FACTOR * value}, "estimate", "standard deviation"
        )
        shifted = fit_friction_to_samples(changed, log_samples, names, fitted_log.rotor_inertia)
        changes = shifted.linear_unknowns - fitted_log.linear_unknowns
        fitted_log = replace(
            fitted_log,
            friction_solution=_add_independent_error(fitted_log.friction_solution, shifted.friction_solution),
            linear_unknown_covariance=fitted_log.linear_unknown_covariance + np.outer(changes, changes),
        )
    return fitted_log


def _add_independent_error(solution: FitSolution, shifted_solution: FitSolution) -> FitSolution:
    """Add one more error to the covariance of a fit; `jacobian` becomes the (k, k) one of this covariance.

    shifted_solution : the fit, after a shift of its data by one standard deviation of the error
    """
    changes = np.array(
        [np.log(shifted_solution.values[name] / value) for name, value in solution.values.items()]
    )
    information = solution.jacobian.T @ solution.jacobian / solution.noise**2
    effect = information @ changes
    eigenvalues, directions = np.linalg.eigh(
        information - np.outer(effect, effect) / (1.0 + changes @ effect)  # Sherman and Morrison
    )
    root = np.sqrt(np.maximum(eigenvalues, 0.0))[:, None] * directions.T
    return replace(
        solution,
        covariance=solution.covariance + np.outer(changes, changes),
        jacobian=solution.noise * root,
    )


def _propagate_deviations(
    fit_solution: FitSolution, propagated_function: Callable[[Mapping[str, float]], Array]
) -> Array:
    """Changes (k, m) of m function values by k independent errors of a solution, one standard deviation each.

    The errors are the principal directions of the covariance of the k logarithms of the unknowns.

    propagated_function : {name: value} -> m function values
    """
    variances, directions = np.linalg.eigh(fit_solution.covariance)
    rows, reference = [], propagated_function(fit_solution.values)
    for deviation, direction in zip(np.sqrt(np.maximum(variances, 0.0)), directions.T, strict=True):
        changed = {
            n: v * float(np.exp(FINITE_DIFFERENCE_STEP * d))
            for (n, v), d in zip(fit_solution.values.items(), direction, strict=True)
        }
        rows.append((propagated_function(changed) - reference) * deviation / FINITE_DIFFERENCE_STEP)
    return np.array(rows)


def _find_start_values(
    parameter_file: ParameterFile, log_samples: LogSamples, linear_fit_values: Array
) -> dict[str, float]:
    """Start values {name: value}: dry and viscous friction from the linear fit, others from the file.

    linear_fit_values : dry friction [N.m], viscous coefficient [N.m.s/rad], and other unknowns of the fit
    """
    size = float(np.median(np.abs(log_samples.motor_torque))) or 1.0
    fastest = abs(parameter_file.values.ratio) * float(np.max(np.abs(log_samples.dq)))
    dry = max(float(linear_fit_values[0]), 0.05 * size)
    others = {
        name: parameter_file.values_by_name[name] if parameter_file.values_by_name[name] > 0.0 else value
        for name, value in FRICTION_START_VALUES.items()
    }
    return {
        DRY_FRICTION_NAME: dry,
        STRIBECK_FRICTION_NAME: 0.2 * dry,
        VISCOUS_FRICTION_NAME: max(float(linear_fit_values[1]), 0.02 * size / fastest),
    } | others
