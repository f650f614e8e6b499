"""Nodal contact results: unchecked result of a file, checked pressure field of a plane joint, CSV format.

A CSV file has the columns x [m], y [m], area [m2], pressure [Pa], and one node per line. The heading states
the units; see FIELD_COLUMN_UNITS for others. The x axis is along the bolt rows.
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

LISTING_NUMBER_PATTERN = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?")
"""Pattern of a number in a listing, also with a Fortran exponent (1.5D+03)."""


def read_result_lines(result_path: Path, file_description: str) -> list[str]:
    """Read the lines of a text file of results; ValueError (one line) if the file cannot be read.

    file_description : name of the content in the message
    """
    return read_bytes(result_path, file_description).decode("latin-1").splitlines()


@dataclass(frozen=True, slots=True)
class ContactPressureField:
    """Pressure field at the nodes of a plane contact.

    nodal_area     : (n) [m2] of the contact per node, > 0
    node_positions : (n, 2) [m] in the plane of the joint, with any origin
    nodal_pressure : (n) [Pa] >= 0; 0 where the contact is open
    """

    nodal_area: Array
    node_positions: Array
    nodal_pressure: Array

    @property
    def normal_force(self) -> float:
        """Total normal force of the pressure field [N]."""
        return float(np.sum(self.nodal_area * self.nodal_pressure))

    @property
    def contact_centroid(self) -> Array:
        """Centroid of the contact (2) [m]."""
        return np.asarray(np.average(self.node_positions, axis=0, weights=self.nodal_area))


NodeIndices = NDArray[np.intp]
"""Array of node indices."""

LENGTH_UNITS = unit_sizes("m", "mm", "um")
"""Allowed units of length in files: {unit: size in SI units}."""
PRESSURE_UNITS = unit_sizes("Pa", "kPa", "MPa", "GPa")
"""Allowed units of pressure in files: {unit: size in SI units}."""


@dataclass(frozen=True, slots=True)
class NodalResult:
    """Nodal pressure as read from a file, in SI units, not yet checked.

    result_path      : path of the file
    node_label       : word for a node in messages: line or node
    node_numbers     : (n) number of each node
    node_positions   : (n, 3) [m]
    nodal_pressure   : (n) [Pa], NaN where the file has none
    nodal_area       : (n) [m2] of each node, if the file has it
    boundary_faces   : node indices of surface cells, or of boundary faces of the bodies: one array (faces,
                       nodes per face) for each shape; corners first, then mid-side nodes, then the centre
    body_of_node     : (n) index of the body of each node, if there are bodies
    omits_open_nodes : whether the file leaves out open nodes: on the contact, NaN then means zero pressure
    """

    result_path: Path
    node_label: str
    node_numbers: NDArray[np.int64]
    node_positions: Array
    nodal_pressure: Array
    nodal_area: Array | None = None
    boundary_faces: Sequence[NodeIndices] = ()
    body_of_node: NDArray[np.int64] | None = None
    omits_open_nodes: bool = False

    def describe_node(self, node_index: int) -> str:
        """Name the node with an index in a message: file and node number."""
        return f"{self.result_path}: {self.node_label} {self.node_numbers[node_index]}"


FIELD_COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "x": LENGTH_UNITS,
    "y": LENGTH_UNITS,
    "area": unit_sizes(*(f"{unit}2" for unit in LENGTH_UNITS)),
    "pressure": PRESSURE_UNITS,
}
"""Columns of a CSV file with a nodal result: {name: {allowed unit: its size in SI units}}."""


FIELD_COLUMN_ALIASES = {
    "area": ("a", "fläche", "flaeche", "carea", "cnarea"),
    "pressure": ("p", "druck", "pressung", "kontaktdruck", "flächenpressung", "cpress", "pres"),
}
"""{column: accepted synonyms, in lower case}."""


def read_field_csv(csv_path: Path) -> NodalResult:
    """Read a nodal result from a CSV file; ValueError with file, line and column if it cannot be read."""
    table = columns.read_columns(csv_path, FIELD_COLUMN_UNITS, 1, FIELD_COLUMN_ALIASES)
    quantities = {name: table.require_column(name, FIELD_COLUMN_UNITS) for name in FIELD_COLUMN_UNITS}
    return NodalResult(
        result_path=csv_path,
        node_label="line",
        node_numbers=np.array(table.line_numbers, dtype=np.int64),
        node_positions=np.column_stack([quantities["x"], quantities["y"], np.zeros_like(quantities["x"])]),
        nodal_pressure=quantities["pressure"],
        nodal_area=quantities["area"],
    )


def format_field_csv(contact_field: ContactPressureField) -> str:
    """Text of a CSV file with a pressure field in SI units; `read_field_csv` reads the same bits."""
    heads = [(name, next(iter(units))) for name, units in FIELD_COLUMN_UNITS.items()]
    return columns.format_table(
        heads, [*contact_field.node_positions.T, contact_field.nodal_area, contact_field.nodal_pressure]
    )
