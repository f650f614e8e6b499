"""A drive's torque as a sum of what MuJoCo has: k x + k3 x^3 and springs that yield, by least squares."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from .transmission import Transmission, area

Array = NDArray[np.float64]

YIELDS = np.geomspace(0.01, 0.4, 12)
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


def slider(wind_up: Array, limit: float) -> Array:
    """Force (n) of a spring of stiffness 1 that yields at a limit, along wind-ups (n) from rest."""
    force, before, forces = 0.0, 0.0, []
    for x in wind_up.tolist():
        force = min(max(force + x - before, -limit), limit)
        forces.append(force)
        before = x
    return np.array(forces)


def fit(drive: Transmission, torque: float) -> FittedTendons:
    """The least squares of the torque along a ramp to a torque [N.m] and a loop from there, none negative."""
    torques, x = drive.loop(torque)
    largest = float(np.max(np.abs(x)))
    lossy = abs(area(x, torques)) > LOSSLESS * 4.0 * torque * largest
    limits = (YIELDS * largest).tolist() if lossy else []
    scaled = x / largest
    columns = np.stack([scaled, scaled**3, *(slider(x, y) / largest for y in limits)], axis=1)
    found = nnls(columns, torques)[0] / largest
    sliders = tuple((k, y) for k, y in zip(found[2:].tolist(), limits, strict=True) if k > 0.0)
    return FittedTendons(float(found[0]), float(found[1]) / largest**2, sliders, torque)
