"""Inputs and outputs of the bolted joint's model."""

import math
from collections.abc import Mapping
from typing import Any

from ...quantity import Number
from ..model import BEYOND, Model, Outside, Ramp, Values, Variable
from .law import BoltedJoint
from .spring import BoltedJointSpring

_TIGHT = ("preload", "moment")
_SHIFT = ("s_rel_x", "s_rel_y", "s_rel_z")


def _evaluate(spring: BoltedJointSpring, v: Values) -> Mapping[str, float]:
    return spring.motion(
        v["preload"],
        v["moment"],
        (v["s_rel_x"], v["s_rel_y"], v["s_rel_z"]),
        (v["v_rel_x"], v["v_rel_y"], v["v_rel_z"]),
    )


def _row_moment(joint: Any, preload: Number) -> Number:
    """The largest moment [N.m] that both bolt rows carry without a negative bolt force."""
    return preload * joint.row_distance * joint.row_bolts


MODELS = (
    Model(
        name="BoltedJoint",
        joint="bolted_joint",
        doc="Bolted joint under uneven pressure: motion in, force out (Zhao 2018)",
        parameters=BoltedJoint,
        spring=BoltedJointSpring.of,
        inputs=(
            Variable("preload", "N", "pre-tightening force of each bolt", 1e4, low=0.0),
            Variable("moment", "N.m", "bending moment on the joint", 1e3),
            Variable("s_rel_x", "m", "displacement from the tightened state, along the rows", 1e-6),
            Variable("s_rel_y", "m", "displacement from the tightened state, across the rows", 1e-6),
            Variable("s_rel_z", "m", "displacement from the tightened state, positive apart", 1e-6),
            Variable("v_rel_x", "m/s", "rate of s_rel_x", 1e-3),
            Variable("v_rel_y", "m/s", "rate of s_rel_y", 1e-3),
            Variable("v_rel_z", "m/s", "rate of s_rel_z", 1e-3),
        ),
        outputs=(
            Variable("f_x", "N", "force on side 2 along x, restoring", 1e4),
            Variable("f_y", "N", "force on side 2 along y, restoring", 1e4),
            Variable("f_z", "N", "force on side 2 along the normal, negative when pulled apart", 1e4),
            Variable("K_xx", "N/m", "tangential stiffness -df_x/ds_rel_x", 1e10),
            Variable("K_yy", "N/m", "tangential stiffness -df_y/ds_rel_y", 1e10),
            Variable("K_zz", "N/m", "normal stiffness -df_z/ds_rel_z", 1e10),
            Variable("C_xx", "N.s/m", "viscous-equivalent damping along x", 1e4),
            Variable("C_yy", "N.s/m", "viscous-equivalent damping along y", 1e4),
            Variable("C_zz", "N.s/m", "viscous-equivalent damping along the normal", 1e4),
            Variable("eta_t", "1", "tangential dissipation factor"),
            Variable("eta_n", "1", "normal dissipation factor"),
            Variable("K_rx", "N.m/rad", "rotational stiffness about x through the centroid", 1e8),
            Variable("K_ry", "N.m/rad", "rotational stiffness about y through the centroid", 1e8),
            Variable("K_rz", "N.m/rad", "rotational stiffness about the normal, same point", 1e8),
            Variable("p_mean", "Pa", "mean contact pressure", 1e6),
            Variable("p_max", "Pa", "largest contact pressure", 1e6),
        ),
        evaluate=_evaluate,
        outside=(
            Outside(
                "moment",
                lambda j, end, v: (-_row_moment(j, v["preload"]), _row_moment(j, v["preload"])),
                "a bolt force would be negative; the contact is open where the pressure would be",
            ),
            Outside("p_max", lambda j, end, v: (-math.inf, end[1]), BEYOND),
        ),
        ramp=Ramp("preload", 30e3, 100.0),
        dependencies={
            "f_x": (*_TIGHT, "s_rel_x", "s_rel_z", "v_rel_x"),
            "f_y": (*_TIGHT, "s_rel_y", "s_rel_z", "v_rel_y"),
            "f_z": (*_TIGHT, *_SHIFT, "v_rel_z"),
            "K_zz": (*_TIGHT, *_SHIFT),
            "eta_t": (),
            **dict.fromkeys(
                (
                    "K_xx",
                    "K_yy",
                    "C_xx",
                    "C_yy",
                    "C_zz",
                    "eta_n",
                    "K_rx",
                    "K_ry",
                    "K_rz",
                    "p_mean",
                    "p_max",
                ),
                (*_TIGHT, "s_rel_z"),
            ),
        },
        hidden=("pattern", "field"),
    ),
)
