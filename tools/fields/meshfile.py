"""Meshes with point data: VTU, VTK and whatever else meshio reads."""

from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files.reading import check_regular
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal

from .mesh import PASSED, SURFACES, VOLUMES, bodies, boundary, no_reader
from .nodal_result import NodalResult


def read(path: Path, length: float, pressure: float, data: str | None) -> NodalResult:
    """The point data `data` of a mesh as pressure, `NAME` or `NAME:3` for a component; units in SI.

    Raises ValueError, one line: meshio is missing or cannot read the file, no such data (those that are
    there are listed), a kind of cell that has no faces here.
    """
    mesh = _read(path)
    values = _values(path, mesh.point_data, data)
    place = np.asarray(mesh.points, dtype=np.float64)
    place = np.pad(place, ((0, 0), (0, 3 - place.shape[1])))
    cells: dict[str, Any] = {}
    for block in mesh.cells:
        if block.type in PASSED:
            continue
        if block.type not in VOLUMES and block.type not in SURFACES:
            allowed = ", ".join([*SURFACES, *VOLUMES])
            raise ValueError(f"{path}: has cells {block.type!r}, allowed are {allowed}")
        rows = np.asarray(block.data, dtype=np.intp)
        cells[block.type] = np.concatenate([cells[block.type], rows]) if block.type in cells else rows
    if not cells:
        raise ValueError(f"{path}: has no cells with faces, expected the contact's faces or the bodies")
    return NodalResult(
        path=path,
        word="node",
        names=np.arange(len(place), dtype=np.int64),
        place=place * length,
        pressure=values * pressure,
        faces=boundary(cells),
        body=bodies(cells, len(place)),
    )


def known(path: Path) -> bool:
    """Whether meshio has a reader for files of this suffix; True where it is missing, which `read` says."""
    try:
        from meshio import extension_to_filetypes
    except ImportError:
        return True
    return path.suffix.lower() in extension_to_filetypes


def _read(path: Path) -> Any:
    try:
        import meshio
    except ImportError as error:
        raise no_reader(path, error) from None
    check_regular(path, "a mesh with point data")
    if not path.is_file():
        raise ValueError(f"{path}: cannot be read (no such file); expected a mesh with point data")
    try:
        return meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio lets through what its formats' parsers raise
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise ValueError(
            f"{path}: meshio cannot read it ({reason}); expected a mesh with point data"
        ) from None


def _values(path: Path, point_data: dict[str, Any], data: str | None) -> Array:
    """One number per node."""
    shown = {name: np.asarray(value) for name, value in point_data.items()}
    there = (
        ", ".join(f"{n} ({v.shape[1]} components)" if v.ndim > 1 else n for n, v in shown.items()) or "none"
    )
    if data is None:
        raise Refusal(f"{path}: state the point data that is the pressure; there are {there}", "data")
    name, _, component = data.partition(":")
    name, component = (data, "") if data in shown else (name, component)
    if name not in shown:
        raise ValueError(f"{path}: has no point data {name!r}; there are {there}")
    value = shown[name].reshape(len(shown[name]), -1)
    if not component and value.shape[1] == 1:
        component = "1"
    if not component.isdigit() or not 1 <= int(component) <= value.shape[1]:
        raise ValueError(
            f"{path}: {data!r} is no component of {name}; expected {name}:1 to {name}:{value.shape[1]}"
        )
    return np.asarray(value[:, int(component) - 1], dtype=np.float64)
