"""Rigid-body kinematics of the joint: opening and tangential displacement over the interface.

With elastic members, their deformation is added.

The relative displacement q (6) of side 2 from the tightened state has the components s_x, s_y, s_z [m] and
the small rotation theta_x, theta_y, theta_z [rad] about the centroid of the contact.
"""

import numpy as np

from ...mechanics.footprint.distribution import FrictionPatches, PressureDistribution
from ...quantity import Array

NORMAL_COMPONENT_INDICES, TANGENTIAL_COMPONENT_INDICES = slice(2, 5), [0, 1, 5]
"""Components of q that open the contact: s_z, theta_x, theta_y; and those along it: s_x, s_y, theta_z."""


def rigid_opening(point_positions: Array, relative_displacement: Array) -> Array:
    """Opening (n) [m] of the interface at positions (n, 2) [m], at a relative displacement q (6).

    The members are rigid.
    """
    (x, y), (s_z, theta_x, theta_y) = point_positions.T, relative_displacement[NORMAL_COMPONENT_INDICES]
    return np.asarray(s_z + theta_x * y - theta_y * x)


def opening_jacobian(point_positions: Array) -> Array:
    """Derivative (n, 6) [1, m] of the opening at positions (n, 2) [m] with respect to the displacement q."""
    J = np.zeros((len(point_positions), 6))
    J[:, 2], J[:, 3], J[:, 4] = 1.0, point_positions[:, 1], -point_positions[:, 0]
    return J


def point_displacement(contact_points: PressureDistribution, relative_displacement: Array) -> Array:
    """Tangential displacement (n, 2) [m] of contact points along x and y, for relative displacement q (6)."""
    (x, y), (s_x, s_y, theta_z) = (
        contact_points.position.T,
        relative_displacement[TANGENTIAL_COMPONENT_INDICES],
    )
    return np.stack([s_x - theta_z * y, s_y + theta_z * x], axis=-1)


def tangential_displacement(patches: FrictionPatches, relative_displacement: Array) -> Array:
    """Tangential displacement (m, 3) [m] of friction patches: along x, along y, and around their centres."""
    return np.column_stack(
        [
            point_displacement(patches, relative_displacement),
            relative_displacement[5] * patches.slider_circle_radius,
        ]
    )


def tangential_jacobian(patches: FrictionPatches) -> Array:
    """Derivative (3, m, 6) [1, m] of the tangential displacement of the patches with respect to q."""
    return np.stack([tangential_displacement(patches, unit).T for unit in np.eye(6)], axis=-1)
