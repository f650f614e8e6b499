"""Systems as Modelica models, made of components of this library and of the Modelica Standard Library."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from jinja2 import Environment
from jointfmu_fmu_src.joint_parts.terminals import ROTATIONAL_FLANGE_CLASS
from jointfmu_fmu_src.partners.laws import TORQUE_CURVE_CONTROL_POINT_COUNT

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile

from ...common.joint_parts import load_tool_module as joint_part
from ...systems.arm import UNCOUPLED_AXES_NOTE
from ...systems.system import Component as Part
from ...systems.system import System
from ...systems.wiring import ConnectionEnd, find_connections
from .records import ModelicaComponent, ModelicaRecord, escape_html, escape_string, format_double_literal

_MECHANICS_PACKAGE = "Modelica.Mechanics"
"""Package of the Modelica Standard Library with bodies and sources."""
_COMPONENT_PACKAGE = "JointStiffness.Components"
"""Package of the library JointStiffness with the components of joints."""
_NOMINAL_STATE_VALUES = {"phi": "1e-3", "w": "0.1", "s": "1e-6", "v": "1e-3"}
"""{state: nominal value [SI]} of bodies."""
_LINK_WEIGHT_PARAMETERS = ("m", "l")
"""Parameters of a rotational inertia that become parameters of a component `LinkWeight`."""
_DIAGRAM_COLUMN_SPACING, _DIAGRAM_ROW_SPACING = 30, 30
"""Distances on the diagram: between columns of components, and between rows."""

RecordLookup = Callable[[str, ParameterFile, tuple[float, ...]], ModelicaRecord | None]
"""(kind of joint, parameter file, working point) -> record of the library; None if it has no such record."""


class ComponentDeclaration(NamedTuple):
    """Declaration of a Modelica component: type, name, modifications, position (x, y) on the diagram."""

    component_type: str
    component_name: str
    modifications: str
    diagram_x: int
    diagram_y: int


def render_system_model(
    system: System, shared_templates: Environment, find_library_record: RecordLookup, package_name: str = ""
) -> str:
    """Render a system as a Modelica model.

    find_library_record : finds the record of a joint in the library; a joint without one gets a record in the
                          model
    package_name        : package of the model; empty: none

    Raises ValueError for a joint without a component in the library, and for flanges that cannot be connected
    (see `wiring.find_connections`).
    """
    connected = find_connections(system)
    positions = _place_on_diagram(system, connected)
    records: list[dict[str, object]] = []
    declarations: list[ComponentDeclaration] = []
    lines: list[tuple[str, str, str]] = []

    def declare_component(
        component_type: str, component_name: str, modifications: Iterable[str], left_neighbour: str = ""
    ) -> None:
        """Declare a component; it is placed to the right of its component `left_neighbour`."""
        x, y = positions[left_neighbour or component_name]
        if left_neighbour:
            x += _DIAGRAM_COLUMN_SPACING
            y -= _DIAGRAM_ROW_SPACING * sum(
                (declared.diagram_x, declared.diagram_y) == (x, y) for declared in declarations
            )
        declarations.append(
            ComponentDeclaration(component_type, component_name, ", ".join(modifications), x, y)
        )
        positions[component_name] = (x, y)

    def connect_flanges(start_flange: str, end_flange: str) -> None:
        """Connect two flanges, `component.flange`."""
        points = (positions[end.partition(".")[0]] for end in (start_flange, end_flange))
        lines.append((start_flange, end_flange, ",".join(f"{{{x},{y}}}" for x, y in points)))

    for name, component in system.components.items():
        if component.parameter_file:
            data, changes = _joint_modifications(component, find_library_record, records)
            declare_component(f"{_COMPONENT_PACKAGE}.{component.model_name}", name, [*data, *changes])
        else:
            _PARTNER_DECLARERS[component.model_name](component, declare_component, connect_flanges)
    for end, other_end in connected:
        assert end.component
        flange, other_flange = _flange_name(end), _flange_name(other_end) if other_end.component else None
        if flange is None:
            continue
        if other_flange is None:
            support = f"{flange.replace('.', '_')}_held"
            domain = (
                "Rotational"
                if end.flange and end.flange.connector_class == ROTATIONAL_FLANGE_CLASS
                else "Translational"
            )
            declare_component(
                f"{_MECHANICS_PACKAGE}.{domain}.Components.Fixed", support, [], end.component.name
            )
            other_flange = f"{support}.flange"
        connect_flanges(flange, other_flange)
    return shared_templates.get_template("Examples/system.mo").render(
        within=package_name,
        name=make_model_name(system),
        title=escape_string(system.title),
        records=records,
        parts=declarations,
        lines=lines,
        stop=format_double_literal(system.stop_time),
        interval=format_double_literal(system.output_interval),
        about=escape_html(f"{system.description}. {UNCOUPLED_AXES_NOTE if system.arm else ''}".strip()),
        sources=_format_value_sources(system),
    )


def make_model_name(system: System) -> str:
    """Name of the Modelica model of a system: six_axis_robot becomes SixAxisRobot."""
    return system.name.title().replace("_", "")


def _flange_name(connection_end: ConnectionEnd) -> str | None:
    """Name `component.flange` of the end of a connection; None if the component has no such flange."""
    assert connection_end.component
    name = connection_end.component.name
    if connection_end.is_load:
        (first, *_) = connection_end.variables_by_member
        return (
            f"{name}.flange"
            if connection_end.component.model_name == "AngleProfile"
            else f"{name}_{first}.flange"
        )
    assert connection_end.flange
    shaft = connection_end.flange.terminal_name.removeprefix("flange")
    flange = (
        f"flange_{connection_end.flange.flange_side}"
        if shaft.isdigit()
        else connection_end.flange.terminal_name
    )
    return (
        f"{name}.{flange}"
        if connection_end.is_body or flange in _find_modelica_component(connection_end.component).flange_names
        else None
    )


def _find_modelica_component(system_component: Part) -> ModelicaComponent:
    """Modelica component of a joint in a system. Raises ValueError if the library has none."""
    module = joint_part(KINDS[system_component.joint_kind], "modelica")
    if module is None or module.MODELICA_COMPONENT.component_name != system_component.model_name:
        raise ValueError(
            f"{system_component.name}: the Modelica library has no component of a "
            f"{system_component.model_name}"
        )
    component: ModelicaComponent = module.MODELICA_COMPONENT
    return component


def _joint_modifications(
    system_component: Part, find_library_record: RecordLookup, model_records: list[dict[str, object]]
) -> tuple[Sequence[str], Sequence[str]]:
    """Modifications of a joint's component: its record, and other parameters that the system sets.

    model_records : list of records in the model, to which a record is added if the library has none
    """
    assert system_component.parameter_file
    component = _find_modelica_component(system_component)
    file = system_component.parameter_file
    point = tuple(
        system_component.constant_inputs.get(name, file.start_value(name))
        for name in KINDS[system_component.joint_kind].working_point
    )
    changes = [f"{key}={value}" for key, value in component.system_parameters(file).items()]
    changes += [
        f"{component.fixed_input_parameters[name]}={format_double_literal(system_component.constant_inputs[name])}"
        for name in component.fixed_input_parameters
        if name in system_component.constant_inputs
    ]
    known_record = find_library_record(system_component.joint_kind, file, point)
    if known_record:
        return [f"data=JointStiffness.Data.{known_record.record_name}()"], changes
    (record,) = component.make_records(file, [point])
    name = f"{system_component.name[0].upper()}{system_component.name[1:]}Data"
    title = escape_string(f"{file.name}, of {system_component.name}")
    model_records.append(record.template_variables(component.base_record) | {"name": name, "title": title})
    return [f"data={name}()"], changes


def _format_modifications(
    parameter_values: Mapping[str, Any], selected_names: Iterable[str] | None = None
) -> list[str]:
    """Format parameters of a component as modifications NAME = NUMBER."""
    return [
        f"{key}={format_double_literal(value)}"
        for key, value in parameter_values.items()
        if selected_names is None or key in selected_names
    ]


def _format_state_modifications(*names: str) -> list[str]:
    """Format modifications of states: start values and nominal values."""
    return [f"{name}(fixed=true, start=0, nominal={_NOMINAL_STATE_VALUES[name]})" for name in names]


DeclareComponentFunction = Callable[..., None]
"""Function that declares a component of the Modelica model."""
ConnectFlangesFunction = Callable[[str, str], None]
"""Function that connects two flanges of the Modelica model."""


def _has_weight(inertia: Part) -> bool:
    """Whether a rotational inertia of a system has weight at a distance from its axis."""
    return all(inertia.stated_values.get(name, 0.0) for name in _LINK_WEIGHT_PARAMETERS)


def _declare_inertia(
    system_component: Part,
    declare_component: DeclareComponentFunction,
    connect_flanges: ConnectFlangesFunction,
) -> None:
    """Declare the Modelica components of an inertia or mass: body, and weight if it has any."""
    declare_component(
        f"{_MECHANICS_PACKAGE}.Rotational.Components.Inertia",
        system_component.name,
        [
            *_format_modifications(system_component.stated_values, ("J",)),
            *_format_state_modifications("phi", "w"),
        ],
    )
    if _has_weight(system_component):
        name, weight = (
            f"{system_component.name}_weight",
            _format_modifications(system_component.stated_values, _LINK_WEIGHT_PARAMETERS),
        )
        declare_component(f"{_COMPONENT_PACKAGE}.LinkWeight", name, weight, system_component.name)
        connect_flanges(f"{system_component.name}.flange_b", f"{name}.flange")


def _create_load_declarer(
    signal_block_name: str, mechanics_domain: str, source_class: str, signal_name: str
) -> Callable[[Part, DeclareComponentFunction, ConnectFlangesFunction], None]:
    """Return the function that declares a load: a signal block and a source of force or torque."""

    def declare_source(
        system_component: Part,
        declare_component: DeclareComponentFunction,
        connect_flanges: ConnectFlangesFunction,
    ) -> None:
        """Declare a signal block, and a source of force or torque that is connected to it."""
        values = system_component.stated_values
        points = [
            format_double_literal(values[f"p{k}"])
            for k in range(1, TORQUE_CURVE_CONTROL_POINT_COUNT + 1)
            if f"p{k}" in values
        ]
        modifications = _format_modifications(
            {key: value for key, value in values.items() if not key[1:].isdigit()}
        )
        if points:
            modifications.append(f"p={{{', '.join(points)}}}")
        declare_component(f"{_COMPONENT_PACKAGE}.{signal_block_name}", system_component.name, modifications)
        source = f"{system_component.name}_{signal_name}"
        declare_component(
            f"{_MECHANICS_PACKAGE}.{mechanics_domain}.Sources.{source_class}",
            source,
            [],
            system_component.name,
        )
        connect_flanges(f"{system_component.name}.y", f"{source}.{signal_name}")

    return declare_source


_PARTNER_DECLARERS: dict[str, Callable[[Part, DeclareComponentFunction, ConnectFlangesFunction], None]] = {
    "RotationalInertia": _declare_inertia,
    "TranslationalMass": lambda part, declare, _: declare(
        f"{_MECHANICS_PACKAGE}.Translational.Components.Mass",
        part.name,
        [*_format_modifications(part.stated_values, ("m",)), *_format_state_modifications("s", "v")],
    ),
    "TorqueProfile": _create_load_declarer("Load", "Rotational", "Torque", "tau"),
    "ForceProfile": _create_load_declarer("Load", "Translational", "Force", "f"),
    "TorqueCurve": _create_load_declarer("TorqueCurve", "Rotational", "Torque", "tau"),
    "AngleProfile": lambda part, declare, _: declare(
        f"{_COMPONENT_PACKAGE}.AngleProfile", part.name, _format_modifications(part.stated_values)
    ),
}
"""{partner FMU (body or load) of a system: function that declares its Modelica components}."""


def _place_on_diagram(
    system: System, flange_connections: Sequence[tuple[ConnectionEnd, ConnectionEnd]]
) -> dict[str, tuple[int, int]]:
    """Positions of the components on the diagram: a row for each connected chain, in file order."""
    chains: list[set[str]] = []
    for pair in flange_connections:
        names = {end.component.name for end in pair if end.component}
        joined = [chain for chain in chains if chain & names]
        chains = [chain for chain in chains if not chain & names] + [names.union(*joined)]
    order = list(system.components)
    chains.sort(key=lambda chain: min(map(order.index, chain)))
    return {
        name: (_DIAGRAM_COLUMN_SPACING * column * 2 - 80, 80 - _DIAGRAM_ROW_SPACING * row)
        for row, chain in enumerate(chains)
        for column, name in enumerate(sorted(chain, key=order.index))
    }


def _format_value_sources(system: System) -> str:
    """HTML table of the parameters of all components of a system, with value, unit and source."""
    rows = "".join(
        f"<tr><td><code>{path}</code></td><td>{value}</td><td>{escape_html(source)}</td></tr>\n"
        for part in system.components.values()
        for path, (value, source) in _find_value_sources(part).items()
    )
    return f"<table>\n<tr><th>number</th><th>value</th><th>source</th></tr>\n{rows}</table>"


def _find_value_sources(system_component: Part) -> dict[str, tuple[str, str]]:
    """{parameter as the Modelica model names it: (value with unit, source)} of a component."""
    rows: dict[str, tuple[str, str]] = {}
    for name, value in system_component.stated_values.items():
        text, source = (
            f"{format_double_literal(value)} {system_component.stated_units[name].replace('.', ' ')}",
            system_component.value_sources[name],
        )
        if system_component.parameter_file:
            component = _find_modelica_component(system_component)
            if name in component.component_only_parameters:
                for parameter, number in component.system_parameters(system_component.parameter_file).items():
                    computed = f"{number} {component.system_parameter_units[parameter].replace('.', ' ')}"
                    rows[f"{system_component.name}.{parameter}"] = (
                        computed,
                        f"from {name} = {text}: {source}",
                    )
                continue
            in_record = name in KINDS[system_component.joint_kind].working_point
            path = f"data.{name}" if in_record else component.fixed_input_parameters.get(name, name)
            rows[f"{system_component.name}.{path}"] = (text, source)
        elif system_component.model_name == "RotationalInertia" and name in _LINK_WEIGHT_PARAMETERS:
            if _has_weight(system_component):
                rows[f"{system_component.name}_weight.{name}"] = (text, source)
        else:
            path = f"p[{name[1:]}]" if name[1:].isdigit() else name
            rows[f"{system_component.name}.{path}"] = (text, source)
    return rows
