"""Export of a drive to robot formats: MJCF and URDF."""

from dataclasses import asdict

from . import mjcf, urdf
from .rigid_joints import JointFriction, describe_drive
from .transmission import Transmission


def format_drive(
    robot_format: str, drive: Transmission, requested_torque: float | None
) -> tuple[str, list[str], dict[str, object]]:
    """Format a drive for a robot format (MJCF, URDF); springs are fitted up to a torque.

    robot_format     : a key of FORMAT_WRITERS
    requested_torque : [N.m]; None: rated torque

    Returns the text of the file, lines on fit errors and omitted effects, and both as a JSON object (SI).

    Raises ValueError if the torque is outside the drive's table, ImportError without mujoco.
    """
    fit_torque = drive.rated_torque if requested_torque is None else requested_torque
    if not 0.0 < fit_torque <= drive.max_torque:
        raise ValueError(
            f"--torque = {fit_torque:g} N.m is outside (0, {drive.max_torque:g}] N.m of {drive.drive_name}"
        )
    text, miss, lacks = FORMAT_WRITERS[robot_format](drive, fit_torque)
    figures = asdict(JointFriction.from_drive(drive))
    lines = [
        *describe_drive(drive),
        *(miss.format_lines(fit_torque) if miss else ()),
        *(f"not included: {line}" for line in lacks),
    ]
    errors = asdict(miss) if miss else {}
    return (
        text,
        lines,
        {
            "drive": drive.drive_name,
            "torque": fit_torque,
            **errors,
            "rigid_joint": figures,
            "lacks": lacks,
        },
    )


FORMAT_WRITERS = {"mjcf": mjcf.format_mjcf, "urdf": urdf.format_urdf}
"""{format: (drive, torque [N.m]) -> text, errors of the fit (None: no springs), omitted effects}."""
