"""Pressure of a bolted frame: the force of each bolt is distributed over the contact by a decay law."""

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from ...quantity import Array, check_fields, quantity_field
from .distribution import NodalField, PositionMeans, PressureDistribution, position_means
from .plate import EDGE_TOLERANCE_FACTOR, BoltedPlate

CELLS_ACROSS_FLANGE = 7
"""Number of square area cells across the flange of the frame [1]: 1000 nodes for the default frame.

Zhao's mesh has 1019."""
_CELL_SUBDIVISIONS = 8
"""Number of parts of the side of a cell [1], for the area that a hole removes from the cell."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltedFrame:
    """Rectangular frame with eight bolts on its centre line: two rows of three, and two bolts between them.

    The rows lie at y = +-row_spacing/2 with bolts at x = -column_spacing/2, 0, +column_spacing/2.
    """

    row_spacing: float = quantity_field("m", "distance between the two bolt rows", gt=0.0)
    column_spacing: float = quantity_field("m", "distance between the outer bolts of a row", gt=0.0)
    flange_width: float = quantity_field("m", "width of the contact frame", gt=0.0)
    hole_diameter: float = quantity_field("m", "clearance hole of a bolt", gt=0.0)
    decay_length: float = quantity_field("m", "length of the pressure decay", gt=0.0, is_calibrated=True)
    decay_exponent: float = quantity_field("1", "exponent of the pressure decay", gt=0.0, is_calibrated=True)

    def __post_init__(self) -> None:
        check_fields(self)
        if self.hole_diameter >= self.flange_width:
            raise ValueError(
                f"hole_diameter = {self.hole_diameter:g} m is outside (0, {self.flange_width:g}): "
                "the hole must be smaller than the flange width"
            )

    @property
    def bolt_positions_from_middle(self) -> Array:
        """Bolt positions (8, 2) [m] from the middle of the frame, in descending order of y."""
        x, y = 0.5 * self.column_spacing, 0.5 * self.row_spacing
        return np.array([[-x, y], [0, y], [x, y], [-x, 0], [x, 0], [-x, -y], [0, -y], [x, -y]])

    @property
    def area(self) -> float:
        """Area [m2] of the contact: the frame without its holes."""
        frame = 2.0 * self.flange_width * (self.column_spacing + self.row_spacing)
        return frame - 0.25 * np.pi * len(self.bolt_positions_from_middle) * self.hole_diameter**2

    @property
    def equivalent_bolt_rows(self) -> tuple[float, float]:
        """Bolts per row N_b [1] and distance L_a [m] of the two rows that carry a moment."""
        return 3.0, self.row_spacing

    @property
    def bolt_position_means(self) -> PositionMeans:
        """Means of x, y [m], x^2, y^2, x y [m2] of the bolt positions, from the centroid of the contact."""
        return position_means(self.bolt_positions)

    @property
    def bolt_positions(self) -> Array:
        """Positions (8, 2) [m] of the bolts, from the centroid of the contact."""
        return self.bolt_positions_from_middle

    def pressure_decay(self, axis_distance: Array) -> Array:
        """Pressure of one bolt over its value at the axis [1]: (1 + (r/decay_length)^2)^-decay_exponent.

        axis_distance : r (...) [m] from the axis
        """
        return np.asarray((1.0 + (axis_distance / self.decay_length) ** 2) ** -self.decay_exponent)

    def pressure_distribution(self) -> PressureDistribution:
        """Pressure distribution at the centroids of square area cells of the frame."""
        areas, points = divide_frame_into_cells(self)
        unit = bolt_pressures(self, areas, points, points) * areas.sum()
        centroid = np.average(points, axis=0, weights=areas)
        return PressureDistribution(
            area_share=areas / areas.sum(),
            position=points - centroid,
            preload_pressure_ratio=unit.mean(axis=0),
            moment_pressure_ratio=unit[:3].mean(axis=0) - unit[5:].mean(axis=0),
        )


def divide_frame_into_cells(frame_geometry: BoltedFrame) -> tuple[Array, Array]:
    """Areas (n) [m2] and centroids (n, 2) [m] of square cells that divide the frame, without the holes."""
    size = frame_geometry.flange_width / CELLS_ACROSS_FLANGE
    half = 0.5 * np.array([frame_geometry.column_spacing, frame_geometry.row_spacing])
    outer, inner = half + 0.5 * frame_geometry.flange_width, half - 0.5 * frame_geometry.flange_width
    count = np.maximum(np.round(2.0 * outer / size).astype(int), 1)
    sub = [(np.arange(n * _CELL_SUBDIVISIONS) + 0.5) / (n * _CELL_SUBDIVISIONS) for n in count]
    x, y = np.meshgrid(*(o * (2.0 * s - 1.0) for o, s in zip(outer, sub, strict=True)), indexing="ij")
    solid = (np.abs(x) > inner[0] * EDGE_TOLERANCE_FACTOR) | (np.abs(y) > inner[1] * EDGE_TOLERANCE_FACTOR)
    for bx, by in frame_geometry.bolt_positions_from_middle:
        solid &= np.hypot(x - bx, y - by) > 0.5 * frame_geometry.hole_diameter * EDGE_TOLERANCE_FACTOR
    area = 4.0 * outer[0] * outer[1] / solid.size

    def sum_cell_values(subdivision_values: Array) -> Array:
        """Sum the values of the subdivisions of each cell."""
        blocks = (subdivision_values * solid).reshape(
            count[0], _CELL_SUBDIVISIONS, count[1], _CELL_SUBDIVISIONS
        )
        return np.asarray(blocks.sum(axis=(1, 3)).ravel())

    points = sum_cell_values(np.ones_like(x))
    keep = points > 0
    centroids = np.stack([sum_cell_values(x)[keep], sum_cell_values(y)[keep]], axis=1) / points[keep, None]
    return points[keep] * area, centroids


def bolt_pressures(
    frame_geometry: BoltedFrame, cell_areas: Array, cell_points: Array, evaluation_points: Array
) -> Array:
    """Contact pressure (8, k) [Pa] of a bolted frame by 1 N in each of its eight bolts.

    cell_areas, cell_points : (n) [m2], (n, 2) [m] of the cells; the pressure of each bolt sums to 1 N over
                              them
    evaluation_points       : (k, 2) [m] at which the pressure is computed
    """

    def unscaled_pressure(pressure_positions: Array) -> Array:
        """Pressure of each bolt at positions, before it is scaled to a force of 1 N."""
        offset = pressure_positions[None, :, :] - frame_geometry.bolt_positions_from_middle[:, None, :]
        return frame_geometry.pressure_decay(np.hypot(offset[..., 0], offset[..., 1]))

    return np.asarray(
        unscaled_pressure(evaluation_points)
        / np.sum(cell_areas * unscaled_pressure(cell_points), axis=1)[:, None]
    )


PressureSource: TypeAlias = BoltedFrame | BoltedPlate | NodalField
"""Model of the pressure distribution of a bolted joint."""


@lru_cache(maxsize=8)
def pressure_distribution(pressure_source: PressureSource) -> PressureDistribution:
    """Pressure distribution of a bolted frame, a bolted plate or a nodal field, cached."""
    return pressure_source.pressure_distribution()
