"""Bolted joint: a frame under uneven pressure (Zhao 2018), normal, tangential and rotational."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...asperity import mindlin
from ...asperity.zhao2018 import Zhao2018, normal_stiffness, tangential_stiffness
from ...curve import Curve, approach_curve
from ...footprint.bolts import BoltPattern, pressure_shape
from ...footprint.shape import MergedShape, NodalField, PressureShape
from ...interface import largest_spot
from ...quantity import Interval, Limit, Number, check_limits, group, quantity

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BoltedJoint(Zhao2018):
    """Parameters of the bolted joint: the interface law, the bolts and how they spread their force."""

    n_bolts: float = quantity("1", "number of bolts", ge=1.0, whole=True)
    row_bolts: float = quantity(
        "1", "bolts in each of the two rows that carry the moment", ge=1.0, whole=True
    )
    row_distance: float = quantity("m", "distance L_a of the two bolt rows", gt=0.0)
    pattern: BoltPattern | NodalField = group(
        "what gives the pressure: the decay around each bolt of a frame, or the points of a field",
        pattern=BoltPattern,
        field=NodalField,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_limits(self, self.limits())

    def limits(self) -> list[Limit]:
        """Intervals that other parameters decide."""
        why = "two rows cannot hold more bolts than the joint has"
        return [Limit("row_bolts", Interval.of(ge=1.0, le=0.5 * self.n_bolts), why)]


def bolt_pattern(joint: BoltedJoint) -> BoltPattern:
    """The frame of a joint whose pressure is that of a pattern of bolts.

    Raises ValueError if the joint has a nodal field instead.
    """
    if isinstance(joint.pattern, BoltPattern):
        return joint.pattern
    count = len(joint.pattern.share)
    raise ValueError(
        f"the joint has [field], a nodal field of {count} points; expected [pattern], a frame of bolts"
    )


def pressures(
    joint: BoltedJoint, shape: PressureShape | MergedShape, preload: ArrayLike, moment: ArrayLike
) -> Array:
    """Node pressures (..., n) [Pa] of the tightened joint, preload [N] per bolt, moment [N.m] (...).

    The moment raises the bolt forces of the row y > 0 by M/(L_a N_b) and lowers those of the row
    y < 0 (Zhao 2018, section 3). Where the sum would be negative the node is open.
    """
    force, bending = np.asarray(preload)[..., None], np.asarray(moment)[..., None]
    return np.asarray(node_pressure(joint, shape.equal, shape.tilt, force, bending))


def node_pressure(joint: BoltedJoint, equal: Number, tilt: Number, preload: Number, moment: Number) -> Number:
    """Pressure [Pa] of a node of the pressure shape."""
    return shaped_pressure(equal, tilt, *bolt_pressures(joint, preload, moment))


def bolt_pressures(joint: BoltedJoint, preload: Number, moment: Number) -> tuple[Number, Number]:
    """What `equal` and `tilt` of the pressure shape stand for [Pa]."""
    return preload * joint.n_bolts / joint.A_0, moment / joint.row_distance / joint.A_0


def shaped_pressure(equal: Number, tilt: Number, mean: Number, shift: Number) -> Number:
    """Pressure [Pa] of a node of the pressure shape, given `bolt_pressures`; none where it is open."""
    return np.maximum(mean * equal + shift * tilt, 0.0)


def row_forces(joint: BoltedJoint, preload: float, moment: float) -> tuple[float, float]:
    """Bolt forces [N] of the two rows under a moment."""
    shift = moment / (joint.row_distance * joint.row_bolts)
    return preload + shift, preload - shift


def shear_ratio(joint: BoltedJoint) -> Number:
    """K_T/K_N [1], the same at every pressure: both sum the square root of the area of elastic spots."""
    return tangential_stiffness(joint, 1.0) / normal_stiffness(joint, 1.0)


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
    C_n, C_t = eta_n * np.sqrt(joint.mass * K_n), eta_t * np.sqrt(joint.mass * K_t)
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
