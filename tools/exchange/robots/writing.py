"""Export of a drive to robot formats: MJCF and URDF."""

from dataclasses import asdict

from . import mjcf, urdf
from .transmission import Transmission


def write_drive(
    robot_format: str, drive: Transmission, torque: float | None
) -> tuple[str, list[str], dict[str, object]]:
    """Write a drive in a robot format, fitted up to a torque.

    robot_format : a key of FORMAT_WRITERS
    torque       : [N.m]; None: rated torque

    Returns the file text, notes on fit errors and omitted effects, and the same as values in SI units.

    Raises ValueError if the torque is outside the drive's table, ImportError without mujoco.
    """
    fit_torque = drive.rated_torque if torque is None else torque
    if not 0.0 < fit_torque <= drive.max_torque:
        raise ValueError(
            f"--torque = {fit_torque:g} N.m is outside (0, {drive.max_torque:g}] N.m of {drive.name}"
        )
    text, miss, lacks = FORMAT_WRITERS[robot_format](drive, fit_torque)
    lines = [*(miss.format_lines(fit_torque) if miss else ()), *(f"not included: {line}" for line in lacks)]
    errors = asdict(miss) if miss else {}
    return text, lines, {"drive": drive.name, "torque": fit_torque, **errors, "lacks": lacks}


FORMAT_WRITERS = {"mjcf": mjcf.format_mjcf, "urdf": urdf.format_urdf}
"""{format: (drive, torque [N.m]) -> text, errors of the fit (None: no springs), omitted effects}."""
