"""SSP archives of systems: SSP 1.0 with FMUs of FMI 2.0, SSP 2.0 with FMUs of FMI 3.0."""

import tomllib
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

from jointfmu_fmu_src.archive import staging_folder, write_archive
from jointfmu_fmu_src.licence import find_copyright_line
from jointfmu_fmu_src.native.build import build_native_fmu
from jointfmu_fmu_src.native.compiled.compiled_models import FMI_VERSIONS
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from jointfmu_fmu_src.proof.standard import REFERENCE_FILE_FOLDER
from jointfmu_fmu_src.ssv import (
    REAL_NUMBER_ELEMENT_NAMES,
    SSP_NAMESPACE,
    ParameterValue,
    add_unit_definitions,
    format_ssv_parameter_set,
)
from jointfmu_fmu_src.xml_parts import PARAMETER_VARIABILITIES, serialize_xml

from jointfmu.files import archives
from jointfmu.files.outputs import ARCHIVE_FILE, check_outputs
from jointfmu.files.timestamp import read_source_date
from jointfmu.parameters import ParameterFile, format_parameter_file
from jointfmu.progress import map_jobs
from jointfmu.quantity.refusal import InputRefusal
from jointfmu.version import __version__

from .arm import UNCOUPLED_AXES_NOTE
from .system import Component, System, load_systems
from .wiring import find_lag_parameters, find_model, find_signals

_OMS_NAMESPACE = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
"""XML namespace of the annotations of OMSimulator."""
_FMU_MIME_TYPE = "application/x-fmu-sharedlibrary"
"""MIME type of an FMU in an SSP file."""


class MasterKind(NamedTuple):
    """Kind of co-simulation master for which an archive is made.

    archive_suffix   : suffix of the archive name
    force_lag_steps  : number of communication steps by which the force of a joint on a body is delayed
    force_lag_reason : reason for this lag
    is_sequential    : whether the master is sequential (Gauss-Seidel), as OMSimulator; otherwise parallel
        (Jacobi)
    """

    archive_suffix: str
    force_lag_steps: float
    force_lag_reason: str
    is_sequential: bool = False


MASTER_KINDS = (
    MasterKind(
        "",
        1.0,
        "For masters that step all components side by side (Jacobi: fmpy, ecos, libcosim): the force of a "
        "joint reaches a body one step late, and a lag of 1 carries it on to the present.",
    ),
    MasterKind(
        "_in_turn",
        0.0,
        "For masters that update components in turn (Gauss-Seidel: OMSimulator): the force of a joint "
        "reaches a body at once, so the lag is 0; a lag of 1 would carry a present force on.",
        is_sequential=True,
    ),
)
"""Kinds of co-simulation masters for which archives are made."""


def format_system_structure(
    system: System, fmu_names_by_component: Mapping[str, str], ssp_version: str, master_kind: MasterKind
) -> bytes:
    """Content of SystemStructure.ssd; parameter sets are in `parameters/`, FMUs in `resources/`.

    fmu_names_by_component : {component: name of its FMU}
    """
    spaces = {"xmlns:ssd": f"{SSP_NAMESPACE}Description", "xmlns:ssc": f"{SSP_NAMESPACE}Common"}
    head = {**spaces, "version": ssp_version, "name": system.name, **make_ssp_attributes()}
    root = Element("ssd:SystemStructureDescription", head)
    description = f"{system.description}. {master_kind.force_lag_reason}"
    if system.arm:
        description += f" {UNCOUPLED_AXES_NOTE}"
    root.set("description", description)
    system_node = SubElement(root, "ssd:System", name=system.name, description=description)
    _add_parameter_binding(system_node, system.name)
    elements = SubElement(system_node, "ssd:Elements")
    signals = find_signals(system)
    units = set()
    for component in system.components.values():
        model = find_model(component)
        source = f"resources/{fmu_names_by_component[component.name]}.fmu"
        node = SubElement(elements, "ssd:Component", name=component.name, source=source, type=_FMU_MIME_TYPE)
        if component.parameter_file:
            node.set("description", component.parameter_file.name)
        if ssp_version == "2.0":
            node.set("implementation", "CoSimulation")
        connectors = SubElement(node, "ssd:Connectors")
        outputs = {(wire.source_component, wire.source_output) for wire in signals}
        inputs = {(wire.target_component, wire.target_input) for wire in signals}
        for kind, variables, used in (("input", model.inputs, inputs), ("output", model.outputs, outputs)):
            for v in (v for v in variables if (component.name, v.name) in used):
                connector = SubElement(connectors, "ssd:Connector", name=v.name, kind=kind, description=v.doc)
                SubElement(connector, f"ssc:{REAL_NUMBER_ELEMENT_NAMES[ssp_version]}", unit=v.unit)
                units.add(v.unit)
        _add_parameter_binding(node, component.name)
    connections = SubElement(system_node, "ssd:Connections")
    for wire in signals:
        ends = zip(("startElement", "startConnector", "endElement", "endConnector"), wire, strict=True)
        SubElement(connections, "ssd:Connection", dict(ends))
    if master_kind.is_sequential:
        _add_omsimulator_annotation(system_node, system.output_interval)
    add_unit_definitions(root, "ssd", units)
    SubElement(root, "ssd:DefaultExperiment", startTime="0", stopTime=repr(system.stop_time))
    return serialize_xml(root)


def make_ssp_attributes() -> dict[str, str]:
    """XML attributes of an SSP file: author, copyright, licence, generation tool, date if fixed."""
    attributes = {
        "author": "the jointfmu authors",
        "copyright": find_copyright_line(),
        "license": "MIT",
        "generationTool": f"jointfmu {__version__}",
    }
    if when := read_source_date():
        attributes["generationDateAndTime"] = when.strftime("%Y-%m-%dT%H:%M:%SZ")
    return attributes


def _add_parameter_binding(xml_element: Element, parameter_set_name: str) -> None:
    """Add to the XML element of a system or component that it takes its values from `parameters/NAME.ssv`."""
    bindings = SubElement(xml_element, "ssd:ParameterBindings")
    SubElement(bindings, "ssd:ParameterBinding", source=f"parameters/{parameter_set_name}.ssv")


def _add_omsimulator_annotation(system_element: Element, communication_step: float) -> None:
    """Add the annotation by which OMSimulator selects co-simulation with a fixed step [s]."""
    annotations = SubElement(system_element, "ssd:Annotations")
    annotation = SubElement(annotations, "ssc:Annotation", type="org.openmodelica")
    oms_node = SubElement(annotation, "oms:Annotations", {"xmlns:oms": _OMS_NAMESPACE})
    information = SubElement(oms_node, "oms:SimulationInformation")
    SubElement(information, "oms:FixedStepMaster", description="oms-ma", stepSize=repr(communication_step))


ARCHIVE_FOLDERS = {"1.0": ("ssp", "fmi2"), "2.0": ("ssp2", "fmi3")}
"""{version of SSP: (folder of the archives, folder of their FMUs)}."""


def build_system_archives(
    out_folder: Path,
    chosen_systems: Sequence[System] | None = None,
    parameter_file: ParameterFile | None = None,
    build_joints: bool = True,
    variability: str = PARAMETER_VARIABILITIES[0],
    process_pool: Executor | None = None,
    overwrite: bool = False,
) -> list[Path]:
    """Write the archives of systems, and their component FMUs to `out/fmi2/NAME.fmu` and `out/fmi3/NAME.fmu`.

    chosen_systems : systems to build; None: all shipped systems
    parameter_file : parameter file of a joint that replaces those of the systems; then only systems with this
        kind of joint are built
    build_joints   : whether to build the FMUs of the joints too; False: they exist already in `out_folder`
    variability    : FMI variability of all parameters, one of PARAMETER_VARIABILITIES
    process_pool   : processes that build in parallel; None: build in this process
    overwrite      : also replace files that jointfmu did not write

    Raises ValueError for invalid connections, an unwritable folder, or if no system has this kind of joint;
    and all errors of `build_native_fmu`.
    """
    chosen = list(load_systems().values()) if chosen_systems is None else list(chosen_systems)
    if parameter_file:
        kinds = {kind for system in chosen for kind in system.shared_joint_kinds}
        if parameter_file.joint not in kinds:
            allowed = ", ".join(sorted(kinds))
            raise ValueError(f"no system has a joint {parameter_file.joint!r}, allowed are {allowed}")
        chosen = [
            system.with_joint_parameter_file(parameter_file)
            for system in chosen
            if parameter_file.joint in system.shared_joint_kinds
        ]
    components: dict[str, Component] = {}
    for system in chosen:
        find_signals(system)
        for name, fmu in find_fmu_names(system).items():
            components.setdefault(fmu, system.components[name])
    built_components = {
        fmu: component
        for fmu, component in components.items()
        if build_joints or component.has_own_fmu or not component.parameter_file
    }
    fmus_out = [
        out_folder / f"fmi{version}" / f"{fmu}.fmu" for version in FMI_VERSIONS for fmu in built_components
    ]
    archive_paths = [
        _make_archive_path(system, out_folder, *kind)
        for system in chosen
        for kind in product(ARCHIVE_FOLDERS, MASTER_KINDS)
    ]
    check_outputs([*fmus_out, *archive_paths], ARCHIVE_FILE, overwrite)
    if parameter_file is None and not overwrite:
        for fmu, component in built_components.items():
            if component.base_parameter_file and not component.has_own_fmu:
                for version in FMI_VERSIONS:
                    _check_existing_fmu_parameters(
                        out_folder / f"fmi{version}" / f"{fmu}.fmu", component.base_parameter_file
                    )
    build_versions = partial(_build_component_fmus, out_folder, variability)
    fmu_paths = map_jobs(
        process_pool,
        build_versions,
        "build FMUs of systems",
        [*built_components],
        [*built_components.values()],
    )
    fmus = [path for paths in zip(*fmu_paths, strict=True) for path in paths]
    return fmus + [path for system in chosen for path in write_system_archives(system, out_folder)]


def _check_existing_fmu_parameters(fmu_path: Path, parameter_file: ParameterFile) -> None:
    """Raise InputRefusal if an FMU exists and its parameters differ from the parameter file."""
    if not fmu_path.exists():
        return
    with archives.open_archive(fmu_path) as archive:
        folder = f"{REFERENCE_FILE_FOLDER}/parameters/"
        names = [name for name in archive.namelist() if name.startswith(folder) and name.endswith(".toml")]
        texts = [archives.read_member(archive, name).decode() for name in names]
    stated = [text for text in texts if "joint" in tomllib.loads(text)]
    if stated and any(
        _list_parameter_values(text) != _list_parameter_values(format_parameter_file(parameter_file))
        for text in stated
    ):
        raise InputRefusal(
            f"{fmu_path}: was built from other parameters, and the systems need it with "
            f"{parameter_file.name!r}; state another folder with --out, pack your parameters with --params, "
            "or force to replace it",
            "force",
        )


def _list_parameter_values(parameter_file_text: str) -> dict[str, Any]:
    """{structured name: value} of the text of a parameter file, without start values of inputs."""
    found: dict[str, Any] = {}

    def add_entries(file_section: Mapping[str, Any], name_prefix: str) -> None:
        """Add the values of a section of the parameter file to `found`, with names of all its sections."""
        for name, entry in file_section.items():
            if isinstance(entry, dict) and "value" in entry:
                found[name_prefix + name] = entry["value"]
            elif isinstance(entry, dict):
                add_entries(entry, f"{name_prefix}{name}.")

    document = tomllib.loads(parameter_file_text)
    add_entries({name: entry for name, entry in document.items() if name != "inputs"}, "")
    return found | {"law": document.get("law")}


def _build_component_fmus(
    out_folder: Path, variability: str, fmu_name: str, component: Component
) -> list[Path]:
    """Build the FMU of a system's component for all FMI versions, which share the compiled model.

    Returns the paths of the FMUs.
    """
    file = (
        component.parameter_file if component.has_own_fmu else component.base_parameter_file
    ) or partner_parameters(component.model_name)
    alias = "" if fmu_name == component.model_name else fmu_name
    return [
        build_native_fmu(
            component.model_name, file, out_folder / f"fmi{version}", version, variability, alias
        )
        for version in FMI_VERSIONS
    ]


def write_system_archives(system: System, out_folder: Path) -> list[Path]:
    """Write archives of the system to `out/ssp` (SSP 1.0, FMI 2 FMUs) and `out/ssp2` (SSP 2.0, FMI 3 FMUs).

    Each folder gets one archive per kind of master, see MASTER_KINDS. The archives contain the FMUs and the
    parameters of the system.

    Raises ValueError for invalid connections or an unwritable folder.
    """
    return [
        _write_archive(system, out_folder, version, master)
        for version, master in product(ARCHIVE_FOLDERS, MASTER_KINDS)
    ]


def _make_archive_path(system: System, out_folder: Path, ssp_version: str, master_kind: MasterKind) -> Path:
    """Path of the archive of a system, for one SSP version and one kind of master."""
    return out_folder / ARCHIVE_FOLDERS[ssp_version][0] / f"{system.name}{master_kind.archive_suffix}.ssp"


def _write_archive(system: System, out_folder: Path, ssp_version: str, master_kind: MasterKind) -> Path:
    """Write the SSP archive of a system for an SSP version and a sequential or parallel master."""
    lag_parameters, names = find_lag_parameters(system), find_fmu_names(system)
    members = {"SystemStructure.ssd": format_system_structure(system, names, ssp_version, master_kind)}
    system_values: dict[str, ParameterValue] = {}
    for name, component in system.components.items():
        lag_values = {
            lag: ParameterValue(master_kind.force_lag_steps, "1", master_kind.force_lag_reason)
            for lag in lag_parameters.get(name, ())
        }
        component_values = list_archive_values(component) | lag_values
        system_values |= {f"{name}.{variable}": value for variable, value in component_values.items()}
        members[f"resources/{names[name]}.fmu"] = (
            out_folder / ARCHIVE_FOLDERS[ssp_version][1] / f"{names[name]}.fmu"
        ).read_bytes()
        members[f"parameters/{name}.ssv"] = format_ssv_parameter_set(
            system.name, component_values, ssp_version, make_ssp_attributes()
        )
    members[f"parameters/{system.name}.ssv"] = format_ssv_parameter_set(
        system.name, system_values, ssp_version, make_ssp_attributes()
    )
    target = _make_archive_path(system, out_folder, ssp_version, master_kind)
    with staging_folder(target) as work:
        write_archive(members, work / target.name)
    return target


def list_archive_values(component: Component) -> dict[str, ParameterValue]:
    """Values {variable: value} that an archive sets in a component's FMU.

    The values are those of the parameter file of its joint and of the system file.

    Booleans of the parameter file are omitted: they are start values of the FMU, and fmpy reads every Boolean
    of a parameter set as true.
    """
    joint_values: dict[str, ParameterValue] = {}
    if component.parameter_file:
        for name, item in find_model(component).parameter_fields().items():
            value = component.parameter_file.values_by_name[name]
            if not isinstance(value, bool):
                joint_values[name] = ParameterValue(
                    value, item.metadata.get("unit", ""), component.parameter_file.sources.get(name, "")
                )
    return joint_values | {
        name: ParameterValue(value, component.stated_units[name], component.value_sources[name])
        for name, value in component.stated_values.items()
        if name in component.parameters or name in component.constant_inputs
    }


def find_fmu_names(system: System) -> dict[str, str]:
    """{component: name of its FMU}.

    The FMU has the name of its model. An FMU that is built for this system has the name of the system, an
    underscore and the name of the component. Components with equal fixed values share the FMU of the first.
    """
    names: dict[str, str] = {}
    variants: list[tuple[str, Mapping[str, Any], str]] = []
    for name, component in system.components.items():
        if not (component.parameter_file and component.has_own_fmu):
            names[name] = component.model_name
            continue
        exposed = find_model(component).parameter_fields()
        fixed_values = {
            key: value
            for key, value in component.parameter_file.values_by_name.items()
            if key not in exposed or isinstance(value, bool)
        } | {"law": component.parameter_file.law}
        equal_fmus = [
            fmu for model, values, fmu in variants if (model, values) == (component.model_name, fixed_values)
        ]
        names[name] = equal_fmus[0] if equal_fmus else f"{system.name}_{name}"
        if not equal_fmus:
            variants.append((component.model_name, fixed_values, names[name]))
    return names
