"""Contact stiffness of scanned heights by boundary elements (ContactMechanics), with the hardness as limit.

The gap of both surfaces is pressed on a periodic elastic half-space (Polonsky and Keer 1999; pressure limited
to the hardness: Almqvist and others 2007). The stiffness is that of small motions: all points in contact move
together.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from .form import PointMask, remove_form
from .heights import MIN_AREAL_POINTS, ArealMap

MAX_SOLVED_SIDE_POINTS = 256
"""Largest number of points along a side that is solved. Most scans are finer, but the stiffness hardly
depends on the short waves (docs/validity_stiffness.md)."""
MIN_SOLVED_SIDE_POINTS = 2 * MIN_AREAL_POINTS
"""Smallest number of points along a side, for the sub-areas."""
MAX_ASPECT_RATIO = 4
"""Largest ratio of the long to the short side of a scan that is solved [1]."""
SUB_AREAS_PER_SIDE = 2
"""Number of sub-areas along each side of a scan [1], whose scatter gives the range of the stiffness."""
MIN_CONTACT_POINTS = 16
"""Smallest number of points in contact [1] whose stiffness counts: fewer are one summit."""
PRESSURES_OVER_MODULUS_AND_SLOPE = (3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1)
"""Pressures over E* h' [1], with the rms slope h' of the grid."""
SOLVER_FORCE_TOLERANCE, SOLVER_GAP_TOLERANCE = 1e-5, 1e-3
"""Tolerances of the solver: force of a point over the mean force, gap over the rms height [1]."""
SOLVER_STIFFNESS_TOLERANCE = 1e-4
"""Relative tolerance of the iterative solution for the stiffness [1]."""
MAX_SOLVER_ITERATIONS = 1000
"""Largest number of iterations of a solution [1]."""


@dataclass(frozen=True, slots=True)
class SolvedStiffness:
    """Contact stiffness of a scan by boundary elements.

    nominal_pressure : (n) nominal pressures [Pa]
    normal_stiffness : (n) normal stiffness per area [Pa/m]
    min_sub_area_over_mean_stiffness, max_sub_area_over_mean_stiffness : smallest and largest stiffness of the
        sub-areas over their geometric mean [1]
    plastic_area_share : (n) share of the real contact area at the hardness [1]
    grid_spacing : spacing of the solved grid [m]
    """

    nominal_pressure: Array
    normal_stiffness: Array
    min_sub_area_over_mean_stiffness: float
    max_sub_area_over_mean_stiffness: float
    plastic_area_share: Array
    grid_spacing: float


def compute_gap_heights(scans: Sequence[ArealMap]) -> ArealMap:
    """Gap of two facing scans over their common area, the second one mirrored; of one scan, its heights.

    Raises ValueError if the spacings differ by more than 1 %.
    """
    first = scans[0]
    if len(scans) == 1:
        return first
    second = scans[1]
    if max(abs(second.dx / first.dx - 1.0), abs(second.dy / first.dy - 1.0)) > 0.01:
        raise ValueError(
            f"{second.scan_name}: spacing = {second.dx:g} x {second.dy:g} m, {first.scan_name} has "
            f"{first.dx:g} x {first.dy:g} m; --solve needs the same spacing: resample one scan"
        )
    rows, columns = (min(a, b) for a, b in zip(first.z.shape, second.z.shape, strict=True))
    return first.replace_heights(first.z[:rows, :columns] + second.z[:rows, :columns][:, ::-1])


def coarsen_heights(heights: ArealMap) -> ArealMap:
    """Coarser grid of heights: means of square blocks of points, in all about MAX_SOLVED_SIDE_POINTS^2.

    A long scan is cut to MAX_ASPECT_RATIO. Raises ValueError if a side has fewer than MIN_SOLVED_SIDE_POINTS.
    """
    short = min(heights.z.shape)
    if short < MIN_SOLVED_SIDE_POINTS:
        raise ValueError(
            f"{heights.scan_name}: {short} points along a side; boundary elements need at least "
            f"{MIN_SOLVED_SIDE_POINTS}"
        )
    z = heights.z[: MAX_ASPECT_RATIO * short, : MAX_ASPECT_RATIO * short]
    block = max(
        1, min(int(np.ceil(np.sqrt(z.size) / MAX_SOLVED_SIDE_POINTS)), short // MIN_SOLVED_SIDE_POINTS)
    )
    rows, columns = (n // block * block for n in z.shape)
    z = z[:rows, :columns].reshape(rows // block, block, columns // block, block).mean(axis=(1, 3))
    return ArealMap(z=z, dx=block * heights.dx, dy=block * heights.dy, scan_name=heights.scan_name)


def solve_stiffness(gap_heights: ArealMap, contact_modulus: float, hardness: float) -> SolvedStiffness:
    """Contact stiffness of a gap without form over a range of pressures, and its scatter over sub-areas.

    contact_modulus, hardness : contact modulus E* and hardness of the softer body [Pa]

    The sub-areas are elastic. Raises ValueError if too few points touch.
    """
    grid = coarsen_heights(gap_heights)
    pressure = np.array(PRESSURES_OVER_MODULUS_AND_SLOPE) * contact_modulus * _rms_slope(grid)
    pressure = pressure[pressure < 0.5 * hardness]
    parts = [grid, *_divide_into_sub_areas(grid)]
    steps = track_progress(range(len(parts) * pressure.size), "boundary elements")
    contacts = [
        list(
            _press_on_half_space(part, pressure, contact_modulus, hardness if part is grid else np.inf, steps)
        )
        for part in parts
    ]
    stiffness, plastic_area_share, count = (np.array(v) for v in zip(*contacts[0], strict=True))
    use = count >= MIN_CONTACT_POINTS
    if use.sum() < 2:
        raise ValueError(
            f"{gap_heights.scan_name}: fewer than two pressures have a converged solution with "
            f"{MIN_CONTACT_POINTS} points in contact; use a scan of more points"
        )
    parts_stiffness = np.array([[k for k, _, _ in one] for one in contacts[1:]])[:, use]
    ratio = np.exp(np.log(parts_stiffness) - np.mean(np.log(parts_stiffness), axis=0))
    return SolvedStiffness(
        pressure[use],
        np.maximum.accumulate(stiffness[use]),
        float(ratio.min()),
        float(ratio.max()),
        plastic_area_share[use],
        grid.dx,
    )


def _divide_into_sub_areas(height_grid: ArealMap) -> Iterator[ArealMap]:
    """Equal parts of a grid of heights, each without its tilt."""
    rows, columns = (n // SUB_AREAS_PER_SIDE for n in height_grid.z.shape)
    for i in range(SUB_AREAS_PER_SIDE):
        for j in range(SUB_AREAS_PER_SIDE):
            part = height_grid.z[i * rows : (i + 1) * rows, j * columns : (j + 1) * columns]
            plane = remove_form(
                ArealMap(z=part, dx=height_grid.dx, dy=height_grid.dy, scan_name=height_grid.scan_name)
            )
            yield height_grid.replace_heights(plane.z)


def _rms_slope(height_grid: ArealMap) -> float:
    """Rms slope [1] of a grid of heights, by differences of neighbours."""
    along_y, along_x = (np.diff(height_grid.z, axis=axis) for axis in (0, 1))
    return float(np.sqrt(np.mean((along_x / height_grid.dx) ** 2) + np.mean((along_y / height_grid.dy) ** 2)))


def _press_on_half_space(
    height_grid: ArealMap,
    nominal_pressures: Array,
    contact_modulus: float,
    hardness: float,
    step_counter: Iterator[int],
) -> Iterator[tuple[float, float, int]]:
    """Press a grid of heights on a half-space, at several pressures, by boundary elements.

    Returns for each pressure: stiffness per area [Pa/m], share of the contact at the hardness, points in
    contact. The number of points is 0 if the solver did not converge.
    """
    try:
        from ContactMechanics import PeriodicFFTElasticHalfSpace
        from ContactMechanics.Optimization import constrained_conjugate_gradients
    except ImportError:
        raise ValueError(
            "the package ContactMechanics is missing, needed to solve the contact of a scan: pip install "
            "'jointfmu[surface]'"
        ) from None

    sides = (height_grid.z.shape[0] * height_grid.dy, height_grid.z.shape[1] * height_grid.dx)
    area, point = sides[0] * sides[1], height_grid.dx * height_grid.dy
    half_space = PeriodicFFTElasticHalfSpace(height_grid.z.shape, contact_modulus, sides, stiffness_q0=0.0)
    z = height_grid.z - height_grid.z.mean()
    forces = None
    for pressure in nominal_pressures:
        next(step_counter, None)
        mean_force = float(pressure) * point
        options = {
            "external_force": float(pressure) * area,
            "pentol": SOLVER_GAP_TOLERANCE * float(z.std()),
            "forcetol": SOLVER_FORCE_TOLERANCE * mean_force,
            "maxiter": MAX_SOLVER_ITERATIONS,
        }
        result = constrained_conjugate_gradients(half_space, z, initial_forces=forces, **options)
        forces = -np.asarray(result.jac)
        limit = hardness * point
        if -forces.min() > limit:
            result = constrained_conjugate_gradients(
                half_space, z, hardness=limit, initial_forces=np.maximum(forces, -limit), **options
            )
        force = np.asarray(result.jac)
        contact_mask = force > 0.0
        flowing = force >= (1.0 - 1e-6) * limit
        count = int(contact_mask.sum())
        yield (
            _bonded_stiffness(half_space, contact_mask) / area,
            float(flowing.sum() / count),
            count if result.success else 0,
        )


def _bonded_stiffness(half_space: Any, contact_mask: PointMask) -> float:
    """Stiffness [N/m] of small motions: force on all points in contact for a common unit displacement."""
    from scipy.sparse.linalg import LinearOperator, cg

    field = np.zeros(contact_mask.shape)

    def compute_displacement(contact_force: Array) -> Array:
        """Displacement of the half-space under the forces on the points in contact."""
        field[contact_mask] = -contact_force  # forces of the package act on the half-space
        return np.asarray(half_space.evaluate_disp(field))[contact_mask]

    count = int(contact_mask.sum())
    operator = LinearOperator((count, count), compute_displacement, dtype=float)
    scale = float(compute_displacement(np.ones(count)).mean())
    start = np.full(count, 1.0 / scale)
    force, _ = cg(
        operator, np.ones(count), x0=start, rtol=SOLVER_STIFFNESS_TOLERANCE, maxiter=MAX_SOLVER_ITERATIONS
    )
    return float(force.sum())
