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


def exp_integral(exponent: Number, lower_log_area: Number, upper_log_area: Number) -> Number:
    """Integral of exp(x t) dt over log-areas t from lower_log_area to upper_log_area [1].

    exponent       : x [1]; the result is accurate also near x = 0
    lower_log_area : None: minus infinity, for x > 0 only
    """
    if lower_log_area is None:
        return np.exp(exponent * upper_log_area) / exponent
    span = upper_log_area - lower_log_area
    return np.exp(exponent * lower_log_area) * span * exprel(exponent * span)


def integrate_gauss(
    integrand: Callable[[Number], Number], lower_limit: Number, upper_limit: Number
) -> Number:
    """Integral of a smooth function between two limits by 32 Gauss-Legendre nodes.

    The function is called once per node, or for small arrays once with all remaining nodes.
    """
    middle, half = 0.5 * (lower_limit + upper_limit), 0.5 * (upper_limit - lower_limit)
    total = _GAUSS_WEIGHTS[0] * integrand(middle + half * _GAUSS_NODES[0])
    if isinstance(total, float | np.ndarray) and np.size(total) <= _MAX_BATCHED_ARRAY_SIZE:
        column = (-1, *(1 for _ in np.shape(total)))
        rest = _GAUSS_WEIGHTS[1:].reshape(column) * integrand(
            middle + half * _GAUSS_NODES[1:].reshape(column)
        )
        return half * (total + np.sum(rest, axis=0))
    for node, weight in zip(_GAUSS_NODES[1:], _GAUSS_WEIGHTS[1:], strict=True):
        total = total + weight * integrand(middle + half * node)
    return half * total


class RegimeTerm(Protocol):
    """Quantity of a contact spot (load, stiffness, area) in one regime, for example elastic contact.

    The regime lies between two log-areas ln(area of the spot/reference area) [1].
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
        """Integral over the regime of the quantity of a spot, weighted with the size distribution exp(-m t).

        t is the log-area of a spot; the integral ends at the largest spot.

        size_exponent    : exponent m of the size distribution [1]
        largest_log_area : log-area of the largest spot [1]
        """


@dataclass(frozen=True, slots=True)
class PowerTerm:
    """Quantity of a contact spot as a power of its area: coefficient exp(exponent t).

    t is the log-area of the spot, ln(area/reference area). The quantity is 0 outside
    `lower_log_area < t <= upper_log_area`; a bound None is infinite.
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
        upper = clip_regime_bound(
            self.upper_log_area, largest_log_area, limit_of_infinite_regime=largest_log_area
        )
        return self.coefficient * exp_integral(self.exponent - size_exponent, lower, upper)


@dataclass(frozen=True, slots=True)
class SmoothFunctionTerm:
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
            """Quantity of a spot of log-area t, times the weight exp(-m t) of the size distribution."""
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
class PartialSlipTerm:
    """Tangential stiffness of a spot in partial slip, as a function of its log-area t; 0 in full slip.

    coefficient exp(exponent t) (1 - slip_coefficient exp(-slip_exponent t))^(1/3); in full slip the bracket
    is negative.

    The bracket is zero at the log-area t_slip. The substitution `t = t_slip + r^3` removes the cube root, so
    Gauss-Legendre quadrature converges.
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

        def integrand(substituted_log_area: Number) -> Number:
            """Stiffness of a spot of log-area t, times exp(-m t), as integrand over r: t = t_slip + r^3.

            m: exponent of the size distribution; t_slip: log-area up to which spots are in full slip.
            """
            t = onset + substituted_log_area**3
            stick = np.maximum(-np.expm1(-self.slip_exponent * substituted_log_area**3), 0.0) ** (1.0 / 3.0)
            return 3.0 * substituted_log_area**2 * stick * np.exp((self.exponent - size_exponent) * t)

        start = np.maximum(lower - onset, 0.0) ** (1.0 / 3.0)
        end = np.maximum(upper - onset, 0.0) ** (1.0 / 3.0)
        return self.coefficient * integrate_gauss(integrand, start, end)


def clip_regime_bound(
    regime_bound: Number, largest_log_area: Number, limit_of_infinite_regime: Number = None
) -> Number:
    """Clip the bound of a regime to the log-area of the largest spot, as a limit of integration.

    `limit_of_infinite_regime` replaces a bound None (infinite).
    """
    return limit_of_infinite_regime if regime_bound is None else np.minimum(regime_bound, largest_log_area)


def regime_indicator(log_area: Number, lower_log_area: Number, upper_log_area: Number) -> Number:
    """Indicator of a regime [1]: 1 for log-areas t in (lower, upper], else 0."""
    is_above = 1.0 if lower_log_area is None else np.where(log_area > lower_log_area, 1.0, 0.0)
    is_below = 1.0 if upper_log_area is None else np.where(log_area <= upper_log_area, 1.0, 0.0)
    return is_above * is_below


@dataclass(frozen=True, slots=True)
class SpotDistribution:
    """Contact spots of a surface: size distribution; load, stiffness and area of a spot in each regime.

    reference_area : [m2] area a_ref of a spot with the log-area 0
    size_exponent  : [1]  exponent m of the number of spots with an area from a to a + da:
        m w (a_L/a)^m da/a, with the area a_L of the largest spot
    size_prefactor : [1]  prefactor w of this number
    regime_terms   : {quantity of a spot: its terms, one per regime}; always contains `load` [N]
    onset_log_area : [1] log-area at which the stiffness begins, for a law without plastic spots; else None
    has_spot_area : whether the argument u is the log-area of the largest spot; False: the law has no spots,
        and u is a logarithm of the load
    kink_log_areas : log-areas [1], ascending, at which derivatives of a spline of the stiffness jump
    """

    reference_area: Number
    size_exponent: Number
    size_prefactor: Number
    regime_terms: Mapping[str, tuple[RegimeTerm, ...]]
    onset_log_area: Number = None
    has_spot_area: bool = True
    kink_log_areas: Sequence[Number] = ()

    def sum_over_spots(self, quantity_name: str, largest_log_area: Number) -> Number:
        """Sum Q(u) over all spots of a quantity (load, stiffness, area); u: log-area of the largest spot."""
        return (
            self.size_exponent
            * self.size_prefactor
            * np.exp(self.size_exponent * largest_log_area)
            * self._integrate_spots(quantity_name, largest_log_area)
        )

    def sum_over_spots_derivative(self, quantity_name: str, largest_log_area: Number) -> Number:
        """Derivative of `sum_over_spots` with respect to the log-area u of the largest spot.

        m Q + m w q, with the sum Q, the quantity q of the largest spot, and exponent m and prefactor w of the
        size distribution.
        """
        largest = sum(term.evaluate_spot(largest_log_area) for term in self.regime_terms[quantity_name])
        return (
            self.size_exponent * self.sum_over_spots(quantity_name, largest_log_area)
            + self.size_exponent * self.size_prefactor * largest
        )

    @property
    def stiffness_onset_log_area(self) -> Number:
        """Log-area [1] of the largest spot at which stiffness begins: below, all spots are plastic."""
        if self.onset_log_area is not None:
            return self.onset_log_area
        return reduce(np.minimum, (term.lower_log_area for term in self.regime_terms["normal"]))

    @property
    def first_kink_log_area(self) -> Number:
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

    def log_sum_over_spots(self, quantity_name: str, largest_log_area: Number) -> tuple[Number, Number]:
        """Logarithm of the sum of a quantity over all spots, and its derivative with respect to u.

        u: log-area of the largest spot.
        """
        integral = self._integrate_spots(quantity_name, largest_log_area)
        largest = sum(term.evaluate_spot(largest_log_area) for term in self.regime_terms[quantity_name])
        growth = largest * np.exp(-self.size_exponent * largest_log_area) / integral
        return np.log(
            self.size_exponent * self.size_prefactor * integral
        ) + self.size_exponent * largest_log_area, self.size_exponent + growth

    def _integrate_spots(self, quantity_name: str, largest_log_area: Number) -> Number:
        """Integral of a quantity of a spot, weighted with exp(-m t), over log-areas t up to the largest spot.

        m: exponent of the size distribution. `sum_over_spots` multiplies the integral by the number of spots.
        """
        return sum(
            term.integrate_over_spots(self.size_exponent, largest_log_area)
            for term in self.regime_terms[quantity_name]
        )
