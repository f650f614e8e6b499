"""Boundary elements against closed forms, and claims of docs/validity_stiffness.md, on small grids.

The numbers of the document come from studies/validity_stiffness.py; the bounds here are wide enough for grids
of 64 and 128 points, whose results were within a factor of two of the results for 256.
"""

from dataclasses import replace

import numpy as np
import pytest
from clients import needs
from oracles import boundary_element, interface_laws
from oracles.measured_joints import measured
from oracles.rough_surfaces import periodic, rms_height, rms_slope

from jointfmu.contact.interface import evaluate_at_pressure, stiffness_curve

pytestmark = [pytest.mark.slow, needs("tamaas")]


def test_hertz_is_met_and_better_on_a_finer_grid():
    coarse, fine = np.abs(boundary_element.hertz(32)), np.abs(boundary_element.hertz(128))
    ring = 2.0 / (0.25 * 128)  # the contact's edge is known to a spacing, its radius is 0.25
    assert fine[0] < ring
    assert np.all(fine[1:3] < 5e-4)  # errors fall with the square of the spacing, 1e-3 and 4e-3 at 32
    assert np.all(fine[1:3] < 0.15 * coarse[1:3])
    assert fine[3] < 0.5 * ring


def test_westergaard_is_met():
    width, gap, stiffness = boundary_element.westergaard(128)
    assert width < 2.0 / 128 / 0.2  # a spacing at either edge of the narrowest contact, 0.2
    assert gap < 5e-4
    assert stiffness < 0.05  # follows the width: d ln k/d ln width < 1 at these loads


def test_the_bonded_stiffness_is_the_derivative_of_the_elastic_load():
    z = interface_laws.heights(2.5, 1e-6, 1.0, 1, points=64)
    p = 0.05 * boundary_element.slope(z) * np.array([0.98, 1.0, 1.02])
    contacts = boundary_element.press(z, p)
    secant = (p[2] - p[0]) / (contacts[0].separation - contacts[2].separation)
    assert contacts[1].stiffness == pytest.approx(secant, rel=0.02)  # the contact set changes by whole points


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_tangential_stiffness_follows_mindlin(nu):
    ratios = interface_laws.tangential_ratio(nu, seeds=range(2), points=64)
    assert np.mean(ratios) == pytest.approx(2.0 * (1.0 - nu) / (2.0 - nu), rel=0.02)


def test_elastic_stiffness_hardly_depends_on_the_dimension():
    """For all D, k = p/(0.48 h_rms) (Akarapu et al. 2011), with wavelengths up to a quarter of the side."""
    loads = (0.025, 0.05)
    alpha = [
        interface_laws.elastic(H, 4, seeds=range(3), loads=loads, points=128, finest=4)["alpha"].mean()
        for H in (0.3, 0.8)
    ]
    assert 0.48 * np.array(alpha) == pytest.approx(1.0, abs=0.2)
    assert alpha[0] == pytest.approx(alpha[1], rel=0.1)


def test_refining_the_grid_keeps_the_stiffness_and_moves_the_area_into_the_known_interval():
    alpha, kappa = interface_laws.resolution(factors=(1, 4), loads=(0.03,))
    assert alpha[1, 0] == pytest.approx(alpha[0, 0], rel=0.02)  # 8 against 2 spacings in the shortest wave
    # Persson: 2 sqrt(2/pi) = 1.60; Bush, Gibson and Thomas: sqrt(2 pi) = 2.51
    assert 1.6 < kappa[1, 0] < 2.51 < kappa[0, 0]


def test_waves_up_to_the_side_stiffen_the_contact_at_small_load():
    loads = (0.003, 0.012)
    alpha = [
        interface_laws.elastic(0.8, r, seeds=range(5), loads=loads, points=64, finest=4)["alpha"].mean(axis=0)
        for r in (1, 4)
    ]
    assert np.all(alpha[0] > 1.2 * alpha[1])  # 1.6 and 1.3 with a standard error of 0.2 and 0.1


@pytest.fixture(scope="module")
def pressed():
    """Law and boundary elements on the nominal area of the joints: one seed, 128 points, three pressures."""
    found = {}
    for name, case in interface_laws.cases().items():
        few = replace(case, pressures=case.pressures[1::2])
        elements = interface_laws.boundary_element_results(few, few.sides[-1], range(1), points=128)
        found[name] = few, elements, interface_laws.law_state(few, few.sides[-1])
    return found


def test_a_hardness_bounds_the_pressure_and_the_area_from_below(pressed):
    for case, elements, _ in pressed.values():
        assert np.all(elements["area"] >= case.pressures / case.law.hardness * (1.0 - 1e-6))


def test_the_real_area_of_the_laws_is_right_within_a_factor(pressed):
    for _, elements, law in pressed.values():
        ratio = law["area"] / elements["area"].mean(axis=0)
        assert np.all((ratio > 1 / 4) & (ratio < 2.5))


def test_stiffness_grows_in_both_but_its_level_differs(pressed):
    bands = {"zhao2018": (4.0, 40.0), "hu2023": (40.0, 300.0), "yu2022": (0.5, 6.0)}
    for name, (_, elements, law) in pressed.items():
        assert np.all(np.diff(law["k"]) > 0.0)
        assert np.all(np.diff(elements["k"].mean(axis=0)) > 0.0)
        low, high = bands[name]
        ratio = law["k"] / elements["k"].mean(axis=0)
        assert np.all((ratio > low) & (ratio < high))


def test_the_law_has_no_stiffness_on_a_small_area_where_boundary_elements_have():
    case = interface_laws.cases()["zhao2018"]
    case = replace(case, pressures=np.array([1e6, 4e6]))
    assert np.all(interface_laws.law_state(case, 1e-3)["k"] == 0.0)
    assert np.all(interface_laws.boundary_element_results(case, 1e-3, range(1), points=64)["k"] > 1e12)


def test_zhaos_continuous_choice_alone_lies_among_measured_cast_iron():
    p = np.array([1e6])
    joints = [j for j in measured()["normal"] if j["material"].startswith("cast iron")]
    bands = [interface_laws.measured_stiffness(j, p) for j in joints]
    low, high = min(b[0][0] for b in bands), max(b[1][0] for b in bands)
    law = interface_laws.cases()["zhao2018"].law
    level = {
        a: stiffness_curve(replace(law, critical_area=a), p)[0][0] for a in ("continuity", "printed", "yield")
    }
    assert low < level["continuity"] < high
    assert level["printed"] < low / 5.0
    assert level["yield"] < low / 50.0


def test_only_the_hertz_stiffness_keeps_the_tangential_ratio():
    law = interface_laws.cases()["zhao2018"].law
    mindlin = 2.0 * (1.0 - law.side1.nu) / (2.0 - law.side1.nu)
    stick = (1.0 - law.traction_ratio) ** (1.0 / 3.0)
    ratio = {}
    for spot in ("family", "hertz"):
        state = evaluate_at_pressure(replace(law, spot_stiffness=spot), 1e6)
        ratio[spot] = state["K_T"] / state["K_N"]
    assert ratio["hertz"] == pytest.approx(mindlin * stick, rel=1e-6)
    assert ratio["family"] < 0.6 * mindlin


def test_every_measured_number_has_its_source():
    data = measured()
    for joint in (*data["normal"], *data["tangential"]):
        assert joint["source"]
        assert joint["read"]
        assert joint["to"] > 0.0
    assert all(one["source"] for one in data["statement"])


def test_measured_stiffness_is_the_derivative_of_the_approach():
    joint = {"C": [0.5], "m": [0.4], "pressure_unit": 98066.5}
    p = 1e6 * np.array([0.999, 1.0, 1.001])
    approach = 0.5e-6 * (p / 98066.5) ** 0.4
    low, high = interface_laws.measured_stiffness(joint, p[1:2])
    assert low == high == pytest.approx((p[2] - p[0]) / (approach[2] - approach[0]), rel=1e-6)


def test_a_periodic_surface_has_the_height_and_slope_of_its_band():
    D, G, band = 2.42, 1e-8, (1e-3 / 8, 1e-3 / 32)
    surface = periodic(1e-3, 256, D, G, band, 7)
    assert np.array_equal(surface.z, periodic(1e-3, 256, D, G, band, 7).z)
    # the waves of a band are whole numbers per side: 8 to 32 of them, the ends weigh by half a ring, 1/16
    assert surface.z.std() == pytest.approx(rms_height(3.0 - D, G, *band), rel=1 / 16)
    slope = boundary_element.slope(surface.z / 1e-3)
    assert slope == pytest.approx(rms_slope(3.0 - D, G, *band), rel=1 / 16)


@pytest.mark.parametrize("band", [(2e-3, 1e-4), (1e-4, 1e-4), (1e-3, 1e-6)])
def test_a_band_that_does_not_fit_is_refused(band):
    with pytest.raises(ValueError, match=r"band = .* is not allowed: the longest wave is at most the side"):
        periodic(1e-3, 128, 2.5, 1e-8, band, 0)
