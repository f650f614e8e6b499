"""Systems of joints: TOML files of named components and what connects them, the same for every tool.

A file is `schema = 1`, `name = ...`, `description = ...`, and a section for every component,

    [drive]
    model = "HarmonicDriveSpring"
    parameters = "my_drive.toml"
    hysteresis_loss = { value = 2.9e-4, unit = "rad", kind = "catalogue", source = "1 arcmin" }

with its FMU as `model`, of a joint its parameter file or, as `catalogue`, its name in the catalogue
(neither: the default), and values of its own: parameters, and of a joint the inputs at which the system
holds it. `connect` is a list of pairs: a load and the flange that it acts on, two flanges, or a flange of
a joint and "ground". A section `[experiment]` has `stop_time` and `interval`. A section `[arm]` stands for
the components of a serial arm, see `arm`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jointfmu_fmu_src.naming import NAME_RULE, is_identifier
from jointfmu_fmu_src.partners import PARTNERS

from jointfmu.joints import MODELS
from jointfmu.parameters import ParameterFile, load_default, read_document, read_entries
from jointfmu.quantity import find_problem, flat_fields, quantity_field

from .arm import arm_parts
from .system_joint import KEYS, joint_file

GROUND = "ground"
"""What holds a flange of a joint."""
_EXPERIMENT = {
    "stop_time": quantity_field("s", "end of the simulation", gt=0.0),
    "interval": quantity_field("s", "between two points of the result", gt=0.0),
}
_HEAD = ("schema", "name", "description", "connect", "experiment", "arm")


@dataclass(frozen=True, slots=True)
class Component:
    """One part of a system.

    model : what it is exported as, a joint's or a partner's
    base  : parameters of a joint without those that the system gives; None: of a partner
    file  : the same with them
    own   : whether its FMU is another than the model's: the system names a file for it, or gives a parameter
        that is baked in
    values, units, sources : {parameter or input: SI value, unit, text} that the system gives it
    """

    name: str
    model: str
    base: ParameterFile | None
    file: ParameterFile | None
    own: bool
    values: Mapping[str, Any]
    units: Mapping[str, str]
    sources: Mapping[str, str]

    @property
    def kind(self) -> str:
        """Kind of a joint; empty for a partner."""
        return self.file.joint if self.file else ""

    @property
    def state(self) -> dict[str, float]:
        """{input of a joint: value} at which the system holds it."""
        inputs = {v.name for v in MODELS[self.model].inputs} if self.file else set()
        return {name: value for name, value in self.values.items() if name in inputs}

    @property
    def parameters(self) -> dict[str, Any]:
        """{parameter of its FMU: value} that the system gives it."""
        held, fields = self.state, _exposed(self.model, self.file)
        return {name: value for name, value in self.values.items() if name not in held and name in fields}


@dataclass(frozen=True, slots=True)
class System:
    """A system.

    name        : identifier, the file's stem
    components  : {name: component}
    connections : pairs of ends, `COMPONENT.FLANGE`, the name of a load, or GROUND
    stop_time, interval : [s]
    arm         : the parameters of a serial arm, if it is one
    """

    name: str
    title: str
    description: str
    components: Mapping[str, Component]
    connections: Sequence[tuple[str, str]]
    stop_time: float
    interval: float
    arm: Any = None
    sources: Mapping[str, str] = field(default_factory=dict)

    @property
    def kinds(self) -> set[str]:
        """Kinds of the joints that have the parameters of their model's FMU."""
        return {joint.kind for joint in self.joints.values() if not joint.own}

    @property
    def joints(self) -> dict[str, Component]:
        return {name: part for name, part in self.components.items() if part.file}

    @property
    def values(self) -> dict[str, Any]:
        """{COMPONENT.NAME: SI value} of all that the system gives its components."""
        return {
            f"{part.name}.{name}": value
            for part in self.components.values()
            for name, value in part.values.items()
        }

    def with_joint(self, file: ParameterFile) -> "System":
        """The same system with these parameters for all joints of their kind that have none of their own."""
        parts = dict(self.components)
        for name, part in self.joints.items():
            if part.kind == file.joint and not part.own:
                given = {key: value for key, value in part.values.items() if key not in part.state}
                whole = file.with_values(given, "user", f"system {self.name}")
                parts[name] = replace(part, base=file, file=whole)
        return replace(self, components=parts)


def names() -> tuple[str, ...]:
    """The systems that are shipped, by name: one file each."""
    paths = (files("jointfmu_models") / "systems").iterdir()
    return tuple(sorted(path.name.removesuffix(".toml") for path in paths if path.name.endswith(".toml")))


def systems() -> dict[str, System]:
    """{name: system} of all that are shipped."""
    return {name: system(name) for name in names()}


def system(name: str) -> System:
    """One of `names()`, or a file.

    Raises ValueError with one line that names the entry and what is allowed.
    """
    if name in names():
        return _shipped(name)
    if not name.endswith(".toml"):
        raise ValueError(f"system {name!r}: allowed are {', '.join(names())}, or a file .toml")
    return read_system(Path(name))


@cache
def _shipped(name: str) -> System:
    return read_system(Path(str(files("jointfmu_models") / "systems" / f"{name}.toml")))


def read_system(path: Path) -> System:
    """Read and check a system's file, each component for itself; flanges are the builders' matter.

    Raises ValueError with one line that names the file, the entry and what is allowed.
    """
    document = read_document(path, "a system's file")
    if not is_identifier(path.stem):
        raise ValueError(f"{path}: the file's name is the system's; allowed are {NAME_RULE}")
    try:
        return _system(path, document)
    except ValueError as error:
        raise ValueError(f"{path}: {str(error).removeprefix(f'{path}: ')}") from None


def _system(path: Path, document: Mapping[str, Any]) -> System:
    if "experiment" not in document:
        own = f"; it is of a {document['joint']}" if "joint" in document else ""
        raise ValueError(f"has no section [experiment], expected a system's file{own}")
    experiment, _, times = read_entries(path, _EXPERIMENT, document["experiment"])
    for name, item in _EXPERIMENT.items():
        if text := find_problem(name, experiment.get(name), item):
            raise ValueError(f"experiment.{text}")
    sections = {key: value for key, value in document.items() if key not in _HEAD}
    connections = _pairs(document.get("connect", []))
    arm = None
    if "arm" in document:
        arm, parts, wires = arm_parts(path, document["arm"])
        sections, connections = parts | sections, [*wires, *connections]
    found = {key: _component(path, key, value) for key, value in sections.items()}
    for one in found:
        if longer := [name for name in found if name != one and name.startswith(one)]:
            raise ValueError(
                f"component {longer[0]!r} begins like {one!r}, which fmpy mixes up; allowed are names of "
                "which none begins another"
            )
    if not any(part.file for part in found.values()):
        raise ValueError(f"no component is a joint, allowed models are {', '.join(MODELS)}")
    return System(
        path.stem,
        str(document.get("name", path.stem)),
        str(document.get("description", "")),
        found,
        connections,
        float(experiment["stop_time"]),
        float(experiment["interval"]),
        arm,
        times,
    )


def _pairs(value: Any) -> list[tuple[str, str]]:
    pairs = []
    for pair in value if isinstance(value, list) else [value]:
        if not (isinstance(pair, list) and len(pair) == 2 and all(isinstance(end, str) for end in pair)):
            raise ValueError(f'connect = {pair!r}, expected pairs of ends ["load", "motor.flange_a"]')
        pairs.append((pair[0], pair[1]))
    return pairs


def _component(path: Path, name: str, section: Any) -> Component:
    models = [*MODELS, *PARTNERS]
    if not isinstance(section, Mapping):
        raise ValueError(f"{name} = {section!r}, expected a section [{name}] with its model")
    if not is_identifier(name) or name == GROUND:
        raise ValueError(f"component {name!r}: allowed are {NAME_RULE}, and not {GROUND!r}")
    model = section.get("model")
    if not isinstance(model, str) or model not in models:
        raise ValueError(f"{name}.model = {model!r}, allowed are {', '.join(models)}")
    body = {key: value for key, value in section.items() if key not in ("model", *KEYS)}
    given = None
    if model in PARTNERS:
        for key in KEYS:
            if key in section:
                raise ValueError(
                    f"{name}.{key} = {section[key]!r}, expected none of a {model}, only its values"
                )
        file, declared, inputs = None, dict(flat_fields(PARTNERS[model].parameters)), {}
        needed = getattr(PARTNERS[model].parameters, "inertia", None)
        if needed and needed not in section:
            meant = declared[needed].metadata
            raise ValueError(f"{name}.{needed} is not stated, expected the {meant['doc']} [{meant['unit']}]")
    else:
        joint = MODELS[model].joint
        given = joint_file(path.parent, name, joint, section)
        file = given or load_default(joint)
        declared = {key: item for key, item in flat_fields(type(file.values)) if key in file.values_by_name}
        inputs = {v.name: quantity_field(v.unit, v.doc, ge=v.minimum) for v in MODELS[model].inputs}
        declared |= inputs
    try:
        values, _, sources = read_entries(path, declared, body)
    except ValueError as error:
        raise ValueError(f"{name}.{str(error).removeprefix(f'{path}: ')}") from None
    for key, value in values.items():
        if key not in declared:
            raise ValueError(f"{name}: unknown name {key!r}, allowed are {', '.join(declared)}")
        if text := find_problem(key, value, declared[key]):
            raise ValueError(f"{name}.{text}")
        values[key] = float(value) if isinstance(value, int) and not isinstance(value, bool) else value
    own, base = given is not None, file
    if file:
        changes = {key: value for key, value in values.items() if key not in inputs}
        file = file.with_values(changes, "user", f"system {path.stem}")
        own |= not changes.keys() <= _exposed(model, file).keys()
    units = {key: declared[key].metadata.get("unit", "") for key in values}
    return Component(name, model, base, file, own, values, units, sources)


def _exposed(model: str, file: ParameterFile | None) -> dict[str, Any]:
    """Fields of the parameters that an FMU has."""
    if file is None:
        return dict(flat_fields(PARTNERS[model].parameters))
    return MODELS[model].with_parameters(file.joint, file.values).parameter_fields()
