"""What the page of a user's drive shows of its friction: efficiency, starting and back-driving torque."""

import math

import numpy as np

from jointfmu.joints.harmonic_drive.friction import Friction
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile

from ...report.figure import Figure, Panel, Series
from .beside import beside
from .efficiency import spring_bench

SPEEDS = (500, 2000, 3500)
"""Of the motor [rev/min]."""
_LOADS = 41
_MOST = 10.0
"""Torque up to which back-driving is sought, over the rated torque [1]."""


def friction(model: Model, file: ParameterFile) -> list[Figure]:
    """Efficiency over the load at some speeds; the torques that set the drive in motion."""
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
    return [Figure(title, text, [Panel("Efficiency", "load [N m]", "efficiency", series)])]


FIGURES = {"HarmonicDriveSpring": friction}
BESIDE = {"HarmonicDriveSpring": beside}
