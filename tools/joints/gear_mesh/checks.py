"""What must hold of the mesh's ramp."""

from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_simpson, quad

from jointfmu.contact.interface import stiffness_curve
from jointfmu.fmi.ramp import RampResult
from jointfmu.joints.gear_mesh.spring import GearMesh
from jointfmu.parameters import default

from ...job.checks import deviation

_CLOSED = 10.0
"""Force of a pair [N] from which its contact is closed, with the default parameters."""


def _series(folder: Path, result: RampResult) -> tuple[str, float]:
    mesh = default("gear_mesh").values
    assert isinstance(mesh, GearMesh)

    def compliance(f: float) -> float:
        return float(1.0 / (mesh.A_0 * stiffness_curve(mesh, f / mesh.A_0)[0]) + 1.0 / mesh.K_tooth)

    c = result.columns
    pair = c["f"] / c["pairs"]
    first = int(np.argmax(pair > _CLOSED))
    at = np.linspace(first, pair.size - 1, 4).astype(int)
    way = [quad(compliance, pair[i], pair[j], epsabs=0.0, epsrel=1e-9, limit=400)[0] for i, j in pairwise(at)]
    work = -cumulative_simpson(c["tau1"], x=c["phi1"], initial=0.0)
    return (
        "s_rel against the integral of df/K of flanks and teeth (scipy, quad), E against the work of tau1",
        max(deviation(np.diff(c["s_rel"][at]), way), deviation(c["E"], work)),
    )


RAMPS = {"GearMesh": _series}
"""{FMU: (folder, its ramp) -> (what is compared, largest relative deviation)}."""
