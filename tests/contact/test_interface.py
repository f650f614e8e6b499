"""Inversion from pressure to largest spot and stiffness, its limits, and properties of every law."""

from dataclasses import fields, is_dataclass, replace

import casadi
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from laws import HU, LAWS, RANDOM, YU, ZHAO, changed, decades

from jointfmu.contact.interface import (
    compute_newton_step,
    evaluate_at_largest_spot,
    evaluate_at_pressure,
    solve_largest_spot,
    stiffness_curve,
)
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_fields, flatten_parameters

EPS = np.finfo(float).eps
RESIDUAL = 1e-12
"""Relative residual of the load that `solve_largest_spot` guarantees."""

each_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
each_kind = pytest.mark.parametrize("kind", RANDOM)
log_pressures = st.floats(np.log(1e-9), np.log(1e13))  # Pa: far beyond any joint on both sides


def load(law, pressure):
    return law.spot_distribution().sum_over_spots("load", solve_largest_spot(law, pressure))


@each_kind
@given(data=st.data())
def test_inversion_residual(kind, data):
    law = data.draw(RANDOM[kind])
    pressure = np.exp(data.draw(st.lists(log_pressures, min_size=1, max_size=20)))
    assert load(law, pressure) == pytest.approx(pressure * law.A_0, rel=RESIDUAL)


@each_kind
@given(data=st.data(), v=st.floats(-30.0, 30.0))
def test_newton_step(kind, data, v):
    """The step is the residual over d ln F/dv; this derivative is within the bounds that the safeguard
    assumes."""
    spots = data.draw(RANDOM[kind]).spot_distribution()

    def log_load(v):
        return spots.log_sum_over_spots("load", v)[0]

    h = 1e-4
    ends = {
        end for term in spots.regime_terms["load"] for end in (term.lower_log_area, term.upper_log_area)
    } - {None}
    assume(all(abs(v - end) > 2 * h for end in ends))
    slope = (log_load(v + h) - log_load(v - h)) / (2 * h)
    assert 0.5 * spots.size_exponent < slope < 2.5
    aim = log_load(v) + 1e-3
    step, lower, upper, residual = compute_newton_step(spots, v, aim)
    assert residual == pytest.approx(1e-3, rel=1e-9)  # a difference of logarithms of order 100
    assert lower < step < upper
    # truncation h^2/6 of the third derivative and round-off 100 eps/h
    assert step == pytest.approx(1e-3 / slope, rel=1e-6)
    # whatever the law, the root lies between the two ends of the bracket
    assert log_load(v + lower) <= aim <= log_load(v + upper)


@each_law
def test_inversion_over_the_whole_range(law):
    pressure = np.geomspace(1e-60, 1e20, 4001)
    # u reaches 200: exp(m u) and the powers of the area lose eps u each
    assert load(law, pressure) == pytest.approx(pressure * law.A_0, rel=RESIDUAL)


@each_law
def test_shapes(law):
    pressure = np.geomspace(1.0, 1e9, 12).reshape(3, 1, 4)
    u = solve_largest_spot(law, pressure)
    assert u.shape == (3, 1, 4)
    # a point does not see its neighbours except through the number of steps: two residuals of 1e-13
    alone = [float(solve_largest_spot(law, p)) for p in pressure.ravel()]
    assert u.ravel() == pytest.approx(alone, rel=RESIDUAL, abs=RESIDUAL)
    assert solve_largest_spot(law, 1e6).shape == ()
    assert solve_largest_spot(law, []).shape == (0,)
    state = evaluate_at_pressure(law, pressure)
    assert {np.shape(value) for value in state.values()} == {(3, 1, 4)}


@each_law
def test_more_points_than_a_block(law):
    pressure = np.geomspace(1.0, 1e9, 20000).reshape(200, 100)
    u = solve_largest_spot(law, pressure)
    assert u.shape == pressure.shape
    assert np.all(np.diff(u.ravel()) > 0)
    load = law.spot_distribution().sum_over_spots("load", u)
    assert load == pytest.approx(pressure * law.A_0, rel=RESIDUAL)


# One parameter of every group that the load depends on, over the decades of its use.
ARRAYS = {
    "zhao": {"surface.G": (1e-11, 1e-7), "H": (1e8, 1e10), "side1.E": (1e10, 1e12), "A_0": (1e-6, 1.0)},
    "hu": {
        "surface.G": (1e-9, 1e-6),
        "surface.s_min": (1e-20, 1e-12),
        "surface.r_m": (1e-6, 1e-4),
        "A_0": (1e-6, 1.0),
    },
    "yu": {
        "surface1.G": (1e-11, 1e-8),
        "e": (0.01, 0.95),
        "lambda": (0.01, 1.0),
        "sigma_y": (1e8, 1e9),
        "A_0": (1e-6, 1.0),
    },
}
array_cases = pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind in ARRAYS for name in ARRAYS[kind]]
)


@array_cases
def test_array_parameters(kind, name):
    values = np.geomspace(*ARRAYS[kind][name], 7)
    pressure = np.geomspace(1e3, 1e8, 5)[:, None]
    batch = evaluate_at_pressure(changed(LAWS[kind], {name: values}), pressure)
    for i, value in enumerate(values):
        single = evaluate_at_pressure(changed(LAWS[kind], {name: float(value)}), pressure[:, 0])
        for symbol in ("F", "K_N", "A_r"):
            # two solutions within the residual, and growth exponents of at most 2.5
            assert np.broadcast_to(batch[symbol], (5, 7))[:, i] == pytest.approx(
                single[symbol], rel=5 * RESIDUAL, abs=1e-300
            ), symbol


@array_cases
def test_array_parameters_with_one_pressure(kind, name):
    values = np.geomspace(*ARRAYS[kind][name], 7)
    law = changed(LAWS[kind], {name: values})
    u = solve_largest_spot(law, 1e6)
    assert u.shape == (7,)
    load = law.spot_distribution().sum_over_spots("load", u)
    assert load == pytest.approx(1e6 * law.A_0 * np.ones(7), rel=RESIDUAL)


@array_cases
def test_array_parameters_with_more_points_than_a_block(kind, name):
    n = 20000
    law = changed(LAWS[kind], {name: np.geomspace(*ARRAYS[kind][name], n)})
    pressure = np.full(n, 1e6)
    assert load(law, pressure) == pytest.approx(pressure * law.A_0, rel=RESIDUAL)


def test_replace_takes_arrays():
    G, A_0 = np.geomspace(1e-10, 1e-8, 4), np.geomspace(1e-3, 1.0, 4)
    law = replace(ZHAO, surface=replace(ZHAO.surface, G=G), A_0=A_0)
    state = evaluate_at_pressure(law, 1e6)
    assert state["F"] == pytest.approx(1e6 * A_0, rel=RESIDUAL)
    assert state["K_N"].shape == (4,)


@each_law
def test_zero_pressure(law):
    state = evaluate_at_pressure(law, np.array([0.0, 1e6]))
    for symbol in ("F", "K_N", "A_r", "pressure"):
        assert state[symbol][0] == 0.0, symbol
        assert state[symbol][1] > 0.0, symbol
    assert state["largest_spot"][0] == 0.0


@each_law
def test_largest_spot_at_zero_pressure(law):
    assert solve_largest_spot(law, 0.0) == -np.inf
    assert np.all(np.isfinite(solve_largest_spot(law, [1e-60, 1.0])))


@each_law
@pytest.mark.parametrize(
    ("pressure", "text"),
    [
        (-1.5, "pressure = -1.5 Pa"),
        (np.nan, "pressure = nan Pa"),
        (np.inf, "pressure = inf Pa"),
        ([[1.0, -2e6]], "-2e+06"),
    ],
)
def test_impossible_pressures_are_refused(law, pressure, text):
    with pytest.raises(ValueError, match=r"is outside \[0, inf\)") as error:
        evaluate_at_pressure(law, pressure)
    assert text in str(error.value)
    assert "\n" not in str(error.value)


@each_law
@pytest.mark.parametrize("area", [0.0, -1e-12, np.nan, np.inf])
def test_impossible_spots_are_refused(law, area):
    with pytest.raises(ValueError, match=rf"largest spot = {area:g} m2 is outside \("):
        evaluate_at_largest_spot(law, area)


@pytest.mark.parametrize(
    ("law", "values"),
    [
        (ZHAO, {"surface.D": 1.001}),
        (YU, {"surface1.D": 1.001, "surface2.D": 1.001}),
        (load_default("bolted_joint", "roughness").values, {"longest_wave": 1e300}),
    ],
    ids=["zhao", "yu", "roughness"],
)
def test_dimensions_without_a_representable_area_are_refused(law, values):
    # the critical area ~ G^2 (E/H)^(2/(D - 1)) is some 1e1000 m2
    text = r"^the critical spot area, .* m2, or a contact load is too small or too large [^\n]*$"
    with pytest.raises(ValueError, match=text):
        solve_largest_spot(changed(law, values), 1e6)


def test_spots_below_the_smallest_stiff_one():
    """Such spots carry load (Eq. 23 from 0) and have no stiffness (Eqs. 30, 41 from s_min)."""
    state = evaluate_at_largest_spot(HU, [0.1 * HU.surface.s_min, 10.0 * HU.surface.s_min])
    assert np.all(state["F"] > 0.0)
    assert (state["K_N"][0], state["K_T"][0]) == (0.0, 0.0)
    assert state["K_N"][1] > 0.0


@each_kind
@given(data=st.data())
def test_round_trip(kind, data):
    law = data.draw(RANDOM[kind])
    spots = law.spot_distribution()
    u = data.draw(st.floats(-20.0, 20.0))
    area = spots.reference_area * np.exp(u)
    there = evaluate_at_largest_spot(law, area)
    back = evaluate_at_pressure(law, there["pressure"])
    # the residual divided by the smallest slope d ln F/du = m (0.06 for Yu at e = 0.95), and eps ln(a)
    assert back["largest_spot"] == pytest.approx(area, rel=RESIDUAL / spots.size_exponent + 100 * EPS)
    assert there["largest_spot"] == pytest.approx(area, rel=100 * EPS)
    assert back["F"] == pytest.approx(there["F"], rel=RESIDUAL)
    assert there["pressure"] == there["F"] / law.A_0


@pytest.mark.slow
@each_kind
@given(data=st.data())
def test_everything_grows_with_the_pressure(kind, data):
    law = data.draw(RANDOM[kind])
    pressure = np.geomspace(1e-3, 1e11, 400)
    state = evaluate_at_pressure(law, pressure)
    u = solve_largest_spot(law, pressure)
    assert np.all(np.diff(u) > 0)
    assert np.all(np.diff(state["F"]) > 0)
    assert np.all(np.diff(state["A_r"]) > 0)
    K = state["K_N"]
    assert np.all(np.diff(K) >= 0)
    assert np.all(np.diff(K[K > 0]) > 0)


@each_law
def test_no_jump_across_the_regimes(law):
    """A single spot may jump at a regime bound of the fits, the sum over all spots may not."""
    s = law.spot_distribution()
    ends = {
        end
        for term in (*s.regime_terms["load"], *s.regime_terms["normal"])
        for end in (term.lower_log_area, term.upper_log_area)
    }
    edges = np.array([end for end in ends if end is not None])
    assert edges.size
    h = 1e-9
    for name in ("load", "normal", "area"):
        below, above = s.sum_over_spots(name, edges - h), s.sum_over_spots(name, edges + h)
        # the slope d ln/du is at most 2.5, where there is something to jump
        assert np.all(above - below <= 5 * h * np.maximum(above, s.sum_over_spots(name, edges + 1.0)))
        assert np.all(above >= below)


SCALES = {"Pa": "stress", "m": "length", "m2": "area", "kg": "mass", "1": "one"}
UNITS = {
    "F": "force", "K_N": "stiffness", "K_T": "stiffness", "A_r": "area", "W_NP": "energy", "W_NE": "energy",
    "eta_n": "one", "C_N": "damping", "W_d": "energy", "W": "energy", "W_e": "energy", "eta_t": "one",
    "C_T": "damping", "elastic_fraction": "one", "largest_spot": "area", "pressure": "stress",
}  # fmt: skip


@pytest.mark.slow
@each_kind
@given(data=st.data(), stress=decades(1e-3, 1e3), length=decades(1e-3, 1e3), mass=decades(1e-3, 1e3))
def test_dimensional_homogeneity(kind, data, stress, length, mass):
    """The results do not depend on the units of stress, length and mass."""
    law = data.draw(RANDOM[kind])
    factor = {
        "one": 1.0,
        "stress": stress,
        "length": length,
        "area": length**2,
        "mass": mass,
        "force": stress * length**2,
        "stiffness": stress * length,
        "energy": stress * length**3,
        "damping": np.sqrt(mass * stress * length),
    }
    units = {name: item.metadata.get("unit") for name, item in flatten_fields(type(law))}
    scaled = {
        name: value * factor[SCALES[units[name]]] if units[name] else value
        for name, value in flatten_parameters(law).items()
    }
    u = np.array([-20.0, -5.0, -0.5, 0.5, 3.0, 8.0, 20.0])
    pressure = law.spot_distribution().sum_over_spots("load", u) / law.A_0
    before = evaluate_at_pressure(law, pressure)
    after = evaluate_at_pressure(changed(law, scaled), pressure * stress)
    assert before.keys() <= UNITS.keys()
    for symbol, value in before.items():
        expected = value * factor[UNITS[symbol]]
        finite = np.isfinite(expected)  # eta_n without an elastic spot
        assert np.all(after[symbol][~finite] == expected[~finite])
        # residual 1e-12 over the smallest slope d ln F/du = m = 0.15, eps/(D - 1) in the critical area, and
        # the stiffness of a law that has just become stiff, a difference: 1e-10 of its later values
        assert after[symbol][finite] == pytest.approx(
            expected[finite], rel=1e-9, abs=1e-10 * np.max(expected[finite], initial=0.0)
        ), symbol


@pytest.mark.parametrize("spot_stiffness", ["family", "hertz"])
@pytest.mark.parametrize("D", [1.1, 1.2, 1.3, 1.4, 1.6, 1.7, 1.9])
def test_growth_of_the_elastic_limit(D, spot_stiffness):
    """K ~ F^(D/(3 - D)) for D < 1.5 and K ~ F above, if the largest spots are far inside the
    elastic regime."""
    law = changed(ZHAO, {"surface.D": D, "spot_stiffness": spot_stiffness})
    pressure = law.spot_distribution().sum_over_spots("load", 290.0) / law.A_0
    k, slope = stiffness_curve(law, pressure)
    exponent = D / (3 - D) if D < 1.5 else 1.0
    # what remains of the smaller spots: exp(-(D - 1)/2 290) and exp(-|3 - 2 D|/2 290), and round-off
    remains = np.exp(-290 * min(D - 1, abs(3 - 2 * D)) / 2)
    assert slope * pressure / k == pytest.approx(exponent, rel=max(3 * remains, 1e-11))


@each_law
@pytest.mark.parametrize("name", ["normal", "area"])
def test_slope_of_the_stiffness_curve(law, name):
    s = law.spot_distribution()
    # away from the edges of the regimes, where the slope jumps; stiff for every law
    u = np.array([0.5, 1.7, 4.1, 9.3, 13.7]) + (5.0 if law is HU else 0.0)
    pressure = s.sum_over_spots("load", u) / law.A_0
    h = 1e-4
    up, down = (stiffness_curve(law, pressure * np.exp(sign * h), name)[0] for sign in (1, -1))
    k, slope = stiffness_curve(law, pressure, name)
    finite = (up - down) / (2 * np.sinh(h) * pressure)
    # residual 1e-12/h = 1e-8, truncation h^2 = 1e-8 times the third derivative of the logarithms, up to 30
    assert slope == pytest.approx(finite, rel=3e-7)
    assert k == pytest.approx(s.sum_over_spots(name, u) / law.A_0, rel=10 * RESIDUAL)
    assert np.all(slope > 0)


@pytest.fixture
def casadi_numpy():
    """Patch numpy's functions to build casadi expressions, in this test only."""
    before = casadi.GlobalOptions.getNumpyMode()
    casadi.GlobalOptions.setNumpyMode(1)
    yield
    casadi.GlobalOptions.setNumpyMode(before)


def symbolic(law, prefix=""):
    """Copy of a law with a symbol for every number, without checks; and {name: (symbol, value)}."""
    clone, symbols = object.__new__(type(law)), {}
    for item in fields(law):
        value = getattr(law, item.name)
        if is_dataclass(value):
            value, inner = symbolic(value, f"{prefix}{item.name}.")
            symbols |= inner
        elif isinstance(value, float):
            symbol = casadi.SX.sym(prefix + item.name)
            symbols[prefix + item.name] = symbol, value
            value = symbol
        object.__setattr__(clone, item.name, value)
    return clone, symbols


VARIANTS = {
    "zhao": (ZHAO, {}),
    "zhao, printed, hertz": (ZHAO, {"critical_area": "printed", "spot_stiffness": "hertz"}),
    "zhao, yield": (ZHAO, {"critical_area": "yield"}),
    "hu": (HU, {}),
    "yu": (YU, {}),
    "yu, two bodies": (YU, {"rigid_flat": False, "plastic_area": "kogut_etsion", "surface2.D": 1.62}),
}


@pytest.mark.usefixtures("casadi_numpy")
@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", ["load", "normal", "area"])
def test_laws_take_symbols(variant, name):
    """The laws have no branch on a value and write nothing in place, so one expression holds for
    all values."""
    law = changed(*VARIANTS[variant])
    clone, symbols = symbolic(law)
    u = casadi.SX.sym("u")
    total = clone.spot_distribution().sum_over_spots(name, u)
    function = casadi.Function("total", [u, *(symbol for symbol, _ in symbols.values())], [total])
    values = [value for _, value in symbols.values()]
    s = law.spot_distribution()
    for point in (-12.0, -3.0, -0.4, 0.3, 2.5, 9.0, 15.0, 40.0):
        # two libraries' exp and log, and their order of operations: eps times logarithms of 50 and 1/(D - 1)
        assert float(function(point, *values)) == pytest.approx(s.sum_over_spots(name, point), rel=1e-12)


@pytest.mark.usefixtures("casadi_numpy")
@pytest.mark.parametrize("kind", LAWS)
def test_derivatives_with_respect_to_parameters(kind):
    """The derivative of the expression is the derivative of the law: no parameter is hidden in a constant."""
    law = LAWS[kind]
    clone, symbols = symbolic(law)
    u = 3.0 + (10.0 if law is HU else 0.0)
    reference = law.spot_distribution().reference_area
    for name in ("surface.gamma", "side1.E", "side1.nu"):
        symbol, value = symbols[name]
        # at one largest spot, not at one ratio to a reference area that moves with the parameter
        area = reference * np.exp(u)
        spots = clone.spot_distribution()
        total = spots.sum_over_spots("load", np.log(area / spots.reference_area))
        inputs = [s for s, _ in symbols.values()]
        slope = casadi.Function("slope", inputs, [casadi.gradient(total, symbol)])
        exact = float(slope(*(v for _, v in symbols.values())))
        h = 1e-5
        up, down = (
            evaluate_at_largest_spot(changed(law, {name: value * (1 + sign * h)}), area)["F"]
            for sign in (1, -1)
        )
        # round-off eps/h = 2e-11 over a relative sensitivity of order 0.01 to 1, truncation h^2 times 100
        assert exact * value == pytest.approx((up - down) / (2 * h), rel=1e-6)
