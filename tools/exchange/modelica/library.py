"""Generation of all files of the Modelica library from templates, tables, variables and numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import comb
from pathlib import Path
from types import ModuleType

from jinja2 import Environment
from jointfmu_fmu_src.folders import find_asset
from jointfmu_fmu_src.partners.laws import CONTROL_POINT_COUNT
from jointfmu_fmu_src.templates import PAGE_FOLDER, law_variables, load_template

from jointfmu.files.outputs import EXCHANGE_FILE, PROGRAM_MARK, check_output
from jointfmu.files.writing import write_files
from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import flatten_fields
from jointfmu.quantity.smooth import SMOOTH_STEP_COEFFICIENTS
from jointfmu.version import __version__

from ...common.joint_parts import load_tool_module
from ...systems.system import System, load_systems
from .blocks import interface_template_variables, wrapper_template_variables
from .records import (
    TABLE_TOLERANCE,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    escape_string,
    template_environment,
)
from .systems import model_name, render_system_model

LIBRARY_NAME = "JointStiffness"
"""Name of the Modelica library."""
_NON_JOINT_COMPONENTS = ("LinkWeight", "Load", "AngleProfile", "TorqueCurve")
"""Components of systems that are no joints: loads, profiles, weight."""
_MODELICA_FUNCTION_NAMES = (
    "load",
    "stiffness",
    "bend",
    "linear",
    "segment",
    "limited",
    "slide",
    "frictionLimit",
    "smoothStep",
    "loadDerivative",
    "stiffnessDerivative",
)
"""Names of the Modelica functions of the library, shared by its components."""
WorkingPoints = Mapping[str, Sequence[WorkingPoint]]
"""Working points of the records: {joint: working points}."""


@dataclass(frozen=True, slots=True)
class _LibraryJoint:
    """Joint of the Modelica library: its component, records and templates.

    file      : parameter file
    component : Modelica component that the joint defines
    records   : {working point: record}
    templates : templates of the joint
    """

    joint_kind: JointKind
    file: ParameterFile
    component: ModelicaComponent
    records: Mapping[WorkingPoint, ModelicaRecord]
    templates: Environment

    @property
    def record(self) -> ModelicaRecord:
        """Default record of the component."""
        return next(iter(self.records.values()))


def write_library(
    folder: Path,
    parameter_file: ParameterFile | None = None,
    working_points: WorkingPoints | None = None,
    *,
    overwrite: bool = False,
) -> list[Path]:
    """Write the library into a folder; returns the paths of its files.

    parameter_file : parameter file of one joint, in place of its default file
    working_points : {joint: working points}, in place of the default working points
    overwrite      : replace a library of this name that jointfmu did not write
    """
    check_output(folder / LIBRARY_NAME / "package.mo", EXCHANGE_FILE, overwrite)
    return write_files(folder / LIBRARY_NAME, render_library(parameter_file, working_points))


def render_library(
    parameter_file: ParameterFile | None = None, working_points: WorkingPoints | None = None
) -> dict[str, str]:
    """Render all files of the library: {path in the library: text}."""
    joints = [
        _collect_joint(kind, module, parameter_file, (working_points or {}).get(kind.name))
        for kind in KINDS.values()
        if (module := load_tool_module(kind, "modelica"))
    ]
    shared = template_environment()
    block, model = (shared.get_template(name) for name in ("Interfaces/block.mo", "Wrappers/wrapper.mo"))
    packages = {
        "Examples": _render_examples(joints, shared),
        "Components": _render_components(joints)
        | _render_joint_independent_classes(
            shared, "Components", _NON_JOINT_COMPONENTS, points=CONTROL_POINT_COUNT, comb=comb
        ),
        "Wrappers": {name: model.render(wrapper_template_variables(fmu)) for name, fmu in MODELS.items()},
        "Interfaces": {name: block.render(interface_template_variables(fmu)) for name, fmu in MODELS.items()},
        "Data": _render_records(joints),
        "Functions": _render_joint_independent_classes(
            shared, "Functions", _MODELICA_FUNCTION_NAMES, step=[round(a) for a in SMOOTH_STEP_COEFFICIENTS]
        ),
    }
    notes = [escape_string(joint.component.package_note) for joint in joints if joint.component.package_note]
    common = {"version": __version__, "notes": notes, "example": next(iter(MODELS))}
    out = {
        "package.mo": shared.get_template("package.mo").render(common, tolerance=f"{TABLE_TOLERANCE:g}"),
        "package.order": _render_package_order(packages),
    }
    for package, classes in packages.items():
        out[f"{package}/package.mo"] = shared.get_template(f"{package}/package.mo").render(common)
        out[f"{package}/package.order"] = _render_package_order(classes)
        out |= {f"{package}/{name}.mo": content for name, content in classes.items()}
    return dict(sorted(out.items()))


def _collect_joint(
    joint_kind: JointKind,
    modelica_module: ModuleType,
    parameter_file: ParameterFile | None,
    working_points: Sequence[WorkingPoint] | None,
) -> _LibraryJoint:
    """Collect what the library contains of a joint: parameters, component, records and templates."""
    component: ModelicaComponent = modelica_module.MODELICA_COMPONENT
    is_given = parameter_file is not None and parameter_file.joint == joint_kind.name
    joint_file = parameter_file if parameter_file and is_given else load_default(joint_kind.name)
    used_points = tuple(working_points or (*_read_start_working_point(joint_file), *component.working_points))
    found: Sequence[ModelicaRecord]
    if is_given:
        found = component.make_records(joint_file, used_points)
    else:
        found = _default_records(joint_kind.name, modelica_module, used_points)
    records = dict(zip(used_points, found, strict=True))
    return _LibraryJoint(
        joint_kind,
        joint_file,
        component,
        records,
        template_environment(Path(str(modelica_module.__file__)).parent),
    )


@cache
def _default_records(
    joint: str, module: ModuleType, working_points: tuple[WorkingPoint, ...]
) -> tuple[ModelicaRecord, ...]:
    """Records of a joint with its default parameters.

    A library that is written for a user's joint contains these records, too.
    """
    component: ModelicaComponent = module.MODELICA_COMPONENT
    return tuple(component.make_records(load_default(joint), working_points))


def _read_start_working_point(parameter_file: ParameterFile) -> list[WorkingPoint]:
    """Working point given by the start values of the inputs in a parameter file, as a list of one or none."""
    point = tuple(parameter_file.start_value(name) for name in KINDS[parameter_file.joint].working_point)
    return [point] if point and point[0] > 0.0 else []


def _render_package_order(member_names: Mapping[str, object]) -> str:
    """Render the file package.order, which lists the members of a package."""
    return "\n".join(member_names) + "\n"


def _render_joint_independent_classes(
    shared_templates: Environment, package: str, class_names: Sequence[str], **terms: object
) -> dict[str, str]:
    """Render classes that do not depend on a joint: {class: text}."""
    return {name: shared_templates.get_template(f"{package}/{name}.mo").render(terms) for name in class_names}


def _render_components(joints: Sequence[_LibraryJoint]) -> dict[str, str]:
    """Render the Modelica components of all joints: {class: text}."""
    classes = {}
    for joint in joints:
        name, model = joint.component.name, MODELS[joint.component.name]
        classes[name] = joint.templates.get_template(f"Components/{name}.mo").render(
            joint.component.make_template_texts(joint.record),
            meta=_parameter_meanings(joint.joint_kind),
            docs={v.name: v.doc for v in (*model.inputs, *model.outputs)},
            html=_render_documentation(model, joint.file),
            record=joint.record.name,
        )
    return classes


def _render_records(joints: Sequence[_LibraryJoint]) -> dict[str, str]:
    """Render the base records and the records with tables: {record: text}, base records first.

    Raises ValueError if a record has the name of a base record.
    """
    bases, tables = {}, {}
    for joint in joints:
        base = joint.component.base_record
        extended = joint.templates.get_template(f"Data/{base}.mo")
        bases[base] = extended.render(meta=_parameter_meanings(joint.joint_kind))
        filled = joint.templates.get_template("Data/record.mo")
        for record in joint.records.values():
            if record.name in {other.component.base_record for other in joints}:
                raise ValueError(
                    f"name = {joint.file.name!r}: the library has a class {record.name}; "
                    "expected another name"
                )
            tables[record.name] = filled.render(record.template_variables(base), version=__version__)
    return bases | tables


def _render_examples(joints: Sequence[_LibraryJoint], shared_templates: Environment) -> dict[str, str]:
    """Render the shipped systems: {class: text}."""
    by_kind = {joint.joint_kind.name: joint for joint in joints}
    classes = {}
    for system in load_systems().values():
        for joint in joints:
            system = system.with_joint(joint.file)
        classes[model_name(system)] = render_system_model(
            system, shared_templates, partial(_find_record, by_kind), f"{LIBRARY_NAME}.Examples"
        )
    return classes


def render_system(system: System) -> str:
    """Render a system as a stand-alone model that uses the components of the library."""
    model = render_system_model(system, template_environment(), lambda kind, file, point: None)
    return f"// {PROGRAM_MARK}\n{model}"


def _find_record(
    joints: Mapping[str, _LibraryJoint],
    joint_kind: str,
    parameter_file: ParameterFile,
    working_point: WorkingPoint,
) -> ModelicaRecord | None:
    """Find the record of the library with a joint's parameters at a working point; None if there is none."""
    joint = joints[joint_kind]
    special = joint.component.component_only_parameters
    same = all(
        joint.file.values_by_name.get(name) == value
        for name, value in parameter_file.values_by_name.items()
        if name not in special
    )
    return joint.records.get(working_point, joint.record if not working_point else None) if same else None


def _parameter_meanings(joint_kind: JointKind) -> dict[str, str]:
    """Meanings of the parameters of all laws of a joint: {structured name: meaning}."""
    return {
        name: escape_string(item.metadata["doc"])
        for parameters in joint_kind.laws.values()
        for name, item in flatten_fields(parameters)
        if "doc" in item.metadata
    }


def _render_documentation(model: Model, parameter_file: ParameterFile) -> dict[str, str]:
    """Render sections of the FMU's documentation page for a Modelica annotation: {section: text}."""
    folder = Path(__file__).parent
    page = load_template(find_asset(model, "page.html"), folder, PAGE_FOLDER)
    names = ("what", "law", "trust", "paper")
    terms = {"model": model, "fmu": False, **law_variables(parameter_file)}
    return {name: escape_string(page.render(terms, part=name).strip()) for name in names}
