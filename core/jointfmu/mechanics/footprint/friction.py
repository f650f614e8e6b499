"""Few patches that carry the friction of a bolted contact as all its nodes do, whatever its law.

Under loads that stay, a node whose approach is delta carries p(delta) - p(delta - v) against a shift, v in
units of mu/kappa (Jaeger 1995, Ciavarella 1998). A turn about the normal has the distance from its pole as a
factor, which is no polynomial, and a tilt moves the pressure about: as many nodes with other shares as there
is room for keep few of these sums. So each patch stands for the nodes around it, at the centre of their
friction, with its sliders on a circle of nearly their radius of gyration: near the pole of a turn, where its
parts pull all ways, a patch has little force and a torque. Its place, share and pressures are then fitted to
the friction of rigid motions of the tilted contact under laws p ~ delta^N, and to gross slip about poles that
are pressed. What `few_points` keeps to round-off patches keep, too. The fit is one of rounded numbers
(`reproducible`), so that it ends in one place on every processor. benchmarks/patch_reduction.py prints how
far friction is from that of all nodes.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...quantity import Array
from .elimination import changes, solved
from .patches import balanced, few_points, largest_moment
from .reproducible import cleared, length, over, powers, ranks, root, rounded, squared, to_digits, to_power
from .shape import FrictionPatches, PressureShape

POWERS = (4.0, 8.0, 8.0, 16.0)
"""Powers N of p ~ delta^N [1], of two: 1.5 of Hertz, 7 of the default law, 12 of rough surfaces."""
CASES, POLES = 240, 200
"""States of the joint and motions from rest whose friction is fitted, and more in gross slip about a pole."""
UNTILTED = 0.4
"""Part of the former without displacement and tilt [1]."""
APART, TILTED = 0.1, 0.2
"""Largest displacement and tilt at the edge [1], over the approach of the node that is pressed most."""
MOST_MOMENT = 2.5
"""Largest moment [1], over that at which nodes are open that carried a small part of the force."""
LEAST_WAY, MOST_WAY = 0.05, 3.0
"""Shortest and longest motion [1], over that at which a node at the radius of gyration carries all but the
part STUCK of its friction."""
STUCK = 2.0**-13
STEPS = 50
"""Steps of Levenberg and Marquardt's method."""
FIRST_DAMPING, LEAST_DAMPING = 1e-2, 1e-6
"""Damping over the diagonal of the equations [1]."""
LESS, MORE = 0.2, 5.0
"""Factors of it after a step that is better and one that is not [1]."""
LARGEST_STEP = 0.5
"""Most that a share, place or pressure changes in a step [1], over its size."""
LEAST_DIAGONAL = 1e-9
"""Of the equations of the steps, over the largest [1]."""
HOLDS = 400.0
"""Weight of what is exact beside that of a case [1]."""
DIFFERENCE = 1e-6
"""Change of a place or pressure over its size [1] by which derivatives are found."""
AT_ONCE = 2000
"""Nodes whose friction is summed up at once [1]."""
BESIDE, FAR = 0.06, 1e3
"""How far these poles are beside a pressed node, over the radius of gyration [1]; length of their motion."""
TILTED_POLES = 8
"""One of so many is that of a tilted contact, the others are of one without moment."""
POLE_WEIGHT, TORQUE_WEIGHT, SHIFT_WEIGHT = 12.0, 5.0, 4.0
"""Weights of the forces about them, of the torques, and of shifts alone, beside those of other cases [1]."""
ON_CIRCLE = 4
"""How many places on the circle of a patch stand for its sliders."""
LESS_SPREAD = 0.9
"""Radius of this circle over that of gyration of the friction that a patch stands for [1]: a disc pulls about
a pole inside it as a smaller ring does."""
AT_REST, ROUNDS = 0.1, 5
"""Pressure over the mean one [1] that counts beside a node's own where nodes are divided among the patches,
and how often they are."""
TINY = float(np.finfo(float).tiny)
_RATIOS = powers(1.0 / 1.0969815577985598, 7)
"""An even sequence in seven dimensions: powers of the root of x^8 = x + 1."""
CIRCLE = to_digits(np.exp(2j * np.pi * (np.arange(ON_CIRCLE) + 0.25) / ON_CIRCLE).view(float)).reshape(-1, 2)
"""These places on a circle of radius 1."""


def friction_patches(shape: PressureShape, count: int, begin: PressureShape | None = None) -> FrictionPatches:
    """Patches for the friction, at most `count`, or the shape itself where it has no more nodes.

    begin : some points that stand for many nodes, of which the first patches are taken

    Kept to round-off: the sums of share, equal and tilt, their first moments, the second moments of share.

    Raises ValueError if count is too small to keep the sums.
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
    """1 or -1 (m): every second patch in the order of forces (m) has its circle turned by half, so that what
    one's sliders miss, who slip at different shifts, another's make good."""
    return np.where(ranks(force) % 2 == 0, 1.0, -1.0)


def _divided(shape: PressureShape, places: Array) -> FrictionPatches:
    """Nodes divided among patches that begin at places (m, 2), each to the nearest one.

    A patch then takes the centre of their friction, again and again (Lloyd's method).
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
    thin = max(0.5 * (xx + yy - float(np.sqrt((xx - yy) ** 2 + 4.0 * xy * xy))), 0.0)  # 0 of nodes on a line
    radius = np.minimum(LESS_SPREAD * np.sqrt(sums(weight * away) / whole), np.sqrt(thin))
    return FrictionPatches(
        area, places, sums(share * shape.equal) / area, sums(share * shape.tilt) / area, radius
    )


@dataclass(frozen=True, slots=True)
class _Motions:
    """Cases (m, 1) of a contact whose lengths are over its radius of gyration, pressures over the largest.

    power            : N of the law [1]
    moment           : factor of tilt [1]
    apart            : motion apart [1], over the largest approach
    about_x, about_y : tilts [1] that move the edge by these parts of the largest approach
    along            : (3, m, 1) unit vector of the shift along x and y and of the turn [1]
    way              : its length [1], in mu/kappa times the largest approach
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
        """Even over what a contact with nodes (6, n) up to |x|, |y| (2) can do: shifts, turns about its
        centre, and twice as many about places where it is pressed; and gross slip about POLES more."""
        number = np.arange(1, CASES + POLES + 1)
        unit = (0.5 + number[:, None] * _RATIOS) % 1.0
        moment, apart, about_x, about_y, place, angle = 2.0 * unit[:, :6].T - 1.0
        gross = number > CASES
        moves = np.where(gross, number % TILTED_POLES == 0, number > UNTILTED * CASES)
        moment = np.where(gross & ~moves, 0.0, moment)
        kind = np.where(gross, 2, np.minimum(number % 4, 2))
        along = 2.0 * np.abs(angle) - 1.0  # on a square that stands on its corner
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
        """Of points (6, n), per share: force along x and y, moment and loss of a loop (4 m, n), and the force
        (m, n) in gross slip."""
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
    """What the sums over points (6, n) of share, x, y, equal, tilt and radius should be.

    reach : (2) largest |x| and |y| [1]
    scale : (m) of the sums of friction [1]
    hold  : (12) of the sums that are exact [1]
    held  : (12) these
    sums  : (m + 12) all of them, scaled
    """

    motions: _Motions
    reach: Array
    scale: Array
    hold: Array
    held: Array
    sums: Array

    @classmethod
    def of(cls, nodes: Array, largest_moment: float) -> "_Aim":
        """Those over nodes (6, n)."""
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
        hold = np.divide(HOLDS, size, out=np.zeros_like(size), where=size > HOLDS * TINY)  # none of what is 0
        sums = np.concatenate([scale * friction, hold * held])
        return cls(motions, reach, scale, hold, held, sums)

    def values(self, points: Array) -> Array:
        """(m + 12, n) whose sums with the shares should be `sums`."""
        friction = self.motions.friction(points)[0] * self.scale[:, None]
        return np.concatenate([friction, _exact(points, self.reach) * self.hold[:, None]])

    def missed(self, points: Array) -> tuple[Array, Array]:
        """These, and how far (m + 12) their sums are off."""
        values = self.values(points)
        return values, over(values, points[0]) - self.sums


def _balanced(points: Array, reach: Array, sums: Array) -> Array:
    """Points (6, n) with the exact sums (12), by small changes of their shares, equal and tilt."""
    share, x, y, equal, tilt, radius = points
    place = _exact(points, reach)[:6]
    share = share + changes(share, place, sums[:6] - over(place, share))
    force, place = share * equal, place[:3]
    equal = equal + changes(force, place, sums[6:9] - over(place, force)) / share
    force = share * equal
    tilt = tilt + changes(force, place, sums[9:] - over(place, share * tilt)) / share
    return np.stack([share, x, y, equal, tilt, radius])


def _exact(points: Array, reach: Array) -> Array:
    """(12, n) the functions of points (6, n) whose sums are exact."""
    _, x, y, equal, tilt, radius = points
    each = balanced(x / reach[0], y / reach[1], equal, tilt)
    for place, over_reach in zip((3, 5), radius / reach[:, None], strict=True):  # x^2 and y^2
        each[place] += 0.5 * over_reach * over_reach
    return each


@dataclass(frozen=True, slots=True)
class _Around:
    """An aim, in linear terms of what points change by.

    miss     : (m) how far the sums are off
    size     : (5, n) of which the changes are parts
    square   : (5 n, 5 n) of the derivatives
    gradient : (5 n) of half the sum of miss^2
    """

    miss: Array
    size: Array
    square: Array
    gradient: Array

    @classmethod
    def of(cls, points: Array, aim: _Aim, values: Array, miss: Array) -> "_Around":
        """At points (6, n), whose radii stay, with their values and what these miss of the aim."""
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
        """Change (6, n) of the points."""
        own = np.diag(self.square)
        diagonal = damping * (own + LEAST_DIAGONAL * np.max(own))
        parts = solved(self.square + np.diag(diagonal), -self.gradient)
        parts = np.clip(parts, -LARGEST_STEP, LARGEST_STEP).reshape(self.size.shape)
        return np.concatenate([self.size * parts, np.zeros_like(self.size[:1])])


def _moved(points: Array, aim: _Aim) -> Array:
    """Points (6, n) after STEPS steps of Levenberg and Marquardt's method."""
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
