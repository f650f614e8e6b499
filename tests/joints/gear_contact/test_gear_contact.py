"""Gear contact: approach as a function of the force by the law of Yu 2022, its FMU, and from a drawing."""

import json
import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from conftest import refused_line
from joint_cases import SAME, STATE, TABLE, parameters
from jointfmu_tools import cli
from natives import Host, close, jacobian
from scipy.integrate import quad

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.gear_contact.spring import GearContactParameters, GearContactSpring
from jointfmu.mechanics.curve import CLOSING_END_OVER_PLASTIC_SPOT_AREA, MAX_INTERPOLATION_ERROR
from jointfmu.parameters import load_default, load_parameter_file
from jointfmu.quantity import build_parameter_set, flatten_parameters

EPS = np.finfo(float).eps
STENCIL = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""Central difference with five points; its error is h^4/30 times the fifth derivative."""
FIVE = np.arange(-2, 3)

CONTACT = load_default("gear_contact").values


def changed(**values):
    return build_parameter_set(GearContactParameters, flatten_parameters(CONTACT) | values)


SETS = {
    "default": CONTACT,
    "two-D": changed(**{"surface1.D": 1.56, "surface2.D": 1.4, "surface1.G": 1e-11}),
    "slender": changed(**{"e": 0.7, "lambda": 0.3, "A_0": 2e-5, "surface1.G": 1e-11, "surface2.G": 1e-11}),
    "two-bodies": changed(rigid_flat=False, plastic_area="kogut_etsion", sigma_y=6e8),
}
SPRINGS = {name: GearContactSpring.tabulate(contact) for name, contact in SETS.items()}
each = pytest.mark.parametrize("spring", SPRINGS.values(), ids=SPRINGS)


def closing_end(spring):
    """Force [N] and approach from first contact [m] at the end of the closing."""
    i = int(np.searchsorted(spring.curve.displacement, 0.0))
    return spring.joint.A_0 * float(spring.curve.load[i]), -float(spring.curve.displacement[0])


@each
def test_approach_is_the_integral_of_df_over_K(spring):
    """The approach agrees with adaptive quadrature of df/K_N of the law, from the end of the closing on."""
    A_0 = spring.joint.A_0
    first, s = closing_end(spring)
    assert float(spring.evaluate(first)["s_rel"]) == pytest.approx(s, rel=1e-12)  # round-off of the inverse

    def per_log(t):
        f = np.exp(t)
        return f / float(evaluate_at_pressure(spring.joint, f / A_0)["K_N"])

    spots = spring.joint.spot_distribution()
    breaks = [
        float(spots.sum_over_spots("load", u))
        for u in spots.sorted_regime_end_log_areas
        if u > spots.stiffness_onset_log_area
    ]
    for low, high in pairwise(np.geomspace(first, 0.99 * spring.max_force, 5)):
        ends = np.log([low, *(b for b in breaks if low < b < high), high])
        s += sum(quad(per_log, a, b, epsabs=0.0, epsrel=1e-10)[0] for a, b in pairwise(ends))
        out = spring.evaluate(high)
        assert float(out["s_rel"]) == pytest.approx(s, rel=MAX_INTERPOLATION_ERROR)
        assert float(out["K_N"]) == pytest.approx(
            float(evaluate_at_pressure(spring.joint, high / A_0)["K_N"]), rel=MAX_INTERPOLATION_ERROR
        )


@each
def test_stiffness_is_the_slope_of_the_force(spring):
    """1/K_N agrees with differences ds/df of the outputs, from first contact to beyond the table."""
    f = np.geomspace(1e-6, 3.0, 60) * spring.max_force
    h = 1e-3 * f
    slope = STENCIL @ spring.evaluate(f + h * FIVE[:, None])["s_rel"] / h
    out = spring.evaluate(f)
    # truncation (h/f)^4; nodes of the table inside a step, where the third derivative jumps by
    # interpolation errors; round-off 10 eps s/h
    noise = 10.0 * EPS * out["s_rel"] / h * out["K_N"]
    end = np.abs(f / spring.max_force - 1.0) < 3e-3  # the tangent begins inside the difference
    assert np.all(np.abs(slope * out["K_N"] - 1.0)[~end] <= 1e-7 + noise[~end])


@each
def test_everything_grows_with_the_force(spring):
    out = spring.evaluate(np.geomspace(1e-9, 0.999, 200) * spring.max_force)
    for name in ("s_rel", "K_N", "A_r", "elastic_fraction"):
        assert np.all(np.diff(out[name]) >= 0.0), name
        assert np.all(out[name] >= 0.0)
    assert np.all(np.diff(out["s_rel"]) > 0.0)
    assert np.all(np.diff(out["A_r"]) > 0.0)
    assert np.all(out["elastic_fraction"] < 1.0)


@each
def test_no_load_and_pull(spring):
    """At zero load the flanks just touch; a tensile force separates them."""
    out = spring.evaluate([0.0, -0.0, -1.0, -1e9])
    for name, value in out.items():
        np.testing.assert_array_equal(value, 0.0, err_msg=name)


@pytest.mark.parametrize("f", [1e-100, 1e-200, 1e-300, 5e-324])
def test_vanishing_forces(f):
    """Down to the smallest float, every output is close to its value without load."""
    out = SPRINGS["default"].evaluate(f)
    assert all(np.isfinite(float(value)) for value in out.values())
    # round-off of the approach over the closing of 1 um, and 1e-12 of the stiffness at 1 N
    assert 0.0 <= float(out["s_rel"]) < 1e-17
    assert 0.0 <= float(out["K_N"]) < 1e-5
    assert (float(out["elastic_fraction"]), float(out["A_r"])) == pytest.approx((0.0, 0.0), abs=1e-100)


@each
def test_real_area_and_its_elastic_part(spring):
    """A_r and its elastic part are the sums of the law, and the closed form A_r = lambda m/(1 - m) a_L."""
    f = np.geomspace(1e-3, 0.9, 12) * spring.max_force
    out = spring.evaluate(f)
    law = evaluate_at_pressure(spring.joint, f / spring.joint.A_0)
    np.testing.assert_allclose(out["A_r"], law["A_r"], rtol=4 * EPS)
    m, spots = spring.joint.spot_distribution().size_exponent, spring.joint.spot_distribution()
    largest = law["largest_spot"]
    # exp and log of areas over tens of decades lose 1e-14
    np.testing.assert_allclose(out["A_r"], spring.joint.lambda_ * m / (1 - m) * largest, rtol=1e-12)
    part = np.maximum(1.0 - (spots.reference_area / largest) ** (1.0 - m), 0.0)
    np.testing.assert_allclose(out["elastic_fraction"], part, rtol=1e-11, atol=1e-14)
    assert np.ptp(part) > 0.01  # the range includes a change of it


def test_zeta_is_the_exponent():
    """The exponent m of the size distribution is sqrt(1 - e^2) (D1 + D2)/4 for Table 1 of Yu 2022."""
    exponent = np.sqrt(1 - 0.2**2) * 2 * 1.46 / 4
    assert CONTACT.spot_distribution().size_exponent == pytest.approx(exponent, rel=1e-15)
    assert SPRINGS["default"].max_force == pytest.approx(2.8 * 235e6 * 1e-4, rel=1e-12)  # H A_0


@each
def test_the_closing_is_short(spring):
    """The closing ends where the area of the largest spot is CLOSING_END_OVER_PLASTIC_SPOT_AREA times
    the area of the largest plastic spot."""
    force, _ = closing_end(spring)
    spots = spring.joint.spot_distribution()
    largest = float(evaluate_at_pressure(spring.joint, force / spring.joint.A_0)["largest_spot"])
    plastic = spots.reference_area * np.exp(spots.stiffness_onset_log_area)
    assert largest == pytest.approx(
        CLOSING_END_OVER_PLASTIC_SPOT_AREA * plastic, rel=1e-10
    )  # 1e-12 of the load, steep
    assert force < spring.max_force


@each
def test_beyond_the_table_the_tangent_continues(spring):
    end = spring.max_force
    out = spring.evaluate(end * np.array([1.0, 1.5, 2.0, 10.0]))
    K = out["K_N"][0]
    np.testing.assert_allclose(out["K_N"], K, rtol=1e-10)  # round-off over the last segment
    expected = out["s_rel"][0] + end * np.array([0.0, 0.5, 1.0, 9.0]) / K
    np.testing.assert_allclose(out["s_rel"], expected, rtol=1e-10)
    assert np.all(np.isfinite(out["A_r"]))


@each
def test_shapes(spring):
    f = np.linspace(-1.0, 1.0, 12).reshape(3, 4) * spring.max_force
    together = spring.evaluate(f)
    for name, value in together.items():
        assert value.shape == (3, 4)
        # a point does not see its neighbours except through the number of Newton steps
        assert float(value[2, 1]) == pytest.approx(float(spring.evaluate(f[2, 1])[name]), rel=1e-12)
    assert all(np.shape(value) == () for value in spring.evaluate(1.0).values())


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"e": 1.0}, ("e = 1", "[0, 1)")),
        ({"lambda": 1.5}, ("lambda = 1.5", "(0, 1]")),
        ({"surface1.D": 2.0}, ("surface1.D = 2", "(1, 2)")),
        ({"surface2.G": 0.0}, ("surface2.G = 0 m", "(0, inf)")),
        ({"sigma_y": float("nan")}, ("sigma_y = nan Pa", "(0, inf)")),
        ({"rigid_flat": 1.0}, ("rigid_flat = 1.0", "true, false")),
        ({"A_0": "large"}, ("A_0 = 'large'", "m2")),
    ],
)
def test_impossible_contacts_are_refused(changes, words):
    with pytest.raises(ValueError, match=next(iter(changes))) as error:
        changed(**changes)
    assert "\n" not in str(error.value)
    for word in words:
        assert word in str(error.value)


def test_rigid_flat_takes_the_second_body_out(fmu: Host) -> None:
    def at(**changes: Any) -> dict[str, float]:
        return fmu("GearContact").start(changes | STATE["GearContact"]).get()

    rigid, both = at(rigid_flat=True), at(rigid_flat=False)
    assert at() == rigid  # the default
    assert at(**{"rigid_flat": True, "side2.E": 1e11}) == rigid
    assert at(**{"rigid_flat": False, "side2.E": 1e11}) != both
    # two equal bodies are as soft as one of half the modulus against a rigid flat
    assert at(**{"rigid_flat": True, "side1.E": 1.03e11}) == pytest.approx(both, rel=1e-9)


def test_gear_contact_follows_the_law_without_a_table(fmu: Host) -> None:
    contact, instance = parameters("GearContact"), fmu("GearContact").start()
    for f in (300.0, 2e3, 2e4, 6e4):
        found, expected = instance.at({"f": f}), evaluate_at_pressure(contact, f / contact.A_0)
        assert found["K_N"] == pytest.approx(float(expected["K_N"]), rel=TABLE)
        for output in ("A_r", "elastic_fraction"):
            assert found[output] == pytest.approx(float(expected[output]), rel=SAME)
    assert found["elastic_fraction"] > 0.0
    assert list(instance.at({"f": 0.0}).values()) == [0.0] * 4


def test_derivatives_keep_the_closed_relations_of_the_gear_contact(host: Host, version: str) -> None:
    instance = host("GearContact", version).start()
    for f in (1e-3, 1.0, 300.0, 2e4, 6e4, 1e6):
        values, J = instance.at({"f": f}), jacobian(instance)
        assert J["s_rel", "f"] == close(1.0 / values["K_N"], 1e-12)
        assert J["A_r", "f"] > 0.0
    for f in (0.0, -5.0):
        instance.at({"f": f})
        assert set(jacobian(instance).values()) == {0.0}


DRAWING = ["--width", "20", "--load", "2000", "--material", "hardened steel", "--Ra", "0.4"]


def made(capsys, *words, path=None):
    out = ["--out", str(path)] if path else []
    assert cli.main(["new", "gear-contact", *words, *out, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(
    ("radii", "curvature"),
    [
        (["12", "30"], 1 / 0.012 + 1 / 0.03),
        (["12", "-30"], 1 / 0.012 - 1 / 0.03),
        (["12", "flat"], 1 / 0.012),
    ],
)
def test_the_patch_is_hertz(capsys, radii, curvature):
    found = made(capsys, *DRAWING, "--radii", *radii)
    E = 0.5 * 206e9 / (1.0 - 0.09)
    b = math.sqrt(4.0 * 2000.0 / (math.pi * 0.02 * E * curvature))
    facts = {name: fact["value"] for name, fact in found["facts"].items()}
    assert facts["half_width"] == pytest.approx(b)
    assert facts["p_hertz"] == pytest.approx(math.sqrt(2000.0 * E * curvature / (math.pi * 0.02)))
    assert found["parameters"]["A_0"] == pytest.approx(2.0 * b * 0.02)


def test_the_file_has_the_stiffness_it_shows(capsys, tmp_path):
    path = tmp_path / "flanks.toml"
    found = made(capsys, *DRAWING, "--radii", "12", "30", path=path)
    file = load_parameter_file(path)
    assert (file.law, file.start_value("f")) == ("roughness", 2000.0)
    state = GearContactSpring.tabulate(file.values).evaluate(2000.0)
    assert found["facts"]["K_N"]["value"] == pytest.approx(float(state["K_N"]))
    assert float(state["K_N"]) == pytest.approx(2000.0 / (0.45 * file.values.h), rel=0.1)


@pytest.mark.parametrize(
    ("radii", "text"),
    [
        (["12"], "--radii has 1 values, expected 2: one for each flank"),
        (["-12", "30"], "--radii = -12 30: expected 1/R1 + 1/R2 above 0"),
        (["flat", "flat"], "expected 1/R1 + 1/R2 above 0"),
        (["0", "30"], "--radii = 0 mm is not a radius"),
        (["a", "30"], "--radii = 'a' is not a number"),
    ],
)
def test_what_does_not_fit_is_refused(capsys, radii, text):
    assert text in refused_line(capsys, "new", "gear-contact", *DRAWING, "--radii", *radii)
