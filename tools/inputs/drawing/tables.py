"""Shipped tables of materials, finishes and bolts: models/tables/*.toml."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jointfmu.parameters import read_document, read_entries
from jointfmu.quantity import quantity_field
from jointfmu.quantity.units import conversion_factor

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
class TableRow:
    """Row of a shipped table of materials or finishes: name, other names, title, and {column: number}."""

    name: str
    aliases: tuple[str, ...]
    title: str
    numbers: Mapping[str, SourcedNumber]


@cache
def read_table(table_name: str) -> dict[str, TableRow]:
    """Read the shipped table of materials or of finishes: {name: row}.

    table_name : `materials` or `finishes`
    """
    path, document = _read_document(table_name)
    columns = {"materials": MATERIAL_COLUMNS, "finishes": FINISH_COLUMNS}[table_name]
    rows = {}
    for title, body in document.items():
        plain = {key: body.pop(key) for key in ("also", "title")}
        values, kinds, sources = read_entries(path, columns, body)
        known = {key: SourcedNumber(float(value), kinds[key], sources[key]) for key, value in values.items()}
        rows[title] = TableRow(title, tuple(plain["also"]), plain["title"], known)
    return rows


def find_row(table_name: str, row_name: str) -> TableRow:
    """Find a row of the table of materials or finishes by one of its names. Case and hyphens are ignored.

    Raises ValueError if no row has the name.
    """
    rows = read_table(table_name)
    for candidate in rows.values():
        if _normalise_name(row_name) in map(_normalise_name, (candidate.name, *candidate.aliases)):
            return candidate
    noun = {"materials": "material", "finishes": "finish"}[table_name]
    raise ValueError(
        f"{noun} {row_name!r} is unknown, allowed are {', '.join(rows)} (jointfmu new {table_name})"
    )


def _normalise_name(name: str) -> str:
    """Name of a material or finish without case and hyphens, for comparisons."""
    return name.lower().replace("-", " ").strip()


@dataclass(frozen=True, slots=True)
class Thread:
    """Sizes of a metric bolt, lengths [m].

    nominal_diameter : nominal diameter
    pitch            : pitch of the thread
    hole             : diameter of the clearance hole
    hexagon, socket  : least outer diameter d_w of the bearing face of a hexagon head and of a socket head
    """

    name: str
    nominal_diameter: float
    pitch: float
    hole: float
    hexagon: float
    socket: float


@cache
def read_threads() -> dict[str, Thread]:
    """Read the bolts with coarse pitch: {name: bolt}."""
    _, document = _read_document("bolts")
    columns = [conversion_factor(column["unit"], "m") for column in document["columns"].values()]
    names = list(document["columns"])
    mm = conversion_factor("mm", "m")
    return {
        name: Thread(
            name,
            nominal_diameter=float(name[1:]) * mm,
            **{c: v * f for c, v, f in zip(names, values, columns, strict=True)},
        )
        for name, values in document["rows"].items()
    }


@cache
def fine_pitches() -> dict[str, tuple[float, ...]]:
    """Fine pitches of the bolts: {name of the coarse thread: pitches [m]}."""
    stated = dict(_read_document("bolts")[1]["fine"])
    size = conversion_factor(stated.pop("unit"), "m")
    stated.pop("source")
    return {name: tuple(pitch * size for pitch in pitches) for name, pitches in stated.items()}


def find_thread(name: str, pitch: float | None = None) -> Thread:
    """Find a metric thread by its name, as in M12, with the coarse pitch or a fine pitch [m].

    Raises ValueError for an unknown thread or pitch.
    """
    if name not in read_threads():
        raise ValueError(f"thread {name} is unknown, allowed are {', '.join(read_threads())}")
    coarse = read_threads()[name]
    if pitch is None:
        return coarse
    allowed = (coarse.pitch, *fine_pitches().get(name, ()))
    for known in allowed:
        if math.isclose(known, pitch, rel_tol=1e-6):
            is_coarse = known == coarse.pitch
            return coarse if is_coarse else replace(coarse, name=f"{name}x{known * 1e3:g}", pitch=known)
    pitches = ", ".join(f"{known * 1e3:g}" for known in allowed)
    raise ValueError(f"thread {name}x{pitch * 1e3:g} is unknown, allowed pitches of {name} are {pitches} mm")


@dataclass(frozen=True, slots=True)
class Washer:
    """Sizes of a plain washer [m]: diameter of its hole, outer diameter, thickness."""

    hole_diameter: float
    outer_diameter: float
    thickness: float


@cache
def read_washers() -> dict[str, Washer]:
    """Read the washers of ISO 7089: {name of the coarse thread: washer}."""
    stated = dict(_read_document("bolts")[1]["washers"])
    size = conversion_factor(stated.pop("unit"), "m")
    stated.pop("source")
    return {name: Washer(*(value * size for value in row)) for name, row in stated.items()}


def find_washer(thread: Thread) -> Washer:
    """Find the washer of ISO 7089 for a thread, of coarse or fine pitch."""
    return read_washers()[thread.name.split("x")[0]]


@dataclass(frozen=True, slots=True)
class TighteningMethod:
    """Method of tightening a bolt, with the scatter of its preload.

    title               : name of the method in words
    tightening_factors  : least and greatest tightening factor alpha_A = F_Mmax/F_Mmin [1]
    depends_on_friction : whether the preload depends on the friction in thread and head
    """

    title: str
    tightening_factors: tuple[float, float]
    depends_on_friction: bool


@cache
def read_tightening_methods() -> dict[str, TighteningMethod]:
    """Read the methods of tightening: {name: method}."""
    return {
        name: TighteningMethod(body["title"], tuple(body["factor"]), body["friction"])
        for name, body in _read_document("bolts")[1]["tightening"].items()
        if isinstance(body, dict)
    }


def thread_source(bolt_column: str) -> str:
    """Source text of a column in the table of bolts."""
    return str(_read_document("bolts")[1]["columns"][bolt_column]["source"])


@cache
def read_embedding() -> list[tuple[float, tuple[float, ...]]]:
    """Read the table of embedding: (largest Rz [m], embedding [m] of thread, head or nut, and interface).

    The rows are in ascending order of Rz.
    """
    stated = dict(_read_document("bolts")[1]["embedding"])
    size = conversion_factor(stated.pop("unit"), "m")
    stated.pop("source")
    return sorted((float(Rz) * size, tuple(v * size for v in row)) for Rz, row in stated.items())


@cache
def read_property_classes() -> dict[str, dict[str, tuple[float, float]]]:
    """Read the property classes of bolts: {class: {"yield" or "proof": stress [Pa] up to M16, and above}}."""
    stated = _read_document("bolts")[1]["classes"]
    size = conversion_factor(stated["unit"], "Pa")
    return {
        name: {key: (pair[0] * size, pair[1] * size) for key, pair in body.items()}
        for name, body in stated.items()
        if isinstance(body, dict)
    }


MIN_LARGE_THREAD_DIAMETER = 16e-3
"""Thread diameter [m] above which the second strength of a property class in the table holds."""


def property_class_strength(property_class: str, strength_kind: str, thread: Thread) -> float:
    """Strength [Pa] of a property class, "yield" or "proof", for a thread."""
    return read_property_classes()[property_class][strength_kind][
        int(thread.nominal_diameter > MIN_LARGE_THREAD_DIAMETER)
    ]


def _read_document(table_name: str) -> tuple[Path, dict[str, Any]]:
    """Read the TOML document of a shipped table."""
    path = Path(str(files("jointfmu_models") / "tables" / f"{table_name}.toml"))
    document = read_document(path, "a table")
    return path, {key: value for key, value in document.items() if key not in ("schema", "table")}
