"""Shipped tables of materials, finishes and bolts: models/tables/*.toml."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jointfmu.parameters import entries, read_document
from jointfmu.quantity import quantity
from jointfmu.quantity.units import factor

from ..catalogue import Printed

MATERIAL = {
    "E": quantity("Pa", "Young's modulus"),
    "nu": quantity("1", "Poisson's ratio"),
    "density": quantity("kg/m3", "density"),
    "H": quantity("Pa", "hardness"),
}
FINISH = {
    "Ra": quantity("m", "usual Ra"),
    "Ra_low": quantity("m", "least Ra"),
    "Ra_high": quantity("m", "greatest Ra"),
    "slope": quantity("1", "rms slope of one surface"),
    "hurst": quantity("1", "Hurst exponent"),
}


@dataclass(frozen=True, slots=True)
class TableRow:
    """A row of a table: name, other names, title, and {column: number}."""

    name: str
    also: tuple[str, ...]
    title: str
    numbers: Mapping[str, Printed]


@cache
def table(name: str) -> dict[str, TableRow]:
    """Read a table, `materials` or `finishes`: {name: row}."""
    path, document = _document(name)
    columns = {"materials": MATERIAL, "finishes": FINISH}[name]
    rows = {}
    for title, body in document.items():
        plain = {key: body.pop(key) for key in ("also", "title")}
        values, kinds, sources = entries(path, columns, body)
        known = {key: Printed(float(value), kinds[key], sources[key]) for key, value in values.items()}
        rows[title] = TableRow(title, tuple(plain["also"]), plain["title"], known)
    return rows


def row(name: str, wanted: str) -> TableRow:
    """Find a row of a table by one of its names; case and hyphens are ignored.

    Raises ValueError if no row has the name.
    """
    rows = table(name)
    for candidate in rows.values():
        if _key(wanted) in map(_key, (candidate.name, *candidate.also)):
            return candidate
    noun = {"materials": "material", "finishes": "finish"}[name]
    raise ValueError(f"{noun} {wanted!r} is unknown, allowed are {', '.join(rows)} (jointfmu new {name})")


def _key(text: str) -> str:
    return text.lower().replace("-", " ").strip()


@dataclass(frozen=True, slots=True)
class Thread:
    """Sizes of a metric bolt with coarse thread, lengths [m].

    d               : nominal diameter
    pitch           : pitch of the thread
    hole            : diameter of the clearance hole
    hexagon, socket : least outer diameter d_w of the bearing face of a hexagon head and of a socket head
    """

    name: str
    d: float
    pitch: float
    hole: float
    hexagon: float
    socket: float


@cache
def threads() -> dict[str, Thread]:
    """Read the bolts with coarse pitch: {name: bolt}."""
    _, document = _document("bolts")
    columns = [factor(column["unit"], "m") for column in document["columns"].values()]
    names = list(document["columns"])
    mm = factor("mm", "m")
    return {
        name: Thread(
            name, d=float(name[1:]) * mm, **{c: v * f for c, v, f in zip(names, values, columns, strict=True)}
        )
        for name, values in document["rows"].items()
    }


def thread_source(column: str) -> str:
    """Source of a column in the table of bolts."""
    return str(_document("bolts")[1]["columns"][column]["source"])


@cache
def embedding() -> list[tuple[float, tuple[float, ...]]]:
    """Read the table of embedding: (largest Rz [m], embedding [m] of thread, head or nut, and interface).

    The rows are in ascending order of Rz.
    """
    stated = dict(_document("bolts")[1]["embedding"])
    size = factor(stated.pop("unit"), "m")
    stated.pop("source")
    return sorted((float(Rz) * size, tuple(v * size for v in row)) for Rz, row in stated.items())


@cache
def classes() -> dict[str, dict[str, tuple[float, float]]]:
    """Read the property classes: {class: {"yield" or "proof": stress [Pa] up to M16, and above}}."""
    stated = _document("bolts")[1]["classes"]
    size = factor(stated["unit"], "Pa")
    return {
        name: {key: (pair[0] * size, pair[1] * size) for key, pair in body.items()}
        for name, body in stated.items()
        if isinstance(body, dict)
    }


LARGE = 16e-3
"""Thread diameter [m] above which the second strength of a property class in the table holds."""


def strength(name: str, key: str, thread: Thread) -> float:
    """Strength [Pa] of a property class, "yield" or "proof", for a thread."""
    return classes()[name][key][int(thread.d > LARGE)]


def _document(name: str) -> tuple[Path, dict[str, Any]]:
    path = Path(str(files("jointfmu_models") / "tables" / f"{name}.toml"))
    document = read_document(path, "a table")
    return path, {key: value for key, value in document.items() if key not in ("schema", "table")}
