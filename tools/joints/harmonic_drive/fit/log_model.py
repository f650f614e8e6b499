"""Torque of a robot's motor: friction of the drive, inertia, gravity.

    torque = friction(|ratio| dq, load, temperature) + inertia ddq + gravity/|ratio| + offset

in the sense of the joint, so that the ratio has no sign. The inertia, an offset of the current and, where it
is not measured, gravity = a cos(q) + b sin(q), are linear and eliminated; the load that the teeth carry is
gravity and, of a rotor that is known, what its inertia leaves for the arm.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.friction import REFERENCE, limits, viscous

from ....fitting.least_squares import Array
from .log_samples import Samples


@dataclass(frozen=True, slots=True)
class Linear:
    """What is linear in unknowns beside the friction.

    matrix : (n, k) torque of the motor [N.m] for each unknown
    known  : (n) torque [N.m] for the gravity that is measured
    names  : (k)
    """

    matrix: Array
    known: Array
    names: tuple[str, ...]

    @classmethod
    def of(cls, samples: Samples, ratio: float) -> "Linear":
        """Of samples; ratio > 0."""
        columns: dict[str, Array] = {}
        dynamic = samples.dynamic.astype(float)
        measured = np.isfinite(samples.gravity)
        if dynamic.any():
            columns = {"inertia": samples.ddq / ratio, "offset": dynamic}
            swung = dynamic * np.isfinite(samples.q) * ~measured
            if swung.any():
                angle = np.where(np.isfinite(samples.q), samples.q, 0.0)
                columns |= {
                    "gravity_cos": swung * np.cos(angle) / ratio,
                    "gravity_sin": swung * np.sin(angle) / ratio,
                }
        matrix = np.stack([*columns.values()], axis=1) if columns else np.zeros((samples.dq.size, 0))
        known = np.where(measured, samples.gravity, 0.0) / ratio
        return cls(matrix, known, tuple(columns))

    def found(self, rest: Array) -> Array:
        """The unknowns (k) that leave least of a torque (n)."""
        return np.asarray(np.linalg.lstsq(self.matrix, rest)[0]) if self.names else np.zeros(0)

    def load(self, samples: Samples, unknowns: Array, ratio: float, rotor: float) -> Array:
        """Torque (n) [N.m] at the joint that the teeth carry, positive where the motor holds it."""
        parts = dict(zip(self.names, unknowns.tolist(), strict=True))
        arm = max(parts.get("inertia", 0.0) - rotor * ratio**2, 0.0)
        gravity = [n for n, name in enumerate(self.names) if name.startswith("gravity")]
        swung = ratio * self.matrix[:, gravity] @ unknowns[gravity]
        return np.asarray(arm * samples.ddq + swung + ratio * self.known)


def friction(drive: Drive, dq: Array, temperature: Array, load: Array) -> Array:
    """Torque (...) [N.m] against the motion, of a drive in motion that carries loads (...) [N.m].

    dq : (...) speed of the joint [rad/s];  temperature : (...) [K], NaN: that of the parameters
    """
    forward = replace(drive, ratio=abs(drive.ratio))
    warmth = np.where(np.isfinite(temperature), temperature, REFERENCE)
    w1 = forward.ratio * dq
    positive, negative = limits(forward, w1, -load, warmth)
    return np.asarray(np.where(w1 > 0.0, positive, -negative) + viscous(forward, w1, warmth))


def filtered(drive: Drive, samples: Samples, load: Array) -> Array:
    """The same (n) at samples, through their filter."""
    warmth, carried = samples.temperature[:, None], load[:, None]
    return np.asarray(np.sum(samples.weights * friction(drive, samples.speeds, warmth, carried), axis=1))
