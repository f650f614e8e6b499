"""Parts that the model descriptions of all flavours share: variables, units, model structure."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval
from jointfmu.quantity.units import CELSIUS_UNIT, CELSIUS_ZERO_IN_KELVIN, UNITS, display_unit

PARAMETER_VARIABILITIES = ("tunable", "fixed")
"""Variability of all parameters of an FMU: tunable also during a run, or fixed after initialization."""


class ListedVariable(NamedTuple):
    """FMU variable as the model description lists it.

    start_value                    : start value; None: the variable is calculated; a bool: it is a Boolean
    xml_attributes                 : XML attributes of a real number: unit, displayUnit, min, max, nominal
    differentiated_state_reference : value reference of the state of which this variable is the time
        derivative; None: the variable is no derivative
    """

    variable_name: str
    causality: str
    variable_description: str
    start_value: float | bool | None
    xml_attributes: dict[str, str]
    differentiated_state_reference: int | None = None

    @property
    def is_boolean(self) -> bool:
        """Whether the variable is a Boolean; all other variables are real numbers."""
        return isinstance(self.start_value, bool)


def list_variables(fmu_model: Model, parameter_file: ParameterFile) -> list[ListedVariable]:
    """List the inputs, outputs and parameters of an FMU in the order of their value references, from 1."""
    values = parameter_file.values_by_name
    variables: list[ListedVariable] = []
    for causality, group in (("input", fmu_model.inputs), ("output", fmu_model.outputs)):
        for i, v in enumerate(group):
            attributes = _make_unit_attributes(v.unit, v.nominal) | _make_bound_attributes(v.interval)
            state = causality == "output" and i < fmu_model.state_count
            rate = causality == "output" and fmu_model.is_state_derivative(i)
            rate_of = len(variables) + 1 - fmu_model.state_count // 2 if rate else None
            attributes["nominal"] = repr(v.nominal)
            start = parameter_file.start_value(v.name) if causality == "input" else 0.0 if state else None
            variables.append(ListedVariable(v.name, causality, v.doc, start, attributes, rate_of))
    for name, item in fmu_model.parameter_fields().items():
        meta, value = item.metadata, values[name]
        doc = meta["doc"]
        if meta.get("calibration"):
            doc += " (calibration parameter: fitted to published points)"
        attributes = {}
        if "unit" in meta:
            attributes = _make_unit_attributes(meta["unit"], value) | _make_bound_attributes(meta["interval"])
            if value:
                attributes["nominal"] = repr(abs(value))
        variables.append(ListedVariable(name, "parameter", doc, value, attributes))
    return variables


def format_start_value(start_value: float | bool) -> str:
    """Format a start value for XML; numbers are exact to the last bit."""
    return str(start_value).lower() if isinstance(start_value, bool) else repr(float(start_value))


def stop_time(fmu_model: Model) -> float:
    """Stop time [s] of the default experiment of an FMU, which is the load ramp."""
    return round(fmu_model.ramp.end_value / fmu_model.ramp.value_step) * fmu_model.ramp.step_duration


def list_units(listed_variables: Sequence[ListedVariable]) -> list[str]:
    """List the names of the units of FMU variables, sorted."""
    return sorted({v.xml_attributes["unit"] for v in listed_variables if "unit" in v.xml_attributes})


def make_unit_definitions(listed_variables: Sequence[ListedVariable]) -> Element:
    """Make the XML element UnitDefinitions for FMU variables, the same in FMI 2.0 and 3.0."""
    definitions = Element("UnitDefinitions")
    for name in list_units(listed_variables):
        unit = SubElement(definitions, "Unit", name=name)
        SubElement(unit, "BaseUnit", {k: str(n) for k, n in UNITS[name].base_exponents.items()})
        for shown, factor in UNITS[name].display_factors.items():
            SubElement(unit, "DisplayUnit", name=shown, factor=repr(factor))
        if name == "K":
            SubElement(
                unit, "DisplayUnit", name=CELSIUS_UNIT, factor="1.0", offset=repr(-CELSIUS_ZERO_IN_KELVIN)
            )
    return definitions


def make_model_structure(fmu_model: Model, parameter_variability: str, fmi_version: str = "2") -> Element:
    """Make the XML element ModelStructure: outputs, derivatives and initial unknowns with their dependencies.

    FMI 2.0 refers to a variable by its index in ModelVariables, from 1. In these FMUs, this index equals the
    value reference.

    parameter_variability : FMI variability of all parameters, one of PARAMETER_VARIABILITIES
    fmi_version           : version of FMI, "2" or "3"
    """
    outputs, parameters = [v.name for v in fmu_model.outputs], list(fmu_model.parameter_fields())
    names = [*(v.name for v in fmu_model.inputs), *outputs, *parameters]
    index = {name: reference for reference, name in enumerate(names, start=1)}
    rates = [name for i, name in enumerate(outputs) if fmu_model.is_state_derivative(i)]
    dependency_kinds = {"constant": "constant", "parameters": parameter_variability}
    initial_kinds = {"constant": "constant"}  # parameters can still change: only a number is a known factor
    root = Element("ModelStructure")
    for fmi2, fmi3, unknowns, kinds, further_knowns in (
        ("Outputs", "Output", outputs, dependency_kinds, []),
        ("Derivatives", "ContinuousStateDerivative", rates, dependency_kinds, []),
        ("InitialUnknowns", "InitialUnknown", outputs[fmu_model.state_count :], initial_kinds, parameters),
    ):
        group = SubElement(root, fmi2) if unknowns and fmi_version == "2" else root
        tag, key = ("Unknown", "index") if fmi_version == "2" else (fmi3, "valueReference")
        for name in unknowns:
            linear = fmu_model.linear_factors.get(name, {})
            knowns = [*sorted(fmu_model.list_dependencies(name), key=index.__getitem__), *further_knowns]
            dependencies = {
                "dependencies": " ".join(str(index[known]) for known in knowns),
                "dependenciesKind": " ".join(kinds.get(linear.get(n, ""), "dependent") for n in knowns),
            }
            SubElement(group, tag, {key: str(index[name])} | dependencies)
    return root


def serialize_xml(root_element: Element) -> bytes:
    """Format an element as an indented XML file; equal content gives equal bytes."""
    indent(root_element)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root_element, encoding="unicode")}\n'.encode()


def format_xml_comment(comment_lines: Sequence[str]) -> str:
    """Format lines as an XML comment; double hyphens, which XML forbids there, are separated."""
    return "<!--\n" + "".join(f"  {re.sub('-(?=-)', '- ', line)}\n" for line in comment_lines) + "-->\n"


def _make_unit_attributes(si_unit: str, typical_value: float) -> dict[str, str]:
    """XML attributes unit and displayUnit of an FMU variable.

    typical_value : value of the variable [SI], for which a suitable display unit is chosen
    """
    return {
        "unit": si_unit,
        "displayUnit": CELSIUS_UNIT if si_unit == "K" else display_unit(si_unit, typical_value),
    }


def _make_bound_attributes(allowed_interval: Interval) -> dict[str, str]:
    """XML attributes min and max of an FMU variable, for the finite ends of its allowed interval."""
    bounds = zip(("min", "max"), allowed_interval.closed_bounds(), strict=True)
    return {name: repr(bound) for name, bound in bounds if math.isfinite(bound)}
