"""SSV files (parameter sets of SSP), used by system archives and by the experiments inside FMUs."""

from collections.abc import Mapping
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu.quantity.units import UNITS

from .xml_parts import serialize_xml

REAL_NUMBER_ELEMENT_NAMES = {"1.0": "Real", "2.0": "Float64"}
"""{version of SSP: element name of a real number}."""
SSP_NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructure"
"""Common prefix of the XML namespaces of SSP 1.0 and 2.0."""


class ParameterValue(NamedTuple):
    """Value of a parameter in an SSV file (parameter set), with its unit and the source of the value."""

    parameter_value: Any
    parameter_unit: str
    value_source: str = ""


def format_ssv_parameter_set(
    parameter_set_name: str,
    value_by_name: Mapping[str, ParameterValue],
    ssp_version: str = "1.0",
    root_attributes: Mapping[str, str] | None = None,
) -> bytes:
    """Format an SSV file (parameter set) of one SSP version.

    root_attributes : additional attributes of the root element
    """
    spaces = {"xmlns:ssv": f"{SSP_NAMESPACE}ParameterValues", "xmlns:ssc": f"{SSP_NAMESPACE}Common"}
    root = Element(
        "ssv:ParameterSet",
        {**spaces, "version": ssp_version, "name": parameter_set_name, **(root_attributes or {})},
    )
    parameters = SubElement(root, "ssv:Parameters")
    for variable, (value, unit, source) in value_by_name.items():
        node = SubElement(parameters, "ssv:Parameter", name=variable)
        if source:
            node.set("description", source)
        if isinstance(value, bool):
            SubElement(node, "ssv:Boolean", value=str(value).lower())
        else:
            SubElement(
                node, f"ssv:{REAL_NUMBER_ELEMENT_NAMES[ssp_version]}", value=repr(float(value)), unit=unit
            )
    add_unit_definitions(
        root, "ssv", {entry.parameter_unit for entry in value_by_name.values() if entry.parameter_unit}
    )
    return serialize_xml(root)


def add_unit_definitions(root_element: Element, xml_element_prefix: str, unit_names: set[str]) -> None:
    """Add unit definitions to an SSP file: exponents of the SI base units."""
    if unit_names:
        units = SubElement(root_element, f"{xml_element_prefix}:Units")
        for name in sorted(unit_names):
            unit = SubElement(units, "ssc:Unit", name=name)
            SubElement(unit, "ssc:BaseUnit", {base: str(n) for base, n in UNITS[name].base_exponents.items()})
