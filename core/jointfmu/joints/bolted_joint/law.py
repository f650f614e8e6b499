"""Bolted joint: its parameters, the pressure under its bolts, and the interface law's ratio (Zhao 2018)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...asperity.zhao2018 import Zhao2018, normal_stiffness, tangential_stiffness
from ...footprint.bolts import BoltPattern
from ...footprint.shape import MergedShape, NodalField, PressureShape
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
