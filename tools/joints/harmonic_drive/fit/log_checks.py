"""Checks of a robot's logs that need the columns together: torque scale, repeated logs, gravity column."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.friction import REFERENCE_TEMPERATURE
from jointfmu.quantity import Array

from .log_friction import FittedLogFriction, motor_friction
from .log_reading import LogSamples, MeasuredLog

MAX_RELATIVE_RATIO_ERROR, MAX_PLAUSIBLE_WIND_UP = 0.005, 0.01
"""Relative deviation of the ratio of measured angles from that of the drive [1], and wind-up [rad], up to
which angles of motor and joint count as consistent. Ratios 100 and 101 differ by 0.01; drives wind up by some
mrad."""
ALLOWED_MOTOR_OVER_JOINT_TORQUE_RANGE = (1.0 / 3.0, 3.0)
"""Allowed range of the motor torque times ratio over the torque at the joint [1]."""
MIN_MOTOR_JOINT_TORQUE_CORRELATION = 0.7
"""Correlation of motor torque and torque at the joint [1], above which their ratio is judged."""
MAX_FITTED_OVER_START_FRICTION = 5.0
"""Factor [1] between fitted friction and friction of the start file, above which the fit is doubtful."""
GRAVITY_HARMONIC_COUNT = 3
"""Harmonics of the joint angle in gravity: an arm has one, springs and cables add some."""
MIN_MOTION_SHARE_OF_VARIANCE, MIN_RESIDUAL_OVER_GRAVITY_DEVIATION = 0.5, 0.02
"""Share of the variance of the gravity column, beyond its function of the angle, that acceleration and sense
of the motion explain [1]; and standard deviation of the gravity column beyond its function of the angle, over
standard deviation of the column [1]. From both on, the column is no gravity."""


def check_repeated_logs(measured_logs: Sequence[MeasuredLog]) -> None:
    """Raise ValueError if two logs have the same samples, which would make the intervals too narrow."""
    for first, second in combinations(measured_logs, 2):
        if all(
            np.array_equal(
                getattr(first.log_samples, name), getattr(second.log_samples, name), equal_nan=True
            )
            for name in ("time", "dq", "motor_torque")
        ):
            raise ValueError(
                f"{second.log_path}: has the samples of {first.log_path}; expected each log once"
            )


def check_ratio(measured_log: MeasuredLog, drive_parameters: DriveParameters) -> None:
    """Raise ValueError if the angles of motor and joint in a log contradict the ratio of the drive.

    Their difference must exceed MAX_PLAUSIBLE_WIND_UP and MAX_RELATIVE_RATIO_ERROR: a wind-up is no error.
    """
    samples = measured_log.log_samples
    rows = np.isfinite(samples.motor_angle + samples.q)
    if np.count_nonzero(rows) < 2:
        return
    joint, motor = samples.q[rows], samples.motor_angle[rows]
    span = float(np.ptp(joint))
    measured = abs(float(np.polyfit(joint, motor, 1)[0])) if span > 0.0 else np.inf
    stated = abs(drive_parameters.ratio)
    error = abs(measured / stated - 1.0)
    if error > MAX_RELATIVE_RATIO_ERROR and error * span > MAX_PLAUSIBLE_WIND_UP:
        raise ValueError(
            f"{measured_log.log_path}: q_motor changes by {measured:.4g} times q, but the ratio of the drive "
            f"is {stated:g}; state the right drive or --ratio, or check the units of q and q_motor"
        )


def check_torque_scale(
    measured_log: MeasuredLog, drive_parameters: DriveParameters, torque_constant: float | None
) -> None:
    """Check the scale of the motor torque against the measured torque at the joint, or measured gravity.

    Raises ValueError if their ratio is outside ALLOWED_MOTOR_OVER_JOINT_TORQUE_RANGE.
    """
    samples = measured_log.log_samples
    column = "link_torque" if samples.has_joint_torque_sensor else "gravity"
    load = samples.sensor_torque if samples.has_joint_torque_sensor else samples.gravity_torque
    if not (measured_log.has_motor_torque and np.all(np.isfinite(load)) and np.any(load)):
        return
    at_joint = abs(drive_parameters.ratio) * samples.motor_torque
    product = float(at_joint @ load)
    correlation = product / float(np.linalg.norm(at_joint) * np.linalg.norm(load) or 1.0)
    if abs(correlation) < MIN_MOTOR_JOINT_TORQUE_CORRELATION:
        return
    scale = product / float(load @ load)
    low, high = ALLOWED_MOTOR_OVER_JOINT_TORQUE_RANGE
    if low <= scale <= high:
        return
    if scale < 0.0:
        hint = f"reverse the sign of {column}, or of the motor's torque"
    elif torque_constant is None:
        hint = f"check the units of tau and {column}, and the ratio {abs(drive_parameters.ratio):g}"
    else:
        hint = (
            f"check --torque-constant, with {torque_constant / scale:.3g} N.m/A they agree, and the ratio "
            f"{abs(drive_parameters.ratio):g}"
        )
    raise ValueError(
        f"{measured_log.log_path}: motor torque times ratio is {scale:.3g} times {column}, allowed are "
        f"{low:.2g} to {high:g}; {hint}"
    )


def find_friction_doubt(
    log_samples: LogSamples,
    fitted_log: FittedLogFriction,
    start_drive_parameters: DriveParameters,
    torque_constant: float | None,
) -> str | None:
    """Text that doubts the scale of the motor torque; None if the fitted friction is near its start value.

    Compares the friction without load, at the median speed and REFERENCE_TEMPERATURE.
    """
    speed = np.array([float(np.median(np.abs(log_samples.dq)))])
    nothing = np.zeros(1)
    fitted, expected = (
        float(motor_friction(drive, speed, np.full(1, REFERENCE_TEMPERATURE), nothing)[0])
        for drive in (fitted_log.fitted_drive, start_drive_parameters)
    )
    if (
        not expected > 0.0
        or 1.0 / MAX_FITTED_OVER_START_FRICTION < fitted / expected < MAX_FITTED_OVER_START_FRICTION
    ):
        return None
    check = "the unit of tau" if torque_constant is None else f"--torque-constant = {torque_constant:g} N.m/A"
    return (
        f"the friction without load is {1e3 * fitted:.3g} mN.m at {speed[0]:.3g} rad/s of the joint, "
        f"{fitted / expected:.2g} times that of the start file; check {check}, and the drive"
    )


def find_gravity_doubt(log_samples: LogSamples) -> str | None:
    """Text that doubts that the column `gravity` is a gravity torque; None if it depends on the angle alone.

    A torque that depends on acceleration or on the sense of the motion is a measured torque.
    """
    rows = np.flatnonzero(
        log_samples.is_of_dynamic_log & np.isfinite(log_samples.gravity_torque) & np.isfinite(log_samples.q)
    )
    if log_samples.has_joint_torque_sensor or rows.size < 10 * (2 * GRAVITY_HARMONIC_COUNT + 3):
        return None
    angle, gravity = log_samples.q[rows], log_samples.gravity_torque[rows]
    waves = [f(n * angle) for n in range(1, GRAVITY_HARMONIC_COUNT + 1) for f in (np.cos, np.sin)]
    of_angle = np.stack([np.ones(rows.size), *waves], axis=1)
    motion = np.stack([log_samples.ddq[rows], np.sign(log_samples.dq[rows])], axis=1)
    without, remaining = (
        _fit_residual(np.concatenate(terms, axis=1), gravity) for terms in ([of_angle], [of_angle, motion])
    )
    size, left = float(np.linalg.norm(without)), float(np.linalg.norm(remaining))
    if size <= MIN_RESIDUAL_OVER_GRAVITY_DEVIATION * float(np.linalg.norm(gravity - gravity.mean())):
        return None
    if size**2 - left**2 < MIN_MOTION_SHARE_OF_VARIANCE * size**2:
        return None
    return (
        "the column gravity depends on acceleration or sense of the motion, as a measured torque does; "
        "expected the torque that holds the arm still; a measured torque at the joint is link_torque"
    )


def _fit_residual(design_matrix: Array, fitted_values: Array) -> Array:
    """Residual (n) of a linear least-squares fit of values to a design matrix."""
    return np.asarray(fitted_values - design_matrix @ np.linalg.lstsq(design_matrix, fitted_values)[0])
