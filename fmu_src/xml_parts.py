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

VARIABILITIES = ("tunable", "fixed")
"""Variability of all parameters of an FMU: tunable also during a run, or fixed after initialization."""


class ListedVariable(NamedTuple):
    """Variable of a model as its model description lists it.

    start         : start value; None if the variable is calculated, a bool for a Boolean
    attributes    : XML attributes of a real number: unit, displayUnit, min, max, nominal
    derivative_of : value reference of the state whose time derivative this variable is; None: no derivative
    """

    name: str
    causality: str
    doc: str
    start: float | bool | None
    attributes: dict[str, str]
    derivative_of: int | None = None

    @property
    def is_boolean(self) -> bool:
        """Whether the variable is a Boolean; all other variables are real numbers."""
        return isinstance(self.start, bool)


def list_variables(model: Model, parameters: ParameterFile) -> list[ListedVariable]:
    """List the inputs, outputs and parameters of a model in the order of their value references, from 1."""
    values = parameters.values_by_name
    variables: list[ListedVariable] = []
    for causality, group in (("input", model.inputs), ("output", model.outputs)):
        for i, v in enumerate(group):
            attributes = _unit_attributes(v.unit, v.nominal) | _bound_attributes(v.interval)
            state = causality == "output" and i < model.state_count
            rate = causality == "output" and model.is_state_derivative(i)
            rate_of = len(variables) + 1 - model.state_count // 2 if rate else None
            attributes["nominal"] = repr(v.nominal)
            start = parameters.start_value(v.name) if causality == "input" else 0.0 if state else None
            variables.append(ListedVariable(v.name, causality, v.doc, start, attributes, rate_of))
    for name, item in model.parameter_fields().items():
        meta, value = item.metadata, values[name]
        doc = meta["doc"]
        if meta.get("calibration"):
            doc += " (calibration parameter: fitted to published points)"
        attributes = {}
        if "unit" in meta:
            attributes = _unit_attributes(meta["unit"], value) | _bound_attributes(meta["interval"])
            if value:
                attributes["nominal"] = repr(abs(value))
        variables.append(ListedVariable(name, "parameter", doc, value, attributes))
    return variables


def format_start_value(value: float | bool) -> str:
    """Format a start value for XML; numbers are exact to the last bit."""
    return str(value).lower() if isinstance(value, bool) else repr(float(value))


def stop_time(model: Model) -> float:
    """Stop time [s] of the default experiment of a model, which is the load ramp."""
    return round(model.ramp.end_value / model.ramp.value_step) * model.ramp.step_duration


def list_units(variables: Sequence[ListedVariable]) -> list[str]:
    """Sorted names of the units of some variables."""
    return sorted({v.attributes["unit"] for v in variables if "unit" in v.attributes})


def make_unit_definitions(variables: Sequence[ListedVariable]) -> Element:
    """Make the XML element UnitDefinitions of some variables, the same in FMI 2.0 and 3.0."""
    definitions = Element("UnitDefinitions")
    for name in list_units(variables):
        unit = SubElement(definitions, "Unit", name=name)
        SubElement(unit, "BaseUnit", {k: str(n) for k, n in UNITS[name].base_exponents.items()})
        for shown, factor in UNITS[name].display_factors.items():
            SubElement(unit, "DisplayUnit", name=shown, factor=repr(factor))
        if name == "K":
            SubElement(
                unit, "DisplayUnit", name=CELSIUS_UNIT, factor="1.0", offset=repr(-CELSIUS_ZERO_IN_KELVIN)
            )
    return definitions


def make_model_structure(model: Model, variability: str, fmi_version: str = "2") -> Element:
    """Make the XML element ModelStructure: outputs, derivatives and initial unknowns with their dependencies.

    In FMI 2.0 the index of a variable equals its value reference.

    variability : FMI variability of all parameters, one of VARIABILITIES
    fmi_version : version of FMI, "2" or "3"
    """
    outputs, parameters = [v.name for v in model.outputs], list(model.parameter_fields())
    names = [*(v.name for v in model.inputs), *outputs, *parameters]
    index = {name: reference for reference, name in enumerate(names, start=1)}
    rates = [name for i, name in enumerate(outputs) if model.is_state_derivative(i)]
    dependency_kinds = {"constant": "constant", "parameters": variability}
    initial_kinds = {"constant": "constant"}  # parameters can still change: only a number is a known factor
    root = Element("ModelStructure")
    for fmi2, fmi3, unknowns, kinds, further_knowns in (
        ("Outputs", "Output", outputs, dependency_kinds, []),
        ("Derivatives", "ContinuousStateDerivative", rates, dependency_kinds, []),
        ("InitialUnknowns", "InitialUnknown", outputs[model.state_count :], initial_kinds, parameters),
    ):
        group = SubElement(root, fmi2) if unknowns and fmi_version == "2" else root
        tag, key = ("Unknown", "index") if fmi_version == "2" else (fmi3, "valueReference")
        for name in unknowns:
            linear = model.linear_factors.get(name, {})
            knowns = [*sorted(model.list_dependencies(name), key=index.__getitem__), *further_knowns]
            dependencies = {
                "dependencies": " ".join(str(index[known]) for known in knowns),
                "dependenciesKind": " ".join(kinds.get(linear.get(n, ""), "dependent") for n in knowns),
            }
            SubElement(group, tag, {key: str(index[name])} | dependencies)
    return root


def serialize_xml(root: Element) -> bytes:
    """Bytes of an indented XML file; equal content gives equal bytes."""
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()


def format_xml_comment(lines: Sequence[str]) -> str:
    """Format lines as an XML comment; double hyphens, which XML forbids there, are separated."""
    return "<!--\n" + "".join(f"  {re.sub('-(?=-)', '- ', line)}\n" for line in lines) + "-->\n"


def _unit_attributes(unit: str, typical_value: float) -> dict[str, str]:
    """XML attributes unit and displayUnit of a variable.

    typical_value : [SI] for which the display unit is chosen
    """
    return {"unit": unit, "displayUnit": CELSIUS_UNIT if unit == "K" else display_unit(unit, typical_value)}


def _bound_attributes(interval: Interval) -> dict[str, str]:
    """XML attributes min and max of an interval, for its finite ends."""
    bounds = zip(("min", "max"), interval.closed_bounds(), strict=True)
    return {name: repr(bound) for name, bound in bounds if math.isfinite(bound)}
