"""Samples of the parameters through the joint to bands along a ramp of load; Sobol' indices.

First order and total by the estimators of Saltelli et al. 2010 (doi:10.1016/j.cpc.2009.09.018) in
scipy.stats.sobol_indices; 95 % confidence intervals by the variance of the estimators' terms, as if the
samples were independent, which for a Sobol' sequence is on the safe side.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import sobol_indices

from jointfmu.progress import track
from jointfmu.quantity import Array, Interval, build

from ..batch.approach import columns, inside
from .problem import LOAD_END, Problem
from .study import Refused, samples_of, unit_design

Mask = NDArray[np.bool_]
Singles = NDArray[np.float32]

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
BLOCK = 512
"""Samples that are evaluated at once: what fits the cache."""
ROUND_OFF = 1e-6
"""Of single precision [1]."""
CHECKED = 4
"""Samples that are compared with the exported spring."""
ACCURACY = 1e-2
"""Largest relative difference between the reduced evaluation and the spring that is let pass [1]."""


@dataclass(frozen=True, slots=True)
class SampledOutputs:
    """Outputs (m, n) in single precision by name at accepted samples, NaN elsewhere."""

    outputs: Mapping[str, Singles]
    good: Mask


def run(task: Problem, points: Array, loads: Array, text: str) -> SampledOutputs:
    """All outputs at loads (m) for points (n, d) of the unit cube."""
    values, factor = task.sampled(points)
    n = len(points)
    joint = columns(task.parameters, values)
    good = inside(joint, n) & (factor > 0.0) & (factor * task.loads[-1] <= task.reduced.most(joint))
    outputs: dict[str, Singles] = {
        name: np.full((loads.size, n), np.nan, np.float32) for name in task.reduced.units
    }
    index = np.flatnonzero(good)
    blocks = [index[i : i + BLOCK] for i in range(0, index.size, BLOCK)]
    for block in track(blocks, text, len(blocks)):
        for part, results in _evaluated(task, values, factor, block, loads):
            for name, value in results.items():
                outputs[name][:, part] = value.T
    for column in outputs.values():
        good &= np.all(np.isfinite(column), axis=0)
    return SampledOutputs(outputs, good)


def _evaluated(
    task: Problem, values: Mapping[str, Any], factor: Array, block: Any, loads: Array
) -> Iterator[tuple[Any, dict[str, Array]]]:
    """Outputs of a block of samples; one that the law refuses is halved until it stands alone."""
    some = {k: v[block] if isinstance(v, np.ndarray) else v for k, v in values.items()}
    try:
        with np.errstate(all="ignore"):
            results = task.reduced.evaluate(task.parameters, some, loads, factor[block][:, None])
    except (ValueError, RuntimeError):
        halves = (block[: block.size // 2], block[block.size // 2 :]) if block.size > 1 else ()
        for half in halves:
            yield from _evaluated(task, values, factor, half, loads)
    else:
        yield block, results


@dataclass(frozen=True, slots=True)
class Bands:
    """Distribution of every output along the ramp.

    loads     : (m) nominal load
    quantiles : {output: (len(QUANTILES), m)}
    mean, sd, nominal : {output: (m)}; nominal is of the parameter file
    samples   : how many were drawn
    error     : largest relative difference between reduced evaluation and spring at CHECKED samples
    """

    loads: Array
    quantiles: Mapping[str, Array]
    mean: Mapping[str, Array]
    sd: Mapping[str, Array]
    nominal: Mapping[str, Array]
    samples: int
    refused: Refused
    error: float
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def shown(self) -> list[str]:
        """Outputs that are not zero throughout."""
        return [name for name in self.units if np.any(self.quantiles[name]) or np.any(self.nominal[name])]

    @property
    def moved(self) -> bool:
        """Whether any output differs between samples, by more than single precision."""
        return any(np.any(np.ptp(q, axis=0) > ROUND_OFF * np.abs(q[0])) for q in self.quantiles.values())


def bands(task: Problem, points: Array) -> Bands:
    """Bands of all outputs from points (n, d) of the unit cube.

    Raises RuntimeError if the law refuses every sample, or if the reduced evaluation misses the exported
    spring by more than ACCURACY.
    """
    outcome = run(task, points, task.loads, "samples")
    refused = refusals(task, points, outcome.good)
    if not np.any(outcome.good):
        raise RuntimeError(f"all {len(points)} samples are refused, the first: {refused.reason}")
    error = check(task, points, outcome)
    nominal = task.reduced.evaluate(task.parameters, task.values, task.loads, np.ones((1, 1)))
    spread = {
        name: np.stack([_spread(row, outcome.good) for row in value], axis=1)
        for name, value in outcome.outputs.items()
    }
    return Bands(
        loads=task.loads,
        quantiles={name: value[2:] for name, value in spread.items()},
        mean={name: value[0] for name, value in spread.items()},
        sd={name: value[1] for name, value in spread.items()},
        nominal={name: value[0] for name, value in nominal.items()},
        samples=len(points),
        refused=refused,
        error=error,
        units=task.reduced.units,
    )


def _spread(row: Singles, good: Mask) -> Array:
    """Mean, standard deviation and QUANTILES (linear between samples) of the accepted values of a row."""
    kept = np.sort(row[good]).astype(np.float64)
    places = np.array(QUANTILES) * (kept.size - 1)
    return np.array([kept.mean(), kept.std(), *np.interp(places, np.arange(kept.size), kept)])


def one_sample(task: Problem, points: Array, i: int) -> tuple[dict[str, object], float, dict[str, float]]:
    """Values, factor on the load, and the drawn numbers by name, of sample i."""
    values, factor = task.sampled(points[i : i + 1])
    single = {k: float(v[0]) if isinstance(v, np.ndarray) else v for k, v in values.items()}
    drawn = {name: float(v[0]) for name, v in samples_of(task.uncertain, points[i : i + 1]).items()}
    return single, float(factor[0]), drawn


def refusals(task: Problem, points: Array, good: Mask) -> Refused:
    """How many samples are refused, and the first with the law's own words."""
    bad = np.flatnonzero(~good)
    if not bad.size:
        return Refused(0, {}, "")
    values, factor, drawn = one_sample(task, points, int(bad[0]))
    reason = "the law gives no finite value"
    load, ramped = factor * float(task.loads[-1]), task.reduced.load
    allowed = Interval.of(gt=0.0, le=task.reduced.most(columns(task.parameters, values)))
    if not allowed.contains(load):
        reason = f"{ramped.name} = {load:g} {ramped.unit} is outside {allowed}: {LOAD_END}"
    try:
        task.reduced.exact(build(task.parameters, values), load * np.ones(1))
    except (ValueError, RuntimeError) as error:
        reason = str(error)
    return Refused(int(bad.size), drawn, reason)


def check(task: Problem, points: Array, outcome: SampledOutputs) -> float:
    """Largest relative difference to the exported spring over CHECKED samples and a few loads.

    Raises RuntimeError beyond ACCURACY, naming the output and the sample.
    """
    few = np.unique(np.linspace(0, task.loads.size - 1, 6).astype(int))
    few = few[task.loads[few] > 0.0]
    worst = 0.0
    for i in np.flatnonzero(outcome.good)[:CHECKED]:
        values, factor, drawn = one_sample(task, points, int(i))
        exact = task.reduced.exact(build(task.parameters, values), factor * task.loads[few])
        for name, value in exact.items():
            scale = np.where(value == 0.0, 1.0, np.abs(value))
            miss = float(np.max(np.abs(outcome.outputs[name][few, i] - value) / scale))
            if not miss <= ACCURACY:
                sample = ", ".join(f"{k} = {v:g}" for k, v in drawn.items())
                raise RuntimeError(
                    f"{name} of the reduced evaluation misses the joint's own by {miss:.2g} at {sample}, "
                    f"allowed is {ACCURACY:g}: take `jointfmu sweep` for such a study"
                )
            worst = max(worst, miss)
    return worst


def design(task: Problem, count: int, seed: int) -> tuple[Array, Array]:
    """Points (count, d) for the bands, and as many independent ones for the indices."""
    d = len(task.uncertain)
    both = unit_design(count, 2 * d, seed)
    return both[:, :d], both[:, d:]


LOADS = 21
"""Most loads along the ramp at which indices are computed."""


@dataclass(frozen=True, slots=True)
class Indices:
    """Indices (s, d) of s outputs and d parameters, with the half widths of their 95 % intervals."""

    first: Array
    first_half: Array
    total: Array
    total_half: Array


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Indices (m, d) by output at loads (m); `rows` is the number of base samples."""

    loads: Array
    names: tuple[str, ...]
    outputs: Mapping[str, Indices]
    rows: int


def indices(f_A: Array, f_B: Array, f_AB: Array) -> Indices:
    """From outputs (s, n) at two independent sets of points and (d, s, n) with one column exchanged.

    A row that is not finite everywhere counts for nothing.
    """
    n = f_A.shape[1]
    good = np.isfinite(f_A).all(0) & np.isfinite(f_B).all(0) & np.isfinite(f_AB).all((0, 1))
    middle = 0.5 * (f_A[:, good].mean(1) + f_B[:, good].mean(1))[:, None]
    scale = np.where(middle == 0.0, 1.0, np.abs(middle))
    a, b, ab = (np.where(good, (f - middle) / scale, 0.0) for f in (f_A, f_B, f_AB))
    sobol = sobol_indices(func={"f_A": a, "f_B": b, "f_AB": ab}, n=n)
    shape = (len(a), len(ab))
    first, total = (np.reshape(x, shape) for x in (sobol.first_order, sobol.total_order))
    variance = 0.5 * (a**2 + b**2)
    level = np.mean(variance, axis=1)
    level = np.where(level > 0.0, level, np.inf)

    def half(terms: Array, index: Array) -> Array:
        """1.96 standard errors of a ratio of means (delta method)."""
        spread = np.std(terms - index.T[:, :, None] * variance, axis=2)
        return np.asarray(1.96 * (spread / level).T / np.sqrt(n))

    return Indices(first, half(b * (ab - a), first), total, half(0.5 * (a - ab) ** 2, total))


def sensitivity(task: Problem, A: Array, B: Array) -> Sensitivity:
    """Indices of all outputs along the ramp from two independent designs (n, d), n a power of two."""
    n, d = A.shape
    picked = np.unique(np.linspace(0, task.loads.size - 1, LOADS).astype(int))
    loads = task.loads[picked]
    loads = loads[loads > 0.0]
    sets = [A, B]
    for i in range(d):
        mixed = A.copy()
        mixed[:, i] = B[:, i]
        sets.append(mixed)
    outputs = run(task, np.concatenate(sets), loads, "indices").outputs
    by_output = {}
    for name, value in outputs.items():
        f = value.astype(np.float64).reshape(loads.size, d + 2, n)
        by_output[name] = indices(f[:, 0], f[:, 1], np.moveaxis(f[:, 2:], 1, 0))
    return Sensitivity(loads, tuple(parameter.name for parameter in task.uncertain), by_output, n)
