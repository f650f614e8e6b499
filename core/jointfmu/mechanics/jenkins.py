"""Jenkins sliders: a spring and a dry friction in series each, whose limit may follow a load.

What a straight path does to one slider is written once, in `trial` and `slide`: with arrays for many sliders,
with symbols for the C in the FMUs and its derivatives. Paths are along one direction or in a plane: vectors
have one component or two.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..quantity import Array, Number, where

Vector = Sequence[Number]
ROUND_OFF = 1e-14
"""By which a force that came back to its limit may be beyond it [1]: it sticks where nothing moves."""
AT_LIMIT = 1e-12
"""By which a force may be below its limit and count as at it [1]."""
NOTHING = 1e-200
"""What divides in place of 0: powers of forces, the square of a shift."""
TWELFTH = 1.0 / 12.0
LARGEST = 1e30
"""Of 1/limit, where there is hardly any."""


def trial(force: Vector, keeps: Number, carries: Number, shift: Vector) -> Vector:
    """Force of a slider that sticks: it keeps a part of what it had and carries so much of the shift."""
    return [keeps * q + carries * u for q, u in zip(force, shift, strict=True)]


def beyond(force: Vector, limit: Number) -> Number:
    """Positive for a trial force beyond the limit, in a plane by more than round-off: squared there."""
    if len(force) == 1:
        return np.abs(force[0]) - limit
    return force[0] * force[0] + force[1] * force[1] - (1.0 + ROUND_OFF) * (limit * limit)


def reaches(force: Vector, limit: Number) -> Number:
    """Positive for a trial force at its limit or beyond: it slips, or would in a motion along it."""
    least = (1.0 - AT_LIMIT) * limit
    if len(force) == 1:
        return np.abs(force[0]) - least
    return force[0] * force[0] + force[1] * force[1] - least * least


_Returned = tuple[Vector, Vector, Number, Number]
"""Forces, tangent, slip, mean of the limit meanwhile."""


@dataclass(frozen=True, slots=True)
class Slid:
    """One slider, or many, after a straight path.

    force   : along the path's directions
    tangent : of a further motion: along and across a single direction; xx, xy, yy in a plane, where a slider
              at its limit slips on along its force n, K (1 - n n), by whatever step it came there
    loss    : turned into heat on the way
    slip    : trial force beyond the limit, 0 of a slider that sticks
    """

    force: Vector
    tangent: Vector
    loss: Number
    slip: Number


def slide(
    force: Vector,
    keeps: Number,
    carries: Number,
    shift: Vector,
    before: Number,
    after: Number,
    stiffness: Number,
    compliance: Number,
) -> Slid:
    """A slider after a straight path, see `trial`; its limit goes from `before` to `after`.

    Along one direction the force returns to its limit, and the heat is the mean of the limit while it slips
    times the slip: exact for a stiffness that stays. In a plane it turns towards the shift while it slips,
    tan(angle/2) between both falling as exp(-K way/limit) under constant load (Krieg and Krieg 1977): met to
    the third order of the way, with its heat, and exactly where nothing turns.

    compliance : 1/stiffness, 0 without springs
    """
    tried = trial(force, keeps, carries, shift)
    if len(tried) == 1:
        moved, tangent, slip, mean = _along(force, tried, before, after, stiffness)
    else:
        moved, tangent, slip, mean = _in_a_plane(force, tried, shift, carries, (before, after), stiffness)
    return Slid(moved, tangent, mean * (slip * compliance), slip)


def returned(force: Number, limit: Number) -> Number:
    """A trial force along one direction, which returns to its limit."""
    return np.minimum(np.maximum(force, -limit), limit)


def _along(force: Vector, tried: Vector, before: Number, limit: Number, stiffness: Number) -> _Returned:
    moved = returned(tried[0], limit)
    slip = np.abs(tried[0] - moved)
    slips = slip > 0.0
    margin = np.maximum(before - where(tried[0] < 0.0, -force[0], force[0]), 0.0)
    onset = margin / np.maximum(margin + slip, NOTHING)
    mean = 0.5 * (limit + before + onset * (limit - before))
    return [moved], [where(slips, 0.0, stiffness), stiffness], slip, mean


def _in_a_plane(
    force: Vector, tried: Vector, shift: Vector, carries: Number, limits: Vector, stiffness: Number
) -> _Returned:
    """The trial force, and half of K way times slip over limit more along the shift, returns to the centre.

    A turn by g = K way/limit so ends within g^3 of where a slipping force does, whatever the limit does on
    the way; a limit that falls far turns it by no more than its size, so that a force against the shift does
    not jump to the other side. The slip is |trial| - limit, and limit g^2 (sin^2 before - sin^2 after)/12 by
    Hermite's rule, of the angle between force and shift.
    """
    before, limit = limits
    way = np.sqrt(np.maximum(shift[0] * shift[0] + shift[1] * shift[1], NOTHING))
    e_x, e_y = shift[0] / way, shift[1] / way
    square, squared = tried[0] * tried[0] + tried[1] * tried[1], limit * limit
    largest = np.maximum(np.maximum(squared, square), NOTHING)
    size = np.sqrt(largest)
    slips, out = beyond(tried, limit) > 0.0, size - limit
    margin = np.maximum(before * size - (force[0] * tried[0] + force[1] * tried[1]), 0.0)
    sum_ = margin + out * size
    inverse = 1.0 / np.maximum(limit * sum_, NOTHING)
    per_limit, share = np.minimum(inverse * sum_, LARGEST), inverse * (limit * (out * size))
    left = share * (carries * way)
    held = np.minimum(np.maximum(before * before, squared), largest)
    lost = held - squared  # by a limit that shrinks, from where it slips on
    shrinks = squared * squared + lost * lost / 16.0
    per_shrinks = 1.0 / np.maximum(shrinks * held, NOTHING)
    turns = 0.25 * (lost * squared * held + (largest - held) * shrinks) * per_shrinks
    more_by = turns - TWELFTH * shrinks * per_shrinks * (left * left)
    more = where(slips, left * more_by, 0.0)
    ahead = [q + more * e for q, e in zip(tried, (e_x, e_y), strict=True)]
    size2 = np.maximum(ahead[0] * ahead[0] + ahead[1] * ahead[1], NOTHING)
    per_size = np.sqrt(size2) / size2
    n = [per_size * q for q in ahead]
    across = n[0] * e_y - n[1] * e_x
    turned = left * across
    hermite = turned * turned * np.maximum(1.0 - squared * (per_size * per_size), 0.0) * (TWELFTH * per_limit)
    spent = where(reaches(tried, limit) > 0.0, stiffness, 0.0)
    tangent = [stiffness - spent * n[0] * n[0], -spent * n[0] * n[1], stiffness - spent * n[1] * n[1]]
    moved = [where(slips, limit * m, q) for m, q in zip(n, tried, strict=True)]
    mean = 0.5 * (before + limit + (1.0 - share) * (limit - before))
    return moved, tangent, where(slips, out + hermite, 0.0), mean


@dataclass(frozen=True, slots=True)
class Moved:
    """Sliders side by side after a straight path; of forces and stiffnesses of any unit, per area or whole.

    force   : (..., n) of each along a single direction, (..., 2, n) in a plane
    loss    : (...) turned into heat on the way
    tangent : (...) of a further motion, see `Slid`; (..., 6) of a foundation in a plane: xx, xy, yy, xt, yt,
              tt, t the way around the centre of its patch
    """

    force: Array
    loss: Array
    tangent: Array

    @property
    def traction(self) -> Array:
        """Sum of the forces (...) or (..., 2)."""
        return np.asarray(np.sum(self.force, axis=-1))


@dataclass(frozen=True, slots=True)
class Sliders:
    """Sliders side by side; `stiffness` (..., n) of their springs."""

    stiffness: Array

    @property
    def acts(self) -> bool:
        """Whether there is any."""
        return bool(np.any(self.stiffness > 0.0))

    @property
    def compliance(self) -> Array:
        """Of the springs (..., n), 0 without."""
        return np.asarray(compliance(self.stiffness))

    def along(self, force: Array, shift: ArrayLike, before: Array, after: Array) -> Moved:
        """After shifts (...) along a single direction with forces (..., n) and limits (..., n)."""
        moved = [np.asarray(shift)[..., None]]
        slid = slide([force], 1.0, self.stiffness, moved, before, after, self.stiffness, self.compliance)
        return Moved(np.asarray(slid.force[0]), np.sum(slid.loss, axis=-1), np.sum(slid.tangent[0], axis=-1))

    def path(self, ways: Array, limit: Array) -> Array:
        """Sums (m) of the forces after each of the ways (m) along a single direction, from rest, under limits
        (n) that stay."""
        force, found = np.zeros_like(limit), np.empty(ways.size)
        for n, way in enumerate(ways):
            force = returned(trial([force], 1.0, self.stiffness, [way])[0], limit)
            found[n] = np.add.reduce(force)
        return found


def compliance(stiffness: Number) -> Number:
    """1/stiffness, 0 without springs."""
    some = stiffness > 0.0
    return where(some, 1.0 / where(some, stiffness, 1.0), 0.0)
