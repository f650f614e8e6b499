"""Pressure of a bolted plate: bolts anywhere, each pressing on the disc where its deformation cone ends."""

from dataclasses import dataclass

import numpy as np

from ...quantity import Array, check, quantity, series
from .shape import Means, PressureShape, growing, means

ACROSS = 5
"""Cells from a bolt's axis to the edge of its pressure."""
COARSE = 8
"""Cells across the plate where nothing presses."""
_PARTS = 8
"""Parts of a cell's side in which the edge of a hole is seen."""
_ONE_ROW = 1e-6
"""Bolts whose distances across the rows are below this part of the plate's size make one row [1]."""
EDGE = 1.0 + 1e-9
"""Points nearer to an edge than this lie on it [1]: which side they are on does not hang on rounding."""
_STEPS, _BALANCED = 50, 1e-13
"""Most steps of Newton's method, and what remains of the moment of a bolt's pressure over its radius [1]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltedPlate:
    """Rectangular plate with bolts at any places; all of it but the holes may touch.

    A bolt presses on a disc around its axis. Its pressure falls as Fernlund's polynomial of fourth degree
    (Trans. Chalmers Univ. Techn. 245, 1961): flat at the edge of the hole a, zero with two derivatives at R,

        p(r) ~ (R - r)^3 (3 r + R - 4 a),   a <= r <= R.

    R follows from the deformation cone under the head (VDI 2230, part 1): the pressure has the mean square of
    the radius of an even one on the cone's section by the interface. benchmarks/plate_pressure.py compares it
    with two elastic plates.

    Where an edge of the plate or the hole of another bolt cuts a disc, the pressure is multiplied by an
    exponential of the position, so that its resultant stays on the axis of its bolt.
    Valid for flat plates of a thickness of about half a bolt diameter or more, which do not bend.
    """

    length: float = quantity("m", "length of the plate along x", gt=0.0)
    width: float = quantity("m", "width of the plate along y", gt=0.0)
    x: tuple[float, ...] = series("m", "positions of the bolts along x, from the middle of the plate")
    y: tuple[float, ...] = series("m", "positions of the bolts along y, from the middle of the plate")
    hole_diameter: float = quantity("m", "clearance hole of a bolt", gt=0.0)
    cone_diameter: float = quantity("m", "diameter of a bolt's deformation cone at the interface", gt=0.0)

    def __post_init__(self) -> None:
        check(self)
        if len(self.y) != len(self.x):
            raise ValueError(f"y has {len(self.y)} numbers, expected as many as x has: {len(self.x)}")
        if not self.cone_diameter > self.hole_diameter:
            raise ValueError(
                f"cone_diameter = {self.cone_diameter:g} m is outside ({self.hole_diameter:g}, inf): "
                "a bolt presses beside its hole"
            )
        check_holes(self)

    @property
    def bolts(self) -> Array:
        """Bolt positions (n, 2) [m] from the middle of the plate."""
        return np.column_stack([self.x, self.y])

    @property
    def reach(self) -> float:
        """R [m], where the pressure of a bolt ends.

        The moments of the polynomial over s = R - a make the mean square of r a cubic equation of s with one
        positive root, to which Newton's method falls from above.
        """
        a, square = 0.5 * self.hole_diameter, 0.125 * (self.hole_diameter**2 + self.cone_diameter**2)
        first, second, third = 4 / 35 * a, 0.3 * a**2 - 0.1 * square, 0.4 * a * (a**2 - square)
        s = 8.0 * float(np.sqrt(square))
        for _ in range(_STEPS):
            s -= (((s / 56 + first) * s + second) * s + third) / ((s * 3 / 56 + 2.0 * first) * s + second)
        return a + s

    @property
    def area(self) -> float:
        """Area [m2] of the plate without its holes."""
        return self.length * self.width - 0.25 * np.pi * len(self.x) * self.hole_diameter**2

    @property
    def centroid(self) -> Array:
        """Of the contact (2) [m], from the middle of the plate."""
        return np.asarray(-0.25 * np.pi * self.hole_diameter**2 / self.area * self.bolts.sum(axis=0))

    @property
    def bolt_means(self) -> Means:
        """Means of x, y [m], x^2, y^2, x y [m2] of the bolts, from the centroid of the contact."""
        return means(self.bolt_positions)

    @property
    def bolt_positions(self) -> Array:
        """Positions (n, 2) [m] of the bolts, from the centroid of the contact."""
        return np.asarray(self.bolts - self.centroid)

    @property
    def rows(self) -> tuple[float, float]:
        """N_b [1] and L_a [m] of two rows that would carry a moment as these bolts do, see `lever`.

        Of one row: a force of N_b L_a of a bolt is the moment at which the contact opens at its edge.
        """
        if one_row(self):
            return 1.0, _lever_of_one_row(self, *unit_pressures(self))
        return lever(self.bolts[:, 1])

    @property
    def coarse(self) -> Array:
        """Cells along x and y (2) before any of them is halved both ways."""
        plan = np.array([self.length, self.width])
        return np.asarray(np.maximum(np.ceil(COARSE * plan / np.max(plan)), 2.0))

    def shape(self) -> PressureShape:
        """Shares, positions and pressures of the cells of the plate.

        Under a moment M about x the force of bolt i changes by M y_i/sum(y_j^2), y from the centre of the
        bolts: the plates stay plane, and of two equal rows each bolt gets M/(L_a N_b). Bolts of one row
        cannot carry a moment by their forces: the pressure then grows in proportion to the distance from
        their line.
        """
        share, position, unit = unit_pressures(self)
        equal, y = unit.mean(axis=0), self.bolts[:, 1]
        if one_row(self):
            distance = _lever_of_one_row(self, share, position, unit)
            return PressureShape(share, position, equal, distance * growing(share, position[:, 1], equal))
        away, distance = y - y.mean(), lever(y)[1]
        return PressureShape(share, position, equal, distance / (away @ away) * (away @ unit))


def check_holes(plate: BoltedPlate) -> None:
    """Raise ValueError for a hole that is not inside the plate or overlaps another one."""
    radius, bolts = 0.5 * plate.hole_diameter, plate.bolts
    half = 0.5 * np.array([plate.length, plate.width])
    for i, bolt in enumerate(bolts):
        if np.any(np.abs(bolt) + radius >= half):
            x, y = half - radius
            raise ValueError(
                f"bolt {i + 1} at ({bolt[0]:g}, {bolt[1]:g}) m with a hole of {2.0 * radius:g} m leaves "
                f"the plate; allowed are |x| < {x:g} m and |y| < {y:g} m"
            )
        apart = np.hypot(*(bolts[:i] - bolt).T)
        if apart.size and apart.min() <= plate.hole_diameter:
            raise ValueError(
                f"the holes of bolts {apart.argmin() + 1} and {i + 1} overlap: hole_diameter = "
                f"{plate.hole_diameter:g} m is outside (0, {apart.min():g}), their distance"
            )


def one_row(plate: BoltedPlate) -> bool:
    """Whether all bolts lie on one line along x, so that a moment about x cannot change their forces."""
    return bool(np.ptp(plate.bolts[:, 1]) <= _ONE_ROW * plate.width)


def lever(y: Array) -> tuple[float, float]:
    """N_b [1] and L_a [m] of bolts at y (n) [m]: of two rows of N_b bolts at the distance L_a, where a moment
    changes the force of a bolt by as much as it does here at most.

    N_b bolts are farthest from the centre, and L_a = sum(y^2)/(N_b max|y|); of two equal rows it is their
    distance.
    """
    away = y - np.mean(y)
    far = float(np.max(np.abs(away)))
    count = min(np.sum(np.isclose(side * away, far, rtol=1e-6)) or np.inf for side in (1.0, -1.0))
    return float(count), float(np.sum(away * away) / (count * far))


def cells(plate: BoltedPlate) -> tuple[Array, Array]:
    """Areas (n) [m2] and centroids (n, 2) [m] of the cells of the plate, holes cut out.

    Cells that a bolt presses on are halved until they are small against its disc.
    """
    reach, plan, count = plate.reach, np.array([plate.length, plate.width]), plate.coarse
    index = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), -1).reshape(-1, 2)
    side = plan / count
    middle = (index + 0.5) * side - 0.5 * plan
    done_middle, done_side = [], []
    while middle.size:
        pressed = _distance(plate, middle, side) * EDGE < reach
        split = pressed & (np.max(side) > reach / ACROSS * EDGE)
        done_middle.append(middle[~split])
        done_side.append(np.broadcast_to(side, middle[~split].shape))
        side = 0.5 * side
        quarters = 0.5 * side * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
        middle = (middle[split][:, None, :] + quarters).reshape(-1, 2)
    return _solid(plate, np.concatenate(done_middle), np.concatenate(done_side))


def _distance(plate: BoltedPlate, middle: Array, side: Array) -> Array:
    """Distance (n) [m] of the nearest bolt from cells of one size."""
    beside = np.maximum(np.abs(middle[:, None, :] - plate.bolts) - 0.5 * side, 0.0)
    return np.asarray(np.min(np.hypot(beside[..., 0], beside[..., 1]), axis=1))


def _solid(plate: BoltedPlate, middle: Array, side: Array) -> tuple[Array, Array]:
    """Areas and centroids of cells without what the holes take; cells inside a hole are left out."""
    part = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    grid = np.stack(np.meshgrid(part, part, indexing="ij"), -1).reshape(-1, 2)
    areas, centroids = np.prod(side, axis=1), middle.copy()
    reach = 0.5 * np.hypot(*side.T) + 0.5 * plate.hole_diameter
    for bolt in plate.bolts:
        near = np.flatnonzero(np.hypot(*(middle - bolt).T) < reach)
        points = middle[near, None, :] + grid * side[near, None, :]
        solid = np.hypot(*np.moveaxis(points - bolt, -1, 0)) > 0.5 * plate.hole_diameter * EDGE
        kept = solid.mean(axis=1)
        areas[near] *= kept
        total = np.sum(points * solid[..., None], axis=1)
        centroids[near] = np.where(kept[:, None] > 0.0, total / np.maximum(solid.sum(1), 1)[:, None], 0.0)
    there = areas > 0.0
    return areas[there], centroids[there]


def decay(plate: BoltedPlate, distance: Array) -> Array:
    """Pressure of a bolt at distances [m] from its axis, over the one at the edge of its hole [1]."""
    a, R = 0.5 * plate.hole_diameter, plate.reach
    r = np.clip(distance, a, R)
    return np.asarray((R - r) ** 3 * (3.0 * r + R - 4.0 * a) / (R - a) ** 4)


def unit_pressures(plate: BoltedPlate) -> tuple[Array, Array, Array]:
    """Shares (k) [1] and positions (k, 2) [m] of the cells from their centroid, and the pressure (n, k) [1]
    of each bolt over its mean on the whole area."""
    areas, points = cells(plate)
    unit = np.array([_balanced(plate, areas, points - bolt) for bolt in plate.bolts])
    share = areas / areas.sum()
    return share, points - share @ points, unit * areas.sum()


def _lever_of_one_row(plate: BoltedPlate, share: Array, position: Array, unit: Array) -> float:
    """L_a [m] of bolts in one row."""
    equal = unit.mean(axis=0)
    away = position[:, 1] - share @ (equal * position[:, 1])
    reach = np.max(np.abs(away[equal > 0.0]))
    return float(len(plate.x) * (share @ (equal * away**2)) / reach)


def _balanced(plate: BoltedPlate, areas: Array, offset: Array) -> Array:
    """Pressures (n) [Pa] at offsets (n, 2) [m] from a bolt of 1 N: they sum to 1 N without a moment about it.

    Newton's method for the two factors of the exponential; the logarithm of the sum is convex in them.
    """
    force = areas * decay(plate, np.hypot(*offset.T))
    pressed = force > 0.0
    weight, at = force[pressed], offset[pressed] / plate.reach
    factor = np.zeros(2)
    for _ in range(_STEPS):
        part = weight * np.exp(at @ factor)
        part /= part.sum()
        mean = part @ at
        if np.max(np.abs(mean)) < _BALANCED:
            break
        factor -= np.linalg.solve((at - mean).T @ (part[:, None] * (at - mean)), mean)
    result = np.zeros_like(areas)
    result[pressed] = part / areas[pressed]
    return result
