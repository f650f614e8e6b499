"""Robot as one system: its rigid bodies are one component, the drive of each driven joint another one.

Variables of a joint JOINT begin with its name. `JOINT.drive` is the component of its drive. The arm is the
component without a name. The states are counted from the start pose, in which all drives are unwound.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, make_dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from jointfmu.joints import MODELS
from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, CheckedParameters, Number, flatten_parameters, quantity_field
from jointfmu.quantity.declaration import group_field

from ...systems.fmu.model import InputSource, SystemComponent, SystemModel
from ...systems.multibody import (
    GROUND,
    Body,
    Frame,
    FrameMotion,
    Link,
    Payload,
    RotorMotion,
    TreeMotion,
    forward_dynamics,
    frame_motion,
)
from .elastic import ElasticAxis
from .names import make_identifier
from .plugin_robot import find_two_flange_fmu
from .rigid_tree import check_tree, find_frame, read_links

if TYPE_CHECKING:
    from mujoco import MjModel

STOP_TIME = 0.2
"""Stop time [s] of the default experiment."""
COMMUNICATION_STEP = 1e-3
"""Communication step [s] of the default experiment."""
REFERENCE_INTERVAL = 1e-4
"""Interval [s] of the references of the proof: short, because the friction of each load step is
calculated on a straight path."""
RESERVED_NAMES = ("payload", "tip")
"""First parts of names of variables, which no joint may have."""
_XYZ = ("x", "y", "z")


class Coordinate(NamedTuple):
    """Names and units of a joint's variables: position, speed, force, and motion since the start."""

    position: str
    speed: str
    force: str
    travel: str
    word: str
    unit: str
    force_unit: str


HINGE = Coordinate("phi", "w", "tau", "rotation", "angle", "rad", "N.m")
"""Names and units of the variables of a hinge."""
SLIDE = Coordinate("s", "v", "f", "displacement", "position", "m", "N")
"""Names and units of the variables of a slide."""


@dataclass(frozen=True, kw_only=True)
class HingeParameters(CheckedParameters):
    """Parameters of the FMU for a hinge of the robot."""

    phi_start: float = quantity_field("rad", "angle of the joint at the start")


@dataclass(frozen=True, kw_only=True)
class SlideParameters(CheckedParameters):
    """Parameters of the FMU for a slide of the robot."""

    s_start: float = quantity_field("m", "position of the joint at the start")


@dataclass(frozen=True, kw_only=True)
class RotorParameters(CheckedParameters):
    """Parameters of the FMU for the rotor of a drive's motor: its inertia."""

    J: float = quantity_field(
        "kg.m2", "moment of inertia of rotor and wave generator about their axis", gt=0.0
    )


@dataclass(frozen=True, kw_only=True)
class DrivenHingeParameters(HingeParameters):
    """Parameters of the FMU for a hinge of the robot with a drive."""

    motor: RotorParameters = group_field("motor of the joint")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RobotJoint:
    """Joint of the robot, with or without a drive.

    name          : first part of the names of its variables
    link          : link behind the joint
    start         : start position [rad or m]
    motor_load    : start value of the motor torque or force [N.m or N]
    drive         : parameter file of its drive; None: the joint is rigidly connected to its motor
    rotor_inertia : [kg.m2] of rotor and wave generator, with a drive
    is_coupled    : whether the spin of the rotor acts on the link that carries it
    """

    name: str
    link: Link
    start: float
    motor_load: float
    drive: ParameterFile | None = None
    rotor_inertia: float = 0.0
    is_coupled: bool = True

    @property
    def coordinate(self) -> Coordinate:
        """Names and units of the variables of this joint."""
        return SLIDE if self.link.is_slide else HINGE

    def make_parameters(self) -> CheckedParameters:
        """Parameter set of the FMU for this joint."""
        if self.link.is_slide:
            return SlideParameters(s_start=self.start)
        if self.drive:
            return DrivenHingeParameters(phi_start=self.start, motor=RotorParameters(J=self.rotor_inertia))
        return HingeParameters(phi_start=self.start)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RobotArm:
    """Rigid bodies of a robot with the rotors of its drives.

    joints           : in the order of the links
    gravity          : (3) [m/s2] acceleration of free fall
    tip              : frame of the tip body
    has_motor_angles : whether the motion of the motors is prescribed; otherwise their torque
    """

    joints: Sequence[RobotJoint]
    gravity: Sequence[float]
    tip: Frame
    has_motor_angles: bool

    def is_free(self, joint: RobotJoint) -> bool:
        """Whether the position of a joint is a state of the FMU."""
        return joint.drive is not None or not self.has_motor_angles

    def list_inputs(self) -> list[Variable]:
        """Inputs of the arm: those of the motors, and the torques of the drives."""
        variables = []
        for joint in self.joints:
            c, name = joint.coordinate, joint.name
            side = (
                "of the motor from the start"
                if joint.drive
                else "of the joint from the start, which has no drive"
            )
            if self.has_motor_angles:
                variables += [
                    Variable(f"{name}.{c.position}_motor", c.unit, f"{c.word} {side}"),
                    Variable(f"{name}.{c.speed}_motor", f"{c.unit}/s", "speed of the motor"),
                    Variable(f"{name}.a_motor", f"{c.unit}/s2", "acceleration of the motor"),
                ]
            else:
                side = "on the rotor" if joint.drive else "on the joint, which has no drive"
                variables.append(
                    Variable(f"{name}.{c.force}_motor", c.force_unit, f"load of the motor {side}")
                )
            if joint.drive:
                variables.append(Variable(f"{name}.tau2", "N.m", "torque of the drive on the link"))
                if not self.has_motor_angles:
                    variables.append(Variable(f"{name}.tau1", "N.m", "torque of the drive on the rotor"))
        return variables

    def list_states(self) -> tuple[list[Variable], list[Variable], list[Variable]]:
        """States and their rates: positions, speeds, accelerations of the free joints, then of the rotors."""
        positions, speeds, accelerations = [], [], []
        for joint in filter(self.is_free, self.joints):
            c, name = joint.coordinate, joint.name
            positions.append(
                Variable(f"{name}.{c.travel}", c.unit, f"{c.word} of the joint from the start", 0.1)
            )
            speeds.append(Variable(f"{name}.{c.speed}", f"{c.unit}/s", "speed of the joint", 0.1))
            accelerations.append(Variable(f"{name}.a", f"{c.unit}/s2", "acceleration of the joint", 1e2))
        for name in [] if self.has_motor_angles else [joint.name for joint in self.joints if joint.drive]:
            side = "of the rotor against the link that carries it"
            positions.append(Variable(f"{name}.motor.phi", "rad", f"angle {side}, from the start", 1e1))
            speeds.append(Variable(f"{name}.motor.w", "rad/s", f"speed {side}", 1e1))
            accelerations.append(Variable(f"{name}.motor.a", "rad/s2", f"acceleration {side}", 1e4))
        return positions, speeds, accelerations

    def list_kinematic_outputs(self) -> list[Variable]:
        """Outputs that follow from positions and speeds."""
        variables = []
        for joint in self.joints:
            c = joint.coordinate
            variables.append(Variable(f"{joint.name}.{c.position}", c.unit, f"{c.word} of the joint"))
            if not self.is_free(joint):
                variables.append(Variable(f"{joint.name}.{c.speed}", f"{c.unit}/s", "speed of the joint"))
        variables += [Variable(f"tip.{x}", "m", f"position of the tip along {x} of the ground") for x in _XYZ]
        variables += [
            Variable(f"tip.v_{x}", "m/s", f"velocity of the tip along {x} of the ground") for x in _XYZ
        ]
        variables += [
            Variable(f"tip.w_{x}", "rad/s", f"angular velocity of the tip body about {x}") for x in _XYZ
        ]
        variables += [
            Variable(f"tip.R_{x}{y}", "1", f"component along {x} of the ground of axis {y} of the tip body")
            for x in _XYZ
            for y in _XYZ
        ]
        return variables

    def evaluate_outputs(self, parameters: Any, values: Mapping[str, Number]) -> dict[str, Number]:
        """All outputs of the arm, for a parameter set and the values of time, inputs and states."""
        positions, speeds, motion, tip = self.compute_motion(parameters, values)
        outputs = dict(values)
        for i, joint in enumerate(self.joints):
            c, name = joint.coordinate, joint.name
            outputs |= {f"{name}.{c.position}": positions[i], f"{name}.{c.speed}": speeds[i]}
            outputs[f"{name}.a"] = motion.accelerations[i]
            if joint.drive:
                outputs[f"{name}.motor.a"] = motion.rotor_accelerations[joint.link.name]
        for i, x in enumerate(_XYZ):
            outputs |= {f"tip.{x}": tip.position[i], f"tip.v_{x}": tip.velocity[i]}
            outputs[f"tip.w_{x}"] = tip.angular_velocity[i]
            outputs |= {f"tip.R_{x}{y}": tip.rotation[i][j] for j, y in enumerate(_XYZ)}
        return outputs

    def compute_motion(
        self, parameters: Any, values: Mapping[str, Number]
    ) -> tuple[list[Number], list[Number], TreeMotion, FrameMotion]:
        """Joint positions and speeds, accelerations of joints and rotors, motion of the tip."""
        positions, speeds, forces, given, rotors, payload = self._collect_loads(parameters, values)
        links = [joint.link for joint in self.joints]
        return (
            positions,
            speeds,
            forward_dynamics(links, self.gravity, positions, speeds, forces, given, rotors, payload),
            frame_motion(links, self.tip, positions, speeds),
        )

    def evaluate_residuals(self, parameters: Any, values: Mapping[str, Number]) -> list[Number]:
        """Forces that the accelerations need, minus the acting forces, of free joints and of rotors."""
        positions, speeds, forces, given, rotors, payload = self._collect_loads(parameters, values)
        links, free = [joint.link for joint in self.joints], list(map(self.is_free, self.joints))
        names = {joint.link.name: joint.name for joint in self.joints}
        accelerations = [
            values[f"{joint.name}.a"] if is_free else a
            for joint, is_free, a in zip(self.joints, free, given, strict=True)
        ]
        moved = {
            name: rotor
            if rotor.torque is None
            else replace(rotor, torque=None, acceleration=values[f"{names[name]}.motor.a"])
            for name, rotor in rotors.items()
        }
        needed = forward_dynamics(
            links, self.gravity, positions, speeds, [None] * len(links), accelerations, moved, payload
        )
        residuals = [
            due - force for due, force, is_free in zip(needed.forces, forces, free, strict=True) if is_free
        ]
        return residuals + [
            needed.rotor_torques[name] - rotor.torque
            for name, rotor in rotors.items()
            if rotor.torque is not None
        ]

    def _collect_loads(self, parameters: Any, values: Mapping[str, Number]) -> tuple[Any, ...]:
        """Positions, speeds, forces, prescribed accelerations, rotors and payload for `forward_dynamics`."""
        positions, speeds, forces, given = [], [], list[Number | None](), []
        rotors = {}
        for k, joint in enumerate(self.joints):
            c, name, own = joint.coordinate, joint.name, getattr(parameters, f"joint{k}")
            position, speed = f"{name}.{c.travel}", f"{name}.{c.speed}"
            if not self.is_free(joint):
                position, speed = f"{name}.{c.position}_motor", f"{name}.{c.speed}_motor"
            positions.append(getattr(own, f"{c.position}_start") + values[position])
            speeds.append(values[speed])
            given.append(0.0 if self.is_free(joint) else values[f"{name}.a_motor"])
            if not joint.drive:
                forces.append(values[f"{name}.{c.force}_motor"] if self.is_free(joint) else None)
                continue
            forces.append(values[f"{name}.tau2"])
            if self.has_motor_angles:
                motion = {"speed": values[f"{name}.w_motor"], "acceleration": values[f"{name}.a_motor"]}
            else:
                torque = values[f"{name}.tau_motor"] + values[f"{name}.tau1"]
                motion = {"speed": values[f"{name}.motor.w"], "torque": torque}
            rotors[joint.link.name] = RotorMotion(own.motor.J, is_coupled=joint.is_coupled, **motion)
        return positions, speeds, forces, given, rotors, parameters.payload.make_body(self.tip)

    def make_component(self, payload: float) -> SystemComponent:
        """Component of a system, with the payload [kg] at the origin of the tip body."""
        groups: dict[str, tuple[str, CheckedParameters]] = {
            "payload": ("payload", Payload.at_origin(payload)),
            **{f"joint{k}": (joint.name, joint.make_parameters()) for k, joint in enumerate(self.joints)},
        }
        sets = [
            (key, type(values), group_field(name, **{name: type(values)}))
            for key, (name, values) in groups.items()
        ]
        parameter_class = make_dataclass("RobotParameters", sets, frozen=True, kw_only=True)
        values = parameter_class(**{key: values for key, (_, values) in groups.items()})
        names = flatten_parameters(values)
        file = ParameterFile(
            "robot",
            "robot",
            values,
            dict.fromkeys(names, "derived"),
            dict.fromkeys(names, "robot file and options"),
        )
        sources: dict[str, InputSource | None] = {}
        start_values = {}
        for joint in self.joints:
            if joint.drive:
                drive = f"{joint.name}.drive"
                sources[f"{joint.name}.tau2"] = InputSource(drive, "tau2")
                if not self.has_motor_angles:
                    sources[f"{joint.name}.tau1"] = InputSource(drive, "tau1")
            if not self.has_motor_angles:
                start_values[f"{joint.name}.{joint.coordinate.force}_motor"] = joint.motor_load
        return SystemComponent("", self._make_model(parameter_class), file, sources, start_values)

    def _make_model(self, parameter_class: type) -> Model:
        """Model of the arm as a component of a system."""
        inputs, states, kinematic_outputs = (
            self.list_inputs(),
            self.list_states(),
            self.list_kinematic_outputs(),
        )
        positions, speeds, accelerations = states
        state_names = [v.name for v in (*positions, *speeds)]
        knowns = [v.name for v in inputs]
        prescribed = [
            name for name in knowns if self.has_motor_angles and "_motor" in name.rpartition(".")[2]
        ]
        dependencies = {name: [name] for name in state_names}
        dependencies |= {v.name: [*knowns, *state_names] for v in accelerations}
        dependencies |= {v.name: [*prescribed, *state_names] for v in kinematic_outputs}
        return Model(
            name="RobotArm",
            joint="robot",
            doc="rigid bodies of the robot",
            parameter_class=parameter_class,
            tabulate=lambda parameters: parameters,
            inputs=inputs,
            outputs=[*positions, *speeds, *accelerations, *kinematic_outputs],
            evaluate=self.evaluate_outputs,
            validity_limits=(),
            ramp=LoadRamp(inputs[0].name, 1.0, COMMUNICATION_STEP, COMMUNICATION_STEP),
            dependencies=dependencies,
            state_count=len(state_names),
            evaluate_residuals=self.evaluate_residuals,
            is_time_dependent=True,
        )


def read_arm(
    model: "MjModel",
    axes: Sequence[ElasticAxis],
    drive_files: Mapping[str, ParameterFile],
    pose: Array,
    payload: float,
    tip_body: int,
    has_motor_angles: bool = False,
) -> RobotArm:
    """Rigid bodies of a robot whose drives are unwound at a pose.

    axes        : joints with a drive
    drive_files : {joint: parameter file of its drive}
    pose        : positions of all joints, as MuJoCo's qpos [rad or m]
    payload     : mass [kg] at the origin of the body `tip_body`, which the motor loads at the start hold

    Raises ValueError as `name_joints`.
    """
    links, tip = read_links(model, drive_files), find_frame(model, tip_body)
    inertias = {axis.joint: axis.rotor_inertia / axis.drive.ratio**2 for axis in axes}
    ratios = {axis.joint: axis.drive.ratio for axis in axes}
    positions, gravity = pose.tolist(), model.opt.gravity.tolist()
    body, rest = Body(tip, payload, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), [0.0] * len(links)
    held = forward_dynamics(links, gravity, positions, rest, [None] * len(links), payload=body).forces
    joints = []
    for k, (name, link) in enumerate(zip(name_joints(model), links, strict=True)):
        rotor = inertias.get(link.name, 0.0)
        joints.append(
            RobotJoint(
                name=name,
                link=link,
                start=float(positions[k]),
                motor_load=float(held[k]) / ratios.get(link.name, 1.0),
                drive=drive_files.get(link.name),
                rotor_inertia=rotor,
                is_coupled=link.parent == GROUND or _includes_rotor(links[link.parent], link, rotor),
            )
        )
    return RobotArm(joints=joints, gravity=gravity, tip=tip, has_motor_angles=has_motor_angles)


def name_joints(model: "MjModel") -> list[str]:
    """Names of the joints in the FMU.

    Raises ValueError, one line, if the robot is no tree of hinges and slides, or if two names are equal.
    """
    check_tree(model)
    names: list[str] = []
    for k in range(model.njnt):
        name = make_identifier(model.joint(k).name or f"joint{k + 1}")
        if name in names or name in RESERVED_NAMES:
            raise ValueError(f"two variables would be named {name}; rename the joint {model.joint(k).name!r}")
        names.append(name)
    return names


def _includes_rotor(carrier: Link, link: Link, rotor_inertia: float) -> bool:
    """Whether the inertia of the link that carries a rotor is large enough to include it."""
    axis = link.rotation[:, 2]
    return bool(np.linalg.eigvalsh(carrier.inertia - rotor_inertia * np.outer(axis, axis))[0] >= 0.0)


def make_robot_system(arm: RobotArm, name: str, description: str, payload: float) -> SystemModel:
    """Model of the system of arm and drives.

    payload : [kg] at the origin of the tip body
    """
    motor = ("phi_motor", "w_motor") if arm.has_motor_angles else ("motor.phi", "motor.w")
    components = []
    for joint in arm.joints:
        if joint.drive:
            file = joint.drive
            model = MODELS[find_two_flange_fmu(file)].with_parameters(file.joint, file.values)
            flanges = {"phi1": motor[0], "w1": motor[1], "phi2": "rotation", "w2": "w"}
            sources: dict[str, InputSource | None] = {
                key: InputSource("", f"{joint.name}.{variable}") for key, variable in flanges.items()
            }
            starts = {v.name: file.start_value(v.name) for v in model.inputs}
            components.append(SystemComponent(f"{joint.name}.drive", model, file, sources, starts))
    components.append(arm.make_component(payload))
    return SystemModel(name, description, components, STOP_TIME, COMMUNICATION_STEP, REFERENCE_INTERVAL)
