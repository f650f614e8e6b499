"""Friction patches whose work on the modes of elastic members is that of the complete contact."""

import numpy as np
import pytest
import scipy.sparse as sp
from jointfmu_tools.fem.reduction.patch_work import (
    FrictionPoints,
    PatchFit,
    ShearStates,
    StickContactStiffness,
    compute_friction_work,
    evaluate_friction,
    patch_rotations,
    rigid_displacement_matrix,
    shear_combinations,
    stick_stiffness_matrix,
)

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.mechanics.footprint.distribution import FrictionPatches
from jointfmu.parameters import load_default

RADIUS, COUNT, PATCHES = 0.02, 24, 10
LEVELS = np.array([0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3])


@pytest.fixture(scope="module")
def disc():
    """Uniformly pressed disc of many points whose middle lags behind by two modes, and its patches."""
    law = BoltedJointSpring.from_joint(load_default("bolted_joint").values).friction_law.foundation()
    line = RADIUS * (np.arange(COUNT) + 0.5) / COUNT * 2.0 - RADIUS
    place = np.stack([each.ravel() for each in np.meshgrid(line, line)], axis=1)
    place = place[np.hypot(*place.T) < RADIUS]
    lag, nothing = 1.0 - np.sum(place**2, axis=1) / RADIUS**2, np.zeros(len(place))
    rows = np.concatenate([np.stack([-lag, nothing], axis=1), np.stack([nothing, -lag], axis=1)])
    approach = float(law.pressure_curve.inverse(5e6))
    area = np.full(len(place), 1e-6)
    points = FrictionPoints(area, np.full(len(place), approach), rigid_displacement_matrix(place))
    number = np.arange(PATCHES) + 0.5
    far, angle = RADIUS * np.sqrt(number / PATCHES), np.pi * (3.0 - np.sqrt(5.0)) * number
    seed = np.stack([far * np.cos(angle), far * np.sin(angle)], axis=1)
    cell = np.argmin(np.hypot(*(place[:, None] - seed).transpose(2, 0, 1)), axis=1)
    means = np.stack([cell == i for i in range(PATCHES)]) / np.bincount(cell)[:, None]
    few = FrictionPoints(
        1e-6 * np.bincount(cell), np.full(PATCHES, approach), rigid_displacement_matrix(means @ place)
    )
    both = np.concatenate([means @ rows[: len(place)], means @ rows[len(place) :]])
    motion = np.zeros((21, 6))
    reach = law.friction_coefficient / law.stiffness_ratio * approach
    for i, (axis, arm) in enumerate(((0, 1.0), (1, 1.0), (5, RADIUS))):
        motion[7 * i : 7 * i + 7, axis] = 0.3 * reach / arm * LEVELS
    amplitude = 0.7 * motion[:, :2]
    slip = shear_combinations(motion)
    shears = ShearStates((slip @ motion)[:, (0, 1, 5)], slip @ amplitude)
    return law, points, rows, few, both, shears


LINEAR = ShearStates(np.eye(3), np.array([[0.7, 0.0], [0.0, 0.7], [0.0, 0.0]]))


def tightened(disc) -> StickContactStiffness:
    """Stick stiffness of a joint that is twice as stiff as its contact."""
    law, points, rows = disc[:3]
    full = stick_stiffness_matrix(evaluate_friction(law, LINEAR, points, rows)[1], points.point_area)
    return StickContactStiffness(LINEAR, full, 2.0 * full.diagonal())


def fit(disc) -> PatchFit:
    law, points, rows, few, means, shears = disc
    return PatchFit(
        law, shears, few, 0.0 * means, compute_friction_work(law, shears, points, rows), tightened(disc)
    )


def test_shears_have_one_or_two_components_of_motion(disc):
    shears = disc[-1]
    moving = np.count_nonzero(shears.rigid_motion, axis=1)
    assert len(moving) == 63
    assert (np.sum(moving == 1), np.sum(moving == 2)) == (21, 42)


def test_patches_lose_and_resist_as_all_points(disc):
    """Patches at the mean displacements dissipate too little in partial slip; fitted patches do not."""
    law, points, rows, few, means, shears = disc
    aim = compute_friction_work(law, shears, points, rows)
    fitted = fit(disc).fit_patches(means)
    before, after = (compute_friction_work(law, shears, few, each) for each in (means, fitted))
    partial = np.arange(1, 7)  # along x
    assert np.min(before.cycle_loss[partial] / aim.cycle_loss[partial]) < 0.97
    np.testing.assert_allclose(after.cycle_loss[partial], aim.cycle_loss[partial], rtol=0.03)
    size = np.linalg.norm(aim.friction_forces[:7, :2], axis=1)
    missed = [
        np.max(np.linalg.norm((w.friction_forces - aim.friction_forces)[:7, :2], axis=1) / size)
        for w in (before, after)
    ]
    assert missed[1] < max(0.5 * missed[0], 0.01)


def test_the_tightened_joint_stays_as_stiff(disc):
    """The fitted patches keep the stiffness of linear states without slip, and have the same loss."""
    law, few, means = disc[0], disc[3], disc[4]
    working, full = fit(disc), tightened(disc).contact_stiffness
    fitted = working.fit_patches(means)
    found = [
        stick_stiffness_matrix(evaluate_friction(law, LINEAR, few, each)[1], few.point_area)
        for each in (means, fitted)
    ]
    missed = [np.max(np.abs(each - full)[:2]) / np.max(np.abs(full)) for each in found]
    assert missed[0] > 0.01
    assert missed[1] < 2e-4
    assert np.max(np.abs(fitted - means)) < 0.5


def test_slopes_of_the_tightened_stiffness_are_those_of_differences(disc):
    means, working, step = disc[4], fit(disc), 1e-6
    slope = working._stiffness_jacobian(means, working._stiffness_errors(means)[1])
    for index in ((0, 0), (5, 1), (PATCHES + 2, 1)):
        there = [means.copy(), means.copy()]
        there[0][index] -= step
        there[1][index] += step
        low, high = (working._stiffness_errors(each)[0] for each in there)
        column = slope[:, np.ravel_multi_index(index, means.shape)]
        np.testing.assert_allclose((high - low) / (2 * step), column, atol=1e-6 * np.abs(slope).max())


def test_slopes_are_those_of_differences(disc):
    means, working = disc[4], fit(disc)
    slope, step = working._work_jacobian(means, *working._work_errors(means)[1]), 1e-6
    for index in ((0, 0), (5, 1)):
        there = [means.copy(), means.copy()]
        there[0][index] -= step
        there[1][index] += step
        low, high = (working._work_errors(each)[0] for each in there)
        column = slope[:, np.ravel_multi_index(index, means.shape)]
        np.testing.assert_allclose((high - low) / (2 * step), column, atol=2e-4 * np.abs(column).max())


def test_a_patch_of_a_single_point_does_not_rotate():
    """Side 2 rotates by 1 rad about the origin. A cell of four points rotates with it. A cell of one point
    has no rotation, although its centre differs from its point by the round-off of 49 (1/49) < 1."""
    place = np.array([[0.0, 0.0], [2e-3, 0.0], [0.0, 2e-3], [2e-3, 2e-3], [0.03, 0.01]])
    means = sp.csr_matrix([[0.25] * 4 + [0.0], [0.0] * 4 + [49.0 * (1.0 / 49.0)]])
    assert (means @ place)[1, 0] != place[4, 0]
    each = np.ones(2)
    centres = np.array([[1e-3, 1e-3], [0.03, 0.01]])
    patches = FrictionPatches(0.5 * each, centres, each, 0.0 * each, 0.0 * each)
    turned = [-place[:, 1:], place[:, :1]]
    rotations = patch_rotations(place, patches, means, turned)
    np.testing.assert_allclose(rotations[:, 0], [1.0, 0.0], atol=1e-12)
