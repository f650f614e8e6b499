"""What the fits of the harmonic drive share: the size of the start, bounds, and the angle."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.law import PairDrive
from jointfmu.joints.harmonic_drive.spring import torque_curve
from jointfmu.parameters import ParameterFile
from jointfmu.quantity.refusal import Refusal
from jointfmu.quantity.units import Sizes, measured

from ....fitting.least_squares import Array

LEVELS: Mapping[str, tuple[str, ...]] = {
    "hu2023": ("K_FTS0", "drive_scale"),
    "catalogue": ("K1", "K2", "K3"),
}
"""{law: its stiffnesses}, the two of Eq. 46 or the lines': scaled together they scale K_WTS."""
LEAST_PRESSURE = 0.05
"""Least peak pressure without torque over that at rated torque [1] that a fit may find."""


WINDUP = (1e-5, 0.1)
"""Wind-up at rated torque [rad] that a drive may have: a hundredth to a hundred times the usual 1e-3."""


FAR = 50.0
"""Stiffness of a measurement over the start's [1], either way, from which on a wrong unit is likelier than
such a drive: less than degrees in the place of radians make, 57."""
NEAR = 5.0
"""The same [1] within which another unit explains it."""


def check_level(
    path: Path, ratio: float, units: Mapping[str, str], spec: Mapping[str, Sizes], start: ParameterFile
) -> None:
    """Refuse a measurement whose stiffness is `ratio` times the start's, if that is FAR off.

    units : of the columns torque and angle in the heading;  spec : units that they may have
    """
    if 1.0 / FAR < ratio < FAR:
        return
    raise Refusal(
        f"{path}: the stiffness is {ratio:.3g} times that of {start.name}, "
        f"allowed are {1.0 / FAR:g} to {FAR:g}: "
        f"{likely_unit(ratio, units, spec)}; if both are right, start from a drive of its size",
        "params",
    )


def likely_unit(ratio: float, units: Mapping[str, str], spec: Mapping[str, Sizes]) -> str:
    """Which unit of a column would bring a stiffness that is `ratio` times what it should be to its place."""
    found = []
    for column, power in (("angle", -1.0), ("torque", 1.0)):
        said = measured(units[column], spec[column])
        found += [(ratio * (size / said) ** power, column, unit) for unit, size in spec[column].items()]
    left, column, unit = min(found, key=lambda one: abs(np.log(one[0])))
    if not 1.0 / NEAR < left < NEAR:
        return "check the units of both columns, no usual one explains it"
    return f"likely the {column} is in {unit}, where the heading says {units[column]}"


def windup(drive: Drive, torque: Array) -> Array:
    """phi (...) [rad] at torques (...) [N.m]: exactly the exported curve."""
    return torque_curve(drive).odd_inverse(torque)


def resized(start: ParameterFile, rated: float, factor: float, kind: str, source: str) -> ParameterFile:
    """The drive with another rated torque [N.m]; max_torque = factor x rated, the smoothing in proportion.

    Raises ValueError if the torque is not positive and finite.
    """
    if not 0.0 < rated < np.inf:
        raise ValueError(f"rated torque = {rated:g} N.m is outside (0, inf): the drive's rated torque")
    drive = start.values
    file = start.with_values({"rated_torque": rated}, kind, source)
    if "max_torque" in file.flat:
        file = file.with_values({"max_torque": factor * rated}, "estimate", f"{factor:g} times rated_torque")
    if "torque_smoothing" not in file.flat:
        return file
    smoothing = drive.torque_smoothing * rated / drive.rated_torque
    return file.with_values(
        {"torque_smoothing": smoothing},
        "estimate",
        f"{smoothing / rated:.2g} of rated_torque, as in {start.name}",
    )


def scaled(start: ParameterFile, names: tuple[str, ...], torque: Array, angle: Array) -> ParameterFile:
    """The start with its stiffness brought to that of a curve, if all of its LEVELS are to be fitted."""
    ratio = float(np.sum(windup(start.values, torque) * angle) / np.sum(angle**2))
    level = {name: start.flat[name] * ratio for name in LEVELS.get(start.law, ()) if name in names}
    whole = level and len(level) == len(LEVELS[start.law])
    return start.with_values(level, "calibration", "start") if whole else start


def bounds(start: ParameterFile) -> Mapping[str, tuple[float, float]]:
    """Intervals of the pressures that keep the pair in contact without torque."""
    drive: Any = start.values
    if not isinstance(drive, PairDrive):
        return {}
    rated, loss = drive.rated_pressure, drive.pressure_loss
    least = loss + LEAST_PRESSURE * rated
    return {
        "zero_torque_pressure": (least, rated),
        "rated_pressure": (drive.zero_torque_pressure, np.inf),
        "torque_smoothing": (1e-3 * drive.rated_torque, drive.rated_torque),
    }
