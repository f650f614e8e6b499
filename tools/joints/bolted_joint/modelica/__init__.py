"""The joint in the Modelica library: tightened to a preload under a moment, one record for each."""

from collections.abc import Sequence

from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.mechanics.sliders import SPREAD
from jointfmu.parameters import ParameterFile

from ....modelica.records import (
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    computed,
    given,
    identifier,
    matrix,
)
from .tight import ABOVE, BELOW, DAMPING_TOLERANCE, STRONGEST, tightened

TIGHTENED = ((9e3, 0.0), (15e3, 0.0), (15e3, 4500.0))
"""Preload [N] per bolt and moment [N.m]: Zhao 2018, Table 3."""


def _records(file: ParameterFile, points: Sequence[WorkingPoint]) -> list[ModelicaRecord]:
    spring = BoltedJointSpring.of_nodes(file.values)
    return [_record(file.name, spring, *point) for point in points]


def _record(name: str, spring: BoltedJointSpring, preload: float, moment: float) -> ModelicaRecord:
    tight = tightened(spring, preload, moment)
    rest = spring.motion(preload, moment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    values = given(
        {
            "preload": preload,
            "moment": moment,
            "mass": spring.joint.mass,
            "bolts": float(spring.joint.n_bolts * spring.joint.bolt_stiffness),
            "plastic_damping": spring.joint.plastic_damping,
            "memory": spring.joint.memory,
            "damping": spring.joint.damping,
            "mu": spring.joint.mu,
        }
    ) | computed({"tight": tight.force, "shear": tight.shear, "eta_t": float(rest["eta_t"])})
    force = f"{preload / 1e3:g} kN"
    return ModelicaRecord(
        name=identifier(f"{name} {force}" + (f" {moment:g} Nm" if moment else "")),
        title=f"{name}, {force} per bolt" + (f" and {moment:g} N m" if moment else ""),
        table=tight.table,
        values=values
        | {
            "heights": matrix(tight.heights),
            "sliders": matrix(tight.sliders),
            "eta_n": matrix(tight.damping),
        },
        more="; where the force is below the one at tightening, relative to that",
    )


COMPONENT = ModelicaComponent(
    name="BoltedJoint",
    base="BoltedJoint",
    points=TIGHTENED,
    records=_records,
    flanges=("flange_x", "flange_y", "flange_z"),
    texts=lambda joint: {
        "damping_tolerance": f"{DAMPING_TOLERANCE:g}",
        "strongest": f"{STRONGEST:g}",
        "spread": f"{SPREAD:.15g}",
        "sliders": f"{2 * (BELOW + len(ABOVE))}",
    },
)
