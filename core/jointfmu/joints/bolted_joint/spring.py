"""The exported bolted joint: six degrees of freedom under uneven pressure, with friction that remembers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from ...contact.interface import solve_largest_spot
from ...mechanics.curve import Curve, tabulate_approach
from ...mechanics.footprint.bolts import PressureSource, pressure_distribution
from ...mechanics.footprint.friction import reduce_patches
from ...mechanics.footprint.patches import reduce_points
from ...mechanics.footprint.shape import MAX_PATCHES, FrictionPatches, NodalField, PressureDistribution
from ...mechanics.jenkins import SliderUpdate
from ...mechanics.memory import HistoryLayout
from ...mechanics.sliders import Foundation, height_offsets, heights_after_liftoff, slider_heights
from ...quantity import Array, Number
from .bodies import MODES, Modes, RigidBodies
from .bolts import BoltSprings
from .compliances import Compliances
from .contact import (
    STICK_TANGENT,
    RelativeDisplacement,
    consistent_tangent,
    cycle_sums,
    elastic_shear,
    first_moments,
    node_displacement,
    normal_sums,
    patch_displacement,
    pressure_transfer,
    tangent_sums,
    traction_sums,
)
from .law import Bolted, interface_alone, preload_pressure
from .memory import (
    FULL_STICK,
    SLIP_1D,
    SLIP_2D,
    UNKNOWN,
    History,
    full_stick_force,
    history_layout,
    slip_state,
)
from .outputs import STRETCHES, bolt_force_name, joint_outputs
from .trials import FrictionUpdate, LoadStep, TrialState, summarise_inputs
from .whole import JointAssembly, PreloadState

MAX_POINTS = 120
"""Points that carry the normal force [1], where a pattern has more nodes."""
ZERO_MOTION = (0.0, 0.0, 0.0)


@lru_cache(maxsize=8)
def contact_points(pattern: PressureSource) -> PressureDistribution:
    """The points that carry the normal force of a joint."""
    return reduce_points(pressure_distribution(pattern), MAX_POINTS)


@lru_cache(maxsize=8)
def friction_patches_of(pattern: PressureSource) -> FrictionPatches:
    """The patches of its friction."""
    stated = pattern.friction_patches() if isinstance(pattern, NodalField) else None
    return stated or reduce_patches(pressure_distribution(pattern), MAX_PATCHES)


@dataclass(frozen=True)
class BoltedJointSpring:
    """The exported joint: relative motion of its two sides in, forces and moments out.

    Every node follows the pressure-approach curve `p(delta)` of the interface from its own pressure at
    tightening: the normal traction is the gradient of a potential, V' = p. Shear is carried by the sliders of
    `Foundation` on fewer points, which slip and remember, or without memory by the potential of
    `elastic_shear`. The n bolts act beside the interface: they carry the joint once it is open. They only
    pull, see `BoltSprings`.

    shape   : the points that carry the normal force
    patches : the points that carry the friction
    modes   : of the bodies between their attachments, none of rigid sides
    """

    joint: Bolted
    curve: Curve
    shape: PressureDistribution
    patches: FrictionPatches
    modes: Modes

    @classmethod
    def of(cls, joint: Bolted) -> "BoltedJointSpring":
        """Tabulate a joint, on as few points as its FMU has.

        Raises ValueError for bodies that were computed for another contact.
        """
        shape, few = contact_points(joint.pattern), friction_patches_of(joint.pattern)
        bodies = joint.bodies if joint.elastic else RigidBodies()
        modes = Modes.of(bodies, shape.share.size, few.position)
        return cls(joint, tabulate_approach(joint), shape, few, modes)

    @classmethod
    def of_nodes(cls, joint: Bolted, nodes: PressureDistribution | None = None) -> "BoltedJointSpring":
        """The interface alone, on all nodes of its pattern or on given ones."""
        shape, joint = (
            pressure_distribution(joint.pattern) if nodes is None else nodes,
            interface_alone(joint),
        )
        modes = Modes.for_rigid_bodies(shape.share.size, shape.share.size)
        return cls(joint, tabulate_approach(joint), shape, shape.as_patches(), modes)

    def on_nodes(self, nodes: PressureDistribution) -> "BoltedJointSpring":
        """The same interface alone on other nodes."""
        count = nodes.share.size
        modes = Modes.for_rigid_bodies(count, count)
        few = nodes.as_patches()
        return replace(self, joint=interface_alone(self.joint), shape=nodes, patches=few, modes=modes)

    @cached_property
    def _foundations(self) -> Callable[[bytes, bytes], Foundation]:
        """The sliders of the patches around approaches and above lowest ones, of which the last are kept."""
        ratio, mu, shifts = (
            float(self.joint.shear_ratio()),
            self.joint.mu,
            height_offsets(self.patches.preload_shape),
        )

        def build(*approaches: bytes) -> Foundation:
            reference, lowest = (np.frombuffer(each) for each in approaches)
            return Foundation(
                self.curve,
                ratio,
                mu,
                heights_after_liftoff(slider_heights(self.curve, reference, shifts), lowest),
            )

        return lru_cache(maxsize=4)(build)

    def foundation(
        self, onset_approach: Array | None = None, min_approach: Array | None = None
    ) -> Foundation:
        """The sliders of patches which first move at approaches (m) [m]; None: not yet known.

        lowest : (m) [m] least approach since then; None: the first one
        """
        first = np.zeros(self.patches.share.size) if onset_approach is None else onset_approach
        both = first, first if min_approach is None else min_approach
        return self._foundations(*(np.ascontiguousarray(each).tobytes() for each in both))

    def preloaded_approach(self, preload: float, moment: float) -> Array:
        """Approach (n) [m] of the nodes at tightening."""
        return self.curve.inverse(preload_pressure(self.joint, self.shape, preload, moment))

    def preloaded_patch_approach(self, preload: float, moment: float) -> Array:
        """The same (m) [m] of the patches."""
        if self.joint.elastic:
            return self.patch_approach(self.preloaded_approach(preload, moment))
        return self.curve.inverse(preload_pressure(self.joint, self.patches, preload, moment))

    @cached_property
    def _preload_state(self) -> Callable[[float, float], tuple[Array, ...]]:
        """Approach [m] at tightening of the points, the pressure [Pa] there, and the approach of the patches;
        the last ones are kept."""

        def build(preload: float, moment: float) -> tuple[Array, ...]:
            start = self.preloaded_approach(preload, moment)
            patches = self.preloaded_patch_approach(preload, moment)
            return start, self.curve.derivatives(start, 0)[0], patches

        return lru_cache(maxsize=2)(build)

    @cached_property
    def pressure_transfer(self) -> Array:
        """(m, n) [1] pressure of the patches over that of the points, where sides are elastic."""
        return pressure_transfer(self.shape, self.patches)

    def patch_approach(self, approach: Array) -> Array:
        """Approach (m) [m] of the patches to points at approaches (n) [m]: that at which they have the normal
        force of their points, or, where all of these are open, that of the nearest one."""
        p = self.pressure_transfer @ self.curve.derivatives(approach, 0)[0]
        nearest = np.max(np.where(self.pressure_transfer > 0.0, approach, -np.inf), axis=1)
        return np.where(p > 0.0, self.curve.inverse(p), np.minimum(nearest, self.curve.displacement[0]))

    def checked_approach(self, preload: float, moment: float) -> Array:
        """As `tightened`; ValueError if nothing is in contact or the hardness is reached."""
        start = self.preloaded_approach(preload, moment)
        low, high = self.curve.displacement[[0, -1]]
        if not (np.isfinite(preload + moment) and low < np.max(start) < high):
            raise ValueError(
                f"preload = {preload:g} N per bolt with moment = {moment:g} N.m is outside the law: expected "
                f"contact after embedding ({self.joint.embedding:g} N), and at most {self.curve.end[1]:g} Pa"
            )
        return start

    def evaluate(
        self,
        preload: float,
        moment: float,
        s_rel: tuple[float, float, float],
        v_rel: tuple[float, float, float],
        theta: tuple[float, float, float] = ZERO_MOTION,
        omega: tuple[float, float, float] = ZERO_MOTION,
    ) -> dict[str, Number]:
        """Outputs of a joint that has not moved along its surface before.

        preload [N] per bolt, moment [N.m], s_rel [m] (z positive apart), v_rel [m/s], small turn theta [rad]
        of side 2 about the joint's centre, omega [rad/s].
        """
        place = RelativeDisplacement(np.array([*s_rel, *theta]))
        return self.advance(preload, moment, place, (*v_rel, *omega), self.initial_history())[0]

    @property
    def history_layout(self) -> HistoryLayout:
        """What it remembers."""
        return history_layout(self.patches.share.size)

    def initial_history(self) -> Array:
        """Memory of a joint that has not moved yet: UNKNOWN, and zero."""
        return self.history_layout.virgin_history()

    def advance(
        self,
        preload: float,
        moment: float,
        displacement: RelativeDisplacement,
        rates: tuple[float, ...],
        history: Array,
    ) -> tuple[dict[str, Number], Array]:
        """Outputs at a place with rates (v_rel, omega), and the memory after the straight path there.

        Raises ValueError if elastic sides find no equilibrium.
        """
        joint, shape = self.joint, self.shape
        start, tight, first = self._preload_state(float(preload), float(moment))
        bolt_force = self.bolts.preload_force(joint, preload, moment)
        before = self.history_layout.split(history)

        trials = LoadStep(
            self, (start, first), displacement, before, summarise_inputs(preload, moment, displacement)
        )
        amplitude = np.zeros(0)
        if joint.elastic:
            begin = before["amplitude"][: len(self.modes.stiffness)]
            followed = self._tangent_predictor(trials, bolt_force, begin)
            amplitude, at = self.assembly.solve(trials, PreloadState(tight, bolt_force), begin, *followed)
        else:
            at = trials.evaluate(displacement, amplitude)
        if at.friction is not None:
            shear, after = self._friction_sums(at.friction, amplitude, displacement, before)
            lifted = stiffer = np.zeros_like(tight)
        else:
            limit, rho = joint.mu * tight, joint.shear_ratio()
            *parts, lifted, stiffer = elastic_shear(
                limit, rho, at.derivatives, *node_displacement(shape, displacement.tangential).T
            )
            none, nodes = np.zeros_like(tight), shape.as_patches()
            traction, tangent = (
                np.stack(each, axis=-1) for each in ([*parts[:2], none], [*parts[2:], none, none, none])
            )
            shear, after = traction_sums(nodes, traction) | tangent_sums(nodes, tangent), history
            shear["loss"] = 0.0
        plastic, elastic = self.first_loading_work(at.derivatives[0])
        shift = self.patch_displacement(displacement.tangential, amplitude)
        size = np.sqrt(np.sum(shift**2, axis=1))
        sums: dict[str, Number] = {
            **first_moments(shape, "tightened", tight),
            **normal_sums(shape, lifted, stiffer, at.derivatives),
            "plastic": shape.share @ plastic,
            "elastic": shape.share @ elastic,
            **shear,
            **cycle_sums(self.foundation(), self.patches.share, at.approach, size),
        }
        if joint.elastic:
            sums |= self._assembly_sums(at, displacement, amplitude, bolt_force, sums["loop_energy"])
        else:
            sums |= self._gap_sums(displacement, bolt_force, sums)
        s_rel, theta = displacement.components.reshape(2, 3).tolist()
        out = joint_outputs(joint, sums, s_rel, theta, rates, np.max(at.derivatives[0]))
        if not joint.elastic:
            return out, after
        forces = self.bolts.force(bolt_force, self.assembly.elongation(displacement, amplitude))
        return out | {bolt_force_name(j): force for j, force in enumerate(forces)}, after

    def tangent_stiffness(self, preload: float, moment: float = 0.0) -> Array:
        """`Whole.slope` of elastic sides at tightening."""
        stick = (
            self.foundation().stick_stiffness(self.preloaded_patch_approach(preload, moment))[:, None]
            * STICK_TANGENT
        )
        bolt_force = self.bolts.preload_force(self.joint, preload, moment)
        bolts = self.bolts.tangent(bolt_force, np.zeros_like(bolt_force))
        return self.assembly.tangent_stiffness(
            self.curve.derivatives(self.preloaded_approach(preload, moment), 1)[1], stick, bolts
        )

    def compliances(self, preload: float, moment: float = 0.0) -> Compliances:
        """Of elastic sides, tightened by the force of each bolt [N] and a moment [N.m]."""
        return Compliances.of(self, preload, moment)

    @cached_property
    def assembly(self) -> JointAssembly:
        """The contact with what gives way around it."""
        area, closed = self.joint.A_0, self.curve.closing_end_load
        return JointAssembly.of(self.modes, self.shape, self.patches, area, self.bolts, closed)

    @cached_property
    def bolts(self) -> BoltSprings:
        """Its bolts, which act beside the contact."""
        return BoltSprings.of(self.joint, self.curve.closing_end_load)

    def patch_displacement(self, tangential: Array, modal_coordinates: Array) -> Array:
        """`shifts` (m, 3) [m] of the patches by a rigid motion (3) and amplitudes (k) [m] of the modes."""
        return np.asarray(
            patch_displacement(self.patches, tangential)
            + (self.modes.patch_displacement @ modal_coordinates).T
        )

    def update_friction(
        self, history: History, approach: Array, displacement: Array, tangential: Array
    ) -> "FrictionUpdate":
        """How the patches move on a straight path to approaches (m) [m] by `shifts` (m, 3) [m]."""
        first = approach if history["state"] == UNKNOWN else history["approach"]
        stick = self.foundation().stick_stiffness(approach)
        moved = (
            self._full_stick_update(history, first, approach, displacement, stick)
            if history["state"] < SLIP_1D
            else None
        )
        if moved is not None:
            return FrictionUpdate(FULL_STICK, approach, approach, approach, moved, stick)
        state = SLIP_2D if self.joint.elastic else slip_state(history, tangential)
        reference = lowest = first
        if history["state"] >= SLIP_1D:
            reference = history["reference"]
            opened = history["lowest"] < self.curve.displacement[0]
            lowest = np.where(opened, first, np.minimum(history["lowest"], first))
        foundation, force = self.foundation(reference, lowest), history["force"]
        if history["state"] < SLIP_1D:
            force = foundation.distribute_stick_force(full_stick_force(force), first)
        return FrictionUpdate(
            state,
            reference,
            lowest,
            approach,
            foundation.advance(force, first, approach, displacement),
            stick,
        )

    def _friction_sums(
        self,
        update: "FrictionUpdate",
        modal_coordinates: Array,
        displacement: RelativeDisplacement,
        history: History,
    ) -> tuple[dict[str, Number], Array]:
        """Sums of the shear, and the memory after a way of the patches."""
        patches, area, moved = self.patches, self.joint.A_0, update.slider_update
        loss = float(history["loss"]) + area * float(patches.share @ moved.loss)
        elastic = self.joint.elastic
        after = self.history_layout.join(
            {
                "state": update.state,
                "loss": loss,
                "rigid": displacement.tangential,
                "reference": update.onset_approach,
                "lowest": update.min_approach,
                "approach": update.approach,
                "force": moved.force,
                "apart": displacement.normal if elastic else 0.0,
                "amplitude": np.pad(modal_coordinates, (0, MODES - modal_coordinates.size)),
                "tangent": moved.tangent if elastic else 0.0,
            }
        )
        further = consistent_tangent(patches, update.stick_stiffness, moved.tangent, update.traction)
        return traction_sums(patches, update.traction) | further | {"loss": loss / area}, after

    def _full_stick_update(
        self, history: History, first: Array, approach: Array, displacement: Array, stick_stiffness: Array
    ) -> SliderUpdate | None:
        """The patches after a straight path on which all sliders stick; None if one moves more than hardly.

        Their force stands in the place of the first slider: so heights may follow the load.
        """
        traction, rests = self.foundation().full_stick_update(
            full_stick_force(history["force"]), first, approach, displacement
        )
        if not np.all(rests):
            return None
        force = np.zeros_like(history["force"])
        force[..., 0], force[:, 1, 1] = traction[:, :2], traction[:, 2]
        return SliderUpdate(force, np.zeros_like(stick_stiffness), stick_stiffness[:, None] * STICK_TANGENT)

    def _tangent_predictor(
        self, load_step: LoadStep, bolt_force: Array, modal_coordinates: Array
    ) -> tuple[Array, Array]:
        """Amplitudes (k) [m] that follow the motion from `amplitude` in the tangent of its beginning, and the
        derivative (k, k) [N/m] of the residual by them there."""
        whole, before, there = self.assembly, load_step.history, load_step.displacement_at(0.0)
        points, patches = load_step.approaches(there, modal_coordinates)
        tangent = before["tangent"]
        if before["state"] == UNKNOWN:
            tangent = self.foundation().stick_stiffness(patches)[:, None] * STICK_TANGENT
        bolts = self.bolts.tangent(bolt_force, whole.elongation(there, modal_coordinates))
        H = whole.tangent_stiffness(self.curve.derivatives(points, 1)[1], tangent, bolts)
        motion = load_step.end.components - there.components
        return np.asarray(modal_coordinates - np.linalg.solve(H[6:, 6:], H[6:, :6] @ motion)), H[6:, 6:]

    def _gap_sums(
        self, displacement: RelativeDisplacement, bolt_force: Array, sums: Mapping[str, Number]
    ) -> dict[str, Number]:
        """Sums of rigid sides with the gaps under the heads, from bolt forces (b) [N] at tightening."""
        bolts, area = self.bolts, self.joint.A_0
        elongation = bolts.elongation @ displacement.normal
        gap = bolts.count * bolts.gap(bolt_force, elongation)
        missing = bolts.count * (bolts.stiffness - bolts.tangent(bolt_force, elongation))
        x, y = bolts.position.T
        return {
            **dict(zip(STRETCHES, [np.sum(gap), gap @ x, gap @ y], strict=True)),
            "normal_stiffness": sums["normal_stiffness"] - np.sum(missing) / area,
            "normal_about_x": sums["normal_about_x"] - (missing @ y**2) / area,
            "normal_about_y": sums["normal_about_y"] - (missing @ x**2) / area,
        }

    def _assembly_sums(
        self,
        state: "TrialState",
        displacement: RelativeDisplacement,
        modal_coordinates: Array,
        bolt_force: Array,
        loop_energy: Number,
    ) -> dict[str, Number]:
        """Sums of elastic sides: stiffnesses of the whole without the bolts' own part, see `outputs`.

        bolt_force : (b) [N] at tightening
        """
        joint, area, modes = self.joint, self.joint.A_0, self.modes
        bolts, (_, _, x2, y2, _) = joint.n_bolts * joint.bolt_stiffness, joint.pattern.bolt_means
        whole = self.assembly.elongation(displacement, modal_coordinates)
        gap = self.bolts.gap(bolt_force, whole)
        slope = self.assembly.tangent_stiffness(
            state.stiffness, state.tangent, self.bolts.tangent(bolt_force, whole)
        )
        K = np.maximum(np.diag(self.assembly.condense(slope)), 0.0)
        stretch = modes.bolt_elongation @ modal_coordinates + gap
        elastic = joint.bolt_stiffness * (whole @ whole) - joint.bolt_stiffness * (gap @ gap)
        energy = 0.5 * (modes.stiffness @ modal_coordinates**2 + elastic)
        values = [np.sum(stretch), *(stretch @ modes.bolts)]
        return {
            **dict(zip(STRETCHES, values, strict=True)),
            "tangent_x": K[0] / area,
            "tangent_y": K[1] / area,
            "normal_stiffness": (K[2] - bolts) / area,
            "normal_about_x": (K[3] - bolts * y2) / area,
            "normal_about_y": (K[4] - bolts * x2) / area,
            "tangent_z": K[5] / area,
            "loop_energy": loop_energy + energy / area,
        }

    def first_loading_work(self, p: Array) -> tuple[Array, Array]:
        """Plastic and elastic work [J] of the whole area at pressures (...) (Zhao 2018, Eqs. 16, 18).

        Inside the closing of the contact, where the law itself has hardly an elastic spot, the values
        at its end are kept.
        """
        spots, u = (
            self.joint.spots(),
            solve_largest_spot(self.joint, np.maximum(p, self.curve.closing_end_load)),
        )
        return spots.total("plastic_work", u), spots.total("elastic_work", u)
