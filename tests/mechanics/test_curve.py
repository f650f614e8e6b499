"""Tabulated monotone force laws: spline, inverse, interpolation error, approach of an interface."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laws import RANDOM, YU, ZHAO, changed, decades
from numpy.polynomial import Polynomial, polynomial
from scipy.integrate import quad

from jointfmu.contact.interface import evaluate_at_largest_spot, solve_largest_spot, stiffness_curve
from jointfmu.joints.harmonic_drive.spring import torque_curve
from jointfmu.mechanics.curve import (
    CLOSING_END_OVER_PLASTIC_SPOT_AREA,
    MAX_INTERPOLATION_ERROR,
    Curve,
    assemble_curve,
    closing_pressure,
    tabulate_approach,
)
from jointfmu.parameters import load_default

EPS = np.finfo(float).eps
STENCIL = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
"""Central difference with seven points, exact up to degree six: on a quintic only round-off remains."""

SETS = {
    "zhao": ZHAO,
    "zhao-D-1.5": changed(ZHAO, {"surface.D": 1.5}),
    "zhao-D-5/3": changed(ZHAO, {"surface.D": 5.0 / 3.0}),
    "zhao-D-1.8": changed(ZHAO, {"surface.D": 1.8, "surface.G": 1e-10}),
    "zhao-printed": changed(ZHAO, {"critical_area": "printed", "surface.D": 1.6}),
    "zhao-yield": changed(ZHAO, {"critical_area": "yield", "surface.D": 1.6}),
    "zhao-hertz": changed(ZHAO, {"spot_stiffness": "hertz", "H": 3e9}),
    "yu": YU,
    "yu-two-D": changed(YU, {"surface1.D": 1.36, "surface2.D": 1.66, "surface1.G": 1e-11}),
    "yu-slender": changed(YU, {"e": 0.7, "surface1.G": 1e-11, "surface2.G": 1e-11}),
    "yu-kogut-etsion": changed(YU, {"plastic_area": "kogut_etsion"}),
    "yu-two-bodies": changed(YU, {"rigid_flat": False, "lambda": 0.9, "sigma_y": 4e8}),
}
each_set = pytest.mark.parametrize("law", SETS.values(), ids=SETS)


@pytest.fixture(scope="module")
def curves():
    """Every exported kind of table: {name: curve}."""
    made = {name: tabulate_approach(law) for name, law in SETS.items()}
    return made | {"drive": torque_curve(load_default("harmonic_drive").values)}


def polynomial_curve(p, nodes):
    values = [p.deriv(k)(nodes) if k else p(nodes) for k in range(3)]
    return Curve(nodes, values[0], values[1], values[2][:-1], values[2][1:])


@st.composite
def node_lists(draw):
    gaps = draw(st.lists(st.floats(0.3, 1.5), min_size=1, max_size=5))
    return draw(st.floats(-2.0, 2.0)) + np.concatenate([[0.0], np.cumsum(gaps)])


@given(
    nodes=node_lists(),
    coefficients=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=6),
    t=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=10),
)
def test_polynomials_up_to_degree_five(nodes, coefficients, t):
    p = Polynomial(coefficients)
    x = nodes[0] + (nodes[-1] - nodes[0]) * np.array(t)
    found = polynomial_curve(p, nodes).derivatives(x, 5)
    scale = Polynomial(np.abs(coefficients))(np.max(np.abs(nodes))) + 1e-300
    for k, value in enumerate(found):
        # round-off of the data, 60 times the data in the coefficients, and 5!/(5 - k)! h^-k
        tolerance = 1e3 * EPS * scale * 120.0 / np.min(np.diff(nodes)) ** k
        np.testing.assert_allclose(value, p.deriv(k)(x) if k else p(x), rtol=0.0, atol=tolerance)


@given(nodes=node_lists(), t=st.floats(0.0, 1.0))
def test_degree_six_leaves_the_node_polynomial(nodes, t):
    """x^6 minus its Hermite interpolant over [a, b] is (x - a)^3 (x - b)^3, so the interpolant is quintic."""
    a, b = nodes[:2]
    x = a + t * (b - a)
    curve = polynomial_curve(Polynomial([0.0] * 6 + [1.0]), nodes[:2])
    scale = np.max(np.abs(nodes)) ** 6
    error = x**6 - curve.derivatives(x)[0]
    assert error == pytest.approx((x - a) ** 3 * (x - b) ** 3, rel=0.0, abs=1e4 * EPS * scale)


def test_each_derivative_is_the_slope_of_the_one_before(curves):
    for name, curve in curves.items():
        x, h = curve.displacement, np.diff(curve.displacement)
        middle, step = 0.5 * (x[:-1] + x[1:]), h / 8.0
        around = curve.derivatives(middle + step * np.arange(-3, 4)[:, None], 2)
        at = curve.derivatives(middle, 3)
        size = np.abs(at[0]) + at[1] * np.abs(middle)  # round-off of the load and of x itself
        for k in range(3):
            slope = STENCIL @ around[k] / step
            # round-off eps/h^k of the k-th derivative, 60 in its coefficients, 15 in the stencil
            tolerance = 1e3 * EPS * size / h ** (k + 1)
            assert np.all(np.abs(at[k + 1] - slope) <= tolerance), (name, k)
        assert np.all(1e3 * EPS * size / h < 1e-6 * at[1])  # the bound on the stiffness is not empty


def test_nodes_are_met(curves):
    """The curve meets load, stiffness and both one-sided second derivatives at every node."""
    for curve in curves.values():
        x = curve.displacement
        load, stiffness = curve.derivatives(x, 1)
        # six coefficients of up to 15 times the data; a node's own value is exact up to their sum
        np.testing.assert_allclose(load, curve.load, rtol=1e2 * EPS, atol=0.0)
        noise = 1e2 * EPS * curve.load[1:] / np.diff(x)
        assert np.all(np.abs(stiffness - curve.stiffness)[1:] <= noise + 1e2 * EPS * curve.stiffness[1:])
        inner = np.diff(x) * 1e-9
        right = curve.derivatives(x[:-1] + inner, 2)[2]
        left = curve.derivatives(x[1:] - inner, 2)[2]
        # 1e-9 of a segment away: the third derivative moves the bend by at most 1e-9 * 60 times its size
        size = np.maximum(np.abs(curve.stiffness_slope_start), np.abs(curve.stiffness_slope_end))
        size = size + curve.stiffness[1:] / np.diff(x)
        assert np.all(np.abs(right - curve.stiffness_slope_start) <= 1e-7 * size)
        assert np.all(np.abs(left - curve.stiffness_slope_end) <= 1e-7 * size)


def test_load_and_stiffness_have_no_jump_at_nodes(curves):
    for curve in curves.values():
        x = curve.displacement[1:-1]
        below, above = np.nextafter(x, -np.inf), np.nextafter(x, np.inf)
        low, high = curve.derivatives(below, 1), curve.derivatives(above, 1)
        gap = above - below
        # the slope over the gap, and the round-off of both polynomials: near t = 1 the coefficients of load,
        # 10 + 15 + 6 times two loads, count k times in the stiffness, 3 10 + 4 15 + 5 6 times two, for each
        assert np.all(np.abs(high[0] - low[0]) <= high[1] * gap + 1.3e2 * EPS * high[0])
        h = np.minimum(np.diff(curve.displacement)[:-1], np.diff(curve.displacement)[1:])
        bend = np.maximum(np.abs(curve.stiffness_slope_end[:-1]), np.abs(curve.stiffness_slope_start[1:]))
        assert np.all(np.abs(high[1] - low[1]) <= bend * gap + 4.8e2 * EPS * (high[1] + high[0] / h))


def test_inverse_round_trip(curves):
    for name, curve in curves.items():
        y = np.concatenate([np.linspace(0.0, 1.5 * curve.end_point[1], 501), np.geomspace(1e-9, 1.0, 501)])
        y[501:] *= curve.end_point[1]
        x = curve.inverse(y)
        load, stiffness = curve.derivatives(x, 1)
        # round-off of x moves the load by k eps |x|; the polynomial sums 15 times the load
        segment = np.searchsorted(curve.displacement, x, side="right").clip(1, curve.load.size - 1)
        tolerance = 4.0 * EPS * stiffness * np.abs(x) + 60.0 * EPS * np.maximum(curve.load[segment], y)
        # and the tangent beyond the end has the polynomial's round-off over the last segment
        beyond = np.maximum(x - curve.end_point[0], 0.0) / (curve.end_point[0] - curve.displacement[-2])
        tolerance += 60.0 * EPS * curve.end_point[1] * beyond
        assert np.all(np.abs(load - y) <= tolerance), name
        assert np.all(np.diff(x[501:]) > 0.0)


def test_inverse_at_the_ends(curves):
    for curve in curves.values():
        found = curve.inverse(curve.load[[0, -1]])
        assert found[0] == curve.displacement[0]
        # the last load is met to its round-off, eps y/k in the displacement
        noise = 60.0 * EPS * curve.load[-1] / curve.stiffness[-1] + 4.0 * EPS * curve.displacement[-1]
        assert found[1] == pytest.approx(curve.displacement[-1], rel=0.0, abs=noise)
        assert np.shape(curve.inverse(curve.load[-1])) == ()


@given(
    nodes=node_lists(),
    coefficients=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=6),
    t=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=10),
)
def test_energy_of_a_polynomial(nodes, coefficients, t):
    p = Polynomial(coefficients)
    x = nodes[0] + (nodes[-1] - nodes[0]) * np.array(t)
    found = polynomial_curve(p, nodes).energy(x)
    antiderivative = p.integ()
    scale = (Polynomial(np.abs(coefficients))(np.max(np.abs(nodes))) + 1e-300) * (np.ptp(nodes) + 1.0)
    # round-off of the data, 60 times the data in the coefficients; the closed form subtracts
    tolerance = 1e3 * EPS * scale * (1.0 + np.max(np.abs(nodes)))
    np.testing.assert_allclose(found, antiderivative(x) - antiderivative(nodes[0]), rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("name", [*SETS, "drive"])
def test_load_is_the_slope_of_the_energy(curves, name):
    """Between nodes the load is the derivative of the energy; the energy in a segment is one polynomial of
    degree six, as the stencil requires."""
    curve = curves[name]
    x0, h = curve.displacement[:-1], np.diff(curve.displacement)
    x = x0 + h * (0.5 + 0.1 * np.arange(-3, 4)[:, None])
    energy = curve.energy(x)
    slope = STENCIL @ (energy - energy[3]) / (0.1 * h)
    # the table's last digit of the energy, over a tenth of a segment
    noise = 10.0 * EPS * (energy[3] + np.abs(curve.displacement[1:] * slope)) / (0.1 * h)
    assert np.all(np.abs(slope - curve.derivatives(x[3], 0)[0]) <= noise + 1e-12 * slope)
    assert energy[3, 0] > 0.0


def test_energy_of_the_closing():
    """V = p L z^4 (a/4 + b z/5 + c z^2/6) from first contact on, accurate down to the smallest z."""
    curve = tabulate_approach(ZHAO)
    p, length = curve.closing_end_pressure, -curve.displacement[0]
    i = int(np.searchsorted(curve.displacement, 0.0))
    c = 0.5 * curve.stiffness_slope_end[i - 1] * length**2 / p - 6.0
    z = np.array([1e-3, 1e-2, 0.1, 0.5, 1.0])
    expected = p * length * z**4 * (c / 4.0 + (1.0 - 2.0 * c) * z / 5.0 + c * z**2 / 6.0)
    # x = (z - 1) L keeps 1e-16 of L, the load grows with z^3
    np.testing.assert_allclose(curve.energy((z - 1.0) * length), expected, rtol=1e-11)
    assert curve.energy(curve.displacement[0]) == 0.0


def test_energy_beyond_the_ends_is_that_of_the_tangents():
    """Beyond its ends, y = 1 + 2x + x^2 on [0, 1] has the energy of the end tangents; inside it is 7/3."""
    found = straight_ends().energy([-3.0, 0.0, 1.0, 11.0])
    # -3 + 2*9/2; 7/3 + 4*10 + 4*100/2
    np.testing.assert_allclose(found, [6.0, 0.0, 7.0 / 3.0, 7.0 / 3.0 + 240.0], rtol=1e-12)  # round-off
    assert np.shape(straight_ends().energy(0.5)) == ()


def straight_ends():
    """Curve y = 1 + 2x + x^2 on [0, 1], with stiffness 2 and 4 at its ends."""
    return polynomial_curve(Polynomial([1.0, 2.0, 1.0]), np.linspace(0.0, 1.0, 4))


@pytest.mark.parametrize(
    ("x", "y", "k"), [(-3.0, -5.0, 2.0), (-0.25, 0.5, 2.0), (1.5, 6.0, 4.0), (11.0, 44.0, 4.0)]
)
def test_last_tangents_continue(x, y, k):
    load, stiffness, bend, twist = straight_ends().derivatives(x, 3)
    # the polynomial sums 60 times numbers up to 4 over a segment of 1/3; then up to ten times that
    noise = 60.0 * EPS * 4.0 * 3.0
    assert load == pytest.approx(y, rel=0.0, abs=10.0 * noise)
    assert stiffness == pytest.approx(k, rel=0.0, abs=noise)
    assert (bend, twist) == (0.0, 0.0)
    assert straight_ends().derivatives(x, 0)[0] == load


@pytest.mark.parametrize(("x", "y"), [(-3.0, -5.0), (-0.25, 0.5), (1.5, 6.0), (11.0, 44.0)])
def test_inverse_continues_with_the_last_tangents(x, y):
    assert straight_ends().inverse(y) == pytest.approx(x, rel=0.0, abs=1e-13)  # numbers of order ten


def test_a_flat_beginning_is_inverted_to_the_first_node():
    curve = tabulate_approach(ZHAO)
    assert np.all(curve.inverse([-1e9, -1.0, 0.0]) == curve.displacement[0])


def test_pieces_keep_their_bends():
    """2x + x^2 below and 2x + 3x^2 above zero: quintics reproduce both, only the second derivative jumps."""
    pieces = []
    for ends, bend in (((-0.5, 0.0), 2.0), ((0.0, 1.0), 6.0)):
        x = np.linspace(*ends, 5)
        pieces.append((x, 3.0 + 2.0 * x + 0.5 * bend * x**2, 2.0 + bend * x, np.full(5, bend)))
    curve = assemble_curve(pieces)
    x = np.linspace(-0.5, 1.0, 301)
    bend = np.where(x < 0.0, 2.0, 6.0)
    found = curve.derivatives(x, 2)
    np.testing.assert_allclose(found[0], 3.0 + 2.0 * x + 0.5 * bend * x**2, rtol=1e-13)  # round-off
    np.testing.assert_allclose(found[1], 2.0 + bend * x, rtol=1e-12)  # round-off over h = 1/8
    np.testing.assert_allclose(found[2], bend, rtol=1e-10)  # round-off over h^2
    assert curve.displacement.size == 9
    assert curve.interpolation_error < 1e-13  # nothing to interpolate


SMOOTH = {
    "exp": (np.exp, np.exp, np.exp),
    "stiffening": (lambda x: x + x**3.5, lambda x: 1 + 3.5 * x**2.5, lambda x: 8.75 * x**1.5),
    "hardening": (lambda x: x / (4 - x), lambda x: 4 / (4 - x) ** 2, lambda x: 8 / (4 - x) ** 3),
}


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("segments", [16, 32, 64])
def test_measured_error_covers_the_true_error(name, segments):
    """The measured error covers the true error of load and stiffness, everywhere between the nodes."""
    f, slope, bend = SMOOTH[name]
    x = np.linspace(1.0, 3.0, segments + 1)
    curve = assemble_curve([(x, f(x), slope(x), bend(x))])
    dense = np.linspace(1.0, 3.0, 20 * segments + 1)
    load, stiffness = curve.derivatives(dense, 1)
    true = max(np.max(np.abs(load / f(dense) - 1.0)), np.max(np.abs(stiffness / slope(dense) - 1.0)))
    noise = 1e2 * EPS * segments  # round-off of the stiffness over one segment
    assert true <= curve.interpolation_error + noise
    # measured with half the nodes: 2^6 times the error of the load, 2^5 of the stiffness, halved
    assert curve.interpolation_error <= 32.0 * true + noise


@each_set
def test_approach_is_the_integral_of_dp_over_k(law):
    """Pressure and stiffness at an approach, by adaptive quadrature, to MAX_INTERPOLATION_ERROR."""
    curve = tabulate_approach(law)
    spots = law.spot_distribution()
    start = float(curve.load[np.searchsorted(curve.displacement, 0.0)])
    pressures = np.geomspace(start, 0.999 * law.hardness, 7)
    ends = [end for end in spots.sorted_regime_end_log_areas if end > spots.stiffness_onset_log_area]
    breaks = [float(spots.sum_over_spots("load", end)) / law.A_0 for end in ends]

    def per_decade(t):
        p = np.exp(t)
        return float(p / stiffness_curve(law, p)[0])

    delta = 0.0
    for low, high in pairwise(pressures):
        inner = [np.log(b) for b in breaks if low < b < high]
        ends = [np.log(low), *inner, np.log(high)]
        delta += sum(quad(per_decade, a, b, epsabs=0.0, epsrel=1e-10)[0] for a, b in pairwise(ends))
        load, stiffness = curve.derivatives(delta, 1)
        assert load == pytest.approx(high, rel=MAX_INTERPOLATION_ERROR)
        assert stiffness == pytest.approx(float(stiffness_curve(law, high)[0]), rel=MAX_INTERPOLATION_ERROR)


@each_set
def test_stiffness_is_the_laws(law):
    """Everywhere between the nodes, the stiffness is that of the law at the pressure of the table."""
    curve = tabulate_approach(law)
    x = curve.displacement[curve.displacement >= 0.0]
    t = np.linspace(0.0, 1.0, 11)[:-1, None]
    p, k = curve.derivatives((x[:-1] + t * np.diff(x)).ravel(), 1)
    np.testing.assert_allclose(k, stiffness_curve(law, p)[0], rtol=MAX_INTERPOLATION_ERROR)
    assert curve.end_point[1] == pytest.approx(law.hardness, rel=1e-12)  # residual of the pressure inversion


@pytest.mark.parametrize("kind", ["zhao", "yu"])
@settings(max_examples=40)
@given(data=st.data())
def test_any_law_gives_a_monotone_table_or_is_refused(kind, data):
    law = data.draw(RANDOM[kind])
    if law.spot_distribution().stiffness_onset_log_area + np.log(
        CLOSING_END_OVER_PLASTIC_SPOT_AREA
    ) >= solve_largest_spot(law, law.hardness):
        with pytest.raises(ValueError, match="plastic"):
            tabulate_approach(law)
        return
    curve = tabulate_approach(law)
    assert curve.interpolation_error <= MAX_INTERPOLATION_ERROR
    x = curve.displacement
    load, stiffness = curve.derivatives((x[:-1] + np.linspace(0, 1, 9)[:-1, None] * np.diff(x)).T.ravel(), 1)
    assert np.all(np.diff(load) > 0.0)
    assert np.all(stiffness[1:] > 0.0)


@each_set
def test_closing_begins_at_nothing_and_joins_smoothly(law):
    curve = tabulate_approach(law)
    assert (curve.load[0], curve.stiffness[0], curve.stiffness_slope_start[0]) == (0.0, 0.0, 0.0)
    assert np.all(np.array(curve.derivatives(curve.displacement[0] - 1e-6, 3)) == 0.0)
    i = int(np.searchsorted(curve.displacement, 0.0))
    assert curve.displacement[i] == 0.0
    p, k = curve.load[i], curve.stiffness[i]
    assert curve.displacement[0] == pytest.approx(-4.0 * p / k, rel=1e-14)  # one multiplication
    # the closing takes over the very same numbers; its last polynomial sums three of them
    assert curve.stiffness_slope_end[i - 1] == pytest.approx(curve.stiffness_slope_start[i], rel=1e-12)
    spots = law.spot_distribution()
    state = evaluate_at_largest_spot(
        law,
        spots.reference_area * np.exp(spots.stiffness_onset_log_area) * CLOSING_END_OVER_PLASTIC_SPOT_AREA,
    )
    assert p == pytest.approx(float(state["pressure"]), rel=1e-12)  # round-off of exp and log
    slope = stiffness_curve(law, p)[1]
    assert curve.stiffness_slope_start[i] == pytest.approx(
        float(k * slope), rel=1e-7
    )  # taken 1e-9 inside the regime


@given(
    p=decades(1e-3, 1e9),
    k=decades(1e6, 1e16),
    growth=st.floats(0.75, 2.7),
)
def test_closing(p, k, growth):
    """One quintic, C2 at both ends, monotone, and its derivatives; growth = d ln k/d ln p of the laws.

    With c = 8 growth - 6 the stiffness is z^2 (3 c + 4 (1 - 2 c) z + 5 c z^2) k, which has no zero inside up
    to c = 8 + sqrt(60), a growth of 2.718.
    """
    bend = growth * k * k / p
    z = np.linspace(0.0, 1.0, 49)
    x, load, stiffness, slope = closing_pressure(p, k, bend, z)
    assert (load[0], stiffness[0], slope[0]) == (0.0, 0.0, 0.0)
    assert x[-1] == 0.0
    # sums of three terms up to 60 times the result
    assert load[-1] == pytest.approx(p, rel=1e-13)
    assert stiffness[-1] == pytest.approx(k, rel=1e-13)
    assert slope[-1] == pytest.approx(bend, rel=1e-12)
    assert np.all(np.diff(load) > 0.0)
    assert np.all(stiffness[1:] > 0.0)
    length = 4.0 * p / k
    fit = Polynomial(polynomial.polyfit(z, load / p, 5))
    # a fit of six powers over [0, 1] loses about eight digits
    np.testing.assert_allclose(fit.deriv(1)(z), stiffness * length / p, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(fit.deriv(2)(z), slope * length**2 / p, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize(
    "law",
    [
        changed(ZHAO, {"surface.D": 1.2}),
        changed(ZHAO, {"surface.D": 1.23}),
        changed(ZHAO, {"surface.D": 1.3, "surface.G": 1e-6}),
        changed(YU, {"surface1.D": 1.2, "surface2.D": 1.2, "surface1.G": 1e-7, "surface2.G": 1e-7}),
    ],
    ids=["zhao-D-1.2", "zhao-D-1.23", "zhao-coarse", "yu"],
)
def test_only_plastic_spots_are_refused(law):
    with pytest.raises(ValueError, match="all contact spots are plastic") as error:
        tabulate_approach(law)
    text = str(error.value)
    assert "\n" not in text
    said = float(text.split("start at ")[1].split(" Pa")[0])
    assert said > law.hardness  # what the message says
