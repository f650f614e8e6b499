"""How the joint lies in the model: springs between node pairs, axes, units, labels; the head of a file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from jointfmu import __version__
from jointfmu.quantity import Array
from jointfmu.quantity.units import factor, rewritten

T = TypeVar("T", float, NDArray[np.float64])


@dataclass(frozen=True, slots=True)
class Units:
    """A consistent set of units.

    name    : length, force, pressure and mass
    symbols : {SI symbol: its own} where they differ
    """

    name: str
    symbols: Mapping[str, str]

    def of(self, value: T, unit: str) -> T:
        """A value given in an SI unit, in this set."""
        return value * factor(unit, self.symbol(unit))

    def symbol(self, unit: str) -> str:
        """How the set writes an SI unit."""
        return rewritten(unit, self.symbols)


SI = Units("m-N-Pa-kg", {})
UNITS = {units.name: units for units in (SI, Units("mm-N-MPa-t", {"m": "mm", "Pa": "MPa", "kg": "t"}))}
"""The sets by name, SI first; the second is the one usual in finite elements."""


@dataclass(frozen=True, slots=True)
class Springs:
    """Springs and dashpots of the closed node pairs; x and y lie in the joint's plane, z is its normal.

    nodes      : (n, 2) labels on side 1 and side 2
    position   : (n, 2) [m] from the centroid of the contact
    area       : (n)    [m2]
    pressure   : (n)    [Pa]
    K_n, K_t   : (n)    [N/m] along z; along x and along y
    C_n, C_t   : (n)    [N.s/m] the same
    sums       : what the joint has, and what the pairs add up to: K_ [N/m], C_ [N.s/m]
    correction : [1] factor by which the pairs' stiffness was multiplied to add up to the joint's
    opened     : pairs that are open and left out
    """

    nodes: NDArray[np.int64]
    position: Array
    area: Array
    pressure: Array
    K_n: Array
    K_t: Array
    C_n: Array
    C_t: Array
    sums: dict[str, float]
    correction: float
    opened: int


AXES = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
"""{axis of the model that is the joint's normal: axes of the model along the joint's x, y, z}."""


@dataclass(frozen=True, slots=True)
class Placing:
    """What the springs need to stand in a model.

    units     : of the model
    normal    : axis of the model along the joint's normal, a key of AXES
    first     : first number that is free in the model for elements and nodes
    first_set : the same for element types and sets of real constants (ANSYS)
    own       : whether the file brings its own nodes
    """

    units: Units = SI
    normal: str = "z"
    first: int = 1
    first_set: int = 1
    own: bool = True

    def coordinates(self, position: Array) -> Array:
        """Coordinates (n, 3) in the model of places (n, 2) [m] in the joint's plane."""
        placed = np.zeros((len(position), 3))
        placed[:, AXES[self.normal][:2]] = self.units.of(position, "m")
        return placed

    def along(self, tangential: Array, normal: Array) -> Array:
        """Columns (n, 3) along the model's x, y, z of values in the joint's plane and along its normal."""
        placed = np.stack([tangential] * 3, axis=1)
        placed[:, AXES[self.normal][2]] = normal
        return placed


def header(lines: Sequence[str], mark: str) -> list[str]:
    """The comment at the head of a file: every line behind `mark`, plain ASCII."""
    plain = (" ".join(line.split()).encode("ascii", "replace").decode() for line in lines)
    return [f"{mark} written by jointfmu {__version__}", *(f"{mark} {line}" for line in plain)]
