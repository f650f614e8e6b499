"""Loops, decays and responses to the hysteresis of the harmonic drive.

The midline is that of the parameters to start from (fit it with `torque-angle` first). Beside it acts the
friction torque of the exported drive: how far the branches are apart without torque gives
`hysteresis_loss`, how the torque turns round after a reversal `hysteresis_stiffness`.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile, default
from jointfmu.quantity.units import sizes

from ....fitting import memory, memory_pictures
from ....fitting.branches import Loops
from ....fitting.heads import Heads
from ....fitting.hysteresis import HysteresisLaw, NonlinearSpring
from ....fitting.least_squares import Array
from ....fitting.measurement import measured
from ....fitting.outcome import FitResult, fitted, unknowns
from . import drive as own

HEADS = Heads(
    "torque",
    "angle",
    sizes("N.m", "mN.m", "kN.m"),
    sizes("rad", "mrad", "deg", "arcmin", "arcsec"),
)
_UNITS = {HEADS.force: HEADS.forces, HEADS.motion: HEADS.motions}
LOSS, STIFFNESS = FREE = ("hysteresis_loss", "hysteresis_stiffness")
ARCMIN = HEADS.motions["arcmin"]
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
        wound = float(own.windup(begun.values, np.array(reach)))
        own.check_level(data.path, wound / data.amplitude, data.units, _UNITS, begun)
    file, rest = _begun(begun, names)

    def drive(values: Mapping[str, float]) -> Drive:
        parameters: Drive = file.with_values(values, "calibration", "fit").values
        return parameters

    model = memory.model(data, lambda values: law(drive(values)), "inertia", inertia, 0.0)
    starts = {LOSS: LOSSES, STIFFNESS: tuple(rest * np.array(STIFFNESSES))}
    solution, scale = memory.search(data, unknowns(file, names, own.bounds(file)), model, starts)
    result = fitted(file, solution.values, "calibration", data.path.name, data.span)
    picture, beside = memory_pictures.pictures(data, model, solution.values, scale)
    found = law(result.values)
    limit = float(found.friction(np.array([np.inf]))[0])
    described = {"friction_torque": (limit, "N.m", "bound of the friction torque")}
    return FitResult(
        result,
        solution,
        described | memory.facts(data, solution, found, scale),
        picture,
        notes=memory.notes(data, solution),
        second_picture=beside,
    )


def _begun(file: ParameterFile, names: Sequence[str]) -> tuple[ParameterFile, float]:
    """The start with some hysteresis, as a fit in logarithms needs it, and K_WTS [N.m/rad] without torque."""
    rest = float(HarmonicDriveSpring.of(file.values).curve.stiffness[0])
    first = {LOSS: FIRST[LOSS], STIFFNESS: FIRST[STIFFNESS] * rest}
    absent = {name: value for name, value in first.items() if name in names and file.flat[name] == 0.0}
    return file.with_values(absent, "calibration", "start"), rest
