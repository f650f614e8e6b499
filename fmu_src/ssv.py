"""Parameter sets of SSP (SSV): those of systems, and those of the experiments in FMUs."""

from collections.abc import Mapping
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.quantity.units import UNITS

from .xml_parts import serialized

NUMBER = {"1.0": "Real", "2.0": "Float64"}
"""Type of real numbers in a version of SSP."""
SSP = "http://ssp-standard.org/SSP1/SystemStructure"
"""Begin of its namespaces, in both versions."""


class Value(NamedTuple):
    """A value in its unit, and where it comes from."""

    value: Any
    unit: str
    source: str = ""


def parameter_set(
    name: str, entries: Mapping[str, Value], version: str = "1.0", metadata: Mapping[str, str] | None = None
) -> bytes:
    """An SSV file of a version of SSP; `metadata` are more attributes of its root."""
    spaces = {"xmlns:ssv": f"{SSP}ParameterValues", "xmlns:ssc": f"{SSP}Common"}
    root = Element("ssv:ParameterSet", {**spaces, "version": version, "name": name, **(metadata or {})})
    parameters = SubElement(root, "ssv:Parameters")
    for variable, (value, unit, source) in entries.items():
        node = SubElement(parameters, "ssv:Parameter", name=variable)
        if source:
            node.set("description", source)
        if isinstance(value, bool):
            SubElement(node, "ssv:Boolean", value=str(value).lower())
        else:
            SubElement(node, f"ssv:{NUMBER[version]}", value=repr(float(value)), unit=unit)
    add_units(root, "ssv", {entry.unit for entry in entries.values() if entry.unit})
    return serialized(root)


def add_units(root: Element, prefix: str, names: set[str]) -> None:
    """Define units in an SSP file, by the powers of the SI's."""
    if names:
        units = SubElement(root, f"{prefix}:Units")
        for name in sorted(names):
            unit = SubElement(units, "ssc:Unit", name=name)
            SubElement(unit, "ssc:BaseUnit", {base: str(n) for base, n in UNITS[name].base.items()})
