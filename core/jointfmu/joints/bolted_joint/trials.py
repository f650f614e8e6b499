"""The bolted joint on its way to a place, for amplitudes of the modes of its sides."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...mechanics.jenkins import SliderUpdate
from ...mechanics.sliders import resultant
from ...quantity import Array
from .contact import RelativeDisplacement
from .memory import FULL_STICK, History, full_stick_force

if TYPE_CHECKING:
    from .spring import BoltedJointSpring

DIFFERENCE_STEP = 1e-7
"""Part of the largest approach at tightening [1] by which patches move to find the slopes of their tractions;
or of the approach at which the contact has closed, if it is larger: without preload all patches are open."""


@dataclass(frozen=True, slots=True)
class FrictionUpdate:
    """How the patches came to where they are: state and (m) [m] reference, lowest, approach of `memory_of`.

    stick : (m) [Pa/m] of all sliders
    """

    state: int
    onset_approach: Array
    min_approach: Array
    approach: Array
    slider_update: SliderUpdate
    stick_stiffness: Array

    @property
    def traction(self) -> Array:
        """(m, 3) [Pa] against the shift, see `together`."""
        return (
            full_stick_force(self.slider_update.force)
            if self.state == FULL_STICK
            else resultant(self.slider_update.force)
        )


@dataclass(frozen=True, slots=True)
class TrialState:
    """A joint with amplitudes of its modes.

    derivatives : of the pressure (n) [Pa] over the approach of the points
    approach    : (m) [m] of the patches
    way         : of the patches, None without memory
    """

    derivatives: list[Array]
    approach: Array
    friction: FrictionUpdate | None

    @property
    def pressure(self) -> Array:
        """(n) [Pa]."""
        return self.derivatives[0]

    @property
    def stiffness(self) -> Array:
        """(n) [Pa/m]."""
        return self.derivatives[1]

    @property
    def traction(self) -> Array:
        """(m, 3) [Pa] against the shift, see `together`."""
        assert self.friction
        return self.friction.traction

    @property
    def tangent(self) -> Array:
        """(m, 6) [Pa/m], see `Moved`."""
        assert self.friction
        return self.friction.slider_update.tangent


@dataclass(frozen=True, slots=True)
class LoadStep:
    """The joint on its way from a memory to a place.

    starts : approaches [m] of points (n) and patches (m) at tightening
    told   : the inputs at its end, as text
    """

    spring: "BoltedJointSpring"
    preloaded_approaches: tuple[Array, Array]
    end: RelativeDisplacement
    history: History
    input_summary: str

    def displacement_at(self, load_factor: float) -> RelativeDisplacement:
        """Where it is after a part [1] of the way."""
        if load_factor == 1.0:
            return self.end
        before = self.history
        first = np.array([*before["rigid"][:2], *before["apart"], before["rigid"][2]])
        return RelativeDisplacement(first + load_factor * (self.end.components - first))

    def approaches(self, displacement: RelativeDisplacement, modal_coordinates: Array) -> tuple[Array, Array]:
        """Approaches [m] of points (n) and patches (m)."""
        spring, (points, patches) = self.spring, self.preloaded_approaches
        there = points - (displacement.opening(spring.shape) + spring.modes.opening @ modal_coordinates)
        if spring.joint.elastic:
            return there, spring.patch_approach(there)
        return there, patches - displacement.opening(spring.patches)

    def evaluate(self, displacement: RelativeDisplacement, modal_coordinates: Array) -> TrialState:
        """At a place with amplitudes (k) [m]."""
        points, patches = self.approaches(displacement, modal_coordinates)
        way = (
            self._friction_update(displacement, modal_coordinates, patches, np.zeros(3))
            if self.spring.joint.memory
            else None
        )
        return TrialState(self.spring.curve.derivatives(points, 3), patches, way)

    def _friction_update(
        self,
        displacement: RelativeDisplacement,
        modal_coordinates: Array,
        approach: Array,
        extra_displacement: Array,
    ) -> FrictionUpdate:
        spring, before = self.spring, self.history
        shift = spring.patch_displacement(
            displacement.tangential - before["rigid"],
            modal_coordinates - before["amplitude"][: modal_coordinates.size],
        )
        shift += extra_displacement
        return spring.update_friction(before, approach, shift, displacement.tangential)

    def modal_opening(self, state: TrialState) -> Array:
        """How far the patches come apart by the modes (m, k) [1], as the points that press on them do."""
        spring, stiffness = self.spring, self.spring.curve.derivatives(state.approach, 1)[1][:, None]
        touches = stiffness > 0.0
        rows = (spring.pressure_transfer * state.stiffness) @ spring.modes.opening
        return np.asarray(np.where(touches, rows / np.where(touches, stiffness, 1.0), 0.0))

    def traction_derivatives(self, displacement: RelativeDisplacement, modal_coordinates: Array) -> Array:
        """Derivatives (m, 3, 4) [Pa/m] of the traction by shifts along x, y and around the centres, and by
        coming apart.

        By differences, at the end of the way; FMUs have the derivative of the rule.
        """
        approach = self.approaches(displacement, modal_coordinates)[1]
        first = self.spring.curve.displacement[0]
        step = DIFFERENCE_STEP * float(np.max(np.maximum(self.preloaded_approaches[1], 0.0) - first))

        def traction(extra_displacement: Array) -> Array:
            return self._friction_update(
                displacement, modal_coordinates, approach - extra_displacement[3], extra_displacement[:3]
            ).traction

        here = traction(np.zeros(4))
        return np.stack([(traction(motion) - here) / step for motion in step * np.eye(4)], axis=-1)


def summarise_inputs(preload: float, moment: float, displacement: RelativeDisplacement) -> str:
    """Inputs that are not zero, as text."""
    names = ("preload", "moment", "s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
    values = dict(zip(names, (preload, moment, *displacement.components), strict=True))
    return ", ".join(f"{name} = {value:g}" for name, value in values.items() if value)
