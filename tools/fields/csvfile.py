"""CSV of a contact field: x [m], y [m], area [m2], pressure [Pa], one node per line.

The heading states the units, which may be others (COLUMNS). x runs along the bolt rows, y across them.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jointfmu.quantity.units import Sizes, sizes

from .. import columns
from .contact import ContactField
from .nodal_result import LENGTHS, PRESSURES, NodalResult

COLUMNS: Mapping[str, Sizes] = {
    "x": LENGTHS,
    "y": LENGTHS,
    "area": sizes(*(f"{unit}2" for unit in LENGTHS)),
    "pressure": PRESSURES,
}


def read(path: Path) -> NodalResult:
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


def text(field: ContactField) -> str:
    """A field as the text of a file that `read` reads back, in SI units and to the last bit."""
    heads = [(name, next(iter(units))) for name, units in COLUMNS.items()]
    return columns.text(heads, [*field.position.T, field.area, field.pressure])
