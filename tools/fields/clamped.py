"""Joints that bolts clamp and whose pressure may be a field: what `footprint` and `modes` need of them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from jointfmu.contact.interface import InterfaceLaw
from jointfmu.joints import KINDS
from jointfmu.mechanics.footprint.bolts import PressureSource
from jointfmu.mechanics.footprint.shape import PressureShape
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Number

from ..joint_parts import part

Pressures = Callable[[Any, PressureShape, Array, Array], Array]


class BoltedInterface(InterfaceLaw, Protocol):
    """Parameters of such a joint: an interface law and its bolts. They are a frozen dataclass.

    A solution by finite elements sets `A_0`, `side1.E`, `side1.nu`, `side2.E`, `side2.nu`, `n_bolts`,
    `row_bolts` and `row_distance`, a field also the group `pattern`, by its table [field].
    """

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def n_bolts(self) -> float:
        """Bolts [1]."""

    @property
    def row_bolts(self) -> float:
        """Bolts [1] in each of the two rows that carry a moment."""

    @property
    def row_distance(self) -> float:
        """Distance L_a [m] of the rows."""

    @property
    def pattern(self) -> PressureSource:
        """What gives the pressure; tables [pattern], [plate] and [field] of a parameter file."""


class BoltLayout(Protocol):
    """What parameters say of their bolts: 0 or nothing where they do not."""

    @property
    def bolts(self) -> Array:
        """Places (b, 2) [m] from the centroid of the contact."""

    @property
    def hole(self) -> float:
        """Diameter [m]."""

    @property
    def head(self) -> float:
        """Outer diameter [m] of what presses."""


@dataclass(frozen=True, slots=True)
class Clamping:
    """How such a joint carries its bolts' forces: `FIELD` of the file field.py in its folder.

    pressures   : node pressures (m, n) [Pa] of parameters, a shape (n), preloads (m) [N] per bolt and moments
                  (m) [N.m]: (preload n_bolts equal + moment/L_a tilt)/A_0, and 0 where that is negative
    shear_ratio : tangential over normal stiffness [1] of parameters, the same at every pressure
    layout      : places of its bolts and sizes of holes and heads, as far as parameters have them
    whole       : a parameter file with the bodies of an assembly between attachments of a name, at the
                  force [N] that tightens each bolt and the pressure of all nodes
    facts       : {name: (value, unit, meaning)} of the whole joint of such a file at that force
    """

    pressures: Pressures
    shear_ratio: Callable[[Any], Number]
    layout: Callable[[Any], BoltLayout]
    whole: Callable[[ParameterFile, Any, float, str, PressureShape], ParameterFile]
    facts: Callable[[ParameterFile, float], dict[str, tuple[float, str, str]]]


def clamped() -> dict[str, Clamping]:
    """{name: clamping} of the joints that have one."""
    parts = {name: part(kind, "field") for name, kind in KINDS.items()}
    return {name: own.FIELD for name, own in parts.items() if own is not None}


def clamping(joint: str) -> Clamping:
    """That of a joint; ValueError if it has none."""
    there = clamped()
    if joint not in there:
        allowed = " or ".join(repr(name) for name in there)
        raise ValueError(f"joint = {joint!r} has no field of pressure; expected {allowed}")
    return there[joint]
