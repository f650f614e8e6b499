"""Washers under heads and nuts: sizes and limits."""

from dataclasses import dataclass, replace

import numpy as np

from jointfmu.quantity import Array

from ....inputs.drawing.part import DrawingOptions
from ....inputs.drawing.quantities import parse_quantity_values
from ....inputs.drawing.tables import Thread, Washer, find_washer
from . import STANDARD_WASHER_OPTION

MAX_BEARING_OVER_THREAD_DIAMETER = 8.0
"""Largest diameter of a bearing face over diameter of the thread [1]; washers of ISO 7094 have 4."""
MAX_WASHER_THICKNESS_OVER_THREAD_DIAMETER = 1.0
"""Largest thickness of a washer over the diameter of the thread [1]: a thicker one is a spacer."""


@dataclass(frozen=True, slots=True)
class BoltWashers:
    """Equal washers of one bolt.

    washer_size  : sizes of each washer
    washer_count : 2, under head and nut; 1 for a tapped thread
    size_source  : where the sizes come from
    """

    washer_size: Washer
    washer_count: int
    size_source: str

    @property
    def total_thickness(self) -> float:
        """Thickness of all washers together [m]."""
        return self.washer_count * self.washer_size.thickness

    def describe_washers(self) -> str:
        """Describe number, sizes and source of the washers in words."""
        sizes = f"{self.washer_size.outer_diameter * 1e3:g} x {self.washer_size.thickness * 1e3:g} mm"
        return f"{'two washers' if self.washer_count == 2 else 'a washer'} of {sizes} ({self.size_source})"


def find_washers(drawing_options: DrawingOptions, thread: Thread) -> BoltWashers | None:
    """Find the washers of one bolt from the option `washers`; None if it is not stated.

    Washers of stated sizes have the hole of ISO 7089, too.

    Raises ValueError for text that is not two lengths.
    """
    text = drawing_options["washers"]
    if text is None:
        return None
    washer, count = find_washer(thread), 1 if drawing_options["tapped"] else 2
    if text.replace(" ", "").upper() == STANDARD_WASHER_OPTION.replace(" ", ""):
        return BoltWashers(washer, count, STANDARD_WASHER_OPTION)
    outer, thickness = parse_quantity_values("washers", text, number_separator="x", expected_value_count=2)
    stated = replace(washer, outer_diameter=outer, thickness=thickness)
    return BoltWashers(stated, count, f"stated on the drawing, hole of {STANDARD_WASHER_OPTION}")


def check_washers(
    bolt_washers: BoltWashers, thread: Thread, head_diameter: float, bolt_positions: Array
) -> None:
    """Raise ValueError for washers that are narrower than the head, too large, or overlap.

    head_diameter : [m] of the bearing face of the head
    """
    d, washer = thread.nominal_diameter, bolt_washers.washer_size
    for noun, value, low, high in (
        ("outer diameter", washer.outer_diameter, head_diameter, MAX_BEARING_OVER_THREAD_DIAMETER * d),
        ("thickness", washer.thickness, 0.0, MAX_WASHER_THICKNESS_OVER_THREAD_DIAMETER * d),
    ):
        if not low < value <= high:
            raise ValueError(
                f"--washers: {noun} = {value * 1e3:g} mm is outside ({low * 1e3:g}, {high * 1e3:g}] mm for "
                f"{thread.thread_name}"
            )
    nearest = float(np.min(distances_to_next_bolt(bolt_positions)))
    if washer.outer_diameter > nearest:
        raise ValueError(
            f"--washers: outer diameter = {washer.outer_diameter * 1e3:g} mm is outside (0, "
            f"{nearest * 1e3:g}] mm: washers of neighbouring bolts overlap"
        )


def distances_to_next_bolt(bolt_positions: Array) -> Array:
    """Distance [m] of each of b bolts to its nearest neighbour; infinite for a single bolt."""
    distance = np.hypot(*np.moveaxis(bolt_positions[:, None, :] - bolt_positions, -1, 0)) + np.diag(
        np.full(len(bolt_positions), np.inf)
    )
    return np.asarray(np.min(distance, axis=1))
