"""Reduction of the friction of a bolted contact from all nodes to few patches, for any interface law.

At constant load the traction of a node with the approach delta is p(delta) - p(delta - v), with the
displacement v in units of mu/kappa, kappa = K_T/K_N (Jaeger 1995, Ciavarella 1998). Sums of such tractions
over nodes cannot be kept by a few nodes with other shares: in a rotation about the normal the distance from
the pole is not a polynomial of the position, and a tilt changes the pressure.

So each patch represents the nodes around it. Its position is the centre of their friction; its sliders lie on
a circle with nearly their radius of gyration. Near the pole of a rotation, where its parts slide in different
directions, a patch then has little force and a torque. Position, share and pressures of the patches are
fitted: to the friction of rigid motions of the tilted contact for laws p ~ delta^N, and to gross slip about
poles at loaded nodes. The sums that `reduce_points` keeps to round-off are kept here too.

The fit uses rounded numbers (`reproducible`), so its result is the same on every processor.
studies/fields_explanation.py prints the deviation of the friction from friction at all nodes.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...quantity import Array
from .distribution import FrictionPatches, PressureDistribution
from .elimination import find_smallest_weight_changes, solve_linear_system
from .point_reduction import largest_moment_factor, preserved_sum_functions, reduce_points
from .reproducible import (
    clear_round_off,
    euclidean_norm,
    gram_matrix,
    raise_to_power_of_two,
    rank_descending,
    round_distribution,
    round_to_digits,
    successive_powers,
    take_power_of_two_root,
    weighted_sums,
)

PRESSURE_LAW_EXPONENTS = (4.0, 8.0, 8.0, 16.0)
"""Exponents N of the laws p ~ delta^N [1], powers of 2; real laws: Hertz 1.5, default law 7, roughness 12."""
SLIP_CASE_COUNT, GROSS_SLIP_CASE_COUNT = 240, 200
"""Number of fitted cases [1]: partial slip from the virgin state, and gross slip about a pole."""
UNTILTED_SLIP_CASE_SHARE = 0.4
"""Share of the cases of partial slip without normal displacement and tilt [1]."""
MAX_SAMPLED_OPENING_OVER_APPROACH, MAX_SAMPLED_TILT_OPENING_OVER_APPROACH = 0.1, 0.2
"""Largest normal displacement, and largest opening by tilt at the edge, over the largest approach [1]."""
MAX_MOMENT_OVER_OPENING_MOMENT = 2.5
"""Largest moment of the cases, over the moment that opens part of the contact [1].

The latter is computed by `largest_moment_factor`."""
MIN_MOTION_OVER_SLIP_DISPLACEMENT, MAX_MOTION_OVER_SLIP_DISPLACEMENT = 0.05, 3.0
"""Shortest and longest motion [1], over the motion at which a node at the radius of gyration has mobilised
all but UNMOBILISED_FRICTION_SHARE of its friction."""
UNMOBILISED_FRICTION_SHARE = 2.0**-13
"""Share of the friction that is not yet mobilised [1], at the motion to which lengths are relative."""
LEVENBERG_MARQUARDT_ITERATIONS = 50
"""Iterations of the Levenberg-Marquardt method [1]."""
INITIAL_MARQUARDT_DAMPING, MIN_MARQUARDT_DAMPING = 1e-2, 1e-6
"""Initial and smallest damping, over the diagonal of the normal equations [1]."""
MARQUARDT_DAMPING_DECREASE, MARQUARDT_DAMPING_INCREASE = 0.2, 5.0
"""Factors on the damping after a successful and after a rejected step [1]."""
MAX_RELATIVE_FIT_STEP = 0.5
"""Largest relative change of a share, position or pressure in one step [1]."""
MIN_OVER_MAX_NORMAL_MATRIX_DIAGONAL = 1e-9
"""Smallest diagonal entry of the normal equations used for damping, over the largest entry [1]."""
PRESERVED_SUM_WEIGHT = 400.0
"""Weight of a sum that must be kept exactly, over the weight of a case of friction [1]."""
RELATIVE_FINITE_DIFFERENCE_STEP = 1e-6
"""Relative perturbation of a position or pressure for finite differences [1]."""
NODES_PER_BATCH = 2000
"""Number of nodes whose friction is evaluated at once [1]."""
MAX_ROTATION_POLE_OFFSET, GROSS_SLIP_MOTION_LENGTH = 0.06, 1e3
"""Largest distance of a pole of gross slip from a loaded node, over the radius of gyration [1]; length of the
motion in gross slip [1]."""
GROSS_SLIP_CASES_PER_TILTED_CASE = 8
"""One of this number of cases of gross slip [1] has a tilted contact; the others have no moment."""
GROSS_SLIP_FORCE_WEIGHT, GROSS_SLIP_TORQUE_WEIGHT, LOSS_AND_TRANSLATION_WEIGHT = 12.0, 5.0, 4.0
"""Weights [1]: forces in gross slip; torques in gross slip; losses in gross slip and all values of
translations and of rotations about the centre. All other values have the weight 1."""
SLIDER_CIRCLE_POINT_COUNT = 4
"""Number of points on the circle of a patch that represent its sliders in the fit [1]."""
SLIDER_CIRCLE_OVER_GYRATION_RADIUS = 0.9
"""Radius of the circle over the radius of gyration of the friction of a patch [1]: in a rotation about a pole
inside it, a disc acts like a smaller ring."""
PRESSURE_OFFSET_FOR_NODE_DIVISION, LLOYD_ITERATIONS = 0.1, 5
"""Pressure over mean pressure [1] that is added to the pressure of each node for the division among patches,
and number of iterations of the division [1]."""
SMALLEST_FLOAT = float(np.finfo(float).tiny)
"""Smallest normal float: replaces 0 in divisions."""
_LOW_DISCREPANCY_INCREMENTS = successive_powers(1.0 / 1.0969815577985598, 7)
"""Increments of a low-discrepancy sequence in seven dimensions [1]: powers of 1/x with x^8 = x + 1."""
SLIDER_CIRCLE_POINTS = round_to_digits(
    np.exp(2j * np.pi * (np.arange(SLIDER_CIRCLE_POINT_COUNT) + 0.25) / SLIDER_CIRCLE_POINT_COUNT).view(float)
).reshape(-1, 2)
"""Points (SLIDER_CIRCLE_POINT_COUNT, 2) [1] on the unit circle that represent the sliders of a patch."""


def reduce_patches(
    pressure_distribution: PressureDistribution,
    max_patch_count: int,
    start_points: PressureDistribution | None = None,
) -> FrictionPatches:
    """Reduce the friction of a contact to few patches; one patch per node if it has no more nodes.

    start_points : distribution from which the initial patches are selected; None: `pressure_distribution`

    The patches keep to round-off: the sums and first moments of share, preload_pressure_ratio and
    moment_pressure_ratio (weighted by share), and the second moments of share.

    Raises ValueError if max_patch_count is too small to keep these sums.
    """
    if pressure_distribution.area_share.size <= max_patch_count:
        return pressure_distribution.make_friction_patches()
    rough = round_distribution(pressure_distribution)
    gyration = float(np.sqrt(np.add.reduce(rough.area_share * np.add.reduce(rough.position**2, axis=1))))
    highest = float(np.max(rough.preload_pressure_ratio))
    steep = max(float(np.max(np.abs(rough.moment_pressure_ratio))), SMALLEST_FLOAT)
    unit = np.array([1.0, gyration, gyration, highest, steep, gyration])[:, None]
    few = reduce_points(rough if start_points is None else round_distribution(start_points), max_patch_count)
    first = _divide_nodes_among_patches(rough, few.position)
    nodes, there, points = (
        np.stack(
            [
                each.area_share,
                *each.position.T,
                each.preload_pressure_ratio,
                each.moment_pressure_ratio,
                each.slider_circle_radius,
            ]
        )
        / unit
        for each in (rough.make_friction_patches(), pressure_distribution.make_friction_patches(), first)
    )
    aim = _TargetSums.from_nodes(
        nodes, MAX_MOMENT_OVER_OPENING_MOMENT * largest_moment_factor(rough) * steep / highest
    )
    moved = _restore_preserved_sums(
        _fit_points(points, aim),
        aim.max_coordinates,
        weighted_sums(_scaled_preserved_functions(there, aim.max_coordinates), there[0]),
    )
    share, x, y, equal, tilt, radius = unit * moved
    few = clear_round_off(PressureDistribution(share, np.column_stack([x, y]), equal, tilt))
    return replace(
        few.make_friction_patches(), slider_circle_radius=radius * _radius_signs(share * equal * radius)
    )


def _radius_signs(patch_forces: Array) -> Array:
    """Signs (m) [1] of the radii of the slider circles of m patches: negative for every second patch.

    The order is that of descending forces (m). A negative sign turns the circle by 180 degrees, so that
    errors of stepwise slip cancel between patches.
    """
    return np.where(rank_descending(patch_forces) % 2 == 0, 1.0, -1.0)


def _divide_nodes_among_patches(
    pressure_distribution: PressureDistribution, patch_centres: Array
) -> FrictionPatches:
    """Divide the nodes among m patches by Lloyd's method.

    Each node belongs to the nearest patch. Each patch then moves to the centre of the friction of its nodes;
    this is repeated LLOYD_ITERATIONS times.

    patch_centres : (m, 2) initial positions of the patches
    """
    share, (x, y) = pressure_distribution.area_share, pressure_distribution.position.T
    weight, count = (
        share * (pressure_distribution.preload_pressure_ratio + PRESSURE_OFFSET_FOR_NODE_DIVISION),
        len(patch_centres),
    )

    def sum_over_nodes(node_values: Array) -> Array:
        """Sum values (n) of the nodes over the nodes of each patch."""
        return np.asarray(np.bincount(nearest, node_values, count))

    for _ in range(LLOYD_ITERATIONS):
        square = (x - patch_centres[:, :1]) ** 2 + (y - patch_centres[:, 1:]) ** 2
        nearest = np.argmin(square, axis=0)
        whole = np.maximum(sum_over_nodes(weight), SMALLEST_FLOAT)
        patch_centres = np.column_stack(
            [sum_over_nodes(weight * x) / whole, sum_over_nodes(weight * y) / whole]
        )
    away = (x - patch_centres[nearest, 0]) ** 2 + (y - patch_centres[nearest, 1]) ** 2
    area = np.maximum(sum_over_nodes(share), SMALLEST_FLOAT)
    xx, xy, yy = (float(np.add.reduce(share * each)) for each in (x * x, x * y, y * y))
    thin = max(0.5 * (xx + yy - float(np.sqrt((xx - yy) ** 2 + 4.0 * xy * xy))), 0.0)  # 0 for nodes on a line
    radius = np.minimum(
        SLIDER_CIRCLE_OVER_GYRATION_RADIUS * np.sqrt(sum_over_nodes(weight * away) / whole), np.sqrt(thin)
    )
    return FrictionPatches(
        area,
        patch_centres,
        sum_over_nodes(share * pressure_distribution.preload_pressure_ratio) / area,
        sum_over_nodes(share * pressure_distribution.moment_pressure_ratio) / area,
        radius,
    )


@dataclass(frozen=True, slots=True)
class _SlipCases:
    """Load cases (m, 1), normal and tangential, in which the patches are fitted to the friction of all nodes.

    Lengths are divided by the radius of gyration of the contact, pressures by the largest one.

    pressure_law_exponent : exponent N [1] of the law pressure ~ approach^N
    moment_factor         : factor [1] on the pressure by a moment
    normal_displacement   : normal displacement [1], divided by the largest approach
    tilt_x, tilt_y        : tilts [1] about x and y, as opening per length, divided by the largest approach
    motion_direction      : (3, m, 1) unit vector of the motion: translation along x and y, rotation [1]
    motion_length         : length of the motion [1], divided by mu/kappa times the largest approach, with
                            friction coefficient mu and stiffness ratio kappa = K_T/K_N
    """

    pressure_law_exponent: Array
    moment_factor: Array
    normal_displacement: Array
    tilt_x: Array
    tilt_y: Array
    motion_direction: Array
    motion_length: Array

    @classmethod
    def sample_cases(
        cls, contact_nodes: Array, largest_moment: float, max_coordinates: Array
    ) -> "_SlipCases":
        """Sample the cases evenly (low-discrepancy sequence) for a contact with nodes (6, n).

        Of the SLIP_CASE_COUNT a quarter are translations, a quarter rotations about the centre, and
        half rotations about loaded nodes. GROSS_SLIP_CASE_COUNT more are gross slip about poles near loaded
        nodes.

        largest_moment  : [1] largest factor on the pressure by a moment
        max_coordinates : (2) [1] largest |x| and |y|
        """
        number = np.arange(1, SLIP_CASE_COUNT + GROSS_SLIP_CASE_COUNT + 1)
        unit = (0.5 + number[:, None] * _LOW_DISCREPANCY_INCREMENTS) % 1.0
        moment, apart, about_x, about_y, place, angle = 2.0 * unit[:, :6].T - 1.0
        gross = number > SLIP_CASE_COUNT
        moves = np.where(
            gross,
            number % GROSS_SLIP_CASES_PER_TILTED_CASE == 0,
            number > UNTILTED_SLIP_CASE_SHARE * SLIP_CASE_COUNT,
        )
        moment = np.where(gross & ~moves, 0.0, moment)
        kind = np.where(gross, 2, np.minimum(number % 4, 2))
        along = 2.0 * np.abs(angle) - 1.0  # on the square |along| + |across| = 1
        across = np.sign(angle) * (1.0 - np.abs(along))
        force, nothing, one = (
            np.add.accumulate(contact_nodes[0] * contact_nodes[3]),
            0.0 * along,
            np.ones_like(along),
        )
        _, x, y, *_ = contact_nodes[:, np.searchsorted(force, 0.5 * (1.0 + place) * force[-1])]
        x, y = (
            x + gross * MAX_ROTATION_POLE_OFFSET * angle,
            y + gross * MAX_ROTATION_POLE_OFFSET * (2.0 * unit[:, 6] - 1.0),
        )
        shift_or_turn = ((along, nothing, y), (across, nothing, -x), (nothing, one, one))
        motion = np.stack([np.choose(kind, each) for each in shift_or_turn])
        motion /= np.sqrt(np.add.reduce(motion * motion, axis=0))
        power = np.choose(number % len(PRESSURE_LAW_EXPONENTS), PRESSURE_LAW_EXPONENTS)
        way = (
            MIN_MOTION_OVER_SLIP_DISPLACEMENT
            + (MAX_MOTION_OVER_SLIP_DISPLACEMENT - MIN_MOTION_OVER_SLIP_DISPLACEMENT) * unit[:, 6] ** 2
        )
        columns = (
            power,
            largest_moment * moment,
            MAX_SAMPLED_OPENING_OVER_APPROACH * apart * moves,
            MAX_SAMPLED_TILT_OPENING_OVER_APPROACH / max_coordinates[1] * about_x * moves,
            MAX_SAMPLED_TILT_OPENING_OVER_APPROACH / max_coordinates[0] * about_y * moves,
            motion,
            np.where(
                gross,
                GROSS_SLIP_MOTION_LENGTH,
                way
                * (
                    1.0
                    - take_power_of_two_root(
                        np.full((number.size, 1), UNMOBILISED_FRICTION_SHARE), power[:, None]
                    )[:, 0]
                ),
            ),
        )
        return cls(*(each[..., None] for each in columns))

    def evaluate_friction(self, fitted_points: Array) -> tuple[Array, Array]:
        """Friction per share of points (6, n) in all m cases.

        Returns force along x and y, moment about z and loss of a cycle (4 m, n) [1], and the scale (m, n)
        [1]: friction limit times displacement per length of the motion.
        """
        _, x, y, equal, tilt, radius = fitted_points
        start = take_power_of_two_root(
            np.maximum(equal + self.moment_factor * tilt, 0.0), self.pressure_law_exponent
        )
        now = np.maximum(start - (self.normal_displacement + self.tilt_x * y - self.tilt_y * x), 0.0)
        most = raise_to_power_of_two(now, self.pressure_law_exponent)
        whole = np.zeros((4, *now.shape))
        turned = np.zeros(now.shape)
        places, stored = SLIDER_CIRCLE_POINTS if np.any(radius) else SLIDER_CIRCLE_POINTS[:1], now * most
        for along, across in places:
            there_x, there_y = x + along * radius, y + across * radius
            u = self.motion_direction[0] - self.motion_direction[2] * there_y
            v = self.motion_direction[1] + self.motion_direction[2] * there_x
            size = np.sqrt(u * u + v * v)
            way = self.motion_length * size
            then = np.maximum(now - way, 0.0)
            rest = raise_to_power_of_two(then, self.pressure_law_exponent)
            force, work = (
                most - rest,
                most * way - (stored - then * rest) / (self.pressure_law_exponent + 1.0),
            )
            part = force / np.maximum(size, SMALLEST_FLOAT)
            each = part * u, part * v, part * (there_x * v - there_y * u), 8.0 * (work - 0.5 * force * way)
            for total, one in zip(whole, each, strict=True):
                total += one / len(places)
            turned += most * size / len(places)
        return whole.reshape(-1, now.shape[1]), turned


@dataclass(frozen=True, slots=True)
class _TargetSums:
    """Sums over all nodes of the contact that the fitted patches must reproduce: m of friction, 12 others.

    Nodes and patches are points (6, n): share, x, y, pressure ratios of preload and moment, circle radius.

    slip_cases            : load cases whose friction is fitted
    max_coordinates       : (2) [1] largest |x| and |y|
    friction_weights      : (m) [1] weights of the sums of friction
    preserved_sum_weights : (12) [1] weights of the preserved sums
    preserved_sums        : (12) [1] sums of `preserved_sum_functions`, kept to round-off
    target_sums           : (m + 12) [1] all sums, weighted
    """

    slip_cases: _SlipCases
    max_coordinates: Array
    friction_weights: Array
    preserved_sum_weights: Array
    preserved_sums: Array
    target_sums: Array

    @classmethod
    def from_nodes(cls, contact_nodes: Array, largest_moment: float) -> "_TargetSums":
        """Compute the sums that the patches must reproduce from the nodes (6, n) of the contact."""
        reach = np.maximum(np.max(np.abs(contact_nodes[1:3]), axis=1), SMALLEST_FLOAT)
        motions, share = _SlipCases.sample_cases(contact_nodes, largest_moment, reach), contact_nodes[0]
        friction = np.zeros(4 * (SLIP_CASE_COUNT + GROSS_SLIP_CASE_COUNT))
        gross = np.zeros(SLIP_CASE_COUNT + GROSS_SLIP_CASE_COUNT)
        for first in range(0, share.size, NODES_PER_BATCH):
            some = contact_nodes[:, first : first + NODES_PER_BATCH]
            each, most = motions.evaluate_friction(some)
            friction, gross = friction + weighted_sums(each, some[0]), gross + weighted_sums(most, some[0])
        scale = 1.0 / np.maximum(
            np.concatenate([gross, gross, gross, friction[3 * gross.size :]]), SMALLEST_FLOAT
        )
        shift_x, shift_y, turn = motions.motion_direction[:, :, 0]
        centred = (turn == 0.0) | ((shift_x == 0.0) & (shift_y == 0.0))
        weight = np.tile(np.where(centred, LOSS_AND_TRANSLATION_WEIGHT, 1.0), (4, 1))
        weight[:, SLIP_CASE_COUNT:] = np.array(
            [
                GROSS_SLIP_FORCE_WEIGHT,
                GROSS_SLIP_FORCE_WEIGHT,
                GROSS_SLIP_TORQUE_WEIGHT,
                LOSS_AND_TRANSLATION_WEIGHT,
            ]
        )[:, None]
        scale *= weight.ravel()
        exact = _scaled_preserved_functions(contact_nodes, reach)
        held, size = weighted_sums(exact, share), weighted_sums(np.abs(exact), share)
        hold = np.divide(
            PRESERVED_SUM_WEIGHT,
            size,
            out=np.zeros_like(size),
            where=size > PRESERVED_SUM_WEIGHT * SMALLEST_FLOAT,
        )  # 0 for sums of 0
        sums = np.concatenate([scale * friction, hold * held])
        return cls(motions, reach, scale, hold, held, sums)

    def evaluate_sum_functions(self, fitted_points: Array) -> Array:
        """Functions (m + 12, n) of points (6, n), whose share-weighted sums are fitted to `target_sums`."""
        friction = self.slip_cases.evaluate_friction(fitted_points)[0] * self.friction_weights[:, None]
        return np.concatenate(
            [
                friction,
                _scaled_preserved_functions(fitted_points, self.max_coordinates)
                * self.preserved_sum_weights[:, None],
            ]
        )

    def find_residual(self, fitted_points: Array) -> tuple[Array, Array]:
        """Weighted functions (m + 12, n) of points (6, n), and the residual (m + 12) of their sums."""
        values = self.evaluate_sum_functions(fitted_points)
        return values, weighted_sums(values, fitted_points[0]) - self.target_sums


def _restore_preserved_sums(fitted_points: Array, max_coordinates: Array, preserved_sums: Array) -> Array:
    """Correct shares and pressure ratios of points (6, n) slightly, so that they have the given 12 sums.

    The sums are those of `preserved_sum_functions`.
    """
    share, x, y, equal, tilt, radius = fitted_points
    place = _scaled_preserved_functions(fitted_points, max_coordinates)[:6]
    share = share + find_smallest_weight_changes(
        share, place, preserved_sums[:6] - weighted_sums(place, share)
    )
    force, place = share * equal, place[:3]
    equal = (
        equal
        + find_smallest_weight_changes(force, place, preserved_sums[6:9] - weighted_sums(place, force))
        / share
    )
    force = share * equal
    tilt = (
        tilt
        + find_smallest_weight_changes(force, place, preserved_sums[9:] - weighted_sums(place, share * tilt))
        / share
    )
    return np.stack([share, x, y, equal, tilt, radius])


def _scaled_preserved_functions(fitted_points: Array, max_coordinates: Array) -> Array:
    """Functions (12, n) of points (6, n) whose sums, weighted by share, are preserved; of the order of 1."""
    _, x, y, equal, tilt, radius = fitted_points
    each = preserved_sum_functions(x / max_coordinates[0], y / max_coordinates[1], equal, tilt)
    for place, over_reach in zip((3, 5), radius / max_coordinates[:, None], strict=True):  # x^2 and y^2
        each[place] += 0.5 * over_reach * over_reach
    return each


@dataclass(frozen=True, slots=True)
class _LinearisedFit:
    """Linearised least-squares problem: residual of the sums as a function of relative changes of n points.

    sum_residual : (m) residual of the m fitted sums [1]
    change_scale : (5, n) sizes [1] to which the changes are relative
    normal_matrix : (5 n, 5 n) J^T J [1] of the Jacobian J
    gradient : (5 n) gradient [1] of half the sum of squared residuals
    """

    sum_residual: Array
    change_scale: Array
    normal_matrix: Array
    gradient: Array

    @classmethod
    def linearise(
        cls, fitted_points: Array, fit_target: _TargetSums, function_values: Array, sum_residual: Array
    ) -> "_LinearisedFit":
        """Linearise the fit at points (6, n); the radii of the slider circles are constant.

        function_values, sum_residual : result of `_TargetSums.find_residual` at these points
        """
        share, *_, equal, _, _ = fitted_points
        one = np.ones_like(share)
        size = np.stack([share, *np.outer(fit_target.max_coordinates, one), equal, equal])
        slopes = [function_values * share]
        for place in range(1, 5):
            moved = fitted_points.copy()
            moved[place] += RELATIVE_FINITE_DIFFERENCE_STEP * size[place]
            slopes.append(
                (fit_target.evaluate_sum_functions(moved) - function_values)
                / RELATIVE_FINITE_DIFFERENCE_STEP
                * share
            )
        slope = np.concatenate(slopes, axis=1).T.copy()
        return cls(sum_residual, size, gram_matrix(slope), weighted_sums(slope, sum_residual))

    def solve_marquardt_step(self, marquardt_damping: float) -> Array:
        """Levenberg-Marquardt step: change (6, n) of the points for a damping [1]."""
        own = np.diag(self.normal_matrix)
        diagonal = marquardt_damping * (own + MIN_OVER_MAX_NORMAL_MATRIX_DIAGONAL * np.max(own))
        parts = solve_linear_system(self.normal_matrix + np.diag(diagonal), -self.gradient)
        parts = np.clip(parts, -MAX_RELATIVE_FIT_STEP, MAX_RELATIVE_FIT_STEP).reshape(self.change_scale.shape)
        return np.concatenate([self.change_scale * parts, np.zeros_like(self.change_scale[:1])])


def _fit_points(start_points: Array, fit_target: _TargetSums) -> Array:
    """Fit the numbers of n friction patches to target sums, by the Levenberg-Marquardt method.

    Returns the numbers (6, n) of the patches: share of the area, x and y [m], pressure ratio of the preload,
    pressure ratio of the moment, and radius [m] of the circle of sliders that replaces the patch in torsion.
    """
    here, damping = (
        _LinearisedFit.linearise(start_points, fit_target, *fit_target.find_residual(start_points)),
        INITIAL_MARQUARDT_DAMPING,
    )
    for _ in range(LEVENBERG_MARQUARDT_ITERATIONS):
        trial = _restore_preserved_sums(
            start_points + here.solve_marquardt_step(damping),
            fit_target.max_coordinates,
            fit_target.preserved_sums,
        )
        values, miss = fit_target.find_residual(trial)
        allowed = np.all(trial[0] > 0.0) and np.all(trial[3] >= 0.0)
        if allowed and euclidean_norm(miss) < euclidean_norm(here.sum_residual):
            start_points, here = trial, _LinearisedFit.linearise(trial, fit_target, values, miss)
            damping = max(MARQUARDT_DAMPING_DECREASE * damping, MIN_MARQUARDT_DAMPING)
        else:
            damping *= MARQUARDT_DAMPING_INCREASE
    return start_points
