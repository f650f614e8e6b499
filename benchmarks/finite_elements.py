"""Assembly and factorisation of a body of finite elements, over scikit-fem's loop and SuperLU.

    python benchmarks/finite_elements.py [--quick]

Processor times of the matrices of one body of the box specimen, and of solving with them on springs at its
contact. With PyAMG installed, multigrid is timed too.
"""

from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

import scipy.sparse as sp
from harness import print_processor_time, read_options
from jointfmu_tools.fem.assembly import read_assembly
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.fem.contact import displacement_matrix
from jointfmu_tools.fem.elasticity import CholeskyFactor
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementHexS2, ElementVector
from skfem.models.elasticity import lame_parameters, linear_elasticity

REFINEMENT, QUICK_REFINEMENT = 1.2, 0.4
"""Factors that divide the element sizes [1]."""
SPRING_STIFFNESS = 3e11
"""Stiffness [N/m3] of the springs at the contact."""


def main() -> None:
    """Print the times of the finite elements."""
    refinement = QUICK_REFINEMENT if read_options(__doc__).quick else REFINEMENT
    assembly = read_assembly(Path(str(files("jointfmu_models") / "assemblies" / "box_specimen.toml")))
    joint = BoltedContact.from_assembly(assembly, refinement)
    body = joint.bodies[0]
    count = body.unknown_count
    stiffness = print_processor_time(f"stiffness matrix, {count} unknowns", lambda: body.stiffness_matrix)
    form = BilinearForm(linear_elasticity(*lame_parameters(body.E, body.nu)))
    basis = Basis(body.mesh, ElementVector(ElementHexS2()), intorder=4)
    reference = print_processor_time("the same by scikit-fem's loop", lambda: form.assemble(basis))
    print(f"largest difference {abs(stiffness - reference).max() / abs(reference).max():.1e}")
    relative = displacement_matrix(body, joint.contact_interface)
    springs = (
        relative.T @ sp.diags_array(joint.contact_interface.quadrature_area * SPRING_STIFFNESS) @ relative
    )
    matrix = (stiffness + springs + 1e5 * sp.eye_array(count)).tocsc()
    load = body.distribute_unit_force(body.mesh.boundaries["head1"])
    factor = print_processor_time("CHOLMOD", lambda: CholeskyFactor(matrix))
    print_processor_time("  solution", lambda: factor.solve_linear_system(load))
    options = {"SymmetricMode": True}
    lu = print_processor_time(
        "SuperLU, minimum degree", lambda: splu(matrix, "MMD_AT_PLUS_A", 0.0, options=options)
    )
    print_processor_time("  solution", lambda: lu.solve(load))
    if find_spec("pyamg"):
        import pyamg

        rigid = body.rigid_body_motions()
        levels = print_processor_time(
            "PyAMG", lambda: pyamg.smoothed_aggregation_solver(matrix.tobsr((3, 3)), B=rigid)
        )
        print_processor_time(
            "  solution to 1e-8", lambda: levels.solve(load, tol=1e-8, accel="cg", maxiter=500)
        )


if __name__ == "__main__":
    main()
