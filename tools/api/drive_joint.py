"""Harmonic drive of the public interface, with torque over wind-up."""

import warnings

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.joints.model import EXTRAPOLATION_WARNING
from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from .joint import Joint


class DriveJoint(Joint):
    """Harmonic drive of the public interface: a joint with its torque-wind-up curve.

    `wind_up`, `torque` and `stiffness` describe the midline: the curve without hysteresis, with the wave
    generator locked. Above max_torque the midline continues with its last tangent. The three methods then
    warn; results of `evaluate` and `follow` have the warning in `messages`.

    >>> import jointfmu
    >>> drive = jointfmu.drive("CSG-25-100")
    >>> float(drive.torque(drive.wind_up(48.0))).__round__(9)
    48.0
    """

    def wind_up(self, torque: ArrayLike) -> Array:
        """Wind-up (n) [rad] of the output under torques (n) [N.m], on the midline; odd in the torque."""
        self._warn_beyond_table("torque", torque, self._midline_curve.load[-1], "N.m")
        return self._midline_curve.odd_inverse(torque)[()]

    def torque(self, wind_up: ArrayLike) -> Array:
        """Torque (n) [N.m] on the midline at wind-ups (n) [rad]; odd in the wind-up."""
        phi = np.asarray(wind_up, dtype=np.float64)
        self._warn_beyond_table("wind-up", phi, self._midline_curve.displacement[-1], "rad")
        return np.asarray(np.copysign(self._midline_curve.derivatives(np.abs(phi), 1)[0], phi))[()]

    def stiffness(self, torque: ArrayLike) -> Array:
        """Tangent stiffness K_WTS (n) [N.m/rad] of the midline under torques (n) [N.m]."""
        return np.asarray(self._midline_curve.derivatives(np.abs(self.wind_up(torque)), 1)[1])[()]

    def _warn_beyond_table(
        self, input_name: str, input_values: ArrayLike, table_end_value: float, input_unit: str
    ) -> None:
        """Warn, as the FMU does, if a torque or wind-up is beyond the end of the midline's table."""
        largest = float(np.max(np.abs(np.asarray(input_values, dtype=np.float64)), initial=0.0))
        if largest > table_end_value:
            allowed = f"[-{table_end_value:.6g}, {table_end_value:.6g}] {input_unit}"
            text = f"{input_name} = {largest:.6g} {input_unit} is outside {allowed}"
            warnings.warn(f"{self.name}: {text}: {EXTRAPOLATION_WARNING}", stacklevel=3)

    @property
    def _midline_curve(self) -> Curve:
        """Torque [N.m] as a function of wind-up [rad], both positive, without hysteresis: a table."""
        curve = self.spring.curve
        assert isinstance(curve, Curve)
        return curve
