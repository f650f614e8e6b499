"""Factorisation of the stiffness of symmetric joints in symmetry classes, beside the complete matrix."""

import numpy as np
import pytest
import scipy.sparse as sp
from clients import needs
from jointfmu_tools.fem.elasticity import CholeskyFactor
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate
from jointfmu_tools.fem.symmetric_factorisation import SymmetricFactorisation, find_reflections
from jointfmu_tools.fem.whole_joint import JointFiniteElements

pytestmark = [pytest.mark.slow, needs("gmsh")]

CASES = {
    "equal plates between faces": ("faces", (0.0,), 2e11, 0.0, ["x", "y", "z"]),
    "soft side 2": ("heads", (0.0,), 1e11, 0.0, ["x", "y"]),
    "opposite edges": ("edge", (0.0,), 2e11, 0.0, ["y", "x and z"]),
    "bolt beside the middle": ("faces", (0.006,), 2e11, 0.0, ["y", "z"]),
    "stiffer interface at +x": ("faces", (0.0,), 2e11, 1.0, ["y", "z"]),
}
"""Attachment, x of the bolt [m], E of side 2 [Pa], growth of the stiffness of the interface over x, reflected
axes."""


def joint_matrix(attached, x, E, growth):
    """Bodies, free unknowns and their stiffness matrix, of a joint with few elements."""
    plates = [
        Plate(length=0.05, width=0.04, thickness=0.02, E=each, nu=0.3, density=7850.0) for each in (2e11, E)
    ]
    bolts = BoltList(x=x, y=(0.0,), hole_diameter=8e-3, head_diameter=16e-3)
    joint = JointFiniteElements.from_assembly(Assembly("block", *plates, bolts), attached, 0.5)
    at = joint.contact_interface.quadrature_position[:, :1]
    springs = 1e12 * np.array([1.0, 1.0, 2.0]) * (1.0 + growth * at / 0.05)
    linear = joint.linearise_joint(springs, 1e8)
    free = linear.free_unknowns
    matrix = linear.body_stiffness_matrix + linear.contact_stiffness_matrix + linear.bolt_stiffness_matrix
    return joint.bodies, free, matrix[free][:, free]


@pytest.mark.parametrize("name", CASES)
def test_classes_solve_as_the_complete_matrix(name):
    """Tolerance: round-off times the condition of a stiffness matrix, about 1e5."""
    *case, axes = CASES[name]
    bodies, free, matrix = joint_matrix(*case)
    reflections = find_reflections(matrix, bodies, free)
    assert [
        " and ".join(axis for k, axis in enumerate("xyz") if np.any(r.data[free % 3 == k] < 0.0))
        for r in reflections
    ] == axes
    factor, complete = SymmetricFactorisation(matrix, reflections), CholeskyFactor(matrix)
    loads = np.random.default_rng(3).standard_normal((free.size, 3))
    loads[:, 1] += reflections[0] @ loads[:, 1]  # of one class
    loads[:, 2] *= np.arange(free.size) % 97 == 0
    expected = complete.solve_linear_system(loads)
    for given in (loads, sp.csc_matrix(loads)):
        error = np.max(np.abs(factor.solve_linear_system(given) - expected), axis=0)
        assert np.all(error < 1e-10 * np.max(np.abs(expected), axis=0))
