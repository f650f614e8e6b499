"""Bolted joint with a pressure field: parameters, and nodal pressures under preload and moment."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar, Protocol

from numpy.typing import ArrayLike

from jointfmu.contact.interface import InterfaceLaw
from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.law import preload_pressure
from jointfmu.mechanics.footprint.bolts import PressureSource
from jointfmu.mechanics.footprint.distribution import MergedDistribution, PressureDistribution
from jointfmu.quantity import Array

NodalPressureFunction = Callable[[Any, PressureDistribution, Array, Array], Array]
"""Function (joint, pressure distribution, preloads, moments) -> nodal pressures."""


class BoltedInterface(InterfaceLaw, Protocol):
    """Parameters of a bolted joint whose contact pressure may come from finite elements (frozen dataclass).

    A finite-element solution sets the contact area `A_0`, the elastic constants `side1.E`, `side1.nu`,
    `side2.E`, `side2.nu`, and `n_bolts`, `row_bolts`, `row_distance`. A pressure field also replaces the
    group `pattern` by the table [field].
    """

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def n_bolts(self) -> float:
        """Number of bolts [1]."""

    @property
    def row_bolts(self) -> float:
        """Number of bolts [1] in each of the two rows that carry a moment."""

    @property
    def row_distance(self) -> float:
        """Distance L_a [m] between the two bolt rows that carry a moment."""

    @property
    def pattern(self) -> PressureSource:
        """Source of the pressure distribution: table [pattern], [plate] or [field] of a parameter file."""


def check_pressure_field(joint_name: str) -> None:
    """Raise ValueError if a kind of joint has no parameters for a pressure field."""
    if joint_name != KIND.name:
        raise ValueError(f"joint = {joint_name!r} has no pressure field; expected {KIND.name!r}")


def nodal_pressures(
    bolted_joint: Any,
    pressure_shape: PressureDistribution | MergedDistribution,
    preload: ArrayLike,
    bending_moment: ArrayLike,
) -> Array:
    """Pressures p >= 0 [Pa] at n nodes of a bolted joint, in m load cases: array (m, n).

    p = (preload n_bolts e + bending_moment/L_a t)/A_0, with the distance L_a of the bolt rows, the contact
    area A_0 and, for each node, e = `preload_pressure_ratio` and t = `moment_pressure_ratio`.

    pressure_shape : pressure distribution at n nodes, divided by its mean
    preload        : preloads (m) [N] per bolt, without a further loss by embedding: a field is computed for
                     the preload that remains
    bending_moment : bending moments (m) [N.m]
    """
    return preload_pressure(replace(bolted_joint, embedding=0.0), pressure_shape, preload, bending_moment)
