"""Synthetic torque-angle loops and preload series with seeded noise, and their fits."""

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from jointfmu_tools.joints.bolted_joint.fit import preload
from jointfmu_tools.joints.harmonic_drive.fit import torque_angle

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

from .joint_measurements import save

DRIVE = {"K_FTS0": 18000.0, "drive_scale": 4.4, "zero_torque_pressure": 52e6}
START = load_default("bolted_joint")
JOINT = {"surface.D": 1.38, "surface.G": 2.5e-8, "mass": 250.0}
ARCMIN = np.pi / 10800.0


def loops(rng, values=DRIVE, amplitude=25.0, noise=0.03 * ARCMIN, gap=1.0 * ARCMIN, drift=0.3 * ARCMIN):
    """Torque [N.m] and angle [rad] of two loops 0, A, -A, A, -A, A of the drive, with an offset of 5 arcmin.

    gap : hysteresis_loss [rad]; the torque has 0.5 mN.m of noise
    """
    torque, angle = loops_without_noise(tuple((values | {"hysteresis_loss": gap}).items()), amplitude)
    angle = angle + 5.0 * ARCMIN + drift * np.linspace(-0.5, 0.5, torque.size)
    angle += noise * rng.standard_normal(torque.size)
    return torque + 5e-4 * rng.standard_normal(torque.size), angle


@cache
def loops_without_noise(values, amplitude):
    """Torque and angle of the loops; values: ((name, value), ...)."""
    ends = amplitude * np.array([0.0, 1.0, -1.0, 1.0, -1.0, 1.0])
    torque = np.concatenate([np.linspace(a, b, 200, endpoint=False) for a, b in pairwise(ends)])
    spring = HarmonicDriveSpring.tabulate(
        load_default("harmonic_drive").with_values(dict(values), "user", "synthetic").values
    )
    angle, memory = np.empty(torque.size), spring.initial_history()
    for i, T in enumerate(torque):
        state, memory = spring.advance_torque(T, memory)
        angle[i] = state["phi_rel"]
    return torque, angle


def preload_series(rng, quantity, noise, series=np.inf, points=20):
    """Preload [N] and stiffness [N/m] or frequency [Hz] with a relative noise."""
    P = np.geomspace(2e3, 30e3, points)
    joint = START.with_values(JOINT, "user", "synthetic").values
    K = 1.0 / (1.0 / preload.compute_joint_stiffness(joint, P) + 1.0 / series)
    value = K if quantity == "stiffness" else np.sqrt(K / joint.mass) / (2.0 * np.pi)
    return P, value * np.exp(noise * rng.standard_normal(points))


def torque_angle_fit(rng, path):
    """Fit loops of a drive."""
    torque, angle = loops(rng)
    save(path, "torque [N.m], angle [arcmin]", torque, angle / ARCMIN)
    return torque_angle.fit(path), DRIVE


def stiffness_fit(rng, path):
    """Fit the stiffness over the preload, 2 % of noise."""
    save(path, "preload [N], stiffness [N/m]", *preload_series(rng, "stiffness", 0.02))
    return preload.fit(path, START), JOINT


def frequency_fit(rng, path):
    """Fit the frequency over the preload with a stated modal mass, 0.5 % of noise."""
    save(path, "preload [N], frequency [Hz]", *preload_series(rng, "frequency", 0.005))
    return preload.fit(path, START, modal_mass=JOINT["mass"]), JOINT


def series_fit(rng, path):
    """Fit the frequency over the preload and a series stiffness of the structure, 0.2 % of noise."""
    save(path, "preload [N], frequency [Hz]", *preload_series(rng, "frequency", 0.002, series=3e10))
    free = ["surface.D", "surface.G", preload.SERIES_STIFFNESS_NAME]
    return preload.fit(path, START, fitted_names=free, modal_mass=JOINT["mass"]), JOINT | {
        preload.SERIES_STIFFNESS_NAME: 3e10
    }


CASES = {
    "torque-angle loops": torque_angle_fit,
    "stiffness over preload": stiffness_fit,
    "frequency over preload": frequency_fit,
    "frequency with a series stiffness": series_fit,
}


def errors(case, seed, folder):
    """Errors of a fit with one seed: {parameter: (relative error, error in standard deviations)}."""
    outcome, true = case(np.random.default_rng(seed), Path(folder) / "measured.csv")
    found, deviations = outcome.solution.values, outcome.solution.relative_deviations
    logs = {name: float(np.log(found[name] / true[name])) for name in found}
    return {name: (error, error / deviations[name]) for name, error in logs.items()}
