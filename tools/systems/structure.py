"""System structure descriptions, SSP 1.0 and 2.0."""

from collections.abc import Mapping
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu_fmu_src.native.licence import copyright_line
from jointfmu_fmu_src.ssv import NUMBER, SSP, add_units
from jointfmu_fmu_src.xml_parts import serialized

from jointfmu import __version__
from jointfmu.files.timestamp import fixed_time

from .system import System
from .wiring import model_of, wires

_OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
_TYPE = "application/x-fmu-sharedlibrary"


class Master(NamedTuple):
    """A kind of master that an archive is for.

    suffix : of the archive's name
    lag    : communication steps by which the force of a joint comes late there
    doc    : why
    in_turn : whether it updates the components in turn, as OMSimulator does
    """

    suffix: str
    lag: float
    doc: str
    in_turn: bool = False


MASTERS = (
    Master(
        "",
        1.0,
        "For masters that step all components side by side (Jacobi: fmpy, ecos, libcosim): the force of a "
        "joint reaches a body one step late, and a lag of 1 carries it on to the present.",
    ),
    Master(
        "_in_turn",
        0.0,
        "For masters that update components in turn (Gauss-Seidel: OMSimulator): the force of a joint "
        "reaches a body at once, so the lag is 0; a lag of 1 would carry a present force on.",
        in_turn=True,
    ),
)


def structure(system: System, names: Mapping[str, str], version: str, master: Master) -> bytes:
    """SystemStructure.ssd; the parameter sets lie in `parameters/`, the FMUs in `resources/`.

    names : {component: its FMU}
    """
    spaces = {"xmlns:ssd": f"{SSP}Description", "xmlns:ssc": f"{SSP}Common"}
    head = {**spaces, "version": version, "name": system.name, **metadata()}
    root = Element("ssd:SystemStructureDescription", head)
    text = f"{system.description}. {master.doc}"
    root.set("description", text)
    inside = SubElement(root, "ssd:System", name=system.name, description=text)
    _bindings(inside, system.name)
    elements = SubElement(inside, "ssd:Elements")
    signals = wires(system)
    units = set()
    for component in system.components.values():
        model = model_of(component)
        source = f"resources/{names[component.name]}.fmu"
        node = SubElement(elements, "ssd:Component", name=component.name, source=source, type=_TYPE)
        if component.file:
            node.set("description", component.file.name)
        if version == "2.0":
            node.set("implementation", "CoSimulation")
        connectors = SubElement(node, "ssd:Connectors")
        outputs = {(wire.source, wire.output) for wire in signals}
        inputs = {(wire.target, wire.input) for wire in signals}
        for kind, variables, used in (("input", model.inputs, inputs), ("output", model.outputs, outputs)):
            for v in (v for v in variables if (component.name, v.name) in used):
                connector = SubElement(connectors, "ssd:Connector", name=v.name, kind=kind, description=v.doc)
                SubElement(connector, f"ssc:{NUMBER[version]}", unit=v.unit)
                units.add(v.unit)
        _bindings(node, component.name)
    connections = SubElement(inside, "ssd:Connections")
    for wire in signals:
        ends = zip(("startElement", "startConnector", "endElement", "endConnector"), wire, strict=True)
        SubElement(connections, "ssd:Connection", dict(ends))
    if master.in_turn:
        _for_omsimulator(inside, system.interval)
    add_units(root, "ssd", units)
    SubElement(root, "ssd:DefaultExperiment", startTime="0", stopTime=repr(system.stop_time))
    return serialized(root)


def metadata() -> dict[str, str]:
    """Who wrote an SSP file, and with what."""
    found = {
        "author": "the jointfmu authors",
        "copyright": copyright_line(),
        "license": "MIT",
        "generationTool": f"jointfmu {__version__}",
    }
    if when := fixed_time():
        found["generationDateAndTime"] = when.strftime("%Y-%m-%dT%H:%M:%SZ")
    return found


def _bindings(node: Element, name: str) -> None:
    bindings = SubElement(node, "ssd:ParameterBindings")
    SubElement(bindings, "ssd:ParameterBinding", source=f"parameters/{name}.ssv")


def _for_omsimulator(system: Element, step: float) -> None:
    """Say what OMSimulator takes from an annotation alone: that this is a co-simulation of fixed step."""
    annotations = SubElement(system, "ssd:Annotations")
    annotation = SubElement(annotations, "ssc:Annotation", type="org.openmodelica")
    own = SubElement(annotation, "oms:Annotations", {"xmlns:oms": _OMS})
    information = SubElement(own, "oms:SimulationInformation")
    SubElement(information, "oms:FixedStepMaster", description="oms-ma", stepSize=repr(step))
