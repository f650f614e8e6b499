"""modelDescription.xml of FMI 2.0 and 3.0, and buildDescription.xml of FMI 3.0.

Value references: 0 is the time (not listed in FMI 2.0), then follow inputs, outputs and parameters.
"""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from jointfmu.files.timestamp import read_source_date
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity.units import CELSIUS_UNIT, UNITS
from jointfmu.version import __version__

from ..licence import find_copyright_line
from ..xml_parts import (
    ListedVariable,
    format_start_value,
    list_units,
    list_variables,
    make_model_structure,
    make_unit_definitions,
    serialize_xml,
    stop_time,
)

LOG_CATEGORIES = {
    "logEvents": "changes of mode and new tables, if logging is on",
    "logStatusWarning": "the state has left the range of the law; once for each way of leaving it",
    "logStatusError": "why a call was refused: what was found and what was expected",
}
"""{log category of FMI: its meaning}."""
_TIME_VARIABLE = ListedVariable(
    "time", "independent", "simulation time", None, {"unit": "s", "displayUnit": "s"}
)
"""Entry of the time in a model description."""
_COMMON_CAPABILITIES = {"needsExecutionTool": "false", "canBeInstantiatedOnlyOncePerProcess": "false"}
"""Capability flags of an FMU that both FMI versions have."""
_FMI2_CAPABILITIES = _COMMON_CAPABILITIES | {
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}
"""Capability flags of both interface types in FMI 2.0."""
_FMI2_INTERFACE_TYPE_CAPABILITIES = {
    "ModelExchange": _FMI2_CAPABILITIES | {"completedIntegratorStepNotNeeded": "true"},
    "CoSimulation": _FMI2_CAPABILITIES
    | {
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "0",
        "canRunAsynchronuously": "false",
    },
}
"""{interface type: capability flags} in FMI 2.0."""
_FMI3_CAPABILITIES = _COMMON_CAPABILITIES | {
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesDirectionalDerivatives": "true",
    "providesAdjointDerivatives": "true",
    "providesPerElementDependencies": "true",
}
"""Capability flags of both interface types in FMI 3.0."""
_FMI3_INTERFACE_TYPE_CAPABILITIES = {
    "ModelExchange": _FMI3_CAPABILITIES
    | {"needsCompletedIntegratorStep": "false", "providesEvaluateDiscreteStates": "false"},
    "CoSimulation": _FMI3_CAPABILITIES
    | {
        "canHandleVariableCommunicationStepSize": "true",
        "maxOutputDerivativeOrder": "0",
        "recommendedIntermediateInputSmoothness": "0",
        "providesIntermediateUpdate": "false",
        "mightReturnEarlyFromDoStep": "false",
        "canReturnEarlyAfterIntermediateUpdate": "false",
        "hasEventMode": "false",
        "providesEvaluateDiscreteStates": "false",
    },
}
"""{interface type: capability flags} in FMI 3.0."""


def format_fmi2_description(
    fmu_model: Model,
    parameter_file: ParameterFile,
    instantiation_token: str,
    source_names: Sequence[str],
    parameter_variability: str = "tunable",
) -> bytes:
    """Format modelDescription.xml of FMI 2.0.

    instantiation_token   : GUID
    source_names          : names of the C files to compile, in `sources/`
    parameter_variability : FMI variability of all parameters, one of PARAMETER_VARIABILITIES
    """
    variables = list_variables(fmu_model, parameter_file)
    root = _make_root_element(fmu_model, "2.0", "guid", instantiation_token)
    root.set("numberOfEventIndicators", "0")
    for kind, flags in _FMI2_INTERFACE_TYPE_CAPABILITIES.items():
        interface = SubElement(root, kind, {"modelIdentifier": fmu_model.title} | flags)
        if fmu_model.initial_history and kind == "ModelExchange":
            interface.set("completedIntegratorStepNotNeeded", "false")
        files = SubElement(interface, "SourceFiles")
        for name in source_names:
            SubElement(files, "File", name=name)
    root.append(make_unit_definitions(variables))
    types = SubElement(root, "TypeDefinitions")
    for quantity, attributes in _make_type_definition_attributes(variables).items():
        SubElement(SubElement(types, "SimpleType", name=quantity), "Real", attributes)
    _add_log_categories_and_experiment(root, fmu_model)
    nodes = SubElement(root, "ModelVariables")
    for reference, v in enumerate(variables, start=1):
        node = SubElement(
            nodes, "ScalarVariable", _make_common_variable_attributes(v, reference, parameter_variability)
        )
        SubElement(node, "Boolean" if v.is_boolean else "Real", _make_value_attributes(v))
    root.append(make_model_structure(fmu_model, parameter_variability))
    return serialize_xml(root)


def format_fmi3_description(
    fmu_model: Model,
    parameter_file: ParameterFile,
    instantiation_token: str,
    parameter_variability: str = "tunable",
) -> bytes:
    """Format modelDescription.xml of FMI 3.0; parameters as in `format_fmi2_description`."""
    variables = [_TIME_VARIABLE, *list_variables(fmu_model, parameter_file)]
    root = _make_root_element(fmu_model, "3.0", "instantiationToken", instantiation_token)
    for kind, flags in _FMI3_INTERFACE_TYPE_CAPABILITIES.items():
        interface = SubElement(root, kind, {"modelIdentifier": fmu_model.title} | flags)
        if fmu_model.initial_history and kind == "ModelExchange":
            interface.set("needsCompletedIntegratorStep", "true")
    root.append(make_unit_definitions(variables))
    types = SubElement(root, "TypeDefinitions")
    for quantity, attributes in _make_type_definition_attributes(variables).items():
        SubElement(types, "Float64Type", {"name": quantity} | attributes)
    _add_log_categories_and_experiment(root, fmu_model)
    nodes = SubElement(root, "ModelVariables")
    for reference, v in enumerate(variables):
        SubElement(
            nodes,
            "Boolean" if v.is_boolean else "Float64",
            _make_common_variable_attributes(v, reference, parameter_variability) | _make_value_attributes(v),
        )
    root.append(make_model_structure(fmu_model, parameter_variability, "3"))
    return serialize_xml(root)


def format_build_description(fmu_model: Model, source_names: Sequence[str]) -> bytes:
    """Format sources/buildDescription.xml of FMI 3.0: how to compile the C files in `sources/`.

    The first build configuration is for any platform. On Linux the mathematical functions are a separate
    library, so each Linux platform has a further configuration with this library.
    """
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    for platform in (None, "x86_64-linux", "aarch64-linux"):
        build = SubElement(root, "BuildConfiguration", modelIdentifier=fmu_model.title)
        files = SubElement(build, "SourceFileSet", language="C11")
        for name in source_names:
            SubElement(files, "SourceFile", name=name)
        if platform:
            build.set("platform", platform)
            SubElement(build, "Library", name="m", external="true", description="mathematical functions of C")
    return serialize_xml(root)


def _make_root_element(
    fmu_model: Model, fmi_version: str, token_attribute_name: str, instantiation_token: str
) -> Element:
    """Make the root element of a model description with the instantiation token in an attribute."""
    root = Element(
        "fmiModelDescription",
        {"fmiVersion": fmi_version, "modelName": fmu_model.title, token_attribute_name: instantiation_token},
    )
    root.attrib |= {
        "description": fmu_model.doc,
        "author": "the jointfmu authors",
        "version": __version__,
        "copyright": find_copyright_line(),
        "license": "MIT",
        "generationTool": f"jointfmu {__version__}",
        "variableNamingConvention": "structured",
    }
    if when := read_source_date():  # otherwise no date: builds of equal content give equal files
        root.set("generationDateAndTime", when.strftime("%Y-%m-%dT%H:%M:%SZ"))
    return root


def _make_type_definition_attributes(listed_variables: Sequence[ListedVariable]) -> dict[str, dict[str, str]]:
    """Make the XML attributes of the type definitions in a model description: {quantity: attributes}.

    The display unit of a quantity is the first display unit of its SI unit.
    """
    return {
        UNITS[name].quantity: {
            "quantity": UNITS[name].quantity,
            "unit": name,
            "displayUnit": CELSIUS_UNIT if name == "K" else next(iter(UNITS[name].display_factors)),
        }
        for name in list_units(listed_variables)
    }


def _add_log_categories_and_experiment(root_element: Element, fmu_model: Model) -> None:
    """Add the log categories and the default experiment to a model description."""
    categories = SubElement(root_element, "LogCategories")
    for name, doc in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=doc)
    stop, step = format_start_value(stop_time(fmu_model)), f"{fmu_model.ramp.step_duration:g}"
    SubElement(root_element, "DefaultExperiment", startTime="0", stopTime=stop, stepSize=step)


def _make_common_variable_attributes(
    listed_variable: ListedVariable, value_reference: int, parameter_variability: str
) -> dict[str, str]:
    """XML attributes of an FMU variable that do not depend on its type: name, causality, variability."""
    variability = parameter_variability if listed_variable.causality == "parameter" else "continuous"
    heading = {
        "name": listed_variable.variable_name,
        "valueReference": str(value_reference),
        "description": listed_variable.variable_description,
    }
    heading |= {"causality": listed_variable.causality, "variability": variability}
    if listed_variable.causality in ("parameter", "output"):
        heading["initial"] = "calculated" if listed_variable.start_value is None else "exact"
    return heading


def _make_value_attributes(listed_variable: ListedVariable) -> dict[str, str]:
    """XML attributes of the value of an FMU variable: type, unit, bounds, start value.

    Unit and bounds repeat the type definition, for importers that ignore it.
    """
    value = (
        {"declaredType": UNITS[listed_variable.xml_attributes["unit"]].quantity}
        if listed_variable.xml_attributes
        else {}
    )
    if listed_variable.differentiated_state_reference:
        value["derivative"] = str(listed_variable.differentiated_state_reference)
    return (
        value
        | listed_variable.xml_attributes
        | (
            {}
            if listed_variable.start_value is None
            else {"start": format_start_value(listed_variable.start_value)}
        )
    )
