"""How often a fit recovers the parameters of synthetic measurements within three standard deviations.

Each kind of measurement is made from known parameters with seeded noise, read back from a file and
fitted. Prints, for each kind, in how many of the seeds every fitted parameter lies within three of
its own standard deviations, and the middle relative error of each parameter.
"""

import tempfile
from functools import cache
from itertools import pairwise
from pathlib import Path

import drive_measurements
import memory_measurements
import numpy as np
from jointfmu_tools.joints.bolted_joint.fit import preload
from jointfmu_tools.joints.harmonic_drive.fit import torque_angle

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default
from jointfmu.progress import track_progress

SEEDS = 100
DRIVE = {"K_FTS0": 18000.0, "drive_scale": 4.4, "zero_torque_pressure": 52e6}
JOINT = {"surface.D": 1.38, "surface.G": 2.5e-8, "mass": 250.0}
ARCMIN = np.pi / 10800.0


def loops(rng, values=DRIVE, amplitude=25.0, noise=0.03 * ARCMIN, gap=1.0 * ARCMIN, drift=0.3 * ARCMIN):
    """Torque [N.m] and angle [rad] of two loops 0, A, -A, A, -A, A of the drive, with an offset of 5 arcmin.

    gap : hysteresis_loss [rad]; 0.5 mN.m of noise in T
    """
    torque, angle = moved(tuple((values | {"hysteresis_loss": gap}).items()), amplitude)
    angle = angle + 5.0 * ARCMIN + drift * np.linspace(-0.5, 0.5, torque.size)
    angle += noise * rng.standard_normal(torque.size)
    return torque + 5e-4 * rng.standard_normal(torque.size), angle


@cache
def moved(values, amplitude):
    """Torque and angle of these loops as they are, values: ((name, value), ...)."""
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


def preloads(rng, of, noise, series=np.inf, points=20):
    """Preload [N] and stiffness [N/m] or frequency [Hz] with a relative noise."""
    P = np.geomspace(2e3, 30e3, points)
    joint = load_default("bolted_joint").with_values(JOINT, "user", "synthetic").values
    K = 1.0 / (1.0 / preload.joint_stiffness(joint, P) + 1.0 / series)
    value = K if of == "stiffness" else np.sqrt(K / joint.mass) / (2.0 * np.pi)
    return P, value * np.exp(noise * rng.standard_normal(points))


def save(path, heading, *columns):
    """Write columns as a CSV file."""
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=heading, comments="")
    return path


def torque_angle_fit(rng, path):
    """Loops of a drive."""
    torque, angle = loops(rng)
    save(path, "torque [N.m], angle [arcmin]", torque, angle / ARCMIN)
    return torque_angle.fit(path), DRIVE


def stiffness_fit(rng, path):
    """Stiffness over preload, 2 % of noise."""
    save(path, "preload [N], stiffness [N/m]", *preloads(rng, "stiffness", 0.02))
    return preload.fit(path), JOINT


def frequency_fit(rng, path):
    """Frequency over preload with a stated modal mass, 0.5 % of noise."""
    save(path, "preload [N], frequency [Hz]", *preloads(rng, "frequency", 0.005))
    return preload.fit(path, modal_mass=JOINT["mass"]), JOINT


def series_fit(rng, path):
    """The same with the structure in series, to be found too; 0.2 % of noise."""
    save(path, "preload [N], frequency [Hz]", *preloads(rng, "frequency", 0.002, series=3e10))
    free = ["surface.D", "surface.G", preload.SERIES_STIFFNESS]
    return preload.fit(path, fitted_names=free, modal_mass=JOINT["mass"]), JOINT | {
        preload.SERIES_STIFFNESS: 3e10
    }


CASES = {
    "torque-angle loops": torque_angle_fit,
    "stiffness over preload": stiffness_fit,
    "frequency over preload": frequency_fit,
    "frequency with a series stiffness": series_fit,
}


def errors(case, seed, folder):
    """{name: (relative error, the same in standard deviations)} of one seed."""
    outcome, true = case(np.random.default_rng(seed), Path(folder) / "measured.csv")
    found, deviations = outcome.solution.values, outcome.solution.relative_deviations
    logs = {name: float(np.log(found[name] / true[name])) for name in found}
    return {name: (error, error / deviations[name]) for name, error in logs.items()}


def main():
    """Print the table."""
    print(f"{'measurement':36} within three deviations   middle error of each parameter")
    with tempfile.TemporaryDirectory() as folder:
        for name, case in (CASES | memory_measurements.CASES | drive_measurements.CASES).items():
            found = [errors(case, seed, folder) for seed in track_progress(range(SEEDS), name)]
            hits = sum(all(abs(z) <= 3.0 for _, z in one.values()) for one in found)
            middle = {p: np.median([abs(one[p][0]) for one in found]) for p in found[0]}
            shown = ", ".join(f"{p} {100.0 * e:.2g} %" for p, e in middle.items())
            print(f"{name:36} {hits:6d} of {SEEDS}              {shown}", flush=True)


if __name__ == "__main__":
    main()
