"""The reduced evaluation of many gear meshes against the exported spring."""

import numpy as np
import pytest
from jointfmu_tools.uncertainty import propagate
from jointfmu_tools.uncertainty.problem import pose

from jointfmu.joints.gear_mesh.spring import GearMesh
from jointfmu.parameters import default
from jointfmu.quantity import build, flatten

pytestmark = pytest.mark.slow

REDUCED = 1e-4
"""Relative error that the reduced evaluation states (docs/uncertainty.md)."""
STUDIES = {
    "surfaces": {
        "surface1.D": "1.35..1.6",
        "surface2.D": "1.35..1.6",
        "surface1.G": "loguniform(2e-11, 1e-9)",
        "e": "0.05..0.7",
        "lambda": "0.7..1",
        "sigma_y": "+-20%",
        "phi1": "+-10%",
    },
    "wheels and teeth": {
        "K_tooth": "loguniform(1e7, 1e10)",
        "A_0": "loguniform(2e-5, 1e-3)",
        "contact_ratio": "1..2.9",
        "engagement": "0.1..1",
        "backlash": "0..3e-4",
        "r_b1": "+-10%",
        "r_b2": "+-10%",
        "d": "+-50%",
    },
}


@pytest.mark.parametrize("name", STUDIES)
@pytest.mark.parametrize("s_rel", [5e-7, 2e-5, 3e-4], ids=["closing", "default ramp", "end of the table"])
def test_reduced_evaluation_against_the_spring(name, s_rel):
    """Deflections [m] of the driving flanks; the default table ends at 474 um, with stiff teeth sooner."""
    joint = default("gear_mesh")
    shorter = 0.1 if "K_tooth" in STUDIES[name] and s_rel > 1e-6 else 1.0
    end = shorter * s_rel / joint.values.r_b1
    task = pose(joint, STUDIES[name], end, 9)
    points = propagate.design(task, 256, 5)[0][:24]
    outcome = propagate.run(task, points, task.loads, "")
    assert np.count_nonzero(outcome.good) > 12
    for i in np.flatnonzero(outcome.good):
        values, factor, _ = propagate.one_sample(task, points, i)
        exact = task.reduced.exact(build(GearMesh, values), factor * task.loads)
        for output, value in exact.items():
            found = outcome.outputs[output][:, i]
            assert found[1:] == pytest.approx(value[1:], rel=REDUCED), (output, values)
            assert found[0] == 0.0


def test_bands():
    """The command's own check, and what turns the band: the teeth are the softer part."""
    task = pose(default("gear_mesh"), {"surface1.D": "1.4..1.5", "K_tooth": "+-10%"}, None, 6)
    found = propagate.bands(task, propagate.design(task, 64, 0)[0])
    assert found.error < REDUCED
    assert found.refused.count == 0
    low, high = found.quantiles["K"][[0, -1], -1]
    nominal = found.nominal["K"][-1]
    assert low < 0.95 * nominal < 1.05 * nominal < high


def test_default_ramp_ends_inside_the_table():
    joint = default("gear_mesh").values
    task = pose(default("gear_mesh"), {"K_tooth": "+-1%"}, None, 2)
    f = task.reduced.exact(joint, task.loads)["f"][-1]
    assert 0.5 < f / (2.0 * 0.05 * joint.hardness * joint.A_0) < 1.0  # two pairs; the flanks give way too


def test_every_parameter_can_be_uncertain():
    values = flatten(default("gear_mesh").values)
    names = [n for n, v in values.items() if isinstance(v, float) and v and n != "teeth1"]
    task = pose(default("gear_mesh"), dict.fromkeys(names, "+-1%"), None, 3)
    outcome = propagate.run(task, propagate.design(task, 16, 0)[0], task.loads, "")
    assert np.all(outcome.good)
