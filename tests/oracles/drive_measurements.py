"""Synthetic loops and decays of a harmonic drive with hysteresis, with seeded noise, and their fits."""

from functools import cache

import numpy as np
from jointfmu_tools.joints.harmonic_drive.fit import hysteresis

from .joint_measurements import DECAY_NOISE, decay, file, loops, save

ARCMIN = np.pi / 10800.0
INERTIA = 0.2
DRIVE = {"hysteresis_loss": 1.2 * ARCMIN, "hysteresis_stiffness": 6000.0}
TURNS = (0.5 * ARCMIN, 2.0 * ARCMIN, 6.0 * ARCMIN)


@cache
def drive_law():
    """Hysteresis law of the drive with the true parameters."""
    return hysteresis.make_hysteresis_law(file("harmonic_drive", DRIVE).values)


@cache
def drive_decay():
    """Decay of an inertia on the drive with the true parameters."""
    return decay(drive_law(), INERTIA, 0.3 * ARCMIN)


def drive_loops_fit(rng, path):
    """Fit loops of a harmonic drive with three amplitudes."""
    run, motion, torque = loops(drive_law(), TURNS, rng)
    save(path, "run [1], angle [arcmin], torque [N.m]", run, motion / ARCMIN, torque)
    return hysteresis.fit(path), DRIVE


def drive_decay_fit(rng, path):
    """Fit the decay of an inertia on a harmonic drive with viscous damping."""
    time, motion = drive_decay()
    motion = motion + DECAY_NOISE * motion[0] * rng.standard_normal(motion.size)
    save(path, "time [s], angle [arcmin]", time, motion / ARCMIN)
    return hysteresis.fit(path, inertia=INERTIA), DRIVE


CASES = {
    "loops of a drive": drive_loops_fit,
    "decay on a drive": drive_decay_fit,
}
