"""The laboratory's pressure map of the bolted joint is the package's pressure at the FMU's points."""

import numpy as np
import pytest
from jointfmu_tools.laboratory.describe import modules
from webassembly import Instance

from jointfmu.joints.bolted_joint.spring import BoltedJointSpring, points

pytestmark = pytest.mark.slow

TABLE = 1e-9
"""The same table with another mathematical library [1]."""


@pytest.mark.parametrize("law", ["zhao2018", "roughness"])
def test_the_map_is_the_pressure_at_the_points(law):
    pytest.importorskip("wasmtime")
    module = next(m for m in modules() if m.model.name == "BoltedJoint" and m.files[0].law == law)
    joint = module.files[0].values
    shape = points(joint.pattern)
    spring = BoltedJointSpring.of_nodes(joint, shape)
    instance = Instance(module, module.compiled())
    for moment, apart, turn in ((0.0, 0.0, 0.0), (1500.0, 2e-7, 1e-6)):
        given = {"preload": 12e3, "moment": moment, "s_rel_z": apart, "theta_x": turn, "theta_y": -turn}
        assert instance.start(given)
        found = instance.map()
        assert found[:, :2] == pytest.approx(shape.position, rel=1e-12, abs=1e-15)
        assert found[:, 2] == pytest.approx(shape.share, rel=1e-15)
        x, y = shape.position.T
        approach = spring.tightened(12e3, moment) - (apart + turn * y + turn * x)
        expected = spring.curve.derivatives(approach, 0)[0]
        assert found[:, 3] == pytest.approx(expected, rel=TABLE, abs=TABLE * float(np.max(expected)))
        assert float(found[:, 3].max()) == instance.get()["p_max"]
