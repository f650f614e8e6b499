"""Report of a harmonic drive: figures of the friction, and comparison with catalogue values."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from jointfmu.joints.harmonic_drive.friction import REFERENCE, Friction, limits, viscous
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity.units import KELVIN_AT_ZERO

from ...catalogue import Item, Printed
from ...report.course import Course
from ...report.figure import OWN, PREDICTED, SET, Beside, Figure, Panel, Series
from .catalogue import COLUMNS, LINES, find
from .efficiency import Bench, hysteresis_loss, lost_motion, spring_bench
from .fit.drive import Row
from .friction import QUOTED, SET_BY, SPEED

SPEEDS = (500, 2000, 3500)
"""Motor speeds [rev/min] in the figure of the efficiency."""
KELVIN = (263.15, REFERENCE, 333.15)
"""Temperatures of the lubricant [K]: lower limit of catalogues, reference temperature, and a warm drive."""
_LOADS = 41
"""Points of a curve."""
_MOST = 10.0
"""End of the search for the back-driving torque over the rated torque [1]."""


def friction(course: Course) -> list[Figure]:
    """Figures of the friction: efficiency over load, starting and back-driving torque, no-load friction."""
    model, file = course.model, course.file
    drive = file.values
    title = "Friction"
    if not Friction.of(drive).acts and drive.friction_viscous == 0.0:
        return [Figure(title, "None with these parameters: the wave generator turns without loss.")]
    bench = spring_bench(model, file)
    loads = drive.rated_torque * np.linspace(0.1, 1.0, _LOADS) ** 2
    series = [
        Series(f"{rpm} rev/min", loads, [bench.efficiency(rpm * math.pi / 30.0, x) for x in loads])
        for rpm in SPEEDS
    ]
    back_driving_torque = bench.back_driving_torque(_MOST * drive.rated_torque)
    torque_text = (
        f"{back_driving_torque:.4g} N m"
        if math.isfinite(back_driving_torque)
        else f"none up to {_MOST * drive.rated_torque:g} N m"
    )
    text = (
        f"Starting torque of the motor without load: {bench.starting_torque():.4g} N m. Torque at the output "
        f"that drives the motor back: {torque_text}. Efficiency against a load, without hysteresis and "
        "kinematic error, up to the rated torque; speeds are those of the motor; the lubricant is at "
        f"{_celsius(file.start('temperature'))}."
    )
    over_load = Panel("Efficiency", "load [N m]", "efficiency", series)
    return [Figure(title, text, [over_load]), _over_speed(file)]


def _over_speed(file: ParameterFile) -> Figure:
    """Figure of the no-load friction over motor speed, at several temperatures and at that of the file."""
    drive, rpm = file.values, np.linspace(0.0, max(SPEEDS), _LOADS)
    w1 = rpm * math.pi / 30.0
    series = [
        Series(
            _celsius(kelvin),
            rpm,
            np.asarray(limits(drive, w1, 0.0, kelvin)[0] + viscous(drive, w1, kelvin)),
        )
        for kelvin in sorted({*KELVIN, file.start("temperature")})
    ]
    coefficients = [
        f"{name} = {file.flat[name]:g} 1/K ({file.sources.get(name, 'default choice')})"
        for name in ("viscous_temperature_coefficient", "dry_temperature_coefficient")
    ]
    text = (
        "Torque that turns the wave generator without load, over the motor's speed. The parameters hold at "
        f"{_celsius(REFERENCE)}; other temperatures follow from {' and '.join(coefficients)}."
    )
    panel = Panel("Friction over speed", "speed of the motor [rev/min]", "torque [N m]", series)
    return Figure("Friction over speed and temperature", text, [panel])


def _celsius(kelvin: float) -> str:
    return f"{kelvin - KELVIN_AT_ZERO:g} degrees C"


_LOOP = {"hysteresis_loss": (hysteresis_loss, OWN), "lost_motion": (lost_motion, PREDICTED)}
_UNITS = {column.name: column.unit for column in COLUMNS if column.name in QUOTED}


def beside(model: Model, file: ParameterFile) -> list[Beside]:
    """Compare a drive with all values in the catalogue; empty if the catalogue has no such drive.

    The drive is identified by the name of the file, or by the source of its ratio. Estimates are omitted,
    upper limits are included. All values hold at REFERENCE_TEMPERATURE.
    """
    item = _drive(file)
    return [] if item is None else list(_rows(model, replace(file, inputs={}), item))


def _drive(file: ParameterFile) -> Item | None:
    for name in (file.name, file.sources.get("ratio", "").partition(":")[0]):
        try:
            return find(name)
        except ValueError:
            continue
    return None


def _rows(model: Model, file: ParameterFile, item: Item) -> Iterator[Beside]:
    printed, spring = item.numbers, HarmonicDriveSpring.of(file.values)
    yield from _angles(spring, printed, SET if _stiffness_set(file, printed) else OWN)
    for column, (measured, role) in _LOOP.items():
        number = printed[column]
        yield Beside(column, "rad", number.value, number.bound, measured(spring), role, number.source)
    known = [column for column in _UNITS if column in printed and printed[column].kind != "estimate"]
    bench = spring_bench(model, file) if known else None
    for column in known:
        assert bench is not None
        number, (parameter, text) = printed[column], SET_BY[column]
        is_set = file.sources.get(parameter, "").startswith(f"{number.source}; {text}")
        role = SET if is_set else PREDICTED
        value = _turned(bench, column, printed)
        yield Beside(column, _UNITS[column], number.value, number.bound, value, role, number.source)


def _angles(spring: HarmonicDriveSpring, printed: Mapping[str, Printed], role: str) -> Iterator[Beside]:
    """Comparison of the wind-up at T1, T2, rated and peak torque: lines of the catalogue, and midline."""
    lines = {name: printed[name].value for name in LINES}
    torques = {name: printed[name] for name in ("T1", "T2", "rated_torque", "peak_torque") if name in printed}
    row = Row(**lines, rated=torques.get("rated_torque", printed["T2"]).value)
    for name, torque in torques.items():
        angle, midline_angle = float(row.angle(torque.value)), float(spring.curve.inverse(torque.value))
        label = f"wind-up at {name.replace('_', ' ')}, {torque.value:g} N m"
        yield Beside(label, "rad", angle, False, midline_angle, role, printed["K1"].source)


def _stiffness_set(file: ParameterFile, printed: Mapping[str, Printed]) -> bool:
    """Whether the stiffness in the file comes from the catalogue, directly or by a fit."""
    if "K1" in file.flat:
        return file.sources.get("K1") == printed["K1"].source
    return file.origins.get("K_FTS0") == "catalogue"


def _turned(bench: Bench, column: str, printed: Mapping[str, Printed]) -> float:
    """Computed value of a friction column: a torque [N.m] or the efficiency [1]."""
    if column == "starting_torque":
        return bench.starting_torque()
    if column == "running_torque":
        return bench.motor_torque(SPEED, 0.0)
    if column == "efficiency":
        return bench.efficiency(SPEED, printed["rated_torque"].value)
    return bench.back_driving_torque(_MOST * printed[column].value)


FIGURES = {"HarmonicDriveSpring": friction}
BESIDE = {"HarmonicDriveSpring": beside}
