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

MIN_REVERSAL_OVER_MOTION_RANGE = 0.02
"""Smallest reversal of the motion that counts as a turning point, over the range of the motion [1]."""
MIN_REVERSAL_OVER_NOISE = 8.0
"""Smallest reversal that counts as a turning point, over the standard deviation of the noise [1]."""
TURNING_POINT_DEVIATION_OVER_NOISE = 5.0
"""Deviation from the motion at a turning point, over the standard deviation of the noise [1], up to which
samples enter the parabola of the turning point."""
MIN_BRANCH_SAMPLES = 5
"""Minimum number of samples of a branch."""
MAX_CREATED_ENERGY_OVER_AREA_DEVIATION = 4.0
"""Energy that a loop may create (negative area), over the standard deviation of its area [1]."""
RELATIVE_ROUNDING = 1e-9
"""Relative round-off [1] of data without noise: of areas over range of force times range of motion, of
motions over their range."""
MIN_COMMON_OVER_LONGER_MOTION_RANGE = 0.9
"""Motion range common to two branches over range of the longer branch [1], from which they close a loop."""
RISING_OVER_BRANCH_FORCE_CHANGE = 0.9
"""Force change since the turning point over change of the whole branch [1], up to which a branch counts as
rising. Beyond it a slipped branch is flat."""
FLAT_END_OVER_MOTION_RANGE, MAX_FLAT_RISE_OVER_BRANCH_RISE = 0.3, 0.05
"""Last part of a branch over its range of motion [1], and rise of the force over this part, relative to the
force change of the branch [1], up to which the branch counts as slipping."""
MIN_FLAT_SAMPLES = 3
"""Minimum number of samples on the flat end of a branch."""
BEARING_INTERVALS = 12
"""Number of equal parts of a branch that show whether its stiffness rises again."""
MIN_BEARING_RISE_OVER_BRANCH_RISE, MIN_BEARING_OVER_SOFTEST_STIFFNESS = 0.2, 3.0
"""Rise of the force after the softest part over rise of the branch [1], and stiffness there over stiffness
of the softest part [1], from which a joint bears after slip."""
MIN_STIFFNESS_RISE_OVER_DEVIATION = 8.0
"""Rise of a branch's stiffness over its standard deviation [1], from which a joint bears after slip."""
MIN_RISING_SAMPLES = 5
"""Number of samples on the rising part of a branch from which its stiffness counts as resolved."""
_AREA_INTEGRATION_POINTS = 200
"""Number of points of the grid for the area between two branches [1]."""
_MAX_REST_ITERATIONS, _REST_DIFFERENCE_STEP_OVER_MOTION_RANGE = 6, 1e-4
"""Gauss-Newton iterations for the rest position, and half the difference step over the motion's range [1]."""


@dataclass(frozen=True, slots=True)
class Loops:
    """Measured hysteresis loops: samples of their branches, branch after branch.

    motion, force          : (n) samples
    branch_index           : (n) index of the branch of each sample
    start_motion           : (branches) motion at the turning point at which the branch begins
    start_motion_deviation : (branches) standard deviation of `start_motion`
    start_force            : (branches) approximate force at the turning point
    run_index              : (n) index of the run of each sample
    widest_loops           : for each run with a closed loop: area [J] and range of motion of the widest loop
    slip_steps             : force steps between branches that slip, see `find_slip_steps`
    """

    motion: Array
    force: Array
    branch_index: NDArray[np.int64]
    start_motion: Array
    start_motion_deviation: Array
    start_force: Array
    run_index: NDArray[np.int64]
    widest_loops: Sequence[tuple[float, float]]
    slip_steps: Sequence["SlipStep"] = ()

    @property
    def noise_groups(self) -> NDArray[np.int64]:
        """Noise group (n) of each sample, whose samples have equal noise: the index of the run."""
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

        If `is_stiffness_resolved` is false, the result is a lower bound.
        """
        slopes = self._initial_slopes(is_resolved=True) or self._initial_slopes(is_resolved=False)
        return max(slopes)

    @property
    def is_stiffness_resolved(self) -> bool:
        """Whether a branch has enough samples between its turning point and slip to show its stiffness."""
        return bool(self._initial_slopes(is_resolved=True))

    def _initial_slopes(self, is_resolved: bool) -> list[float]:
        """Initial slopes of the branches with a resolved stiffness; or lower bounds for the other branches.

        Only the rising part of a branch is used: a slipped part would lower the slope.
        """
        slopes = []
        for k in range(self.start_motion.size):
            distance, change = self.branch_curve(k)
            rising = int(np.argmax(change >= RISING_OVER_BRANCH_FORCE_CHANGE * np.max(change)))
            if (rising >= MIN_RISING_SAMPLES) is not is_resolved:
                continue
            if is_resolved:
                slopes.append(float(np.polyfit(distance[:rising], change[:rising], 2)[1]))
            else:
                slopes.append(float(change[rising] / (distance[rising] + self.start_motion_deviation[k])))
        return slopes

    @property
    def slip_force(self) -> float | None:
        """Friction force at gross slip [N or N.m]: half the force change of branches with a flat end.

        None if no branch has a flat end.
        """
        plateaus = []
        for k in range(self.start_motion.size):
            _, change = self.branch_curve(k)
            if (flat := self._flat_samples(k)).any():
                plateaus.append(0.5 * float(np.mean(change[flat])))
        return float(np.median(plateaus)) if plateaus else None

    def _flat_samples(self, branch_number: int) -> NDArray[np.bool_]:
        """Mask (n) of the samples of a branch on its flat end; all false if its end is not flat."""
        distance, change = self.branch_curve(branch_number)
        end = distance >= (1.0 - FLAT_END_OVER_MOTION_RANGE) * np.max(distance)
        if np.count_nonzero(end) < MIN_FLAT_SAMPLES:
            return np.zeros_like(end)
        slope = float(np.polyfit(distance[end], change[end], 1)[0])
        is_flat = abs(slope) * FLAT_END_OVER_MOTION_RANGE * np.max(
            distance
        ) < MAX_FLAT_RISE_OVER_BRANCH_RISE * np.max(change)
        return np.asarray(end & is_flat)

    def find_slip_steps(self) -> list["SlipStep"]:
        """Find the force steps at turning points between two branches that both end in full slip."""
        flat = [
            np.flatnonzero(self.branch_index == k)[self._flat_samples(k)]
            for k in range(self.start_motion.size)
        ]
        sizes = np.bincount(self.branch_index)
        steps = []
        for number, (before, after) in enumerate(pairwise(flat), 1):
            if not before.size or not after.size or self.run_index[before[0]] != self.run_index[after[0]]:
                continue
            deviation = np.hypot(
                *(np.std(self.force[rows], ddof=1) / np.sqrt(rows.size) for rows in (before, after))
            )
            steps.append(
                SlipStep(
                    branch_number=number,
                    samples_before=before,
                    samples_after=after,
                    force_step=float(np.mean(self.force[after]) - np.mean(self.force[before])),
                    deviation=float(deviation),
                    relative_deviation=float(np.hypot(*sizes[number - 1 : number + 1] ** -0.5)),
                )
            )
        return steps

    def find_bearing(self) -> tuple[float, float] | None:
        """Find slip through a clearance, until the joint bears (its bolts touch the holes).

        Returns the range of motion of this slip and its force change; None if the joint never bears.
        After a reversal, friction alone makes a joint softer and softer. A joint that becomes stiffer again
        has slipped through a clearance.
        """
        for k in range(self.start_motion.size):
            distance, change = self.branch_curve(k)
            part = distance / np.max(distance) * BEARING_INTERVALS
            part = np.clip(part.astype(np.int64), 0, BEARING_INTERVALS - 1)
            counts = np.bincount(part, minlength=BEARING_INTERVALS)
            if not np.all(counts):
                continue
            x, y = (np.bincount(part, values) / counts for values in (distance, change))
            slopes = np.diff(y) / np.diff(x)
            softest = int(np.argmin(slopes))
            later = softest + int(np.argmax(slopes[softest:]))
            noise = noise_deviation(change) * np.sqrt(2.0 / np.min(counts)) / np.min(np.diff(x))
            if (
                y[-1] - y[softest + 1] > MIN_BEARING_RISE_OVER_BRANCH_RISE * y[-1]
                and slopes[later] > MIN_BEARING_OVER_SOFTEST_STIFFNESS * slopes[softest]
                and slopes[later] - slopes[softest] > MIN_STIFFNESS_RISE_OVER_DEVIATION * noise
            ):
                limit = (
                    slopes[softest] + (slopes[later] - slopes[softest]) / MIN_BEARING_OVER_SOFTEST_STIFFNESS
                )
                return float(np.sum(np.diff(x)[slopes < limit])), float(y[softest + 1])
        return None

    def branch_curve(self, branch_number: int) -> tuple[Array, Array]:
        """Distance (n) from the turning point and force change (n) in this direction, of one branch."""
        samples = self.branch_index == branch_number
        shift = self.motion[samples] - self.start_motion[branch_number]
        change = self.force[samples] - self.start_force[branch_number]
        return np.abs(shift), np.copysign(1.0, shift[-1]) * change

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
            """Force residuals (n) over their standard deviations [1] at the rest position `rest_motion`."""
            residual = (
                without_friction
                - force(self.motion - rest_motion)
                + force(self.start_motion - rest_motion)[self.branch_index]
            )
            return np.asarray((residual - self._branch_means(residual)[self.branch_index]) / residual_scale)

        middle = 0.5 * float(np.max(self.motion) + np.min(self.motion))
        position = min((0.0, middle), key=lambda rest: float(np.sum(misfit(rest) ** 2)))
        for _ in range(_MAX_REST_ITERATIONS):
            high, low = (
                misfit(position + sign * _REST_DIFFERENCE_STEP_OVER_MOTION_RANGE * size)
                for sign in (1.0, -1.0)
            )
            slope = (high - low) / (2.0 * _REST_DIFFERENCE_STEP_OVER_MOTION_RANGE)
            step = -float(misfit(position) @ slope) / (float(slope @ slope) + 1.0)
            position += size * float(np.clip(step, -0.5, 0.5))
        return position

    def residuals(self, law: HysteresisLaw, residual_scale: Array) -> Array:
        """Residuals of measured loops against a hysteresis law, over their standard deviations [1].

        The residuals are the force errors (n), the shifts of the turning points (branches), and the force
        steps between slipping branches (`slip_steps`), which the free offset of each branch would hide
        otherwise.
        """
        law = law.with_rest_position(self.rest_position(law, residual_scale))
        _, start, residual = self.fit_turning_points(law, residual_scale)
        steps = [self._slip_step_residual(law, step, start, residual_scale) for step in self.slip_steps]
        return np.concatenate(
            [residual / residual_scale, (start - self.start_motion) / self.start_motion_deviation, steps]
        )

    def _slip_step_residual(
        self, law: HysteresisLaw, slip_step: "SlipStep", start_motion: Array, residual_scale: Array
    ) -> float:
        """Measured minus computed force step between two slipping branches, over its standard deviation [1].


        start_motion : fitted motion (branches) at the turning points
        """
        k = slip_step.branch_number

        def mean_change(samples: NDArray[np.int64], start: float) -> float:
            """Force change of the law since the start of a branch, averaged over samples [N or N.m]."""
            return float(np.mean(law.force_change(self.motion[samples], np.full(samples.size, start))))

        before, after = start_motion[k - 1], start_motion[k]
        end_change = float(law.force_change(np.array([after]), np.array([before]))[0])
        law_step = (
            mean_change(slip_step.samples_after, after)
            + end_change
            - mean_change(slip_step.samples_before, before)
        )
        scale = float(residual_scale[slip_step.samples_after[0]])
        deviation = max(slip_step.deviation, scale * slip_step.relative_deviation)
        return (slip_step.force_step - law_step) / deviation

    def _force_residuals(self, law: HysteresisLaw, start_shift: float) -> Array:
        """Force (n) minus the force change by the law since the turning point.

        The turning points are shifted by `start_shift` standard deviations [1] of their motion.
        """
        return self.force - law.force_change(
            self.motion, (self.start_motion + start_shift * self.start_motion_deviation)[self.branch_index]
        )

    def _branch_sums(self, sample_values: Array) -> Array:
        """Sum (branches) of values (n) over each branch."""
        return np.asarray(np.bincount(self.branch_index, sample_values), dtype=np.float64)

    def _branch_means(self, sample_values: Array) -> Array:
        """Mean (branches) of values (n) over each branch."""
        return np.asarray(self._branch_sums(sample_values) / np.bincount(self.branch_index))


@dataclass(frozen=True, slots=True)
class SlipStep:
    """Force step between the flat ends of two consecutive branches: twice the friction force at gross slip.

    branch_number                 : index of the second branch
    samples_before, samples_after : indices of the samples on both flat ends
    force_step                    : difference of the mean forces, second minus first
    deviation                     : standard deviation of `force_step` by the scatter of the samples
    relative_deviation            : least standard deviation over the residual scale [1]: if the law misses
                                    the data systematically, the step counts as all samples of both branches
    """

    branch_number: int
    samples_before: NDArray[np.int64]
    samples_after: NDArray[np.int64]
    force_step: float
    deviation: float
    relative_deviation: float


def cut_branches(measured_runs: Sequence[tuple[str, Array, Array]]) -> Loops:
    """Cut measured runs into branches at the turning points of the motion.

    measured_runs : (prefix of error messages, motion, force) of each run, samples in the order of the
                    measurement

    Samples before the first turning point are left out, because their history is unknown. Samples beyond the
    previous turning point are left out, because there a smaller loop has closed.

    Raises ValueError: no branch, a loop that creates energy, a force that falls with the motion.
    """
    branches: list[tuple[Array, Array, float, float, float, int]] = []
    areas = []
    for number, (name, motion, force) in enumerate(measured_runs):
        turns = find_turning_points(motion)
        if not turns.size:
            raise ValueError(f"{name}the motion never reverses; give loops with reversals")
        ends = [*turns.tolist(), motion.size - 1]
        areas += _check_work(name, motion, force, ends)
        run_branches = [(*branch, number) for branch in _branches_of_run(motion, force, ends)]
        if not run_branches:
            raise ValueError(
                f"{name}no branch after a turning point has {MIN_BRANCH_SAMPLES} samples; expected loops"
            )
        branches += run_branches
    sizes = [branch[0].size for branch in branches]
    loops = Loops(
        motion=np.concatenate([branch[0] for branch in branches]),
        force=np.concatenate([branch[1] for branch in branches]),
        branch_index=np.repeat(np.arange(len(branches)), sizes),
        start_motion=np.array([branch[2] for branch in branches]),
        start_motion_deviation=np.array([branch[3] for branch in branches]),
        start_force=np.array([branch[4] for branch in branches]),
        run_index=np.repeat([branch[5] for branch in branches], sizes),
        widest_loops=areas,
    )
    return replace(loops, slip_steps=loops.find_slip_steps())


def _branches_of_run(
    motion: Array, force: Array, branch_ends: Sequence[int]
) -> Iterator[tuple[Array, Array, float, float, float]]:
    """Yield, for each branch of a run, its samples and its start.

    Samples: motion and force. Start: motion, standard deviation of this motion, and force.

    branch_ends : indices of the turning points, and of the last sample

    The extreme sample of the motion may lie behind the reversal, where the force has changed already. The
    force at the start is that of the extreme sample or of the sample before, whichever is further from the
    force at the end.
    """
    deviation = noise_deviation(motion)
    turns = [refine_turning_point(motion, k, deviation) for k in branch_ends]
    for k, (first, last) in enumerate(pairwise(branch_ends)):
        u, F = motion[first + 1 : last + 1], force[first + 1 : last + 1]
        inside = np.abs(u - turns[k]) <= (abs(turns[k - 1] - turns[k]) if k else np.inf)
        if np.count_nonzero(inside) >= MIN_BRANCH_SAMPLES:
            step = 0.25 * (abs(motion[first + 1] - motion[first]) + abs(motion[first] - motion[first - 1]))
            turn_deviation = max(float(np.hypot(step, deviation)), RELATIVE_ROUNDING * float(np.ptp(motion)))
            start_force = max(force[first - 1 : first + 1], key=lambda F_0: abs(F_0 - F[inside][-1]))
            yield u[inside], F[inside], turns[k], turn_deviation, float(start_force)


def find_turning_points(motion: Array) -> NDArray[np.int64]:
    """Find the indices of the turning points of a motion; reversals within the noise do not count."""
    least = max(
        MIN_REVERSAL_OVER_MOTION_RANGE * float(np.ptp(motion)),
        MIN_REVERSAL_OVER_NOISE * noise_deviation(motion),
    )
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
    """Refine the motion at a turning point: vertex of a parabola through the samples next to `sample_index`.

    motion_noise : standard deviation of the noise of the motion

    The parabola uses the samples within TURNING_POINT_DEVIATION_OVER_NOISE deviations of the turning point.
    The extreme sample itself would overestimate the motion, because of its noise.
    """
    distinct = np.abs(motion - motion[sample_index]) > TURNING_POINT_DEVIATION_OVER_NOISE * motion_noise
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


def _check_work(
    message_prefix: str, motion: Array, force: Array, branch_ends: Sequence[int]
) -> list[tuple[float, float]]:
    """Check that the loops of a run dissipate work and that the force rises with the motion.

    The work of the loops decides, not the number of rows: rows may be dense after the reversals. Returns area
    [J] and range of motion of the widest closed loop, as a list of one or no element.

    branch_ends : indices of the turning points, and of the last sample

    Raises ValueError if the loops create more energy (mean negative area) than noise explains, or if the mean
    of the branches falls by more than the branches differ.
    """
    branches = [(motion[a : b + 1], force[a : b + 1]) for a, b in pairwise(branch_ends)]
    loops = [loop for first, second in pairwise(branches) if (loop := _enclosed_loop(first, second))]
    if not loops:
        if sum((u[-1] - u[0]) * (F[-1] - F[0]) for u, F in branches) < 0.0:
            raise ValueError(f"{message_prefix}{_FALLING_FORCE_TEXT}")
        return []
    area, size = float(np.mean([loop.area for loop in loops])), max(loop.motion_range for loop in loops)
    rise = float(np.mean([loop.mean_rise for loop in loops]))
    slope = float(np.ptp(force) / np.ptp(motion))
    # the area between two branches is integrated over at most _GRID_POINTS of their samples
    samples = min(motion.size / len(branches), _AREA_INTEGRATION_POINTS) * len(loops)
    noise = np.hypot(noise_deviation(force), slope * noise_deviation(motion))
    deviation = noise * size * np.sqrt(2.0 / samples)
    if rise < -abs(area) / size:
        raise ValueError(f"{message_prefix}{_FALLING_FORCE_TEXT}")
    if area < -max(
        MAX_CREATED_ENERGY_OVER_AREA_DEVIATION * deviation, RELATIVE_ROUNDING * size * float(np.ptp(force))
    ):
        sign_hint = "" if rise > abs(area) / size else "reverse the sign of one column, or "
        raise ValueError(
            f"{message_prefix}the loop creates energy, area = {area:.3g} J, expected 0 or more: the force "
            f"must lead the motion; {sign_hint}reverse the order of the rows if their time order is reversed"
        )
    closed = [
        loop for loop in loops if loop.motion_range >= MIN_COMMON_OVER_LONGER_MOTION_RANGE * loop.longer_range
    ]
    if not closed:
        return []
    widest = max(closed, key=lambda loop: loop.motion_range)
    return [(widest.area, widest.motion_range)]


_FALLING_FORCE_TEXT = "the force decreases as the motion increases; reverse the sign of one column"
"""Error of loops in which the force falls with the motion."""


@dataclass(frozen=True, slots=True)
class _EnclosedLoop:
    """Closed part of a measured loop between two consecutive branches.

    area         : work [J] dissipated between the branches
    motion_range : range of motion common to both branches
    longer_range : range of motion of the longer branch
    mean_rise    : rise of the mean of both branches over `motion_range`, by linear regression
    """

    area: float
    motion_range: float
    longer_range: float
    mean_rise: float


def _enclosed_loop(
    first_branch: tuple[Array, Array], second_branch: tuple[Array, Array]
) -> _EnclosedLoop | None:
    """Loop between two consecutive branches. Each branch: motion, force.

    None if the branches have no common range, or too few samples.
    """
    (u, F), (v, G) = (
        (first_branch, second_branch)
        if first_branch[0][-1] > first_branch[0][0]
        else (second_branch, first_branch)
    )
    low, high = max(u.min(), v.min()), min(u.max(), v.max())
    if not high > low or min(u.size, v.size) < MIN_BRANCH_SAMPLES:
        return None
    grid = np.linspace(low, high, _AREA_INTEGRATION_POINTS)
    up, down = (np.interp(grid, *sort_points(x, y)) for x, y in ((u, F), (v, G)))
    fraction = np.linspace(-0.5, 0.5, _AREA_INTEGRATION_POINTS)
    return _EnclosedLoop(
        float(np.trapezoid(up - down, grid)),
        float(high - low),
        float(max(np.ptp(u), np.ptp(v))),
        float(fraction @ (0.5 * (up + down)) / (fraction @ fraction)),
    )


def sort_points(x_values: Array, y_values: Array) -> tuple[Array, Array]:
    """Sort points (n) with coordinates x, y by x, ascending."""
    order = np.argsort(x_values, kind="stable")
    return x_values[order], y_values[order]
