"""Friction of each catalogue drive from the other drives, and of the base joint of a UR5e robot."""

import csv
from importlib.resources import files

import numpy as np
from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.friction import collect_published_friction, scale_friction
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND
from scipy.optimize import minimize_scalar

from jointfmu.joints.harmonic_drive.friction import dry_friction_factor, friction_limits, viscous_torque

DRIVES = {name: each for name, (each, _) in collect_published_friction(catalogue.list_drives()).items()}


def leave_one_out():
    """Leave each drive out: (drive, quantity, printed value, value scaled from the others [N.m or 1])."""
    for name, drive in DRIVES.items():
        law = scale_friction(
            drive.drive_size,
            drive.speed_ratio,
            tuple(other for other in DRIVES.values() if other is not drive),
        )
        yield name, "starting torque", drive.starting_torque, law.starting_torque
        if drive.running_torque is not None:
            yield (
                name,
                "rise to running torque",
                drive.running_torque - drive.starting_torque,
                law.viscous_torque,
            )
        if drive.load_loss is not None:
            yield name, "`load_loss`", drive.load_loss, law.load_loss
        if drive.load_loss_back is not None:
            yield name, "`load_loss_back`", drive.load_loss_back, law.load_loss_back


WARM = 318.15
"""Temperature [K] of the robot's joints."""
SPEEDS = (0.0, 0.5, 1.5, 3.2)
"""Speeds of the joint [rad/s]; 0: at rest."""
JOINTS = {"CSG-25-100": ("0.019", 150.0), "CSG-14-100": ("0.006", 28.0)}
"""{drive: motor drag at 20 degrees C [N.m], torque of the joint by the robot's data sheet [N.m]}."""


def robot_drive(name, drag):
    """Parameters of a catalogue drive of the robot, with the flexspline fixed."""
    options = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options)
    options |= {"catalogue": name, "fixed": "flexspline", "temperature": f"{WARM}K", "motor_drag": drag}
    return NEW_JOINT_COMMAND.make_joint(options).parameter_file.values


def motor_friction(drive):
    """Friction [N.m] at the motor at SPEEDS, without load."""
    speed = abs(drive.ratio) * np.array(SPEEDS)
    return friction_limits(drive, speed, 0.0, WARM)[0] + viscous_torque(drive, speed, WARM)


def read_reference(name):
    """Rows of a CSV file of models/reference."""
    text = (files("jointfmu_models") / "reference" / name).read_text(encoding="utf-8")
    return csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))


def measured_friction():
    """Measured friction [N.m] at the motor of the base joint at SPEEDS: mean of both directions."""
    torque = {}
    for row in read_reference("ur5e_base_joint_friction.csv"):
        speed = abs(float(row["joint_speed_rad_per_s"]))
        torque.setdefault(speed if speed >= 0.5 else 0.0, []).append(abs(float(row["motor_torque_Nm"])))
    return np.array([np.mean(torque[speed]) for speed in SPEEDS])


def fit_drag(name="CSG-25-100"):
    """Motor drag [N.m] at 20 degrees C that fits the base joint best: least squares in logarithms."""
    drive, base = robot_drive(name, "0"), measured_friction()
    bare, part = motor_friction(drive), float(dry_friction_factor(drive, WARM))

    def cost(more):
        return np.sum(np.log((bare + more * part) / base) ** 2)

    return minimize_scalar(cost, bounds=(0.0, 0.1), method="bounded").x
