"""The whole bolted joint: what its bodies give way by, in equilibrium with the interface and the bolts.

The motion of the attachments and the amplitudes of the modes are one set of motions, q and a: points open and
patches shift by G_q q + G_a a, and so do the seats of the bolts. Equilibrium is

    r(a) = S a + G_a^T f = 0,    f = -(p - p_tightened) A share, t A share, k_b e

at points, patches and bolts, S the stiffness of the modes; k_b e is at least the bolt's force at tightening
with the opposite sign, see `BoltSprings`. It is found by Newton's method with the
derivative of r, at first that at the beginning of the way, which Broyden's update carries on; it is not
symmetric, as the normal force acts on friction. What is left of H = G^T W G + S to the attachments where a
follows is the stiffness of the whole, W the tangents of points, patches and bolts in a further motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...mechanics.footprint.shape import FrictionPatches, PressureDistribution
from ...quantity import Array
from .bodies import Modes
from .bolts import BoltSprings
from .contact import RelativeDisplacement, patch_displacement
from .trials import LoadStep, TrialState

RELATIVE_TOLERANCE = 1e-13
"""Residual over the sum of all forces [1] at which the bodies are in equilibrium: round-off of the sums. All
forces vanish where the joint is open, so the load at which the contact closes is added to them."""
CANCELLATION_RATIO = 0.02
"""Forces of points that come apart by rigid motion and modes alike, whose difference is left [1] in CLOSE."""
INTERMEDIATE_TOLERANCE_FACTOR = 1e7
"""How much more is enough on the way [1]."""
MAX_ITERATIONS, MAX_LINE_SEARCH = 16, 6
"""Most steps of Newton's method [1], and most parts of each that are tried."""
TANGENT_REUSE_RATIO = 0.03
"""Part of the residual that a step leaves [1] below which the next one takes the derivative on."""
MIN_LOAD_STEP = 1e-4
"""Least part of a motion that is gone at once [1]."""


class PreloadState(NamedTuple):
    """Pressure (n) [Pa] of the points, and force (b) [N] of the bolts, at tightening."""

    pressure: Array
    bolt_force: Array


@dataclass(frozen=True)
class JointAssembly:
    """A contact between bodies that give way, and its bolts.

    points  : (n, 3) opening by s_z, theta_x, theta_y; patches: (3, m, 3) `shifts` by s_x, s_y, theta_z
    seats   : (b, 3) stretch by s_z, theta_x, theta_y
    weight  : (n) [m2] area of the points, `patch` (m) of the patches
    bolts   : one at each place of the modes
    closed  : [N] load of the whole area at which the contact closes, see `Curve.closed`
    """

    modes: Modes
    point_opening: Array
    patch_motion: Array
    bolt_elongation: Array
    point_area: Array
    patch_area: Array
    bolts: BoltSprings
    closure_load: float

    @classmethod
    def of(
        cls,
        modes: Modes,
        shape: PressureDistribution,
        patches: FrictionPatches,
        area: float,
        bolts: BoltSprings,
        closure_pressure: float,
    ) -> "JointAssembly":
        """Of points and patches of a nominal area [m2]; the contact closes under a pressure `closed` [Pa]."""
        turns = np.eye(3)
        return cls(
            modes,
            _opening_modes(shape.position),
            np.stack([patch_displacement(patches, turn) for turn in turns], axis=-1).transpose(1, 0, 2),
            bolts.elongation,
            area * shape.share,
            area * patches.share,
            bolts,
            area * closure_pressure,
        )

    def elongation(self, displacement: RelativeDisplacement, modal_coordinates: Array) -> Array:
        """Of the bolts (b) [m]."""
        return np.asarray(
            self.bolt_elongation @ displacement.normal + self.modes.bolt_elongation @ modal_coordinates
        )

    def residual(
        self,
        state: TrialState,
        preload: PreloadState,
        displacement: RelativeDisplacement,
        modal_coordinates: Array,
    ) -> tuple[Array, float]:
        """r (k) [N] of amplitudes (k) [m], and what of it is round-off [N]."""
        modes, stretch = self.modes, self.elongation(displacement, modal_coordinates)
        bolts = self.bolts.stiffness * (stretch + self.bolts.gap(preload.bolt_force, stretch))
        r = modes.stiffness * modal_coordinates + modes.bolt_elongation.T @ bolts
        r = r - modes.opening.T @ (self.point_area * (state.pressure - preload.pressure))
        for axis in range(3):
            r = r + modes.patch_displacement[axis].T @ (self.patch_area * state.traction[:, axis])
        sizes = (
            self.point_area @ (state.pressure + preload.pressure),
            np.sum(np.abs(bolts)),
            self.patch_area @ np.abs(state.traction),
        )
        apart = np.max(np.abs(self.point_opening @ displacement.normal))
        forces = (
            sum(np.sum(size) for size in sizes)
            + (self.point_area @ state.stiffness) * apart * CANCELLATION_RATIO
        )
        return r, float(RELATIVE_TOLERANCE * (forces + self.closure_load))

    def tangent_stiffness(self, stiffness: Array, tangent: Array, bolt_tangent: Array) -> Array:
        """H (6 + k, 6 + k) [N/m] over s_x, s_y, s_z, theta_x, theta_y, theta_z and the amplitudes.

        stiffness (n) [Pa/m] of the points, tangent (m, 6) [Pa/m] of the patches, bolts (b) [N/m].
        """
        modes, normal, shear = self.modes, slice(2, 5), (0, 1, 5)
        size = 6 + len(modes.stiffness)
        H = np.zeros((size, size))

        def motions(rigid: Array, columns: "slice | tuple[int, ...]", own: Array) -> Array:
            G = np.zeros((len(rigid), size))
            G[:, columns], G[:, 6:] = rigid, own
            return G

        points = motions(self.point_opening, normal, modes.opening)
        seats = motions(self.bolt_elongation, normal, modes.bolt_elongation)
        u, v, w = (
            motions(self.patch_motion[axis], shear, modes.patch_displacement[axis]) for axis in range(3)
        )
        xx, xy, yy, xt, yt, tt = (self.patch_area * tangent.T)[:, :, None]
        H += points.T @ ((self.point_area * stiffness)[:, None] * points) + (bolt_tangent * seats.T) @ seats
        H += u.T @ (xx * u + xy * v + xt * w) + v.T @ (xy * u + yy * v + yt * w)
        H += w.T @ (xt * u + yt * v + tt * w)
        H[6:, 6:] += np.diag(modes.stiffness)
        return H

    def condense(self, H: Array) -> Array:
        """Stiffness (6, 6) of the whole, where the amplitudes follow."""
        return np.asarray(H[:6, :6] - H[:6, 6:] @ np.linalg.solve(H[6:, 6:], H[6:, :6]))

    def solve(
        self, load_step: LoadStep, preload: PreloadState, start: Array, first: Array, J: Array
    ) -> tuple[Array, TrialState]:
        """Amplitudes (k) [m] in equilibrium at the end of a motion, and the trial there.

        start, first : amplitudes (k) [m] at its beginning, and at its end in the tangent of the beginning
        J            : (k, k) [N/m] derivative of the residual at the beginning, by the tangents

        Where Newton's method does not come to the end at once, it goes there part by part.

        Raises ValueError if there is no equilibrium, with the residual and the place.
        """
        done, step, amplitude, rate = 0.0, 1.0, start, first - start
        while True:
            part = min(done + step, 1.0)
            found = self._solve_newton(load_step, part, preload, amplitude + (part - done) * rate, J)
            if isinstance(found, float):
                step *= 0.5
                if step < MIN_LOAD_STEP:
                    raise ValueError(
                        f"{load_step.input_summary}: no equilibrium of the joint was found beyond a fraction "
                        f"of {done:.3g} of the way, the residual is {found:.2g} N"
                    )
                continue
            if part == 1.0:
                return found
            rate = (found[0] - amplitude) / (part - done)
            amplitude, done, step = found[0], part, 2.0 * step

    def _jacobian(
        self, stiffness: Array, modal_opening: Array, traction_derivatives: Array, bolt_tangent: Array
    ) -> Array:
        """Of the residual by the amplitudes: (k, k) [N/m].

        stiffness (n) [Pa/m] of the points, slopes (m, 3, 4) [Pa/m] of the tractions by shifts and by coming
        apart, which the modes do by (m, k) [1], bolts (b) [N/m].
        """
        modes = self.modes
        J = np.diag(modes.stiffness) + (bolt_tangent * modes.bolt_elongation.T) @ modes.bolt_elongation
        J += modes.opening.T @ ((self.point_area * stiffness)[:, None] * modes.opening)
        every = np.concatenate([modes.patch_displacement, modal_opening[None]])
        for axis in range(3):
            J += modes.patch_displacement[axis].T @ np.einsum(
                "m,mc,cmk->mk", self.patch_area, traction_derivatives[:, axis], every
            )
        return np.asarray(J)

    def _solve_newton(
        self,
        load_step: LoadStep,
        load_factor: float,
        preload: PreloadState,
        modal_coordinates: Array,
        J: Array,
    ) -> tuple[Array, TrialState] | float:
        """Equilibrium at a part [1] of the motion, from amplitudes (k) [m] and a derivative J (k, k), or
        the residual [N] left."""
        place, close = (
            load_step.displacement_at(load_factor),
            1.0 if load_factor == 1.0 else INTERMEDIATE_TOLERANCE_FACTOR,
        )
        at = load_step.evaluate(place, modal_coordinates)
        r, least = self.residual(at, preload, place, modal_coordinates)
        before, own = np.inf, False  # whether the derivative is that at the amplitudes
        steps: list[Array] = []
        for _ in range(MAX_ITERATIONS):
            left = float(np.max(np.abs(r)))
            if left <= close * least:
                return modal_coordinates, at
            if not left < TANGENT_REUSE_RATIO * before:
                bolts = self.bolts.tangent(preload.bolt_force, self.elongation(place, modal_coordinates))
                slopes = load_step.traction_derivatives(place, modal_coordinates)
                J = self._jacobian(at.stiffness, load_step.modal_opening(at), slopes, bolts)
                steps, own = [], True
            try:
                step, before = _broyden_step(np.asarray(-np.linalg.solve(J, r)), steps), left
            except np.linalg.LinAlgError:  # the derivative is singular
                break
            steps.append(step)
            size, falls, begin = 1.0, float(r @ step), modal_coordinates
            for _ in range(MAX_LINE_SEARCH):
                modal_coordinates = begin + size * step
                at = load_step.evaluate(place, modal_coordinates)
                r, least = self.residual(at, preload, place, modal_coordinates)
                rises = float(r @ step)
                if size == 0.0 or not rises > 0.5 * abs(falls):
                    break
                size *= max(falls / (falls - rises), 0.1) if own else 0.0
                before = 0.0
            own = False
        return float(np.max(np.abs(r)))


def _broyden_step(step: Array, steps: Sequence[Array]) -> Array:
    """A step (k) of a derivative as Broyden's (good) update by the steps since then changes it."""
    for last, following in pairwise(steps):
        step = step + (last @ step) / (last @ last) * following
    return np.asarray(step / (1.0 - steps[-1] @ step / (steps[-1] @ steps[-1])) if steps else step)


def _opening_modes(position: Array) -> Array:
    """How far places (n, 2) [m] come apart by s_z, theta_x, theta_y: (n, 3)."""
    x, y = position.T
    return np.stack([np.ones_like(x), y, -x], axis=-1)
