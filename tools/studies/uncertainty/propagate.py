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
from .problem import UncertaintyStudy
from .runs import (
    LOCAL_UNSAVED_EXECUTION,
    Mask,
    SampledOutputs,
    SinglePrecisionArray,
    StudyExecution,
    evaluate_runs,
)
from .study import RefusedSamples, draw_samples, draw_unit_cube_points
from .worker import JointRampEvaluator

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Probabilities of the quantiles that bands consist of."""
SINGLE_PRECISION_ROUNDING = 1e-6
"""Relative round-off in single precision [1]."""


@dataclass(frozen=True, slots=True)
class UncertaintyBands:
    """Distribution of each output at each load of the ramp.

    loads                    : loads of the ramp (m) if the load is not sampled
    quantiles                : {output: (len(QUANTILES), m)}
    mean, standard_deviation : mean and standard deviation over the samples, {output: (m)}
    nominal_outputs          : {output: (m)} for the values of the parameter file, or the start values of the
        FMU
    sampled_outputs          : outputs of all samples
    refused_samples          : number and example of the samples that the law refuses
    output_units             : {output: unit}
    """

    loads: Array
    quantiles: Mapping[str, Array]
    mean: Mapping[str, Array]
    standard_deviation: Mapping[str, Array]
    nominal_outputs: Mapping[str, Array]
    sampled_outputs: SampledOutputs
    refused_samples: RefusedSamples
    output_units: Mapping[str, str]

    @property
    def sample_count(self) -> int:
        """Number of samples drawn."""
        return self.sampled_outputs.accepted_mask.size

    @property
    def nonzero_outputs(self) -> list[str]:
        """Names of the outputs that are not zero at all loads."""
        return [
            name
            for name in self.output_units
            if np.any(self.quantiles[name]) or np.any(self.nominal_outputs[name])
        ]

    @property
    def scattered_outputs(self) -> list[str]:
        """Names of the outputs that differ between samples by more than the round-off of single precision."""
        return [
            name
            for name, q in self.quantiles.items()
            if np.any(np.ptp(q, axis=0) > SINGLE_PRECISION_ROUNDING * np.abs(q[0]))
        ]


def compute_bands(
    uncertainty_study: UncertaintyStudy,
    unit_cube_points: Array,
    execution: StudyExecution = LOCAL_UNSAVED_EXECUTION,
) -> UncertaintyBands:
    """Bands (distribution along the ramp) of all outputs, from points (n, d) of the unit cube.

    execution : where and in how many processes the runs are done, and where their results are stored

    Raises RuntimeError if the law refuses all samples; ValueError, RuntimeError as `evaluate_runs`.
    """
    first = uncertainty_study.run_evaluator.execute_run(-1, uncertainty_study.common_settings)
    if "error" in first:
        raise ValueError(
            f"{uncertainty_study.study_subject}: fails already with the values of the file: {first['error']}"
        )
    nominal = {name: np.asarray(first["columns"][name]) for name in uncertainty_study.output_units}
    runs = uncertainty_study.list_run_settings(unit_cube_points)
    samples = evaluate_runs(
        uncertainty_study.run_evaluator,
        runs,
        uncertainty_study.output_units,
        uncertainty_study.loads.size,
        execution,
    )
    refused, accepted = (
        summarise_refusals(uncertainty_study, unit_cube_points, samples),
        samples.accepted_mask,
    )
    if not np.any(accepted):
        raise RuntimeError(
            f"all {len(unit_cube_points)} samples are rejected, state narrower distributions; the first: "
            f"{refused.refusal_message}"
        )
    statistics = {
        name: np.stack([_compute_statistics(row, accepted) for row in value], axis=1)
        for name, value in samples.output_arrays.items()
    }
    return UncertaintyBands(
        loads=uncertainty_study.loads,
        quantiles={name: value[2:] for name, value in statistics.items()},
        mean={name: value[0] for name, value in statistics.items()},
        standard_deviation={name: value[1] for name, value in statistics.items()},
        nominal_outputs=nominal,
        sampled_outputs=samples,
        refused_samples=refused,
        output_units=uncertainty_study.output_units,
    )


def _compute_statistics(output_samples: SinglePrecisionArray, accepted_mask: Mask) -> Array:
    """Mean, standard deviation and quantiles of one output at one load, over the samples.

    Quantiles are linear between samples.

    output_samples : values (n) of the output
    accepted_mask  : whether a sample is used (n)
    """
    values = np.sort(output_samples[accepted_mask]).astype(np.float64)
    positions = np.array(QUANTILES) * (values.size - 1)
    return np.array([values.mean(), values.std(), *np.interp(positions, np.arange(values.size), values)])


def summarise_refusals(
    uncertainty_study: UncertaintyStudy, unit_cube_points: Array, sampled_outputs: SampledOutputs
) -> RefusedSamples:
    """Summary of the samples that the law refuses: their number, and the first one with the error message."""
    if not sampled_outputs.error_messages:
        return RefusedSamples(0, {}, "")
    first, reason = next(iter(sampled_outputs.error_messages.items()))
    example = draw_samples(uncertainty_study.uncertain_parameters, unit_cube_points[first : first + 1])
    return RefusedSamples(
        len(sampled_outputs.error_messages),
        {name: float(value[0]) for name, value in example.items()},
        reason,
    )


def draw_independent_point_sets(
    uncertainty_study: UncertaintyStudy, point_count: int, seed: int
) -> tuple[Array, Array]:
    """Two independent sets of points (count, d) of the unit cube: for bands and indices, for indices only."""
    d = len(uncertainty_study.uncertain_parameters)
    both = draw_unit_cube_points(point_count, 2 * d, seed)
    return both[:, :d], both[:, d:]


MAX_LOADS_WITH_SOBOL_INDICES = 21
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
class RampSensitivity:
    """Sobol' indices along the load ramp.

    loads             : (m) [SI] loads of the ramp
    parameter_names   : names of the uncertain parameters (d)
    indices_by_output : {output: indices (m, d)}
    base_sample_count : number of base samples
    """

    loads: Array
    parameter_names: tuple[str, ...]
    indices_by_output: Mapping[str, SobolIndices]
    base_sample_count: int


def estimate_sobol_indices(f_A: Array, f_B: Array, f_AB: Array) -> SobolIndices:
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

    def compute_half_width(estimator_terms: Array, sobol_indices: Array) -> Array:
        """Half width of the 95 % interval of Sobol' indices: 1.96 standard errors (delta method).

        estimator_terms : (d, s, n) terms whose mean over n base samples, divided by the variance of the
            output, is the index
        """
        deviation = np.std(estimator_terms - sobol_indices.T[:, :, None] * variance, axis=2)
        return np.asarray(1.96 * (deviation / level).T / np.sqrt(n))

    return SobolIndices(
        first, compute_half_width(b * (ab - a), first), total, compute_half_width(0.5 * (a - ab) ** 2, total)
    )


def compute_sensitivity(
    uncertainty_study: UncertaintyStudy,
    uncertainty_bands: UncertaintyBands,
    points_A: Array,
    points_B: Array,
    execution: StudyExecution = LOCAL_UNSAVED_EXECUTION,
) -> RampSensitivity:
    """Sobol' indices of all quantities of a joint along the load ramp.

    uncertainty_bands  : bands of a set of points that begins with A
    points_A, points_B : two independent sets of points (n, d) of the unit cube, n a power of two
    """
    n, d = points_A.shape
    load_indices = np.unique(
        np.linspace(0, uncertainty_study.loads.size - 1, MAX_LOADS_WITH_SOBOL_INDICES).astype(int)
    )
    load_indices = load_indices[uncertainty_study.loads[load_indices] > 0.0]
    loads = uncertainty_study.loads[load_indices]
    sets = [points_B]
    for i in range(d):
        mixed = points_A.copy()
        mixed[:, i] = points_B[:, i]
        sets.append(mixed)
    assert isinstance(uncertainty_study.run_evaluator, JointRampEvaluator)
    found = evaluate_runs(
        replace(uncertainty_study.run_evaluator, evaluated_load_indices=load_indices),
        uncertainty_study.list_run_settings(np.concatenate(sets)),
        uncertainty_study.output_units,
        loads.size,
        execution,
        SOBOL_RUNS_FILE,
        "indices",
    ).output_arrays
    by_output = {}
    for name, value in found.items():
        f_A = uncertainty_bands.sampled_outputs.output_arrays[name][load_indices, :n].astype(np.float64)
        f = value.astype(np.float64).reshape(loads.size, d + 1, n)
        by_output[name] = estimate_sobol_indices(f_A, f[:, 0], np.moveaxis(f[:, 1:], 1, 0))
    return RampSensitivity(
        loads, tuple(parameter.name for parameter in uncertainty_study.uncertain_parameters), by_output, n
    )
