"""The number of tooth pairs over the mesh cycle."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointfmu.joints.gear_mesh.spring import pairs

EPS = np.finfo(float).eps

ratios = st.floats(1.0, 2.999)
engagements = st.floats(1e-3, 1.0)
phases = st.floats(-1e3, 1e3)
CYCLE = (np.arange(4000) + 0.5) / 4000
"""Phases of a cycle; the midpoint rule of a periodic function that is even about its jumps."""


@given(ratio=ratios, engagement=engagements)
def test_mean_over_a_cycle_is_the_contact_ratio(ratio, engagement):
    """Exact: between its ends the number is a polynomial, five Gauss points integrate it."""
    part = ratio - np.floor(ratio)
    width = engagement * min(part, 1.0 - part)
    ends = np.sort([0.0, *(0.5 * part + width * np.array([-0.5, 0.5])), 0.5])
    x, weights = np.polynomial.legendre.leggauss(5)
    mean = sum(
        (b - a) * weights @ pairs(ratio, engagement, 0.0, a + (b - a) * 0.5 * (1.0 + x))[0]
        for a, b in pairwise(ends)
    )
    # three intervals of half a cycle, weights of sum two
    assert mean == pytest.approx(ratio, rel=20.0 * EPS)


@pytest.mark.parametrize(
    ("ratio", "phase", "count"),
    [(1.6, 0.0, 2.0), (1.6, 0.5, 1.0), (1.6, 0.3, 1.5), (1.6, 7.3, 1.5), (2.25, 0.0, 3.0), (2.25, -3.5, 2.0)],
)
def test_one_pair_more_around_whole_phases(ratio, phase, count):
    assert pairs(ratio, 0.4, 0.0, phase)[0] == pytest.approx(count, abs=1e-12)  # 7.3 - 7 has lost a digit


def test_time_with_one_pair_more():
    """The rest of the contact ratio is the part of the cycle with more than half a pair more."""
    count, _ = pairs(1.69, 0.3, 0.0, CYCLE)
    assert np.mean(count > 1.5) == pytest.approx(0.69, abs=1.0 / CYCLE.size)
    full = np.mean(count == 2.0)
    none = np.mean(count == 1.0)
    assert full == pytest.approx(0.69 - 0.3 * 0.31, abs=2.0 / CYCLE.size)
    assert none == pytest.approx(0.31 - 0.3 * 0.31, abs=2.0 / CYCLE.size)


@pytest.mark.parametrize("ratio", [1.0, 2.0])
@given(engagement=engagements, phase=phases)
def test_a_whole_contact_ratio_is_constant(ratio, engagement, phase):
    assert pairs(ratio, engagement, 0.0, phase) == (ratio, 0.0)


@given(ratio=ratios, engagement=engagements, phase=phases)
def test_even_and_between_its_neighbours(ratio, engagement, phase):
    count, slope = pairs(ratio, engagement, 0.0, phase)
    back, falling = pairs(ratio, engagement, 0.0, -phase)
    assert (back, falling) == (count, -slope)
    assert np.floor(ratio) <= count <= np.floor(ratio) + 1.0


@given(ratio=ratios, engagement=st.floats(0.05, 1.0))
def test_slope(ratio, engagement):
    """By central differences: their error is h^2/6 times the third derivative, 60/width^3 at most."""
    part = ratio - np.floor(ratio)
    width = engagement * min(part, 1.0 - part)
    if width < 1e-3:
        return
    h = 1e-4 * width
    _, slope = pairs(ratio, engagement, 0.0, CYCLE[::40])
    ends = [pairs(ratio, engagement, 0.0, CYCLE[::40] + step)[0] for step in (-h, h)]
    # and round-off of the two counts over 2 h
    allowed = 10.0 * h**2 / width**3 + 4.0 * EPS * 3.0 / h
    np.testing.assert_allclose((ends[1] - ends[0]) / (2.0 * h), slope, rtol=0.0, atol=allowed)
    assert np.max(np.abs(slope)) <= 1.875 / width * (1.0 + 1e-12)


def test_arrays_of_ratios():
    """As in studies of many samples: every row as alone, whole ratios among them."""
    ratio, engagement = np.array([[1.0], [1.5], [2.0], [2.9]]), np.array([[0.5], [1.0], [0.1], [0.3]])
    together = pairs(ratio, engagement, 0.0, CYCLE)
    for i in range(4):
        alone = pairs(float(ratio[i, 0]), float(engagement[i, 0]), 0.0, CYCLE)
        for both, single in zip(together, alone, strict=True):
            np.testing.assert_array_equal(both[i], np.broadcast_to(single, CYCLE.shape))


@given(ratio=ratios, engagement=engagements, overlap=st.floats(0.05, 4.0), phase=st.floats(-3.0, 3.0))
def test_a_helical_mesh_is_the_mean_of_its_sections(ratio, engagement, overlap, phase):
    """By quadrature; the midpoint rule's error is h^2/24 overlap times the curvature, at most 6/width^2."""
    part = ratio - np.floor(ratio)
    width = engagement * min(part, 1.0 - part)
    if 0.0 < width < 0.02:
        return
    h = 1.0 / 4000
    at = phase + overlap * ((np.arange(4000) + 0.5) * h - 0.5)
    count, slope = pairs(ratio, engagement, overlap, phase)
    sections, slopes = pairs(ratio, engagement, 0.0, at)
    allowed = (h * overlap) ** 2 / 24.0 * (6.0 / width**2 if width else 0.0) + 1e-12
    assert count == pytest.approx(np.mean(sections), abs=allowed)
    assert slope == pytest.approx(np.mean(slopes), abs=20.0 * allowed / (width or 1.0))


@pytest.mark.parametrize("overlap", [1.0, 2.0])
def test_a_whole_overlap_ratio_has_no_mesh_cycle(overlap):
    count, slope = pairs(1.69, 0.3, overlap, CYCLE)
    np.testing.assert_allclose(count, 1.69, rtol=4.0 * EPS)
    np.testing.assert_allclose(slope, 0.0, atol=1e-11)  # round-off of the phase over the width of 0.09


def test_a_vanishing_overlap_is_a_spur_mesh():
    spur, slope = pairs(1.69, 0.3, 0.0, CYCLE)
    for overlap in (0.5e-6, 2e-6):
        count, change = pairs(1.69, 0.3, overlap, CYCLE)
        np.testing.assert_allclose(count, spur, atol=1e-9)
        # overlap^2/24 times the slope's curvature of 60/width^3, width 0.093
        np.testing.assert_allclose(change, slope, atol=2e-8)
