"""Node pairs of the user's mesh, read from CSV.

The columns are `node_1 [1], node_2 [1], x [mm], y [mm], area [mm2]` and optionally `pressure [MPa]`: labels
of the two nodes of a pair, position in the joint's plane, contact area of the pair, and contact pressure,
for example from a contact analysis.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array
from jointfmu.quantity.units import UnitSizes, unit_sizes

from ...common.columns import TableColumns, read_columns

COLUMN_UNITS: Mapping[str, UnitSizes] = {
    "node_1": unit_sizes("1"),
    "node_2": unit_sizes("1"),
    "x": unit_sizes("m", "mm"),
    "y": unit_sizes("m", "mm"),
    "area": unit_sizes("m2", "mm2"),
    "pressure": unit_sizes("Pa", "MPa"),
}
"""Columns of the file of node pairs: {name: {allowed unit: its size in SI}}."""
MAX_NODE_LABEL = 99_999_999
"""Largest label of a node: eight digits fit into the fixed columns of all solvers."""


@dataclass(frozen=True, slots=True)
class NodePairs:
    """Opposite nodes of the user's mesh on both sides of the contact, in pairs.

    csv_path         : file that the pairs were read from
    node_labels      : (n, 2) labels on side 1 and side 2
    position         : (n, 2) [m] in the joint's plane, relative to the centroid of the contact
    contact_area     : (n)    [m2] contact area of each pair
    contact_pressure : (n)    [Pa]; None: the pressure distribution of the joint is used
    """

    csv_path: Path
    node_labels: NDArray[np.int64]
    position: Array
    contact_area: Array
    contact_pressure: Array | None


def read_node_pairs(csv_path: str | Path) -> NodePairs:
    """Read node pairs from a CSV file. The origin of x and y is arbitrary.

    Raises ValueError, one line with file and node: a file that `columns.read_columns` cannot read, a missing
    column, a label that is no positive whole number or is repeated, an area that is not positive, a negative
    pressure, or a pressure that is zero everywhere.
    """
    table = read_columns(csv_path, COLUMN_UNITS, 3)
    nodes = np.stack([_read_node_labels(table, name) for name in ("node_1", "node_2")], axis=1)
    labels, counts = np.unique(nodes, return_counts=True)
    if np.any(counts > 1):
        raise ValueError(f"{table.table_path}: node {labels[counts > 1][0]} is given twice; state it once")
    area = table.require_column("area", COLUMN_UNITS)
    _check_column_values(table, nodes, "area", area, area <= 0.0, "it must be positive")
    pressure = table.values_by_name.get("pressure")
    if pressure is not None:
        _check_column_values(table, nodes, "pressure", pressure, pressure < 0.0, "a contact does not pull")
        if not np.any(pressure > 0.0):
            raise ValueError(f"{table.table_path}: pressure is zero everywhere; expected a closed contact")
    position = np.stack([table.require_column(name, COLUMN_UNITS) for name in ("x", "y")], axis=1)
    return NodePairs(
        table.table_path, nodes, position - np.average(position, axis=0, weights=area), area, pressure
    )


def _read_node_labels(mesh_columns: TableColumns, column_name: str) -> NDArray[np.int64]:
    """Read a column of node labels. Raises ValueError for a label that is no positive whole number."""
    value = mesh_columns.require_column(column_name, COLUMN_UNITS)
    bad = (value != np.round(value)) | (value < 1.0) | (value > MAX_NODE_LABEL)
    if np.any(bad):
        raise ValueError(
            f"{mesh_columns.table_path}: {column_name} = {value[bad][0]:.10g} is not a node; "
            f"expected a whole number in [1, {MAX_NODE_LABEL}]"
        )
    return value.astype(np.int64)


def _check_column_values(
    mesh_columns: TableColumns,
    node_labels: NDArray[np.int64],
    column_name: str,
    column_values: Array,
    invalid_rows: NDArray[np.bool_],
    error_reason: str,
) -> None:
    """Raise ValueError with the node, if values of a column are invalid."""
    if np.any(invalid_rows):
        raise ValueError(
            f"{mesh_columns.table_path}: {column_name} = {column_values[invalid_rows][0]:g} (SI) at node "
            f"{node_labels[invalid_rows][0, 0]}: {error_reason}"
        )
