"""Fit of a law of the drive to a measured torque-angle curve, or a table of the midline of this curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints.harmonic_drive.given import TableDrive
from jointfmu.joints.harmonic_drive.law import PairDrive
from jointfmu.parameters import ParameterFile, default
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal

from .... import columns
from ....catalogue import Printed
from ....fitting import loop
from ....fitting.least_squares import NOTHING, Solution, solve
from ....fitting.measurement import OTHERS
from ....fitting.outcome import Facts, FitResult, Picture, fitted, model, systematic, unknowns
from . import drive
from .drive import ARCMIN, COLUMNS, HEADS

FREE = ("K_FTS0", "drive_scale", "zero_torque_pressure")
"""Parameters to fit; of the law `catalogue` they are K1, K2, K3."""
LEAST = 10
"""Required number of points of a curve."""
CREATED = 0.01
"""Created energy of a loop, from noise or drift, over torque range times angle range [1] that is accepted."""


@dataclass(frozen=True, slots=True)
class Record:
    """Measured curve: path of the file, its midline, and start parameters for a drive of this size."""

    path: Path
    line: loop.Backbone
    start: ParameterFile


def fit(
    path: str | Path,
    start: ParameterFile | None = None,
    free: Sequence[str] | None = None,
    rated_torque: float | None = None,
    law: str | None = None,
) -> FitResult:
    """Fit a file with the columns torque and angle (COLUMN_UNITS), in the order of measurement.

    An offset of the angle is a further unknown, which is fitted and subtracted.

    Parameters
    ----------
    start        : parameters to start from; None: the default drive
    fitted_names : names to fit; None: FITTED_PARAMETERS, or K1, K2, K3 for the law `catalogue`
    rated_torque : [N.m]; max_torque and torque_smoothing of `start` are scaled with it; None: that of `start`
    law          : "table": use the midline itself, see `fit_table`; None: fit the law of `start`

    Raises ValueError with a one-line message for a bad file, unit or shape of the curve, a torque above
    max_torque, or a name that cannot be fitted. Raises RuntimeError if the fit does not converge.
    """
    if law == "table":
        if free:
            raise ValueError("the law table has nothing to fit; --free is allowed without --law table")
        return fit_table(path, start, rated_torque)
    record = read(path, start, rated_torque)
    line, file = record.line, record.start
    if file.law == "table":
        raise ValueError(f"{record.path}: the law table has nothing to fit; --law table makes a new table")
    names = tuple(free or (FREE if file.law != "catalogue" else drive.LEVELS["catalogue"]))
    centred = line.angle - np.interp(0.0, line.torque, line.angle)
    file = drive.scaled(file, names, line.torque, centred)
    weight = np.sqrt(line.count)
    size = float(np.ptp(line.angle))

    def offset(predicted: Array) -> float:
        return float(np.average(line.angle - predicted, weights=line.count))

    def miss(predicted: Array) -> Array:
        return np.asarray(weight * (line.angle - predicted - offset(predicted)) / size)

    angles = model(file, lambda joint: drive.windup(joint, line.torque))
    solution = solve(
        unknowns(file, names, drive.bounds(file)), lambda values: miss(angles(values)), nuisances=1
    )
    result = fitted(file, solution.values, "calibration", record.path.name, span(line))
    return outcome(record, result, solution, offset(angles(solution.values)), solution.noise * size)


def read(path: str | Path, start: ParameterFile | None, rated_torque: float | None) -> Record:
    """Read the midline of a file and prepare the start parameters. Raises ValueError as `fit`."""
    table = columns.read(path, COLUMNS, LEAST, OTHERS)
    torque, angle = (table.require(name, COLUMNS) for name in COLUMNS)
    try:
        line = loop.backbone(torque, angle)
    except ValueError as error:
        raise ValueError(f"{table.path}: {error}") from None
    start_file = start or default("harmonic_drive")
    file = _sized(start_file, line.torque, rated_torque, table.path)
    _check_size(line, file, table)
    size = start_file.values.rated_torque / file.values.rated_torque
    expected = float(np.ptp(drive.windup(start_file.values, size * line.torque)))
    HEADS.check_level(table.path, expected / float(np.ptp(line.angle)), table.units, start_file)
    return Record(table.path, line, file)


def span(line: loop.Backbone) -> str:
    """Text with the range of torques."""
    return f"torque {line.torque[0]:.4g} to {line.torque[-1]:.4g} N.m"


def outcome(
    record: Record, result: ParameterFile, solution: Solution, shift: float, noise: float
) -> FitResult:
    """Result of a fit with facts, picture and notes.

    offset : [rad] angle at zero torque
    noise  : [rad] standard deviation of one sample
    """
    line = record.line
    residuals = line.angle - drive.windup(result.values, line.torque) - shift
    grid = np.linspace(line.torque[0], line.torque[-1], 400)
    picture = Picture(
        x=line.torque,
        y=(line.angle - shift) / ARCMIN,
        misfit=residuals / ARCMIN,
        line=(grid, drive.windup(result.values, grid) / ARCMIN),
        labels=("torque [N.m]", "wind-up [arcmin]", "data - law [arcmin]"),
    )
    return FitResult(
        result, solution, _facts(line, shift, residuals, noise), [picture], notes=_notes(line, residuals)
    )


def _sized(start: ParameterFile, torque: Array, rated: float | None, path: Path) -> ParameterFile:
    """Start parameters for a drive of the stated rated torque [N.m].

    Raises Refusal if the measured torque (n) [N.m] exceeds max_torque of the law.
    """
    drive_, reach = start.values, float(np.max(np.abs(torque)))
    if rated is not None:
        factor = drive_.reach / drive_.rated_torque
        start = drive.resized(start, rated, factor, "user", "stated with the torque-angle curve")
    if isinstance(start.values, PairDrive) and reach > start.values.max_torque:
        raise Refusal(
            f"{path}: torque reaches {reach:g} N.m, beyond max_torque = {start.values.max_torque:g} N.m of "
            f"{start.name}: state the drive's rated torque, max_torque is scaled with it",
            "rated_torque",
        )
    return start


def _check_size(line: loop.Backbone, start: ParameterFile, table: columns.Columns) -> None:
    """Check wind-up and loop energy before the fit.

    Raises Refusal for a wind-up that is implausible for this size, ValueError for a loop that creates energy.
    """
    angle_range, torque_range = float(np.ptp(line.angle)), float(np.ptp(line.torque))
    rated = start.values.rated_torque
    low, high = drive.WINDUP
    path, at_rated = table.path, angle_range * rated / torque_range
    if not low <= at_rated <= high:
        typical = float(np.sqrt(low * high))
        raise Refusal(
            f"{path}: the angle turns {angle_range:.3g} rad over {torque_range:.3g} N.m, that is "
            f"{at_rated:.3g} rad at the rated torque {rated:g} N.m, allowed are {low:g} to {high:g}: "
            f"{HEADS.likely_unit(typical / at_rated, table.units)}, or state the drive's rated torque",
            "rated_torque",
        )
    if line.loop_area is not None:
        area, deviation = line.loop_area
        if area < -max(3.0 * deviation, CREATED * torque_range * angle_range):
            raise ValueError(
                f"{path}: the loop creates energy, loop_area = {area:.3g} J, expected is 0 or more: the "
                "angle has to lag behind the torque; reverse the order of the rows if they run back in time"
            )


def _facts(line: loop.Backbone, shift: float, rest: Array, noise: float) -> Facts:
    """Facts about the measured curve: offset, loop area, backlash, drift, noise, largest error."""
    facts = {
        "points": (float(np.sum(line.count)), "1", "samples used"),
        "branches": (float(line.branches), "1", "branches used"),
        "offset": (shift, "rad", "angle at zero torque, taken off"),
    }
    texts = {
        "loop_area": ("J", "dissipated per loop"),
        "backlash": ("rad", "angle between the branches at zero torque"),
        "drift": ("rad", "drift of the angle over the record, taken off"),
    }
    for name, (unit, text) in texts.items():
        if (value := getattr(line, name)) is not None:
            facts[name] = (value[0], unit, text)
            facts[f"{name}_deviation"] = (value[1], unit, "its standard deviation")
    facts["noise"] = (noise, "rad", "standard deviation of one sample about the fitted law")
    facts["largest_misfit"] = (float(np.max(np.abs(rest))), "rad", "of the mid-line from the fitted law")
    return facts


def _notes(line: loop.Backbone, rest: Array) -> list[str]:
    """Notes about quantities that the curve does not determine, and about systematic errors of the law."""
    notes = []
    if line.loop_area is None:
        notes.append("one direction of loading only: loop area, backlash and drift cannot be told")
    elif line.drift is None:
        notes.append("a single loop that is not closed: a drift cannot be told from the loop")
    return notes + systematic(rest, "curve")


MOST, FEWEST = 24, 4
"""Largest and smallest number of points of a table; noise reduces it until the torques and angles ascend."""
CROWDING = 1.5
"""Exponent of the spacing of the points [1]; above 1 they are closer near zero torque."""


def fit_table(
    path: str | Path, start: ParameterFile | None = None, rated_torque: float | None = None
) -> FitResult:
    """Make a drive with the law `table` from a file with the columns torque and angle, read as in `fit`.

    The law is odd: values at negative torques are averaged with those at positive torques.

    Raises ValueError as `fit`, and for a curve that does not include zero torque or does not rise.
    """
    record = read(path, start, rated_torque)
    line, start_file = record.line, record.start
    try:
        torque, angle, offset = points(line)
    except ValueError as error:
        raise ValueError(f"{record.path}: {error}") from None
    name, values = record.path.name, dict[str, Any]()
    values["table.torque"] = tuple(torque.tolist())
    values["table.angle"] = tuple(angle.tolist())
    table = {label: Printed(column, "calibration", name) for label, column in values.items()}
    file = drive.with_law(start_file, TableDrive, name, table)
    file = replace(fitted(file, values, "calibration", name, span(line)), name=name)
    residuals = line.angle - offset - drive.windup(file.values, line.torque)
    noise = float(np.sqrt(np.average(line.count * residuals**2)))
    return outcome(record, file, NOTHING, offset, noise)


def points(line: loop.Backbone) -> tuple[Array, Array, float]:
    """Torques (n) [N.m] and angles (n) [rad] of a table, and the offset [rad]: the angle at zero torque.

    Raises ValueError if the midline does not include zero torque or does not rise.
    """
    low, high = line.torque[0], line.torque[-1]
    if low * high > 0.0 and min(abs(low), abs(high)) > 0.05 * (high - low):
        raise ValueError(f"the torque goes from {low:.4g} to {high:.4g} N.m; a table needs it to pass zero")
    common_torques = np.linspace(0.0, max(min(-low, high), 0.0), 41)
    offset = float(
        np.mean([np.interp(sign * common_torques, line.torque, line.angle) for sign in (-1.0, 1.0)])
    )
    size, angle = np.abs(line.torque), np.sign(line.torque) * (line.angle - offset)
    for count in range(MOST, FEWEST - 1, -1):
        edges = size.max() * np.linspace(0.0, 1.0, count + 1) ** CROWDING
        bin_index = np.clip(np.searchsorted(edges, size, side="left") - 1, 0, count - 1)
        weight = np.bincount(bin_index, line.count, count)
        is_filled = weight > 0.0
        means = [
            np.bincount(bin_index, line.count * x, count)[is_filled] / weight[is_filled]
            for x in (size, angle)
        ]
        if all(x[0] > 0.0 and np.all(np.diff(x) > 0.0) for x in means):
            return means[0], means[1], offset
    raise ValueError(f"the mid-line does not rise from one of {FEWEST} points to the next")
