"""TOML files -> assemblies.

    schema = 1
    assembly = "bolted"
    name = "..."
    [side1]
    body = "box"
    length = { value = 0.28, unit = "m", kind = "estimate", source = "..." }

The entries are those of parameter files (jointfmu.parameters). `body` is one of BODIES, `layout` of
the section [bolts] one of LAYOUTS.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointfmu.parameters import entries, read_document
from jointfmu.quantity import build, flat_fields

from .geometry import Assembly, BoltGrid, BoltList, BoxSection, Plate

BODIES: dict[str, type[object]] = {"plate": Plate, "box": BoxSection}
LAYOUTS: dict[str, type[object]] = {"grid": BoltGrid, "list": BoltList}
SECTIONS = {"side1": ("body", BODIES), "side2": ("body", BODIES), "bolts": ("layout", LAYOUTS)}


def load(path: str | Path) -> Assembly:
    """Read and check an assembly.

    Raises ValueError with one line that names the file, the entry, its value and what is allowed.
    """
    path = Path(path)
    document = read_document(path, "an assembly")
    if document.get("assembly") != "bolted":
        own = f"; it is of a {document['joint']}" if "joint" in document else ""
        raise ValueError(f"{path}: assembly = {document.get('assembly')!r}, allowed is 'bolted'{own}")
    if unknown := sorted(set(document) - {"schema", "assembly", "name", *SECTIONS}):
        raise ValueError(f"{path}: unknown entry {unknown[0]!r}, allowed are name, {', '.join(SECTIONS)}")
    parts = {name: _part(path, document, name) for name in SECTIONS}
    try:
        return Assembly(str(document.get("name", path.stem)), **parts)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _part(path: Path, document: Mapping[str, Any], name: str) -> Any:
    """One section of an assembly."""
    word, classes = SECTIONS[name]
    table = document.get(name)
    if not isinstance(table, Mapping):
        raise ValueError(f"{path}: the section [{name}] is missing")
    shape = table.get(word)
    if not isinstance(shape, str) or shape not in classes:
        raise ValueError(f"{path}: {name}.{word} = {shape!r}, allowed are {', '.join(classes)}")
    body = {k: v for k, v in table.items() if k != word}
    values, _, _ = entries(path, dict(flat_fields(classes[shape])), body)
    try:
        return build(classes[shape], {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()})
    except ValueError as error:
        raise ValueError(f"{path}: [{name}] {error}") from None
