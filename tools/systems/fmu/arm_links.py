"""Rigid links of a serial arm as one component of its system: weight, Coriolis and gyroscopic terms included.

The drives of a section [arm] act on this component instead of on separate inertias with precomputed torques.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jointfmu_fmu_src.partners.laws import GRAVITY

from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, CheckedParameters, Number, flatten_parameters
from jointfmu.quantity.declaration import group_field

from ..arm import Arm
from ..multibody import GROUND_INDEX, Frame, Link, Payload, TreeMotion, compute_frame_motion, forward_dynamics
from .model import InputSource, SystemComponent

_FRAME_AXES_BY_ROTATION_AXIS: Mapping[str, Array] = {
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "z": np.eye(3),
}
"""{name of a rotation axis: axes of a frame with z along this axis, as columns, in the frame of the link}."""


@dataclass(frozen=True, kw_only=True)
class ArmParameters(CheckedParameters):
    """Parameters of the links of an arm."""

    payload: Payload = group_field("payload at the tip, in addition to the last link")


@dataclass(frozen=True, slots=True, eq=False)
class ArmLinks:
    """Links of an arm as a model with states: angles from upright, then speeds.

    arm        : arm as read from a system file
    tree_links : the same links with the frames of `multibody`
    tip_frame  : frame of the tip
    """

    arm: Arm
    tree_links: Sequence[Link] = field(init=False)
    tip_frame: Frame = field(init=False)

    def __post_init__(self) -> None:
        links, distance, parent_axes = list[Link](), 0.0, np.eye(3)
        for k, (name, axis, link) in enumerate(
            zip(self.arm.axis_names, self.arm.rotation_axes, self.arm.links, strict=True)
        ):
            axes, along = _FRAME_AXES_BY_ROTATION_AXIS[axis], np.array([0.0, 0.0, 1.0])
            links.append(
                Link(
                    name=name,
                    parent_index=k - 1 if k else GROUND_INDEX,
                    is_sliding_joint=False,
                    rotation=parent_axes.T @ axes,
                    origin=parent_axes.T @ (distance * along),
                    mass=link.mass,
                    centre_of_mass=axes.T @ (link.centre * along),
                    inertia=axes.T @ np.diag([link.J_across, link.J_across, link.J_along]) @ axes,
                )
            )
            parent_axes, distance = axes, link.length
        object.__setattr__(self, "tree_links", links)
        object.__setattr__(
            self, "tip_frame", Frame(len(links) - 1, parent_axes.T, parent_axes.T @ [0.0, 0.0, distance])
        )

    def make_component(self) -> SystemComponent:
        """Make one system component of all links of the arm; the torque of each drive acts on its link."""
        values = ArmParameters(payload=Payload.make_point_mass(0.0))
        names = flatten_parameters(values)
        file = ParameterFile(
            "arm", "arm", values, dict.fromkeys(names, "derived"), dict.fromkeys(names, "section [arm]")
        )
        sources = {f"{name}_link.tau": InputSource(f"{name}_drive", "tau2") for name in self.arm.axis_names}
        return SystemComponent("", self._make_model(), file, sources, {})

    def _make_model(self) -> Model:
        """FMU model of the coupled links: input torques; output angles, speeds, accelerations and tip."""
        names = [f"{name}_link" for name in self.arm.axis_names]
        inputs = [Variable(f"{name}.tau", "N.m", "torque of the drive on the link") for name in names]
        positions = [Variable(f"{name}.phi", "rad", "angle of the axis from upright", 0.1) for name in names]
        speeds = [Variable(f"{name}.w", "rad/s", "speed of the axis", 0.1) for name in names]
        accelerations = [Variable(f"{name}.a", "rad/s2", "acceleration of the axis", 1e2) for name in names]
        tip = [Variable(f"tip.{x}", "m", f"position of the tip along {x} of the ground") for x in "xyz"]
        angles = [v.name for v in positions]
        states = [*angles, *(v.name for v in speeds)]
        dependencies = {name: [name] for name in states}
        dependencies |= {v.name: [*(i.name for i in inputs), *states] for v in accelerations}
        dependencies |= {v.name: angles for v in tip}
        return Model(
            name="ArmLinks",
            joint="arm",
            doc="rigid links of the arm",
            parameter_class=ArmParameters,
            tabulate=lambda parameters: parameters,
            inputs=inputs,
            outputs=[*positions, *speeds, *accelerations, *tip],
            evaluate=self.evaluate_outputs,
            validity_limits=(),
            ramp=LoadRamp(inputs[0].name, 1.0, 1e-3, 1e-3),
            dependencies=dependencies,
            state_count=len(states),
            evaluate_residuals=self.evaluate_residuals,
            is_time_dependent=True,
        )

    def evaluate_outputs(self, parameters: Any, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """All outputs, for a parameter set and the values of inputs and states."""
        outputs = dict(variable_values)
        accelerations = self._compute_motion(
            parameters, variable_values, self._list_link_values(variable_values, "tau")
        ).joint_accelerations
        for name, acceleration in zip(self.arm.axis_names, accelerations, strict=True):
            outputs[f"{name}_link.a"] = acceleration
        positions, speeds = (
            self._list_link_values(variable_values, "phi"),
            self._list_link_values(variable_values, "w"),
        )
        position = compute_frame_motion(self.tree_links, self.tip_frame, positions, speeds).position
        return outputs | {f"tip.{x}": value for x, value in zip("xyz", position, strict=True)}

    def evaluate_residuals(self, parameters: Any, variable_values: Mapping[str, Number]) -> list[Number]:
        """Residuals [N.m] of the equations of motion, one per link: required torque minus drive torque."""
        free = [None] * len(self.tree_links)
        needed = self._compute_motion(
            parameters, variable_values, free, self._list_link_values(variable_values, "a")
        ).joint_forces
        return [
            due - torque
            for due, torque in zip(needed, self._list_link_values(variable_values, "tau"), strict=True)
        ]

    def _compute_motion(
        self,
        arm_parameters: Any,
        variable_values: Mapping[str, Number],
        axis_torques: Sequence[Number | None],
        prescribed_accelerations: Sequence[Number] | None = None,
    ) -> TreeMotion:
        """Accelerations and torques of the links at the angles and speeds in `variable_values`."""
        return forward_dynamics(
            self.tree_links,
            (0.0, 0.0, -GRAVITY),
            self._list_link_values(variable_values, "phi"),
            self._list_link_values(variable_values, "w"),
            axis_torques,
            prescribed_accelerations,
            payload=arm_parameters.payload.make_body(self.tip_frame),
        )

    def _list_link_values(self, variable_values: Mapping[str, Number], link_variable: str) -> list[Number]:
        """Values of a variable that each link has, for example its angle; one value for each link."""
        return [variable_values[f"{name}_link.{link_variable}"] for name in self.arm.axis_names]
