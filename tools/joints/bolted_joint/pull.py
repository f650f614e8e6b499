"""A bolted joint between elastic sides under a force along z that leaves its other five motions free."""

import numpy as np

from jointfmu.joints.bolted_joint.contact import STICKS
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.quantity import Array

CLOSE = 1e-10
"""Work of a step over that of the pull [1] at which there is equilibrium."""
STEPS, PARTS = 100, 8
"""Most steps of Newton's method at a pull [1], and most parts of each that are tried."""
LEAST_SHIFT, LEAST = 1e-12, 1e-6
"""Shift of a patch [m] that counts as none, and stiffness over the greatest one of tightening [1] that open
patches keep, and open points in the derivative: a joint that is open may shift, and turn on one bolt."""
MOST = 2.0
"""Force of a bolt over that of tightening [1] beyond which nothing is told."""


def bolt_forces(spring: BoltedJointSpring, preload: float, moment: float, pulls: Array) -> Array:
    """Force (m, bolts) [N] of each bolt under the first m of growing pulls (n) [N], from the tightened state.

    Motion and amplitudes z of least energy at rest,

        K z + E^T (B - B_tightened) - G^T A (p - p_tightened) = F,

    B the forces of the bolts. K is that of modes and patches, which have the traction of a shift from rest
    over that shift, as they last were. Ends where a bolt has MOST of its force at tightening.
    """
    whole, modes, law = spring.whole, spring.modes, spring.foundation()
    start = spring.tightened(preload, moment)
    z, bolts = np.zeros(6 + len(modes.stiffness)), spring.bolts
    tension = bolts.tightened(spring.joint, preload, moment)
    G, E = (np.zeros((len(rows), len(z))) for rows in (start, tension))
    G[:, 2:5], G[:, 6:] = whole.points, modes.opening
    E[:, 2:5], E[:, 6:] = whole.seats, modes.stretch
    tight, stiff = spring.curve.derivatives(start, 1)
    least, found = LEAST * law.stick(spring.pressed(start)).max(), []

    def left(z: Array, K: Array, pull: float) -> Array:
        p = spring.curve.derivatives(start - G @ z, 0)[0]
        inside = E.T @ (bolts.force(tension, E @ z) - tension) - G.T @ (whole.weight * (p - tight))
        return np.asarray(K @ z + inside - pull * (np.arange(len(z)) == 2))

    for pull in pulls:
        for _ in range(STEPS):
            approach = start - G @ z
            shift = np.linalg.norm(spring.shift(z[[0, 1, 5]], z[6:]), axis=1) + LEAST_SHIFT
            stick = np.maximum(law.backbone(spring.pressed(approach), shift) / shift, least)
            K = whole.slope(np.zeros_like(start), stick[:, None] * STICKS, np.zeros_like(tension))
            normal = np.maximum(spring.curve.derivatives(approach, 1)[1], LEAST * stiff.max()) * whole.weight
            r = left(z, K, pull)
            pulling = bolts.tangent(tension, E @ z)[:, None]
            step = -np.linalg.solve(K + E.T @ (pulling * E) + G.T @ (normal[:, None] * G), r)
            falls, size = float(r @ step), 1.0
            if -falls <= CLOSE * pull * abs(z[2]):
                break
            for _ in range(PARTS):
                rises = float(left(z + size * step, K, pull) @ step)
                if rises <= 0.5 * abs(falls):
                    break
                size *= max(falls / (falls - rises), 0.1)
            z = z + size * step
        else:
            break
        forces = bolts.force(tension, E @ z)
        if np.any(forces > MOST * tension):
            break
        found.append(forces)
    return np.array(found)
