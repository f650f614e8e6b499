"""Pressure of a bolted plate: each bolt, at any position, loads a disc given by its deformation cone."""

from dataclasses import dataclass

import numpy as np

from ...quantity import Array, check_fields, quantity_field, series_field
from .distribution import PositionMeans, PressureDistribution, moment_pressure, position_means

MIN_CELLS_PER_PRESSURE_RADIUS = 5
"""Smallest number of area cells [1] from the axis of a bolt to the radius R at which its pressure ends."""
COARSE_CELL_COUNT = 8
"""Number of area cells [1] along the longer side of the plate where there is no pressure."""
_HOLE_SUBDIVISIONS = 8
"""Number of parts of the side of an area cell [1], for the area that a hole removes from the cell."""
_ONE_BOLT_ROW_TOLERANCE = 1e-6
"""Extent of the bolt positions along y over the width of the plate [1], below which they are one row."""
EDGE_TOLERANCE_FACTOR = 1.0 + 1e-9
"""Factor on distances that are compared with an edge [1]: points on it then do not depend on round-off."""
_MAX_ITERATIONS, _MOMENT_ARM_TOLERANCE = 50, 1e-13
"""Largest number of Newton iterations [1], and tolerance of the moment of a bolt's pressure over R [1]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltedPlate:
    """Rectangular plate with bolts at any position; the contact is the plate without its holes.

    The pressure under each bolt is axisymmetric, Fernlund's fourth-degree polynomial (Trans. Chalmers Univ.
    Techn. 245, 1961). It has zero slope at the edge a of the hole, and is zero with its first two derivatives
    at the radius R,

        p(r) ~ (R - r)^3 (3 r + R - 4 a),   a <= r <= R.

    R follows from the deformation cone under the head (VDI 2230, part 1): the mean square radius of p equals
    that of a uniform pressure on the section of the cone at the interface.
    studies/bolted_joint_explanation.py compares p with two elastic plates.

    If an edge of the plate or another hole cuts the disc of a bolt, its pressure is multiplied by an
    exponential function of the position, so that the resultant stays on the axis of the bolt. The model is
    valid for flat plates that do not bend, with a thickness of at least about half a bolt diameter.
    """

    length: float = quantity_field("m", "length of the plate along x", gt=0.0)
    width: float = quantity_field("m", "width of the plate along y", gt=0.0)
    x: tuple[float, ...] = series_field("m", "positions of the bolts along x, from the middle of the plate")
    y: tuple[float, ...] = series_field("m", "positions of the bolts along y, from the middle of the plate")
    hole_diameter: float = quantity_field("m", "clearance hole of a bolt", gt=0.0)
    cone_diameter: float = quantity_field(
        "m", "diameter of a bolt's deformation cone at the interface", gt=0.0
    )

    def __post_init__(self) -> None:
        check_fields(self)
        if len(self.y) != len(self.x):
            raise ValueError(f"y has {len(self.y)} numbers, expected as many as x: {len(self.x)}")
        if not self.cone_diameter > self.hole_diameter:
            raise ValueError(
                f"cone_diameter = {self.cone_diameter:g} m is outside ({self.hole_diameter:g}, inf): "
                "it must be larger than the hole"
            )
        check_holes(self)

    @property
    def bolt_positions_from_middle(self) -> Array:
        """Bolt positions (n, 2) [m] from the middle of the plate."""
        return np.column_stack([self.x, self.y])

    @property
    def pressure_radius(self) -> float:
        """Radius R [m] at which the pressure of a bolt ends.

        The condition on the mean square radius is a cubic equation for s = R - a with one positive root.
        Newton's method converges to it from above.
        """
        a, square = 0.5 * self.hole_diameter, 0.125 * (self.hole_diameter**2 + self.cone_diameter**2)
        first, second, third = 4 / 35 * a, 0.3 * a**2 - 0.1 * square, 0.4 * a * (a**2 - square)
        s = 8.0 * float(np.sqrt(square))
        for _ in range(_MAX_ITERATIONS):
            s -= (((s / 56 + first) * s + second) * s + third) / ((s * 3 / 56 + 2.0 * first) * s + second)
        return a + s

    @property
    def area(self) -> float:
        """Area [m2] of the plate without its holes."""
        return self.length * self.width - 0.25 * np.pi * len(self.x) * self.hole_diameter**2

    @property
    def centroid(self) -> Array:
        """Centroid (2) [m] of the contact, from the middle of the plate."""
        return np.asarray(
            -0.25 * np.pi * self.hole_diameter**2 / self.area * self.bolt_positions_from_middle.sum(axis=0)
        )

    @property
    def bolt_position_means(self) -> PositionMeans:
        """Means of x, y [m], x^2, y^2, x y [m2] of the bolt positions, from the centroid of the contact."""
        return position_means(self.bolt_positions)

    @property
    def bolt_positions(self) -> Array:
        """Positions (n, 2) [m] of the bolts, from the centroid of the contact."""
        return np.asarray(self.bolt_positions_from_middle - self.centroid)

    @property
    def equivalent_bolt_rows(self) -> tuple[float, float]:
        """Bolts per row N_b [1] and distance L_a [m] of two rows that are equivalent for a moment about x.

        If all bolts are in one row, N_b is 1 whatever their number, and L_a times the force of a bolt is the
        moment at which the contact starts to open at its edge.
        """
        if has_one_bolt_row(self):
            return 1.0, _one_row_equivalent_distance(self, *bolt_pressures(self))
        return equivalent_bolt_rows(self.bolt_positions_from_middle[:, 1])

    @property
    def coarse_cell_counts(self) -> Array:
        """Number of area cells (2) [1] along x and y, before cells under bolts are divided."""
        plan = np.array([self.length, self.width])
        return np.asarray(np.maximum(np.ceil(COARSE_CELL_COUNT * plan / np.max(plan)), 2.0))

    def pressure_distribution(self, area_cells: tuple[Array, Array] | None = None) -> PressureDistribution:
        """Pressure distribution at the centroids of area cells of the plate; arguments: see `bolt_pressures`.

        A moment M about x changes the force of bolt i by M y_i/sum(y_j^2), y from the centre of the bolts
        (the plates stay plane); for two equal rows this is M/(L_a N_b). Bolts in one row cannot carry a
        moment by their forces: the pressure then changes linearly with the distance from their line.
        """
        share, position, unit = bolt_pressures(self, area_cells)
        equal, y = unit.mean(axis=0), self.bolt_positions_from_middle[:, 1]
        if has_one_bolt_row(self):
            distance = _one_row_equivalent_distance(self, share, position, unit)
            return PressureDistribution(
                share, position, equal, distance * moment_pressure(share, position[:, 1], equal)
            )
        distances, distance = y - y.mean(), equivalent_bolt_rows(y)[1]
        return PressureDistribution(
            share, position, equal, distance / (distances @ distances) * (distances @ unit)
        )


def check_holes(plate: BoltedPlate) -> None:
    """Raise ValueError if a hole is not inside the plate or overlaps another hole."""
    radius, bolts = 0.5 * plate.hole_diameter, plate.bolt_positions_from_middle
    half = 0.5 * np.array([plate.length, plate.width])
    for i, bolt in enumerate(bolts):
        if np.any(np.abs(bolt) + radius >= half):
            x, y = 1e3 * (half - radius)
            raise ValueError(
                f"bolt {i + 1} at ({1e3 * bolt[0]:g}, {1e3 * bolt[1]:g}) mm with a hole of "
                f"{2e3 * radius:g} mm is not inside the plate; allowed are |x| < {x:.4g} mm and |y| < "
                f"{y:.4g} mm"
            )
        distances = np.hypot(*(bolts[:i] - bolt).T)
        if distances.size and distances.min() <= plate.hole_diameter:
            raise ValueError(
                f"the holes of bolts {distances.argmin() + 1} and {i + 1} overlap: hole_diameter = "
                f"{1e3 * plate.hole_diameter:g} mm is outside (0, {1e3 * distances.min():.4g}) mm, their "
                "distance"
            )


def has_one_bolt_row(plate: BoltedPlate) -> bool:
    """Whether all bolts lie on one line along x, so that a moment about x cannot change their forces."""
    return bool(np.ptp(plate.bolt_positions_from_middle[:, 1]) <= _ONE_BOLT_ROW_TOLERANCE * plate.width)


def equivalent_bolt_rows(bolt_y: Array) -> tuple[float, float]:
    """Equivalent pair of bolt rows: bolts per row N_b [1] and distance L_a [m], for bolts at y (n) [m].

    A moment changes the force of a bolt in the equivalent rows as much as the force of the outermost bolts.
    N_b is the number of outermost bolts, L_a = sum(y^2)/(N_b max|y|), y from the centre. For two equal rows
    L_a is their distance.
    """
    distances = bolt_y - np.mean(bolt_y)
    max_distance = float(np.max(np.abs(distances)))
    count = min(
        np.sum(np.isclose(side * distances, max_distance, rtol=1e-6)) or np.inf for side in (1.0, -1.0)
    )
    return float(count), float(np.sum(distances * distances) / (count * max_distance))


def plate_cells(plate: BoltedPlate) -> tuple[Array, Array]:
    """Areas (n) [m2] and centroids (n, 2) [m] of cells that divide the plate, without the holes.

    Cells within the disc of a bolt are halved in both directions until they are small compared with R.
    """
    reach = plate.pressure_radius
    plan = np.array([plate.length, plate.width])
    count = plate.coarse_cell_counts
    index = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), -1).reshape(-1, 2)
    side = plan / count
    middle = (index + 0.5) * side - 0.5 * plan
    done_middle, done_side = [], []
    while middle.size:
        is_loaded = _bolt_distance(plate, middle, side) * EDGE_TOLERANCE_FACTOR < reach
        split = is_loaded & (np.max(side) > reach / MIN_CELLS_PER_PRESSURE_RADIUS * EDGE_TOLERANCE_FACTOR)
        done_middle.append(middle[~split])
        done_side.append(np.broadcast_to(side, middle[~split].shape))
        side = 0.5 * side
        quarters = 0.5 * side * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
        middle = (middle[split][:, None, :] + quarters).reshape(-1, 2)
    return _remove_holes(plate, np.concatenate(done_middle), np.concatenate(done_side))


def _bolt_distance(plate: BoltedPlate, cell_centres: Array, cell_sides: Array) -> Array:
    """Distance (n) [m] from cells, with centres (n, 2) and sides (2) [m], to the nearest bolt axis."""
    gap = np.maximum(
        np.abs(cell_centres[:, None, :] - plate.bolt_positions_from_middle) - 0.5 * cell_sides, 0.0
    )
    return np.asarray(np.min(np.hypot(gap[..., 0], gap[..., 1]), axis=1))


def _remove_holes(plate: BoltedPlate, cell_centres: Array, cell_sides: Array) -> tuple[Array, Array]:
    """Subtract the holes from cells: areas [m2] and centroids [m]; cells inside a hole are omitted."""
    positions = (np.arange(_HOLE_SUBDIVISIONS) + 0.5) / _HOLE_SUBDIVISIONS - 0.5
    grid = np.stack(np.meshgrid(positions, positions, indexing="ij"), -1).reshape(-1, 2)
    areas, centroids = np.prod(cell_sides, axis=1), cell_centres.copy()
    reach = 0.5 * np.hypot(*cell_sides.T) + 0.5 * plate.hole_diameter
    for bolt in plate.bolt_positions_from_middle:
        affected = np.flatnonzero(np.hypot(*(cell_centres - bolt).T) < reach)
        points = cell_centres[affected, None, :] + grid * cell_sides[affected, None, :]
        solid = (
            np.hypot(*np.moveaxis(points - bolt, -1, 0)) > 0.5 * plate.hole_diameter * EDGE_TOLERANCE_FACTOR
        )
        solid_share = solid.mean(axis=1)
        areas[affected] *= solid_share
        total = np.sum(points * solid[..., None], axis=1)
        centroids[affected] = np.where(
            solid_share[:, None] > 0.0, total / np.maximum(solid.sum(1), 1)[:, None], 0.0
        )
    remaining = areas > 0.0
    return areas[remaining], centroids[remaining]


def pressure_decay(plate: BoltedPlate, axis_distance: Array) -> Array:
    """Pressure at distances (...) [m] from a bolt's axis, over the pressure at the edge of its hole [1]."""
    a, R = 0.5 * plate.hole_diameter, plate.pressure_radius
    r = np.clip(axis_distance, a, R)
    return np.asarray((R - r) ** 3 * (3.0 * r + R - 4.0 * a) / (R - a) ** 4)


def bolt_pressures(
    plate: BoltedPlate, area_cells: tuple[Array, Array] | None = None
) -> tuple[Array, Array, Array]:
    """Area shares (k) [1] and positions (k, 2) [m] of the area cells, and pressures (n, k) [1] of each bolt.

    Positions are relative to the centroid of the contact, pressures to their mean over the whole contact.

    area_cells : areas (k) [m2] and centroids (k, 2) [m] from the middle of the plate; None: `plate_cells`
    """
    areas, points = area_cells or plate_cells(plate)
    unit = np.array(
        [_moment_free_pressure(plate, areas, points - bolt) for bolt in plate.bolt_positions_from_middle]
    )
    share = areas / areas.sum()
    return share, points - share @ points, unit * areas.sum()


def _one_row_equivalent_distance(
    plate: BoltedPlate, area_shares: Array, cell_positions: Array, unit_pressures: Array
) -> float:
    """Equivalent distance L_a [m] of two bolt rows, for bolts that lie in one row.

    See `BoltedPlate.equivalent_bolt_rows`.
    """
    equal = unit_pressures.mean(axis=0)
    distances = cell_positions[:, 1] - area_shares @ (equal * cell_positions[:, 1])
    reach = np.max(np.abs(distances[equal > 0.0]))
    return float(len(plate.x) * (area_shares @ (equal * distances**2)) / reach)


def _moment_free_pressure(plate: BoltedPlate, cell_areas: Array, axis_offsets: Array) -> Array:
    """Pressure (n) [Pa] of a bolt with 1 N at offsets (n, 2) [m] from its axis; its resultant is on the axis.

    The pressure around the bolt is multiplied by an exponential function of the offset, see `BoltedPlate`.
    Newton's method finds the two coefficients in the exponent; the logarithm of the total force is a convex
    function of them.
    """
    force = cell_areas * pressure_decay(plate, np.hypot(*axis_offsets.T))
    is_loaded = force > 0.0
    weight, relative = force[is_loaded], axis_offsets[is_loaded] / plate.pressure_radius
    factor = np.zeros(2)
    for _ in range(_MAX_ITERATIONS):
        share = weight * np.exp(relative @ factor)
        share /= share.sum()
        mean = share @ relative
        if np.max(np.abs(mean)) < _MOMENT_ARM_TOLERANCE:
            break
        factor -= np.linalg.solve((relative - mean).T @ (share[:, None] * (relative - mean)), mean)
    result = np.zeros_like(cell_areas)
    result[is_loaded] = share / cell_areas[is_loaded]
    return result
