"""Fit of a drive's torque by elements of MuJoCo: k x + k3 x^3 and yielding springs, by least squares."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, nnls

from jointfmu.mechanics.jenkins import Sliders
from jointfmu.quantity import Array

from .transmission import LOOP_POINT_COUNT, RAMP_POINT_COUNT, Transmission, loop_area

YIELD_OVER_MAX_WIND_UPS = np.geomspace(0.02, 0.4, 6)
"""Candidate yield wind-ups of the springs over the largest wind-up of the fit [1].

All springs yield within the range of the fit, so no spring adds hysteresis beyond it.
"""
MIN_LOOP_OVER_BOX_AREA = 1e-6
"""Area of the hysteresis loop over area of its bounding box [1], below which it counts as zero.

Round-off of the drive's inversion leaves about this area."""


@dataclass(frozen=True, slots=True)
class FittedSpring:
    """Torque [N.m] against wind-up x [rad] from rest: k x + k3 x^3, and yielding springs in parallel.

    linear_stiffness : k [N.m/rad], not negative, so that the torque increases with wind-up
    cubic_stiffness  : k3 [N.m/rad^3], not negative
    yielding_springs : (stiffness [N.m/rad], yield wind-up [rad]) of each yielding spring
    max_torque       : largest torque [N.m] of the fit
    """

    linear_stiffness: float
    cubic_stiffness: float
    yielding_springs: tuple[tuple[float, float], ...]
    max_torque: float

    def compute_torque(self, wind_up: Array) -> Array:
        """Torques (n) [N.m] along a history of wind-ups (n) [rad] that starts at rest."""
        elastic = self.linear_stiffness * wind_up + self.cubic_stiffness * wind_up**3
        return elastic + sum(
            (k * compute_unit_slider_torque(wind_up, y) for k, y in self.yielding_springs),
            np.zeros_like(wind_up),
        )

    def solve_wind_up(self, torque: float) -> float:
        """Wind-up [rad] at a torque [N.m], for first loading from rest."""
        upper = 1.0
        while self.compute_torque(np.array([upper]))[0] < abs(torque):
            upper *= 2.0
        size = brentq(lambda x: self.compute_torque(np.array([x]))[0] - abs(torque), 0.0, upper, xtol=1e-15)
        return float(np.copysign(size, torque))

    def stiffness_at_torque(self, torque: float) -> float:
        """Stiffness [N.m/rad] of small vibrations about a torque [N.m], with all sliders sticking."""
        x = self.solve_wind_up(torque)
        return (
            self.linear_stiffness
            + 3.0 * self.cubic_stiffness * x**2
            + sum(k for k, _ in self.yielding_springs)
        )


def compute_unit_slider_torque(wind_up: Array, yield_wind_up: float) -> Array:
    """Torque (n) of a yielding spring of stiffness 1 N.m/rad along wind-ups (n) [rad] that start at rest."""
    return Sliders(np.ones(1)).follow_increments(np.diff(wind_up, prepend=0.0), np.array([yield_wind_up]))


def fit_spring(drive: Transmission, max_torque: float) -> FittedSpring:
    """Fit nonnegative coefficients to the torque of a drive along a ramp to `max_torque` [N.m] and one loop.

    The yielding springs are fitted first, to half the distance between the branches of the loop, which does
    not depend on the elastic part. So smaller loops also have about the right area.
    """
    torques, x = drive.compute_loop(max_torque)
    largest = float(np.max(np.abs(x)))
    has_hysteresis = abs(loop_area(x, torques)) > MIN_LOOP_OVER_BOX_AREA * 4.0 * max_torque * largest
    limits = (YIELD_OVER_MAX_WIND_UPS * largest).tolist() if has_hysteresis else []
    sliders: tuple[tuple[float, float], ...] = ()
    if has_hysteresis:
        forces = [compute_unit_slider_torque(x, y) for y in limits]
        half_widths = np.stack([loop_half_width(x, force) for force in forces], axis=1)
        stiffnesses = nnls(half_widths, loop_half_width(x, torques))[0]
        sliders = tuple((k, y) for k, y in zip(stiffnesses.tolist(), limits, strict=True) if k > 0.0)
    elastic = torques - sum((k * compute_unit_slider_torque(x, y) for k, y in sliders), np.zeros_like(x))
    scaled = x / largest
    linear, cubic = (nnls(np.stack([scaled, scaled**3], axis=1), elastic)[0] / largest).tolist()
    return FittedSpring(linear, cubic / largest**2, sliders, max_torque)


def loop_half_width(wind_up: Array, torque: Array) -> Array:
    """Half the torque difference (n) [N.m] of the branches of a loop, at n wind-ups between its ends."""
    back = slice(RAMP_POINT_COUNT, RAMP_POINT_COUNT + LOOP_POINT_COUNT // 2 + 1)
    forth = slice(RAMP_POINT_COUNT + LOOP_POINT_COUNT // 2, None)
    x = np.linspace(wind_up[back].min(), wind_up[back].max(), RAMP_POINT_COUNT)
    down = np.interp(x, wind_up[back][::-1], torque[back][::-1])
    return np.asarray(0.5 * (down - np.interp(x, wind_up[forth], torque[forth])))
