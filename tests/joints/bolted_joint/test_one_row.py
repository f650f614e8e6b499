"""Assemblies whose bolts are no two rows: what finite elements write of them."""

import pytest
from jointfmu_tools.commands.footprint.compute import with_assembly
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate

from jointfmu.parameters import default

PLATE = Plate(length=0.2, width=0.1, thickness=0.02, E=210e9, nu=0.3, density=7850.0)


@pytest.mark.parametrize("x", [(0.0,), (-0.05, 0.0, 0.05)])
def test_the_default_joint_takes_one_row(x):
    bolts = BoltList(x=x, y=(0.0,) * len(x), hole_diameter=0.0135, head_diameter=0.018)
    joint = with_assembly(default("bolted_joint"), Assembly("row", PLATE, PLATE, bolts), whole=True).values
    assert (joint.n_bolts, joint.row_bolts, joint.row_distance) == (len(x), 1.0, 0.018)
