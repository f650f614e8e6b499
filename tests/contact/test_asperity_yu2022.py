"""Law of Yu 2022 against quadrature of the paper's corrected equations, and closed forms."""

from dataclasses import dataclass
from math import exp, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from laws import QUAD, YU, changed, open_end, over_spots, yu_laws
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from jointfmu.contact.laws import yu2022
from jointfmu.contact.laws.yu2022 import Yu2022

EPS = np.finfo(float).eps
log_areas = st.floats(-40.0, 20.0)  # ln(a_l/a_nec); the plastic spots lie far below a_nec
KOGUT_ETSION = ((0.93, 1.136, 1.03, 1.425), (0.94, 1.146, 1.40, 1.263))  # m, n, c, d of Eqs. 33-36


@dataclass
class Paper:
    """Equations of the paper for the parameters of one law, in the symbols of the paper."""

    law: Yu2022

    def __post_init__(self):
        law = self.law
        self.D1, self.G1 = law.surface1.D, law.surface1.G
        self.D2, self.G2 = law.surface2.D, law.surface2.G
        self.e, self.root = law.e, sqrt(log(law.surface.gamma))
        compliance = (1 - law.side1.nu**2) / law.side1.E
        if not law.rigid_flat:
            compliance += (1 - law.side2.nu**2) / law.side2.E
        self.E = 1 / compliance  # Eq. 21
        self.H, self.k = 2.8 * law.sigma_y, 0.454 + 0.41 * law.side1.nu  # Eqs. 25 and 26
        K, E = ellipk(self.e**2), ellipe(self.e**2)
        self.KE = K * E
        self.f1 = E / (K * sqrt(1 - self.e**2))  # Eq. 22
        self.f2 = pi * sqrt(E) / (2 * K**1.5 * sqrt(1 - self.e**2))  # Eq. 23 with E^(+1/2)
        self.zeta = 0.5 * sqrt(1 - self.e**2)  # Eq. 43
        self.m = self.zeta * (self.D1 + self.D2) / 2
        self.a_nec = self.edge(1)
        limits = (6, 110) if law.plastic_area == "geometric" else (0.93 * 6**1.136, 0.94 * 110**1.146)
        self.a_nepc, self.a_npc = (self.edge(limit) for limit in limits)

    def count(self, a_l):
        """Number density of the spots per logarithmic area a n'(a): lambda times Eq. 44."""
        return lambda a: self.law.lambda_ * self.m * (a_l / a) ** self.m

    def R_m(self, a):
        """Radius of curvature of Eqs. 12, 13 and 15."""
        s = 1 - self.e**2
        R_x = a ** (self.D1 / 2) * s ** (-self.D1 / 4)
        R_x /= 2 ** (4 - self.D1) * pi ** (self.D1 / 2) * self.G1 ** (self.D1 - 1) * self.root
        R_y = a ** (self.D2 / 2) * s ** (self.D2 / 4)
        R_y /= 2 ** (4 - self.D2) * pi ** (self.D2 / 2) * self.G2 ** (self.D2 - 1) * self.root
        return 2 / (1 / R_x + 1 / R_y)

    def w_nec(self, a):  # Eq. 27 with the spot's own curvature
        return self.KE * self.R_m(a) * (self.k * self.H / self.E) ** 2

    def ratio(self, a):
        """Area of a spot over its area at the onset of yield with the same curvature: Eq. 22 at w_nec."""
        return a / (self.f1 * pi * self.R_m(a) * self.w_nec(a))

    def edge(self, ratio):
        """Area of the spot with this ratio; the ratio decreases as the area grows."""
        return exp(brentq(lambda t: log(self.ratio(exp(t)) / ratio), -250.0, 250.0, xtol=1e-13, rtol=4 * EPS))

    def stage(self, a):
        """Deformation ratio w/w_nec, and exponents c, d of its stage in Eqs. 34 and 36."""
        m, n, c, d = KOGUT_ETSION[0] if a > self.a_nepc else KOGUT_ETSION[1]
        if self.law.plastic_area == "geometric":
            m = n = 1.0
        return (self.ratio(a) / m) ** (1 / n), c, d

    def load(self, a):
        if a <= self.a_npc:
            return self.H * a  # Eq. 38
        R_m, w_nec = self.R_m(a), self.w_nec(a)
        F_nec = self.f2 * 4 / 3 * self.E * sqrt(R_m) * w_nec**1.5
        if a <= self.a_nec:
            w, c, d = self.stage(a)
            return F_nec * c * w**d
        w = a / (self.f1 * pi * R_m)  # Eq. 22
        return self.f2 * 4 / 3 * self.E * sqrt(R_m) * w**1.5  # Eq. 23

    def stiffness(self, a):
        """Stiffness dF/dw of a spot with constant curvature, for areas above a_npc."""
        R_m, w_nec = self.R_m(a), self.w_nec(a)
        if a <= self.a_nec:
            w, c, d = self.stage(a)
            return self.f2 * 4 / 3 * self.E * sqrt(R_m * w_nec) * c * d * w ** (d - 1)
        return self.f2 * 2 * self.E * sqrt(R_m * a / (self.f1 * pi * R_m))

    def total(self, spot, a_l, start=None):
        """Sum over the spots up to a_l, from zero (plastic spots) or from the start of a regime."""
        edges = [self.a_npc, self.a_nepc, self.a_nec]
        if start is None:
            edges.insert(0, open_end(min(self.a_npc, a_l), 1 - self.m))
        else:
            edges = [edge for edge in edges if edge >= start]
        return over_spots(spot, self.count(a_l), edges, a_l)


@given(law=yu_laws, u=log_areas)
def test_totals_are_sums_over_spots(law, u):
    paper, s = Paper(law), law.spot_distribution()
    assert s.reference_area == pytest.approx(paper.a_nec, rel=1e-11)  # brentq: 1e-13 in ln a
    a_l = paper.a_nec * exp(u)
    # closer to an edge than 1 % the quadrature's own difference of logarithms is lost
    assume(all(abs(log(a_l / edge)) > 0.01 for edge in (paper.a_npc, paper.a_nepc, paper.a_nec)))
    expected = {
        "load": paper.total(paper.load, a_l),
        "normal": paper.total(paper.stiffness, a_l, paper.a_npc),
        "area": paper.total(lambda a: a, a_l),
        "elastic_area": paper.total(lambda a: a, a_l, paper.a_nec),
    }
    assert set(s.regime_terms) == set(expected)
    for name, value in expected.items():
        assert s.sum_over_spots(name, u) == pytest.approx(value, rel=QUAD), name
    state = law.contact_quantities(u)
    for symbol, name in {"F": "load", "K_N": "normal", "A_r": "area"}.items():
        assert state[symbol] == s.sum_over_spots(name, u)
    assert state["elastic_fraction"] == pytest.approx(expected["elastic_area"] / expected["area"], rel=QUAD)


@given(law=yu_laws)
def test_order_of_the_regimes(law):
    """a_npc < a_nepc < a_nec: small spots are plastic."""
    paper, s = Paper(law), law.spot_distribution()
    plastic, second, first, *elastic = s.regime_terms["load"]
    assert plastic.upper_log_area < second.upper_log_area < 0.0
    assert plastic.lower_log_area is None
    assert (second.lower_log_area, first.lower_log_area, first.upper_log_area) == (
        plastic.upper_log_area,
        second.upper_log_area,
        0.0,
    )
    assert [term.lower_log_area for term in elastic] == [0.0, 0.0]
    # the roots of Eqs. 28, 31, 32 to brentq's 1e-13, differences of ln a of some ten
    assert plastic.upper_log_area == pytest.approx(log(paper.a_npc / paper.a_nec), rel=1e-11)
    assert second.upper_log_area == pytest.approx(log(paper.a_nepc / paper.a_nec), rel=1e-11)


@pytest.mark.parametrize("D", [1.15, 1.46, 1.8])
def test_edges_of_equal_dimensions(D):
    """With D1 = D2 the root has a closed form: w/w_nec = (a/a_nec)^-(D - 1)."""
    law = changed(YU, {"surface1.D": D, "surface2.D": D})
    nec, nepc, npc = (yu2022.critical_log_area(law, x) for x in (1.0, 6.0, 110.0))
    # ln a of some ten, over D - 1
    assert nepc - nec == pytest.approx(-log(6) / (D - 1), rel=1e-12)
    assert npc - nec == pytest.approx(-log(110) / (D - 1), rel=1e-12)


@given(law=yu_laws, multiple=st.floats(1.0, 206.0))
def test_critical_area_is_the_root_of_equation_28(law, multiple):
    paper = Paper(law)
    t = yu2022.critical_log_area(law, multiple)
    total = 2 / paper.R_m(exp(t))  # 1/R_x + 1/R_y
    right = 4 * pi * paper.f1 * paper.KE * (paper.k * paper.H / paper.E) ** 2
    # powers up to 10 of areas: |ln a| eps
    assert exp(t) * total**2 == pytest.approx(multiple * right, rel=1e-12)


def test_shape_factors_of_a_circle():
    assert yu2022.ellipse_factors(0.0) == pytest.approx((1.0, 1.0), rel=4 * EPS)


@given(e=st.floats(0.0, 0.99))
def test_shape_factors(e):
    """The factors of Eqs. 22 and 23 give Hertz's load (Eqs. 17 and 18) at one deformation."""
    f1, f2 = yu2022.ellipse_factors(e)
    K, E = ellipk(e**2), ellipe(e**2)
    R, modulus, F = 1.0, 1.0, 1.0
    w = 2 * K / pi * (pi * (1 - e**2) / (2 * E * R)) ** (1 / 3) * (3 * F / (4 * modulus)) ** (2 / 3)  # Eq. 18
    r_x = (3 * E * F * R / (2 * pi * modulus * (1 - e**2))) ** (1 / 3)  # Eq. 17
    area = pi * r_x**2 * sqrt(1 - e**2)  # Eq. 11
    # 1 - e^2 loses 1e-14 at e = 0.99
    assert f2 * 4 / 3 * modulus * sqrt(R) * w**1.5 == pytest.approx(F, rel=1e-12)
    assert f1 * pi * R * w == pytest.approx(area, rel=1e-12)


@given(e=st.floats(0.0, 0.99))
def test_onset_of_yield_follows_from_the_shape_factors(e):
    """Eq. 27 (w_nec = K E R (K H/E')^2) follows from P_m = K H and Eqs. 16, 22, 23 if E has exponent +1/2."""
    f1, f2 = yu2022.ellipse_factors(e)
    K, E = ellipk(e**2), ellipe(e**2)
    strain = 1e-3
    w = K * E * strain**2
    pressure = 3 / 2 * (f2 * 4 / 3 * w**1.5) / (f1 * pi * w)  # Eq. 16, R = E' = 1
    assert pressure == pytest.approx(strain, rel=1e-12)  # conditioning of 1 - e^2


def test_rigid_flat():
    soft = YU.side1
    assert yu2022.effective_modulus(YU) == pytest.approx(soft.E / (1 - soft.nu**2), rel=4 * EPS)
    both = changed(YU, {"rigid_flat": False})
    assert yu2022.effective_modulus(both) == pytest.approx(yu2022.effective_modulus(YU) / 2, rel=4 * EPS)
    # a rigid flat does not see the second body, two bodies do
    other = {"side2.E": 7e10}
    assert changed(YU, other).contact_quantities(3.0) == YU.contact_quantities(3.0)
    assert changed(both, other).contact_quantities(3.0) != both.contact_quantities(3.0)


def test_friction_does_not_enter():
    assert changed(YU, {"mu": 0.9, "traction_ratio": 0.9}).contact_quantities(2.0) == YU.contact_quantities(
        2.0
    )


def test_contact_coefficient_scales_everything():
    half = changed(YU, {"lambda": YU.lambda_ / 2})
    u = np.linspace(-15.0, 10.0, 26)
    for symbol in ("F", "K_N", "A_r"):
        # a power of two is exact up to the order of the factors
        assert half.contact_quantities(u)[symbol] == pytest.approx(
            YU.contact_quantities(u)[symbol] / 2, rel=4 * EPS
        )


@given(law=yu_laws, u=st.floats(0.1, 20.0))
def test_area(law, u):
    """The real area obeys Eqs. 45 and 54, its elastic part Eq. 59."""
    paper, state = Paper(law), law.contact_quantities(u)
    z, a_l = paper.zeta * (paper.D1 + paper.D2), paper.a_nec * exp(u)
    # a_nec: brentq's 1e-13 in ln a
    assert state["A_r"] == pytest.approx(law.lambda_ * z / (2 - z) * a_l, rel=1e-11)
    A_re = law.lambda_ * z / (2 - z) * a_l ** (z / 2) * (a_l ** (1 - z / 2) - paper.a_nec ** (1 - z / 2))
    assert state["elastic_fraction"] * state["A_r"] == pytest.approx(A_re, rel=1e-9)  # difference of powers


@given(law=yu_laws, u=st.floats(0.1, 20.0))
def test_elastic_load(law, u):
    """The load is lambda times Eq. 65, with the factor (1 - e^2)^(D/4) for D1, and its inverse for D2."""
    paper = Paper(law)
    z = paper.zeta * (paper.D1 + paper.D2)
    a_l = paper.a_nec * exp(u)
    assume(all(abs(3 - z - D) > 0.05 for D in (paper.D1, paper.D2)))  # the printed form divides by it
    expected = 0.0
    for D, G, sign in ((paper.D1, paper.G1, 1), (paper.D2, paper.G2, -1)):
        c = 2 ** (5 - D) * pi ** ((D - 3) / 2) * paper.f2 * paper.E * G ** (D - 1) * paper.root * z
        c *= (1 - paper.e**2) ** (sign * D / 4) / (3 * paper.f1**1.5 * (3 - z - D))
        power = (3 - z - D) / 2
        expected += law.lambda_ * c * a_l ** (z / 2) * (a_l**power - paper.a_nec**power)
    s = law.spot_distribution()
    elastic = sum(term.integrate_over_spots(s.size_exponent, u) for term in s.regime_terms["load"][3:])
    # difference of powers: 1e-11 of a_nec over 0.1 * 0.025
    assert s.size_exponent * s.size_prefactor * np.exp(s.size_exponent * u) * elastic == pytest.approx(
        expected, rel=1e-8
    )


@pytest.mark.parametrize("plastic_area", ["geometric", "kogut_etsion"])
def test_elastic_plastic_loads_of_equal_dimensions(plastic_area):
    """For D1 = D2 the loads obey Eqs. 62 and 63 with the exponent -d/n and each spot's own curvature."""
    law = changed(YU, {"plastic_area": plastic_area, "e": 0.0})
    paper, s = Paper(law), law.spot_distribution()
    D, u = paper.D1, 5.0
    F_nec = paper.f2 * 4 / 3 * paper.E * sqrt(paper.R_m(paper.a_nec)) * paper.w_nec(paper.a_nec) ** 1.5
    ends = ((paper.a_npc, paper.a_nepc), (paper.a_nepc, paper.a_nec))
    for term, (low, high), (m, n, c, d) in zip(
        s.regime_terms["load"][1:3], ends, KOGUT_ETSION[::-1], strict=True
    ):
        if plastic_area == "geometric":
            m = n = 1.0
        # R_m ~ a^(D/2): F_nec(R_m) ~ R_m^2 = a^D, w/w_nec = ((a/a_nec)^(1 - D)/m)^(1/n)
        x = D + (1 - D) * d / n - paper.m
        integral = (high**x - low**x) / (x * paper.a_nec**x)
        expected = law.lambda_ * paper.m * F_nec * c * m ** (-d / n) * exp(paper.m * u) * integral
        # brentq's 1e-13 in ln a, twice
        assert s.size_exponent * s.size_prefactor * np.exp(s.size_exponent * u) * term.integrate_over_spots(
            s.size_exponent, u
        ) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(("plastic_area", "jump"), [("geometric", 1.03), ("kogut_etsion", 1.12816)])
def test_jump_of_the_force_at_the_onset(plastic_area, jump):
    """The jump is c for the geometric area, and c m^(-d/n) for the area of Kogut and Etsion."""
    s = changed(YU, {"plastic_area": plastic_area}).spot_distribution()
    below, above = (
        sum(float(term.evaluate_spot(t)) for term in s.regime_terms["load"]) for t in (0.0, 1e-12)
    )
    assert below / above == pytest.approx(jump, abs=5e-6)  # six digits


# zeta (D1 + D2)/2 + D/2 = 3/2 for the load, zeta (D1 + D2) = 1 for the stiffness
SINGULAR = {
    "load, round": {"surface1.D": 1.5, "surface2.D": 1.5, "e": 0.0},
    "load, one term": {"surface1.D": 1.4, "surface2.D": 1.8, "e": 0.0},
    "stiffness": {"surface1.D": 1.5, "surface2.D": 1.5, "e": sqrt(1 - 4 / 9)},
    "stiffness, two": {"surface1.D": 1.2, "surface2.D": 1.3, "e": 0.6},
}


@pytest.mark.parametrize("name", SINGULAR)
@pytest.mark.parametrize("k", [*range(3, 17), 99])
def test_continuity_through_the_singular_exponents(name, k):
    values = SINGULAR[name]
    for step in (10.0**-k, -(10.0**-k)):
        law = changed(YU, values | {"surface1.D": values["surface1.D"] + step})
        paper, s = Paper(law), law.spot_distribution()
        u = 6.0
        a_l = paper.a_nec * exp(u)
        assert s.sum_over_spots("load", u) == pytest.approx(paper.total(paper.load, a_l), rel=QUAD)
        assert s.sum_over_spots("normal", u) == pytest.approx(
            paper.total(paper.stiffness, a_l, paper.a_npc), rel=QUAD
        )


def test_singular_cases_are_singular():
    for name, values in SINGULAR.items():
        s = changed(YU, values).spot_distribution()
        terms = s.regime_terms["normal"][2:] if "stiffness" in name else s.regime_terms["load"][3:]
        assert min(abs(term.exponent - s.size_exponent) for term in terms) < 4 * EPS, name
