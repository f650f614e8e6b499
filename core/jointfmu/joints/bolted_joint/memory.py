"""What a bolted joint remembers of its way."""

from collections.abc import Mapping

import numpy as np

from ...mechanics.memory import HistoryLayout
from ...mechanics.sliders import FOUNDATION_SLIDERS
from ...quantity import Array
from .bodies import MODES

History = Mapping[str, Array]

UNKNOWN, FULL_STICK, SLIP_1D, SLIP_2D = range(4)
"""How friction has moved so far, see `memory_of`."""


def history_layout(patches: int) -> HistoryLayout:
    """What friction remembers on so many patches.

    state     : UNKNOWN: the path begins at the present approach, which is the reference as well, without a
                shift; RESTING: it has hardly moved along its surface; ALONG: it has along x alone; FREE:
                along y or by a turn, too
    loss      : [J] turned into heat so far
    rigid     : (3) shift along x and y [m] and turn about the normal [rad]
    reference : (m) [m] approach of the patches when they first moved along the surface, or until they do
    lowest    : (m) [m] least approach since then, from where a contact began to open last if it has been open
    approach  : (m) [m] of the patches
    force     : (m, 2, n) [Pa] of the sliders; at rest the first stands for all, and y of the second one for
                their force around the centre of the patch
    apart     : (3) shift along z [m] and turns about x and y [rad]; this and the rest of elastic sides
    amplitude : (MODES) [m] of the modes
    tangent   : (m, 6) [Pa/m] of the patches, see `Moved`
    """
    one = (patches,)
    return HistoryLayout(
        {
            "state": (),
            "loss": (),
            "rigid": (3,),
            "reference": one,
            "lowest": one,
            "approach": one,
            "force": (*one, 2, FOUNDATION_SLIDERS),
            "apart": (3,),
            "amplitude": (MODES,),
            "tangent": (*one, 6),
        }
    )


def slip_state(history: History, tangential: Array) -> int:
    """How friction has moved after the way to a shift and turn, where it is no longer at rest."""
    free = history["state"] == SLIP_2D or np.any(history["force"][:, 1, :2])
    return SLIP_2D if free or not np.array_equal(tangential[1:], history["rigid"][1:]) else SLIP_1D


def full_stick_force(force: Array) -> Array:
    """Forces (m, 3) of all sliders of patches at rest, see `together`, from those in the memory (m, 2, n)."""
    return np.column_stack([force[..., 0], force[:, 1, 1]])
