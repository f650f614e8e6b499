"""Sobol' indices: which uncertain parameter the spread of an output comes from.

First order and total by the estimators of Saltelli et al. 2010 (doi:10.1016/j.cpc.2009.09.018) in
scipy.stats.sobol_indices; 95 % confidence intervals by the variance of the estimators' terms, as if the
samples were independent, which for a Sobol' sequence is on the safe side.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import sobol_indices

from jointfmu.quantity import Array

from .problem import Problem
from .propagate import run

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
