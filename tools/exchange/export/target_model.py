"""The finite-element model of the user that receives an export: units, axes, free numbers, springs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array
from jointfmu.quantity.units import conversion_factor, replace_symbols
from jointfmu.version import __version__

FloatOrArrayType = TypeVar("FloatOrArrayType", float, NDArray[np.float64])


@dataclass(frozen=True, slots=True)
class UnitSet:
    """Consistent set of units of a finite-element model.

    unit_set_name : units of length, force, pressure and mass, as `mm-N-MPa-t`
    unit_symbols  : {SI symbol: symbol in this set}, where they differ
    """

    unit_set_name: str
    unit_symbols: Mapping[str, str]

    def convert_from_si(self, si_value: FloatOrArrayType, si_unit: str) -> FloatOrArrayType:
        """Convert a value from an SI unit to the consistent unit of this set."""
        return si_value * conversion_factor(si_unit, self.unit_symbol(si_unit))

    def unit_symbol(self, si_unit: str) -> str:
        """Symbol of the consistent unit of this set, for an SI unit."""
        return replace_symbols(si_unit, self.unit_symbols)


SI_UNIT_SET = UnitSet("m-N-Pa-kg", {})
"""Unit set of a finite-element model in SI units."""
UNIT_SETS = {
    units.unit_set_name: units
    for units in (SI_UNIT_SET, UnitSet("mm-N-MPa-t", {"m": "mm", "Pa": "MPa", "kg": "t"}))
}
"""{name: set of units}: SI, and the set that is common in finite-element models."""


@dataclass(frozen=True, slots=True)
class Springs:
    """Springs and dashpots of n closed node pairs. x and y lie in the joint's plane, z is its normal.

    node_labels                 : (n, 2) labels on side 1 and side 2
    position                    : (n, 2) [m] relative to the centroid of the contact
    area                        : (n) [m2]
    pressure                    : (n) [Pa]
    K_n, K_t                    : (n) [N/m] stiffness along z; along x and along y
    C_n, C_t                    : (n) [N.s/m] damping along z; along x and along y
    total_stiffness_and_damping : {name: stiffness K_ [N/m] or damping C_ [N.s/m]}, summed over pairs
    stiffness_correction_factor : [1] by which the stiffness of each pair is multiplied, so that the sum over
                                  all pairs is the stiffness of the joint
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
class TargetModel:
    """Finite-element model of the user that receives the exported springs or stiffness matrix.

    unit_set              : units of the model
    joint_normal_axis     : axis of the model along the joint's normal, a key of AXIS_ORDER
    first_free_number     : first free number for elements and nodes
    first_free_set_number : first free number for element types and sets of real constants (ANSYS)
    defines_nodes         : whether the written file defines the nodes, in place of nodes of the model
    """

    unit_set: UnitSet = SI_UNIT_SET
    joint_normal_axis: str = "z"
    first_free_number: int = 1
    first_free_set_number: int = 1
    defines_nodes: bool = True

    def model_coordinates(self, joint_plane_positions: Array) -> Array:
        """Coordinates (n, 3) in the model, in its units, of positions (n, 2) [m] in the joint's plane."""
        placed = np.zeros((len(joint_plane_positions), 3))
        placed[:, AXIS_ORDER[self.joint_normal_axis][:2]] = self.unit_set.convert_from_si(
            joint_plane_positions, "m"
        )
        return placed

    def assign_to_axes(self, tangential_values: Array, normal_values: Array) -> Array:
        """Assign tangential (n) and normal (n) values to the model's axes x, y, z; returns (n, 3)."""
        placed = np.stack([tangential_values] * 3, axis=1)
        placed[:, AXIS_ORDER[self.joint_normal_axis][2]] = normal_values
        return placed


def format_comment_header(comment_lines: Sequence[str], comment_mark: str) -> list[str]:
    """Format the comment at the head of an exported file in ASCII; each line starts with the comment mark."""
    plain = (" ".join(line.split()).encode("ascii", "replace").decode() for line in comment_lines)
    return [
        f"{comment_mark} written by jointfmu {__version__}",
        *(f"{comment_mark} {line}" for line in plain),
    ]
