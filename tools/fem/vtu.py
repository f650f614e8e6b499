"""Meshes with data at their points, for ParaView."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from .elasticity import Array, Index


def packed(points: Array, cell_type: str, cells: Index, data: Mapping[str, Array]) -> bytes:
    """A VTU file: points (k, 3) [m], cells (m, corners) of meshio's `cell_type`, values (k, ...) by name."""
    import meshio

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "mesh.vtu"
        meshio.Mesh(points, [(cell_type, cells)], point_data=dict(data)).write(place)
        return place.read_bytes()
