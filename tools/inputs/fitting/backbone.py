"""Backbone curve of a measured torque-angle record, without hysteresis, friction and drift.

The record is cut into rising and falling branches at the turning points of the torque. One linear
least-squares problem then gives the mean curve m(T) and half the gap h(T) of the branches, piecewise linear
in the torque T, and a drift of the angle, linear in the order of the samples:

    angle_i = m(T_i) + s_i h(T_i) + drift t_i,   s = +1 rising, -1 falling,   t from -1/2 to 1/2

At turning points h = 0, because the branches meet. The drift is left out if the record does not determine it
(a single loop that is not closed).

The backbone is not m, because the friction torque M opposes the motion on both branches. After a reversal M
changes its sign, and has its full value again before the middle of the range. There M is half the torque
difference between the branches at equal angles. On the half of a branch that leads away from the middle the
spring carries T - M (rising) or T + M (falling): these halves are the backbone. At the tips, where the
branches meet, m is off by M/K, K the stiffness.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from jointfmu.quantity import Array

from .branches import find_reversals

MIN_REVERSAL_OVER_TORQUE_RANGE = 0.1
"""Smallest reversal of the torque that counts as a turning point, over the range of the torque [1]."""
CENTRAL_OVER_WHOLE_TORQUE_RANGE = 0.25
"""Central fraction of the torque range [1], in which friction is fully reversed on both branches."""
MIN_BRANCH_OVER_RECORD_TORQUE_RANGE = 0.9
"""Torque range of a branch over that of the record [1], from which the branch covers the full range."""
MAX_KNOTS, POINTS_PER_KNOT = 41, 20
"""Maximum number of knots of the piecewise linear curves, and number of samples for each knot."""
MAX_BACKBONE_POINTS = 400
"""Largest number of points of the backbone [1]; more samples are averaged in groups of similar torque."""
MIN_INDEPENDENT_DRIFT_FRACTION = 0.05
"""Independent fraction of the drift's column in the design matrix [1]: above, the drift is determined."""
MONOTONICITY_CHECK_INTERVALS = 10
"""Number of equal torque intervals in which the backbone is checked to be monotonic [1]."""


@dataclass(frozen=True, slots=True)
class Backbone:
    """Backbone curve of a torque-angle record, and the hysteresis and drift that were separated from it.

    torque, angle : (n) [N.m], (n) [rad], ascending in torque
    sample_counts : number of samples (n) averaged in each point
    branch_count  : number of branches used
    loop_area     : energy dissipated in one loop [J]
    backlash      : angle between the branches at zero torque [rad]
    drift         : drift of the angle over the whole record [rad]

    Loop area, backlash and drift are (value, standard deviation); None if the record does not determine them.
    """

    torque: Array
    angle: Array
    sample_counts: Array
    branch_count: int
    loop_area: tuple[float, float] | None
    backlash: tuple[float, float] | None
    drift: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class _Branch:
    """Branch between two turning points: indices of its samples, direction, torque range [N.m]."""

    sample_indices: NDArray[np.int64]
    is_rising: bool
    min_torque: float
    max_torque: float


def find_backbone(torque: Array, angle: Array) -> Backbone:
    """Backbone curve of a record: torque (n) [N.m] and angle (n) [rad], in the order of the measurement.

    Raises ValueError: constant torque, branches without a common range, or an angle that falls with rising
    torque.
    """
    if not np.ptp(torque) > 0.0:
        raise ValueError(f"torque is {torque[0]:g} N.m throughout; expected a range of torques")
    branches = _select_full_range_branches(_cut_branches(torque))
    if len({b.is_rising for b in branches}) == 1:
        indices = np.concatenate([b.sample_indices for b in branches])
        line = _average_samples_in_groups(torque[indices], angle[indices])
        return _check_monotonic_backbone(Backbone(*line, len(branches), None, None, None))
    low, high = (
        inner(outer(getattr(b, name) for b in branches if b.is_rising is rising) for rising in (True, False))
        for inner, outer, name in ((max, min, "min_torque"), (min, max, "max_torque"))
    )
    if not high - low >= 0.5 * np.ptp(torque):
        raise ValueError(
            f"rising and falling branches overlap only from {low:g} to {high:g} N.m, the torque goes from "
            f"{np.min(torque):g} to {np.max(torque):g} N.m; expected loops over the whole range"
        )
    return _check_monotonic_backbone(_separate_hysteresis(torque, angle, branches, float(low), float(high)))


def _cut_branches(torque: Array) -> list[_Branch]:
    """Cut a record into branches at the turning points of the torque, in the order of the measurement."""
    turns = find_reversals(torque, MIN_REVERSAL_OVER_TORQUE_RANGE * float(np.ptp(torque)))
    ends = np.concatenate([[0], turns, [torque.size - 1]])
    branches = []
    for first, last in pairwise(ends):
        indices = np.arange(first, last + 1)
        T = torque[indices]
        branches.append(_Branch(indices, bool(T[-1] > T[0]), float(np.min(T)), float(np.max(T))))
    return branches


def _select_full_range_branches(branches: list[_Branch]) -> list[_Branch]:
    """Select the branches that cover the full torque range; if a direction has none, all its branches."""
    span = max(b.max_torque for b in branches) - min(b.min_torque for b in branches)
    selected = []
    for rising in (True, False):
        same = [b for b in branches if b.is_rising is rising]
        selected += [
            b for b in same if b.max_torque - b.min_torque >= MIN_BRANCH_OVER_RECORD_TORQUE_RANGE * span
        ] or same
    return sorted(selected, key=lambda b: int(b.sample_indices[0]))


def _separate_hysteresis(
    torque: Array, angle: Array, branches: list[_Branch], min_torque: float, max_torque: float
) -> Backbone:
    """Separate backbone, hysteresis and drift by one linear least-squares problem.

    min_torque, max_torque : torque range [N.m] common to rising and falling branches
    """
    indices = np.concatenate([b.sample_indices for b in branches])
    direction = np.concatenate(
        [np.where(b.is_rising, 1.0, -1.0) * np.ones(b.sample_indices.size) for b in branches]
    )
    inside = (torque[indices] >= min_torque) & (torque[indices] <= max_torque)
    indices, direction = indices[inside], direction[inside]
    T, phi, time = torque[indices], angle[indices], indices / (torque.size - 1.0) - 0.5
    knots = int(np.clip(indices.size // POINTS_PER_KNOT, 5, MAX_KNOTS))
    grid = np.linspace(min_torque, max_torque, knots)
    hats = _hat_functions(T, grid)
    open_gap = np.ones(knots, dtype=bool)  # knots whose gap is unknown; at turning points it is zero
    open_gap[[0, -1]] = [
        not _has_turning_point(branches, min_torque, span := max_torque - min_torque, 0),
        not _has_turning_point(branches, max_torque, span, -1),
    ]
    gap = scipy.sparse.diags(direction) @ hats
    design = scipy.sparse.hstack(
        [hats, gap[:, np.flatnonzero(open_gap)], scipy.sparse.csr_matrix(time[:, None])]
    )
    design = design.tocsr()
    has_drift = _is_drift_identifiable(design)
    if not has_drift:
        design = design[:, :-1]
    normal = np.linalg.pinv((design.T @ design).toarray(), hermitian=True)
    values = normal @ (design.T @ phi)
    residual = phi - design @ values
    covariance = normal * float(residual @ residual) / max(indices.size - values.size, 1)
    gap_values = slice(knots, knots + int(np.sum(open_gap)))

    def sum_weighted_gaps(knot_weights: Array) -> tuple[float, float]:
        """Weighted sum of half the angle gaps [rad] of both branches at the knots; its standard deviation."""
        row = knot_weights[open_gap]
        return float(row @ values[gap_values]), float(np.sqrt(row @ covariance[gap_values, gap_values] @ row))

    lengths = np.gradient(grid)
    lengths[[0, -1]] = 0.5 * (grid[1] - grid[0])
    drift = (float(values[-1]), float(np.sqrt(covariance[-1, -1]))) if has_drift else None
    driftless = phi - (drift[0] * time if drift else 0.0)
    backlash = (
        _fit_backlash(T, driftless, direction, grid[1] - grid[0]) if min_torque <= 0.0 <= max_torque else None
    )
    position = (T - 0.5 * (min_torque + max_torque)) / (
        0.5 * (max_torque - min_torque)
    )  # in the range of the torque, from -1 to 1
    central = np.abs(position) <= CENTRAL_OVER_WHOLE_TORQUE_RANGE
    friction = _fit_friction_torque(T[central], driftless[central], direction[central])
    loading = direction * position >= 0.0
    line = _average_samples_in_groups((T - friction * direction)[loading], driftless[loading])
    return Backbone(*line, len(branches), sum_weighted_gaps(-2.0 * lengths), backlash, drift)


def _fit_friction_torque(torque: Array, angle: Array, branch_direction: Array) -> float:
    """Fit the friction torque [N.m]: half the torque difference of both branches at equal angles.

    branch_direction : +1 (rising) or -1 (falling) for each sample (n)

    The friction torque is assumed constant over the samples.
    """
    knots = int(np.clip(angle.size // POINTS_PER_KNOT, 2, MAX_KNOTS))
    grid = np.linspace(np.min(angle), np.max(angle), knots)
    design = np.column_stack([_hat_functions(angle, grid).toarray(), branch_direction])
    return float(np.linalg.lstsq(design, torque)[0][-1])


def _fit_backlash(
    torque: Array, angle: Array, branch_direction: Array, torque_window: float
) -> tuple[float, float] | None:
    """Fit the angle [rad] between the branches at zero torque, and its standard deviation.

    Both branches are parabolas near zero torque: the gap between the curves, piecewise linear over the whole
    range, would be a mean over a range in which the stiffness changes.

    branch_direction : +1 (rising) or -1 (falling) for each sample (n)
    torque_window    : length [N.m] of the range around zero torque
    """
    near = np.abs(torque) <= 0.5 * torque_window
    T, s = torque[near] / torque_window, branch_direction[near]
    design = np.column_stack([np.ones_like(T), T, T**2, s, s * T, s * T**2])
    if T.size <= design.shape[1] or np.linalg.matrix_rank(design) < design.shape[1]:
        return None
    values = np.linalg.lstsq(design, angle[near])[0]
    residual = angle[near] - design @ values
    variance = float(residual @ residual) / (T.size - values.size)
    deviation = float(np.sqrt(variance * np.linalg.inv(design.T @ design)[3, 3]))
    return -2.0 * float(values[3]), 2.0 * deviation


def _hat_functions(torques: Array, knots: Array) -> scipy.sparse.csr_matrix:
    """Piecewise linear basis functions (n, k) at torques (n), for the knots `knots` (k)."""
    return scipy.sparse.csr_matrix(BSpline.design_matrix(torques, np.pad(knots, 1, mode="edge"), 1))


def _has_turning_point(
    branches: list[_Branch], end_torque: float, torque_range: float, end_index: int
) -> bool:
    """Whether a rising and a falling branch meet at an end of the torque range.

    end_torque, torque_range : torque of that end, and length of the range [N.m]
    end_index                : 0: lower end, -1: upper end
    """
    pairs = pairwise(branches)
    return any(
        branch.is_rising is not next_branch.is_rising
        and branch.sample_indices[-1] == next_branch.sample_indices[0]
        and branch.is_rising is (end_index == -1)
        and abs((branch.max_torque if branch.is_rising else branch.min_torque) - end_torque)
        < (1.0 - MIN_BRANCH_OVER_RECORD_TORQUE_RANGE) * torque_range
        for branch, next_branch in pairs
    )


def _is_drift_identifiable(design_matrix: scipy.sparse.csr_matrix) -> bool:
    """Whether the drift of the angle can be fitted: the last column does not depend on the other columns."""
    columns, last = design_matrix[:, :-1], design_matrix[:, -1].toarray()[:, 0]
    normal = np.linalg.pinv((columns.T @ columns).toarray(), hermitian=True)
    independent = last - columns @ (normal @ (columns.T @ last))
    return bool(np.linalg.norm(independent) > MIN_INDEPENDENT_DRIFT_FRACTION * np.linalg.norm(last))


def _average_samples_in_groups(torque: Array, angle: Array) -> tuple[Array, Array, Array]:
    """Average the samples of a record in groups of similar torque, at most MAX_BACKBONE_POINTS.

    Returns mean torque, mean angle and size (n) of the groups.
    """
    order = np.argsort(torque, kind="stable")
    starts = np.linspace(0, order.size, min(order.size, MAX_BACKBONE_POINTS) + 1).astype(int)[:-1]
    count = np.diff(np.append(starts, order.size)).astype(float)
    sums = (np.add.reduceat(column[order], starts) for column in (torque, angle))
    T, phi = (total / count for total in sums)
    return T, phi, count


def _check_monotonic_backbone(backbone: Backbone) -> Backbone:
    """Return a backbone; ValueError if its angle falls between neighbouring tenths of the torque range."""
    edges = np.linspace(backbone.torque[0], backbone.torque[-1], MONOTONICITY_CHECK_INTERVALS + 1)
    tenth = np.clip(
        np.searchsorted(edges, backbone.torque, side="right") - 1, 0, MONOTONICITY_CHECK_INTERVALS - 1
    )
    nonempty = [k for k in range(MONOTONICITY_CHECK_INTERVALS) if np.any(tenth == k)]
    means = np.array(
        [np.average(backbone.angle[tenth == k], weights=backbone.sample_counts[tenth == k]) for k in nonempty]
    )
    if np.all(np.diff(means) < 0.0):
        raise ValueError("the angle decreases as the torque increases; reverse the sign of one column")
    if np.any(falling := np.diff(means) <= 0.0):
        k = nonempty[int(np.argmax(falling))]
        raise ValueError(
            f"the mid-line of the angle does not rise with the torque between {edges[k]:.4g} and "
            f"{edges[min(k + 2, MONOTONICITY_CHECK_INTERVALS)]:.4g} N.m; expected one loop or curve of "
            "a spring"
        )
    return backbone
