"""Partial slip of one spot: published formulas, their limits, and the friction loop."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from jointfmu.contact.laws import mindlin

EPS = np.finfo(float).eps
ratios = st.floats(0.0, 1.0 - 1e-9)


def test_numbers_at_one_half():
    # six printed digits each
    assert mindlin.dissipated_energy_function(0.5) == pytest.approx(0.00586952, abs=5e-9)
    assert mindlin.stored_energy_function(0.5) == pytest.approx(0.0960316, abs=5e-8)
    assert mindlin.loss_ratio(0.5) == pytest.approx(0.0466928, abs=5e-8)
    assert mindlin.loss_factor(0.5) == pytest.approx(0.0466928 / (1 - 0.0466928), abs=1e-7)


@given(x=ratios)
def test_factored_forms_are_the_papers(x):
    v = (1 - x) ** (1 / 3)
    H1 = 1 - v**5 - 5 * x / 6 * (1 + v**2)  # Zhao 2018 below Eq. 29
    H2 = 3 / 5 + 2 / 5 * v**5 - v**2
    # the paper's terms of order 1 cancel: their round-off is absolute
    assert mindlin.dissipated_energy_function(x) == pytest.approx(H1, abs=8 * EPS)
    assert mindlin.stored_energy_function(x) == pytest.approx(H2, abs=8 * EPS)


@given(x=st.floats(1e-300, 1e-3))
def test_small_traction(x):
    # H1 = 5 x^3/162 (1 + x ...), H2 = x^2/3 (1 + 4 x/9 ...), ratio 2 x/(9 pi) (1 + O(x))
    assert mindlin.loss_ratio(x) == pytest.approx(2 * x / (9 * math.pi), rel=2 * x + 16 * EPS)
    assert mindlin.loss_factor(x) == pytest.approx(2 * x / (9 * math.pi), rel=2 * x + 16 * EPS)
    if x > 1e-90:  # x^3 is a float
        assert mindlin.dissipated_energy_function(x) == pytest.approx(5 * x**3 / 162, rel=2 * x + 16 * EPS)
        assert mindlin.stored_energy_function(x) == pytest.approx(x**2 / 3, rel=2 * x + 16 * EPS)


def test_no_traction_no_loss():
    assert mindlin.dissipated_energy_function(0.0) == 0.0
    assert mindlin.stored_energy_function(0.0) == 0.0
    assert mindlin.loss_ratio(0.0) == 0.0
    assert mindlin.loss_factor(0.0) == 0.0
    assert mindlin.stick_radius_ratio(0.0) == (1.0, 0.0)


def test_limit_of_full_slip():
    # v -> 0: H1 = 1/6, H2 = 3/5, ratio 2/(3 pi); v = 1e-5 at x = 1 - 1e-15
    x = 1 - 1e-15
    assert mindlin.dissipated_energy_function(x) == pytest.approx(1 / 6, rel=1e-4)
    assert mindlin.stored_energy_function(x) == pytest.approx(3 / 5, rel=1e-4)
    assert mindlin.loss_ratio(x) == pytest.approx(2 / (3 * math.pi), rel=1e-4)


@given(x=ratios)
def test_stick_root(x):
    v, slip = mindlin.stick_radius_ratio(x)
    # the cube root divides the error of 1 - x by 3, the sum is exact to round-off
    assert v**3 == pytest.approx(1 - x, rel=16 * EPS)
    assert v + slip == pytest.approx(1.0, rel=2 * EPS)
    assert 0 <= slip < 1


@given(x=st.floats(1e-12, 1.0 - 1e-9))
def test_ratio_is_twelve_loops_over_five_pi_storages(x):
    # 5 pi/12 in place of the printed 5 pi/24 of Eq. 29; each factor is right to a few ulp
    expected = 12 * mindlin.dissipated_energy_function(x) / (5 * math.pi * mindlin.stored_energy_function(x))
    assert mindlin.loss_ratio(x) == pytest.approx(expected, rel=32 * EPS)
    eta = 1 / (
        5 * math.pi / 12 * mindlin.stored_energy_function(x) / mindlin.dissipated_energy_function(x) - 1
    )
    assert mindlin.loss_factor(x) == pytest.approx(eta, rel=64 * EPS)


def backbone(t):
    """Displacement of Eq. 21 over its prefactor 3 mu p/(16 G' r), for a force t/(mu p)."""
    return 1 - (1 - t) ** (2 / 3)


@given(x=st.floats(0.05, 0.999))
def test_masing_loop(x):
    """Unloading and reloading follow the doubled backbone (Masing); the loop is the area between them."""

    def width(t):
        unloading = backbone(x) - 2 * backbone((x - t) / 2)
        reloading = -backbone(x) + 2 * backbone((x + t) / 2)
        return unloading - reloading

    dissipated = quad(width, -x, x, epsabs=0, epsrel=1e-11)[0]
    # work along the backbone, force over displacement: x d(x) minus the integral of d over the force
    stored = x * backbone(x) - quad(backbone, 0, x, epsabs=0, epsrel=1e-12)[0]
    # the two nearly equal branches cancel to (x/9)^2 of their size at x = 0.05: 1e-16 * 3e4 * safety 30
    assert mindlin.loss_ratio(x) == pytest.approx(dissipated / (2 * math.pi * stored), rel=1e-10)
    assert mindlin.stored_energy_function(x) == pytest.approx(stored, rel=1e-10)
    # Eq. 23 over (mu p)(3 mu p/(16 G' r)): (9/10)(16/3) H1 = 4.8 H1
    assert 4.8 * mindlin.dissipated_energy_function(x) == pytest.approx(dissipated, rel=1e-10)


def test_loss_grows_with_the_traction():
    x = np.linspace(0, 1 - 1e-9, 2001)
    for function in (
        mindlin.dissipated_energy_function,
        mindlin.stored_energy_function,
        mindlin.loss_ratio,
        mindlin.loss_factor,
    ):
        assert np.all(np.diff(function(x)) > 0)
