"""Load ramp of the gear mesh: check and figures for the main job, and evaluation for many samples at once.

The evaluation gives stiffness K and force f over the angle phi1 of wheel 1. Wheel 2 is fixed where the flanks
touch at phi1 = 0, so that s_rel = r_b1 phi1 and no angle lies within the backlash. The curve of a tooth pair
is that of `spring.tabulate_pair`, at the nodes of `batch.approach`.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import (
    GearMesh,
    GearMeshSpring,
    MeshParameters,
    combine_in_series,
    mesh_phase,
    pairs_in_contact,
)
from jointfmu.parameters import load_default
from jointfmu.quantity import Array

from ...pages.report.figure import Figure, Panel, Series
from ...run.ramps.ramp import RampResult
from ...studies.batch.approach import Rows, columns, tabulate
from ...studies.checks import integrate_logarithmically, relative_deviation
from ...studies.uncertainty.problem import ReducedCurves

_CLOSED_FORCE = 10.0
"""Force [N] of a tooth pair above which its contact is closed, with the default parameters."""


def _check_deflection_and_work(folder: Path, result: RampResult) -> tuple[str, float]:
    mesh = load_default("gear_mesh").values
    assert isinstance(mesh, GearMesh)

    def compliance(f: Array) -> Array:
        return 1.0 / (mesh.A_0 * stiffness_curve(mesh, f / mesh.A_0)[0]) + 1.0 / mesh.K_tooth

    c = result.columns
    pair = c["f"] / c["pairs"]
    first = int(np.argmax(pair > _CLOSED_FORCE))
    rows = np.linspace(first, pair.size - 1, 4).astype(int)
    deflection = integrate_logarithmically(compliance, pair[rows])
    work = -cumulative_simpson(c["tau1"], x=c["phi1"], initial=0.0)
    return (
        "s_rel against the integral of df/K of flanks and teeth (scipy, Simpson), E against the work of tau1",
        max(relative_deviation(np.diff(c["s_rel"][rows]), deflection), relative_deviation(c["E"], work)),
    )


RAMPS = {"GearMesh": _check_deflection_and_work}
"""{FMU: check}, a check being (folder, ramp of the FMU) -> (text, largest relative deviation [1])."""


_FIGURE_FORCES = (5e2, 1e3, 2e3)
"""Constant forces of the mesh [N] in the figures over the mesh cycle."""


def figures(job_result: Any) -> list[Figure]:
    """Figures of the gear mesh, from the results of the main job (`JobResult`)."""
    return [
        Figure(
            "Stiffness and deflection over the mesh cycle",
            "At constant forces. The number of tooth pairs in contact changes; flanks with "
            "a larger force are stiffer.",
            mesh_cycle_panels(GearMeshSpring.tabulate(load_default("gear_mesh").values)),
        ),
        Figure(
            "Torque over angle",
            "Torque on wheel 1 with wheel 2 fixed: backlash and contact on both flanks. Second chart: "
            "detail at first contact.",
            torque_angle_panels(job_result.ramps["GearMesh"]),
            data_file="GearMesh.csv",
        ),
    ]


def mesh_cycle_panels(spring: GearMeshSpring) -> list[Panel]:
    """Panels of stiffness and deflection over two mesh cycles, at constant forces."""
    phase = np.linspace(0.0, 2.0, 401)
    mesh = spring.joint
    count, _ = pairs_in_contact(mesh.contact_ratio, mesh.engagement, mesh.overlap_ratio, phase)
    stiffness, deflection = [], []
    for force in _FIGURE_FORCES:
        s = spring.curve.inverse(force / count)
        name = f"{force / 1e3:g} kN"
        stiffness.append(Series(name, phase, count * spring.curve.derivatives(s, 1)[1] / 1e6))
        deflection.append(Series(name, phase, s * 1e6))
    over = "phase of the mesh cycle"
    return [
        Panel("Stiffness over the mesh cycle", over, "K [N/um]", stiffness),
        Panel("Deflection over the mesh cycle", over, "s_rel [um]", deflection),
    ]


def torque_angle_panels(result: RampResult) -> list[Panel]:
    """Panels of the torque on wheel 1 over its angle: for both flanks, and near the first contact."""
    angle, torque = result.columns["phi1"] * 1e3, -result.columns["tau1"]
    first = int(np.argmax(torque > 0.0))
    rows = slice(max(first - 3, 0), first + 15)
    curve = np.concatenate([-angle[::-1], angle]), np.concatenate([-torque[::-1], torque])
    axes = ("angle of wheel 1 [mrad]", "torque [N m]")
    return [
        Panel("Torque over angle", *axes, [Series("torque", *curve)]),
        Panel("First touch", *axes, [Series("torque", angle[rows], torque[rows])]),
    ]


RAMP_END_RATIO = 0.05
"""Default end of the ramp over `largest_table_angle` [1]."""


def evaluate(
    parameters: type[MeshParameters], values: Mapping[str, object], loads: Array, factor: Array
) -> dict[str, Array]:
    """Stiffness K (n, m) [N/m] and force f (n, m) [N] at the angles factor times loads.

    parameters : class of the parameter set
    values     : {structured name: number, or samples (n)}
    loads      : (m) [rad], ascending
    factor     : (n, 1) [1], one for each sample
    """
    mesh = columns(parameters, values, 1)
    angle = factor * loads
    cycle = mesh_phase(mesh, (angle, 0.0, first_contact_angle(mesh), 0.0))
    count, _ = pairs_in_contact(mesh.contact_ratio, mesh.engagement, mesh.overlap_ratio, cycle)
    loaded = loads > 0.0
    deflection = mesh.r_b1 * factor
    max_pressure = mesh.K_tooth * deflection * loads[-1] / mesh.A_0  # upper bound: flanks as rigid
    pair = _tabulate_pair(mesh, max_pressure)(np.log(loads[loaded]), np.log(deflection))
    K, f = np.zeros((2, *angle.shape))
    K[:, loaded], f[:, loaded] = np.exp(pair["K"]), np.exp(pair["f"])
    return {"K": count * K, "f": count * f}


def _tabulate_pair(mesh: MeshParameters, max_pressure: Array) -> Rows:
    """Tables of log K and log f of one tooth pair over log deflection, up to `max_pressure` (n, 1) [Pa]."""
    rows, _ = tabulate(mesh, np.zeros_like(max_pressure), max_pressure)
    p, (k, growth), approach = rows.pressure, rows.values["k"], rows.values["s"][0]
    pressure, stiffness = np.exp(p), np.exp(k)
    bend = growth * stiffness**2 / pressure
    s, f, K, slope = combine_in_series(mesh, np.exp(approach), pressure, stiffness, bend)
    return Rows(np.log(s), {"K": (np.log(K), slope * s / K), "f": (np.log(f), K * s / f)})


def first_contact_angle(mesh: MeshParameters) -> Any:
    """Angle [rad] of wheel 2 at which the driving flanks are in contact at phi1 = 0."""
    return 0.5 * mesh.backlash / mesh.r_b2


def largest_table_angle(mesh: MeshParameters) -> Any:
    """Angle [rad] of wheel 1 at which tooth bending alone gives the largest force of the table.

    This force is the hardness times A_0. The approach of the flanks is neglected.
    """
    return mesh.hardness * mesh.A_0 / (mesh.K_tooth * mesh.r_b1)


def evaluate_exported(joint: MeshParameters, loads: Array) -> dict[str, Array]:
    """K (m) [N/m] and f (m) [N] of the exported joint at angles (m) [rad]."""
    state = GearMeshSpring.tabulate(joint).evaluate(loads, 0.0, first_contact_angle(joint), 0.0)
    return {name: state[name] for name in REDUCED.units}


REDUCED = ReducedCurves(
    load=KIND.variables["phi1"],
    outputs=tuple(KIND.variables[name] for name in ("K", "f")),
    default_end=lambda mesh: RAMP_END_RATIO * float(largest_table_angle(mesh)),
    max_load=largest_table_angle,
    evaluate=evaluate,
    exact=evaluate_exported,
)
