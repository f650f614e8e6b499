"""Jenkins sliders: a spring in series with dry friction, whose limit may depend on a normal load.

`elastic_predictor` and `return_map` update one slider for a displacement increment. They accept arrays for
many sliders, and symbols, from which the C code of the FMUs and its derivatives are generated. Displacements
are along one direction or in a plane: vectors have one component or two.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..quantity import Array, Number, select

Vector = Sequence[Number]
"""Components of a force or displacement: one along a direction, two in a plane."""
ROUND_OFF_TOLERANCE = 1e-14
"""Relative excess over the limit [1] at which a slider still sticks: round-off of a return mapping."""
AT_LIMIT_TOLERANCE = 1e-12
"""Relative distance below the limit [1] at which a force counts as at the limit."""
MIN_DENOMINATOR = 1e-200
"""Smallest denominator: replaces 0 in divisions by powers of forces and squared displacements."""
HERMITE_RULE_WEIGHT = 1.0 / 12.0
"""Weight [1] of the end derivatives in the corrected trapezoidal rule (Hermite's rule)."""
MAX_INVERSE_FRICTION_LIMIT = 1e30
"""Largest value of 1/limit, for limits near zero."""


def elastic_predictor(
    start_force: Vector, retained_fraction: Number, secant_stiffness: Number, displacement_increment: Vector
) -> Vector:
    """Elastic predictor of the friction force, for a slider that sticks.

    Its components are retained_fraction q + secant_stiffness u.

    start_force            : q, one or two components, at the start of the increment
    retained_fraction      : fraction [1] of q that remains while the normal load changes
    secant_stiffness       : stiffness for the increment
    displacement_increment : u, as many components as q
    """
    return [
        retained_fraction * q + secant_stiffness * u
        for q, u in zip(start_force, displacement_increment, strict=True)
    ]


def yield_function(friction_force: Vector, friction_limit: Number) -> Number:
    """Yield function: positive if the force exceeds the limit.

    |q| - limit along one direction; |q|^2 - (1 + ROUND_OFF_TOLERANCE) limit^2 in a plane.
    """
    if len(friction_force) == 1:
        return np.abs(friction_force[0]) - friction_limit
    return (
        friction_force[0] * friction_force[0]
        + friction_force[1] * friction_force[1]
        - (1.0 + ROUND_OFF_TOLERANCE) * (friction_limit * friction_limit)
    )


def slip_limit_function(friction_force: Vector, friction_limit: Number) -> Number:
    """Function of a force, positive at the friction limit: further motion in its direction causes slip.

    |q| - limit along one direction; |q|^2 - limit^2 in a plane, with the limit reduced by AT_LIMIT_TOLERANCE.
    """
    reduced_limit = (1.0 - AT_LIMIT_TOLERANCE) * friction_limit
    if len(friction_force) == 1:
        return np.abs(friction_force[0]) - reduced_limit
    return (
        friction_force[0] * friction_force[0]
        + friction_force[1] * friction_force[1]
        - reduced_limit * reduced_limit
    )


_MappingResult = tuple[Vector, Vector, Number, Number]
"""Result of a return mapping: forces, tangent stiffness, slip force, mean limit during the slip."""


@dataclass(frozen=True, slots=True)
class ReturnMapping:
    """Result of `return_map`: friction force, tangent and loss of one slider, or many, after an increment.

    force             : friction force, one or two components
    tangent           : tangent stiffness for a further increment. One direction: along and across it. Plane:
        components xx, xy, yy of K (1 - n n) for a slider at its limit, with the stiffness K of its spring and
        the unit vector n of its force; else of K.
    dissipated_energy : energy dissipated in the increment
    slip_force        : force of the elastic predictor above the friction limit; 0 if the slider sticks
    """

    force: Vector
    tangent: Vector
    dissipated_energy: Number
    slip_force: Number


def return_map(
    start_force: Vector,
    retained_fraction: Number,
    secant_stiffness: Number,
    displacement_increment: Vector,
    start_limit: Number,
    end_limit: Number,
    spring_stiffness: Number,
    spring_compliance: Number,
) -> ReturnMapping:
    """Return mapping of a slider for one displacement increment.

    start_force            : friction force at the start
    retained_fraction, secant_stiffness, displacement_increment : see `elastic_predictor`
    start_limit, end_limit : friction limit at the start and at the end of the increment
    spring_stiffness       : K at the end
    spring_compliance      : 1/K, 0 without springs

    One direction: the force is limited to the limit. The loss is the mean limit during slip times the slip
    distance, exact for constant K. Plane: while the slider slips, its force turns towards the displacement.
    Under constant load tan(angle/2) between both decreases as exp(-K distance/limit) (Krieg and Krieg 1977).
    Angle and loss are accurate to third order in the distance, and exact if the force does not turn.
    """
    predictor = elastic_predictor(start_force, retained_fraction, secant_stiffness, displacement_increment)
    if len(predictor) == 1:
        new_force, tangent, slip, mean = _return_map_1d(
            start_force, predictor, start_limit, end_limit, spring_stiffness
        )
    else:
        new_force, tangent, slip, mean = _return_map_2d(
            start_force,
            predictor,
            displacement_increment,
            secant_stiffness,
            (start_limit, end_limit),
            spring_stiffness,
        )
    return ReturnMapping(new_force, tangent, mean * (slip * spring_compliance), slip)


def project_to_limit(friction_force: Number, friction_limit: Number) -> Number:
    """Clip a force along one direction to the range from -limit to limit."""
    return np.minimum(np.maximum(friction_force, -friction_limit), friction_limit)


def _return_map_1d(
    start_force: Vector,
    predicted_force: Vector,
    start_limit: Number,
    end_limit: Number,
    spring_stiffness: Number,
) -> _MappingResult:
    """Return mapping along one direction: the predictor is clipped to the friction limit."""
    new_force = project_to_limit(predicted_force[0], end_limit)
    slip = np.abs(predicted_force[0] - new_force)
    slips = slip > 0.0
    margin = np.maximum(start_limit - select(predicted_force[0] < 0.0, -start_force[0], start_force[0]), 0.0)
    onset = margin / np.maximum(margin + slip, MIN_DENOMINATOR)
    mean = 0.5 * (end_limit + start_limit + onset * (end_limit - start_limit))
    return [new_force], [select(slips, 0.0, spring_stiffness), spring_stiffness], slip, mean


def _return_map_2d(
    start_force: Vector,
    predicted_force: Vector,
    displacement_increment: Vector,
    secant_stiffness: Number,
    friction_limits: Vector,
    spring_stiffness: Number,
) -> _MappingResult:
    """Return mapping in a plane: radial return of the predictor, corrected for the rotation of the force.

    Before the radial return, half of K distance slip/limit is added to the predictor in the direction of the
    displacement. With g = K distance/limit the direction of the force is then accurate to g^3, also if the
    limit changes during the increment. If the limit decreases strongly, the correction is bounded, so that a
    force against the displacement does not change its side. The slip is |predictor| - limit, plus
    limit g^2 (sin^2 start - sin^2 end)/12 by Hermite's rule, of the angle between force and displacement.
    """
    limit_start, limit = friction_limits
    distance = np.sqrt(
        np.maximum(
            displacement_increment[0] * displacement_increment[0]
            + displacement_increment[1] * displacement_increment[1],
            MIN_DENOMINATOR,
        )
    )
    e_x, e_y = displacement_increment[0] / distance, displacement_increment[1] / distance
    square, squared = (
        predicted_force[0] * predicted_force[0] + predicted_force[1] * predicted_force[1],
        limit * limit,
    )
    largest = np.maximum(np.maximum(squared, square), MIN_DENOMINATOR)
    size = np.sqrt(largest)
    slips, out = yield_function(predicted_force, limit) > 0.0, size - limit
    margin = np.maximum(
        limit_start * size - (start_force[0] * predicted_force[0] + start_force[1] * predicted_force[1]), 0.0
    )
    sum_ = margin + out * size
    inverse = 1.0 / np.maximum(limit * sum_, MIN_DENOMINATOR)
    per_limit, share = (
        np.minimum(inverse * sum_, MAX_INVERSE_FRICTION_LIMIT),
        inverse * (limit * (out * size)),
    )
    slip_angle = share * (secant_stiffness * distance)
    start_square = np.minimum(np.maximum(limit_start * limit_start, squared), largest)
    decrease = start_square - squared  # the limit decreased: slip starts from the reduced limit
    shrinks = squared * squared + decrease * decrease / 16.0
    per_shrinks = 1.0 / np.maximum(shrinks * start_square, MIN_DENOMINATOR)
    turn_factor = (
        0.25 * (decrease * squared * start_square + (largest - start_square) * shrinks) * per_shrinks
    )
    correction_factor = turn_factor - HERMITE_RULE_WEIGHT * shrinks * per_shrinks * (slip_angle * slip_angle)
    correction = select(slips, slip_angle * correction_factor, 0.0)
    corrected = [q + correction * e for q, e in zip(predicted_force, (e_x, e_y), strict=True)]
    size2 = np.maximum(corrected[0] * corrected[0] + corrected[1] * corrected[1], MIN_DENOMINATOR)
    per_size = np.sqrt(size2) / size2
    n = [per_size * q for q in corrected]
    across = n[0] * e_y - n[1] * e_x
    rotation = slip_angle * across
    hermite = (
        rotation
        * rotation
        * np.maximum(1.0 - squared * (per_size * per_size), 0.0)
        * (HERMITE_RULE_WEIGHT * per_limit)
    )
    slip_stiffness = select(slip_limit_function(predicted_force, limit) > 0.0, spring_stiffness, 0.0)
    tangent = [
        spring_stiffness - slip_stiffness * n[0] * n[0],
        -slip_stiffness * n[0] * n[1],
        spring_stiffness - slip_stiffness * n[1] * n[1],
    ]
    new_force = [select(slips, limit * m, q) for m, q in zip(n, predicted_force, strict=True)]
    mean = 0.5 * (limit_start + limit + (1.0 - share) * (limit - limit_start))
    return new_force, tangent, select(slips, out + hermite, 0.0), mean


@dataclass(frozen=True, slots=True)
class SliderUpdate:
    """Update of parallel sliders for a displacement increment, in any consistent units (also per area).

    force             : (..., n) friction force of each slider along one direction, (..., 2, n) in a plane
    dissipated_energy : (...) energy dissipated in the increment
    tangent           : (...) tangent stiffness of their sum, see `ReturnMapping`; for a foundation (..., 6):
        xx, xy, yy, xr, yr, rr, with r the displacement around the centre of the patch
    """

    force: Array
    dissipated_energy: Array
    tangent: Array

    @property
    def traction(self) -> Array:
        """Friction traction: sum of the friction forces of all sliders, in the unit of `force`.

        Shape (...) along one direction, (..., 2) in a plane.
        """
        return np.asarray(np.sum(self.force, axis=-1))


@dataclass(frozen=True, slots=True)
class Sliders:
    """Parallel Jenkins sliders; `stiffness` (..., n) of their springs."""

    stiffness: Array

    @property
    def has_friction(self) -> bool:
        """Whether any slider has stiffness."""
        return bool(np.any(self.stiffness > 0.0))

    @property
    def compliance(self) -> Array:
        """Compliance (..., n) of the springs; 0 for a slider without stiffness."""
        return np.asarray(compliance(self.stiffness))

    def advance_1d(
        self, start_force: Array, displacement_increment: ArrayLike, start_limit: Array, end_limit: Array
    ) -> SliderUpdate:
        """Update the sliders for displacements (...) along one direction.

        start_force            : (..., n) friction force of each slider at the start
        start_limit, end_limit : (..., n) friction limits
        """
        increment = [np.asarray(displacement_increment)[..., None]]
        mapping = return_map(
            [start_force],
            1.0,
            self.stiffness,
            increment,
            start_limit,
            end_limit,
            self.stiffness,
            self.compliance,
        )
        return SliderUpdate(
            np.asarray(mapping.force[0]),
            np.sum(mapping.dissipated_energy, axis=-1),
            np.sum(mapping.tangent[0], axis=-1),
        )

    def follow_increments(self, displacement_increments: Array, friction_limit: Array) -> Array:
        """Total force (m) after each of m displacement increments along one direction, from the virgin state.

        friction_limit : (n) constant friction limits of the n sliders
        """
        force, totals = np.zeros_like(friction_limit), np.empty(displacement_increments.size)
        for n, increment in enumerate(displacement_increments):
            force = project_to_limit(
                elastic_predictor([force], 1.0, self.stiffness, [increment])[0], friction_limit
            )
            totals[n] = np.add.reduce(force)
        return totals


def compliance(spring_stiffness: Number) -> Number:
    """Compliance 1/stiffness of springs, in the inverse unit of the stiffness; 0 where there is no spring."""
    has_spring = spring_stiffness > 0.0
    return select(has_spring, 1.0 / select(has_spring, spring_stiffness, 1.0), 0.0)
