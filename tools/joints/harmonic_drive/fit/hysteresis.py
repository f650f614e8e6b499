"""Loops, decays, responses and logs to the hysteresis of the harmonic drive.

`fit` takes the midline of the parameters to start from (fit it with `torque-angle` first). Beside it acts the
friction torque of the exported drive: how far the branches are apart without torque gives `hysteresis_loss`,
how the torque turns round after a reversal `hysteresis_stiffness`.

`fit_log` finds stiffness too, from a log whose motor has an angle of its own beside the joint's. The wind-up
is the joint's angle less the motor's over the ratio, the torque that of the teeth. The friction torque
follows the measured wind-up; where the drive has its zero is found beside.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile, default
from jointfmu.quantity import Array

from ....fitting import memory
from ....fitting.branches import Loops
from ....fitting.hysteresis import HysteresisLaw, NonlinearSpring
from ....fitting.least_squares import Solution, Unknown, solve
from ....fitting.measurement import measured
from ....fitting.outcome import FitResult, Picture, fitted, undetermined, unknowns
from . import drive
from .drive import ARCMIN, HEADS
from .log_reading import Samples

LOSS, STIFFNESS = FREE = ("hysteresis_loss", "hysteresis_stiffness")
FIRST = {LOSS: ARCMIN, STIFFNESS: 1.0}
"""Where the fit starts if the file has no hysteresis: [rad], and over K_WTS without torque [1]."""
LOSSES = tuple(ARCMIN * np.geomspace(0.03, 10.0, 7))
STIFFNESSES = (0.3, 1.0, 3.0, 10.0)
"""Where the fit looks for a start, beside the start file's values: [rad], and over K_WTS [1]."""


def law(drive: Drive) -> HysteresisLaw:
    """Midline and friction torque of a drive: exactly the exported ones.

    Raises ValueError if there is no such hysteresis.
    """
    spring = HarmonicDriveSpring.of(drive)
    stiffness, limit = spring.hysteresis.stiffness, spring.hysteresis.limit
    curve = spring.curve

    def friction(motion: Array) -> Array:
        return np.asarray(np.sum(np.minimum(stiffness * motion[..., None], limit), axis=-1))

    def work(motion: Array) -> Array:
        stuck = np.minimum(motion[..., None], limit / stiffness)
        return np.asarray(np.sum(0.5 * stiffness * stuck**2 + limit * (motion[..., None] - stuck), axis=-1))

    def force(motion: Array) -> Array:
        return np.copysign(curve.derivatives(np.abs(motion), 0)[0], motion)

    return HysteresisLaw(
        friction, work, NonlinearSpring(force, lambda motion: curve.energy(np.abs(motion))), drive.d
    )


def fit(
    path: str | Path,
    start: ParameterFile | None = None,
    free: Sequence[str] | None = None,
    inertia: float | None = None,
) -> FitResult:
    """Fit a file of loops, decays, responses or frequency and damping over the amplitude (HEADS).

    Parameters
    ----------
    free    : names to fit; None: FREE
    inertia : [kg.m2] what vibrates on the drive; needed unless the file has loops

    Raises ValueError, one line: the file, its units, its values; a loop that creates energy; a name that
    cannot be fitted. RuntimeError if the fit finds no end.
    """
    data = measured(path, HEADS)
    names = list(free or FREE)
    begun = start or default("harmonic_drive")
    if isinstance(data.data, Loops):
        reach = 0.5 * float(np.ptp(data.data.force))
        wound = float(drive.windup(begun.values, np.array(reach)))
        HEADS.check_level(data.path, wound / data.amplitude, data.units, begun)
    file, rest = _begun(begun, names)

    def own(values: Mapping[str, float]) -> HysteresisLaw:
        return law(file.with_values(values, "calibration", "fit").values)

    model = memory.model(data, own, "inertia", inertia, 0.0)
    starts = {LOSS: LOSSES, STIFFNESS: tuple(rest * np.array(STIFFNESSES))}
    solution, scale, _ = memory.search(data, unknowns(file, names, drive.bounds(file)), model, starts)
    result = fitted(file, solution.values, "calibration", data.path.name, data.span)
    found = law(result.values)
    limit = float(found.friction(np.array([np.inf]))[0])
    described = {"friction_torque": (limit, "N.m", "bound of the friction torque")}
    return FitResult(
        result,
        solution,
        described | memory.facts(data, solution, found, scale),
        memory.pictures(data, model, solution.values, scale),
        notes=memory.notes(data, solution),
    )


def _begun(file: ParameterFile, names: Sequence[str]) -> tuple[ParameterFile, float]:
    """The start with some hysteresis, as a fit in logarithms needs it, and K_WTS [N.m/rad] without torque."""
    rest = float(HarmonicDriveSpring.of(file.values).curve.stiffness[0])
    first = {LOSS: FIRST[LOSS], STIFFNESS: FIRST[STIFFNESS] * rest}
    absent = {name: value for name, value in first.items() if name in names and file.flat[name] == 0.0}
    return file.with_values(absent, "calibration", "start"), rest


LINES = ("K1", "K2", "K3")
"""Stiffnesses of the law `catalogue`; drives of other laws are fitted to loops."""
OWN = (*LINES, LOSS)
"""What is fitted here."""
ROTOR = "motor_inertia"
"""Beside these, where nobody states it."""
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


def rotor(
    file: ParameterFile, phi: Array, tau: Array, spread: Array, relief: Array, most: float
) -> tuple[float, float] | None:
    """Inertia of the rotor and its standard deviation [kg.m2] by a path of wind-ups (n) [rad]; None if these
    do not determine it.

    tau, spread : as in `fit`, if it were none
    relief      : (n) [N.m/(kg.m2)] what of them it takes
    most        : all of the inertia is the rotor's [kg.m2]

    Raises RuntimeError if the fit finds no end.
    """
    own = [name for name in OWN if name in file.flat]
    wanted = Unknown(ROTOR, "kg.m2", 0.1 * most, LEAST_PART * most, most)
    solution, _ = _solved(file, own, phi, lambda values: tau + values[ROTOR] * relief, spread, [wanted])
    found = solution.values[ROTOR]
    return None if ROTOR in undetermined(solution) else (found, found * solution.deviations[ROTOR])


def fit_log(
    file: ParameterFile, names: Sequence[str], phi: Array, tau: Array, spread: Array
) -> tuple[Solution, Picture]:
    """Fit names of OWN to a path of wind-ups (n) [rad] under torques (n) [N.m].

    spread : (k, n) changes of the torques by k independent standard deviations; they widen the covariance

    Raises RuntimeError if the fit finds no end.
    """
    solution, law = _solved(file, names, phi, lambda values: tau, spread)
    labels = "torque at the joint [N m]", "wind-up [arcmin]", "log - law [arcmin]"
    return solution, Picture(tau, phi / ARCMIN, (phi - law) / ARCMIN, (tau, law / ARCMIN), labels)


def _solved(
    file: ParameterFile,
    names: Sequence[str],
    phi: Array,
    torque: Callable[[Mapping[str, float]], Array],
    spread: Array,
    more: Sequence[Unknown] = (),
) -> tuple[Solution, Array]:
    """The fit of names of OWN, and of what else decides the torque (n) [N.m]; and the law's wind-up (n)."""
    begin = {LOSS: FIRST_LOSS} if file.flat[LOSS] == 0.0 else {}
    start = file.with_values({n: v for n, v in begin.items() if n in names}, "calibration", "start")
    path = phi - phi[0]

    def angle(values: Mapping[str, float], tau: Array) -> Array:
        """Wind-up (n) [rad] by the law, less its mean."""
        own = {name: values[name] for name in names}
        spring = HarmonicDriveSpring.of(file.with_values(own, "calibration", "fit").values)
        found = spring.curve.odd_inverse(tau - _friction(spring, path))
        return np.asarray(found - np.mean((found - phi)[SETTLED:]))

    wanted = [*unknowns(start, names, {LOSS: (LEAST_PART * start.flat[LOSS], np.inf)}), *more]
    solution = solve(wanted, lambda values: (phi - angle(values, torque(values)))[SETTLED:], nuisances=1)
    carried = torque(solution.values)
    law = angle(solution.values, carried)
    for change in spread:
        off = (angle(solution.values, carried + change) - law)[SETTLED:]
        moved = np.linalg.lstsq(solution.jacobian, off)[0]
        solution = replace(solution, covariance=solution.covariance + np.outer(moved, moved))
    return solution, law


def _friction(spring: HarmonicDriveSpring, path: Array) -> Array:
    """Friction torque (n) [N.m] of the hysteresis along a path of wind-ups (n) [rad] from rest."""
    sliders = spring.hysteresis
    if not sliders.acts:
        return np.zeros(path.size)
    places, sampled = _with_turns(path)
    return sliders.path(np.diff(places, prepend=0.0), sliders.limit)[sampled]


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
