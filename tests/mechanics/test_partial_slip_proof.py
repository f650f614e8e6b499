"""Friction with history against boundary elements with partial slip, an independent method.

The tables of docs/validity_friction.md come from studies/validity_friction.py. The tests have surfaces of
other seeds, on 64 points. Bounds on displacements and loops are those that the theory keeps where many hills
carry, 5 % and 10 %, and on most single ones; the solver's own are errors seen on these grids, less than three
times.
"""

import numpy as np
import pytest
from clients import needs
from oracles import partial_slip
from oracles import partial_slip_cases as cases

pytestmark = pytest.mark.slow

POINTS = 64
MANY = cases.heights(0.3, 4, 900, points=POINTS)
FEW = cases.heights(0.8, 1, 901, points=POINTS)
"""Heights of rough squares: MANY has sixteen hills, FEW has one."""


def compare(z, nu, axis=0, amplitudes=cases.AMPLITUDES):
    contact = cases.rough_contact(z, nu)
    return cases.compare(contact, cases.predict(contact, amplitudes), axis)


def test_a_sphere_slips_as_cattaneo_and_mindlin_say():
    coarse, fine = (cases.sphere_errors(points, nu=0.0) for points in (24, 48))
    assert abs(fine[0]) < 5e-4
    assert np.abs(fine[1]).max() < 1e-3
    assert (
        np.abs(fine[2][2:]).max() < 2e-3
    )  # at a fifth of the limit the ring that slips is two elements wide
    assert np.abs(fine[1]).max() < 0.5 * np.abs(coarse[1]).max()
    assert np.abs(fine[2]).max() < 0.5 * np.abs(coarse[2]).max()


def test_poissons_ratio_moves_the_sphere_by_less_than_a_hundredth():
    _, displacement, loop = cases.sphere_errors(48, nu=0.3)
    assert (
        5e-4 < np.abs(displacement).max() < 2e-3
    )  # Cattaneo and Mindlin leave out the slip across the force
    assert np.abs(loop[2:]).max() < 0.01


@pytest.mark.parametrize("z", [MANY, FEW], ids=["many hills", "one hill"])
def test_without_poissons_effect_the_theory_is_exact_on_the_same_grid(z):
    one = compare(z, nu=0.0)
    assert one.theory == pytest.approx(1.0, abs=1e-4)  # solved to 1e-7 of the largest traction
    assert one.loop_theory == pytest.approx(1.0, abs=1e-3)  # of the least loop's work a hundredth is lost
    assert np.abs(one.across).max() < 1e-12


@pytest.mark.parametrize("z", [MANY, FEW], ids=["many hills", "one hill"])
def test_the_normal_curve_foretells_displacement_and_loop(z):
    for axis in (0, 1):
        one = compare(z, 0.3, axis)
        assert one.theory == pytest.approx(1.0, abs=0.05)
        assert one.loop_theory == pytest.approx(1.0, abs=0.10)
        assert one.loop_sliders[1:] == pytest.approx(1.0, abs=0.10)  # below it few of the 64 sliders slip
        assert np.abs(one.across).max() < 0.05
        assert one.open < 1e-3


def test_a_sphere_of_the_same_stiffness_does_not():
    one = compare(MANY, 0.3)
    assert np.abs(one.sphere - 1.0).max() > 0.25
    assert np.abs(one.loop_sphere - 1.0).min() > 0.25


def test_ridges_are_stiffer_across_and_softer_along_than_one_ratio_says():
    z = cases.heights(0.8, 1, 900, points=POINTS, stretch=4)
    across, along = (compare(z, 0.3, axis, (0.5,)) for axis in (0, 1))
    assert across.theory[0] > 1.02
    assert along.theory[0] < 0.98
    plane = (
        1.0 / cases.rough_contact(z, 0.3).space.stiffness_ratio
    )  # an endless ridge: 1 across, 1 - nu along
    assert across.theory[0] < plane
    assert along.theory[0] > 0.7 * plane


def test_smaller_steps_of_the_history_change_little():
    contact = cases.rough_contact(FEW, 0.3)
    prediction = cases.predict(contact, ())
    one = cases.backbone(contact, prediction.shift, 0)[-1]
    finer = np.sort(
        np.concatenate([prediction.shift, prediction.shift - 0.5 * np.diff(prediction.shift, prepend=0.0)])
    )
    many = cases.backbone(contact, finer, 0)[-1]
    assert one.force == pytest.approx(many.force, rel=0, abs=2e-4 * contact.load)
    fine = np.polynomial.legendre.leggauss(12)
    assert cases.follow_loop(contact, one, 0).area == pytest.approx(
        cases.follow_loop(contact, many, 0, fine).area, rel=5e-3
    )


def test_no_traction_exceeds_the_friction_and_slip_works_against_it():
    contact = cases.rough_contact(FEW, 0.3)
    before = cases.backbone(contact, [0.2 * np.ptp(FEW)], 0)[0]
    after = contact.shear_to(before, (0.2 * np.ptp(FEW), 0.1 * np.ptp(FEW)))
    size = np.hypot(*after.traction)
    assert np.all(size <= contact.pressure * (1.0 + 1e-12))
    slip = (after.shift - before.shift)[:, None, None] - (after.displacement - before.displacement)
    slip = slip[:, contact.pressure > 0.0]
    traction, limit = after.traction[:, contact.pressure > 0.0], contact.pressure[contact.pressure > 0.0]
    work, largest = np.sum(slip * traction, axis=0), np.hypot(*slip)
    sticks = np.hypot(*traction) < limit * (1.0 - 1e-6)
    assert 0 < sticks.sum() < limit.size
    assert largest[sticks].max() < 1e-4 * largest.max()
    assert work[~sticks] == pytest.approx((largest * limit)[~sticks], rel=1e-3, abs=1e-4 * work.max())


@needs("tamaas")
def test_the_normal_contact_is_that_of_another_solver():
    from oracles.boundary_element import press

    contact = cases.rough_contact(MANY, 0.3)
    other = press(MANY, [contact.load])[0]
    assert other.separation == pytest.approx(-contact.approach, rel=1e-6)
    assert contact.pressure == pytest.approx(other.pressure, abs=1e-3 * contact.load)


def test_a_square_that_does_not_repeat_answers_like_points_far_from_the_load():
    """Boussinesq and Cerruti, E* = 1: P/(pi r) normal, Q/(pi r) across and 1 + nu/(1 - nu) times it along the
    force."""
    space, nu = partial_slip.single_square(POINTS, 0.3), 0.3
    force = np.zeros((2, POINTS, POINTS))
    force[0, 0, 0] = POINTS**2
    far = POINTS - 1
    r = far / POINTS
    assert space.normal_displacement(force[0])[far, 0] == pytest.approx(1.0 / (np.pi * r), rel=1e-3)
    shift = space.tangential_displacement(force)
    assert shift[0, far, 0] == pytest.approx((1.0 + nu / (1.0 - nu)) / (np.pi * r), rel=1e-3)
    assert shift[0, 0, far] == pytest.approx(1.0 / (np.pi * r), rel=1e-3)
    assert shift[1, far, far] == pytest.approx(nu / (1.0 - nu) / (2.0**1.5 * np.pi * r), rel=1e-3)
