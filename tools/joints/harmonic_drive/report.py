"""Report of a harmonic drive: figures of the friction, and comparison with catalogue values."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from jointfmu.joints.harmonic_drive.friction import (
    REFERENCE_TEMPERATURE,
    FrictionSliders,
    friction_limits,
    viscous_torque,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity.units import CELSIUS_ZERO_IN_KELVIN

from ...inputs.catalogue import CatalogueEntry, SourcedNumber
from ...pages.report.figure import (
    ROLE_INDEPENDENT,
    ROLE_PARAMETER_SOURCE,
    ROLE_PREDICTED,
    ComparisonRow,
    Figure,
    Panel,
    Series,
)
from ...pages.report.load_history import LoadHistory
from .catalogue import CATALOGUE_COLUMNS, STIFFNESS_COLUMN_NAMES, find_drive
from .efficiency import DriveTestRig, compute_hysteresis_loss, compute_lost_motion, make_test_rig
from .fit.drive import CatalogueRow
from .friction import CATALOGUE_MOTOR_SPEED, FRICTION_COLUMNS, PARAMETER_OF_COLUMN

CHART_MOTOR_SPEEDS = (500, 2000, 3500)
"""Motor speeds [rev/min] in the figure of the efficiency."""
CHART_LUBRICANT_TEMPERATURES = (263.15, REFERENCE_TEMPERATURE, 333.15)
"""Temperatures of the lubricant [K]: lower limit of catalogues, reference temperature, and a warm drive."""
_CURVE_POINT_COUNT = 41
"""Number of points of a plotted curve [1]."""
_MAX_BACK_DRIVING_OVER_RATED_TORQUE = 10.0
"""Torque at which the search for the back-driving torque ends, over the rated torque [1]."""


def make_friction_figures(load_history: LoadHistory) -> list[Figure]:
    """Figures of the friction: efficiency over load, starting and back-driving torque, no-load friction."""
    model, file = load_history.model, load_history.file
    drive = file.values
    title = "Friction"
    if not FrictionSliders.from_drive(drive).has_friction and drive.friction_viscous == 0.0:
        return [Figure(title, "The parameters contain no friction: the wave generator turns without loss.")]
    bench = make_test_rig(model, file)
    loads = drive.rated_torque * np.linspace(0.1, 1.0, _CURVE_POINT_COUNT) ** 2
    series = [
        Series(f"{rpm} rev/min", loads, [bench.efficiency(rpm * math.pi / 30.0, x) for x in loads])
        for rpm in CHART_MOTOR_SPEEDS
    ]
    back_driving_torque = bench.back_driving_torque(_MAX_BACK_DRIVING_OVER_RATED_TORQUE * drive.rated_torque)
    torque_text = (
        f"{back_driving_torque:.4g} N m"
        if math.isfinite(back_driving_torque)
        else f"none up to {_MAX_BACK_DRIVING_OVER_RATED_TORQUE * drive.rated_torque:g} N m"
    )
    text = (
        f"Starting torque of the motor without load: {bench.starting_torque():.4g} N m. Torque at the output "
        f"that drives the motor back: {torque_text}. Efficiency when driving a load, without hysteresis and "
        "kinematic error, up to the rated torque; speeds are those of the motor; the lubricant is at "
        f"{_format_celsius(file.start_value('temperature'))}."
    )
    over_load = Panel("Efficiency", "load [N m]", "efficiency", series)
    return [Figure(title, text, [over_load]), _make_friction_over_speed_figure(file)]


def _make_friction_over_speed_figure(parameter_file: ParameterFile) -> Figure:
    """Figure of the no-load friction over motor speed, at several temperatures and the file's temperature."""
    drive, rpm = parameter_file.values, np.linspace(0.0, max(CHART_MOTOR_SPEEDS), _CURVE_POINT_COUNT)
    w1 = rpm * math.pi / 30.0
    series = [
        Series(
            _format_celsius(kelvin),
            rpm,
            np.asarray(friction_limits(drive, w1, 0.0, kelvin)[0] + viscous_torque(drive, w1, kelvin)),
        )
        for kelvin in sorted({*CHART_LUBRICANT_TEMPERATURES, parameter_file.start_value("temperature")})
    ]
    coefficients = [
        f"{name} = {parameter_file.values_by_name[name]:g} 1/K ({parameter_file.describe_source(name)[1]})"
        for name in ("viscous_temperature_coefficient", "dry_temperature_coefficient")
    ]
    text = (
        "Torque needed to turn the wave generator without load, over the motor speed. The parameters hold "
        f"at {_format_celsius(REFERENCE_TEMPERATURE)}; other temperatures follow from "
        f"{' and '.join(coefficients)}."
    )
    panel = Panel("Friction over speed", "speed of the motor [rev/min]", "torque [N m]", series)
    return Figure("Friction over speed and temperature", text, [panel])


def _format_celsius(temperature_in_kelvin: float) -> str:
    """Format a temperature [K] in degrees Celsius."""
    return f"{temperature_in_kelvin - CELSIUS_ZERO_IN_KELVIN:g} degrees C"


_HYSTERESIS_LOOP_QUANTITIES = {
    "hysteresis_loss": (compute_hysteresis_loss, ROLE_INDEPENDENT),
    "lost_motion": (compute_lost_motion, ROLE_PREDICTED),
}
"""Quantities of the hysteresis loop in a catalogue: {column: function that computes it}."""
_FRICTION_UNITS = {
    column.column_name: column.si_unit
    for column in CATALOGUE_COLUMNS
    if column.column_name in FRICTION_COLUMNS
}
"""Units of the friction columns of a catalogue: {column: unit}."""


def compare_with_catalogue(fmu_model: Model, parameter_file: ParameterFile) -> list[ComparisonRow]:
    """Compare a drive with all values in the catalogue; empty if the catalogue has no such drive.

    The drive is identified by the name of the file, or by the source of its ratio. Estimates are omitted,
    upper limits are included. All values hold at REFERENCE_TEMPERATURE.
    """
    item = _find_catalogue_entry(parameter_file)
    return [] if item is None else list(_comparison_rows(fmu_model, replace(parameter_file, inputs={}), item))


def _find_catalogue_entry(parameter_file: ParameterFile) -> CatalogueEntry | None:
    """Catalogue entry of the drive of a parameter file; None if the catalogue has no such drive."""
    for name in (parameter_file.name, parameter_file.sources.get("ratio", "").partition(":")[0]):
        try:
            return find_drive(name)
        except ValueError:
            continue
    return None


def _comparison_rows(
    fmu_model: Model, parameter_file: ParameterFile, catalogue_entry: CatalogueEntry
) -> Iterator[ComparisonRow]:
    """Rows that compare the numbers of a catalogue entry with the computed numbers of the drive."""
    printed, spring = catalogue_entry.known_numbers, HarmonicDriveSpring.tabulate(parameter_file.values)
    yield from _wind_up_rows(
        spring,
        printed,
        ROLE_PARAMETER_SOURCE if _is_stiffness_from_catalogue(parameter_file, printed) else ROLE_INDEPENDENT,
    )
    for column, (measured, role) in _HYSTERESIS_LOOP_QUANTITIES.items():
        number = printed[column]
        yield ComparisonRow(
            column, "rad", number.si_value, number.is_upper_limit, measured(spring), role, number.value_source
        )
    known = [
        column
        for column in _FRICTION_UNITS
        if column in printed and printed[column].value_origin != "estimate"
    ]
    bench = make_test_rig(fmu_model, parameter_file) if known else None
    for column in known:
        assert bench is not None
        number, (parameter, text) = printed[column], PARAMETER_OF_COLUMN[column]
        is_set = parameter_file.sources.get(parameter, "").startswith(f"{number.value_source}; {text}")
        role = ROLE_PARAMETER_SOURCE if is_set else ROLE_PREDICTED
        value = _compute_friction_value(bench, column, printed)
        yield ComparisonRow(
            column,
            _FRICTION_UNITS[column],
            number.si_value,
            number.is_upper_limit,
            value,
            role,
            number.value_source,
        )


def _wind_up_rows(
    drive_spring: HarmonicDriveSpring, sourced_numbers: Mapping[str, SourcedNumber], comparison_role: str
) -> Iterator[ComparisonRow]:
    """Rows that compare the wind-up at T1, T2, rated and peak torque: catalogue, drive's midline."""
    lines = {name: sourced_numbers[name].si_value for name in STIFFNESS_COLUMN_NAMES}
    torques = {
        name: sourced_numbers[name]
        for name in ("T1", "T2", "rated_torque", "peak_torque")
        if name in sourced_numbers
    }
    row = CatalogueRow(**lines, rated_torque=torques.get("rated_torque", sourced_numbers["T2"]).si_value)
    for name, torque in torques.items():
        angle, midline_angle = (
            float(row.wind_up(torque.si_value)),
            float(drive_spring.curve.inverse(torque.si_value)),
        )
        label = f"wind-up at {name.replace('_', ' ')}, {torque.si_value:g} N m"
        yield ComparisonRow(
            label, "rad", angle, False, midline_angle, comparison_role, sourced_numbers["K1"].value_source
        )


def _is_stiffness_from_catalogue(
    parameter_file: ParameterFile, sourced_numbers: Mapping[str, SourcedNumber]
) -> bool:
    """Whether the stiffness in the file comes from the catalogue, directly or by a fit."""
    if "K1" in parameter_file.values_by_name:
        return parameter_file.sources.get("K1") == sourced_numbers["K1"].value_source
    return parameter_file.origins.get("K_FTS0") == "catalogue"


def _compute_friction_value(
    test_rig: DriveTestRig, friction_column: str, sourced_numbers: Mapping[str, SourcedNumber]
) -> float:
    """Computed value of a friction column: a torque [N.m] or the efficiency [1]."""
    if friction_column == "starting_torque":
        return test_rig.starting_torque()
    if friction_column == "running_torque":
        return test_rig.motor_torque(CATALOGUE_MOTOR_SPEED, 0.0)
    if friction_column == "efficiency":
        return test_rig.efficiency(CATALOGUE_MOTOR_SPEED, sourced_numbers["rated_torque"].si_value)
    return test_rig.back_driving_torque(
        _MAX_BACK_DRIVING_OVER_RATED_TORQUE * sourced_numbers[friction_column].si_value
    )


REPORT_FIGURES = {"HarmonicDriveSpring": make_friction_figures}
"""{FMU: function that makes the figures of its report}."""
CATALOGUE_COMPARISONS = {"HarmonicDriveSpring": compare_with_catalogue}
"""{FMU: function that compares the drive with its catalogue}."""
