"""Contact of the interface: pressure of the points, approach of the friction patches, elastic shear.

The points and the patches follow one curve of contact pressure over approach. At approach 0 the closing of
the contact ends, and the contact law begins. At a negative approach the contact is closing, or open.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...mechanics.curve import Curve
from ...mechanics.footprint.distribution import FrictionPatches, PressureDistribution
from ...quantity import Array, Number, select
from .kinematics import rigid_opening
from .law import AnyBoltedJoint, preload_pressure

TRANSFER_PRESSURE_OFFSET_OVER_MEAN = 0.01
"""Pressure over the mean pressure [1] added to all points and patches when the normal force is distributed,
so that open points and patches take part."""
SINKHORN_ITERATIONS = 100
"""Number of Sinkhorn iterations [1]: with all patches, and again with the selected patches of each point."""
MIN_FORCE_TRANSFER_SHARE, MAX_PATCHES_PER_POINT = 0.02, 8
"""Smallest share of the force of a point for a patch [1], and largest number of patches of a point [1]."""
FORCE_TRANSFER_DECIMALS = 4
"""Decimals to which the shares of `force_transfer` are rounded [1]."""
MAX_TRANSFER_SQUARE_DISTANCE_OVER_MEAN = 300.0
"""Largest square distance from a patch over the mean square distance [1]; it replaces larger ones."""


class PreloadState(NamedTuple):
    """Approach and pressure of the contact after tightening, before the sides move.

    approach, pressure : (n) [m] and (n) [Pa] of the n contact points
    patch_approach     : (m) [m] of the m friction patches
    """

    approach: Array
    pressure: Array
    patch_approach: Array


class NormalState(NamedTuple):
    """Approach, pressure and stiffness of the contact at a relative displacement of the sides.

    approach            : (n) [m] of the n contact points
    pressure, stiffness : p (n) [Pa] and dp/d(approach) (n) [Pa/m] of the points
    patch_approach      : (m) [m] of the m friction patches
    """

    approach: Array
    pressure: Array
    stiffness: Array
    patch_approach: Array


@dataclass(frozen=True)
class Contact:
    """Contact interface of a bolted joint: points carry the contact pressure, patches the friction.

    pressure_curve      : contact pressure [Pa] as a function of the approach [m]
    has_elastic_members : the patches take the normal force of the points around them. Between rigid members
                          each patch has its own pressure at tightening, and opens at its own position.
    """

    pressure_curve: Curve
    points: PressureDistribution
    patches: FrictionPatches
    has_elastic_members: bool

    @cached_property
    def pressure_transfer(self) -> Array:
        """Matrix (m, n) [1] that maps the pressures of n contact points to the pressures of m patches."""
        return pressure_transfer(self.points, self.patches)

    def patch_approach(self, point_approach: Array) -> Array:
        """Approaches (m) [m] of the m patches, from the pressures that the contact points transfer to them.
        If all points of a patch are open: the approach of the nearest point.

        point_approach : (n) [m] of the n contact points
        """
        p = self.pressure_transfer @ self.pressure_curve.derivatives(point_approach, 0)[0]
        nearest = np.max(np.where(self.pressure_transfer > 0.0, point_approach, -np.inf), axis=1)
        return np.where(
            p > 0.0, self.pressure_curve.inverse(p), np.minimum(nearest, self.pressure_curve.displacement[0])
        )

    def preloaded_approach(
        self, joint_parameters: AnyBoltedJoint, preload: float, bending_moment: float
    ) -> Array:
        """Approach (n) [m] of the points under a preload [N] of each bolt and a moment [N.m]."""
        return self.pressure_curve.inverse(
            preload_pressure(joint_parameters, self.points, preload, bending_moment)
        )

    def preload_state(
        self, joint_parameters: AnyBoltedJoint, preload: float, bending_moment: float
    ) -> PreloadState:
        """Approach and pressure of the contact before motion, under preload [N] per bolt and moment [N.m]."""
        approach = self.preloaded_approach(joint_parameters, preload, bending_moment)
        if self.has_elastic_members:
            patch_approach = self.patch_approach(approach)
        else:
            patch_approach = self.pressure_curve.inverse(
                preload_pressure(joint_parameters, self.patches, preload, bending_moment)
            )
        return PreloadState(approach, self.pressure_curve.derivatives(approach, 0)[0], patch_approach)

    def evaluate_normal(
        self, preload_state: PreloadState, relative_displacement: Array, elastic_opening: Array
    ) -> NormalState:
        """Approach and pressure of the contact at a relative displacement q (6) of the sides.

        Deformation of the members adds an opening elastic_opening (n) [m] of the points.
        """
        approach = preload_state.approach - (
            rigid_opening(self.points.position, relative_displacement) + elastic_opening
        )
        if self.has_elastic_members:
            patch_approach = self.patch_approach(approach)
        else:
            patch_approach = preload_state.patch_approach - rigid_opening(
                self.patches.position, relative_displacement
            )
        pressure, stiffness = self.pressure_curve.derivatives(approach, 1)
        return NormalState(approach, pressure, stiffness, patch_approach)


def force_transfer(contact_points: PressureDistribution, patches: FrictionPatches) -> Array:
    """Distribute the normal force of the contact points to the friction patches near them.

    Returns the share (m, n) [1] of the force of each of n points that each of m patches receives; the shares
    of a point add up to 1, except for round-off.

    Under equal bolt forces, each patch receives the normal force of its own area. The method is entropic
    optimal transport from points to patches (Sinkhorn's iteration). Its regularisation [m2] is the mean
    square distance of the force from the nearest patch.
    """
    square = np.sum((patches.position[:, None] - contact_points.position) ** 2, axis=2)
    nearest = np.min(square, axis=0)
    point_force, patch_force = (
        nodes.area_share * (nodes.preload_pressure_ratio + TRANSFER_PRESSURE_OFFSET_OVER_MEAN)
        for nodes in (contact_points, patches)
    )
    width = np.maximum(point_force @ nearest / np.sum(point_force), np.finfo(float).tiny)
    kernel = np.exp(-np.minimum((square - nearest) / width, MAX_TRANSFER_SQUARE_DISTANCE_OVER_MEAN))
    scale = np.ones_like(patch_force)
    for _ in range(2):
        for _ in range(SINKHORN_ITERATIONS):
            share = scale[:, None] * kernel
            share = share / np.sum(share, axis=0)
            scale = scale * patch_force / (share @ point_force)
        least = np.maximum(np.sort(share, axis=0)[-MAX_PATCHES_PER_POINT:][0], MIN_FORCE_TRANSFER_SHARE)
        kernel = np.where((share >= least) | (share == np.max(share, axis=1, keepdims=True)), kernel, 0.0)
    rounded = np.maximum(np.round(share, FORCE_TRANSFER_DECIMALS), 10.0**-FORCE_TRANSFER_DECIMALS)
    return np.asarray(np.where(kernel > 0.0, rounded, 0.0))


def pressure_transfer(contact_points: PressureDistribution, patches: FrictionPatches) -> Array:
    """Matrix (m, n) [1] that maps the pressures of contact points to the pressures of friction patches.

    The matrix distributes the normal forces as `force_transfer` does.
    """
    return force_transfer(contact_points, patches) * contact_points.area_share / patches.area_share[:, None]


def elastic_shear(
    friction_limit: Number,
    stiffness_ratio: Number,
    pressure_derivatives: Sequence[Number],
    u_x: Number,
    u_y: Number,
) -> tuple[Number, ...]:
    """Shear traction of a contact point without friction history, from the potential per area

        S = t u^2/(1 + R),    R = sqrt(1 + (t u/l)^2),    t = rho k.

    friction_limit       : l [Pa], mu times the pressure at tightening; the traction t u/R tends to l
    stiffness_ratio      : rho = K_T/K_N [1]
    pressure_derivatives : pressure p [Pa], and its derivatives k, k', k'' with respect to the approach
    u_x, u_y             : tangential displacement [m]; u is its magnitude

    Returns the traction along x and y [Pa], its derivatives xx, xy, yy with respect to the displacement
    [Pa/m], and what shear adds to the normal traction [Pa], rho k' u^2/(R (1 + R)) <= l^2 k'/(rho k^2), and
    to the normal stiffness [Pa/m].
    """
    _, k, d2p, d3p = pressure_derivatives
    carries, touches = friction_limit > 0.0, k > 0.0
    t, square = stiffness_ratio * k, u_x * u_x + u_y * u_y
    per = select(carries, t / select(carries, friction_limit, 1.0), 0.0 * t) ** 2
    R = np.sqrt(1.0 + per * square)
    secant, turn = select(carries, t / R, 0.0 * t), per / (R * R)
    g = select(carries, square / (R * (1.0 + R)), 0.0 * square)
    slope = -g * g * per * (1.0 + 2.0 * R) / R * select(touches, d2p / select(touches, k, 1.0), 0.0 * k)
    return (
        secant * u_x,
        secant * u_y,
        secant * (1.0 - turn * u_x * u_x),
        -secant * turn * u_x * u_y,
        secant * (1.0 - turn * u_y * u_y),
        stiffness_ratio * d2p * g,
        stiffness_ratio * (d3p * g + d2p * slope),
    )
