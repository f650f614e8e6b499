"""Systems as SSP archives with their structure descriptions: SSP 1.0 with FMUs of FMI 2.0, SSP 2.0 with
FMUs of FMI 3.0.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu_fmu_src.archive import pack, workshop
from jointfmu_fmu_src.licence import copyright_line
from jointfmu_fmu_src.native.build import build
from jointfmu_fmu_src.native.compiled.kept import VERSIONS
from jointfmu_fmu_src.partners import parameters as partner_parameters
from jointfmu_fmu_src.ssv import NUMBER, SSP, Value, add_units, parameter_set
from jointfmu_fmu_src.xml_parts import VARIABILITIES, serialized

from jointfmu import __version__
from jointfmu.files.outputs import ARCHIVE, check_outputs
from jointfmu.files.timestamp import fixed_time
from jointfmu.parameters import ParameterFile
from jointfmu.progress import map_jobs

from .system import Component, System, systems
from .wiring import lags, model_of, wires

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


FOLDERS = {"1.0": ("ssp", "fmi2"), "2.0": ("ssp2", "fmi3")}
"""{version of SSP: (folder of the archives, folder of their FMUs)}."""


def build_systems(
    out: Path,
    wanted: Sequence[System] | None = None,
    parameters: ParameterFile | None = None,
    joints: bool = True,
    variability: str = VARIABILITIES[0],
    pool: Executor | None = None,
    force: bool = False,
) -> list[Path]:
    """Write the archives of systems, and their components as `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu`.

    wanted      : None: all that are shipped
    parameters  : of a joint, instead of that of the systems: then only systems with the joint are packed
    joints      : build the systems' joints beside the partners; else they are there
    variability : of the parameters, one of VARIABILITIES
    pool        : processes that share the work; None: this one does it
    force       : replace files of these names that jointfmu did not write

    Raises what `native.build.build` and `pack_system` raise, and ValueError if no system has the joint, or
    two joints of one FMU differ in what is baked into it.
    """
    chosen = list(systems().values()) if wanted is None else list(wanted)
    if parameters:
        kinds = {kind for system in chosen for kind in system.kinds}
        if parameters.joint not in kinds:
            allowed = ", ".join(sorted(kinds))
            raise ValueError(f"no system has a joint {parameters.joint!r}, allowed are {allowed}")
        chosen = [system.with_joint(parameters) for system in chosen if parameters.joint in system.kinds]
    used: dict[str, Component] = {}
    for system in chosen:
        wires(system)
        for name, fmu in fmu_names(system).items():
            used.setdefault(fmu, system.components[name])
    wanted_fmus = {fmu: one for fmu, one in used.items() if joints or one.own or not one.file}
    fmus_out = [out / f"fmi{version}" / f"{fmu}.fmu" for version in VERSIONS for fmu in wanted_fmus]
    archives = [_target(system, out, *kind) for system in chosen for kind in product(FOLDERS, MASTERS)]
    check_outputs([*fmus_out, *archives], ARCHIVE, force)
    work = partial(_versions, out, variability)
    built = map_jobs(pool, work, "build FMUs of systems", [*wanted_fmus], [*wanted_fmus.values()])
    fmus = [path for paths in zip(*built, strict=True) for path in paths]
    return fmus + [path for system in chosen for path in pack_system(system, out)]


def _versions(out: Path, variability: str, fmu: str, component: Component) -> list[Path]:
    """Build an FMU of a component in all versions of FMI, which share what is compiled."""
    file = (component.file if component.own else component.base) or partner_parameters(component.model)
    alias = "" if fmu == component.model else fmu
    return [
        build(component.model, file, out / f"fmi{version}", version, variability, alias)
        for version in VERSIONS
    ]


def pack_system(system: System, out: Path) -> list[Path]:
    """Write `out/ssp/NAME.ssp` (SSP 1.0) and `out/ssp2/NAME.ssp` (SSP 2.0) for every one of MASTERS.

    They hold FMUs of `out/fmi2` and `out/fmi3`, and the system's numbers.

    Raises ValueError for flanges that do not fit, see `wiring.ends`, and folders that cannot be written.
    """
    return [_pack(system, out, version, master) for version, master in product(FOLDERS, MASTERS)]


def _target(system: System, out: Path, version: str, master: Master) -> Path:
    return out / FOLDERS[version][0] / f"{system.name}{master.suffix}.ssp"


def _pack(system: System, out: Path, version: str, master: Master) -> Path:
    late, names = lags(system), fmu_names(system)
    members = {"SystemStructure.ssd": structure(system, names, version, master)}
    every: dict[str, Value] = {}
    for name, component in system.components.items():
        own = values(component) | {lag: Value(master.lag, "1", master.doc) for lag in late.get(name, ())}
        every |= {f"{name}.{variable}": value for variable, value in own.items()}
        members[f"resources/{names[name]}.fmu"] = (
            out / FOLDERS[version][1] / f"{names[name]}.fmu"
        ).read_bytes()
        members[f"parameters/{name}.ssv"] = parameter_set(system.name, own, version, metadata())
    members[f"parameters/{system.name}.ssv"] = parameter_set(system.name, every, version, metadata())
    target = _target(system, out, version, master)
    with workshop(target) as work:
        pack(members, work / target.name)
    return target


def values(component: Component) -> dict[str, Value]:
    """{variable: value} of a component: of the joint's file, and of the system's.

    Booleans of the joint's file are the start values of its FMU: fmpy takes every Boolean of a parameter set
    for true.
    """
    found: dict[str, Value] = {}
    if component.file:
        for name, item in model_of(component).parameter_fields().items():
            value = component.file.values_by_name[name]
            if not isinstance(value, bool):
                found[name] = Value(
                    value, item.metadata.get("unit", ""), component.file.sources.get(name, "")
                )
    return found | {
        name: Value(value, component.units[name], component.sources[name])
        for name, value in component.values.items()
        if name in component.parameters or name in component.state
    }


def fmu_names(system: System) -> dict[str, str]:
    """{component: its FMU}: the model's name; where it is another, SYSTEM_COMPONENT of the first one with the
    same baked values."""
    found: dict[str, str] = {}
    variants: list[tuple[str, Mapping[str, Any], str]] = []
    for name, component in system.components.items():
        if not (component.file and component.own):
            found[name] = component.model
            continue
        exposed = model_of(component).parameter_fields()
        baked = {
            key: value
            for key, value in component.file.values_by_name.items()
            if key not in exposed or isinstance(value, bool)
        } | {"law": component.file.law}
        same = [fmu for model, values, fmu in variants if (model, values) == (component.model, baked)]
        found[name] = same[0] if same else f"{system.name}_{name}"
        if not same:
            variants.append((component.model, baked, found[name]))
    return found
