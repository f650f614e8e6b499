"""Bolt forces of a joint with elastic sides under a tensile force along z, free in its other five motions."""

import numpy as np

from jointfmu.joints.bolted_joint.friction import STICK_TANGENT
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.quantity import Array

RELATIVE_TOLERANCE = 1e-10
"""Work of a Newton correction over the work of the external force [1] that counts as equilibrium."""
MAX_ITERATIONS, MAX_LINE_SEARCH = 100, 8
"""Newton iterations at one force, and trial lengths in each iteration."""
MIN_DISPLACEMENT, MIN_STIFFNESS_RATIO = 1e-12, 1e-6
"""Tangential displacement of a patch [m] that avoids a division by zero, and stiffness of open patches and
points over the largest stiffness at tightening [1]: it keeps the matrix of an open joint regular."""
MAX_BOLT_OVER_TIGHTENING_FORCE = 2.0
"""Bolt force over the force at tightening [1] at which the calculation ends."""


def bolt_forces(spring: BoltedJointSpring, preload: float, moment: float, tensile_forces: Array) -> Array:
    """Bolt forces (m, bolts) [N] under the first m of increasing tensile forces (n) [N].

    Static equilibrium from the tightened state,

        K z + E^T (B - B_tightened) - G^T A (p - p_tightened) = F.

    z: relative displacement and modal coordinates; B: bolt forces; E: elongation of the bolts; G: derivative
    of the opening of the points; A: areas; p: contact pressure. K: stiffness of modes and patches, with the
    secant stiffness of the patches from the iteration before. Ends at the first force at which a bolt exceeds
    MAX_BOLT_OVER_TIGHTENING_FORCE, or at which the iteration does not converge.
    """
    whole, modes, law = spring.assembly, spring.modes, spring.friction_law.foundation()
    start = spring.preloaded_approach(preload, moment)
    z, bolts = np.zeros(6 + len(modes.stiffness)), spring.bolts
    tension = bolts.preload_force(spring.joint, preload, moment)
    G, E = whole.opening_jacobian, whole.elongation_jacobian
    preload_pressure, preload_stiffness = spring.curve.derivatives(start, 1)
    min_stiffness = MIN_STIFFNESS_RATIO * law.stick_stiffness(spring.contact.patch_approach(start)).max()
    results = []

    def residual(z: Array, K: Array, tensile_force: float) -> Array:
        """Residual [N, N.m] of the static equilibrium at z, with stiffness K, under a tensile force [N]."""
        p = spring.curve.derivatives(start - G @ z, 0)[0]
        contact = G.T @ (whole.point_area * (p - preload_pressure))
        inside = E.T @ (bolts.bolt_force(tension, E @ z) - tension) - contact
        return np.asarray(K @ z + inside - tensile_force * (np.arange(len(z)) == 2))

    for pull in tensile_forces:
        for _ in range(MAX_ITERATIONS):
            approach = start - G @ z
            shift = np.linalg.norm(whole.tangential_displacement(z[:6], z[6:]), axis=1) + MIN_DISPLACEMENT
            stick = np.maximum(
                law.virgin_traction(spring.contact.patch_approach(approach), shift) / shift, min_stiffness
            )
            K = whole.tangent_stiffness(
                np.zeros_like(start), stick[:, None] * STICK_TANGENT, np.zeros_like(tension)
            )
            stiffness = spring.curve.derivatives(approach, 1)[1]
            normal = np.maximum(stiffness, MIN_STIFFNESS_RATIO * preload_stiffness.max()) * whole.point_area
            r = residual(z, K, pull)
            pulling = bolts.active_stiffness(tension, E @ z)[:, None]
            step = -np.linalg.solve(K + E.T @ (pulling * E) + G.T @ (normal[:, None] * G), r)
            energy_slope_0, size = float(r @ step), 1.0
            if -energy_slope_0 <= RELATIVE_TOLERANCE * pull * abs(z[2]):
                break
            for _ in range(MAX_LINE_SEARCH):
                energy_slope_1 = float(residual(z + size * step, K, pull) @ step)
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
