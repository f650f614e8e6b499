"""The lapped beam (oracles/lap_beam): closed forms, and friction over amplitude on a coarse mesh."""

from dataclasses import replace

import numpy as np
import pytest
from clients import needs
from oracles.lap_beam import brake_reuss as cases
from oracles.lap_beam.brake_reuss import AMPLITUDES, FRICTION_COEFFICIENT, GLUED_STIFFNESS
from oracles.lap_beam.loops import Joint, damping, foundation, frequency, masing_losses, with_friction
from oracles.lap_beam.plan import Fineness
from oracles.lap_beam.reduction import Structure, reduce_beam, spectrum

from jointfmu.mechanics.curve import tabulate_approach

pytestmark = pytest.mark.slow

BAR = replace(cases.beam(), lap=cases.beam().length, bolts=())
"""Two bars, one on the other, without bolts: the lap is as long as the beam."""


@needs("gmsh")
@pytest.mark.parametrize(("shear", "height"), [(GLUED_STIFFNESS, 1.0), (0.0, 0.5)])
def test_bars_on_each_other_have_the_frequency_of_timoshenko(shear, height):
    """Glued bars are one bar; sliding bars have half the height and also rigid sliding modes. Tolerance 0.05
    %: the mesh."""
    structure = Structure.of(BAR, Fineness(far=12e-3, layers=2))
    normal = np.full(structure.interface.quadrature_area.size, GLUED_STIFFNESS)
    found, _ = spectrum(structure, np.column_stack([shear * np.ones_like(normal)] * 2 + [normal]))
    expected = cases.solid_bar_frequency(replace(BAR, side=height * BAR.side))
    assert found[found > 1.0][0] == pytest.approx(expected, rel=5e-4)


@pytest.fixture(scope="module")
def joint():
    """The Brake-Reuss beam on a coarse mesh."""
    structure = Structure.of(cases.beam(), Fineness(near=6e-3, far=8e-3, layers=1))
    law = cases.laws()["roughness"]
    curve, shear = tabulate_approach(law), float(law.shear_stiffness_ratio())
    part = reduce_beam(structure, curve, cases.data()["beam"]["preload"], shear)
    return Joint(part, foundation(curve, shear, FRICTION_COEFFICIENT))


@needs("gmsh")
def test_the_bolts_press_with_their_preload(joint):
    pressure = joint.sliders.pressure_curve.derivatives(joint.beam.approach, 0)[0]
    force = 2.0 * joint.beam.area @ pressure
    assert force == pytest.approx(3.0 * cases.data()["beam"]["preload"], rel=1e-8)


@needs("gmsh")
def test_small_loads_meet_the_linear_mode(joint):
    """A small load (slip below 1e-4 of the displacement) gives the linear modal coordinate and shape."""
    q = 1e-9
    state = joint.apply_load(joint.at_rest(), q * joint.square)
    assert state.q == pytest.approx(q, rel=1e-5)
    assert np.allclose(
        state.displacement, q * joint.beam.shape, atol=1e-3 * q * np.abs(joint.beam.shape).max()
    )


@needs("gmsh")
def test_frequency_falls_and_damping_rises_with_amplitude(joint):
    """At constant pressure the loss of a small cycle grows with the third power of the amplitude, so the
    damping ratio is proportional to it. Patches with little pressure slip completely, which reduces the
    exponent by up to 0.15; the finite number of sliders scatters it by 0.1."""
    states = joint.backbone(AMPLITUDES)
    zeta = np.array([damping(*pair) for pair in zip(masing_losses(states), states, strict=True)])
    assert np.all(np.diff([frequency(state) for state in states]) < 0.0)
    assert np.all(np.diff(zeta[3:]) > 0.0)
    slope = np.polyfit(np.log([state.q for state in states[4:9]]), np.log(zeta[4:9]), 1)[0]
    assert slope == pytest.approx(0.9, abs=0.2)


@needs("gmsh")
def test_a_whole_cycle_closes_and_its_area_is_its_loss(joint):
    """The area by the trapezoidal rule with 8 steps per half cycle is accurate to 3 %. Masing's rules neglect
    that bending opens one end of the lap and closes the other, at most 10 %; with 5 loads their loss is 5 %
    too small."""
    states = joint.backbone(np.geomspace(3e-6, 3e-5, 5))
    loss, cycle = joint.cycle(states[-1], 8)
    load, q = (np.array([getattr(state, name) for state in cycle]) for name in ("load", "q"))
    assert q[-1] == pytest.approx(q[0], rel=1e-3)
    assert q[8] == pytest.approx(-q[0], rel=1e-3)
    assert np.sum(0.5 * (load[1:] + load[:-1]) * np.diff(q)) == pytest.approx(loss, rel=0.05)
    assert masing_losses(states)[-1] == pytest.approx(loss, rel=0.2)


@needs("gmsh")
def test_damping_by_masing_is_never_negative(joint):
    """With high friction there is little slip; the contact becomes stiffer under the load, which is
    no loss."""
    states = with_friction(joint, 0.6).backbone(AMPLITUDES)
    assert np.all(masing_losses(states) > 0.0)
