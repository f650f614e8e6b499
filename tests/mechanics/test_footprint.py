"""Pressure over the contacts: bolts on a frame, and sums over nodes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.elastic_ring.nodes import Footprint

from jointfmu.joints.bolted_joint.law import preload_pressure, row_forces
from jointfmu.mechanics.footprint.bolts import (
    BoltedFrame,
    bolt_pressures,
    divide_frame_into_cells,
    pressure_distribution,
)
from jointfmu.mechanics.footprint.distribution import PRESSURE_COMPARISON_DECIMALS
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_parameters

EPS = np.finfo(float).eps
SUM = 1e-12
"""Round-off of sums over a thousand nodes of normalised pressures [1]."""
FIT = 1e-8
"""Relative residual of an accepted calibration [1]."""

JOINT = load_default("bolted_joint").values

patterns = st.builds(
    BoltedFrame,
    row_spacing=st.floats(0.15, 0.6),
    column_spacing=st.floats(0.15, 0.6),
    flange_width=st.floats(0.03, 0.07),
    hole_diameter=st.floats(0.005, 0.02),
    decay_length=st.floats(0.003, 0.3),
    decay_exponent=st.floats(0.6, 3.0),
)


# Bolts


@settings(max_examples=10)
@given(pattern=patterns)
def test_force_is_conserved(pattern):
    """1 N in a bolt gives 1 N in the contact, for each bolt and for all together."""
    areas, points = divide_frame_into_cells(pattern)
    np.testing.assert_allclose(bolt_pressures(pattern, areas, points, points) @ areas, 1.0, rtol=SUM)
    shape = pressure_distribution(pattern)
    assert shape.area_share.sum() == pytest.approx(1.0, rel=SUM)
    assert shape.area_share @ shape.preload_pressure_ratio == pytest.approx(1.0, rel=SUM)
    assert shape.area_share @ shape.moment_pressure_ratio == pytest.approx(0.0, abs=SUM)
    np.testing.assert_allclose(shape.area_share @ shape.position, 0.0, atol=SUM)  # m, about the centroid


def test_cells_fill_the_frame():
    """Their area is that of the frame without holes, and they lie in its solid part."""
    pattern = JOINT.pattern
    areas, points = divide_frame_into_cells(pattern)
    width = pattern.flange_width
    outer = (pattern.column_spacing + width) * (pattern.row_spacing + width)
    inner = (pattern.column_spacing - width) * (pattern.row_spacing - width)
    holes = 8.0 * np.pi * (0.5 * pattern.hole_diameter) ** 2
    # cells are cut in 8 x 8: edges of 3.2 m are met to a tenth of a sub-cell of 0.7 mm, holes alike
    assert areas.sum() == pytest.approx(outer - inner - holes, rel=6e-3)
    assert areas.sum() == pytest.approx(JOINT.A_0, rel=5e-4)  # A_0 is this area in three digits
    assert np.all(areas > 0.0)
    assert np.all(
        np.abs(points) <= 0.5 * np.array([pattern.column_spacing, pattern.row_spacing]) + 0.5 * width
    )
    assert 1000 < len(points) < 1300  # about as fine as Zhao's mesh of 1019


def test_bolts_sit_on_the_frame():
    bolts = JOINT.pattern.bolt_positions_from_middle
    assert len(bolts) == JOINT.n_bolts
    np.testing.assert_allclose(bolts.sum(axis=0), 0.0, atol=EPS)
    np.testing.assert_array_equal(bolts[:3, 1], 0.5 * JOINT.row_distance)
    np.testing.assert_array_equal(bolts[5:, 1], -0.5 * JOINT.row_distance)
    np.testing.assert_array_equal(np.sort(bolts[:3, 0]), [-0.1, 0.0, 0.1])


def mirrored(points, values, sign):
    """Values at the mirror images of the nodes, in the order of the nodes."""
    order, image = (np.lexsort(np.round(p * 1e9).T) for p in (points, points * sign))
    out = np.empty_like(values)
    out[image] = values[order]
    return out


@settings(max_examples=10)
@given(pattern=patterns)
def test_shapes_are_symmetric(pattern):
    shape = pressure_distribution(pattern)
    for sign, parity in (((-1, 1), 1.0), ((1, -1), -1.0)):
        for values, factor in (
            (shape.preload_pressure_ratio, 1.0),
            (shape.moment_pressure_ratio, parity),
            (shape.area_share, 1.0),
        ):
            image = mirrored(shape.position, values, np.array(sign))
            # round-off of the positions over the decay length
            np.testing.assert_allclose(image, factor * values, rtol=1e-9, atol=1e-9 * np.max(np.abs(values)))


@given(pattern=patterns, r=st.floats(0.0, 1.0), further=st.floats(1e-3, 1.0))
def test_pressure_decays_with_the_distance(pattern, r, further):
    near, far = pattern.pressure_decay(np.array([r, r + further]))
    assert 0.0 < far < near <= 1.0


def test_pressure_of_one_bolt_falls_outwards():
    areas, points = divide_frame_into_cells(JOINT.pattern)
    for bolt, unit in zip(
        JOINT.pattern.bolt_positions_from_middle,
        bolt_pressures(JOINT.pattern, areas, points, points),
        strict=True,
    ):
        outwards = np.argsort(np.hypot(*(points - bolt).T))
        assert np.all(np.diff(unit[outwards]) <= 0.0)


@pytest.mark.parametrize(("preload", "moment"), [(9e3, 0.0), (15e3, 4500.0), (15e3, -2000.0)])
def test_pressures_are_those_of_the_bolt_forces(preload, moment):
    """Pressure of every bolt by the decay: rows of three, changed by M/(L_a N_b)."""
    shift = moment / (JOINT.row_distance * 3)
    forces = preload + shift * np.array([1, 1, 1, 0, 0, -1, -1, -1])
    assert row_forces(JOINT, preload, moment) == pytest.approx((forces[0], forces[-1]), rel=1e-15)
    areas, points = divide_frame_into_cells(JOINT.pattern)
    expected = forces @ bolt_pressures(JOINT.pattern, areas, points, points) * areas.sum() / JOINT.A_0
    shape = pressure_distribution(JOINT.pattern)
    found = preload_pressure(JOINT, shape, preload, moment)
    np.testing.assert_allclose(found, expected, rtol=SUM)
    assert np.all(found > 0.0)
    assert JOINT.A_0 * shape.area_share @ found == pytest.approx(8 * preload, rel=SUM)


def test_published_bolt_forces():
    """A preload of 15 kN and a moment of 4500 N.m give bolt forces of 20 and 10 kN (Zhao 2018, section 3)."""
    assert row_forces(JOINT, 15e3, 4500.0) == pytest.approx((20e3, 10e3), rel=1e-15)


def test_published_pressures():
    """At 9 kN: 7.98 MPa at the holes, 0.62 MPa between bolts (Zhao 2018, section 3; both are fitted)."""
    shape = pressure_distribution(JOINT.pattern)
    p = preload_pressure(JOINT, shape, 9e3, 0.0)
    assert np.max(p) == pytest.approx(7.98e6, rel=FIT)
    rim = np.min(np.hypot(*(shape.position[np.argmax(p)] - JOINT.pattern.bolt_positions_from_middle).T))
    assert rim < 0.5 * JOINT.pattern.hole_diameter + JOINT.pattern.flange_width / 7  # within one cell
    areas, points = divide_frame_into_cells(JOINT.pattern)
    between = 0.5 * (
        JOINT.pattern.bolt_positions_from_middle[0] + JOINT.pattern.bolt_positions_from_middle[3]
    )
    unit = bolt_pressures(JOINT.pattern, areas, points, between[None, :]).sum()
    assert 9e3 * unit * areas.sum() / JOINT.A_0 == pytest.approx(0.62e6, rel=FIT)


def test_pressures_of_many_load_cases():
    shape = pressure_distribution(JOINT.pattern)
    preload, moment = np.array([[5e3], [9e3]]), np.array([0.0, 1e3, 2e3])
    together = preload_pressure(JOINT, shape, preload, moment)
    assert together.shape == (2, 3, shape.area_share.size)
    # the same sum of two products
    np.testing.assert_allclose(together[1, 2], preload_pressure(JOINT, shape, 9e3, 2e3), rtol=4 * EPS)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"hole_diameter": 0.04}, ("hole_diameter", "0.04 m", "(0, 0.04)")),
        ({"decay_length": 0.0}, ("decay_length", "0 m", "(0, inf)")),
        ({"flange_width": float("nan")}, ("flange_width", "nan m", "(0, inf)")),
    ],
)
def test_impossible_patterns_are_refused(change, words):
    with pytest.raises(ValueError, match=next(iter(change))) as error:
        replace(JOINT.pattern, **change)
    assert all(word in str(error.value) for word in words)


# Sums over nodes


def unit_vectors():
    part = st.floats(-1.0, 1.0)
    vector = st.tuples(part, part, part).map(np.array).filter(lambda v: np.linalg.norm(v) > 0.1)
    return vector.map(lambda v: v / np.linalg.norm(v))


@given(
    position=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    normal=unit_vectors(),
    axis=unit_vectors(),
    stiffness=st.tuples(st.floats(0.0, 1e9), st.floats(0.0, 1e9)),
)
def test_rotation_is_the_energy_of_a_unit_twist(position, normal, axis, stiffness):
    """d^T K d with the stiffness matrix K = K_N n n^T + K_T (1 - n n^T) of one node."""
    node = Footprint(np.array([0.25]), np.array([position]), normal[None, :], np.array([1.0]))
    K_N, K_T = stiffness
    outer = np.outer(normal, normal)
    matrix = K_N * outer + K_T * (np.eye(3) - outer)
    d = np.cross(axis, position)
    expected = 0.25 * d @ matrix @ d
    scale = (K_N + K_T) * (d @ d)
    found = node.rotation(np.array([K_N]), np.array([K_T]), axis)
    assert found == pytest.approx(expected, rel=0.0, abs=1e-14 * scale + 1e-300)  # round-off


def test_rotation_is_the_corrected_eq_45():
    """The rotational stiffness is Eq. 45 of Hu 2023, corrected, with the angles a and b from the normals:

    sum R_a^2 (K_N (cos a sin b)^2 + K_T (1 - (cos a sin b)^2)).
    """
    theta, w, r, slope = np.linspace(0.0, 0.7, 40), 2e-4, 0.017, 0.01
    a, b = (r + w) * np.ones(40), (r - w) * np.ones(40)
    x = np.stack([a * np.cos(theta), b * np.sin(theta), np.linspace(0.0, 0.01, 40)], axis=-1)
    n = np.stack([b * np.cos(theta), a * np.sin(theta), slope * np.cos(2.0 * theta) * r], axis=-1)
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    field = Footprint(np.full(40, 1.0 / 40.0), x, n, np.ones(40))
    alpha = np.arcsin(n[:, 2])
    beta = np.arctan2(n[:, 1], n[:, 0]) - np.arctan2(x[:, 1], x[:, 0])
    R_a = np.hypot(x[:, 0], x[:, 1])
    K_N = np.linspace(1e8, 2e9, beta.size)
    K_T = K_N[::-1]
    part = (np.cos(alpha) * np.sin(beta)) ** 2
    expected = np.sum(field.share * R_a**2 * (K_N * part + K_T * (1.0 - part)))
    assert field.rotation(K_N, K_T, (0, 0, 1)) == pytest.approx(expected, rel=1e-13)  # round-off
    assert np.max(part) > 1e-5  # K_N does take part
    printed = np.sum(
        field.share * R_a * (K_N * np.sin(alpha) * np.cos(beta) + K_T * np.cos(alpha) * np.cos(beta))
    )
    assert field.rotation(K_N, K_T, (0, 0, 1)) < 0.05 * printed  # N, not N m/rad


def test_translation_and_mean():
    nodes = Footprint(np.array([0.25, 0.75]), np.zeros((2, 3)), np.ones((2, 3)), np.array([2.0, 4.0]))
    assert nodes.mean_pressure == 3.5
    assert nodes.translation(np.array([8.0, 4.0])) == 5.0


def test_calibrated_values_are_marked():
    """Values that the published pressures determined have the origin `calibration` in the parameter file."""
    kinds = load_default("bolted_joint").origins
    fitted = {name for name in flatten_parameters(JOINT) if kinds.get(name) == "calibration"}
    assert fitted == {"pattern.decay_length", "pattern.decay_exponent"}


@pytest.mark.parametrize("moment", [True, False])
def test_merged_nodes_keep_the_sums(moment):
    """Merging keeps the total area, pressure and second moments of area.

    Without a moment, nodes of equal preload pressure are merged; else only mirror images.
    """
    shape = pressure_distribution(JOINT.pattern)
    merged = shape.merge_nodes(keeps_moment_pressure=moment)
    mirrors = 2 if moment else 4  # the frame's axes; a moment tells its two rows apart
    assert merged.area_share.size <= shape.area_share.size / mirrors + 4  # but for nodes on an axis
    x2, y2 = shape.position.T**2
    for found, expected in (
        (1.0, 1.0 + 0.0 * x2),
        (merged.preload_pressure_ratio, shape.preload_pressure_ratio),
        (merged.preload_pressure_ratio**2, shape.preload_pressure_ratio**2),
        (merged.mean_square_x, x2),
        (merged.mean_square_y * merged.preload_pressure_ratio, y2 * shape.preload_pressure_ratio),
        (merged.moment_pressure_ratio**2, moment * shape.moment_pressure_ratio**2),
    ):
        # equal is rounded to ALIKE decimals where nodes are compared
        assert np.sum(merged.area_share * found) == pytest.approx(
            shape.area_share @ expected, rel=10.0**-PRESSURE_COMPARISON_DECIMALS
        )
    assert np.max(merged.preload_pressure_ratio) == pytest.approx(
        np.max(shape.preload_pressure_ratio), rel=10.0**-PRESSURE_COMPARISON_DECIMALS
    )
