"""Bolt forces of a joint with elastic sides under a tensile force along z, free in its other five motions."""

import numpy as np

from jointfmu.joints.bolted_joint.contact import STICKS
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.quantity import Array

CLOSE = 1e-10
"""Work of a Newton correction over the work of the external force [1] that counts as equilibrium."""
STEPS, PARTS = 100, 8
"""Newton iterations at one force, and trial lengths in each iteration."""
LEAST_SHIFT, LEAST = 1e-12, 1e-6
"""Tangential displacement of a patch [m] that avoids a division by zero, and stiffness of open patches and
points over the largest stiffness at tightening [1]: it keeps the matrix of an open joint regular."""
MOST = 2.0
"""Bolt force over the force at tightening [1] at which the calculation ends."""


def bolt_forces(spring: BoltedJointSpring, preload: float, moment: float, pulls: Array) -> Array:
    """Bolt forces (m, bolts) [N] under the first m of increasing tensile forces (n) [N].

    Static equilibrium from the tightened state,

        K z + E^T (B - B_tightened) - G^T A (p - p_tightened) = F.

    z: relative displacement and modal coordinates; B: bolt forces; E: elongation of the bolts; G: derivative
    of the opening of the points; A: areas; p: contact pressure. K: stiffness of modes and patches, with the
    secant stiffness of the patches from the iteration before. Ends at the first force at which a bolt exceeds
    MAX_BOLT_FORCE_RATIO, or at which the iteration does not converge.
    """
    whole, modes, law = spring.whole, spring.modes, spring.foundation()
    start = spring.tightened(preload, moment)
    z, bolts = np.zeros(6 + len(modes.stiffness)), spring.bolts
    tension = bolts.tightened(spring.joint, preload, moment)
    G, E = (np.zeros((len(rows), len(z))) for rows in (start, tension))
    G[:, 2:5], G[:, 6:] = whole.points, modes.opening
    E[:, 2:5], E[:, 6:] = whole.seats, modes.stretch
    preload_pressure, preload_stiffness = spring.curve.derivatives(start, 1)
    min_stiffness, results = LEAST * law.stick(spring.pressed(start)).max(), []

    def left(z: Array, K: Array, pull: float) -> Array:
        p = spring.curve.derivatives(start - G @ z, 0)[0]
        contact = G.T @ (whole.weight * (p - preload_pressure))
        inside = E.T @ (bolts.force(tension, E @ z) - tension) - contact
        return np.asarray(K @ z + inside - pull * (np.arange(len(z)) == 2))

    for pull in pulls:
        for _ in range(STEPS):
            approach = start - G @ z
            shift = np.linalg.norm(spring.shift(z[[0, 1, 5]], z[6:]), axis=1) + LEAST_SHIFT
            stick = np.maximum(law.backbone(spring.pressed(approach), shift) / shift, min_stiffness)
            K = whole.slope(np.zeros_like(start), stick[:, None] * STICKS, np.zeros_like(tension))
            stiffness = spring.curve.derivatives(approach, 1)[1]
            normal = np.maximum(stiffness, LEAST * preload_stiffness.max()) * whole.weight
            r = left(z, K, pull)
            pulling = bolts.tangent(tension, E @ z)[:, None]
            step = -np.linalg.solve(K + E.T @ (pulling * E) + G.T @ (normal[:, None] * G), r)
            energy_slope_0, size = float(r @ step), 1.0
            if -energy_slope_0 <= CLOSE * pull * abs(z[2]):
                break
            for _ in range(PARTS):
                energy_slope_1 = float(left(z + size * step, K, pull) @ step)
                if energy_slope_1 <= 0.5 * abs(energy_slope_0):
                    break
                size *= max(energy_slope_0 / (energy_slope_0 - energy_slope_1), 0.1)
            z = z + size * step
        else:
            break
        forces = bolts.force(tension, E @ z)
        if np.any(forces > MOST * tension):
            break
        results.append(forces)
    return np.array(results)
