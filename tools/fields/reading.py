"""A file with a nodal contact result to a checked field."""

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
"""Format by the end of a file's name; others are meshes."""
LISTINGS = {"ansys": ansys.read, "abaqus": abaqus.read}
"""Formats in which several files belong together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """How a file is read.

    format   : one of FORMATS; None: by the file's name
    length   : unit of its lengths, of LENGTHS; None for CSV, whose heading states it
    pressure : unit of its pressures, of PRESSURES; None for CSV
    data     : point data that is the pressure, for meshes
    beside   : further listings, or the mesh (ANSYS, Abaqus)
    open     : what to do with nodes without pressure, one of OPEN
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
        """The field of a file and, from a second one at the same nodes, that with a moment.

        beside : further listings of the second one

        Raises ValueError, one line that names the file and the node.
        """
        first = self._surface(path, self.beside)
        second = None if tilted is None else self._surface(tilted, beside or self.beside)
        kept = np.ones(first.area.size, dtype=bool)
        if self.open == "drop":
            kept = first.pressure > 0.0
        elif self.open == "refuse":
            for surface in filter(None, (first, second)):
                _refuse_open(surface)
        if second is None:
            return first.field(kept), None
        if second.area.size != first.area.size:
            raise ValueError(
                f"{tilted}: has a contact of {second.area.size} nodes, expected those of {path}: "
                f"{first.area.size}"
            )
        return first.field(kept), second.field(kept)

    def _surface(self, path: Path, beside: Sequence[Path]) -> ContactSurface:
        return contact_surface(self._result(path, beside), self.plane)

    def _result(self, path: Path, beside: Sequence[Path]) -> NodalResult:
        format = self.format or SUFFIXES.get(path.suffix.lower(), "mesh")
        if format == "mesh" and not self.format and not meshfile.known(path):
            text = f"suffix {path.suffix!r} is of no format known here"
            raise Refusal(f"{path}: {text}; state the format, one of {', '.join(FORMATS)}", "format")
        for given, what, name, only in (
            (self.data, "point data are", "data", ("mesh",)),
            (beside, "further listings are", "beside", tuple(LISTINGS)),
        ):
            if given and format not in only:
                allowed = " or ".join(only)
                raise Refusal(f"{path}: is read as {format}, {what} for the format {allowed}", name)
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
        """Sizes of the stated units."""
        for value, name, units in ((self.length, "length", LENGTHS), (self.pressure, "pressure", PRESSURES)):
            if value is None:
                raise Refusal(f"{path}: states no unit of {name}; expected one of {', '.join(units)}", name)
        return LENGTHS[str(self.length)], PRESSURES[str(self.pressure)]

    def _stated_by_file(self, path: Path) -> None:
        """Refuse what a CSV file answers itself."""
        for given, name in (
            (self.length, "length"),
            (self.pressure, "pressure"),
            (self.plane.side, "side"),
            (self.plane.rows, "rows"),
            (None if self.plane.normal == "z" else self.plane.normal, "normal"),
        ):
            if given is not None:
                text = f"{path}: {name} = {given!r}: a CSV file states units and plane in its heading"
                raise Refusal(text, name)


def _refuse_open(surface: ContactSurface) -> None:
    open_nodes = np.flatnonzero(surface.pressure == 0.0)
    if open_nodes.size:
        raise Refusal(
            f"{surface.at(int(open_nodes[0]))}: is open (no pressure), with {open_nodes.size} of "
            f"{surface.area.size} nodes; say keep (they just touch) or drop (they never do)",
            "open",
        )
