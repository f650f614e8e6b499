"""Generation of all files of the Modelica library from templates, tables, variables and numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import comb
from pathlib import Path
from types import ModuleType

from jinja2 import Environment
from jointfmu_fmu_src.folders import find_page_or_icon
from jointfmu_fmu_src.partners.laws import TORQUE_CURVE_CONTROL_POINT_COUNT
from jointfmu_fmu_src.templates import PAGE_TEMPLATE_FOLDER, load_jinja_template, make_law_template_variables

from jointfmu.files.outputs import EXPORTED_TEXT_FILE, PROGRAM_MARK, check_output
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
    MAX_RELATIVE_TABLE_ERROR,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    create_template_environment,
    escape_string,
)
from .systems import make_model_name, render_system_model

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
WorkingPointsByJoint = Mapping[str, Sequence[WorkingPoint]]
"""Working points of the records: {joint: working points}."""


@dataclass(frozen=True, slots=True)
class _LibraryJoint:
    """Joint of the Modelica library: its component, records and templates.

    parameter_file          : parameter file
    modelica_component      : Modelica component that the joint defines
    record_by_working_point : {working point: record}
    joint_templates         : templates of the joint
    """

    joint_kind: JointKind
    parameter_file: ParameterFile
    modelica_component: ModelicaComponent
    record_by_working_point: Mapping[WorkingPoint, ModelicaRecord]
    joint_templates: Environment

    @property
    def default_record(self) -> ModelicaRecord:
        """Default record of the component."""
        return next(iter(self.record_by_working_point.values()))


def write_library(
    parent_folder: Path,
    parameter_file: ParameterFile | None = None,
    working_points: WorkingPointsByJoint | None = None,
    *,
    overwrite: bool = False,
) -> list[Path]:
    """Write the library into a folder; returns the paths of its files.

    parameter_file : parameter file of one joint, in place of its default file
    working_points : {joint: working points}, in place of the default working points
    overwrite      : replace a library of this name that jointfmu did not write
    """
    check_output(parent_folder / LIBRARY_NAME / "package.mo", EXPORTED_TEXT_FILE, overwrite)
    return write_files(parent_folder / LIBRARY_NAME, render_library(parameter_file, working_points))


def render_library(
    parameter_file: ParameterFile | None = None, working_points: WorkingPointsByJoint | None = None
) -> dict[str, str]:
    """Render all files of the library: {path in the library: text}."""
    joints = [
        _collect_library_joint(kind, module, parameter_file, (working_points or {}).get(kind.name))
        for kind in KINDS.values()
        if (module := load_tool_module(kind, "modelica"))
    ]
    shared = create_template_environment()
    block, model = (shared.get_template(name) for name in ("Interfaces/block.mo", "Wrappers/wrapper.mo"))
    packages = {
        "Examples": _render_examples(joints, shared),
        "Components": _render_components(joints)
        | _render_joint_independent_classes(
            shared, "Components", _NON_JOINT_COMPONENTS, points=TORQUE_CURVE_CONTROL_POINT_COUNT, comb=comb
        ),
        "Wrappers": {name: model.render(wrapper_template_variables(fmu)) for name, fmu in MODELS.items()},
        "Interfaces": {name: block.render(interface_template_variables(fmu)) for name, fmu in MODELS.items()},
        "Data": _render_records(joints),
        "Functions": _render_joint_independent_classes(
            shared, "Functions", _MODELICA_FUNCTION_NAMES, step=[round(a) for a in SMOOTH_STEP_COEFFICIENTS]
        ),
    }
    notes = [
        escape_string(joint.modelica_component.package_note)
        for joint in joints
        if joint.modelica_component.package_note
    ]
    common = {"version": __version__, "notes": notes, "example": next(iter(MODELS))}
    out = {
        "package.mo": shared.get_template("package.mo").render(
            common, tolerance=f"{MAX_RELATIVE_TABLE_ERROR:g}"
        ),
        "package.order": _render_package_order(packages),
    }
    for package, classes in packages.items():
        out[f"{package}/package.mo"] = shared.get_template(f"{package}/package.mo").render(common)
        out[f"{package}/package.order"] = _render_package_order(classes)
        out |= {f"{package}/{name}.mo": content for name, content in classes.items()}
    return dict(sorted(out.items()))


def _collect_library_joint(
    joint_kind: JointKind,
    modelica_module: ModuleType,
    parameter_file: ParameterFile | None,
    working_points: Sequence[WorkingPoint] | None,
) -> _LibraryJoint:
    """Collect what the library contains of a joint: parameters, component, records and templates."""
    component: ModelicaComponent = modelica_module.MODELICA_COMPONENT
    is_given = parameter_file is not None and parameter_file.joint == joint_kind.name
    joint_file = parameter_file if parameter_file and is_given else load_default(joint_kind.name)
    used_points = tuple(
        working_points or (*_read_start_working_point(joint_file), *component.default_working_points)
    )
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
        create_template_environment(Path(str(modelica_module.__file__)).parent),
    )


@cache
def _default_records(
    joint_name: str, modelica_module: ModuleType, working_points: tuple[WorkingPoint, ...]
) -> tuple[ModelicaRecord, ...]:
    """Modelica records of a joint with its default parameters.

    A library that is written for a user's joint contains these records, too.
    """
    component: ModelicaComponent = modelica_module.MODELICA_COMPONENT
    return tuple(component.make_records(load_default(joint_name), working_points))


def _read_start_working_point(parameter_file: ParameterFile) -> list[WorkingPoint]:
    """Load and temperature of a record: start values of a parameter file, as a list of one tuple or none."""
    point = tuple(parameter_file.start_value(name) for name in KINDS[parameter_file.joint].working_point)
    return [point] if point and point[0] > 0.0 else []


def _render_package_order(member_names: Mapping[str, object]) -> str:
    """Render the file package.order, which lists the members of a package."""
    return "\n".join(member_names) + "\n"


def _render_joint_independent_classes(
    shared_templates: Environment, package_name: str, class_names: Sequence[str], **terms: object
) -> dict[str, str]:
    """Render classes that do not depend on a joint: {class: text}."""
    return {
        name: shared_templates.get_template(f"{package_name}/{name}.mo").render(terms) for name in class_names
    }


def _render_components(library_joints: Sequence[_LibraryJoint]) -> dict[str, str]:
    """Render the Modelica components of all joints: {class: text}."""
    classes = {}
    for joint in library_joints:
        name, model = joint.modelica_component.component_name, MODELS[joint.modelica_component.component_name]
        classes[name] = joint.joint_templates.get_template(f"Components/{name}.mo").render(
            joint.modelica_component.make_template_texts(joint.default_record),
            meta=_parameter_meanings(joint.joint_kind),
            docs={v.name: v.doc for v in (*model.inputs, *model.outputs)},
            html=_render_documentation(model, joint.parameter_file),
            record=joint.default_record.record_name,
        )
    return classes


def _render_records(library_joints: Sequence[_LibraryJoint]) -> dict[str, str]:
    """Render the base records and the records with tables: {record: text}, base records first.

    Raises ValueError if a record has the name of a base record.
    """
    bases, tables = {}, {}
    for joint in library_joints:
        base = joint.modelica_component.base_record
        extended = joint.joint_templates.get_template(f"Data/{base}.mo")
        bases[base] = extended.render(meta=_parameter_meanings(joint.joint_kind))
        filled = joint.joint_templates.get_template("Data/record.mo")
        for record in joint.record_by_working_point.values():
            if record.record_name in {other.modelica_component.base_record for other in library_joints}:
                raise ValueError(
                    f"name = {joint.parameter_file.name!r} of the parameter file: the library has a class "
                    f"{record.record_name}; expected another name"
                )
            tables[record.record_name] = filled.render(record.template_variables(base), version=__version__)
    return bases | tables


def _render_examples(
    library_joints: Sequence[_LibraryJoint], shared_templates: Environment
) -> dict[str, str]:
    """Render the systems shipped with jointfmu as Modelica example models: {class name: Modelica text}."""
    by_kind = {joint.joint_kind.name: joint for joint in library_joints}
    classes = {}
    for system in load_systems().values():
        for joint in library_joints:
            system = system.with_joint_parameter_file(joint.parameter_file)
        classes[make_model_name(system)] = render_system_model(
            system, shared_templates, partial(_find_library_record, by_kind), f"{LIBRARY_NAME}.Examples"
        )
    return classes


def render_system(system: System) -> str:
    """Render a system as a stand-alone model that uses the components of the library."""
    model = render_system_model(system, create_template_environment(), lambda kind, file, point: None)
    return f"// {PROGRAM_MARK}\n{model}"


def _find_library_record(
    library_joints: Mapping[str, _LibraryJoint],
    joint_kind: str,
    parameter_file: ParameterFile,
    working_point: WorkingPoint,
) -> ModelicaRecord | None:
    """Find the record of the library with a joint's parameters at a working point; None if there is none."""
    joint = library_joints[joint_kind]
    special = joint.modelica_component.component_only_parameters
    same = all(
        joint.parameter_file.values_by_name.get(name) == value
        for name, value in parameter_file.values_by_name.items()
        if name not in special
    )
    return (
        joint.record_by_working_point.get(working_point, joint.default_record if not working_point else None)
        if same
        else None
    )


def _parameter_meanings(joint_kind: JointKind) -> dict[str, str]:
    """Meanings of the parameters of all laws of a joint: {structured name: meaning}."""
    return {
        name: escape_string(item.metadata["doc"])
        for parameters in joint_kind.laws.values()
        for name, item in flatten_fields(parameters)
        if "doc" in item.metadata
    }


def _render_documentation(fmu_model: Model, parameter_file: ParameterFile) -> dict[str, str]:
    """Render sections of the FMU's documentation page for a Modelica annotation: {section: text}."""
    folder = Path(__file__).parent
    page = load_jinja_template(find_page_or_icon(fmu_model, "page.html"), folder, PAGE_TEMPLATE_FOLDER)
    names = ("what", "law", "trust", "paper")
    terms = {"model": fmu_model, "fmu": False, **make_law_template_variables(parameter_file)}
    return {name: escape_string(page.render(terms, part=name).strip()) for name in names}
