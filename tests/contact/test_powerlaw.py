"""Integral of a power law over the spots: against adaptive quadrature, at its removable
singularity, clipped."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import exprel as scipy_exprel

from jointfmu.contact.powerlaw import (
    PartialSlipTerm,
    PowerTerm,
    SmoothFunctionTerm,
    SpotDistribution,
    exp_integral,
    exprel,
    integrate_gauss,
    regime_indicator,
)

EPS = np.finfo(float).eps
# Exponents: ordinary ones, the singular one, and those where (exp(x span) - 1)/x cancels.
exponents = st.one_of(st.floats(-3.0, 3.0), st.just(0.0), st.floats(-1e-6, 1e-6), st.floats(-1e-300, 1e-300))
points = st.floats(-6.0, 6.0)


def reference(function, lower, upper, **options):
    """Integral by adaptive quadrature with the requested tolerance 1e-12."""
    return quad(function, lower, upper, epsabs=0.0, epsrel=1e-12, limit=200, **options)[0]


@given(st.one_of(st.floats(-700.0, 700.0), st.floats(-1e-8, 1e-8), st.just(0.0)))
def test_exprel(z):
    # expm1 and the division are each right to 1 ulp; scipy's own function to about 1 more.
    assert exprel(z) == pytest.approx(scipy_exprel(z), rel=4 * EPS)


def test_exprel_takes_arrays_through_zero():
    z = np.array([-1.0, 0.0, 1e-320, 1.0])
    assert exprel(z) == pytest.approx([1.0 - np.exp(-1.0), 1.0, 1.0, np.e - 1.0], rel=4 * EPS)


@given(x=exponents, lower=points, span=st.floats(1e-3, 8.0))
@example(x=0.0, lower=-1.0, span=2.0)
@example(x=1e-17, lower=-1.0, span=2.0)
def test_exp_integral(x, lower, span):
    expected = reference(lambda t: np.exp(x * t), lower, lower + span)
    # quadrature 1e-12; upper - lower loses up to eps |lower|/span = 2e-12
    assert exp_integral(x, lower, lower + span) == pytest.approx(expected, rel=4e-12)


@given(x=st.floats(0.05, 3.0), upper=points)
def test_exp_integral_from_minus_infinity(x, upper):
    expected = reference(lambda t: np.exp(x * t), upper - 37.0 / x, upper)  # the rest is 1e-16 of it
    assert exp_integral(x, None, upper) == pytest.approx(expected, rel=2e-12)


@pytest.mark.parametrize("k", range(1, 19))
def test_exp_integral_is_continuous_through_the_singularity(k):
    # Taylor: span + x (upper^2 - lower^2)/2 + x^2 (upper^3 - lower^3)/6 + O(x^3)
    lower, upper = 0.5, 3.5
    for x in (10.0**-k, -(10.0**-k)):
        taylor = (upper - lower) + x * (upper**2 - lower**2) / 2 + x**2 * (upper**3 - lower**3) / 6
        # the next term of the series, (upper^4 - lower^4) x^3/24 = 6.3 x^3, and round-off
        assert exp_integral(x, lower, upper) == pytest.approx(taylor, rel=3 * abs(x) ** 3 + 8 * EPS)


def test_exp_integral_of_a_huge_span_stays_finite():
    # 600 decades: exp(x upper) alone would be zero, (upper^x - lower^x) exact
    assert exp_integral(-1.0, 0.0, 1400.0) == pytest.approx(1.0, rel=4 * EPS)


@given(degree=st.integers(0, 63), lower=st.floats(-1.0, 0.5), span=st.floats(0.1, 2.0))
def test_gauss_is_exact_for_degree_63(degree, lower, span):
    upper = lower + span
    exact = (upper ** (degree + 1) - lower ** (degree + 1)) / (degree + 1)
    scale = span * max(abs(lower), abs(upper)) ** degree
    # 32 nodes; each of the nodes and weights is right to a few eps, amplified by the degree
    assert integrate_gauss(lambda t: t**degree, lower, upper) == pytest.approx(
        exact, abs=4 * (degree + 4) * EPS * scale
    )


def test_gauss_is_not_exact_for_degree_64():
    # the 32-point rule misses t^64 by 2^65 (32!)^4/(65 (64!)^2) = 8.5e-20 on [-1, 1]: nothing to see there,
    # so the number of nodes shows on a sharp function: |error| of 1/(1 + 25 t^2) ~ (1.22)^-64 = 3e-6
    exact = 2.0 / 5.0 * np.arctan(5.0)
    error = abs(integrate_gauss(lambda t: 1.0 / (1.0 + 25.0 * t**2), -1.0, 1.0) - exact)
    assert 1e-7 < error < 1e-4


def test_within_belongs_to_the_regime_below():
    assert list(regime_indicator(np.array([0.0, 1.0, 2.0, 3.0]), 1.0, 2.0)) == [0.0, 0.0, 1.0, 0.0]
    assert list(regime_indicator(np.array([-1e9, 1e9]), None, 0.0)) == [1.0, 0.0]
    assert list(regime_indicator(np.array([-1e9, 1e9]), 0.0, None)) == [0.0, 1.0]


@given(p=st.floats(-1.0, 2.0), m=st.floats(0.1, 1.0), lower=points, span=st.floats(0.01, 6.0), u=points)
def test_power(p, m, lower, span, u):
    term = PowerTerm(2.5, p, lower, lower + span)
    end = min(lower + span, u)
    expected = reference(lambda t: 2.5 * np.exp((p - m) * t), lower, end) if end > lower else 0.0
    # quadrature 1e-12; the span of the clipped interval loses eps max|t|/span, absolutely
    assert term.integrate_over_spots(m, u) == pytest.approx(
        expected, rel=4e-12, abs=20 * EPS * np.exp(abs(p - m) * 12)
    )


@given(p=st.floats(-1.0, 2.0), u=points)
def test_power_at_the_singular_exponent(p, u):
    term = PowerTerm(2.5, p, -1.0, 3.0)
    span = min(3.0, u) - min(-1.0, u)
    assert term.integrate_over_spots(p, u) == pytest.approx(2.5 * span, rel=4 * EPS)


@given(m=st.floats(0.1, 0.9), u=points)
def test_power_open_at_both_ends(m, u):
    assert PowerTerm(2.0, 1.0).integrate_over_spots(m, u) == pytest.approx(
        2.0 * np.exp((1 - m) * u) / (1 - m), rel=8 * EPS
    )
    # an open upper end is u, an open lower end below a closed upper one is clipped to u as well
    closed = min(0.0, u)
    assert PowerTerm(2.0, 1.0, upper_log_area=0.0).integrate_over_spots(m, u) == pytest.approx(
        2.0 * np.exp((1 - m) * closed) / (1 - m), rel=8 * EPS
    )
    above = reference(lambda t: 2.0 * np.exp((1 - m) * t), 0.0, u) if u > 0.0 else 0.0
    assert PowerTerm(2.0, 1.0, 0.0).integrate_over_spots(m, u) == pytest.approx(above, rel=4e-12)


def test_power_on_one_spot():
    term = PowerTerm(2.0, 0.5, 0.0, 1.0)
    t = np.array([-0.1, 0.0, 0.5, 1.0, 1.1])
    assert term.evaluate_spot(t) == pytest.approx(
        [0.0, 0.0, 2 * np.exp(0.25), 2 * np.exp(0.5), 0.0], rel=4 * EPS
    )


def bump(t):
    return np.exp(0.7 * t) / (1.0 + np.exp(0.3 * t)) ** 2


@given(m=st.floats(0.1, 1.0), lower=points, span=st.floats(0.01, 12.0), u=points)
def test_smooth(m, lower, span, u):
    term = SmoothFunctionTerm(bump, lower, lower + span)
    end = min(lower + span, u)
    expected = reference(lambda t: bump(t) * np.exp(-m * t), lower, end) if end > lower else 0.0
    # poles of the bump at +-10.5 i: the 32-point rule has converged (error 3.4^-64); quadrature 1e-12
    assert term.integrate_over_spots(m, u) == pytest.approx(expected, rel=4e-12, abs=1e-12)
    assert term.evaluate_spot(lower + 0.5 * span) == bump(lower + 0.5 * span)
    assert term.evaluate_spot(lower - 0.01) == 0.0


def slip_value(t, p, h, q):
    return np.exp(p * t) * max(1.0 - h * np.exp(-q * t), 0.0) ** (1.0 / 3.0)


@given(
    m=st.floats(0.5, 1.0),
    q=st.floats(0.08, 0.6),
    onset=st.floats(-8.0, 12.0),
    lower=st.floats(0.0, 5.0),
    span=st.floats(0.1, 12.0),
    u=st.floats(0.0, 20.0),
)
def test_slip(m, q, onset, lower, span, u):
    h = np.exp(q * onset)  # 1 - h exp(-q t) changes sign at t = onset
    term = PartialSlipTerm(3.0, 0.5, h, q, lower, lower + span)
    end = min(lower + span, u)
    start = max(lower, onset)

    def value(t):
        return 3.0 * slip_value(t, 0.5, h, q) * np.exp(-m * t)

    expected = 0.0
    if end > start:
        # own substitution t = start + y^3 for the adaptive rule: a cube root has no Taylor series
        expected = reference(lambda y: 3.0 * y**2 * value(start + y**3), 0.0, np.cbrt(end - start))
    # 1e-9: the cancellation in 1 - h exp(-q t) near the onset, (eps/(q y^3))^(1/3) over the first y
    assert term.integrate_over_spots(m, u) == pytest.approx(expected, rel=1e-9, abs=1e-13)
    middle = lower + 0.5 * span
    # eps/(1 - h exp(-q t)) on the bracket, whose cube root is taken
    assert term.evaluate_spot(middle) == pytest.approx(
        3.0 * slip_value(middle, 0.5, h, q), rel=1e-9, abs=1e-4
    )


def test_slip_is_zero_when_every_spot_slips():
    term = PartialSlipTerm(3.0, 0.5, np.exp(0.5 * 9.0), 0.5, 0.0, 8.0)  # onset 9 above the regime
    assert term.integrate_over_spots(0.7, 20.0) == 0.0
    assert term.evaluate_spot(7.0) == 0.0


TERMS = {
    "load": (
        PowerTerm(2.0, 1.0, upper_log_area=-1.0),
        SmoothFunctionTerm(bump, -1.0, 0.0),
        PowerTerm(3.0, 0.79, 0.0),
    ),
    "singular": (PowerTerm(2.0, 0.71, -3.0, 2.0),),  # p = m
    "slip": (PartialSlipTerm(3.0, 0.5, np.exp(0.5 * 0.7), 0.5, 0.0, 4.0),),
}
SPOTS = SpotDistribution(reference_area=1e-9, size_exponent=0.71, size_prefactor=1.3, regime_terms=TERMS)
EDGES = (-3.0, -1.0, 0.0, 0.7, 2.0, 4.0)
away = st.floats(-8.0, 9.0).filter(lambda u: min(abs(u - edge) for edge in EDGES) > 1e-3)


@given(u=away)
@pytest.mark.parametrize("name", TERMS)
def test_total_is_the_integral_of_all_spots(name, u):
    def density(t):
        return 0.71 * 1.3 * np.exp(0.71 * (u - t)) * sum(float(term.evaluate_spot(t)) for term in TERMS[name])

    inside = sorted(edge for edge in EDGES if edge < u)
    ends = [-130.0, *inside, u]  # exp((1 - m) t) is below 1e-16 of the total there
    expected = sum(quad(density, *pair, limit=200, epsabs=0.0, epsrel=1e-9)[0] for pair in pairwise(ends))
    # the adaptive rule meets the cube root end point without a substitution here: 1e-7
    assert SPOTS.sum_over_spots(name, u) == pytest.approx(expected, rel=1e-7, abs=1e-12)


@given(u=away)
@pytest.mark.parametrize("name", TERMS)
def test_slope_is_the_derivative_of_total(name, u):
    h = 1e-5
    finite = (SPOTS.sum_over_spots(name, u + h) - SPOTS.sum_over_spots(name, u - h)) / (2 * h)
    # eps/h = 2e-11 round-off; h^2/6 = 2e-11 times the third derivative, which the cube root makes large:
    # u^(1/3 - 3) at 1e-3 from the onset gives 1e-4 there
    tolerance = 2e-4 if name == "slip" and 0.7 < u < 1.2 else 1e-8
    assert SPOTS.sum_over_spots_derivative(name, u) == pytest.approx(finite, rel=tolerance, abs=1e-9)


@given(u=st.floats(-30.0, 30.0))
def test_log_total_is_the_logarithm_of_total(u):
    value, growth = SPOTS.log_sum_over_spots("load", u)
    total, slope = SPOTS.sum_over_spots("load", u), SPOTS.sum_over_spots_derivative("load", u)
    assert value == pytest.approx(np.log(total), rel=8 * EPS, abs=8 * EPS)
    assert growth == pytest.approx(slope / total, rel=16 * EPS)


@pytest.mark.parametrize(("u", "growth"), [(-690.0, 1.0), (690.0, 0.79)])
def test_log_total_far_from_the_reference(u, growth):
    # 300 decades either way: the largest spots are all plastic (p = 1) or all elastic (p = 0.79),
    # since the smaller ones hold exp(-(p - m) 690) = 1e-24 of the load
    value, slope = SPOTS.log_sum_over_spots("load", u)
    prefactor = {1.0: 2.0 / (1.0 - 0.71), 0.79: 3.0 / (0.79 - 0.71)}[growth]
    # m u and p u differ by eps 690
    assert value == pytest.approx(np.log(0.71 * 1.3 * prefactor) + growth * u, abs=8 * EPS * 690)
    # exp(p u) exp(-m u): relative error eps u
    assert slope == pytest.approx(growth, rel=4 * EPS * 690)


def test_total_takes_arrays():
    u = np.array([[-5.0, -0.5], [0.5, 5.0]])
    for name in TERMS:
        expected = [SPOTS.sum_over_spots(name, x) for x in u.ravel()]
        # the vector and the scalar exponential of numpy may differ by an ulp
        assert SPOTS.sum_over_spots(name, u).ravel() == pytest.approx(expected, rel=16 * EPS, abs=1e-300)
