"""A robot's log to the friction of its drive: steady speeds, or motion with time.

The parameters are fitted by least squares over their logarithms; what is linear is eliminated from the
residuals. The load on the teeth, which some of that decides, is fixed in each of a few rounds. The last 30 %
of each log, or every third row of a table, are predicted by a fit to the rest.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy import stats
from scipy.linalg import block_diag

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.parameters import ParameterFile, default

from ....fitting.identifiability import undetermined
from ....fitting.least_squares import Array, Solution, solve
from ....fitting.outcome import FitResult, Picture, fitted, unknowns
from . import log_link, log_pictures
from .hysteresis import LOSS as LOOP
from .log_model import Linear, filtered, friction
from .log_reading import ONE_SPEED, Samples, joined, named, read

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
LEVEL = 0.95
SMALL = 1e-4
"""Step in the logarithms [1] over which what follows from them is taken as straight."""


@dataclass(frozen=True, slots=True)
class FittedLog:
    """A fit to samples.

    linear     : (k) what is linear beside the drive's friction
    covariance : (k, k) of these
    """

    drive: Drive
    solution: Solution
    linear: Array
    covariance: Array
    rotor: float

    def torque(self, samples: Samples) -> tuple[Array, Array]:
        """Friction (n) and all of the motor's torque (n) [N.m] at samples."""
        ratio = abs(self.drive.ratio)
        beside = Linear.of(samples, ratio)
        load = beside.load(samples, self.linear, ratio, self.rotor)
        braked = filtered(self.drive, samples, load)
        return braked, braked + beside.matrix @ self.linear + beside.known

    def load(self, samples: Samples) -> tuple[Array, Array]:
        """Load (n) [N.m] of the teeth, and (k, n) its changes by k independent standard deviations."""
        ratio = abs(self.drive.ratio)
        beside = Linear.of(samples, ratio)
        found = beside.load(samples, self.linear, ratio, self.rotor)
        variances, ways = np.linalg.eigh(self.covariance)
        ends = self.linear + np.sqrt(np.maximum(variances, 0.0))[:, None] * ways.T
        changes = [beside.load(samples, end, ratio, self.rotor) - found for end in ends]
        return found, np.reshape(changes, (len(changes), found.size))

    def unloaded(self, dq: Array, temperature: float) -> Array:
        """Friction (n) [N.m] without load at speeds of the joint [rad/s] and a temperature [K]."""
        return friction(self.drive, dq, np.full(dq.size, temperature), np.zeros(dq.size))


def fit(
    paths: Sequence[Path],
    start: ParameterFile | None = None,
    free: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
    torque_constant: float | None = None,
    ratio: float | None = None,
    motor_inertia: float | None = None,
) -> FitResult:
    """Fit the friction of the drive to one or more logs.

    Parameters
    ----------
    start           : with the ratio of the drive; None: the default, with `ratio`
    free            : names to fit; None: those of FREE that the logs can speak of
    columns         : `NAME=HEADING` or `NAME=HEADING [UNIT]` for files with other headings
    torque_constant : torque of the motor over its current [N.m/A]
    motor_inertia   : of the rotor [kg.m2], which the teeth do not carry

    Raises ValueError, one line: a file, its units, its values; a name that cannot be fitted. RuntimeError if
    the fit finds no end.
    """
    file = _begun(start, ratio)
    names = named(columns or ())
    logs = [read(path, names, torque_constant, file.values) for path in paths]
    samples = joined([log.part(log.built) for log in logs])
    label = ", ".join(path.name for path in paths)
    turned = [log for log in logs if np.all(np.isfinite(log.motor + log.q))]
    if not turned and (alone := [name for name in free or () if name in (*log_link.LINES, LOOP)]):
        raise ValueError(f"{label}: {alone[0]} needs the columns q and q_motor beside the time")
    _speeds(label, samples)
    rotor = motor_inertia or 0.0
    wanted, left = _wanted(samples, file.values, free, rotor)
    whole = _fitted(file, samples, wanted, rotor)
    found, pictures = whole.solution, [*log_pictures.pictures(samples, whole)]
    if samples.dynamic.any() and motor_inertia is None:
        left.append(
            "without --motor-inertia all inertia counts as the arm's: what hangs on the load, load_loss and "
            "stiffness, is off by the rotor's share"
        )
    intervals = _intervals(whole.solution)
    if turned:
        more, why = _link(file, turned[0], whole, free)
        left += why
        if more is not None:
            found, pictures = _both(found, more[0]), [*pictures, more[1]]
            intervals |= _intervals(more[0])
    result = fitted(file, found.values, "calibration", label, _span(samples))
    for name, (low, high) in intervals.items():
        text = f"{result.sources[name]}; {100.0 * LEVEL:g} % interval {low:.4g} to {high:.4g}"
        result = replace(result, sources={**result.sources, name: text})
    return FitResult(
        result,
        found,
        _facts(file, samples, whole, wanted, rotor),
        pictures[0],
        notes=left,
        more_pictures=pictures[1:],
        intervals=intervals,
    )


def _link(
    file: ParameterFile, log: Samples, whole: FittedLog, free: Sequence[str] | None
) -> tuple[tuple[Solution, Picture] | None, list[str]]:
    """Stiffness and hysteresis of a log with the motor's angle, or why they are not found."""
    own = (*log_link.LINES, LOOP)
    if free and not any(name in own for name in free):
        return None, []
    names = [name for name in own if name in file.flat and (not free or name in free)]
    if file.law != "catalogue" or not names:
        return None, ["stiffness and hysteresis are found with a start of the law catalogue"]
    load, spread = log.sensed, np.zeros((0, log.q.size))
    if not np.all(np.isfinite(load)):
        load, spread = whole.load(log)
    return log_link.fit(file, names, log_link.wind_up(log, abs(whole.drive.ratio)), -load, -spread), []


def _both(one: Solution, other: Solution) -> Solution:
    """Two fits of different unknowns to different data as one, in standard deviations of their noise."""
    scaled = [(fit.residuals / fit.noise, fit.jacobian / fit.noise) for fit in (one, other)]
    return Solution(
        unknowns=(*one.unknowns, *other.unknowns),
        values={**one.values, **other.values},
        residuals=np.concatenate([residuals for residuals, _ in scaled]),
        noise=1.0,
        jacobian=block_diag(*(jacobian for _, jacobian in scaled)),
        covariance=block_diag(one.covariance, other.covariance),
        at_bound=(*one.at_bound, *other.at_bound),
        limit=one.limit or other.limit,
    )


def _begun(start: ParameterFile | None, ratio: float | None) -> ParameterFile:
    """The file to start from, with its ratio."""
    if start is None and ratio is None:
        raise ValueError("the log does not tell the ratio; expected --params FILE of the drive, or --ratio")
    file = start or default("harmonic_drive")
    return file if ratio is None else file.with_values({"ratio": ratio}, "user", "stated")


def _speeds(label: str, samples: Samples) -> None:
    """Raise ValueError unless the samples have several speeds."""
    speed = np.abs(samples.dq)
    speed = speed[speed > 0.0]
    if speed.size == 0:
        raise ValueError(
            f"{label}: never turns on long enough for friction to build up; expected longer motion"
        )
    if speed.max() < ONE_SPEED * speed.min():
        raise ValueError(
            f"{label}: has one speed alone, {speed.min():.4g} to {speed.max():.4g} rad/s; expected several, "
            f"{ONE_SPEED:g} times as fast or more"
        )


def _wanted(
    samples: Samples, drive: Drive, free: Sequence[str] | None, rotor: float
) -> tuple[list[str], list[str]]:
    """Names to fit, and why others of FREE are left as they are."""
    if own := [name for name in free or () if name not in (*log_link.LINES, LOOP)]:
        return own, []
    left: dict[str, str] = {}
    load = _first_load(samples, drive, rotor)
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


def _first_load(samples: Samples, drive: Drive, rotor: float) -> Array:
    """The load (n) [N.m] as friction of constant dry and viscous parts leaves it."""
    beside, linear = _straight(samples, drive)
    return beside.load(samples, linear[2:], abs(drive.ratio), rotor)


def _straight(samples: Samples, drive: Drive) -> tuple[Linear, Array]:
    """Dry and viscous friction and what is linear, by one linear least squares."""
    ratio = abs(drive.ratio)
    beside = Linear.of(samples, ratio)
    steady = np.stack([np.sign(samples.dq), ratio * samples.dq], axis=1)
    whole = np.concatenate([steady, beside.matrix], axis=1)
    return beside, np.linalg.lstsq(whole, samples.torque - beside.known)[0]


def _fitted(file: ParameterFile, samples: Samples, wanted: Sequence[str], rotor: float) -> FittedLog:
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
    return FittedLog(changed.values, solution, linear, own + follows.T @ follows, rotor)


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


def _intervals(solution: Solution) -> dict[str, tuple[float, float]]:
    """{name: ends of the interval} by Student's t, in logarithms; of what is determined."""
    spare = max(solution.residuals.size - len(solution.unknowns), 1)
    factor = float(stats.t.ppf(0.5 + 0.5 * LEVEL, spare))
    loose = undetermined(solution)
    return {
        name: (solution.values[name] * np.exp(-factor * d), solution.values[name] * np.exp(factor * d))
        for name, d in solution.deviations.items()
        if name not in loose
    }


def _facts(
    file: ParameterFile, samples: Samples, whole: FittedLog, wanted: Sequence[str], rotor: float
) -> dict[str, tuple[float, str, str]]:
    """Residual, what was found beside, and the held-out part beside a constant."""
    ratio = abs(whole.drive.ratio)
    beside = Linear.of(samples, ratio)
    units = {"inertia": "kg.m2", "offset": "N.m", "gravity_cos": "N.m", "gravity_sin": "N.m"}
    texts = {"inertia": "of arm and rotor at the joint", "offset": "of the motor's torque"}
    facts = {
        name: (float(value), units[name], texts.get(name, f"{name[8:]}(q) part of gravity at the joint"))
        for name, value in zip(beside.names, whole.linear, strict=True)
    }
    facts["residual"] = (
        _rms(samples.torque - whole.torque(samples)[1]),
        "N.m",
        "root mean square, at the motor",
    )
    early, late = samples.part(~samples.later), samples.part(samples.later)
    if late.dq.size and early.dq.size > len(wanted) + len(beside.names):
        part = _fitted(file, early, wanted, rotor)
        miss = _rms(late.torque - part.torque(late)[1])
        facts["held_out"] = (
            miss,
            "N.m",
            f"the same of {late.dq.size} samples that a fit to the rest predicts",
        )
        guess = _rms(late.torque - _constant(early, late, ratio))
        facts["held_out_constant"] = (guess, "N.m", "the same of a constant in the place of friction")
    return facts


def _constant(early: Samples, late: Samples, ratio: float) -> Array:
    """Torque (n) [N.m] at later samples by what is linear and a constant, fitted to earlier ones."""
    matrices = []
    for samples in (early, late):
        beside = Linear.of(samples, ratio)
        matrices.append(
            (np.concatenate([np.ones((samples.dq.size, 1)), beside.matrix], axis=1), beside.known)
        )
    (first, known), (then, more) = matrices
    return np.asarray(then @ np.linalg.lstsq(first, early.torque - known)[0] + more)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _span(samples: Samples) -> str:
    """Over which speeds and temperatures, in words."""
    speed = np.abs(samples.dq)
    text = f"speeds of the joint {speed.min():.3g} to {speed.max():.3g} rad/s"
    known = samples.temperature[np.isfinite(samples.temperature)]
    return text + (f", {known.min():.5g} to {known.max():.5g} K" if known.size else "")
