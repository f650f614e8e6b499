"""Law of Zhao 2018 against quadrature of the paper's equations, and corrected closed forms."""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from laws import QUAD, ZHAO, changed, open_end, over_spots, zhao_laws
from scipy.optimize import brentq

from jointfmu.contact.laws import zhao2018
from jointfmu.contact.laws.zhao2018 import Zhao2018

EPS = np.finfo(float).eps
# ln(a'_L/a'_c); closer to the edge the quadrature's own difference of logarithms is lost
log_areas = st.floats(-6.0, 20.0).filter(lambda u: not 0.0 < u < 0.01)


@dataclass
class Paper:
    """Equations of the paper for one law, in the symbols of the paper; `ac` follows the choice of the law."""

    law: Zhao2018

    def __post_init__(self):
        law = self.law
        one, two, surface = law.side1, law.side2, law.surface
        self.D, self.G, self.gamma, self.H = surface.D, surface.G, surface.gamma, law.H
        self.E = 1 / ((1 - one.nu**2) / one.E + (1 - two.nu**2) / two.E)
        G1, G2 = one.E / (2 * (1 + one.nu)), two.E / (2 * (1 + two.nu))
        self.Gs = 1 / ((2 - one.nu) / G1 + (2 - two.nu) / G2)
        q = (2 - self.D) / self.D

        def equation_3(psi):
            return psi ** ((2 - self.D) / 2) - (1 + psi ** (-self.D / 2)) ** -q - q

        self.psi = brentq(equation_3, 1.5, 3.0, xtol=1e-15, rtol=4 * EPS)
        self.ac = float(zhao2018.critical_area(law))
        x = law.traction_ratio
        self.H1 = 1 - (1 - x) ** (5 / 3) - 5 * x / 6 * (1 + (1 - x) ** (2 / 3))
        self.H2 = 3 / 5 + 2 / 5 * (1 - x) ** (5 / 3) - (1 - x) ** (2 / 3)

    def count(self, largest):
        """a' n(a') of Eq. 2."""
        D, psi = self.D, self.psi
        return lambda a: 0.5 * D * psi ** ((2 - D) / 2) * (largest / a) ** (D / 2)

    def delta(self, a):  # Eq. 5
        D = self.D
        return (
            2 ** (3 - D) * self.G ** (D - 1) * sqrt(log(self.gamma)) * pi ** ((D - 2) / 2) * a ** (1 - D / 2)
        )

    def R(self, a):  # Eq. 6
        D = self.D
        return a ** (D / 2) / (2 ** (4 - D) * pi ** (D / 2) * self.G ** (D - 1) * sqrt(log(self.gamma)))

    def f_e(self, a):  # Eq. 7, the printed second form
        D = self.D
        c = 2 ** (4.5 - D) * self.E / 3 * pi ** ((D - 3) / 2) * sqrt(log(self.gamma)) * self.G ** (D - 1)
        return c * a ** ((3 - D) / 2)

    def k_n(self, a):  # Eq. 13, or df/d(delta) of Hertz at a fixed radius
        if self.law.spot_stiffness == "hertz":
            return 2 * self.E * sqrt(self.R(a) * self.delta(a))
        return 4 * self.E * (3 - self.D) / (3 * sqrt(2 * pi) * (2 - self.D)) * sqrt(a)

    def elastic(self, spot, largest):
        """Sum over the elastic spots, a'_c < a' <= a'_L."""
        return over_spots(spot, self.count(largest), [self.ac], largest)

    def plastic(self, spot, largest, exponent):
        """Sum over the plastic spots, 0 < a' <= a'_c; the integrand decreases with this exponent of ln a'."""
        end = min(self.ac, largest)
        return over_spots(spot, self.count(largest), [open_end(end, exponent)], end)


@given(law=zhao_laws, u=log_areas)
def test_totals_are_sums_over_spots(law, u):
    paper, s = Paper(law), law.spot_distribution()
    largest = paper.ac * np.exp(u)
    stick = (1 - law.traction_ratio) ** (1 / 3)
    D, x = paper.D, 1 - paper.D / 2
    elastic = {
        "load": paper.f_e,
        "normal": paper.k_n,
        "tangential": lambda a: 8 * paper.Gs * sqrt(a / 2 / pi) * stick,  # Eq. 21, r of the area a'/2
        "area": lambda a: a / 2,
        "elastic_work": lambda a: 8 / 15 * paper.E * sqrt(paper.R(a)) * paper.delta(a) ** 2.5,  # Eq. 17
        "loop_area": lambda a: a**1.5,
    }
    plastic = {
        "load": (lambda a: paper.H * a, x),  # Eq. 8
        "area": (lambda a: a, x),
        "plastic_work": (lambda a: paper.H * a * paper.delta(a), 2 - D),  # Eq. 15
    }
    assert set(s.regime_terms) == set(elastic) | set(plastic)
    for name in s.regime_terms:
        expected = paper.elastic(elastic[name], largest) if name in elastic else 0.0
        if name in plastic:
            expected += paper.plastic(plastic[name][0], largest, plastic[name][1])
        assert s.sum_over_spots(name, u) == pytest.approx(expected, rel=QUAD), name


@given(law=zhao_laws, u=st.floats(0.1, 20.0))
def test_state_is_made_of_the_sums(law, u):
    paper, s = Paper(law), law.spot_distribution()
    state = law.contact_quantities(u)
    largest = paper.ac * np.exp(u)
    for symbol, name in {
        "F": "load",
        "K_N": "normal",
        "K_T": "tangential",
        "A_r": "area",
        "W_NP": "plastic_work",
        "W_NE": "elastic_work",
    }.items():
        assert state[symbol] == s.sum_over_spots(name, u)
    pressure = law.mu * state["F"] / state["A_r"]  # mu P / A_r
    w_d = paper.elastic(  # Eq. 23 with a = a'/2
        lambda a: 9 * sqrt(pi) * (a / 2) ** 1.5 * pressure**2 / (10 * paper.Gs) * paper.H1, largest
    )
    w = paper.elastic(  # Eq. 25
        lambda a: 2 * pi * 3 * (a / 2) ** 2 * pressure**2 / (16 * paper.Gs * sqrt(a / 2 / pi)) * paper.H2,
        largest,
    )
    # the paper's H1 and H2 lose 5 eps/x^3 and eps/x^2 to cancellation; scale: full slip
    cancelled = 10 * EPS * pressure**2 / paper.Gs * s.sum_over_spots("loop_area", u)
    assert state["W_d"] == pytest.approx(w_d, rel=QUAD, abs=cancelled)
    assert state["W"] == pytest.approx(w, rel=QUAD, abs=cancelled)
    assert state["W_e"] == state["W"] - state["W_d"]  # Eq. 27
    if law.traction_ratio > 0.01:  # cancellation 5 eps/x^3 = 1e-9
        eta = 1 / (5 * pi / 12 * paper.H2 / paper.H1 - 1)
        assert state["eta_t"] == pytest.approx(eta, rel=1e-8)
        assert state["eta_t"] == pytest.approx(state["W_d"] / state["W_e"], rel=1e-12)  # Eq. 28
    assert state["eta_n"] == pytest.approx(state["W_NP"] / state["W_NE"], rel=4 * EPS)
    assert state["C_N"] == pytest.approx(state["eta_n"] * sqrt(law.mass * state["K_N"]), rel=4 * EPS)
    assert state["C_T"] == pytest.approx(state["eta_t"] * sqrt(law.mass * state["K_T"]), rel=4 * EPS)


def test_no_elastic_spot():
    u = np.array([-3.0, 0.0])
    state = ZHAO.contact_quantities(u)
    assert np.all(state["K_N"] == 0)
    assert np.all(state["K_T"] == 0)
    assert np.all(state["C_N"] == 0)
    assert np.all(state["C_T"] == 0)
    assert np.all(state["eta_n"] == np.inf)
    # every spot carries its hardness on its truncated area
    assert state["F"] == pytest.approx(ZHAO.H * state["A_r"], rel=8 * EPS)


@pytest.mark.parametrize(
    ("choice", "area", "printed"),
    [("printed", 4.04e-7, 0.005e-7), ("continuity", 1.626e-9, 0.0005e-9), ("yield", 4.47e-6, 0.005e-6)],
)
def test_critical_area_of_table_1(choice, area, printed):
    law = changed(ZHAO, {"critical_area": choice})
    assert zhao2018.critical_area(law) == pytest.approx(area, abs=printed)  # half of the last digit


def test_force_at_the_critical_area():
    def jump(choice):
        law = changed(ZHAO, {"critical_area": choice})
        a = zhao2018.critical_area(law)
        return law.H * a / zhao2018.elastic_load(law, a)

    assert jump("continuity") == pytest.approx(1.0, rel=32 * EPS)
    assert jump("printed") == pytest.approx(3.2, abs=0.05)  # two digits


@given(law=zhao_laws)
def test_critical_areas(law):
    paper = Paper(law)
    D = paper.D
    # an error of the bracket is amplified by its exponent 1/(D - 1), up to 10
    tolerance = {"rel": 100 * EPS / (D - 1)}
    a = zhao2018.critical_area(law)
    if law.critical_area == "continuity":
        expected = (2 ** (9 - 2 * D) * (paper.E / paper.H) ** 2 * log(paper.gamma) / (9 * pi ** (3 - D))) ** (
            1 / (D - 1)
        ) * paper.G**2
        assert paper.f_e(a) == pytest.approx(paper.H * a, rel=1e-12)
    elif law.critical_area == "printed":
        expected = 2 * (2 * paper.E / paper.H) ** (2 / (D - 1)) * paper.G**2
    else:
        # first yield: the maximum Hertz pressure (2 E*/pi) sqrt(delta/R) is k H
        k = 0.454 + 0.41 * law.side1.nu
        maximum = 2 * paper.E / pi * sqrt(paper.delta(a) / paper.R(a))
        assert maximum == pytest.approx(k * paper.H, rel=1e-12)
        return
    assert a == pytest.approx(expected, **tolerance)


@given(law=zhao_laws, u=log_areas)
def test_one_spot(law, u):
    paper = Paper(law)
    a = paper.ac * np.exp(u)
    close = {"rel": 100 * EPS}  # some ten operations and powers
    assert zhao2018.spot_deformation(law, a) == pytest.approx(paper.delta(a), **close)
    assert zhao2018.curvature_radius(law, a) == pytest.approx(paper.R(a), **close)
    assert zhao2018.elastic_load(law, a) == pytest.approx(paper.f_e(a), **close)
    assert zhao2018.normal_stiffness(law, a) == pytest.approx(paper.k_n(a), **close)
    # the truncated area is twice the Hertzian contact area pi R delta
    assert 2 * pi * paper.R(a) * paper.delta(a) == pytest.approx(a, **close)


def test_family_stiffness_is_the_derivative_along_the_family():
    a, h = 1e-7, 1e-12
    force = zhao2018.elastic_load(ZHAO, a + h) - zhao2018.elastic_load(ZHAO, a - h)
    path = zhao2018.spot_deformation(ZHAO, a + h) - zhao2018.spot_deformation(ZHAO, a - h)
    # h/a = 1e-5: truncation 1e-10, round-off eps/1e-5 = 2e-11
    assert zhao2018.normal_stiffness(ZHAO, a) == pytest.approx(force / path, rel=1e-9)
    hertz = changed(ZHAO, {"spot_stiffness": "hertz"})
    ratio = zhao2018.normal_stiffness(ZHAO, a) / zhao2018.normal_stiffness(hertz, a)
    assert ratio == pytest.approx(1.816, abs=5e-4)  # four digits, D = 1.42


def closed_forms(paper, aL):
    """Closed forms of Eqs. 9-11, 14, 16, 18, 19, 22, 24, 26, with the printed errors corrected."""
    D, G, E, H, ac, psi = paper.D, paper.G, paper.E, paper.H, paper.ac, paper.psi
    L, Gs, law = log(paper.gamma), paper.Gs, paper.law
    if D == 1.5:
        F_E = 2 * E * psi**0.25 * pi**-0.75 * sqrt(L) * sqrt(G) * aL**0.75 * log(aL / ac)
    else:
        F_E = (
            2 ** ((9 - 2 * D) / 2) * D / (3 * (3 - 2 * D) * pi ** ((3 - D) / 2)) * E * sqrt(L) * G ** (D - 1)
        )
        F_E *= psi ** (1 - D / 2) * aL ** (D / 2) * (aL ** ((3 - 2 * D) / 2) - ac ** ((3 - 2 * D) / 2))
    F_P = H * D * psi ** ((2 - D) / 2) / (2 - D) * aL ** (D / 2) * ac ** ((2 - D) / 2)
    A_r = D / (4 - 2 * D) * psi ** (1 - D / 2) * aL ** (D / 2) * (aL ** (1 - D / 2) + ac ** (1 - D / 2))
    bracket = aL ** ((1 - D) / 2) - ac ** ((1 - D) / 2)
    K_N = (
        4
        * E
        * (3 - D)
        * D
        / (3 * sqrt(2 * pi) * (1 - D) * (2 - D))
        * psi ** (1 - D / 2)
        * aL ** (D / 2)
        * bracket
    )
    stick = (1 - law.traction_ratio) ** (1 / 3)
    K_T = 8 * Gs * D * psi ** ((2 - D) / 2) / (sqrt(2 * pi) * (1 - D)) * stick * aL ** (D / 2) * bracket
    W_NP = 2 ** (2 - D) * H * D * G ** (D - 1) / (2 - D) * psi ** ((2 - D) / 2) * sqrt(L)
    W_NP *= pi ** ((D - 2) / 2) * aL ** (D / 2) * ac ** (2 - D)
    if D == 5 / 3:
        power = log(aL / ac) / 2  # the limit of (aL^q - ac^q)/(5 - 3 D), q = (5 - 3 D)/2
    else:
        power = (aL ** ((5 - 3 * D) / 2) - ac ** ((5 - 3 * D) / 2)) / (5 - 3 * D)
    W_NE = 2 ** (17 / 2 - 2 * D) * E * D * G ** (2 * (D - 1)) * psi ** (1 - D / 2) * L
    W_NE *= aL ** (D / 2) * power / (15 * pi ** ((5 - 2 * D) / 2))
    eta_n = 15 * H * pi ** ((3 - D) / 2) * ac ** (2 - D)
    eta_n /= 2 ** (13 / 2 - D) * E * G ** (D - 1) * (2 - D) * sqrt(L) * power
    shear = (law.mu * (F_E + F_P)) ** 2 * (4 - 2 * D) ** 2 * (aL ** ((3 - D) / 2) - ac ** ((3 - D) / 2))
    shear /= (
        Gs * psi ** ((2 - D) / 2) * D * (3 - D) * aL ** (D / 2) * (aL ** (1 - D / 2) + ac ** (1 - D / 2)) ** 2
    )
    return {
        "F": F_E + F_P,
        "A_r": A_r,
        "K_N": K_N,
        "K_T": K_T,
        "W_NP": W_NP,
        "W_NE": W_NE,
        "eta_n": eta_n,
        "W_d": 9 * sqrt(2 * pi) / 40 * shear * paper.H1,
        "W": 3 * pi * sqrt(2 * pi) / 32 * shear * paper.H2,
        "eta_t": 1 / (5 * pi / 12 * paper.H2 / paper.H1 - 1),
    }


@pytest.mark.parametrize("u", [0.5, 4.0, 12.0])
@pytest.mark.parametrize("D", [1.15, 1.42, 1.5, 1.6, 5 / 3, 1.9])
def test_closed_forms(D, u):
    # the continuous critical area as everywhere; D = 1.5 and 5/3 take the logarithms
    law = changed(ZHAO, {"surface.D": D})
    paper = Paper(law)
    state = law.contact_quantities(u)
    for symbol, expected in closed_forms(paper, paper.ac * np.exp(u)).items():
        # differences of powers as close as exp(0.02); psi, H1 and H2 to 1e-14 each
        assert state[symbol] == pytest.approx(expected, rel=1e-11), symbol


@pytest.mark.parametrize("D", [1.5, 5 / 3])
@pytest.mark.parametrize("k", [*range(3, 17), 99])
@pytest.mark.parametrize("sign", [1, -1])
def test_continuity_through_the_singular_dimension(D, k, sign):
    law = changed(ZHAO, {"surface.D": D + sign * 10.0**-k})
    paper, s, u = Paper(law), law.spot_distribution(), 6.0
    largest = paper.ac * np.exp(u)
    work = paper.elastic(lambda a: 8 / 15 * paper.E * sqrt(paper.R(a)) * paper.delta(a) ** 2.5, largest)
    assert s.sum_over_spots("elastic_work", u) == pytest.approx(work, rel=QUAD)
    load = paper.elastic(paper.f_e, largest)
    load += paper.plastic(lambda a: paper.H * a, largest, 1 - paper.D / 2)
    assert s.sum_over_spots("load", u) == pytest.approx(load, rel=QUAD)
