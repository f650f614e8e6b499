r"""The one integral behind every law: power laws of the spot area over a power-law size distribution.

A spot of area `a` carries a quantity `q(a) = c (a/a_ref)^p` on `[lower, upper]`; there are
`n(a) da = m w (a_L/a)^m da/a` spots of area `a <= a_L`.  With `t = ln(a/a_ref)`, `u = ln(a_L/a_ref)`

.. math::  Q(u) = m w e^{m u} \sum_i c_i \int_{\min(lower_i, u)}^{\min(upper_i, u)} e^{(p_i - m) t} dt .

All logarithms are relative to the reference area, which keeps the powers in range for -600 < u < 300
(130 decades of area above, 260 below); the singularity at `p = m` (D = 1.5, D = 5/3,
zeta (D1 + D2) = 1, ...) is removed by `exprel`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Protocol

import numpy as np

from ..quantity import Number

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(32)
_FEW = 1024
"""Numbers of which all nodes at once fit the cache."""


def exprel(z: Number) -> Number:
    """(exp(z) - 1)/z [1], equal to 1 at z = 0."""
    zero = z == 0.0
    return np.where(zero, 1.0, np.expm1(z) / np.where(zero, 1.0, z))


def exp_integral(x: Number, lower: Number, upper: Number) -> Number:
    """Integral of exp(x t) over [lower, upper] [1], stable through x = 0.

    With t = ln a this is `(upper^x - lower^x)/x` of the areas.  `lower = None` is minus infinity
    (then x > 0).
    """
    if lower is None:
        return np.exp(x * upper) / x
    span = upper - lower
    return np.exp(x * lower) * span * exprel(x * span)


def gauss(function: Callable[[Number], Number], lower: Number, upper: Number) -> Number:
    """Integral of a smooth function over [lower, upper] by 32 Gauss-Legendre nodes.

    The function is called with one node after the other; few numbers go with all nodes at once.
    """
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    total = _WEIGHTS[0] * function(middle + half * _NODES[0])
    if isinstance(total, float | np.ndarray) and np.size(total) <= _FEW:
        column = (-1, *(1 for _ in np.shape(total)))
        rest = _WEIGHTS[1:].reshape(column) * function(middle + half * _NODES[1:].reshape(column))
        return half * (total + np.sum(rest, axis=0))
    for node, weight in zip(_NODES[1:], _WEIGHTS[1:], strict=True):
        total = total + weight * function(middle + half * node)
    return half * total


class Term(Protocol):
    """One regime of a spot law, between two log-areas; None is an open end."""

    @property
    def lower(self) -> Number: ...
    @property
    def upper(self) -> Number: ...

    def spot(self, t: Number) -> Number:
        """Value on one spot of log-area `t`; zero outside the regime."""

    def integral(self, m: Number, u: Number) -> Number:
        """Integral of value times exp(-m t) over the regime, clipped to t <= u."""


@dataclass(frozen=True, slots=True)
class Power:
    """`c exp(p t)` for `lower < t <= upper`; None is an open end."""

    c: Number
    p: Number
    lower: Number = None
    upper: Number = None

    def spot(self, t: Number) -> Number:
        return within(t, self.lower, self.upper) * self.c * np.exp(self.p * t)

    def integral(self, m: Number, u: Number) -> Number:
        lower, upper = clip(self.lower, u), clip(self.upper, u, open_end=u)
        return self.c * exp_integral(self.p - m, lower, upper)


@dataclass(frozen=True, slots=True)
class Smooth:
    """Any smooth function of the log-area on `[lower, upper]`, integrated by Gauss-Legendre."""

    function: Callable[[Number], Number]
    lower: Number
    upper: Number

    def spot(self, t: Number) -> Number:
        inside = np.minimum(np.maximum(t, self.lower), self.upper)
        return within(t, self.lower, self.upper) * self.function(inside)

    def integral(self, m: Number, u: Number) -> Number:
        def integrand(t: Number) -> Number:
            return self.function(np.maximum(t, self.lower)) * np.exp(-m * t)

        if isinstance(u, np.ndarray) and isinstance(self.upper, float) and np.all(u >= self.upper):
            u = self.upper  # one number for all
        return gauss(integrand, clip(self.lower, u), clip(self.upper, u))


@dataclass(frozen=True, slots=True)
class Slip:
    """`c exp(p t) (1 - h exp(-q t))^(1/3)`, zero where the bracket is negative (full slip).

    The substitution `t = t_slip + r^3` removes the cube-root end point, so Gauss-Legendre converges.
    """

    c: Number
    p: Number
    h: Number
    q: Number
    lower: Number
    upper: Number

    def spot(self, t: Number) -> Number:
        stick = np.maximum(1.0 - self.h * np.exp(-self.q * t), 0.0)
        return within(t, self.lower, self.upper) * self.c * np.exp(self.p * t) * stick ** (1.0 / 3.0)

    def integral(self, m: Number, u: Number) -> Number:
        onset = np.log(self.h) / self.q
        lower = np.maximum(clip(self.lower, u), np.minimum(onset, clip(self.upper, u)))
        upper = np.maximum(clip(self.upper, u), lower)

        def integrand(r: Number) -> Number:
            t = onset + r**3
            stick = np.maximum(-np.expm1(-self.q * r**3), 0.0) ** (1.0 / 3.0)
            return 3.0 * r**2 * stick * np.exp((self.p - m) * t)

        start = np.maximum(lower - onset, 0.0) ** (1.0 / 3.0)
        end = np.maximum(upper - onset, 0.0) ** (1.0 / 3.0)
        return self.c * gauss(integrand, start, end)


def clip(bound: Number, u: Number, open_end: Number = None) -> Number:
    """`min(bound, u)`; an open bound stays open."""
    return open_end if bound is None else np.minimum(bound, u)


def within(t: Number, lower: Number, upper: Number) -> Number:
    """1 where `lower < t <= upper`, else 0 [1]."""
    above = 1.0 if lower is None else np.where(t > lower, 1.0, 0.0)
    below = 1.0 if upper is None else np.where(t <= upper, 1.0, 0.0)
    return above * below


@dataclass(frozen=True, slots=True)
class Spots:
    """A spot law together with its size distribution.

    reference : [m2] area at t = 0
    m         : [1]  exponent of the size distribution
    weight    : [1]  its prefactor w
    terms     : {quantity: regimes}; `load` [N] is always there
    onset     : [1]  log-area where the stiffness begins, of a law without plastic spots
    sized     : whether u is the log-area of a largest spot, and not just a measure of the load
    """

    reference: Number
    m: Number
    weight: Number
    terms: Mapping[str, tuple[Term, ...]]
    onset: Number = None
    sized: bool = True

    def total(self, name: str, u: Number) -> Number:
        """Sum over all spots, the largest of which has log-area `u`."""
        return self.m * self.weight * np.exp(self.m * u) * self._integral(name, u)

    def slope(self, name: str, u: Number) -> Number:
        """Derivative of `total` in `u`: m Q + m w q(a_L)."""
        largest = sum(term.spot(u) for term in self.terms[name])
        return self.m * self.total(name, u) + self.m * self.weight * largest

    @property
    def stiff_onset(self) -> Number:
        """Log-area [1] up to which every spot is plastic, so that the stiffness is zero."""
        if self.onset is not None:
            return self.onset
        return reduce(np.minimum, (term.lower for term in self.terms["normal"]))

    @property
    def breaks(self) -> list[float]:
        """Log-areas [1], ascending, where a regime of the stiffness ends: its slope jumps there."""
        return sorted({float(end) for end in self.ends})

    @property
    def ends(self) -> list[Number]:
        """The same as numbers or symbols, unsorted, with repetitions."""
        own = [end for term in self.terms["normal"] for end in (term.lower, term.upper) if end is not None]
        return own if self.onset is None else [*own, self.onset]

    def log_total(self, name: str, u: Number) -> tuple[Number, Number]:
        """`ln Q` and its derivative in `u` (one pass, for the inversion)."""
        integral = self._integral(name, u)
        largest = sum(term.spot(u) for term in self.terms[name])
        growth = largest * np.exp(-self.m * u) / integral
        return np.log(self.m * self.weight * integral) + self.m * u, self.m + growth

    def _integral(self, name: str, u: Number) -> Number:
        return sum(term.integral(self.m, u) for term in self.terms[name])
