"""modelDescription.xml of FMI 2.0 and 3.0, and buildDescription.xml of FMI 3.0.

Value references: 0 is the time (not listed in FMI 2.0), then follow inputs, outputs and parameters.
"""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from jointfmu import __version__
from jointfmu.files.timestamp import fixed_time
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity.units import CELSIUS, UNITS

from ..licence import copyright_line
from ..xml_parts import (
    ListedVariable,
    list_variables,
    model_structure,
    serialized,
    stop_time,
    text,
    unit_definitions,
    units,
)

LOG_CATEGORIES = {
    "logEvents": "changes of mode and new tables, if logging is on",
    "logStatusWarning": "the state has left the range of the law; once for each way of leaving it",
    "logStatusError": "why a call was refused: what was found and what was expected",
}
_TIME = ListedVariable("time", "independent", "simulation time", None, {"unit": "s", "displayUnit": "s"})
_COMMON = {"needsExecutionTool": "false", "canBeInstantiatedOnlyOncePerProcess": "false"}
_FMI2 = _COMMON | {
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}
_FMI2_INTERFACES = {
    "ModelExchange": _FMI2 | {"completedIntegratorStepNotNeeded": "true"},
    "CoSimulation": _FMI2
    | {
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "0",
        "canRunAsynchronuously": "false",
    },
}
_FMI3 = _COMMON | {
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesDirectionalDerivatives": "true",
    "providesAdjointDerivatives": "true",
    "providesPerElementDependencies": "true",
}
_FMI3_INTERFACES = {
    "ModelExchange": _FMI3
    | {"needsCompletedIntegratorStep": "false", "providesEvaluateDiscreteStates": "false"},
    "CoSimulation": _FMI3
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


def fmi2_xml(
    model: Model, parameters: ParameterFile, token: str, sources: Sequence[str], variability: str = "tunable"
) -> bytes:
    """Content of modelDescription.xml of FMI 2.0.

    token        : GUID
    source_names : names of the C files to compile, in `sources/`
    variability  : of all parameters, one of VARIABILITIES
    """
    variables = list_variables(model, parameters)
    root = _root(model, "2.0", "guid", token)
    root.set("numberOfEventIndicators", "0")
    for kind, flags in _FMI2_INTERFACES.items():
        interface = SubElement(root, kind, {"modelIdentifier": model.title} | flags)
        if model.initial_history and kind == "ModelExchange":
            interface.set("completedIntegratorStepNotNeeded", "false")
        files = SubElement(interface, "SourceFiles")
        for name in sources:
            SubElement(files, "File", name=name)
    root.append(unit_definitions(variables))
    types = SubElement(root, "TypeDefinitions")
    for quantity, attributes in _types(variables).items():
        SubElement(SubElement(types, "SimpleType", name=quantity), "Real", attributes)
    _log_categories_and_experiment(root, model)
    nodes = SubElement(root, "ModelVariables")
    for reference, v in enumerate(variables, start=1):
        node = SubElement(nodes, "ScalarVariable", _heading(v, reference, variability))
        SubElement(node, "Boolean" if v.boolean else "Real", _value(v))
    root.append(model_structure(model, variability))
    return serialized(root)


def fmi3_xml(model: Model, parameters: ParameterFile, token: str, variability: str = "tunable") -> bytes:
    """Content of modelDescription.xml of FMI 3.0; parameters as in `format_fmi2_description`."""
    variables = [_TIME, *list_variables(model, parameters)]
    root = _root(model, "3.0", "instantiationToken", token)
    for kind, flags in _FMI3_INTERFACES.items():
        interface = SubElement(root, kind, {"modelIdentifier": model.title} | flags)
        if model.initial_history and kind == "ModelExchange":
            interface.set("needsCompletedIntegratorStep", "true")
    root.append(unit_definitions(variables))
    types = SubElement(root, "TypeDefinitions")
    for quantity, attributes in _types(variables).items():
        SubElement(types, "Float64Type", {"name": quantity} | attributes)
    _log_categories_and_experiment(root, model)
    nodes = SubElement(root, "ModelVariables")
    for reference, v in enumerate(variables):
        SubElement(
            nodes, "Boolean" if v.boolean else "Float64", _heading(v, reference, variability) | _value(v)
        )
    root.append(model_structure(model, variability, "3"))
    return serialized(root)


def build_description(model: Model, sources: Sequence[str]) -> bytes:
    """Content of sources/buildDescription.xml of FMI 3.0: how to compile the C files in `sources/`.

    The first configuration is for any platform. On Linux the mathematical functions are a separate library:
    a further configuration for each Linux platform names it.
    """
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    for platform in (None, "x86_64-linux", "aarch64-linux"):
        build = SubElement(root, "BuildConfiguration", modelIdentifier=model.title)
        files = SubElement(build, "SourceFileSet", language="C11")
        for name in sources:
            SubElement(files, "SourceFile", name=name)
        if platform:
            build.set("platform", platform)
            SubElement(build, "Library", name="m", external="true", description="mathematical functions of C")
    return serialized(root)


def _root(model: Model, version: str, token_name: str, token: str) -> Element:
    """Root element of a model description; `token_name` is the attribute that holds the token."""
    root = Element(
        "fmiModelDescription", {"fmiVersion": version, "modelName": model.title, token_name: token}
    )
    root.attrib |= {
        "description": model.doc,
        "author": "the jointfmu authors",
        "version": __version__,
        "copyright": copyright_line(),
        "license": "MIT",
        "generationTool": f"jointfmu {__version__}",
        "variableNamingConvention": "structured",
    }
    if when := fixed_time():  # otherwise no date: builds of equal content give equal files
        root.set("generationDateAndTime", when.strftime("%Y-%m-%dT%H:%M:%SZ"))
    return root


def _types(variables: Sequence[ListedVariable]) -> dict[str, dict[str, str]]:
    """{quantity: attributes of its type definition}; its display unit is the first one of the unit."""
    return {
        UNITS[name].quantity: {
            "quantity": UNITS[name].quantity,
            "unit": name,
            "displayUnit": CELSIUS if name == "K" else next(iter(UNITS[name].display)),
        }
        for name in units(variables)
    }


def _log_categories_and_experiment(root: Element, model: Model) -> None:
    categories = SubElement(root, "LogCategories")
    for name, doc in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=doc)
    stop, step = text(stop_time(model)), f"{model.ramp.interval:g}"
    SubElement(root, "DefaultExperiment", startTime="0", stopTime=stop, stepSize=step)


def _heading(v: ListedVariable, reference: int, parameters: str) -> dict[str, str]:
    """XML attributes of a variable of any type; `parameter_variability` applies to parameters."""
    variability = parameters if v.causality == "parameter" else "continuous"
    heading = {"name": v.name, "valueReference": str(reference), "description": v.doc}
    heading |= {"causality": v.causality, "variability": variability}
    if v.causality in ("parameter", "output"):
        heading["initial"] = "calculated" if v.start is None else "exact"
    return heading


def _value(v: ListedVariable) -> dict[str, str]:
    """XML attributes of the value of a variable; the unit is repeated for importers that ignore types."""
    value = {"declaredType": UNITS[v.attributes["unit"]].quantity} if v.attributes else {}
    if v.rate_of:
        value["derivative"] = str(v.rate_of)
    return value | v.attributes | ({} if v.start is None else {"start": text(v.start)})
