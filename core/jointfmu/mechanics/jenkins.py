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
"""What divides in place of 0: square of a force or a shift, or force times force."""
MOST_TURNED = 1e6
"""Way over limit/stiffness [1] after which a force that slips is along the shift."""


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
"""Forces, tangent, slip; size of the trial force."""


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
    unit: Vector | None = None,
) -> Slid:
    """A slider after a straight path, see `trial`; its limit goes from `before` to `after`.

    Along one direction the force returns to its limit. In a plane it turns towards the shift while it slips:
    under constant load tan(angle/2) between both falls as exp(-K way/limit) (Krieg and Krieg 1977), within
    WITHIN whatever the step. A force beyond a limit that fell returns to the centre. The heat is the mean of
    the limit while it slips times the slip, exact for a stiffness that stays along one direction, of second
    order for turning paths.

    compliance : 1/stiffness, 0 without springs
    unit       : direction and size of a shift in a plane, where they are known
    """
    tried = trial(force, keeps, carries, shift)
    if len(tried) == 1:
        moved, tangent, slip, size = _along(tried, after, stiffness)
        work = where(tried[0] < 0.0, -force[0], force[0])
    else:
        kept = [keeps * q for q in force]
        way = direction(shift) if unit is None else unit
        moved, tangent, slip, size = _in_a_plane(kept, tried, carries, way, after, stiffness)
        work = force[0] * tried[0] + force[1] * tried[1]
    margin = np.maximum(before * size - work, 0.0)
    onset = margin / np.maximum(margin + slip * size, NOTHING)
    mean = 0.5 * (after + before + onset * (after - before))
    return Slid(moved, tangent, mean * (slip * compliance), slip)


def _along(tried: Vector, limit: Number, stiffness: Number) -> _Returned:
    moved = np.minimum(np.maximum(tried[0], -limit), limit)
    slip = np.abs(tried[0] - moved)
    slips = slip > 0.0
    return [moved], [where(slips, 0.0, stiffness), stiffness], slip, 1.0


def direction(shift: Vector) -> Vector:
    """Unit vector of a shift in a plane, and its size."""
    way = np.sqrt(np.maximum(shift[0] * shift[0] + shift[1] * shift[1], NOTHING))
    return [shift[0] / way, shift[1] / way, way]


def _in_a_plane(
    kept: Vector, tried: Vector, carries: Number, unit: Vector, limit: Number, stiffness: Number
) -> _Returned:
    """The kept force grows along the shift up to the circle of its limit, or of its own where that is larger.

    With c of it along the shift there and g = K way/limit of the rest, it ends along the trial force and more
    of the shift: c (cosh g - 1) + limit (sinh g - g), by their series.
    """
    square, own, squared = (x * x + y * y for x, y in (tried, kept, (limit, 0.0)))
    size = np.sqrt(np.maximum(np.maximum(squared, square), NOTHING))
    slips = beyond(tried, limit) > 0.0
    *unit, way = unit
    first = kept[0] * unit[0] + kept[1] * unit[1]
    begin = np.sqrt(np.maximum(np.maximum(squared - own, 0.0) + first * first, NOTHING))
    left = np.maximum(first + carries * way - begin, 0.0)
    g = np.minimum(left / np.maximum(limit, NOTHING), MOST_TURNED)
    g2 = g * g
    more = g2 * (begin * (1 / 2 + g2 * (1 / 24)) + limit * (g * (1 / 6 + g2 * (1 / 120))))
    ahead = [q + where(slips, more, 0.0) * e for q, e in zip(tried, unit, strict=True)]
    inverse = 1.0 / np.sqrt(np.maximum(ahead[0] * ahead[0] + ahead[1] * ahead[1], NOTHING))
    n = [inverse * q for q in ahead]
    spent = where(reaches(tried, limit) > 0.0, stiffness, 0.0)
    tangent = [stiffness - spent * n[0] * n[0], -spent * n[0] * n[1], stiffness - spent * n[1] * n[1]]
    moved = [where(slips, limit * m, q) for m, q in zip(n, tried, strict=True)]
    return moved, tangent, where(slips, size - limit, 0.0), size


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
        moved = [np.asarray(shift)[..., None]]
        slid = slide([force], 1.0, self.stiffness, moved, before, after, self.stiffness, self.compliance)
        return Moved(np.asarray(slid.force[0]), np.sum(slid.loss, axis=-1), np.sum(slid.tangent[0], axis=-1))


def compliance(stiffness: Number) -> Number:
    """1/stiffness, 0 without springs."""
    some = stiffness > 0.0
    return where(some, 1.0 / where(some, stiffness, 1.0), 0.0)
