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

from ....inputs.fitting.outcome import FitFacts
from .log_friction import DRY_FRICTION_NAME, FittedLogFriction, LinearTorqueTerms
from .log_reading import FILTER_NODE_COUNT, FILTER_WINDOW, Samples

MAX_RIPPLE_CHANCE, MIN_RIPPLE_SHARE = 1e-6, 0.02
"""Probability [1] that chance explains a ripple, and its amplitude over the dry friction [1]: ripple must be
below the first and above the second."""
MAX_NODE_ROTATION = 1.5
"""Largest phase [rad] of a harmonic between two nodes of the filter; above, the filter removes the ripple."""
MIN_TURN_ANGLES = 8
"""Number of different motor angles, modulo a turn, from which a log shows a ripple [1]."""


@dataclass(frozen=True, slots=True)
class Ripple:
    """Harmonic of the dry friction in the motor angle: amplitude [N.m], phase [rad], deviations."""

    harmonic: int
    amplitude: float
    phase: float
    amplitude_deviation: float
    phase_deviation: float


def find_ripple_terms(samples: Samples, fitted_log: FittedLogFriction) -> tuple[Samples, tuple[int, ...]]:
    """Find harmonics of the friction in the residuals of a fit.

    Returns the samples with the terms of these harmonics, and the harmonics.
    """
    angles = samples.window_angles[:, FILTER_NODE_COUNT // 2]
    turns = np.unique(np.round(np.mod(angles, 2.0 * np.pi) * MIN_TURN_ANGLES))
    if not np.all(np.isfinite(samples.window_angles)) or turns.size < MIN_TURN_ANGLES:
        return samples, ()
    residual = samples.motor_torque - fitted_log.evaluate_torque(samples)[1]
    others = LinearTorqueTerms.evaluate_at_samples(samples, abs(fitted_log.drive.ratio)).design_matrix
    terms = [_harmonic_terms(samples, n, abs(fitted_log.drive.ratio)) for n in FRICTION_HARMONICS]
    matrix = np.concatenate([*terms, others], axis=1)
    values = np.linalg.lstsq(matrix, residual)[0]
    left = residual - matrix @ values
    variance = float(left @ left) / max(left.size - values.size, 1)
    covariance = variance * np.linalg.pinv(matrix.T @ matrix)
    dry = float(getattr(fitted_log.drive, DRY_FRICTION_NAME))
    found = []
    for number, harmonic in enumerate(FRICTION_HARMONICS):
        place = slice(2 * number, 2 * number + 2)
        statistic = float(values[place] @ np.linalg.pinv(covariance[place, place]) @ values[place])
        is_large = np.hypot(*values[place]) > MIN_RIPPLE_SHARE * dry
        if is_large and stats.chi2.sf(statistic, 2) < MAX_RIPPLE_CHANCE:
            found.append(harmonic)
    if not found:
        return samples, ()
    columns = [term for term, n in zip(terms, FRICTION_HARMONICS, strict=True) if n in found]
    return replace(samples, ripple_terms=np.concatenate(columns, axis=1)), tuple(found)


def _harmonic_terms(samples: Samples, harmonic: int, speed_ratio: float) -> Array:
    """Filtered sense of rotation times sine and cosine (n, 2) [1] of a harmonic of the motor angle."""
    angle, sense = harmonic * samples.window_angles, np.sign(samples.window_speeds)
    node_rotation = harmonic * speed_ratio * np.abs(samples.dq) * FILTER_WINDOW / (FILTER_NODE_COUNT - 1)
    is_resolved = ~samples.is_of_dynamic_log | (node_rotation < MAX_NODE_ROTATION)
    columns = [
        np.sum(samples.window_weights * sense * wave, axis=1) * is_resolved
        for wave in (np.sin(angle), np.cos(angle))
    ]
    return np.stack(columns, axis=1)


def fitted_ripples(fitted_log: FittedLogFriction, harmonics: Sequence[int]) -> list[Ripple]:
    """Amplitude and phase of each harmonic of the friction, with deviations, from a fit with ripple terms.

    The last linear unknowns of the fit are the amplitudes of sine and cosine of each harmonic.
    """
    ripples, first = [], fitted_log.linear_unknowns.size - 2 * len(harmonics)
    for number, harmonic in enumerate(harmonics):
        place = slice(first + 2 * number, first + 2 * number + 2)
        sine, cosine = fitted_log.linear_unknowns[place]
        amplitude, phase = float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
        radial, tangential = np.array([sine, cosine]) / amplitude, np.array([-cosine, sine]) / amplitude
        deviations = [
            float(np.sqrt(d @ fitted_log.covariance[place, place] @ d)) for d in (radial, tangential)
        ]
        ripples.append(Ripple(harmonic, amplitude, phase, deviations[0], deviations[1] / amplitude))
    return ripples


def add_ripples(
    parameter_file: ParameterFile, ripples: Sequence[Ripple], source: str, confidence_level: float
) -> tuple[ParameterFile, FitFacts, list[str]]:
    """Add the friction ripples to a parameter file; returns the file, facts about the ripples, and notes.

    source           : source of the parameters, without their intervals
    confidence_level : confidence level of the intervals [1]
    """
    facts: FitFacts = {}
    factor = float(stats.norm.ppf(0.5 + 0.5 * confidence_level))
    values, sources = {}, {}
    for ripple in ripples:
        name = f"friction_{ripple.harmonic}"
        for key, value, deviation, unit in (
            (name, ripple.amplitude, ripple.amplitude_deviation, "N.m"),
            (f"{name}_phase", ripple.phase, ripple.phase_deviation, "rad"),
        ):
            low, high = value - factor * deviation, value + factor * deviation
            interval = f"{100.0 * confidence_level:g} % interval {low:.4g} to {high:.4g}"
            periods = "once" if ripple.harmonic == 1 else f"{ripple.harmonic} times"
            facts[key] = value, unit, f"friction over the turn of the motor, {periods} a turn; {interval}"
            values[key], sources[key] = value, f"{source}; {interval}"
    total, dry = sum(ripple.amplitude for ripple in ripples), parameter_file.values_by_name[DRY_FRICTION_NAME]
    if total > dry:
        note = (
            f"the friction over the turn of the motor, {total:.3g} N.m, exceeds friction_coulomb = "
            f"{dry:.3g} N.m and is not written"
        )
        return parameter_file, facts, [note]
    for key, value in values.items():
        parameter_file = parameter_file.with_values({key: value}, "calibration", sources[key])
    return parameter_file, facts, []
