"""Constants of surfaces and materials: limits, roots and reference implementations."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1

from jointfmu.contact.surface import (
    ElasticConstants,
    complete_elliptic_integrals,
    contact_modulus,
    contact_shear_modulus,
    domain_extension,
    domain_extension_fit,
    hardness_coefficient,
)

EPS = np.finfo(float).eps


def zhao_equation_3(psi, D):
    return (psi ** ((2 - D) / 2) - (1 + psi ** (-D / 2)) ** (-(2 - D) / D)) / ((2 - D) / D) - 1


@given(D=st.floats(1.0 + 1e-9, 2.0 - 1e-6))
def test_psi_solves_equation_3(D):
    # the difference of two numbers near 1 is divided by q = (2 - D)/D
    assert abs(zhao_equation_3(domain_extension(D), D)) <= 8 * EPS * D / (2 - D)


@given(D=st.floats(1.01, 1.99))
def test_psi_is_the_only_root(D):
    root = brentq(zhao_equation_3, 1.2, 5.0, args=(D,), xtol=1e-15, rtol=4 * EPS)
    # brentq sees the round-off of the residual, eps/q, over a slope of order 1
    assert domain_extension(D) == pytest.approx(root, rel=16 * EPS * D / (2 - D))


def test_psi_limits():
    # the golden ratio squared and e - 1; at 1e-12 from the end psi has moved by about 1e-12
    assert domain_extension(1.0 + 1e-12) == pytest.approx(((1 + math.sqrt(5)) / 2) ** 2, rel=1e-11)
    assert domain_extension(2.0 - 1e-12) == pytest.approx(math.e - 1, rel=1e-11)
    assert domain_extension(1.0) == pytest.approx(2.618034, abs=5e-7)  # seven printed digits
    assert domain_extension(2.0) == pytest.approx(math.e - 1, rel=8 * EPS)
    assert domain_extension(1.5) == pytest.approx(2.000713, abs=5e-7)  # seven printed digits


def test_psi_falls_smoothly_and_takes_arrays():
    D = np.linspace(1.0, 2.0, 1001)
    psi = domain_extension(D)
    assert psi.shape == D.shape
    assert np.all(np.diff(psi) < 0)
    # the curvature is 4.4 at D = 1 and less above: a root lost for one D would show as a jump
    assert np.max(np.abs(np.diff(psi, 2))) < 5.0 * (D[1] - D[0]) ** 2


@given(D=st.floats(2.01, 2.98))
def test_hu_fit_is_the_root_at_the_profile_dimension(D):
    # 0.33 %: the largest distance of the fit of Ding et al. from the root
    assert domain_extension_fit(D) == pytest.approx(domain_extension(D - 1), rel=3.3e-3)


def test_hu_fit_at_the_ends():
    # beyond, it leaves to 5.454 exp(-1/0.628) + 1.499 = 2.608594 and 1.724741, three digits of per cent
    assert domain_extension_fit(2.0) / domain_extension(1.0) - 1 == pytest.approx(-3.61e-3, abs=5e-6)
    assert domain_extension_fit(3.0) / domain_extension(2.0) - 1 == pytest.approx(3.76e-3, abs=5e-6)


def test_hu_fit_is_wrong_with_a_profile_dimension():
    D = np.linspace(1.05, 1.95, 19)
    excess = domain_extension_fit(D) / domain_extension(D) - 1
    # 52 % at D = 1 to 166 %: the fit belongs to the dimension of the surface
    assert np.all((excess > 0.5) & (excess < 1.66))


@given(e=st.floats(0.0, 1.0 - 1e-7))
def test_complete_elliptic(e):
    first, second = complete_elliptic_integrals(e)
    complement = (1 - e) * (1 + e)
    # scipy's ellipkm1 keeps 1 - e^2; the mean and the sum of squares are right to some ulp
    assert first == pytest.approx(ellipkm1(complement), rel=32 * EPS)
    assert second == pytest.approx(ellipe(1 - complement), rel=32 * EPS)


def test_complete_elliptic_is_a_circle_at_zero():
    assert complete_elliptic_integrals(0.0) == pytest.approx((math.pi / 2, math.pi / 2), rel=2 * EPS)


@given(e=st.floats(0.01, 0.99))
def test_legendre_relation(e):
    K, E = complete_elliptic_integrals(e)
    K1, E1 = complete_elliptic_integrals(math.sqrt(1 - e**2))
    area = E * K1 + E1 * K - K * K1
    # terms up to 10 times pi/2, and 1 - e^2 is formed twice
    assert area == pytest.approx(math.pi / 2, rel=1e-12)


@pytest.mark.parametrize("distance", [1e-8, 1e-10, 1e-12])
def test_complete_elliptic_near_a_line(distance):
    e = 1 - distance
    first, second = complete_elliptic_integrals(e)
    complement = (1 - e) * (1 + e)
    # the documented range: round-off for e <= 1 - 1e-12
    assert first == pytest.approx(ellipkm1(complement), rel=32 * EPS)
    assert second == pytest.approx(ellipe(1 - complement), rel=32 * EPS)


nus, Es = st.floats(0.0, 0.5), st.floats(1e9, 1e12)


@given(E1=Es, E2=Es, nu1=nus, nu2=nus)
def test_moduli(E1, E2, nu1, nu2):
    first, second = ElasticConstants(E=E1, nu=nu1), ElasticConstants(E=E2, nu=nu2)
    star = contact_modulus(first, second)
    assert 1 / star == pytest.approx((1 - nu1**2) / E1 + (1 - nu2**2) / E2, rel=8 * EPS)
    G1, G2 = E1 / (2 * (1 + nu1)), E2 / (2 * (1 + nu2))
    shear = contact_shear_modulus(first, second)
    assert 1 / shear == pytest.approx((2 - nu1) / G1 + (2 - nu2) / G2, rel=8 * EPS)
    assert contact_modulus(second, first) == pytest.approx(star, rel=4 * EPS)


def test_mindlin_ratio_of_equal_bodies():
    # k_t/k_n of a circular contact without slip is 8 G'/(2 E*) = 2 (1 - nu)/(2 - nu) (Mindlin 1949)
    nu = 0.28
    body = ElasticConstants(E=1.5e11, nu=nu)
    ratio = 4 * contact_shear_modulus(body, body) / contact_modulus(body, body)
    assert ratio == pytest.approx(2 * (1 - nu) / (2 - nu), rel=8 * EPS)


def test_a_rigid_second_body_leaves_the_first():
    body = ElasticConstants(E=2e11, nu=0.3)
    rigid = ElasticConstants(E=1e40, nu=0.3)
    assert contact_modulus(body, rigid) == pytest.approx(2e11 / 0.91, rel=8 * EPS)


def test_hardness_coefficient():
    # Hu 2023 below Eq. 7 and Yu 2022, Eq. 26: 0.454 + 0.41 * 0.3
    assert hardness_coefficient(0.3) == pytest.approx(0.577, rel=4 * EPS)
    assert hardness_coefficient(0.0) == 0.454
