"""Read a pressure field from a file of any supported format, and check it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.quantity.refusal import InputRefusal

from . import abaqus, ansys, frd, meshfile, nodal_result
from .contact_surface import OPEN_NODE_OPTIONS, ContactPlane, ContactSurface, extract_contact_surface
from .nodal_result import LENGTH_UNITS, PRESSURE_UNITS, ContactPressureField, NodalResult

FIELD_FORMATS = ("csv", "mesh", "ansys", "abaqus", "frd")
"""Formats of files with a pressure field."""
FIELD_FORMAT_BY_SUFFIX = {
    ".csv": "csv",
    ".frd": "frd",
    ".lis": "ansys",
    ".txt": "ansys",
    ".out": "ansys",
    ".rpt": "abaqus",
    ".dat": "abaqus",
}
"""Format by the suffix of a file; files with other suffixes are meshes."""
LISTING_READERS = {"ansys": ansys.read_ansys, "abaqus": abaqus.read_abaqus}
"""Functions that read text listings of a solver, by format: one result may need several files."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldReader:
    """Options for reading a pressure field.

    file_format         : one of FIELD_FORMATS; None: chosen by the suffix
    length_unit         : unit of lengths, one of LENGTH_UNITS; None for CSV, whose heading states it
    pressure_unit       : unit of pressures, one of PRESSURE_UNITS; None for CSV
    point_data_name     : name of the point data with the pressure, for meshes
    companion_files     : more listings of the same result, or its mesh (ANSYS, Abaqus)
    contact_plane       : orientation of the contact plane in the file
    open_node_treatment : treatment of nodes without pressure, one of OPEN_NODE_OPTIONS
    """

    file_format: str | None = None
    length_unit: str | None = None
    pressure_unit: str | None = None
    point_data_name: str | None = None
    companion_files: Sequence[Path] = ()
    contact_plane: ContactPlane = ContactPlane()
    open_node_treatment: str = OPEN_NODE_OPTIONS[0]

    def read_field(
        self, field_path: Path, moment_field_path: Path | None = None, companion_files: Sequence[Path] = ()
    ) -> tuple[ContactPressureField, ContactPressureField | None]:
        """Read the pressure field of a file, and optionally the field with a moment from a second file.

        Both files must have the same contact nodes.

        moment_field_path : second file; None: no second field
        companion_files   : more listings of the second result, or its mesh

        Raises ValueError: one line with file and node.
        """
        first = self._read_contact_surface(field_path, self.companion_files)
        second = (
            None
            if moment_field_path is None
            else self._read_contact_surface(moment_field_path, companion_files or self.companion_files)
        )
        selected = np.ones(first.nodal_area.size, dtype=bool)
        if self.open_node_treatment == "drop":
            selected = first.nodal_pressure > 0.0
        elif self.open_node_treatment == "refuse":
            for surface in filter(None, (first, second)):
                _check_no_open_nodes(surface)
        if second is None:
            return first.select_pressure_field(selected), None
        if second.nodal_area.size != first.nodal_area.size:
            raise ValueError(
                f"{moment_field_path}: has a contact of {second.nodal_area.size} nodes, expected those of "
                f"{field_path}: {first.nodal_area.size}"
            )
        return first.select_pressure_field(selected), second.select_pressure_field(selected)

    def _read_contact_surface(self, field_path: Path, companion_files: Sequence[Path]) -> ContactSurface:
        """Read a file and extract the contact surface."""
        return extract_contact_surface(
            self._read_nodal_result(field_path, companion_files), self.contact_plane
        )

    def _read_nodal_result(self, field_path: Path, companion_files: Sequence[Path]) -> NodalResult:
        """Read a nodal result with the reader of its format; ValueError for options that do not apply."""
        format = self.file_format or FIELD_FORMAT_BY_SUFFIX.get(field_path.suffix.lower(), "mesh")
        if format == "mesh" and not self.file_format and not meshfile.is_mesh_format_supported(field_path):
            text = f"suffix {field_path.suffix!r} belongs to no known format"
            raise InputRefusal(
                f"{field_path}: {text}; state the format, one of {', '.join(FIELD_FORMATS)}", "format"
            )
        for value, subject, name, formats in (
            (self.point_data_name, "point data are", "data", ("mesh",)),
            (companion_files, "further listings are", "beside", tuple(LISTING_READERS)),
        ):
            if value and format not in formats:
                allowed = " or ".join(formats)
                raise InputRefusal(
                    f"{field_path}: is read as {format}; {subject} only for the format {allowed}", name
                )
        if format == "csv":
            self._check_csv_options(field_path)
            return nodal_result.read_field_csv(field_path)
        length, pressure = self._find_unit_sizes(field_path)
        if format in LISTING_READERS:
            return LISTING_READERS[format]([field_path, *companion_files], length, pressure)
        if format == "frd":
            return frd.read_frd(field_path, length, pressure)
        return meshfile.read_mesh_file(field_path, length, pressure, self.point_data_name)

    def _find_unit_sizes(self, field_path: Path) -> tuple[float, float]:
        """Size of the length unit [m] and of the pressure unit [Pa]; ValueError if one is not stated."""
        for value, name, units in (
            (self.length_unit, "length", LENGTH_UNITS),
            (self.pressure_unit, "pressure", PRESSURE_UNITS),
        ):
            if value is None:
                raise InputRefusal(
                    f"{field_path}: states no unit of {name}; expected one of {', '.join(units)}", name
                )
        return LENGTH_UNITS[str(self.length_unit)], PRESSURE_UNITS[str(self.pressure_unit)]

    def _check_csv_options(self, field_path: Path) -> None:
        """Raise ValueError for options on units and plane, which a CSV file states in its heading."""
        for value, name in (
            (self.length_unit, "length"),
            (self.pressure_unit, "pressure"),
            (self.contact_plane.body_side, "side"),
            (self.contact_plane.bolt_row_axis, "rows"),
            (None if self.contact_plane.normal_axis == "z" else self.contact_plane.normal_axis, "normal"),
        ):
            if value is not None:
                text = (
                    f"{field_path}: {name} = {value!r}: leave it out, a CSV file states units and plane in "
                    "its heading"
                )
                raise InputRefusal(text, name)


def _check_no_open_nodes(contact_surface: ContactSurface) -> None:
    """Raise ValueError if a node of the contact surface has no pressure (option `refuse` for open nodes)."""
    open_nodes = np.flatnonzero(contact_surface.nodal_pressure == 0.0)
    if open_nodes.size:
        raise InputRefusal(
            f"{contact_surface.describe_node(int(open_nodes[0]))}: has no pressure; {open_nodes.size} of the "
            f"{contact_surface.nodal_area.size} nodes in the contact plane have none. State keep (at these "
            "nodes the sides touch, with a gap of zero) or drop (they never touch)",
            "open",
        )
