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
from jointfmu.quantity.units import Sizes, sizes

from ..columns import Columns, read

COLUMNS: Mapping[str, Sizes] = {
    "node_1": sizes("1"),
    "node_2": sizes("1"),
    "x": sizes("m", "mm"),
    "y": sizes("m", "mm"),
    "area": sizes("m2", "mm2"),
    "pressure": sizes("Pa", "MPa"),
}
LARGEST_LABEL = 99_999_999
"""Largest label of a node: eight digits fit into the fixed columns of all solvers."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """Node pairs of a mesh.

    path     : file that the pairs were read from
    nodes    : (n, 2) labels on side 1 and side 2
    position : (n, 2) [m] in the joint's plane, relative to the centroid of the contact
    area     : (n)    [m2] contact area of each pair
    pressure : (n)    [Pa]; None: the pressure distribution of the joint is used
    """

    path: Path
    nodes: NDArray[np.int64]
    position: Array
    area: Array
    pressure: Array | None


def read_pairs(path: str | Path) -> Mesh:
    """Read node pairs from a CSV file. The origin of x and y is arbitrary.

    Raises ValueError, one line with file and node: a file that `columns.read_columns` cannot read, a missing
    column, a label that is no positive whole number or stands twice, an area that is not positive, a negative
    pressure, or a pressure that is zero everywhere.
    """
    table = read(path, COLUMNS, 3)
    nodes = np.stack([_labels(table, name) for name in ("node_1", "node_2")], axis=1)
    labels, counts = np.unique(nodes, return_counts=True)
    if np.any(counts > 1):
        raise ValueError(f"{table.path}: node {labels[counts > 1][0]} stands twice, allowed is once")
    area = table.require("area", COLUMNS)
    _refuse(table, nodes, "area", area, area <= 0.0, "it must be positive")
    pressure = table.columns.get("pressure")
    if pressure is not None:
        _refuse(table, nodes, "pressure", pressure, pressure < 0.0, "a contact does not pull")
        if not np.any(pressure > 0.0):
            raise ValueError(f"{table.path}: pressure is zero everywhere; expected a closed contact")
    position = np.stack([table.require(name, COLUMNS) for name in ("x", "y")], axis=1)
    return Mesh(table.path, nodes, position - np.average(position, axis=0, weights=area), area, pressure)


def _labels(table: Columns, name: str) -> NDArray[np.int64]:
    value = table.require(name, COLUMNS)
    bad = (value != np.round(value)) | (value < 1.0) | (value > LARGEST_LABEL)
    if np.any(bad):
        raise ValueError(
            f"{table.path}: {name} = {value[bad][0]:.10g} is no node; "
            f"expected a whole number in [1, {LARGEST_LABEL}]"
        )
    return value.astype(np.int64)


def _refuse(
    table: Columns, nodes: NDArray[np.int64], name: str, value: Array, bad: NDArray[np.bool_], why: str
) -> None:
    if np.any(bad):
        raise ValueError(f"{table.path}: {name} = {value[bad][0]:g} (SI) at node {nodes[bad][0, 0]}: {why}")
