"""Bolted joint: a frame under uneven pressure (Zhao 2018), normal, tangential and rotational."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..asperity import mindlin
from ..asperity.zhao2018 import Zhao2018, normal_stiffness, tangential_stiffness
from ..curve import Curve, approach_curve
from ..footprint.bolts import BoltPattern, PressureShape, pressure_shape
from ..footprint.nodes import Footprint
from ..interface import largest_spot
from ..quantity import group, quantity

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BoltedJoint(Zhao2018):
    """Parameters of the bolted joint: the interface law, the bolts and how they spread their force."""

    n_bolts: float = quantity("1", "number of bolts", ge=1.0)
    row_bolts: float = quantity("1", "bolts in each of the two rows that carry the moment", ge=1.0)
    row_distance: float = quantity("m", "distance L_a of the two bolt rows", gt=0.0)
    pattern: BoltPattern = group("frame and decay of the pressure around each bolt")

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("n_bolts", "row_bolts"):
            if getattr(self, name) % 1.0:
                raise ValueError(
                    f"{name} = {getattr(self, name):g} is no whole number, allowed are 1, 2, 3, ..."
                )
        if 2.0 * self.row_bolts > self.n_bolts:
            raise ValueError(
                f"row_bolts = {self.row_bolts:g} is outside [1, {0.5 * self.n_bolts:g}]: "
                "two rows cannot hold more bolts than the joint has"
            )


def pressures(joint: BoltedJoint, shape: PressureShape, preload: ArrayLike, moment: ArrayLike) -> Array:
    """Node pressures (..., n) [Pa] of the tightened joint, preload [N] per bolt, moment [N.m] (...).

    The moment raises the bolt forces of the row y > 0 by M/(L_a N_b) and lowers those of the row
    y < 0 (Zhao 2018, section 3). Where the sum would be negative the node is open.
    """
    mean = np.asarray(preload) * joint.n_bolts / joint.A_0
    shift = np.asarray(moment) / joint.row_distance / joint.A_0
    return np.maximum(mean[..., None] * shape.equal + shift[..., None] * shape.tilt, 0.0)


def row_forces(joint: BoltedJoint, preload: float, moment: float) -> tuple[float, float]:
    """Bolt forces [N] of the two rows under a moment."""
    shift = moment / (joint.row_distance * joint.row_bolts)
    return preload + shift, preload - shift


def shear_ratio(joint: BoltedJoint) -> float:
    """K_T/K_N [1], the same at every pressure: both sum the square root of the area of elastic spots."""
    return float(tangential_stiffness(joint, 1.0) / normal_stiffness(joint, 1.0))


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
        start = self.tightened(preload, moment)
        area, rho = self.joint.A_0, shear_ratio(self.joint)
        x, y, z = s_rel
        shear = 0.5 * rho * (x * x + y * y)
        p, k, bend, twist = self.curve.derivatives(start - z, 3)
        nodes = footprint(self.shape, p)
        K_n = float(area * nodes.translation(k))
        K_zz, K_t = float(area * nodes.translation(k + shear * twist)), rho * K_n
        elastic_z = float(area * nodes.translation(p - self.curve.derivatives(start, 0)[0] + shear * bend))
        eta_n = self.normal_loss_factor(p)
        eta_t = float(mindlin.loss_factor(self.joint.traction_ratio))
        C_n, C_t = eta_n * np.sqrt(self.joint.mass * K_n), eta_t * np.sqrt(self.joint.mass * K_t)
        K_rx, K_ry, K_rz = (float(nodes.rotation(area * k, rho * area * k, axis)) for axis in np.eye(3))
        return {
            "f_x": 0.0 - K_t * x - C_t * v_rel[0],
            "f_y": 0.0 - K_t * y - C_t * v_rel[1],
            "f_z": elastic_z - C_n * v_rel[2],
            "K_xx": K_t,
            "K_yy": K_t,
            "K_zz": K_zz,
            "C_xx": C_t,
            "C_yy": C_t,
            "C_zz": C_n,
            "eta_t": eta_t,
            "eta_n": eta_n,
            "K_rx": K_rx,
            "K_ry": K_ry,
            "K_rz": K_rz,
            "p_mean": float(nodes.mean_pressure),
            "p_max": float(np.max(p)),
        }

    def normal_loss_factor(self, p: Array) -> float:
        """eta_n [1] of the joint: plastic over elastic work of all nodes (Zhao 2018, Eqs. 16, 18, 19).

        Inside the closing of the contact, where the law itself has hardly an elastic spot, the value
        at its end is kept.
        """
        floor = self.curve.load[np.searchsorted(self.curve.displacement, 0.0)]
        spots, u = self.joint.spots(), largest_spot(self.joint, np.maximum(p, floor))
        plastic = self.shape.share @ spots.total("plastic_work", u)
        return float(plastic / (self.shape.share @ spots.total("elastic_work", u)))


def footprint(shape: PressureShape, p: Array) -> Footprint:
    """The flat contact with normal z as nodes."""
    n = shape.share.size
    position = np.column_stack([shape.position, np.zeros(n)])
    return Footprint(shape.share, position, np.tile([0.0, 0.0, 1.0], (n, 1)), p)
