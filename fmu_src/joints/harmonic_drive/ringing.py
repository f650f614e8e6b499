"""A link on the drive, motor held: it rings about the wind-up that a torque makes."""

from pathlib import Path

from ...master import Slave
from ...ringing import Axis, Body, Rest

LOADING = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Torques over the rated torque [1]."""
_FMU = "HarmonicDriveSpring"


def _torques(folder: Path) -> list[float]:
    """From zero to the drive's rated torque [N.m]."""
    with Slave(folder / f"{_FMU}.fmu", {}, (), ("rated_torque",)) as drive:
        (rated,) = drive.get()
    return [share * rated for share in LOADING]


def _rest(folder: Path, torque: float) -> Rest:
    path = folder / f"{_FMU}.fmu"
    with Slave(path, {"w2": 1.0}, ("w1",), ("tau",)) as dashpot:
        (damping,) = dashpot.get()
    with Slave(path, {}, ("phi2", "w2"), ("tau", "K_WTS")) as law:
        angle, stiffness = _wound_up(law, torque)
    return Rest(torque, angle, stiffness, damping)


def _wound_up(drive: Slave, torque: float) -> tuple[float, float]:
    """Wind-up [rad] and stiffness [N.m/rad] of a drive under a torque [N.m], by Newton's method."""
    angle = 0.0
    for _ in range(60):
        drive.set(angle, 0.0)
        tau, stiffness = drive.get()
        if abs(tau - torque) <= 1e-12 * abs(torque):
            break
        angle += (torque - tau) / stiffness
    return angle, stiffness


RINGING = Body(
    fmu=_FMU,
    motion=("phi2", "w2"),
    force="tau2",
    partner="RotationalInertia",
    loads=_torques,
    start=lambda torque: {},
    rest=_rest,
    release=1e-3,
    load=Axis("torque", "N m", 1.0),
    deflection=Axis("wind-up", "urad", 1e6),
    doc="motor held",
    stiffness="K_WTS",
)
