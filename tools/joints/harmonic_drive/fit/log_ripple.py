"""Friction of a drive that is periodic in the angle of the motor, found in logs.

The ripple is linear in the amplitudes of its sines and cosines. A fit without ripple leaves it in the
residuals. If a harmonic explains them by more than chance, its sine and cosine become linear terms of the fit
(`Samples.ripple_terms`), in addition to inertia and gravity.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from jointfmu.joints.harmonic_drive.drive import FRICTION_HARMONICS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....inputs.fitting.outcome import DerivedFitValues
from .log_friction import DRY_FRICTION_NAME, FittedLogFriction, LinearTorqueTerms
from .log_reading import FILTER_NODE_COUNT, FILTER_WINDOW_TIME, LogSamples

MAX_RIPPLE_CHANCE_PROBABILITY, MIN_RIPPLE_OVER_DRY_FRICTION = 1e-6, 0.02
"""Probability [1] that chance explains a ripple, and its amplitude over the dry friction [1]: ripple must be
below the first and above the second."""
MAX_PHASE_BETWEEN_FILTER_NODES = 1.5
"""Largest phase [rad] of a harmonic between two nodes of the filter; above, the filter removes the ripple."""
MIN_DIFFERENT_MOTOR_ANGLES = 8
"""Number of different motor angles, modulo a turn, from which a log shows a ripple [1]."""


@dataclass(frozen=True, slots=True)
class FrictionRipple:
    """Harmonic of the dry friction over the motor angle: amplitude [N.m], phase [rad], their deviations."""

    harmonic_order: int
    ripple_amplitude: float
    ripple_phase: float
    amplitude_standard_deviation: float
    phase_deviation: float


def find_friction_ripple_terms(
    log_samples: LogSamples, fitted_log: FittedLogFriction
) -> tuple[LogSamples, tuple[int, ...]]:
    """Find harmonics of the dry friction over the motor angle in the residuals of a friction fit.

    Returns the samples with the terms of these harmonics (`ripple_terms`), and the orders of the harmonics.
    """
    angles = log_samples.window_angles[:, FILTER_NODE_COUNT // 2]
    turns = np.unique(np.round(np.mod(angles, 2.0 * np.pi) * MIN_DIFFERENT_MOTOR_ANGLES))
    if not np.all(np.isfinite(log_samples.window_angles)) or turns.size < MIN_DIFFERENT_MOTOR_ANGLES:
        return log_samples, ()
    residual = log_samples.motor_torque - fitted_log.evaluate_friction_and_motor_torque(log_samples)[1]
    others = LinearTorqueTerms.evaluate_at_samples(
        log_samples, abs(fitted_log.fitted_drive.ratio)
    ).design_matrix
    terms = [
        _compute_harmonic_terms(log_samples, n, abs(fitted_log.fitted_drive.ratio))
        for n in FRICTION_HARMONICS
    ]
    matrix = np.concatenate([*terms, others], axis=1)
    values = np.linalg.lstsq(matrix, residual)[0]
    left = residual - matrix @ values
    variance = float(left @ left) / max(left.size - values.size, 1)
    covariance = variance * np.linalg.pinv(matrix.T @ matrix)
    dry = float(getattr(fitted_log.fitted_drive, DRY_FRICTION_NAME))
    found = []
    for number, harmonic in enumerate(FRICTION_HARMONICS):
        place = slice(2 * number, 2 * number + 2)
        statistic = float(values[place] @ np.linalg.pinv(covariance[place, place]) @ values[place])
        is_large = np.hypot(*values[place]) > MIN_RIPPLE_OVER_DRY_FRICTION * dry
        if is_large and stats.chi2.sf(statistic, 2) < MAX_RIPPLE_CHANCE_PROBABILITY:
            found.append(harmonic)
    if not found:
        return log_samples, ()
    columns = [term for term, n in zip(terms, FRICTION_HARMONICS, strict=True) if n in found]
    return replace(log_samples, ripple_terms=np.concatenate(columns, axis=1)), tuple(found)


def _compute_harmonic_terms(log_samples: LogSamples, harmonic_order: int, speed_ratio: float) -> Array:
    """Filtered sense of rotation times sine and cosine (n, 2) [1] of a harmonic of the motor angle."""
    angle, sense = harmonic_order * log_samples.window_angles, np.sign(log_samples.window_speeds)
    node_rotation = (
        harmonic_order * speed_ratio * np.abs(log_samples.dq) * FILTER_WINDOW_TIME / (FILTER_NODE_COUNT - 1)
    )
    is_resolved = ~log_samples.is_of_dynamic_log | (node_rotation < MAX_PHASE_BETWEEN_FILTER_NODES)
    columns = [
        np.sum(log_samples.window_weights * sense * wave, axis=1) * is_resolved
        for wave in (np.sin(angle), np.cos(angle))
    ]
    return np.stack(columns, axis=1)


def fitted_friction_ripples(
    fitted_log: FittedLogFriction, harmonic_orders: Sequence[int]
) -> list[FrictionRipple]:
    """Amplitude and phase of each harmonic of the friction, with deviations, from a fit with ripple terms.

    The last linear unknowns of the fit are the amplitudes of sine and cosine of each harmonic.
    """
    ripples, first = [], fitted_log.linear_unknowns.size - 2 * len(harmonic_orders)
    for number, harmonic in enumerate(harmonic_orders):
        place = slice(first + 2 * number, first + 2 * number + 2)
        sine, cosine = fitted_log.linear_unknowns[place]
        amplitude, phase = float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
        radial, tangential = np.array([sine, cosine]) / amplitude, np.array([-cosine, sine]) / amplitude
        deviations = [
            float(np.sqrt(d @ fitted_log.linear_unknown_covariance[place, place] @ d))
            for d in (radial, tangential)
        ]
        ripples.append(FrictionRipple(harmonic, amplitude, phase, deviations[0], deviations[1] / amplitude))
    return ripples


def add_friction_ripples(
    parameter_file: ParameterFile,
    friction_ripples: Sequence[FrictionRipple],
    parameter_source: str,
    confidence_level: float,
) -> tuple[ParameterFile, DerivedFitValues, list[str]]:
    """Add the friction ripples to a parameter file; returns the file, results for the user, and notes.

    parameter_source : source of the parameters, without their intervals
    confidence_level : confidence level of the intervals [1]
    """
    facts: DerivedFitValues = {}
    factor = float(stats.norm.ppf(0.5 + 0.5 * confidence_level))
    values, sources = {}, {}
    for ripple in friction_ripples:
        name = f"friction_{ripple.harmonic_order}"
        for key, value, deviation, unit in (
            (name, ripple.ripple_amplitude, ripple.amplitude_standard_deviation, "N.m"),
            (f"{name}_phase", ripple.ripple_phase, ripple.phase_deviation, "rad"),
        ):
            low, high = value - factor * deviation, value + factor * deviation
            interval = f"{100.0 * confidence_level:g} % interval {low:.4g} to {high:.4g}"
            periods = "once" if ripple.harmonic_order == 1 else f"{ripple.harmonic_order} times"
            facts[key] = value, unit, f"friction over the turn of the motor, {periods} a turn; {interval}"
            values[key], sources[key] = value, f"{parameter_source}; {interval}"
    total, dry = (
        sum(ripple.ripple_amplitude for ripple in friction_ripples),
        parameter_file.values_by_name[DRY_FRICTION_NAME],
    )
    if total > dry:
        note = (
            f"the friction over the turn of the motor, {total:.3g} N.m, exceeds friction_coulomb = "
            f"{dry:.3g} N.m and is not written"
        )
        return parameter_file, facts, [note]
    for key, value in values.items():
        parameter_file = parameter_file.with_values({key: value}, "calibration", sources[key])
    return parameter_file, facts, []
