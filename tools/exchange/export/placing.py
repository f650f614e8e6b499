"""Placement of a joint in the user's model: node pairs with springs, axes, units, element numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array
from jointfmu.quantity.units import conversion_factor, replace_symbols
from jointfmu.version import __version__

ValueType = TypeVar("ValueType", float, NDArray[np.float64])


@dataclass(frozen=True, slots=True)
class UnitSet:
    """Consistent set of units of a finite-element model.

    name    : units of length, force, pressure and mass, as `mm-N-MPa-t`
    symbols : {SI symbol: symbol in this set}, where they differ
    """

    name: str
    symbols: Mapping[str, str]

    def convert(self, value: ValueType, unit: str) -> ValueType:
        """Convert a value from an SI unit to the consistent unit of this set."""
        return value * conversion_factor(unit, self.symbol(unit))

    def symbol(self, unit: str) -> str:
        """Symbol of the consistent unit of this set, for an SI unit."""
        return replace_symbols(unit, self.symbols)


SI_UNIT_SET = UnitSet("m-N-Pa-kg", {})
"""Unit set of a finite-element model in SI units."""
UNIT_SETS = {
    units.name: units for units in (SI_UNIT_SET, UnitSet("mm-N-MPa-t", {"m": "mm", "Pa": "MPa", "kg": "t"}))
}
"""{name: set of units}: SI, and the set that is common in finite-element models."""


@dataclass(frozen=True, slots=True)
class Springs:
    """Springs and dashpots of the closed node pairs. x and y lie in the joint's plane, z is its normal.

    node_labels                 : (n, 2) labels on side 1 and side 2
    position                    : (n, 2) [m] relative to the centroid of the contact
    area                        : (n) [m2]
    pressure                    : (n) [Pa]
    K_n, K_t                    : (n) [N/m] stiffness along z; along x and along y
    C_n, C_t                    : (n) [N.s/m] damping along z; along x and along y
    total_stiffness_and_damping : {name: stiffness K_ [N/m] or damping C_ [N.s/m]}, summed over pairs
    stiffness_correction_factor : [1] on the stiffness of each pair, so that the sum is that of the joint
    open_pair_count             : number of open pairs, which are left out
    """

    node_labels: NDArray[np.int64]
    position: Array
    area: Array
    pressure: Array
    K_n: Array
    K_t: Array
    C_n: Array
    C_t: Array
    total_stiffness_and_damping: dict[str, float]
    stiffness_correction_factor: float
    open_pair_count: int


AXIS_ORDER = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
"""{axis of the model along the joint's normal: indices of the model axes along the joint's x, y, z}."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Placement of the springs in the user's model.

    units                 : units of the model
    normal_axis           : axis of the model along the joint's normal, a key of AXIS_ORDER
    first_free_number     : first free number for elements and nodes
    first_free_set_number : first free number for element types and sets of real constants (ANSYS)
    has_own_nodes         : whether the written file defines the nodes, in place of nodes of the model
    """

    units: UnitSet = SI_UNIT_SET
    normal_axis: str = "z"
    first_free_number: int = 1
    first_free_set_number: int = 1
    has_own_nodes: bool = True

    def model_coordinates(self, position: Array) -> Array:
        """Coordinates (n, 3) in the model, in its units, of positions (n, 2) [m] in the joint's plane."""
        placed = np.zeros((len(position), 3))
        placed[:, AXIS_ORDER[self.normal_axis][:2]] = self.units.convert(position, "m")
        return placed

    def assign_to_axes(self, tangential_values: Array, normal_values: Array) -> Array:
        """Assign tangential (n) and normal (n) values to the model's axes x, y, z; returns (n, 3)."""
        placed = np.stack([tangential_values] * 3, axis=1)
        placed[:, AXIS_ORDER[self.normal_axis][2]] = normal_values
        return placed


def format_comment_header(lines: Sequence[str], comment_mark: str) -> list[str]:
    """Format the comment at the head of an exported file in ASCII; each line starts with the comment mark."""
    plain = (" ".join(line.split()).encode("ascii", "replace").decode() for line in lines)
    return [
        f"{comment_mark} written by jointfmu {__version__}",
        *(f"{comment_mark} {line}" for line in plain),
    ]
