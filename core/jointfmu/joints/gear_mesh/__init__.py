"""Gear mesh: tooth pairs with rough flanks (Yu 2022) and bending teeth between two wheels."""

from ...mechanics.stable_steps import STABLE_STEP_OUTPUTS
from ..kind import JointKind, RoughSurface
from ..model import EXTRAPOLATION_WARNING, LoadRamp, Model, ValidityLimit, Variable, VariableValues
from .spring import (
    GearMeshParameters,
    GearMeshSpring,
    RoughGearMeshParameters,
    TableGearMeshParameters,
)

_ANGLE_INPUTS = ("phi1", "phi2")
"""Names of the inputs with the angles of the two wheels."""
_RAMP_END_OVER_TABLE_END_DEFLECTION = 0.3
"""Deflection at the end of the load ramp over deflection at the end of the table [1]."""


def _find_ramp_range(mesh_spring: GearMeshSpring, input_values: VariableValues) -> tuple[float, float]:
    """Angles phi1 [rad] at which the driving flanks touch, and at which the load ramp ends."""
    mesh = mesh_spring.joint
    touch = 0.5 * mesh.backlash - mesh.r_b2 * input_values["phi2"]
    return touch / mesh.r_b1, (
        touch + _RAMP_END_OVER_TABLE_END_DEFLECTION * mesh_spring.curve.end_point[0]
    ) / mesh.r_b1


MODELS = (
    Model(
        name="GearMesh",
        joint="gear_mesh",
        doc="Mesh of two gear wheels with rough flanks and backlash: motion in, torque out",
        parameter_class=GearMeshParameters,
        tabulate=GearMeshSpring.tabulate,
        inputs=(
            Variable("phi1", "rad", "angle of wheel 1; wheels roll with r_b1 phi1 + r_b2 phi2 = 0"),
            Variable("w1", "rad/s", "speed of wheel 1"),
            Variable("phi2", "rad", "angle of wheel 2; wheels roll with r_b1 phi1 + r_b2 phi2 = 0"),
            Variable("w2", "rad/s", "speed of wheel 2"),
        ),
        outputs=(
            Variable("tau1", "N.m", "torque of the mesh on wheel 1", 100.0),
            Variable("tau2", "N.m", "torque of the mesh on wheel 2", 100.0),
            Variable(
                "s_rel", "m", "deflection r_b1 phi1 + r_b2 phi2 beyond half the backlash, 0 within it", 1e-5
            ),
            Variable(
                "transmission_error",
                "m",
                "lag of wheel 2 along the line of action, with the teeth deflected; 0 without load",
                1e-5,
            ),
            Variable("f", "N", "normal force of the mesh, positive on the driving flanks", 1e3),
            Variable("K", "N/m", "stiffness df/ds_rel at the present phase of the mesh cycle", 1e8),
            Variable("pairs", "1", "tooth pairs in contact at the present phase, if the flanks touch"),
            Variable("E", "J", "elastic energy of the mesh", 1e-2),
            *(
                Variable(name, "s", f"{doc}: with inertia1, inertia2, K, d", 1e-3)
                for name, doc in STABLE_STEP_OUTPUTS
            ),
        ),
        evaluate=lambda s, v: s.evaluate(v["phi1"], v["w1"], v["phi2"], v["w2"]),
        validity_limits=(ValidityLimit("s_rel", lambda j, end, v: (-end[0], end[0]), EXTRAPOLATION_WARNING),),
        ramp=LoadRamp("phi1", 1.5e-3, 5e-6, find_load_range=_find_ramp_range),
        dependencies=dict.fromkeys(
            ("s_rel", "transmission_error", "K", "pairs", "E", *(name for name, _ in STABLE_STEP_OUTPUTS)),
            _ANGLE_INPUTS,
        ),
        fixed_parameters=("mu", "traction_ratio", "table.ratio"),
    ),
)

KIND = JointKind(
    name="gear_mesh",
    package=__name__,
    default_file_stem="beveloid_pair",
    laws={
        "yu2022": GearMeshParameters,
        "roughness": RoughGearMeshParameters,
        "table": TableGearMeshParameters,
    },
    models=MODELS,
    surfaces=(
        RoughSurface("surface1", profile_direction="x"),
        RoughSurface("surface2", profile_direction="y"),
    ),
)
"""Description of the gear mesh for builders and tools."""
