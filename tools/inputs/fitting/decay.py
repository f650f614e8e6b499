"""Frequency and damping as functions of the amplitude, from a measured free decay.

The record is cut into windows of a few periods. In each window a decaying oscillation is fitted by least
squares:

    u = c + d t + exp(-s t) (A cos(w t) + B sin(w t))

The angular frequency w and the decay rate s change linearly with time. They are reported for the middle of
the window, t = 0. Standard deviations follow from the residuals of the fit.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array

WINDOW_PERIOD_COUNT_RANGE = (2, 5)
"""Minimum and maximum number of periods of a window."""
WINDOW_LOG_DECREMENT = 0.3
"""Target of the logarithmic decrement over a window [1], within WINDOW_PERIOD_COUNT_RANGE."""
MAX_WINDOW_LOG_DECREMENT = 1.0
"""Logarithmic decrement over a window [1], from which the window is left out: the two periods of the window
are too different."""
MIN_SAMPLES_PER_PERIOD = 10
"""Minimum number of samples of a period."""
MIN_WINDOW_COUNT = 4
"""Minimum number of windows of a measurement."""
MIN_SIGNAL_TO_NOISE = 4.0
"""Amplitude over the standard deviation of the residuals [1], below which a window is not used."""
FREQUENCY_ERROR_OVER_DECREMENT_SQUARED, DAMPING_ERROR_OVER_DECREMENT_SQUARED = 8e-3, 1e-1
"""Relative error of frequency and of damping in a window without noise, over the square of the logarithmic
decrement over the window [1]. Source: simulated decays of known laws."""
RECORD_END_FRACTION = 0.2
"""Last fraction of a record [1]: if the motion is largest there, the record is no decay."""


@dataclass(frozen=True, slots=True)
class DecayPoints:
    """Frequency and damping of a free vibration at amplitudes (n) [m or rad].

    frequency           : undamped natural frequency (n) [Hz]
    damping_ratio       : damping ratio (n) [1]
    frequency_deviation : relative standard deviation (n) [1] of the frequency, up to a common factor
    damping_deviation   : standard deviation (n) [1] of the damping ratio, up to a common factor
    """

    motion_amplitude: Array
    frequency: Array
    damping_ratio: Array
    frequency_deviation: Array
    damping_deviation: Array


def analyse_decay(sample_times: Array, joint_motion: Array, message_prefix: str = "") -> DecayPoints:
    """Compute frequency and damping over the amplitude, from time (n) [s] and motion (n) [m or rad].

    Raises ValueError, whose message begins with `message_prefix`: time does not rise, too few samples or
    periods, or a growing motion.
    """
    if np.any(np.diff(sample_times) <= 0.0):
        row = int(np.argmax(np.diff(sample_times) <= 0.0)) + 1
        raise ValueError(
            f"{message_prefix}time does not increase at row {row + 1}; expected increasing times"
        )
    frequency = _find_peak_frequency(sample_times, joint_motion)
    step = float(np.median(np.diff(sample_times)))
    if not frequency * step * MIN_SAMPLES_PER_PERIOD <= 1.0:
        raise ValueError(
            f"{message_prefix}has {1.0 / (frequency * step):.3g} samples per period, at least "
            f"{MIN_SAMPLES_PER_PERIOD} are needed"
        )
    largest = sample_times[int(np.argmax(np.abs(joint_motion - np.median(joint_motion))))]
    if largest > sample_times[-1] - RECORD_END_FRACTION * (sample_times[-1] - sample_times[0]):
        raise ValueError(
            f"{message_prefix}the motion is largest at {largest:.3g} s, near its end: a joint cannot create "
            "energy; expected a decay; reverse the order of the rows if their time order is reversed"
        )
    windows = list(_fit_decay_windows(sample_times, joint_motion, 2.0 * np.pi * frequency))
    if len(windows) < MIN_WINDOW_COUNT:
        raise ValueError(
            f"{message_prefix}{len(windows)} time windows of a few periods of {1.0 / frequency:.3g} s are "
            f"above the noise, at least {MIN_WINDOW_COUNT} are needed; give a longer record or one with "
            "less noise"
        )
    amplitude, w, s, w_deviation, s_deviation, length = np.array(windows).T
    undamped = np.hypot(w, s)
    damping, decrement = s / undamped, s * length
    return DecayPoints(
        amplitude,
        undamped / (2.0 * np.pi),
        damping,
        np.hypot(w_deviation / w, FREQUENCY_ERROR_OVER_DECREMENT_SQUARED * decrement**2),
        np.hypot(s_deviation / undamped, DAMPING_ERROR_OVER_DECREMENT_SQUARED * damping * decrement**2),
    )


def _find_peak_frequency(sample_times: Array, joint_motion: Array) -> float:
    """Frequency [Hz] of the highest peak in the spectrum of the motion."""
    n = joint_motion.size
    even = np.interp(np.linspace(sample_times[0], sample_times[-1], n), sample_times, joint_motion)
    spectrum = np.abs(np.fft.rfft((even - even.mean()) * np.hanning(n), 8 * n))
    spectrum[:8] = 0.0
    return float(np.argmax(spectrum) / (8.0 * (sample_times[-1] - sample_times[0]) * n / (n - 1)))


def _fit_decay_windows(
    sample_times: Array, joint_motion: Array, angular_frequency: float
) -> Iterator[tuple[float, ...]]:
    """Fit a decaying oscillation in each window of a record.

    Yields for each window: amplitude, angular frequency [rad/s] and decay rate [1/s], the standard deviations
    of these two, length of the window [s].

    angular_frequency : angular frequency [rad/s] with which the first window is chosen
    """
    size, s = float(np.ptp(joint_motion)), 0.02 * angular_frequency
    begin = sample_times[int(np.argmax(np.abs(joint_motion - np.median(joint_motion))))]
    while True:
        periods = int(
            np.clip(
                WINDOW_LOG_DECREMENT * angular_frequency / (2.0 * np.pi * max(s, 1e-9 * angular_frequency)),
                *WINDOW_PERIOD_COUNT_RANGE,
            )
        )
        length = 2.0 * np.pi * periods / angular_frequency
        inside = (sample_times >= begin) & (sample_times < begin + length)
        t, u = (sample_times[inside] - begin) / length - 0.5, joint_motion[inside] / size
        begin += length
        if begin > sample_times[-1] or t.size < MIN_SAMPLES_PER_PERIOD:
            return
        shape = _fit_decay_window(np.array([angular_frequency * length, s * length]), t, u)
        residual = _decay_window_residuals(shape, t, u)
        *_, A, B = np.linalg.lstsq(_decay_design_matrix(shape, t), u)[0]
        amplitude, noise = float(np.hypot(A, B)), float(np.sqrt(residual @ residual / max(t.size - 8, 1)))
        if not amplitude > MIN_SIGNAL_TO_NOISE * noise:
            return
        angular_frequency, s = float(shape[0]) / length, float(shape[1]) / length
        deviations = (x / length for x in _estimate_standard_deviations(shape, A, B, t, noise))
        if s * length < MAX_WINDOW_LOG_DECREMENT:
            yield size * amplitude, angular_frequency, s, *deviations, length


def _fit_decay_window(start_values: Array, window_times: Array, scaled_motion: Array) -> Array:
    """Fit angular frequency and decay rate in one window, and the rates of change of both (4).

    start_values : start values (2) of angular frequency and decay rate
    window_times : time (n) from the middle of the window

    Time and results are made dimensionless with the length of the window. Frequency and decay rate are first
    fitted as constants, then all four parameters together.
    """
    from scipy.optimize import least_squares  # slow to import, and most commands import this module

    constant = least_squares(
        lambda x: _decay_window_residuals(np.append(x, [0.0, 0.0]), window_times, scaled_motion), start_values
    ).x
    start = np.append(constant, [0.0, 0.0])
    return np.asarray(
        least_squares(lambda x: _decay_window_residuals(x, window_times, scaled_motion), start).x
    )


def _decay_window_residuals(window_parameters: Array, window_times: Array, scaled_motion: Array) -> Array:
    """Residuals (n) of a decaying oscillation; offset, drift and amplitudes are fitted linearly to a signal.

    window_parameters : angular frequency, decay rate, and the rates of change of both (4)
    """
    matrix = _decay_design_matrix(window_parameters, window_times)
    return np.asarray(scaled_motion - matrix @ np.linalg.lstsq(matrix, scaled_motion)[0])


def _decay_design_matrix(window_parameters: Array, window_times: Array) -> Array:
    """Design matrix (n, 4) of a decaying oscillation: ones, time, decaying cosine, decaying sine.

    window_parameters : angular frequency, decay rate, and the rates of change of both (4)
    """
    w, s, w_rate, s_rate = window_parameters
    angle = (w + 0.5 * w_rate * window_times) * window_times
    decay = np.exp(-(s + 0.5 * s_rate * window_times) * window_times)
    return np.stack(
        [np.ones_like(window_times), window_times, decay * np.cos(angle), decay * np.sin(angle)], axis=1
    )


def _estimate_standard_deviations(
    window_parameters: Array,
    cosine_amplitude: float,
    sine_amplitude: float,
    window_times: Array,
    residual_deviation: float,
) -> tuple[float, float]:
    """Standard deviations of angular frequency and decay rate, dimensionless with the window length.

    cosine_amplitude, sine_amplitude : amplitudes of cosine and sine
    residual_deviation : standard deviation of the residuals
    """
    ones, _, cos, sin = _decay_design_matrix(window_parameters, window_times).T
    d_angle, d_decay = (
        sine_amplitude * cos - cosine_amplitude * sin,
        -(cosine_amplitude * cos + sine_amplitude * sin),
    )  # derivatives of u in angle and decay
    columns = [
        ones,
        window_times,
        cos,
        sin,
        window_times * d_angle,
        window_times * d_decay,
        window_times**2 * d_angle,
        window_times**2 * d_decay,
    ]
    jacobian = np.stack(columns, axis=1)
    size = np.linalg.norm(jacobian, axis=0)
    covariance = residual_deviation**2 * np.linalg.pinv((jacobian / size).T @ (jacobian / size))
    w_deviation, s_deviation = np.sqrt(np.diag(covariance))[4:6] / size[4:6]
    return float(w_deviation), float(s_deviation)
