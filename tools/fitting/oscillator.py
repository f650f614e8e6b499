"""One mass on a joint with memory: free vibration and response, against what was measured.

A free vibration follows the law from turning point to turning point (`Hysteresis.decay`). A response is
that of the first harmonic: at the amplitude a the joint is a spring K(a) with the loss factor eta(a) of
its loop,

    F = a |K (1 + i eta) + i d w + 2 i own w sqrt(K M) - M w^2|,

d the joint's viscous damping and `own` the damping ratio of a structure beside it, which add to the damping
of the loop in a free vibration.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from .decay import Points
from .hysteresis import HysteresisLaw
from .least_squares import Array

REACH = 30.0
"""How far beyond the measured amplitudes, as a factor [1], a response is looked for."""
_TABLE, _HALVINGS = 80, 50


@dataclass(frozen=True, slots=True)
class Oscillator:
    """The law of a loop, the mass or inertia on it, and the damping ratio [1] beside it."""

    law: HysteresisLaw
    inertia: float
    damping: float = 0.0

    def free(self, amplitude: Array) -> tuple[Array, Array]:
        """Frequency (n) [Hz] and damping ratio (n) [1] of free vibration."""
        omega, decrement = self.law.decay(amplitude, self.inertia)
        return omega / (2.0 * np.pi), decrement / np.hypot(np.pi, decrement) + self.damping

    def response(self, frequency: Array, force: Array, near: Array) -> Array:
        """Amplitude (n) under forces (n) at frequencies (n) [Hz], within REACH of amplitudes `near`."""
        ends = float(np.log(near.min() / REACH)), float(np.log(near.max() * REACH))
        grid = np.linspace(ends[0], ends[1], _TABLE)
        stiffness, loss = self.law.equivalent(np.exp(grid))
        table = CubicSpline(grid, np.stack([stiffness, loss], axis=1))
        w = 2.0 * np.pi * frequency
        low, high = np.full(w.shape, ends[0]), np.full(w.shape, ends[1])
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            K, eta = table(middle).T
            own = self.law.viscous * w + 2.0 * self.damping * w * np.sqrt(np.maximum(K, 0.0) * self.inertia)
            needed = np.exp(middle) * np.hypot(K - self.inertia * w**2, K * eta + own)
            low, high = np.where(needed < force, middle, low), np.where(needed < force, high, middle)
        return np.asarray(np.exp(0.5 * (low + high)))


@dataclass(frozen=True, slots=True)
class Free:
    """Measured frequency and damping over the amplitude."""

    points: Points

    nuisances = 0

    @property
    def groups(self) -> NDArray[np.int64]:
        """Frequencies and dampings have their own noise."""
        return np.repeat([0, 1], self.points.amplitude.size)

    @property
    def scale(self) -> Array:
        """Standard deviations (2 n) of the misfit up to a factor for each group [1]."""
        return np.concatenate([self.points.frequency_spread, self.points.damping_spread])

    def misfit(self, model: Oscillator) -> Array:
        """Frequencies of the data over the model's minus 1, then differences of the damping ratios (2 n)."""
        frequency, damping = model.free(self.points.amplitude)
        data = self.points
        return np.concatenate([data.frequency / frequency - 1.0, data.damping - damping])

    def residuals(self, model: Oscillator, scale: Array) -> Array:
        """Misfit over the scale (2 n)."""
        return self.misfit(model) / scale


@dataclass(frozen=True, slots=True)
class Response:
    """Measured amplitudes under forces at frequencies (n)."""

    frequency: Array
    force: Array
    amplitude: Array

    nuisances = 0

    @property
    def groups(self) -> NDArray[np.int64]:
        """All have the same noise."""
        return np.zeros(self.amplitude.size, dtype=np.int64)

    @property
    def scale(self) -> Array:
        """Standard deviations (n) of the misfit up to a factor [1]."""
        return np.ones(self.amplitude.size)

    def misfit(self, model: Oscillator) -> Array:
        """Logarithm of the amplitude over the model's (n)."""
        return np.log(self.amplitude / model.response(self.frequency, self.force, self.amplitude))

    def residuals(self, model: Oscillator, scale: Array) -> Array:
        """Misfit over the scale (n)."""
        return self.misfit(model) / scale
