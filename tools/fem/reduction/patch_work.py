"""What modes of the bodies do at few patches, so that friction works on them as on the whole contact.

The shift of elastic sides is uneven within a patch: it rises towards the edge of a pressed disc, where slip
begins. At the mean of its place a patch slips too late and loses too little, by a fifth in partial slip. So
what each mode does at each patch is fitted, from the mean of its place on: on ways of the joint into slip,
at the pressure of tightening, friction has the forces on motions and modes, and loses as much in a cycle, as
at all points of the finite elements. That is a cubature of the work of friction; it costs the joint nothing.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from jointfmu.mechanics.footprint.friction import CIRCLE
from jointfmu.mechanics.footprint.shape import FrictionPatches
from jointfmu.mechanics.sliders import Foundation
from jointfmu.quantity import Array

PART = np.sqrt(0.5)
"""Part of each of two motions that are taken together [1]."""
STAY = 0.1
"""Weight of staying where the patches are beside the forces [1]."""
STEPS = 10
"""Of Levenberg and Marquardt's method [1]."""
FIRST_DAMPING, LESS, MORE, MOST_DAMPING = 1e-3, 0.2, 5.0, 1e6
"""Damping over the diagonal of the equations [1], its factors after a step that is better and one that is
not, and where it ends."""
EXACT = 300.0
"""Weight of the tightened stiffness, as part of the joint's, beside that of forces and losses [1]: so much
that it is missed by 2e-4 at most; with more the steps keep to a valley too narrow."""
TINY = 1e-15
"""Shift [m] that counts as one, and other least numbers."""
LEAST = 0.03
"""Motion of patches by a mode, over that by the one that moves them most [1], from which changes count."""


def into_slip(motion: Array) -> Array:
    """Ways into slip (w, s) as sums of states (s) that moved by (s, 6) [m, rad]: those along x, along y and
    about z alone, as many each, and of these two at once."""
    alone = np.flatnonzero(~np.any(motion[:, 2:5], axis=1))
    alone = alone[np.count_nonzero(motion[alone], axis=1) == 1]
    one = np.eye(len(motion))
    axes = [one[alone[motion[alone][:, axis] != 0.0]] for axis in (0, 1, 5)]
    pairs = [(axes[i], axes[j], sign) for i, j in ((0, 1), (0, 2), (1, 2)) for sign in (1.0, -1.0)]
    return np.concatenate([*axes, *(PART * (a + sign * b) for a, b, sign in pairs)])


@dataclass(frozen=True)
class Shears:
    """Ways of the joint into slip: motion (s, 3) [m, rad] of side 2 along x, y and about z, amplitudes (s, k)
    [m] of the modes."""

    motion: Array
    amplitude: Array


@dataclass(frozen=True)
class Surface:
    """Points or patches (n) that carry friction.

    area     : (n) [m2]
    approach : (n) [m] at tightening
    rigid    : (2 n, 3) shift along x, then along y, by motions along x, y and about z without deformation
    """

    area: Array
    approach: Array
    rigid: Array


@dataclass(frozen=True)
class Work:
    """Of friction on ways (s).

    forces : (s, 3 + k) [N, N.m] on motions and modes; stuck: the same if nothing slipped
    loss   : (s) [J] of a cycle as wide
    """

    forces: Array
    stuck: Array
    loss: Array

    @cached_property
    def scale(self) -> tuple[Array, Array, Array]:
        """What counts as one of each: all of a way's forces on motions, of those on modes, its loss."""
        return _size(self.forces), _size(self.stuck), np.maximum(self.loss, TINY * np.max(self.loss))


def _size(forces: Array) -> Array:
    """(s, 3 + k), alike for both directions, for the moment, and for all modes."""
    along, turn, modes = (np.linalg.norm(f, axis=1) for f in (forces[:, :2], forces[:, 2:3], forces[:, 3:]))
    arm = np.max(turn) / np.max(along)
    along = np.hypot(along, turn / arm)
    modes = np.maximum(modes, LEAST * np.max(modes / along) * along)
    return np.stack([along, along, arm * along, *[modes] * (forces.shape[1] - 3)], axis=1)


@dataclass(frozen=True)
class Friction:
    """Law of the contact from rest, at shifts (s, n): secant and tangent [Pa/m] of the traction, stiffness
    [Pa/m] without slip, loss [J/m2] of a cycle and its derivative [Pa] in the shift; size [m], u, v [m]."""

    u: Array
    v: Array
    size: Array
    secant: Array
    tangent: Array
    stick: Array
    loss: Array
    rate: Array

    @classmethod
    def of(cls, law: Foundation, approach: Array, shift: Array) -> "Friction":
        """Under approaches (n) [m] and shifts (s, 2 n) [m]."""
        u, v = np.split(shift, 2, axis=1)
        size = np.maximum(np.hypot(u, v), TINY)
        stick, tangent = (
            law.ratio * law.curve.derivatives(x, 1)[1]
            for x in (approach, approach - law.ratio / law.friction * size)
        )
        stick = np.broadcast_to(stick, size.shape)
        force = np.minimum(law.backbone(approach, size), stick * size)
        rate = 4.0 * (force - tangent * size)
        return cls(u, v, size, force / size, tangent, stick, law.loop(approach, size)[0], rate)


@dataclass(frozen=True)
class LinearContact:
    """What the contact of the linear joint stores: nothing slips.

    ways  : (w) of the linear joint, each motion alone
    shear : (w, w) [N/m, N, N.m] twice the energy that the contact stores on any two of these ways
    joint : (w) [N/m, N.m] stiffness of the joint along each motion
    """

    ways: Shears
    shear: Array
    joint: Array

    @cached_property
    def size(self) -> Array:
        """(w, w) what counts as one."""
        return np.sqrt(np.outer(self.joint, self.joint))


@dataclass(frozen=True)
class PatchWork:
    """What all points (q) do on ways of the joint, and patches (m) that are to do the same.

    law    : of the interface
    shears : the ways
    places : that carry the friction, several of each patch: all first ones, all second ones ...
    turned : (2 c m, k) what these c m places shift as modes turn the patches
    aim    : work of all points
    tight  : what they are to be while nothing slips
    """

    law: Foundation
    shears: Shears
    places: Surface
    turned: Array
    aim: Work
    tight: LinearContact

    def moved(self, shears: Shears, rows: Array) -> tuple[Array, Friction]:
        """Shift (2 c m, 3 + k) of the places by motions and modes, those of the patches by modes (2 m, k)
        given; friction on ways of the joint."""
        times = len(self.turned) // len(rows)
        by_modes = np.concatenate([np.tile(half, (times, 1)) for half in np.split(rows, 2)]) + self.turned
        return moved(self.law, shears, self.places, by_modes)

    def fitted(self, rows: Array) -> Array:
        """Rows (2 m, k) near given ones, by Levenberg and Marquardt's method.

        The tightened joint stays as stiff as its finite elements: at the equilibrium of the linear joint the
        contact stores as much. Forces on the modes count there in second order only.
        """
        typical = np.sqrt(np.mean(rows**2, axis=0))
        still = STAY * np.sqrt(len(self.aim.loss) / rows.size) / np.maximum(typical, LEAST * typical.max())
        still, begin, damping = np.broadcast_to(still, rows.shape), rows, FIRST_DAMPING
        missed, apart = self._missed(rows, still * (rows - begin)), self._tightened(rows)
        for _ in range(STEPS):
            slope = np.concatenate([self._slopes(rows), np.diag(still.ravel())])
            square, stiff = slope.T @ slope, self._tightened_slopes(rows)
            gradient, before = slope.T @ missed + stiff.T @ apart, missed @ missed + apart @ apart
            while damping < MOST_DAMPING:
                damped = square + stiff.T @ stiff + damping * np.diag(np.diag(square))
                there = rows + np.linalg.solve(damped, -gradient).reshape(rows.shape)
                trial = self._missed(there, still * (there - begin)), self._tightened(there)
                if sum(part @ part for part in trial) < before:
                    break
                damping *= MORE
            else:
                return rows
            rows, (missed, apart), damping = there, trial, LESS * damping
        return rows

    def _tightened(self, rows: Array) -> Array:
        """What the patches miss of the tightened stiffness."""
        _, at = self.moved(self.tight.ways, rows)
        missed = (stiffness(at, self.places.area) - self.tight.shear) / self.tight.size
        return np.asarray(EXACT * missed[np.triu_indices(len(missed))])

    def _tightened_slopes(self, rows: Array) -> Array:
        """Derivatives of what is missed of the tightened stiffness by the rows."""
        _, at = self.moved(self.tight.ways, rows)
        force = (self.places.area * at.stick * np.stack([at.u, at.v])).swapaxes(0, 1)
        force = force.reshape(len(force), 2, -1, len(rows) // 2).sum(axis=2).reshape(len(force), -1)
        half = np.einsum("im,jk->ijmk", force, self.tight.ways.amplitude)
        slope = (half + half.swapaxes(0, 1)) / self.tight.size[:, :, None, None]
        return np.asarray(EXACT * slope[np.triu_indices(len(slope))].reshape(-1, rows.size))

    def _missed(self, rows: Array, change: Array) -> Array:
        """What the patches miss of forces and loss, and their change."""
        every, at = self.moved(self.shears, rows)
        found, aim = work(at, self.places.area, every), self.aim
        pairs = ((found.forces, aim.forces), (found.stuck, aim.stuck), (found.loss, aim.loss))
        parts = [((a - b) / size).ravel() for (a, b), size in zip(pairs, aim.scale, strict=True)]
        return np.concatenate([*parts, change.ravel()])

    def _slopes(self, rows: Array) -> Array:
        """Derivatives of what is missed of forces and loss by the rows."""
        all_rows, at = self.moved(self.shears, rows)
        area, amplitude = self.places.area, self.shears.amplitude
        (ways, modes), count = amplitude.shape, len(rows) // 2
        unit, halves = (at.u / at.size, at.v / at.size), np.split(all_rows, 2)

        def of_patches(slope: Array, half: Array) -> Array:
            """Sums (s, 3 + k, m) over the places of each patch."""
            parts = slope.reshape(ways, -1, count), half.reshape(-1, count, 3 + modes)
            return np.einsum("scm,cmh->shm", *parts)

        def sums(each: Array) -> Array:
            return each.reshape(ways, -1, count).sum(axis=1)

        forces, loss = np.zeros((2, ways, 3 + modes, 2, count)), np.zeros((ways, 2, count))
        pulls, springs = np.zeros((2, ways, 2, count)), area * at.stick
        for i, (shift, along) in enumerate(zip((at.u, at.v), unit, strict=True)):
            for j in range(2):
                slope = area * ((i == j) * at.secant + (at.tangent - at.secant) * along * unit[j])
                forces[0, :, :, i] += of_patches(slope, halves[j])
            forces[1, :, :, i] = of_patches(springs, halves[i])
            pulls[:, :, i] = sums(area * at.secant * shift), sums(springs * shift)
            loss[:, i] = sums(area * at.rate * along)
        by_rows, own = forces[..., None] * amplitude[:, None, None, None], np.arange(modes)
        by_rows[:, :, 3 + own, :, :, own] += pulls
        each = *by_rows, loss[..., None] * amplitude[:, None, None]
        parts = zip(each, self.aim.scale, strict=True)
        return np.concatenate([(x / s.reshape(s.shape + (1,) * 3)).reshape(-1, rows.size) for x, s in parts])


def rigid_shifts(place: Array) -> Array:
    """Shifts (2 n, 3) of places (n, 2), along x, then along y, by motions along x, y and about z."""
    x, y = place.T
    one, zero = np.ones_like(x), np.zeros_like(x)
    return np.concatenate([np.stack([one, zero, -y], axis=1), np.stack([zero, one, x], axis=1)])


def turned(place: Array, patches: FrictionPatches, means: sp.csr_matrix, traces: list[Array]) -> Array:
    """Turns (m, k) [1/m] of the patches about their centres by modes that shift the contact at
    places (q, 2) [m] by traces (q, k).

    Of each the mean over its cell, by the weights of means (m, q) there and the square of the distance.
    """
    cell = cKDTree(patches.position).query(place)[1]
    x, y = (place - (means @ place)[cell]).T
    lever, square = x[:, None] * traces[1] - y[:, None] * traces[0], means @ (x * x + y * y)
    some = square > 0.0
    return np.asarray(np.where(some, 1.0 / np.where(some, square, 1.0), 0.0)[:, None] * (means @ lever))


def on_circles(patches: FrictionPatches, area: float, approach: Array, turns: Array) -> tuple[Surface, Array]:
    """Places of the sliders of patches on a nominal area [m2] at approaches (m) [m], and what they shift by
    turns (m, k) [1/m]."""
    places = CIRCLE if np.any(patches.radius) else 0.0 * CIRCLE[:1]
    away = places[:, None] * patches.radius[:, None]
    count, (x, y) = len(places), away.reshape(-1, 2).T[:, :, None]
    each = np.tile(turns, (count, 1))
    there = Surface(
        np.tile(area * patches.share / count, count),
        np.tile(approach, count),
        rigid_shifts((patches.position + away).reshape(-1, 2)),
    )
    return there, np.concatenate([-y * each, x * each])


def moved(law: Foundation, shears: Shears, surface: Surface, rows: Array) -> tuple[Array, Friction]:
    """Shift (2 n, 3 + k) of a surface by motions and modes, and its friction on ways of the joint."""
    every = np.concatenate([surface.rigid, rows], axis=1)
    amount = np.concatenate([shears.motion, shears.amplitude], axis=1)
    return every, Friction.of(law, surface.approach, amount @ every.T)


def work(at: Friction, area: Array, every: Array) -> Work:
    """Of the friction of areas (n) [m2] which motions and modes shift by (2 n, 3 + k)."""
    forces, stuck = (
        np.concatenate([area * slope * shift for shift in (at.u, at.v)], axis=1) @ every
        for slope in (at.secant, at.stick)
    )
    return Work(forces, stuck, at.loss @ area)


def stiffness(at: Friction, area: Array) -> Array:
    """Of springs of areas (n) [m2] on ways (w) while nothing slips (w, w) [N/m, N, N.m]."""
    return np.asarray(sum((area * at.stick * shift) @ shift.T for shift in (at.u, at.v)))


def work_of(law: Foundation, shears: Shears, surface: Surface, rows: Array) -> Work:
    """Of the friction of a surface that modes shift by rows (2 n, k), on ways of the joint."""
    every, at = moved(law, shears, surface, rows)
    return work(at, surface.area, every)
