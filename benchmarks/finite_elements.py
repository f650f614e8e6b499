"""Contact of the box specimen by finite elements: time and memory, meshes, lengths, preload.

    python benchmarks/finite_elements.py [convergence] [lengths] [preload] [solvers]

Published for 9 kN per bolt (Zhao 2018, section 3): 7.98 MPa near a hole, 0.62 MPa midway between bolts.
"""

import argparse
import resource
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from jointfmu_tools.fem import convergence
from jointfmu_tools.fem.assembly import read_assembly
from jointfmu_tools.fem.bolted_contact import DEFAULT_MOMENT_RATIO, BoltedContact, JointSolution
from jointfmu_tools.fem.contact import displacement_matrix
from jointfmu_tools.fem.elasticity import Cholesky
from jointfmu_tools.fem.geometry import Assembly, BoxSection
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementHexS2, ElementVector
from skfem.models.elasticity import lame_parameters, linear_elasticity

from jointfmu.mechanics.curve import Curve, tabulate_approach
from jointfmu.parameters import load_default

PRELOAD = 9e3
MESHES = 4
SOLVERS = 1.2
"""Refinement [1] of the body on which solvers are compared."""
BOX = Path(str(files("jointfmu_models") / "assemblies" / "box_specimen.toml"))


class Hard:
    """Contact without roughness: a stiffness [Pa/m] 300 times that of the law at 1 MPa."""

    def __init__(self, stiffness: float = 1e14) -> None:
        self.stiffness = stiffness

    def derivatives(self, x: Any, order: int = 1) -> list[Any]:
        return [self.stiffness * np.maximum(x, 0.0), np.where(x > 0.0, self.stiffness, 0.0)]

    def inverse(self, load: Any) -> Any:
        return load / self.stiffness


def law(assembly: Assembly) -> Curve:
    """The fractal law with the contact area of an assembly."""
    return tabulate_approach(replace(load_default("bolted_joint").values, A_0=assembly.contact_area))


def meshes(assembly: Assembly) -> None:
    """One solve of the default joint and of one without mirror image, and what MESHES meshes give."""
    other = replace(assembly, side1=replace(assembly.side1, E=1.01 * assembly.side1.E))
    for name, one in (("two equal bodies", assembly), ("two different bodies", other)):
        start, cpu = time.perf_counter(), time.process_time()
        joint = BoltedContact.from_assembly(one)
        solution = joint.solve(law(one), PRELOAD)
        steps = solution.contact.newton_steps
        seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        unknowns = sum(body.unknown_count for body in joint.bodies)
        print(f"{name}, {unknowns} unknowns: {seconds:.1f} s, {cpu:.1f} s of processor time, ", end="")
        print(f"{memory:.2f} GB, {steps} steps of Newton's method", flush=True)
        start = time.process_time()
        steps = solution.solve_load_case(
            PRELOAD, DEFAULT_MOMENT_RATIO * one.max_moment(PRELOAD)
        ).contact.newton_steps
        print(f"with a moment, from there: {time.process_time() - start:.1f} s, {steps} steps", flush=True)
    rows, _ = convergence.run_mesh_study(
        assembly, law(assembly), PRELOAD, 0.0, convergence.refinement_series(MESHES)
    )
    for row in rows:
        values = "  ".join(f"{name} {row.result_values[name]:.6g}" for name in convergence.RESULT_UNITS)
        print(f"refinement {row.refinement:.2f}, {row.unknown_count} unknowns: {values}")
    for change in convergence.relative_changes(rows):
        print(
            "change [%]:", "  ".join(f"{name} {100 * change[name]:.3f}" for name in convergence.RESULT_UNITS)
        )
    print("order:", {name: round(value, 1) for name, value in convergence.observed_orders(rows).items()})


def pressures(solution: JointSolution) -> str:
    """Peak and the pressures midway between the bolts of a row and of a side [MPa]."""
    places, between = solution.pressure_between_bolts
    row = between[np.abs(places[:, 1]) > 0.14].mean() / 1e6
    side = between[np.abs(places[:, 1]) < 0.14].mean() / 1e6
    return f"peak {solution.peak_pressure / 1e6:6.2f}  row {row:6.3f}  side {side:6.3f}"


def boxes(assembly: Assembly) -> Iterator[tuple[str, Assembly]]:
    """The default assembly with one thing changed."""
    yield "default", assembly
    changes: list[dict[str, float]] = [
        *({"flange_thickness": t} for t in (0.015, 0.018, 0.022, 0.025, 0.03)),
        *({"flange_width": w} for w in (0.07, 0.08)),
        *({"wall": w, "flange_width": 0.04 + w} for w in (0.01, 0.015)),
        *({"height": h} for h in (0.1, 0.3)),
        {"floor": 0.02},
        *({"length": 0.24 + 2 * e, "width": 0.34 + 2 * e, "wall_inset": 0.04 + e, "flange_width": 0.06 + e}
          for e in (0.005, 0.01)),
        {"length": 0.28, "width": 0.38, "wall_inset": 0.0},
    ]  # fmt: skip
    box = assembly.side2
    assert isinstance(box, BoxSection)
    for change in changes:
        one = replace(box, **change)
        yield ", ".join(f"{k} {v:g}" for k, v in change.items()), replace(assembly, side1=one, side2=one)
    for head in (0.022, 0.03):
        yield f"head_diameter {head:g}", replace(assembly, bolts=replace(assembly.bolts, head_diameter=head))


def lengths(assembly: Assembly) -> None:
    """What the published pressures say about the lengths."""
    print("published: peak 7.98, between 0.62 MPa")
    print(
        f"{pressures(BoltedContact.from_assembly(assembly).solve(Hard(), PRELOAD))}  default, hard contact",
        flush=True,
    )
    for name, one in boxes(assembly):
        print(f"{pressures(BoltedContact.from_assembly(one).solve(law(one), PRELOAD))}  {name}", flush=True)


def preload(assembly: Assembly) -> None:
    """How the shape p/p_mean changes with the preload."""
    joint, curve = BoltedContact.from_assembly(assembly), law(assembly)
    first: Any = None
    for force in (9e3, 15e3, 24e3):
        solution = joint.solve(curve, force)
        field = solution.field
        shape = field.pressure / (field.force / field.area.sum())
        first = shape if first is None else first
        change = np.sqrt(field.area @ (shape - first) ** 2 / (field.area @ first**2))
        mean = field.force / field.area.sum()
        print(
            f"{force / 1e3:g} kN: peak/mean {solution.peak_pressure / mean:.3f}, {pressures(solution)} MPa, "
            f"shape differs from 9 kN by {100 * change:.2f} % rms"
        )


def timed(name: str, work: Callable[[], Any]) -> Any:
    """Do the work and print the processor time that it took."""
    start = time.process_time()
    result = work()
    print(f"{name}: {time.process_time() - start:.2f} s", flush=True)
    return result


def solvers(assembly: Assembly) -> None:
    """Processor time of the matrices of one body, and of solving with them on springs at its contact."""
    joint = BoltedContact.from_assembly(assembly, SOLVERS)
    body = joint.bodies[0]
    ours = timed(f"stiffness matrix, {body.unknown_count} unknowns", lambda: body.stiffness)
    form = BilinearForm(linear_elasticity(*lame_parameters(body.E, body.nu)))
    basis = Basis(body.mesh, ElementVector(ElementHexS2()), intorder=4)
    theirs = timed("the same by scikit-fem's loop", lambda: form.assemble(basis))
    print(f"largest difference {abs(ours - theirs).max() / abs(theirs).max():.1e}")
    springs = displacement_matrix(body, joint.interface).T @ sp.diags_array(
        joint.interface.quadrature_area * 3e11
    )
    matrix = (
        ours + springs @ displacement_matrix(body, joint.interface) + 1e5 * sp.eye_array(body.unknown_count)
    ).tocsc()
    load = body.uniform_load(body.mesh.boundaries["head1"])
    factor = timed("CHOLMOD", lambda: Cholesky(matrix))
    timed("  solution", lambda: factor.solve(load))
    options = {"SymmetricMode": True}
    lu = timed("SuperLU, minimum degree", lambda: splu(matrix, "MMD_AT_PLUS_A", 0.0, options=options))
    timed("  solution", lambda: lu.solve(load))
    if find_spec("pyamg"):
        import pyamg

        rigid = body.rigid_motions()
        levels = timed("PyAMG", lambda: pyamg.smoothed_aggregation_solver(matrix.tobsr((3, 3)), B=rigid))
        timed("  solution to 1e-8", lambda: levels.solve(load, tol=1e-8, accel="cg", maxiter=500))


STUDIES = {"convergence": meshes, "lengths": lengths, "preload": preload, "solvers": solvers}


def main() -> None:
    """Run the studies that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", nargs="*", help=f"of {', '.join(STUDIES)} (default: all)")
    chosen = parser.parse_args().study
    if unknown := [name for name in chosen if name not in STUDIES]:
        parser.error(f"no such study: {unknown[0]}; have {', '.join(STUDIES)}")
    for name in chosen or STUDIES:
        print(f"# {name}")
        STUDIES[name](read_assembly(BOX))


if __name__ == "__main__":
    main()
