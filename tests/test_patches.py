"""Few patches stand for the nodes of a bolted contact."""

from functools import cache

import numpy as np
import patch_reduction
import pytest

from jointfmu.footprint.bolts import pressure_shape
from jointfmu.footprint.patches import few_points
from jointfmu.footprint.plate import BoltedPlate
from jointfmu.footprint.shape import PressureShape
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.parameters import default

CONTACTS = ("frame", "plate", "row")


@cache
def contact(name: str) -> PressureShape:
    """The default frame, a plate without symmetry, a plate with one row of bolts."""
    if name == "frame":
        return pressure_shape(default("bolted_joint").values.pattern)
    if name == "plate":
        x, y, hole, cone = (-0.1, 0.0, 0.1, 0.1), (0.02, -0.03, 0.02, -0.02), 0.011, 0.03
        return BoltedPlate(length=0.3, width=0.1, x=x, y=y, hole_diameter=hole, cone_diameter=cone).shape()
    x, y, hole, cone = (-0.03, 0.0, 0.03), (0.0, 0.0, 0.0), 0.0085, 0.02
    return BoltedPlate(length=0.12, width=0.025, x=x, y=y, hole_diameter=hole, cone_diameter=cone).shape()


@cache
def reduced(name: str, count: int) -> PressureShape:
    """Few points of it."""
    return few_points(contact(name), count)


def balance(shape: PressureShape) -> np.ndarray:
    """Sums that are exact, each over the sum of its sizes."""
    (x, y), share, equal, tilt = shape.position.T, shape.share, shape.equal, shape.tilt
    one = np.ones_like(x)
    rows = np.stack([one, x, y, x * x, x * y, y * y, equal, equal * x, equal * y, tilt, tilt * x, tilt * y])
    return rows @ share, np.abs(rows) @ share


@pytest.mark.parametrize("count", [40, 160])
@pytest.mark.parametrize("name", CONTACTS)
def test_few_points_keep_share_and_moments_to_rounding(name, count):
    """Area, centroid, second moments, force and moment of the preload and of the moment; shares positive."""
    shape = contact(name)
    points = reduced(name, count)
    assert points.share.size <= count
    assert np.min(points.share) > 0.0
    there, size = balance(shape)
    np.testing.assert_allclose(balance(points)[0] / size, there / size, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("name", CONTACTS)
def test_largest_pressure_is_that_of_all_nodes(name):
    """Under moments of both signs, to the last bit."""
    shape = contact(name)
    points = reduced(name, 160)
    for moment in np.linspace(-1.0, 1.0, 41):
        assert np.max(points.equal + moment * points.tilt) == np.max(shape.equal + moment * shape.tilt)


def test_few_nodes_stay_as_they_are():
    shape = contact("frame")
    assert few_points(shape, shape.share.size) is shape


def test_points_are_the_same_on_every_run():
    one, other = (few_points(contact("plate"), 40) for _ in range(2))
    assert np.array_equal(one.share, other.share)
    assert np.array_equal(one.position, other.position)


def test_too_few_points_are_refused():
    with pytest.raises(ValueError, match=r"^6 points are too few, expected at least \d+ for this contact$"):
        few_points(contact("frame"), 6)


@pytest.fixture(scope="module")
def spring() -> BoltedJointSpring:
    """The default joint, whose curve the points do not know."""
    return BoltedJointSpring.of(default("bolted_joint").values)


@pytest.mark.parametrize(
    ("states", "force", "stiffness"),
    [("no tilt", 2e-5, 1e-4), ("tilt 0.1", 4e-4, 1e-3), ("opening", 6e-3, 2e-2)],
)
@pytest.mark.parametrize("name", CONTACTS)
def test_force_and_stiffness_are_those_of_all_nodes(spring, name, states, force, stiffness):
    """160 points, over preload, moment, displacement and tilt: about four times what the benchmark prints."""
    shape = contact(name)
    states = patch_reduction.ranges(patch_reduction.opening_moment(shape))[states]
    mean = patch_reduction.mean_pressure(spring)
    found = patch_reduction.deviation(spring.curve, mean, shape, reduced(name, 160), states, 16)
    assert found[0] < force
    assert found[1] < stiffness


@pytest.mark.slow
@pytest.mark.parametrize("motion", patch_reduction.MOTIONS)
def test_friction_of_few_patches_is_that_of_all_nodes(spring, motion):
    """28 patches of a field of 400 nodes: forces within 2 % of gross slip, areas of loops within 3 %.

    About twice what the benchmark prints.
    """
    shape, motion = patch_reduction.field(), patch_reduction.MOTIONS[motion]
    start = patch_reduction.tightened(spring.curve, shape, (patch_reduction.mean_pressure(spring), 0.0))
    largest = float(np.max(start) - spring.curve.displacement[0])
    force, loss = patch_reduction.friction(spring, shape, True, largest, motion)
    few, lost = patch_reduction.friction(spring, few_points(shape, 28), False, largest, motion)
    np.testing.assert_allclose(few, force, rtol=0.0, atol=0.02 * np.max(np.abs(force)))
    np.testing.assert_allclose(lost, loss, rtol=0.03)
