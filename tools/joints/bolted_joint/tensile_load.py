"""Bolt forces of a joint with elastic sides under a tensile force along z, free in its other five motions."""

import numpy as np

from jointfmu.joints.bolted_joint.friction import FULL_STICK_TANGENT_OVER_STIFFNESS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.quantity import Array

RELATIVE_WORK_TOLERANCE = 1e-10
"""Work of a Newton correction over the work of the external force [1] that counts as equilibrium."""
MAX_NEWTON_ITERATIONS, MAX_LINE_SEARCH_TRIALS = 100, 8
"""Newton iterations at one force, and trial lengths in each iteration."""
MIN_TANGENTIAL_DISPLACEMENT, OPEN_CONTACT_OVER_MAX_STIFFNESS = 1e-12, 1e-6
"""Tangential displacement of a patch [m] that avoids a division by zero, and stiffness of open patches and
points over the largest stiffness at tightening [1]: it keeps the matrix of an open joint regular."""
MAX_BOLT_OVER_TIGHTENING_FORCE = 2.0
"""Bolt force over the force at tightening [1] at which the calculation ends."""


def compute_bolt_forces(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float, tensile_forces: Array
) -> Array:
    """Bolt forces (m, bolts) [N] under the first m of increasing tensile forces (n) [N].

    Static equilibrium from the tightened state,

        K z + E^T (B - B_tightened) - G^T A (p - p_tightened) = F.

    z: relative displacement and modal coordinates; B: bolt forces; E: elongation of the bolts; G: derivative
    of the opening of the points; A: areas; p: contact pressure. K: stiffness of modes and patches, with the
    secant stiffness of the patches from the iteration before. Ends at the first force at which a bolt exceeds
    MAX_BOLT_OVER_TIGHTENING_FORCE, or at which the iteration does not converge.
    """
    whole, modes, law = joint_spring.assembly, joint_spring.modes, joint_spring.friction_law.foundation()
    start = joint_spring.preloaded_approach(preload, bending_moment)
    z, bolts = np.zeros(6 + len(modes.modal_stiffness)), joint_spring.bolts
    tension = bolts.preload_force(joint_spring.joint, preload, bending_moment)
    G, E = whole.full_opening_jacobian, whole.full_elongation_jacobian
    preload_pressure, preload_stiffness = joint_spring.curve.derivatives(start, 1)
    min_stiffness = (
        OPEN_CONTACT_OVER_MAX_STIFFNESS
        * law.stick_stiffness(joint_spring.contact.patch_approach(start)).max()
    )
    results = []

    def equilibrium_residual(z: Array, K: Array, tensile_force: float) -> Array:
        """Unbalanced generalised forces [N, N.m] at displacements z under a tensile force [N]."""
        p = joint_spring.curve.derivatives(start - G @ z, 0)[0]
        contact = G.T @ (whole.point_area * (p - preload_pressure))
        inside = E.T @ (bolts.bolt_force(tension, E @ z) - tension) - contact
        return np.asarray(K @ z + inside - tensile_force * (np.arange(len(z)) == 2))

    for pull in tensile_forces:
        for _ in range(MAX_NEWTON_ITERATIONS):
            approach = start - G @ z
            shift = (
                np.linalg.norm(whole.tangential_displacement(z[:6], z[6:]), axis=1)
                + MIN_TANGENTIAL_DISPLACEMENT
            )
            stick = np.maximum(
                law.virgin_traction(joint_spring.contact.patch_approach(approach), shift) / shift,
                min_stiffness,
            )
            K = whole.tangent_stiffness(
                np.zeros_like(start),
                stick[:, None] * FULL_STICK_TANGENT_OVER_STIFFNESS,
                np.zeros_like(tension),
            )
            stiffness = joint_spring.curve.derivatives(approach, 1)[1]
            normal = (
                np.maximum(stiffness, OPEN_CONTACT_OVER_MAX_STIFFNESS * preload_stiffness.max())
                * whole.point_area
            )
            r = equilibrium_residual(z, K, pull)
            pulling = bolts.active_stiffness(tension, E @ z)[:, None]
            step = -np.linalg.solve(K + E.T @ (pulling * E) + G.T @ (normal[:, None] * G), r)
            energy_slope_0, size = float(r @ step), 1.0
            if -energy_slope_0 <= RELATIVE_WORK_TOLERANCE * pull * abs(z[2]):
                break
            for _ in range(MAX_LINE_SEARCH_TRIALS):
                energy_slope_1 = float(equilibrium_residual(z + size * step, K, pull) @ step)
                if energy_slope_1 <= 0.5 * abs(energy_slope_0):
                    break
                size *= max(energy_slope_0 / (energy_slope_0 - energy_slope_1), 0.1)
            z = z + size * step
        else:
            break
        forces = bolts.bolt_force(tension, E @ z)
        if np.any(forces > MAX_BOLT_OVER_TIGHTENING_FORCE * tension):
            break
        results.append(forces)
    return np.array(results)
