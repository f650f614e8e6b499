"""Read a pressure field from a file of any supported format, and check it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.quantity.refusal import Refusal

from . import abaqus, ansys, frd, meshfile, nodal_result
from .contact_surface import OPEN, ContactSurface, Plane, contact_surface
from .nodal_result import LENGTHS, PRESSURES, ContactField, NodalResult

FORMATS = ("csv", "mesh", "ansys", "abaqus", "frd")
SUFFIXES = {
    ".csv": "csv",
    ".frd": "frd",
    ".lis": "ansys",
    ".txt": "ansys",
    ".out": "ansys",
    ".rpt": "abaqus",
    ".dat": "abaqus",
}
"""Format by the suffix of a file; files with other suffixes are meshes."""
LISTINGS = {"ansys": ansys.read, "abaqus": abaqus.read}
"""Readers of formats that may need several files for one result."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """Options for reading a pressure field.

    format   : one of FORMATS; None: chosen by the suffix
    length_unit : unit of lengths, one of LENGTH_UNITS; None for CSV, whose heading states it
    pressure_unit : unit of pressures, one of PRESSURE_UNITS; None for CSV
    data     : name of the point data with the pressure, for meshes
    companion_files : more listings of the same result, or its mesh (ANSYS, Abaqus)
    plane    : orientation of the contact plane in the file
    open_nodes : treatment of nodes without pressure, one of OPEN_NODE_OPTIONS
    """

    format: str | None = None
    length: str | None = None
    pressure: str | None = None
    data: str | None = None
    beside: Sequence[Path] = ()
    plane: Plane = Plane()
    open: str = OPEN[0]

    def field(
        self, path: Path, tilted: Path | None = None, beside: Sequence[Path] = ()
    ) -> tuple[ContactField, ContactField | None]:
        """Read the pressure field of a file, and optionally the field with a moment from a second file.

        Both files must have the same contact nodes.

        moment_path     : second file; None: no second field
        companion_files : more listings of the second result, or its mesh

        Raises ValueError: one line with file and node.
        """
        first = self._surface(path, self.beside)
        second = None if tilted is None else self._surface(tilted, beside or self.beside)
        selected = np.ones(first.area.size, dtype=bool)
        if self.open == "drop":
            selected = first.pressure > 0.0
        elif self.open == "refuse":
            for surface in filter(None, (first, second)):
                _refuse_open(surface)
        if second is None:
            return first.field(selected), None
        if second.area.size != first.area.size:
            raise ValueError(
                f"{tilted}: has a contact of {second.area.size} nodes, expected those of {path}: "
                f"{first.area.size}"
            )
        return first.field(selected), second.field(selected)

    def _surface(self, path: Path, beside: Sequence[Path]) -> ContactSurface:
        """Read a file and extract the contact surface."""
        return contact_surface(self._result(path, beside), self.plane)

    def _result(self, path: Path, beside: Sequence[Path]) -> NodalResult:
        """Read a nodal result with the reader of its format; ValueError for options that do not apply."""
        format = self.format or SUFFIXES.get(path.suffix.lower(), "mesh")
        if format == "mesh" and not self.format and not meshfile.known(path):
            text = f"suffix {path.suffix!r} is of no format known here"
            raise Refusal(f"{path}: {text}; state the format, one of {', '.join(FORMATS)}", "format")
        for value, subject, name, formats in (
            (self.data, "point data are", "data", ("mesh",)),
            (beside, "further listings are", "beside", tuple(LISTINGS)),
        ):
            if value and format not in formats:
                allowed = " or ".join(formats)
                raise Refusal(f"{path}: is read as {format}, {subject} for the format {allowed}", name)
        if format == "csv":
            self._stated_by_file(path)
            return nodal_result.read_csv(path)
        length, pressure = self._units(path)
        if format in LISTINGS:
            return LISTINGS[format]([path, *beside], length, pressure)
        if format == "frd":
            return frd.read(path, length, pressure)
        return meshfile.read(path, length, pressure, self.data)

    def _units(self, path: Path) -> tuple[float, float]:
        """Units of length and pressure in SI units; ValueError if one is missing."""
        for value, name, units in ((self.length, "length", LENGTHS), (self.pressure, "pressure", PRESSURES)):
            if value is None:
                raise Refusal(f"{path}: states no unit of {name}; expected one of {', '.join(units)}", name)
        return LENGTHS[str(self.length)], PRESSURES[str(self.pressure)]

    def _stated_by_file(self, path: Path) -> None:
        """Raise ValueError for options that the heading of a CSV file defines."""
        for value, name in (
            (self.length, "length"),
            (self.pressure, "pressure"),
            (self.plane.side, "side"),
            (self.plane.rows, "rows"),
            (None if self.plane.normal == "z" else self.plane.normal, "normal"),
        ):
            if value is not None:
                text = f"{path}: {name} = {value!r}: a CSV file states units and plane in its heading"
                raise Refusal(text, name)


def _refuse_open(surface: ContactSurface) -> None:
    """Raise ValueError if a node has no pressure."""
    open_nodes = np.flatnonzero(surface.pressure == 0.0)
    if open_nodes.size:
        raise Refusal(
            f"{surface.at(int(open_nodes[0]))}: is open (no pressure), with {open_nodes.size} of "
            f"{surface.area.size} nodes; say keep (they just touch) or drop (they never do)",
            "open",
        )
