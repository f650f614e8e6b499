r"""Lost motion of a harmonic drive: the play that the output runs through at next to no torque.

The teeth never let go, so play is soft, not empty: beside the wind-up of the law

    phi_p(T) = lost_motion/2 tanh(T/T_p),   T_p = WIDTH rated_torque,

smooth, odd and in series, so that the torque over the wind-up stays a curve with one stiffness everywhere.
Catalogues state as lost motion the angle between +4 % and -4 % of rated torque, midway between the branches
of the loop through rated torque. Of that, 2 phi(0.04 rated_torque) is the wind-up of the law; `lost_motion`
is what is left.
"""

import numpy as np

from ...quantity import Number
from .drive import Drive
from .law import PairDrive, drive_stiffness

WIDTH = 0.01
"""Torque over rated torque [1] in which the play is run through: at 4 % all but 0.07 % of it is."""


def play(drive: Drive, torque: Number) -> tuple[Number, Number, Number]:
    """phi_p (...) [rad] at torques (...) [N.m], and its derivatives [rad/(N.m)], [rad/(N.m)2]."""
    width, half = WIDTH * drive.rated_torque, 0.5 * drive.lost_motion
    part = np.tanh(torque / width)
    slope = half * (1.0 - part * part) / width
    return half * part, slope, -2.0 * part * slope / width


def stiffness_with_play(drive: PairDrive, torque: Number) -> tuple[Number, Number]:
    """K_WTS (...) [N.m/rad] of law and play in series, and dK_WTS/dT [1/rad]."""
    K, growth = drive_stiffness(drive, torque)
    _, compliance, change = play(drive, torque)
    softer = 1.0 + K * compliance
    return K / softer, (growth - K * K * change) / softer**2
