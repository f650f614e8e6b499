"""Quasi-static modal analysis of the lapped beam: loads along its first mode on patches that slide and open.

The load a M phi on the tightened beam grows from zero, turns and comes back (Festjens, Chevallier and Dion
2013; Lacayo and Allen 2019). With the modal coordinate q = phi M u the frequency at an amplitude is
sqrt(a/q)/(2 pi) and the damping ratio the loss of a cycle over 2 pi a q.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from jointfmu.mechanics.sliders import Foundation

from ..sphere_friction import load_levels, sliders_at_levels
from .reduction import ReducedBeam

WORKING, LOWEST, STEP = (5e4, 5e7), 1e-9, 0.2
"""Pressures [Pa] with close slider heights; lowest load level, logarithmic step of the levels [1]."""
TOLERANCE = 1e-9
"""Largest residual displacement over the largest displacement [1] of an equilibrium."""
MAX_NEWTON_ITERATIONS, MIN_STEP = 200, 1e-4
"""Largest number of Newton steps; smallest step of the line search over the displacement [1]."""


def foundation(curve, ratio, friction):
    """Foundation of sliders for a curve of pressure over approach, with K_T/K_N [1] and friction coefficient
    [1]."""
    end = curve.end_point[1]
    return sliders_at_levels(
        curve, ratio, friction, load_levels(LOWEST, (WORKING[0] / end, WORKING[1] / end), STEP)
    )


@dataclass(frozen=True)
class State:
    """State of the beam under a modal load.

    load     : a [m kg^0.5/s2]; `q` [m kg^0.5] the modal coordinate
    displacement : (P, 3) [m] relative displacement of the patches since tightening
    force    : (P, 2, n) [Pa] of the sliders
    loss     : [J] dissipated energy since tightening, whole width
    """

    load: float
    q: float
    displacement: np.ndarray
    force: np.ndarray
    loss: float = 0.0


@dataclass(frozen=True)
class Joint:
    """Reduced beam on friction sliders."""

    beam: ReducedBeam
    sliders: Foundation

    @property
    def square(self):
        """Square of the linear angular frequency [1/s2]."""
        return (2.0 * np.pi * self.beam.frequency) ** 2

    def at_rest(self):
        """State of the preloaded beam without load."""
        count = self.beam.area.size
        return State(0.0, 0.0, np.zeros((count, 3)), self.sliders.virgin_forces(count))

    def apply_load(self, state, load):
        """State after a monotonic change of the load, by Newton's method on the patches.

        Raises RuntimeError if the iteration does not converge.
        """
        beam, given = self.beam, load * self.beam.shape / self.square
        moved = state.displacement + (load - state.load) * beam.shape / self.square
        weighted = beam.compliance * np.repeat(beam.area, 3)
        base, step, last = moved, 0.0 * moved, np.inf
        for _ in range(MAX_NEWTON_ITERATIONS):
            sliders, traction, tangent = self._interface(state, moved)
            extra = traction - beam.springs * moved
            residual = (moved - given).ravel() + weighted @ extra.ravel()
            if np.abs(residual).max() <= TOLERANCE * max(np.abs(moved).max(), 1e-15):
                q = (load - 2.0 * np.sum(beam.shape * beam.area[:, None] * extra)) / self.square
                return State(
                    load, float(q), moved, sliders.force, float(2.0 * beam.area @ sliders.dissipated_energy)
                )
            size, short = np.linalg.norm(residual), np.abs(step).max() < MIN_STEP * np.abs(moved).max()
            if size < last or short:
                base, step, last = moved, -self._step(weighted, tangent, residual), size
            else:
                step = 0.5 * step
            moved = base + step
        raise RuntimeError(
            f"no equilibrium at a load of {load:g} m kg^0.5/s2 after {MAX_NEWTON_ITERATIONS} steps"
        )

    def _interface(self, state, moved):
        """Sliders, tractions (P, 3) [Pa] less tractions at tightening, and their derivatives (P, 3, 3)."""
        before, after = (self.beam.approach + w[:, 2] for w in (state.displacement, moved))
        shift = (moved - state.displacement)[:, :2]
        sliders = self.sliders.advance(state.force, before, after, shift)
        pressure, normal = self.sliders.pressure_curve.derivatives(after, 1)
        first = self.sliders.pressure_curve.derivatives(self.beam.approach, 0)[0]
        tangent = np.zeros((len(moved), 3, 3))
        tangent[:, 0, 0], tangent[:, 0, 1], tangent[:, 1, 1] = sliders.tangent.T[:3]
        tangent[:, 1, 0], tangent[:, 2, 2] = tangent[:, 0, 1], normal
        nudge = 1e-4 * self.sliders.heights.std() / self.sliders.heights.size
        coupled = self.sliders.advance(state.force, before, after + nudge, shift).traction
        tangent[:, :2, 2] = (coupled - sliders.traction) / nudge
        return sliders, np.column_stack([sliders.traction, pressure - first]), tangent

    def _step(self, weighted, tangent, residual):
        """Newton step."""
        tangent = tangent - self.beam.springs[:, None, :] * np.eye(3)
        size = residual.size
        product = np.einsum("ipk,pkl->ipl", weighted.reshape(size, -1, 3), tangent).reshape(size, size)
        product[np.diag_indices(size)] += 1.0
        return lu_solve(lu_factor(product, overwrite_a=True, check_finite=False), residual).reshape(-1, 3)

    def backbone(self, amplitudes):
        """States on first loading, at the loads of linear amplitudes q [m kg^0.5]."""
        states = [self.at_rest()]
        for q in amplitudes:
            states.append(self.apply_load(states[-1], q * self.square))
        return states[1:]

    def cycle(self, top, steps):
        """Loss [J] and states of a cycle between a state and its opposite load; `steps` per half cycle."""
        down = top.load * np.linspace(1.0, -1.0, steps + 1)[1:]
        states = [top]
        for load in np.concatenate([down, -down]):
            states.append(self.apply_load(states[-1], load))
        return sum(state.loss for state in states[1:]), states


def frequency(state):
    """Secant frequency [Hz]."""
    return float(np.sqrt(state.load / state.q) / (2.0 * np.pi))


def masing_losses(states):
    """Losses [J] of cycles by Masing's rules: four times the dissipation in first loading.

    With the area under the backbone, an elastic stiffening of the contact would count as a negative loss.
    """
    return 4.0 * np.cumsum([state.loss for state in states])


def damping(loss, state):
    """Damping ratio [1] of a loss [J] per cycle."""
    return float(loss / (2.0 * np.pi * state.load * state.q))


def with_friction(joint, friction):
    """Copy of the joint with another friction coefficient [1]."""
    return replace(joint, sliders=replace(joint.sliders, friction_coefficient=friction))
