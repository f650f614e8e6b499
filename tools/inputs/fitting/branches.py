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
MIN_MOTION_REVERSAL_OVER_NOISE = 8.0
"""Smallest reversal that counts as a turning point, over the standard deviation of the noise [1]."""
TURNING_POINT_DEVIATION_OVER_NOISE = 5.0
"""Deviation from the motion at a turning point, over the standard deviation of the noise [1], up to which
samples enter the parabola of the turning point."""
MIN_BRANCH_SAMPLES = 5
"""Minimum number of samples of a branch."""
MAX_CREATED_ENERGY_OVER_AREA_DEVIATION = 4.0
"""Energy that a loop may create (negative area), over the standard deviation of its area [1]."""
NOISE_FREE_ROUND_OFF = 1e-9
"""Relative round-off [1] of data without noise: of areas over range of force times range of motion, of
motions over their range."""
MIN_COMMON_OVER_LONGER_MOTION_RANGE = 0.9
"""Motion range common to two branches over range of the longer branch [1], from which they close a loop."""
RISING_OVER_BRANCH_FORCE_CHANGE = 0.9
"""Force change since the turning point over change of the whole branch [1], up to which a branch counts as
rising. Beyond it a slipped branch is flat."""
FLAT_END_SHARE_OF_MOTION, MAX_FLAT_END_SHARE_OF_FORCE_CHANGE = 0.3, 0.05
"""Last part of a branch over its range of motion [1], and rise of the force over this part, relative to the
force change of the branch [1], up to which the branch counts as slipping."""
MIN_FLAT_SAMPLES = 3
"""Minimum number of samples on the flat end of a branch."""
CLEARANCE_CHECK_INTERVALS = 12
"""Number of equal parts of a branch that show whether its stiffness rises again."""
MIN_BEARING_RISE_OVER_BRANCH_RISE, MIN_BEARING_OVER_SOFTEST_STIFFNESS = 0.2, 3.0
"""Rise of the force after the softest part over rise of the branch [1], and stiffness there over stiffness
of the softest part [1], from which a joint bears after slip."""
MIN_STIFFNESS_RISE_OVER_DEVIATION = 8.0
"""Rise of a branch's stiffness over its standard deviation [1], from which a joint bears after slip."""
MIN_RISING_BRANCH_SAMPLES = 5
"""Number of samples on the rising part of a branch from which its stiffness counts as resolved."""
MIN_STIFFNESS_DEVIATIONS = 4.0
"""Distance of the lower bound of a stiffness from its estimate, in standard deviations [1]."""
_AREA_INTEGRATION_POINTS = 200
"""Number of points of the grid for the area between two branches [1]."""
_MAX_REST_POSITION_ITERATIONS, _REST_DIFFERENCE_STEP_OVER_MOTION_RANGE = 6, 1e-4
"""Gauss-Newton iterations for the rest position, and half the difference step over the motion's range [1]."""


@dataclass(frozen=True, slots=True)
class MeasuredLoops:
    """Measured hysteresis loops: samples of their branches, branch after branch.

    joint_motion          : (n) displacement or angle of the samples
    joint_force           : (n) force or torque of the samples
    branch_of_sample      : (n) index of the branch of each sample
    branch_start_motion   : (branches) motion at the turning point at which the branch begins
    branch_start_motion_standard_deviation : (branches) standard deviation of `branch_start_motion`
    branch_start_force    : (branches) approximate force at the turning point
    run_of_sample         : (n) index of the run of each sample
    widest_loops          : for each run with a closed loop: area [J] and range of motion of its widest loop
    slip_steps            : force steps between branches that slip, see `find_slip_steps`
    """

    joint_motion: Array
    joint_force: Array
    branch_of_sample: NDArray[np.int64]
    branch_start_motion: Array
    branch_start_motion_standard_deviation: Array
    branch_start_force: Array
    run_of_sample: NDArray[np.int64]
    widest_loops: Sequence[tuple[float, float]]
    slip_steps: Sequence["SlipStep"] = ()

    @property
    def noise_group_of_residual(self) -> NDArray[np.int64]:
        """Index (n) of the group of samples with equal noise: the index of the run of each sample."""
        return self.run_of_sample

    @property
    def residual_scale(self) -> Array:
        """Scale (n) of the force residuals: range of the force in the run of each sample."""
        return np.array(
            [np.ptp(self.joint_force[self.run_of_sample == k]) for k in range(self.run_of_sample[-1] + 1)]
        )[self.run_of_sample]

    @property
    def nuisance_count(self) -> int:
        """Number of nuisance parameters: force and motion at each turning point, and the rest position."""
        return 2 * self.branch_start_motion.size + 1

    @property
    def rest_stiffness(self) -> float:
        """Approximate stiffness [N/m or N.m/rad] after a reversal: initial slope of the best branch.

        If `is_stiffness_resolved` is false, the result is a secant, which is rather too small.
        """
        return self._best_initial_slope.stiffness

    @property
    def min_rest_stiffness(self) -> float:
        """Lower bound [N/m or N.m/rad] of the stiffness after a reversal, with a margin for the noise."""
        return self._best_initial_slope.min_stiffness

    @property
    def is_stiffness_resolved(self) -> bool:
        """Whether a branch has enough samples between its turning point and slip to show its stiffness."""
        return self._best_initial_slope.is_resolved

    @property
    def _best_initial_slope(self) -> "InitialSlope":
        """Initial slope with the largest lower bound, of the resolved branches if there are any."""
        slopes = [self._initial_slope(k) for k in range(self.branch_start_motion.size)]
        return max(slopes, key=lambda slope: (slope.is_resolved, slope.min_stiffness))

    def _initial_slope(self, branch_index: int) -> "InitialSlope":
        """Stiffness right after the turning point of a branch.

        Only the rising part of the branch is used: a slipped part would lower the slope.
        """
        distance, change = self.branch_curve(branch_index)
        rising = int(np.argmax(change >= RISING_OVER_BRANCH_FORCE_CHANGE * np.max(change)))
        if rising >= MIN_RISING_BRANCH_SAMPLES:
            coefficients, covariance = np.polyfit(distance[:rising], change[:rising], 2, cov=True)
            slope, deviation = float(coefficients[1]), float(np.sqrt(covariance[1, 1]))
            return InitialSlope(branch_index, rising, slope, slope - MIN_STIFFNESS_DEVIATIONS * deviation)
        deviation = float(self.branch_start_motion_standard_deviation[branch_index])
        secant, min_secant = (
            float(change[rising] / (distance[rising] + factor * deviation))
            for factor in (1.0, MIN_STIFFNESS_DEVIATIONS)
        )
        return InitialSlope(branch_index, rising, secant, min_secant)

    def rest_stiffness_over_law(self, hysteresis_law: HysteresisLaw, residual_scale: Array) -> float:
        """Stiffness after a reversal over that of a law [1], both by the initial slope at the same samples.

        NaN if the samples do not resolve the stiffness.
        """
        best = self._best_initial_slope
        if not best.is_resolved:
            return np.nan
        law = hysteresis_law.with_rest_position(self.rest_position(hysteresis_law, residual_scale))
        _, _, residual = self.fit_turning_points(law, residual_scale)
        distance, measured = self.branch_curve(best.branch_index)
        _, computed = replace(self, joint_force=self.joint_force - residual).branch_curve(best.branch_index)
        rising = slice(best.rising_samples)
        slopes = [np.polyfit(distance[rising], change[rising], 2)[1] for change in (measured, computed)]
        return float(slopes[0] / slopes[1])

    @property
    def slip_force(self) -> float | None:
        """Friction force at gross slip [N or N.m]: half the force change of branches with a flat end.

        None if no branch has a flat end.
        """
        plateaus = []
        for k in range(self.branch_start_motion.size):
            _, change = self.branch_curve(k)
            if (flat := self._flat_end_samples(k)).any():
                plateaus.append(0.5 * float(np.mean(change[flat])))
        return float(np.median(plateaus)) if plateaus else None

    def _flat_end_samples(self, branch_index: int) -> NDArray[np.bool_]:
        """Mask (n) of the samples of a branch on its flat end; all false if its end is not flat."""
        distance, change = self.branch_curve(branch_index)
        end = distance >= (1.0 - FLAT_END_SHARE_OF_MOTION) * np.max(distance)
        if np.count_nonzero(end) < MIN_FLAT_SAMPLES:
            return np.zeros_like(end)
        slope = float(np.polyfit(distance[end], change[end], 1)[0])
        is_flat = abs(slope) * FLAT_END_SHARE_OF_MOTION * np.max(
            distance
        ) < MAX_FLAT_END_SHARE_OF_FORCE_CHANGE * np.max(change)
        return np.asarray(end & is_flat)

    def find_slip_steps(self) -> list["SlipStep"]:
        """Find the force steps at turning points between two branches that both end in full slip."""
        flat = [
            np.flatnonzero(self.branch_of_sample == k)[self._flat_end_samples(k)]
            for k in range(self.branch_start_motion.size)
        ]
        sizes = np.bincount(self.branch_of_sample)
        steps = []
        for number, (before, after) in enumerate(pairwise(flat), 1):
            if (
                not before.size
                or not after.size
                or self.run_of_sample[before[0]] != self.run_of_sample[after[0]]
            ):
                continue
            deviation = np.hypot(
                *(np.std(self.joint_force[rows], ddof=1) / np.sqrt(rows.size) for rows in (before, after))
            )
            steps.append(
                SlipStep(
                    branch_index=number,
                    first_flat_end_samples=before,
                    second_flat_end_samples=after,
                    force_step=float(np.mean(self.joint_force[after]) - np.mean(self.joint_force[before])),
                    force_step_standard_deviation=float(deviation),
                    min_relative_standard_deviation=float(np.hypot(*sizes[number - 1 : number + 1] ** -0.5)),
                )
            )
        return steps

    def find_clearance_slip(self) -> tuple[float, float] | None:
        """Find slip through a clearance, until the joint bears (its bolts touch the holes).

        Returns the range of motion of this slip and its force change; None if the joint never bears.
        After a reversal, friction alone makes a joint softer and softer. A joint that becomes stiffer again
        has slipped through a clearance.
        """
        for k in range(self.branch_start_motion.size):
            distance, change = self.branch_curve(k)
            part = distance / np.max(distance) * CLEARANCE_CHECK_INTERVALS
            part = np.clip(part.astype(np.int64), 0, CLEARANCE_CHECK_INTERVALS - 1)
            counts = np.bincount(part, minlength=CLEARANCE_CHECK_INTERVALS)
            if not np.all(counts):
                continue
            x, y = (np.bincount(part, values) / counts for values in (distance, change))
            slopes = np.diff(y) / np.diff(x)
            softest = int(np.argmin(slopes))
            later = softest + int(np.argmax(slopes[softest:]))
            noise = estimate_noise_deviation(change) * np.sqrt(2.0 / np.min(counts)) / np.min(np.diff(x))
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

    def branch_curve(self, branch_index: int) -> tuple[Array, Array]:
        """Distance (n) from the turning point and force change (n) in this direction, of one branch."""
        samples = self.branch_of_sample == branch_index
        shift = self.joint_motion[samples] - self.branch_start_motion[branch_index]
        change = self.joint_force[samples] - self.branch_start_force[branch_index]
        return np.abs(shift), np.copysign(1.0, shift[-1]) * change

    def fit_turning_points(
        self, hysteresis_law: HysteresisLaw, residual_scale: Array
    ) -> tuple[Array, Array, Array]:
        """Fit the turning points to the samples: force and motion (branches) there, and residual force (n).

        Linear least squares for each branch. `residual_scale` (n) are the standard deviations of the force;
        the motion at the turning point has the standard deviation `branch_start_motion_standard_deviation`.
        """
        residual, derivative = (
            self._force_residuals(hysteresis_law, 0.0),
            self._force_residuals(hysteresis_law, 1.0),
        )
        derivative = (derivative - residual) / self.branch_start_motion_standard_deviation[
            self.branch_of_sample
        ]
        force, mean_derivative = self._branch_means(residual), self._branch_means(derivative)
        residual = residual - force[self.branch_of_sample]
        derivative = derivative - mean_derivative[self.branch_of_sample]
        weight = residual_scale**-2.0
        shift = -self._branch_sums(weight * residual * derivative) / (
            self._branch_sums(weight * derivative**2) + self.branch_start_motion_standard_deviation**-2.0
        )
        return (
            force + mean_derivative * shift,
            self.branch_start_motion + shift,
            residual + derivative * shift[self.branch_of_sample],
        )

    def rest_position(self, hysteresis_law: HysteresisLaw, residual_scale: Array) -> float:
        """Motion at which the elastic force is zero (rest position), by a least-squares fit (Gauss-Newton).

        The search starts at zero or in the middle of the measured motion, whichever fits better. If the law
        is linear there, the data do not determine the position, and the result is the start.
        """
        if hysteresis_law.elastic_spring is None:
            return 0.0
        force = hysteresis_law.elastic_spring.elastic_force
        without_friction = self._force_residuals(replace(hysteresis_law, elastic_spring=None), 0.0)
        size = float(np.ptp(self.joint_motion))

        def misfit(trial_rest_position: float) -> Array:
            """Force residuals (n) over their standard deviations [1] for a trial rest position of the law."""
            residual = (
                without_friction
                - force(self.joint_motion - trial_rest_position)
                + force(self.branch_start_motion - trial_rest_position)[self.branch_of_sample]
            )
            return np.asarray(
                (residual - self._branch_means(residual)[self.branch_of_sample]) / residual_scale
            )

        middle = 0.5 * float(np.max(self.joint_motion) + np.min(self.joint_motion))
        position = min((0.0, middle), key=lambda rest: float(np.sum(misfit(rest) ** 2)))
        for _ in range(_MAX_REST_POSITION_ITERATIONS):
            high, low = (
                misfit(position + sign * _REST_DIFFERENCE_STEP_OVER_MOTION_RANGE * size)
                for sign in (1.0, -1.0)
            )
            slope = (high - low) / (2.0 * _REST_DIFFERENCE_STEP_OVER_MOTION_RANGE)
            step = -float(misfit(position) @ slope) / (float(slope @ slope) + 1.0)
            position += size * float(np.clip(step, -0.5, 0.5))
        return position

    def residuals(self, hysteresis_law: HysteresisLaw, residual_scale: Array) -> Array:
        """Residuals of measured loops against a hysteresis law, over their standard deviations [1].

        The residuals are the force errors (n), the shifts of the turning points (branches), and the force
        steps between slipping branches (`slip_steps`), which the free offset of each branch would hide
        otherwise.
        """
        hysteresis_law = hysteresis_law.with_rest_position(self.rest_position(hysteresis_law, residual_scale))
        _, start, residual = self.fit_turning_points(hysteresis_law, residual_scale)
        steps = [
            self._slip_step_residual(hysteresis_law, step, start, residual_scale) for step in self.slip_steps
        ]
        return np.concatenate(
            [
                residual / residual_scale,
                (start - self.branch_start_motion) / self.branch_start_motion_standard_deviation,
                steps,
            ]
        )

    def _slip_step_residual(
        self, hysteresis_law: HysteresisLaw, slip_step: "SlipStep", start_motion: Array, residual_scale: Array
    ) -> float:
        """Measured minus computed force step between two slipping branches, over its standard deviation [1].

        start_motion : fitted motion (branches) at the turning points
        """
        k = slip_step.branch_index

        def mean_force_change(sample_indices: NDArray[np.int64], branch_start_motion: float) -> float:
            """Force change of the law since the start of a branch, averaged over samples [N or N.m]."""
            return float(
                np.mean(
                    hysteresis_law.force_change(
                        self.joint_motion[sample_indices], np.full(sample_indices.size, branch_start_motion)
                    )
                )
            )

        before, after = start_motion[k - 1], start_motion[k]
        end_change = float(hysteresis_law.force_change(np.array([after]), np.array([before]))[0])
        law_step = (
            mean_force_change(slip_step.second_flat_end_samples, after)
            + end_change
            - mean_force_change(slip_step.first_flat_end_samples, before)
        )
        scale = float(residual_scale[slip_step.second_flat_end_samples[0]])
        deviation = max(
            slip_step.force_step_standard_deviation, scale * slip_step.min_relative_standard_deviation
        )
        return (slip_step.force_step - law_step) / deviation

    def _force_residuals(self, hysteresis_law: HysteresisLaw, turning_point_shift: float) -> Array:
        """Measured force (n) minus the change of the law's force since the turning point of the branch.

        The turning points are shifted by `turning_point_shift` standard deviations [1] of their motion.
        """
        return self.joint_force - hysteresis_law.force_change(
            self.joint_motion,
            (self.branch_start_motion + turning_point_shift * self.branch_start_motion_standard_deviation)[
                self.branch_of_sample
            ],
        )

    def _branch_sums(self, sample_values: Array) -> Array:
        """Sum (branches) of values (n) over each branch."""
        return np.asarray(np.bincount(self.branch_of_sample, sample_values), dtype=np.float64)

    def _branch_means(self, sample_values: Array) -> Array:
        """Mean (branches) of values (n) over each branch."""
        return np.asarray(self._branch_sums(sample_values) / np.bincount(self.branch_of_sample))


@dataclass(frozen=True, slots=True)
class InitialSlope:
    """Stiffness right after the turning point of a branch.

    rising_samples : number of samples before the branch slips
    stiffness      : [N/m or N.m/rad]; a secant if the slope is not resolved
    min_stiffness  : lower bound of `stiffness`, MIN_STIFFNESS_DEVIATIONS standard deviations below
    """

    branch_index: int
    rising_samples: int
    stiffness: float
    min_stiffness: float

    @property
    def is_resolved(self) -> bool:
        """Whether the samples before slip suffice for the slope."""
        return self.rising_samples >= MIN_RISING_BRANCH_SAMPLES


@dataclass(frozen=True, slots=True)
class SlipStep:
    """Force step between the flat ends of two consecutive branches: twice the friction force at gross slip.

    branch_index : index of the second branch
    first_flat_end_samples, second_flat_end_samples : indices of the samples on both flat ends
    force_step : difference of the mean forces, second minus first
    force_step_standard_deviation : standard deviation of `force_step` by the scatter of the samples
    min_relative_standard_deviation : lower limit of the standard deviation of the step, over the residual
        scale of a sample [1]: if the law misses the data systematically, the step counts as all samples of
        both branches
    """

    branch_index: int
    first_flat_end_samples: NDArray[np.int64]
    second_flat_end_samples: NDArray[np.int64]
    force_step: float
    force_step_standard_deviation: float
    min_relative_standard_deviation: float


def cut_branches(measured_runs: Sequence[tuple[str, Array, Array]]) -> MeasuredLoops:
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
        areas += _check_loop_work(name, motion, force, ends)
        run_branches = [(*branch, number) for branch in _cut_run_into_branches(motion, force, ends)]
        if not run_branches:
            raise ValueError(
                f"{name}has fewer than {MIN_BRANCH_SAMPLES} samples after each reversal; expected loops with "
                "more samples"
            )
        branches += run_branches
    sizes = [branch[0].size for branch in branches]
    loops = MeasuredLoops(
        joint_motion=np.concatenate([branch[0] for branch in branches]),
        joint_force=np.concatenate([branch[1] for branch in branches]),
        branch_of_sample=np.repeat(np.arange(len(branches)), sizes),
        branch_start_motion=np.array([branch[2] for branch in branches]),
        branch_start_motion_standard_deviation=np.array([branch[3] for branch in branches]),
        branch_start_force=np.array([branch[4] for branch in branches]),
        run_of_sample=np.repeat([branch[5] for branch in branches], sizes),
        widest_loops=areas,
    )
    return replace(loops, slip_steps=loops.find_slip_steps())


def _cut_run_into_branches(
    joint_motion: Array, joint_force: Array, branch_ends: Sequence[int]
) -> Iterator[tuple[Array, Array, float, float, float]]:
    """Yield, for each branch of a run, its samples and its start.

    Samples: motion and force. Start: motion, standard deviation of this motion, and force.

    branch_ends : indices of the turning points, and of the last sample

    The extreme sample of the motion may lie behind the reversal, where the force has changed already. The
    force at the start is that of the extreme sample or of the sample before, whichever is further from the
    force at the end.
    """
    deviation = estimate_noise_deviation(joint_motion)
    turns = [refine_turning_point(joint_motion, k, deviation) for k in branch_ends]
    for k, (first, last) in enumerate(pairwise(branch_ends)):
        u, F = joint_motion[first + 1 : last + 1], joint_force[first + 1 : last + 1]
        inside = np.abs(u - turns[k]) <= (abs(turns[k - 1] - turns[k]) if k else np.inf)
        if np.count_nonzero(inside) >= MIN_BRANCH_SAMPLES:
            step = 0.25 * (
                abs(joint_motion[first + 1] - joint_motion[first])
                + abs(joint_motion[first] - joint_motion[first - 1])
            )
            turn_deviation = max(
                float(np.hypot(step, deviation)), NOISE_FREE_ROUND_OFF * float(np.ptp(joint_motion))
            )
            start_force = max(joint_force[first - 1 : first + 1], key=lambda F_0: abs(F_0 - F[inside][-1]))
            yield u[inside], F[inside], turns[k], turn_deviation, float(start_force)


def find_turning_points(joint_motion: Array) -> NDArray[np.int64]:
    """Find the indices of the turning points of a motion; reversals within the noise do not count."""
    least = max(
        MIN_REVERSAL_OVER_MOTION_RANGE * float(np.ptp(joint_motion)),
        MIN_MOTION_REVERSAL_OVER_NOISE * estimate_noise_deviation(joint_motion),
    )
    if not least > 0.0:
        return np.array([], dtype=np.int64)
    return find_reversals(joint_motion, least)


def find_reversals(sampled_signal: Array, min_reversal: float) -> NDArray[np.int64]:
    """Find the indices at which a signal reverses by at least `min_reversal`."""
    from scipy.signal import find_peaks  # slow to import, and most commands import this module

    return np.sort(
        np.concatenate(
            [find_peaks(sign * sampled_signal, prominence=min_reversal)[0] for sign in (1.0, -1.0)]
        )
    )


def refine_turning_point(joint_motion: Array, sample_index: int, motion_noise: float) -> float:
    """Refine the motion at a turning point: vertex of a parabola through the samples next to `sample_index`.

    motion_noise : standard deviation of the noise of the motion

    The parabola uses the samples within TURNING_POINT_DEVIATION_OVER_NOISE deviations of the turning point.
    The extreme sample itself would overestimate the motion, because of its noise.
    """
    distinct = (
        np.abs(joint_motion - joint_motion[sample_index]) > TURNING_POINT_DEVIATION_OVER_NOISE * motion_noise
    )
    before, after = np.flatnonzero(distinct[:sample_index]), np.flatnonzero(distinct[sample_index:])
    width = min(
        sample_index - int(before[-1]) if before.size else sample_index,
        int(after[0]) if after.size else joint_motion.size - 1 - sample_index,
    )
    if width < 2:
        return float(joint_motion[sample_index])
    offsets = np.arange(-width, width + 1)
    c, b, a = np.polyfit(offsets, joint_motion[sample_index - width : sample_index + width + 1], 2)
    return float(a - b**2 / (4.0 * c) if c else a)


def estimate_noise_deviation(sampled_signal: Array) -> float:
    """Standard deviation of independent noise on a smooth signal, from the second differences of the signal.

    The curvature of the signal counts as noise, so the result is an upper bound.
    """
    if sampled_signal.size < 3:
        return 0.0
    return float(np.median(np.abs(np.diff(sampled_signal, 2))) / 0.6745 / np.sqrt(6.0))


def _check_loop_work(
    message_prefix: str, joint_motion: Array, joint_force: Array, branch_ends: Sequence[int]
) -> list[tuple[float, float]]:
    """Check that the loops of a run dissipate work and that the force rises with the motion.

    The work of the loops decides, not the number of rows: rows may be dense after the reversals. Returns area
    [J] and range of motion of the widest closed loop, as a list of one or no element.

    branch_ends : indices of the turning points, and of the last sample

    Raises ValueError if the loops create more energy (mean negative area) than noise explains, or if the mean
    of the branches falls by more than the branches differ.
    """
    branches = [(joint_motion[a : b + 1], joint_force[a : b + 1]) for a, b in pairwise(branch_ends)]
    loops = [loop for first, second in pairwise(branches) if (loop := _find_enclosed_loop(first, second))]
    if not loops:
        if sum((u[-1] - u[0]) * (F[-1] - F[0]) for u, F in branches) < 0.0:
            raise ValueError(f"{message_prefix}{_FALLING_FORCE_TEXT}")
        return []
    area, size = float(np.mean([loop.loop_area for loop in loops])), max(loop.motion_range for loop in loops)
    rise = float(np.mean([loop.mean_force_rise for loop in loops]))
    slope = float(np.ptp(joint_force) / np.ptp(joint_motion))
    # the area between two branches is integrated over at most _GRID_POINTS of their samples
    samples = min(joint_motion.size / len(branches), _AREA_INTEGRATION_POINTS) * len(loops)
    noise = np.hypot(estimate_noise_deviation(joint_force), slope * estimate_noise_deviation(joint_motion))
    deviation = noise * size * np.sqrt(2.0 / samples)
    if rise < -abs(area) / size:
        raise ValueError(f"{message_prefix}{_FALLING_FORCE_TEXT}")
    if area < -max(
        MAX_CREATED_ENERGY_OVER_AREA_DEVIATION * deviation,
        NOISE_FREE_ROUND_OFF * size * float(np.ptp(joint_force)),
    ):
        sign_hint = "" if rise > abs(area) / size else "reverse the sign of one column, or "
        raise ValueError(
            f"{message_prefix}the loop creates energy, area = {area:.3g} J, expected 0 or more: the force "
            f"must lead the motion; {sign_hint}reverse the order of the rows if their time order is reversed"
        )
    closed = [
        loop
        for loop in loops
        if loop.motion_range >= MIN_COMMON_OVER_LONGER_MOTION_RANGE * loop.longer_branch_motion_range
    ]
    if not closed:
        return []
    widest = max(closed, key=lambda loop: loop.motion_range)
    return [(widest.loop_area, widest.motion_range)]


_FALLING_FORCE_TEXT = "the force decreases as the motion increases; reverse the sign of one column"
"""Error of loops in which the force falls with the motion."""


@dataclass(frozen=True, slots=True)
class _EnclosedLoop:
    """Closed part of a measured loop between two consecutive branches.

    loop_area           : work [J] dissipated between the branches
    motion_range        : range of motion common to both branches
    longer_branch_motion_range : range of motion of the longer branch
    mean_force_rise     : rise of the mean of both branches over `motion_range`, by linear regression
    """

    loop_area: float
    motion_range: float
    longer_branch_motion_range: float
    mean_force_rise: float


def _find_enclosed_loop(
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
    up, down = (np.interp(grid, *sort_points_by_x(x, y)) for x, y in ((u, F), (v, G)))
    fraction = np.linspace(-0.5, 0.5, _AREA_INTEGRATION_POINTS)
    return _EnclosedLoop(
        float(np.trapezoid(up - down, grid)),
        float(high - low),
        float(max(np.ptp(u), np.ptp(v))),
        float(fraction @ (0.5 * (up + down)) / (fraction @ fraction)),
    )


def sort_points_by_x(x_values: Array, y_values: Array) -> tuple[Array, Array]:
    """Sort n points by their coordinate x, ascending; return the coordinates x (n) and y (n)."""
    order = np.argsort(x_values, kind="stable")
    return x_values[order], y_values[order]
