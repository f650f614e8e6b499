"""Jenkins sliders: a spring and a dry friction in series each, whose limit may follow a load.

What a straight path does to one slider is written once, in `trial` and `slide`: with arrays for many sliders,
with symbols for the C in the FMUs and its derivatives. Paths are along one direction or in a plane: vectors
have one component or two.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantity import Number, where

Array = NDArray[np.float64]
Vector = Sequence[Number]
ROUND_OFF = 1e-14
"""By which a force that came back to its limit may be beyond it [1]: it sticks where nothing moves."""
AT_LIMIT = 1e-12
"""By which a force may be below its limit and count as at it [1]."""
NOTHING = 1e-200
"""What divides in place of 0: square of a force, or force times force."""


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


_Returned = tuple[Vector, Vector, Number, Number, Number]
"""Forces, tangent, slip; a trial force of this size, and its product with the force before."""


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
    force: Vector, tried: Vector, before: Number, after: Number, stiffness: Number, compliance: Number
) -> Slid:
    """A slider after a straight path with a `trial` force; its limit goes from `before` to `after`.

    Beyond the limit the force returns to the friction circle, straight to its centre: exact for paths along
    one direction, of first order for turning ones. The heat is the mean of the limit while it slips times the
    slip, exact for a stiffness that stays: under constant load, and along one direction under any.

    compliance : 1/stiffness, 0 without springs
    """
    returned = _along if len(tried) == 1 else _in_a_plane
    moved, tangent, slip, size, work = returned(force, tried, after, stiffness)
    margin = np.maximum(before * size - work, 0.0)
    onset = margin / np.maximum(margin + slip * size, NOTHING)
    mean = 0.5 * (after + before + onset * (after - before))
    return Slid(moved, tangent, mean * (slip * compliance), slip)


def _along(force: Vector, tried: Vector, limit: Number, stiffness: Number) -> _Returned:
    moved = np.minimum(np.maximum(tried[0], -limit), limit)
    slip = np.abs(tried[0] - moved)
    slips = slip > 0.0
    before = where(tried[0] < 0.0, -force[0], force[0])
    return [moved], [where(slips, 0.0, stiffness), stiffness], slip, 1.0, before


def _in_a_plane(force: Vector, tried: Vector, limit: Number, stiffness: Number) -> _Returned:
    x, y = tried
    slips = beyond(tried, limit) > 0.0
    square = np.maximum(np.maximum(limit * limit, x * x + y * y), NOTHING)
    size = np.sqrt(square)
    inverse = 1.0 / (size * square)
    part = where(slips, limit * inverse * square, 1.0)
    spent = where(reaches(tried, limit) > 0.0, stiffness * size * inverse, 0.0)
    tangent = [stiffness - spent * x * x, -spent * x * y, stiffness - spent * y * y]
    return [part * x, part * y], tangent, where(slips, size - limit, 0.0), size, force[0] * x + force[1] * y


@dataclass(frozen=True, slots=True)
class Moved:
    """Sliders side by side after a straight path; of forces and stiffnesses of any unit, per area or whole.

    force   : (..., n) of each along a single direction, (..., 2, n) in a plane
    loss    : (...) turned into heat on the way
    tangent : (...) of a further motion, see `Slid`; (..., 3): xx, xy, yy in a plane
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
        tried = trial([force], 1.0, self.stiffness, [np.asarray(shift)[..., None]])
        slid = slide([force], tried, before, after, self.stiffness, self.compliance)
        return Moved(np.asarray(slid.force[0]), np.sum(slid.loss, axis=-1), np.sum(slid.tangent[0], axis=-1))


def compliance(stiffness: Number) -> Number:
    """1/stiffness, 0 without springs."""
    some = stiffness > 0.0
    return where(some, 1.0 / where(some, stiffness, 1.0), 0.0)
