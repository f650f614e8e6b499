"""Stiffness of heights that are not Gaussian against boundary elements, on seeds that no fit has used."""

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.inputs.surfaces import solve
from jointfmu_tools.inputs.surfaces.bearing_curve import BearingCurve
from jointfmu_tools.inputs.surfaces.heights import ArealMap
from jointfmu_tools.inputs.surfaces.stiffness_table import MaterialPair, interface_points_from_solution
from oracles.boundary_element import press, slope
from oracles.machined_surfaces import KINDS, gaussian, plateau, sample_periodic

pytestmark = [needs("tamaas"), pytest.mark.slow]
LOADS = np.array([0.003, 0.01, 0.03])
BARE_GROOVES = "turned, 12 grooves, roughness 0.1"
"""Regular grooves, whose crests are lines: the law is up to 1.6 times too soft."""


@pytest.mark.parametrize("kind", KINDS)
def test_pressure_over_decay_length_is_the_stiffness_of_boundary_elements(kind):
    limit = 1.7 if kind == BARE_GROOVES else 1.5
    z = KINDS[kind](70_000, 128)
    contacts = press(z, slope(z) * LOADS)
    law = BearingCurve.from_height_sample(sample_periodic(z)).normal_stiffness(
        np.array([c.p for c in contacts]), 1.0
    )
    ratio = law / [c.stiffness for c in contacts]
    assert np.all((ratio > 1.0 / limit) & (ratio < limit)), ratio


@pytest.mark.parametrize("heights", [gaussian(6, 64), plateau(6, 64, 0.55, 0.1)])
def test_solved_scan_is_that_of_another_boundary_element_code(heights):
    """In elastic contact, ContactMechanics (the product's solver) agrees with tamaas."""
    n, side, modulus, height = 64, 1e-3, 1e11, 1e-6
    scan = ArealMap(z=height * heights, dx=side / n, dy=side / n, scan_name="scan")
    contacts = press(heights, slope(heights) * LOADS)
    p = np.array([c.p for c in contacts]) * modulus * height / side
    found = [k for k, *_ in solve._press_on_half_space(scan, p, modulus, 1e30, iter(range(9)))]
    assert found == pytest.approx([c.stiffness * modulus / side for c in contacts], rel=0.01)


def test_hardness_limits_the_pressure_and_stiffens_small_motions():
    n, side = 128, 1e-3
    scan = ArealMap(z=0.5e-6 * gaussian(6, n), dx=side / n, dy=side / n, scan_name="scan")
    soft, hard = (solve.solve_stiffness(scan, 1e11, hardness) for hardness in (2e9, 1e30))
    common, i, j = np.intersect1d(soft.nominal_pressure, hard.nominal_pressure, return_indices=True)
    assert common.size >= 3
    assert np.all(hard.plastic_area_share == 0.0)
    assert np.all(soft.plastic_area_share > 0.1)
    ratio = soft.normal_stiffness[i] / hard.normal_stiffness[j]
    assert np.all(ratio > 0.999)
    assert ratio[-1] > 1.2
    assert (
        hard.min_sub_area_over_mean_stiffness
        <= soft.min_sub_area_over_mean_stiffness
        < 1.0
        < soft.max_sub_area_over_mean_stiffness
        <= hard.max_sub_area_over_mean_stiffness
    )


def test_stiffness_of_a_contact_that_yields_has_a_wider_range_than_its_sub_areas():
    """The page of the command names 30 % at the hardness: from there on, a factor of 3 in both directions."""
    n, side = 128, 1e-3
    scan = ArealMap(z=0.5e-6 * gaussian(6, n), dx=side / n, dy=side / n, scan_name="scan")
    for hardness, factor in ((2e9, 3.0), (1e30, 1.0)):
        found = solve.solve_stiffness(scan, 1e11, hardness)
        points = interface_points_from_solution([scan], False, MaterialPair(1e11, 0.8, hardness, "m"), "scan")
        assert (np.max(found.plastic_area_share) > 0.3) == points.is_mostly_plastic == (factor > 1.0)
        low, high = found.min_sub_area_over_mean_stiffness, found.max_sub_area_over_mean_stiffness
        assert points.stiffness_factor_range == pytest.approx((low / factor, high * factor))
