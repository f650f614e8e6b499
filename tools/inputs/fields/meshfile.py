"""Read nodal pressure from mesh files with point data: VTU, VTK and other formats of meshio."""

from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files.reading import check_regular_file
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from .mesh import (
    IGNORED_CELL_TYPES,
    SURFACE_CELL_NODE_COUNTS,
    VOLUME_CELLS,
    boundary_faces,
    label_bodies,
    make_missing_reader_error,
)
from .nodal_result import NodalResult


def read_mesh_file(
    mesh_path: Path, length_unit: float, pressure_unit: float, point_data_name: str | None
) -> NodalResult:
    """Read a nodal contact result from the point data of a mesh.

    length_unit, pressure_unit : size of the file's length unit [m] and pressure unit [Pa]
    point_data_name            : name of the point data with the pressure; NAME:3 is the third component

    Raises ValueError (one line): meshio is missing or cannot read the file, the point data do not exist (the
    message lists the existing ones), a cell type is not supported.
    """
    mesh = _read_meshio(mesh_path)
    values = _select_nodal_values(mesh_path, mesh.point_data, point_data_name)
    position = np.asarray(mesh.points, dtype=np.float64)
    position = np.pad(position, ((0, 0), (0, 3 - position.shape[1])))
    cells: dict[str, Any] = {}
    for block in mesh.cells:
        if block.type in IGNORED_CELL_TYPES:
            continue
        if block.type not in VOLUME_CELLS and block.type not in SURFACE_CELL_NODE_COUNTS:
            allowed = ", ".join([*SURFACE_CELL_NODE_COUNTS, *VOLUME_CELLS])
            raise ValueError(f"{mesh_path}: has cells {block.type!r}, allowed are {allowed}")
        rows = np.asarray(block.data, dtype=np.intp)
        cells[block.type] = np.concatenate([cells[block.type], rows]) if block.type in cells else rows
    if not cells:
        raise ValueError(
            f"{mesh_path}: has no cells with faces; expected the faces of the contact, or the bodies"
        )
    return NodalResult(
        result_path=mesh_path,
        node_label="node",
        node_numbers=np.arange(len(position), dtype=np.int64),
        node_positions=position * length_unit,
        nodal_pressure=values * pressure_unit,
        boundary_faces=boundary_faces(cells),
        body_of_node=label_bodies(cells, len(position)),
    )


def is_mesh_format_supported(mesh_path: Path) -> bool:
    """Whether meshio can read mesh files with the ending of this path.

    True if meshio is missing: the reader then raises.
    """
    try:
        from meshio import extension_to_filetypes
    except ImportError:
        return True
    return mesh_path.suffix.lower() in extension_to_filetypes


def _read_meshio(mesh_path: Path) -> Any:
    """Read a mesh with meshio; ValueError if meshio is missing or cannot read the file."""
    try:
        import meshio
    except ImportError as error:
        raise make_missing_reader_error(mesh_path, error) from None
    check_regular_file(mesh_path, "a mesh with point data")
    if not mesh_path.is_file():
        raise ValueError(f"{mesh_path}: cannot be read (no such file); expected a mesh with point data")
    try:
        return meshio.read(mesh_path)
    except (Exception, SystemExit) as error:  # the parsers of meshio raise exceptions of any kind
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise ValueError(
            f"{mesh_path}: meshio cannot read it ({reason}); expected a mesh with point data"
        ) from None


def _select_nodal_values(mesh_path: Path, point_data: dict[str, Any], point_data_name: str | None) -> Array:
    """Select nodal values (n) by name: an array of the point data, or one of its components."""
    arrays = {name: np.asarray(value) for name, value in point_data.items()}
    listed = [f"{n} ({v.shape[1]} components)" if v.ndim > 1 else n for n, v in arrays.items()]
    available = ", ".join(listed) or "none"
    if point_data_name is None:
        raise InputRefusal(
            f"{mesh_path}: state which point data are the pressure; the file has {available}", "data"
        )
    name, _, component = point_data_name.partition(":")
    name, component = (point_data_name, "") if point_data_name in arrays else (name, component)
    if name not in arrays:
        raise ValueError(f"{mesh_path}: has no point data {name!r}; there are {available}")
    value = arrays[name].reshape(len(arrays[name]), -1)
    if not component and value.shape[1] == 1:
        component = "1"
    if not component.isdigit() or not 1 <= int(component) <= value.shape[1]:
        raise ValueError(
            f"{mesh_path}: {point_data_name!r} is not a component of {name}; expected {name}:1 to "
            f"{name}:{value.shape[1]}"
        )
    return np.asarray(value[:, int(component) - 1], dtype=np.float64)
