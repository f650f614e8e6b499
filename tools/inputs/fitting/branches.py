"""Branches of measured hysteresis loops, and their residuals against a hysteresis law.

Loops are cut into branches at the turning points of the motion. The zeros of a measurement are unknown.
Therefore the force of each branch has an offset of its own. The rest position, about which the elastic force
is odd, is estimated for each law.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .hysteresis import HysteresisLaw

MIN_REVERSAL = 0.02
"""Smallest reversal of the motion that counts as a turning point, over the range of the motion [1]."""
MIN_REVERSAL_NOISE = 8.0
"""Smallest reversal that counts as a turning point, over the standard deviation of the noise [1]."""
TURNING_POINT_WIDTH = 5.0
"""Deviation from the motion at a turning point, over the standard deviation of the noise [1], up to which
samples enter the parabola of the turning point."""
MIN_BRANCH_SAMPLES = 5
"""Minimum number of samples of a branch."""
MAX_CREATED_ENERGY = 4.0
"""Energy that a loop may create (negative area), over the standard deviation of its area [1]."""
RELATIVE_ROUNDING = 1e-9
"""Relative round-off [1] of data without noise: of areas over range of force times range of motion, of
motions over their range."""
MIN_COMMON_RANGE = 0.9
"""Range of motion common to two branches, over the range of the longer branch [1], from which they count as
a closed loop."""
_GRID_POINTS = 200
"""Points of the integration grid for the area between two branches."""
_MAX_REST_ITERATIONS, _REST_DIFFERENCE = 6, 1e-4
"""Gauss-Newton iterations for the rest position, and half the difference step over the motion's range [1]."""


@dataclass(frozen=True, slots=True)
class Loops:
    """Measured hysteresis loops: samples of their branches, branch after branch.

    motion, force          : (n) samples
    branch_index           : (n) index of the branch of each sample
    start_motion           : (branches) motion at the turning point at which the branch begins
    start_motion_deviation : (branches) standard deviation of `start_motion`
    run_index              : (n) index of the run of each sample
    widest_loops           : for each run with a closed loop: area [J] and range of motion of the widest loop
    """

    motion: Array
    force: Array
    branch_index: NDArray[np.int64]
    start_motion: Array
    start_motion_deviation: Array
    run_index: NDArray[np.int64]
    widest_loops: Sequence[tuple[float, float]]

    @property
    def noise_groups(self) -> NDArray[np.int64]:
        """Noise group (n) of each sample: the index of its run."""
        return self.run_index

    @property
    def residual_scale(self) -> Array:
        """Scale (n) of the force residuals: range of the force in the run of each sample."""
        return np.array([np.ptp(self.force[self.run_index == k]) for k in range(self.run_index[-1] + 1)])[
            self.run_index
        ]

    @property
    def nuisance_count(self) -> int:
        """Number of nuisance parameters: force and motion at each turning point, and the rest position."""
        return 2 * self.start_motion.size + 1

    @property
    def rest_stiffness(self) -> float:
        """Approximate stiffness [N/m or N.m/rad] after a reversal: the largest initial slope of the branches.

        Each branch is approximated by a parabola.
        """
        slopes = []
        for k, start in enumerate(self.start_motion):
            distance, force = self.motion[self.branch_index == k] - start, self.force[self.branch_index == k]
            slopes.append(float(np.polyfit(np.abs(distance), np.sign(distance) * force, 2)[1]))
        return max(slopes)

    def fit_turning_points(self, law: HysteresisLaw, residual_scale: Array) -> tuple[Array, Array, Array]:
        """Fit the turning points to the samples: force and motion (branches) there, and residual force (n).

        Linear least squares for each branch. `residual_scale` (n) are the standard deviations of the force;
        the motion at the turning point has the standard deviation `start_motion_deviation`.
        """
        residual, derivative = self._force_residuals(law, 0.0), self._force_residuals(law, 1.0)
        derivative = (derivative - residual) / self.start_motion_deviation[self.branch_index]
        force, mean_derivative = self._branch_means(residual), self._branch_means(derivative)
        residual = residual - force[self.branch_index]
        derivative = derivative - mean_derivative[self.branch_index]
        weight = residual_scale**-2.0
        shift = -self._branch_sums(weight * residual * derivative) / (
            self._branch_sums(weight * derivative**2) + self.start_motion_deviation**-2.0
        )
        return (
            force + mean_derivative * shift,
            self.start_motion + shift,
            residual + derivative * shift[self.branch_index],
        )

    def rest_position(self, law: HysteresisLaw, residual_scale: Array) -> float:
        """Rest position: motion at which the elastic force is zero, by least squares (Gauss-Newton).

        The search starts at zero or in the middle of the motion, whichever fits better. If the law is linear
        there, the result is the start.
        """
        if law.elastic_spring is None:
            return 0.0
        force = law.elastic_spring.force
        without_friction = self._force_residuals(replace(law, elastic_spring=None), 0.0)
        size = float(np.ptp(self.motion))

        def misfit(rest_motion: float) -> Array:
            residual = (
                without_friction
                - force(self.motion - rest_motion)
                + force(self.start_motion - rest_motion)[self.branch_index]
            )
            return np.asarray((residual - self._branch_means(residual)[self.branch_index]) / residual_scale)

        middle = 0.5 * float(np.max(self.motion) + np.min(self.motion))
        position = min((0.0, middle), key=lambda rest: float(np.sum(misfit(rest) ** 2)))
        for _ in range(_MAX_REST_ITERATIONS):
            high, low = (misfit(position + sign * _REST_DIFFERENCE * size) for sign in (1.0, -1.0))
            slope = (high - low) / (2.0 * _REST_DIFFERENCE)
            step = -float(misfit(position) @ slope) / (float(slope @ slope) + 1.0)
            position += size * float(np.clip(step, -0.5, 0.5))
        return position

    def residuals(self, law: HysteresisLaw, residual_scale: Array) -> Array:
        """Residuals against a law, over their standard deviations [1].

        These are the force errors (n), then the shifts of the turning points (branches).
        """
        _, start, residual = self.fit_turning_points(
            law.shift_rest(self.rest_position(law, residual_scale)), residual_scale
        )
        return np.concatenate(
            [residual / residual_scale, (start - self.start_motion) / self.start_motion_deviation]
        )

    def _force_residuals(self, law: HysteresisLaw, start_shift: float) -> Array:
        """Force (n) minus the force change by the law since the turning point.

        The turning points are shifted by `start_shift` standard deviations [1] of their motion.
        """
        return self.force - law.force_change(
            self.motion, (self.start_motion + start_shift * self.start_motion_deviation)[self.branch_index]
        )

    def _branch_sums(self, values: Array) -> Array:
        """Sum (branches) of values (n) over each branch."""
        return np.asarray(np.bincount(self.branch_index, values), dtype=np.float64)

    def _branch_means(self, values: Array) -> Array:
        """Mean (branches) of values (n) over each branch."""
        return np.asarray(self._branch_sums(values) / np.bincount(self.branch_index))


def cut_branches(runs: Sequence[tuple[str, Array, Array]]) -> Loops:
    """Cut measured runs into branches at the turning points of the motion.

    runs : (prefix of error messages, motion, force) of each run, samples in the order of the measurement

    Samples before the first turning point are left out, because their history is unknown. Samples beyond the
    previous turning point are left out, because there a smaller loop has closed.

    Raises ValueError: no branch, a force that falls with the motion, a loop that creates energy.
    """
    branches: list[tuple[Array, Array, float, float, int]] = []
    areas = []
    for number, (name, motion, force) in enumerate(runs):
        turns = find_turning_points(motion)
        if not turns.size:
            raise ValueError(f"{name}the motion never reverses; give loops with reversals")
        _check_sign(name, motion, force)
        ends = [*turns.tolist(), motion.size - 1]
        areas += _check_energy(name, motion, force, ends)
        run_branches = [(*branch, number) for branch in _branches_of_run(motion, force, ends)]
        if not run_branches:
            raise ValueError(
                f"{name}no branch after a turning point has {MIN_BRANCH_SAMPLES} samples; expected loops"
            )
        branches += run_branches
    sizes = [branch[0].size for branch in branches]
    return Loops(
        motion=np.concatenate([branch[0] for branch in branches]),
        force=np.concatenate([branch[1] for branch in branches]),
        branch_index=np.repeat(np.arange(len(branches)), sizes),
        start_motion=np.array([branch[2] for branch in branches]),
        start_motion_deviation=np.array([branch[3] for branch in branches]),
        run_index=np.repeat([branch[4] for branch in branches], sizes),
        widest_loops=areas,
    )


def _branches_of_run(
    motion: Array, force: Array, branch_ends: Sequence[int]
) -> Iterator[tuple[Array, Array, float, float]]:
    """Yield for each branch of a run: motion, force, motion at the turning point and its standard deviation.

    branch_ends : indices of the turning points, and of the last sample
    """
    deviation = noise_deviation(motion)
    turns = [refine_turning_point(motion, k, deviation) for k in branch_ends]
    for k, (first, last) in enumerate(pairwise(branch_ends)):
        u, F = motion[first + 1 : last + 1], force[first + 1 : last + 1]
        inside = np.abs(u - turns[k]) <= (abs(turns[k - 1] - turns[k]) if k else np.inf)
        if np.count_nonzero(inside) >= MIN_BRANCH_SAMPLES:
            step = 0.25 * (abs(motion[first + 1] - motion[first]) + abs(motion[first] - motion[first - 1]))
            turn_deviation = max(float(np.hypot(step, deviation)), RELATIVE_ROUNDING * float(np.ptp(motion)))
            yield u[inside], F[inside], turns[k], turn_deviation


def find_turning_points(motion: Array) -> NDArray[np.int64]:
    """Find the indices of the turning points of a motion; reversals within the noise do not count."""
    least = max(MIN_REVERSAL * float(np.ptp(motion)), MIN_REVERSAL_NOISE * noise_deviation(motion))
    if not least > 0.0:
        return np.array([], dtype=np.int64)
    return find_reversals(motion, least)


def find_reversals(signal: Array, prominence: float) -> NDArray[np.int64]:
    """Find the indices at which a signal reverses by at least `prominence`."""
    from scipy.signal import find_peaks  # slow to import, and most commands import this module

    return np.sort(
        np.concatenate([find_peaks(sign * signal, prominence=prominence)[0] for sign in (1.0, -1.0)])
    )


def refine_turning_point(motion: Array, sample_index: int, motion_noise: float) -> float:
    """Motion at the turning point at sample `sample_index`: vertex of a parabola through the nearest samples.

    motion_noise : standard deviation of the noise of the motion

    The parabola uses the samples within TURNING_POINT_WIDTH deviations of the turning point.
    The extreme sample itself would overestimate the motion, because of its noise.
    """
    distinct = np.abs(motion - motion[sample_index]) > TURNING_POINT_WIDTH * motion_noise
    before, after = np.flatnonzero(distinct[:sample_index]), np.flatnonzero(distinct[sample_index:])
    width = min(
        sample_index - int(before[-1]) if before.size else sample_index,
        int(after[0]) if after.size else motion.size - 1 - sample_index,
    )
    if width < 2:
        return float(motion[sample_index])
    offsets = np.arange(-width, width + 1)
    c, b, a = np.polyfit(offsets, motion[sample_index - width : sample_index + width + 1], 2)
    return float(a - b**2 / (4.0 * c) if c else a)


def noise_deviation(signal: Array) -> float:
    """Standard deviation of independent noise on a smooth signal, from the second differences of the signal.

    The curvature of the signal counts as noise, so the result is an upper bound.
    """
    if signal.size < 3:
        return 0.0
    return float(np.median(np.abs(np.diff(signal, 2))) / 0.6745 / np.sqrt(6.0))


def _check_sign(message_prefix: str, motion: Array, force: Array) -> None:
    """Raise ValueError if the force decreases as the motion increases."""
    if np.sum((motion - motion.mean()) * (force - force.mean())) <= 0.0:
        raise ValueError(
            f"{message_prefix}the force decreases as the motion increases; reverse the sign of one column"
        )


def _check_energy(
    message_prefix: str, motion: Array, force: Array, branch_ends: Sequence[int]
) -> list[tuple[float, float]]:
    """Check that the loops of a run dissipate energy; return the widest closed loop.

    Returns its area [J] and range of motion, as a list of one or no element.

    branch_ends : indices of the turning points, and of the last sample

    Raises ValueError if the loops create more energy (mean negative area) than noise explains.
    """
    branches = [(motion[a : b + 1], force[a : b + 1]) for a, b in pairwise(branch_ends)]
    loops = [loop for first, second in pairwise(branches) if (loop := _area_between_branches(first, second))]
    if not loops:
        return []
    areas, ranges, _ = np.array(loops).T
    area, size = float(np.mean(areas)), float(np.max(ranges))
    slope = float(np.ptp(force) / np.ptp(motion))
    deviation = (
        np.hypot(noise_deviation(force), slope * noise_deviation(motion)) * size / np.sqrt(0.5 * motion.size)
    )
    if area < -max(MAX_CREATED_ENERGY * deviation, RELATIVE_ROUNDING * size * float(np.ptp(force))):
        raise ValueError(
            f"{message_prefix}the loop creates energy, area = {area:.3g} J, expected 0 or more: the force "
            "must lead the motion; reverse the order of the rows if their time order is reversed"
        )
    closed = [(work, common) for work, common, longer in loops if common >= MIN_COMMON_RANGE * longer]
    return [max(closed, key=lambda loop: loop[1])] if closed else []


def _area_between_branches(
    first_branch: tuple[Array, Array], second_branch: tuple[Array, Array]
) -> tuple[float, float, float] | None:
    """Area [J] between two consecutive branches, their common range of motion, range of the longer branch.

    Each branch: motion, force. None if the branches have no common range, or too few samples.
    """
    (u, F), (v, G) = (
        (first_branch, second_branch)
        if first_branch[0][-1] > first_branch[0][0]
        else (second_branch, first_branch)
    )
    low, high = max(u.min(), v.min()), min(u.max(), v.max())
    if not high > low or min(u.size, v.size) < MIN_BRANCH_SAMPLES:
        return None
    grid = np.linspace(low, high, _GRID_POINTS)
    up, down = (np.interp(grid, *sort_points(x, y)) for x, y in ((u, F), (v, G)))
    return float(np.trapezoid(up - down, grid)), float(high - low), float(max(np.ptp(u), np.ptp(v)))


def sort_points(x: Array, y: Array) -> tuple[Array, Array]:
    """Sort points (n) by x, ascending."""
    order = np.argsort(x, kind="stable")
    return x[order], y[order]
