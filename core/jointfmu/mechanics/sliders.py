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
from functools import cache, cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantity import Array, Number, where
from .curve import Curve
from .footprint.reproducible import ranks, to_digits
from .jenkins import Moved, Slid, Vector, compliance, slide

SMALL = 1e-3
"""Change of the approach over the height of a slider [1] below which its mean stiffness is integrated by the
derivatives at the ends (to the fourth order) and not by the difference of its limits, which cancels."""
SHORT = 3e-2
"""Fall of the load over an amplitude, by the stiffness, over the load [1]: below it a loop is taken from the
derivatives of the curve, as its differences cancel."""
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""The golden section [1]."""
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
    return np.asarray((ranks(load) * GOLDEN + 0.5) % 1.0)


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


def lowered(height: Array, lowest: ArrayLike) -> Array:
    """Heights (..., n) [m], of which the next one above the lowest approach (...) [m] so far lies at it.

    Springs above it have lifted off meanwhile and have no force, so that the height moves freely; and those
    that touch and lift again, while the load swings, share no range with springs that stay touched.
    """
    given = np.asarray(lowest, dtype=np.float64)[..., None]
    below = height < given
    next_above = below[..., :-1] & ~below[..., 1:]
    next_above[..., -1] = False  # no springs are beyond the last height
    return np.concatenate([height[..., :1], np.where(next_above, given, height[..., 1:])], axis=-1)


@cache
def turning(sliders: int) -> Array:
    """Shifts (2, n) [1] of sliders in a turn about the centre of their patch, over its radius and the turn.

    They stand on a circle around it. The two of a range are opposite, so that a turn makes no force and a
    shift no torque while they stick; the ranges follow by golden sections of half the circle.
    """
    angle = np.pi * (GOLDEN * np.arange(sliders // 2) % 1.0)
    unit = to_digits(np.stack([-np.sin(angle), np.cos(angle)]))
    unit /= np.sqrt(unit[0] * unit[0] + unit[1] * unit[1])
    both = np.asarray(np.stack([unit, -unit], axis=-1).reshape(2, -1))
    both.flags.writeable = False
    return both


def together(each: Array) -> Array:
    """Forces (..., 2, n) of sliders together (..., 3): along x, y and around the centre of their patch."""
    around_it = np.sum(turning(each.shape[-1]) * each, axis=(-2, -1))
    return np.concatenate([np.sum(each, axis=-1), around_it[..., None]], axis=-1)


HARDLY = 1e-3
"""Shift over that of gross slip [1] below which sliders are at rest: they stick, whatever the heights."""


@dataclass(frozen=True, slots=True)
class Carried:
    """What sliders (..., n) have at an approach, per area.

    stiffness : [Pa/m] along the surface; 0 without contact
    limit     : [Pa] of the friction
    slope     : [Pa/m2] derivative of the stiffness in the approach
    """

    stiffness: Number
    limit: Number
    slope: Number


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

    def stick(self, approach: ArrayLike) -> Array:
        """Stiffness (...) [Pa/m] along the surface of all sliders that touch at approaches (...) [m]."""
        here, first = (self.curve.derivatives(x, 1)[1] for x in (approach, self.height[..., 0]))
        return np.asarray(self.ratio * np.maximum(here - first, 0.0))

    def rested(
        self, force: Array, before: ArrayLike, after: ArrayLike, shift: ArrayLike
    ) -> tuple[Array, Array]:
        """Traction (..., 3) [Pa] of sliders that all stick after a straight path, and whether (...) they do.

        force         : (..., 3) [Pa] of all sliders before, see `together`
        before, after : (...) [m] approaches
        shift         : (..., 3) [m] of the other side along the surface, and around the centre of the patch
        """
        stiff, now = self.stick(before), self.stick(after)
        falls = np.asarray(after) < np.asarray(before)
        rule = rest_rule(stiff, now, falls)
        kept, gain = (np.asarray(each)[..., None] for each in rule)
        traction = kept * force + gain * np.asarray(shift)
        most = HARDLY * self.friction / self.ratio * now * (np.asarray(after) - self.height[..., 0])
        return traction, np.sqrt(np.sum(traction**2, axis=-1)) <= most

    def spread(self, force: Array, approach: ArrayLike) -> Array:
        """Forces (..., 2, n) of sliders that have stuck so far with forces (..., 3) `together`."""
        stiffness = self.carried(approach).stiffness
        whole = np.sum(stiffness, axis=-1, keepdims=True)
        part = np.divide(stiffness, whole, out=np.zeros_like(stiffness), where=whole > 0.0)
        each = force[..., :2, None] + force[..., 2:, None] * turning(self.sliders)
        return np.asarray(each * part[..., None, :])

    def backbone(self, approach: ArrayLike, shift: ArrayLike) -> Array:
        """Traction (...) [Pa] from rest over shifts (...) >= 0 [m], at approaches (...) [m] that stay.

        mu [p(delta) - p(delta - kappa u/mu)]: of all springs, without the sliders' steps.
        """
        now, then, _ = self.slipped(approach, shift)
        return np.asarray(self.friction * (now - then))

    def slipped(self, approach: ArrayLike, shift: ArrayLike) -> tuple[Array, Array, Array]:
        """Loads (...) [Pa] now and where springs have slipped, and the energy (...) [J/m2] in between.

        At approaches (...) [m], over shifts (...) >= 0 [m] from rest.
        """
        now, moved = np.asarray(approach, dtype=np.float64), np.asarray(shift, dtype=np.float64)
        then = np.asarray(now - moved / (self.friction / self.ratio))
        load, left = (self.curve.derivatives(x, 0)[0] for x in (now, then))
        return load, left, self.curve.energy(now) - self.curve.energy(then)

    def loop(self, approach: ArrayLike, size: ArrayLike) -> tuple[Array, Array]:
        """Loss (...) [J/m2] of a cycle with an amplitude (...) [m], and the energy (...) at its end.

        At approaches (...) [m], to full relative accuracy down to no amplitude.
        """
        now, a = np.asarray(approach, dtype=np.float64), np.asarray(size, dtype=np.float64)
        law = self.friction, self.ratio, a
        (load, *here), (_, *there) = (
            self.curve.derivatives(x, 3) for x in (now, now - a / (self.friction / self.ratio))
        )
        far, near = loop(*law, *self.slipped(now, a)), short_loop(*law, here, there)
        small = short(*law, load, here[0])
        loss, stored = (np.where(small, *each) for each in zip(near, far, strict=True))
        return loss, stored

    @cached_property
    def _ends(self) -> list[Array]:
        """Load [Pa] and stiffness [Pa/m] of the curve at the heights."""
        return self.curve.derivatives(self.height, 1)

    def carried(self, approach: ArrayLike) -> Carried:
        """What the sliders have at approaches (...) [m]."""
        delta = np.asarray(approach, dtype=np.float64)[..., None]
        (low, p_low, k_low), (high, p_high, k_high) = (
            [each[..., part] for each in (self.height, *self._ends)] for part in (slice(-1), slice(1, None))
        )
        touches, full = delta >= low, delta >= high
        p, k, slope = self.curve.derivatives(delta, 2)
        width = np.where(touches, np.where(full, high, delta) - low, 0.0)
        load = np.where(touches, np.where(full, p_high, p) - p_low - k_low * width, 0.0)
        springs = np.where(touches, np.where(full, k_high, k) - k_low, 0.0)
        bend = np.where(touches & ~full, slope, 0.0)
        each, rate, early, late = touching(load, springs, bend, width, self.ratio, self.friction)
        grown = self.friction / self.ratio * each * np.where(full, delta - high, 0.0)
        limit = np.stack([early + grown, late + grown], axis=-1).reshape(*each.shape[:-1], -1)
        return Carried(np.repeat(each, 2, axis=-1), limit, np.repeat(rate, 2, axis=-1))

    def moved(self, force: Array, before: ArrayLike, after: ArrayLike, shift: ArrayLike) -> Moved:
        """The sliders after a straight path, see `slide`.

        force         : (..., 2, n) [Pa] of the sliders before
        before, after : (...) [m] approaches
        shift         : (..., 2) [m] of the other side along the surface, (..., 3) and around the centre of
                        the patch

        The heat is exact for sliders whose stiffness stays, else of third order in the path.
        """
        path, end = _Path.of(before, after, self._along(shift)), self.carried(after)
        start = self.carried(before) if np.any(path.change) else end
        slid, springs = self._slid(force, start, end, path), (start.stiffness, end.stiffness)
        loss, stays = slid.loss, springs[0] == springs[1]
        if not np.all(stays):
            across = ~self._touches_alike(path)
            middle = self._halfway(force, start, path) if np.any(across) else [0.0, 0.0]
            ends = _parts(force), slid.force
            loss = np.where(stays, loss, changing_loss(*ends, path.parts, springs, slid.slip, across, middle))
        return Moved(np.stack(slid.force, axis=-2), np.sum(loss, axis=-1), self._tangent(*slid.tangent))

    def _along(self, shift: ArrayLike) -> Array:
        """Shifts (..., 2, 1) or (..., 2, n) [m] of the sliders."""
        given = np.asarray(shift, dtype=np.float64)[..., None]
        turns = given.shape[-2] > 2
        return np.asarray(given[..., :2, :] + given[..., 2:, :] * turning(self.sliders) if turns else given)

    def _tangent(self, xx: Array, xy: Array, yy: Array) -> Array:
        """Of all sliders (..., 6) [Pa/m]: xx, xy, yy, and with the way around the centre xt, yt, tt."""
        e_x, e_y = turning(self.sliders)
        x_t, y_t = xx * e_x + xy * e_y, xy * e_x + yy * e_y
        each = np.stack([xx, xy, yy, x_t, y_t, x_t * e_x + y_t * e_y])
        return np.asarray(np.moveaxis(np.sum(each, axis=-1), 0, -1))

    def _slid(self, force: Array, start: Carried, end: Carried, path: "_Path") -> Slid:
        """Sliders (..., n) after a path; the loss is right where the stiffness stays, else see `moved`."""
        change: Number = path.change
        rise: Number = 0.0
        small: Number = True
        if start is not end:
            steps = np.repeat(np.diff(self.height), 2, axis=-1)
            small = (self._touches_alike(path) & (np.abs(change) < SMALL * steps)) | (change == 0.0)
            limits = (end.limit - start.limit).reshape(*end.limit.shape[:-1], -1, 2)
            rise = 0.5 * self.ratio / self.friction * np.repeat(np.sum(limits, axis=-1), 2, axis=-1)
        ends = (start.stiffness, start.slope), (end.stiffness, end.slope)
        keeps, carries = carrying(*ends, change, rise, small)
        springs = end.stiffness, compliance(end.stiffness)
        return slide(_parts(force), keeps, carries, path.parts, start.limit, end.limit, *springs)

    def _halfway(self, force: Array, start: Carried, path: "_Path") -> Vector:
        """Forces of the sliders in the middle of a path."""
        half = path.part(0.5)
        return self._slid(force, start, self.carried(half.last[..., 0]), half).force

    def _touches_alike(self, path: "_Path") -> NDArray[np.bool_]:
        """Whether all, some or none of the springs of sliders (..., n) touch at both ends of a path alike."""
        low, high = (np.repeat(h, 2, axis=-1) for h in (self.height[..., :-1], self.height[..., 1:]))
        first, last = path.first, path.last
        return np.asarray(((first > low) == (last > low)) & ((first >= high) == (last >= high)))


@dataclass(frozen=True, slots=True)
class _Path:
    """A straight path: approaches (..., 1) [m] at its ends, shifts (..., 2, 1) or (..., 2, n) [m]."""

    first: Array
    last: Array
    along: Array

    @classmethod
    def of(cls, before: ArrayLike, after: ArrayLike, shift: Array) -> "_Path":
        first, last = (np.asarray(x, dtype=np.float64)[..., None] for x in (before, after))
        return cls(first, last, shift)

    @property
    def change(self) -> Array:
        """Of the approach (..., 1) [m]."""
        return np.asarray(self.last - self.first)

    @property
    def parts(self) -> tuple[Array, Array]:
        """Shifts (..., 1) or (..., n) along x and along y."""
        return _parts(self.along)

    def part(self, part: float) -> "_Path":
        """Its beginning."""
        return _Path(self.first, self.first + part * self.change, part * self.along)


def _parts(vector: Array) -> tuple[Array, Array]:
    """Components (..., n) of vectors (..., 2, n)."""
    return vector[..., 0, :], vector[..., 1, :]


def _cycle(
    friction: Number, ratio: Number, size: Number, fall: Number, excess: Number
) -> tuple[Number, Number]:
    """Loss and stored energy of `loop`, from what the load falls by over the reach, and the excess of the
    trapezoid over the integral of the load there."""
    return 8.0 * friction**2 / ratio * np.maximum(excess, 0.0), 0.5 * friction * fall * size


def loop(
    friction: Number, ratio: Number, size: Number, load: Number, then: Number, energy: Number
) -> tuple[Number, Number]:
    """Loss [J/m2] of a cycle with the amplitude `size` [m], and the elastic energy at its end.

    Under constant load 8 (I - B a/2) and B a/2, B the backbone and I its integral over a; the rest is of
    `Foundation.slipped`. It cancels where the amplitude is `short`, see `short_loop`.
    """
    reach = size * (ratio / friction)
    return _cycle(friction, ratio, size, load - then, 0.5 * reach * (load + then) - energy)


def short_loop(
    friction: Number, ratio: Number, size: Number, now: Vector, then: Vector
) -> tuple[Number, Number]:
    """`loop` from three derivatives of the load at both ends of the reach, exact inside a segment of
    the curve."""
    reach, (stiffness, bend, twist), (first, bent, twisted) = size * (ratio / friction), now, then
    fall = reach * (0.5 * (stiffness + first) - reach * (bend - bent) / 12.0)
    excess = reach**3 * ((bend + bent) / 24.0 - reach * (twist - twisted) / 120.0)
    return _cycle(friction, ratio, size, fall, excess)


def short(friction: Number, ratio: Number, size: Number, load: Number, stiffness: Number) -> Number:
    """Whether `short_loop` holds for an amplitude, at a load [Pa] and stiffness [Pa/m] of the curve."""
    return size * (ratio / friction) * stiffness < SHORT * load


def touching(
    load: Number, stiffness: Number, bend: Number, width: Number, ratio: Number, friction: Number
) -> tuple[Number, ...]:
    """Springs that begin to touch, of a range that the approach has entered by `width` [m].

    load, stiffness : of the curve, less those at the lower height and their tangent [Pa, Pa/m]
    bend            : [Pa/m2] derivative of the stiffness

    Of each of the two sliders the stiffness along the surface [Pa/m], its derivative in the approach [Pa/m2];
    the limits of the early and the late one [Pa].
    """
    normal = np.maximum(load, 0.0)
    springs = where(load > 0.0, np.maximum(stiffness, 0.0), 0.0)  # with a load below its round-off, none
    apart = np.minimum(springs * (SPREAD * width), normal)  # else the springs begin at the lower height
    half = 0.5 * friction
    return 0.5 * ratio * springs, 0.5 * ratio * bend, half * (normal - apart), half * (normal + apart)


def rest_rule(stiff: Number, now: Number, falls: Number) -> tuple[Number, Number]:
    """Part of its force that a foundation at rest keeps while its stiffness [Pa/m] goes from `stiff` to `now`
    [1], and what the shift adds [Pa/m], as `carrying`."""
    some = stiff > 0.0
    kept = where(some, np.minimum(now / where(some, stiff, 1.0), 1.0), 0.0)
    return where(falls, kept, 1.0), where(falls, now, 0.5 * (stiff + now))


def carrying(
    start: tuple[Number, Number],
    end: tuple[Number, Number],
    change: Number,
    rise: Number,
    small: Number,
) -> tuple[Number, Number]:
    """Part of its force that a slider keeps on a path [1], and what the shift adds [Pa/m].

    While the approach grows a slider's stiffness does, by springs that touch without a force; while it falls
    the springs that lift off take theirs with them.

    start, end : stiffness [Pa/m] and its derivative in the approach [Pa/m2]
    change     : [m] of the approach
    rise       : [Pa] integral of the stiffness over it, ratio/friction times the mean rise of the limits
    small      : whether the mean stiffness follows from the ends, to the fourth order, as the rise cancels
    """
    (first, slope), (last, then) = start, end
    touches, falls = first > 0.0, change < 0.0
    kept = where(touches, np.minimum(last / where(touches, first, 1.0), 1.0), 0.0)
    ends = 0.5 * (first + last) + change * (slope - then) / 12.0
    mean = where(small, ends, where(first == last, last, rise / where(small, 1.0, change)))
    return where(falls, kept, 1.0), where(falls, last, mean)


def changing_loss(
    force: Vector,
    moved: Vector,
    shift: Vector,
    stiffness: tuple[Number, Number],
    slip: Number,
    across: Number,
    middle: Vector,
) -> Number:
    """Heat [J/m2] of a slider whose stiffness changes from one to another: the work less what it stores.

    The work is by Hermite's rule from the ends of the path, by Simpson's where the springs begin or cease to
    touch (`across`), with the force in its `middle`.
    """
    first, last = stiffness
    ends = (force[0] + moved[0]) * shift[0] + (force[1] + moved[1]) * shift[1]
    half = middle[0] * shift[0] + middle[1] * shift[1]
    bent = where(slip > 0.0, 0.0, (shift[0] * shift[0] + shift[1] * shift[1]) * ((first - last) / 12.0))
    work = where(across, ends / 6.0 + 2.0 / 3.0 * half, 0.5 * ends + bent)
    return np.maximum(work - (_elastic(moved, last) - _elastic(force, first)), 0.0)


def _elastic(force: Vector, stiffness: Number) -> Number:
    """Elastic energy [J/m2] of a slider."""
    some = stiffness > 0.0
    square = force[0] * force[0] + force[1] * force[1]
    return where(some, square / (2.0 * where(some, stiffness, 1.0)), 0.0)
