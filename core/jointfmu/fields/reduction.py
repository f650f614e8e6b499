"""Few points for many nodes: a field's sums at all loads, kept by some of its nodes with new shares.

What a joint exports are sums over its nodes of share times a function of the node's two pressures
(`equal`, `tilt`), with its position as a factor. At finitely many loads these are finitely many sums, and
some of the nodes with positive shares keep them all (Tchakaloff's theorem); non-negative least squares finds
such nodes. Loads at which the points miss are added until none of further ones is missed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from ..footprint.shape import PressureShape
from ..joints.clamped import Clamped, Pressures
from ..progress import track
from .nodal_result import Array, Nodes
from .sums import PRELOADS, SEED, Load, Sums, SumsAtLoad, balance, first_loads, further_loads, largest_moment

TOLERANCE = 1e-6
"""Largest deviation of a sum [1] that a reduced field may have."""
AIM, LET_PASS, WORTH_ADDING = 0.3, 0.5, 0.15
"""Parts of the tolerance [1]: what is aimed at, what is let pass where it was not aimed at (the rest is for
loads that are not tried), and from where on a load is one to aim at."""
LEAST = (1e-6, 3e-7, 1e-7, 3e-8, 1e-8)
"""Combinations of the sums that are kept: with so much of the weight of the largest one [1]."""
SKETCH = 600
"""Random combinations of nodes, from which those of the sums are found."""
FEW = 60
"""Nodes that are kept as they are."""
MOST = 3000
"""Nodes that are all kept where no points do."""
CANDIDATES = 3000
"""Nodes among which the points are sought; twice and four times as many where these do not do."""
TESTS, WORK = (60, 300), 3e6
"""Fewest and most loads per round at which the points are tried, and how many nodes all of them may have."""
ROUNDS = 8


@dataclass(frozen=True, slots=True)
class Reduction:
    """What stands for a field.

    shape     : the points
    nodes     : how many nodes they stand for
    deviation : [1] largest one of the sums at `loads` loads that the points were not made for: total
                force, K_zz (and K_xx, which is in proportion), K_rx, K_ry, each over its value or the
                one at tightening, whichever is larger; a hundredth of that of moments of the force and of
                coupling stiffnesses
    moment    : [1] largest moment of these loads, over the one at which a row of bolts has no force left
    beyond    : [1] the deviation between this moment and that one
    """

    shape: PressureShape
    nodes: int
    deviation: float = 0.0
    loads: int = 0
    moment: float = 1.0
    beyond: float = 0.0

    @property
    def points(self) -> int:
        """How many points the field has left."""
        return int(self.shape.share.size)


def reduce(joint: Clamped, shape: PressureShape, preload: float, pressures: Pressures) -> Reduction:
    """The fewest points found that keep a field's sums within TOLERANCE.

    preload   : [N] per bolt, the field's; loads are tried from PRELOADS of it, from pressed together to
                fully open, with moments up to the one at which a row of bolts has no force left or nodes
                that carried the part OPENED of the preload are open, whichever comes first
    pressures : of the joint, those of joints.clamped.Clamping

    Raises RuntimeError if no points do and there are more than MOST nodes.
    """
    nodes = shape.share.size
    if nodes <= FEW:
        return Reduction(shape, nodes)
    rng, sums = np.random.default_rng(SEED), Sums.of(joint, preload, pressures)
    for size in (CANDIDATES, 2 * CANDIDATES, 4 * CANDIDATES):
        few = rng.choice(nodes, min(size, nodes), replace=False)
        reduction = _search(sums, shape, _part(shape, np.union1d(few, _highest(shape))))
        if reduction is not None:
            return reduction
        if size >= nodes:
            break
    if nodes <= MOST:
        return Reduction(shape, nodes)
    raise RuntimeError(f"the field of {nodes} nodes has no points that keep its sums within {TOLERANCE:g}")


def _highest(shape: PressureShape) -> Nodes:
    """Nodes that have the largest pressure at some moment: they are kept, with their share."""
    steep = np.concatenate([-np.geomspace(30.0, 0.01, 40), [0.0], np.geomspace(0.01, 30.0, 40)])
    return np.unique([int(np.argmax(shape.equal + m * shape.tilt)) for m in steep])


def _search(sums: Sums, shape: PressureShape, some: PressureShape) -> Reduction | None:
    """Points among some nodes; None if there are none within the tolerance."""
    limit = largest_moment(sums.joint, shape)
    loads = further_loads(limit)
    rows = [sums.row(shape, load) for load in first_loads(limit)]
    columns = [sums.columns(some, row) for row in rows]
    best, least = None, TOLERANCE
    tests = int(np.clip(WORK / shape.share.size, *TESTS))
    for _ in track(range(ROUNDS), "points", ROUNDS):
        weights = _weights(rows, columns, shape, some)
        if weights is None:
            break
        points = _balanced(some, weights)
        tried = [sums.row(shape, load) for load in islice(loads, tests)]
        missed = [sums.deviation(points, row) for row in tried]
        worst = max(missed)
        if worst <= least:
            best, least = points, worst
        if worst <= LET_PASS * TOLERANCE:
            break
        more = [row for row, miss in zip(tried, missed, strict=True) if miss > WORTH_ADDING * TOLERANCE]
        rows += more
        columns += [sums.columns(some, row) for row in more]
    if best is None:
        return None
    beyond = _beyond(sums, shape, best, limit)
    return Reduction(best, shape.share.size, least, tests, limit, beyond)


def _beyond(sums: Sums, shape: PressureShape, points: PressureShape, limit: float) -> float:
    """Largest deviation [1] at larger moments."""
    if limit >= 1.0:
        return 0.0
    moments = np.linspace(limit, 1.0, 6)[1:].tolist()
    loads = [Load(p, sign * m, 0.0) for p in PRELOADS for m in moments for sign in (-1.0, 1.0)]
    return max(sums.deviation(points, sums.row(shape, load)) for load in loads)


def _weights(
    rows: Sequence[SumsAtLoad], values: Sequence[Array], shape: PressureShape, some: PressureShape
) -> Array | None:
    """Shares (c) of the nodes, most of them zero, that keep the sums; None if there are none."""
    everywhere = balance(shape)
    over = np.maximum(np.max(np.abs(everywhere), axis=0), np.finfo(float).tiny)
    columns = np.concatenate([balance(some) / over, *values], axis=1)
    target = np.concatenate([shape.share @ everywhere / over, *(row.total for row in rows)])
    size, directions = _combinations(np.sqrt(some.share / np.sum(some.share))[:, None] * columns)
    fixed = np.zeros(some.share.size)
    held = _highest(some)
    fixed[held] = some.share[held]
    rest = target - fixed @ columns
    best, error = fixed, np.inf
    for least in LEAST:
        kept = directions[size > least * size[0]]
        scale = np.sqrt(size[: len(kept)])[:, None]
        try:
            shares, _ = nnls((kept @ columns.T) / scale, (kept @ rest) / scale[:, 0], maxiter=50 * len(kept))
        except RuntimeError:  # too many steps
            break
        miss = float(np.max(np.abs(shares @ columns - rest)))
        if miss > error:
            break
        best, error = fixed + shares, miss
        if error <= AIM * TOLERANCE:
            break
    return best if error <= LET_PASS * TOLERANCE else None


def _combinations(columns: Array) -> tuple[Array, Array]:
    """Weights, descending, and rows of the combinations of columns that matter.

    From random combinations of the nodes (Halko, Martinsson and Tropp 2011), many more than are needed.
    """
    mixed = np.random.default_rng(SEED).standard_normal((SKETCH, len(columns))) / np.sqrt(SKETCH)
    _, size, directions = np.linalg.svd(mixed @ columns, full_matrices=False)
    return size, directions


def _part(shape: PressureShape, index: NDArray[np.intp]) -> PressureShape:
    return PressureShape(shape.share[index], shape.position[index], shape.equal[index], shape.tilt[index])


def _balanced(some: PressureShape, weights: Array) -> PressureShape:
    """The nodes with a share, their sums put right to round-off."""
    points = _part(some, np.flatnonzero(weights > 0.0))
    share = weights[weights > 0.0] / np.sum(weights)
    return PressureShape(
        share=share,
        position=points.position - share @ points.position,
        equal=points.equal / (share @ points.equal),
        tilt=points.tilt - share @ points.tilt,
    )
