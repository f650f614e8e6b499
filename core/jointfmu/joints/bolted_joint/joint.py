"""Bolted joint: interface between two sides with friction, bolts and, optionally, elastic members."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np

from ...contact.interface import solve_largest_spot
from ...files.results import compute_or_load_array
from ...mechanics.curve import Curve, tabulate_approach
from ...mechanics.footprint.bolts import PressureSource, pressure_distribution
from ...mechanics.footprint.distribution import MAX_PATCHES, FrictionPatches, NodalField, PressureDistribution
from ...mechanics.footprint.patch_reduction import reduce_patches
from ...mechanics.footprint.point_reduction import reduce_points
from ...mechanics.history_layout import HistoryLayout
from ...quantity import Array, Number
from .bodies import MemberModes
from .bolts import BoltSprings, bolt_positions
from .compliances import Compliances
from .contact import Contact, NormalState, PreloadState, elastic_shear
from .equilibrium import JointAssembly, LoadStep, solve_equilibrium
from .friction import (
    BEFORE_FIRST_STEP,
    FrictionLaw,
    FrictionUpdate,
    HistoryVariables,
    continued_motion_stiffness,
    history_layout,
)
from .kinematics import (
    NORMAL_COMPONENT_INDICES,
    TANGENTIAL_COMPONENT_INDICES,
    point_displacement,
    tangential_displacement,
)
from .law import (
    MAX_MODES,
    TIGHTENING_TEMPERATURE,
    AnyBoltedJoint,
    ElasticBodies,
    preload_at_temperature,
    with_rigid_members,
)
from .outputs import (
    bolt_force_name,
    correct_sums_for_lifted_heads,
    elastic_member_sums,
    first_moments,
    joint_outputs,
    sum_cycle_energies,
    sum_friction_tractions,
    sum_normal_tractions,
    sum_tangential_stiffness,
)

MAX_CONTACT_POINTS = 120
"""Largest number of points that carry the normal force [1]."""
ZERO_MOTION = (0.0, 0.0, 0.0)
"""Default of translations, rotations and their rates: no motion."""


@lru_cache(maxsize=8)
def contact_points(pressure_source: PressureSource) -> PressureDistribution:
    """Points that carry the normal force of a joint, selected from the nodes of its pressure distribution."""
    nodes = pressure_distribution(pressure_source)
    rows = compute_or_load_array(
        f"points {MAX_CONTACT_POINTS}",
        nodes.rows,
        lambda: np.stack(reduce_points(nodes, MAX_CONTACT_POINTS).rows),
    )
    return PressureDistribution.from_rows(rows)


@lru_cache(maxsize=8)
def find_friction_patches(pressure_source: PressureSource) -> FrictionPatches:
    """Friction patches of a joint: stated in its pressure field, or reduced from its pressure nodes."""
    stated = pressure_source.friction_patches() if isinstance(pressure_source, NodalField) else None
    if stated:
        return stated
    nodes = pressure_distribution(pressure_source)
    rows = compute_or_load_array(
        f"patches {MAX_PATCHES}", nodes.rows, lambda: np.stack(reduce_patches(nodes, MAX_PATCHES).rows)
    )
    return FrictionPatches.from_rows(rows)


class JointInputs(NamedTuple):
    """Inputs of a bolted joint: preload, moment, relative motion and its rates.

    preload               : [N] of each bolt at tightening
    bending_moment        : [N.m] about x
    relative_displacement : q (6) of side 2 from the tightened state: s_x, s_y, s_z (positive apart) [m], and
                            small rotation theta_x, theta_y, theta_z [rad] about the centroid of the contact
    motion_rates          : (6) [m/s, rad/s] of q
    temperature           : [K] of bolts and members
    """

    preload: float
    bending_moment: float
    relative_displacement: Array
    motion_rates: tuple[float, ...] = (0.0,) * 6
    temperature: float = TIGHTENING_TEMPERATURE

    @property
    def input_summary(self) -> str:
        """Inputs that are not zero, and a temperature other than at tightening, as text; without
        rates."""
        names = ("preload", "moment", "s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
        values = dict(
            zip(names, (self.preload, self.bending_moment, *self.relative_displacement), strict=True)
        )
        if self.temperature != TIGHTENING_TEMPERATURE:
            values["temperature"] = self.temperature
        return ", ".join(f"{name} = {value:g}" for name, value in values.items() if value)


@dataclass(frozen=True)
class BoltedJointSpring:
    """Forces and moments between two sides, by their relative displacement and its history.

    Each point follows the pressure-approach curve p(delta) of the interface from its pressure at tightening:
    the normal traction is the gradient of a potential, V' = p. Shear is carried by the sliders of
    `FrictionLaw` on fewer patches, or without history by the potential of `elastic_shear`. The bolts act in
    parallel with the interface and only pull, see `BoltSprings`: they carry the joint when it is open.

    curve   : contact pressure [Pa] as a function of the approach [m]
    points  : points that carry the normal force
    patches : patches that carry the friction
    modes   : modes of the members between their attachments; none if the members are rigid
    """

    joint: AnyBoltedJoint
    curve: Curve
    points: PressureDistribution
    patches: FrictionPatches
    modes: MemberModes

    @classmethod
    def from_joint(cls, joint_parameters: AnyBoltedJoint) -> "BoltedJointSpring":
        """Bolted joint of a parameter set, with the points and patches that its FMU has.

        Raises ValueError if its [bodies] were computed for another contact.
        """
        points, patches = (
            contact_points(joint_parameters.pattern),
            find_friction_patches(joint_parameters.pattern),
        )
        if joint_parameters.has_elastic_members:
            assert isinstance(joint_parameters.bodies, ElasticBodies)
            modes = MemberModes.from_elastic_bodies(
                joint_parameters.bodies, points.area_share.size, patches.position
            )
        else:
            modes = _rigid_member_modes(joint_parameters, points, patches)
        return cls(joint_parameters, tabulate_approach(joint_parameters), points, patches, modes)

    @classmethod
    def from_interface_nodes(
        cls, joint: AnyBoltedJoint, interface_nodes: PressureDistribution | None = None
    ) -> "BoltedJointSpring":
        """Bolted joint with rigid members, and a point and a friction patch at each node of its contact.

        interface_nodes : pressure distribution with the nodes to use; None: all nodes of the joint's pressure
                distribution
        """
        points = pressure_distribution(joint.pattern) if interface_nodes is None else interface_nodes
        joint, patches = with_rigid_members(joint), points.make_friction_patches()
        return cls(
            joint, tabulate_approach(joint), points, patches, _rigid_member_modes(joint, points, patches)
        )

    def with_nodes(self, interface_nodes: PressureDistribution) -> "BoltedJointSpring":
        """Copy of the joint with rigid members; a contact point and a friction patch at each given node."""
        joint, patches = with_rigid_members(self.joint), interface_nodes.make_friction_patches()
        modes = _rigid_member_modes(joint, interface_nodes, patches)
        return replace(self, joint=joint, points=interface_nodes, patches=patches, modes=modes)

    @cached_property
    def contact(self) -> Contact:
        """Contact interface: points with the normal force, patches with the friction."""
        return Contact(self.curve, self.points, self.patches, self.joint.has_elastic_members)

    @cached_property
    def friction_law(self) -> FrictionLaw:
        """Friction law of the patches."""
        joint = self.joint
        return FrictionLaw(
            self.curve,
            float(joint.shear_stiffness_ratio()),
            joint.mu,
            self.patches,
            joint.has_elastic_members,
        )

    @cached_property
    def bolts(self) -> BoltSprings:
        """Bolts, which act in parallel with the contact."""
        return BoltSprings.from_joint(self.joint, self.curve.closing_end_pressure)

    @cached_property
    def assembly(self) -> JointAssembly:
        """Assembly of contact interface, members and bolts."""
        return JointAssembly(self.contact, self.modes, self.bolts, self.joint.A_0)

    @cached_property
    def _cached_preload_state(self) -> Callable[[float, float], PreloadState]:
        """Cached `Contact.preload_state`: function of preload [N] and moment [N.m]."""
        return lru_cache(maxsize=2)(partial(self.contact.preload_state, self.joint))

    def preload_at_temperature(self, preload: float, temperature: float) -> float:
        """Preload [N] of each bolt at a temperature [K], from the preload at tightening [N]."""
        return float(preload_at_temperature(self.joint, preload, temperature))

    def preloaded_approach(self, preload: float, bending_moment: float) -> Array:
        """Approach (n) [m] of the points under a preload [N] of each bolt and a moment [N.m]."""
        return self.contact.preloaded_approach(self.joint, preload, bending_moment)

    def checked_preloaded_approach(self, preload: float, bending_moment: float) -> Array:
        """Approach (n) [m] of the points under a preload [N] of each bolt and a moment [N.m], after checks.

        Raises ValueError if all points are open, or if the pressure reaches the hardness.
        """
        approach = self.preloaded_approach(preload, bending_moment)
        low, high = self.curve.displacement[[0, -1]]
        if not (np.isfinite(preload + bending_moment) and low < np.max(approach) < high):
            raise ValueError(
                f"preload = {preload:g} N per bolt with moment = {bending_moment:g} N.m is outside the law: "
                f"expected more than embedding takes, {self.joint.embedding:g} N, and pressures up to "
                f"{self.curve.end_point[1]:g} Pa"
            )
        return approach

    def tangent_stiffness(self, preload: float, bending_moment: float = 0.0) -> Array:
        """Tangent stiffness (6 + k, 6 + k) of the tightened joint, see `JointAssembly.tangent_stiffness`."""
        state = self._cached_preload_state(preload, bending_moment)
        stiffness = self.curve.derivatives(state.approach, 1)[1]
        stick = self.friction_law.stick_tangent(state.patch_approach)
        return self.assembly.tangent_stiffness(
            stiffness, stick, self._active_bolt_stiffness(preload, bending_moment)
        )

    def _active_bolt_stiffness(self, preload: float, bending_moment: float) -> Array:
        """Stiffness (b) [N/m] of the bolts at tightening."""
        force = self.bolts.preload_force(self.joint, preload, bending_moment)
        return self.bolts.active_stiffness(force, np.zeros_like(force))

    def compliances(self, preload: float, bending_moment: float = 0.0) -> Compliances:
        """Compliances of the tightened joint with elastic members: shares of interface, members and bolts."""
        H = self.tangent_stiffness(preload, bending_moment)
        return Compliances.from_assembly(
            self.assembly, H, self._active_bolt_stiffness(preload, bending_moment)
        )

    @property
    def history_layout(self) -> HistoryLayout:
        """Names and shapes of the history variables of the joint's friction."""
        return history_layout(self.patches.area_share.size)

    def initial_history(self) -> Array:
        """History variables of a joint that has not moved: zeros."""
        return self.history_layout.virgin_history()

    def evaluate(
        self,
        preload: float,
        moment: float,
        s_rel: tuple[float, float, float],
        v_rel: tuple[float, float, float],
        theta: tuple[float, float, float] = ZERO_MOTION,
        omega: tuple[float, float, float] = ZERO_MOTION,
        temperature: float = TIGHTENING_TEMPERATURE,
    ) -> dict[str, Number]:
        """Outputs {name: value} of a joint that has not moved before; arguments as in `JointInputs`."""
        inputs = JointInputs(preload, moment, np.array([*s_rel, *theta]), (*v_rel, *omega), temperature)
        return self.advance(inputs, self.initial_history())[0]

    def advance(self, joint_inputs: JointInputs, history: Array) -> tuple[dict[str, Number], Array]:
        """Outputs {name: value} and history variables at the end of a straight path to the inputs.

        The path is straight in the relative displacement; preload, moment and temperature have their new
        values from its start on.

        Raises ValueError if elastic members find no equilibrium.
        """
        joint, assembly, points, q = (
            self.joint,
            self.assembly,
            self.points,
            joint_inputs.relative_displacement,
        )
        before = self.history_layout.split(history)
        warm_preload = self.preload_at_temperature(joint_inputs.preload, joint_inputs.temperature)
        preload_state = self._cached_preload_state(warm_preload, float(joint_inputs.bending_moment))
        bolt_force = self.bolts.preload_force(joint, warm_preload, joint_inputs.bending_moment)
        state, a = None, np.zeros(0)
        if joint.has_elastic_members:
            state = solve_equilibrium(self._load_step(joint_inputs, preload_state, bolt_force, before))
            a, normal, friction = state.modal_coordinates, state.normal_state, state.friction_update
        else:
            normal, friction = assembly.evaluate_normal(preload_state, q, a), None
            if joint.memory:
                increment = tangential_displacement(self.patches, q - _relative_displacement(before))
                friction = self.friction_law.update_friction(before, normal.patch_approach, increment)

        if friction is not None:
            loss = float(before["loss"]) + joint.A_0 * float(
                self.patches.area_share @ friction.slider_update.dissipated_energy
            )
            tangent = continued_motion_stiffness(self.patches, friction)
            shear = sum_friction_tractions(self.patches, friction.traction, tangent, loss / joint.A_0)
            added, history = (0.0, 0.0), self._join_history(q, a, friction, loss)
        else:
            shear, added = self._elastic_shear_sums(preload_state, normal, q)

        plastic, elastic = self.first_loading_work(normal.pressure)
        amplitude = np.sqrt(np.sum(assembly.tangential_displacement(q, a) ** 2, axis=1))
        foundation = self.friction_law.foundation()
        sums: dict[str, Number] = {
            **first_moments(points, "tightened", preload_state.pressure),
            **sum_normal_tractions(points, normal.pressure, normal.stiffness, *added),
            "plastic": points.area_share @ plastic,
            "elastic": points.area_share @ elastic,
            **shear,
            **sum_cycle_energies(foundation, self.patches.area_share, normal.patch_approach, amplitude),
        }
        elongation = assembly.elongation(q, a)
        if state is not None:
            sums |= elastic_member_sums(joint, assembly, state, bolt_force, sums["loop_energy"])
        else:
            sums |= correct_sums_for_lifted_heads(self.bolts, joint.A_0, elongation, bolt_force, sums)
        s_rel, theta = q.reshape(2, 3).tolist()
        outputs = joint_outputs(joint, sums, s_rel, theta, joint_inputs.motion_rates, np.max(normal.pressure))
        if joint.has_elastic_members:
            forces = self.bolts.bolt_force(bolt_force, elongation)
            outputs |= {bolt_force_name(j): force for j, force in enumerate(forces)}
        return outputs, history

    def _load_step(
        self,
        joint_inputs: JointInputs,
        preload_state: PreloadState,
        bolt_force: Array,
        start_history: HistoryVariables,
    ) -> LoadStep:
        """Load step from the last equilibrium, by its history variables, to the inputs."""
        return LoadStep(
            self.assembly,
            preload_state,
            bolt_force,
            start_displacement=_relative_displacement(start_history),
            end_displacement=joint_inputs.relative_displacement,
            modal_coordinates=start_history["modal_coordinates"][: len(self.modes.modal_stiffness)],
            friction_tangent=(
                self.friction_law.stick_tangent(preload_state.patch_approach)
                if start_history["state"] == BEFORE_FIRST_STEP
                else start_history["tangent"]
            ),
            update_friction=partial(self.friction_law.update_friction, start_history),
            input_summary=joint_inputs.input_summary,
        )

    def _elastic_shear_sums(
        self, preload_state: PreloadState, normal_state: NormalState, relative_displacement: Array
    ) -> tuple[dict[str, Number], tuple[Number, Number]]:
        """Sums over the points of the shear traction without friction history, see `elastic_shear`.

        Returns also its terms (n) [Pa] in the normal traction and (n) [Pa/m] in the normal stiffness.
        """
        limit, derivatives = (
            self.joint.mu * preload_state.pressure,
            self.curve.derivatives(normal_state.approach, 3),
        )
        u_x, u_y = point_displacement(self.points, relative_displacement).T
        t_x, t_y, xx, xy, yy, added_pressure, added_stiffness = elastic_shear(
            limit, self.joint.shear_stiffness_ratio(), derivatives, u_x, u_y
        )
        none, nodes = np.zeros_like(limit), self.points.make_friction_patches()
        tangent = sum_tangential_stiffness(nodes, np.stack([xx, xy, yy, none, none, none], axis=-1))
        sums = sum_friction_tractions(nodes, np.stack([t_x, t_y, none], axis=-1), tangent, 0.0)
        return sums, (added_pressure, added_stiffness)

    def _join_history(
        self,
        relative_displacement: Array,
        modal_coordinates: Array,
        friction_update: FrictionUpdate,
        total_loss: float,
    ) -> Array:
        """Join the history variables at displacement q (6) and modal coordinates a (k) [m] to one array.

        total_loss : [J] energy dissipated so far
        """
        elastic = self.joint.has_elastic_members
        return self.history_layout.join(
            {
                "state": friction_update.friction_state,
                "loss": total_loss,
                "tangential": relative_displacement[TANGENTIAL_COMPONENT_INDICES],
                "onset_approach": friction_update.onset_approach,
                "min_approach": friction_update.min_approach,
                "approach": friction_update.approach,
                "force": friction_update.slider_update.force,
                "normal": relative_displacement[NORMAL_COMPONENT_INDICES] if elastic else 0.0,
                "modal_coordinates": np.pad(modal_coordinates, (0, MAX_MODES - modal_coordinates.size)),
                "tangent": friction_update.slider_update.tangent if elastic else 0.0,
            }
        )

    def first_loading_work(self, nominal_pressure: Array) -> tuple[Array, Array]:
        """Plastic and elastic work [J] when virgin surfaces are loaded to pressures (...) [Pa].

        Work of the complete interface (Zhao 2018, Eqs. 16, 18). Below the pressure at zero approach, where
        the tabulated curve has its closing end, the values at that pressure are used: the law has hardly an
        elastic spot there.
        """
        spots = self.joint.spot_distribution()
        u = solve_largest_spot(self.joint, np.maximum(nominal_pressure, self.curve.closing_end_pressure))
        return spots.sum_over_spots("plastic_work", u), spots.sum_over_spots("elastic_work", u)


def _rigid_member_modes(
    joint_parameters: AnyBoltedJoint, contact_points: PressureDistribution, patches: FrictionPatches
) -> MemberModes:
    """Empty set of modes, for rigid members."""
    return MemberModes.from_rigid_members(
        contact_points.area_share.size, patches.area_share.size, len(bolt_positions(joint_parameters))
    )


def _relative_displacement(history: HistoryVariables) -> Array:
    """Relative displacement q (6) [m, rad] of the sides that is stored in history variables.

    Its normal part is stored for elastic members only.
    """
    q = np.empty(6)
    q[TANGENTIAL_COMPONENT_INDICES], q[NORMAL_COMPONENT_INDICES] = history["tangential"], history["normal"]
    return q
