"""SSV files (parameter sets of SSP), used by system archives and by the experiments inside FMUs."""

from collections.abc import Mapping
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.quantity.units import UNITS

from .xml_parts import serialized

NUMBER = {"1.0": "Real", "2.0": "Float64"}
"""{version of SSP: element name of a real number}."""
SSP = "http://ssp-standard.org/SSP1/SystemStructure"
"""Common prefix of the XML namespaces of SSP 1.0 and 2.0."""


class Value(NamedTuple):
    """Value of a parameter with its unit and source."""

    value: Any
    unit: str
    source: str = ""


def parameter_set(
    name: str, entries: Mapping[str, Value], version: str = "1.0", metadata: Mapping[str, str] | None = None
) -> bytes:
    """Content of an SSV file of one SSP version; `metadata` gives further attributes of the root element."""
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
    """Define units in an SSP file by their exponents of the SI base units."""
    if names:
        units = SubElement(root, f"{prefix}:Units")
        for name in sorted(names):
            unit = SubElement(units, "ssc:Unit", name=name)
            SubElement(unit, "ssc:BaseUnit", {base: str(n) for base, n in UNITS[name].base.items()})
