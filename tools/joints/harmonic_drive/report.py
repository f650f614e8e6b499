"""What a drive's page shows: its friction, and what it does beside what catalogues publish of it."""

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
"""Of the motor [rev/min]."""
KELVIN = (263.15, REFERENCE, 333.15)
"""Temperatures of the lubricant [K]: where catalogues begin, where they hold, and warm."""
_LOADS = 41
_MOST = 10.0
"""Torque up to which back-driving is sought, over the rated torque [1]."""


def friction(course: Course) -> list[Figure]:
    """Efficiency over the load at some speeds; the torques that set the drive in motion."""
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
    back = bench.back_driving_torque(_MOST * drive.rated_torque)
    moved = f"{back:.4g} N m" if math.isfinite(back) else f"none up to {_MOST * drive.rated_torque:g} N m"
    text = (
        f"Starting torque of the motor without load: {bench.starting_torque():.4g} N m. Torque at the output "
        f"that drives the motor back: {moved}. Efficiency against a load, without hysteresis and kinematic "
        "error, up to the rated torque; speeds are those of the motor; the lubricant is at "
        f"{_celsius(file.start('temperature'))}."
    )
    over_load = Panel("Efficiency", "load [N m]", "efficiency", series)
    return [Figure(title, text, [over_load]), _over_speed(file)]


def _over_speed(file: ParameterFile) -> Figure:
    """Friction of the drive without load over the motor's speed, at some temperatures and the file's own."""
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
    told = [
        f"{name} = {file.flat[name]:g} 1/K ({file.sources.get(name, 'default choice')})"
        for name in ("viscous_temperature_coefficient", "dry_temperature_coefficient")
    ]
    text = (
        "Torque that turns the wave generator without load, over the motor's speed. The parameters hold at "
        f"{_celsius(REFERENCE)}; other temperatures follow from {' and '.join(told)}."
    )
    panel = Panel("Friction over speed", "speed of the motor [rev/min]", "torque [N m]", series)
    return Figure("Friction over speed and temperature", text, [panel])


def _celsius(kelvin: float) -> str:
    return f"{kelvin - KELVIN_AT_ZERO:g} degrees C"


_LOOP = {"hysteresis_loss": (hysteresis_loss, OWN), "lost_motion": (lost_motion, PREDICTED)}
_UNITS = {column.name: column.unit for column in COLUMNS if column.name in QUOTED}


def beside(model: Model, file: ParameterFile) -> list[Beside]:
    """All that the catalogue publishes of the drive that the file is of; nothing if it has no such drive.

    A file is of the drive that it is named after, or that its ratio comes from. Estimates are left out,
    upper limits are not. Catalogues hold at REFERENCE, and so does what stands beside them.
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
        own = file.sources.get(parameter, "").startswith(f"{number.source}; {text}")
        role = SET if own else PREDICTED
        value = _turned(bench, column, printed)
        yield Beside(column, _UNITS[column], number.value, number.bound, value, role, number.source)


def _angles(spring: HarmonicDriveSpring, printed: Mapping[str, Printed], role: str) -> Iterator[Beside]:
    """Wind-up at the corners, at rated and at peak torque: of the lines, and of the midline."""
    lines = {name: printed[name].value for name in LINES}
    torques = {name: printed[name] for name in ("T1", "T2", "rated_torque", "peak_torque") if name in printed}
    row = Row(**lines, rated=torques.get("rated_torque", printed["T2"]).value)
    for name, torque in torques.items():
        angle, found = float(row.angle(torque.value)), float(spring.curve.inverse(torque.value))
        label = f"wind-up at {name.replace('_', ' ')}, {torque.value:g} N m"
        yield Beside(label, "rad", angle, False, found, role, printed["K1"].source)


def _stiffness_set(file: ParameterFile, printed: Mapping[str, Printed]) -> bool:
    """Whether the stiffness is that of the catalogue, as it stands or fitted."""
    if "K1" in file.flat:
        return file.sources.get("K1") == printed["K1"].source
    return file.origins.get("K_FTS0") == "catalogue"


def _turned(bench: Bench, column: str, printed: Mapping[str, Printed]) -> float:
    """A torque [N.m] or the efficiency [1] of the drive on the bench."""
    if column == "starting_torque":
        return bench.starting_torque()
    if column == "running_torque":
        return bench.motor_torque(SPEED, 0.0)
    if column == "efficiency":
        return bench.efficiency(SPEED, printed["rated_torque"].value)
    return bench.back_driving_torque(_MOST * printed[column].value)


FIGURES = {"HarmonicDriveSpring": friction}
BESIDE = {"HarmonicDriveSpring": beside}
