"""Fit of a drive to a measured torque-angle curve, by a law or by a table of its midline (no hysteresis)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints.harmonic_drive.law import ContactPairDriveParameters
from jointfmu.joints.harmonic_drive.prescribed_midline import TableDriveParameters
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ....common import columns
from ....inputs.catalogue import SourcedNumber
from ....inputs.fitting import backbone
from ....inputs.fitting.least_squares import SOLUTION_WITHOUT_UNKNOWNS, FitSolution, solve_least_squares
from ....inputs.fitting.measurement import COLUMN_SYNONYMS
from ....inputs.fitting.outcome import (
    DerivedFitValues,
    FitPlot,
    FitResult,
    build_fitted_file,
    find_undetermined_parameters,
    make_fit_unknowns,
    make_predictor,
    note_residual_correlation,
)
from . import drive
from .drive import COLUMN_UNITS, LOOP_COLUMN_NAMES, RAD_PER_ARCMIN

DEFAULT_FITTED_PARAMETERS = ("K_FTS0", "drive_scale", "zero_torque_pressure")
"""Parameters to fit; of the law `catalogue` they are K1, K2, K3."""
MIN_CURVE_POINT_COUNT = 10
"""Required number of points of a curve."""
MAX_CREATED_ENERGY_OVER_TORQUE_ANGLE_RANGE = 0.01
"""Created energy of a loop, from noise or drift, over torque range times angle range [1] that is accepted."""


@dataclass(frozen=True, slots=True)
class MeasuredTorqueAngleCurve:
    """Measured torque-angle curve, and the parameters at which a fit to it starts.

    data_path  : measured file
    midline    : torque-angle curve without hysteresis
    start_file : start parameters; a stated rated torque scales max_torque and torque_smoothing
    """

    data_path: Path
    midline: backbone.Backbone
    start_file: ParameterFile


def fit(
    data_path: str | Path,
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    rated_torque: float | None = None,
    law: str | None = None,
) -> FitResult:
    """Fit a drive to a measured file with the columns torque and angle (COLUMN_UNITS), in measured order.

    An offset of the angle is a further unknown, which is fitted and subtracted.

    Parameters
    ----------
    start_parameters : parameters to start from; None: the default drive
    fitted_names     : names to fit; None: DEFAULT_FITTED_PARAMETERS, or K1, K2, K3 for the law `catalogue`
    rated_torque     : [N.m]; max_torque and torque_smoothing of `start_parameters` are scaled with it; None:
                       that of `start_parameters`
    law              : "table": use the midline itself as a table, without a fit; None: fit the law of
                       `start_parameters`

    Raises ValueError with a one-line message for a bad file, unit or shape of the curve, a torque above
    max_torque, or a name that cannot be fitted. Raises RuntimeError if the fit does not converge.
    """
    if law == "table":
        if fitted_names:
            raise ValueError(
                "--law table takes the measured midline and fits no parameters; leave out --free"
            )
        return make_drive_with_table_law(data_path, start_parameters, rated_torque)
    record = read_torque_angle_curve(data_path, start_parameters, rated_torque)
    line, file = record.midline, record.start_file
    if file.law == "table":
        raise ValueError(
            f"{record.data_path}: the start file has the law table, which has nothing to fit; --law table "
            "makes a new table"
        )
    names = tuple(
        fitted_names
        or (DEFAULT_FITTED_PARAMETERS if file.law != "catalogue" else drive.STIFFNESS_PARAMETERS["catalogue"])
    )
    centred = line.angle - np.interp(0.0, line.torque, line.angle)
    file = drive.scale_stiffness(file, names, line.torque, centred)
    weight = np.sqrt(line.sample_counts)
    size = float(np.ptp(line.angle))

    def mean_angle_offset(predicted_angle: Array) -> float:
        """Offset of the angle [rad] that makes the mean error zero."""
        return float(np.average(line.angle - predicted_angle, weights=line.sample_counts))

    def weighted_residuals(predicted_angle: Array) -> Array:
        """Residuals of the angle, weighted by the number of averaged samples."""
        return np.asarray(weight * (line.angle - predicted_angle - mean_angle_offset(predicted_angle)) / size)

    angles = make_predictor(file, lambda joint: drive.compute_wind_up(joint, line.torque))
    solution = solve_least_squares(
        make_fit_unknowns(file, names, drive.parameter_bounds(file)),
        lambda values: weighted_residuals(angles(values)),
        nuisance_count=1,
    )
    result = build_fitted_file(
        file,
        solution.values,
        "calibration",
        record.data_path.name,
        describe_torque_range(line),
        find_undetermined_parameters(solution),
    )
    return make_fit_result(
        record, result, solution, mean_angle_offset(angles(solution.values)), solution.noise * size
    )


def read_torque_angle_curve(
    data_path: str | Path, start_parameters: ParameterFile | None, rated_torque: float | None
) -> MeasuredTorqueAngleCurve:
    """Read a measured curve: midline (without hysteresis), start parameters at the rated torque [N.m].

    Raises ValueError for a bad file, unit or shape of the curve, or a torque above max_torque of the law.
    """
    table = columns.read_columns(data_path, COLUMN_UNITS, MIN_CURVE_POINT_COUNT, COLUMN_SYNONYMS)
    torque, angle = (table.require_column(name, COLUMN_UNITS) for name in COLUMN_UNITS)
    try:
        line = backbone.find_backbone(torque, angle)
    except ValueError as error:
        raise ValueError(f"{table.table_path}: {error}") from None
    start_file = start_parameters or load_default("harmonic_drive")
    file = _scale_start_drive_to_rated_torque(start_file, line.torque, rated_torque, table.table_path)
    _check_wind_up_and_loop_energy(line, file, table)
    size = start_file.values.rated_torque / file.values.rated_torque
    expected = float(np.ptp(drive.compute_wind_up(start_file.values, size * line.torque)))
    LOOP_COLUMN_NAMES.check_stiffness_ratio(
        table.table_path, expected / float(np.ptp(line.angle)), table.heading_units, start_file
    )
    return MeasuredTorqueAngleCurve(table.table_path, line, file)


def describe_torque_range(midline: backbone.Backbone) -> str:
    """Describe the range of torques of a measured curve, as text."""
    return f"torque {midline.torque[0]:.4g} to {midline.torque[-1]:.4g} N.m"


def make_fit_result(
    measured_curve: MeasuredTorqueAngleCurve,
    fitted_file: ParameterFile,
    fit_solution: FitSolution,
    angle_offset: float,
    angle_noise: float,
) -> FitResult:
    """Make the result of a fit: parameter file, results for the user, plot and notes.

    angle_offset : [rad] angle at zero torque
    angle_noise  : [rad] standard deviation of one sample
    """
    line = measured_curve.midline
    residuals = line.angle - drive.compute_wind_up(fitted_file.values, line.torque) - angle_offset
    grid = np.linspace(line.torque[0], line.torque[-1], 400)
    picture = FitPlot(
        measured_x=line.torque,
        measured_y=(line.angle - angle_offset) / RAD_PER_ARCMIN,
        misfit=residuals / RAD_PER_ARCMIN,
        law_curve=(grid, drive.compute_wind_up(fitted_file.values, grid) / RAD_PER_ARCMIN),
        axis_labels=("torque [N.m]", "wind-up [arcmin]", "data - law [arcmin]"),
    )
    return FitResult(
        fitted_file,
        fit_solution,
        _describe_curve(line, angle_offset, residuals, angle_noise),
        [picture],
        notes=_find_curve_notes(line, residuals),
    )


def _scale_start_drive_to_rated_torque(
    start_file: ParameterFile, measured_torques: Array, rated_torque: float | None, data_path: Path
) -> ParameterFile:
    """Scale the start parameters to a rated torque [N.m]: max_torque and torque_smoothing in proportion.

    rated_torque : None: the start parameters stay as they are
    Raises InputRefusal if the measured torque (n) [N.m] exceeds max_torque of the law.
    """
    drive_, reach = start_file.values, float(np.max(np.abs(measured_torques)))
    if rated_torque is not None:
        factor = drive_.max_table_torque / drive_.rated_torque
        start_file = drive.change_rated_torque(
            start_file, rated_torque, factor, "user", "stated with the torque-angle curve"
        )
    if isinstance(start_file.values, ContactPairDriveParameters) and reach > start_file.values.max_torque:
        raise InputRefusal(
            f"{data_path}: torque reaches {reach:g} N.m, beyond max_torque = "
            f"{start_file.values.max_torque:g} N.m of {start_file.name}: state the drive's rated torque, "
            "max_torque is scaled with it",
            "rated_torque",
        )
    return start_file


def _check_wind_up_and_loop_energy(
    midline: backbone.Backbone, start_file: ParameterFile, measured_columns: columns.TableColumns
) -> None:
    """Check wind-up and loop energy before the fit.

    Raises InputRefusal for a wind-up that is implausible for this size, ValueError for a loop that creates
    energy.
    """
    angle_range, torque_range = float(np.ptp(midline.angle)), float(np.ptp(midline.torque))
    rated = start_file.values.rated_torque
    low, high = drive.PLAUSIBLE_WIND_UP_RANGE
    path, at_rated = measured_columns.table_path, angle_range * rated / torque_range
    if not low <= at_rated <= high:
        typical = float(np.sqrt(low * high))
        units = measured_columns.heading_units
        raise InputRefusal(
            f"{path}: the angle turns {angle_range:.3g} rad over {torque_range:.3g} N.m, that is "
            f"{at_rated:.3g} rad at the rated torque {rated:g} N.m, allowed are {low:g} to {high:g}: "
            f"{LOOP_COLUMN_NAMES.describe_likely_unit_error(typical / at_rated, units)}, or state the "
            "drive's rated torque",
            "rated_torque",
        )
    if midline.loop_area is not None:
        area, deviation = midline.loop_area
        if area < -max(
            3.0 * deviation, MAX_CREATED_ENERGY_OVER_TORQUE_ANGLE_RANGE * torque_range * angle_range
        ):
            raise ValueError(
                f"{path}: the loop creates energy, loop_area = {area:.3g} J, expected 0 or more: the angle "
                "must lag behind the torque; reverse the order of the rows if their time order is reversed"
            )


def _describe_curve(
    midline: backbone.Backbone, angle_offset: float, angle_residuals: Array, angle_noise: float
) -> DerivedFitValues:
    """Describe the measured curve: offset, loop area, backlash, drift, noise, largest error."""
    facts = {
        "points": (float(np.sum(midline.sample_counts)), "1", "samples used"),
        "branches": (float(midline.branch_count), "1", "branches used"),
        "offset": (angle_offset, "rad", "angle at zero torque, taken off"),
    }
    texts = {
        "loop_area": ("J", "dissipated per loop"),
        "backlash": ("rad", "angle between the branches at zero torque"),
        "drift": ("rad", "drift of the angle over the record, taken off"),
    }
    for name, (unit, text) in texts.items():
        if (value := getattr(midline, name)) is not None:
            facts[name] = (value[0], unit, text)
            facts[f"{name}_deviation"] = (value[1], unit, "its standard deviation")
    facts["noise"] = (angle_noise, "rad", "standard deviation of one sample about the fitted law")
    facts["largest_misfit"] = (
        float(np.max(np.abs(angle_residuals))),
        "rad",
        "of the mid-line from the fitted law",
    )
    return facts


def _find_curve_notes(midline: backbone.Backbone, angle_residuals: Array) -> list[str]:
    """Notes about quantities that the curve does not determine, and about systematic errors of the law."""
    notes = []
    if midline.loop_area is None:
        notes.append(
            "the torque was applied in one direction only: loop area, backlash and drift are not determined"
        )
    elif midline.drift is None:
        notes.append("the record is a single loop that is not closed: drift and loop cannot be separated")
    return notes + note_residual_correlation(angle_residuals, "curve")


MAX_TABLE_POINT_COUNT, MIN_TABLE_POINT_COUNT = 24, 4
"""Largest and smallest number of points of a table; noise reduces it until the torques and angles ascend."""
TABLE_SPACING_EXPONENT = 1.5
"""Exponent of the spacing of the points [1]; above 1 they are closer near zero torque."""


def make_drive_with_table_law(
    data_path: str | Path, start_parameters: ParameterFile | None = None, rated_torque: float | None = None
) -> FitResult:
    """Make a drive with the law `table` from a measured file with the columns torque and angle.

    The law is odd: values at negative and at positive torques are averaged.

    Raises ValueError for a bad file or unit, and for a curve that does not include zero torque or does not
    rise.
    """
    record = read_torque_angle_curve(data_path, start_parameters, rated_torque)
    line, start_file = record.midline, record.start_file
    try:
        torque, angle, offset = make_table_points(line)
    except ValueError as error:
        raise ValueError(f"{record.data_path}: {error}") from None
    name, values = record.data_path.name, dict[str, Any]()
    values["table.torque"] = tuple(torque.tolist())
    values["table.angle"] = tuple(angle.tolist())
    table = {label: SourcedNumber(column, "calibration", name) for label, column in values.items()}
    file = drive.change_law(start_file, TableDriveParameters, name, table)
    file = replace(
        build_fitted_file(file, values, "calibration", name, describe_torque_range(line)), name=name
    )
    residuals = line.angle - offset - drive.compute_wind_up(file.values, line.torque)
    noise = float(np.sqrt(np.average(line.sample_counts * residuals**2)))
    return make_fit_result(record, file, SOLUTION_WITHOUT_UNKNOWNS, offset, noise)


def make_table_points(midline: backbone.Backbone) -> tuple[Array, Array, float]:
    """Torques (n) [N.m] and angles (n) [rad] of a measured midline, and the angle at zero torque [rad].

    The points are those of the law `table`.

    Raises ValueError if the midline does not include zero torque or does not rise.
    """
    low, high = midline.torque[0], midline.torque[-1]
    if low * high > 0.0 and min(abs(low), abs(high)) > 0.05 * (high - low):
        raise ValueError(
            f"the torque goes from {low:.4g} to {high:.4g} N.m; a table needs torques on both sides of zero"
        )
    common_torques = np.linspace(0.0, max(min(-low, high), 0.0), 41)
    offset = float(
        np.mean([np.interp(sign * common_torques, midline.torque, midline.angle) for sign in (-1.0, 1.0)])
    )
    size, angle = np.abs(midline.torque), np.sign(midline.torque) * (midline.angle - offset)
    for count in range(MAX_TABLE_POINT_COUNT, MIN_TABLE_POINT_COUNT - 1, -1):
        edges = size.max() * np.linspace(0.0, 1.0, count + 1) ** TABLE_SPACING_EXPONENT
        bin_index = np.clip(np.searchsorted(edges, size, side="left") - 1, 0, count - 1)
        weight = np.bincount(bin_index, midline.sample_counts, count)
        is_filled = weight > 0.0
        means = [
            np.bincount(bin_index, midline.sample_counts * x, count)[is_filled] / weight[is_filled]
            for x in (size, angle)
        ]
        if all(x[0] > 0.0 and np.all(np.diff(x) > 0.0) for x in means):
            return means[0], means[1], offset
    raise ValueError(
        f"the midline falls between some of {MIN_TABLE_POINT_COUNT} points; expected an angle that rises "
        "with the torque: check the columns"
    )
