"""How the joint lies in the model: axes, units, labels; and the comment at the head of a file."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointfmu import __version__
from jointfmu.quantity import Array

from .units import SI, Units

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
