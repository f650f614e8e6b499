"""Propagation of parameter samples through a joint: bands along a load ramp, and Sobol' indices.

First-order and total indices: estimators of Saltelli et al. 2010 (doi:10.1016/j.cpc.2009.09.018) in
scipy.stats.sobol_indices. 95 % confidence intervals follow from the variance of the terms of the estimators,
as if the samples were independent. For a Sobol' sequence this is conservative.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import sobol_indices

from jointfmu.progress import track_progress
from jointfmu.quantity import Array, Interval, build_parameter_set

from ..batch.approach import columns, inside
from .problem import LOAD_LIMIT_TEXT, Problem
from .study import RefusedSamples, draw_samples, unit_cube_points

Mask = NDArray[np.bool_]
SinglePrecisionArray = NDArray[np.float32]

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Probabilities of the quantiles that bands consist of."""
BLOCK_SAMPLES = 512
"""Number of samples evaluated at once: they fit into the processor cache."""
RELATIVE_ROUNDING = 1e-6
"""Relative round-off in single precision [1]."""
CHECKED_SAMPLES = 4
"""Number of samples at which the reduced curves are compared with the spring model of the exported FMU."""
MAX_REDUCTION_ERROR = 1e-2
"""Largest allowed relative difference between reduced curves and exported spring model [1]."""


@dataclass(frozen=True, slots=True)
class SampledOutputs:
    """Outputs at m loads and n samples, in single precision.

    outputs  : {name: (m, n)}; NaN at refused samples
    accepted : mask (n) of the samples that the law accepts
    """

    outputs: Mapping[str, SinglePrecisionArray]
    accepted: Mask


def evaluate_samples(problem: Problem, points: Array, loads: Array, progress_label: str) -> SampledOutputs:
    """Evaluate all outputs at loads (m) for points (n, d) of the unit cube.

    progress_label : label of the progress bar
    """
    values, factor = problem.sample_values(points)
    n = len(points)
    joint = columns(problem.parameter_class, values)
    good = inside(joint, n) & (factor > 0.0) & (factor * problem.loads[-1] <= problem.curves.max_load(joint))
    outputs: dict[str, SinglePrecisionArray] = {
        name: np.full((loads.size, n), np.nan, np.float32) for name in problem.curves.units
    }
    index = np.flatnonzero(good)
    blocks = [index[i : i + BLOCK_SAMPLES] for i in range(0, index.size, BLOCK_SAMPLES)]
    for block in track_progress(blocks, progress_label, len(blocks)):
        for part_indices, results in _evaluate_block(problem, values, factor, block, loads):
            for name, value in results.items():
                outputs[name][:, part_indices] = value.T
    for column in outputs.values():
        good &= np.all(np.isfinite(column), axis=0)
    return SampledOutputs(outputs, good)


def _evaluate_block(
    problem: Problem, values: Mapping[str, Any], factor: Array, block: Any, loads: Array
) -> Iterator[tuple[Any, dict[str, Array]]]:
    """Evaluate a block of samples: yield (indices of samples, {output: (samples, m)}).

    If the law refuses the block, the block is halved, down to single samples. Refused samples are left out.
    """
    block_values = {k: v[block] if isinstance(v, np.ndarray) else v for k, v in values.items()}
    try:
        with np.errstate(all="ignore"):
            results = problem.curves.evaluate(
                problem.parameter_class, block_values, loads, factor[block][:, None]
            )
    except (ValueError, RuntimeError):
        halves = (block[: block.size // 2], block[block.size // 2 :]) if block.size > 1 else ()
        for half in halves:
            yield from _evaluate_block(problem, values, factor, half, loads)
    else:
        yield block, results


@dataclass(frozen=True, slots=True)
class Bands:
    """Distribution of each output along the load ramp.

    loads     : nominal loads (m)
    quantiles : {output: (len(QUANTILES), m)}
    mean, standard_deviation : mean and standard deviation, {output: (m)}
    nominal   : outputs for the values of the parameter file, {output: (m)}
    sample_count : number of samples drawn
    refusals  : the samples that the law refuses
    reduction_error : largest relative difference [1] between reduced curves and exported spring model, at
        CHECKED_SAMPLES samples
    units     : {output: unit}
    """

    loads: Array
    quantiles: Mapping[str, Array]
    mean: Mapping[str, Array]
    standard_deviation: Mapping[str, Array]
    nominal: Mapping[str, Array]
    sample_count: int
    refusals: RefusedSamples
    reduction_error: float
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def nonzero_outputs(self) -> list[str]:
        """Names of the outputs that are not zero at all loads."""
        return [name for name in self.units if np.any(self.quantiles[name]) or np.any(self.nominal[name])]

    @property
    def has_scatter(self) -> bool:
        """Whether any output differs between samples by more than the round-off of single precision."""
        return any(
            np.any(np.ptp(q, axis=0) > RELATIVE_ROUNDING * np.abs(q[0])) for q in self.quantiles.values()
        )


def compute_bands(problem: Problem, points: Array) -> Bands:
    """Bands of all outputs, from points (n, d) of the unit cube.

    Raises RuntimeError if the law refuses all samples, or if the reduced curves differ from the exported
    spring model by more than MAX_REDUCTION_ERROR.
    """
    outcome = evaluate_samples(problem, points, problem.loads, "samples")
    refused = summarise_refusals(problem, points, outcome.accepted)
    if not np.any(outcome.accepted):
        raise RuntimeError(f"all {len(points)} samples are rejected; the first: {refused.reason}")
    error = check_reduction(problem, points, outcome)
    nominal = problem.curves.evaluate(problem.parameter_class, problem.values, problem.loads, np.ones((1, 1)))
    statistics = {
        name: np.stack([_statistics(row, outcome.accepted) for row in value], axis=1)
        for name, value in outcome.outputs.items()
    }
    return Bands(
        loads=problem.loads,
        quantiles={name: value[2:] for name, value in statistics.items()},
        mean={name: value[0] for name, value in statistics.items()},
        standard_deviation={name: value[1] for name, value in statistics.items()},
        nominal={name: value[0] for name, value in nominal.items()},
        sample_count=len(points),
        refusals=refused,
        reduction_error=error,
        units=problem.curves.units,
    )


def _statistics(row: SinglePrecisionArray, accepted: Mask) -> Array:
    """Mean, standard deviation and quantiles (linear between samples) of one output at one load.

    row, accepted : output (n), and mask (n) of the samples to be used
    """
    values = np.sort(row[accepted]).astype(np.float64)
    positions = np.array(QUANTILES) * (values.size - 1)
    return np.array([values.mean(), values.std(), *np.interp(positions, np.arange(values.size), values)])


def select_sample(
    problem: Problem, points: Array, i: int
) -> tuple[dict[str, object], float, dict[str, float]]:
    """Sample i: values of all parameters, load factor, and values of the uncertain parameters alone."""
    values, factor = problem.sample_values(points[i : i + 1])
    single = {k: float(v[0]) if isinstance(v, np.ndarray) else v for k, v in values.items()}
    uncertain = {
        name: float(v[0]) for name, v in draw_samples(problem.uncertain_parameters, points[i : i + 1]).items()
    }
    return single, float(factor[0]), uncertain


def summarise_refusals(problem: Problem, points: Array, accepted: Mask) -> RefusedSamples:
    """Refused samples: their number, and the first one with the error message of the law.

    accepted : mask (n) of the accepted samples
    """
    refused = np.flatnonzero(~accepted)
    if not refused.size:
        return RefusedSamples(0, {}, "")
    values, factor, sample = select_sample(problem, points, int(refused[0]))
    reason = "the law gives no finite value"
    load, ramped = factor * float(problem.loads[-1]), problem.curves.load
    allowed = Interval.from_bounds(
        gt=0.0, le=problem.curves.max_load(columns(problem.parameter_class, values))
    )
    if not allowed.contains(load):
        reason = f"{ramped.name} = {load:g} {ramped.unit} is outside {allowed}: {LOAD_LIMIT_TEXT}"
    try:
        problem.curves.exact(build_parameter_set(problem.parameter_class, values), load * np.ones(1))
    except (ValueError, RuntimeError) as error:
        reason = str(error)
    return RefusedSamples(int(refused.size), sample, reason)


def check_reduction(problem: Problem, points: Array, outcome: SampledOutputs) -> float:
    """Largest relative difference [1] between reduced curves and exported spring model.

    It is computed at CHECKED_SAMPLES samples and at most 6 loads.

    Raises RuntimeError if it exceeds MAX_REDUCTION_ERROR; the message names the output and the sample.
    """
    load_indices = np.unique(np.linspace(0, problem.loads.size - 1, 6).astype(int))
    load_indices = load_indices[problem.loads[load_indices] > 0.0]
    largest = 0.0
    for i in np.flatnonzero(outcome.accepted)[:CHECKED_SAMPLES]:
        values, factor, uncertain = select_sample(problem, points, int(i))
        exact = problem.curves.exact(
            build_parameter_set(problem.parameter_class, values), factor * problem.loads[load_indices]
        )
        for name, value in exact.items():
            scale = np.where(value == 0.0, 1.0, np.abs(value))
            error = float(np.max(np.abs(outcome.outputs[name][load_indices, i] - value) / scale))
            if not error <= MAX_REDUCTION_ERROR:
                sample = ", ".join(f"{k} = {v:g}" for k, v in uncertain.items())
                raise RuntimeError(
                    f"{name} of the reduced evaluation differs from the evaluation of the joint by "
                    f"{error:.2g} at {sample}, allowed is {MAX_REDUCTION_ERROR:g}: use `jointfmu sweep` for "
                    "this study"
                )
            largest = max(largest, error)
    return largest


def sample_designs(problem: Problem, count: int, seed: int) -> tuple[Array, Array]:
    """Two independent sets of points (count, d) of the unit cube: for bands and indices, for indices only."""
    d = len(problem.uncertain_parameters)
    both = unit_cube_points(count, 2 * d, seed)
    return both[:, :d], both[:, d:]


MAX_INDEX_LOADS = 21
"""Maximum number of loads along the ramp at which Sobol' indices are computed."""


@dataclass(frozen=True, slots=True)
class SobolIndices:
    """First-order and total Sobol' indices (s, d) of s outputs with respect to d parameters.

    first_half, total_half : half widths (s, d) of their 95 % confidence intervals
    """

    first: Array
    first_half: Array
    total: Array
    total_half: Array


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Sobol' indices along the load ramp.

    loads           : (m)
    parameter_names : names of the uncertain parameters (d)
    outputs         : {output: indices (m, d)}
    base_samples    : number of base samples
    """

    loads: Array
    parameter_names: tuple[str, ...]
    outputs: Mapping[str, SobolIndices]
    base_samples: int


def sobol_indices_of(f_A: Array, f_B: Array, f_AB: Array) -> SobolIndices:
    """Sobol' indices of s outputs from n base samples.

    f_A, f_B : outputs (s, n) at two independent sets of points A and B
    f_AB     : outputs (d, s, n) at the points A, with one parameter (column) taken from B

    A base sample with any output that is not finite is left out.
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

    def half_width(terms: Array, index: Array) -> Array:
        """Half width of the 95 % interval: 1.96 standard errors of a ratio of means (delta method)."""
        deviation = np.std(terms - index.T[:, :, None] * variance, axis=2)
        return np.asarray(1.96 * (deviation / level).T / np.sqrt(n))

    return SobolIndices(first, half_width(b * (ab - a), first), total, half_width(0.5 * (a - ab) ** 2, total))


def compute_sensitivity(problem: Problem, A: Array, B: Array) -> Sensitivity:
    """Sobol' indices of all outputs along the load ramp.

    A, B : two independent sets of points (n, d) of the unit cube, n a power of two
    """
    n, d = A.shape
    load_indices = np.unique(np.linspace(0, problem.loads.size - 1, MAX_INDEX_LOADS).astype(int))
    loads = problem.loads[load_indices]
    loads = loads[loads > 0.0]
    sets = [A, B]
    for i in range(d):
        mixed = A.copy()
        mixed[:, i] = B[:, i]
        sets.append(mixed)
    outputs = evaluate_samples(problem, np.concatenate(sets), loads, "indices").outputs
    by_output = {}
    for name, value in outputs.items():
        f = value.astype(np.float64).reshape(loads.size, d + 2, n)
        by_output[name] = sobol_indices_of(f[:, 0], f[:, 1], np.moveaxis(f[:, 2:], 1, 0))
    return Sensitivity(
        loads, tuple(parameter.name for parameter in problem.uncertain_parameters), by_output, n
    )
