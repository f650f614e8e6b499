"""Hysteresis law of Masing type, and an oscillator of one mass on it; residuals against measured vibrations.

At a constant normal load the friction of elastically similar bodies follows Masing's rule (Jäger 1995,
Ciavarella 1998). After a turning point u_k the force changes by

    F - F_k = E(u) - E(u_k) + 2 sign(u - u_k) B(|u - u_k|/2)

with the elastic force E, and the friction force B in first loading. The rule holds until the motion passes
the previous turning point: there the smaller loop closes.

A free vibration follows the law from turning point to turning point (`HysteresisLaw.free_decay`). A forced
vibration uses the first harmonic (harmonic balance): at the amplitude a the joint is a spring K(a) with the
loss factor eta(a) of its loop,

    F = a |K (1 + i eta) + i d w + 2 i D w sqrt(K M) - M w^2|

with the viscous damping d of the joint, the damping ratio D of the structure and the mass M. In a free
vibration, too, the damping ratio D is added to the damping of the joint.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .decay import DecayPoints

ForceFunction = Callable[[Array], Array]
"""Function of motions (...): forces (...)."""
_HALF_CYCLE_ANGLES, _HALF_CYCLE_WEIGHTS = np.polynomial.legendre.leggauss(64)
_HALF_CYCLE_ANGLES = 0.5 * np.pi * (1.0 + _HALF_CYCLE_ANGLES)
_HALF_CYCLE_WEIGHTS = 0.5 * np.pi * _HALF_CYCLE_WEIGHTS
"""Gauss-Legendre angles (64) [rad] from 0 to pi, and their weights: half an oscillation u = a cos(angle)."""
_MAX_DECREMENT_SECANT_STEPS, _MAX_LOG_DECREMENT = 12, 3.0
"""Number of secant iterations for the logarithmic decrement of half a period, and upper limit of it [1]."""


@dataclass(frozen=True, slots=True)
class NonlinearSpring:
    """Nonlinear elastic spring parallel to the friction: force E(u), odd in the motion u, and energy V(u)."""

    elastic_force: ForceFunction
    elastic_energy: ForceFunction


@dataclass(frozen=True, slots=True)
class HysteresisLaw:
    """Force as a function of the motion and its turning points: Masing friction and a parallel spring.

    friction_force  : B(u), friction force or torque in first loading from rest, for motions u (...) >= 0
    friction_work   : integral [J] of B from 0 to u, for motions u (...) >= 0
    elastic_spring  : parallel nonlinear spring; None: no spring
    viscous_damping : viscous damping [N.s/m or N.m.s/rad]; acts in vibrations only
    """

    friction_force: ForceFunction
    friction_work: ForceFunction
    elastic_spring: NonlinearSpring | None = None
    viscous_damping: float = 0.0

    def force_change(self, joint_motion: Array, turning_point_motion: Array) -> Array:
        """Change (...) of the force from the turning points to motions (...), by Masing's rule.

        turning_point_motion : motion (...) at the turning points
        """
        distance = joint_motion - turning_point_motion
        change = np.copysign(2.0 * self.friction_force(0.5 * np.abs(distance)), distance)
        if self.elastic_spring is None:
            return change
        return np.asarray(
            change
            + self.elastic_spring.elastic_force(joint_motion)
            - self.elastic_spring.elastic_force(turning_point_motion)
        )

    def with_rest_position(self, rest_position: float) -> "HysteresisLaw":
        """Copy of the law whose elastic force is zero at the motion `rest_position`, instead of at zero."""
        if self.elastic_spring is None:
            return self
        force, energy = self.elastic_spring.elastic_force, self.elastic_spring.elastic_energy
        moved = NonlinearSpring(lambda u: force(u - rest_position), lambda u: energy(u - rest_position))
        return replace(self, elastic_spring=moved)

    def equivalent_spring(self, motion_amplitude: Array) -> tuple[Array, Array]:
        """Equivalent stiffness (n) and loss factor (n) [1] of closed loops about rest with amplitudes (n).

        First harmonic of the force under u = a cos(angle): K = 1/(pi a) times the integral of F cos(angle)
        over a period, eta = W/(pi K a^2), with the area W of the loop. The integral is taken over one branch,
        because both branches contribute equally.
        """
        a = motion_amplitude[:, None]
        motion = a * np.cos(_HALF_CYCLE_ANGLES)
        force = self.force_change(motion, np.broadcast_to(a, motion.shape))
        stiffness = (
            2.0 / (np.pi * motion_amplitude) * ((force * np.cos(_HALF_CYCLE_ANGLES)) @ _HALF_CYCLE_WEIGHTS)
        )
        return stiffness, self.loop_area(motion_amplitude) / (np.pi * stiffness * motion_amplitude**2)

    def loop_area(self, motion_amplitude: Array) -> Array:
        """Dissipated energy (n) [J] of closed loops about rest with amplitudes a (n): 8 (w(a) - B(a) a/2).

        B is the friction force in first loading, w its work.
        """
        return np.asarray(
            8.0
            * (
                self.friction_work(motion_amplitude)
                - 0.5 * motion_amplitude * self.friction_force(motion_amplitude)
            )
        )

    def free_decay(self, half_cycle_amplitude: Array, inertia: float) -> tuple[Array, Array]:
        """Free decay: angular frequency (n) [rad/s], logarithmic decrement of half a period (n) [1].

        half_cycle_amplitude : h (n), half the distance between two consecutive turning points
        inertia              : mass [kg] or moment of inertia [kg.m2] on the joint

        Energy balance from the turning point a_k of the motion to the next, a_k+1: friction force F_k at a_k,
        friction force B and work w in first loading, energy V of the elastic spring, and the work
        pi d omega h^2/2 of the viscous damping d at the angular frequency omega:

            V(a_k) - V(a_k+1) + 2 h F_k - 2 h G(h) = 0,   G(h) = 2 w(h)/h + pi d omega h/4,
            F_k+1 = 2 B(h) - F_k

        Two consecutive half-cycle amplitudes are h exp(+-b/2), with the decrement b. Eliminating F_k gives

            G(h_k) + G(h_k+1) - 2 B(h_k) = D_k + D_k+1,   D_k = (V(a_k) - V(a_k+1))/(2 h_k)

        Half a period is the integral of du over the speed; viscous damping is neglected in the speed.
        """
        omega = self._angular_frequency(
            half_cycle_amplitude,
            self._logarithmic_decrement(half_cycle_amplitude, 0.0 * half_cycle_amplitude),
        ) / np.sqrt(inertia)
        return omega, self._logarithmic_decrement(
            half_cycle_amplitude, 0.25 * np.pi * self.viscous_damping * omega
        )

    def _logarithmic_decrement(self, half_cycle_amplitude: Array, viscous_slope: Array) -> Array:
        """Logarithmic decrement b (n) [1] of half a period, from the energy balance of `free_decay`.

        viscous_slope : viscous part (n) of the dissipated force G(h) over h, pi d omega/4
        """

        def dissipated_work_per_distance(half_cycle_amplitude: Array) -> Array:
            """Dissipated work of half a cycle per distance 2 h between its ends: G(h) of `free_decay`."""
            return np.asarray(
                2.0 * self.friction_work(half_cycle_amplitude) / half_cycle_amplitude
                + viscous_slope * half_cycle_amplitude
            )

        def energy_residual(log_decrement: Array) -> Array:
            """Residual (n) [N or N.m] of the energy balance of `free_decay` for a logarithmic decrement."""
            first, second = (
                half_cycle_amplitude * np.exp(0.5 * log_decrement),
                half_cycle_amplitude * np.exp(-0.5 * log_decrement),
            )
            dissipated = (
                dissipated_work_per_distance(first)
                + dissipated_work_per_distance(second)
                - 2.0 * self.friction_force(first)
            )
            return np.asarray(
                dissipated
                - self._released_energy_per_distance(first, log_decrement)
                - self._released_energy_per_distance(second, log_decrement)
            )

        low, high = np.zeros_like(half_cycle_amplitude), np.full_like(half_cycle_amplitude, 1e-3)
        at_low, at_high = energy_residual(low), energy_residual(high)
        for _ in range(_MAX_DECREMENT_SECANT_STEPS):
            slope = np.where(at_high == at_low, np.inf, at_high - at_low)
            low, high = high, np.clip(high - at_high * (high - low) / slope, 0.0, _MAX_LOG_DECREMENT)
            at_low, at_high = at_high, energy_residual(high)
        return high

    def _angular_frequency(self, half_cycle_amplitude: Array, log_decrement: Array) -> Array:
        """Angular frequency (n) [rad/s] of free vibration with a unit inertia.

        half_cycle_amplitude : h (n), half the distance between two consecutive turning points
        log_decrement        : logarithmic decrement b (n) [1] of half a period
        """
        start = 2.0 * half_cycle_amplitude / (1.0 + np.exp(-log_decrement))
        distance = half_cycle_amplitude[:, None] * (1.0 - np.cos(_HALF_CYCLE_ANGLES))
        force = 2.0 * self.friction_work(
            half_cycle_amplitude
        ) / half_cycle_amplitude - self._released_energy_per_distance(half_cycle_amplitude, log_decrement)
        speed_squared = 2.0 * (force[:, None] * distance - 4.0 * self.friction_work(0.5 * distance))
        if self.elastic_spring is not None:
            V = self.elastic_spring.elastic_energy
            speed_squared += 2.0 * (V(start)[:, None] - V(start[:, None] - distance))
        speed = np.sqrt(np.maximum(speed_squared, 1e-300))
        return np.asarray(
            np.pi
            / ((half_cycle_amplitude[:, None] * np.sin(_HALF_CYCLE_ANGLES) / speed) @ _HALF_CYCLE_WEIGHTS)
        )

    def _released_energy_per_distance(self, half_cycle_amplitude: Array, log_decrement: Array) -> Array:
        """Energy that the elastic spring releases between two turning points, per distance 2 h [N or N.m].

        half_cycle_amplitude : h (n), half the distance between two consecutive turning points
        log_decrement        : logarithmic decrement (n) [1] of half a period
        """
        if self.elastic_spring is None:
            return np.zeros_like(half_cycle_amplitude)
        start = 2.0 * half_cycle_amplitude / (1.0 + np.exp(-log_decrement))
        V = self.elastic_spring.elastic_energy
        return np.asarray((V(start) - V(start * np.exp(-log_decrement))) / (2.0 * half_cycle_amplitude))


AMPLITUDE_SEARCH_FACTOR = 30.0
"""Factor [1] below the smallest and above the largest measured amplitude: range in which amplitudes of forced
vibration are searched."""
_EQUIVALENT_SPRING_TABLE_POINTS, _MAX_AMPLITUDE_BISECTIONS = 80, 50
"""Number of amplitudes at which the equivalent spring is tabulated, and of bisections for the amplitude."""


@dataclass(frozen=True, slots=True)
class Oscillator:
    """Mass on a joint, an oscillator of one degree of freedom, whose vibration is compared with a test.

    The fields are the hysteresis law, the mass or inertia, and the structural damping ratio [1].
    """

    hysteresis_law: HysteresisLaw
    inertia: float
    damping_ratio: float = 0.0

    def free_vibration(self, motion_amplitude: Array) -> tuple[Array, Array]:
        """Frequency (n) [Hz] and damping ratio (n) [1] of free vibration at amplitudes (n)."""
        omega, decrement = self.hysteresis_law.free_decay(motion_amplitude, self.inertia)
        return omega / (2.0 * np.pi), decrement / np.hypot(np.pi, decrement) + self.damping_ratio

    def response_amplitude(
        self, excitation_frequency: Array, force_amplitude: Array, measured_amplitude: Array
    ) -> Array:
        """Amplitude (n) of forced vibration under force amplitudes (n) at frequencies (n) [Hz].

        measured_amplitude : amplitudes; the result is searched within a factor of AMPLITUDE_SEARCH_FACTOR
        """
        from scipy.interpolate import CubicSpline  # slow to import, and most commands import this module

        ends = (
            float(np.log(measured_amplitude.min() / AMPLITUDE_SEARCH_FACTOR)),
            float(np.log(measured_amplitude.max() * AMPLITUDE_SEARCH_FACTOR)),
        )
        grid = np.linspace(ends[0], ends[1], _EQUIVALENT_SPRING_TABLE_POINTS)
        stiffness, loss = self.hysteresis_law.equivalent_spring(np.exp(grid))
        table = CubicSpline(grid, np.stack([stiffness, loss], axis=1))
        w = 2.0 * np.pi * excitation_frequency
        low, high = np.full(w.shape, ends[0]), np.full(w.shape, ends[1])
        for _ in range(_MAX_AMPLITUDE_BISECTIONS):
            middle = 0.5 * (low + high)
            K, eta = table(middle).T
            linear = self.hysteresis_law.viscous_damping * w + 2.0 * self.damping_ratio * w * np.sqrt(
                np.maximum(K, 0.0) * self.inertia
            )  # viscous damping and structural damping, as a stiffness in phase with the velocity
            required = np.exp(middle) * np.hypot(K - self.inertia * w**2, K * eta + linear)
            low, high = (
                np.where(required < force_amplitude, middle, low),
                np.where(required < force_amplitude, high, middle),
            )
        return np.asarray(np.exp(0.5 * (low + high)))


@dataclass(frozen=True, slots=True)
class FreeVibration:
    """Measured frequency and damping ratio of free vibration as functions of the amplitude."""

    decay_points: DecayPoints

    nuisance_count = 0

    @property
    def noise_group_of_residual(self) -> NDArray[np.int64]:
        """Index (2 n) of the group of residuals with equal noise: 0 for frequencies, 1 for damping ratios."""
        return np.repeat([0, 1], self.decay_points.motion_amplitude.size)

    @property
    def residual_scale(self) -> Array:
        """Standard deviations (2 n) [1] of the misfits, up to a factor for each noise group."""
        return np.concatenate([self.decay_points.frequency_deviation, self.decay_points.damping_deviation])

    def misfit(self, oscillator: Oscillator) -> Array:
        """Differences (2 n) [1] between data at n amplitudes and an oscillator: frequencies, damping ratios.

        Frequencies: measured over computed value, minus 1. Damping ratios: measured minus computed value.
        """
        frequency, damping = oscillator.free_vibration(self.decay_points.motion_amplitude)
        data = self.decay_points
        return np.concatenate([data.frequency / frequency - 1.0, data.damping_ratio - damping])

    def residuals(self, oscillator: Oscillator, residual_scale: Array) -> Array:
        """Differences of data and oscillator (`misfit`) over their standard deviations `residual_scale`."""
        return self.misfit(oscillator) / residual_scale


@dataclass(frozen=True, slots=True)
class ForcedResponse:
    """Measured amplitudes (n) of forced vibration at force amplitudes (n) and frequencies (n) [Hz]."""

    excitation_frequency: Array
    force_amplitude: Array
    motion_amplitude: Array

    nuisance_count = 0

    @property
    def noise_group_of_residual(self) -> NDArray[np.int64]:
        """Index (n) of the group of residuals with equal noise: 0 for all amplitudes."""
        return np.zeros(self.motion_amplitude.size, dtype=np.int64)

    @property
    def residual_scale(self) -> Array:
        """Standard deviations (n) [1] of the misfits, up to a common factor."""
        return np.ones(self.motion_amplitude.size)

    def misfit(self, oscillator: Oscillator) -> Array:
        """Differences (n) [1] of data and oscillator: logarithm of measured over computed amplitude."""
        return np.log(
            self.motion_amplitude
            / oscillator.response_amplitude(
                self.excitation_frequency, self.force_amplitude, self.motion_amplitude
            )
        )

    def residuals(self, oscillator: Oscillator, residual_scale: Array) -> Array:
        """Differences of data and oscillator (`misfit`) over their standard deviations `residual_scale`."""
        return self.misfit(oscillator) / residual_scale
