"""What a joint's part `transmission` says: TRANSMISSION, its parameters -> a drive between motor and link."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..joint_parts import part

RAMP, LOOP = 200, 800
"""Points of the ramp to the largest torque, and of the loop after it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Transmission:
    """A drive between a motor and a link.

    name          : of its parameters
    ratio         : [1] speed of the motor over that of the link, negative where they turn against each other
    damping       : [N.m.s/rad] at the output
    rated_torque  : [N.m] at the output
    max_torque    : [N.m] at the output, to which the law is tabulated
    dry, viscous  : friction of the motor [N.m], [N.m.s/rad]
    static        : dry friction of the motor at rest [N.m], dry if speed takes nothing away
    stribeck_speed, presliding : speed [rad/s] that leaves 1/e of what static is above dry, and angle [rad]
                    of the motor over which dry friction builds up to 1 - 1/e
    wind_up       : torques (n) [N.m] one after the other, from rest -> wind-ups (n) [rad], motor locked
    lacks         : what of it is beyond springs, sliders and friction, in words with numbers
    """

    name: str
    ratio: float
    damping: float
    rated_torque: float
    max_torque: float
    dry: float
    viscous: float
    static: float
    stribeck_speed: float
    presliding: float
    wind_up: Callable[[ArrayLike], Array]
    lacks: Sequence[str] = ()

    def loop(self, torque: float) -> tuple[Array, Array]:
        """Torques [N.m] and wind-ups [rad] (n) from rest to a torque and once round from there."""
        up = np.linspace(0.0, torque, RAMP + 1)
        turn = np.cos(np.linspace(0.0, 2.0 * np.pi, LOOP + 1)[1:]) * torque
        torques = np.concatenate([up, turn])
        return torques, self.wind_up(torques)


def area(wind_up: Array, torque: Array) -> float:
    """Work [J] of the loop after the ramp."""
    return float(np.trapezoid(torque[RAMP:], wind_up[RAMP:]))


def transmission(file: ParameterFile) -> Transmission:
    """The drive of a parameter file. ValueError for a joint that is none."""
    own = part(KINDS[file.joint], "transmission")
    if own is None:
        able = [name for name, kind in KINDS.items() if part(kind, "transmission")]
        raise ValueError(
            f"{file.name} is a {file.joint}, no drive of a motor; allowed is a {', '.join(able)}"
        )
    made: Transmission = own.TRANSMISSION(file.name, file.values)
    return made
