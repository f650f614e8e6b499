"""Nodal contact results: unchecked result of a file, checked pressure field of a plane joint, CSV format.

A CSV file has the columns x [m], y [m], area [m2], pressure [Pa], and one node per line. The heading states
the units; see COLUMN_UNITS for others. The x axis is along the bolt rows.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.reading import read_bytes
from jointfmu.quantity import Array
from jointfmu.quantity.units import UnitSizes, unit_sizes

from ...common import columns

NUMBER_PATTERN = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?")
"""Pattern of a number in a listing, also with a Fortran exponent (1.5D+03)."""


def read_lines(path: Path, file_description: str) -> list[str]:
    """Read the lines of a text file of results; ValueError (one line) if the file cannot be read.

    file_description : name of the content in the message
    """
    return read_bytes(path, file_description).decode("latin-1").splitlines()


@dataclass(frozen=True, slots=True)
class ContactField:
    """Pressure field at the nodes of a plane contact.

    area     : (n) [m2] of the contact per node, > 0
    position : (n, 2) [m] in the plane of the joint, with any origin
    pressure : (n) [Pa] >= 0; 0 where the contact is open
    """

    area: Array
    position: Array
    pressure: Array

    @property
    def force(self) -> float:
        """Total normal force of the pressure field [N]."""
        return float(np.sum(self.area * self.pressure))

    @property
    def centroid(self) -> Array:
        """Centroid of the contact (2) [m]."""
        return np.asarray(np.average(self.position, axis=0, weights=self.area))


NodeIndices = NDArray[np.intp]
"""Array of node indices."""

LENGTH_UNITS = unit_sizes("m", "mm", "um")
"""Allowed units of length in files: {unit: size in SI units}."""
PRESSURE_UNITS = unit_sizes("Pa", "kPa", "MPa", "GPa")
"""Allowed units of pressure in files: {unit: size in SI units}."""


@dataclass(frozen=True, slots=True)
class NodalResult:
    """Nodal pressure as read from a file, in SI units, not yet checked.

    path             : path of the file
    node_label       : word for a node in messages: line or node
    node_numbers     : (n) number of each node
    position         : (n, 3) [m]
    pressure         : (n) [Pa], NaN where the file has none
    area             : (n) [m2] of each node, if the file has it
    faces            : blocks (k, 3 | 4 | 6 | 8 | 9) of node indices in these arrays: surface cells, or
                       boundary faces of the bodies; corners first, then mid-side nodes, then the centre
    body_of_node     : (n) number of the body of each node, if there are bodies
    omits_open_nodes : whether the file leaves out open nodes: on the contact, NaN then means zero pressure
    """

    path: Path
    node_label: str
    node_numbers: NDArray[np.int64]
    position: Array
    pressure: Array
    area: Array | None = None
    faces: Sequence[NodeIndices] = ()
    body_of_node: NDArray[np.int64] | None = None
    omits_open_nodes: bool = False

    def describe_node(self, node_index: int) -> str:
        """Name the node with an index in a message: file and node number."""
        return f"{self.path}: {self.node_label} {self.node_numbers[node_index]}"


COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "x": LENGTH_UNITS,
    "y": LENGTH_UNITS,
    "area": unit_sizes(*(f"{unit}2" for unit in LENGTH_UNITS)),
    "pressure": PRESSURE_UNITS,
}
"""Columns of a CSV file with a nodal result: {name: {allowed unit: its size in SI units}}."""


def read_csv(path: Path) -> NodalResult:
    """Read a nodal result from a CSV file; ValueError with file, line and column if it cannot be read."""
    table = columns.read_columns(path, COLUMN_UNITS, 1)
    quantities = {name: table.require_column(name, COLUMN_UNITS) for name in COLUMN_UNITS}
    return NodalResult(
        path=path,
        node_label="line",
        node_numbers=np.array(table.line_numbers, dtype=np.int64),
        position=np.column_stack([quantities["x"], quantities["y"], np.zeros_like(quantities["x"])]),
        pressure=quantities["pressure"],
        area=quantities["area"],
    )


def csv_text(contact_field: ContactField) -> str:
    """Text of a CSV file with a pressure field in SI units; `read_csv` reads the same bits."""
    heads = [(name, next(iter(units))) for name, units in COLUMN_UNITS.items()]
    return columns.format_table(
        heads, [*contact_field.position.T, contact_field.area, contact_field.pressure]
    )
