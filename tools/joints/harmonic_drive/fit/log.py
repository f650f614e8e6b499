"""A robot's log to the friction of its drive: steady speeds, or motion with time; facts and pictures.

The last 30 % of each log, or every third row of a table, are predicted by a fit to the rest.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import stats
from scipy.linalg import block_diag

from jointfmu.parameters import ParameterFile, default
from jointfmu.quantity import Array
from jointfmu.quantity.units import KELVIN_AT_ZERO

from ....fitting.least_squares import Solution
from ....fitting.outcome import Facts, FitResult, Picture, fitted, undetermined
from . import hysteresis
from .log_friction import FittedLog, LinearTerms, driven, fitted_to, wanted_of, with_rotor, without_blind
from .log_reading import ONE_SPEED, Samples, joined, named, read

LEVEL = 0.95
WHOLE, SURE = 1.1, 4.0
"""Share [1] of all inertia that a rotor may seem to be, and standard deviations [1] of it beyond that."""


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
    motor_inertia   : of the rotor [kg.m2], which the teeth do not carry; None: found from the wind-up where
        the motor has an angle of its own

    Raises ValueError, one line: a file, its units, its values; a name that cannot be fitted. RuntimeError if
    the fit finds no end.
    """
    file = _begun(start, ratio)
    names = named(columns or ())
    logs = [read(path, names, torque_constant, file.values) for path in paths]
    samples = joined([log.part(log.built) for log in logs])
    label = ", ".join(path.name for path in paths)
    turned = [log for log in logs if np.all(np.isfinite(log.motor + log.q))]
    if not turned and (alone := [name for name in free or () if name in hysteresis.OWN]):
        raise ValueError(f"{label}: {alone[0]} needs the columns q and q_motor beside the time")
    _speeds(label, samples)
    if driven(samples, file.values):
        raise ValueError(
            f"{label}: friction drives the motion; reverse the sign of one column or of --torque-constant"
        )
    rotor = motor_inertia or 0.0
    own = [name for name in free or () if name not in hysteresis.OWN]
    wanted, left = wanted_of(samples, file.values, own, rotor)
    whole = fitted_to(file, samples, wanted, rotor)
    if rotor and samples.dynamic.any():
        _within(rotor, whole)
    if not own:
        whole, wanted, blind = without_blind(file, samples, whole, wanted)
        left += blind
    if samples.dynamic.any() and motor_inertia is None:
        if turned and (seen := _rotor(file, turned[0], whole)):
            whole = with_rotor(file, samples, wanted, *seen)
        else:
            left.append(
                "without --motor-inertia all inertia counts as the arm's: what hangs on the load, load_loss "
                "and stiffness, is off by the rotor's share"
            )
    found, drawn = whole.solution, [*pictures(samples, whole)]
    intervals = _intervals(whole.solution)
    if turned:
        more, why = _link(file, turned[0], whole, free)
        left += why
        if more is not None:
            found, drawn = _both(found, more[0]), [*drawn, more[1]]
            intervals |= _intervals(more[0])
    result = fitted(file, found.values, "calibration", label, _span(samples))
    for name, value in found.values.items():
        kind, text = "estimate", "not determined: other values fit as well"
        if name in intervals:
            kind, text = (
                "calibration",
                "{:g} % interval {:.4g} to {:.4g}".format(100.0 * LEVEL, *intervals[name]),
            )
        result = result.with_values({name: value}, kind, f"{result.sources[name]}; {text}")
    return FitResult(
        result,
        found,
        facts(file, samples, whole, wanted),
        drawn,
        notes=left,
        intervals=intervals,
    )


def _within(rotor: float, whole: FittedLog) -> None:
    """Raise ValueError for a rotor [kg.m2] that is more than all inertia of the log."""
    there = rotor * whole.drive.ratio**2
    most = WHOLE * whole.inertia + SURE * float(np.sqrt(whole.covariance[0, 0]))
    if there > most:
        hint = f"; stated at the joint, it is {rotor / whole.drive.ratio**2:.3g} kg.m2 of the rotor"
        raise ValueError(
            f"--motor-inertia = {rotor:g} kg.m2 times ratio^2 is {there:.4g} kg.m2 at the joint, outside "
            f"[0, {most:.4g}] kg.m2, of arm and rotor in the log{hint if rotor <= most else ''}"
        )


def _rotor(file: ParameterFile, log: Samples, whole: FittedLog) -> tuple[float, float] | None:
    """Inertia of the rotor and its deviation [kg.m2], if a log with the motor's angle determines it."""
    if file.law != "catalogue":
        return None
    square = whole.drive.ratio**2
    (load, spread), phi = whole.load(log), hysteresis.wind_up(log, abs(whole.drive.ratio))
    return hysteresis.rotor(file, phi, -load, -spread, square * log.ddq, whole.inertia / square)


def _link(
    file: ParameterFile, log: Samples, whole: FittedLog, free: Sequence[str] | None
) -> tuple[tuple[Solution, Picture] | None, list[str]]:
    """Stiffness and hysteresis of a log with the motor's angle, or why they are not found."""
    if free and not any(name in hysteresis.OWN for name in free):
        return None, []
    names = [name for name in hysteresis.OWN if name in file.flat and (not free or name in free)]
    if file.law != "catalogue" or not names:
        return None, ["stiffness and hysteresis are found with a start of the law catalogue"]
    load, spread = log.sensed, np.zeros((0, log.q.size))
    if not np.all(np.isfinite(load)):
        load, spread = whole.load(log)
    return hysteresis.fit_log(
        file, names, hysteresis.wind_up(log, abs(whole.drive.ratio)), -load, -spread
    ), []


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


def _span(samples: Samples) -> str:
    """Over which speeds and temperatures, in words."""
    speed = np.abs(samples.dq)
    text = f"speeds of the joint {speed.min():.3g} to {speed.max():.3g} rad/s"
    known = samples.temperature[np.isfinite(samples.temperature)]
    return text + (f", {known.min():.5g} to {known.max():.5g} K" if known.size else "")


def facts(file: ParameterFile, samples: Samples, whole: FittedLog, wanted: Sequence[str]) -> Facts:
    """Residual, what was found beside, and the held-out part beside a constant."""
    ratio = abs(whole.drive.ratio)
    beside = LinearTerms.of(samples, ratio)
    units = {"inertia": "kg.m2", "offset": "N.m", "gravity_cos": "N.m", "gravity_sin": "N.m"}
    texts = {"inertia": "of arm and rotor at the joint", "offset": "of the motor's torque"}
    facts = {
        name: (float(value), units[name], texts.get(name, f"{name[8:]}(q) part of gravity at the joint"))
        for name, value in zip(beside.names, whole.linear, strict=True)
    }
    if whole.rotor_deviation:
        text = f"of the rotor, from the wind-up; standard deviation {whole.rotor_deviation:.2g}"
        facts["motor_inertia"] = whole.rotor, "kg.m2", text
    facts["residual"] = (
        _rms(samples.torque - whole.torque(samples)[1]),
        "N.m",
        "root mean square, at the motor",
    )
    early, late = samples.part(~samples.later), samples.part(samples.later)
    if late.dq.size and early.dq.size > len(wanted) + len(beside.names):
        part = fitted_to(file, early, wanted, whole.rotor)
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
        beside = LinearTerms.of(samples, ratio)
        matrices.append(
            (np.concatenate([np.ones((samples.dq.size, 1)), beside.matrix], axis=1), beside.known)
        )
    (first, known), (then, more) = matrices
    return np.asarray(then @ np.linalg.lstsq(first, early.torque - known)[0] + more)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


MILLI = 1e3
_FRICTION, _MISFIT = "friction at the motor [mN m]", "log - law [mN m]"
_UNLOADED, _WARMTH = "friction without load [mN m]", "temperature [degrees C]"


def pictures(samples: Samples, law: FittedLog) -> Iterator[Picture]:
    """Over the speed of the joint, the time, the temperature, as far as the log has them."""
    braked, torque = law.torque(samples)
    misfit = samples.torque - torque
    measured = braked + misfit
    yield _over_speed(samples, law, misfit)
    if samples.dynamic.any():
        rows = np.flatnonzero(samples.dynamic)
        time = samples.time[rows]
        yield _picture(time, measured[rows], misfit[rows], (time, braked[rows]), "time [s]")
    if (known := np.flatnonzero(np.isfinite(samples.temperature))).size:
        warmth = samples.temperature[known] - KELVIN_AT_ZERO
        ends = np.array([warmth.min(), warmth.max()])
        over, rest = measured[known] / braked[known], MILLI * misfit[known]
        yield Picture(warmth, over, rest, (ends, np.ones(2)), (_WARMTH, "friction, log over law", _MISFIT))


def _over_speed(samples: Samples, law: FittedLog, misfit: Array) -> Picture:
    """Without load, at the median of the temperatures; held-out rows of a table are marked."""
    fastest = float(np.max(np.abs(samples.dq)))
    speed = np.linspace(-fastest, fastest, 400)
    known = samples.temperature[np.isfinite(samples.temperature)]
    usual = float(np.median(known)) if known.size else np.nan
    y, line = law.unloaded(samples.dq, usual) + misfit, (speed, law.unloaded(speed, usual))
    picture = _picture(samples.dq, y, misfit, line, "speed of the joint [rad/s]")
    marks = None if samples.dynamic.any() else samples.later
    return replace(picture, labels=(picture.labels[0], _UNLOADED, _MISFIT), marks=marks)


def _picture(x: Array, y: Array, misfit: Array, line: tuple[Array, Array], label: str) -> Picture:
    """Torques in mN m; a line through many samples in their order."""
    return Picture(x, MILLI * y, MILLI * misfit, (line[0], MILLI * line[1]), (label, _FRICTION, _MISFIT))
