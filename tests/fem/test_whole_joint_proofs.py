"""References of the complete bolted joint: closed forms, Coulomb springs, finite elements with friction."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from clients import needs
from oracles.coulomb_springs import Springs
from oracles.joint_elements import (
    JOINTS,
    LAP_LOAD,
    STEPS,
    FrictionElements,
    Lap,
    PlateJoint,
    cycle_loads,
    follow_loads,
    stiffnesses,
    vdi_2230,
)
from oracles.lap_beam import brake_reuss as cases
from oracles.lap_beam.reduction import patches

from jointfmu.joints.bolted_joint.joint import JointInputs
from jointfmu.joints.bolted_joint.kinematics import rigid_opening
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.mechanics.sliders import Foundation


def test_the_form_of_the_lap_is_that_of_the_scan():
    """The gap is the mean of two cells of the scan: column 100 of 246, rows 27 and 28 of 54 (+-0.25 mm)."""
    gap, x = cases.form(), np.linspace(-61.206e-3, 61.206e-3, 246)[100]
    text = (files("jointfmu_models") / "reference" / "brake_reuss_lap_form.csv").read_text()
    rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    expected = 0.5 * sum(float(rows[i][100]) for i in (26, 27))
    y = 0.5 * 26.4e-3 / 53
    assert 1e6 * gap(np.array([x]), np.array([y]))[0] == pytest.approx(expected, rel=1e-6)
    places = np.meshgrid(np.linspace(-0.06, 0.06, 25), np.linspace(0.0, 12.7e-3, 7))
    assert 0.0 <= gap(*places).min() < 6e-6 < 90e-6 < gap(*places).max() < 110e-6
    np.testing.assert_allclose(gap(*places), gap(places[0], -places[1]))


def test_a_crown_touches_first_where_it_is_highest():
    x = np.linspace(-0.06, 0.06, 25)
    for height, first in ((2e-5, 12), (-2e-5, 0)):
        gap = cases.crown(height, 0.12)(x, 0.0 * x)
        assert gap.argmin() == first
        assert np.ptp(gap) == pytest.approx(2e-5)
        assert gap.min() == pytest.approx(0.0, abs=1e-18)


def test_a_bar_of_any_width_has_the_frequency_of_a_square_one():
    square = cases.beam()
    assert cases.solid_bar_frequency(replace(square, width=0.01)) == pytest.approx(
        cases.solid_bar_frequency(square), rel=1e-12
    )


def test_vdi_2230_vdi_2230():
    """Load factor and bolt force by hand: M16 through 2 x 20 mm at 60 kN preload, with 30 kN at its heads."""
    factor, added, opens = vdi_2230(5.575e8, 2.487e9, 9.4e10, 30e3)
    assert (round(factor, 3), round(added, -2), round(opens, 2)) == (0.187, 5600.0, 1.23)


def test_springs_of_coulomb_have_backbone_and_loop_of_the_theorem():
    """Error by the distance of the springs: 0.17 % of the force; of the loss 3 % at the first amplitude, 0.08
    % at the others."""
    law = tabulate_approach(cases.laws()["roughness"])
    springs = Springs.of(law, 0.8, 0.15)
    exact = Foundation(law, 0.8, 0.15, springs.edges)
    delta = law.inverse(np.array([1e6, 5e6, 2e7]))
    full = 0.15 * law.derivatives(delta, 0)[0] / exact.stick_stiffness(delta)
    for part in (0.1, 0.5, 1.0, 2.0):
        shift = np.column_stack([0.6 * part * full, 0.8 * part * full])
        up = springs.advance(springs.virgin_forces(3), delta, delta, shift)
        force = np.hypot(*up.traction.T)
        np.testing.assert_allclose(force, exact.virgin_traction(delta, part * full), rtol=3e-3)
        down = springs.advance(up.force, delta, delta, -2.0 * shift)
        again = springs.advance(down.force, delta, delta, 2.0 * shift)
        heat = exact.cycle_energies(delta, part * full)[0]
        np.testing.assert_allclose(
            down.dissipated_energy + again.dissipated_energy, heat, rtol=2e-3 if part > 0.1 else 0.05
        )


@needs("gmsh")
@pytest.mark.slow
def test_elements_with_friction_are_linear_first_and_slip_at_last():
    """A thin lap under uniform pressure: first its linear stiffness, finally Coulomb's force, for
    any mesh."""
    lap = Lap.of(0.5)
    _, spring, _ = lap.linear(4.0)
    bodies = replace(lap.bodies, contact_interface=patches(lap.bodies.contact_interface))
    area = bodies.contact_interface.quadrature_area
    friction = lap.values.mu * LAP_LOAD
    elements = FrictionElements.of(
        bodies, np.full(area.size, LAP_LOAD / area.sum()), spring, friction, np.eye(6)[0]
    )
    (small, most), (none, heat) = elements.follow([1e-3, 2.0])
    assert small == pytest.approx(1e-3 * elements.stiffness, rel=1e-6)
    assert none == pytest.approx(0.0, abs=1e-9 * heat)
    # plates held flat, nu = 0: the pressure stays, within what shear does to it at the edges
    assert most / elements.motion[0] == pytest.approx(friction, rel=5e-3)
    force, loss = elements.follow(list(cycle_loads(0.6)))
    f, x = force[STEPS - 1 :], cycle_loads(0.6)[STEPS - 1 :]
    work = 0.5 * np.sum((f[1:] + f[:-1]) * np.diff(x))
    # chords of 8 steps each way lie inside a loop: 1.6 % of its area if it is of parabolas, 6.0 % measured
    assert work < loss[-1] - loss[STEPS - 1] < 1.07 * work


@needs("gmsh")
@pytest.mark.slow
@pytest.mark.parametrize("reach", [0.5, 2.0, 6.0])
def test_a_reduced_lap_has_the_compliance_of_shear_lag(reach):
    """Closed form: 0.3 % by shear through the thickness; fit of the patches: 0.2 % (2e-4 of the stiffness for
    each pair of motions). An interface of constant stiffness loses nothing below its friction limit: on this
    mesh, relative errors of such losses led the fit to 4.7 times the compliance of the shortest lap."""
    modes, elements, form = Lap.of(0.7).compliances(reach)
    assert elements == pytest.approx(form, rel=3e-3)
    assert modes == pytest.approx(form, rel=5e-3)


@needs("gmsh")
@pytest.mark.slow
def test_a_bracket_slips_under_a_lever_as_its_elements_do():
    """Loading to slip, three times as far, and back. Measured: 1.2 % of the force, 1.9 % of the heat, with
    coarse elements.

    The friction limit follows the normal force of the contact, also where it bends. With patches that open
    independently of the contact, the wide path of six directions at the end has no equilibrium.
    """
    attached, drawing, wrench = JOINTS["bracket"]
    joint = PlateJoint.of(attached, drawing, 0.7, elements=True)
    elements = FrictionElements.clamped(joint, wrench)
    loads = [0.5, 1.0, 2.0, 3.0, 2.0, 0.0, -2.0, -3.0]
    force, heat = elements.follow(loads)
    found, lost = follow_loads(joint.spring, joint.preload, elements.motion, loads)
    assert force[1] < 0.7 * elements.stiffness  # it slips
    np.testing.assert_allclose(found[:2], force[:2], atol=0.02 * force[1])
    np.testing.assert_allclose(found, force, atol=0.025 * force[3])
    np.testing.assert_allclose(lost[3:], heat[3:], rtol=0.02)

    spring, rng = joint.spring, np.random.default_rng(5)
    there, back = rng.uniform(-0.2, 0.2, (2, 6)) * joint.load() / stiffnesses(joint)[0]
    angles = np.linspace(0.0, 2.0 * np.pi, 25)
    memory, start = spring.initial_history(), spring.preloaded_approach(joint.preload, 0.0)
    for six in np.outer(np.sin(angles), there) + np.outer(1.0 - np.cos(angles), back):
        memory = spring.advance(JointInputs(joint.preload, 0.0, six), memory)[1]
        after = spring.history_layout.split(memory)
        modal_coordinates = after["modal_coordinates"][: len(spring.modes.modal_stiffness)]
        opened = rigid_opening(spring.points.position, six) + spring.modes.point_opening @ modal_coordinates
        points, few = (spring.curve.derivatives(x, 0)[0] for x in (start - opened, after["approach"]))
        assert spring.patches.area_share @ few == pytest.approx(spring.points.area_share @ points, rel=2e-4)
