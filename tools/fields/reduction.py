"""Reduce a pressure field to few nodes, with new area shares that keep its sums at all loads (cubature).

The outputs of a joint are sums over its nodes: area share times a function of the two pressures of the node
(`preload_shape`, `moment_shape`) and of its position. A finite number of load cases gives a finite number of
sums, and most of them are linearly dependent. Some nodes with positive shares keep all sums (`recombine`;
Tchakaloff; Litterer and Lyons 2012). The fewest nodes that keep the sums within the tolerance are selected.
Load cases in which the points miss the tolerance are added until the points meet it in new load cases. The
selection uses rounded numbers (`footprint.reproducible`), so that it is the same on all processors; the
selected nodes are not rounded.
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
"""Number of groups of nodes over number of independent sums [1]."""


def recombined(values: Array, weights: Array, turn: Array) -> tuple[Nodes, Array]:
    """Select at most d nodes with new weights that keep the weighted sums of d functions (recombination).

    values    : (n, d) of the functions at the nodes
    weights   : (n) > 0
    transform : (d, d) matrix that makes the d functions independent

    Returns the indices of the nodes and their weights. Raises RuntimeError if round-off prevents a solution.
    """
    selected, count = np.arange(len(values)), values.shape[1]
    while selected.size > count:
        bounds = np.linspace(0, selected.size, min(GROUPS * count, selected.size) + 1).astype(np.intp)
        sums = [weights[a:b] @ values[a:b] for a, b in pairwise(bounds)]
        vectors = (np.array(sums) @ turn).T
        factors, _ = nnls(vectors, np.sum(vectors, axis=1), maxiter=20 * count)
        node_factors = np.repeat(factors, np.diff(bounds))
        positive = node_factors > 0.0
        selected, weights, values = (
            selected[positive],
            (weights * node_factors)[positive],
            values[positive],
        )
    return selected, weights


TOLERANCE = 1e-6
"""Largest relative deviation of a sum [1] of a reduced field."""
LARGE = 1e-5
"""The same limit for a field with more nodes than can all be kept [1]."""
AIM, LET_PASS, WORTH_ADDING = 0.05, 0.6, 0.15
"""Deviations over the tolerance [1]: goal in the load cases of the selection; limit in the test load cases
(the margin is for untested ones); deviation from which a test load case is added to the selection."""
DIGITS = 25
"""Number of bits to which nodes are rounded for the selection: 3e-8, less than the goal."""
LEAST = 7e-9
"""Smallest pivot of an independent sum over the largest pivot [1]; sums below it are dependent."""
FEWER = 0.93
"""Factor [1] on the number of kept sums, and so of points, from one attempt to the next."""
MORE = 100
"""Number of quasi-random load cases in the selection from the start."""
SKETCH = 600
"""Number of random combinations of the sample nodes (Halko, Martinsson and Tropp 2011); more than the number
of kept sums."""
FEW = 60
"""Largest number of nodes of a field that is not reduced."""
MOST = 3000
"""Largest number of nodes that are all kept if no reduction meets the tolerance."""
SAMPLE = 3000
"""Number of sample nodes for finding the independent sums."""
TESTS, WORK = (60, 300), 3e6
"""Smallest and largest number of test load cases per round; largest number of test load cases times nodes."""
ROUNDS = 8


@dataclass(frozen=True, slots=True)
class Reduction:
    """Result of the reduction of a pressure field.

    shape      : pressure shape of the reduced points
    full_shape : pressure shape of all nodes
    deviation  : [1] largest deviation of the sums in `test_count` load cases outside the selection: total
                 force, K_zz (and K_xx, proportional to K_zz), K_rx and K_ry, each over its value or its value
                 in the preloaded joint, whichever is larger. Deviations of the moments of the force and of
                 coupling stiffnesses count a hundredth
    test_count : number of these load cases
    moment_ratio : [1] largest moment in these load cases over the moment that unloads a row of bolts
    deviation_beyond : [1] largest deviation at moment ratios from `moment_ratio` to 1
    """

    shape: PressureShape
    field: PressureShape
    deviation: float = 0.0
    loads: int = 0
    moment: float = 1.0
    beyond: float = 0.0

    @property
    def points(self) -> int:
        """Number of reduced points."""
        return int(self.shape.share.size)

    @property
    def nodes(self) -> int:
        """Number of nodes of the field."""
        return int(self.field.share.size)


def reduce(joint: BoltedInterface, shape: PressureShape, preload: float, pressures: Pressures) -> Reduction:
    """Reduce a pressure shape to the fewest points that keep its sums within RELATIVE_TOLERANCE.

    If no points do, all nodes are kept. A field with more than MAX_KEPT_NODES nodes then takes the points
    within LARGE_FIELD_TOLERANCE.

    preload   : [N] per bolt of the field. Load cases cover PRELOAD_RANGE of it, from compression to full
                opening, with moments up to `max_moment_ratio`
    pressures : function of the joint for nodal pressures, see FieldAdapter

    Raises RuntimeError if the field has too many nodes and no points are within LARGE_FIELD_TOLERANCE.
    """
    nodes = shape.share.size
    if nodes <= FEW:
        return Reduction(shape, shape)
    sums = Sums.of(joint, preload, pressures)
    # sorted by pressure, neighbouring nodes are close on the pressure curve: its evaluation is faster
    order = np.argsort(to_digits(shape.equal), kind="stable")
    unrounded = shape.part(order)
    shape = rounded(unrounded, DIGITS)
    sample = np.random.default_rng(SEED).choice(
        nodes, min(SAMPLE, nodes), replace=False, p=sums.weights(shape, largest_moment(joint, shape))
    )
    reduction = _search(sums, shape, shape.part(sample), unrounded)
    if reduction is not None and (nodes > MOST or reduction.deviation <= TOLERANCE):
        return reduction
    if nodes <= MOST:
        return Reduction(unrounded, unrounded)
    raise RuntimeError(
        f"the field of {nodes} nodes has no points that keep its sums within {LARGE:g}; of up to {MOST} all "
        "nodes are kept"
    )


def _search(sums: Sums, shape: PressureShape, some: PressureShape, own: PressureShape) -> Reduction | None:
    """Search points that keep the sums within LARGE_FIELD_TOLERANCE; None if there are none.

    Each round tests the points in new load cases, and adds those to the selection in which the points miss.

    shape     : pressure shape of all nodes, rounded
    sample    : sample of these nodes, for finding the independent sums
    unrounded : pressure shape of all nodes
    """
    limit = largest_moment(sums.joint, shape)
    loads, tests = further_loads(limit), int(np.clip(WORK / shape.share.size, *TESTS))
    system = _System.of(sums, shape, own, some, sums.at(shape, [*first_loads(limit), *islice(loads, MORE)]))
    best, best_deviation = None, LARGE
    for _ in track(range(ROUNDS), "points", ROUNDS):
        points = system.points()
        if points is None:
            break
        test_sums = sums.at(shape, list(islice(loads, tests)))
        deviations = sums.deviations(points, test_sums)
        worst = float(np.max(deviations))
        if worst <= best_deviation:
            best, best_deviation = points, worst
        if worst <= LET_PASS * TOLERANCE:
            break
        system.add(test_sums.part(deviations > WORTH_ADDING * TOLERANCE))
    if best is None:
        return None
    deviation_beyond = _beyond(sums, shape, best, limit)
    return Reduction(best, own, best_deviation, tests, limit, deviation_beyond)


def _beyond(sums: Sums, shape: PressureShape, points: PressureShape, limit: float) -> float:
    """Largest deviation [1] at moment ratios from `moment_limit` to 1 (a row of bolts loses its force)."""
    if limit >= 1.0:
        return 0.0
    moments = np.linspace(limit, 1.0, 6)[1:].tolist()
    loads = [Load(p, sign * m, 0.0) for p in PRELOADS for m in moments for sign in (-1.0, 1.0)]
    return float(np.max(sums.deviations(points, sums.at(shape, loads))))


@dataclass(slots=True)
class _System:
    """The r sums that the reduced points must keep: balance of the field, and sums in load cases.

    shape         : pressure shape of all nodes, rounded
    unrounded     : pressure shape of all nodes
    sample        : sample (c) of the nodes, for finding the independent sums
    mixing        : random matrix (SKETCH_ROWS, c)
    load_sums     : sums in the load cases
    balance_scale : divisors of the balance functions
    sketch        : (SKETCH_ROWS, r) random combinations of the functions at the sample nodes
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
        """System with the sums in the first load cases."""
        scale = np.maximum(np.max(np.abs(balance(shape)), axis=0), np.finfo(float).tiny)
        mixing = np.random.default_rng(SEED).standard_normal((SKETCH, some.share.size))
        mixing *= np.sqrt(some.share / SKETCH)
        sketch = mixing @ np.concatenate([balance(some) / scale, sums.columns(some, rows)], axis=1)
        return cls(sums, shape, own, some, mixing, rows, scale, sketch)

    def add(self, rows: SumsAtLoads) -> None:
        """Add the sums in more load cases."""
        self.sketch = np.concatenate([self.sketch, self.mixing @ self.sums.columns(self.some, rows)], axis=1)
        self.rows = self.rows.joined(rows)

    def values(self, shape: PressureShape) -> Array:
        """Values (n, r) of all functions at the nodes of a shape."""
        return np.concatenate([balance(shape) / self.over, self.sums.columns(shape, self.rows)], axis=1)

    def points(self) -> PressureShape | None:
        """Find the fewest nodes that keep the sums; None if no nodes do.

        The nodes with the highest pressure (`highest`) are always kept, with their own share.
        """
        independent, turn = self._combinations()
        fixed = highest(self.shape)
        try:
            candidates, share = self._groups(independent, turn, fixed)
            selected, share = recombined(self._kept(candidates, independent), share, turn)
        except RuntimeError:  # round-off
            return None
        selected = candidates[selected]
        values = self.values(self.shape.part(selected))
        target = np.concatenate([self.shape.share @ balance(self.shape) / self.over, self.rows.total.ravel()])
        target -= self.shape.share[fixed] @ self.values(self.shape.part(fixed))
        best, count = None, independent.size
        tolerance = LET_PASS * LARGE
        while count > 1 and np.max(np.abs(share @ values - target)) <= tolerance:
            best, tolerance = (selected, share), AIM * TOLERANCE
            count = int(FEWER * count)
            try:
                fewer, share = recombined(values[:, independent[:count]], share, turn[:count, :count])
            except RuntimeError:
                break
            selected, values = selected[fewer], values[fewer]
        if best is None:
            return None
        points = self.own.part(np.concatenate([fixed, best[0]]))
        return _balanced(points, np.concatenate([self.shape.share[fixed], best[1]]))

    def _groups(self, kept: Nodes, turn: Array, held: Nodes) -> tuple[Nodes, Array]:
        """Select few groups of nodes, with shares that keep the sums of all nodes except the fixed ones.

        Returns the nodes of these groups and their shares.
        """
        share = self.shape.share.copy()
        share[held] = 0.0
        group = np.arange(share.size) // grouped(share.size)
        old_share = np.asarray(np.bincount(group, share), dtype=np.float64)
        nonempty = np.flatnonzero(old_share)
        sums = self._group_sums(kept)
        np.subtract.at(sums, group[held], self.shape.share[held, None] * self._kept(held, kept))
        selected, new_share = recombined(
            sums[nonempty] / old_share[nonempty, None], old_share[nonempty], turn
        )
        scale = np.zeros(old_share.size)
        scale[nonempty[selected]] = new_share / old_share[nonempty[selected]]
        share *= scale[group]
        nodes = np.flatnonzero(share)
        return nodes, share[nodes]

    def _group_sums(self, kept: Nodes) -> Array:
        """Sums (g, k) of the selected functions over groups of nodes."""
        share, count = self.shape.share[:, None], self.over.size
        is_balance = kept < count
        load, function = np.divmod(kept[~is_balance] - count, 9)
        values = (balance(self.shape) / self.over)[:, kept[is_balance]]
        out = np.empty((self.rows.groups.shape[2], kept.size))
        out[:, is_balance] = np.add.reduceat(share * values, np.arange(0, share.size, grouped(share.size)))
        out[:, ~is_balance] = self.rows.groups[load, function].T
        return out

    def _kept(self, nodes: Nodes, kept: Nodes) -> Array:
        """Values (n, k) of the selected functions at nodes."""
        shape, count = self.shape.part(nodes), self.over.size
        is_balance = kept < count
        out = np.empty((nodes.size, kept.size))
        out[:, is_balance] = (balance(shape) / self.over)[:, kept[is_balance]]
        out[:, ~is_balance] = self.sums.few_columns(shape, self.rows, kept[~is_balance] - count)
        return out

    def _combinations(self) -> tuple[Nodes, Array]:
        """Indices of independent sums, the largest pivot first, and the matrix that orthogonalises them."""
        triangle, order = qr(self.sketch, mode="r", pivoting=True)
        size = np.abs(np.diag(triangle))
        count = int(np.sum(size > LEAST * size[0]))
        return order[:count], solve_triangular(triangle[:count, :count], np.eye(count))


def _balanced(some: PressureShape, weights: Array) -> PressureShape:
    """Select the nodes with a share > 0 and correct the balance of the field to round-off."""
    points = some.part(np.flatnonzero(weights > 0.0))
    share = weights[weights > 0.0] / np.sum(weights)
    return PressureShape(
        share=share,
        position=points.position - share @ points.position,
        equal=points.equal / (share @ points.equal),
        tilt=points.tilt - share @ points.tilt,
    )
