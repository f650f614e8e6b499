"""A nodal contact result as a file has it, before it is checked."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array
from jointfmu.quantity.units import sizes

Nodes = NDArray[np.intp]

LENGTHS = sizes("m", "mm", "um")
PRESSURES = sizes("Pa", "kPa", "MPa", "GPa")
"""Units of files, in the SI unit."""


@dataclass(frozen=True, slots=True)
class NodalResult:
    """Pressure at nodes, in SI units.

    path     : of the file
    word     : what its nodes are named by: line, node
    names    : (n) number of each node
    place    : (n, 3) [m]
    pressure : (n) [Pa], NaN where the file has none
    area     : (n) [m2] of each node, if the file has it
    faces    : each (k, 3 | 4 | 6 | 8 | 9) places of nodes in these arrays: faces of the surface, or
               boundary faces of the bodies; corners first, then the middles of their edges, then the centre
    body     : (n) number of the body that a node belongs to, if there are bodies
    left_out : whether the file leaves open nodes out: on the contact, NaN means no pressure
    """

    path: Path
    word: str
    names: NDArray[np.int64]
    place: Array
    pressure: Array
    area: Array | None = None
    faces: Sequence[Nodes] = ()
    body: NDArray[np.int64] | None = None
    left_out: bool = False

    def at(self, i: int) -> str:
        """The file and the place of node i, for messages."""
        return f"{self.path}: {self.word} {self.names[i]}"
