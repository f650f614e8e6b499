"""A measured free decay to frequency and damping over the amplitude.

The record is cut into windows of a few periods. In each, a decaying oscillation about an offset,

    u = c + d t + exp(-s t) (A cos(w t) + B sin(w t)),

whose w and s change at constant rates is fitted by least squares; t is zero in the middle of the window,
where w and s are taken. What the fit leaves gives the standard deviations.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from jointfmu.quantity import Array

PERIODS = (2, 5)
"""Fewest and most periods of a window."""
DECAY = 0.3
"""Decay of the amplitude's logarithm within a window [1], where that leaves whole periods."""
STEEPEST = 1.0
"""The same [1] beyond which a window is left out: its two periods are too different."""
LEAST_SAMPLES = 10
"""Fewest samples of a period."""
LEAST_WINDOWS = 4
"""Fewest windows of a measurement."""
SEEN = 4.0
"""Amplitude over what a window's fit leaves [1] down to which it is used."""
FREQUENCY_ERROR, DAMPING_ERROR = 8e-3, 1e-1
"""What a window misses without noise, relative and over the square of the decay of its logarithm [1]: from
decays whose law is known."""
GROWING = 0.2
"""Last part of a record [1] in which no decay is largest."""


@dataclass(frozen=True, slots=True)
class Points:
    """Free vibration at amplitudes (n) [m or rad].

    frequency : (n) [Hz], without damping;  damping : (n) ratio [1]
    frequency_spread : (n) relative standard deviation of the frequency up to a factor [1]
    damping_spread : (n) that of the damping ratio up to a factor [1]
    """

    amplitude: Array
    frequency: Array
    damping: Array
    frequency_spread: Array
    damping_spread: Array


def points(time: Array, motion: Array, name: str = "") -> Points:
    """Frequency and damping over the amplitude from a record (n) [s], (n) [m or rad].

    Raises ValueError, beginning with `name`: time does not rise, too few samples or periods, or a motion
    that grows.
    """
    if np.any(np.diff(time) <= 0.0):
        row = int(np.argmax(np.diff(time) <= 0.0)) + 1
        raise ValueError(f"{name}time does not rise at its value {row + 1}; expected rising times")
    frequency = _main_frequency(time, motion)
    step = float(np.median(np.diff(time)))
    if not frequency * step * LEAST_SAMPLES <= 1.0:
        raise ValueError(
            f"{name}has {1.0 / (frequency * step):.3g} samples a period, at least {LEAST_SAMPLES} are needed"
        )
    largest = time[int(np.argmax(np.abs(motion - np.median(motion))))]
    if largest > time[-1] - GROWING * (time[-1] - time[0]):
        raise ValueError(
            f"{name}the motion is largest at {largest:.3g} s, near its end: the joint creates energy, "
            "expected is a decay; reverse the order of the rows if they run back in time"
        )
    found = list(_windows(time, motion, 2.0 * np.pi * frequency))
    if len(found) < LEAST_WINDOWS:
        raise ValueError(
            f"{name}{len(found)} windows of a few periods of {1.0 / frequency:.3g} s stand out of the noise, "
            f"at least {LEAST_WINDOWS} are needed"
        )
    amplitude, w, s, w_spread, s_spread, length = np.array(found).T
    whole = np.hypot(w, s)
    damping, decay = s / whole, s * length
    return Points(
        amplitude,
        whole / (2.0 * np.pi),
        damping,
        np.hypot(w_spread / w, FREQUENCY_ERROR * decay**2),
        np.hypot(s_spread / whole, DAMPING_ERROR * damping * decay**2),
    )


def _main_frequency(time: Array, motion: Array) -> float:
    """Frequency [Hz] of the highest peak of the spectrum."""
    n = motion.size
    even = np.interp(np.linspace(time[0], time[-1], n), time, motion)
    spectrum = np.abs(np.fft.rfft((even - even.mean()) * np.hanning(n), 8 * n))
    spectrum[:8] = 0.0
    return float(np.argmax(spectrum) / (8.0 * (time[-1] - time[0]) * n / (n - 1)))


def _windows(time: Array, motion: Array, w: float) -> Iterator[tuple[float, ...]]:
    """Amplitude, w and s [rad/s], the standard deviations of both, and length [s] of window after window."""
    size, s = float(np.ptp(motion)), 0.02 * w
    begin = time[int(np.argmax(np.abs(motion - np.median(motion))))]
    while True:
        periods = int(np.clip(DECAY * w / (2.0 * np.pi * max(s, 1e-9 * w)), *PERIODS))
        length = 2.0 * np.pi * periods / w
        inside = (time >= begin) & (time < begin + length)
        t, u = (time[inside] - begin) / length - 0.5, motion[inside] / size
        begin += length
        if begin > time[-1] or t.size < LEAST_SAMPLES:
            return
        shape = _fitted(np.array([w * length, s * length]), t, u)
        left = _left(shape, t, u)
        *_, A, B = np.linalg.lstsq(_shapes(shape, t), u)[0]
        amplitude, noise = float(np.hypot(A, B)), float(np.sqrt(left @ left / max(t.size - 8, 1)))
        if not amplitude > SEEN * noise:
            return
        w, s = float(shape[0]) / length, float(shape[1]) / length
        spreads = (x / length for x in _spreads(shape, A, B, t, noise))
        if s * length < STEEPEST:
            yield size * amplitude, w, s, *spreads, length


def _fitted(first: Array, t: Array, u: Array) -> Array:
    """w, s and their rates over times in windows: first without rates, then with them."""
    even = scipy.optimize.least_squares(lambda x: _left(np.append(x, [0.0, 0.0]), t, u), first).x
    start = np.append(even, [0.0, 0.0])
    return np.asarray(scipy.optimize.least_squares(lambda x: _left(x, t, u), start).x)


def _left(shape: Array, t: Array, u: Array) -> Array:
    """What the best amplitudes of a shape leave of a signal."""
    shapes = _shapes(shape, t)
    return np.asarray(u - shapes @ np.linalg.lstsq(shapes, u)[0])


def _shapes(shape: Array, t: Array) -> Array:
    """Columns (n, 4): one, time, and the two decaying oscillations."""
    w, s, w_rate, s_rate = shape
    angle, decay = (w + 0.5 * w_rate * t) * t, np.exp(-(s + 0.5 * s_rate * t) * t)
    return np.stack([np.ones_like(t), t, decay * np.cos(angle), decay * np.sin(angle)], axis=1)


def _spreads(shape: Array, A: float, B: float, t: Array, noise: float) -> tuple[float, float]:
    """Standard deviations of w and s [rad/s]."""
    one, _, cos, sin = _shapes(shape, t).T
    turned, decayed = B * cos - A * sin, -(A * cos + B * sin)
    columns = [one, t, cos, sin, t * turned, t * decayed, t**2 * turned, t**2 * decayed]
    jacobian = np.stack(columns, axis=1)
    size = np.linalg.norm(jacobian, axis=0)
    covariance = noise**2 * np.linalg.pinv((jacobian / size).T @ (jacobian / size))
    w_spread, s_spread = np.sqrt(np.diag(covariance))[4:6] / size[4:6]
    return float(w_spread), float(s_spread)
