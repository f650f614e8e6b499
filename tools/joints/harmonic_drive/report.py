"""What the page of a user's drive shows of its friction: efficiency, starting and back-driving torque."""

import math

import numpy as np

from jointfmu.joints.harmonic_drive.friction import REFERENCE, Friction, limits, viscous
from jointfmu.parameters import ParameterFile

from ...report.course import Course
from ...report.figure import Figure, Panel, Series
from .beside import beside
from .efficiency import spring_bench

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
        "error, up to the rated torque; speeds are those of the motor."
    )
    over_load = Panel("Efficiency", "load [N m]", "efficiency", series)
    return [Figure(title, text, [over_load]), _over_speed(file)]


def _over_speed(file: ParameterFile) -> Figure:
    """Friction of the drive without load over the motor's speed, at three temperatures."""
    drive, rpm = file.values, np.linspace(0.0, max(SPEEDS), _LOADS)
    w1 = rpm * math.pi / 30.0
    series = [
        Series(
            f"{kelvin - 273.15:g} degrees C",
            rpm,
            np.asarray(limits(drive, w1, 0.0, kelvin)[0] + viscous(drive, w1, kelvin)),
        )
        for kelvin in KELVIN
    ]
    told = [
        f"{name} = {file.flat[name]:g} 1/K ({file.sources.get(name, 'default choice')})"
        for name in ("viscous_temperature_coefficient", "dry_temperature_coefficient")
    ]
    text = (
        "Torque that turns the wave generator without load, over the motor's speed. The parameters hold at "
        f"{REFERENCE - 273.15:g} degrees C; other temperatures follow from {' and '.join(told)}."
    )
    panel = Panel("Friction over speed", "speed of the motor [rev/min]", "torque [N m]", series)
    return Figure("Friction over speed and temperature", text, [panel])


FIGURES = {"HarmonicDriveSpring": friction}
BESIDE = {"HarmonicDriveSpring": beside}
