"""What catalogues quote of a drive's loop, as the exported drive has it: hysteresis loss, lost motion."""

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

LOST_MOTION = 0.04
"""Torque over rated torque [1] between which catalogues state lost motion."""


def hysteresis_loss(spring: HarmonicDriveSpring) -> float:
    """Angle [rad] between the branches at zero torque, of the loop through rated torque."""
    rated = float(spring.joint.rated_torque)
    there, back = (_wind_up(spring, (rated, sign * rated, 0.0)) for sign in (1.0, -1.0))
    return there - back


def lost_motion(spring: HarmonicDriveSpring) -> float:
    """Angle [rad] between LOST_MOTION times rated torque and its negative, midway between the branches of
    the loop through rated torque.
    """
    rated = float(spring.joint.rated_torque)
    ends = (
        0.5 * sum(_wind_up(spring, (rated, side * rated, sign * LOST_MOTION * rated)) for side in (1.0, -1.0))
        for sign in (1.0, -1.0)
    )
    there, back = ends
    return there - back


def _wind_up(spring: HarmonicDriveSpring, torques: tuple[float, ...]) -> float:
    """Wind-up [rad] at the last of the torques [N.m] that follow one another from rest."""
    memory = spring.rest()
    for torque in torques:
        out, memory = spring.loaded(torque, memory)
    return float(out["phi_rel"])
