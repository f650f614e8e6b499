"""Harmonic drive of the public interface, with torque over wind-up."""

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from .joint import Joint


class DriveJoint(Joint):
    """Harmonic drive.

    `wind_up`, `torque` and `stiffness` describe the midline, without hysteresis and with the wave generator
    locked. Above max_torque the midline continues with its last tangent; then `messages` of `evaluate` and
    `follow` have a warning.

    >>> import jointfmu
    >>> drive = jointfmu.drive("CSG-25-100")
    >>> float(drive.torque(drive.wind_up(48.0))).__round__(9)
    48.0
    """

    def wind_up(self, torque: ArrayLike) -> Array:
        """Wind-up (n) [rad] of the output under torques (n) [N.m]; odd in the torque."""
        return self._midline_curve.odd_inverse(torque)[()]

    def torque(self, wind_up: ArrayLike) -> Array:
        """Torque (n) [N.m] at wind-ups (n) [rad]; odd in the wind-up."""
        phi = np.asarray(wind_up, dtype=np.float64)
        return np.asarray(np.copysign(self._midline_curve.derivatives(np.abs(phi), 1)[0], phi))[()]

    def stiffness(self, torque: ArrayLike) -> Array:
        """Tangent stiffness K_WTS (n) [N.m/rad] under torques (n) [N.m]."""
        return np.asarray(self._midline_curve.derivatives(np.abs(self.wind_up(torque)), 1)[1])[()]

    @property
    def _midline_curve(self) -> Curve:
        """Midline of the hysteresis loop: torque [N.m] over wind-up [rad], both positive."""
        curve = self.spring.curve
        assert isinstance(curve, Curve)
        return curve
