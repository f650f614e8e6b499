"""The harmonic drive as an object: wind-up over torque and back."""

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from ...interface.joint import Joint


class DriveJoint(Joint):
    """A harmonic drive. `wind_up`, `torque` and `stiffness` are those of the midline, wave generator locked.

    >>> import jointfmu
    >>> drive = jointfmu.drive("CSG-25-100")
    >>> float(drive.torque(drive.wind_up(48.0))).__round__(9)
    48.0
    """

    def wind_up(self, torque: ArrayLike) -> Array:
        """Wind-up (n) [rad] of the output under torques (n) [N.m], odd."""
        return self._curve.odd_inverse(torque)[()]

    def torque(self, wind_up: ArrayLike) -> Array:
        """Torque (n) [N.m] at wind-ups (n) [rad], odd."""
        phi = np.asarray(wind_up, dtype=np.float64)
        return np.asarray(np.copysign(self._curve.derivatives(np.abs(phi), 1)[0], phi))[()]

    def stiffness(self, torque: ArrayLike) -> Array:
        """Tangent stiffness K_WTS (n) [N.m/rad] under torques (n) [N.m]."""
        return np.asarray(self._curve.derivatives(np.abs(self.wind_up(torque)), 1)[1])[()]

    @property
    def _curve(self) -> Curve:
        """Torque over wind-up, from zero on."""
        curve = self.spring.curve
        assert isinstance(curve, Curve)
        return curve


CLASS = DriveJoint
