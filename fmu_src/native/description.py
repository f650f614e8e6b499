"""modelDescription.xml of FMI 2.0 and 3.0, and buildDescription.xml of FMI 3.0.

Value references: 0 is the time (not listed in FMI 2.0), then follow inputs, outputs and parameters.
"""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from jointfmu.files.timestamp import source_date
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
_FMI2_INTERFACE_TYPES = {
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
_FMI3_INTERFACE_TYPES = {
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
    model: Model,
    parameters: ParameterFile,
    token: str,
    source_names: Sequence[str],
    variability: str = "tunable",
) -> bytes:
    """Content of modelDescription.xml of FMI 2.0.

    token        : GUID
    source_names : names of the C files to compile, in `sources/`
    variability  : FMI variability of all parameters, one of VARIABILITIES
    """
    variables = list_variables(model, parameters)
    root = _make_root(model, "2.0", "guid", token)
    root.set("numberOfEventIndicators", "0")
    for kind, flags in _FMI2_INTERFACE_TYPES.items():
        interface = SubElement(root, kind, {"modelIdentifier": model.title} | flags)
        if model.initial_history and kind == "ModelExchange":
            interface.set("completedIntegratorStepNotNeeded", "false")
        files = SubElement(interface, "SourceFiles")
        for name in source_names:
            SubElement(files, "File", name=name)
    root.append(make_unit_definitions(variables))
    types = SubElement(root, "TypeDefinitions")
    for quantity, attributes in _type_attributes(variables).items():
        SubElement(SubElement(types, "SimpleType", name=quantity), "Real", attributes)
    _add_log_categories_and_experiment(root, model)
    nodes = SubElement(root, "ModelVariables")
    for reference, v in enumerate(variables, start=1):
        node = SubElement(nodes, "ScalarVariable", _common_attributes(v, reference, variability))
        SubElement(node, "Boolean" if v.is_boolean else "Real", _value_attributes(v))
    root.append(make_model_structure(model, variability))
    return serialize_xml(root)


def format_fmi3_description(
    model: Model, parameters: ParameterFile, token: str, variability: str = "tunable"
) -> bytes:
    """Content of modelDescription.xml of FMI 3.0; parameters as in `format_fmi2_description`."""
    variables = [_TIME_VARIABLE, *list_variables(model, parameters)]
    root = _make_root(model, "3.0", "instantiationToken", token)
    for kind, flags in _FMI3_INTERFACE_TYPES.items():
        interface = SubElement(root, kind, {"modelIdentifier": model.title} | flags)
        if model.initial_history and kind == "ModelExchange":
            interface.set("needsCompletedIntegratorStep", "true")
    root.append(make_unit_definitions(variables))
    types = SubElement(root, "TypeDefinitions")
    for quantity, attributes in _type_attributes(variables).items():
        SubElement(types, "Float64Type", {"name": quantity} | attributes)
    _add_log_categories_and_experiment(root, model)
    nodes = SubElement(root, "ModelVariables")
    for reference, v in enumerate(variables):
        SubElement(
            nodes,
            "Boolean" if v.is_boolean else "Float64",
            _common_attributes(v, reference, variability) | _value_attributes(v),
        )
    root.append(make_model_structure(model, variability, "3"))
    return serialize_xml(root)


def format_build_description(model: Model, source_names: Sequence[str]) -> bytes:
    """Content of sources/buildDescription.xml of FMI 3.0: how to compile the C files in `sources/`.

    The first configuration is for any platform. On Linux the mathematical functions are a separate library:
    a further configuration for each Linux platform names it.
    """
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    for platform in (None, "x86_64-linux", "aarch64-linux"):
        build = SubElement(root, "BuildConfiguration", modelIdentifier=model.title)
        files = SubElement(build, "SourceFileSet", language="C11")
        for name in source_names:
            SubElement(files, "SourceFile", name=name)
        if platform:
            build.set("platform", platform)
            SubElement(build, "Library", name="m", external="true", description="mathematical functions of C")
    return serialize_xml(root)


def _make_root(model: Model, fmi_version: str, token_name: str, token: str) -> Element:
    """Make the root element of a model description; `token_name` is the attribute that holds the token."""
    root = Element(
        "fmiModelDescription", {"fmiVersion": fmi_version, "modelName": model.title, token_name: token}
    )
    root.attrib |= {
        "description": model.doc,
        "author": "the jointfmu authors",
        "version": __version__,
        "copyright": find_copyright_line(),
        "license": "MIT",
        "generationTool": f"jointfmu {__version__}",
        "variableNamingConvention": "structured",
    }
    if when := source_date():  # otherwise no date: builds of equal content give equal files
        root.set("generationDateAndTime", when.strftime("%Y-%m-%dT%H:%M:%SZ"))
    return root


def _type_attributes(variables: Sequence[ListedVariable]) -> dict[str, dict[str, str]]:
    """{quantity: attributes of its type definition} in a model description.

    The display unit of a type is the first display unit of its SI unit.
    """
    return {
        UNITS[name].quantity: {
            "quantity": UNITS[name].quantity,
            "unit": name,
            "displayUnit": CELSIUS_UNIT if name == "K" else next(iter(UNITS[name].display_factors)),
        }
        for name in list_units(variables)
    }


def _add_log_categories_and_experiment(root: Element, model: Model) -> None:
    """Add the log categories and the default experiment to a model description."""
    categories = SubElement(root, "LogCategories")
    for name, doc in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=doc)
    stop, step = format_start_value(stop_time(model)), f"{model.ramp.step_duration:g}"
    SubElement(root, "DefaultExperiment", startTime="0", stopTime=stop, stepSize=step)


def _common_attributes(
    listed_variable: ListedVariable, value_reference: int, parameter_variability: str
) -> dict[str, str]:
    """XML attributes of a variable of any type; `parameter_variability` applies to parameters."""
    variability = parameter_variability if listed_variable.causality == "parameter" else "continuous"
    heading = {
        "name": listed_variable.name,
        "valueReference": str(value_reference),
        "description": listed_variable.doc,
    }
    heading |= {"causality": listed_variable.causality, "variability": variability}
    if listed_variable.causality in ("parameter", "output"):
        heading["initial"] = "calculated" if listed_variable.start is None else "exact"
    return heading


def _value_attributes(listed_variable: ListedVariable) -> dict[str, str]:
    """XML attributes of the value of a variable; the unit is repeated for importers that ignore types."""
    value = (
        {"declaredType": UNITS[listed_variable.attributes["unit"]].quantity}
        if listed_variable.attributes
        else {}
    )
    if listed_variable.derivative_of:
        value["derivative"] = str(listed_variable.derivative_of)
    return (
        value
        | listed_variable.attributes
        | ({} if listed_variable.start is None else {"start": format_start_value(listed_variable.start)})
    )
