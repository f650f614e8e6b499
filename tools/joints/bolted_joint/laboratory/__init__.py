"""The bolted joint in the laboratory: pressure map, published pressures, measured joints."""

import tomllib
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

import numpy as np
from jointfmu_fmu_src.joint_parts import RampPanel

from jointfmu.joints.bolted_joint.law import bolt_pattern

from ....laboratory.part import LaboratoryModel, Map, MeasuredCurve, Shown

_PRESSURES = (0.3e6, 8e6)
"""Of the measured curves [Pa]: the mean pressures of the load ramp, as far as they were measured."""
_SHARE = 41


def _bolts(joint: Any) -> tuple[Sequence[Sequence[float]], str]:
    try:
        return bolt_pattern(joint).bolts.tolist(), "bolts"
    except ValueError:  # a field of nodal pressures, or a plate
        return [], ""


def _measured() -> list[MeasuredCurve]:
    """Normal stiffness of measured joints per area: approach = C p^m gives p^(1 - m)/(C m)."""
    text = (files("jointfmu_models") / "reference" / "measured_joints.toml").read_text(encoding="utf-8")
    curves = []
    for row in tomllib.loads(text)["normal"]:
        unit = row["pressure_unit"]
        C, m = (float(np.mean(row[name])) for name in "Cm")
        p = np.geomspace(_PRESSURES[0], min(_PRESSURES[1], row["to"] * unit), _SHARE)
        k = p / (C * m * 1e-6 * (p / unit) ** m)
        label = row["finish"]
        curves.append(MeasuredCurve(label, row["source"], "p_mean", "K_zz", p.tolist(), k.tolist(), "A_0"))
    return curves


LABORATORY = {
    "BoltedJoint": LaboratoryModel(
        panels=(RampPanel("preload", ("p_max", "p_mean")), RampPanel("p_mean", ("K_zz",))),
        spans={"moment": (-5e3, 5e3), "bolt_stiffness": (0.0, 2e9), "preload": (0.0, 30e3)},
        path=("s_rel_x", "s_rel_y"),
        points={"p_max": Shown("p_max", {"preload": "preload"})},
        measured=_measured(),
        picture=Map("contact pressure", "Pa", "MPa", "of the nodes that the FMU carries", _bolts),
    )
}
"""{FMU: what the page shows beside its variables}."""
