"""Signals between the components of a system, from the flanges that it connects."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from jointfmu_fmu_src.joint_parts.terminals import Terminal
from jointfmu_fmu_src.native.terminals import terminals
from jointfmu_fmu_src.partners import PARTNERS

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model

from .system import GROUND, Component, System


class Wire(NamedTuple):
    """An output that feeds an input."""

    source: str
    output: str
    target: str
    input: str


class End(NamedTuple):
    """One end of a connection: a flange, a load over time without one, or the ground without a component.

    members : {member: variable}
    """

    text: str
    component: Component | None
    flange: Terminal | None
    members: Mapping[str, str]

    @property
    def joint(self) -> bool:
        return self.component is not None and self.component.file is not None

    @property
    def load(self) -> bool:
        return self.component is not None and self.flange is None

    @property
    def body(self) -> bool:
        return not self.joint and self.flange is not None

    @property
    def flow(self) -> str:
        """The member of a flange that is a force or torque."""
        assert self.flange
        return next(name for name, (_, kind) in self.flange.members.items() if kind != "signal")


def model_of(component: Component) -> Model:
    """What it is exported as."""
    if component.file is None:
        return PARTNERS[component.model]
    return MODELS[component.model].with_parameters(component.file.joint, component.file.values)


def ends(system: System) -> list[tuple[End, End]]:
    """All connections, the one that drives first: a load, a joint; the ground last.

    Raises ValueError with one line that names the end and what is allowed: an unknown component or flange,
    one that is connected twice or to nothing, ends that do not fit, a loop.
    """
    found = []
    seen: dict[str, str] = {}
    for connection in system.connections:
        pair = [_end(system, text) for text in connection]
        for end, other in zip(connection, reversed(connection), strict=True):
            if end != GROUND and end in seen:
                raise ValueError(f"{end} is connected to {seen[end]} and to {other}; allowed is one of them")
            seen[end] = other
        pair.sort(key=lambda end: (end.component is None, not end.load, not end.joint))
        _check_pair(*pair)
        found.append((pair[0], pair[1]))
    for component in system.components.values():
        flanges = [f"{component.name}.{flange.name}" for flange in terminals(model_of(component))]
        if component.file and (free := [name for name in flanges if name not in seen]):
            raise ValueError(
                f'{free[0]} is connected to nothing; allowed are a flange of a body, or "{GROUND}"'
            )
        if not seen.keys() & {component.name, *flanges}:
            raise ValueError(
                f"{component.name} is connected to nothing; allowed is a flange of a body or joint"
            )
    _check_loops(found)
    _check_held(system, found)
    return found


def wires(system: System) -> list[Wire]:
    """All signals. Raises ValueError as `ends`."""
    found = []
    for one, other in ends(system):
        if one.component is None or other.component is None:
            continue
        here, there = one.component.name, other.component.name
        drives = [*one.members] if one.load else [one.flow]
        found += [Wire(here, one.members[m], there, other.members[m]) for m in drives]
        if one.joint:
            moves = [m for m in one.members if m not in drives]
            found += [Wire(there, other.members[m], here, one.members[m]) for m in moves]
    return found


def lags(system: System) -> dict[str, list[str]]:
    """{body: parameters `lag_...` of the flanges that a joint loads}."""
    found: dict[str, list[str]] = {}
    for one, other in ends(system):
        if one.joint and other.component and other.flange:
            found.setdefault(other.component.name, []).append(f"lag_{other.flange.side}")
    return found


def _end(system: System, text: str) -> End:
    name, _, flange = text.partition(".")
    if text == GROUND:
        return End(text, None, None, {})
    if name not in system.components:
        raise ValueError(
            f"connect: unknown component {name!r}, allowed are {', '.join(system.components)}, {GROUND}"
        )
    component = system.components[name]
    model = model_of(component)
    known = {terminal.name: terminal for terminal in terminals(model)}
    if not known and component.file is None:
        if flange:
            raise ValueError(f"connect: {text!r}: a {model.name} has no flange, allowed is {name}")
        return End(text, component, None, {v.name: v.name for v in model.outputs})
    if flange not in known:
        allowed = ", ".join(f"{name}.{one}" for one in known) or "none"
        raise ValueError(f"connect: unknown flange {text!r} of a {model.name}, allowed are {allowed}")
    members = known[flange].members
    if component.file and "inflow" in {kind for _, kind in members.values()}:
        raise ValueError(
            f"{name}: a {model.name} takes a load and gives a motion; allowed are joints that take the "
            "motion of bodies"
        )
    return End(text, component, known[flange], {key: variable for key, (variable, _) in members.items()})


def _check_pair(first: End, second: End) -> None:
    """Refuse ends that do not fit."""
    said = f"{first.text} and {second.text} do not fit"
    if second.component is None:
        if not first.joint:
            raise ValueError(f'{said}; allowed on "{GROUND}" are flanges of joints')
    elif first.load:
        takes = (
            {second.flow} if second.body else {*second.members} - ({second.flow} if second.flange else set())
        )
        if second.load or {*first.members} != takes:
            raise ValueError(
                f"{said}; allowed are a force or torque on a body's flange, an angle on a joint's flange"
            )
    elif first.joint == second.joint:
        raise ValueError(f"{said}; allowed is a joint's flange on a body's")
    elif first.members.keys() != second.members.keys():
        raise ValueError(f"{said}; allowed are two that turn or two that shift")


def _check_held(system: System, connections: Sequence[tuple[End, End]]) -> None:
    """Refuse a joint that nothing moves."""
    moved = {
        one.component.name for one, other in connections if one.joint and one.component and other.component
    }
    moved |= {other.component.name for one, other in connections if other.joint and other.component}
    for name in system.joints:
        if name not in moved:
            raise ValueError(
                f'{name}: all its flanges are on "{GROUND}"; allowed is a joint with a flange on a body'
            )


def _check_loops(connections: Sequence[tuple[End, End]]) -> None:
    """Refuse a joint that closes a ring of bodies and joints."""
    group: dict[str, str] = {}

    def root(name: str) -> str:
        while group.get(name, name) != name:
            name = group[name]
        return name

    for one, other in connections:
        if one.joint and other.body and one.component and other.component:
            ends = root(one.component.name), root(other.component.name)
            if ends[0] == ends[1]:
                raise ValueError(
                    f"{one.text} on {other.text} closes a loop; allowed are chains of joints and bodies"
                )
            group[ends[0]] = ends[1]
