"""Friction of the patches: history variables, full stick, update of the sliders, consistent tangent."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from ...mechanics.curve import Curve
from ...mechanics.footprint.distribution import FrictionPatches
from ...mechanics.history_layout import HistoryLayout
from ...mechanics.jenkins import SliderUpdate
from ...mechanics.sliders import (
    FOUNDATION_SLIDER_COUNT,
    Foundation,
    height_offsets,
    heights_after_liftoff,
    slider_heights,
    sum_slider_forces,
)
from ...quantity import Array
from .kinematics import TANGENTIAL_COMPONENT_INDICES, tangential_displacement
from .law import MAX_MODES

HistoryVariables = Mapping[str, Array]
"""{name: history variable}, see `history_layout`."""

BEFORE_FIRST_STEP, FULL_STICK, SLIP_1D, SLIP_2D = range(4)
"""State of friction: before the first step; no slider has slipped; slip along x alone; slip in the plane.

A joint with memory = false always has the first one."""
FULL_STICK_TANGENT_OVER_STIFFNESS = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
"""Tangent (6) of a patch in full stick over its stiffness [1]: xx, xy, yy, xr, yr, rr, with r the
displacement around the centre of the patch."""


def history_layout(patch_count: int) -> HistoryLayout:
    """History variables of a joint with m patches.

    state             : friction state; BEFORE_FIRST_STEP: the path starts at the present approach with q = 0
    loss              : [J] energy dissipated by friction
    tangential        : (3) s_x, s_y [m] and theta_z [rad]
    onset_approach    : (m) [m] of the patches at the end of full stick, or now in full stick
    min_approach      : (m) [m] smallest approach since then, or since the patch closed again
    approach          : (m) [m] of the patches
    force             : (m, 2, s) [Pa] forces of the s sliders of each patch along x and y; in full stick as
                        `full_stick_force` reads them
    normal            : (3) s_z [m] and theta_x, theta_y [rad]; this and the next two entries are used
                        with elastic members only
    modal_coordinates : (MAX_MODES) [m]
    tangent           : (m, 6) [Pa/m] of the patches, see `SliderUpdate`
    """
    one = (patch_count,)
    return HistoryLayout(
        {
            "state": (),
            "loss": (),
            "tangential": (3,),
            "onset_approach": one,
            "min_approach": one,
            "approach": one,
            "force": (*one, 2, FOUNDATION_SLIDER_COUNT),
            "normal": (3,),
            "modal_coordinates": (MAX_MODES,),
            "tangent": (*one, 6),
        }
    )


def full_stick_force(packed_forces: Array) -> Array:
    """Traction (m, 3) [Pa] of patches in full stick, from the history variable `packed_forces` (m, 2, s).

    In full stick, the first slider stores the sums along x and y of all sliders, and the force along y of the
    second slider stores the force around the centre. So the slider heights can change with the load.
    """
    return np.column_stack([packed_forces[..., 0], packed_forces[:, 1, 1]])


@dataclass(frozen=True, slots=True)
class FrictionUpdate:
    """Friction of m patches after a straight displacement path.

    friction_state : FULL_STICK, SLIP_1D or SLIP_2D
    onset_approach, min_approach, approach : (m) [m], see `history_layout`
    slider_update : forces, loss and tangent of the sliders
    stick_stiffness : (m) [Pa/m] of all sliders of a patch
    """

    friction_state: int
    onset_approach: Array
    min_approach: Array
    approach: Array
    slider_update: SliderUpdate
    stick_stiffness: Array

    @property
    def traction(self) -> Array:
        """Traction (m, 3) [Pa] against the displacement along x, along y and around the centre."""
        force = self.slider_update.force
        return full_stick_force(force) if self.friction_state == FULL_STICK else sum_slider_forces(force)


@dataclass(frozen=True)
class FrictionLaw:
    """Friction law of the patches of a bolted joint: tractions from displacements and history.

    pressure_curve       : contact pressure [Pa] as a function of the approach [m]
    stiffness_ratio      : K_T/K_N [1]
    friction_coefficient : mu [1]
    has_elastic_members  : members are elastic: slip is in the plane for any relative displacement
    """

    pressure_curve: Curve
    stiffness_ratio: float
    friction_coefficient: float
    patches: FrictionPatches
    has_elastic_members: bool

    @cached_property
    def _cached_foundation(self) -> Callable[[bytes, bytes], Foundation]:
        """Cached function for `foundation`: onset and smallest approach (bytes) -> foundation of sliders."""
        offsets = height_offsets(self.patches.preload_pressure_ratio)

        def build_foundation(*approaches: bytes) -> Foundation:
            """Build the slider foundation for an onset and a smallest approach [m], both as bytes."""
            onset, smallest = (np.frombuffer(each) for each in approaches)
            heights = heights_after_liftoff(slider_heights(self.pressure_curve, onset, offsets), smallest)
            return Foundation(self.pressure_curve, self.stiffness_ratio, self.friction_coefficient, heights)

        return lru_cache(maxsize=4)(build_foundation)

    def foundation(
        self, onset_approach: Array | None = None, min_approach: Array | None = None
    ) -> Foundation:
        """Foundation of sliders of the patches, for a history of their approach.

        Full stick and the energies of cycles depend on the lowest slider height only. This height is the same
        for all histories, so they need no arguments.

        onset_approach : (m) [m] at the end of full stick; None: 0
        min_approach   : (m) [m] smallest approach since then; None: onset_approach
        """
        onset = np.zeros(self.patches.area_share.size) if onset_approach is None else onset_approach
        both = onset, onset if min_approach is None else min_approach
        return self._cached_foundation(*(np.ascontiguousarray(each).tobytes() for each in both))

    def stick_tangent(self, patch_approach: Array) -> Array:
        """Tangent stiffness (m, 6) [Pa/m] of the friction of m patches in full stick, at approaches (m) [m].

        The 6 components are xx, xy, yy, xr, yr, rr; r is the displacement around the centre of the patch [m].
        """
        return np.asarray(
            self.foundation().stick_stiffness(patch_approach)[:, None] * FULL_STICK_TANGENT_OVER_STIFFNESS
        )

    def update_friction(
        self, history: HistoryVariables, end_approach: Array, tangential_increment: Array
    ) -> FrictionUpdate:
        """Update the friction of the m patches for one straight increment of approach and displacement.

        end_approach         : (m) [m] approaches at the end of the increment
        tangential_increment : (m, 3) [m] displacements along x, along y and around the patch centres
        """
        start = end_approach if history["state"] == BEFORE_FIRST_STEP else history["approach"]
        stick, force = self.foundation().stick_stiffness(end_approach), history["force"]
        if history["state"] < SLIP_1D:
            update = self.full_stick_update(force, start, end_approach, tangential_increment, stick)
            if update is not None:
                return FrictionUpdate(FULL_STICK, end_approach, end_approach, end_approach, update, stick)
            onset = smallest = start
        else:
            onset = history["onset_approach"]
            was_open = history["min_approach"] < self.pressure_curve.displacement[0]
            smallest = np.where(was_open, start, np.minimum(history["min_approach"], start))
        foundation = self.foundation(onset, smallest)
        state = self._slip_state(history, tangential_increment)
        if history["state"] < SLIP_1D:
            force = foundation.distribute_stick_force(full_stick_force(force), start)
        update = foundation.advance(force, start, end_approach, tangential_increment)
        return FrictionUpdate(state, onset, smallest, end_approach, update, stick)

    def full_stick_update(
        self,
        packed_forces: Array,
        start_approach: Array,
        end_approach: Array,
        tangential_increment: Array,
        stick_stiffness: Array,
    ) -> SliderUpdate | None:
        """Friction update in which all sliders stick; None if a patch exceeds the limit of full stick.

        packed_forces                : (m, 2, s) [Pa] for s sliders, see `full_stick_force`
        start_approach, end_approach : (m) [m] approaches
        tangential_increment         : (m, 3) [m] tangential displacement
        """
        traction, sticks = self.foundation().full_stick_update(
            full_stick_force(packed_forces), start_approach, end_approach, tangential_increment
        )
        if not np.all(sticks):
            return None
        packed_forces = np.zeros_like(packed_forces)
        packed_forces[..., 0], packed_forces[:, 1, 1] = traction[:, :2], traction[:, 2]
        return SliderUpdate(
            packed_forces,
            np.zeros_like(stick_stiffness),
            stick_stiffness[:, None] * FULL_STICK_TANGENT_OVER_STIFFNESS,
        )

    def _slip_state(self, history: HistoryVariables, tangential_increment: Array) -> int:
        """Friction state of a slipping joint: SLIP_1D if all motion so far is along x, else SLIP_2D."""
        in_plane = (
            self.has_elastic_members or history["state"] == SLIP_2D or np.any(history["force"][:, 1, :2])
        )
        return SLIP_2D if in_plane or np.any(tangential_increment[:, 1:]) else SLIP_1D


def unit_displacements(patches: FrictionPatches) -> list[Array]:
    """Tangential displacements (m, 3) [1, m] of the patches for unit s_x, unit s_y and unit theta_z."""
    return [tangential_displacement(patches, unit) for unit in np.eye(6)[TANGENTIAL_COMPONENT_INDICES]]


def directional_stiffness(friction_tangent: Array, motion_direction: Array) -> Array:
    """Tangential stiffness (m) [Pa/m] of patches along directions of motion.

    friction_tangent : (m, 6) [Pa/m] components xx, xy, yy, xr, yr, rr; r is the rotation around the patch
                       centre, as displacement [m]
    motion_direction : (m, 3) components x, y and r of the motion
    """
    (xx, xy, yy, xr, yr, rr), (u, v, w) = friction_tangent.T, motion_direction.T
    return np.asarray(xx * u**2 + yy * v**2 + rr * w**2 + 2.0 * (xy * u * v + xr * u * w + yr * v * w))


def continued_motion_stiffness(patches: FrictionPatches, friction_update: FrictionUpdate) -> list[float]:
    """Tangent stiffness per area of the friction for s_x, s_y [Pa/m] and the rotation theta_z [Pa.m].

    In the direction of the traction of their patch, sliders at their limits continue to slip; in the opposite
    direction they stick. Each component is the smaller one of the stiffnesses in both directions.
    """
    tangent, traction, stick = (
        friction_update.slider_update.tangent,
        friction_update.traction,
        friction_update.stick_stiffness,
    )
    tangent_decrease, result = stick[:, None] * FULL_STICK_TANGENT_OVER_STIFFNESS - tangent, []
    for direction in unit_displacements(patches):
        decrease = patches.area_share * directional_stiffness(tangent_decrease, direction)
        signed_decrease = np.where(np.sum(traction * direction, axis=1) < 0.0, -decrease, decrease)
        stuck = patches.area_share @ (stick * np.sum(direction**2, axis=1))
        result.append(stuck - 0.5 * (np.sum(decrease) + abs(np.sum(signed_decrease))))
    return result
