"""Read the TOML file of a bolted assembly.

    schema = 1
    assembly = "bolted"
    name = "..."
    [side1]
    body = "box"
    length = { value = 0.28, unit = "m", kind = "estimate", source = "..." }

Entries have the format of parameter files (jointfmu.parameters). `body` is a key of BODY_TYPES. `layout` in
the section [bolts] is a key of BOLT_LAYOUTS.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointfmu.parameters import read_document, read_entries
from jointfmu.quantity import build_parameter_set, flatten_fields

from .geometry import Assembly, BoltGrid, BoltList, BoxSection, Plate

BODY_TYPES: dict[str, type[object]] = {"plate": Plate, "box": BoxSection}
"""{value of `body` in an assembly file: class of the body}."""
BOLT_LAYOUTS: dict[str, type[object]] = {"grid": BoltGrid, "list": BoltList}
"""{value of `layout` in an assembly file: class of the bolt positions}."""
ASSEMBLY_SECTIONS = {
    "side1": ("body", BODY_TYPES),
    "side2": ("body", BODY_TYPES),
    "bolts": ("layout", BOLT_LAYOUTS),
}
"""Sections of an assembly file."""


def read_assembly(assembly_path: str | Path) -> Assembly:
    """Read and check the file of an assembly.

    Raises ValueError: one line with file, entry, value and allowed values.
    """
    assembly_path = Path(assembly_path)
    document = read_document(assembly_path, "an assembly")
    if document.get("assembly") != "bolted":
        if "joint" in document:
            raise ValueError(
                f"{assembly_path}: is the parameter file of a {document['joint']}, not an assembly; state "
                "the assembly (bodies and bolts, docs/finite_elements_reference.md) first, and this file "
                "with --params"
            )
        raise ValueError(f"{assembly_path}: assembly = {document.get('assembly')!r}, allowed is 'bolted'")
    if unknown := sorted(set(document) - {"schema", "assembly", "name", *ASSEMBLY_SECTIONS}):
        raise ValueError(
            f"{assembly_path}: unknown entry {unknown[0]!r}, allowed are name, {', '.join(ASSEMBLY_SECTIONS)}"
        )
    sections = {name: _read_assembly_section(assembly_path, document, name) for name in ASSEMBLY_SECTIONS}
    try:
        return Assembly(str(document.get("name", assembly_path.stem)), **sections)
    except ValueError as error:
        raise ValueError(f"{assembly_path}: {error}") from None


def _read_assembly_section(assembly_path: Path, toml_document: Mapping[str, Any], section_name: str) -> Any:
    """Read one section of an assembly file: a body, or the layout of the bolts."""
    type_key, classes = ASSEMBLY_SECTIONS[section_name]
    table = toml_document.get(section_name)
    if not isinstance(table, Mapping):
        raise ValueError(f"{assembly_path}: the section [{section_name}] is missing")
    shape = table.get(type_key)
    if not isinstance(shape, str) or shape not in classes:
        raise ValueError(
            f"{assembly_path}: {section_name}.{type_key} = {shape!r}, allowed are {', '.join(classes)}"
        )
    dimensions = {k: v for k, v in table.items() if k != type_key}
    values, _, _ = read_entries(assembly_path, dict(flatten_fields(classes[shape])), dimensions)
    try:
        return build_parameter_set(
            classes[shape], {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()}
        )
    except ValueError as error:
        raise ValueError(f"{assembly_path}: [{section_name}] {error}") from None
