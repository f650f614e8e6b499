"""Bolt forces: a bolt only pulls. Where it would push, its head lifts off its bearing face.

The force of a bolt that the motion of the sides elongates by e from the tightened state is

    F = max(0, F_0 + k e) = F_0 + k (e + h),    h = max(0, -(F_0/k + e)),

with its force F_0 at tightening, its stiffness k and the gap h under its head or nut. F is the derivative of
a convex potential in e. The same holds for a bolt in a tapped hole: its head lifts off, the thread holds.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...mechanics.footprint.distribution import NodalField
from ...quantity import Array
from .law import AnyBoltedJoint, ElasticBodies, working_preload

LIFT_OFF_FORCE_OVER_CLOSING_END_FORCE = 1e-9
"""Largest force of a bolt that counts as at lift-off, over the force of the contact at the end of its closing
[1]. At lift-off the stiffness is the mean of the values before and after. Round-off of the equilibrium is far
below this force."""
LIFT_OFF_OVER_FULL_STIFFNESS = 0.5
"""Stiffness of a bolt at lift-off over its full stiffness [1]. A bolt without preload is at lift-off in the
tightened state."""
ONE_BOLT_ROW_TOLERANCE = 1e-6
"""Distance across the rows over the size of the bolt pattern [1] up to which bolts form one row."""


@dataclass(frozen=True)
class BoltSprings:
    """Bolts of a joint: springs between its two sides that carry tension only.

    position           : positions (b, 2) [m] of the bolts, from the centroid of the contact
    bolts_per_position : bolts at each position [1]; not 1 if `n_bolts` differs from the number of positions
    stiffness          : [N/m] of each bolt
    lift_off_force     : [N] a bolt counts as just lifting off if the magnitude of its spring force F_0 + k e
                         is below this small force (preload F_0, stiffness k, elongation e)
    """

    position: Array
    bolts_per_position: float
    stiffness: float
    lift_off_force: float

    @classmethod
    def from_joint(cls, joint_parameters: AnyBoltedJoint, closing_end_pressure: float) -> "BoltSprings":
        """Make the bolt springs of a joint.

        closing_end_pressure : [Pa] contact pressure at the end of the closing of the contact; this pressure
                               times the nominal area scales `lift_off_force`
        """
        position = bolt_positions(joint_parameters)
        count = float(joint_parameters.n_bolts) / len(position)
        return cls(
            position,
            count,
            float(joint_parameters.bolt_stiffness),
            LIFT_OFF_FORCE_OVER_CLOSING_END_FORCE * closing_end_pressure * float(joint_parameters.A_0),
        )

    @cached_property
    def force_per_moment(self) -> Array:
        """Force added to each bolt per unit moment about x (b) [1/m], see `bolt_force_per_moment`."""
        return bolt_force_per_moment(self.position) / self.bolts_per_position

    def preload_force(self, joint_parameters: AnyBoltedJoint, preload: float, bending_moment: float) -> Array:
        """Force (b) [N] of each bolt in the preload state: preload after embedding, and share of a moment.

        The force is at least 0.

        preload : [N] assembly preload of each bolt
        bending_moment : [N.m] bending moment about x on the joint
        """
        return np.asarray(
            np.maximum(
                working_preload(joint_parameters, preload) + bending_moment * self.force_per_moment, 0.0
            )
        )

    def head_gap(self, preload_force: Array, bolt_elongation: Array) -> Array:
        """Gap h (b) [m] between head and member; 0 while the bolt is under tension.

        The head lifts off when the joint shortens by more than the elongation of the bolt at tightening.

        preload_force : (b) [N] force of each bolt at tightening
        bolt_elongation : (b) [m] of the clamped length since tightening
        """
        if self.stiffness == 0.0:
            return np.zeros_like(bolt_elongation)
        return np.maximum(-(preload_force + self.stiffness * bolt_elongation), 0.0) / self.stiffness

    def bolt_force(self, preload_force: Array, bolt_elongation: Array) -> Array:
        """Force F (b) [N] of each bolt, at least 0, from force at tightening (b) [N] and elongation [m]."""
        return np.maximum(preload_force + self.stiffness * bolt_elongation, 0.0)

    def active_stiffness(self, preload_force: Array, bolt_elongation: Array) -> Array:
        """Stiffness dF/de (b) [N/m] of each bolt; 0 if its head has lifted off.

        At lift-off, the result is the mean of the stiffness before and after.
        """
        force = preload_force + self.stiffness * bolt_elongation
        active_fraction = np.where(
            force > self.lift_off_force,
            1.0,
            np.where(force < -self.lift_off_force, 0.0, LIFT_OFF_OVER_FULL_STIFFNESS),
        )
        return np.asarray(self.stiffness * active_fraction)


def bolt_positions(joint_parameters: AnyBoltedJoint) -> Array:
    """Positions (b, 2) [m] of the bolts of a joint, from the centroid of its contact.

    A nodal field without a list of bolts gets four positions with the stated means of x, y, x^2, y^2 and x y.
    """
    if isinstance(joint_parameters.bodies, ElasticBodies):
        return np.stack([joint_parameters.bodies.bolt_x, joint_parameters.bodies.bolt_y], axis=-1)
    if isinstance(joint_parameters.pattern, NodalField) and not joint_parameters.pattern.each_bolt_x:
        return _equivalent_positions(*joint_parameters.pattern.bolt_position_means)
    return joint_parameters.pattern.bolt_positions


def bolt_force_per_moment(bolt_position: Array) -> Array:
    """Force added to each bolt per unit moment about x (b) [1/m].

    The moment is distributed to the bolts as in `BoltedPlate.pressure_distribution`. Bolts of one row along x
    cannot carry a moment by their forces: 0.
    """
    x, y = bolt_position.T
    if np.ptp(y) <= ONE_BOLT_ROW_TOLERANCE * max(float(np.ptp(x)), float(np.max(np.abs(y)))):
        return np.zeros_like(y)
    away = y - np.sum(y) / len(y)
    return np.asarray(away / float(away @ away))


def _equivalent_positions(
    mean_x: float, mean_y: float, mean_x2: float, mean_y2: float, mean_xy: float
) -> Array:
    """Positions (4, 2) [m] of four bolts with given means of x, y, x^2, y^2 and x y.

    The positions are the corners of a parallelogram.

    For one bolt, two bolts, and four bolts on a rectangle along x and y these are the bolt positions.
    """
    across = np.sqrt(max(mean_x2 - mean_x * mean_x, 0.0))
    shear = (mean_xy - mean_x * mean_y) / across if across > 0.0 else 0.0
    along = np.sqrt(max(mean_y2 - mean_y * mean_y - shear * shear, 0.0))
    return np.array(
        [[mean_x + u * across, mean_y + u * shear + v * along] for u in (-1.0, 1.0) for v in (-1.0, 1.0)]
    )
