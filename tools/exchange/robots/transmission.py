"""Data of a drive between motor and link, for robot models (transmission)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.quantity import Array

RAMP_POINT_COUNT = 200
"""Number of points of the ramp to the largest torque [1]."""
LOOP_POINT_COUNT = 800
"""Number of points of the hysteresis loop after the ramp [1]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Transmission:
    """Drive between a motor and a link of a robot: numbers and wind-up that models of the robot need.

    drive_name       : name of the parameter file
    ratio            : motor speed over link speed [1], negative for opposite directions
    output_damping   : viscous damping at the output [N.m.s/rad]
    rated_torque     : rated torque at the output [N.m]
    max_torque       : largest tabulated torque at the output [N.m]
    dry_friction     : Coulomb friction of the motor [N.m]
    viscous_friction : viscous friction of the motor [N.m.s/rad]
    static_friction  : static friction of the motor [N.m]; without Stribeck effect equal to dry_friction
    stribeck_speed   : motor speed [rad/s] at which static minus dry friction has decreased to 1/e
    presliding_angle : motor angle [rad] at which dry friction reaches 1 - 1/e of its limit
    compute_wind_up  : (history of torques (n) [N.m] from rest) -> wind-ups (n) [rad] with locked motor
    omitted_effects  : texts on effects of the drive other than springs, sliders and friction
    """

    drive_name: str
    ratio: float
    output_damping: float
    rated_torque: float
    max_torque: float
    dry_friction: float
    viscous_friction: float
    static_friction: float
    stribeck_speed: float
    presliding_angle: float
    compute_wind_up: Callable[[ArrayLike], Array]
    omitted_effects: Sequence[str] = ()

    def compute_loop(self, loop_torque: float) -> tuple[Array, Array]:
        """Torques (n) [N.m] and wind-ups (n) [rad] along a ramp from rest to `loop_torque` and one loop."""
        ramp = np.linspace(0.0, loop_torque, RAMP_POINT_COUNT + 1)
        cycle = np.cos(np.linspace(0.0, 2.0 * np.pi, LOOP_POINT_COUNT + 1)[1:]) * loop_torque
        torques = np.concatenate([ramp, cycle])
        return torques, self.compute_wind_up(torques)


def loop_area(wind_up: Array, loop_torque: Array) -> float:
    """Area [J] of the loop after the ramp: the energy dissipated in one cycle."""
    return float(np.trapezoid(loop_torque[RAMP_POINT_COUNT:], wind_up[RAMP_POINT_COUNT:]))
