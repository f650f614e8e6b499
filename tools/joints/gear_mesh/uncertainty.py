"""Stiffness and force of the gear mesh over the angle of wheel 1, for `jointfmu uncertainty`.

Wheel 2 is fixed where the flanks touch at phi1 = 0: s_rel = r_b1 phi1, and no angle lies within the backlash.
"""

from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import MeshParameters

from ...studies.uncertainty.curves import LoadCurves

RAMP_END_OVER_TABLE_END_ANGLE = 0.05
"""Angle at the default end of the load ramp, over `largest_table_angle` [1]."""


def first_contact_angle(mesh_parameters: MeshParameters) -> float:
    """Angle [rad] of wheel 2 at which the driving flanks touch if the angle phi1 of wheel 1 is 0."""
    return 0.5 * mesh_parameters.backlash / mesh_parameters.r_b2


def largest_table_angle(mesh_parameters: MeshParameters) -> float:
    """Angle [rad] of wheel 1 at which tooth bending alone gives the largest tabulated contact force.

    This force is the largest pressure of the law times the nominal contact area. The approach of the flanks
    is neglected.
    """
    return (
        mesh_parameters.max_pressure * mesh_parameters.A_0 / (mesh_parameters.K_tooth * mesh_parameters.r_b1)
    )


UNCERTAINTY_CURVES = LoadCurves(
    fmu_name="GearMesh",
    ramped_input=KIND.variables["phi1"],
    outputs=tuple(KIND.variables[name] for name in ("K", "f")),
    default_ramp_end=lambda mesh: RAMP_END_OVER_TABLE_END_ANGLE * float(largest_table_angle(mesh)),
    max_load=largest_table_angle,
    fixed_inputs=lambda mesh: {"phi2": first_contact_angle(mesh)},
)
"""Quantities of the gear mesh along its load ramp."""
