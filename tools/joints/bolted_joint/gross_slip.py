"""Gross slip, loss factor and opening load of a bolted joint, over the ranges of its friction and preload."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import (
    preload_at_temperature,
    slip_force,
    superposed_pressure,
    with_rigid_members,
    working_preload,
)
from jointfmu.parameters import ParameterFile

PRELOAD_ENTRY_NAME = "inputs.preload"
"""Entry of the preload in a parameter file."""
REPORTED_SHEAR_OVER_SLIP_FORCE = 0.1
"""Shear force over the gross-slip force [1] at which the loss factor is reported."""


class FrictionResult(NamedTuple):
    """Gross-slip force and loss factor of a bolted joint for one friction coefficient.

    friction_coefficient : friction coefficient [1]
    slip_force           : shear force [N] of gross slip
    loss_factor          : [1] of a loop with a given amplitude of the shear force
    """

    friction_coefficient: float
    slip_force: float
    loss_factor: float


def compute_friction_results(
    parameter_file: ParameterFile, preload: float
) -> tuple[float, list[FrictionResult]]:
    """Compute gross-slip force and loss factor at a preload [N], for the friction coefficient and its range.

    Returns the amplitude [N] of the shear force, then one FrictionResult per mu. The loss factors are those
    of the interface between rigid sides, all at this amplitude.
    """
    joint = with_rigid_members(parameter_file.values)
    remaining_preload = float(working_preload(joint, preload))
    shear = REPORTED_SHEAR_OVER_SLIP_FORCE * float(slip_force(joint, remaining_preload))
    rows = []
    for mu in (joint.mu, *parameter_file.ranges.get("mu", ())):
        other = replace(joint, mu=mu)
        loss = loss_factor(BoltedJointSpring.from_joint(other), remaining_preload, shear)
        rows.append(FrictionResult(mu, float(slip_force(other, remaining_preload)), loss))
    return shear, rows


def loss_factor(joint_spring: BoltedJointSpring, remaining_preload: float, shear_amplitude: float) -> float:
    """Loss factor [1]: dissipated energy over 2 pi times the stored energy, in a loop of the shear force.

    remaining_preload : [N] of each bolt after embedding; without a moment
    shear_amplitude   : amplitude [N] of the shear force
    """
    joint, shape = joint_spring.joint, joint_spring.patches
    law, mean = joint_spring.friction_law.foundation(), remaining_preload * joint.n_bolts / joint.A_0
    approach = joint_spring.curve.inverse(
        superposed_pressure(shape.preload_pressure_ratio, shape.moment_pressure_ratio, mean, 0.0)
    )
    low, size = 0.0, float(np.max(approach - joint_spring.curve.displacement[0]))
    size *= law.friction_coefficient / law.stiffness_ratio
    for _ in range(12):  # each reduces the interval to 1/32, down to round-off
        sizes = np.linspace(low, size, 33)
        carried = joint.A_0 * law.virgin_traction(approach, sizes[:, None]) @ shape.area_share
        k = int(np.searchsorted(carried[1:-1], shear_amplitude))
        low, size = float(sizes[k]), float(sizes[k + 1])
    lost, stored = (
        float(shape.area_share @ each) for each in law.cycle_energies(approach, np.full(approach.size, size))
    )
    return lost / (2.0 * np.pi * stored)


class PreloadResult(NamedTuple):
    """Results of the tightened joint at one preload.

    preload      : preload of each bolt at tightening [N]
    K_zz, K_xx   : stiffness of the joint along z and x [N/m]
    slip_force   : shear force [N] of gross slip
    opening_load : force [N] along z that opens the interface around the most loaded bolt, linear estimate
    """

    preload: float
    K_zz: float
    K_xx: float
    slip_force: float
    opening_load: float


def compute_preload_results(parameter_file: ParameterFile) -> list[PreloadResult]:
    """Compute stiffness, slip force and opening load at the preload and at both ends of its range.

    The temperature is its start value. A preload that embedding and temperature take completely is left out.
    """
    joint = parameter_file.values
    spring = BoltedJointSpring.from_joint(joint)
    rows = []
    preloads = (parameter_file.start_value("preload"), *parameter_file.ranges.get(PRELOAD_ENTRY_NAME, ()))
    for preload in preloads:
        warm_preload = preload_at_temperature(joint, preload, parameter_file.start_value("temperature"))
        remaining_preload = float(working_preload(joint, warm_preload))
        if remaining_preload <= 0.0:
            continue
        compliances = spring.compliances(warm_preload)
        stiffness = 1.0 / compliances.total_compliance
        rows.append(
            PreloadResult(
                preload,
                float(stiffness[2]),
                float(stiffness[0]),
                float(slip_force(joint, remaining_preload)),
                compliances.opening_load(remaining_preload),
            )
        )
    return rows
