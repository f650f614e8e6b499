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

PressureFunction = Callable[[Any, PressureDistribution, Array, Array], Array]
"""Function (joint, pressure distribution, preloads, moments) -> nodal pressures."""


class BoltedInterface(InterfaceLaw, Protocol):
    """Parameters of a bolted joint whose pressure may be a field: a frozen dataclass of interface and bolts.

    A finite-element solution sets `A_0`, `side1.E`, `side1.nu`, `side2.E`, `side2.nu`, `n_bolts`, `row_bolts`
    and `row_distance`. A field also replaces the group `pattern` by the table [field].
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


def check_pressure_field(joint: str) -> None:
    """Raise ValueError if a kind of joint has no parameters for a pressure field."""
    if joint != KIND.name:
        raise ValueError(f"joint = {joint!r} has no pressure field; expected {KIND.name!r}")


def nodal_pressures(
    joint: Any,
    pressure_shape: PressureDistribution | MergedDistribution,
    preload: ArrayLike,
    moment: ArrayLike,
) -> Array:
    """Nodal pressures (m, n) [Pa], >= 0: (preload n_bolts preload_shape + moment/L_a moment_shape)/A_0.

    pressure_shape : pressure distribution at n nodes, divided by its mean
    preload        : preloads (m) [N] per bolt, without a further loss by embedding: a field is computed for
                     the preload that remains
    moment         : moments (m) [N.m]
    """
    return preload_pressure(replace(joint, embedding=0.0), pressure_shape, preload, moment)
