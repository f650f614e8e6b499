"""Friction of a drive from samples of a log, by least squares: the torque of the robot's motor is

    torque = friction(|ratio| dq, load, temperature) + inertia ddq + gravity/|ratio| + offset

in the sense of the joint, so that the ratio has no sign. The inertia, an offset of the current and, where it
is not measured, gravity = a cos(q) + b sin(q), are linear and eliminated; the load that the teeth carry is
gravity and, of a rotor that is known, what its inertia leaves for the arm. The other parameters are fitted
over their logarithms; the load, which some of them decide, is fixed in each of a few rounds.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.friction import REFERENCE, limits, viscous
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....fitting.least_squares import Solution, solve
from ....fitting.outcome import unknowns
from .log_reading import Samples


@dataclass(frozen=True, slots=True)
class LinearTerms:
    """What is linear in unknowns beside the friction.

    matrix : (n, k) torque of the motor [N.m] for each unknown
    known  : (n) torque [N.m] for the gravity that is measured
    names  : (k)
    """

    matrix: Array
    known: Array
    names: tuple[str, ...]

    @classmethod
    def of(cls, samples: Samples, ratio: float) -> "LinearTerms":
        """Of samples; ratio > 0."""
        columns: dict[str, Array] = {}
        dynamic = samples.dynamic.astype(float)
        measured = np.isfinite(samples.gravity)
        if dynamic.any():
            columns = {"inertia": samples.ddq / ratio, "offset": dynamic}
            swung = dynamic * np.isfinite(samples.q) * ~measured
            if swung.any():
                angle = np.where(np.isfinite(samples.q), samples.q, 0.0)
                columns |= {
                    "gravity_cos": swung * np.cos(angle) / ratio,
                    "gravity_sin": swung * np.sin(angle) / ratio,
                }
        matrix = np.stack([*columns.values()], axis=1) if columns else np.zeros((samples.dq.size, 0))
        known = np.where(measured, samples.gravity, 0.0) / ratio
        return cls(matrix, known, tuple(columns))

    def found(self, rest: Array) -> Array:
        """The unknowns (k) that leave least of a torque (n)."""
        return np.asarray(np.linalg.lstsq(self.matrix, rest)[0]) if self.names else np.zeros(0)

    def load(self, samples: Samples, unknowns: Array, ratio: float, rotor: float) -> Array:
        """Torque (n) [N.m] at the joint that the teeth carry, positive where the motor holds it."""
        parts = dict(zip(self.names, unknowns.tolist(), strict=True))
        arm = max(parts.get("inertia", 0.0) - rotor * ratio**2, 0.0)
        gravity = [n for n, name in enumerate(self.names) if name.startswith("gravity")]
        swung = ratio * self.matrix[:, gravity] @ unknowns[gravity]
        return np.asarray(arm * samples.ddq + swung + ratio * self.known)


def friction(drive: Drive, dq: Array, temperature: Array, load: Array) -> Array:
    """Torque (...) [N.m] against the motion, of a drive in motion that carries loads (...) [N.m].

    dq : (...) speed of the joint [rad/s];  temperature : (...) [K], NaN: that of the parameters
    """
    forward = replace(drive, ratio=abs(drive.ratio))
    warmth = np.where(np.isfinite(temperature), temperature, REFERENCE)
    w1 = forward.ratio * dq
    positive, negative = limits(forward, w1, -load, warmth)
    return np.asarray(np.where(w1 > 0.0, positive, -negative) + viscous(forward, w1, warmth))


def filtered(drive: Drive, samples: Samples, load: Array) -> Array:
    """The same (n) at samples, through their filter."""
    warmth, carried = samples.temperature[:, None], load[:, None]
    return np.asarray(np.sum(samples.weights * friction(drive, samples.speeds, warmth, carried), axis=1))


DRY, STRIBECK, VISCOUS = "friction_coulomb", "friction_stribeck", "friction_viscous"
LOSS, BACK = "load_loss", "load_loss_back"
WARM = ("viscous_temperature_coefficient", "dry_temperature_coefficient")
FREE = (DRY, STRIBECK, VISCOUS, LOSS, BACK, *WARM)
ROUNDS = 4
"""Fits, each with the load of the one before."""
WARMED = 5.0
"""Range of temperatures [K] below which a log says nothing of its law."""
LOADED = 0.02
"""Largest load over rated torque [1] below which a log says nothing of the losses with load."""
FIRST = {LOSS: 0.05, BACK: 0.05, WARM[0]: 0.02, WARM[1]: 0.01}
"""Where the fit starts if the file has none [1], [1/K]."""
LEAST_PART = 1e-3
"""Of where the fit starts [1], below which a parameter is none."""
BLIND, AS_WELL = 2.0, 2.0
"""Factor [1] by which a parameter is left open that may stay as it is; standard deviations of the residual
[1], for each of them, up to which the file's values fit as well."""
SMALL = 1e-4
"""Step in the logarithms [1] over which what follows from them is taken as straight."""


@dataclass(frozen=True, slots=True)
class FittedLog:
    """A fit to samples.

    linear     : (k) what is linear beside the drive's friction
    covariance : (k, k) of these
    rotor      : inertia [kg.m2] that the teeth do not carry, and its standard deviation
    """

    drive: Drive
    solution: Solution
    linear: Array
    covariance: Array
    rotor: float
    rotor_deviation: float

    @property
    def inertia(self) -> float:
        """Of arm and rotor at the joint [kg.m2], the first of what is linear in a log of motion."""
        return float(self.linear[0])

    def torque(self, samples: Samples) -> tuple[Array, Array]:
        """Friction (n) and all of the motor's torque (n) [N.m] at samples."""
        ratio = abs(self.drive.ratio)
        beside = LinearTerms.of(samples, ratio)
        load = beside.load(samples, self.linear, ratio, self.rotor)
        braked = filtered(self.drive, samples, load)
        return braked, braked + beside.matrix @ self.linear + beside.known

    def load(self, samples: Samples) -> tuple[Array, Array]:
        """Load (n) [N.m] of the teeth, and (k, n) its changes by k independent standard deviations."""
        ratio = abs(self.drive.ratio)
        beside = LinearTerms.of(samples, ratio)
        found = beside.load(samples, self.linear, ratio, self.rotor)
        variances, ways = np.linalg.eigh(self.covariance)
        ends = self.linear + np.sqrt(np.maximum(variances, 0.0))[:, None] * ways.T
        ways_off = [*((end, self.rotor) for end in ends), (self.linear, self.rotor + self.rotor_deviation)]
        changes = [beside.load(samples, end, ratio, rotor) - found for end, rotor in ways_off]
        return found, np.reshape(changes, (len(changes), found.size))

    def unloaded(self, dq: Array, temperature: float) -> Array:
        """Friction (n) [N.m] without load at speeds of the joint [rad/s] and a temperature [K]."""
        return friction(self.drive, dq, np.full(dq.size, temperature), np.zeros(dq.size))


def wanted_of(
    samples: Samples, drive: Drive, free: Sequence[str], rotor: float
) -> tuple[list[str], list[str]]:
    """Names to fit, and why others of FREE are left as they are."""
    if free:
        return list(free), []
    left: dict[str, str] = {}
    beside, linear = _straight(samples, drive)
    load = beside.load(samples, linear[2:], abs(drive.ratio), rotor)  # with constant dry and viscous friction
    if np.max(np.abs(load)) < LOADED * drive.rated_torque:
        text = f"the load stays below {LOADED:g} times the rated torque"
        left |= {LOSS: text, BACK: text}
    else:
        driven = load * samples.dq < -LOADED * drive.rated_torque * np.abs(samples.dq)
        if drive.load_loss_back < 0.0:
            left[BACK] = "it is that of load_loss in the start file"
        elif not driven.any():
            left[BACK] = "the load never drives the motor"
    known = samples.temperature[np.isfinite(samples.temperature)]
    if known.size == 0 or np.ptp(known) < WARMED:
        span = "no temperature in it" if known.size == 0 else f"{np.ptp(known):.2g} K of temperature"
        left |= dict.fromkeys(WARM, f"{span}, {WARMED:g} K are needed")
    slow = abs(drive.ratio) * np.min(np.abs(samples.dq))
    if slow > 2.0 * drive.stribeck_speed:
        left[STRIBECK] = f"the motor is never slower than {slow:.3g} rad/s, twice stribeck_speed is needed"
    notes = [f"the log does not determine {name}, which stays as it is: {why}" for name, why in left.items()]
    return [name for name in FREE if name not in left], notes


def _straight(samples: Samples, drive: Drive) -> tuple[LinearTerms, Array]:
    """Dry and viscous friction and what is linear, by one linear least squares."""
    ratio = abs(drive.ratio)
    beside = LinearTerms.of(samples, ratio)
    steady = np.stack([np.sign(samples.dq), ratio * samples.dq], axis=1)
    whole = np.concatenate([steady, beside.matrix], axis=1)
    return beside, np.linalg.lstsq(whole, samples.torque - beside.known)[0]


def fitted_to(file: ParameterFile, samples: Samples, wanted: Sequence[str], rotor: float) -> FittedLog:
    """The fit of some parameters to samples."""
    ratio = abs(file.values.ratio)
    beside, linear = _straight(samples, file.values)
    begin, linear = _first(file, samples, linear), linear[2:]
    changed = file.with_values({n: v for n, v in begin.items() if n in wanted}, "calibration", "start")
    least = {name: (LEAST_PART * value, np.inf) for name, value in begin.items()}
    for _ in range(ROUNDS):
        load = beside.load(samples, linear, ratio, rotor)

        def rest(values: Mapping[str, float], load: Array = load) -> Array:
            drive = file.with_values(values, "calibration", "fit").values
            braked = filtered(drive, samples, load)
            return np.asarray(samples.torque - beside.known - braked)

        def residuals(values: Mapping[str, float], rest=rest) -> Array:  # type: ignore[no-untyped-def]
            left = rest(values)
            return np.asarray(left - beside.matrix @ beside.found(left))

        solution = solve(unknowns(changed, wanted, least), residuals, nuisances=len(beside.names))
        linear = beside.found(rest(solution.values))
        changed = file.with_values(solution.values, "calibration", "fit")
    own = solution.noise**2 * np.linalg.pinv(beside.matrix.T @ beside.matrix)
    follows = _deviations(solution, lambda values: beside.found(rest(values)))
    return FittedLog(changed.values, solution, linear, own + follows.T @ follows, rotor, 0.0)


def without_blind(
    file: ParameterFile, samples: Samples, fit: FittedLog, wanted: Sequence[str]
) -> tuple[FittedLog, list[str], list[str]]:
    """The fit without those of FIRST that it leaves open by a factor of BLIND, if the file's own values fit
    as well; names of what is fitted, and what to say of the others.
    """
    open_ = [n for n in wanted if n in FIRST and fit.solution.deviations[n] > np.log(BLIND)]
    kept = [name for name in wanted if name not in open_]
    if open_ and kept:
        other = fitted_to(file, samples, kept, fit.rotor)
        more = np.sum(other.solution.residuals**2) - np.sum(fit.solution.residuals**2)
        if more < len(open_) * (AS_WELL * fit.solution.noise) ** 2:
            text = "the log does not determine {}, which stays as it is: that fits as well"
            return other, kept, [text.format(name) for name in open_]
    return fit, list(wanted), []


def driven(samples: Samples, drive: Drive) -> bool:
    """Whether friction drives the motion, as it does where the torque's sign is the other one."""
    beside, linear = _straight(samples, drive)
    w1 = abs(drive.ratio) * samples.dq
    braked = linear[0] * np.sign(w1) + linear[1] * w1
    rest = samples.torque - beside.known - braked - beside.matrix @ linear[2:]
    return bool(braked @ w1 < 0.0 and np.sum(braked**2) > np.sum(rest**2))


def with_rotor(
    file: ParameterFile, samples: Samples, wanted: Sequence[str], rotor: float, deviation: float
) -> FittedLog:
    """The fit with a rotor's inertia that is known up to a standard deviation [kg.m2]."""
    fit = fitted_to(file, samples, wanted, rotor)
    other = fitted_to(file, samples, wanted, rotor + deviation).solution.values
    off = np.array([np.log(other[name] / value) for name, value in fit.solution.values.items()])
    wider = replace(fit.solution, covariance=fit.solution.covariance + np.outer(off, off))
    return replace(fit, solution=wider, rotor_deviation=deviation)


def _deviations(solution: Solution, of: Callable[[Mapping[str, float]], Array]) -> Array:
    """(k, m) how a function (m) of the values goes with each of their k independent standard deviations."""
    variances, ways = np.linalg.eigh(solution.covariance)
    rows, there = [], of(solution.values)
    for deviation, way in zip(np.sqrt(np.maximum(variances, 0.0)), ways.T, strict=True):
        moved = {
            n: v * float(np.exp(SMALL * d)) for (n, v), d in zip(solution.values.items(), way, strict=True)
        }
        rows.append((of(moved) - there) * deviation / SMALL)
    return np.array(rows)


def _first(file: ParameterFile, samples: Samples, linear: Array) -> dict[str, float]:
    """Where the fit starts: friction as straight least squares have it, the rest as in the file."""
    size = float(np.median(np.abs(samples.torque))) or 1.0
    fastest = abs(file.values.ratio) * float(np.max(np.abs(samples.dq)))
    dry = max(float(linear[0]), 0.05 * size)
    own = {name: file.flat[name] if file.flat[name] > 0.0 else value for name, value in FIRST.items()}
    return {DRY: dry, STRIBECK: 0.2 * dry, VISCOUS: max(float(linear[1]), 0.02 * size / fastest)} | own
