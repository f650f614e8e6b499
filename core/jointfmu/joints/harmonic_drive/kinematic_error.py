r"""Kinematic error of a harmonic drive: the output runs ahead and behind as the wave generator turns.

    phi_error = sum of error_n sin(n phi1 + error_n_phase),   n = HARMONICS

phi1 counts from the housing, which holds the circular spline: each of the wave generator's two lobes passes
every tooth once per turn, so what the teeth do to the motion comes twice. The wind-up is what is left of the
motion, phi_rel = phi2 - phi1/ratio - phi_error, and by virtual work the torque of the spring on the wave
generator is tau (1/ratio + dphi_error/dphi1).
"""

import numpy as np

from ...quantity import Number
from .drive import Drive

HARMONICS = (1, 2, 4)
"""Periods per turn of the wave generator."""


def amplitudes(drive: Drive) -> list[Number]:
    """[rad] of the harmonics; all zero without kinematic error."""
    return [getattr(drive, f"error_{n}") for n in HARMONICS]


def kinematic_error(drive: Drive, phi1: Number) -> tuple[Number, Number, Number]:
    """phi_error (...) [rad] at angles (...) [rad] of the wave generator, and its derivatives [1], [1/rad]."""
    error = slope = bend = 0.0
    for n, amplitude in zip(HARMONICS, amplitudes(drive), strict=True):
        angle = n * phi1 + getattr(drive, f"error_{n}_phase")
        wave, rise = amplitude * np.sin(angle), n * amplitude * np.cos(angle)
        error, slope, bend = error + wave, slope + rise, bend - n * n * wave
    return error, slope, bend
