"""Washers under heads and nuts: sizes and limits."""

from dataclasses import dataclass, replace

import numpy as np

from jointfmu.quantity import Array

from ....inputs.drawing.part import DrawingOptions
from ....inputs.drawing.quantities import parse_values
from ....inputs.drawing.tables import Thread, Washer, find_washer
from . import STANDARD_WASHERS

MAX_BEARING_OVER_THREAD_DIAMETER = 8.0
"""Largest diameter of a bearing face over diameter of the thread [1]; washers of ISO 7094 have 4."""
MAX_WASHER_THICKNESS_OVER_THREAD_DIAMETER = 1.0
"""Largest thickness of a washer over the diameter of the thread [1]: a thicker one is a spacer."""


@dataclass(frozen=True, slots=True)
class BoltWashers:
    """Equal washers of one bolt.

    washer : sizes of each washer
    count  : 2, under head and nut; 1 for a tapped thread
    source : where the sizes come from
    """

    washer: Washer
    count: int
    source: str

    @property
    def length(self) -> float:
        """Thickness of all washers together [m]."""
        return self.count * self.washer.thickness

    def describe(self) -> str:
        """Describe number, sizes and source of the washers in words."""
        sizes = f"{self.washer.outer_diameter * 1e3:g} x {self.washer.thickness * 1e3:g} mm"
        return f"{'two washers' if self.count == 2 else 'a washer'} of {sizes} ({self.source})"


def find_washers(options: DrawingOptions, thread: Thread) -> BoltWashers | None:
    """Find the washers of one bolt from the option `washers`; None if it is not stated.

    Washers of stated sizes have the hole of ISO 7089, too.

    Raises ValueError for text that is not two lengths.
    """
    text = options["washers"]
    if text is None:
        return None
    washer, count = find_washer(thread), 1 if options["tapped"] else 2
    if text.replace(" ", "").upper() == STANDARD_WASHERS.replace(" ", ""):
        return BoltWashers(washer, count, STANDARD_WASHERS)
    outer, thickness = parse_values("washers", text, separator="x", value_count=2)
    stated = replace(washer, outer_diameter=outer, thickness=thickness)
    return BoltWashers(stated, count, f"stated on the drawing, hole of {STANDARD_WASHERS}")


def check_washers(washers: BoltWashers, thread: Thread, head_diameter: float, bolt_positions: Array) -> None:
    """Raise ValueError for washers that are narrower than the head, too large, or overlap.

    head_diameter : [m] of the bearing face of the head
    """
    d, washer = thread.nominal_diameter, washers.washer
    for noun, value, low, high in (
        ("outer diameter", washer.outer_diameter, head_diameter, MAX_BEARING_OVER_THREAD_DIAMETER * d),
        ("thickness", washer.thickness, 0.0, MAX_WASHER_THICKNESS_OVER_THREAD_DIAMETER * d),
    ):
        if not low < value <= high:
            raise ValueError(
                f"--washers: {noun} = {value * 1e3:g} mm is outside ({low * 1e3:g}, {high * 1e3:g}] mm of "
                f"{thread.name}"
            )
    nearest = float(np.min(bolt_distances(bolt_positions)))
    if washer.outer_diameter > nearest:
        raise ValueError(
            f"--washers: outer diameter = {washer.outer_diameter * 1e3:g} mm is outside (0, "
            f"{nearest * 1e3:g}] mm: washers of neighbouring bolts overlap"
        )


def bolt_distances(bolt_positions: Array) -> Array:
    """Distance (b) [m] of each bolt to the next one; infinite for a single bolt."""
    distance = np.hypot(*np.moveaxis(bolt_positions[:, None, :] - bolt_positions, -1, 0)) + np.diag(
        np.full(len(bolt_positions), np.inf)
    )
    return np.asarray(np.min(distance, axis=1))
