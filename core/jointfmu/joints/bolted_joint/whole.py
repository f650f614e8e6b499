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

from ...mechanics.footprint.shape import FrictionPatches, PressureShape
from ...quantity import Array
from .bodies import Modes
from .bolts import BoltSprings
from .contact import Place, shifts
from .trials import Trial, Trials

CLOSE = 1e-13
"""Residual over the sum of all forces [1] at which the bodies are in equilibrium: round-off of the sums. All
forces vanish where the joint is open, so the load at which the contact closes is added to them."""
CANCELS = 0.02
"""Forces of points that come apart by rigid motion and modes alike, whose difference is left [1] in CLOSE."""
ROUGH = 1e7
"""How much more is enough on the way [1]."""
STEPS, PARTS = 16, 6
"""Most steps of Newton's method [1], and most parts of each that are tried."""
CHORD = 0.03
"""Part of the residual that a step leaves [1] below which the next one takes the derivative on."""
LEAST_PART = 1e-4
"""Least part of a motion that is gone at once [1]."""


class Tightened(NamedTuple):
    """Pressure (n) [Pa] of the points, and force (b) [N] of the bolts, at tightening."""

    pressure: Array
    bolt_force: Array


@dataclass(frozen=True)
class Whole:
    """A contact between bodies that give way, and its bolts.

    points  : (n, 3) opening by s_z, theta_x, theta_y; patches: (3, m, 3) `shifts` by s_x, s_y, theta_z
    seats   : (b, 3) stretch by s_z, theta_x, theta_y
    weight  : (n) [m2] area of the points, `patch` (m) of the patches
    bolts   : one at each place of the modes
    closed  : [N] load of the whole area at which the contact closes, see `Curve.closed`
    """

    modes: Modes
    points: Array
    patches: Array
    seats: Array
    weight: Array
    patch: Array
    bolts: BoltSprings
    closed: float

    @classmethod
    def of(
        cls,
        modes: Modes,
        shape: PressureShape,
        patches: FrictionPatches,
        area: float,
        bolts: BoltSprings,
        closed: float,
    ) -> "Whole":
        """Of points and patches of a nominal area [m2]; the contact closes under a pressure `closed` [Pa]."""
        turns = np.eye(3)
        return cls(
            modes,
            _apart(shape.position),
            np.stack([shifts(patches, turn) for turn in turns], axis=-1).transpose(1, 0, 2),
            bolts.elongation,
            area * shape.share,
            area * patches.share,
            bolts,
            area * closed,
        )

    def stretch(self, place: Place, amplitude: Array) -> Array:
        """Of the bolts (b) [m]."""
        return np.asarray(self.seats @ place.normal + self.modes.stretch @ amplitude)

    def residual(self, at: Trial, tight: Tightened, place: Place, amplitude: Array) -> tuple[Array, float]:
        """r (k) [N] of amplitudes (k) [m], and what of it is round-off [N]."""
        modes, stretch = self.modes, self.stretch(place, amplitude)
        bolts = self.bolts.stiffness * (stretch + self.bolts.gap(tight.bolt_force, stretch))
        r = modes.stiffness * amplitude + modes.stretch.T @ bolts
        r = r - modes.opening.T @ (self.weight * (at.pressure - tight.pressure))
        for axis in range(3):
            r = r + modes.patch[axis].T @ (self.patch * at.traction[:, axis])
        sizes = (
            self.weight @ (at.pressure + tight.pressure),
            np.sum(np.abs(bolts)),
            self.patch @ np.abs(at.traction),
        )
        apart = np.max(np.abs(self.points @ place.normal))
        forces = sum(np.sum(size) for size in sizes) + (self.weight @ at.stiffness) * apart * CANCELS
        return r, float(CLOSE * (forces + self.closed))

    def slope(self, stiffness: Array, tangent: Array, bolts: Array) -> Array:
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

        points = motions(self.points, normal, modes.opening)
        seats = motions(self.seats, normal, modes.stretch)
        u, v, w = (motions(self.patches[axis], shear, modes.patch[axis]) for axis in range(3))
        xx, xy, yy, xt, yt, tt = (self.patch * tangent.T)[:, :, None]
        H += points.T @ ((self.weight * stiffness)[:, None] * points) + (bolts * seats.T) @ seats
        H += u.T @ (xx * u + xy * v + xt * w) + v.T @ (xy * u + yy * v + yt * w)
        H += w.T @ (xt * u + yt * v + tt * w)
        H[6:, 6:] += np.diag(modes.stiffness)
        return H

    def condensed(self, H: Array) -> Array:
        """Stiffness (6, 6) of the whole, where the amplitudes follow."""
        return np.asarray(H[:6, :6] - H[:6, 6:] @ np.linalg.solve(H[6:, 6:], H[6:, :6]))

    def solve(
        self, trials: Trials, tight: Tightened, start: Array, first: Array, J: Array
    ) -> tuple[Array, Trial]:
        """Amplitudes (k) [m] in equilibrium at the end of a motion, and the trial there.

        start, first : amplitudes (k) [m] at its beginning, and at its end in the tangent of the beginning
        J            : (k, k) [N/m] derivative of the residual at the beginning, by the tangents

        Where Newton's method does not come to the end at once, it goes there part by part.

        Raises ValueError if there is no equilibrium, with the residual and the place.
        """
        done, step, amplitude, rate = 0.0, 1.0, start, first - start
        while True:
            part = min(done + step, 1.0)
            found = self._newton(trials, part, tight, amplitude + (part - done) * rate, J)
            if isinstance(found, float):
                step *= 0.5
                if step < LEAST_PART:
                    raise ValueError(
                        f"{trials.told}: the sides find no equilibrium beyond {done:.3g} of the way, "
                        f"the residual is {found:.2g} N"
                    )
                continue
            if part == 1.0:
                return found
            rate = (found[0] - amplitude) / (part - done)
            amplitude, done, step = found[0], part, 2.0 * step

    def _derivative(self, stiffness: Array, apart: Array, slopes: Array, bolts: Array) -> Array:
        """Of the residual by the amplitudes: (k, k) [N/m].

        stiffness (n) [Pa/m] of the points, slopes (m, 3, 4) [Pa/m] of the tractions by shifts and by coming
        apart, which the modes do by (m, k) [1], bolts (b) [N/m].
        """
        modes = self.modes
        J = np.diag(modes.stiffness) + (bolts * modes.stretch.T) @ modes.stretch
        J += modes.opening.T @ ((self.weight * stiffness)[:, None] * modes.opening)
        every = np.concatenate([modes.patch, apart[None]])
        for axis in range(3):
            J += modes.patch[axis].T @ np.einsum("m,mc,cmk->mk", self.patch, slopes[:, axis], every)
        return np.asarray(J)

    def _newton(
        self, trials: Trials, part: float, tight: Tightened, amplitude: Array, J: Array
    ) -> tuple[Array, Trial] | float:
        """Equilibrium at a part [1] of the motion, from amplitudes (k) [m] and a derivative J (k, k), or
        the residual [N] left."""
        place, close = trials.place(part), 1.0 if part == 1.0 else ROUGH
        at = trials.at(place, amplitude)
        r, least = self.residual(at, tight, place, amplitude)
        before, own = np.inf, False  # whether the derivative is that at the amplitudes
        steps: list[Array] = []
        for _ in range(STEPS):
            left = float(np.max(np.abs(r)))
            if left <= close * least:
                return amplitude, at
            if not left < CHORD * before:
                bolts = self.bolts.tangent(tight.bolt_force, self.stretch(place, amplitude))
                slopes = trials.slopes(place, amplitude)
                J = self._derivative(at.stiffness, trials.apart(at), slopes, bolts)
                steps, own = [], True
            try:
                step, before = _broyden(np.asarray(-np.linalg.solve(J, r)), steps), left
            except np.linalg.LinAlgError:  # the derivative is singular
                break
            steps.append(step)
            size, falls, begin = 1.0, float(r @ step), amplitude
            for _ in range(PARTS):
                amplitude = begin + size * step
                at = trials.at(place, amplitude)
                r, least = self.residual(at, tight, place, amplitude)
                rises = float(r @ step)
                if size == 0.0 or not rises > 0.5 * abs(falls):
                    break
                size *= max(falls / (falls - rises), 0.1) if own else 0.0
                before = 0.0
            own = False
        return float(np.max(np.abs(r)))


def _broyden(step: Array, steps: Sequence[Array]) -> Array:
    """A step (k) of a derivative as Broyden's (good) update by the steps since then changes it."""
    for last, following in pairwise(steps):
        step = step + (last @ step) / (last @ last) * following
    return np.asarray(step / (1.0 - steps[-1] @ step / (steps[-1] @ steps[-1])) if steps else step)


def _apart(position: Array) -> Array:
    """How far places (n, 2) [m] come apart by s_z, theta_x, theta_y: (n, 3)."""
    x, y = position.T
    return np.stack([np.ones_like(x), y, -x], axis=-1)
