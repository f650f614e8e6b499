"""Pictures of laws beside a catalogue's row: the angle, and the stiffness with the steps of the catalogue."""

from collections.abc import Mapping

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.spring import torque_curve

from ....fitting.least_squares import Array
from ....fitting.outcome import Picture
from . import drive as own
from .row import Row

ARCMIN = np.pi / 10800.0
_GRID = 400


def stiffness(drive: Drive, torque: Array) -> Array:
    """K_WTS (...) [N.m/rad] of the exported midline at torques (...) >= 0 [N.m]."""
    curve = torque_curve(drive)
    return curve.derivatives(curve.inverse(torque), 1)[1]


def angle_picture(row: Row, law: Drive, also: Mapping[str, Drive], torque: Array) -> Picture:
    """Wind-up at torques (n) [N.m], misfits of the law; `also` are further laws by name."""
    grid, target = np.linspace(0.0, torque[-1], _GRID), row.angle(torque)
    return Picture(
        x=torque,
        y=target / ARCMIN,
        misfit=100.0 * (target / own.windup(law, torque) - 1.0),
        line=(grid, own.windup(law, grid) / ARCMIN),
        labels=("torque [N.m]", "wind-up [arcmin]", "catalogue / law - 1 [%]"),
        marks=np.isin(torque, row.kept),
        also={name: (grid, own.windup(other, grid) / ARCMIN) for name, other in also.items()},
    )


def stiffness_picture(row: Row, law: Drive, also: Mapping[str, Drive], most: float) -> Picture:
    """Stiffness up to a torque [N.m] beside the steps of the catalogue, the corners left out."""
    grid = np.linspace(0.0, most, _GRID)
    torque = grid[1::2][~np.isin(grid[1::2], (row.T1, row.T2))]
    steps = row.stiffness(torque)
    return Picture(
        x=torque,
        y=steps / 1e3,
        misfit=100.0 * (steps / stiffness(law, torque) - 1.0),
        line=(grid, stiffness(law, grid) / 1e3),
        labels=("torque [N.m]", "stiffness [kN.m/rad]", "catalogue / law - 1 [%]"),
        also={name: (grid, stiffness(other, grid) / 1e3) for name, other in also.items()},
    )
