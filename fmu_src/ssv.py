"""SSV files (parameter sets of SSP), used by system archives and by the experiments inside FMUs."""

from collections.abc import Mapping
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.quantity.units import UNITS

from .xml_parts import serialize_xml

REAL_ELEMENT = {"1.0": "Real", "2.0": "Float64"}
"""{version of SSP: element name of a real number}."""
SSP_NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructure"
"""Common prefix of the XML namespaces of SSP 1.0 and 2.0."""


class ParameterValue(NamedTuple):
    """Value of a parameter in an SSV file, with its unit and source."""

    value: Any
    unit: str
    source: str = ""


def format_parameter_set(
    set_name: str,
    value_by_name: Mapping[str, ParameterValue],
    ssp_version: str = "1.0",
    metadata: Mapping[str, str] | None = None,
) -> bytes:
    """Content of an SSV file (parameter set) of one SSP version.

    metadata : further attributes of the root element
    """
    spaces = {"xmlns:ssv": f"{SSP_NAMESPACE}ParameterValues", "xmlns:ssc": f"{SSP_NAMESPACE}Common"}
    root = Element(
        "ssv:ParameterSet", {**spaces, "version": ssp_version, "name": set_name, **(metadata or {})}
    )
    parameters = SubElement(root, "ssv:Parameters")
    for variable, (value, unit, source) in value_by_name.items():
        node = SubElement(parameters, "ssv:Parameter", name=variable)
        if source:
            node.set("description", source)
        if isinstance(value, bool):
            SubElement(node, "ssv:Boolean", value=str(value).lower())
        else:
            SubElement(node, f"ssv:{REAL_ELEMENT[ssp_version]}", value=repr(float(value)), unit=unit)
    add_units(root, "ssv", {entry.unit for entry in value_by_name.values() if entry.unit})
    return serialize_xml(root)


def add_units(root_element: Element, element_prefix: str, unit_names: set[str]) -> None:
    """Define units in an SSP file by their exponents of the SI base units."""
    if unit_names:
        units = SubElement(root_element, f"{element_prefix}:Units")
        for name in sorted(unit_names):
            unit = SubElement(units, "ssc:Unit", name=name)
            SubElement(unit, "ssc:BaseUnit", {base: str(n) for base, n in UNITS[name].base_exponents.items()})
