"""Law of Hu 2023 against quadrature of the paper's equations, closed forms and printed numbers."""

from dataclasses import dataclass
from math import exp, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from laws import HU, QUAD, changed, hu_laws, over_spots
from scipy.integrate import quad

from jointfmu.contact.laws import hu2023, kogut_etsion
from jointfmu.contact.laws.hu2023 import Hu2023

EPS = np.finfo(float).eps
# ln(s_l/s_min); below, the quadrature's own difference of logarithms is lost
log_areas = st.floats(0.05, 40.0)


@dataclass
class Paper:
    """Equations of the paper for the parameters of one law, in the symbols of the paper."""

    law: Hu2023

    def __post_init__(self):
        law, surface = self.law, self.law.surface
        one, two = law.side1, law.side2
        self.D, self.s_min = surface.D, surface.s_min
        self.E = 1 / ((1 - one.nu**2) / one.E + (1 - two.nu**2) / two.E)
        G1, G2 = one.E / (2 * (1 + one.nu)), two.E / (2 * (1 + two.nu))
        self.Gs = 1 / ((2 - one.nu) / G1 + (2 - two.nu) / G2)
        self.k, self.H = 0.454 + 0.41 * one.nu, 2.8 * law.sigma_y
        self.height = surface.G ** (self.D - 2) * sqrt(
            log(surface.gamma)
        )  # of Eq. 4, without (2 r_m)^(3 - D)
        self.R = surface.r_m ** (self.D - 1) / (2 ** (3 - self.D) * pi**2 * self.height)  # Eq. 5
        self.eps_ec = (pi * self.k * self.H / (2 * self.E)) ** 2 * self.R  # Eq. 7
        self.s_ec = pi * self.R * self.eps_ec  # Eq. 10
        self.f_ec = 4 / 3 * self.E * sqrt(self.R) * self.eps_ec**1.5  # Eq. 9
        # Eqs. 11 and 12 at 6 and at 110
        self.s_epc1, self.s_epc2 = 0.93 * 6**1.136 * self.s_ec, 0.94 * 110**1.146 * self.s_ec
        self.psi = 5.454 * exp((1 - self.D) / 0.628) + 1.499

    def count(self, s_l):
        """s n(s) of Eq. 17."""
        D = self.D
        return lambda s: (D - 1) / 2 * self.psi ** (1.5 - 0.5 * D) * (s_l / s) ** (0.5 * D - 0.5)

    def f(self, s):
        """Eqs. 9, 11, 12 and 16; the deformation comes from the area of the same branch."""
        if s <= self.s_ec:
            surface = self.law.surface
            c = 2 ** (5 - self.D) * self.E * sqrt(pi) * self.height / (3 * surface.r_m ** (self.D - 1))
            return c * s**1.5
        if s <= self.s_epc1:
            return self.f_ec * 1.03 * (s / (0.93 * self.s_ec)) ** (1.425 / 1.136)
        if s <= self.s_epc2:
            return self.f_ec * 1.40 * (s / (0.94 * self.s_ec)) ** (1.263 / 1.146)
        return self.H * s

    def k_n(self, s):
        """Stiffness df/d(epsilon) of a spot: Eq. 29 and the derivatives of Eqs. 11 and 12."""
        if s <= self.s_ec:
            return 2 * self.E * sqrt(s / pi)
        if s <= self.s_epc1:
            ratio = (s / (0.93 * self.s_ec)) ** (1 / 1.136)
            return self.f_ec / self.eps_ec * 1.03 * 1.425 * ratio**0.425
        ratio = (s / (0.94 * self.s_ec)) ** (1 / 1.146)
        return self.f_ec / self.eps_ec * 1.40 * 1.263 * ratio**0.263

    def full_stick(self, s):
        return 8 * self.Gs * sqrt(s / pi)  # Eq. 39 at t = 0

    def total(self, spot, s_l, end=None, power=None):
        """Sum over all spots from s_min to s_l, or to the end of a regime."""
        start = self.s_min if power is None else min(self.s_min, self.s_ec)
        # below the start the law is one power: the integral of c s^(power - m - 1) from 0
        below = 0.0
        if power is not None:
            below = self.count(s_l)(start) * spot(start) / (power - (self.D - 1) / 2)
        last = s_l if end is None else min(end, s_l)
        if last <= start:
            return below
        regimes = [max(s, start) for s in (self.s_ec, self.s_epc1, self.s_epc2)]
        return below + over_spots(spot, self.count(s_l), [start, *(s for s in regimes if s < last)], last)


def apart(law, u):
    """Whether the largest spot is 1 % away from the regime ends, where the quadrature loses digits."""
    edge = log(Paper(law).s_ec / law.surface.s_min)
    return all(abs(u - edge - log(x)) > 0.01 for x in (1.0, 0.93 * 6**1.136, 0.94 * 110**1.146))


cases = st.tuples(hu_laws, log_areas).filter(lambda case: apart(*case))


@given(case=cases)
def test_totals_are_sums_over_spots(case):
    law, u = case
    paper, s = Paper(law), law.spot_distribution()
    s_l = paper.s_min * exp(u)
    stick = (1 - law.traction_ratio) ** (1 / 3)
    expected = {
        "load": paper.total(paper.f, s_l, power=1.5),
        "normal": paper.total(paper.k_n, s_l, paper.s_epc2),
        "tangential": paper.total(lambda a: stick * paper.full_stick(a), s_l, paper.s_epc2),
        "area": paper.total(lambda a: a, s_l, power=1.0),
        "elastic_area": paper.total(lambda a: a, s_l, paper.s_ec, power=1.0),
    }
    assert set(s.regime_terms) == set(expected)
    for name, value in expected.items():
        assert s.sum_over_spots(name, u) == pytest.approx(value, rel=QUAD), name
    state = law.contact_quantities(u)
    for symbol, name in {"F": "load", "K_N": "normal", "K_T": "tangential", "A_r": "area"}.items():
        assert state[symbol] == s.sum_over_spots(name, u)


def sheared(law, traction):
    """Spot quantities of a law whose real area carries a shear traction [Pa]."""
    return changed(law, {"traction": "real_area", "shear_traction": traction}).spot_distribution()


@given(case=cases, tau=st.floats(1e-3, 1.5))
def test_shear_traction(case, tau):
    """K_T agrees with Eqs. 39-43, with the shear force t = tau s of each spot clipped to full slip."""
    law, u = case
    paper = Paper(law)
    strength = tau * paper.law.mu * paper.H  # as a fraction of the friction of a fully plastic spot
    s_l = paper.s_min * exp(u)

    def stick(a):
        return max(1 - strength * a / (law.mu * paper.f(a)), 0.0)

    def integrand(a):
        return paper.full_stick(a) * stick(a) ** (1 / 3) * paper.count(s_l)(a)

    expected = 0.0
    ends = [max(s, paper.s_min) for s in (paper.s_min, paper.s_ec, paper.s_epc1, paper.s_epc2)]
    # x falls with the area inside a regime as a^-q: the spots above the onset stick
    for low, high, q in zip(ends, ends[1:], (0.5, 1.425 / 1.136 - 1, 1.263 / 1.146 - 1), strict=False):
        high = min(high, s_l)
        if high <= low:
            continue
        inside = sqrt(low * high)
        onset = inside * (strength * inside / (law.mu * paper.f(inside))) ** (1 / q)
        start = max(low, onset)
        if start >= high:
            continue

        def cubed(y, start=start):  # t = start + y^3 removes the cube root's end point
            return 3 * y**2 * integrand(start * exp(y**3))

        expected += quad(cubed, 0, log(high / start) ** (1 / 3), epsabs=0, epsrel=1e-10, limit=200)[0]
    total = sheared(law, strength).sum_over_spots("tangential", u)
    full = law.spot_distribution().sum_over_spots("tangential", u) / (1 - law.traction_ratio) ** (1 / 3)
    # 1 - x cancels at the onset, and a regime may end within round-off of it: 1e-7 of full stick
    assert total == pytest.approx(expected, rel=1e-8, abs=1e-7 * full)
    assert 0 <= total <= full


def test_full_slip():
    """With the printed tau_b = sigma_s/sqrt(3) and mu = 0.15 every spot slips, so K_T is zero."""
    slipping = sheared(HU, HU.sigma_y / sqrt(3))
    assert slipping.sum_over_spots("tangential", 5.0) == 0.0
    assert slipping.sum_over_spots("tangential", 40.0) == 0.0
    # without traction every spot sticks: (1 - x)^(1/3) with x <= 3.59e-9 at s_ec, larger below
    sticking = sheared(HU, 1e-12 * HU.sigma_y)
    at_rest = changed(HU, {"traction_ratio": 0.0}).spot_distribution()
    assert sticking.sum_over_spots("tangential", 30.0) == pytest.approx(
        at_rest.sum_over_spots("tangential", 30.0), rel=1e-7
    )
    # the other quantities do not see the traction
    for name in ("load", "normal", "area"):
        assert sticking.sum_over_spots(name, 30.0) == HU.spot_distribution().sum_over_spots(name, 30.0)


def test_traction_over_friction():
    # errata: t/(mu f) = 3.59, 1.93, 1.39 at s_ec, s_epc1, s_epc2, three digits
    s, edge = HU.spot_distribution(), log(hu2023.critical_area(HU) / HU.surface.s_min)
    tau = HU.sigma_y / sqrt(3)
    for area, ratio in ((1.0, 3.59), (7.1197, 1.93), (205.3827, 1.39)):
        t = edge + log(area) - 1e-6  # just inside the regime below
        load = sum(float(term.evaluate_spot(t)) for term in s.regime_terms["load"])
        assert tau * HU.surface.s_min * exp(t) / (HU.mu * load) == pytest.approx(ratio, abs=5e-3)


def test_lower_bound_of_the_mean_pressure():
    # 286 MPa at s_l = s_ec with s_min -> 0 (three digits), and never below for a larger spot
    law = changed(HU, {"surface.s_min": 1e-60})  # s_min^(1.5 - D/2) = 1e-14 of the sum
    s, edge = law.spot_distribution(), log(hu2023.critical_area(law) / 1e-60)
    u = edge + np.linspace(0.0, 12.0, 200)
    mean = s.sum_over_spots("load", u) / s.sum_over_spots("area", u)
    assert mean[0] == pytest.approx(286e6, abs=0.5e6)
    assert np.all(np.diff(mean) > 0)
    # D does not enter the ends: (2/3) k H (3 - D)/(4 - D) and H
    k, H = 0.454 + 0.41 * 0.295, 2.8 * 835e6
    D = 2.5304
    # s_min leaves (s_min/s_ec)^0.2348 = 1e-12
    assert mean[0] == pytest.approx(2 / 3 * k * H * (3 - D) / (4 - D), rel=1e-10)
    assert s.sum_over_spots("load", edge + 90.0) / s.sum_over_spots("area", edge + 90.0) == pytest.approx(
        H, rel=1e-6
    )


def test_kogut_etsion_products():
    # errata: six and seven digits
    first = kogut_etsion.eliminate_deformation(kogut_etsion.FIRST_ELASTIC_PLASTIC_STAGE)
    second = kogut_etsion.eliminate_deformation(kogut_etsion.SECOND_ELASTIC_PLASTIC_STAGE)
    coefficients = (first.load_factor, second.load_factor, first.stiffness_factor, second.stiffness_factor)
    assert coefficients == pytest.approx((1.12816, 1.49880, 1.50815, 1.79349), abs=5e-6)
    ends = (kogut_etsion.SECOND_STAGE_OVER_YIELD_AREA, kogut_etsion.FULL_PLASTIC_OVER_YIELD_AREA)
    assert ends == pytest.approx((7.1197, 205.3827), abs=5e-5)
    # the exponents of Eqs. 13, 14, 31, 32
    assert (first.load_exponent, second.load_exponent) == pytest.approx((1.2544, 1.1021), abs=5e-5)
    assert (first.stiffness_exponent, second.stiffness_exponent) == pytest.approx((0.3741, 0.2295), abs=5e-5)


def test_mean_pressure_at_the_onset_of_full_plasticity():
    law = changed(HU, {"side1.nu": 0.3})
    edge = log(hu2023.critical_area(law) / law.surface.s_min)
    t = edge + log(kogut_etsion.FULL_PLASTIC_OVER_YIELD_AREA) - 1e-9
    load = sum(float(term.evaluate_spot(t)) for term in law.spot_distribution().regime_terms["load"])
    mean = load / (law.surface.s_min * exp(t))
    assert mean / law.hardness == pytest.approx(0.993, abs=5e-4)  # three digits


def test_exponents():
    # s_ec ~ r_m^(2 (D - 1)) = r_m^3.06 (three digits)
    double = changed(HU, {"surface.r_m": 2 * HU.surface.r_m})
    power = log(hu2023.critical_area(double) / hu2023.critical_area(HU), 2)
    assert power == pytest.approx(3.06, abs=5e-3)
    assert power == pytest.approx(2 * (HU.surface.D - 1), rel=1e-12)
    # K_re ~ s_min^(1 - D/2) = s_min^-0.265 at one largest spot; the spots below are (1e-40)^0.265 = 2e-11
    small, smaller = (changed(HU, {"surface.s_min": s}) for s in (1e-50, 1e-51))
    s_ec = hu2023.critical_area(HU)
    K_re = [
        law.spot_distribution().sum_over_spots("normal", log(s_ec / law.surface.s_min))
        for law in (small, smaller)
    ]
    assert -np.log10(K_re[1] / K_re[0]) == pytest.approx(-0.265, abs=5e-4)
    assert -np.log10(K_re[1] / K_re[0]) == pytest.approx(1 - HU.surface.D / 2, rel=1e-9)


def test_regimes_above_a_large_smallest_spot():
    """With a smallest spot above s_ec no spot has the elastic stiffness; above s_epc2 no spot has any
    stiffness."""
    s_ec = hu2023.critical_area(HU)
    for multiple in (2.0, 50.0, 300.0):
        law = changed(HU, {"surface.s_min": multiple * s_ec})
        paper, s = Paper(law), law.spot_distribution()
        s_l = law.surface.s_min * exp(3.0)
        elastic = paper.total(lambda a: a, s_l, paper.s_ec, power=1.0)
        assert s.sum_over_spots("elastic_area", 3.0) == pytest.approx(elastic, rel=QUAD)
        assert s.sum_over_spots("load", 3.0) == pytest.approx(paper.total(paper.f, s_l, power=1.5), rel=QUAD)
        assert s.sum_over_spots("normal", 3.0) == pytest.approx(
            paper.total(paper.k_n, s_l, paper.s_epc2), rel=QUAD
        )


def closed_forms(paper, s_l):
    """Closed forms of Eqs. 18-27, 30, 33-35 if all regimes are present (s_l > s_epc2), elastic stiffness from
    s_min."""
    D, E, k, H, psi = paper.D, paper.E, paper.k, paper.H, paper.psi
    s_min, s_ec, s1, s2 = paper.s_min, paper.s_ec, paper.s_epc1, paper.s_epc2
    common = psi ** (1.5 - 0.5 * D) * s_l ** (0.5 * D - 0.5)

    def span(x, low, high):
        return high ** (x - 0.5 * D) - low ** (x - 0.5 * D)

    r_m = paper.law.surface.r_m
    areas = [
        (D - 1) / (3 - D) * common * span(1.5, *ends)
        for ends in ((0.0, s_ec), (s_ec, s1), (s1, s2), (s2, s_l))
    ]
    loads = [
        2 ** (5 - D)
        * E
        * sqrt(pi)
        * paper.height
        / (3 * r_m ** (D - 1))
        * (D - 1)
        / (4 - D)
        * common
        * span(2.0, 0.0, s_ec),
        1.1282 * (D - 1) / (5.2632 - 1.5 * D) * k * H * common * s_ec**-0.2544 * span(1.7544, s_ec, s1),
        0.4996 * (D - 1) / (1.6021 - 0.5 * D) * k * H * common * s_ec**-0.1021 * span(1.6021, s1, s2),
        (D - 1) / (3 - D) * H * common * span(1.5, s2, s_l),
    ]
    stiffnesses = [
        (D - 1) / (1 - 0.5 * D) * E / sqrt(pi) * common * span(1.0, s_min, s_ec),
        1.5082
        * (D - 1)
        / (2.6223 - 1.5 * D)
        * k
        * H
        / paper.eps_ec
        * common
        * s_ec**0.6259
        * span(0.8741, s_ec, s1),
        1.7935
        * (D - 1)
        / (2.1885 - 1.5 * D)
        * k
        * H
        / paper.eps_ec
        * common
        * s_ec**0.7705
        * span(0.7295, s1, s2),
    ]
    return {"area": areas, "load": loads, "normal": stiffnesses}


@pytest.mark.parametrize("D", [2.1, 2.5304, 2.9])
def test_closed_forms(D):
    law = changed(HU, {"surface.D": D, "surface.s_min": 1e-20})
    paper, s = Paper(law), law.spot_distribution()
    s_l = 1e4 * paper.s_ec
    m, u = 0.5 * D - 0.5, log(s_l / law.surface.s_min)
    common = m * s.size_prefactor * exp(m * u)
    for name, regimes in closed_forms(paper, s_l).items():
        if name == "area":
            assert s.sum_over_spots(name, u) == pytest.approx(
                sum(regimes), rel=1e-11
            )  # nothing is rounded here
            assert s.sum_over_spots("elastic_area", u) == pytest.approx(regimes[0], rel=1e-11)
            continue
        for term, expected in zip(s.regime_terms[name], regimes, strict=True):
            # five printed digits of each coefficient and 5e-5 ln(205) of each exponent
            assert common * term.integrate_over_spots(m, u) == pytest.approx(expected, rel=5e-4)
        # the elastic and the plastic regime have no rounded coefficient
        assert common * s.regime_terms[name][0].integrate_over_spots(m, u) == pytest.approx(
            regimes[0], rel=1e-11
        )
    plastic = closed_forms(paper, s_l)["load"][3]
    assert common * s.regime_terms["load"][3].integrate_over_spots(m, u) == pytest.approx(plastic, rel=1e-11)


@pytest.mark.parametrize("k", range(2, 15))
def test_near_the_ends_of_the_dimension(k):
    """Sums agree with quadrature near D = 2 and D = 3, where the exponents 1 - D/2 and 3/2 - D/2 vanish."""
    for D in (2 + 10.0**-k, 3 - 10.0**-k):
        law = changed(HU, {"surface.D": D})
        paper, s = Paper(law), law.spot_distribution()
        s_l = 50.0 * paper.s_ec
        u = log(s_l / law.surface.s_min)
        assert s.sum_over_spots("area", u) == pytest.approx(
            paper.total(lambda a: a, s_l, power=1.0), rel=QUAD
        )
        assert s.sum_over_spots("normal", u) == pytest.approx(
            paper.total(paper.k_n, s_l, paper.s_epc2), rel=QUAD
        )
        assert s.sum_over_spots("load", u) == pytest.approx(paper.total(paper.f, s_l, power=1.5), rel=QUAD)
