"""Tooth pairs of the gear mesh: their number over the mesh cycle; flanks and tooth bending in series."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from laws import RANDOM, decades
from scipy.integrate import quad
from scipy.optimize import brentq
from test_gear_mesh_spring import MESH, each, motion

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.gear_contact.spring import GearContactParameters, GearContactSpring
from jointfmu.joints.gear_mesh.spring import GearMeshParameters, GearMeshSpring, pairs_in_contact
from jointfmu.mechanics.curve import MAX_INTERPOLATION_ERROR, tabulate_approach
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set, flatten_parameters, replace_values

EPS = np.finfo(float).eps

ratios = st.floats(1.0, 2.999)
engagements = st.floats(1e-3, 1.0)
phases = st.floats(-1e3, 1e3)
CYCLE = (np.arange(4000) + 0.5) / 4000
"""Phases of a mesh cycle, for the midpoint rule of a periodic function that is symmetric about its jumps."""


@given(ratio=ratios, engagement=engagements)
def test_mean_over_a_cycle_is_the_contact_ratio(ratio, engagement):
    """Exact, because between its corners the number is a polynomial, which five Gauss points integrate
    exactly."""
    part = ratio - np.floor(ratio)
    width = engagement * min(part, 1.0 - part)
    ends = np.sort([0.0, *(0.5 * part + width * np.array([-0.5, 0.5])), 0.5])
    x, weights = np.polynomial.legendre.leggauss(5)
    mean = sum(
        (b - a) * weights @ pairs_in_contact(ratio, engagement, 0.0, a + (b - a) * 0.5 * (1.0 + x))[0]
        for a, b in pairwise(ends)
    )
    # three intervals of half a cycle, weights of sum two
    assert mean == pytest.approx(ratio, rel=20.0 * EPS)


@pytest.mark.parametrize(
    ("ratio", "phase", "count"),
    [(1.6, 0.0, 2.0), (1.6, 0.5, 1.0), (1.6, 0.3, 1.5), (1.6, 7.3, 1.5), (2.25, 0.0, 3.0), (2.25, -3.5, 2.0)],
)
def test_one_pair_more_around_whole_phases(ratio, phase, count):
    assert pairs_in_contact(ratio, 0.4, 0.0, phase)[0] == pytest.approx(
        count, abs=1e-12
    )  # 7.3 - 7 has lost a digit


def test_time_with_one_pair_more():
    """The share of the mesh cycle with one pair more (by at least half) is the contact ratio's fraction."""
    count, _ = pairs_in_contact(1.69, 0.3, 0.0, CYCLE)
    assert np.mean(count > 1.5) == pytest.approx(0.69, abs=1.0 / CYCLE.size)
    full = np.mean(count == 2.0)
    none = np.mean(count == 1.0)
    assert full == pytest.approx(0.69 - 0.3 * 0.31, abs=2.0 / CYCLE.size)
    assert none == pytest.approx(0.31 - 0.3 * 0.31, abs=2.0 / CYCLE.size)


@pytest.mark.parametrize("ratio", [1.0, 2.0])
@given(engagement=engagements, phase=phases)
def test_a_whole_contact_ratio_is_constant(ratio, engagement, phase):
    assert pairs_in_contact(ratio, engagement, 0.0, phase) == (ratio, 0.0)


@given(ratio=ratios, engagement=engagements, phase=phases)
def test_even_and_between_its_neighbours(ratio, engagement, phase):
    count, slope = pairs_in_contact(ratio, engagement, 0.0, phase)
    back, falling = pairs_in_contact(ratio, engagement, 0.0, -phase)
    assert (back, falling) == (count, -slope)
    assert np.floor(ratio) <= count <= np.floor(ratio) + 1.0


@given(ratio=ratios, engagement=st.floats(0.05, 1.0))
def test_slope(ratio, engagement):
    """The slope agrees with central differences, whose error is h^2/6 times the third derivative, at most
    60/width^3."""
    part = ratio - np.floor(ratio)
    width = engagement * min(part, 1.0 - part)
    if width < 1e-3:
        return
    h = 1e-4 * width
    _, slope = pairs_in_contact(ratio, engagement, 0.0, CYCLE[::40])
    ends = [pairs_in_contact(ratio, engagement, 0.0, CYCLE[::40] + step)[0] for step in (-h, h)]
    # and round-off of the two counts over 2 h
    allowed = 10.0 * h**2 / width**3 + 4.0 * EPS * 3.0 / h
    np.testing.assert_allclose((ends[1] - ends[0]) / (2.0 * h), slope, rtol=0.0, atol=allowed)
    assert np.max(np.abs(slope)) <= 1.875 / width * (1.0 + 1e-12)


def test_arrays_of_ratios():
    """In an array of ratios, as in studies with many samples, every row equals the result for its ratio
    alone, integer ratios included."""
    ratio, engagement = np.array([[1.0], [1.5], [2.0], [2.9]]), np.array([[0.5], [1.0], [0.1], [0.3]])
    together = pairs_in_contact(ratio, engagement, 0.0, CYCLE)
    for i in range(4):
        alone = pairs_in_contact(float(ratio[i, 0]), float(engagement[i, 0]), 0.0, CYCLE)
        for both, single in zip(together, alone, strict=True):
            np.testing.assert_array_equal(both[i], np.broadcast_to(single, CYCLE.shape))


@given(ratio=ratios, engagement=engagements, overlap=st.floats(0.05, 4.0), phase=st.floats(-3.0, 3.0))
def test_a_helical_mesh_is_the_mean_of_its_sections(ratio, engagement, overlap, phase):
    """The stiffness agrees with the midpoint rule, whose error is h^2/24 overlap times the curvature, at most
    6/width^2."""
    part = ratio - np.floor(ratio)
    width = engagement * min(part, 1.0 - part)
    if 0.0 < width < 0.02:
        return
    h = 1.0 / 4000
    at = phase + overlap * ((np.arange(4000) + 0.5) * h - 0.5)
    count, slope = pairs_in_contact(ratio, engagement, overlap, phase)
    sections, slopes = pairs_in_contact(ratio, engagement, 0.0, at)
    allowed = (h * overlap) ** 2 / 24.0 * (6.0 / width**2 if width else 0.0) + 1e-12
    assert count == pytest.approx(np.mean(sections), abs=allowed)
    assert slope == pytest.approx(np.mean(slopes), abs=20.0 * allowed / (width or 1.0))


@pytest.mark.parametrize("overlap", [1.0, 2.0])
def test_a_whole_overlap_ratio_has_no_mesh_cycle(overlap):
    count, slope = pairs_in_contact(1.69, 0.3, overlap, CYCLE)
    np.testing.assert_allclose(count, 1.69, rtol=4.0 * EPS)
    np.testing.assert_allclose(slope, 0.0, atol=1e-11)  # round-off of the phase over the width of 0.09


def test_a_vanishing_overlap_is_a_spur_mesh():
    spur, slope = pairs_in_contact(1.69, 0.3, 0.0, CYCLE)
    for overlap in (0.5e-6, 2e-6):
        count, change = pairs_in_contact(1.69, 0.3, overlap, CYCLE)
        np.testing.assert_allclose(count, spur, atol=1e-9)
        # overlap^2/24 times the slope's curvature of 60/width^3, width 0.093
        np.testing.assert_allclose(change, slope, atol=2e-8)


def contact_of(mesh):
    """Contact of the flanks of one pair without the other compliances."""
    names = flatten_parameters(load_default("gear_contact").values)
    return GearContactSpring.tabulate(
        build_parameter_set(GearContactParameters, {name: flatten_parameters(mesh)[name] for name in names})
    )


@each
def test_the_pair_is_flanks_and_teeth_in_series(spring):
    """s = delta(F) + F/K_tooth solved for F by brentq, with delta by adaptive quadrature of the law."""
    mesh = spring.joint
    flanks = tabulate_approach(mesh)
    first, force, delta = mesh.A_0 * flanks.closing_end_pressure, 0.0, -float(flanks.displacement[0])

    def per_log(t):
        return np.exp(t) / float(evaluate_at_pressure(mesh, np.exp(t) / mesh.A_0)["K_N"])

    spots = mesh.spot_distribution()
    breaks = [
        float(spots.sum_over_spots("load", u))
        for u in spots.sorted_regime_end_log_areas
        if u > spots.stiffness_onset_log_area
    ]
    last = first
    for force in np.geomspace(3.0 * first, 0.9 * mesh.A_0 * mesh.hardness, 5):
        ends = np.log([last, *(b for b in breaks if last < b < force), force])
        delta += sum(quad(per_log, a, b, epsabs=0.0, epsrel=1e-11)[0] for a, b in pairwise(ends))
        last = force
        s = delta + force / mesh.K_tooth
        stiffness = 1.0 / (
            1.0 / float(evaluate_at_pressure(mesh, force / mesh.A_0)["K_N"]) + 1.0 / mesh.K_tooth
        )

        def miss(f, s=s, mesh=mesh, flanks=flanks):
            approach = float(flanks.inverse(f / mesh.A_0) - flanks.displacement[0])
            return approach + f / mesh.K_tooth - s

        solved = brentq(miss, 0.5 * force, 2.0 * force, xtol=1e-12 * force, rtol=1e-14)
        found, K = spring.curve.derivatives(s, 1)
        assert found == pytest.approx(
            force, rel=2.0 * MAX_INTERPOLATION_ERROR
        )  # of the flanks' table and the pair's
        assert found == pytest.approx(solved, rel=2.0 * MAX_INTERPOLATION_ERROR)
        assert pytest.approx(stiffness, rel=2.0 * MAX_INTERPOLATION_ERROR) == K


@each
def test_the_closing_is_in_series_too(spring):
    """While the contact closes, the flank curve is one polynomial; brentq on it agrees to the error of the
    table."""
    mesh, flanks = spring.joint, tabulate_approach(spring.joint)
    start = float(flanks.displacement[0])
    for part in (1e-3, 0.02, 0.2, 0.7, 0.999):
        x = (1.0 - part) * start

        def load(x, mesh=mesh, flanks=flanks):
            return mesh.A_0 * float(flanks.derivatives(x, 0)[0])

        s = x - start + load(x) / mesh.K_tooth

        def miss(y, s=s, start=start, load=load, mesh=mesh):
            return y - start + load(y) / mesh.K_tooth - s

        solved = brentq(miss, start, 0.0, xtol=1e-22, rtol=1e-15)
        # the approach is known to 1e-16 of the closing, the load grows with its cube
        allowed = MAX_INTERPOLATION_ERROR + 10.0 * EPS / part
        assert spring.curve.derivatives(s, 0)[0] == pytest.approx(load(solved), rel=allowed)
    assert spring.closing_end_deflection == pytest.approx(
        -start + mesh.A_0 * flanks.closing_end_pressure / mesh.K_tooth, rel=4.0 * EPS
    )


@each
def test_the_table_starts_at_first_touch_and_ends_at_the_hardness(spring):
    assert (spring.curve.displacement[0], spring.curve.load[0], spring.curve.stiffness[0]) == (0.0, 0.0, 0.0)
    assert spring.curve.end_point[1] == pytest.approx(spring.joint.A_0 * spring.joint.hardness, rel=1e-12)
    assert spring.curve.interpolation_error <= MAX_INTERPOLATION_ERROR
    assert np.all(np.diff(spring.curve.load) > 0.0)


@settings(max_examples=25)
@given(law=RANDOM["yu"], teeth=decades(1e-3, 1e6))
def test_any_mesh_gives_a_monotone_table_or_is_refused(law, teeth):
    """Tooth stiffness over the stiffness of the flanks at the end of the closing, in a wide range."""
    try:
        flanks = tabulate_approach(law)
    except ValueError as error:
        assert "plastic" in str(error)  # noqa: PT017
        return
    closed = int(np.searchsorted(flanks.displacement, 0.0))
    p, k, bend = flanks.load[closed], flanks.stiffness[closed], flanks.stiffness_slope_end[closed - 1]
    assume(bend * p >= 0.75 * k**2)  # else the flanks' own closing begins with a load below zero
    own = {"K_tooth": float(teeth * law.A_0 * k)}
    try:
        spring = GearMeshSpring.tabulate(
            build_parameter_set(GearMeshParameters, flatten_parameters(MESH) | flatten_parameters(law) | own)
        )
    except RuntimeError as error:  # only teeth much softer than their flanks need too many nodes
        assert "nodes" in str(error)  # noqa: PT017
        assert teeth < 0.1
        return
    assert spring.curve.interpolation_error <= MAX_INTERPOLATION_ERROR
    x = spring.curve.displacement
    places = (x[:-1] + np.linspace(0, 1, 9)[:-1, None] * np.diff(x)).T.ravel()
    load, stiffness = spring.curve.derivatives(places, 1)
    assert np.all(np.diff(load) > 0.0)
    assert np.all(stiffness[1:] > 0.0)
    assert np.all(stiffness < own["K_tooth"] * (1.0 + MAX_INTERPOLATION_ERROR))


def test_hard_teeth_leave_the_contact_alone():
    hard = GearMeshSpring.tabulate(replace_values(MESH, {"K_tooth": 1e20, "contact_ratio": 1.0}))
    contact = contact_of(MESH)
    f = np.geomspace(1e-3, 0.99, 20) * contact.max_force
    alone = contact.evaluate(f)
    found = motion(hard, alone["s_rel"], 0.0)
    np.testing.assert_allclose(found["f"], f, rtol=2.0 * MAX_INTERPOLATION_ERROR)
    np.testing.assert_allclose(found["K"], alone["K_N"], rtol=2.0 * MAX_INTERPOLATION_ERROR)


def test_teeth_too_soft_for_a_table_are_refused():
    with pytest.raises(RuntimeError, match="not smooth enough"):
        GearMeshSpring.tabulate(replace_values(MESH, {"K_tooth": 1.0}))
