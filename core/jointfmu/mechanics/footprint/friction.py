"""Reduction of the friction of a bolted contact from all nodes to few patches, for any interface law.

At constant load the traction of a node with the approach delta is p(delta) - p(delta - v), with the
displacement v in units of mu/kappa, kappa = K_T/K_N (Jaeger 1995, Ciavarella 1998). Sums of such tractions
over nodes cannot be kept by a few nodes with other shares: in a rotation about the normal the distance from
the pole is no polynomial of the position, and a tilt changes the pressure.

So each patch represents the nodes around it. Its position is the centre of their friction; its sliders lie on
a circle with nearly their radius of gyration. Near the pole of a rotation, where its parts slide in different
directions, a patch then has little force and a torque. Position, share and pressures of the patches are
fitted: to the friction of rigid motions of the tilted contact for laws p ~ delta^N, and to gross slip about
poles at loaded nodes. The sums that `reduce_points` keeps to round-off are kept here too.

The fit uses rounded numbers (`reproducible`), so its result is the same on every processor.
benchmarks/patch_reduction.py prints the deviation of the friction from that of all nodes.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...quantity import Array
from .elimination import changes, solved
from .patches import balanced, few_points, largest_moment
from .reproducible import cleared, length, over, powers, ranks, root, rounded, squared, to_digits, to_power
from .shape import FrictionPatches, PressureShape

POWERS = (4.0, 8.0, 8.0, 16.0)
"""Exponents N of the laws p ~ delta^N [1], powers of 2; real laws: Hertz 1.5, default law 7, roughness 12."""
CASES, POLES = 240, 200
"""Number of fitted cases [1]: partial slip from the virgin state, and gross slip about a pole."""
UNTILTED = 0.4
"""Share of the cases of partial slip without normal displacement and tilt [1]."""
APART, TILTED = 0.1, 0.2
"""Largest normal displacement, and largest opening by tilt at the edge, over the largest approach [1]."""
MOST_MOMENT = 2.5
"""Largest moment over that of `largest_moment` [1]."""
LEAST_WAY, MOST_WAY = 0.05, 3.0
"""Shortest and longest motion [1], over the motion at which a node at the radius of gyration has mobilised
all but STUCK_SHARE of its friction."""
STUCK = 2.0**-13
"""Share of the friction that is not yet mobilised [1], for the scale of motions."""
STEPS = 50
"""Iterations of the Levenberg-Marquardt method [1]."""
FIRST_DAMPING, LEAST_DAMPING = 1e-2, 1e-6
"""Initial and smallest damping, over the diagonal of the normal equations [1]."""
LESS, MORE = 0.2, 5.0
"""Factors on the damping after a successful and after a rejected step [1]."""
LARGEST_STEP = 0.5
"""Largest relative change of a share, position or pressure in one step [1]."""
LEAST_DIAGONAL = 1e-9
"""Smallest diagonal of the normal equations used for damping, over the largest [1]."""
HOLDS = 400.0
"""Weight of an exact sum over the weight of a case [1]."""
DIFFERENCE = 1e-6
"""Relative perturbation of a position or pressure for finite differences [1]."""
AT_ONCE = 2000
"""Number of nodes whose friction is evaluated at once [1]."""
BESIDE, FAR = 0.06, 1e3
"""Largest distance of a pole of gross slip from a loaded node, over the radius of gyration [1]; length of the
motion in gross slip [1]."""
TILTED_POLES = 8
"""One of this number of cases of gross slip [1] has a tilted contact; the others have no moment."""
POLE_WEIGHT, TORQUE_WEIGHT, SHIFT_WEIGHT = 12.0, 5.0, 4.0
"""Weights [1]: forces in gross slip; torques in gross slip; losses in gross slip and all values of
translations and of rotations about the centre. All other values have the weight 1."""
ON_CIRCLE = 4
"""Number of points on the circle of a patch that represent its sliders in the fit [1]."""
LESS_SPREAD = 0.9
"""Radius of the circle over the radius of gyration of the friction of a patch [1]: in a rotation about a pole
inside it, a disc acts like a smaller ring."""
AT_REST, ROUNDS = 0.1, 5
"""Pressure over mean pressure [1] that is added to that of each node for the division among patches, and
number of iterations of the division [1]."""
TINY = float(np.finfo(float).tiny)
_RATIOS = powers(1.0 / 1.0969815577985598, 7)
"""Increments of a low-discrepancy sequence in seven dimensions [1]: powers of the root of x^8 = x + 1."""
CIRCLE = to_digits(np.exp(2j * np.pi * (np.arange(ON_CIRCLE) + 0.25) / ON_CIRCLE).view(float)).reshape(-1, 2)
"""Points (CIRCLE_POINT_COUNT, 2) [1] on the unit circle that represent the sliders of a patch."""


def friction_patches(shape: PressureShape, count: int, begin: PressureShape | None = None) -> FrictionPatches:
    """Reduce the friction of a contact to at most `count` patches; one per node if it has no more nodes.

    start_points : distribution from which the initial patches are selected; None: `shape`

    Kept to round-off: the sums and first moments of share, preload_shape and moment_shape (weighted by
    share), and the second moments of share.

    Raises ValueError if count is too small to keep these sums.
    """
    if shape.share.size <= count:
        return shape.as_patches()
    rough = rounded(shape)
    gyration = float(np.sqrt(np.add.reduce(rough.share * np.add.reduce(rough.position**2, axis=1))))
    highest, steep = float(np.max(rough.equal)), max(float(np.max(np.abs(rough.tilt))), TINY)
    unit = np.array([1.0, gyration, gyration, highest, steep, gyration])[:, None]
    few = few_points(rough if begin is None else rounded(begin), count)
    first = _divided(rough, few.position)
    nodes, there, points = (
        np.stack([each.share, *each.position.T, each.equal, each.tilt, each.radius]) / unit
        for each in (rough.as_patches(), shape.as_patches(), first)
    )
    aim = _Aim.of(nodes, MOST_MOMENT * largest_moment(rough) * steep / highest)
    moved = _balanced(_moved(points, aim), aim.reach, over(_exact(there, aim.reach), there[0]))
    share, x, y, equal, tilt, radius = unit * moved
    few = cleared(PressureShape(share, np.column_stack([x, y]), equal, tilt))
    return replace(few.as_patches(), radius=radius * _opposite(share * equal * radius))


def _opposite(force: Array) -> Array:
    """Signs (m) [1] of the circle radii: negative for every second patch in descending order of forces (m).

    Their circles are turned by 180 degrees, so that errors of stepwise slip cancel between patches.
    """
    return np.where(ranks(force) % 2 == 0, 1.0, -1.0)


def _divided(shape: PressureShape, places: Array) -> FrictionPatches:
    """Divide the nodes among m patches by Lloyd's method.

    Each node belongs to the nearest patch. Each patch then moves to the centre of the friction of its nodes;
    this is repeated DIVISION_ITERATIONS times.

    centres : (m, 2) initial positions of the patches
    """
    share, (x, y) = shape.share, shape.position.T
    weight, count = share * (shape.equal + AT_REST), len(places)

    def sums(values: Array) -> Array:
        return np.asarray(np.bincount(nearest, values, count))

    for _ in range(ROUNDS):
        square = (x - places[:, :1]) ** 2 + (y - places[:, 1:]) ** 2
        nearest = np.argmin(square, axis=0)
        whole = np.maximum(sums(weight), TINY)
        places = np.column_stack([sums(weight * x) / whole, sums(weight * y) / whole])
    away = (x - places[nearest, 0]) ** 2 + (y - places[nearest, 1]) ** 2
    area = np.maximum(sums(share), TINY)
    xx, xy, yy = (float(np.add.reduce(share * each)) for each in (x * x, x * y, y * y))
    thin = max(0.5 * (xx + yy - float(np.sqrt((xx - yy) ** 2 + 4.0 * xy * xy))), 0.0)  # 0 for nodes on a line
    radius = np.minimum(LESS_SPREAD * np.sqrt(sums(weight * away) / whole), np.sqrt(thin))
    return FrictionPatches(
        area, places, sums(share * shape.equal) / area, sums(share * shape.tilt) / area, radius
    )


@dataclass(frozen=True, slots=True)
class _Motions:
    """Cases (m, 1) of normal loading and tangential motion whose friction is fitted.

    Lengths are divided by the radius of gyration of the contact, pressures by the largest one.

    power            : exponent N [1] of the law p ~ delta^N
    moment           : factor [1] on the pressure by a moment
    opening          : normal displacement [1], over the largest approach
    tilt_x, tilt_y   : tilts [1] about x and y, as opening per length, over the largest approach
    direction        : (3, m, 1) unit vector of the motion: translation along x and y, rotation [1]
    distance         : length of the motion [1], in units of mu/kappa times the largest approach
    """

    power: Array
    moment: Array
    apart: Array
    about_x: Array
    about_y: Array
    along: Array
    way: Array

    @classmethod
    def of(cls, nodes: Array, largest_moment: float, reach: Array) -> "_Motions":
        """Sample the cases evenly (low-discrepancy sequence) for a contact with nodes (6, n).

        Of the SLIP_CASES a quarter are translations, a quarter rotations about the centre, and
        half rotations about loaded nodes. GROSS_SLIP_CASES more are gross slip about poles near loaded nodes.

        largest_moment : [1] largest factor on the pressure by a moment
        extent         : (2) [1] largest |x| and |y|
        """
        number = np.arange(1, CASES + POLES + 1)
        unit = (0.5 + number[:, None] * _RATIOS) % 1.0
        moment, apart, about_x, about_y, place, angle = 2.0 * unit[:, :6].T - 1.0
        gross = number > CASES
        moves = np.where(gross, number % TILTED_POLES == 0, number > UNTILTED * CASES)
        moment = np.where(gross & ~moves, 0.0, moment)
        kind = np.where(gross, 2, np.minimum(number % 4, 2))
        along = 2.0 * np.abs(angle) - 1.0  # on the square |along| + |across| = 1
        across = np.sign(angle) * (1.0 - np.abs(along))
        force, nothing, one = np.add.accumulate(nodes[0] * nodes[3]), 0.0 * along, np.ones_like(along)
        _, x, y, *_ = nodes[:, np.searchsorted(force, 0.5 * (1.0 + place) * force[-1])]
        x, y = x + gross * BESIDE * angle, y + gross * BESIDE * (2.0 * unit[:, 6] - 1.0)
        shift_or_turn = ((along, nothing, y), (across, nothing, -x), (nothing, one, one))
        motion = np.stack([np.choose(kind, each) for each in shift_or_turn])
        motion /= np.sqrt(np.add.reduce(motion * motion, axis=0))
        power = np.choose(number % len(POWERS), POWERS)
        way = LEAST_WAY + (MOST_WAY - LEAST_WAY) * unit[:, 6] ** 2
        columns = (
            power,
            largest_moment * moment,
            APART * apart * moves,
            TILTED / reach[1] * about_x * moves,
            TILTED / reach[0] * about_y * moves,
            motion,
            np.where(gross, FAR, way * (1.0 - root(np.full((number.size, 1), STUCK), power[:, None])[:, 0])),
        )
        return cls(*(each[..., None] for each in columns))

    def friction(self, points: Array) -> tuple[Array, Array]:
        """Friction per share of points (6, n) in all m cases.

        Returns force along x and y, moment about z and loss of a cycle (4 m, n) [1], and the scale (m, n)
        [1]: friction limit times displacement per length of the motion.
        """
        _, x, y, equal, tilt, radius = points
        start = root(np.maximum(equal + self.moment * tilt, 0.0), self.power)
        now = np.maximum(start - (self.apart + self.about_x * y - self.about_y * x), 0.0)
        most, whole, turned = to_power(now, self.power), np.zeros((4, *now.shape)), np.zeros(now.shape)
        places, stored = CIRCLE if np.any(radius) else CIRCLE[:1], now * most
        for along, across in places:
            there_x, there_y = x + along * radius, y + across * radius
            u, v = self.along[0] - self.along[2] * there_y, self.along[1] + self.along[2] * there_x
            size = np.sqrt(u * u + v * v)
            way = self.way * size
            then = np.maximum(now - way, 0.0)
            rest = to_power(then, self.power)
            force, work = most - rest, most * way - (stored - then * rest) / (self.power + 1.0)
            part = force / np.maximum(size, TINY)
            each = part * u, part * v, part * (there_x * v - there_y * u), 8.0 * (work - 0.5 * force * way)
            for total, one in zip(whole, each, strict=True):
                total += one / len(places)
            turned += most * size / len(places)
        return whole.reshape(-1, now.shape[1]), turned


@dataclass(frozen=True, slots=True)
class _Aim:
    """Target of the fit: sums over all nodes. Points (6, n) are share, x, y, both pressure shapes, radius.

    cases       : cases whose friction is fitted
    extent      : (2) [1] largest |x| and |y|
    scale       : (m) [1] weights of the sums of friction
    exact_scale : (12) [1] weights of the sums that must be exact
    exact_sums  : (12) [1] sums that must be exact
    sums        : (m + 12) [1] all sums, weighted
    """

    motions: _Motions
    reach: Array
    scale: Array
    hold: Array
    held: Array
    sums: Array

    @classmethod
    def of(cls, nodes: Array, largest_moment: float) -> "_Aim":
        """Compute the target sums of nodes (6, n)."""
        reach = np.maximum(np.max(np.abs(nodes[1:3]), axis=1), TINY)
        motions, share = _Motions.of(nodes, largest_moment, reach), nodes[0]
        friction, gross = np.zeros(4 * (CASES + POLES)), np.zeros(CASES + POLES)
        for first in range(0, share.size, AT_ONCE):
            some = nodes[:, first : first + AT_ONCE]
            each, most = motions.friction(some)
            friction, gross = friction + over(each, some[0]), gross + over(most, some[0])
        scale = 1.0 / np.maximum(np.concatenate([gross, gross, gross, friction[3 * gross.size :]]), TINY)
        shift_x, shift_y, turn = motions.along[:, :, 0]
        centred = (turn == 0.0) | ((shift_x == 0.0) & (shift_y == 0.0))
        weight = np.tile(np.where(centred, SHIFT_WEIGHT, 1.0), (4, 1))
        weight[:, CASES:] = np.array([POLE_WEIGHT, POLE_WEIGHT, TORQUE_WEIGHT, SHIFT_WEIGHT])[:, None]
        scale *= weight.ravel()
        exact = _exact(nodes, reach)
        held, size = over(exact, share), over(np.abs(exact), share)
        hold = np.divide(HOLDS, size, out=np.zeros_like(size), where=size > HOLDS * TINY)  # 0 for sums of 0
        sums = np.concatenate([scale * friction, hold * held])
        return cls(motions, reach, scale, hold, held, sums)

    def values(self, points: Array) -> Array:
        """Functions (m + 12, n) [1] of points (6, n); their sums, weighted by share, are to equal `sums`."""
        friction = self.motions.friction(points)[0] * self.scale[:, None]
        return np.concatenate([friction, _exact(points, self.reach) * self.hold[:, None]])

    def missed(self, points: Array) -> tuple[Array, Array]:
        """Weighted functions (m + 12, n) of points (6, n), and the residual (m + 12) of their sums."""
        values = self.values(points)
        return values, over(values, points[0]) - self.sums


def _balanced(points: Array, reach: Array, sums: Array) -> Array:
    """Correct shares and pressure shapes of points (6, n) slightly, so that they have the exact sums (12)."""
    share, x, y, equal, tilt, radius = points
    place = _exact(points, reach)[:6]
    share = share + changes(share, place, sums[:6] - over(place, share))
    force, place = share * equal, place[:3]
    equal = equal + changes(force, place, sums[6:9] - over(place, force)) / share
    force = share * equal
    tilt = tilt + changes(force, place, sums[9:] - over(place, share * tilt)) / share
    return np.stack([share, x, y, equal, tilt, radius])


def _exact(points: Array, reach: Array) -> Array:
    """Functions (12, n) of points (6, n) whose sums, weighted by share, must be exact."""
    _, x, y, equal, tilt, radius = points
    each = balanced(x / reach[0], y / reach[1], equal, tilt)
    for place, over_reach in zip((3, 5), radius / reach[:, None], strict=True):  # x^2 and y^2
        each[place] += 0.5 * over_reach * over_reach
    return each


@dataclass(frozen=True, slots=True)
class _Around:
    """Linearised least-squares problem: residual of the sums as a function of relative changes of the points.

    residual : (m) residual of the sums [1]
    scale    : (5, n) sizes [1] to which the changes are relative
    normal_matrix : (5 n, 5 n) J^T J [1] of the Jacobian J
    gradient : (5 n) gradient [1] of half the sum of squared residuals
    """

    miss: Array
    size: Array
    square: Array
    gradient: Array

    @classmethod
    def of(cls, points: Array, aim: _Aim, values: Array, miss: Array) -> "_Around":
        """Linearise at points (6, n) with constant radii.

        values, residual : result of `_TargetSums.residual` at these points
        """
        share, *_, equal, _, _ = points
        one = np.ones_like(share)
        size = np.stack([share, *np.outer(aim.reach, one), equal, equal])
        slopes = [values * share]
        for place in range(1, 5):
            moved = points.copy()
            moved[place] += DIFFERENCE * size[place]
            slopes.append((aim.values(moved) - values) / DIFFERENCE * share)
        slope = np.concatenate(slopes, axis=1).T.copy()
        return cls(miss, size, squared(slope), over(slope, miss))

    def step(self, damping: float) -> Array:
        """Levenberg-Marquardt step: change (6, n) of the points for a damping [1]."""
        own = np.diag(self.square)
        diagonal = damping * (own + LEAST_DIAGONAL * np.max(own))
        parts = solved(self.square + np.diag(diagonal), -self.gradient)
        parts = np.clip(parts, -LARGEST_STEP, LARGEST_STEP).reshape(self.size.shape)
        return np.concatenate([self.size * parts, np.zeros_like(self.size[:1])])


def _moved(points: Array, aim: _Aim) -> Array:
    """Fit points (6, n) by the Levenberg-Marquardt method with MAX_ITERATIONS iterations."""
    here, damping = _Around.of(points, aim, *aim.missed(points)), FIRST_DAMPING
    for _ in range(STEPS):
        trial = _balanced(points + here.step(damping), aim.reach, aim.held)
        values, miss = aim.missed(trial)
        allowed = np.all(trial[0] > 0.0) and np.all(trial[3] >= 0.0)
        if allowed and length(miss) < length(here.miss):
            points, here = trial, _Around.of(trial, aim, values, miss)
            damping = max(LESS * damping, LEAST_DAMPING)
        else:
            damping *= MORE
    return points
