"""Tables of a gear mesh for other solvers."""

import numpy as np
import pytest
from jointfmu_tools import cli
from jointfmu_tools.export.exports import required

from jointfmu.joints.gear_mesh.spring import GearMeshSpring
from jointfmu.parameters import default

MESH = default("gear_mesh").values


def test_force_over_deflection_is_the_mean_over_the_mesh_cycle():
    table = required("gear_mesh", "curve").table(MESH, None, 1e-3)
    spring = GearMeshSpring.of(MESH)
    s, f, K = table.rows.T
    load, stiffness = spring.curve.derivatives(np.abs(s), 1)
    np.testing.assert_allclose(f, MESH.contact_ratio * load * np.sign(s), rtol=1e-9)  # a shift of the table
    np.testing.assert_allclose(K, MESH.contact_ratio * stiffness, rtol=1e-9, atol=1e-9 * np.max(K))
    np.testing.assert_array_equal(table.rows[::-1] * [-1.0, -1.0, 1.0], table.rows)
    between = np.linspace(spring.closing, s[-1], 5001)
    exact = MESH.contact_ratio * spring.curve.derivatives(between, 0)[0]
    np.testing.assert_allclose(np.interp(between, s, f), exact, rtol=1.01e-3)
    assert table.straight[0] <= 1e-3


def test_the_contact_is_that_of_the_flanks():
    """The same surfaces as the gear contact's default."""
    mesh, _ = required("gear_mesh", "contact")(MESH)
    flanks, _ = required("gear_contact", "contact")(default("gear_contact").values)
    np.testing.assert_array_equal(mesh.load, flanks.load)


@pytest.mark.parametrize("what", ["curve", "contact"])
def test_command(what, tmp_path, capsys):
    path = tmp_path / "mesh.csv"
    assert cli.main(["export", "csv", what, "--joint", "gear_mesh", "--out", str(path)]) == 0
    capsys.readouterr()
    assert "gear_mesh" in path.read_text()
