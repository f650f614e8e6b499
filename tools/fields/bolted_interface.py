"""Functions and parameters of a kind of bolted joint for the commands that use pressure fields."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from jointfmu.contact.interface import InterfaceLaw
from jointfmu.joints import KINDS
from jointfmu.mechanics.footprint.bolts import PressureSource
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Number

from ..joint_parts import load_tool_module

PressureFunction = Callable[[Any, PressureDistribution, Array, Array], Array]


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
        """Distance L_a [m] between the two rows."""

    @property
    def pattern(self) -> PressureSource:
        """Source of the pressure distribution: table [pattern], [plate] or [field] of a parameter file."""


class BoltLayout(Protocol):
    """Bolt positions and sizes in the parameters of a joint; empty or 0 where the parameters have none."""

    @property
    def bolt_positions(self) -> Array:
        """Positions (b, 2) [m] relative to the centroid of the contact."""

    @property
    def hole_diameter(self) -> float:
        """Diameter of the holes [m]."""

    @property
    def head_diameter(self) -> float:
        """Outer diameter of the bolt heads or washers [m]."""


@dataclass(frozen=True, slots=True)
class FieldAdapter:
    """Functions of a joint for pressure fields: the constant FIELD_ADAPTER in `field.py` of its folder.

    nodal_pressures : nodal pressure (m, n) [Pa] for parameters, a normalised pressure distribution
        (n), preloads (m) [N] per bolt and moments (m) [N.m]:
        (preload n_bolts preload_shape + moment/L_a moment_shape)/A_0, >= 0
    tangential_stiffness_ratio : tangential over normal stiffness [1] for parameters, the same at every
        pressure
    bolt_layout : bolt positions, hole and head sizes for parameters, as far as they have them
    insert_elastic_bodies : parameter file with elastic bodies, from a parameter file, an assembly, the
        preload [N] per bolt, the name of the attachment and the normalised pressure at all nodes
    describe_joint : {name: (value, unit, meaning)} of the complete joint for such a file and preload
    """

    nodal_pressures: PressureFunction
    tangential_stiffness_ratio: Callable[[Any], Number]
    bolt_layout: Callable[[Any], BoltLayout]
    insert_elastic_bodies: Callable[[ParameterFile, Any, float, str, PressureDistribution], ParameterFile]
    describe_joint: Callable[[ParameterFile, float], dict[str, tuple[float, str, str]]]


def field_adapters() -> dict[str, FieldAdapter]:
    """{joint: its functions for pressure fields}, for all joints whose pressure may be a field."""
    modules = {name: load_tool_module(kind, "field") for name, kind in KINDS.items()}
    return {name: module.FIELD for name, module in modules.items() if module is not None}


def field_adapter(joint: str) -> FieldAdapter:
    """Functions for pressure fields of a kind of joint; ValueError if it takes no pressure field."""
    adapters = field_adapters()
    if joint not in adapters:
        allowed = " or ".join(repr(name) for name in adapters)
        raise ValueError(f"joint = {joint!r} has no pressure field; expected {allowed}")
    return adapters[joint]
