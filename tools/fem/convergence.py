"""How far the contact of a bolted joint still depends on the mesh: from mesh to mesh, and where bolts that
symmetry makes alike show unlike pressures, which a mesh that is too coarse breaks first.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from jointfmu.progress import track
from jointfmu.quantity import Array

from ..fields.nodal_result import ContactField
from .bolted_contact import BoltedContact, JointSolution
from .contact import PressureLaw
from .geometry import Assembly

RATIO = math.sqrt(2.0)
"""Between the element sizes of two meshes [1]."""
COLUMNS = {"peak": "Pa", "between": "Pa", "K_N": "N/m", "K_rx": "N.m/rad", "K_ry": "N.m/rad"}
"""What is followed, with its unit: greatest pressure, mean midway between bolts, stiffness sums."""


@dataclass(frozen=True, slots=True)
class MeshResult:
    """One mesh: how fine it is and what comes out.

    refinement : [1] divides all element sizes
    elements   : on the contact; `unknowns` of all bodies
    values     : {name of COLUMNS: value}; `between` is nan where no two bolts are neighbours
    """

    refinement: float
    elements: int
    unknowns: int
    values: dict[str, float]


def refinements(count: int, middle: float = 1.0) -> list[float]:
    """Of `count` meshes, each finer by RATIO; the second, or the only one, has the refinement `middle`."""
    return [middle * RATIO**k for k in range(-1, count - 1)] if count > 1 else [middle]


def study(
    assembly: Assembly, law: PressureLaw, preload: float, moment: float, levels: Sequence[float]
) -> tuple[list[MeshResult], JointSolution]:
    """Results on meshes of rising refinement [1], and the solution on the last of them.

    preload : [N] per bolt; moment : [N.m]
    """

    def solved(refinement: float) -> JointSolution:
        return BoltedContact.of(assembly, refinement).solve(law, preload, moment)

    *before, last = levels
    rows = [result(solved(refinement), refinement) for refinement in track(before, "meshes")]
    solution = solved(last)
    return [*rows, result(solution, last)], solution


def result(solution: JointSolution, refinement: float) -> MeshResult:
    """What is followed of a solution."""
    between = solution.between[1]
    values = {"peak": solution.peak, "between": float(between.mean()) if between.size else math.nan}
    joint = solution.joint
    return MeshResult(
        refinement=refinement,
        elements=int(joint.interface.basis.mesh.nelements),
        unknowns=sum(body.size for body in joint.bodies),
        values=values | solution.stiffness,
    )


def changes(rows: Sequence[MeshResult]) -> list[dict[str, float]]:
    """Relative change [1] of every value from each mesh to the next."""
    return [
        {name: fine.values[name] / coarse.values[name] - 1.0 for name in COLUMNS}
        for coarse, fine in pairwise(rows)
    ]


def orders(rows: Sequence[MeshResult]) -> dict[str, float]:
    """Observed order [1] of every value from the last three meshes; nan if its changes do not fall."""
    if len(rows) < 3:
        return {}
    before, after = changes(rows)[-2:]
    ratio = math.log(rows[-1].refinement / rows[-2].refinement)
    observed = {}
    for name in COLUMNS:
        falls = 0.0 < abs(after[name]) < abs(before[name])
        observed[name] = math.log(abs(before[name] / after[name])) / ratio if falls else math.nan
    return observed


UNLIKE = 0.1
"""Relative difference of the greatest pressures around alike bolts, which a fine mesh stays below [1]."""
_SAME = 1e-6
"""Distance [m] within which a mirrored bolt lies on another one."""


def alike(bolts: Array, moment: bool) -> NDArray[np.int64]:
    """The first bolt (n) that each one equals by a mirror in x = 0 and, without a moment about x, in y = 0.

    bolts : (n, 2) [m]. The bodies are symmetric to both planes; a mirror counts if it maps bolts on bolts.
    """
    first = np.arange(len(bolts))
    for mirror in ((-1.0, 1.0),) if moment else ((-1.0, 1.0), (1.0, -1.0)):
        far = np.hypot(*(bolts[:, None] * mirror - bolts[None]).T).T
        image = far.argmin(axis=1)
        if np.all(far[np.arange(len(bolts)), image] < _SAME):
            first = np.minimum(first, first[image])
    return first


def unlike_holes(field: ContactField, bolts: Array, moment: bool) -> list[str]:
    """The warning if the greatest pressures around alike bolts differ by more than UNLIKE."""
    if not len(bolts):
        return []
    near = np.hypot(*(field.position[:, None] - bolts[None]).T).argmin(axis=0)
    peak = np.array([np.max(field.pressure[near == i], initial=0.0) for i in range(len(bolts))])
    first = alike(bolts, moment)
    spread = peak / np.array([np.min(peak[first == one]) for one in first]).clip(1e-9)
    worst = int(np.argmax(spread))
    if not spread[worst] > 1.0 + UNLIKE:
        return []
    x, y = bolts[worst]
    return [
        f"the pressure around the bolt at ({x:g}, {y:g}) m is {spread[worst]:.3g} times that around a bolt "
        "that symmetry makes alike: the mesh is too coarse around the holes, take a larger --refinement"
    ]
