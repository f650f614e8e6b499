"""The law `roughness` against its formulas, quadrature and an independent solution of Persson's equation."""

import numpy as np
import pytest
from jointfmu_tools.cli import main
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.special import erf
from scipy.stats import norm

from jointfmu.contact.interface import evaluate_at_largest_spot, evaluate_at_pressure
from jointfmu.contact.laws import persson, roughness
from jointfmu.contact.laws.roughness import FEW_SPOTS_STIFFNESS_FACTOR, RoughnessLaw
from jointfmu.contact.surface import ElasticConstants
from jointfmu.joints import KINDS
from jointfmu.mechanics.curve import MAX_INTERPOLATION_ERROR, tabulate_approach
from jointfmu.parameters import load_default

STEEL = ElasticConstants(E=2.1e11, nu=0.3)
GROUND = RoughnessLaw(
    h=1.5e-6,
    gamma=0.45,
    longest_wave=1e-3,
    hurst=0.8,
    slope=0.1,
    side1=STEEL,
    side2=STEEL,
    H=2e9,
    mu=0.15,
    traction_ratio=0.3,
    A_0=1e-3,
)
MODULUS = 2.1e11 / (2.0 * (1.0 - 0.3**2))
WITH_ROUGHNESS = [name for name, kind in KINDS.items() if "roughness" in kind.laws]


def changed(**values):
    return RoughnessLaw(**{**{k: getattr(GROUND, k) for k in GROUND.__dataclass_fields__}, **values})


def test_many_spots_have_the_pressure_over_gamma_h():
    wide = changed(A_0=10.0)  # a load far beyond that of few spots
    p = np.array([1e6, 1e7, 1e8])
    state = evaluate_at_pressure(wide, p)
    few = FEW_SPOTS_STIFFNESS_FACTOR * (p * 10.0 / (MODULUS * 1.5e-6 * 1e-3)) ** (-0.8 / 1.8)
    assert np.max(few) < 1e-2  # of 1/gamma = 2.2
    assert state["K_N"] / 10.0 == pytest.approx(p / 1.5e-6 * (1.0 / 0.45 + few), rel=1e-13)
    assert state["F"] == pytest.approx(10.0 * p, rel=1e-13)


def test_few_spots_have_their_own_exponent():
    p = np.geomspace(1e-3, 1e-2, 3)
    K = evaluate_at_pressure(GROUND, p)["K_N"]
    exponents = np.diff(np.log(K)) / np.diff(np.log(p))
    assert exponents == pytest.approx(1.0 / 1.8, abs=0.01)
    # the modulus counts only there
    soft = changed(side1=ElasticConstants(E=2.1e10, nu=0.3), side2=ElasticConstants(E=2.1e10, nu=0.3))
    assert np.all(evaluate_at_pressure(soft, p)["K_N"] < 0.5 * K)
    assert evaluate_at_pressure(soft, 1e9)["K_N"] == pytest.approx(
        evaluate_at_pressure(GROUND, 1e9)["K_N"], rel=0.01
    )


def test_tangential_stiffness_is_mindlins():
    state = evaluate_at_pressure(GROUND, 1e6)
    assert state["K_T"] / state["K_N"] == pytest.approx(2.0 * 0.7 / 1.7, rel=1e-13)
    assert state["friction_limit"] == pytest.approx(0.15 * state["F"], rel=1e-13)
    assert state["slip_length"] == pytest.approx(0.15 * 0.45 * 1.5e-6 * 1.7 / 1.4, rel=1e-13)


@pytest.mark.parametrize("x", [1e-8, 1e-3, 0.0099, 0.0101, 0.3, 0.9, 0.999])
def test_loss_factor_is_that_of_masings_loop(x):
    """The loss factor agrees with quadrature of a Masing loop of the first loading T = 1 - exp(-s)."""
    if x < 1e-4:
        assert roughness.loss_factor(x) == pytest.approx(2.0 * x / (3.0 * np.pi), rel=1e-7)
        return
    end = -np.log1p(-x)

    def branch(s):  # down from the end
        return x - 2.0 * -np.expm1(-0.5 * (end - s))

    # W = the loop's area: twice the area between the falling branch and its mirror image
    work = -2.0 * quad(branch, -end, end, epsabs=1e-16, epsrel=1e-12)[0]
    expected = work / (2.0 * np.pi * 0.5 * x * end)
    assert roughness.loss_factor(x) == pytest.approx(expected, rel=max(2e-10, 1e-14 / x**2))


def test_loss_factor_vanishes_without_shear():
    assert roughness.loss_factor(0.0) == 0.0


@pytest.mark.parametrize("p", [1e2, 1e5, 1e7])
def test_approach_is_the_integral_of_the_compliance(p):
    def compliance(log):
        return np.exp(log) * GROUND.A_0 / evaluate_at_pressure(GROUND, np.exp(log))["K_N"]

    integral = quad(compliance, np.log(p) - 60.0, np.log(p), epsrel=1e-11, limit=400)[0]
    assert roughness.approach(GROUND, p) == pytest.approx(integral, rel=1e-9)
    curve = tabulate_approach(GROUND)
    from_touch = float(curve.inverse(p) - curve.displacement[0])
    # the table closes the contact its own way below a millionth of one hill's load
    assert from_touch == pytest.approx(integral, abs=0.03 * GROUND.h)


# Real area


def diffused(x, t, walls=200):
    """Elastic share of the area and load by Persson's diffusion equation, solved on a grid between both
    boundaries."""
    step = 1.0 / walls
    grid = (np.arange(walls - 1) + 1) * step
    laplace = (
        np.diag(np.ones(walls - 2), 1) + np.diag(np.ones(walls - 2), -1) - 2.0 * np.eye(walls - 1)
    ) / step**2
    start = np.maximum(1.0 - np.abs(grid - x) / step, 0.0)
    after = expm(0.5 * t * laplace) @ start
    return float(after.sum()), float(after @ grid)


@pytest.mark.parametrize("x", [0.01, 0.2, 0.7])
@pytest.mark.parametrize("t", [0.01, 0.199, 0.201, 1.0])
def test_the_real_area_is_perssons_with_a_wall_at_the_hardness(x, t):
    elastic, plastic = persson.elastic_and_plastic_area_shares(x * 2e9, 2e9, np.sqrt(t) * 2e9)
    share, load = diffused(x, t)
    assert elastic == pytest.approx(share, abs=1e-4)  # of the grid
    assert plastic == pytest.approx(x - load, abs=1e-4)


def test_series_and_images_meet():
    both = [
        persson._image_source_series(np.array([0.03, 0.5]), 0.2),
        persson._diffusion_mode_series(np.array([0.03, 0.5]), 0.2),
    ]
    assert np.array(both[0]) == pytest.approx(np.array(both[1]), rel=1e-9)


def test_without_yield_the_area_is_an_error_function():
    p = np.array([1e5, 1e7, 1e8])
    hard = changed(H=1e13)
    expected = erf(np.sqrt(2.0) * p / (MODULUS * 0.1))
    assert evaluate_at_pressure(hard, p)["A_r"] / GROUND.A_0 == pytest.approx(expected, rel=1e-6)
    steep = changed(slope=10.0)
    assert evaluate_at_pressure(steep, p)["A_r"] / GROUND.A_0 == pytest.approx(p / 2e9, rel=1e-9)


def test_the_first_loading_is_softer_where_spots_flow():
    p = np.geomspace(1e5, 1e9, 9)
    flowing, hard = evaluate_at_pressure(changed(slope=10.0), p), evaluate_at_pressure(changed(H=1e13), p)
    z = norm.isf(p / 2e9)
    series = 1.0 / flowing["K_N"] + GROUND.h * norm.sf(z) / norm.pdf(z) / flowing["F"]
    assert flowing["K_loading"] == pytest.approx(1.0 / series, rel=1e-9)
    assert hard["K_loading"] == pytest.approx(hard["K_N"], rel=1e-6)


# In the machinery


def test_the_law_roughness_has_no_largest_spot(capsys):
    assert np.isnan(evaluate_at_pressure(GROUND, 1e6)["largest_spot"])
    with pytest.raises(ValueError, match="has no largest spot with an area; state a pressure"):
        evaluate_at_largest_spot(GROUND, 1e-9)
    assert main(["law", "roughness", "--largest-spot", "1e-9"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("joint", WITH_ROUGHNESS)
def test_default_files_have_the_law(joint):
    file = load_default(joint, "roughness")
    assert file.law == "roughness"
    assert file.joint == joint


@pytest.mark.parametrize("hurst", [0.05, 0.5, 0.95])
@pytest.mark.parametrize("longest_wave", [1e-5, 3e-2])
def test_the_curve_is_monotone_and_closes(hurst, longest_wave):
    curve = tabulate_approach(changed(hurst=hurst, longest_wave=longest_wave))
    assert curve.interpolation_error <= MAX_INTERPOLATION_ERROR
    assert np.all(np.diff(curve.load) > 0.0)
    assert curve.load[0] == 0.0
    x = np.linspace(curve.displacement[0], 0.0, 2000)
    load, stiffness = curve.derivatives(x)
    assert np.all(load >= 0.0)
    assert np.all(np.diff(stiffness) >= -1e-12 * stiffness[-1])
