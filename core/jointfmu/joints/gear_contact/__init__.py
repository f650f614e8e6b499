"""Gear contact: two tooth flanks under a load (Yu 2022)."""

import math

from ..kind import JointKind, RoughSurface
from ..model import EXTRAPOLATION_WARNING, LoadRamp, Model, ValidityLimit, Variable
from .spring import (
    GearContactParameters,
    GearContactSpring,
    RoughGearContactParameters,
    TableGearContactParameters,
)

_RAMP_END_PRESSURE_OVER_HARDNESS = 0.05
"""Mean pressure over the hardness [1] at the end of the load ramp, or beyond: at twice a stated load."""

MODELS = (
    Model(
        name="GearContact",
        joint="gear_contact",
        doc="Tooth contact of a gear: force in, motion out",
        parameter_class=GearContactParameters,
        tabulate=GearContactSpring.tabulate,
        inputs=(Variable("f", "N", "normal load of the tooth contact", 1e3),),
        outputs=(
            Variable("s_rel", "m", "approach of the two flanks, counted from first touch", 1e-6),
            Variable("K_N", "N/m", "tangent stiffness df/ds", 1e9),
            Variable("A_r", "m2", "real contact area", 1e-6),
            Variable("elastic_fraction", "1", "elastic part of the real contact area"),
        ),
        evaluate=lambda s, v: s.evaluate(v["f"]),
        validity_limits=(
            ValidityLimit(
                "f", lambda j, end, v: (0.0, math.inf), "the force is tensile, the flanks are separated"
            ),
            ValidityLimit("f", lambda j, end, v: (-math.inf, j.A_0 * end[1]), EXTRAPOLATION_WARNING),
        ),
        ramp=LoadRamp(
            "f",
            3e3,
            10.0,
            find_load_range=lambda s, v: (
                0.0,
                max(2.0 * v["f"], _RAMP_END_PRESSURE_OVER_HARDNESS * s.joint.A_0 * s.curve.end_point[1]),
            ),
        ),
        dependencies={},
        fixed_parameters=("mu", "traction_ratio", "table.ratio"),
    ),
)

KIND = JointKind(
    name="gear_contact",
    package=__name__,
    default_file_stem="beveloid",
    laws={
        "yu2022": GearContactParameters,
        "roughness": RoughGearContactParameters,
        "table": TableGearContactParameters,
    },
    models=MODELS,
    surfaces=(
        RoughSurface("surface1", profile_direction="x"),
        RoughSurface("surface2", profile_direction="y"),
    ),
)
"""Description of the gear contact for builders and tools."""
