"""The load of a harmonic drive: its curve for other solvers, how the torque presses on its contact pair."""

from typing import TYPE_CHECKING

from jointfmu.contact.interface import at_pressure
from jointfmu.joints.harmonic_drive import KIND
from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.law import (
    HarmonicDrive,
    RoughHarmonicDrive,
    pair_stiffness,
    peak_pressure,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

from ...export.exports import Exports, LoadCurve
from ...pressure import NominalPressure

if TYPE_CHECKING:
    from ...export.tables import LoadTable


def _torque(drive: Drive, _: None, error: float) -> "LoadTable":
    from ...export.tables import odd_table

    return odd_table(HarmonicDriveSpring.of(drive).curve, error)


EXPORTS = Exports(
    curve=LoadCurve(
        meaning="torque over wind-up at the output, wave generator locked",
        columns=tuple(KIND.variables[name] for name in ("phi_rel", "tau", "K_WTS")),
        name="torque",
        table=_torque,
    ),
    lacks={"contact": "its stiffness is a sum over the nodes of a mesh, not over an area; export its curve"},
)


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
