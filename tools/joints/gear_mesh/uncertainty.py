"""Stiffness and force of the gear mesh over the angle of wheel 1, for `jointfmu uncertainty`.

Wheel 2 is fixed where the flanks touch at phi1 = 0: s_rel = r_b1 phi1, and no angle lies within the backlash.
"""

from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import MeshParameters

from ...studies.uncertainty.curves import LoadCurves

RAMP_END_OVER_TABLE_END_ANGLE = 0.05
"""Angle at the default end of the load ramp, over `largest_table_angle` [1]."""


def first_contact_angle(mesh: MeshParameters) -> float:
    """Angle [rad] of wheel 2 at which the driving flanks are in contact at phi1 = 0."""
    return 0.5 * mesh.backlash / mesh.r_b2


def largest_table_angle(mesh: MeshParameters) -> float:
    """Angle [rad] of wheel 1 at which tooth bending alone gives the largest force of the table.

    This force is the largest pressure of the law times A_0. The approach of the flanks is neglected.
    """
    return mesh.max_pressure * mesh.A_0 / (mesh.K_tooth * mesh.r_b1)


UNCERTAINTY_CURVES = LoadCurves(
    model="GearMesh",
    load=KIND.variables["phi1"],
    outputs=tuple(KIND.variables[name] for name in ("K", "f")),
    default_end=lambda mesh: RAMP_END_OVER_TABLE_END_ANGLE * float(largest_table_angle(mesh)),
    max_load=largest_table_angle,
    other_inputs=lambda mesh: {"phi2": first_contact_angle(mesh)},
)
"""Quantities of the gear mesh along its load ramp."""
