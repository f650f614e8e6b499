"""Friction with history: Winkler foundation of Jenkins sliders, derived from the normal law of an interface.

For elastically similar bodies the traction in partial slip is the difference of two normal contact solutions
(Jaeger 1995, Ciavarella 1998). A foundation of independent springs that come into contact one after the other
reproduces it for any history (Popov and Hess 2015). A spring at height h is in contact if the approach delta
exceeds h. It has the normal stiffness p''(h) dh and the tangential stiffness kappa p''(h) dh, with
kappa = K_T/K_N. It slips if its tangential force reaches mu times its normal force. A spring that lifts off
loses its force.

Here two sliders represent all springs between two adjacent heights (a range). Their stiffness and friction
limit are sums over the springs in contact, so the foundation is exact in full stick and in gross slip at
every approach. The limits of the two differ by the spread of the springs' limits, which determines the loss
of a cycle.
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
"""Change of the approach over the range of heights of a slider [1] below which its mean stiffness is computed
from the derivatives at both ends (fourth order): the difference of its limits would cancel."""
SHORT = 3e-2
"""Stiffness times displacement over the load [1] below which the energies of a cycle are computed from
derivatives of the curve: differences of its loads would cancel."""
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Golden ratio conjugate (sqrt(5) - 1)/2 [1]."""
SPREAD = 1.0 / np.sqrt(12.0)
"""Standard deviation of a uniform distribution over its range [1]."""


BELOW, ABOVE = 10, 7
"""Number of slider heights below the reference approach, and between it and the end of the curve [1]."""
SLIDERS = 2 * (BELOW + ABOVE + 2)
"""Number of sliders of a foundation with the heights of `slider_heights` [1]."""
LOWEST, HIGHEST, USUAL = 1e-5, 0.1, 1e-3
"""Smallest and largest load at the reference approach, and load that replaces a smaller one, over the load at
the end of the curve [1]."""


def offsets(load: Array) -> Array:
    """Offsets (n) [1] of the slider heights of n parallel foundations, for which their errors cancel.

    load : (n) loads of the foundations, any unit. The offsets are multiples of the golden ratio modulo 1, in
        descending order of the loads; equal loads keep their order.
    """
    return np.asarray((ranks(load) * GOLDEN + 0.5) % 1.0)


def around(curve: Curve, reference: ArrayLike, offset: ArrayLike) -> Array:
    """Heights (..., n) [m] that separate the sliders of foundations near a reference approach.

    They are dense just below the reference approach, where the first springs slip, and near the first
    contact, where the last springs slip.

    curve     : pressure over approach
    reference : (...) [m] reference approach; another one is used if its load is too small or too large
    offset    : (...) in (0, 1) [1] moves the heights. Parallel foundations with different offsets slip at
                different displacements, so the errors of their stepwise slip cancel in the sum.
    """
    reference_approach, offset_column = (
        np.asarray(reference, dtype=np.float64),
        np.asarray(offset, dtype=np.float64)[..., None],
    )
    end = curve.end[1]
    load = curve.derivatives(reference_approach, 0)[0]
    touches = load > LOWEST * end
    load = np.where(touches, np.minimum(load, HIGHEST * end), USUAL * end)[..., None]
    position_below = (np.arange(BELOW)[::-1] + offset_column) / BELOW
    position_above = (np.arange(ABOVE) + offset_column) / ABOVE
    loads_below = load * (1.0 - position_below) ** 2 / (position_below**2 + (1.0 - position_below) ** 2)
    loads_above = load * np.exp(np.log(end / load) * position_above**2)
    lowest, highest = (np.full_like(load, x) for x in curve.displacement[[0, -1]])
    inner_heights = curve.inverse(np.concatenate([loads_below, load, loads_above], axis=-1))
    inner_heights[..., BELOW] = np.where(
        touches & (load[..., 0] < HIGHEST * end), reference_approach, inner_heights[..., BELOW]
    )
    return np.concatenate([lowest, inner_heights, highest], axis=-1)


def lowered(height: Array, lowest: ArrayLike) -> Array:
    """Slider heights after partial lift-off: the first height above the smallest approach moves down to it.

    heights      : (..., n) [m]
    min_approach : (...) [m] smallest approach so far

    Springs above min_approach have lifted off and have no force, so this height can be changed. Springs that
    touch and lift off periodically are then in another range than springs that stay in contact.
    """
    smallest = np.asarray(lowest, dtype=np.float64)[..., None]
    is_below = height < smallest
    next_above = is_below[..., :-1] & ~is_below[..., 1:]
    next_above[..., -1] = False  # no springs are beyond the last height
    return np.concatenate([height[..., :1], np.where(next_above, smallest, height[..., 1:])], axis=-1)


@cache
def turning(sliders: int) -> Array:
    """Tangential unit vectors (2, n) [1] of the sliders on the circle of a patch.

    A rotation theta [rad] of a patch with the circle radius r [m] displaces a slider by r theta times this
    vector. The two sliders of a range are on opposite sides of the circle: while both stick, a rotation
    causes no force, and a translation no torque. The angle between adjacent ranges is GOLDEN times 180
    degrees.
    """
    angle = np.pi * (GOLDEN * np.arange(sliders // 2) % 1.0)
    unit = to_digits(np.stack([-np.sin(angle), np.cos(angle)]))
    unit /= np.sqrt(unit[0] * unit[0] + unit[1] * unit[1])
    directions = np.asarray(np.stack([unit, -unit], axis=-1).reshape(2, -1))
    directions.flags.writeable = False
    return directions


def together(each: Array) -> Array:
    """Resultant (..., 3) of slider forces (..., 2, n): along x, along y, around the centre of the patch."""
    around_it = np.sum(turning(each.shape[-1]) * each, axis=(-2, -1))
    return np.concatenate([np.sum(each, axis=-1), around_it[..., None]], axis=-1)


HARDLY = 1e-3
"""Displacement over that of gross slip [1] below which a foundation counts as in full stick."""


@dataclass(frozen=True, slots=True)
class Carried:
    """Properties (..., n) of sliders at an approach, per area.

    stiffness : [Pa/m] tangential; 0 without contact
    limit     : [Pa] friction limit
    slope     : [Pa/m2] derivative of the stiffness with respect to the approach
    """

    stiffness: Number
    limit: Number
    slope: Number


@dataclass(frozen=True)
class Foundation:
    """Winkler foundation of n sliders for an interface, or for several parallel ones.

    curve                : pressure [Pa] over approach [m], convex
    stiffness_ratio      : kappa = K_T/K_N [1]
    friction_coefficient : mu [1]
    heights              : (..., n/2 + 1) [m] increasing heights that separate the ranges of springs; parallel
                           foundations may have different heights

    The sliders are in the order of the heights, two per range: first the one that slips earlier.
    """

    curve: Curve
    ratio: float
    friction: float
    height: Array

    @property
    def sliders(self) -> int:
        """Number n of sliders [1]."""
        return 2 * int(self.height.shape[-1] - 1)

    def at_rest(self, *shape: int) -> Array:
        """Slider forces (*shape, 2, n) of the virgin state: zeros."""
        return np.zeros((*shape, 2, self.sliders))

    def stick(self, approach: ArrayLike) -> Array:
        """Tangential stiffness (...) [Pa/m] in full stick at approaches (...) [m]."""
        slope_here, slope_at_first = (
            self.curve.derivatives(x, 1)[1] for x in (approach, self.height[..., 0])
        )
        return np.asarray(self.ratio * np.maximum(slope_here - slope_at_first, 0.0))

    def rested(
        self, force: Array, before: ArrayLike, after: ArrayLike, shift: ArrayLike
    ) -> tuple[Array, Array]:
        """Update in full stick: traction (..., 3) [Pa] after an increment, and whether (...) it holds.

        force      : (..., 3) [Pa] traction at the start, see `resultant`
        start, end : (...) [m] approaches
        tangential_displacement : (..., 3) [m] of the other side along x, y and around the centre
        """
        stiffness_start, stiffness_end = self.stick(before), self.stick(after)
        is_unloading = np.asarray(after) < np.asarray(before)
        rule = rest_rule(stiffness_start, stiffness_end, is_unloading)
        retention, secant_stiffness = (np.asarray(factor)[..., None] for factor in rule)
        traction = retention * force + secant_stiffness * np.asarray(shift)
        max_traction = (
            HARDLY * self.friction / self.ratio * stiffness_end * (np.asarray(after) - self.height[..., 0])
        )
        return traction, np.sqrt(np.sum(traction**2, axis=-1)) <= max_traction

    def spread(self, force: Array, approach: ArrayLike) -> Array:
        """Distribute a traction (..., 3) of full stick to sliders, by stiffness: forces (..., 2, n) [Pa]."""
        stiffness = self.carried(approach).stiffness
        total = np.sum(stiffness, axis=-1, keepdims=True)
        share = np.divide(stiffness, total, out=np.zeros_like(stiffness), where=total > 0.0)
        unit_forces = force[..., :2, None] + force[..., 2:, None] * turning(self.sliders)
        return np.asarray(unit_forces * share[..., None, :])

    def backbone(self, approach: ArrayLike, shift: ArrayLike) -> Array:
        """Virgin curve: traction (...) [Pa] at displacements u (...) >= 0 [m], constant approach (...) [m].

        mu [p(delta) - p(delta - kappa u/mu)], the sum over all springs, without discretisation by sliders.
        """
        load, slipped_load, _ = self.slipped(approach, shift)
        return np.asarray(self.friction * (load - slipped_load))

    def slipped(self, approach: ArrayLike, shift: ArrayLike) -> tuple[Array, Array, Array]:
        """Pressures (...) [Pa] at the approach delta and at delta - kappa u/mu, and the energy in between.

        Springs between both heights have slipped. The energy (...) [J/m2] is the integral of the pressure
        from the lower to the upper approach.

        approach                : delta (...) [m]
        tangential_displacement : u (...) >= 0 [m] from the virgin state
        """
        upper, displacement = np.asarray(approach, dtype=np.float64), np.asarray(shift, dtype=np.float64)
        lower = np.asarray(upper - displacement / (self.friction / self.ratio))
        load, slipped_load = (self.curve.derivatives(x, 0)[0] for x in (upper, lower))
        return load, slipped_load, self.curve.energy(upper) - self.curve.energy(lower)

    def loop(self, approach: ArrayLike, size: ArrayLike) -> tuple[Array, Array]:
        """Loss (...) [J/m2] of a cycle with amplitudes (...) [m], elastic energy (...) [J/m2] at its ends.

        At constant approaches (...) [m]. The relative accuracy is full also for amplitudes near zero.
        """
        upper_approach, a = np.asarray(approach, dtype=np.float64), np.asarray(size, dtype=np.float64)
        law = self.friction, self.ratio, a
        (load, *upper), (_, *lower) = (
            self.curve.derivatives(x, 3)
            for x in (upper_approach, upper_approach - a / (self.friction / self.ratio))
        )
        general, small_amplitude = (
            loop(*law, *self.slipped(upper_approach, a)),
            short_loop(*law, upper, lower),
        )
        is_small = short(*law, load, upper[0])
        loss, stored = (np.where(is_small, *each) for each in zip(small_amplitude, general, strict=True))
        return loss, stored

    @cached_property
    def _ends(self) -> list[Array]:
        """Pressure [Pa] and stiffness [Pa/m] of the curve at the heights."""
        return self.curve.derivatives(self.height, 1)

    def carried(self, approach: ArrayLike) -> Carried:
        """Stiffness, friction limit and slope of the sliders at approaches (...) [m]."""
        delta = np.asarray(approach, dtype=np.float64)[..., None]
        (low, p_low, k_low), (high, p_high, k_high) = (
            [slider_stiffness[..., part] for slider_stiffness in (self.height, *self._ends)]
            for part in (slice(-1), slice(1, None))
        )
        is_touching, is_full = delta >= low, delta >= high
        p, k, slope = self.curve.derivatives(delta, 2)
        width = np.where(is_touching, np.where(is_full, high, delta) - low, 0.0)
        load = np.where(is_touching, np.where(is_full, p_high, p) - p_low - k_low * width, 0.0)
        springs = np.where(is_touching, np.where(is_full, k_high, k) - k_low, 0.0)
        bend = np.where(is_touching & ~is_full, slope, 0.0)
        slider_stiffness, rate, limit_early, limit_late = touching(
            load, springs, bend, width, self.ratio, self.friction
        )
        grown = self.friction / self.ratio * slider_stiffness * np.where(is_full, delta - high, 0.0)
        limit = np.stack([limit_early + grown, limit_late + grown], axis=-1).reshape(
            *slider_stiffness.shape[:-1], -1
        )
        return Carried(np.repeat(slider_stiffness, 2, axis=-1), limit, np.repeat(rate, 2, axis=-1))

    def moved(self, force: Array, before: ArrayLike, after: ArrayLike, shift: ArrayLike) -> Moved:
        """Return-map all sliders for one increment, see `return_map`.

        force      : (..., 2, n) [Pa] slider forces at the start
        start, end : (...) [m] approaches
        tangential_displacement : (..., 2) [m] of the other side along x and y, or (..., 3): also around the
                     centre of the patch

        The loss is exact for sliders of constant stiffness, else accurate to third order in the increment.
        """
        path, properties_end = _Path.of(before, after, self._along(shift)), self.carried(after)
        properties_start = self.carried(before) if np.any(path.change) else properties_end
        update = self._slid(force, properties_start, properties_end, path)
        stiffness = properties_start.stiffness, properties_end.stiffness
        loss, is_constant = update.loss, stiffness[0] == stiffness[1]
        if not np.all(is_constant):
            changes = ~self._touches_alike(path)
            middle = self._halfway(force, properties_start, path) if np.any(changes) else [0.0, 0.0]
            varying = changing_loss(
                _parts(force), update.force, path.parts, stiffness, update.slip, changes, middle
            )
            loss = np.where(is_constant, loss, varying)
        return Moved(np.stack(update.force, axis=-2), np.sum(loss, axis=-1), self._tangent(*update.tangent))

    def _along(self, shift: ArrayLike) -> Array:
        """Displacements of the sliders [m]: (..., 2, 1) without rotation, (..., 2, n) with rotation."""
        column = np.asarray(shift, dtype=np.float64)[..., None]
        has_rotation = column.shape[-2] > 2
        return np.asarray(
            column[..., :2, :] + column[..., 2:, :] * turning(self.sliders) if has_rotation else column
        )

    def _tangent(self, xx: Array, xy: Array, yy: Array) -> Array:
        """Tangent stiffness (..., 6) [Pa/m] of the foundation: xx, xy, yy, and xt, yt, tt with the rotation.

        xx, xy, yy : (..., n) tangent stiffness of the sliders
        """
        e_x, e_y = turning(self.sliders)
        x_t, y_t = xx * e_x + xy * e_y, xy * e_x + yy * e_y
        components = np.stack([xx, xy, yy, x_t, y_t, x_t * e_x + y_t * e_y])
        return np.asarray(np.moveaxis(np.sum(components, axis=-1), 0, -1))

    def _slid(self, force: Array, start: Carried, end: Carried, path: "_Path") -> Slid:
        """Return mapping of sliders (..., n); its loss is valid for constant stiffness, see `advance`."""
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
        """Slider forces in the middle of an increment."""
        half = path.part(0.5)
        return self._slid(force, start, self.carried(half.last[..., 0]), half).force

    def _touches_alike(self, path: "_Path") -> NDArray[np.bool_]:
        """Whether each slider (..., n) has the same contact state (full, partial, open) at both ends."""
        low, high = (np.repeat(h, 2, axis=-1) for h in (self.height[..., :-1], self.height[..., 1:]))
        first, last = path.first, path.last
        return np.asarray(((first > low) == (last > low)) & ((first >= high) == (last >= high)))


@dataclass(frozen=True, slots=True)
class _Path:
    """Increment of the relative displacement.

    start, end              : (..., 1) [m] approaches at its ends
    tangential_displacement : (..., 2, 1) or (..., 2, n) [m]
    """

    first: Array
    last: Array
    along: Array

    @classmethod
    def of(cls, before: ArrayLike, after: ArrayLike, shift: Array) -> "_Path":
        first_approach, last_approach = (np.asarray(x, dtype=np.float64)[..., None] for x in (before, after))
        return cls(first_approach, last_approach, shift)

    @property
    def change(self) -> Array:
        """Change of the approach (..., 1) [m]."""
        return np.asarray(self.last - self.first)

    @property
    def parts(self) -> tuple[Array, Array]:
        """Tangential displacements (..., 1) or (..., n) [m] along x and along y."""
        return _parts(self.along)

    def part(self, part: float) -> "_Path":
        """First part of the increment; load_factor [1] from 0 to 1."""
        return _Path(self.first, self.first + part * self.change, part * self.along)


def _parts(vector: Array) -> tuple[Array, Array]:
    """Components x, y (..., n) of vectors (..., 2, n)."""
    return vector[..., 0, :], vector[..., 1, :]


def _cycle(
    friction: Number, ratio: Number, size: Number, fall: Number, excess: Number
) -> tuple[Number, Number]:
    """Loss and elastic energy [J/m2] of a cycle, see `cycle_energies`.

    fall   : [Pa] difference of the pressures at the approach and at the lowest slipped height
    excess : [J/m2] trapezoidal rule minus exact integral of the pressure between both
    """
    return 8.0 * friction**2 / ratio * np.maximum(excess, 0.0), 0.5 * friction * fall * size


def loop(
    friction: Number, ratio: Number, size: Number, load: Number, then: Number, energy: Number
) -> tuple[Number, Number]:
    """Loss [J/m2] of a cycle at constant approach, and elastic energy [J/m2] at its ends.

    With the virgin curve B(a), a the amplitude, and its integral I they are 8 (I - B a/2) and B a/2 (Masing).
    Differences cancel for small amplitudes: then use `small_cycle_energies`.

    friction_coefficient, stiffness_ratio, amplitude : mu [1], kappa = K_T/K_N [1], a [m]
    load, slipped_load, energy : result of `Foundation.slipped_pressure`
    """
    reach = size * (ratio / friction)
    return _cycle(friction, ratio, size, load - then, 0.5 * reach * (load + then) - energy)


def short_loop(
    friction: Number, ratio: Number, size: Number, now: Vector, then: Vector
) -> tuple[Number, Number]:
    """Energies of `cycle_energies` for small amplitudes, exact within one segment of the curve.

    upper, lower : first three derivatives of the pressure at delta and at delta - kappa a/mu
    """
    reach, (upper_stiffness, upper_d2p, upper_d3p), (lower_stiffness, lower_d2p, lower_d3p) = (
        size * (ratio / friction),
        now,
        then,
    )
    fall = reach * (0.5 * (upper_stiffness + lower_stiffness) - reach * (upper_d2p - lower_d2p) / 12.0)
    excess = reach**3 * ((upper_d2p + lower_d2p) / 24.0 - reach * (upper_d3p - lower_d3p) / 120.0)
    return _cycle(friction, ratio, size, fall, excess)


def short(friction: Number, ratio: Number, size: Number, load: Number, stiffness: Number) -> Number:
    """Whether `small_cycle_energies` holds for an amplitude [m], at a load [Pa] and stiffness [Pa/m]."""
    return size * (ratio / friction) * stiffness < SHORT * load


def touching(
    load: Number, stiffness: Number, bend: Number, width: Number, ratio: Number, friction: Number
) -> tuple[Number, ...]:
    """Partial contact of a range of springs: the approach exceeds its lower height by `width` [m].

    load, stiffness : [Pa], [Pa/m] of the curve minus its tangent at the lower height
    d2p             : [Pa/m2] derivative of the stiffness

    Returns tangential stiffness [Pa/m] of each of the two sliders, its derivative with respect to the
    approach [Pa/m2], and the friction limits [Pa] of the slider that slips first and of the other one.
    """
    normal = np.maximum(load, 0.0)
    springs = where(load > 0.0, np.maximum(stiffness, 0.0), 0.0)  # round-off may make the load negative
    apart = np.minimum(springs * (SPREAD * width), normal)  # the first spring has no load
    half = 0.5 * friction
    return 0.5 * ratio * springs, 0.5 * ratio * bend, half * (normal - apart), half * (normal + apart)


def rest_rule(stiff: Number, now: Number, falls: Number) -> tuple[Number, Number]:
    """Retention [1] and secant stiffness [Pa/m] of a foundation in full stick, see `retention_and_stiffness`.

    stiffness_start, stiffness_end : [Pa/m] tangential stiffness
    is_unloading                   : whether the approach decreases
    """
    has_stiffness = stiff > 0.0
    retention = where(has_stiffness, np.minimum(now / where(has_stiffness, stiff, 1.0), 1.0), 0.0)
    return where(falls, retention, 1.0), where(falls, now, 0.5 * (stiff + now))


def carrying(
    start: tuple[Number, Number],
    end: tuple[Number, Number],
    change: Number,
    rise: Number,
    small: Number,
) -> tuple[Number, Number]:
    """Fraction of the friction force retained [1], and secant stiffness [Pa/m], if the normal load changes.

    If the approach grows, springs come into contact without force: the force is retained. If it decreases,
    springs lift off and lose their force: it decreases in proportion to the stiffness.

    start, end : (stiffness [Pa/m], its derivative with respect to the approach [Pa/m2]) at both ends
    change     : [m] change of the approach
    stiffness_integral : [Pa] integral of the stiffness over the approach: ratio/mu times the mean change of
        the friction limits
    is_small   : whether to compute the mean stiffness from `start` and `end` (fourth order), because
        stiffness_integral cancels
    """
    (stiffness_start, slope_start), (stiffness_end, slope_end) = start, end
    touches, is_unloading = stiffness_start > 0.0, change < 0.0
    retention = where(touches, np.minimum(stiffness_end / where(touches, stiffness_start, 1.0), 1.0), 0.0)
    ends = 0.5 * (stiffness_start + stiffness_end) + change * (slope_start - slope_end) / 12.0
    mean = where(
        small, ends, where(stiffness_start == stiffness_end, stiffness_end, rise / where(small, 1.0, change))
    )
    return where(is_unloading, retention, 1.0), where(is_unloading, stiffness_end, mean)


def changing_loss(
    force: Vector,
    moved: Vector,
    shift: Vector,
    stiffness: tuple[Number, Number],
    slip: Number,
    across: Number,
    middle: Vector,
) -> Number:
    """Loss [J/m2] of a slider whose stiffness changes in the increment: work minus change of elastic energy.

    force, new_force : at the start and at the end of the increment
    tangential_displacement : displacement increment
    stiffness        : [Pa/m] at both ends
    slip             : slip of the return mapping, see `ReturnMapping`
    contact_changes  : whether the contact state changes. Then the work is computed by Simpson's rule with the
        force `middle` in the middle of the increment, else by Hermite's rule from both ends.
    """
    stiffness_start, stiffness_end = stiffness
    ends = (force[0] + moved[0]) * shift[0] + (force[1] + moved[1]) * shift[1]
    half = middle[0] * shift[0] + middle[1] * shift[1]
    hermite_term = where(
        slip > 0.0,
        0.0,
        (shift[0] * shift[0] + shift[1] * shift[1]) * ((stiffness_start - stiffness_end) / 12.0),
    )
    work = where(across, ends / 6.0 + 2.0 / 3.0 * half, 0.5 * ends + hermite_term)
    return np.maximum(work - (_elastic(moved, stiffness_end) - _elastic(force, stiffness_start)), 0.0)


def _elastic(force: Vector, stiffness: Number) -> Number:
    """Elastic energy [J/m2] of a slider: force^2/(2 stiffness); 0 without stiffness."""
    has_stiffness = stiffness > 0.0
    square = force[0] * force[0] + force[1] * force[1]
    return where(has_stiffness, square / (2.0 * where(has_stiffness, stiffness, 1.0)), 0.0)
