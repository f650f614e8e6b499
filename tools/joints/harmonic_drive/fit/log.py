"""Fit of the friction of a harmonic drive to logs of a robot: motion over time, or tables of steady speeds.

For validation the last 30 % of each log, or every third row of a table, are predicted by a fit to the other
data.
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
"""Confidence level of the intervals [1]."""
WHOLE, SURE = 1.1, 4.0
"""Bound of the stated rotor inertia: first value times the fitted total inertia, plus second value times the
standard deviation of the total inertia [1]."""


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
    start           : parameters to start from, with the ratio of the drive; None: the default, with `ratio`
    fitted_names    : names to fit; None: the parameters that the logs can determine
    columns         : `NAME=HEADING` or `NAME=HEADING [UNIT]`, for files with other headings
    torque_constant : motor torque over motor current [N.m/A]
    ratio           : speed ratio [1]; None: that of `start`
    motor_inertia   : [kg.m2] of the rotor, whose inertia torque does not load the teeth; None: fitted to the
                      wind-up, if the log has the motor angle

    Raises ValueError with a one-line message for a bad file, unit or value, or a name that cannot be fitted.
    Raises RuntimeError if the fit does not converge.
    """
    file = _begun(start, ratio)
    names = named(columns or ())
    logs = [read(path, names, torque_constant, file.values) for path in paths]
    samples = joined([log.part(log.built) for log in logs])
    label = ", ".join(path.name for path in paths)
    logs_with_motor_angle = [log for log in logs if np.all(np.isfinite(log.motor + log.q))]
    if not logs_with_motor_angle and (alone := [name for name in free or () if name in hysteresis.OWN]):
        raise ValueError(f"{label}: {alone[0]} needs the columns q and q_motor beside the time")
    _speeds(label, samples)
    if driven(samples, file.values):
        raise ValueError(
            f"{label}: friction drives the motion; reverse the sign of one column or of --torque-constant"
        )
    rotor_inertia = motor_inertia or 0.0
    friction_names = [name for name in free or () if name not in hysteresis.OWN]
    names_to_fit, notes = wanted_of(samples, file.values, friction_names, rotor_inertia)
    fitted_log = fitted_to(file, samples, names_to_fit, rotor_inertia)
    if rotor_inertia and samples.dynamic.any():
        _within(rotor_inertia, fitted_log)
    if not friction_names:
        fitted_log, names_to_fit, dropped = without_blind(file, samples, fitted_log, names_to_fit)
        notes += dropped
    if samples.dynamic.any() and motor_inertia is None:
        if logs_with_motor_angle and (rotor_fit := _rotor(file, logs_with_motor_angle[0], fitted_log)):
            fitted_log = with_rotor(file, samples, names_to_fit, *rotor_fit)
        else:
            notes.append(
                "without --motor-inertia all inertia counts as the arm's: what hangs on the load, load_loss "
                "and stiffness, is off by the rotor's share"
            )
    solution, drawn_pictures = fitted_log.solution, [*pictures(samples, fitted_log)]
    intervals = _intervals(fitted_log.solution)
    if logs_with_motor_angle:
        stiffness_fit, link_notes = _link(file, logs_with_motor_angle[0], fitted_log, free)
        notes += link_notes
        if stiffness_fit is not None:
            solution, drawn_pictures = _both(solution, stiffness_fit[0]), [*drawn_pictures, stiffness_fit[1]]
            intervals |= _intervals(stiffness_fit[0])
    result = fitted(file, solution.values, "calibration", label, _span(samples))
    for name, value in solution.values.items():
        kind, text = "estimate", "not determined: other values fit as well"
        if name in intervals:
            kind, text = (
                "calibration",
                "{:g} % interval {:.4g} to {:.4g}".format(100.0 * LEVEL, *intervals[name]),
            )
        result = result.with_values({name: value}, kind, f"{result.sources[name]}; {text}")
    return FitResult(
        result,
        solution,
        facts(file, samples, fitted_log, names_to_fit),
        drawn_pictures,
        notes=notes,
        intervals=intervals,
    )


def _within(rotor: float, whole: FittedLog) -> None:
    """Check the rotor inertia [kg.m2]. Raises ValueError if it exceeds the total inertia in the log."""
    at_joint = rotor * whole.drive.ratio**2
    limit = WHOLE * whole.inertia + SURE * float(np.sqrt(whole.covariance[0, 0]))
    if at_joint > limit:
        hint = f"; stated at the joint, it is {rotor / whole.drive.ratio**2:.3g} kg.m2 of the rotor"
        raise ValueError(
            f"--motor-inertia = {rotor:g} kg.m2 times ratio^2 is {at_joint:.4g} kg.m2 at the joint, outside "
            f"[0, {limit:.4g}] kg.m2, of arm and rotor in the log{hint if rotor <= limit else ''}"
        )


def _rotor(file: ParameterFile, log: Samples, whole: FittedLog) -> tuple[float, float] | None:
    """Rotor inertia and its standard deviation [kg.m2]; None if the log does not determine them."""
    if file.law != "catalogue":
        return None
    square = whole.drive.ratio**2
    (load, spread), phi = whole.load(log), hysteresis.wind_up(log, abs(whole.drive.ratio))
    return hysteresis.rotor(file, phi, -load, -spread, square * log.ddq, whole.inertia / square)


def _link(
    file: ParameterFile, log: Samples, whole: FittedLog, free: Sequence[str] | None
) -> tuple[tuple[Solution, Picture] | None, list[str]]:
    """Fit stiffness and hysteresis to a log with the motor angle.

    Returns solution and picture, or None if there is no such fit; and notes.
    """
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
    """Combine two independent fits to one solution; residuals are divided by the noise of each fit."""
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
    """Start parameters with the speed ratio. Raises ValueError if neither a file nor a ratio is given."""
    if start is None and ratio is None:
        raise ValueError("the log does not tell the ratio; expected --params FILE of the drive, or --ratio")
    file = start or default("harmonic_drive")
    return file if ratio is None else file.with_values({"ratio": ratio}, "user", "stated")


def _speeds(label: str, samples: Samples) -> None:
    """Check that the samples have several speeds. Raises ValueError if not."""
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
    """Confidence intervals {name: (low, high)} by Student's t over the logarithm.

    Parameters that the data do not determine have none.
    """
    spare = max(solution.residuals.size - len(solution.unknowns), 1)
    factor = float(stats.t.ppf(0.5 + 0.5 * LEVEL, spare))
    loose = undetermined(solution)
    return {
        name: (solution.values[name] * np.exp(-factor * d), solution.values[name] * np.exp(factor * d))
        for name, d in solution.deviations.items()
        if name not in loose
    }


def _span(samples: Samples) -> str:
    """Text with the ranges of speed and temperature."""
    speed = np.abs(samples.dq)
    text = f"speeds of the joint {speed.min():.3g} to {speed.max():.3g} rad/s"
    known = samples.temperature[np.isfinite(samples.temperature)]
    return text + (f", {known.min():.5g} to {known.max():.5g} K" if known.size else "")


def facts(file: ParameterFile, samples: Samples, whole: FittedLog, wanted: Sequence[str]) -> Facts:
    """Facts about the fit: inertia, offset, gravity, residual, prediction error of held-out samples."""
    ratio = abs(whole.drive.ratio)
    terms = LinearTerms.of(samples, ratio)
    units = {"inertia": "kg.m2", "offset": "N.m", "gravity_cos": "N.m", "gravity_sin": "N.m"}
    texts = {"inertia": "of arm and rotor at the joint", "offset": "of the motor's torque"}
    facts = {
        name: (float(value), units[name], texts.get(name, f"{name[8:]}(q) part of gravity at the joint"))
        for name, value in zip(terms.names, whole.linear, strict=True)
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
    if late.dq.size and early.dq.size > len(wanted) + len(terms.names):
        early_fit = fitted_to(file, early, wanted, whole.rotor)
        error = _rms(late.torque - early_fit.torque(late)[1])
        facts["held_out"] = (
            error,
            "N.m",
            f"the same of {late.dq.size} samples that a fit to the rest predicts",
        )
        guess = _rms(late.torque - _constant(early, late, ratio))
        facts["held_out_constant"] = (guess, "N.m", "the same of a constant in the place of friction")
    return facts


def _constant(early: Samples, late: Samples, ratio: float) -> Array:
    """Motor torque (n) [N.m] of later samples, by a model with constant friction fitted to earlier ones."""
    models = []
    for samples in (early, late):
        terms = LinearTerms.of(samples, ratio)
        models.append((np.concatenate([np.ones((samples.dq.size, 1)), terms.matrix], axis=1), terms.known))
    (early_matrix, early_known), (late_matrix, late_known) = models
    return np.asarray(late_matrix @ np.linalg.lstsq(early_matrix, early.torque - early_known)[0] + late_known)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


MILLI = 1e3
_FRICTION, _MISFIT = "friction at the motor [mN m]", "log - law [mN m]"
_UNLOADED, _WARMTH = "friction without load [mN m]", "temperature [degrees C]"


def pictures(samples: Samples, law: FittedLog) -> Iterator[Picture]:
    """Pictures of the friction over speed, time and temperature, as far as the log has these columns."""
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
    """Picture of the no-load friction over speed, at the median temperature; held-out rows are marked."""
    fastest = float(np.max(np.abs(samples.dq)))
    speed = np.linspace(-fastest, fastest, 400)
    known = samples.temperature[np.isfinite(samples.temperature)]
    usual = float(np.median(known)) if known.size else np.nan
    y, line = law.unloaded(samples.dq, usual) + misfit, (speed, law.unloaded(speed, usual))
    picture = _picture(samples.dq, y, misfit, line, "speed of the joint [rad/s]")
    marks = None if samples.dynamic.any() else samples.later
    return replace(picture, labels=(picture.labels[0], _UNLOADED, _MISFIT), marks=marks)


def _picture(x: Array, y: Array, misfit: Array, line: tuple[Array, Array], label: str) -> Picture:
    """Picture of friction torques y (n) [N.m] over x (n), with errors (n) [N.m] and a curve of the law."""
    return Picture(x, MILLI * y, MILLI * misfit, (line[0], MILLI * line[1]), (label, _FRICTION, _MISFIT))
