r"""Sums over contact spots: power laws of the spot area, integrated over a power-law size distribution.

A spot of area `a` carries a quantity `q(a) = c (a/a_ref)^p` on `[lower, upper]`; there are
`n(a) da = m w (a_L/a)^m da/a` spots of area `a <= a_L`.  With `t = ln(a/a_ref)`, `u = ln(a_L/a_ref)`

.. math::  Q(u) = m w e^{m u} \sum_i c_i \int_{\min(lower_i, u)}^{\min(upper_i, u)} e^{(p_i - m) t} dt .

All logarithms are relative to the reference area, which keeps the powers in range for -600 < u < 300
(130 decades of area above, 260 below). The removable singularity at `p = m` (D = 1.5, D = 5/3,
zeta (D1 + D2) = 1, ...) is handled by `exprel`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Protocol

import numpy as np

from ..quantity import Number

_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(32)
_MAX_BATCHED_ARRAY_SIZE = 1024
"""Array size [1] up to which all quadrature nodes are evaluated at once, within the cache."""


def exprel(z: Number) -> Number:
    """Relative exponential (exp(z) - 1)/z [1], equal to 1 at z = 0."""
    zero = z == 0.0
    return np.where(zero, 1.0, np.expm1(z) / np.where(zero, 1.0, z))


def exp_integral(x: Number, lower: Number, upper: Number) -> Number:
    """Integral of exp(x t) over log-areas t in [lower, upper] [1], accurate also near x = 0.

    With t = ln a this is `(upper^x - lower^x)/x` of the areas. `lower = None` stands for minus infinity,
    with x > 0.
    """
    if lower is None:
        return np.exp(x * upper) / x
    span = upper - lower
    return np.exp(x * lower) * span * exprel(x * span)


def integrate_gauss(function: Callable[[Number], Number], lower: Number, upper: Number) -> Number:
    """Integral of a smooth function over [lower, upper] by 32 Gauss-Legendre nodes.

    The function is called once per node, or for small arrays once with all remaining nodes.
    """
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    total = _GAUSS_WEIGHTS[0] * function(middle + half * _GAUSS_NODES[0])
    if isinstance(total, float | np.ndarray) and np.size(total) <= _MAX_BATCHED_ARRAY_SIZE:
        column = (-1, *(1 for _ in np.shape(total)))
        rest = _GAUSS_WEIGHTS[1:].reshape(column) * function(middle + half * _GAUSS_NODES[1:].reshape(column))
        return half * (total + np.sum(rest, axis=0))
    for node, weight in zip(_GAUSS_NODES[1:], _GAUSS_WEIGHTS[1:], strict=True):
        total = total + weight * function(middle + half * node)
    return half * total


class RegimeTerm(Protocol):
    """Quantity of a contact spot (load, stiffness, area) in one regime, for example elastic contact.

    The regime lies between two log-areas t = ln(area/reference area) [1].
    """

    @property
    def lower_log_area(self) -> Number:
        """Log-area [1] of the spots at which the regime begins; None: minus infinity."""

    @property
    def upper_log_area(self) -> Number:
        """Log-area [1] of the spots at which the regime ends; None: infinity."""

    def evaluate_spot(self, log_area: Number) -> Number:
        """Quantity (such as load or stiffness) of one spot of log-area t; 0 outside the regime."""

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        """Integral of the quantity of a spot times exp(-m t) over the regime, for log-areas t <= u.

        size_exponent, largest_log_area : m and u
        """


@dataclass(frozen=True, slots=True)
class PowerTerm:
    """Quantity of a contact spot as a power of its area: coefficient exp(exponent t), t its log-area.

    The quantity is 0 outside `lower_log_area < t <= upper_log_area`; a bound None is infinite.
    """

    coefficient: Number
    exponent: Number
    lower_log_area: Number = None
    upper_log_area: Number = None

    def evaluate_spot(self, log_area: Number) -> Number:
        return (
            regime_indicator(log_area, self.lower_log_area, self.upper_log_area)
            * self.coefficient
            * np.exp(self.exponent * log_area)
        )

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        lower = clip_regime_bound(self.lower_log_area, largest_log_area)
        upper = clip_regime_bound(self.upper_log_area, largest_log_area, value_if_infinite=largest_log_area)
        return self.coefficient * exp_integral(self.exponent - size_exponent, lower, upper)


@dataclass(frozen=True, slots=True)
class SmoothTerm:
    """Quantity of a contact spot as a smooth function of its log-area, summed by Gauss-Legendre quadrature.

    The quantity is 0 outside `[lower_log_area, upper_log_area]`.
    """

    spot_function: Callable[[Number], Number]
    lower_log_area: Number
    upper_log_area: Number

    def evaluate_spot(self, log_area: Number) -> Number:
        inside = np.minimum(np.maximum(log_area, self.lower_log_area), self.upper_log_area)
        return regime_indicator(log_area, self.lower_log_area, self.upper_log_area) * self.spot_function(
            inside
        )

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        def integrand(log_area: Number) -> Number:
            """Quantity of a spot times exp(-m t), the integrand over log-areas t."""
            return self.spot_function(np.maximum(log_area, self.lower_log_area)) * np.exp(
                -size_exponent * log_area
            )

        if (
            isinstance(largest_log_area, np.ndarray)
            and isinstance(self.upper_log_area, float)
            and np.all(largest_log_area >= self.upper_log_area)
        ):
            largest_log_area = self.upper_log_area  # the integral is the same for all points
        return integrate_gauss(
            integrand,
            clip_regime_bound(self.lower_log_area, largest_log_area),
            clip_regime_bound(self.upper_log_area, largest_log_area),
        )


@dataclass(frozen=True, slots=True)
class SlipTerm:
    """Tangential stiffness of a spot in partial slip, as a function of its log-area t; 0 in full slip.

    coefficient exp(exponent t) (1 - slip_coefficient exp(-slip_exponent t))^(1/3); in full slip the bracket
    is negative.

    The substitution `t = t_slip + r^3` removes the cube root at the end of slip, so Gauss-Legendre converges.
    """

    coefficient: Number
    exponent: Number
    slip_coefficient: Number
    slip_exponent: Number
    lower_log_area: Number
    upper_log_area: Number

    def evaluate_spot(self, log_area: Number) -> Number:
        stick = np.maximum(1.0 - self.slip_coefficient * np.exp(-self.slip_exponent * log_area), 0.0)
        return (
            regime_indicator(log_area, self.lower_log_area, self.upper_log_area)
            * self.coefficient
            * np.exp(self.exponent * log_area)
            * stick ** (1.0 / 3.0)
        )

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        onset = np.log(self.slip_coefficient) / self.slip_exponent
        lower = np.maximum(
            clip_regime_bound(self.lower_log_area, largest_log_area),
            np.minimum(onset, clip_regime_bound(self.upper_log_area, largest_log_area)),
        )
        upper = np.maximum(clip_regime_bound(self.upper_log_area, largest_log_area), lower)

        def integrand(cube_root: Number) -> Number:
            """Stiffness of a spot times exp(-m t), after the substitution t = t_slip + r^3."""
            t = onset + cube_root**3
            stick = np.maximum(-np.expm1(-self.slip_exponent * cube_root**3), 0.0) ** (1.0 / 3.0)
            return 3.0 * cube_root**2 * stick * np.exp((self.exponent - size_exponent) * t)

        start = np.maximum(lower - onset, 0.0) ** (1.0 / 3.0)
        end = np.maximum(upper - onset, 0.0) ** (1.0 / 3.0)
        return self.coefficient * integrate_gauss(integrand, start, end)


def clip_regime_bound(
    regime_bound: Number, largest_log_area: Number, value_if_infinite: Number = None
) -> Number:
    """Integration limit over the log-areas of spots: the bound of a regime, at most u of the largest spot.

    `value_if_infinite` replaces a bound None (infinite).
    """
    return value_if_infinite if regime_bound is None else np.minimum(regime_bound, largest_log_area)


def regime_indicator(log_area: Number, lower_log_area: Number, upper_log_area: Number) -> Number:
    """Indicator of a regime [1]: 1 for log-areas t in (lower, upper], else 0."""
    is_above = 1.0 if lower_log_area is None else np.where(log_area > lower_log_area, 1.0, 0.0)
    is_below = 1.0 if upper_log_area is None else np.where(log_area <= upper_log_area, 1.0, 0.0)
    return is_above * is_below


@dataclass(frozen=True, slots=True)
class SpotDistribution:
    """Contact spots of a surface: size distribution; load, stiffness and area of a spot in each regime.

    reference_area : [m2] area a_ref of a spot with the log-area 0
    size_exponent  : [1]  exponent m of the size distribution
    size_prefactor : [1]  prefactor w of the size distribution
    regime_terms   : {quantity of a spot: its terms, one per regime}; always contains `load` [N]
    onset_log_area : [1] log-area at which the stiffness begins, for a law without plastic spots; else None
    has_spot_area : whether u is the log-area of the largest spot; else it only measures the load
    kink_log_areas : log-areas [1], ascending, at which derivatives of a spline of the stiffness jump
    """

    reference_area: Number
    size_exponent: Number
    size_prefactor: Number
    regime_terms: Mapping[str, tuple[RegimeTerm, ...]]
    onset_log_area: Number = None
    has_spot_area: bool = True
    kink_log_areas: Sequence[Number] = ()

    def sum_over_spots(self, quantity: str, largest_log_area: Number) -> Number:
        """Sum Q(u) over all spots of a quantity (load, stiffness, area); u: log-area of the largest spot."""
        return (
            self.size_exponent
            * self.size_prefactor
            * np.exp(self.size_exponent * largest_log_area)
            * self._integrate_spots(quantity, largest_log_area)
        )

    def sum_over_spots_derivative(self, quantity: str, largest_log_area: Number) -> Number:
        """Derivative of `sum_over_spots` by the log-area u of the largest spot: m Q + m w q(a_L)."""
        largest = sum(term.evaluate_spot(largest_log_area) for term in self.regime_terms[quantity])
        return (
            self.size_exponent * self.sum_over_spots(quantity, largest_log_area)
            + self.size_exponent * self.size_prefactor * largest
        )

    @property
    def stiffness_onset_log_area(self) -> Number:
        """Log-area [1] of the largest spot at which stiffness begins: below, all spots are plastic."""
        if self.onset_log_area is not None:
            return self.onset_log_area
        return reduce(np.minimum, (term.lower_log_area for term in self.regime_terms["normal"]))

    @property
    def first_kink(self) -> Number:
        """Smallest log-area [1] at which derivatives of a spline of the stiffness jump.

        Plus infinity for a law without such a spline.
        """
        return self.kink_log_areas[0] if self.kink_log_areas else np.inf

    @property
    def sorted_regime_end_log_areas(self) -> list[float]:
        """Log-areas [1], ascending, at which the stiffness of a spot changes its regime or has a kink.

        At a kink, derivatives of a spline of the stiffness jump.
        """
        return sorted({float(end) for end in self.regime_end_log_areas})

    @property
    def regime_end_log_areas(self) -> list[Number]:
        """Log-areas [1] at which the stiffness of a spot changes its regime or has a kink, unsorted.

        The log-areas are numbers or symbols.
        """
        ends = [
            end
            for term in self.regime_terms["normal"]
            for end in (term.lower_log_area, term.upper_log_area)
            if end is not None
        ]
        return [*ends, *([] if self.onset_log_area is None else [self.onset_log_area]), *self.kink_log_areas]

    def log_sum_over_spots(self, quantity: str, largest_log_area: Number) -> tuple[Number, Number]:
        """Logarithm ln Q(u) of the sum over all spots, and its derivative with respect to u."""
        integral = self._integrate_spots(quantity, largest_log_area)
        largest = sum(term.evaluate_spot(largest_log_area) for term in self.regime_terms[quantity])
        growth = largest * np.exp(-self.size_exponent * largest_log_area) / integral
        return np.log(
            self.size_exponent * self.size_prefactor * integral
        ) + self.size_exponent * largest_log_area, self.size_exponent + growth

    def _integrate_spots(self, quantity: str, largest_log_area: Number) -> Number:
        """Integral of a quantity over the spots up to log-area u, without the prefactor of their number."""
        return sum(
            term.integrate_over_spots(self.size_exponent, largest_log_area)
            for term in self.regime_terms[quantity]
        )
