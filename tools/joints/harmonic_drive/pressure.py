"""How the torque presses on the contact pair, and how the drive takes the stiffness of its law."""

from jointfmu.contact.interface import at_pressure
from jointfmu.joints.harmonic_drive.law import (
    HarmonicDrive,
    RoughHarmonicDrive,
    pair_stiffness,
    peak_pressure,
)

from ...pressure import NominalPressure

_Any = HarmonicDrive | RoughHarmonicDrive


def _peak(drive: _Any, torque: float) -> float:
    return float(peak_pressure(drive, torque)[0])


def _mean(drive: _Any, torque: float) -> float:
    return drive.mean_over_peak * _peak(drive, torque)


def _scale(drive: _Any, torque: float) -> float:
    """K_TS of the drive over the twist of a pair with the law's tangential stiffness, K_T radius^2."""
    tangential = at_pressure(drive.law, _mean(drive, torque))["K_T"]
    return float(pair_stiffness(drive, torque)[0] / (tangential * drive.radius**2))


PRESSURE = NominalPressure(
    load="tau", usual=lambda drive: drive.rated_torque, mean=_mean, peak=_peak, scale=_scale
)
