"""Points and patches of a contact do not depend on the last bits of their inputs."""

import numpy as np
import pytest
from oracles import contact_patches
from test_patches import CONTACTS, balance, contact

from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.mechanics.footprint.patch_reduction import reduce_patches
from jointfmu.mechanics.footprint.point_reduction import reduce_points
from jointfmu.mechanics.footprint.reproducible import (
    clear_round_off,
    matrix_product,
    raise_to_power_of_two,
    round_distribution,
    take_power_of_two_root,
)

AGREE = 1e-9
NUMBERS = ("area_share", "position", "preload_pressure_ratio", "moment_pressure_ratio")


def shape_of(name: str) -> PressureDistribution:
    """Pressure distribution: default frame, plate without symmetry, one row of bolts, nodal field, README
    plate."""
    if name == "readme":
        bolts = ((x, y) for x in (-0.08, 0.08) for y in (-0.03, 0.03))
        return contact_patches.bolted_plate(*bolts, size=(0.2, 0.1), hole=0.0135, cone=0.0411)
    return contact_patches.nodal_field() if name == "field" else contact(name)


def perturbed(shape: PressureDistribution, rng: np.random.Generator) -> PressureDistribution:
    """Distribution with every number changed by a relative 1e-15, up or down."""
    values = (getattr(shape, name) for name in NUMBERS)
    return PressureDistribution(*(v * (1.0 + 1e-15 * rng.choice([-1.0, 1.0], v.shape)) for v in values))


def content(distribution: PressureDistribution) -> bytes:
    """All numbers of a distribution as bytes."""
    return b"".join(getattr(distribution, name).tobytes() for name in NUMBERS)


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CONTACTS, "field", "readme"])
def test_points_and_patches_are_those_of_inputs_a_bit_off(name):
    """All numbers agree within 1e-9; the exact sums are those of the perturbed contact. The perturbation
    changes thousands of numbers, so some are at the limit of rounding."""
    shape = shape_of(name)
    other = perturbed(shape, np.random.default_rng(4))
    there, size = balance(other)
    for reduce, count in ((reduce_points, 120), (reduce_patches, 22)):
        one, few = reduce(shape, count), reduce(other, count)
        np.testing.assert_allclose(few.area_share, one.area_share, rtol=AGREE)
        for number in NUMBERS[1:]:
            was, now = getattr(one, number), getattr(few, number)
            np.testing.assert_allclose(now, was, rtol=AGREE, atol=AGREE * np.max(np.abs(was)))
            assert np.array_equal(now == 0.0, was == 0.0)
        np.testing.assert_allclose(balance(few)[0] / size, there / size, rtol=0.0, atol=1e-13)


def test_rounded_numbers_keep_their_place():
    """Rounding moves a number by at most half a step plus the offset of the rounding limit; rounding again
    changes nothing."""
    rng = np.random.default_rng(2)
    shape = PressureDistribution(
        rng.random(99), rng.standard_normal((99, 2)), rng.random(99), rng.standard_normal(99)
    )
    once = round_distribution(shape)
    assert content(round_distribution(once)) == content(once)
    assert np.max(np.abs(once.area_share / shape.area_share - 1.0)) < 2.0**-19
    assert np.max(np.abs(once.moment_pressure_ratio - shape.moment_pressure_ratio)) < 2.0**-19 * np.max(
        np.abs(shape.moment_pressure_ratio)
    )
    mirrored = round_distribution(
        PressureDistribution(
            shape.area_share, -shape.position, shape.preload_pressure_ratio, -shape.moment_pressure_ratio
        )
    )
    assert np.array_equal(mirrored.position, -once.position)
    assert np.array_equal(mirrored.moment_pressure_ratio, -once.moment_pressure_ratio)


def test_what_rounding_leaves_is_zero():
    shape = PressureDistribution(
        np.ones(2), np.array([[1.0, 1e-17], [-1.0, 2.0]]), np.ones(2), np.array([1e-18, 0.5])
    )
    found = clear_round_off(shape)
    assert found.position[0, 1] == found.moment_pressure_ratio[0] == 0.0
    assert np.array_equal(found.position[1], shape.position[1])


def test_functions_are_those_of_numpy():
    """Roots, powers of two and products of matrices agree with numpy."""
    rng = np.random.default_rng(3)
    values, power = rng.random((4, 9)), np.array([[2.0], [4.0], [16.0], [64.0]])
    np.testing.assert_allclose(take_power_of_two_root(values, power), values ** (1.0 / power), rtol=1e-15)
    np.testing.assert_allclose(raise_to_power_of_two(values, power), values**power, rtol=1e-14)
    one, other = rng.standard_normal((3, 50)), rng.standard_normal((4, 50))
    np.testing.assert_allclose(matrix_product(one, other), one @ other.T, rtol=0.0, atol=1e-13)
