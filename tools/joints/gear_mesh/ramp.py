"""Load ramp of the gear mesh: check and figures of the main job."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.gear_mesh.spring import GearMeshParameters, GearMeshSpring, pairs_in_contact
from jointfmu.parameters import load_default
from jointfmu.quantity import Array

from ...pages.report.figure import Figure, Panel, Series
from ...run.ramps.ramp import RampResult
from ...studies.checks import integrate_logarithmically, relative_deviation

_FULL_CONTACT_FORCE = 10.0
"""Force [N] of a tooth pair above which its contact is closed, with the default parameters."""


def _check_deflection_and_work(fmu_folder: Path, ramp_result: RampResult) -> tuple[str, float]:
    """Compare deflection and work along the load ramp of the FMU with integrals of the stiffness."""
    mesh = load_default("gear_mesh").values
    assert isinstance(mesh, GearMeshParameters)

    def compliance(mesh_force: Array) -> Array:
        """Compliance 1/K [m/N] of the mesh at forces [N]."""
        return 1.0 / (mesh.A_0 * stiffness_curve(mesh, mesh_force / mesh.A_0)[0]) + 1.0 / mesh.K_tooth

    c = ramp_result.variable_columns
    pair = c["f"] / c["pairs"]
    first = int(np.argmax(pair > _FULL_CONTACT_FORCE))
    rows = np.linspace(first, pair.size - 1, 4).astype(int)
    deflection = integrate_logarithmically(compliance, pair[rows])
    work = -cumulative_simpson(c["tau1"], x=c["phi1"], initial=0.0)
    return (
        "s_rel against the integral of df/K of flanks and teeth (scipy, Simpson), E against the work of tau1",
        max(relative_deviation(np.diff(c["s_rel"][rows]), deflection), relative_deviation(c["E"], work)),
    )


RAMP_CHECKS = {"GearMesh": _check_deflection_and_work}
"""{FMU: check of its load ramp}.

A check is a function: (folder, ramp of the FMU) -> (name of the compared
quantity, largest relative deviation [1])."""


_PLOTTED_MESH_FORCES = (5e2, 1e3, 2e3)
"""Constant forces of the mesh [N] in the figures over the mesh cycle."""


def make_figures(pipeline_result: Any) -> list[Figure]:
    """Make the figures of the gear mesh, from the results of building all FMUs (`PipelineResult`)."""
    return [
        Figure(
            "Stiffness and deflection over the mesh cycle",
            "At constant forces. The number of tooth pairs in contact changes; flanks with "
            "a larger force are stiffer.",
            make_mesh_cycle_charts(GearMeshSpring.tabulate(load_default("gear_mesh").values)),
        ),
        Figure(
            "Torque over angle",
            "Torque on wheel 1 with wheel 2 fixed: backlash and contact on both flanks. Second chart: "
            "detail at first contact.",
            make_torque_angle_charts(pipeline_result.load_ramps["GearMesh"]),
            data_file="GearMesh.csv",
        ),
    ]


def make_mesh_cycle_charts(mesh_spring: GearMeshSpring) -> list[Panel]:
    """Charts of stiffness and deflection over two mesh cycles, at constant forces."""
    phase = np.linspace(0.0, 2.0, 401)
    mesh = mesh_spring.joint
    count, _ = pairs_in_contact(mesh.contact_ratio, mesh.engagement, mesh.overlap_ratio, phase)
    stiffness, deflection = [], []
    for force in _PLOTTED_MESH_FORCES:
        s = mesh_spring.curve.inverse(force / count)
        name = f"{force / 1e3:g} kN"
        stiffness.append(Series(name, phase, count * mesh_spring.curve.derivatives(s, 1)[1] / 1e6))
        deflection.append(Series(name, phase, s * 1e6))
    over = "phase of the mesh cycle"
    return [
        Panel("Stiffness over the mesh cycle", over, "K [N/um]", stiffness),
        Panel("Deflection over the mesh cycle", over, "s_rel [um]", deflection),
    ]


def make_torque_angle_charts(ramp_result: RampResult) -> list[Panel]:
    """Charts of the torque on wheel 1 over its angle: for both flanks, and near the first contact."""
    angle, torque = ramp_result.variable_columns["phi1"] * 1e3, -ramp_result.variable_columns["tau1"]
    first = int(np.argmax(torque > 0.0))
    rows = slice(max(first - 3, 0), first + 15)
    curve = np.concatenate([-angle[::-1], angle]), np.concatenate([-torque[::-1], torque])
    axes = ("angle of wheel 1 [mrad]", "torque [N m]")
    return [
        Panel("Torque over angle", *axes, [Series("torque", *curve)]),
        Panel("First touch", *axes, [Series("torque", angle[rows], torque[rows])]),
    ]
