"""Figures of docs/modelica_explanation.md: cost of the history variables for an implicit solver.

    python studies/modelica_explanation.py [SECTION ...]

Steps, right-hand sides and Jacobians of scipy's BDF on the equations of the components of the Modelica
library.
drive        : a motor and a hanging link, driven to and fro and released; hysteresis from the last reversal,
               as in the component, or one state for each slider
bolted-joint : a mass that vibrates along x, y and z on a bolted joint; friction from the last reversal of the
               path, as in the component, or two states for each slider

BDF computes Jacobians by differences of the usual size of the states.
"""

import math
from dataclasses import replace

import numpy as np
from common import print_table_head, print_table_row, run_study
from jointfmu_tools.joints.bolted_joint.modelica import combine_nodes_to_spring
from scipy.integrate import solve_ivp
from scipy.interpolate import BPoly

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.harmonic_drive.drive import kinematic_error
from jointfmu.joints.harmonic_drive.friction import SLIDER_LIMIT_SHARES, friction_limits, viscous_torque
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring, transmitted_torque, wind_up
from jointfmu.joints.harmonic_drive.spring import SpringState as Spring
from jointfmu.mechanics.sliders import UNIFORM_DISTRIBUTION_DEVIATION
from jointfmu.parameters import load_default

CHANGED, BENT, STILL = 0.02, 0.2, 1e-4
"""Ratios [1] of the bolted joint component, as in its Modelica text."""
PATH_PARTS = 4
"""Number of parts of a path in the Modelica function `slide`."""
MASS, AMPLITUDES = 20.0, (0.7, 0.5, 0.1)
"""Mass [kg]; amplitudes along x and y over the displacement of gross slip, along z over the compression [1].
"""
FRICTION = {"friction_coulomb": 0.004, "friction_stribeck": 0.003, "stribeck_speed": 2.0, "load_loss": 0.15}
OTHER_LOSSES = {"friction_viscous": 1e-5, "error_2": 2e-4, "hysteresis_loss": 2.9e-4}
MOTOR, LINK, WEIGHT, STOP = 1e-5, 0.05, 9.80665 * 0.2, 0.6
"""Moments of inertia [kg.m2], torque of the horizontal link [N.m], stop time [s]."""
LAYER, MEMORY_TIME = 1e-3, 1e-4
"""Layer width [1] and time constant [s] of the Modelica component."""


class Drive:
    """Equations of the drive component; states: phi1, w1, phi2, w2, friction sliders, and hysteresis sliders
    if any."""

    def __init__(self, friction, turns):
        given = OTHER_LOSSES | (FRICTION if friction else {})
        self.law = HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **given))
        self.brakes, self.turns = SLIDER_LIMIT_SHARES.size if friction else 0, turns
        joint = self.law.joint
        self.most = (
            LAYER * max(friction_limits(joint, 0.0, joint.rated_torque)) * SLIDER_LIMIT_SHARES[: self.brakes]
        )
        self.held, self.place = np.zeros(self.law.hysteresis.friction_limit.size), 0.0

    def wind_up_and_rate(self, x):
        """Wind-up [rad], derivative of the kinematic error, rate of the wind-up [rad/s]."""
        error, slope, _ = kinematic_error(self.law.joint, x[0])
        return wind_up(self.law.joint, x[:4], error), slope, x[3] - x[1] / self.law.joint.ratio - slope * x[1]

    def hysteresis(self, phi):
        """Torques of the hysteresis sliders [N.m] since the last reversal."""
        found = self.law.hysteresis
        return np.clip(
            self.held + found.stiffness * (phi - self.place), -found.friction_limit, found.friction_limit
        )

    def rates(self, t, x):
        joint, found = self.law.joint, self.law.hysteresis
        phi, slope, rise = self.wind_up_and_rate(x)
        states = x[4 + self.brakes :]
        held = (
            self.hysteresis(phi)
            if self.turns
            else np.clip(states, -found.friction_limit, found.friction_limit)
        )
        load = math.copysign(float(self.law.curve.derivatives(np.array(abs(phi)), 0)[0]), phi)
        tau = transmitted_torque(
            joint,
            x[:4],
            Spring(
                phi_rel=phi,
                midline_torque=load,
                midline_stiffness=0.0,
                hysteresis_torque=held.sum(),
                phi_error=0.0,
                phi_error_slope=slope,
            ),
        )
        positive, negative = friction_limits(joint, x[1], tau)
        q = x[4 : 4 + self.brakes]
        share = SLIDER_LIMIT_SHARES[: self.brakes]
        braked = np.clip(q, -negative * share, positive * share)
        stuck = self.law.friction.stiffness[: self.brakes]
        rate = stuck * (x[1] - abs(x[1]) * (q - braked) / self.most) - (q - braked) / MEMORY_TIME
        push = 0.03 * math.sin(26.179938779914945 * t) ** 3 if t < 0.24 else 0.0
        torque = push + tau * (1.0 / joint.ratio + slope) - braked.sum() - viscous_torque(joint, x[1])
        own = [x[1], torque / MOTOR, x[3], -(tau + WEIGHT * math.sin(x[2])) / LINK]
        if self.turns:
            return np.concatenate([own, rate])
        slipped = abs(rise) * (states - held) / (LAYER * found.friction_limit)
        return np.concatenate([own, rate, found.stiffness * (rise - slipped)])

    def run(self, tolerance):
        """Numbers of steps, right-hand sides, Jacobians, states and events of a simulation."""
        size = 4 + self.brakes + (0 if self.turns else self.held.size)
        x, t, counts = np.zeros(size), 0.0, np.zeros(3, dtype=int)
        scale = np.concatenate([[1e-3, 0.1, 1e-3, 0.1], np.full(size - 4, 0.01)])

        def reversal_function(t, x):
            return self.wind_up_and_rate(x)[2]

        reversal_function.terminal = True
        events = 0
        while t < STOP:
            found = solve_ivp(
                self.rates,
                (t, STOP),
                x,
                "BDF",
                rtol=tolerance,
                atol=tolerance * scale,
                events=reversal_function if self.turns else None,
            )
            counts += len(found.t), found.nfev, found.njev
            t, x = found.t[-1], found.y[:, -1]
            if found.status == 1:
                phi = self.wind_up_and_rate(x)[0]
                self.held, self.place, events = self.hysteresis(phi), phi, events + 1
                t, x = t + 1e-9, x + 1e-9 * self.rates(t, x)  # past the turn
        return *counts, size, events


class Bolted:
    """Equations of the bolted joint component; states: s, v, with history also slider forces (2, n)."""

    def __init__(self, kept):
        spring = BoltedJointSpring.from_interface_nodes(load_default("bolted_joint").values)
        found = combine_nodes_to_spring(spring, 9e3, 0.0)
        rows, self.kept, self.tight = found.force_table.table_rows, kept, found.preload_contact_force
        self.load = BPoly.from_derivatives(rows[:, 0], rows[:, 1:4])
        self.curve = [self.load, self.load.derivative(), self.load.derivative(2)]
        self.shear, self.mu, self.heights = (
            found.shear_stiffness_ratio,
            spring.joint.mu,
            found.slider_pair_boundaries,
        )
        self.K, self.Q = found.slider_properties.T
        stiff = float(self.curve[1](0.0))
        self.reach = np.array([self.mu / self.shear, self.mu / self.shear, 1.0]) * self.tight / stiff
        self.rate = np.sqrt(stiff * np.array([self.shear, self.shear, 1.0]) / MASS)
        self.keep(np.zeros((2, self.K.size)), np.zeros(3), self.K, self.Q)

    def keep(self, force, s, stiffness, friction):
        self.last = force, s, stiffness, friction, self.tight + float(self.load(-s[2]))

    def sliders(self, c, v_c):
        """Stiffness, friction limit and their rates: of the sliders that slip earlier, then of the others."""
        load, stiff, bend = (float(part(c)) for part in self.curve)
        h, g, k = self.heights.T
        on, far = c > h[:-1], c > h[1:]
        inside = np.clip(c, h[:-1], h[1:]) - h[:-1]
        S = np.where(on, np.maximum(np.minimum(stiff, k[1:]) - k[:-1], 0.0), 0.0)
        grow = np.where(on & ~far, bend, 0.0)
        first = np.where(on, np.minimum(self.tight + load, g[1:]) - g[:-1] - k[:-1] * inside, 0.0)
        apart = np.minimum(S * UNIFORM_DISTRIBUTION_DEVIATION * inside, np.maximum(first, 0.0))
        widen = np.where(on & ~far, np.minimum(UNIFORM_DISTRIBUTION_DEVIATION * (S + grow * inside), S), 0.0)
        N = np.maximum(first, 0.0) + S * np.maximum(c - h[1:], 0.0)
        half = 0.5 * self.shear * np.array([S, S]), 0.5 * self.mu * np.array([N - apart, N + apart])
        rates = 0.5 * self.shear * np.array([grow, grow]), 0.5 * self.mu * np.array([S - widen, S + widen])
        return *(x.ravel() for x in half), *(x.ravel() * v_c for x in rates)

    def slider_forces(self, s):
        """Forces of the sliders by a straight path from the last stored state, their stiffness and friction
        limit."""
        force, place, first, most, _ = self.last
        K, Q, _, _ = self.sliders(-s[2], 0.0)
        before = first
        for part in np.arange(1, PATH_PARTS + 1) / PATH_PARTS:
            here, limit = first + (K - first) * part, most + (Q - most) * part
            falls = here < before
            keeps = np.where(falls, here / np.where(before > 0.0, before, 1.0), 1.0)
            carries = np.where(falls, here, 0.5 * (before + here))
            force = keeps * force + carries * (s[:2] - place[:2])[:, None] / PATH_PARTS
            force = force * np.minimum(1.0, limit / np.maximum(np.hypot(*force), 1e-60))
            before = here
        return force, K, Q

    def rates(self, t, x):
        s, v = x[:3], x[3:6]
        if self.kept:
            held, more = self.slider_forces(s)[0], np.zeros(0)
        else:
            q = x[6:].reshape(2, -1)
            K, Q, K_rate, Q_rate = self.sliders(-s[2], -v[2])
            stuck = K * v[:2, None] + np.where(K_rate < 0.0, q * K_rate / np.maximum(K, 1.0), 0.0)
            size = np.hypot(*q)
            along = np.sum(q * stuck, axis=0) / np.maximum(size, 1e-60)
            layer = np.clip((size - Q) / (LAYER * Q + 1e-9), 0.0, 1.0)
            more = stuck - layer * np.maximum(along - Q_rate, 0.0) * q / np.maximum(size, 1e-60)
            held = q * np.where(size > Q, Q / np.maximum(size, 1e-60), 1.0)
        force = np.array([*-held.sum(axis=1), float(self.load(-s[2]))])
        return np.concatenate([v, force / MASS, more.ravel()])

    def reversal_function(self, t, x):
        u, v = x[:2] - self.last[1][:2], x[3:5]
        across, along = abs(u[0] * v[1] - u[1] * v[0]), u @ v
        return across - BENT * along - STILL * self.reach[0] * math.hypot(*v)

    def changed(self, t, x):
        return abs(self.tight + float(self.load(-x[2])) - self.last[4]) - CHANGED * self.tight

    def run(self, tolerance, stop):
        """Numbers of steps, right-hand sides (not for Jacobians), Jacobians, states and events of a run."""
        amplitude = np.array(AMPLITUDES) * self.reach
        x = np.concatenate([[0.0, amplitude[1], 0.0], amplitude * self.rate * [1.0, 0.0, 1.0]])
        usual = np.concatenate([self.reach, self.reach * self.rate])
        if not self.kept:
            x, usual = (np.append(a, np.full(2 * self.K.size, b)) for a, b in ((x, 0.0), (usual, 100.0)))

        def jacobian(t, x):
            here, steps = self.rates(t, x), 1e-7 * np.maximum(np.abs(x), usual)
            return np.column_stack([(self.rates(t, x + d) - here) / d.sum() for d in np.diag(steps)])

        for event in (Bolted.reversal_function, Bolted.changed):
            event.terminal, event.direction = True, 1.0
        t, counts, events = 0.0, np.zeros(3, dtype=int), 0
        while t < stop:
            found = solve_ivp(
                self.rates, (t, stop), x, "BDF", rtol=tolerance, atol=tolerance * usual, jac=jacobian,
                events=[self.reversal_function, self.changed] if self.kept else None,
            )  # fmt: skip
            counts += len(found.t), found.nfev, found.njev
            t, x = found.t[-1], found.y[:, -1]
            if found.status == 1:
                force, K, Q = self.slider_forces(x[:3])
                self.keep(force, x[:3], K, Q)
                events += 1
        return *counts, x.size, events


NAMES = "steps", "right-hand sides", "Jacobians", "states", "events"


def print_drive():
    """Print steps, evaluations and events for a motor and a link with the equations of the drive."""
    print_table_head("Motor and link on the component's equations, BDF", "drive", *NAMES)
    for friction in (False, True):
        for turns in (False, True):
            for tolerance in (1e-6, 1e-8):
                losses = "hysteresis and friction" if friction else "hysteresis"
                form = "from the last turn" if turns else "as states"
                print_table_row(f"{losses}, {tolerance:g}, {form}", *Drive(friction, turns).run(tolerance))


def print_bolted_joint():
    """Print steps, evaluations and events for a mass on the equations of the bolted joint."""
    print_table_head("A mass on a bolted joint, BDF", "friction", *NAMES)
    cases = ((False, 1e-6, 4e-4), (True, 1e-6, 4e-4), (True, 1e-6, 2e-2), (True, 1e-8, 2e-2))
    for kept, tolerance, stop in cases:
        form = "from the last turn" if kept else "as states"
        print_table_row(f"{stop * 1e3:g} ms, {tolerance:g}, {form}", *Bolted(kept).run(tolerance, stop))


if __name__ == "__main__":
    run_study(__doc__, {"drive": print_drive, "bolted-joint": print_bolted_joint})
