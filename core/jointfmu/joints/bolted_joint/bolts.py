"""Bolt forces: a bolt only pulls. Where it would push, its head lifts off its bearing face.

The force of a bolt that the motion of the sides elongates by e from the tightened state is

    F = max(0, F_0 + k e) = F_0 + k (e + h),    h = max(0, -(F_0/k + e)),

F_0 its force at tightening, k its stiffness and h the gap under its head or nut. It is the derivative of a
convex potential in e. A tapped bolt keeps its thread; its head lifts off alike.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...mechanics.footprint.distribution import NodalField
from ...quantity import Array
from .law import Bolted, ElasticBodies, working_preload

LIFT_OFF_RATIO = 1e-9
"""Largest force of a bolt at lift-off, over the load at which the contact closes [1]. At lift-off the
stiffness is the mean of the values before and after. Round-off of the equilibrium is far below this force."""
AT_LIFT_OFF = 0.5
"""Stiffness of a bolt at lift-off over its full stiffness [1]. A bolt without preload is at lift-off in the
tightened state."""
ONE_ROW = 1e-6
"""Distance across the rows over the size of the bolt pattern [1] up to which bolts form one row."""


@dataclass(frozen=True)
class BoltSprings:
    """Bolts of a joint: springs between its two sides that carry tension only.

    position           : positions (b, 2) [m] of the bolts, from the centroid of the contact
    bolts_per_position : bolts at each position [1]; not 1 if `n_bolts` differs from the number of positions
    stiffness          : [N/m] of each bolt
    lift_off_force     : [N] largest force of a bolt that stands at lift-off
    """

    position: Array
    count: float
    stiffness: float
    lift_off: float

    @classmethod
    def of(cls, joint: Bolted, closure_pressure: float) -> "BoltSprings":
        """Bolt springs of a joint; closure_pressure: [Pa] at which its contact closes."""
        position = bolt_positions(joint)
        count = float(joint.n_bolts) / len(position)
        return cls(
            position, count, float(joint.bolt_stiffness), LIFT_OFF_RATIO * closure_pressure * float(joint.A_0)
        )

    @cached_property
    def lever(self) -> Array:
        """Force that a moment adds to each bolt, over the moment (b) [1/m], see `bolt_force_per_moment`."""
        return moment_lever(self.position) / self.count

    def preload_force(self, joint: Bolted, preload: float, moment: float) -> Array:
        """Force (b) [N] of each bolt at tightening: working preload and share of the moment, at least 0."""
        return np.asarray(np.maximum(working_preload(joint, preload) + moment * self.lever, 0.0))

    def gap(self, preload_force: Array, elongation: Array) -> Array:
        """Gap h (b) [m] under the heads, by bolt forces at tightening (b) [N] and elongations (b) [m]."""
        if self.stiffness == 0.0:
            return np.zeros_like(elongation)
        return np.maximum(-(preload_force + self.stiffness * elongation), 0.0) / self.stiffness

    def force(self, preload_force: Array, elongation: Array) -> Array:
        """Force F (b) [N] of each bolt, at least 0."""
        return np.maximum(preload_force + self.stiffness * elongation, 0.0)

    def tangent(self, preload_force: Array, elongation: Array) -> Array:
        """Stiffness dF/de (b) [N/m] of each bolt; at lift-off the mean of both sides."""
        force = preload_force + self.stiffness * elongation
        pulling = np.where(force > self.lift_off, 1.0, np.where(force < -self.lift_off, 0.0, AT_LIFT_OFF))
        return np.asarray(self.stiffness * pulling)


def bolt_positions(joint: Bolted) -> Array:
    """Positions (b, 2) [m] of the bolts of a joint, from the centroid of its contact.

    A nodal field without a list of bolts gets four positions with the means of x, y, ... that it states.
    """
    if isinstance(joint.bodies, ElasticBodies):
        return np.stack([joint.bodies.bolt_x, joint.bodies.bolt_y], axis=-1)
    if isinstance(joint.pattern, NodalField) and not joint.pattern.each_bolt_x:
        return _rectangle(*joint.pattern.bolt_position_means)
    return joint.pattern.bolt_positions


def moment_lever(position: Array) -> Array:
    """Force that a moment about x adds to each bolt over the moment (b) [1/m].

    It is that of `BoltedPlate.pressure_distribution`. Bolts of one row along x cannot carry a moment by their
    forces: 0.
    """
    x, y = position.T
    if np.ptp(y) <= ONE_ROW * max(float(np.ptp(x)), float(np.max(np.abs(y)))):
        return np.zeros_like(y)
    away = y - np.sum(y) / len(y)
    return np.asarray(away / float(away @ away))


def _rectangle(x: float, y: float, x2: float, y2: float, xy: float) -> Array:
    """Corners (4, 2) [m] of a parallelogram with given means of x, y, x^2, y^2 and x y.

    For one bolt, two bolts, and four bolts on a rectangle along x and y these are the bolt positions.
    """
    across = np.sqrt(max(x2 - x * x, 0.0))
    shear = (xy - x * y) / across if across > 0.0 else 0.0
    along = np.sqrt(max(y2 - y * y - shear * shear, 0.0))
    return np.array([[x + u * across, y + u * shear + v * along] for u in (-1.0, 1.0) for v in (-1.0, 1.0)])
