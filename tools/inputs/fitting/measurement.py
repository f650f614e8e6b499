"""Measurement files of joints with hysteresis: loops, free vibration or forced vibration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal
from jointfmu.quantity.units import UnitSizes, unit_sizes
from jointfmu.quantity.units import unit_size_in as measured_in

from ...common import columns
from .branches import MeasuredLoops, cut_branches
from .decay import DecayPoints, analyse_decay
from .hysteresis import ForcedResponse, FreeVibration

MIN_MEASUREMENT_ROW_COUNT = 8
"""Smallest number of rows of a measurement file [1]."""
RUN_NUMBER_COLUMN = "run"
"""Column with the number of the run, if a file holds several runs."""
COLUMN_SYNONYMS = {
    "displacement": ("x", "s", "u", "weg", "verschiebung"),
    "force": ("kraft", "load", "f"),
    "angle": ("phi", "theta", "winkel", "drehwinkel", "rotation"),
    "torque": ("tau", "moment", "drehmoment", "torsionsmoment"),
    "time": ("t", "zeit"),
    "frequency": ("freq", "frequenz", "f"),
    "damping": ("zeta", "dämpfung", "dämpfungsgrad"),
    "preload": ("vorspannkraft",),
    "stiffness": ("steifigkeit",),
}
"""{column: accepted synonyms, in lower case}."""
WRONG_UNIT_MEASURED_OVER_START_STIFFNESS = 50.0
"""Ratio [1] of measured stiffness to stiffness of the start values, or its inverse, from which a wrong unit
is assumed. Degrees read as radians give 57."""
MAX_CORRECTED_OVER_START_STIFFNESS = 5.0
"""A wrong unit counts as the explanation if, with the right unit, measured stiffness over stiffness of the
start values [1] is at most this value, and at least its inverse."""
SIMILAR_JOINT_REMEDY = "start from the parameter file of a joint of similar stiffness"
"""What to do if a measured stiffness is far from that of the start values, and its units are right."""


@dataclass(frozen=True, slots=True)
class MeasurementColumns:
    """Names and units of the columns for force (or torque) and motion (displacement or angle) of a joint.

    force_column, motion_column : names of the columns
    force_units, motion_units   : {unit: size in SI units} allowed for each, SI unit first
    """

    force_column: str
    motion_column: str
    force_units: UnitSizes
    motion_units: UnitSizes

    @property
    def column_units(self) -> Mapping[str, UnitSizes]:
        """{column: {unit: size in SI units}} of all columns that a measurement file may have."""
        return {
            self.motion_column: self.motion_units,
            self.force_column: self.force_units,
            "time": unit_sizes("s", "ms"),
            "frequency": unit_sizes("Hz", "kHz"),
            "damping": unit_sizes("1"),
            RUN_NUMBER_COLUMN: unit_sizes("1"),
        }

    @property
    def si_units(self) -> tuple[str, str]:
        """SI unit of the force and SI unit of the motion."""
        return next(iter(self.force_units)), next(iter(self.motion_units))

    def check_stiffness_ratio(
        self,
        measurement_path: Path,
        measured_over_start_stiffness: float,
        stated_units: Mapping[str, str],
        start_file: ParameterFile,
        is_force_plausible: bool = False,
        remedy: str = SIMILAR_JOINT_REMEDY,
    ) -> None:
        """Check that the measured stiffness is near the stiffness of the start values.

        measured_over_start_stiffness : measured stiffness over stiffness of the start values [1]
        stated_units                  : {column: unit in the heading}
        start_file                    : parameter file with the start values
        is_force_plausible            : whether the force at gross slip shows that the unit of the force is
                                        right
        remedy                        : what to do if the units are right

        Raises InputRefusal, with a likely unit error, if the ratio or its inverse reaches
        WRONG_UNIT_MEASURED_OVER_START_STIFFNESS.
        """
        if (
            1.0 / WRONG_UNIT_MEASURED_OVER_START_STIFFNESS
            < measured_over_start_stiffness
            < WRONG_UNIT_MEASURED_OVER_START_STIFFNESS
        ):
            return
        unit_error = self.describe_likely_unit_error(
            measured_over_start_stiffness, stated_units, is_force_plausible
        )
        raise InputRefusal(
            f"{measurement_path}: the measured stiffness is {measured_over_start_stiffness:.3g} times that "
            f"of the start values, {start_file.name}; allowed are "
            f"{1.0 / WRONG_UNIT_MEASURED_OVER_START_STIFFNESS:g} to "
            f"{WRONG_UNIT_MEASURED_OVER_START_STIFFNESS:g}: {unit_error}; if the units are right, {remedy}",
            "params",
        )

    def describe_likely_unit_error(
        self,
        measured_over_start_stiffness: float,
        stated_units: Mapping[str, str],
        is_force_plausible: bool = False,
    ) -> str:
        """Describe the unit error that best explains a wrong ratio of stiffnesses, as text.

        measured_over_start_stiffness : measured stiffness over stiffness of the start values [1]
        stated_units                  : {column: unit in the heading}
        is_force_plausible            : whether the unit of the force is known to be right

        If a wrong unit of either column explains the ratio, the text names both.
        """
        explanations = []
        for column, power, units in (
            (self.motion_column, -1.0, self.motion_units),
            (self.force_column, 1.0, self.force_units),
        ):
            if is_force_plausible and column == self.force_column:
                continue
            stated = measured_in(stated_units[column], units)
            errors = {
                unit: abs(np.log(measured_over_start_stiffness * (size / stated) ** power))
                for unit, size in units.items()
            }
            unit = min(errors, key=errors.__getitem__)
            if errors[unit] < np.log(MAX_CORRECTED_OVER_START_STIFFNESS):
                text = f"the {column} is in {unit}, where the heading says {stated_units[column]}"
                explanations.append((float(errors[unit]), text))
        if not explanations:
            columns_text = f"column {self.motion_column}" if is_force_plausible else "both columns"
            return f"check the units of {columns_text} (no usual unit explains the ratio)"
        return "likely " + ", or ".join(
            text for _, text in sorted(explanations, key=lambda item: round(item[0], 6))
        )


def read_columns(
    measurement_path: str | Path, column_names: MeasurementColumns
) -> tuple[str, columns.TableColumns]:
    """Read a measurement file: its kind, recognised by its columns, and the columns.

    kind "loops"    : columns motion, force
    kind "response" : columns motion (amplitude), force (amplitude), frequency
    kind "backbone" : columns motion (amplitude), frequency, damping
    kind "decay"    : columns motion, time

    Raises ValueError, one line, for any other set of columns.
    """
    table = columns.read_columns(
        measurement_path, column_names.column_units, MIN_MEASUREMENT_ROW_COUNT, COLUMN_SYNONYMS
    )
    table.require_column(column_names.motion_column, column_names.column_units)
    present = set(table.values_by_name)
    if {"frequency", column_names.force_column} <= present:
        return "response", table.check_positive_columns(
            (column_names.motion_column, "frequency", column_names.force_column), column_names.column_units
        )
    if {"frequency", "damping"} <= present:
        return "backbone", table.check_positive_columns(
            (column_names.motion_column, "frequency", "damping"), column_names.column_units
        )
    if "frequency" not in present and column_names.force_column in present:
        return "loops", table
    if "frequency" not in present and "time" in present:
        return "decay", table
    expected = (
        (column_names.force_column,),
        ("time",),
        ("frequency", column_names.force_column),
        ("frequency", "damping"),
    )
    raise ValueError(
        f"{table.table_path}: has {', '.join(table.values_by_name)} alone; expected "
        f"{column_names.motion_column} with {', or with '.join(' and '.join(names) for names in expected)}"
    )


def split_runs(measured_columns: columns.TableColumns) -> list[tuple[str, dict[str, Array]]]:
    """Split a table by the column `run`: (prefix of error messages, {name: column}) of each run."""
    if RUN_NUMBER_COLUMN not in measured_columns.values_by_name:
        return [("", dict(measured_columns.values_by_name))]
    run_numbers = measured_columns.values_by_name[RUN_NUMBER_COLUMN]
    result = []
    for number in dict.fromkeys(run_numbers.tolist()):
        rows = run_numbers == number
        result.append(
            (
                f"run {number:g}: ",
                {name: column[rows] for name, column in measured_columns.values_by_name.items()},
            )
        )
    return result


@dataclass(frozen=True, slots=True)
class Measurement:
    """Measurement of a joint, read from a file.

    measurement_kind : "loops", "response", "backbone" or "decay", see `read_columns`
    column_names     : names and units of the columns
    stated_units     : {column: unit in the heading}
    """

    measurement_path: Path
    measurement_kind: str
    column_names: MeasurementColumns
    measured_data: MeasuredLoops | FreeVibration | ForcedResponse
    stated_units: Mapping[str, str]

    @property
    def joint_motion(self) -> Array:
        """Motion (n) of all samples of loops; amplitudes (n) of a vibration."""
        match self.measured_data:
            case MeasuredLoops():
                return self.measured_data.joint_motion
            case FreeVibration():
                return self.measured_data.decay_points.motion_amplitude
            case ForcedResponse():
                return self.measured_data.motion_amplitude

    @property
    def largest_amplitude(self) -> float:
        """Largest amplitude of the motion; of loops, half the range of the motion."""
        return float(
            0.5 * np.ptp(self.joint_motion) if self.measurement_kind == "loops" else np.max(self.joint_motion)
        )

    @property
    def describe_amplitude(self) -> str:
        """Meaning of `largest_amplitude`, as text."""
        name = self.column_names.motion_column
        if self.measurement_kind == "loops":
            return f"half the range of the {name}"
        if self.measurement_kind == "decay":
            return f"largest mean {name} amplitude of a window of the decay"
        return f"largest {name} amplitude"

    def rest_stiffness(self, inertia: float | None) -> float:
        """Approximate stiffness [N/m or N.m/rad] at small motions.

        inertia : vibrating mass [kg] or moment of inertia [kg.m2]; not used for loops, required otherwise
        """
        if isinstance(self.measured_data, MeasuredLoops):
            return self.measured_data.rest_stiffness
        if isinstance(self.measured_data, FreeVibration):
            frequency = self.measured_data.decay_points.frequency[
                np.argmin(self.measured_data.decay_points.motion_amplitude)
            ]
        else:
            amplitude = np.where(
                self.measured_data.force_amplitude == self.measured_data.force_amplitude.min(),
                self.measured_data.motion_amplitude,
                0.0,
            )
            frequency = self.measured_data.excitation_frequency[
                np.argmax(amplitude)
            ]  # resonance at the smallest force
        assert inertia is not None
        return float(inertia * (2.0 * np.pi * frequency) ** 2)

    @property
    def describe_range(self) -> str:
        """Kind of the measurement and largest amplitude, as text."""
        amplitude = f"{self.largest_amplitude:.4g} {self.column_names.si_units[1]}"
        return f"{self.measurement_kind} up to {self.column_names.motion_column} {amplitude}"


def read_measurement(measurement_path: str | Path, column_names: MeasurementColumns) -> Measurement:
    """Read a measurement file and evaluate it; see `read_columns` for its columns.

    Raises ValueError, one line that begins with the path.
    """
    kind, table = read_columns(measurement_path, column_names)
    records = split_runs(table)
    data: MeasuredLoops | FreeVibration | ForcedResponse
    try:
        if kind == "loops":
            data = cut_branches(
                [
                    (name, run[column_names.motion_column], run[column_names.force_column])
                    for name, run in records
                ]
            )
        elif kind == "decay":
            data = FreeVibration(
                _join_decay_points(
                    [
                        analyse_decay(run["time"], run[column_names.motion_column], name)
                        for name, run in records
                    ]
                )
            )
        elif kind == "backbone":
            a, f, damping = (
                table.values_by_name[name] for name in (column_names.motion_column, "frequency", "damping")
            )
            data = FreeVibration(DecayPoints(a, f, damping, np.ones_like(f), damping))
        else:
            data = ForcedResponse(
                *(
                    table.values_by_name[name]
                    for name in ("frequency", column_names.force_column, column_names.motion_column)
                )
            )
    except ValueError as error:
        raise ValueError(f"{table.table_path}: {error}") from None
    return Measurement(table.table_path, kind, column_names, data, table.heading_units)


def _join_decay_points(decay_records: Sequence[DecayPoints]) -> DecayPoints:
    """Concatenate the decay points of several records."""
    return DecayPoints(
        *(
            np.concatenate([getattr(record, name) for record in decay_records])
            for name in DecayPoints.__dataclass_fields__
        )
    )
