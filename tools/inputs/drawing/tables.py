"""Shipped tables of materials, finishes and bolts: models/tables/*.toml."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jointfmu.parameters import read_document, read_entries
from jointfmu.quantity import quantity_field
from jointfmu.quantity.units import conversion_factor

from ...common.names import suggest_names
from ..catalogue import SourcedNumber

MATERIAL_COLUMNS = {
    "E": quantity_field("Pa", "Young's modulus"),
    "nu": quantity_field("1", "Poisson's ratio"),
    "density": quantity_field("kg/m3", "density"),
    "alpha": quantity_field("1/K", "thermal expansion coefficient"),
    "H": quantity_field("Pa", "hardness"),
}
"""Columns of the table of materials: {name in the file: field with SI unit and meaning}."""
FINISH_COLUMNS = {
    "Ra": quantity_field("m", "usual Ra"),
    "Ra_low": quantity_field("m", "least Ra"),
    "Ra_high": quantity_field("m", "greatest Ra"),
    "slope": quantity_field("1", "rms slope of one surface"),
    "hurst": quantity_field("1", "Hurst exponent"),
    "skewness": quantity_field("1", "usual skewness of the heights"),
    "skewness_low": quantity_field("1", "least skewness"),
    "skewness_high": quantity_field("1", "greatest skewness"),
}
"""Columns of the table of finishes: {name in the file: field with SI unit and meaning}."""


@dataclass(frozen=True, slots=True)
class MaterialOrFinish:
    """Row of a shipped table of materials or finishes: name, other names, title, and {column: number}."""

    row_name: str
    row_aliases: tuple[str, ...]
    display_title: str
    sourced_numbers: Mapping[str, SourcedNumber]


@cache
def read_material_or_finish_table(table_name: str) -> dict[str, MaterialOrFinish]:
    """Read the shipped table of materials or of finishes: {name: row}.

    table_name : `materials` or `finishes`
    """
    path, document = _read_table_document(table_name)
    columns = {"materials": MATERIAL_COLUMNS, "finishes": FINISH_COLUMNS}[table_name]
    rows = {}
    for title, body in document.items():
        plain = {key: body.pop(key) for key in ("also", "title")}
        values, kinds, sources = read_entries(path, columns, body)
        known = {key: SourcedNumber(float(value), kinds[key], sources[key]) for key, value in values.items()}
        rows[title] = MaterialOrFinish(title, tuple(plain["also"]), plain["title"], known)
    return rows


def find_table_row(table_name: str, row_name: str) -> MaterialOrFinish:
    """Find a row of the table of materials or finishes by one of its names.

    Case, hyphens and underscores are ignored.

    Raises ValueError if no row has the name.
    """
    rows = read_material_or_finish_table(table_name)
    for candidate in rows.values():
        if _normalise_name(row_name) in map(_normalise_name, (candidate.row_name, *candidate.row_aliases)):
            return candidate
    noun = {"materials": "material", "finishes": "finish"}[table_name]
    names = [name for row in rows.values() for name in (row.row_name, *row.row_aliases)]
    raise ValueError(
        f"{noun} {row_name!r} is unknown, allowed are {', '.join(rows)}{suggest_names(row_name, names)}; "
        f"jointfmu new {table_name} lists their values and other names"
    )


def _normalise_name(row_name: str) -> str:
    """Name of a material or finish without case, hyphens and underscores, for comparisons."""
    return re.sub("[-_]", " ", row_name.lower()).strip()


@dataclass(frozen=True, slots=True)
class Thread:
    """Sizes of a metric bolt, lengths [m].

    pitch         : pitch of the thread
    hole_diameter : diameter of the clearance hole
    hexagon_bearing_diameter, socket_bearing_diameter : least outer diameter d_w of the bearing face of a
        hexagon head and of a socket head
    """

    thread_name: str
    nominal_diameter: float
    pitch: float
    hole_diameter: float
    hexagon_bearing_diameter: float
    socket_bearing_diameter: float

    def bearing_diameter(self, head_type: str) -> float:
        """Least outer diameter d_w [m] of the bearing face of a head: "hexagon" or "socket"."""
        return {"hexagon": self.hexagon_bearing_diameter, "socket": self.socket_bearing_diameter}[head_type]


@cache
def read_threads() -> dict[str, Thread]:
    """Read the table of metric bolts with coarse pitch: {thread name: sizes}."""
    _, document = _read_table_document("bolts")
    units = [conversion_factor(column["unit"], "m") for column in document["columns"].values()]
    mm = conversion_factor("mm", "m")
    threads = {}
    for name, row in document["rows"].items():
        sizes = dict(
            zip(document["columns"], (v * unit for v, unit in zip(row, units, strict=True)), strict=True)
        )
        threads[name] = Thread(
            name,
            nominal_diameter=float(name[1:]) * mm,
            pitch=sizes["pitch"],
            hole_diameter=sizes["hole"],
            hexagon_bearing_diameter=sizes["hexagon"],
            socket_bearing_diameter=sizes["socket"],
        )
    return threads


@cache
def read_fine_pitches() -> dict[str, tuple[float, ...]]:
    """Read the fine pitches of metric bolts: {name of the coarse thread: pitches [m]}."""
    stated = dict(_read_table_document("bolts")[1]["fine"])
    size = conversion_factor(stated.pop("unit"), "m")
    stated.pop("source")
    return {name: tuple(pitch * size for pitch in pitches) for name, pitches in stated.items()}


def find_thread(thread_name: str, thread_pitch: float | None = None) -> Thread:
    """Find a metric thread by its name, as in M12, with the coarse pitch or a fine pitch [m].

    Raises ValueError for an unknown thread or pitch.
    """
    if thread_name not in read_threads():
        raise ValueError(f"thread {thread_name} is unknown, allowed are {', '.join(read_threads())}")
    coarse = read_threads()[thread_name]
    if thread_pitch is None:
        return coarse
    allowed = (coarse.pitch, *read_fine_pitches().get(thread_name, ()))
    for known in allowed:
        if math.isclose(known, thread_pitch, rel_tol=1e-6):
            is_coarse = known == coarse.pitch
            return (
                coarse
                if is_coarse
                else replace(coarse, thread_name=f"{thread_name}x{known * 1e3:g}", pitch=known)
            )
    pitches = ", ".join(f"{known * 1e3:g}" for known in allowed)
    raise ValueError(
        f"thread {thread_name}x{thread_pitch * 1e3:g} is unknown, allowed pitches of {thread_name} are "
        f"{pitches} mm"
    )


@dataclass(frozen=True, slots=True)
class Washer:
    """Sizes of a plain washer [m]: diameter of its hole, outer diameter, thickness."""

    hole_diameter: float
    outer_diameter: float
    thickness: float


@cache
def read_washers() -> dict[str, Washer]:
    """Read the washers of ISO 7089: {name of the coarse thread: washer}."""
    stated = dict(_read_table_document("bolts")[1]["washers"])
    size = conversion_factor(stated.pop("unit"), "m")
    stated.pop("source")
    return {name: Washer(*(value * size for value in row)) for name, row in stated.items()}


def find_washer(thread: Thread) -> Washer:
    """Find the washer of ISO 7089 for a thread, of coarse or fine pitch."""
    return read_washers()[thread.thread_name.split("x")[0]]


@dataclass(frozen=True, slots=True)
class TighteningMethod:
    """Method of tightening a bolt, with the scatter of its preload.

    display_title       : name of the method in words
    tightening_factors  : least and greatest tightening factor alpha_A = F_Mmax/F_Mmin [1]
    depends_on_friction : whether the preload depends on the friction in thread and head
    """

    display_title: str
    tightening_factors: tuple[float, float]
    depends_on_friction: bool


@cache
def read_tightening_methods() -> dict[str, TighteningMethod]:
    """Read the methods of tightening: {name: method}."""
    return {
        name: TighteningMethod(body["title"], tuple(body["factor"]), body["friction"])
        for name, body in _read_table_document("bolts")[1]["tightening"].items()
        if isinstance(body, dict)
    }


def find_bolt_column_source(bolt_column: str) -> str:
    """Source (standard) of the numbers in a column of the shipped table of bolts, as text."""
    return str(_read_table_document("bolts")[1]["columns"][bolt_column]["source"])


@cache
def read_embedding() -> list[tuple[float, tuple[float, ...]]]:
    """Read the table of embedding: (largest Rz [m], embedding [m] of thread, head or nut, and interface).

    The rows are in ascending order of Rz.
    """
    stated = dict(_read_table_document("bolts")[1]["embedding"])
    size = conversion_factor(stated.pop("unit"), "m")
    stated.pop("source")
    return sorted((float(Rz) * size, tuple(v * size for v in row)) for Rz, row in stated.items())


@cache
def read_property_classes() -> dict[str, dict[str, tuple[float, float]]]:
    """Read the property classes of bolts: {class: {"yield" or "proof": stress [Pa] up to M16, and above}}."""
    stated = _read_table_document("bolts")[1]["classes"]
    size = conversion_factor(stated["unit"], "Pa")
    return {
        name: {key: (pair[0] * size, pair[1] * size) for key, pair in body.items()}
        for name, body in stated.items()
        if isinstance(body, dict)
    }


STRENGTH_CHANGE_DIAMETER = 16e-3
"""Thread diameter [m] above which the second strength of a property class in the table holds."""


def property_class_strength(property_class: str, strength_kind: str, thread: Thread) -> float:
    """Yield strength or proof stress [Pa] of the bolts of a property class, for a thread.

    strength_kind : "yield" or "proof"
    """
    return read_property_classes()[property_class][strength_kind][
        int(thread.nominal_diameter > STRENGTH_CHANGE_DIAMETER)
    ]


def _read_table_document(table_name: str) -> tuple[Path, dict[str, Any]]:
    """Read the TOML document of a shipped table."""
    path = Path(str(files("jointfmu_models") / "tables" / f"{table_name}.toml"))
    document = read_document(path, "a table")
    return path, {key: value for key, value in document.items() if key not in ("schema", "table")}
