"""What a nonlinear joint does in a system, by running FMUs: resonance over the load, and free decay."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jointfmu.progress import track

from .master import Array, Slave, damping_ratio, motion, peak
from .systems import system

PER_PERIOD, PERIODS = 100, 25
RESONANCE_TOLERANCE = 5e-3
"""Peak of the spectrum against sqrt(K/J) [1]."""
DAMPING_TOLERANCE = 1e-2
"""Decrement of the free decay against the stated damping [1]."""
LOADING = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Torques over the rated torque [1]."""
MOST_DAMPED = 0.1
"""Damping ratio [1] up to which there are enough periods to find frequency and decrement."""
PRELOADS = (3e3, 9e3, 15e3, 30e3)
_LEAST_DAMPED = 1e-6
"""Damping ratio [1] below which the decrement, found to 2e-9, is not compared."""
_RELEASE = 1e-3
"""First deflection from the working point, of the one that a load of 1 N m or 1 kN makes."""


@dataclass(frozen=True, slots=True)
class Ringing:
    """Free motion at one working point.

    load            : torque offset [N.m] or preload [N]
    frequency       : peak of the simulated signal's spectrum [rad/s]
    expected        : sqrt(K/J) with the joint's stiffness there [rad/s]
    damping, stated : ratios [1], of the decay and of the joint's own damping
    time, signal    : deflection from the working point [rad or m]
    messages        : what the FMUs logged
    """

    load: float
    frequency: float
    expected: float
    damping: float
    stated: float
    time: Array
    signal: Array
    messages: tuple[str, ...]

    @property
    def misses(self) -> list[str]:
        """What lies outside the tolerances, one line each."""
        pairs = [("frequency", self.frequency, self.expected, RESONANCE_TOLERANCE)]
        if self.stated > _LEAST_DAMPED:
            pairs.append(("damping", self.damping, self.stated, DAMPING_TOLERANCE))
        return [
            f"load = {self.load:g}: {name} {found:.6g}, expected {expected:.6g} within {allowed:g}"
            for name, found, expected, allowed in pairs
            if not abs(found - expected) <= allowed * expected
        ]


class Point(NamedTuple):
    """A working point: its load, the constant force or torque there, the position of rest, and the joint's
    stiffness and damping with the inertia on it (SI units)."""

    load: float
    force: float
    rest: float
    inertia: float
    stiffness: float
    damping: float


def examples(folder: Path) -> dict[str, list[Ringing]]:
    """Both example systems over their loads; `folder` has the FMUs (FMI 2.0)."""
    return {"robot_joint": robot_joint(folder), "bolted_column": bolted_column(folder)}


def robot_joint(
    folder: Path, torques: Sequence[float] | None = None, inertia: float | None = None
) -> list[Ringing]:
    """The link of the robot joint, motor held, about working points under a torque.

    folder  : of the FMUs (FMI 2.0) HarmonicDriveSpring and RotationalInertia
    torques : [N.m]; None: six from zero to the drive's rated torque
    inertia : [kg.m2] of the link; None: that of the example system

    Raises ValueError for an FMU that is missing or refuses, and where nothing rings.
    """
    body_inertia = system("robot_joint").values["link.J"] if inertia is None else inertia
    path = folder / "HarmonicDriveSpring.fmu"
    if torques is None:
        with Slave(path, {}, (), ("rated_torque",)) as drive:
            torques = [share * drive.get()[0] for share in LOADING]
    found = []
    for torque in track(torques, "ring", len(torques)):
        with Slave(path, {"w2": 1.0}, ("w1",), ("tau",)) as dashpot:
            (damping,) = dashpot.get()
        with Slave(path, {}, ("phi2", "w2"), ("tau", "K_WTS")) as law:
            angle, stiffness = _wound_up(law, torque)
        start = {"J": body_inertia, "phi": angle + _RELEASE / stiffness}
        with (
            Slave(path, {}, ("phi2", "w2"), ("tau2",)) as joint,
            Slave(folder / "RotationalInertia.fmu", start, ("tau_a", "tau_b"), ("phi", "w")) as body,
        ):
            point = Point(torque, torque, angle, body_inertia, stiffness, damping)
            found.append(_ring(joint, body, point))
    return found


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


def bolted_column(
    folder: Path, preloads: Sequence[float] | None = None, mass: float | None = None
) -> list[Ringing]:
    """The column on its joint over the preload.

    folder   : of the FMUs (FMI 2.0) BoltedJoint and TranslationalMass
    preloads : [N] per bolt; None: PRELOADS
    mass     : [kg] of the column; None: that of the example system

    Raises ValueError for an FMU that is missing or refuses, and where nothing rings.
    """
    body_mass = system("bolted_column").values["column.m"] if mass is None else mass
    path, found = folder / "BoltedJoint.fmu", []
    for preload in track(PRELOADS if preloads is None else preloads, "ring"):
        with Slave(path, {"preload": preload}, (), ("K_zz", "C_zz")) as law:
            stiffness, damping = law.get()
        if stiffness <= 0.0:
            raise ValueError(
                f"load = {preload:g} N: the joint has no stiffness there; allowed are preloads > 0"
            )
        start = {"m": body_mass, "s": 1e3 * _RELEASE / stiffness}
        with (
            Slave(path, {"preload": preload}, ("s_rel_z", "v_rel_z"), ("f_z",)) as joint,
            Slave(folder / "TranslationalMass.fmu", start, ("f_a", "f_b"), ("s", "v")) as body,
        ):
            found.append(_ring(joint, body, Point(preload, 0.0, 0.0, body_mass, stiffness, damping)))
    return found


def _ring(joint: Slave, body: Slave, at: Point) -> Ringing:
    expected = float(np.sqrt(at.stiffness / at.inertia))
    stated = at.damping / (2.0 * at.inertia * expected)
    if not stated < MOST_DAMPED:
        raise ValueError(
            f"load = {at.load:g}: damping ratio {stated:.3g} with the inertia {at.inertia:g}; allowed is "
            f"less than {MOST_DAMPED:g}, so that there are periods to count: take a larger inertia"
        )
    step = 2.0 * np.pi / (expected * PER_PERIOD)
    signal = motion(joint, body, at.force, step, PERIODS * PER_PERIOD)[:, 0] - at.rest
    time = np.asarray(step * np.arange(signal.size), dtype=np.float64)
    messages = tuple(dict.fromkeys(joint.messages + body.messages))
    return Ringing(
        at.load, peak(signal, step), expected, damping_ratio(signal), stated, time, signal, messages
    )
