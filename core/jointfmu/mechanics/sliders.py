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

from ..quantity import Array, Number, select
from .curve import Curve
from .footprint.reproducible import rank_descending, round_to_digits
from .jenkins import ReturnMapping, SliderUpdate, Vector, compliance, return_map

SMALL_APPROACH_CHANGE_OVER_INTERVAL = 1e-3
"""Change of the approach over the height interval of a slider [1], below which differences would cancel.

Below, the mean stiffness is computed from the derivatives at both ends (fourth order)."""
SMALL_CYCLE_FORCE_OVER_LOAD = 3e-2
"""Stiffness times displacement over the load [1] below which the energies of a cycle are computed from
derivatives of the curve: differences of its loads would cancel."""
GOLDEN_RATIO_CONJUGATE = 0.5 * (np.sqrt(5.0) - 1.0)
"""Golden ratio conjugate (sqrt(5) - 1)/2 [1]."""
UNIFORM_DISTRIBUTION_DEVIATION = 1.0 / np.sqrt(12.0)
"""Standard deviation of a uniform distribution over its range [1]."""


HEIGHTS_BELOW_REFERENCE, HEIGHTS_ABOVE_REFERENCE = 10, 7
"""Number of slider heights below the reference approach, and between it and the end of the curve [1]."""
FOUNDATION_SLIDER_COUNT = 2 * (HEIGHTS_BELOW_REFERENCE + HEIGHTS_ABOVE_REFERENCE + 2)
"""Number of sliders of a foundation with the heights of `slider_heights` [1]: two per height interval."""
MIN_REFERENCE_LOAD_OVER_END_LOAD, MAX_REFERENCE_LOAD_OVER_END_LOAD, DEFAULT_REFERENCE_LOAD_OVER_END_LOAD = (
    1e-5,
    0.1,
    1e-3,
)
"""Smallest and largest load at the reference approach, and load that replaces a smaller one, over the load at
the end of the curve [1]."""


def height_offsets(foundation_loads: Array) -> Array:
    """Offsets (n) [1] by which n parallel foundations shift their slider heights, so that errors cancel.

    A slider height is the approach at which the first springs of a slider touch. An offset between 0 and 1
    moves all heights by a fraction of the step between them.

    foundation_loads : (n) loads of the foundations, any unit

    The offsets are multiples of the golden ratio modulo 1, in descending order of the loads; equal loads keep
    their order.
    """
    return np.asarray((rank_descending(foundation_loads) * GOLDEN_RATIO_CONJUGATE + 0.5) % 1.0)


def slider_heights(
    pressure_curve: Curve, stated_reference_approach: ArrayLike, height_offset: ArrayLike
) -> Array:
    """Slider heights (..., h) [m] of foundations: approaches at which the first springs of sliders touch.

    The springs of a foundation touch one after the other, as the approach grows. Two sliders represent all
    springs between two adjacent heights. The h heights are dense just below a reference approach, where the
    first springs slip, and near the first contact, where the last springs slip.

    pressure_curve            : pressure [Pa] as a function of the approach [m]
    stated_reference_approach : (...) [m]; another one is used if its load is too small or too large
    height_offset             : (...) in (0, 1) [1] moves the heights. Parallel foundations with different
                                offsets slip at different displacements, so the errors of their stepwise slip
                                cancel in the sum.
    """
    reference_approach = np.asarray(stated_reference_approach, dtype=np.float64)
    offset_column = np.asarray(height_offset, dtype=np.float64)[..., None]
    end = pressure_curve.end_point[1]
    load = pressure_curve.derivatives(reference_approach, 0)[0]
    touches = load > MIN_REFERENCE_LOAD_OVER_END_LOAD * end
    load = np.where(
        touches,
        np.minimum(load, MAX_REFERENCE_LOAD_OVER_END_LOAD * end),
        DEFAULT_REFERENCE_LOAD_OVER_END_LOAD * end,
    )[..., None]
    position_below = (np.arange(HEIGHTS_BELOW_REFERENCE)[::-1] + offset_column) / HEIGHTS_BELOW_REFERENCE
    position_above = (np.arange(HEIGHTS_ABOVE_REFERENCE) + offset_column) / HEIGHTS_ABOVE_REFERENCE
    loads_below = load * (1.0 - position_below) ** 2 / (position_below**2 + (1.0 - position_below) ** 2)
    loads_above = load * np.exp(np.log(end / load) * position_above**2)
    lowest, highest = (np.full_like(load, x) for x in pressure_curve.displacement[[0, -1]])
    inner_heights = pressure_curve.inverse(np.concatenate([loads_below, load, loads_above], axis=-1))
    inner_heights[..., HEIGHTS_BELOW_REFERENCE] = np.where(
        touches & (load[..., 0] < MAX_REFERENCE_LOAD_OVER_END_LOAD * end),
        reference_approach,
        inner_heights[..., HEIGHTS_BELOW_REFERENCE],
    )
    return np.concatenate([lowest, inner_heights, highest], axis=-1)


def heights_after_liftoff(slider_heights: Array, min_approach: ArrayLike) -> Array:
    """Grid of slider heights after partial lift-off, with a grid point at the smallest approach.

    slider_heights : (..., h) [m] grid of h heights, see `slider_heights`
    min_approach   : (...) [m] smallest approach so far

    A spring is in contact while the approach is above its height, so springs with heights above min_approach
    have lifted off at least once. The first grid point above min_approach is moved down to min_approach. Each
    interval of the grid then has either springs that lift off or springs that stay in contact, not both.
    """
    smallest = np.asarray(min_approach, dtype=np.float64)[..., None]
    is_below = slider_heights < smallest
    next_above = is_below[..., :-1] & ~is_below[..., 1:]
    next_above[..., -1] = False  # no springs are beyond the last height
    return np.concatenate(
        [slider_heights[..., :1], np.where(next_above, smallest, slider_heights[..., 1:])], axis=-1
    )


@cache
def torsion_directions(slider_count: int) -> Array:
    """Directions (2, n) [1] in which a rotation of a patch about its centre moves its sliders.

    The directions are unit vectors along the tangents of the circle on which the sliders lie.

    A rotation theta [rad] of a patch with the circle radius r [m] displaces a slider by r theta times this
    vector. Two sliders represent one range of springs: those that touch between two adjacent approaches of
    the surfaces. They are on opposite sides of the circle: while both stick, a rotation causes no force, and
    a translation no torque. The angle between the sliders of adjacent ranges is GOLDEN_RATIO_CONJUGATE times
    180 degrees, which spreads the sliders of all ranges evenly.
    """
    angle = np.pi * (GOLDEN_RATIO_CONJUGATE * np.arange(slider_count // 2) % 1.0)
    unit = round_to_digits(np.stack([-np.sin(angle), np.cos(angle)]))
    unit /= np.sqrt(unit[0] * unit[0] + unit[1] * unit[1])
    directions = np.asarray(np.stack([unit, -unit], axis=-1).reshape(2, -1))
    directions.flags.writeable = False
    return directions


def sum_slider_forces(slider_forces: Array) -> Array:
    """Resultant (..., 3) of the forces of n sliders of a patch: along x, along y, around its centre.

    The last is the torque divided by the radius of the circle on which the sliders lie.

    slider_forces : (..., 2, n) components along x and y
    """
    around_it = np.sum(torsion_directions(slider_forces.shape[-1]) * slider_forces, axis=(-2, -1))
    return np.concatenate([np.sum(slider_forces, axis=-1), around_it[..., None]], axis=-1)


FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT = 1e-3
"""Displacement over the displacement of gross slip [1] below which a foundation counts as in full stick."""


@dataclass(frozen=True, slots=True)
class SliderProperties:
    """Properties (..., n) of n sliders at an approach, per area of their patch.

    stiffness       : [Pa/m] tangential; 0 without contact
    friction_limit  : [Pa] share of the slider in mu times the pressure of the patch
    stiffness_slope : [Pa/m2] derivative of the stiffness with respect to the approach
    """

    stiffness: Number
    friction_limit: Number
    stiffness_slope: Number


@dataclass(frozen=True)
class Foundation:
    """Winkler foundation of n sliders for an interface, or for several parallel ones.

    pressure_curve       : pressure [Pa] as a function of the approach [m], convex
    stiffness_ratio      : kappa = K_T/K_N [1]
    friction_coefficient : mu [1]
    heights              : (..., n/2 + 1) [m] increasing heights that separate the ranges of springs; parallel
                           foundations may have different heights

    The sliders are in the order of the heights, two per range: first the one that slips earlier.
    """

    pressure_curve: Curve
    stiffness_ratio: float
    friction_coefficient: float
    heights: Array

    @property
    def slider_count(self) -> int:
        """Number n of sliders [1]."""
        return 2 * int(self.heights.shape[-1] - 1)

    def virgin_forces(self, *leading_shape: int) -> Array:
        """Forces (*leading_shape, 2, n) of the n sliders along x and y in the virgin state: zeros."""
        return np.zeros((*leading_shape, 2, self.slider_count))

    def stick_stiffness(self, approach: ArrayLike) -> Array:
        """Tangential stiffness (...) [Pa/m] in full stick at approaches (...) [m]."""
        slope_here, slope_at_first = (
            self.pressure_curve.derivatives(x, 1)[1] for x in (approach, self.heights[..., 0])
        )
        return np.asarray(self.stiffness_ratio * np.maximum(slope_here - slope_at_first, 0.0))

    def full_stick_update(
        self,
        start_traction: Array,
        start_approach: ArrayLike,
        end_approach: ArrayLike,
        tangential_displacement: ArrayLike,
    ) -> tuple[Array, Array]:
        """Update in full stick: traction (..., 3) [Pa] after an increment, and whether (...) it holds.

        start_traction : (..., 3) [Pa] traction at the start, see `sum_slider_forces`
        start_approach, end_approach : (...) [m] approaches at the start and at the end
        tangential_displacement : (..., 3) [m] of the other side along x, y and around the centre
        """
        stiffness_start = self.stick_stiffness(start_approach)
        stiffness_end = self.stick_stiffness(end_approach)
        is_unloading = np.asarray(end_approach) < np.asarray(start_approach)
        rule = stick_retention(stiffness_start, stiffness_end, is_unloading)
        retention, secant_stiffness = (np.asarray(factor)[..., None] for factor in rule)
        traction = retention * start_traction + secant_stiffness * np.asarray(tangential_displacement)
        max_traction = (
            FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT
            * self.friction_coefficient
            / self.stiffness_ratio
            * stiffness_end
            * (np.asarray(end_approach) - self.heights[..., 0])
        )
        return traction, np.sqrt(np.sum(traction**2, axis=-1)) <= max_traction

    def distribute_stick_force(self, stick_traction: Array, approach: ArrayLike) -> Array:
        """Distribute a traction (..., 3) of full stick to sliders, by stiffness: forces (..., 2, n) [Pa]."""
        stiffness = self.slider_properties(approach).stiffness
        total = np.sum(stiffness, axis=-1, keepdims=True)
        share = np.divide(stiffness, total, out=np.zeros_like(stiffness), where=total > 0.0)
        unit_forces = stick_traction[..., :2, None] + stick_traction[..., 2:, None] * torsion_directions(
            self.slider_count
        )
        return np.asarray(unit_forces * share[..., None, :])

    def virgin_traction(self, approach: ArrayLike, tangential_displacement: ArrayLike) -> Array:
        """Virgin curve: traction (...) [Pa] at displacements u (...) >= 0 [m], constant approach (...) [m].

        mu [p(delta) - p(delta - kappa u/mu)], with the friction coefficient mu, the pressure p, the approach
        delta and the stiffness ratio kappa: the sum over all springs, without discretisation by sliders.
        """
        load, slipped_load = (
            self.pressure_curve.derivatives(x, 0)[0]
            for x in self._slipped_height_range(approach, tangential_displacement)
        )
        return np.asarray(self.friction_coefficient * (load - slipped_load))

    def slipped_pressure(
        self, approach: ArrayLike, tangential_displacement: ArrayLike
    ) -> tuple[Array, Array, Array]:
        """Pressures (...) [Pa] at both ends of the range of springs that have slipped, and energy in between.

        The springs with heights between the approach delta and delta - kappa u/mu have slipped, with the
        stiffness ratio kappa and the friction coefficient mu. The energy (...) [J/m2] is the integral of the
        pressure from the lower to the upper end.

        approach                : delta (...) [m]
        tangential_displacement : u (...) >= 0 [m] from the virgin state
        """
        upper, lower = self._slipped_height_range(approach, tangential_displacement)
        load, slipped_load = (self.pressure_curve.derivatives(x, 0)[0] for x in (upper, lower))
        return load, slipped_load, self.pressure_curve.energy(upper) - self.pressure_curve.energy(lower)

    def _slipped_height_range(
        self, approach: ArrayLike, tangential_displacement: ArrayLike
    ) -> tuple[Array, Array]:
        """Upper and lower end (...) [m] of the heights of all springs that have slipped.

        The upper end is the approach (...) [m]. The displacement (...) [m] starts at the virgin state, and is
        not negative.
        """
        upper = np.asarray(approach, dtype=np.float64)
        displacement = np.asarray(tangential_displacement, dtype=np.float64)
        return upper, np.asarray(upper - displacement / (self.friction_coefficient / self.stiffness_ratio))

    def cycle_energies(self, approach: ArrayLike, displacement_amplitude: ArrayLike) -> tuple[Array, Array]:
        """Energy loss (...) [J/m2] of friction cycles of amplitudes (...) [m]; elastic energy at their ends.

        The approaches (...) [m] are constant. The relative accuracy is full also for amplitudes near zero.
        """
        upper_approach, a = (
            np.asarray(approach, dtype=np.float64),
            np.asarray(displacement_amplitude, dtype=np.float64),
        )
        law = self.friction_coefficient, self.stiffness_ratio, a
        (load, *upper), (_, *lower) = (
            self.pressure_curve.derivatives(x, 3)
            for x in (upper_approach, upper_approach - a / (self.friction_coefficient / self.stiffness_ratio))
        )
        general = cycle_energies(*law, *self.slipped_pressure(upper_approach, a))
        small_amplitude = small_cycle_energies(*law, upper, lower)
        is_small = is_small_amplitude(*law, load, upper[0])
        loss, stored = (np.where(is_small, *each) for each in zip(small_amplitude, general, strict=True))
        return loss, stored

    @cached_property
    def _pressure_at_heights(self) -> list[Array]:
        """Pressure [Pa] and stiffness [Pa/m] of the curve at the slider heights, cached."""
        return self.pressure_curve.derivatives(self.heights, 1)

    def slider_properties(self, approach: ArrayLike) -> SliderProperties:
        """Stiffness, friction limit and slope of the sliders at approaches (...) [m]."""
        delta = np.asarray(approach, dtype=np.float64)[..., None]
        (low, p_low, k_low), (high, p_high, k_high) = (
            [at_heights[..., ends] for at_heights in (self.heights, *self._pressure_at_heights)]
            for ends in (slice(-1), slice(1, None))
        )
        is_touching, is_full = delta >= low, delta >= high
        p, k, slope = self.pressure_curve.derivatives(delta, 2)
        width = np.where(is_touching, np.where(is_full, high, delta) - low, 0.0)
        load = np.where(is_touching, np.where(is_full, p_high, p) - p_low - k_low * width, 0.0)
        springs = np.where(is_touching, np.where(is_full, k_high, k) - k_low, 0.0)
        bend = np.where(is_touching & ~is_full, slope, 0.0)
        slider_stiffness, rate, limit_early, limit_late = partial_contact(
            load, springs, bend, width, self.stiffness_ratio, self.friction_coefficient
        )
        grown = (
            self.friction_coefficient
            / self.stiffness_ratio
            * slider_stiffness
            * np.where(is_full, delta - high, 0.0)
        )
        limit = np.stack([limit_early + grown, limit_late + grown], axis=-1).reshape(
            *slider_stiffness.shape[:-1], -1
        )
        return SliderProperties(np.repeat(slider_stiffness, 2, axis=-1), limit, np.repeat(rate, 2, axis=-1))

    def advance(
        self,
        start_force: Array,
        start_approach: ArrayLike,
        end_approach: ArrayLike,
        tangential_displacement: ArrayLike,
    ) -> SliderUpdate:
        """Return-map all sliders for one increment, see `return_map`.

        start_force : (..., 2, n) [Pa] slider forces at the start
        start_approach, end_approach : (...) [m] approaches
        tangential_displacement : (..., 2) [m] of the other side along x and y, or (..., 3): also around the
                     centre of the patch

        The loss is exact for sliders of constant stiffness, else accurate to third order in the increment.
        """
        path = _DisplacementIncrement.from_approaches(
            start_approach, end_approach, self._slider_displacements(tangential_displacement)
        )
        properties_end = self.slider_properties(end_approach)
        properties_start = (
            self.slider_properties(start_approach) if np.any(path.approach_change) else properties_end
        )
        update = self._return_map(start_force, properties_start, properties_end, path)
        stiffness = properties_start.stiffness, properties_end.stiffness
        loss, is_constant = update.dissipated_energy, stiffness[0] == stiffness[1]
        if not np.all(is_constant):
            changes = ~self._keeps_contact_state(path)
            middle = (
                self._middle_forces(start_force, properties_start, path) if np.any(changes) else [0.0, 0.0]
            )
            varying = varying_stiffness_loss(
                _vector_components(start_force),
                update.force,
                path.tangential_components,
                stiffness,
                update.slip_force,
                changes,
                middle,
            )
            loss = np.where(is_constant, loss, varying)
        return SliderUpdate(
            np.stack(update.force, axis=-2), np.sum(loss, axis=-1), self._foundation_tangent(*update.tangent)
        )

    def _slider_displacements(self, tangential_displacement: ArrayLike) -> Array:
        """Displacements of the sliders [m]: (..., 2, 1) without rotation, (..., 2, n) with rotation."""
        column = np.asarray(tangential_displacement, dtype=np.float64)[..., None]
        has_rotation = column.shape[-2] > 2
        return np.asarray(
            column[..., :2, :] + column[..., 2:, :] * torsion_directions(self.slider_count)
            if has_rotation
            else column
        )

    def _foundation_tangent(self, tangent_xx: Array, tangent_xy: Array, tangent_yy: Array) -> Array:
        """Tangent stiffness (..., 6) [Pa/m], summed over the n sliders of a patch: xx, xy, yy, xr, yr, rr.

        r is the displacement [m] of a slider by the rotation of the patch: angle times radius of its circle.

        tangent_xx, tangent_xy, tangent_yy : (..., n) tangent stiffness of each slider
        """
        e_x, e_y = torsion_directions(self.slider_count)
        x_r, y_r = tangent_xx * e_x + tangent_xy * e_y, tangent_xy * e_x + tangent_yy * e_y
        components = np.stack([tangent_xx, tangent_xy, tangent_yy, x_r, y_r, x_r * e_x + y_r * e_y])
        return np.asarray(np.moveaxis(np.sum(components, axis=-1), 0, -1))

    def _return_map(
        self,
        start_force: Array,
        start_properties: SliderProperties,
        end_properties: SliderProperties,
        displacement_increment: "_DisplacementIncrement",
    ) -> ReturnMapping:
        """Return mapping of sliders (..., n); its loss is valid for constant stiffness, see `advance`."""
        change: Number = displacement_increment.approach_change
        rise: Number = 0.0
        small: Number = True
        if start_properties is not end_properties:
            steps = np.repeat(np.diff(self.heights), 2, axis=-1)
            small = (
                self._keeps_contact_state(displacement_increment)
                & (np.abs(change) < SMALL_APPROACH_CHANGE_OVER_INTERVAL * steps)
            ) | (change == 0.0)
            limits = (end_properties.friction_limit - start_properties.friction_limit).reshape(
                *end_properties.friction_limit.shape[:-1], -1, 2
            )
            rise = (
                0.5
                * self.stiffness_ratio
                / self.friction_coefficient
                * np.repeat(np.sum(limits, axis=-1), 2, axis=-1)
            )
        ends = (
            (start_properties.stiffness, start_properties.stiffness_slope),
            (end_properties.stiffness, end_properties.stiffness_slope),
        )
        retention, secant_stiffness = retention_and_stiffness(*ends, change, rise, small)
        return return_map(
            _vector_components(start_force),
            retention,
            secant_stiffness,
            displacement_increment.tangential_components,
            start_properties.friction_limit,
            end_properties.friction_limit,
            end_properties.stiffness,
            compliance(end_properties.stiffness),
        )

    def _middle_forces(
        self,
        start_force: Array,
        start_properties: SliderProperties,
        displacement_increment: "_DisplacementIncrement",
    ) -> Vector:
        """Slider forces (..., 2, n) [Pa] in the middle of a displacement increment."""
        half = displacement_increment.scale_increment(0.5)
        return self._return_map(
            start_force, start_properties, self.slider_properties(half.end_approach[..., 0]), half
        ).force

    def _keeps_contact_state(self, displacement_increment: "_DisplacementIncrement") -> NDArray[np.bool_]:
        """Whether each slider (..., n) has the same contact state (full, partial, open) at both ends."""
        low, high = (np.repeat(h, 2, axis=-1) for h in (self.heights[..., :-1], self.heights[..., 1:]))
        first, last = displacement_increment.start_approach, displacement_increment.end_approach
        return np.asarray(((first > low) == (last > low)) & ((first >= high) == (last >= high)))


@dataclass(frozen=True, slots=True)
class _DisplacementIncrement:
    """Increment of the displacement of sliders: approaches at both ends, tangential displacement.

    start_approach, end_approach : (..., 1) [m] approaches at its ends
    tangential_displacement      : (..., 2, 1) or (..., 2, n) [m]
    """

    start_approach: Array
    end_approach: Array
    tangential_displacement: Array

    @classmethod
    def from_approaches(
        cls, start_approach: ArrayLike, end_approach: ArrayLike, tangential_displacement: Array
    ) -> "_DisplacementIncrement":
        """Displacement increment between two approaches (...) [m], which get an axis for the sliders."""
        first_approach, last_approach = (
            np.asarray(x, dtype=np.float64)[..., None] for x in (start_approach, end_approach)
        )
        return cls(first_approach, last_approach, tangential_displacement)

    @property
    def approach_change(self) -> Array:
        """Approach at the end of the increment minus approach at its start (..., 1) [m]."""
        return np.asarray(self.end_approach - self.start_approach)

    @property
    def tangential_components(self) -> tuple[Array, Array]:
        """Tangential displacements (..., 1) or (..., n) [m] along x and along y."""
        return _vector_components(self.tangential_displacement)

    def scale_increment(self, step_fraction: float) -> "_DisplacementIncrement":
        """Scale the increment: its part from the start up to a step fraction [1], from 0 to 1."""
        return _DisplacementIncrement(
            self.start_approach,
            self.start_approach + step_fraction * self.approach_change,
            step_fraction * self.tangential_displacement,
        )


def _vector_components(slider_vectors: Array) -> tuple[Array, Array]:
    """Components x, y (..., n) of vectors (..., 2, n)."""
    return slider_vectors[..., 0, :], slider_vectors[..., 1, :]


def _cycle_energies(
    friction_coefficient: Number,
    stiffness_ratio: Number,
    displacement_amplitude: Number,
    pressure_drop: Number,
    energy_excess: Number,
) -> tuple[Number, Number]:
    """Energy loss and elastic energy [J/m2] of a friction cycle, from differences of pressure and energy.

    pressure_drop : [Pa] pressure at the approach minus pressure at the height of the last spring that slips
    energy_excess : [J/m2] integral of the pressure between these heights: trapezoidal rule minus exact value
    """
    return 8.0 * friction_coefficient**2 / stiffness_ratio * np.maximum(
        energy_excess, 0.0
    ), 0.5 * friction_coefficient * pressure_drop * displacement_amplitude


def cycle_energies(
    friction_coefficient: Number,
    stiffness_ratio: Number,
    displacement_amplitude: Number,
    contact_pressure: Number,
    pressure_at_lower_slip_end: Number,
    pressure_integral: Number,
) -> tuple[Number, Number]:
    """Energy loss [J/m2] of a cycle at constant approach, and elastic energy [J/m2] at its ends.

    The energies are 8 (I - B a/2) and B a/2 (Masing), with the virgin curve B(a), its integral I and the
    amplitude a. Differences cancel for small amplitudes: then use `small_cycle_energies`.

    friction_coefficient, stiffness_ratio, displacement_amplitude : mu [1], kappa = K_T/K_N [1], a [m]
    contact_pressure, pressure_at_lower_slip_end, pressure_integral : result of `Foundation.slipped_pressure`
    """
    reach = displacement_amplitude * (stiffness_ratio / friction_coefficient)
    return _cycle_energies(
        friction_coefficient,
        stiffness_ratio,
        displacement_amplitude,
        contact_pressure - pressure_at_lower_slip_end,
        0.5 * reach * (contact_pressure + pressure_at_lower_slip_end) - pressure_integral,
    )


def small_cycle_energies(
    friction_coefficient: Number,
    stiffness_ratio: Number,
    displacement_amplitude: Number,
    upper_derivatives: Vector,
    lower_derivatives: Vector,
) -> tuple[Number, Number]:
    """Energy loss and elastic energy [J/m2] of a cycle of small amplitude, exact in one segment of the curve.

    The energies are those of `cycle_energies`, without its cancellation.

    friction_coefficient, stiffness_ratio, displacement_amplitude : mu [1], kappa = K_T/K_N [1], a [m]
    upper_derivatives, lower_derivatives : first three derivatives of the pressure with respect to the
        approach, at the approach and at the approach minus kappa a/mu
    """
    reach = displacement_amplitude * (stiffness_ratio / friction_coefficient)
    upper_stiffness, upper_d2p, upper_d3p = upper_derivatives
    lower_stiffness, lower_d2p, lower_d3p = lower_derivatives
    fall = reach * (0.5 * (upper_stiffness + lower_stiffness) - reach * (upper_d2p - lower_d2p) / 12.0)
    excess = reach**3 * ((upper_d2p + lower_d2p) / 24.0 - reach * (upper_d3p - lower_d3p) / 120.0)
    return _cycle_energies(friction_coefficient, stiffness_ratio, displacement_amplitude, fall, excess)


def is_small_amplitude(
    friction_coefficient: Number,
    stiffness_ratio: Number,
    displacement_amplitude: Number,
    contact_pressure: Number,
    contact_stiffness: Number,
) -> Number:
    """Whether the amplitude of a friction cycle is so small that differences of energies would cancel.

    The energies are then computed by `small_cycle_energies`.

    displacement_amplitude, contact_pressure, contact_stiffness : [m], [Pa], [Pa/m]
    """
    return (
        displacement_amplitude * (stiffness_ratio / friction_coefficient) * contact_stiffness
        < SMALL_CYCLE_FORCE_OVER_LOAD * contact_pressure
    )


def partial_contact(
    pressure_above_tangent: Number,
    stiffness_above_tangent: Number,
    contact_stiffness_slope: Number,
    approach_excess: Number,
    stiffness_ratio: Number,
    friction_coefficient: Number,
) -> tuple[Number, ...]:
    """Stiffness and friction limits of the springs between two heights that are partly in contact.

    The approach exceeds the lower height of this range of springs by `approach_excess` [m].

    pressure_above_tangent, stiffness_above_tangent : [Pa], [Pa/m] of the pressure curve minus its tangent at
        the lower height
    contact_stiffness_slope : [Pa/m2] derivative of the stiffness

    Returns tangential stiffness [Pa/m] of each of the two sliders, its derivative with respect to the
    approach [Pa/m2], and the friction limits [Pa] of the slider that slips first and of the other one.
    """
    normal = np.maximum(pressure_above_tangent, 0.0)
    # round-off may make the pressure negative
    springs = select(pressure_above_tangent > 0.0, np.maximum(stiffness_above_tangent, 0.0), 0.0)
    # the first spring has no load
    apart = np.minimum(springs * (UNIFORM_DISTRIBUTION_DEVIATION * approach_excess), normal)
    half = 0.5 * friction_coefficient
    return (
        0.5 * stiffness_ratio * springs,
        0.5 * stiffness_ratio * contact_stiffness_slope,
        half * (normal - apart),
        half * (normal + apart),
    )


def stick_retention(
    stiffness_start: Number, stiffness_end: Number, is_unloading: Number
) -> tuple[Number, Number]:
    """Fraction of the traction [1] that remains if the approach changes while all sliders stick.

    The fraction is 1 if the approach grows. If the approach decreases, springs lift off and lose their force,
    and the fraction is below 1. Returns also the secant stiffness [Pa/m] for the tangential displacement, see
    `retention_and_stiffness`.

    stiffness_start, stiffness_end : [Pa/m] tangential stiffness
    is_unloading                   : whether the approach decreases
    """
    has_stiffness = stiffness_start > 0.0
    retention = select(
        has_stiffness, np.minimum(stiffness_end / select(has_stiffness, stiffness_start, 1.0), 1.0), 0.0
    )
    return select(is_unloading, retention, 1.0), select(
        is_unloading, stiffness_end, 0.5 * (stiffness_start + stiffness_end)
    )


def retention_and_stiffness(
    start_stiffness: tuple[Number, Number],
    end_stiffness: tuple[Number, Number],
    approach_change: Number,
    stiffness_integral: Number,
    is_small_approach_change: Number,
) -> tuple[Number, Number]:
    """Fraction [1] of the friction force that remains when the normal load changes; secant stiffness [Pa/m].

    If the approach grows, springs come into contact without force: the force is retained. If it decreases,
    springs lift off and lose their force: it decreases in proportion to the stiffness.

    start_stiffness, end_stiffness : (stiffness [Pa/m], its derivative by the approach [Pa/m2]) at both ends
    approach_change : [m] change of the approach
    stiffness_integral : [Pa] integral of the stiffness over the approach: kappa/mu times the mean change of
        the friction limits, kappa = K_T/K_N
    is_small_approach_change : whether to compute the mean stiffness from both ends (fourth order), because
        stiffness_integral cancels
    """
    (stiffness_start, slope_start), (stiffness_end, slope_end) = start_stiffness, end_stiffness
    touches, is_unloading = stiffness_start > 0.0, approach_change < 0.0
    retention = select(touches, np.minimum(stiffness_end / select(touches, stiffness_start, 1.0), 1.0), 0.0)
    ends = 0.5 * (stiffness_start + stiffness_end) + approach_change * (slope_start - slope_end) / 12.0
    mean = select(
        is_small_approach_change,
        ends,
        select(
            stiffness_start == stiffness_end,
            stiffness_end,
            stiffness_integral / select(is_small_approach_change, 1.0, approach_change),
        ),
    )
    return select(is_unloading, retention, 1.0), select(is_unloading, stiffness_end, mean)


def varying_stiffness_loss(
    start_force: Vector,
    end_force: Vector,
    tangential_displacement: Vector,
    slider_stiffness: tuple[Number, Number],
    slip_force: Number,
    has_contact_change: Number,
    middle_force: Vector,
) -> Number:
    """Energy loss [J/m2] of a slider with changing stiffness: work minus increase of elastic energy.

    start_force, end_force : forces at the start and at the end of the increment
    tangential_displacement : displacement increment
    slider_stiffness : [Pa/m] at both ends
    slip_force : slip force of the return mapping, see `ReturnMapping`
    has_contact_change : whether the contact state changes. Then the work is computed by Simpson's rule with
        the force in the middle of the increment (middle_force), else by Hermite's rule from both ends.
    """
    stiffness_start, stiffness_end = slider_stiffness
    ends = (start_force[0] + end_force[0]) * tangential_displacement[0] + (
        start_force[1] + end_force[1]
    ) * tangential_displacement[1]
    half = middle_force[0] * tangential_displacement[0] + middle_force[1] * tangential_displacement[1]
    hermite_term = select(
        slip_force > 0.0,
        0.0,
        (
            tangential_displacement[0] * tangential_displacement[0]
            + tangential_displacement[1] * tangential_displacement[1]
        )
        * ((stiffness_start - stiffness_end) / 12.0),
    )
    work = select(has_contact_change, ends / 6.0 + 2.0 / 3.0 * half, 0.5 * ends + hermite_term)
    return np.maximum(
        work - (_elastic_energy(end_force, stiffness_end) - _elastic_energy(start_force, stiffness_start)),
        0.0,
    )


def _elastic_energy(slider_force: Vector, slider_stiffness: Number) -> Number:
    """Elastic energy [J/m2] of a slider: force^2/(2 stiffness); 0 without stiffness."""
    has_stiffness = slider_stiffness > 0.0
    square = slider_force[0] * slider_force[0] + slider_force[1] * slider_force[1]
    return select(has_stiffness, square / (2.0 * select(has_stiffness, slider_stiffness, 1.0)), 0.0)
