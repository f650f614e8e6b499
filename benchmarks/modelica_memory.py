"""What the memory of the Modelica library's drive costs an implicit solver.

`python benchmarks/modelica_memory.py` prints steps, right-hand sides and Jacobians of scipy's BDF on the
equations of the component, a motor and a hanging link that are pushed to and fro and left to stop: hysteresis
from the last turn of the wind-up on, as the component has it, and as one state for each slider.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from validity_tables import heading, row

from jointfmu.joints.harmonic_drive.friction import LIMITS, limits, viscous
from jointfmu.joints.harmonic_drive.kinematic_error import kinematic_error
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring, transmitted, wind_up
from jointfmu.joints.harmonic_drive.spring import State as Spring
from jointfmu.parameters import default

FRICTION = {"friction_coulomb": 0.004, "friction_stribeck": 0.003, "stribeck_speed": 2.0, "load_loss": 0.15}
OTHERS = {"friction_viscous": 1e-5, "error_2": 2e-4, "hysteresis_loss": 2.9e-4}
MOTOR, LINK, WEIGHT, STOP = 1e-5, 0.05, 9.80665 * 0.2, 0.6
"""Inertias [kg.m2], torque of the link held level [N.m], end [s]."""
LAYER, FORGETS = 1e-3, 1e-4
"""As the component has them [1], [s]."""


class Drive:
    """The equations: states phi1, w1, phi2, w2, sliders of the friction, perhaps those of the hysteresis."""

    def __init__(self, friction, turns):
        given = OTHERS | (FRICTION if friction else {})
        self.law = HarmonicDriveSpring.of(replace(default("harmonic_drive").values, **given))
        self.brakes, self.turns = LIMITS.size if friction else 0, turns
        self.held, self.place = np.zeros(self.law.hysteresis.limit.size), 0.0

    def seen(self, x):
        """Wind-up [rad], slope of the error, its rate [rad/s]."""
        error, slope, _ = kinematic_error(self.law.joint, x[0])
        return wind_up(self.law.joint, x[:4], error), slope, x[3] - x[1] / self.law.joint.ratio - slope * x[1]

    def hysteresis(self, phi):
        """Torques of its sliders [N.m] from the last turn on."""
        found = self.law.hysteresis
        return np.clip(self.held + found.stiffness * (phi - self.place), -found.limit, found.limit)

    def rates(self, t, x):
        joint, found = self.law.joint, self.law.hysteresis
        phi, slope, rise = self.seen(x)
        states = x[4 + self.brakes :]
        held = self.hysteresis(phi) if self.turns else np.clip(states, -found.limit, found.limit)
        load = math.copysign(float(self.law.curve.derivatives(np.array(abs(phi)), 0)[0]), phi)
        tau = transmitted(joint, x[:4], Spring(phi, load, 0.0, held.sum(), 0.0, slope))
        positive, negative = limits(joint, x[1], tau)
        q = x[4 : 4 + self.brakes]
        share = LIMITS[: self.brakes]
        braked = np.clip(q, -negative * share, positive * share)
        most = LAYER * max(limits(joint, 0.0, joint.rated_torque)) * share + 1e-60
        stuck = self.law.friction.stiffness[: self.brakes]
        rate = stuck * (x[1] - abs(x[1]) * (q - braked) / most) - (q - braked) / FORGETS
        push = 0.03 * math.sin(26.179938779914945 * t) ** 3 if t < 0.24 else 0.0
        torque = push + tau * (1.0 / joint.ratio + slope) - braked.sum() - viscous(joint, x[1])
        own = [x[1], torque / MOTOR, x[3], -(tau + WEIGHT * math.sin(x[2])) / LINK]
        if self.turns:
            return np.concatenate([own, rate])
        slipped = abs(rise) * (states - held) / (LAYER * found.limit)
        return np.concatenate([own, rate, found.stiffness * (rise - slipped)])

    def run(self, tolerance):
        """Steps, right-hand sides, Jacobians, states and events."""
        size = 4 + self.brakes + (0 if self.turns else self.held.size)
        x, t, counts = np.zeros(size), 0.0, np.zeros(3, dtype=int)
        scale = np.concatenate([[1e-3, 0.1, 1e-3, 0.1], np.full(size - 4, 0.01)])

        def turned(t, x):
            return self.seen(x)[2]

        turned.terminal = True
        events = 0
        while t < STOP:
            found = solve_ivp(
                self.rates,
                (t, STOP),
                x,
                "BDF",
                rtol=tolerance,
                atol=tolerance * scale,
                events=turned if self.turns else None,
            )
            counts += len(found.t), found.nfev, found.njev
            t, x = found.t[-1], found.y[:, -1]
            if found.status == 1:
                phi = self.seen(x)[0]
                self.held, self.place, events = self.hysteresis(phi), phi, events + 1
                t, x = t + 1e-9, x + 1e-9 * self.rates(t, x)  # past the turn
        return *counts, size, events


def main():
    """Print the table."""
    names = "steps", "right-hand sides", "Jacobians", "states", "events"
    heading("Motor and link on the component's equations, BDF", "drive", *names)
    for friction in (False, True):
        for turns in (False, True):
            for tolerance in (1e-6, 1e-8):
                what = f"{'hysteresis and friction' if friction else 'hysteresis'}, {tolerance:g}, "
                row(
                    what + ("from the last turn" if turns else "as states"),
                    *Drive(friction, turns).run(tolerance),
                )


if __name__ == "__main__":
    main()
