"""A spring with friction that remembers, and one mass on it, against what was measured.

At a constant normal load the friction of elastically similar bodies follows Masing's rule (Jäger 1995,
Ciavarella 1998). After a turning point u_k the force changes by

    F - F_k = E(u) - E(u_k) + 2 sign(u - u_k) B(|u - u_k|/2)

with the elastic force E and the first loading B of the friction, until the motion passes the turning point
before: there the smaller loop closes.

A free vibration follows the law from turning point to turning point (`HysteresisLaw.decay`). A response is
that of the first harmonic: at the amplitude a the joint is a spring K(a) with the loss factor eta(a) of its
loop,

    F = a |K (1 + i eta) + i d w + 2 i own w sqrt(K M) - M w^2|,

d the joint's viscous damping and `own` the damping ratio of a structure beside it, which add to the damping
of the loop in a free vibration.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from jointfmu.quantity import Array

from .decay import Points

Force = Callable[[Array], Array]
_ANGLE, _WEIGHT = np.polynomial.legendre.leggauss(64)
_ANGLE, _WEIGHT = 0.5 * np.pi * (1.0 + _ANGLE), 0.5 * np.pi * _WEIGHT
"""Nodes of half an oscillation, cos(angle) from one turning point to the other."""
_SECANTS, _STEEPEST = 12, 3.0
"""Steps to a decrement, and the largest one [1]."""


@dataclass(frozen=True, slots=True)
class NonlinearSpring:
    """A spring without memory: force E and energy V at motions (...); E odd, V even."""

    force: Force
    energy: Force


@dataclass(frozen=True, slots=True)
class HysteresisLaw:
    """The law of a loop.

    friction : B (...), force or torque of first loading from rest at motions (...) >= 0
    work     : integral of B from 0 to motions (...) >= 0
    elastic  : what acts beside; None: nothing
    viscous  : force or torque over the rate of the motion, SI; in a vibration alone
    """

    friction: Force
    work: Force
    elastic: NonlinearSpring | None = None
    viscous: float = 0.0

    def change(self, motion: Array, start: Array) -> Array:
        """Change (...) of the force from turning points `start` (...) to motions (...)."""
        way = motion - start
        change = np.copysign(2.0 * self.friction(0.5 * np.abs(way)), way)
        if self.elastic is None:
            return change
        return np.asarray(change + self.elastic.force(motion) - self.elastic.force(start))

    def about(self, rest: float) -> "HysteresisLaw":
        """The same with the elastic force at rest at another motion."""
        if self.elastic is None:
            return self
        force, energy = self.elastic.force, self.elastic.energy
        return replace(self, elastic=NonlinearSpring(lambda u: force(u - rest), lambda u: energy(u - rest)))

    def equivalent(self, amplitude: Array) -> tuple[Array, Array]:
        """Stiffness (n) and loss factor (n) [1] of the loops about rest with amplitudes (n).

        First harmonic of the force under u = a cos(angle): K = 1/(pi a) times the integral of F cos over a
        period, eta = W/(pi K a^2), W the loop's area. Both branches of a loop give the same.
        """
        a = amplitude[:, None]
        motion = a * np.cos(_ANGLE)
        force = self.change(motion, np.broadcast_to(a, motion.shape))
        stiffness = 2.0 / (np.pi * amplitude) * ((force * np.cos(_ANGLE)) @ _WEIGHT)
        return stiffness, self.area(amplitude) / (np.pi * stiffness * amplitude**2)

    def area(self, amplitude: Array) -> Array:
        """Work (n) [J] that closed loops of amplitudes (n) about rest turn into heat: 8 (work - B a/2)."""
        return np.asarray(8.0 * (self.work(amplitude) - 0.5 * amplitude * self.friction(amplitude)))

    def decay(self, half: Array, inertia: float) -> tuple[Array, Array]:
        """Free vibration of an inertia: angular frequency (n) [rad/s] and decrement of half a period (n) [1].

        half : (n) half the way between two turning points, in the middle of a decay

        From one turning point to the next no energy is left or missing. With F_k the friction force at the
        first, h half the way between them, w = `work` and the viscous work pi d omega h^2/2,

            V(a_k) - V(a_k+1) + 2 h F_k - 2 h G(h) = 0,   G(h) = 2 w(h)/h + pi d omega h/4,
            F_k+1 = 2 B(h) - F_k,

        so that with the decrement b of two neighbouring ways h exp(+-b/2)

            G(h_k) + G(h_k+1) - 2 B(h_k) = D_k + D_k+1,   D_k = (V(a_k) - V(a_k+1))/(2 h_k).

        The time is the integral of du over the speed, without viscous damping.
        """
        omega = self._frequency(half, self._decrement(half, 0.0 * half)) / np.sqrt(inertia)
        return omega, self._decrement(half, 0.25 * np.pi * self.viscous * omega)

    def _decrement(self, half: Array, viscous: Array) -> Array:
        """b (n), `viscous` the part of G over h."""

        def held(way: Array) -> Array:
            return np.asarray(2.0 * self.work(way) / way + viscous * way)

        def left(b: Array) -> Array:
            first, second = half * np.exp(0.5 * b), half * np.exp(-0.5 * b)
            rest = held(first) + held(second) - 2.0 * self.friction(first)
            return np.asarray(rest - self._released(first, b) - self._released(second, b))

        low, high = np.zeros_like(half), np.full_like(half, 1e-3)
        at_low, at_high = left(low), left(high)
        for _ in range(_SECANTS):
            slope = np.where(at_high == at_low, np.inf, at_high - at_low)
            low, high = high, np.clip(high - at_high * (high - low) / slope, 0.0, _STEEPEST)
            at_low, at_high = at_high, left(high)
        return high

    def _frequency(self, half: Array, b: Array) -> Array:
        """Angular frequency (n) [rad/s] of a unit inertia."""
        start = 2.0 * half / (1.0 + np.exp(-b))
        way = half[:, None] * (1.0 - np.cos(_ANGLE))
        force = 2.0 * self.work(half) / half - self._released(half, b)
        square = 2.0 * (force[:, None] * way - 4.0 * self.work(0.5 * way))
        if self.elastic is not None:
            V = self.elastic.energy
            square += 2.0 * (V(start)[:, None] - V(start[:, None] - way))
        speed = np.sqrt(np.maximum(square, 1e-300))
        return np.asarray(np.pi / ((half[:, None] * np.sin(_ANGLE) / speed) @ _WEIGHT))

    def _released(self, half: Array, b: Array) -> Array:
        """D: elastic energy released on a way over the way."""
        if self.elastic is None:
            return np.zeros_like(half)
        start = 2.0 * half / (1.0 + np.exp(-b))
        V = self.elastic.energy
        return np.asarray((V(start) - V(start * np.exp(-b))) / (2.0 * half))


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
        return self.misfit(model) / scale
