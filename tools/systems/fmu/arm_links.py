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
from ..multibody import GROUND, Frame, Link, Payload, TreeMotion, forward_dynamics, frame_motion
from .model import InputSource, SystemComponent

_JOINT_AXES: Mapping[str, Array] = {
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

    arm   : arm as read from a system file
    links : the same links with the frames of `multibody`
    tip   : frame of the tip
    """

    arm: Arm
    links: Sequence[Link] = field(init=False)
    tip: Frame = field(init=False)

    def __post_init__(self) -> None:
        links, distance, parent_axes = list[Link](), 0.0, np.eye(3)
        for k, (name, axis, link) in enumerate(
            zip(self.arm.axis_names, self.arm.rotation_axes, self.arm.links, strict=True)
        ):
            axes, along = _JOINT_AXES[axis], np.array([0.0, 0.0, 1.0])
            links.append(
                Link(
                    name=name,
                    parent=k - 1 if k else GROUND,
                    is_slide=False,
                    rotation=parent_axes.T @ axes,
                    origin=parent_axes.T @ (distance * along),
                    mass=link.mass,
                    centre=axes.T @ (link.centre * along),
                    inertia=axes.T @ np.diag([link.J_across, link.J_across, link.J_along]) @ axes,
                )
            )
            parent_axes, distance = axes, link.length
        object.__setattr__(self, "links", links)
        object.__setattr__(
            self, "tip", Frame(len(links) - 1, parent_axes.T, parent_axes.T @ [0.0, 0.0, distance])
        )

    def make_component(self) -> SystemComponent:
        """Component of the system; the torque of each drive acts on the link behind its axis."""
        values = ArmParameters(payload=Payload.at_origin(0.0))
        names = flatten_parameters(values)
        file = ParameterFile(
            "arm", "arm", values, dict.fromkeys(names, "derived"), dict.fromkeys(names, "section [arm]")
        )
        sources = {f"{name}_link.tau": InputSource(f"{name}_drive", "tau2") for name in self.arm.axis_names}
        return SystemComponent("", self._make_model(), file, sources, {})

    def _make_model(self) -> Model:
        """Model of the component."""
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

    def evaluate_outputs(self, parameters: Any, values: Mapping[str, Number]) -> dict[str, Number]:
        """All outputs, for a parameter set and the values of inputs and states."""
        outputs = dict(values)
        accelerations = self._compute_motion(
            parameters, values, self._list_values(values, "tau")
        ).accelerations
        for name, acceleration in zip(self.arm.axis_names, accelerations, strict=True):
            outputs[f"{name}_link.a"] = acceleration
        positions, speeds = self._list_values(values, "phi"), self._list_values(values, "w")
        position = frame_motion(self.links, self.tip, positions, speeds).position
        return outputs | {f"tip.{x}": value for x, value in zip("xyz", position, strict=True)}

    def evaluate_residuals(self, parameters: Any, values: Mapping[str, Number]) -> list[Number]:
        """Torques [N.m] that the accelerations need, minus torques of the drives."""
        free = [None] * len(self.links)
        needed = self._compute_motion(parameters, values, free, self._list_values(values, "a")).forces
        return [due - torque for due, torque in zip(needed, self._list_values(values, "tau"), strict=True)]

    def _compute_motion(
        self,
        parameters: Any,
        values: Mapping[str, Number],
        torques: Sequence[Number | None],
        accelerations: Sequence[Number] | None = None,
    ) -> TreeMotion:
        """Dynamics at the states in `values`, see `forward_dynamics`."""
        return forward_dynamics(
            self.links,
            (0.0, 0.0, -GRAVITY),
            self._list_values(values, "phi"),
            self._list_values(values, "w"),
            torques,
            accelerations,
            payload=parameters.payload.make_body(self.tip),
        )

    def _list_values(self, values: Mapping[str, Number], variable: str) -> list[Number]:
        """Values of a variable of all links."""
        return [values[f"{name}_link.{variable}"] for name in self.arm.axis_names]
