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
    GROUND_INDEX,
    Frame,
    FrameMotion,
    Link,
    Payload,
    RigidBody,
    RotorMotion,
    TreeMotion,
    compute_frame_motion,
    forward_dynamics,
)
from .elastic import ElasticAxis
from .names import make_identifier
from .plugin_robot import find_two_flange_fmu
from .rigid_tree import check_joint_tree, find_body_frame, read_links

if TYPE_CHECKING:
    from mujoco import MjModel

STOP_TIME = 0.2
"""Stop time [s] of the default experiment."""
COMMUNICATION_STEP = 1e-3
"""Communication step [s] of the default experiment."""
REFERENCE_OUTPUT_INTERVAL = 1e-4
"""Interval [s] of the references of the proof: short, because the friction of each load step is
calculated on a straight path."""
RESERVED_JOINT_NAMES = ("payload", "tip")
"""First parts of names of variables, which no joint may have."""
_AXIS_LETTERS = ("x", "y", "z")


class JointVariableNames(NamedTuple):
    """Names and units of a joint's variables: position, speed, force, and motion since the start."""

    position_name: str
    speed_name: str
    force_name: str
    displacement_name: str
    position_word: str
    position_unit: str
    force_unit: str


HINGE_VARIABLES = JointVariableNames("phi", "w", "tau", "rotation", "angle", "rad", "N.m")
"""Names and units of the variables of a hinge."""
SLIDE_VARIABLES = JointVariableNames("s", "v", "f", "displacement", "position", "m", "N")
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

    joint_name       : first part of the names of its variables
    link             : link behind the joint
    start_position   : start position [rad or m]
    motor_load       : start value of the motor torque or force [N.m or N]
    drive            : parameter file of its drive; None: the joint is rigidly connected to its motor
    rotor_inertia    : [kg.m2] of rotor and wave generator, with a drive
    is_rotor_coupled : whether the spin of the rotor acts on the link that carries it
    """

    joint_name: str
    link: Link
    start_position: float
    motor_load: float
    drive: ParameterFile | None = None
    rotor_inertia: float = 0.0
    is_rotor_coupled: bool = True

    @property
    def variable_names(self) -> JointVariableNames:
        """Names and units of the variables of this joint."""
        return SLIDE_VARIABLES if self.link.is_sliding_joint else HINGE_VARIABLES

    def make_parameter_set(self) -> CheckedParameters:
        """Parameter set of the FMU for this joint."""
        if self.link.is_sliding_joint:
            return SlideParameters(s_start=self.start_position)
        if self.drive:
            return DrivenHingeParameters(
                phi_start=self.start_position, motor=RotorParameters(J=self.rotor_inertia)
            )
        return HingeParameters(phi_start=self.start_position)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RobotArm:
    """Rigid bodies of a robot with the rotors of its drives.

    joints                      : in the order of the links
    gravity                     : (3) [m/s2] acceleration of free fall
    tip_frame                   : frame of the tip body
    has_prescribed_motor_motion : whether the motion of the motors is prescribed; otherwise their torque
    """

    joints: Sequence[RobotJoint]
    gravity: Sequence[float]
    tip_frame: Frame
    has_prescribed_motor_motion: bool

    def is_free(self, joint: RobotJoint) -> bool:
        """Whether the position of a joint is a state of the FMU."""
        return joint.drive is not None or not self.has_prescribed_motor_motion

    def list_inputs(self) -> list[Variable]:
        """Inputs of the arm: those of the motors, and the torques of the drives."""
        variables = []
        for joint in self.joints:
            c, name = joint.variable_names, joint.joint_name
            side = (
                "of the motor from the start"
                if joint.drive
                else "of the joint from the start, which has no drive"
            )
            if self.has_prescribed_motor_motion:
                variables += [
                    Variable(f"{name}.{c.position_name}_motor", c.position_unit, f"{c.position_word} {side}"),
                    Variable(f"{name}.{c.speed_name}_motor", f"{c.position_unit}/s", "speed of the motor"),
                    Variable(f"{name}.a_motor", f"{c.position_unit}/s2", "acceleration of the motor"),
                ]
            else:
                side = "on the rotor" if joint.drive else "on the joint, which has no drive"
                variables.append(
                    Variable(f"{name}.{c.force_name}_motor", c.force_unit, f"load of the motor {side}")
                )
            if joint.drive:
                variables.append(Variable(f"{name}.tau2", "N.m", "torque of the drive on the link"))
                if not self.has_prescribed_motor_motion:
                    variables.append(Variable(f"{name}.tau1", "N.m", "torque of the drive on the rotor"))
        return variables

    def list_states(self) -> tuple[list[Variable], list[Variable], list[Variable]]:
        """States and their rates: positions, speeds, accelerations of the free joints, then of the rotors."""
        positions, speeds, accelerations = [], [], []
        for joint in filter(self.is_free, self.joints):
            c, name = joint.variable_names, joint.joint_name
            positions.append(
                Variable(
                    f"{name}.{c.displacement_name}",
                    c.position_unit,
                    f"{c.position_word} of the joint from the start",
                    0.1,
                )
            )
            speeds.append(
                Variable(f"{name}.{c.speed_name}", f"{c.position_unit}/s", "speed of the joint", 0.1)
            )
            accelerations.append(
                Variable(f"{name}.a", f"{c.position_unit}/s2", "acceleration of the joint", 1e2)
            )
        for name in (
            []
            if self.has_prescribed_motor_motion
            else [joint.joint_name for joint in self.joints if joint.drive]
        ):
            side = "of the rotor against the link that carries it"
            positions.append(Variable(f"{name}.motor.phi", "rad", f"angle {side}, from the start", 1e1))
            speeds.append(Variable(f"{name}.motor.w", "rad/s", f"speed {side}", 1e1))
            accelerations.append(Variable(f"{name}.motor.a", "rad/s2", f"acceleration {side}", 1e4))
        return positions, speeds, accelerations

    def list_kinematic_outputs(self) -> list[Variable]:
        """Outputs that follow from positions and speeds."""
        variables = []
        for joint in self.joints:
            c = joint.variable_names
            variables.append(
                Variable(
                    f"{joint.joint_name}.{c.position_name}",
                    c.position_unit,
                    f"{c.position_word} of the joint",
                )
            )
            if not self.is_free(joint):
                variables.append(
                    Variable(
                        f"{joint.joint_name}.{c.speed_name}", f"{c.position_unit}/s", "speed of the joint"
                    )
                )
        variables += [
            Variable(f"tip.{x}", "m", f"position of the tip along {x} of the ground") for x in _AXIS_LETTERS
        ]
        variables += [
            Variable(f"tip.v_{x}", "m/s", f"velocity of the tip along {x} of the ground")
            for x in _AXIS_LETTERS
        ]
        variables += [
            Variable(f"tip.w_{x}", "rad/s", f"angular velocity of the tip body about {x}")
            for x in _AXIS_LETTERS
        ]
        variables += [
            Variable(f"tip.R_{x}{y}", "1", f"component along {x} of the ground of axis {y} of the tip body")
            for x in _AXIS_LETTERS
            for y in _AXIS_LETTERS
        ]
        return variables

    def evaluate_outputs(
        self, parameter_set: Any, variable_values: Mapping[str, Number]
    ) -> dict[str, Number]:
        """All outputs of the arm, for a parameter set and the values of time, inputs and states."""
        positions, speeds, motion, tip = self.compute_motion(parameter_set, variable_values)
        outputs = dict(variable_values)
        for i, joint in enumerate(self.joints):
            c, name = joint.variable_names, joint.joint_name
            outputs |= {f"{name}.{c.position_name}": positions[i], f"{name}.{c.speed_name}": speeds[i]}
            outputs[f"{name}.a"] = motion.joint_accelerations[i]
            if joint.drive:
                outputs[f"{name}.motor.a"] = motion.rotor_accelerations[joint.link.name]
        for i, x in enumerate(_AXIS_LETTERS):
            outputs |= {f"tip.{x}": tip.position[i], f"tip.v_{x}": tip.velocity[i]}
            outputs[f"tip.w_{x}"] = tip.angular_velocity[i]
            outputs |= {f"tip.R_{x}{y}": tip.rotation[i][j] for j, y in enumerate(_AXIS_LETTERS)}
        return outputs

    def compute_motion(
        self, parameter_set: Any, variable_values: Mapping[str, Number]
    ) -> tuple[list[Number], list[Number], TreeMotion, FrameMotion]:
        """Joint positions and speeds, accelerations of joints and rotors, motion of the tip."""
        positions, speeds, forces, given, rotors, payload = self._collect_loads(
            parameter_set, variable_values
        )
        links = [joint.link for joint in self.joints]
        return (
            positions,
            speeds,
            forward_dynamics(links, self.gravity, positions, speeds, forces, given, rotors, payload),
            compute_frame_motion(links, self.tip_frame, positions, speeds),
        )

    def evaluate_residuals(self, parameter_set: Any, variable_values: Mapping[str, Number]) -> list[Number]:
        """Residuals of the equations of motion of free joints and rotors: required minus acting forces."""
        positions, speeds, forces, given, rotors, payload = self._collect_loads(
            parameter_set, variable_values
        )
        links, free = [joint.link for joint in self.joints], list(map(self.is_free, self.joints))
        names = {joint.link.name: joint.joint_name for joint in self.joints}
        accelerations = [
            variable_values[f"{joint.joint_name}.a"] if is_free else a
            for joint, is_free, a in zip(self.joints, free, given, strict=True)
        ]
        moved = {
            name: rotor
            if rotor.torque is None
            else replace(rotor, torque=None, acceleration=variable_values[f"{names[name]}.motor.a"])
            for name, rotor in rotors.items()
        }
        needed = forward_dynamics(
            links, self.gravity, positions, speeds, [None] * len(links), accelerations, moved, payload
        )
        residuals = [
            due - force
            for due, force, is_free in zip(needed.joint_forces, forces, free, strict=True)
            if is_free
        ]
        return residuals + [
            needed.rotor_torques[name] - rotor.torque
            for name, rotor in rotors.items()
            if rotor.torque is not None
        ]

    def _collect_loads(self, parameter_set: Any, variable_values: Mapping[str, Number]) -> tuple[Any, ...]:
        """Positions, speeds, forces, prescribed accelerations, rotors and payload for `forward_dynamics`."""
        positions, speeds, forces, given = [], [], list[Number | None](), []
        rotors = {}
        for k, joint in enumerate(self.joints):
            c, name, own = joint.variable_names, joint.joint_name, getattr(parameter_set, f"joint{k}")
            position, speed = f"{name}.{c.displacement_name}", f"{name}.{c.speed_name}"
            if not self.is_free(joint):
                position, speed = f"{name}.{c.position_name}_motor", f"{name}.{c.speed_name}_motor"
            positions.append(getattr(own, f"{c.position_name}_start") + variable_values[position])
            speeds.append(variable_values[speed])
            given.append(0.0 if self.is_free(joint) else variable_values[f"{name}.a_motor"])
            if not joint.drive:
                forces.append(
                    variable_values[f"{name}.{c.force_name}_motor"] if self.is_free(joint) else None
                )
                continue
            forces.append(variable_values[f"{name}.tau2"])
            if self.has_prescribed_motor_motion:
                motion = {
                    "speed": variable_values[f"{name}.w_motor"],
                    "acceleration": variable_values[f"{name}.a_motor"],
                }
            else:
                torque = variable_values[f"{name}.tau_motor"] + variable_values[f"{name}.tau1"]
                motion = {"speed": variable_values[f"{name}.motor.w"], "torque": torque}
            rotors[joint.link.name] = RotorMotion(own.motor.J, is_coupled=joint.is_rotor_coupled, **motion)
        return positions, speeds, forces, given, rotors, parameter_set.payload.make_body(self.tip_frame)

    def make_arm_component(self, payload_mass: float) -> SystemComponent:
        """Arm as a component of a system model, with the payload [kg] at the origin of the tip body."""
        groups: dict[str, tuple[str, CheckedParameters]] = {
            "payload": ("payload", Payload.make_point_mass(payload_mass)),
            **{
                f"joint{k}": (joint.joint_name, joint.make_parameter_set())
                for k, joint in enumerate(self.joints)
            },
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
                drive = f"{joint.joint_name}.drive"
                sources[f"{joint.joint_name}.tau2"] = InputSource(drive, "tau2")
                if not self.has_prescribed_motor_motion:
                    sources[f"{joint.joint_name}.tau1"] = InputSource(drive, "tau1")
            if not self.has_prescribed_motor_motion:
                start_values[f"{joint.joint_name}.{joint.variable_names.force_name}_motor"] = joint.motor_load
        return SystemComponent("", self._make_arm_model(parameter_class), file, sources, start_values)

    def _make_arm_model(self, parameter_class: type) -> Model:
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
            name
            for name in knowns
            if self.has_prescribed_motor_motion and "_motor" in name.rpartition(".")[2]
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
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    drive_files: Mapping[str, ParameterFile],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
    has_prescribed_motor_motion: bool = False,
) -> RobotArm:
    """Rigid bodies of a robot that starts at a pose, with zero wind-up of its drives.

    robot_axes   : joints with a drive
    drive_files  : {joint: parameter file of its drive}
    robot_pose   : positions of all joints, as MuJoCo's qpos [rad or m]
    payload_mass : mass [kg] at the origin of the body `tip_body`; the start values of the motor torques
                   balance its weight and that of the links

    Raises ValueError as `list_joint_names`.
    """
    links, tip = read_links(robot_model, drive_files), find_body_frame(robot_model, tip_body)
    inertias = {axis.joint_name: axis.rotor_inertia / axis.drive.ratio**2 for axis in robot_axes}
    ratios = {axis.joint_name: axis.drive.ratio for axis in robot_axes}
    positions, gravity = robot_pose.tolist(), robot_model.opt.gravity.tolist()
    body, rest = RigidBody(tip, payload_mass, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), [0.0] * len(links)
    held = forward_dynamics(links, gravity, positions, rest, [None] * len(links), payload=body).joint_forces
    joints = []
    for k, (name, link) in enumerate(zip(list_joint_names(robot_model), links, strict=True)):
        rotor = inertias.get(link.name, 0.0)
        joints.append(
            RobotJoint(
                joint_name=name,
                link=link,
                start_position=float(positions[k]),
                motor_load=float(held[k]) / ratios.get(link.name, 1.0),
                drive=drive_files.get(link.name),
                rotor_inertia=rotor,
                is_rotor_coupled=link.parent_index == GROUND_INDEX
                or _includes_rotor(links[link.parent_index], link, rotor),
            )
        )
    return RobotArm(
        joints=joints, gravity=gravity, tip_frame=tip, has_prescribed_motor_motion=has_prescribed_motor_motion
    )


def list_joint_names(robot_model: "MjModel") -> list[str]:
    """Names of the joints in the FMU.

    Raises ValueError, one line, if the robot is no tree of hinges and slides, or if two names are equal.
    """
    check_joint_tree(robot_model)
    names: list[str] = []
    for k in range(robot_model.njnt):
        name = make_identifier(robot_model.joint(k).name or f"joint{k + 1}")
        if name in names or name in RESERVED_JOINT_NAMES:
            raise ValueError(
                f"two variables would be named {name}; rename the joint {robot_model.joint(k).name!r}"
            )
        names.append(name)
    return names


def _includes_rotor(carrier_link: Link, link: Link, rotor_inertia: float) -> bool:
    """Whether the inertia of a link minus that of the rotor it carries, about the joint axis, is physical.

    True if the difference is positive semidefinite: then the stated inertia can include the rotor.
    """
    axis = link.rotation[:, 2]
    return bool(np.linalg.eigvalsh(carrier_link.inertia - rotor_inertia * np.outer(axis, axis))[0] >= 0.0)


def make_robot_system(
    arm: RobotArm, system_name: str, system_description: str, payload_mass: float
) -> SystemModel:
    """Model of the system of arm and drives.

    payload_mass : [kg] at the origin of the tip body
    """
    motor = ("phi_motor", "w_motor") if arm.has_prescribed_motor_motion else ("motor.phi", "motor.w")
    components = []
    for joint in arm.joints:
        if joint.drive:
            file = joint.drive
            model = MODELS[find_two_flange_fmu(file)].with_parameters(file.joint, file.values)
            flanges = {"phi1": motor[0], "w1": motor[1], "phi2": "rotation", "w2": "w"}
            sources: dict[str, InputSource | None] = {
                key: InputSource("", f"{joint.joint_name}.{variable}") for key, variable in flanges.items()
            }
            starts = {v.name: file.start_value(v.name) for v in model.inputs}
            components.append(SystemComponent(f"{joint.joint_name}.drive", model, file, sources, starts))
    components.append(arm.make_arm_component(payload_mass))
    return SystemModel(
        system_name, system_description, components, STOP_TIME, COMMUNICATION_STEP, REFERENCE_OUTPUT_INTERVAL
    )
