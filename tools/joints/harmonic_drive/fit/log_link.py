"""Stiffness and hysteresis from a log whose motor has an angle of its own beside the joint's.

The wind-up is the joint's angle less the motor's over the ratio, the torque that of the teeth. The friction
torque of the hysteresis follows the measured wind-up; where the drive has its zero is found beside.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.harmonic_drive import hysteresis
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile

from ....fitting.least_squares import Array, Solution, solve
from ....fitting.outcome import Picture, unknowns
from .hysteresis import ARCMIN, LOSS
from .log_reading import Samples

LINES = ("K1", "K2", "K3")
"""Stiffnesses of the law `catalogue`; drives of other laws are fitted to loops."""
FIRST_LOSS = 0.3 * ARCMIN
"""Where hysteresis_loss starts [rad] if the file has none."""
LEAST_PART = 1e-2
"""Of where the fit starts [1], below which hysteresis is none."""
SETTLED = 10
"""First samples that are left out: the hysteresis has no history yet."""


def wind_up(samples: Samples, ratio: float) -> Array:
    """Wind-up (n) [rad] of the joint against the motor, less its mean; the motor may turn either way."""
    sense = np.sign(np.dot(samples.q - samples.q.mean(), samples.motor - samples.motor.mean()))
    angle = samples.q - sense * samples.motor / abs(ratio)
    return np.asarray(angle - angle.mean())


def fit(
    file: ParameterFile, names: Sequence[str], phi: Array, tau: Array, spread: Array
) -> tuple[Solution, Picture]:
    """Fit names of LINES and hysteresis_loss to a path of wind-ups (n) [rad] under torques (n) [N.m].

    spread : (k, n) changes of the torques by k independent standard deviations; they widen the covariance

    Raises RuntimeError if the fit finds no end.
    """
    begin = {LOSS: FIRST_LOSS} if file.flat[LOSS] == 0.0 else {}
    start = file.with_values({n: v for n, v in begin.items() if n in names}, "calibration", "start")
    path = phi - phi[0]

    def angle(values: Mapping[str, float], torque: Array = tau) -> Array:
        """Wind-up (n) [rad] by the law, less its mean."""
        spring = HarmonicDriveSpring.of(file.with_values(values, "calibration", "fit").values)
        found = spring.curve.odd_inverse(torque - _friction(spring, path))
        return np.asarray(found - np.mean((found - phi)[SETTLED:]))

    bounds = {LOSS: (LEAST_PART * start.flat[LOSS], np.inf)}
    solution = solve(
        unknowns(start, names, bounds), lambda values: (phi - angle(values))[SETTLED:], nuisances=1
    )
    law = angle(solution.values)
    for change in spread:
        moved = np.linalg.lstsq(solution.jacobian, (angle(solution.values, tau + change) - law)[SETTLED:])[0]
        solution = replace(solution, covariance=solution.covariance + np.outer(moved, moved))
    labels = "torque at the joint [N m]", "wind-up [arcmin]", "log - law [arcmin]"
    picture = Picture(tau, phi / ARCMIN, (phi - law) / ARCMIN, (tau, law / ARCMIN), labels)
    return solution, picture


def _friction(spring: HarmonicDriveSpring, path: Array) -> Array:
    """Friction torque (n) [N.m] of the hysteresis along a path of wind-ups (n) [rad] from rest."""
    sliders = spring.hysteresis
    if not sliders.acts:
        return np.zeros(path.size)
    places, sampled = _with_turns(path)
    found, memory, none = np.empty(places.size), hysteresis.MEMORY.rest(), np.zeros(())
    for n, place in enumerate(places):
        slid = sliders.moved(memory, place)
        memory, found[n] = sliders.after(slid, place, none), slid.traction
    return found[sampled]


def _with_turns(path: Array) -> tuple[Array, NDArray[np.int_]]:
    """A path (n) with the vertices of the parabolas where it turns between samples, and where these are."""
    before, after = np.diff(path)[:-1], np.diff(path)[1:]
    turns = np.flatnonzero(before * after < 0.0)
    one, two = before[turns], after[turns]
    late = 0.5 * (one + two) / (one - two)  # in steps after the sample
    vertex = path[turns + 1] + 0.25 * (one + two) * late
    # the vertex lies on the side of the sample to which `late` points
    at = turns + 1 + (late > 0.0)
    sampled = np.arange(path.size) + np.searchsorted(at, np.arange(path.size), side="right")
    return np.insert(path, at, vertex), sampled
