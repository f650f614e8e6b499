"""Moment at which the contact of a bolted joint opens: by hand, and by the model's own outputs."""

from dataclasses import replace

import numpy as np
import pytest
from clients import needs
from jointfmu_tools import cli
from jointfmu_tools.joints.bolted_joint import report
from jointfmu_tools.joints.bolted_joint.external_load import (
    OPEN_PRESSURE_RATIO,
    OPENING_MOMENT_TOLERANCE,
    ExternalLoad,
    compute_opening_moment,
)

from jointfmu.contact.laws.table import StiffnessTable
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.parameters import load_default, load_parameter_file

PRELOAD = 10e3
LENGTH, WIDTH = 0.18, 0.12
"""Rectangular interface [m]."""


def uniform_joint(columns, rows):
    """Linear interface (constant stiffness) under a uniform pressure between rigid sides, on a grid of
    nodes."""
    table = StiffnessTable(pressure=(1e4, 1e8), stiffness=(1e13, 1e13), ratio=0.5, factor=1.0)
    values = replace(
        load_default("bolted_joint", "table").values,
        table=table, A_0=LENGTH * WIDTH, bolt_stiffness=0.0, embedding=0.0, sides="rigid",
    )  # fmt: skip
    x, y = (size * ((np.arange(n) + 0.5) / n - 0.5) for size, n in ((LENGTH, columns), (WIDTH, rows)))
    position = np.array([each.ravel() for each in np.meshgrid(x, y)]).T
    one = np.ones(len(position))
    nodes = PressureDistribution(one / len(one), position, one, 0.0 * one)
    return BoltedJointSpring.from_interface_nodes(values, nodes)


@pytest.mark.parametrize(("axis", "size", "grid"), [(0, WIDTH, (2, 60)), (1, LENGTH, (60, 2))])
def test_a_uniform_pressure_opens_at_the_edge_as_by_hand(axis, size, grid):
    """p = F/A and M/W are equal at the edge: M = F b/6. The last of 60 rows is half a row inside."""
    joint = uniform_joint(*grid)
    force = PRELOAD * joint.joint.n_bolts
    by_hand = force * size / 6.0 * (1.0 + 1.0 / 60.0) * (1.0 - OPEN_PRESSURE_RATIO)
    found = compute_opening_moment(joint, PRELOAD, 0.0, axis)
    assert found == pytest.approx(by_hand, rel=2.0 * OPENING_MOMENT_TOLERANCE)
    assert compute_opening_moment(joint, 2.0 * PRELOAD, 0.0, axis) == pytest.approx(2.0 * found, rel=2e-3)


@pytest.mark.slow
@needs("gmsh")
def test_the_complete_joint_has_this_moment_alone(elastic_joint):
    """At the rotation of the opening moment, the outputs of the joint have this moment and no other force.

    The solution has the secant stiffness of friction, the outputs its history: 1e-3 of the bolt force.
    """
    file = load_parameter_file(elastic_joint / "joint.toml")
    spring, preload = BoltedJointSpring.from_joint(file.values), file.start_value("preload")
    found = compute_opening_moment(spring, preload, 0.0, 0)
    load = ExternalLoad(spring, preload, 0.0, direction=3)
    tightened = load.pressure(load.unloaded_state)
    closed = tightened > OPEN_PRESSURE_RATIO * (spring.points.area_share @ tightened)
    ratios = []
    for moment in (found, -found):
        state = load.unloaded_state
        for part in np.linspace(0.1, 1.0, 10):
            state = load.solve_equilibrium(part * moment, state)
        out = spring.evaluate(preload, 0.0, tuple(state[:3]), (0.0,) * 3, tuple(state[3:6]))
        assert out["m_x"] == pytest.approx(-moment, rel=1e-3)
        for name in ("f_x", "f_y", "f_z"):
            assert abs(out[name]) < 1e-3 * preload, name
        ratios.append(np.min(load.pressure(state)[closed] / tightened[closed]))
    # the pressure falls by about 10 % for 1 % of moment
    assert np.min(ratios) == pytest.approx(OPEN_PRESSURE_RATIO, rel=20.0 * OPENING_MOMENT_TOLERANCE)
    still = spring.evaluate(preload, 0.0, (0.0,) * 3, (0.0,) * 3)
    assert 0.5 < out["K_rx"] / still["K_rx"] < 1.0  # it begins to open: not much is lost yet


def test_bolts_that_differ_in_the_added_force_are_not_called_equal():
    """Two bolts share a curve if the forces that the load adds are equal, however large the preload is."""
    added = np.array([1.0, 1.02, 1.0, 1.02 + 1e-5])  # 2 % apart: 0.1 % of the whole force
    forces = 20e3 + np.outer(added, np.linspace(0.0, 1e3, 5))
    assert report._group_equal_bolts(forces) == [[0, 2], [1, 3]]


@pytest.mark.slow
@needs("gmsh")
@pytest.mark.parametrize(
    ("settings", "overloaded"),
    [
        (["--input", "preload", "--to", "40e3", "--step", "20e3"], "preload = 40000 N"),
        (["--input", "s_rel_x", "--to", "1e-7", "--step", "1e-7", "--set", "preload=40e3"], "preload ="),
        (["--input", "moment", "--to", "2500", "--step", "500", "--set", "preload=15e3"], "F_bolt["),
        (["--input", "moment", "--to", "100", "--step", "50", "--set", "preload=15e3"], None),
    ],
)
def test_a_run_that_overloads_a_bolt_is_warned_of(elastic_joint, capsys, settings, overloaded):
    """The proof load is that of an M8 of the strongest class, 12.9: 970 MPa on 36.6 mm2."""
    assert cli.main(["ramp", str(elastic_joint / "fmi3" / "BoltedJoint.fmu"), *settings]) == 0
    warnings = [line for line in capsys.readouterr().err.splitlines() if "proof load" in line]
    assert len(warnings) == (overloaded is not None)
    if overloaded:
        assert overloaded in warnings[0]
        assert "is above 3.551e+04 N" in warnings[0]
