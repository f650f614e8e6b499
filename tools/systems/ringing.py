"""Free vibration of a body on a nonlinear joint, by running FMUs: frequency and damping over the load."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters

from jointfmu.joints import KINDS
from jointfmu.progress import track_progress
from jointfmu.quantity import Array, flatten_fields

from ..common.joint_parts import load_tool_module
from .master import Slave, damping_ratio, find_peak_frequency, simulate_body_on_joint
from .ssp import find_fmu_names, list_archive_values
from .system import Component, System, load_systems
from .wiring import find_connections, find_signals

STEPS_PER_PERIOD = 100
"""Number of communication steps per period of a vibration [1]."""
SIMULATED_PERIOD_COUNT = 25
"""Number of periods of a simulation [1]."""
RESONANCE_TOLERANCE = 5e-3
"""Relative tolerance [1] of the spectral peak frequency against sqrt(K/J)."""
DAMPING_TOLERANCE = 1e-2
"""Relative tolerance [1] of the damping ratio by the decrement against the ratio of the joint."""
FREQUENCY_CURVE_POINT_COUNT = 41
"""Number of points of a curve over the load [1]."""
MIN_INITIAL_OVER_REST_DEFLECTION = 1e-10
"""Smallest initial deflection of a vibration over the deflection of the joint at its working point [1].

Round-off of the vibration is then 1e-6 of its amplitude."""
MAX_DAMPING_RATIO = 0.1
"""Largest damping ratio of a vibration [1]: more leaves too few periods to determine the frequency."""
_MIN_DAMPING_RATIO = 1e-6
"""Damping ratio [1] below which the damping is not compared: the decrement is accurate to 2e-9."""


@dataclass(frozen=True, slots=True)
class FreeVibration:
    """Simulated free vibration of a body on a joint about one working point.

    joint_load         : load on the joint, in SI units
    inertia            : inertia or mass of the body [kg.m2 or kg]
    frequency          : angular frequency [rad/s] of the spectral peak of the simulated signal
    expected_frequency : sqrt(K/J) [rad/s]: K tangent stiffness of the joint at the working point, J inertia
    damping            : damping ratio [1] of the simulated decay
    expected_damping   : damping ratio [1] by the damping coefficient of the joint
    time               : [s]
    deflection         : deflection from the working point [rad or m]
    log_messages       : log messages of the FMUs
    """

    joint_load: float
    inertia: float
    frequency: float
    expected_frequency: float
    damping: float
    expected_damping: float
    time: Array
    deflection: Array
    log_messages: tuple[str, ...]

    @property
    def is_damped(self) -> bool:
        """Whether the joint has enough damping to be resolved by the decrement."""
        return self.expected_damping > _MIN_DAMPING_RATIO

    @property
    def deviation_texts(self) -> list[str]:
        """Texts on deviations beyond the tolerances, one line each."""
        pairs = [("frequency", self.frequency, self.expected_frequency, RESONANCE_TOLERANCE)]
        if self.is_damped:
            pairs.append(("damping", self.damping, self.expected_damping, DAMPING_TOLERANCE))
        return [
            f"load = {self.joint_load:g}: {name} {simulated:.6g}, expected {expected:.6g} within "
            f"{tolerance:.2%}"
            for name, simulated, expected, tolerance in pairs
            if not abs(simulated - expected) <= tolerance * expected
        ]


class WorkingPoint(NamedTuple):
    """Working point of a joint with a body, in SI units.

    force     : constant force or torque
    position  : position of rest
    stiffness : tangent stiffness of the joint
    damping   : damping coefficient of the joint
    """

    force: float
    position: float
    stiffness: float
    damping: float


class PlotAxis(NamedTuple):
    """Axis of a plot: name of the quantity, its unit, and the factor from SI to this unit."""

    quantity_name: str
    unit: str
    display_factor: float

    @property
    def axis_label(self) -> str:
        """Label of the axis: quantity and unit."""
        return f"{self.quantity_name} [{self.unit}]"


class SlipDeflection(NamedTuple):
    """Initial deflection of a body that makes its joint slip, with the load on the joint (SI units)."""

    joint_load: float
    deflection: float
    description: str


@dataclass(frozen=True, slots=True, kw_only=True)
class VibrationTest:
    """Vibration test of a kind of joint with a body. A joint defines it by the constant VIBRATION_TEST.

    model_name              : FMU of the joint, with motion as input
    motion_inputs           : inputs of the joint: position and speed of the body
    force_output            : output of the joint: force or torque on the body
    body_model              : FMU of the body
    load_variable           : variable that is the load on the joint
    find_example_loads      : (FMU of the joint, its parameters) -> example loads, in SI units
    find_start_values       : load -> {input of the joint: start value}
    find_working_point      : (FMU of the joint, load, its parameters) -> working point; ValueError if there
        is no vibration
    release_force           : force or torque that causes the initial deflection [N or N.m]
    load_axis               : plot axis of the load
    deflection_axis         : plot axis of the deflection
    support_description     : how the body is held, for the report
    stiffness_output        : variable of the joint that is the stiffness for the motion of the body
    deflection_for_slip     : initial deflection that makes the joint slip
    frictionless_parameters : {parameter: value} of the joint without friction, which adds stiffness at small
        amplitudes
    """

    model_name: str
    motion_inputs: tuple[str, str]
    force_output: str
    body_model: str
    load_variable: str
    find_example_loads: Callable[[Path, Mapping[str, Any]], Sequence[float]]
    find_start_values: Callable[[float], Mapping[str, float]]
    find_working_point: Callable[[Path, float, Mapping[str, float]], WorkingPoint]
    release_force: float
    load_axis: PlotAxis
    deflection_axis: PlotAxis
    support_description: str
    stiffness_output: str
    deflection_for_slip: SlipDeflection
    frictionless_parameters: Mapping[str, float] = field(default_factory=dict)


def load_vibration_test(joint_kind: str) -> VibrationTest:
    """Import the vibration test of a kind of joint; raises ValueError if the joint defines none."""
    tool_module = load_tool_module(KINDS[joint_kind], "ringing")
    if tool_module is None:
        joints = [name for name, kind in KINDS.items() if load_tool_module(kind, "ringing")]
        raise ValueError(
            f"joint {joint_kind!r} has no free vibration that can be simulated; allowed are "
            f"{', '.join(joints)}"
        )
    body: VibrationTest = tool_module.VIBRATION_TEST
    return body


@dataclass(frozen=True, slots=True)
class VibratingJoint:
    """Joint of a system with the body that vibrates on it; all other bodies are locked.

    vibration_test    : vibration test of the joint
    fmu_name          : name of the joint's FMU
    moving_body       : body that vibrates
    inertia_parameter : parameter of this body that is its inertia
    locked_bodies     : names of the other bodies on the joint
    """

    vibration_test: VibrationTest
    joint: Component
    fmu_name: str
    moving_body: Component
    inertia_parameter: str
    locked_bodies: tuple[str, ...]

    @property
    def parameters(self) -> dict[str, Any]:
        """Values of the joint's parameters in the system: {parameter of the joint's FMU: value}.

        All parameters if the system has its own FMU of the joint, which several joints may share. Otherwise
        only those that the system gives, as the FMU in `--fmus` may have other parameters.
        """
        if not self.joint.has_own_fmu:
            return self.joint.parameters
        return {name: entry.parameter_value for name, entry in list_archive_values(self.joint).items()}

    @property
    def inertia(self) -> float:
        """Inertia [kg.m2] or mass [kg] of the body."""
        value = self.moving_body.stated_values.get(self.inertia_parameter)
        return float(
            partner_parameters(self.moving_body.model_name).values_by_name[self.inertia_parameter]
            if value is None
            else value
        )

    @property
    def simplification_notes(self) -> list[str]:
        """Notes on what `simulate_vibrations` changes in the system, for the user."""
        notes = [
            f"{self.joint.name}: {name} = 0 in this simulation, not {self.parameters[name]:g}: the joint "
            "follows the midline of its loop. Small vibrations, in which nothing slips, have a higher "
            "frequency: state --amplitude"
            for name, value in self.vibration_test.frictionless_parameters.items()
            if self.parameters.get(name, value) != value
        ]
        if self.locked_bodies:
            notes.append(
                f"largest_step and largest_step_late are those with {', '.join(self.locked_bodies)} held; if "
                f"{'they move' if self.locked_bodies[1:] else 'it moves'}, the limits are shorter: jointfmu "
                "system compares interval with the limit of the system"
            )
        return notes

    @property
    def inertia_unit(self) -> str:
        """Unit of the inertia: kg.m2 or kg."""
        fields = dict(flatten_fields(PARTNERS[self.moving_body.model_name].parameter_class))
        return str(fields[self.inertia_parameter].metadata["unit"])

    @property
    def motion_unit(self) -> str:
        """Unit of the motion: rad or m."""
        return KINDS[self.joint.joint_kind].variables[self.vibration_test.motion_inputs[0]].unit

    @property
    def load_unit(self) -> str:
        """Unit of the load on the joint."""
        return KINDS[self.joint.joint_kind].variables[self.vibration_test.load_variable].unit


def find_vibrating_joint(system: System, joint_name: str | None = None) -> VibratingJoint:
    """Find a joint of a system and the body that vibrates on it.

    joint_name : name of the joint; None: the only joint of the system

    Raises ValueError if the system has no such joint or several, or if the joint has no vibration test.
    """
    joints = system.joints
    if joint_name is None and len(joints) > 1:
        raise ValueError(f"{system.name} has several joints; state one of {', '.join(joints)}")
    name = next(iter(joints)) if joint_name is None else joint_name
    if name not in joints:
        raise ValueError(f"joint {name!r} is not in {system.name}, allowed are {', '.join(joints)}")
    body = load_vibration_test(joints[name].joint_kind)
    body_names = [
        w.source_component
        for w in find_signals(system)
        if (w.target_component, w.target_input) == (name, body.motion_inputs[0])
    ]
    moving = system.components[body_names[0]] if body_names else None
    if joints[name].model_name != body.model_name or moving is None or moving.model_name != body.body_model:
        raise ValueError(
            f"{name}: expected a joint {body.model_name} with a {body.body_model} connected to "
            f"{body.motion_inputs[0]}"
        )
    key = next(iter(dict(flatten_fields(PARTNERS[body.body_model].parameter_class))))
    locked = [
        other.component.name
        for end, other in find_connections(system)
        if end.component is joints[name] and other.component and other.component != moving
    ]
    return VibratingJoint(
        body, joints[name], find_fmu_names(system)[name], moving, key, tuple(dict.fromkeys(locked))
    )


def simulate_example_vibrations(fmu_folder: Path) -> dict[str, list[FreeVibration]]:
    """Simulate all shipped systems of one vibrating joint, {system: results}.

    fmu_folder : folder with FMUs of FMI 2.0
    """
    return {name: simulate_vibrations(joint, fmu_folder) for name, joint in find_vibrating_joints().items()}


def find_vibrating_joints() -> dict[str, VibratingJoint]:
    """{system: vibrating joint} of the shipped systems with one joint that has a vibration test."""
    single = {n: s for n, s in load_systems().items() if len(s.joints) == 1}
    kinds = {n: next(iter(s.joints.values())).joint_kind for n, s in single.items()}
    return {
        n: find_vibrating_joint(s) for n, s in single.items() if load_tool_module(KINDS[kinds[n]], "ringing")
    }


def simulate_vibrations(
    vibrating_joint: VibratingJoint,
    fmu_folder: Path,
    joint_loads: Sequence[float] | None = None,
    inertia: float | None = None,
) -> list[FreeVibration]:
    """Simulate free vibrations of a body on its joint without friction, one for each load.

    fmu_folder  : folder of the FMUs (FMI 2.0) of joint and body
    joint_loads : loads in SI units; None: the example loads of the joint
    inertia     : [kg.m2 or kg] of the body; None: inertia in the system

    Raises ValueError if an FMU is missing or returns an error, or if there is no vibration.
    """
    parameters = {**vibrating_joint.parameters, **vibrating_joint.vibration_test.frictionless_parameters}
    if joint_loads is None:
        joint_loads = vibrating_joint.vibration_test.find_example_loads(
            fmu_folder / f"{vibrating_joint.fmu_name}.fmu", parameters
        )
    if inertia is None:
        inertia = vibrating_joint.inertia
    return [
        _simulate_vibration(vibrating_joint, fmu_folder, load, parameters, inertia)
        for load in track_progress(joint_loads, "ring", len(joint_loads))
    ]


def compute_frequency_curve(
    vibrating_joint: VibratingJoint, fmu_folder: Path, vibrations: Sequence[FreeVibration]
) -> tuple[Array, Array]:
    """Loads on the joint, and natural frequency sqrt(stiffness/inertia) [rad/s] of the body at each load.

    The loads are evenly spaced over the range of the simulated points.
    """
    joint = {**vibrating_joint.parameters, **vibrating_joint.vibration_test.frictionless_parameters}
    path = fmu_folder / f"{vibrating_joint.fmu_name}.fmu"
    ends, inertia = [point.joint_load for point in vibrations], vibrations[0].inertia
    loads = np.linspace(min(ends), max(ends), FREQUENCY_CURVE_POINT_COUNT)
    stiffness = np.array(
        [
            vibrating_joint.vibration_test.find_working_point(path, float(load), joint).stiffness
            for load in loads
        ]
    )
    return loads, np.sqrt(stiffness / inertia)


def _simulate_vibration(
    vibrating_joint: VibratingJoint,
    fmu_folder: Path,
    joint_load: float,
    joint_parameters: Mapping[str, Any],
    inertia: float,
) -> FreeVibration:
    """Simulate the free vibration at one load, with given parameters of the joint."""
    body, path = vibrating_joint.vibration_test, fmu_folder / f"{vibrating_joint.fmu_name}.fmu"
    rest, partner = body.find_working_point(path, joint_load, joint_parameters), PARTNERS[body.body_model]
    initial, smallest = (
        body.release_force / rest.stiffness,
        MIN_INITIAL_OVER_REST_DEFLECTION * abs(rest.position),
    )
    if not initial > smallest:
        raise ValueError(
            f"load = {joint_load:g} is too large: the vibration starts with {initial:.3g} from a rest "
            f"position of {rest.position:g}, expected more than {smallest:.3g}"
        )
    states = [v.name for v in partner.outputs[: partner.state_count]]
    start = {vibrating_joint.inertia_parameter: inertia, states[0]: rest.position + initial}
    forces = [v.name for v in partner.inputs]
    with (
        Slave(
            path,
            {**joint_parameters, **body.find_start_values(joint_load)},
            body.motion_inputs,
            (body.force_output,),
        ) as slave,
        Slave(fmu_folder / f"{body.body_model}.fmu", start, forces, states) as mass,
    ):
        return _run_vibration(slave, mass, rest, joint_load, inertia)


def _run_vibration(
    joint_slave: Slave, body_slave: Slave, working_point: WorkingPoint, joint_load: float, inertia: float
) -> FreeVibration:
    """Simulate the free vibration of a body on a joint about a working point; each is a running FMU."""
    expected = float(np.sqrt(working_point.stiffness / inertia))
    stated = working_point.damping / (2.0 * inertia * expected)
    if not stated < MAX_DAMPING_RATIO:
        raise ValueError(
            f"load = {joint_load:g}: damping ratio {stated:.3g} with the inertia {inertia:g}; allowed is "
            f"less than {MAX_DAMPING_RATIO:g}, so that it vibrates; state a larger inertia"
        )
    step = 2.0 * np.pi / (expected * STEPS_PER_PERIOD)
    signal = (
        simulate_body_on_joint(
            joint_slave, body_slave, working_point.force, step, SIMULATED_PERIOD_COUNT * STEPS_PER_PERIOD
        )[:, 0]
        - working_point.position
    )
    time = np.asarray(step * np.arange(signal.size), dtype=np.float64)
    messages = tuple(dict.fromkeys(joint_slave.log_messages + body_slave.log_messages))
    results = find_peak_frequency(signal, step), expected, damping_ratio(signal), stated
    return FreeVibration(joint_load, inertia, *results, time, signal, messages)
