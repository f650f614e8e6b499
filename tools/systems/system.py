"""System files (TOML): components and their connections, read by all tools for systems.

A file has `schema = 1`, `name = ...`, `description = ...`, and a section for each component:

    [drive]
    model = "HarmonicDriveSpring"
    parameters = "my_drive.toml"
    hysteresis_loss = { value = 2.9e-4, unit = "rad", kind = "catalogue", source = "1 arcmin" }

`model` is the FMU of the component. A joint has the parameter file in `parameters`, or the item of the
catalogue named in `catalogue`, or its default parameter file. Further entries are values of parameters, and
of inputs of a joint that the system keeps constant. `connect` is a list of pairs: a load and a flange on
which it acts, two flanges, or a flange of a joint and "ground". The section `[experiment]` has `stop_time`
and `interval`. A section `[arm]` defines the components of a serial arm, see `arm`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jointfmu_fmu_src.naming import FMU_NAME_RULE, is_valid_fmu_name
from jointfmu_fmu_src.partners import PARTNERS

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.kind import FlangeRating
from jointfmu.parameters import ParameterFile, load_default, read_document, read_entries
from jointfmu.quantity import find_problem, flatten_fields, quantity_field

from .arm import read_arm
from .system_joint import PARAMETER_FILE_KEYS, load_joint_file

GROUND = "ground"
"""Name of the ground in connections; it fixes a flange of a joint."""
_EXPERIMENT_ENTRIES = {
    "stop_time": quantity_field("s", "end time of the simulation", gt=0.0),
    "interval": quantity_field("s", "time between two points of the result", gt=0.0),
}
"""Entries of the section [experiment], as dataclass fields."""
_NON_COMPONENT_KEYS = ("schema", "name", "description", "connect", "experiment", "arm")
"""Top-level keys of a system file that are no components."""


@dataclass(frozen=True, slots=True)
class Component:
    """Component of a system: joint, body or load.

    model_name          : name of its model, of a joint or of a partner (body or load)
    base_parameter_file : parameter file of a joint, without values of the system; None: a partner
    parameter_file      : parameter file of a joint, with values of the system; None: a partner
    has_own_fmu         : whether the system needs its own FMU of the joint: it names a parameter file or a
        catalogue item, or sets a parameter that is not an FMU variable
    stated_values       : {parameter or input: SI value} given in the system file
    stated_units        : {parameter or input: SI unit} of these values
    value_sources       : {parameter or input: source} of these values, as text
    """

    name: str
    model_name: str
    base_parameter_file: ParameterFile | None
    parameter_file: ParameterFile | None
    has_own_fmu: bool
    stated_values: Mapping[str, Any]
    stated_units: Mapping[str, str]
    value_sources: Mapping[str, str]

    @property
    def joint_kind(self) -> str:
        """Name of the kind of joint; empty for a partner (body or load)."""
        return self.parameter_file.joint if self.parameter_file else ""

    @property
    def constant_inputs(self) -> dict[str, float]:
        """{input of a joint: value} that the system keeps constant."""
        inputs = {v.name for v in MODELS[self.model_name].inputs} if self.parameter_file else set()
        return {name: value for name, value in self.stated_values.items() if name in inputs}

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of the component's FMU that the system file states: {parameter: value}."""
        constant_inputs, fields = (
            self.constant_inputs,
            _find_variable_fields(self.model_name, self.parameter_file),
        )
        return {
            name: value
            for name, value in self.stated_values.items()
            if name not in constant_inputs and name in fields
        }


@dataclass(frozen=True, slots=True)
class System:
    """System of joints, bodies and loads, as read from a system file.

    name                       : identifier, the stem of the file
    title                      : name given in the file
    components                 : {name: component}
    connections                : pairs of ends: `COMPONENT.FLANGE`, the name of a load, or GROUND
    stop_time, output_interval : end and output interval of the experiment [s]
    arm                        : serial arm with its motion; None: the system is no arm
    experiment_sources         : {entry of the experiment: source}
    """

    name: str
    title: str
    description: str
    components: Mapping[str, Component]
    connections: Sequence[tuple[str, str]]
    stop_time: float
    output_interval: float
    arm: Any = None
    experiment_sources: Mapping[str, str] = field(default_factory=dict)

    @property
    def shared_joint_kinds(self) -> set[str]:
        """Kinds of the joints that use the FMU of their model with its default parameters."""
        return {joint.joint_kind for joint in self.joints.values() if not joint.has_own_fmu}

    @property
    def joints(self) -> dict[str, Component]:
        """Joints of the system: {name: component}."""
        return {name: component for name, component in self.components.items() if component.parameter_file}

    @property
    def stated_values(self) -> dict[str, Any]:
        """Values of all parameters and inputs that the system file states: {COMPONENT.NAME: SI value}."""
        return {
            f"{component.name}.{name}": value
            for component in self.components.values()
            for name, value in component.stated_values.items()
        }

    def with_joint_parameter_file(self, parameter_file: ParameterFile) -> "System":
        """Copy of the system with another parameter file for all joints of its kind without their own FMU.

        The bodies and loads at their flanges are scaled to the new joint: it moves as the old one did.
        """
        components = dict(self.components)
        for name, joint in self.joints.items():
            if joint.joint_kind == parameter_file.joint and not joint.has_own_fmu:
                changes = {
                    key: value
                    for key, value in joint.stated_values.items()
                    if key not in joint.constant_inputs
                }
                changed_file = parameter_file.with_values(changes, "user", f"system {self.name}")
                components[name] = replace(
                    joint, base_parameter_file=parameter_file, parameter_file=changed_file
                )
                find_ratings = KINDS[parameter_file.joint].find_flange_ratings
                assert joint.base_parameter_file
                before, after = (
                    find_ratings(joint.base_parameter_file.values),
                    find_ratings(parameter_file.values),
                )
                for flange in before:
                    for partner in self._list_bodies_and_loads_at(f"{name}.{flange}"):
                        components[partner] = _scale_body_or_load(
                            components[partner], before[flange], after[flange], parameter_file.name
                        )
        return replace(self, components=components)

    def _list_bodies_and_loads_at(self, flange: str) -> list[str]:
        """Names of the partners (bodies and loads) that are connected to a flange of a joint directly."""
        found: set[str] = set()
        new = {flange}
        while new:
            beside = {end for pair in self.connections if new & {*pair} for end in pair}
            names = {end.partition(".")[0] for end in beside} & self.components.keys() - self.joints.keys()
            new = {end for pair in self.connections for end in pair if end.partition(".")[0] in names - found}
            found |= names
        return sorted(found)


def _scale_body_or_load(
    body_or_load: Component, old_joint_rating: FlangeRating, new_joint_rating: FlangeRating, joint_name: str
) -> Component:
    """Scale a partner (body or load) from the rated values of one joint to the rated values of another joint.

    Loads scale with the rated load, inertias with the rated load over the motion of the flange per motion of
    the output. The final value `ramp_height` of a load ramp also changes by the difference of the static
    friction of both joints.
    """
    load = new_joint_rating.rated_load / old_joint_rating.rated_load
    inertia = load * old_joint_rating.motion_over_output_motion / new_joint_rating.motion_over_output_motion
    if (load, inertia, new_joint_rating.static_friction_load) == (
        1.0,
        1.0,
        old_joint_rating.static_friction_load,
    ):
        return body_or_load
    values, sources = dict(body_or_load.stated_values), dict(body_or_load.value_sources)
    for name, unit in body_or_load.stated_units.items():
        if factor := {"N.m": load, "N": load, "kg.m2": inertia, "kg": inertia}.get(unit):
            values[name] = factor * values[name]
            if name == "ramp_height":
                values[name] += new_joint_rating.static_friction_load - old_joint_rating.static_friction_load
            sources[name] += f"; scaled to {joint_name}"
    return replace(body_or_load, stated_values=values, value_sources=sources)


def list_system_names() -> tuple[str, ...]:
    """Sorted names of the shipped systems."""
    paths = (files("jointfmu_models") / "systems").iterdir()
    return tuple(sorted(path.name.removesuffix(".toml") for path in paths if path.name.endswith(".toml")))


def load_systems() -> dict[str, System]:
    """Read all shipped systems: {name: system}."""
    return {name: load_system(name) for name in list_system_names()}


def load_system(name_or_path: str) -> System:
    """Read a system: a shipped one by name, or a file by path.

    Raises ValueError with one line that names the entry and what is allowed.
    """
    return (
        _load_shipped_system(name_or_path)
        if name_or_path in list_system_names()
        else read_system(find_system_file(name_or_path))
    )


def find_system_file(name_or_path: str) -> Path:
    """Path of a system file: of a shipped system by name, or the path itself; ValueError for other names."""
    if name_or_path in list_system_names():
        return Path(str(files("jointfmu_models") / "systems" / f"{name_or_path}.toml"))
    if not name_or_path.endswith(".toml"):
        raise ValueError(
            f"system {name_or_path!r}: allowed are {', '.join(list_system_names())}, or a file .toml"
        )
    return Path(name_or_path)


@cache
def _load_shipped_system(system_name: str) -> System:
    """Read a shipped system by its name; cached."""
    return read_system(find_system_file(system_name))


def read_system(system_path: Path) -> System:
    """Read and check a system file; connections are checked later, by `wiring.find_connections`.

    Raises ValueError with one line that names the file, the entry and what is allowed.
    """
    document = read_document(system_path, "a system's file")
    if not is_valid_fmu_name(system_path.stem):
        raise ValueError(
            f"{system_path}: the file name is the name of the system; allowed are {FMU_NAME_RULE}"
        )
    try:
        return _make_system(system_path, document)
    except ValueError as error:
        raise ValueError(f"{system_path}: {str(error).removeprefix(f'{system_path}: ')}") from None


def _make_system(system_path: Path, system_document: Mapping[str, Any]) -> System:
    """Make a system from the parsed TOML document of its file."""
    if "experiment" not in system_document:
        hint = f"; it is of a {system_document['joint']}" if "joint" in system_document else ""
        raise ValueError(f"has no section [experiment], expected a system's file{hint}")
    experiment, _, times = read_entries(system_path, _EXPERIMENT_ENTRIES, system_document["experiment"])
    for name, item in _EXPERIMENT_ENTRIES.items():
        if text := find_problem(name, experiment.get(name), item):
            raise ValueError(f"experiment.{text}")
    sections = {key: value for key, value in system_document.items() if key not in _NON_COMPONENT_KEYS}
    connections = _parse_connections(system_document.get("connect", []))
    arm = None
    if "arm" in system_document:
        arm, arm_sections, arm_connections = read_arm(system_path, system_document["arm"])
        sections, connections = arm_sections | sections, [*arm_connections, *connections]
    components = {key: _make_component(system_path, key, value) for key, value in sections.items()}
    for prefix in components:
        if longer := [name for name in components if name != prefix and name.startswith(prefix)]:
            raise ValueError(
                f"component {longer[0]!r} begins with the name {prefix!r}, which fmpy confuses; no name may "
                "begin with another name"
            )
    if not any(component.parameter_file for component in components.values()):
        raise ValueError(f"no component is a joint, allowed models are {', '.join(MODELS)}")
    return System(
        system_path.stem,
        str(system_document.get("name", system_path.stem)),
        str(system_document.get("description", "")),
        components,
        connections,
        float(experiment["stop_time"]),
        float(experiment["interval"]),
        arm,
        times,
    )


def _parse_connections(connect_entry: Any) -> list[tuple[str, str]]:
    """Check the value of `connect` in a system file, and convert it to pairs of ends."""
    pairs = []
    for pair in connect_entry if isinstance(connect_entry, list) else [connect_entry]:
        if not (isinstance(pair, list) and len(pair) == 2 and all(isinstance(end, str) for end in pair)):
            raise ValueError(f'connect = {pair!r}, expected pairs of ends ["load", "motor.flange_a"]')
        pairs.append((pair[0], pair[1]))
    return pairs


def _make_component(system_path: Path, component_name: str, component_section: Any) -> Component:
    """Make a component from its section of the system file."""
    models = [*MODELS, *PARTNERS]
    if not isinstance(component_section, Mapping):
        raise ValueError(
            f"{component_name} = {component_section!r}, expected a section [{component_name}] with its model"
        )
    if not is_valid_fmu_name(component_name) or component_name == GROUND:
        raise ValueError(f"component {component_name!r}: allowed are {FMU_NAME_RULE}, and not {GROUND!r}")
    model = component_section.get("model")
    if not isinstance(model, str) or model not in models:
        raise ValueError(f"{component_name}.model = {model!r}, allowed are {', '.join(models)}")
    body = {
        key: value for key, value in component_section.items() if key not in ("model", *PARAMETER_FILE_KEYS)
    }
    joint_parameters = None
    if model in PARTNERS:
        for key in PARAMETER_FILE_KEYS:
            if key in component_section:
                raise ValueError(
                    f"{component_name}.{key} = {component_section[key]!r}, but a {model} takes no {key}; "
                    "state its parameters only"
                )
        file, declared, inputs = None, dict(flatten_fields(PARTNERS[model].parameter_class)), {}
        needed = getattr(PARTNERS[model].parameter_class, "inertia_name", None)
        if needed and needed not in component_section:
            missing = declared[needed].metadata
            raise ValueError(
                f"{component_name}.{needed} is not stated, expected the {missing['doc']} [{missing['unit']}]"
            )
    else:
        joint = MODELS[model].joint
        joint_parameters = load_joint_file(system_path.parent, component_name, joint, component_section)
        file = joint_parameters or load_default(joint)
        declared = {
            key: item for key, item in flatten_fields(type(file.values)) if key in file.values_by_name
        }
        inputs = {v.name: quantity_field(v.unit, v.doc, ge=v.minimum) for v in MODELS[model].inputs}
        declared |= inputs
    try:
        values, _, sources = read_entries(system_path, declared, body)
    except ValueError as error:
        raise ValueError(f"{component_name}.{str(error).removeprefix(f'{system_path}: ')}") from None
    for key, value in values.items():
        if key not in declared:
            raise ValueError(f"{component_name}: unknown name {key!r}, allowed are {', '.join(declared)}")
        if text := find_problem(key, value, declared[key]):
            raise ValueError(f"{component_name}.{text}")
        values[key] = float(value) if isinstance(value, int) and not isinstance(value, bool) else value
    own, base = joint_parameters is not None, file
    if file:
        changes = {key: value for key, value in values.items() if key not in inputs}
        file = file.with_values(changes, "user", f"system {system_path.stem}")
        own |= not changes.keys() <= _find_variable_fields(model, file).keys()
    units = {key: declared[key].metadata.get("unit", "") for key in values}
    return Component(component_name, model, base, file, own, values, units, sources)


def _find_variable_fields(model_name: str, parameter_file: ParameterFile | None) -> dict[str, Any]:
    """{parameter: dataclass field} of the FMU variables of a model."""
    if parameter_file is None:
        return dict(flatten_fields(PARTNERS[model_name].parameter_class))
    return MODELS[model_name].with_parameters(parameter_file.joint, parameter_file.values).parameter_fields()
