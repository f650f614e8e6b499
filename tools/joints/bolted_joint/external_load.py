"""Joint with elastic sides under one external force or moment, free in its other five motions."""

from dataclasses import dataclass

import numpy as np

from jointfmu.joints.bolted_joint.friction import FULL_STICK_TANGENT_OVER_STIFFNESS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.quantity import Array

RELATIVE_WORK_TOLERANCE = 1e-10
"""Work of a Newton correction over the work of the external load [1] that counts as equilibrium."""
MAX_NEWTON_ITERATIONS, MAX_LINE_SEARCH_TRIALS = 100, 8
"""Newton iterations at one load, and trial lengths in each iteration."""
MIN_TANGENTIAL_DISPLACEMENT, OPEN_CONTACT_OVER_MAX_STIFFNESS = 1e-12, 1e-6
"""Tangential displacement of a patch [m] that avoids a division by zero, and stiffness of open patches and
points over the largest stiffness at tightening [1]: it keeps the matrix of an open joint regular."""
MAX_BOLT_OVER_TIGHTENING_FORCE = 2.0
"""Bolt force over the force at tightening [1] at which the calculation ends."""
OPEN_PRESSURE_RATIO = 0.01
"""Pressure of a point over its pressure at tightening [1] at which it counts as open: the pressure of rough
faces falls exponentially with the opening. A point with a smaller pressure at tightening, over the mean
pressure [1], counts as open from the start."""
OPENING_MOMENT_GROWTH, OPENING_MOMENT_TOLERANCE = 1.25, 1e-3
"""Ratio of successive moments in the search of the opening moment [1], and relative tolerance of it [1]."""
MIN_OPENING_MOMENT_RATIO, MAX_OPENING_MOMENT_RATIO = 1e-2, 10.0
"""Limits of the opening moment over the force of all bolts times the largest lever arm of a point [1]."""


@dataclass(frozen=True, slots=True)
class ExternalLoad:
    """External force or moment on a tightened joint, free in its other five motions.

    joint_spring            : complete joint
    preload, bending_moment : [N] of each bolt and [N.m] at tightening
    direction               : index of the force or moment: x, y, z [N], rx, ry, rz [N.m]
    """

    joint_spring: BoltedJointSpring
    preload: float
    bending_moment: float
    direction: int

    @property
    def tightening_force(self) -> Array:
        """Force (b) [N] of the bolts at tightening."""
        spring = self.joint_spring
        return spring.bolts.preload_force(spring.joint, self.preload, self.bending_moment)

    @property
    def start_approach(self) -> Array:
        """Approach (n) [m] of the points at tightening."""
        return self.joint_spring.preloaded_approach(self.preload, self.bending_moment)

    @property
    def unloaded_state(self) -> Array:
        """Generalised displacements z (6 + k) of the tightened joint: zeros."""
        return np.zeros(6 + len(self.joint_spring.modes.modal_stiffness))

    def pressure(self, z: Array) -> Array:
        """Pressure (n) [Pa] of the points at generalised displacements z."""
        opening = self.joint_spring.assembly.full_opening_jacobian @ z
        return self.joint_spring.curve.derivatives(self.start_approach - opening, 0)[0]

    def bolt_forces(self, z: Array) -> Array:
        """Forces (b) [N] of the bolts at generalised displacements z."""
        elongation = self.joint_spring.assembly.full_elongation_jacobian @ z
        return self.joint_spring.bolts.bolt_force(self.tightening_force, elongation)

    def solve_equilibrium(self, load: float, z: Array) -> Array | None:
        """Generalised displacements in static equilibrium with a load [N, N.m]; None if not found.

            K z + E^T (B - B_tightened) - G^T A (p - p_tightened) = F.

        z: relative displacement and modal coordinates, the argument is the start of the iteration; B: bolt
        forces; E: elongation of the bolts; G: derivative of the opening of the points; A: areas; p: contact
        pressure. K: stiffness of modes and patches, with the secant stiffness of the patches from the
        iteration before.
        """
        spring, start, tension = self.joint_spring, self.start_approach, self.tightening_force
        whole, law, bolts = spring.assembly, spring.friction_law.foundation(), spring.bolts
        G, E = whole.full_opening_jacobian, whole.full_elongation_jacobian
        preload_pressure, preload_stiffness = spring.curve.derivatives(start, 1)
        min_stiffness = (
            OPEN_CONTACT_OVER_MAX_STIFFNESS * law.stick_stiffness(spring.contact.patch_approach(start)).max()
        )

        def equilibrium_residual(z: Array, K: Array) -> Array:
            """Unbalanced generalised forces [N, N.m] at displacements z."""
            p = spring.curve.derivatives(start - G @ z, 0)[0]
            contact = G.T @ (whole.point_area * (p - preload_pressure))
            inside = E.T @ (bolts.bolt_force(tension, E @ z) - tension) - contact
            return np.asarray(K @ z + inside - load * (np.arange(len(z)) == self.direction))

        for _ in range(MAX_NEWTON_ITERATIONS):
            approach = start - G @ z
            shift = (
                np.linalg.norm(whole.tangential_displacement(z[:6], z[6:]), axis=1)
                + MIN_TANGENTIAL_DISPLACEMENT
            )
            stick = np.maximum(
                law.virgin_traction(spring.contact.patch_approach(approach), shift) / shift,
                min_stiffness,
            )
            K = whole.tangent_stiffness(
                np.zeros_like(start),
                stick[:, None] * FULL_STICK_TANGENT_OVER_STIFFNESS,
                np.zeros_like(tension),
            )
            stiffness = spring.curve.derivatives(approach, 1)[1]
            normal = (
                np.maximum(stiffness, OPEN_CONTACT_OVER_MAX_STIFFNESS * preload_stiffness.max())
                * whole.point_area
            )
            r = equilibrium_residual(z, K)
            pulling = bolts.active_stiffness(tension, E @ z)[:, None]
            step = -np.linalg.solve(K + E.T @ (pulling * E) + G.T @ (normal[:, None] * G), r)
            energy_slope_0, size = float(r @ step), 1.0
            if -energy_slope_0 <= RELATIVE_WORK_TOLERANCE * abs(load * z[self.direction]):
                return z
            for _ in range(MAX_LINE_SEARCH_TRIALS):
                energy_slope_1 = float(equilibrium_residual(z + size * step, K) @ step)
                if energy_slope_1 <= 0.5 * abs(energy_slope_0):
                    break
                size *= max(energy_slope_0 / (energy_slope_0 - energy_slope_1), 0.1)
            z = z + size * step
        return None


def compute_bolt_forces(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float, tensile_forces: Array
) -> Array:
    """Bolt forces (m, bolts) [N] under the first m of increasing tensile forces along z (n) [N].

    Ends before the first force at which a bolt exceeds MAX_BOLT_OVER_TIGHTENING_FORCE, or at which the
    equilibrium is not found.
    """
    load = ExternalLoad(joint_spring, preload, bending_moment, direction=2)
    state, results = load.unloaded_state, []
    for pull in tensile_forces:
        found = load.solve_equilibrium(float(pull), state)
        if found is None:
            break
        state, forces = found, load.bolt_forces(found)
        if np.any(forces > MAX_BOLT_OVER_TIGHTENING_FORCE * load.tightening_force):
            break
        results.append(forces)
    return np.array(results)


def compute_opening_moment(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float, axis: int
) -> float | None:
    """Moment [N.m] at which the first point of the contact opens, the smaller of both senses of rotation.

    A point opens when its pressure falls to OPEN_PRESSURE_RATIO of that at tightening. The moment acts about
    x (axis = 0) or y (axis = 1) on the attachments, and the other five motions are free. None if no
    equilibrium is found.

    preload, bending_moment : [N] of each bolt and [N.m] at tightening
    """
    load = ExternalLoad(joint_spring, preload, bending_moment, direction=3 + axis)
    moments = [_search_opening_moment(load, sign) for sign in (1.0, -1.0)]
    return min((moment for moment in moments if moment is not None), default=None)


def _search_opening_moment(external_moment: ExternalLoad, sign: float) -> float | None:
    """Moment [N.m] of one sense of rotation (sign) at which the first point opens, by bisection."""
    load, points = external_moment, external_moment.joint_spring.points
    tightened = load.pressure(load.unloaded_state)
    closed = tightened > OPEN_PRESSURE_RATIO * (points.area_share @ tightened)

    def is_open(state: Array) -> bool:
        """Whether a point is open that is closed at tightening."""
        return bool(np.any(load.pressure(state)[closed] <= OPEN_PRESSURE_RATIO * tightened[closed]))

    lever = np.max(np.abs(points.position[closed, 4 - load.direction]))
    limit = float(np.sum(load.tightening_force) * lever)
    low, high, state = 0.0, np.inf, load.unloaded_state
    while np.isinf(high) or high - low > OPENING_MOMENT_TOLERANCE * high:
        moment = 0.5 * (low + high)
        if np.isinf(high):
            moment = max(OPENING_MOMENT_GROWTH * low, MIN_OPENING_MOMENT_RATIO * limit)
        found = load.solve_equilibrium(sign * moment, state)
        if found is None or moment > MAX_OPENING_MOMENT_RATIO * limit:
            return None
        if is_open(found):
            high = moment
        else:
            low, state = moment, found
    return 0.5 * (low + high)
