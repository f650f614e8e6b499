"""Mesh convergence of the contact of a bolted joint.

Results are compared from mesh to mesh. The peak pressures around bolts that are equivalent by symmetry are
compared too: a mesh that is too coarse breaks this symmetry first.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from ..inputs.fields.nodal_result import ContactPressureField
from .bolted_contact import BoltedContact, JointSolution
from .contact import PressureLaw
from .geometry import Assembly

COARSE_OVER_FINE_ELEMENT_SIZE = math.sqrt(2.0)
"""Ratio of the element sizes of two successive meshes [1]."""
RESULT_UNITS = {"peak": "Pa", "between": "Pa", "K_N": "N/m", "K_rx": "N.m/rad", "K_ry": "N.m/rad"}
"""Results that are compared, with their units: peak pressure, mean pressure midway between neighbouring
bolts, normal stiffness and bending stiffness about x and y."""


@dataclass(frozen=True, slots=True)
class MeshResult:
    """Size of one mesh, and results on it.

    refinement    : [1] divides all element sizes
    element_count : number of elements on the contact
    unknown_count : number of unknowns of all meshed bodies
    result_values : {name in RESULT_UNITS: value}; `between`, the pressure midway between bolts, is nan if no
                    two bolts are neighbours
    """

    refinement: float
    element_count: int
    unknown_count: int
    result_values: dict[str, float]


def refinement_series(mesh_count: int, base_refinement: float = 1.0) -> list[float]:
    """Refinements [1] of `mesh_count` meshes of increasing fineness.

    Each mesh is COARSE_OVER_FINE_ELEMENT_SIZE times finer than the one before.

    base_refinement : refinement [1] of the second mesh, or of the only one
    """
    return (
        [base_refinement * COARSE_OVER_FINE_ELEMENT_SIZE**k for k in range(-1, mesh_count - 1)]
        if mesh_count > 1
        else [base_refinement]
    )


def run_mesh_study(
    assembly: Assembly,
    pressure_law: PressureLaw,
    preload: float,
    moment: float,
    refinement_levels: Sequence[float],
) -> tuple[list[MeshResult], JointSolution]:
    """Solve the contact on meshes of increasing refinement [1]; return all results and the last solution.

    preload : [N] per bolt
    moment  : [N.m] about x
    """

    def solve_mesh(refinement: float) -> JointSolution:
        return BoltedContact.from_assembly(assembly, refinement).solve_equilibrium(
            pressure_law, preload, moment
        )

    *coarser, finest = refinement_levels
    rows = [
        summarize_solution(solve_mesh(refinement), refinement)
        for refinement in track_progress(coarser, "meshes")
    ]
    solution = solve_mesh(finest)
    return [*rows, summarize_solution(solution, finest)], solution


def summarize_solution(joint_solution: JointSolution, refinement: float) -> MeshResult:
    """Collect numbers of elements and unknowns, pressures and stiffnesses (RESULT_UNITS) of a solution."""
    between = joint_solution.pressure_between_bolts[1]
    values = {
        "peak": joint_solution.peak_pressure,
        "between": float(between.mean()) if between.size else math.nan,
    }
    joint = joint_solution.bolted_contact
    return MeshResult(
        refinement=refinement,
        element_count=int(joint.contact_interface.finite_element_basis.mesh.nelements),
        unknown_count=sum(body.unknown_count for body in joint.bodies),
        result_values=values | joint_solution.interface_stiffness,
    )


def relative_changes(mesh_results: Sequence[MeshResult]) -> list[dict[str, float]]:
    """Relative change [1] of each result from each mesh to the next."""
    return [
        {name: fine.result_values[name] / coarse.result_values[name] - 1.0 for name in RESULT_UNITS}
        for coarse, fine in pairwise(mesh_results)
    ]


def observed_orders(mesh_results: Sequence[MeshResult]) -> dict[str, float]:
    """Observed order of convergence [1] of each result from the last three meshes.

    nan if the changes do not decrease. Fewer than three meshes give an empty dict.
    """
    if len(mesh_results) < 3:
        return {}
    previous, latest = relative_changes(mesh_results)[-2:]
    ratio = math.log(mesh_results[-1].refinement / mesh_results[-2].refinement)
    observed = {}
    for name in RESULT_UNITS:
        decreases = 0.0 < abs(latest[name]) < abs(previous[name])
        observed[name] = math.log(abs(previous[name] / latest[name])) / ratio if decreases else math.nan
    return observed


MAX_PEAK_PRESSURE_DIFFERENCE = 0.1
"""Largest relative difference of the peak pressures around equivalent bolts [1] on a mesh that is fine
enough."""
_BOLT_POSITION_TOLERANCE = 1e-6
"""Distance [m] below which a mirrored bolt coincides with another bolt."""


def find_first_equivalent_bolts(bolt_positions: Array, has_moment: bool) -> NDArray[np.int64]:
    """For each bolt, index (n) of the first bolt that is equivalent to it by mirror symmetry.

    Mirror planes are x = 0 and, without a moment about x, y = 0. The bodies are symmetric about both planes.
    A mirror plane counts only if it maps all bolts onto bolts.

    bolt_positions : (n, 2) [m]
    """
    first = np.arange(len(bolt_positions))
    for mirror in ((-1.0, 1.0),) if has_moment else ((-1.0, 1.0), (1.0, -1.0)):
        distance = np.hypot(*(bolt_positions[:, None] * mirror - bolt_positions[None]).T).T
        image = distance.argmin(axis=1)
        if np.all(distance[np.arange(len(bolt_positions)), image] < _BOLT_POSITION_TOLERANCE):
            first = np.minimum(first, first[image])
    return first


def check_bolt_symmetry(
    contact_field: ContactPressureField, bolt_positions: Array, has_moment: bool
) -> list[str]:
    """List a warning if the peak pressures around equivalent bolts differ by over MAX_PEAK_DIFFERENCE.

    Returns a list of one message, or an empty list.
    """
    if not len(bolt_positions):
        return []
    nearest_bolt = np.hypot(*(contact_field.node_positions[:, None] - bolt_positions[None]).T).argmin(axis=0)
    peak = np.array(
        [
            np.max(contact_field.nodal_pressure[nearest_bolt == i], initial=0.0)
            for i in range(len(bolt_positions))
        ]
    )
    group = find_first_equivalent_bolts(bolt_positions, has_moment)
    ratio = peak / np.array([np.min(peak[group == first]) for first in group]).clip(1e-9)
    worst = int(np.argmax(ratio))
    if not ratio[worst] > 1.0 + MAX_PEAK_PRESSURE_DIFFERENCE:
        return []
    x, y = bolt_positions[worst]
    return [
        f"the pressure around the bolt at ({x:g}, {y:g}) m is {ratio[worst]:.3g} times that around a bolt "
        "that symmetry makes alike: the mesh is too coarse around the holes, take a larger --refinement"
    ]
