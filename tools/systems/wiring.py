"""Signals between the components of a system, derived from the connections of flanges in its file."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from jointfmu_fmu_src.joint_parts.terminals import Terminal
from jointfmu_fmu_src.native.terminals import find_terminals
from jointfmu_fmu_src.partners import PARTNERS

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model

from .system import GROUND, Component, System


class SignalConnection(NamedTuple):
    """Signal from `output` of the component `source_component` to `input` of `target_component`."""

    source_component: str
    source_output: str
    target_component: str
    target_input: str


class ConnectionEnd(NamedTuple):
    """End of a connection in a system: a flange, a prescribed load (no flange), or the ground (no component).

    end_text            : the end as written in the system file
    variables_by_member : {Modelica member: variable}; of a load {output: output}
    """

    end_text: str
    component: Component | None
    flange: Terminal | None
    variables_by_member: Mapping[str, str]

    @property
    def is_joint(self) -> bool:
        """Whether the end is a flange of a joint."""
        return self.component is not None and self.component.parameter_file is not None

    @property
    def is_load(self) -> bool:
        """Whether the end is a prescribed load or motion over time."""
        return self.component is not None and self.flange is None

    @property
    def is_body(self) -> bool:
        """Whether the end is a flange of a body (inertia or mass)."""
        return not self.is_joint and self.flange is not None

    @property
    def force_member(self) -> str:
        """Name of the flange member that is a force or torque."""
        assert self.flange
        return next(name for name, (_, kind) in self.flange.member_variables.items() if kind != "signal")


def find_model(component: Component) -> Model:
    """Model of the FMU of a system's component."""
    if component.parameter_file is None:
        return PARTNERS[component.model_name]
    return MODELS[component.model_name].with_parameters(
        component.parameter_file.joint, component.parameter_file.values
    )


def find_connections(system: System) -> list[tuple[ConnectionEnd, ConnectionEnd]]:
    """Connections of a system as pairs of ends: a load or joint first, then a body; the ground last.

    Raises ValueError, one line that names the end and what is allowed, for: an unknown component or flange,
    an end that is connected twice or not at all, incompatible ends, a kinematic loop.
    """
    pairs = []
    partners: dict[str, str] = {}
    for connection in system.connections:
        pair = [_parse_connection_end(system, text) for text in connection]
        for end, other in zip(connection, reversed(connection), strict=True):
            if end != GROUND and end in partners:
                raise ValueError(f"{end} is connected to {partners[end]} and to {other}; state one of them")
            partners[end] = other
        pair.sort(key=lambda end: (end.component is None, not end.is_load, not end.is_joint))
        _check_end_compatibility(*pair)
        pairs.append((pair[0], pair[1]))
    for component in system.components.values():
        flanges = [
            f"{component.name}.{flange.terminal_name}" for flange in find_terminals(find_model(component))
        ]
        if component.parameter_file and (unconnected := [name for name in flanges if name not in partners]):
            raise ValueError(
                f'{unconnected[0]} is not connected; connect it to a flange of a body, or "{GROUND}"'
            )
        if not partners.keys() & {component.name, *flanges}:
            raise ValueError(f"{component.name} is not connected; connect it to a flange of a body or joint")
    _check_kinematic_loops(pairs)
    _check_ungrounded_joints(system, pairs)
    return pairs


def find_signals(system: System) -> list[SignalConnection]:
    """List the signals between components of a system. Raises ValueError for invalid connections."""
    signals = []
    for first, second in find_connections(system):
        if first.component is None or second.component is None:
            continue
        first_name, second_name = first.component.name, second.component.name
        driving_members = [*first.variables_by_member] if first.is_load else [first.force_member]
        signals += [
            SignalConnection(
                first_name, first.variables_by_member[m], second_name, second.variables_by_member[m]
            )
            for m in driving_members
        ]
        if first.is_joint:
            motion_members = [m for m in first.variables_by_member if m not in driving_members]
            signals += [
                SignalConnection(
                    second_name, second.variables_by_member[m], first_name, first.variables_by_member[m]
                )
                for m in motion_members
            ]
    return signals


def find_lag_parameters(system: System) -> dict[str, list[str]]:
    """{body: its parameters `lag_...`, of the flanges that are connected to a joint}."""
    lag_parameters: dict[str, list[str]] = {}
    for first, second in find_connections(system):
        if first.is_joint and second.component and second.flange:
            lag_parameters.setdefault(second.component.name, []).append(f"lag_{second.flange.flange_side}")
    return lag_parameters


def _parse_connection_end(system: System, end_text: str) -> ConnectionEnd:
    """Parse an end of a connection: `COMPONENT.FLANGE`, the name of a load, or "ground"."""
    name, _, flange = end_text.partition(".")
    if end_text == GROUND:
        return ConnectionEnd(end_text, None, None, {})
    if name not in system.components:
        raise ValueError(
            f"connect: unknown component {name!r}, allowed are {', '.join(system.components)}, {GROUND}"
        )
    component = system.components[name]
    model = find_model(component)
    known = {terminal.terminal_name: terminal for terminal in find_terminals(model)}
    if not known and component.parameter_file is None:
        if flange:
            raise ValueError(f"connect: {end_text!r}: a {model.name} has no flange, allowed is {name}")
        return ConnectionEnd(end_text, component, None, {v.name: v.name for v in model.outputs})
    if flange not in known:
        allowed = ", ".join(f"{name}.{known_flange}" for known_flange in known) or "none"
        raise ValueError(f"connect: unknown flange {end_text!r} of a {model.name}, allowed are {allowed}")
    members = known[flange].member_variables
    if component.parameter_file and "inflow" in {kind for _, kind in members.values()}:
        raise ValueError(
            f"{name}: a {model.name} has a load as input and a motion as output; expected a joint whose "
            "input is the motion of bodies"
        )
    return ConnectionEnd(
        end_text, component, known[flange], {key: variable for key, (variable, _) in members.items()}
    )


def _check_end_compatibility(first_end: ConnectionEnd, second_end: ConnectionEnd) -> None:
    """Raise ValueError if two ends of a connection do not fit, for example torque and force."""
    prefix = f"{first_end.end_text} and {second_end.end_text} do not fit"
    if second_end.component is None:
        if not first_end.is_joint:
            raise ValueError(f'{prefix}; allowed on "{GROUND}" are flanges of joints')
    elif first_end.is_load:
        expected_members = (
            {second_end.force_member}
            if second_end.is_body
            else {*second_end.variables_by_member}
            - ({second_end.force_member} if second_end.flange else set())
        )
        if second_end.is_load or {*first_end.variables_by_member} != expected_members:
            raise ValueError(
                f"{prefix}; allowed are a force or torque on a body's flange, an angle on a joint's flange"
            )
    elif first_end.is_joint == second_end.is_joint:
        raise ValueError(f"{prefix}; allowed is a joint's flange on a body's")
    elif first_end.variables_by_member.keys() != second_end.variables_by_member.keys():
        raise ValueError(f"{prefix}; allowed are two rotational or two translational flanges")


def _check_ungrounded_joints(
    system: System, connections: Sequence[tuple[ConnectionEnd, ConnectionEnd]]
) -> None:
    """Raise ValueError if all flanges of a joint are on the ground."""
    moved_joints = {
        first.component.name
        for first, second in connections
        if first.is_joint and first.component and second.component
    }
    moved_joints |= {
        second.component.name for _, second in connections if second.is_joint and second.component
    }
    for name in system.joints:
        if name not in moved_joints:
            raise ValueError(
                f'{name}: all its flanges are on "{GROUND}"; allowed is a joint with a flange on a body'
            )


def _check_kinematic_loops(connections: Sequence[tuple[ConnectionEnd, ConnectionEnd]]) -> None:
    """Raise ValueError if bodies and joints form a closed loop."""
    parents: dict[str, str] = {}

    def find_chain_root(component_name: str) -> str:
        """Name of the first component of the chain to which a component is connected."""
        while parents.get(component_name, component_name) != component_name:
            component_name = parents[component_name]
        return component_name

    for first, second in connections:
        if first.is_joint and second.is_body and first.component and second.component:
            roots = find_chain_root(first.component.name), find_chain_root(second.component.name)
            if roots[0] == roots[1]:
                raise ValueError(
                    f"{first.end_text} on {second.end_text} closes a loop; only chains of joints and bodies "
                    "are possible"
                )
            parents[roots[0]] = roots[1]
