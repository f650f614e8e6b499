"""The exported bolted joint: normal, tangential and rotational, under uneven pressure (Zhao 2018)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...asperity import mindlin
from ...curve import Curve, approach_curve
from ...footprint.bolts import pressure_shape
from ...footprint.shape import PressureShape
from ...interface import largest_spot
from ...quantity import Number
from .law import BoltedJoint, pressures, shear_ratio

Array = NDArray[np.float64]

SUMS = (
    "tightened", "pressure", "stiffness", "bend", "twist", "about_x", "about_y", "plastic", "elastic",
)  # fmt: skip
"""Sums over the nodes, times their shares of the area: pressure [Pa] at tightening and now with three
derivatives in the approach, stiffness [Pa/m] times y^2 and x^2, plastic and elastic work [J]."""


@dataclass(frozen=True, slots=True)
class BoltedJointSpring:
    """The exported joint: relative motion of its two sides in, force out.

    Every node follows the pressure-approach curve `p(delta)` of the interface from its own pressure
    at tightening. Force and stiffness derive from the potential

        U(s) = sum A (V(delta - s_z) + (rho/2) p'(delta - s_z) (s_x^2 + s_y^2)) + P_0 s_z,   V' = p,

    with the ratio rho = K_T/K_N, so the tangential stiffness follows the normal approach, and shear
    reacts on the normal force.
    """

    joint: BoltedJoint
    curve: Curve
    shape: PressureShape

    @classmethod
    def of(cls, joint: BoltedJoint) -> "BoltedJointSpring":
        """Tabulate a joint."""
        return cls(joint, approach_curve(joint), pressure_shape(joint.pattern))

    def tightened(self, preload: float, moment: float) -> Array:
        """Approach (n) [m] of the nodes at tightening."""
        return self.curve.inverse(pressures(self.joint, self.shape, preload, moment))

    def within_law(self, preload: float, moment: float) -> Array:
        """As `tightened`; ValueError if nothing is in contact or the hardness is reached."""
        start = self.tightened(preload, moment)
        low, high = self.curve.displacement[[0, -1]]
        if not (np.isfinite(preload + moment) and low < np.max(start) < high):
            raise ValueError(
                f"preload = {preload:g} N per bolt with moment = {moment:g} N.m is outside the law: expected "
                f"some contact and a pressure of at most {self.curve.end[1]:g} Pa"
            )
        return start

    def motion(
        self,
        preload: float,
        moment: float,
        s_rel: tuple[float, float, float],
        v_rel: tuple[float, float, float],
    ) -> dict[str, float]:
        """Forces [N], stiffnesses, damping and pressures at one state.

        preload [N] per bolt, moment [N.m], s_rel [m] (z positive apart), v_rel [m/s].
        """
        start, shape = self.tightened(preload, moment), self.shape
        p, k, bend, twist = self.curve.derivatives(start - s_rel[2], 3)
        x2, y2 = shape.position.T**2
        plastic, elastic = self.works(p)
        each = {
            "tightened": self.curve.derivatives(start, 0)[0],
            "pressure": p,
            "stiffness": k,
            "bend": bend,
            "twist": twist,
            "about_x": k * y2,
            "about_y": k * x2,
            "plastic": plastic,
            "elastic": elastic,
        }
        sums = {name: np.sum(shape.share * each[name]) for name in SUMS}
        return motion(self.joint, sums, s_rel, v_rel, np.max(p))

    def works(self, p: Array) -> tuple[Array, Array]:
        """Plastic and elastic work [J] of the whole area at pressures (...) (Zhao 2018, Eqs. 16, 18).

        Inside the closing of the contact, where the law itself has hardly an elastic spot, the values
        at its end are kept.
        """
        spots, u = self.joint.spots(), largest_spot(self.joint, np.maximum(p, self.curve.closed))
        return spots.total("plastic_work", u), spots.total("elastic_work", u)


def motion(
    joint: BoltedJoint,
    sums: Mapping[str, Number],
    s_rel: Sequence[Number],
    v_rel: Sequence[Number],
    p_max: Number,
) -> dict[str, Number]:
    """What the joint exports, from the SUMS of its nodes.

    A unit rotation about an in-plane axis moves a node along its normal, about the normal along the
    plane: Hu 2023, Eq. 45, corrected.
    """
    area, rho = joint.A_0, shear_ratio(joint)
    shear = 0.5 * rho * (s_rel[0] * s_rel[0] + s_rel[1] * s_rel[1])
    K_n = area * sums["stiffness"]
    K_t = rho * K_n
    eta_n = sums["plastic"] / sums["elastic"]
    eta_t = mindlin.loss_factor(joint.traction_ratio)
    C_n = mindlin.viscous_equivalent(eta_n, joint.mass, K_n)
    C_t = mindlin.viscous_equivalent(eta_t, joint.mass, K_t)
    K_rx, K_ry = area * sums["about_x"], area * sums["about_y"]
    return {
        "f_x": 0.0 - K_t * s_rel[0] - C_t * v_rel[0],
        "f_y": 0.0 - K_t * s_rel[1] - C_t * v_rel[1],
        "f_z": area * (sums["pressure"] - sums["tightened"] + shear * sums["bend"]) - C_n * v_rel[2],
        "K_xx": K_t,
        "K_yy": K_t,
        "K_zz": area * (sums["stiffness"] + shear * sums["twist"]),
        "C_xx": C_t,
        "C_yy": C_t,
        "C_zz": C_n,
        "eta_t": eta_t,
        "eta_n": eta_n,
        "K_rx": K_rx,
        "K_ry": K_ry,
        "K_rz": rho * (K_rx + K_ry),
        "p_mean": sums["pressure"],
        "p_max": p_max,
    }
