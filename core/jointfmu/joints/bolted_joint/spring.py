"""The exported bolted joint: six degrees of freedom under uneven pressure, with friction that remembers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from ...contact.interface import largest_spot
from ...mechanics.curve import Curve, approach_curve
from ...mechanics.footprint.bolts import PressureSource, pressure_shape
from ...mechanics.footprint.friction import friction_patches
from ...mechanics.footprint.patches import few_points
from ...mechanics.footprint.shape import PressureShape
from ...mechanics.memory import Layout
from ...mechanics.sliders import SLIDERS, Foundation, around, offsets
from ...quantity import Number
from .contact import (
    Place,
    along,
    elastic_shear,
    further_tangent,
    loop_sums,
    normal_sums,
    over_plane,
    shear_sums,
)
from .law import Bolted, pressures, shear_ratio
from .outputs import outputs

Array = NDArray[np.float64]

POINTS = 120
"""Points that carry the normal force [1], where a pattern has more nodes."""
PATCHES = 22
"""Points that carry the friction [1], each with sliders."""
REST = (0.0, 0.0, 0.0)
UNKNOWN, RESTING, ALONG, FREE = range(4)
"""How friction has moved so far, see `memory_of`."""


def memory_of(patches: int) -> Layout:
    """What friction remembers on so many patches.

    state     : UNKNOWN: the path begins at the present approach, which is the reference as well, without a
                shift; RESTING: it has not moved along its surface; ALONG: it has along x alone; FREE: along
                y or by a turn, too
    loss      : [J] turned into heat so far
    rigid     : (3) shift along x and y [m] and turn about the normal [rad]
    reference : (m) [m] approach of the patches when they first moved along the surface, or until they do
    approach  : (m) [m] of the patches
    force     : (m, 2, n) [Pa] of the sliders
    """
    one = (patches,)
    return Layout(
        {
            "state": (),
            "loss": (),
            "rigid": (3,),
            "reference": one,
            "approach": one,
            "force": (*one, 2, SLIDERS),
        }
    )


@lru_cache(maxsize=8)
def points(pattern: PressureSource) -> PressureShape:
    """The points that carry the normal force of a joint."""
    return few_points(pressure_shape(pattern), POINTS)


@lru_cache(maxsize=8)
def patches(pattern: PressureSource) -> PressureShape:
    """The points that carry its friction."""
    return friction_patches(pressure_shape(pattern), PATCHES)


@dataclass(frozen=True)
class BoltedJointSpring:
    """The exported joint: relative motion of its two sides in, forces and moments out.

    Every node follows the pressure-approach curve `p(delta)` of the interface from its own pressure at
    tightening: the normal traction is the gradient of a potential, V' = p. Shear is carried by the sliders of
    `Foundation` on fewer points, which slip and remember, or without memory by the potential of
    `elastic_shear`. The n bolts act beside the interface: they carry the joint once it is open, by their
    tension alone.

    shape   : the points that carry the normal force
    patches : the points that carry the friction
    """

    joint: Bolted
    curve: Curve
    shape: PressureShape
    patches: PressureShape

    @classmethod
    def of(cls, joint: Bolted) -> "BoltedJointSpring":
        """Tabulate a joint, on as few points as its FMU has."""
        return cls(joint, approach_curve(joint), points(joint.pattern), patches(joint.pattern))

    @classmethod
    def of_nodes(cls, joint: Bolted, nodes: PressureShape | None = None) -> "BoltedJointSpring":
        """On all nodes of its pattern, or on given ones."""
        shape = pressure_shape(joint.pattern) if nodes is None else nodes
        return cls(joint, approach_curve(joint), shape, shape)

    def on(self, nodes: PressureShape) -> "BoltedJointSpring":
        """The same interface on other nodes."""
        return replace(self, shape=nodes, patches=nodes)

    @cached_property
    def _foundations(self) -> Callable[[bytes], Foundation]:
        """The sliders of the patches around approaches, of which the last ones are kept."""
        ratio, mu, shifts = float(shear_ratio(self.joint)), self.joint.mu, offsets(self.patches.equal)

        def build(reference: bytes) -> Foundation:
            return Foundation(self.curve, ratio, mu, around(self.curve, np.frombuffer(reference), shifts))

        return lru_cache(maxsize=4)(build)

    def foundation(self, reference: Array | None = None) -> Foundation:
        """The sliders of patches which first move at approaches (m) [m]; None: not yet known."""
        first = np.zeros(self.patches.share.size) if reference is None else reference
        return self._foundations(np.ascontiguousarray(first).tobytes())

    def tightened(self, preload: float, moment: float) -> Array:
        """Approach (n) [m] of the nodes at tightening."""
        return self.curve.inverse(pressures(self.joint, self.shape, preload, moment))

    @cached_property
    def _tightened(self) -> Callable[[float, float], tuple[Array, ...]]:
        """Approach [m] at tightening of the points, the pressure [Pa] there, and the approach of the patches;
        the last ones are kept."""

        def build(preload: float, moment: float) -> tuple[Array, ...]:
            start = self.tightened(preload, moment)
            patches = self.curve.inverse(pressures(self.joint, self.patches, preload, moment))
            return start, self.curve.derivatives(start, 0)[0], patches

        return lru_cache(maxsize=2)(build)

    def within_law(self, preload: float, moment: float) -> Array:
        """As `tightened`; ValueError if nothing is in contact or the hardness is reached."""
        start = self.tightened(preload, moment)
        low, high = self.curve.displacement[[0, -1]]
        if not (np.isfinite(preload + moment) and low < np.max(start) < high):
            raise ValueError(
                f"preload = {preload:g} N per bolt with moment = {moment:g} N.m is outside the law: expected "
                f"some contact and a pressure of at most {self.curve.end[1]:g} Pa"
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
        place = Place(s_rel, theta)
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
        """Outputs at a place with rates (v_rel, omega), and the memory after the straight path there."""
        joint, shape = self.joint, self.shape
        start, tight, approach = self._tightened(float(preload), float(moment))
        derivatives = self.curve.derivatives(start - place.apart(shape), 3)
        approach = approach - place.apart(self.patches)
        if joint.memory:
            shear, after = self._friction(approach, place, memory)
            lifted = stiffer = np.zeros_like(tight)
        else:
            limit, rho = joint.mu * tight, shear_ratio(joint)
            *parts, lifted, stiffer = elastic_shear(limit, rho, derivatives, *place.along(shape).T)
            traction, tangent = np.stack(parts[:2], axis=-1), np.stack(parts[2:], axis=-1)
            shear, after = shear_sums(shape, traction, tangent) | {"loss": 0.0}, memory
        plastic, elastic = self.works(derivatives[0])
        sums: dict[str, Number] = {
            **over_plane(shape, "tightened", tight),
            **normal_sums(shape, lifted, stiffer, derivatives),
            "plastic": shape.share @ plastic,
            "elastic": shape.share @ elastic,
            **shear,
            **loop_sums(
                self.foundation(), self.patches.share, approach, np.hypot(*place.along(self.patches).T)
            ),
        }
        p_max = np.max(derivatives[0])
        return outputs(joint, sums, place.shift, place.turn, rates, p_max), after

    def _friction(self, approach: Array, place: Place, memory: Array) -> tuple[dict[str, Number], Array]:
        """Sums of the shear at approaches (m) [m] of the patches, and the memory after the straight path."""
        patches, area, before = self.patches, self.joint.A_0, self.memory.split(memory)
        rigid = np.array([*place.shift[:2], place.turn[2]])
        shift, state = along(patches, rigid - before["rigid"]), _moved_on(before, rigid)
        begins = before["state"] == UNKNOWN
        first, reference = (approach,) * 2 if begins else (before["approach"], before["reference"])
        moved = self.foundation(reference).moved(before["force"], first, approach, shift)
        loss = float(before["loss"]) + area * float(patches.share @ moved.loss)
        after = self.memory.joined(
            {
                "state": state,
                "loss": loss,
                "rigid": rigid,
                "reference": approach if state == RESTING else reference,
                "approach": approach,
                "force": moved.force,
            }
        )
        stick = self.foundation(reference).stick(approach)
        further = further_tangent(patches, stick, moved.tangent, moved.traction)
        return shear_sums(patches, moved.traction, moved.tangent) | further | {"loss": loss / area}, after

    def works(self, p: Array) -> tuple[Array, Array]:
        """Plastic and elastic work [J] of the whole area at pressures (...) (Zhao 2018, Eqs. 16, 18).

        Inside the closing of the contact, where the law itself has hardly an elastic spot, the values
        at its end are kept.
        """
        spots, u = self.joint.spots(), largest_spot(self.joint, np.maximum(p, self.curve.closed))
        return spots.total("plastic_work", u), spots.total("elastic_work", u)


def _moved_on(before: Mapping[str, Array], rigid: Array) -> int:
    """How friction has moved after the way to a shift and turn."""
    if before["state"] == FREE or not np.array_equal(rigid[1:], before["rigid"][1:]):
        return FREE
    return RESTING if before["state"] < ALONG and rigid[0] == before["rigid"][0] else ALONG
