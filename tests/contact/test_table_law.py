"""Interface law `table`: points of the stiffness over the pressure."""

import re

import numpy as np
import pytest
from jointfmu_fmu_src.native.data import split_parameters
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from jointfmu.contact.interface import evaluate_at_pressure, find_validity_violations, stiffness_curve
from jointfmu.contact.laws import roughness
from jointfmu.contact.laws.table import MAX_TABLE_POINTS, StiffnessTable, TableLaw, loss_factor
from jointfmu.joints import MODELS
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.parameters import load_default

EPS = np.finfo(float).eps
ROUGH = load_default("bolted_joint", "roughness").values


def law_of(pressure, stiffness, **more):
    table = StiffnessTable(
        pressure=tuple(map(float, pressure)), stiffness=tuple(map(float, stiffness)), ratio=0.7, **more
    )
    return TableLaw(table=table, mu=0.15, traction_ratio=0.1, A_0=1e-3)


def random_points(seed, count=7):
    """Points that rise irregularly, one of the steps flat."""
    random = np.random.default_rng(seed)
    steps, exponents = random.uniform(0.1, 2.0, count - 1), random.uniform(0.0, 1.5, count - 1)
    exponents[seed % (count - 1)] = 0.0
    return (a * np.exp(np.cumsum([0.0, *x])) for a, x in ((1e5, steps), (1e12, steps * exponents)))


@pytest.mark.parametrize("exponent", [0.0, 1.0 / 3.0, 0.5, 1.0])
@pytest.mark.parametrize("count", [2, 6])
def test_points_of_a_power_law_give_this_power_law(exponent, count):
    def stiffness(p):
        return 4e12 * (p / 1e6) ** exponent

    def approach(p):
        return np.log(p / 1e5) * 1e6 / 4e12 if exponent == 1.0 else p / stiffness(p) / (1.0 - exponent)

    points = np.geomspace(2e5, 3e7, count) * (1.0 + 0.1 * np.sin(np.arange(count)))
    law, p = law_of(points, stiffness(points)), np.geomspace(1e3, points[-1], 9)
    np.testing.assert_allclose(evaluate_at_pressure(law, p)["K_N"] / law.A_0, stiffness(p), rtol=64 * EPS)
    curve = tabulate_approach(law)
    delta = curve.inverse(p)
    np.testing.assert_allclose(
        np.diff(delta), np.diff(approach(p)), rtol=1e-8
    )  # MAX_INTERPOLATION_ERROR of a curve
    np.testing.assert_allclose(curve.derivatives(delta, 1)[1], stiffness(p), rtol=1e-8)
    if exponent < 1.0:  # from first contact; the closing is short
        assert delta[4] - curve.displacement[0] == pytest.approx(approach(p[4]), rel=5e-3)


@pytest.mark.parametrize(("count", "error"), [(3, 0.02), (5, 5e-3), (9, 1.3e-3), (17, 4e-4)])
def test_points_of_the_law_roughness_give_its_force_stiffness_and_approach(count, error):
    """A table over four decades of pressure has the errors that docs/models.md states."""
    points = np.geomspace(1e4, 1e8, count)
    law = law_of(points, evaluate_at_pressure(ROUGH, points)["K_N"] / ROUGH.A_0)
    p = np.geomspace(1e4, 1e8, 301)
    known = evaluate_at_pressure(ROUGH, p)
    np.testing.assert_allclose(stiffness_curve(law, p)[0], known["K_N"] / ROUGH.A_0, rtol=error)
    delta = tabulate_approach(law).inverse(p)
    np.testing.assert_allclose(np.diff(delta), np.diff(known["approach"]), rtol=error)
    back = tabulate_approach(law).derivatives(delta[0] + known["approach"] - known["approach"][0], 0)[0]
    np.testing.assert_allclose(back[1:], p[1:], rtol=10.0 * error)  # an exponential of the approach


@pytest.mark.parametrize("seed", range(6))
def test_the_stiffness_is_monotone_and_passes_the_points(seed):
    points, K = random_points(seed)
    law, p = law_of(points, K, factor=1.3), np.geomspace(1e3, 1.1 * points[-1], 400)
    np.testing.assert_allclose(stiffness_curve(law, points)[0], 1.3 * K, rtol=64 * EPS)
    k, slope = stiffness_curve(law, p)
    assert np.all(np.diff(k) >= -1e-14 * k[1:])
    assert np.all(slope >= -1e-12 * np.max(slope))
    step = 1e-5
    ends = [stiffness_curve(law, p * (1.0 + sign * step))[0] for sign in (-1.0, 1.0)]
    inside = np.min(np.abs(np.log(p[:, None] / points)), axis=1) > 2.0 * step
    np.testing.assert_allclose(
        slope[inside], ((ends[1] - ends[0]) / (2.0 * step * p))[inside], rtol=1e-6, atol=1e-6 * np.max(slope)
    )
    inner = PchipInterpolator(np.log(points), np.log(K)).derivative()(np.log(points[1:-1]))
    np.testing.assert_allclose(
        stiffness_curve(law, points[1:-1])[1] * points[1:-1] / 1.3 / K[1:-1], inner, rtol=1e-12, atol=1e-12
    )


@pytest.mark.parametrize("seed", range(3))
def test_stiffness_and_force_are_derivatives_of_the_energy(seed):
    curve = tabulate_approach(law_of(*random_points(seed)))
    ends = np.append(curve.displacement, 1.2 * curve.displacement[-1])  # beyond the last point, too
    node, weight = np.polynomial.legendre.leggauss(4)  # exact for the polynomials of the segments
    half = 0.5 * np.diff(ends)[:, None]
    load, stiffness = curve.derivatives(ends[:-1, None] + half * (1.0 + node), 1)
    np.testing.assert_allclose(np.diff(curve.energy(ends)), (half * load) @ weight, rtol=1e-9)
    rise = np.diff(curve.derivatives(ends, 0)[0])
    np.testing.assert_allclose(rise, (half * stiffness) @ weight, rtol=1e-9)


def test_continuations_and_their_warnings():
    law = law_of([1e6, 2e6, 4e6], [1e12, 4e12, 8e12])  # exponents 2 and 1
    p = np.array([1e5, 1e6, 4e6, 4e7])
    k, slope = stiffness_curve(law, p)
    np.testing.assert_allclose(k, [1e11, 1e12, 8e12, 8e12], rtol=64 * EPS)  # n = 1 at most below
    assert slope[-1] == pytest.approx(0.0, abs=1e-12 * slope[1])
    assert find_validity_violations(law, 3e6, 1.5e6) == []
    below, above = find_validity_violations(law, 5e6, 5e5)
    assert "a pressure of 5e+05 Pa is below the first point of the law table, 1e+06 Pa" in below
    assert "a pressure of 5e+06 Pa is above the last point of the law table, 4e+06 Pa" in above
    assert np.isnan(evaluate_at_pressure(law, 1e6)["A_r"])


@pytest.mark.parametrize(
    ("pressure", "stiffness", "message"),
    [
        (
            [1e6],
            [1e12],
            "table.pressure has 1 numbers and table.stiffness 1; expected the same number, from 2",
        ),
        ([1e6, 2e6], [1e12], "table.pressure has 2 numbers and table.stiffness 1"),
        ([1e6, 1e6], [1e12, 2e12], "table.pressure[1] = 1e+06 Pa follows 1e+06 Pa; expected increasing"),
        ([2e6, 1e6], [1e12, 2e12], "table.pressure[1] = 1e+06 Pa follows 2e+06 Pa; expected increasing"),
        ([1e6, 2e6], [2e12, 1e12], "table.stiffness[1] = 1e+12 Pa/m is below the one before it, 2e+12 Pa/m"),
        ([1e6, 2e6], [1e12, 64e12], "rises from 1e+12 Pa/m with power 6 of the pressure, allowed is up to 5"),
        ([1e6, 2e6], [-2e12, 1e12], "stiffness[0] = -2e+12 Pa/m is outside (0, inf)"),
        ([0.0, 2e6], [1e12, 2e12], "pressure[0] = 0 Pa is outside (0, inf)"),
        (np.geomspace(1e5, 1e6, MAX_TABLE_POINTS + 1), [1e12] * (MAX_TABLE_POINTS + 1), "from 2 to 32"),
    ],
)
def test_wrong_points_are_refused_in_one_line(pressure, stiffness, message):
    with pytest.raises(ValueError, match=re.escape(message)) as refused:
        law_of(pressure, stiffness)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("exponent", [0.0, 1.0 / 3.0, 0.7, 1.0])
@pytest.mark.parametrize("x", [1e-9, 1e-3, 0.1, 0.5, 0.95])
def test_loss_factor_is_that_of_masings_loop(exponent, x):
    """The loss factor is that of a Masing loop whose first loading has a stiffness ~ (1 - t)^n."""
    if exponent == 1.0:
        assert loss_factor(x, 1.0) == pytest.approx(roughness.loss_factor(x), rel=1e-12, abs=1e-16)
    if x < 1e-6:
        assert loss_factor(x, exponent) == pytest.approx(
            2.0 * exponent * x / (3.0 * np.pi), rel=1e-8, abs=1e-16
        )
        return

    def shift(t):
        return quad(lambda s: (1.0 - s) ** -exponent, 0.0, t, epsrel=1e-13)[0]

    area = 4.0 * x * shift(x) - 8.0 * quad(shift, 0.0, x, epsrel=1e-13)[0]
    assert loss_factor(x, exponent) == pytest.approx(area / (np.pi * x * shift(x)), rel=1e-6, abs=1e-9)


def test_all_tables_share_the_compiled_code_of_an_fmu():
    file = load_default("gear_contact", "table")
    model = MODELS["GearContact"].with_parameters("gear_contact", file.values)
    splits = []
    for count in (2, MAX_TABLE_POINTS):
        points = np.geomspace(1e5, 1e7, count)
        values = {"table.pressure": tuple(points.tolist()), "table.stiffness": tuple((1e6 * points).tolist())}
        splits.append(split_parameters(model, file.with_values(values, "user", "test")))
    assert splits[0].code_structure_key == splits[1].code_structure_key
    assert splits[0].data_struct_values != splits[1].data_struct_values
    assert "table.factor" in splits[0].variable_names
