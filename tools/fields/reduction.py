"""Few points for many nodes: a field's sums at all loads, kept by some of its nodes with new shares.

What a joint exports are sums over its nodes of share times a function of the node's two pressures (`equal`,
`tilt`), with its position as a factor. At finitely many loads these are finitely many sums, most of which
follow from the others. Some of the nodes with positive shares keep these (`recombined`; Tchakaloff; Litterer
and Lyons 2012), and as few of them as keep all within the tolerance are taken. Loads at which the points miss
are added until none of further ones is missed. Which nodes and shares these are is found with rounded numbers
(`footprint.reproducible`); the nodes are the field's own.
"""

from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np
from scipy.linalg import qr, solve_triangular
from scipy.optimize import nnls

from jointfmu.mechanics.footprint.patches import highest
from jointfmu.mechanics.footprint.reproducible import rounded, to_digits
from jointfmu.mechanics.footprint.shape import PressureShape
from jointfmu.progress import track
from jointfmu.quantity import Array

from .clamped import BoltedInterface, Pressures
from .nodal_result import Nodes
from .sums import (
    PRELOADS,
    SEED,
    Load,
    Sums,
    SumsAtLoads,
    balance,
    first_loads,
    further_loads,
    grouped,
    largest_moment,
)

GROUPS = 2
"""Groups over kept sums [1]."""


def recombined(values: Array, weights: Array, turn: Array) -> tuple[Nodes, Array]:
    """Nodes and their weights (at most d), with which values (n, d) have the sums that weights (n) > 0 give.

    turn : (d, d) makes the d values independent

    Raises RuntimeError if rounding stands in the way.
    """
    left, count = np.arange(len(values)), values.shape[1]
    while left.size > count:
        groups = np.linspace(0, left.size, min(GROUPS * count, left.size) + 1).astype(np.intp)
        sums = [weights[a:b] @ values[a:b] for a, b in pairwise(groups)]
        vectors = (np.array(sums) @ turn).T
        factors, _ = nnls(vectors, np.sum(vectors, axis=1), maxiter=20 * count)
        of_node = np.repeat(factors, np.diff(groups))
        stays = of_node > 0.0
        left, weights, values = left[stays], (weights * of_node)[stays], values[stays]
    return left, weights


TOLERANCE = 1e-6
"""Largest deviation of a sum [1] that a reduced field may have."""
LARGE = 1e-5
"""The same of one with too many nodes to keep them all."""
AIM, LET_PASS, WORTH_ADDING = 0.05, 0.6, 0.15
"""Parts of the tolerance [1]: what is aimed at, what is let pass where it was not aimed at (the rest is for
loads that are not tried), and from where on a load is one to aim at."""
DIGITS = 25
"""Binary digits to which nodes are rounded before they decide: 3e-8, less than what is aimed at."""
LEAST = 7e-9
"""Sums that are kept: those that say so much that others do not, over the one that says most [1]."""
FEWER = 0.93
"""Sums that are kept in a further attempt with fewer points [1]."""
MORE = 100
"""Of the further loads, how many are aimed at from the beginning."""
SKETCH = 600
"""Random combinations of these nodes (Halko, Martinsson and Tropp 2011), more than the sums that are kept."""
FEW = 60
"""Nodes that are kept as they are."""
MOST = 3000
"""Nodes that are all kept where no points do."""
SAMPLE = 3000
"""Nodes on which it is found which sums follow from others."""
TESTS, WORK = (60, 300), 3e6
"""Fewest and most loads per round at which the points are tried, and how many nodes all of them may have."""
ROUNDS = 8


@dataclass(frozen=True, slots=True)
class Reduction:
    """What stands for a field.

    shape     : the points
    field     : all nodes, for which they stand
    deviation : [1] largest one of the sums at `loads` loads that the points were not made for: total
                force, K_zz (and K_xx, which is in proportion), K_rx, K_ry, each over its value or the
                one at tightening, whichever is larger; a hundredth of that of moments of the force and of
                coupling stiffnesses
    moment    : [1] largest moment of these loads, over the one at which a row of bolts has no force left
    beyond    : [1] the deviation between this moment and that one
    """

    shape: PressureShape
    field: PressureShape
    deviation: float = 0.0
    loads: int = 0
    moment: float = 1.0
    beyond: float = 0.0

    @property
    def points(self) -> int:
        """How many points the field has left."""
        return int(self.shape.share.size)

    @property
    def nodes(self) -> int:
        """How many nodes they stand for."""
        return int(self.field.share.size)


def reduce(joint: BoltedInterface, shape: PressureShape, preload: float, pressures: Pressures) -> Reduction:
    """The fewest points found that keep a field's sums within TOLERANCE; all nodes where none do, of more
    than MOST nodes those within LARGE.

    preload   : [N] per bolt, the field's; loads are tried from PRELOADS of it, from pressed together to
                fully open, with moments up to the one at which a row of bolts has no force left or nodes
                that carried the part OPENED of the preload are open, whichever comes first
    pressures : of the joint, those of joints.clamped.Clamping

    Raises RuntimeError if none do.
    """
    nodes = shape.share.size
    if nodes <= FEW:
        return Reduction(shape, shape)
    sums = Sums.of(joint, preload, pressures)
    order = np.argsort(
        to_digits(shape.equal), kind="stable"
    )  # neighbours on the curve: it is read the faster
    own = shape.part(order)
    shape = rounded(own, DIGITS)
    few = np.random.default_rng(SEED).choice(
        nodes, min(SAMPLE, nodes), replace=False, p=sums.weights(shape, largest_moment(joint, shape))
    )
    reduction = _search(sums, shape, shape.part(few), own)
    if reduction is not None and (nodes > MOST or reduction.deviation <= TOLERANCE):
        return reduction
    if nodes <= MOST:
        return Reduction(own, own)
    raise RuntimeError(
        f"the field of {nodes} nodes has no points that keep its sums within {LARGE:g}; of up to {MOST} all "
        "nodes are kept"
    )


def _search(sums: Sums, shape: PressureShape, some: PressureShape, own: PressureShape) -> Reduction | None:
    """Points that keep the sums at first loads and at those of others that they missed, within LARGE.

    shape : the nodes, rounded
    some  : of these, on which it is found which sums follow from others
    own   : the nodes as they are
    """
    limit = largest_moment(sums.joint, shape)
    loads, tests = further_loads(limit), int(np.clip(WORK / shape.share.size, *TESTS))
    system = _System.of(sums, shape, own, some, sums.at(shape, [*first_loads(limit), *islice(loads, MORE)]))
    best, least = None, LARGE
    for _ in track(range(ROUNDS), "points", ROUNDS):
        points = system.points()
        if points is None:
            break
        tried = sums.at(shape, list(islice(loads, tests)))
        missed = sums.deviations(points, tried)
        worst = float(np.max(missed))
        if worst <= least:
            best, least = points, worst
        if worst <= LET_PASS * TOLERANCE:
            break
        system.add(tried.part(missed > WORTH_ADDING * TOLERANCE))
    if best is None:
        return None
    beyond = _beyond(sums, shape, best, limit)
    return Reduction(best, own, least, tests, limit, beyond)


def _beyond(sums: Sums, shape: PressureShape, points: PressureShape, limit: float) -> float:
    """Largest deviation [1] at larger moments."""
    if limit >= 1.0:
        return 0.0
    moments = np.linspace(limit, 1.0, 6)[1:].tolist()
    loads = [Load(p, sign * m, 0.0) for p in PRELOADS for m in moments for sign in (-1.0, 1.0)]
    return float(np.max(sums.deviations(points, sums.at(shape, loads))))


@dataclass(slots=True)
class _System:
    """Sums that shares of the nodes of a shape are to keep, those that balance it and those at loads.

    own    : the nodes as they are, not rounded
    some   : (c) nodes on which it is found which sums follow from others, mixed by `mixing` (SKETCH, c)
    rows   : the sums at loads
    over   : what those that balance the shape are divided by
    sketch : (SKETCH, r) the functions at these nodes, mixed
    """

    sums: Sums
    shape: PressureShape
    own: PressureShape
    some: PressureShape
    mixing: Array
    rows: SumsAtLoads
    over: Array
    sketch: Array

    @classmethod
    def of(
        cls, sums: Sums, shape: PressureShape, own: PressureShape, some: PressureShape, rows: SumsAtLoads
    ) -> "_System":
        """Of loads, to begin with."""
        over = np.maximum(np.max(np.abs(balance(shape)), axis=0), np.finfo(float).tiny)
        mixing = np.random.default_rng(SEED).standard_normal((SKETCH, some.share.size))
        mixing *= np.sqrt(some.share / SKETCH)
        sketch = mixing @ np.concatenate([balance(some) / over, sums.columns(some, rows)], axis=1)
        return cls(sums, shape, own, some, mixing, rows, over, sketch)

    def add(self, rows: SumsAtLoads) -> None:
        """Further loads."""
        self.sketch = np.concatenate([self.sketch, self.mixing @ self.sums.columns(self.some, rows)], axis=1)
        self.rows = self.rows.joined(rows)

    def values(self, shape: PressureShape) -> Array:
        """(n, r) the functions at nodes."""
        return np.concatenate([balance(shape) / self.over, self.sums.columns(shape, self.rows)], axis=1)

    def points(self) -> PressureShape | None:
        """The fewest nodes found that keep the sums; None if none do."""
        kept, turn = self._combinations()
        held = highest(self.shape)
        try:
            some, share = self._groups(kept, turn, held)
            left, share = recombined(self._kept(some, kept), share, turn)
        except RuntimeError:  # rounding
            return None
        left = some[left]
        values = self.values(self.shape.part(left))
        target = np.concatenate([self.shape.share @ balance(self.shape) / self.over, self.rows.total.ravel()])
        target -= self.shape.share[held] @ self.values(self.shape.part(held))
        best, count = None, kept.size
        allowed = LET_PASS * LARGE
        while count > 1 and np.max(np.abs(share @ values - target)) <= allowed:
            best, allowed = (left, share), AIM * TOLERANCE
            count = int(FEWER * count)
            try:
                few, share = recombined(values[:, kept[:count]], share, turn[:count, :count])
            except RuntimeError:
                break
            left, values = left[few], values[few]
        if best is None:
            return None
        both = self.own.part(np.concatenate([held, best[0]]))
        return _balanced(both, np.concatenate([self.shape.share[held], best[1]]))

    def _groups(self, kept: Nodes, turn: Array, held: Nodes) -> tuple[Nodes, Array]:
        """Nodes of few groups, with shares that keep the sums of all nodes but those held."""
        share = self.shape.share.copy()
        share[held] = 0.0
        of_node = np.arange(share.size) // grouped(share.size)
        before = np.asarray(np.bincount(of_node, share), dtype=np.float64)
        full = np.flatnonzero(before)
        sums = self._group_sums(kept)
        np.subtract.at(sums, of_node[held], self.shape.share[held, None] * self._kept(held, kept))
        left, after = recombined(sums[full] / before[full, None], before[full], turn)
        scale = np.zeros(before.size)
        scale[full[left]] = after / before[full[left]]
        share *= scale[of_node]
        nodes = np.flatnonzero(share)
        return nodes, share[nodes]

    def _group_sums(self, kept: Nodes) -> Array:
        """(g, k) sums of some of the functions over groups of nodes."""
        share, own = self.shape.share[:, None], self.over.size
        still = kept < own
        load, function = np.divmod(kept[~still] - own, 9)
        values = (balance(self.shape) / self.over)[:, kept[still]]
        out = np.empty((self.rows.groups.shape[2], kept.size))
        out[:, still] = np.add.reduceat(share * values, np.arange(0, share.size, grouped(share.size)))
        out[:, ~still] = self.rows.groups[load, function].T
        return out

    def _kept(self, nodes: Nodes, kept: Nodes) -> Array:
        """(n, k) some of the functions at nodes."""
        some, own = self.shape.part(nodes), self.over.size
        still = kept < own
        out = np.empty((nodes.size, kept.size))
        out[:, still] = (balance(some) / self.over)[:, kept[still]]
        out[:, ~still] = self.sums.few_columns(some, self.rows, kept[~still] - own)
        return out

    def _combinations(self) -> tuple[Nodes, Array]:
        """Sums that say what others do not, the most telling first, and what makes them independent."""
        triangle, order = qr(self.sketch, mode="r", pivoting=True)
        size = np.abs(np.diag(triangle))
        count = int(np.sum(size > LEAST * size[0]))
        return order[:count], solve_triangular(triangle[:count, :count], np.eye(count))


def _balanced(some: PressureShape, weights: Array) -> PressureShape:
    """The nodes with a share, their sums put right to round-off."""
    points = some.part(np.flatnonzero(weights > 0.0))
    share = weights[weights > 0.0] / np.sum(weights)
    return PressureShape(
        share=share,
        position=points.position - share @ points.position,
        equal=points.equal / (share @ points.equal),
        tilt=points.tilt - share @ points.tilt,
    )
