"""Propagation of parameter samples through a joint: bands along a load ramp, and Sobol' indices.

First-order and total indices: estimators of Saltelli et al. 2010 (doi:10.1016/j.cpc.2009.09.018) in
scipy.stats.sobol_indices. 95 % confidence intervals follow from the variance of the terms of the estimators,
as if the samples were independent. For a Sobol' sequence this is conservative.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import sobol_indices

from jointfmu.quantity import Array

from .journal import SOBOL_RUNS_FILE
from .problem import UncertaintyProblem
from .runs import (
    LOCAL_UNSAVED_EXECUTION,
    Execution,
    Mask,
    SampledOutputs,
    SinglePrecisionArray,
    evaluate_runs,
)
from .study import RefusedSamples, draw_samples, unit_cube_points
from .worker import JointRamp

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Probabilities of the quantiles that bands consist of."""
RELATIVE_ROUNDING = 1e-6
"""Relative round-off in single precision [1]."""


@dataclass(frozen=True, slots=True)
class Bands:
    """Distribution of each output along the load ramp.

    loads     : nominal loads (m)
    quantiles : {output: (len(QUANTILES), m)}
    mean, standard_deviation : mean and standard deviation, {output: (m)}
    nominal   : nominal outputs: those for the values of the parameter file, or the start values of the FMU,
                {output: (m)}
    sampled_outputs : outputs of all samples
    refused_samples : the samples that the law refuses
    units     : {output: unit}
    """

    loads: Array
    quantiles: Mapping[str, Array]
    mean: Mapping[str, Array]
    standard_deviation: Mapping[str, Array]
    nominal: Mapping[str, Array]
    sampled_outputs: SampledOutputs
    refused_samples: RefusedSamples
    units: Mapping[str, str]

    @property
    def sample_count(self) -> int:
        """Number of samples drawn."""
        return self.sampled_outputs.accepted.size

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


def compute_bands(
    uncertainty_problem: UncertaintyProblem,
    unit_cube_points: Array,
    execution: Execution = LOCAL_UNSAVED_EXECUTION,
) -> Bands:
    """Bands (distribution along the ramp) of all outputs, from points (n, d) of the unit cube.

    execution : where and in how many processes the runs are done, and where their results are stored

    Raises RuntimeError if the law refuses all samples; ValueError, RuntimeError as `evaluate_runs`.
    """
    first = uncertainty_problem.evaluator.run(-1, uncertainty_problem.settings)
    if "error" in first:
        raise ValueError(f"{uncertainty_problem.title}: without samples of its parameters: {first['error']}")
    nominal = {name: np.asarray(first["columns"][name]) for name in uncertainty_problem.units}
    runs = uncertainty_problem.list_runs(unit_cube_points)
    samples = evaluate_runs(
        uncertainty_problem.evaluator,
        runs,
        uncertainty_problem.units,
        uncertainty_problem.loads.size,
        execution,
    )
    refused, accepted = summarise_refusals(uncertainty_problem, unit_cube_points, samples), samples.accepted
    if not np.any(accepted):
        raise RuntimeError(f"all {len(unit_cube_points)} samples are rejected; the first: {refused.reason}")
    statistics = {
        name: np.stack([_statistics(row, accepted) for row in value], axis=1)
        for name, value in samples.outputs.items()
    }
    return Bands(
        loads=uncertainty_problem.loads,
        quantiles={name: value[2:] for name, value in statistics.items()},
        mean={name: value[0] for name, value in statistics.items()},
        standard_deviation={name: value[1] for name, value in statistics.items()},
        nominal=nominal,
        sampled_outputs=samples,
        refused_samples=refused,
        units=uncertainty_problem.units,
    )


def _statistics(output_samples: SinglePrecisionArray, accepted: Mask) -> Array:
    """Mean, standard deviation and quantiles of one output at one load, over the samples.

    Quantiles are linear between samples.

    output_samples, accepted : output (n), and mask (n) of the samples to be used
    """
    values = np.sort(output_samples[accepted]).astype(np.float64)
    positions = np.array(QUANTILES) * (values.size - 1)
    return np.array([values.mean(), values.std(), *np.interp(positions, np.arange(values.size), values)])


def summarise_refusals(
    uncertainty_problem: UncertaintyProblem, unit_cube_points: Array, samples: SampledOutputs
) -> RefusedSamples:
    """Summary of the samples that the law refuses: their number, and the first one with the error message."""
    if not samples.errors:
        return RefusedSamples(0, {}, "")
    first, reason = next(iter(samples.errors.items()))
    example = draw_samples(uncertainty_problem.uncertain_parameters, unit_cube_points[first : first + 1])
    return RefusedSamples(
        len(samples.errors), {name: float(value[0]) for name, value in example.items()}, reason
    )


def sample_designs(
    uncertainty_problem: UncertaintyProblem, point_count: int, seed: int
) -> tuple[Array, Array]:
    """Two independent sets of points (count, d) of the unit cube: for bands and indices, for indices only."""
    d = len(uncertainty_problem.uncertain_parameters)
    both = unit_cube_points(point_count, 2 * d, seed)
    return both[:, :d], both[:, d:]


MAX_INDEX_LOADS = 21
"""Largest number of loads along the ramp at which Sobol' indices are computed [1]."""


@dataclass(frozen=True, slots=True)
class SobolIndices:
    """First-order and total Sobol' indices (s, d) of s outputs with respect to d parameters.

    first_order_half_width, total_half_width : half widths (s, d) of the 95 % confidence intervals
    """

    first_order: Array
    first_order_half_width: Array
    total_order: Array
    total_half_width: Array


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Sobol' indices along the load ramp.

    loads             : (m) [SI] loads of the ramp
    parameter_names   : names of the uncertain parameters (d)
    outputs           : {output: indices (m, d)}
    base_sample_count : number of base samples
    """

    loads: Array
    parameter_names: tuple[str, ...]
    outputs: Mapping[str, SobolIndices]
    base_sample_count: int


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


def compute_sensitivity(
    uncertainty_problem: UncertaintyProblem,
    bands: Bands,
    A: Array,
    B: Array,
    execution: Execution = LOCAL_UNSAVED_EXECUTION,
) -> Sensitivity:
    """Sobol' indices of all quantities of a joint along the load ramp.

    bands : bands of a set of points that begins with A
    A, B  : two independent sets of points (n, d) of the unit cube, n a power of two
    """
    n, d = A.shape
    load_indices = np.unique(np.linspace(0, uncertainty_problem.loads.size - 1, MAX_INDEX_LOADS).astype(int))
    load_indices = load_indices[uncertainty_problem.loads[load_indices] > 0.0]
    loads = uncertainty_problem.loads[load_indices]
    sets = [B]
    for i in range(d):
        mixed = A.copy()
        mixed[:, i] = B[:, i]
        sets.append(mixed)
    assert isinstance(uncertainty_problem.evaluator, JointRamp)
    found = evaluate_runs(
        replace(uncertainty_problem.evaluator, load_indices=load_indices),
        uncertainty_problem.list_runs(np.concatenate(sets)),
        uncertainty_problem.units,
        loads.size,
        execution,
        SOBOL_RUNS_FILE,
        "indices",
    ).outputs
    by_output = {}
    for name, value in found.items():
        f_A = bands.sampled_outputs.outputs[name][load_indices, :n].astype(np.float64)
        f = value.astype(np.float64).reshape(loads.size, d + 1, n)
        by_output[name] = sobol_indices_of(f_A, f[:, 0], np.moveaxis(f[:, 1:], 1, 0))
    return Sensitivity(
        loads, tuple(parameter.name for parameter in uncertainty_problem.uncertain_parameters), by_output, n
    )
