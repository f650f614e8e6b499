"""What a nonlinear joint does in a system, by running FMUs: resonance over the load, and free decay."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .master import Array, Slave, damping_ratio, motion, peak
from .systems import system

PER_PERIOD, PERIODS = 100, 25
RESONANCE_TOLERANCE = 5e-3
"""Peak of the spectrum against sqrt(K/J) [1]."""
DAMPING_TOLERANCE = 1e-2
"""Decrement of the free decay against the stated damping [1]."""
TORQUES = (0.0, 0.5, 1.0, 2.0, 3.5, 5.0)
PRELOADS = (3e3, 9e3, 15e3, 30e3)
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
    """

    load: float
    frequency: float
    expected: float
    damping: float
    stated: float
    time: Array
    signal: Array


def examples(folder: Path) -> dict[str, list[Ringing]]:
    """Both example systems over their loads; `folder` has the FMUs (FMI 2.0)."""
    return {"robot_joint": robot_joint(folder), "bolted_column": bolted_column(folder)}


def robot_joint(folder: Path, torques: Sequence[float] = TORQUES) -> list[Ringing]:
    """The link of the robot joint, motor held, about working points under a torque; `folder` has the FMUs."""
    inertia = system("robot_joint").values["link.J"]
    found = []
    for torque in torques:
        with Slave(folder / "HarmonicDriveCompliance.fmu", {"tau": torque}, (), ("phi_rel", "K_WTS")) as law:
            angle, stiffness = law.get()
        release = angle + _RELEASE / stiffness
        with (
            Slave(folder / "HarmonicDriveSpring.fmu", {}, ("phi2", "w2"), ("tau2",)) as joint,
            Slave(folder / "HarmonicDriveSpring.fmu", {"w2": 1.0}, ("w1",), ("tau",)) as dashpot,
            Slave(
                folder / "RotationalInertia.fmu",
                {"J": inertia, "phi": release},
                ("tau_a", "tau_b"),
                ("phi", "w"),
            ) as body,
        ):
            (damping,) = dashpot.get()
            found.append(_ring(joint, body, torque, torque, angle, inertia, stiffness, damping))
    return found


def bolted_column(folder: Path, preloads: Sequence[float] = PRELOADS) -> list[Ringing]:
    """The column on its joint over the preload; `folder` has the FMUs."""
    mass = system("bolted_column").values["column.m"]
    found = []
    for preload in preloads:
        outputs, wires = ("K_zz", "C_zz"), ("s_rel_z", "v_rel_z")
        with Slave(folder / "BoltedJoint.fmu", {"preload": preload}, (), outputs) as law:
            stiffness, damping = law.get()
        start = {"m": mass, "s": 1e3 * _RELEASE / stiffness}
        with (
            Slave(folder / "BoltedJoint.fmu", {"preload": preload}, wires, ("f_z",)) as joint,
            Slave(folder / "TranslationalMass.fmu", start, ("f_a", "f_b"), ("s", "v")) as body,
        ):
            found.append(_ring(joint, body, preload, 0.0, 0.0, mass, stiffness, damping))
    return found


def _ring(
    joint: Slave,
    body: Slave,
    load: float,
    force: float,
    rest: float,
    inertia: float,
    stiffness: float,
    damping: float,
) -> Ringing:
    expected = float(np.sqrt(stiffness / inertia))
    step = 2.0 * np.pi / (expected * PER_PERIOD)
    signal = motion(joint, body, force, step, PERIODS * PER_PERIOD)[:, 0] - rest
    return Ringing(
        load,
        peak(signal, step),
        expected,
        damping_ratio(signal),
        damping / (2.0 * inertia * expected),
        np.asarray(step * np.arange(signal.size), dtype=np.float64),
        signal,
    )
