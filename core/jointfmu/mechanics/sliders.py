"""Friction with memory: the foundation of sliders that follows from a normal law.

For elastically similar bodies the tangential contact in partial slip is the difference of two normal ones
(Jaeger 1995, Ciavarella 1998), and a foundation of independent springs that touch one after the other
reproduces it for any history (Popov and Hess 2015). Springs at heights h touch when the approach delta is
above h. Each has the normal stiffness p''(h) dh, ratio times as much along the surface, and slips when its
force along the surface reaches friction times its normal force; a spring that lifts off forgets.

Here two sliders stand for the springs between two heights. Their stiffness and their friction limit are the
sums over those of the springs that touch, so the foundation is exact in full stick and in gross slip at every
approach; they differ by the spread of the springs' limits, which the loss of a loop needs.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantity import Number, where
from .curve import Curve
from .footprint.reproducible import to_digits

Array = NDArray[np.float64]

SMALL = 1e-3
"""Change of the approach over the height of a slider [1] below which its mean stiffness is integrated by the
derivatives at the ends (to the fourth order) and not by the difference of its limits, which cancels."""
LOBATTO = 0.1 * np.sqrt(5.0)
"""Distance of the two inner points of Lobatto's rule from the middle of a path [1]."""
SPREAD = 1.0 / np.sqrt(12.0)
"""Standard deviation of evenly spread springs over the range of their heights [1]."""


BELOW, ABOVE = 10, 7
"""Heights of `around` between none and the reference, and between it and the end of the curve."""
SLIDERS = 2 * (BELOW + ABOVE + 2)
"""Sliders of a foundation with these heights."""
LOWEST, HIGHEST, USUAL = 1e-5, 0.1, 1e-3
"""Least and largest load of a reference, and that without one, over the load at the end of the curve [1]."""


def offsets(load: Array) -> Array:
    """Offsets (n) [1] of `around` for foundations side by side under loads (n), of whatever unit.

    Multiples of the golden section in the order of the loads, equal ones in that of their places: what
    neighbours in it miss cancels.
    """
    rank = np.argsort(np.argsort(-to_digits(load), kind="stable"), kind="stable")
    return np.asarray((rank * (0.5 * (np.sqrt(5.0) - 1.0)) + 0.5) % 1.0)


def around(curve: Curve, reference: ArrayLike, offset: ArrayLike) -> Array:
    """Heights (..., n) [m] for contacts that move along their surface at about an approach.

    They lie close to it, where the first springs slip, and where the last ones touch.

    reference : (...) [m] the approach; without contact there a usual one is taken
    offset    : (...) in (0, 1) [1] shifts the heights; where those of several foundations differ, so do the
                steps in which their springs slip, and cancel in the sum
    """
    given, part = np.asarray(reference, dtype=np.float64), np.asarray(offset, dtype=np.float64)[..., None]
    end = curve.end[1]
    load = curve.derivatives(given, 0)[0]
    touches = load > LOWEST * end
    load = np.where(touches, np.minimum(load, HIGHEST * end), USUAL * end)[..., None]
    down = (np.arange(BELOW)[::-1] + part) / BELOW
    up = (np.arange(ABOVE) + part) / ABOVE
    below = load * (1.0 - down) ** 2 / (down**2 + (1.0 - down) ** 2)
    above = load * np.exp(np.log(end / load) * up**2)
    lowest, last = (np.full_like(load, x) for x in curve.displacement[[0, -1]])
    between = curve.inverse(np.concatenate([below, load, above], axis=-1))
    between[..., BELOW] = np.where(touches & (load[..., 0] < HIGHEST * end), given, between[..., BELOW])
    return np.concatenate([lowest, between, last], axis=-1)


@dataclass(frozen=True, slots=True)
class Carried:
    """What sliders (..., n) have at an approach, per area.

    stiffness : [Pa/m] along the surface; 0 without contact
    limit     : [Pa] of the friction
    slope     : [Pa/m2] derivative of the stiffness in the approach
    change    : [Pa/m] derivative of the limit in the approach
    """

    stiffness: Array
    limit: Array
    slope: Array
    change: Array


@dataclass(frozen=True, slots=True)
class Moved:
    """Sliders after a straight path, per area.

    force   : (..., 2, n) [Pa] of each slider, along the shift
    loss    : (...) [J/m2] turned into heat on the way
    tangent : (..., 3) [Pa/m] derivative of the sum of the forces in a further shift: xx, xy, yy
    """

    force: Array
    loss: Array
    tangent: Array

    @property
    def traction(self) -> Array:
        """Sum of the forces (..., 2) [Pa]."""
        return np.asarray(np.sum(self.force, axis=-1))


@dataclass(frozen=True)
class Foundation:
    """The sliders of an interface.

    curve    : pressure [Pa] over approach [m], convex
    ratio    : K_T/K_N [1]
    friction : mu [1]
    height   : (..., n/2 + 1) [m] between which the springs are taken together, increasing; foundations side
               by side may have heights of their own

    The sliders stand in the order of the heights, of each range first that of the springs that slip earlier.
    """

    curve: Curve
    ratio: float
    friction: float
    height: Array

    @property
    def sliders(self) -> int:
        """How many there are."""
        return 2 * int(self.height.shape[-1] - 1)

    def at_rest(self, *shape: int) -> Array:
        """Forces (*shape, 2, n) of sliders that have not moved."""
        return np.zeros((*shape, 2, self.sliders))

    def backbone(self, approach: ArrayLike, shift: ArrayLike) -> Array:
        """Traction (...) [Pa] from rest over shifts (...) >= 0 [m], at approaches (...) [m] that stay.

        mu [p(delta) - p(delta - kappa u/mu)]: of all springs, without the sliders' steps.
        """
        now, then = (self.curve.derivatives(x, 0)[0] for x in self._between(approach, shift))
        return np.asarray(self.friction * (now - then))

    def work(self, approach: ArrayLike, shift: ArrayLike) -> Array:
        """Integral (...) [J/m2] of the backbone over the shift from 0."""
        now, then = self._between(approach, shift)
        energy = self.curve.energy(now) - self.curve.energy(then)
        whole = self.curve.derivatives(now, 0)[0] * np.asarray(shift, dtype=np.float64)
        return np.asarray(self.friction * (whole - self.friction / self.ratio * energy))

    def _between(self, approach: ArrayLike, shift: ArrayLike) -> tuple[Array, Array]:
        """Heights between which springs have slipped."""
        now, moved = np.asarray(approach, dtype=np.float64), np.asarray(shift, dtype=np.float64)
        return now, np.asarray(now - moved / (self.friction / self.ratio))

    def _ranges(self) -> tuple[Array, Array]:
        """Lower and upper ends (..., n/2) [m] of the ranges of heights."""
        return self.height[..., :-1], self.height[..., 1:]

    @cached_property
    def _ends(self) -> list[Array]:
        """Load [Pa] and stiffness [Pa/m] of the curve at the heights."""
        return self.curve.derivatives(self.height, 1)

    def carried(self, approach: ArrayLike) -> Carried:
        """What the sliders have at approaches (...) [m]."""
        delta = np.asarray(approach, dtype=np.float64)[..., None]
        low, high = self._ranges()
        full, touches = delta >= high, delta > low
        now, ends = self.curve.derivatives(delta, 2), self._ends
        first, last = ([end[..., part] for end in ends] for part in (slice(-1), slice(1, None)))
        load, springs = (np.where(full, b, a) for a, b in zip(now[:2], last, strict=True))
        springs = np.where(touches, np.maximum(springs - first[1], 0.0), 0.0)
        inside = np.minimum(delta, high)
        normal = load - first[0] - first[1] * (inside - low)
        normal = np.where(touches, np.maximum(normal, 0.0), 0.0)
        rises = (delta >= low) & ~full
        bend = np.where(rises, now[2], 0.0)
        spread = SPREAD * np.where(touches, inside - low, 0.0)
        narrow = springs * spread < normal  # else the springs begin at the lower height
        apart = np.where(narrow, springs * spread, normal)
        parts = np.where(rises, np.where(narrow, bend * spread + springs * SPREAD, springs), 0.0)
        normal = normal + springs * (delta - inside)
        half, limit = 0.5 * self.ratio, 0.5 * self.friction
        return Carried(
            np.repeat(half * springs, 2, axis=-1),
            limit * _pairs(normal - apart, normal + apart),
            np.repeat(half * bend, 2, axis=-1),
            limit * _pairs(springs - parts, springs + parts),
        )

    def moved(self, force: Array, before: ArrayLike, after: ArrayLike, shift: ArrayLike) -> Moved:
        """The sliders after a straight path.

        force         : (..., 2, n) [Pa] of the sliders before
        before, after : (...) [m] approaches
        shift         : (..., 2) [m] of the other side along the surface

        While the approach grows a slider's stiffness does, by springs that touch without a force; while it
        falls the springs that lift off take theirs with them. Beyond the limit the force returns to the
        friction circle. Exact for paths along one direction, of first order for turning ones.

        Heat is the work less the change of the elastic energy: exact for sliders whose stiffness stays, see
        `slip_loss`, else of third order in the path.
        """
        path, end = _Path.of(before, after, shift), self.carried(after)
        start = self.carried(before) if np.any(path.change) else end
        keeps, carries = (1.0, end.stiffness) if start is end else self._carrying(start, end, path)
        old, along = (force[..., 0, :], force[..., 1, :]), (path.along[..., 0, :], path.along[..., 1, :])
        x, y, beyond, *tangent = slide(*old, keeps, carries, *along, end.limit, end.stiffness)
        loss = slip_loss(*old, x, y, beyond, start.limit, end.limit, end.stiffness)
        new = np.stack([x, y], axis=-2)
        changes = start.stiffness != end.stiffness
        if np.any(changes):
            energy = _elastic(new, end.stiffness) - _elastic(force, start.stiffness)
            work = self._work(force, new, start, end, path, beyond > 0.0)
            loss = np.where(changes, np.maximum(work - energy, 0.0), loss)
        return Moved(new, np.sum(loss, axis=-1), np.stack([np.sum(t, axis=-1) for t in tangent], axis=-1))

    def _carrying(self, start: Carried, end: Carried, path: "_Path") -> tuple[Array, Array]:
        """Part of their forces (..., n) that sliders keep on a path [1], and what the shift adds [Pa/m]."""
        mean = self._mean_stiffness(start, end, path)
        kept = np.divide(end.stiffness, start.stiffness, out=np.zeros_like(mean), where=start.stiffness > 0.0)
        grows = path.change >= 0.0
        return np.where(grows, 1.0, np.minimum(kept, 1.0)), np.where(grows, mean, end.stiffness)

    def _work(
        self, force: Array, new: Array, start: Carried, end: Carried, path: "_Path", slips: NDArray[np.bool_]
    ) -> Array:
        """Work (..., n) [J/m2] put into the sliders.

        By Hermite's rule from the ends of the path, by Lobatto's with two more points for those whose springs
        begin or cease to touch on it.
        """
        work = 0.5 * np.sum((force + new) * path.along, axis=-2)
        square = np.sum(path.along**2, axis=-2)
        work += np.where(slips, 0.0, square * (start.stiffness - end.stiffness) / 12.0)
        crosses = ~self._stays(path)
        if not np.any(crosses):
            return np.asarray(work)
        total = (force + new) / 12.0
        for part in (0.5 - LOBATTO, 0.5 + LOBATTO):
            so_far = path.part(part)
            there = self.carried(so_far.last[..., 0])
            keeps, carries = self._carrying(start, there, so_far)
            along = so_far.along[..., 0, :], so_far.along[..., 1, :]
            x, y, *_ = slide(force[..., 0, :], force[..., 1, :], keeps, carries, *along, there.limit, 0.0)
            total += 5.0 / 12.0 * np.stack([x, y], axis=-2)
        return np.asarray(np.where(crosses, np.sum(total * path.along, axis=-2), work))

    def _stays(self, path: "_Path") -> NDArray[np.bool_]:
        """Whether all, some or none of the springs of sliders (..., n) touch at both ends of a path alike."""
        low, high = (np.repeat(h, 2, axis=-1) for h in self._ranges())
        first, last = path.first, path.last
        return np.asarray(((first > low) == (last > low)) & ((first >= high) == (last >= high)))

    def _mean_stiffness(self, start: Carried, end: Carried, path: "_Path") -> Array:
        """Stiffness (..., n) of the sliders on average over a path."""
        change = path.change
        ends = 0.5 * (start.stiffness + end.stiffness) + change * (start.slope - end.slope) / 12.0
        small = np.abs(change) < SMALL * np.repeat(np.diff(self.height), 2, axis=-1)
        differs = (change != 0.0) & ~(self._stays(path) & small)
        rise = (end.limit - start.limit).reshape(*ends.shape[:-1], -1, 2).sum(axis=-1)
        half = 0.5 * self.ratio * np.repeat(rise, 2, axis=-1)
        difference = np.divide(half, self.friction * change, out=ends.copy(), where=differs)
        return np.asarray(np.where(start.stiffness == end.stiffness, end.stiffness, difference))


@dataclass(frozen=True, slots=True)
class _Path:
    """A straight path: approaches (..., 1) [m] at its ends, shift (..., 2, 1) [m]."""

    first: Array
    last: Array
    along: Array

    @classmethod
    def of(cls, before: ArrayLike, after: ArrayLike, shift: ArrayLike) -> "_Path":
        first, last, along = (np.asarray(x, dtype=np.float64)[..., None] for x in (before, after, shift))
        return cls(first, last, along)

    @property
    def change(self) -> Array:
        """Of the approach (..., 1) [m]."""
        return np.asarray(self.last - self.first)

    def part(self, part: float) -> "_Path":
        """Its beginning."""
        return _Path(self.first, self.first + part * self.change, part * self.along)


def _pairs(early: Array, late: Array) -> Array:
    """Values (..., n/2) of the two sliders of each range as those (..., n) of all."""
    return np.stack([early, late], axis=-1).reshape(*early.shape[:-1], -1)


def _elastic(force: Array, stiffness: Array) -> Array:
    """Elastic energy (..., n) [J/m2] of sliders."""
    square = np.sum(force**2, axis=-2)
    energy = np.divide(square, 2.0 * stiffness, out=np.zeros_like(stiffness), where=stiffness > 0.0)
    return np.asarray(energy)


def slide(
    force_x: Number,
    force_y: Number,
    keeps: Number,
    carries: Number,
    shift_x: Number,
    shift_y: Number,
    limit: Number,
    stiffness: Number,
) -> tuple[Number, ...]:
    """A slider after a straight path: its force along x and y, how far it would be beyond its limit, and the
    derivatives xx, xy, yy of the force in a further shift.

    It keeps the part `keeps` of its force, gains `carries` times the shift and returns to the circle `limit`,
    on which it only turns; at the end of the path its stiffness is `stiffness`.
    """
    x, y = keeps * force_x + carries * shift_x, keeps * force_y + carries * shift_y
    square = x * x + y * y
    slips = square > limit * limit
    size = np.sqrt(where(slips, square, 1.0))
    part = where(slips, limit / size, 1.0)
    turns, turned = part * stiffness, where(slips, 1.0 / (size * size), 0.0)
    return (
        part * x,
        part * y,
        where(slips, size - limit, 0.0),
        turns * (1.0 - turned * x * x),
        -turns * turned * x * y,
        turns * (1.0 - turned * y * y),
    )


def slip_loss(
    force_x: Number,
    force_y: Number,
    moved_x: Number,
    moved_y: Number,
    beyond: Number,
    before: Number,
    after: Number,
    stiffness: Number,
) -> Number:
    """Work [J/m2] that a slider of constant stiffness turns into heat on a path.

    The mean of the limit, which goes from `before` to `after`, while it slips, times the slip
    beyond/stiffness. Exact under constant normal load, and along one direction under any.
    """
    slips, some = beyond > 0.0, stiffness > 0.0
    aligned = (force_x * moved_x + force_y * moved_y) / where(after > 0.0, after, 1.0)
    margin = np.maximum(before - aligned, 0.0)
    onset = margin / where(slips, margin + beyond, 1.0)
    limit = 0.5 * (after + before + onset * (after - before))
    return where(slips, limit * beyond * where(some, 1.0 / where(some, stiffness, 1.0), 0.0), 0.0)
