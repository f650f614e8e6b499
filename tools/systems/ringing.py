"""What a nonlinear joint does in a system, by running FMUs: resonance over the load, and free decay."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_fmu_src.partners import parameters as partner_parameters

from jointfmu.joints import KINDS
from jointfmu.progress import track_progress
from jointfmu.quantity import Array, flat_fields

from ..joint_parts import load_tool_module
from .master import Slave, damping_ratio, motion, peak
from .ssp import fmu_names, values
from .system import Component, System, systems
from .wiring import wires

PER_PERIOD, PERIODS = 100, 25
RESONANCE_TOLERANCE = 5e-3
"""Peak of the spectrum against sqrt(K/J) [1]."""
DAMPING_TOLERANCE = 1e-2
"""Decrement of the free decay against the stated damping [1]."""
LINE = 41
"""Points of a line over the load."""
RESOLVED = 1e-10
"""Least first deflection over that of the working point [1]: round-off is 1e-6 of it."""
MOST_DAMPED = 0.1
"""Damping ratio [1] up to which there are enough periods to find frequency and decrement."""
_LEAST_DAMPED = 1e-6
"""Damping ratio [1] below which the decrement, found to 2e-9, is not compared."""


@dataclass(frozen=True, slots=True)
class Ringing:
    """Free motion at one working point.

    load            : on the joint, SI
    inertia         : of the body [kg or kg.m2]
    frequency       : peak of the simulated signal's spectrum [rad/s]
    expected        : sqrt(K/J) with the joint's stiffness there [rad/s]
    damping, stated : ratios [1], of the decay and of the joint's own damping
    time, signal    : deflection from the working point [rad or m]
    messages        : what the FMUs logged
    """

    load: float
    inertia: float
    frequency: float
    expected: float
    damping: float
    stated: float
    time: Array
    signal: Array
    messages: tuple[str, ...]

    @property
    def damped(self) -> bool:
        """Whether the joint states a damping that the decrement resolves."""
        return self.stated > _LEAST_DAMPED

    @property
    def misses(self) -> list[str]:
        """What lies outside the tolerances, one line each."""
        pairs = [("frequency", self.frequency, self.expected, RESONANCE_TOLERANCE)]
        if self.damped:
            pairs.append(("damping", self.damping, self.stated, DAMPING_TOLERANCE))
        return [
            f"load = {self.load:g}: {name} {simulated:.6g}, expected {expected:.6g} within {allowed:g}"
            for name, simulated, expected, allowed in pairs
            if not abs(simulated - expected) <= allowed * expected
        ]


class Rest(NamedTuple):
    """A working point: the constant force or torque there, the position of rest, and the joint's stiffness
    and damping (SI units)."""

    force: float
    position: float
    stiffness: float
    damping: float


class Axis(NamedTuple):
    """Name of what a plot shows, its unit there, and the factor from SI to it."""

    name: str
    unit: str
    factor: float

    @property
    def label(self) -> str:
        return f"{self.name} [{self.unit}]"


class Pull(NamedTuple):
    """A pull that makes the joint slip: load on the joint and deflection, SI, and what it is."""

    load: float
    deflection: float
    doc: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """How a joint rings with a body on it: RINGING in the joint's file.

    model   : of the joint, motion in
    motion  : its inputs, position and speed of the body
    force   : its output, the force or torque on the body
    partner : FMU of the body
    over    : the variable that loads it
    loads   : (the joint's FMU, its parameters) -> the loads that show the joint, SI
    start   : load -> {input: value} of the joint's FMU under it
    rest    : (the joint's FMU, load, its parameters) -> working point; ValueError where nothing rings
    release : force or torque whose deflection is the first one [N or N.m]
    load, deflection : as plots show them
    doc     : how the body is held, for the report
    stiffness : variable of the joint that the body feels
    pull    : one that makes the joint slip
    elastic : parameters of the joint without friction, where friction adds to its stiffness at tiny motion
    """

    model: str
    motion: tuple[str, str]
    force: str
    partner: str
    over: str
    loads: Callable[[Path, Mapping[str, Any]], Sequence[float]]
    start: Callable[[float], Mapping[str, float]]
    rest: Callable[[Path, float, Mapping[str, float]], Rest]
    release: float
    load: Axis
    deflection: Axis
    doc: str
    stiffness: str
    pull: Pull
    elastic: Mapping[str, float] = field(default_factory=dict)


def body_on(joint: str) -> Body:
    """How a joint rings with a body on it; ValueError if it says nothing of that."""
    ringing = load_tool_module(KINDS[joint], "ringing")
    if ringing is None:
        able = [name for name, kind in KINDS.items() if load_tool_module(kind, "ringing")]
        raise ValueError(f"joint {joint!r} does not say how it rings, allowed are {', '.join(able)}")
    body: Body = ringing.RINGING
    return body


@dataclass(frozen=True, slots=True)
class VibratingJoint:
    """A joint of a system, and the body on it that rings while all others are held.

    fmu : name of the joint's FMU
    key : the parameter of the body that is its inertia
    """

    body: Body
    joint: Component
    fmu: str
    moving: Component
    key: str

    @property
    def parameters(self) -> dict[str, Any]:
        """Of the joint's FMU: all of one of its own, which another joint may share; else what the system
        gives it, for `--fmus` may hold a joint of other numbers."""
        if not self.joint.own:
            return self.joint.parameters
        return {name: entry.value for name, entry in values(self.joint).items()}

    @property
    def inertia(self) -> float:
        """Of the body [kg or kg.m2]."""
        given = self.moving.values.get(self.key)
        return float(
            partner_parameters(self.moving.model).values_by_name[self.key] if given is None else given
        )

    @property
    def inertia_unit(self) -> str:
        fields = dict(flat_fields(PARTNERS[self.moving.model].parameters))
        return str(fields[self.key].metadata["unit"])

    @property
    def motion_unit(self) -> str:
        return KINDS[self.joint.kind].variables[self.body.motion[0]].unit

    @property
    def load_unit(self) -> str:
        return KINDS[self.joint.kind].variables[self.body.over].unit


def vibrating_joint(system: System, joint: str | None = None) -> VibratingJoint:
    """What rings in a system.

    joint : name of one of its joints; None: the only one

    Raises ValueError if there is none of that name, several, or one that says nothing of how it rings.
    """
    joints = system.joints
    if joint is None and len(joints) > 1:
        raise ValueError(f"{system.name} has several joints, one must be named: {', '.join(joints)}")
    name = next(iter(joints)) if joint is None else joint
    if name not in joints:
        raise ValueError(f"joint {name!r} is not in {system.name}, allowed are {', '.join(joints)}")
    body = body_on(joints[name].kind)
    ends = [w.source for w in wires(system) if (w.target, w.input) == (name, body.motion[0])]
    moving = system.components[ends[0]] if ends else None
    if joints[name].model != body.model or moving is None or moving.model != body.partner:
        raise ValueError(f"{name}: expected a {body.model} that takes {body.motion[0]} from a {body.partner}")
    key = next(iter(dict(flat_fields(PARTNERS[body.partner].parameters))))
    return VibratingJoint(body, joints[name], fmu_names(system)[name], moving, key)


def examples(folder: Path) -> dict[str, list[Ringing]]:
    """The systems of one joint that says how it rings, over their loads; `folder` has the FMUs (FMI 2.0)."""
    return {name: ring(one, folder) for name, one in vibrating_joints().items()}


def vibrating_joints() -> dict[str, VibratingJoint]:
    """What rings in the shipped systems of one joint that says how, by the system's name."""
    alone = {n: s for n, s in systems().items() if len(s.joints) == 1}
    kinds = {n: next(iter(s.joints.values())).kind for n, s in alone.items()}
    return {n: vibrating_joint(s) for n, s in alone.items() if load_tool_module(KINDS[kinds[n]], "ringing")}


def ring(
    joint: VibratingJoint, folder: Path, loads: Sequence[float] | None = None, inertia: float | None = None
) -> list[Ringing]:
    """The body of a system on its joint without friction, about working points under a load.

    folder  : of the FMUs (FMI 2.0) of the joint and of the body
    loads   : SI; None: those that show the joint
    inertia : [kg.m2 or kg] of the body; None: that of the system

    Raises ValueError for an FMU that is missing or refuses, and where nothing rings.
    """
    parameters = {**joint.parameters, **joint.body.elastic}
    if loads is None:
        loads = joint.body.loads(folder / f"{joint.fmu}.fmu", parameters)
    if inertia is None:
        inertia = joint.inertia
    return [
        _ring_at(joint, folder, load, parameters, inertia)
        for load in track_progress(loads, "ring", len(loads))
    ]


def stiffness_line(
    vibrating_joint: VibratingJoint, folder: Path, points: Sequence[Ringing]
) -> tuple[Array, Array]:
    """Loads (n), evenly from the least to the largest of some points, and sqrt(K/J) there [rad/s]."""
    joint, path = (
        {**vibrating_joint.parameters, **vibrating_joint.body.elastic},
        folder / f"{vibrating_joint.fmu}.fmu",
    )
    ends, inertia = [point.load for point in points], points[0].inertia
    loads = np.linspace(min(ends), max(ends), LINE)
    stiffness = np.array([vibrating_joint.body.rest(path, float(load), joint).stiffness for load in loads])
    return loads, np.sqrt(stiffness / inertia)


def _ring_at(
    joint: VibratingJoint, folder: Path, load: float, parameters: Mapping[str, Any], inertia: float
) -> Ringing:
    """Free motion about one working point, with parameters of the joint."""
    body, path = joint.body, folder / f"{joint.fmu}.fmu"
    rest, partner = body.rest(path, load, parameters), PARTNERS[body.partner]
    first, least = body.release / rest.stiffness, RESOLVED * abs(rest.position)
    if not first > least:
        raise ValueError(
            f"load = {load:g}: too large, its deflection of {rest.position:g} hides a first one of "
            f"{first:.3g}; allowed is more than {least:.3g}"
        )
    states = [v.name for v in partner.outputs[: partner.state_count]]
    start = {joint.key: inertia, states[0]: rest.position + first}
    forces = [v.name for v in partner.inputs]
    with (
        Slave(path, {**parameters, **body.start(load)}, body.motion, (body.force,)) as slave,
        Slave(folder / f"{body.partner}.fmu", start, forces, states) as mass,
    ):
        return _ring(slave, mass, rest, load, inertia)


def _ring(joint: Slave, body: Slave, rest: Rest, load: float, inertia: float) -> Ringing:
    expected = float(np.sqrt(rest.stiffness / inertia))
    stated = rest.damping / (2.0 * inertia * expected)
    if not stated < MOST_DAMPED:
        raise ValueError(
            f"load = {load:g}: damping ratio {stated:.3g} with the inertia {inertia:g}; allowed is "
            f"less than {MOST_DAMPED:g}, so that there are periods to count: take a larger inertia"
        )
    step = 2.0 * np.pi / (expected * PER_PERIOD)
    signal = motion(joint, body, rest.force, step, PERIODS * PER_PERIOD)[:, 0] - rest.position
    time = np.asarray(step * np.arange(signal.size), dtype=np.float64)
    messages = tuple(dict.fromkeys(joint.messages + body.messages))
    found = peak(signal, step), expected, damping_ratio(signal), stated
    return Ringing(load, inertia, *found, time, signal, messages)
