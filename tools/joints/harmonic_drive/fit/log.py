"""A robot's log to the friction of its drive: steady speeds, or motion with time.

The last 30 % of each log, or every third row of a table, are predicted by a fit to the rest.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import stats
from scipy.linalg import block_diag

from jointfmu.parameters import ParameterFile, default

from ....fitting.identifiability import undetermined
from ....fitting.least_squares import Solution
from ....fitting.outcome import FitResult, Picture, fitted
from . import log_link, log_pictures
from .log_facts import facts
from .log_friction import FittedLog, fitted_to, wanted_of, with_rotor
from .log_reading import named, read
from .log_samples import ONE_SPEED, Samples, joined

LEVEL = 0.95


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
    if not turned and (alone := [name for name in free or () if name in log_link.OWN]):
        raise ValueError(f"{label}: {alone[0]} needs the columns q and q_motor beside the time")
    _speeds(label, samples)
    rotor = motor_inertia or 0.0
    own = [name for name in free or () if name not in log_link.OWN]
    wanted, left = wanted_of(samples, file.values, own, rotor)
    whole = fitted_to(file, samples, wanted, rotor)
    if samples.dynamic.any() and motor_inertia is None:
        if turned and (seen := _rotor(file, turned[0], whole)):
            whole = with_rotor(file, samples, wanted, *seen)
        else:
            left.append(
                "without --motor-inertia all inertia counts as the arm's: what hangs on the load, load_loss "
                "and stiffness, is off by the rotor's share"
            )
    found, pictures = whole.solution, [*log_pictures.pictures(samples, whole)]
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
        facts(file, samples, whole, wanted),
        pictures[0],
        notes=left,
        more_pictures=pictures[1:],
        intervals=intervals,
    )


def _rotor(file: ParameterFile, log: Samples, whole: FittedLog) -> tuple[float, float] | None:
    """Inertia of the rotor and its deviation [kg.m2], if a log with the motor's angle determines it."""
    if file.law != "catalogue":
        return None
    square = whole.drive.ratio**2
    (load, spread), phi = whole.load(log), log_link.wind_up(log, abs(whole.drive.ratio))
    return log_link.rotor(file, phi, -load, -spread, square * log.ddq, whole.inertia / square)


def _link(
    file: ParameterFile, log: Samples, whole: FittedLog, free: Sequence[str] | None
) -> tuple[tuple[Solution, Picture] | None, list[str]]:
    """Stiffness and hysteresis of a log with the motor's angle, or why they are not found."""
    if free and not any(name in log_link.OWN for name in free):
        return None, []
    names = [name for name in log_link.OWN if name in file.flat and (not free or name in free)]
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
