"""A drive's torque as a sum of what MuJoCo has: k x + k3 x^3 and springs that yield, by least squares."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, nnls

from jointfmu.mechanics.jenkins import Sliders
from jointfmu.quantity import Array

from .transmission import LOOP, RAMP, Transmission, area

YIELDS = np.geomspace(0.02, 0.4, 6)
"""Wind-ups at which the springs may yield, over that at the largest torque of the fit [1]: all yield on
the way there, so beyond it none holds a set that the fit has not seen."""
LOSSLESS = 1e-6
"""Loop over its bounding box [1] below which there is no hysteresis: round-off of the drive's inversion."""


@dataclass(frozen=True, slots=True)
class FittedTendons:
    """Torque [N.m] over wind-up x [rad] from rest: linear x + cubic x^3, and springs in parallel that yield.

    linear, cubic : [N.m/rad], [N.m/rad^3], neither negative: the torque grows with the wind-up everywhere
    sliders       : spring [N.m/rad] and yield [rad] of each
    torque        : [N.m] to which it was fitted
    """

    linear: float
    cubic: float
    sliders: tuple[tuple[float, float], ...]
    torque: float

    def along(self, wind_up: Array) -> Array:
        """Torques (n) [N.m] along wind-ups (n) [rad] from rest."""
        found = self.linear * wind_up + self.cubic * wind_up**3
        return found + sum((k * slider(wind_up, y) for k, y in self.sliders), np.zeros_like(wind_up))

    def wind_up(self, torque: float) -> float:
        """[rad] on the way from rest at a torque [N.m]."""
        far = 1.0
        while self.along(np.array([far]))[0] < abs(torque):
            far *= 2.0
        found = brentq(lambda x: self.along(np.array([x]))[0] - abs(torque), 0.0, far, xtol=1e-15)
        return float(np.copysign(found, torque))

    def stiffness(self, torque: float) -> float:
        """[N.m/rad] of small vibrations about a torque [N.m]: what slides sticks again."""
        x = self.wind_up(torque)
        return self.linear + 3.0 * self.cubic * x**2 + sum(k for k, _ in self.sliders)


def slider(wind_up: Array, limit: float) -> Array:
    """Force (n) of a spring of stiffness 1 that yields at a limit, along wind-ups (n) from rest."""
    return Sliders(np.ones(1)).path(np.diff(wind_up, prepend=0.0), np.array([limit]))


def fit(drive: Transmission, torque: float) -> FittedTendons:
    """The least squares of the torque along a ramp to a torque [N.m] and a loop from there, none negative.

    The springs that yield come first, from half the distance of the loop's branches, in which what is elastic
    has no part: so loops inside have their area too.
    """
    torques, x = drive.loop(torque)
    largest = float(np.max(np.abs(x)))
    lossy = abs(area(x, torques)) > LOSSLESS * 4.0 * torque * largest
    limits = (YIELDS * largest).tolist() if lossy else []
    sliders: tuple[tuple[float, float], ...] = ()
    if lossy:
        each = [slider(x, y) for y in limits]
        found = nnls(np.stack([opening(x, force) for force in each], axis=1), opening(x, torques))[0]
        sliders = tuple((k, y) for k, y in zip(found.tolist(), limits, strict=True) if k > 0.0)
    rest = torques - sum((k * slider(x, y) for k, y in sliders), np.zeros_like(x))
    scaled = x / largest
    linear, cubic = (nnls(np.stack([scaled, scaled**3], axis=1), rest)[0] / largest).tolist()
    return FittedTendons(linear, cubic / largest**2, sliders, torque)


def opening(wind_up: Array, force: Array) -> Array:
    """Half the distance (n) of the branches of a loop after its ramp, at wind-ups between its ends."""
    back, forth = slice(RAMP, RAMP + LOOP // 2 + 1), slice(RAMP + LOOP // 2, None)
    at = np.linspace(wind_up[back].min(), wind_up[back].max(), RAMP)
    down = np.interp(at, wind_up[back][::-1], force[back][::-1])
    return np.asarray(0.5 * (down - np.interp(at, wind_up[forth], force[forth])))
