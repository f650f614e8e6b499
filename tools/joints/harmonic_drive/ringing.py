"""A link on the drive, motor held: it rings about the wind-up that a torque makes."""

from collections.abc import Mapping
from pathlib import Path

from scipy.optimize import brentq

from ...systems.master import Slave
from ...systems.ringing import Axis, Body, Pull, Rest

LOADING = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Torques over the rated torque [1]."""
_FMU = "HarmonicDriveSpring"


def _torques(folder: Path, parameters: Mapping[str, float]) -> list[float]:
    """From zero to the drive's rated torque [N.m]."""
    with Slave(folder / f"{_FMU}.fmu", parameters, (), ("rated_torque",)) as drive:
        (rated,) = drive.get()
    return [share * rated for share in LOADING]


def _rest(folder: Path, torque: float, parameters: Mapping[str, float]) -> Rest:
    path = folder / f"{_FMU}.fmu"
    with Slave(path, {**parameters, "w2": 1.0}, ("w1",), ("tau",)) as dashpot:
        (damping,) = dashpot.get()
    with Slave(path, parameters, ("phi2", "w2"), ("tau", "K_WTS")) as law:
        angle, stiffness = _wound_up(law, torque)
    return Rest(torque, angle, stiffness, damping)


def _wound_up(drive: Slave, torque: float) -> tuple[float, float]:
    """Wind-up [rad] and stiffness [N.m/rad] of a drive under a torque [N.m], which grows with the wind-up."""

    def missing(angle: float) -> float:
        drive.set(angle, 0.0)
        return float(drive.get()[0] - torque)

    drive.set(0.0, 0.0)
    end = torque / drive.get()[1]
    while missing(end) * torque < 0.0:
        end *= 2.0
    angle = brentq(missing, 0.0, end, xtol=1e-12 * abs(end), rtol=1e-13) if torque else 0.0
    drive.set(angle, 0.0)
    return angle, drive.get()[1]


RINGING = Body(
    fmu=_FMU,
    motion=("phi2", "w2"),
    force="tau2",
    partner="RotationalInertia",
    over="tau",
    loads=_torques,
    start=lambda torque: {},
    rest=_rest,
    release=1e-3,
    load=Axis("torque", "N m", 1.0),
    deflection=Axis("wind-up", "urad", 1e6),
    doc="motor held",
    stiffness="K_WTS",
    pull=Pull(0.0, 5e-4, "three lengths of its hysteresis"),
    elastic={"hysteresis_loss": 0.0},
)
