"""A nodal contact result: on a plane joint, as a file has it before it is checked, and as CSV.

CSV has x [m], y [m], area [m2], pressure [Pa], one node per line. The heading states the units, which may be
others (COLUMNS). x runs along the bolt rows, y across them.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.reading import read_bytes
from jointfmu.quantity import Array
from jointfmu.quantity.units import Sizes, sizes

from .. import columns

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?")
"""A number of a listing, Fortran's exponents among them."""


def read_lines(path: Path, what: str) -> list[str]:
    """The lines of a listing; ValueError, one line, for what cannot be read."""
    return read_bytes(path, what).decode("latin-1").splitlines()


@dataclass(frozen=True, slots=True)
class ContactField:
    """Pressure at the nodes of a plane contact, whatever made it.

    area     : (n)    [m2] part of the contact that the node stands for, > 0
    position : (n, 2) [m]  in the joint's plane, any origin
    pressure : (n)    [Pa] >= 0; 0 where the contact is open
    """

    area: Array
    position: Array
    pressure: Array

    @property
    def force(self) -> float:
        """Total normal force [N]."""
        return float(np.sum(self.area * self.pressure))

    @property
    def centroid(self) -> Array:
        """Centroid of the contact (2) [m]."""
        return np.asarray(np.average(self.position, axis=0, weights=self.area))


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


COLUMNS: Mapping[str, Sizes] = {
    "x": LENGTHS,
    "y": LENGTHS,
    "area": sizes(*(f"{unit}2" for unit in LENGTHS)),
    "pressure": PRESSURES,
}


def read_csv(path: Path) -> NodalResult:
    """The nodes of a file, in SI units; ValueError with file, line and column otherwise."""
    table = columns.read(path, COLUMNS, 1)
    quantities = {name: table.require(name, COLUMNS) for name in COLUMNS}
    return NodalResult(
        path=path,
        word="line",
        names=np.array(table.lines, dtype=np.int64),
        place=np.column_stack([quantities["x"], quantities["y"], np.zeros_like(quantities["x"])]),
        pressure=quantities["pressure"],
        area=quantities["area"],
    )


def csv_text(field: ContactField) -> str:
    """A field as the text of a file that `read` reads back, in SI units and to the last bit."""
    heads = [(name, next(iter(units))) for name, units in COLUMNS.items()]
    return columns.text(heads, [*field.position.T, field.area, field.pressure])
