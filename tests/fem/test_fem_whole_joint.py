"""Complete bolted joint between its attachments: members, interface and bolts."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate
from jointfmu_tools.fem.reduction.states import UnitLoadResponse
from jointfmu_tools.fem.whole_joint import ATTACHMENT_NODES, JointFiniteElements

pytestmark = pytest.mark.slow  # solves finite elements


def lap(length=0.1, width=0.04, thickness=2e-3, nu=0.0, hole=2e-3):
    plate = Plate(length=length, width=width, thickness=thickness, E=206e9, nu=nu, density=7850.0)
    bolts = BoltList(x=(0.0,), y=(0.0,), hole_diameter=hole, head_diameter=2.0 * hole)
    return Assembly("lap", plate, plate, bolts)


def even(joint, tangential, normal):
    """Uniform springs [N/m3] of the contact."""
    return np.tile([tangential, tangential, normal], (joint.contact_interface.quadrature_area.size, 1))


def block(nu=0.0):
    """Joint of thick plates with a wide hole, which needs few elements."""
    return lap(length=0.05, width=0.05, thickness=0.02, nu=nu, hole=8e-3)


@needs("gmsh")
@pytest.mark.parametrize("reach", [0.5, 2.0, 6.0])
def test_a_lap_has_the_compliance_of_shear_lag(reach):
    """Closed form from d'' = beta^2 d with beta^2 = 2 k/(E t): the relative displacement of the ends is F/(E
    t w) (1/(beta tanh(beta L/2)) + L/2). It neglects shear through the thickness, at most (beta t)^2/6 =
    2.4e-3 of d here, and the small hole."""
    assembly = lap()
    joint = JointFiniteElements.from_assembly(assembly, "edge")
    plate, beta = assembly.side1, reach / assembly.side1.length
    # no bending: both plates stay in their planes
    flat = [np.arange(2, body.unknown_count, 3) for body in joint.bodies]
    joint = replace(
        joint,
        attachment_unknowns=tuple(
            np.union1d(a, b) for a, b in zip(joint.attachment_unknowns, flat, strict=True)
        ),
    )
    springs = even(joint, 0.5 * beta**2 * plate.E * plate.thickness, 1e12)
    found = joint.compliances(springs, 0.0).total_compliance[0]
    per = plate.E * plate.thickness * plate.width
    expected = (1.0 / (beta * np.tanh(0.5 * reach)) + 0.5 * plate.length) / per
    assert found == pytest.approx(expected, rel=0.01)


@needs("gmsh")
@pytest.mark.parametrize("attached", ATTACHMENT_NODES)
def test_bodies_without_compliance_leave_the_interface(attached):
    """With plates 1e6 times as stiff, 1e-6 of their compliance remains, which was up to 13 times the
    compliance of the interface."""
    assembly = block()
    stiff = replace(assembly.side1, E=206e15)
    joint = JointFiniteElements.from_assembly(replace(assembly, side1=stiff, side2=stiff), attached)
    found = joint.compliances(even(joint, 1e12, 1e12), 0.0)
    assert found.total_compliance == pytest.approx(found.interface_compliance, rel=1e-4)
    assert found.component_compliances[0] == pytest.approx(found.interface_compliance, rel=1e-4)


@needs("gmsh")
def test_each_stiffer_part_makes_a_stiffer_joint():
    joint = JointFiniteElements.from_assembly(block(nu=0.3), "heads")
    springs = even(joint, 1e12, 1e12)
    base, bolted, rough = (
        joint.compliances(springs * s, bolt) for s, bolt in ((1.0, 0.0), (1.0, 1e9), (0.5, 0.0))
    )
    assert np.all(bolted.total_compliance < base.total_compliance * (1.0 + 1e-9))
    assert np.all(rough.total_compliance > base.total_compliance)
    # in equilibrium bolts and members share the load as their stiffness under the heads does, but for what a
    # mesh that is not symmetric turns
    bolt, members = 1e9, 1.0 / base.total_compliance[2]
    assert bolted.joint_load_factor == pytest.approx(bolt / (bolt + members), rel=1e-5)
    assert 1.0 / bolted.total_compliance[2] == pytest.approx(bolt + members, rel=1e-9)


@needs("gmsh")
def test_a_mirrored_side_moves_as_the_mirror_image():
    """The mirrored side is not solved for. A softer side, other heads, or edges at opposite ends are no
    mirror image."""
    joint = JointFiniteElements.from_assembly(block(nu=0.3), "heads")
    near = SimpleNamespace(points=SimpleNamespace(position=joint.contact_interface.centred_position[::40]))
    springs = even(joint, 1e12, 2e12)

    def moved():
        cells = UnitLoadResponse.from_joint(
            joint, near, np.ones(joint.contact_interface.quadrature_area.size)
        )
        return cells.unit_load_displacement, joint.linearise_joint(springs, 1e8).unit_motion_displacement

    found = moved()
    soft = replace(joint, bodies=(joint.bodies[0], replace(joint.bodies[1], E=1e11)))
    pulled = replace(joint, bolt_head_loads=(joint.bolt_head_loads[0], 2.0 * joint.bolt_head_loads[1]))
    others = (soft, pulled, JointFiniteElements.from_assembly(block(), "edge"))
    assert [each.is_mirrored for each in (joint, *others)] == [True, False, False, False]
    almost = replace(joint.bodies[1], E=joint.bodies[1].E * (1.0 + 1e-12))
    joint = replace(joint, bodies=(joint.bodies[0], almost))
    assert not joint.is_mirrored
    for one, expected in zip(found, moved(), strict=True):
        assert np.max(np.abs(one - expected)) < 1e-9 * np.max(np.abs(expected))
