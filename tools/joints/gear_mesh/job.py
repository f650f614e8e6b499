"""The ramp of the gear mesh in the main job: what must hold of it, and figures of the report."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson, quad

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.gear_mesh.spring import GearMesh, GearMeshSpring, pairs
from jointfmu.parameters import default

from ...job.checks import deviation
from ...ramps.ramp import RampResult
from ...report.figure import Figure, Panel, Series

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


_FORCES = (5e2, 1e3, 2e3)
"""Constant forces of the mesh [N]."""


def figures(outcome: Any) -> list[Figure]:
    """The figures of an outcome of the main job."""
    return [
        Figure(
            "Stiffness and deflection over the mesh cycle",
            "At constant forces: tooth pairs come and go, and flanks that carry more are stiffer.",
            cycle(GearMeshSpring.of(default("gear_mesh").values)),
        ),
        Figure(
            "Torque over angle",
            "What turns wheel 1, wheel 2 held: backlash and the flanks of both sides; then the first touch.",
            torque_angle(outcome.ramps["GearMesh"]),
            data="GearMesh.csv",
        ),
    ]


def cycle(spring: GearMeshSpring) -> list[Panel]:
    """Stiffness and deflection over two mesh cycles at constant forces."""
    phase = np.linspace(0.0, 2.0, 401)
    mesh = spring.joint
    count, _ = pairs(mesh.contact_ratio, mesh.engagement, mesh.overlap_ratio, phase)
    stiffness, deflection = [], []
    for force in _FORCES:
        s = spring.curve.inverse(force / count)
        name = f"{force / 1e3:g} kN"
        stiffness.append(Series(name, phase, count * spring.curve.derivatives(s, 1)[1] / 1e6))
        deflection.append(Series(name, phase, s * 1e6))
    over = "phase of the mesh cycle"
    return [
        Panel("Stiffness over the mesh cycle", over, "K [N/um]", stiffness),
        Panel("Deflection over the mesh cycle", over, "s_rel [um]", deflection),
    ]


def torque_angle(result: RampResult) -> list[Panel]:
    """Torque on wheel 1 over its angle, both flanks, and near the first touch of the driving ones."""
    angle, torque = result.columns["phi1"] * 1e3, -result.columns["tau1"]
    first = int(np.argmax(torque > 0.0))
    some = slice(max(first - 3, 0), first + 15)
    both = np.concatenate([-angle[::-1], angle]), np.concatenate([-torque[::-1], torque])
    axes = ("angle of wheel 1 [mrad]", "torque [N m]")
    return [
        Panel("Torque over angle", *axes, [Series("torque", *both)]),
        Panel("First touch", *axes, [Series("torque", angle[some], torque[some])]),
    ]
