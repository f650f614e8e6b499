"""Joints of a robot with rigid drives: armature and friction of each motor, as values of the joint.

Robot simulators without elastic drives (Isaac Lab, Newton) take these values. The motor turns by the ratio
times the angle of the joint. So its friction torques are multiplied by the ratio, and its viscous friction
and inertia by the square of the ratio.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import PROGRAM_MARK

from .transmission import Transmission

if TYPE_CHECKING:
    from .elastic import ElasticAxis

RIGID_DRIVE_VALUE_UNITS = {
    "armature": "kg.m2",
    "static_friction": "N.m",
    "dynamic_friction": "N.m",
    "viscous_friction": "N.m.s/rad",
}
"""Units of the numbers that describe a joint with a rigid drive: {number: unit}.

The numbers are armature and friction."""


@dataclass(frozen=True, slots=True)
class JointFriction:
    """Friction of the motor of a drive at the joint.

    static_friction  : largest torque [N.m] at which the joint stays at rest
    dynamic_friction : friction torque [N.m] at speed
    viscous_friction : friction torque over joint speed [N.m.s/rad]
    """

    static_friction: float
    dynamic_friction: float
    viscous_friction: float

    @classmethod
    def from_drive(cls, drive: Transmission) -> "JointFriction":
        """Friction of the motor of a drive, seen from the output of the drive."""
        ratio = abs(drive.ratio)
        return cls(
            drive.static_friction * ratio, drive.dry_friction * ratio, drive.viscous_friction * ratio**2
        )


def rigid_drive_values(robot_axis: "ElasticAxis") -> dict[str, float]:
    """Armature and friction of a joint with a rigid drive: {name in RIGID_DRIVE_VALUE_UNITS: value}."""
    friction = JointFriction.from_drive(robot_axis.drive)
    return {
        "armature": robot_axis.rotor_inertia,
        "static_friction": friction.static_friction,
        "dynamic_friction": friction.dynamic_friction,
        "viscous_friction": friction.viscous_friction,
    }


def format_rigid_drive_values(drive_values: Mapping[str, float]) -> str:
    """Format the numbers of a joint with a rigid drive (armature, friction) as one line."""
    return ", ".join(
        f"{name.replace('_', ' ')} {value:.4g} {RIGID_DRIVE_VALUE_UNITS[name]}"
        for name, value in drive_values.items()
    )


def format_actuators(robot_axes: "Sequence[ElasticAxis]") -> str:
    """JSON text with `actuators`: {joint: arguments of Isaac Lab's ImplicitActuatorCfg}.

    In Isaac Lab, `friction` is the static friction. Since Isaac Sim 5.0, friction is a torque [N.m].
    """
    groups = {}
    for axis in robot_axes:
        figures = rigid_drive_values(axis)
        groups[axis.joint_name] = {
            "joint_names_expr": [axis.joint_name],
            "armature": figures["armature"],
            "friction": figures["static_friction"],
            "dynamic_friction": figures["dynamic_friction"],
            "viscous_friction": figures["viscous_friction"],
        }
    about = f"{PROGRAM_MARK}; units kg.m2, N.m, N.m.s/rad at the joint; Isaac Sim 5.0 or newer"
    return json.dumps({"about": about, "actuators": groups}, indent=2) + "\n"


def add_rigid_drives(robot_spec: Any, robot_axes: "Sequence[ElasticAxis]") -> Any:
    """Copy the robot, with armature and friction of the drives in its joints.

    Friction and damping of the robot file are added. `frictionloss` of MJCF is the dynamic friction.
    """
    rigid_spec = robot_spec.copy()
    for axis in robot_axes:
        figures, joint = rigid_drive_values(axis), rigid_spec.joint(axis.joint_name)
        joint.armature = figures["armature"]
        joint.frictionloss = float(joint.frictionloss) + figures["dynamic_friction"]
        damping = list(joint.damping)
        joint.damping = [damping[0] + figures["viscous_friction"], *damping[1:]]
    return rigid_spec


def describe_drive(drive: Transmission) -> Iterator[str]:
    """Lines with the values of a joint with this drive, for a motor whose inertia is not known."""
    friction = JointFriction.from_drive(drive)
    figures = {name: getattr(friction, name) for name in RIGID_DRIVE_VALUE_UNITS if name != "armature"}
    yield f"as a rigid joint: {format_rigid_drive_values(figures)}"
    yield f"  armature: {drive.ratio**2:g} times the inertia of the rotor and the wave generator"
