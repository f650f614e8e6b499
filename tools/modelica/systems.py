"""Systems as Modelica models, made of components of this library and of the Modelica Standard Library."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from jinja2 import Environment
from jointfmu_fmu_src.joint_parts.terminals import ROTATIONAL
from jointfmu_fmu_src.partners.laws import POINTS

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile

from ..joint_parts import part as joint_part
from ..systems.system import Component as Part
from ..systems.system import System
from ..systems.wiring import End, ends
from .records import ModelicaComponent, ModelicaRecord, html, number, text

_MSL = "Modelica.Mechanics"
_LIBRARY = "JointStiffness.Components"
_NOMINAL = {"phi": "1e-3", "w": "0.1", "s": "1e-6", "v": "1e-3"}
"""{state: nominal value [SI]} of bodies."""
_APART, _ROW = 30, 30
"""Distances on the diagram: between columns of components, and between rows."""

Records = Callable[[str, ParameterFile, tuple[float, ...]], ModelicaRecord | None]
"""(kind of joint, parameter file, working point) -> record of the library; None if it has no such record."""


class Declared(NamedTuple):
    """Declaration of a component: type, name, modifications (`values`), position (x, y) on the diagram."""

    type: str
    name: str
    values: str
    x: int
    y: int


def system_model(system: System, shared: Environment, library: Records, within: str = "") -> str:
    """Render a system as a Modelica model.

    find_record : finds the record of a joint in the library; a joint without one gets a record in the model
    package     : package of the model; empty: none

    Raises ValueError for a joint without a component in the library, and for a wrong connection as
    `wiring.ends`.
    """
    connected = ends(system)
    positions = _places(system, connected)
    records: list[dict[str, object]] = []
    declarations: list[Declared] = []
    lines: list[tuple[str, str, str]] = []

    def declare(kind: str, name: str, values: Iterable[str], of: str = "") -> None:
        """Declare a component; it is placed to the right of the component `of` to which it belongs."""
        x, y = positions[of or name]
        if of:
            x += _APART
            y -= _ROW * sum((declared.x, declared.y) == (x, y) for declared in declarations)
        declarations.append(Declared(kind, name, ", ".join(values), x, y))
        positions[name] = (x, y)

    def connect(one: str, other: str) -> None:
        """Connect two flanges, `component.flange`."""
        points = (positions[end.partition(".")[0]] for end in (one, other))
        lines.append((one, other, ",".join(f"{{{x},{y}}}" for x, y in points)))

    for name, component in system.components.items():
        if component.file:
            data, changes = _record(component, library, records)
            declare(f"{_LIBRARY}.{component.model}", name, [*data, *changes])
        else:
            _PARTNERS[component.model](component, declare, connect)
    for end, other_end in connected:
        assert end.component
        flange, other_flange = _flange(end), _flange(other_end) if other_end.component else None
        if flange is None:
            continue
        if other_flange is None:
            support = f"{flange.replace('.', '_')}_held"
            domain = "Rotational" if end.flange and end.flange.kind == ROTATIONAL else "Translational"
            declare(f"{_MSL}.{domain}.Components.Fixed", support, [], end.component.name)
            other_flange = f"{support}.flange"
        connect(flange, other_flange)
    return shared.get_template("Examples/system.mo").render(
        within=within,
        name=model_name(system),
        title=text(system.title),
        records=records,
        parts=declarations,
        lines=lines,
        stop=number(system.stop_time),
        interval=number(system.interval),
        about=html(f"{system.description}."),
        sources=_sources(system),
    )


def model_name(system: System) -> str:
    """Name of the Modelica model of a system: six_axis_robot becomes SixAxisRobot."""
    return system.name.title().replace("_", "")


def _flange(end: End) -> str | None:
    """Name `component.flange` of the end of a connection; None if the component has no such flange."""
    assert end.component
    name = end.component.name
    if end.load:
        (first, *_) = end.members
        return f"{name}.flange" if end.component.model == "AngleProfile" else f"{name}_{first}.flange"
    assert end.flange
    shaft = end.flange.name.removeprefix("flange")
    flange = f"flange_{end.flange.side}" if shaft.isdigit() else end.flange.name
    return f"{name}.{flange}" if end.body or flange in _component(end.component).flanges else None


def _component(part: Part) -> ModelicaComponent:
    """Modelica component of a joint in a system. Raises ValueError if the library has none."""
    module = joint_part(KINDS[part.kind], "modelica")
    if module is None or module.COMPONENT.name != part.model:
        raise ValueError(f"{part.name}: the Modelica library has no component of a {part.model}")
    component: ModelicaComponent = module.COMPONENT
    return component


def _record(
    part: Part, library: Records, records: list[dict[str, object]]
) -> tuple[Sequence[str], Sequence[str]]:
    """Modifications of a joint's component: its record, and other parameters that the system sets.

    records : list of records in the model, to which a record is added if the library has none
    """
    assert part.file
    component = _component(part)
    file = part.file
    point = tuple(part.state.get(name, file.start(name)) for name in KINDS[part.kind].working_point)
    changes = [f"{key}={value}" for key, value in component.of_system(file).items()]
    changes += [
        f"{component.held[name]}={number(part.state[name])}" for name in component.held if name in part.state
    ]
    known_record = library(part.kind, file, point)
    if known_record:
        return [f"data=JointStiffness.Data.{known_record.name}()"], changes
    (record,) = component.records(file, [point])
    name = f"{part.name[0].upper()}{part.name[1:]}Data"
    title = text(f"{file.name}, of {part.name}")
    records.append(record.content(component.base) | {"name": name, "title": title})
    return [f"data={name}()"], changes


def _numbers(values: Mapping[str, Any], names: Iterable[str] | None = None) -> list[str]:
    return [f"{key}={number(value)}" for key, value in values.items() if names is None or key in names]


def _states(*names: str) -> list[str]:
    return [f"{name}(fixed=true, start=0, nominal={_NOMINAL[name]})" for name in names]


Declare = Callable[..., None]
Connect = Callable[[str, str], None]


def _inertia(part: Part, declare: Declare, connect: Connect) -> None:
    declare(
        f"{_MSL}.Rotational.Components.Inertia",
        part.name,
        [*_numbers(part.values, ("J",)), *_states("phi", "w")],
    )
    weight = {key: part.values.get(key, 0.0) for key in ("m", "l")}
    if all(weight.values()):
        name = f"{part.name}_weight"
        declare(f"{_LIBRARY}.LinkWeight", name, _numbers(weight), part.name)
        connect(f"{part.name}.flange_b", f"{name}.flange")


def _source(block: str, domain: str, kind: str, signal: str) -> Callable[[Part, Declare, Connect], None]:
    """Return the function that declares a load: a signal block and a source of force or torque."""

    def add(part: Part, declare: Declare, connect: Connect) -> None:
        values = part.values
        points = [number(values[f"p{k}"]) for k in range(1, POINTS + 1) if f"p{k}" in values]
        modifications = _numbers({key: value for key, value in values.items() if not key[1:].isdigit()})
        if points:
            modifications.append(f"p={{{', '.join(points)}}}")
        declare(f"{_LIBRARY}.{block}", part.name, modifications)
        source = f"{part.name}_{signal}"
        declare(f"{_MSL}.{domain}.Sources.{kind}", source, [], part.name)
        connect(f"{part.name}.y", f"{source}.{signal}")

    return add


_PARTNERS: dict[str, Callable[[Part, Declare, Connect], None]] = {
    "RotationalInertia": _inertia,
    "TranslationalMass": lambda part, declare, _: declare(
        f"{_MSL}.Translational.Components.Mass",
        part.name,
        [*_numbers(part.values, ("m",)), *_states("s", "v")],
    ),
    "TorqueProfile": _source("Load", "Rotational", "Torque", "tau"),
    "ForceProfile": _source("Load", "Translational", "Force", "f"),
    "TorqueCurve": _source("TorqueCurve", "Rotational", "Torque", "tau"),
    "AngleProfile": lambda part, declare, _: declare(
        f"{_LIBRARY}.AngleProfile", part.name, _numbers(part.values)
    ),
}


def _places(system: System, connected: Sequence[tuple[End, End]]) -> dict[str, tuple[int, int]]:
    """Positions of the components on the diagram: a row for each connected chain, in file order."""
    chains: list[set[str]] = []
    for pair in connected:
        names = {end.component.name for end in pair if end.component}
        joined = [chain for chain in chains if chain & names]
        chains = [chain for chain in chains if not chain & names] + [names.union(*joined)]
    order = list(system.components)
    chains.sort(key=lambda chain: min(map(order.index, chain)))
    return {
        name: (_APART * column * 2 - 80, 80 - _ROW * row)
        for row, chain in enumerate(chains)
        for column, name in enumerate(sorted(chain, key=order.index))
    }


def _sources(system: System) -> str:
    rows = "".join(
        f"<tr><td><code>{part.name}.{name}</code></td><td>{number(value)} "
        f"{part.units[name].replace('.', ' ')}</td><td>{html(part.sources[name])}</td></tr>\n"
        for part in system.components.values()
        for name, value in part.values.items()
    )
    return f"<table>\n<tr><th>number</th><th>value</th><th>source</th></tr>\n{rows}</table>"
