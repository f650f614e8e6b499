"""The bolted joint on its way to a place, for amplitudes of the modes of its sides."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...mechanics.jenkins import Moved
from ...mechanics.sliders import together
from ...quantity import Array
from .contact import Place
from .memory import RESTING, Memory, resting

if TYPE_CHECKING:
    from .spring import BoltedJointSpring

DIFFERENCE = 1e-7
"""Part of the largest approach at tightening [1] by which patches move to find the slopes of their tractions;
or of the approach at which the contact has closed, if it is larger: without preload all patches are open."""


@dataclass(frozen=True, slots=True)
class Way:
    """How the patches came to where they are: state and (m) [m] reference, lowest, approach of `memory_of`.

    stick : (m) [Pa/m] of all sliders
    """

    state: int
    reference: Array
    lowest: Array
    approach: Array
    moved: Moved
    stick: Array

    @property
    def traction(self) -> Array:
        """(m, 3) [Pa] against the shift, see `together`."""
        return resting(self.moved.force) if self.state == RESTING else together(self.moved.force)


@dataclass(frozen=True, slots=True)
class Trial:
    """A joint with amplitudes of its modes.

    derivatives : of the pressure (n) [Pa] over the approach of the points
    approach    : (m) [m] of the patches
    way         : of the patches, None without memory
    """

    derivatives: list[Array]
    approach: Array
    way: Way | None

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
        assert self.way
        return self.way.traction

    @property
    def tangent(self) -> Array:
        """(m, 6) [Pa/m], see `Moved`."""
        assert self.way
        return self.way.moved.tangent


@dataclass(frozen=True, slots=True)
class Trials:
    """The joint on its way from a memory to a place.

    starts : approaches [m] of points (n) and patches (m) at tightening
    told   : the inputs at its end, as text
    """

    spring: "BoltedJointSpring"
    starts: tuple[Array, Array]
    end: Place
    before: Memory
    told: str

    def place(self, part: float) -> Place:
        """Where it is after a part [1] of the way."""
        if part == 1.0:
            return self.end
        before = self.before
        first = np.array([*before["rigid"][:2], *before["apart"], before["rigid"][2]])
        return Place(first + part * (self.end.six - first))

    def approaches(self, place: Place, amplitude: Array) -> tuple[Array, Array]:
        """Approaches [m] of points (n) and patches (m)."""
        spring, (points, patches) = self.spring, self.starts
        there = points - (place.apart(spring.shape) + spring.modes.opening @ amplitude)
        if spring.joint.elastic:
            return there, spring.pressed(there)
        return there, patches - place.apart(spring.patches)

    def at(self, place: Place, amplitude: Array) -> Trial:
        """At a place with amplitudes (k) [m]."""
        points, patches = self.approaches(place, amplitude)
        way = self._way(place, amplitude, patches, np.zeros(3)) if self.spring.joint.memory else None
        return Trial(self.spring.curve.derivatives(points, 3), patches, way)

    def _way(self, place: Place, amplitude: Array, approach: Array, further: Array) -> Way:
        spring, before = self.spring, self.before
        shift = spring.shift(place.rigid - before["rigid"], amplitude - before["amplitude"][: amplitude.size])
        shift += further
        return spring.way(before, approach, shift, place.rigid)

    def apart(self, at: Trial) -> Array:
        """How far the patches come apart by the modes (m, k) [1], as the points that press on them do."""
        spring, stiffness = self.spring, self.spring.curve.derivatives(at.approach, 1)[1][:, None]
        touches = stiffness > 0.0
        rows = (spring.pressing * at.stiffness) @ spring.modes.opening
        return np.asarray(np.where(touches, rows / np.where(touches, stiffness, 1.0), 0.0))

    def slopes(self, place: Place, amplitude: Array) -> Array:
        """Derivatives (m, 3, 4) [Pa/m] of the traction by shifts along x, y and around the centres, and by
        coming apart.

        By differences, at the end of the way; FMUs have the derivative of the rule.
        """
        approach = self.approaches(place, amplitude)[1]
        first = self.spring.curve.displacement[0]
        step = DIFFERENCE * float(np.max(np.maximum(self.starts[1], 0.0) - first))

        def traction(further: Array) -> Array:
            return self._way(place, amplitude, approach - further[3], further[:3]).traction

        here = traction(np.zeros(4))
        return np.stack([(traction(motion) - here) / step for motion in step * np.eye(4)], axis=-1)


def told(preload: float, moment: float, place: Place) -> str:
    """Inputs that are not zero, as text."""
    names = ("preload", "moment", "s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
    values = dict(zip(names, (preload, moment, *place.six), strict=True))
    return ", ".join(f"{name} = {value:g}" for name, value in values.items() if value)
