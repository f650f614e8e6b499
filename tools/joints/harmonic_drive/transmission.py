"""Harmonic drive between motor and link of a robot."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.joints.harmonic_drive import KIND
from jointfmu.joints.harmonic_drive.drive import KINEMATIC_ERROR_HARMONICS, DriveParameters
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ...exchange.robots.transmission import Transmission


def make_transmission(parameter_file: ParameterFile) -> Transmission:
    """Make the robot joint model `Transmission` with stiffness and friction of a harmonic drive.

    Raises ValueError if the joint of the file is not a drive.
    """
    if parameter_file.joint != KIND.name:
        raise ValueError(
            f"{parameter_file.name} is a {parameter_file.joint}, no drive of a motor; "
            f"allowed is a {KIND.name}"
        )
    drive: DriveParameters = parameter_file.values
    spring = HarmonicDriveSpring.tabulate(drive)

    def wind_up(torques: ArrayLike) -> Array:
        """Wind-ups (n) [rad] along torques (n) [N.m] from rest, with locked motor."""
        memory, found = spring.initial_history(), []
        for torque in np.asarray(torques, dtype=np.float64):
            out, memory = spring.advance_torque(torque, memory)
            found.append(float(out["phi_rel"]))
        return np.array(found)

    return Transmission(
        drive_name=parameter_file.name,
        ratio=drive.ratio,
        output_damping=drive.d,
        rated_torque=drive.rated_torque,
        max_torque=float(spring.curve.end_point[1]),
        dry_friction=drive.friction_coulomb,
        viscous_friction=drive.friction_viscous,
        static_friction=drive.friction_coulomb + drive.friction_stribeck,
        stribeck_speed=drive.stribeck_speed,
        presliding_angle=drive.presliding,
        compute_wind_up=wind_up,
        omitted_effects=tuple(_list_missing_effects(drive)),
    )


def _list_missing_effects(drive_parameters: DriveParameters) -> Iterator[str]:
    """Effects of the drive that the model `Transmission` lacks, as text."""
    if drive_parameters.load_loss or drive_parameters.effective_load_loss_back:
        loss, back = (
            share * drive_parameters.rated_torque / abs(drive_parameters.ratio)
            for share in (drive_parameters.load_loss, drive_parameters.effective_load_loss_back)
        )
        yield (
            "friction that grows with the load: at rated torque "
            f"{loss:.4g} N.m at the motor if the motor drives the load, {back:.4g} N.m if the load drives "
            "the motor"
        )
    if drive_parameters.friction_coulomb or drive_parameters.friction_viscous:
        yield "the temperature of the lubricant: friction is that at 20 degrees C"
    if ripple := drive_parameters.friction_1 + drive_parameters.friction_2:
        yield f"the friction over the turn of the motor, up to {ripple:.3g} N.m"
    error = sum(abs(getattr(drive_parameters, f"error_{n}")) for n in KINEMATIC_ERROR_HARMONICS)
    if error:
        yield f"the kinematic error, up to {error:.3g} rad"
