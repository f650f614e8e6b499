"""The exported bolted joint: six degrees of freedom under uneven pressure, with friction that remembers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from ...contact.interface import largest_spot
from ...mechanics.curve import Curve, approach_curve
from ...mechanics.footprint.bolts import PressureSource, pressure_shape
from ...mechanics.footprint.friction import friction_patches
from ...mechanics.footprint.patches import few_points
from ...mechanics.footprint.shape import PATCHES, FrictionPatches, NodalField, PressureShape
from ...mechanics.jenkins import Moved
from ...mechanics.memory import Layout
from ...mechanics.sliders import Foundation, around, lowered, offsets
from ...quantity import Array, Number
from .bodies import MODES, Modes, RigidBodies
from .bolts import BoltSprings
from .compliances import Compliances
from .contact import (
    STICKS,
    Place,
    along,
    elastic_shear,
    further_tangent,
    loop_sums,
    normal_sums,
    over_plane,
    pressing,
    shifts,
    tangent_sums,
    traction_sums,
)
from .law import Bolted, interface_alone, pressures
from .memory import ALONG, FREE, RESTING, UNKNOWN, Memory, memory_of, moved_on, resting
from .outputs import STRETCHES, bolt_force_name, outputs
from .trials import Trial, Trials, Way, told
from .whole import Tightened, Whole

POINTS = 120
"""Points that carry the normal force [1], where a pattern has more nodes."""
REST = (0.0, 0.0, 0.0)


@lru_cache(maxsize=8)
def points(pattern: PressureSource) -> PressureShape:
    """The points that carry the normal force of a joint."""
    return few_points(pressure_shape(pattern), POINTS)


@lru_cache(maxsize=8)
def patches(pattern: PressureSource) -> FrictionPatches:
    """The patches of its friction."""
    stated = pattern.patches() if isinstance(pattern, NodalField) else None
    return stated or friction_patches(pressure_shape(pattern), PATCHES)


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
    shape: PressureShape
    patches: FrictionPatches
    modes: Modes

    @classmethod
    def of(cls, joint: Bolted) -> "BoltedJointSpring":
        """Tabulate a joint, on as few points as its FMU has.

        Raises ValueError for bodies that were computed for another contact.
        """
        shape, few = points(joint.pattern), patches(joint.pattern)
        bodies = joint.bodies if joint.elastic else RigidBodies()
        modes = Modes.of(bodies, shape.share.size, few.position)
        return cls(joint, approach_curve(joint), shape, few, modes)

    @classmethod
    def of_nodes(cls, joint: Bolted, nodes: PressureShape | None = None) -> "BoltedJointSpring":
        """The interface alone, on all nodes of its pattern or on given ones."""
        shape, joint = pressure_shape(joint.pattern) if nodes is None else nodes, interface_alone(joint)
        modes = Modes.none(shape.share.size, shape.share.size)
        return cls(joint, approach_curve(joint), shape, shape.as_patches(), modes)

    def on(self, nodes: PressureShape) -> "BoltedJointSpring":
        """The same interface alone on other nodes."""
        count = nodes.share.size
        modes = Modes.none(count, count)
        few = nodes.as_patches()
        return replace(self, joint=interface_alone(self.joint), shape=nodes, patches=few, modes=modes)

    @cached_property
    def _foundations(self) -> Callable[[bytes, bytes], Foundation]:
        """The sliders of the patches around approaches and above lowest ones, of which the last are kept."""
        ratio, mu, shifts = float(self.joint.shear_ratio()), self.joint.mu, offsets(self.patches.equal)

        def build(*approaches: bytes) -> Foundation:
            reference, lowest = (np.frombuffer(each) for each in approaches)
            return Foundation(self.curve, ratio, mu, lowered(around(self.curve, reference, shifts), lowest))

        return lru_cache(maxsize=4)(build)

    def foundation(self, reference: Array | None = None, lowest: Array | None = None) -> Foundation:
        """The sliders of patches which first move at approaches (m) [m]; None: not yet known.

        lowest : (m) [m] least approach since then; None: the first one
        """
        first = np.zeros(self.patches.share.size) if reference is None else reference
        both = first, first if lowest is None else lowest
        return self._foundations(*(np.ascontiguousarray(each).tobytes() for each in both))

    def tightened(self, preload: float, moment: float) -> Array:
        """Approach (n) [m] of the nodes at tightening."""
        return self.curve.inverse(pressures(self.joint, self.shape, preload, moment))

    def tightened_patches(self, preload: float, moment: float) -> Array:
        """The same (m) [m] of the patches."""
        if self.joint.elastic:
            return self.pressed(self.tightened(preload, moment))
        return self.curve.inverse(pressures(self.joint, self.patches, preload, moment))

    @cached_property
    def _tightened(self) -> Callable[[float, float], tuple[Array, ...]]:
        """Approach [m] at tightening of the points, the pressure [Pa] there, and the approach of the patches;
        the last ones are kept."""

        def build(preload: float, moment: float) -> tuple[Array, ...]:
            start = self.tightened(preload, moment)
            patches = self.tightened_patches(preload, moment)
            return start, self.curve.derivatives(start, 0)[0], patches

        return lru_cache(maxsize=2)(build)

    @cached_property
    def pressing(self) -> Array:
        """(m, n) [1] pressure of the patches over that of the points, where sides are elastic."""
        return pressing(self.shape, self.patches)

    def pressed(self, approach: Array) -> Array:
        """Approach (m) [m] of the patches to points at approaches (n) [m]: that at which they have the normal
        force of their points, or, where all of these are open, that of the nearest one."""
        p = self.pressing @ self.curve.derivatives(approach, 0)[0]
        nearest = np.max(np.where(self.pressing > 0.0, approach, -np.inf), axis=1)
        return np.where(p > 0.0, self.curve.inverse(p), np.minimum(nearest, self.curve.displacement[0]))

    def within_law(self, preload: float, moment: float) -> Array:
        """As `tightened`; ValueError if nothing is in contact or the hardness is reached."""
        start = self.tightened(preload, moment)
        low, high = self.curve.displacement[[0, -1]]
        if not (np.isfinite(preload + moment) and low < np.max(start) < high):
            raise ValueError(
                f"preload = {preload:g} N per bolt with moment = {moment:g} N.m is outside the law: expected "
                f"contact after embedding ({self.joint.embedding:g} N), and at most {self.curve.end[1]:g} Pa"
            )
        return start

    def motion(
        self,
        preload: float,
        moment: float,
        s_rel: tuple[float, float, float],
        v_rel: tuple[float, float, float],
        theta: tuple[float, float, float] = REST,
        omega: tuple[float, float, float] = REST,
    ) -> dict[str, Number]:
        """Outputs of a joint that has not moved along its surface before.

        preload [N] per bolt, moment [N.m], s_rel [m] (z positive apart), v_rel [m/s], small turn theta [rad]
        of side 2 about the joint's centre, omega [rad/s].
        """
        place = Place(np.array([*s_rel, *theta]))
        return self.evolve(preload, moment, place, (*v_rel, *omega), self.at_rest())[0]

    @property
    def memory(self) -> Layout:
        """What it remembers."""
        return memory_of(self.patches.share.size)

    def at_rest(self) -> Array:
        """Memory of a joint that has not moved yet: UNKNOWN, and zero."""
        return self.memory.rest()

    def evolve(
        self, preload: float, moment: float, place: Place, rates: tuple[float, ...], memory: Array
    ) -> tuple[dict[str, Number], Array]:
        """Outputs at a place with rates (v_rel, omega), and the memory after the straight path there.

        Raises ValueError if elastic sides find no equilibrium.
        """
        joint, shape = self.joint, self.shape
        start, tight, first = self._tightened(float(preload), float(moment))
        bolt_force = self.bolts.tightened(joint, preload, moment)
        before = self.memory.split(memory)

        trials = Trials(self, (start, first), place, before, told(preload, moment, place))
        amplitude = np.zeros(0)
        if joint.elastic:
            begin = before["amplitude"][: len(self.modes.stiffness)]
            followed = self._followed(trials, bolt_force, begin)
            amplitude, at = self.whole.solve(trials, Tightened(tight, bolt_force), begin, *followed)
        else:
            at = trials.at(place, amplitude)
        if at.way is not None:
            shear, after = self._friction(at.way, amplitude, place, before)
            lifted = stiffer = np.zeros_like(tight)
        else:
            limit, rho = joint.mu * tight, joint.shear_ratio()
            *parts, lifted, stiffer = elastic_shear(limit, rho, at.derivatives, *along(shape, place.rigid).T)
            none, nodes = np.zeros_like(tight), shape.as_patches()
            traction, tangent = (
                np.stack(each, axis=-1) for each in ([*parts[:2], none], [*parts[2:], none, none, none])
            )
            shear, after = traction_sums(nodes, traction) | tangent_sums(nodes, tangent), memory
            shear["loss"] = 0.0
        plastic, elastic = self.works(at.derivatives[0])
        shift = self.shift(place.rigid, amplitude)
        size = np.sqrt(np.sum(shift**2, axis=1))
        sums: dict[str, Number] = {
            **over_plane(shape, "tightened", tight),
            **normal_sums(shape, lifted, stiffer, at.derivatives),
            "plastic": shape.share @ plastic,
            "elastic": shape.share @ elastic,
            **shear,
            **loop_sums(self.foundation(), self.patches.share, at.approach, size),
        }
        if joint.elastic:
            sums |= self._whole_sums(at, place, amplitude, bolt_force, sums["loop_energy"])
        else:
            sums |= self._gap_sums(place, bolt_force, sums)
        s_rel, theta = place.six.reshape(2, 3).tolist()
        out = outputs(joint, sums, s_rel, theta, rates, np.max(at.derivatives[0]))
        if not joint.elastic:
            return out, after
        forces = self.bolts.force(bolt_force, self.whole.stretch(place, amplitude))
        return out | {bolt_force_name(j): force for j, force in enumerate(forces)}, after

    def slope(self, preload: float, moment: float = 0.0) -> Array:
        """`Whole.slope` of elastic sides at tightening."""
        stick = self.foundation().stick(self.tightened_patches(preload, moment))[:, None] * STICKS
        bolt_force = self.bolts.tightened(self.joint, preload, moment)
        bolts = self.bolts.tangent(bolt_force, np.zeros_like(bolt_force))
        return self.whole.slope(self.curve.derivatives(self.tightened(preload, moment), 1)[1], stick, bolts)

    def compliances(self, preload: float, moment: float = 0.0) -> Compliances:
        """Of elastic sides, tightened by the force of each bolt [N] and a moment [N.m]."""
        return Compliances.of(self, preload, moment)

    @cached_property
    def whole(self) -> Whole:
        """The contact with what gives way around it."""
        area, closed = self.joint.A_0, self.curve.closed
        return Whole.of(self.modes, self.shape, self.patches, area, self.bolts, closed)

    @cached_property
    def bolts(self) -> BoltSprings:
        """Its bolts, which act beside the contact."""
        return BoltSprings.of(self.joint, self.curve.closed)

    def shift(self, rigid: Array, amplitude: Array) -> Array:
        """`shifts` (m, 3) [m] of the patches by a rigid motion (3) and amplitudes (k) [m] of the modes."""
        return np.asarray(shifts(self.patches, rigid) + (self.modes.patch @ amplitude).T)

    def way(self, before: Memory, approach: Array, shift: Array, rigid: Array) -> "Way":
        """How the patches move on a straight path to approaches (m) [m] by `shifts` (m, 3) [m]."""
        first = approach if before["state"] == UNKNOWN else before["approach"]
        stick = self.foundation().stick(approach)
        moved = self._at_rest(before, first, approach, shift, stick) if before["state"] < ALONG else None
        if moved is not None:
            return Way(RESTING, approach, approach, approach, moved, stick)
        state = FREE if self.joint.elastic else moved_on(before, rigid)
        reference = lowest = first
        if before["state"] >= ALONG:
            reference = before["reference"]
            opened = before["lowest"] < self.curve.displacement[0]
            lowest = np.where(opened, first, np.minimum(before["lowest"], first))
        foundation, force = self.foundation(reference, lowest), before["force"]
        if before["state"] < ALONG:
            force = foundation.spread(resting(force), first)
        return Way(state, reference, lowest, approach, foundation.moved(force, first, approach, shift), stick)

    def _friction(
        self, way: "Way", amplitude: Array, place: Place, before: Memory
    ) -> tuple[dict[str, Number], Array]:
        """Sums of the shear, and the memory after a way of the patches."""
        patches, area, moved = self.patches, self.joint.A_0, way.moved
        loss = float(before["loss"]) + area * float(patches.share @ moved.loss)
        elastic = self.joint.elastic
        after = self.memory.joined(
            {
                "state": way.state,
                "loss": loss,
                "rigid": place.rigid,
                "reference": way.reference,
                "lowest": way.lowest,
                "approach": way.approach,
                "force": moved.force,
                "apart": place.normal if elastic else 0.0,
                "amplitude": np.pad(amplitude, (0, MODES - amplitude.size)),
                "tangent": moved.tangent if elastic else 0.0,
            }
        )
        further = further_tangent(patches, way.stick, moved.tangent, way.traction)
        return traction_sums(patches, way.traction) | further | {"loss": loss / area}, after

    def _at_rest(
        self, before: Memory, first: Array, approach: Array, shift: Array, stick: Array
    ) -> Moved | None:
        """The patches after a straight path on which all sliders stick; None if one moves more than hardly.

        Their force stands in the place of the first slider: so heights may follow the load.
        """
        traction, rests = self.foundation().rested(resting(before["force"]), first, approach, shift)
        if not np.all(rests):
            return None
        force = np.zeros_like(before["force"])
        force[..., 0], force[:, 1, 1] = traction[:, :2], traction[:, 2]
        return Moved(force, np.zeros_like(stick), stick[:, None] * STICKS)

    def _followed(self, trials: Trials, bolt_force: Array, amplitude: Array) -> tuple[Array, Array]:
        """Amplitudes (k) [m] that follow the motion from `amplitude` in the tangent of its beginning, and the
        derivative (k, k) [N/m] of the residual by them there."""
        whole, before, there = self.whole, trials.before, trials.place(0.0)
        points, patches = trials.approaches(there, amplitude)
        tangent = before["tangent"]
        if before["state"] == UNKNOWN:
            tangent = self.foundation().stick(patches)[:, None] * STICKS
        bolts = self.bolts.tangent(bolt_force, whole.stretch(there, amplitude))
        H = whole.slope(self.curve.derivatives(points, 1)[1], tangent, bolts)
        motion = trials.end.six - there.six
        return np.asarray(amplitude - np.linalg.solve(H[6:, 6:], H[6:, :6] @ motion)), H[6:, 6:]

    def _gap_sums(self, place: Place, bolt_force: Array, sums: Mapping[str, Number]) -> dict[str, Number]:
        """Sums of rigid sides with the gaps under the heads, from bolt forces (b) [N] at tightening."""
        bolts, area = self.bolts, self.joint.A_0
        elongation = bolts.elongation @ place.normal
        gap = bolts.count * bolts.gap(bolt_force, elongation)
        missing = bolts.count * (bolts.stiffness - bolts.tangent(bolt_force, elongation))
        x, y = bolts.position.T
        return {
            **dict(zip(STRETCHES, [np.sum(gap), gap @ x, gap @ y], strict=True)),
            "normal_stiffness": sums["normal_stiffness"] - np.sum(missing) / area,
            "normal_about_x": sums["normal_about_x"] - (missing @ y**2) / area,
            "normal_about_y": sums["normal_about_y"] - (missing @ x**2) / area,
        }

    def _whole_sums(
        self, at: "Trial", place: Place, amplitude: Array, bolt_force: Array, loop_energy: Number
    ) -> dict[str, Number]:
        """Sums of elastic sides: stiffnesses of the whole without the bolts' own part, see `outputs`.

        bolt_force : (b) [N] at tightening
        """
        joint, area, modes = self.joint, self.joint.A_0, self.modes
        bolts, (_, _, x2, y2, _) = joint.n_bolts * joint.bolt_stiffness, joint.pattern.bolt_means
        whole = self.whole.stretch(place, amplitude)
        gap = self.bolts.gap(bolt_force, whole)
        slope = self.whole.slope(at.stiffness, at.tangent, self.bolts.tangent(bolt_force, whole))
        K = np.maximum(np.diag(self.whole.condensed(slope)), 0.0)
        stretch = modes.stretch @ amplitude + gap
        elastic = joint.bolt_stiffness * (whole @ whole) - joint.bolt_stiffness * (gap @ gap)
        energy = 0.5 * (modes.stiffness @ amplitude**2 + elastic)
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

    def works(self, p: Array) -> tuple[Array, Array]:
        """Plastic and elastic work [J] of the whole area at pressures (...) (Zhao 2018, Eqs. 16, 18).

        Inside the closing of the contact, where the law itself has hardly an elastic spot, the values
        at its end are kept.
        """
        spots, u = self.joint.spots(), largest_spot(self.joint, np.maximum(p, self.curve.closed))
        return spots.total("plastic_work", u), spots.total("elastic_work", u)
