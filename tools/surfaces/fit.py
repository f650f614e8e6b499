"""Fit of the self-affine law to a series: generalised least squares, range search, test of straightness."""

from bisect import bisect_left
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from jointfmu.quantity import Array

from .spectrum import ScaleSeries

FLOOR = 0.03
"""Least standard deviation of ln(value) from the law at every scale [1]."""
CORRELATION = 0.5
"""Length in ln(scale) over which deviations from the law hang together [1]."""
DRIFT = 0.1
"""Largest drift of D over a range that counts as straight, unless within its own two standard errors."""
MOST_DRIFT = 0.7
"""Largest drift of D that counts as straight however unsure it is, well below that from 1 to 2."""
RUN = 0.8
"""Drift of D over all scales beyond which D counts as running through its interval from 1 to 2."""
ENOUGH = 1.5
"""Length of a straight range, in decades, that counts although D runs through its interval beyond it."""
BOUND = 0.02
"""The fit keeps H that far from 0 and 1."""
ROUGHEST = 0.25
"""Largest standard deviation of ln(value) from the law that counts as self-affine."""
SHORTEST = 0.5
"""Least length of a range that the search considers, in decades."""
INFLATION = 1.15
"""Factor on the covariance of the result, from simulation (benchmarks/surface_round_trip.py: coverage)."""
OFFSET = 2.0
"""Standard deviation of the offset before it is fitted [1]: it may hardly exceed the shortest value."""
UNSURE = 0.3
"""Values with a larger variance of ln(value) are left out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfAffineLaw:
    """Self-affine law of a series.

    H, level  : Hurst exponent, ln Phi [m2] at the wavelength `reference` [m]
    covariance : (2, 2) of (H, level)
    offset    : constant share of the shortest value: noise above 0, missing short waves below
    deviation : standard deviation of ln(value) from the law beyond chance
    drift, drift_error : change of D over the range, its standard error
    low, high : range [m]; straight : whether the law holds there
    runs      : whether the range is a short piece of a series over which D runs through its whole interval
    """

    H: float
    level: float
    reference: float
    covariance: Array
    offset: float
    deviation: float
    drift: float
    drift_error: float
    low: float
    high: float
    runs: bool = False

    @property
    def straight(self) -> bool:
        """Whether drift and deviation stay within what counts as self-affine."""
        allowed = max(DRIFT, min(2.0 * self.drift_error, MOST_DRIFT))
        return abs(self.drift) <= allowed and self.deviation <= ROUGHEST and not self.runs

    @property
    def at_bound(self) -> bool:
        """Whether H lies at an end of its interval, where its standard error means nothing."""
        return not 1.5 * BOUND < self.H < 1.0 - 1.5 * BOUND

    @property
    def decades(self) -> float:
        return float(np.log10(self.high / self.low))


def fit(series: ScaleSeries, low: float | None = None, high: float | None = None) -> SelfAffineLaw:
    """Fit over the given range of scales [m], or over the longest straight one.

    Raises ValueError if fewer than four values lie in the range.
    """
    sure = np.diag(series.covariance(0.5)) < UNSURE
    if low is not None and high is not None:
        inside = (series.scale >= low * (1 - 1e-9)) & (series.scale <= high * (1 + 1e-9))
        if (inside & sure).sum() < 4:
            raise ValueError(
                f"range {low:g} {high:g} m holds {int((inside & sure).sum())} values of the {series.method} "
                f"method, at least 4 are needed; allowed is within {series.scale[sure][0]:.3g} "
                f"{series.scale[sure][-1]:.3g} m"
            )
        return _fit(series.within(inside & sure))
    return _search(series.within(sure))


def _search(series: ScaleSeries) -> SelfAffineLaw:
    """The longest straight range; if there is none, the straightest."""
    n = series.scale.size
    step = max(1, n // 10)
    starts, ends = range(0, n - 3, step), range(n, 3, -step)
    windows = sorted(
        (
            (np.log10(series.scale[j - 1] / series.scale[i]), -i, j)
            for i in starts
            for j in ends
            if j - i >= 4
        ),
        reverse=True,
    )
    whole = _fit(series)
    runs = abs(whole.drift) > max(RUN, 2.0 * whole.drift_error)
    tried: list[SelfAffineLaw] = []
    for length, negative, j in windows:
        if length < SHORTEST and tried:
            break
        candidate = _fit(series.within(np.arange(-negative, j)))
        candidate = replace(candidate, runs=runs and candidate.decades < ENOUGH)
        if candidate.straight:
            return candidate
        tried.append(candidate)
    return min(tried, key=lambda fitted: abs(fitted.drift) + fitted.deviation)


def _fit(series: ScaleSeries) -> SelfAffineLaw:
    x, y = np.log(series.scale), np.log(series.value)
    reference = float(np.exp(x.mean()))
    offset = series.method == "structure"
    start = np.array([0.5, 0.0, 0.0][: 3 if offset else 2])
    chance = series.covariance(0.5)

    def law(p: Array) -> Array:
        expected = series.expected(p[0]) * reference ** (-2.0 * p[0])
        return np.asarray(np.log(expected + (p[2] * expected[0] if offset else 0.0)) + p[1])

    start[1] = np.mean(y - law(start))
    deviation, p = FLOOR, start
    for _ in range(3):
        whiten = _whitening(chance + deviation**2 * _hang(x))
        known = y + 0.5 * np.diag(chance)

        def residual(p: Array, whiten: Array = whiten, known: Array = known) -> Array:
            white = whiten @ (known - law(p))
            return np.append(white, p[2] / OFFSET) if offset else np.asarray(white)

        bounds = ([BOUND, -np.inf, -0.9][: p.size], [1.0 - BOUND, np.inf, np.inf][: p.size])
        result = least_squares(residual, p, bounds=bounds, x_scale=np.array([0.1, 0.1, 0.1])[: p.size])
        p = result.x
        chance = series.covariance(float(np.clip(p[0], 0.05, 0.95)))
        deviation = _excess(known - law(p), chance, x, p.size)
    drift, drift_error = _drift(x, known - law(p), chance)
    covariance = INFLATION * np.linalg.inv(result.jac.T @ result.jac)[:2, :2]
    return SelfAffineLaw(
        H=float(p[0]),
        level=float(p[1]),
        reference=reference,
        covariance=covariance,
        offset=float(p[2]) if offset else 0.0,
        deviation=deviation,
        drift=drift,
        drift_error=drift_error,
        low=float(series.scale[0]),
        high=float(series.scale[-1]),
    )


def _whitening(covariance: Array) -> Array:
    """What makes residuals of this covariance independent, of variance 1.

    An inverse: scipy's triangular solver wakes threads that cost fifty times so small a solution.
    """
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))


def _hang(x: Array) -> Array:
    return np.asarray(np.exp(-np.abs(x[:, None] - x) / CORRELATION))


def _excess(residual: Array, chance: Array, x: Array, parameters: int) -> float:
    """Standard deviation beyond chance that makes the weighted residual as large as expected."""
    freedom = max(x.size - parameters, 1)
    hang, tried = _hang(x), np.geomspace(FLOOR, 3.0, 60)

    def enough(deviation: float) -> bool:
        return bool(residual @ np.linalg.solve(chance + deviation**2 * hang, residual) <= freedom)

    return float(tried[min(bisect_left(tried, True, key=enough), tried.size - 1)])


def _drift(x: Array, residual: Array, chance: Array) -> tuple[float, float]:
    """Change of D over the range and its standard error, from one further, quadratic term."""
    whiten = _whitening(chance + FLOOR**2 * _hang(x))
    t = x - x.mean()
    columns = [np.ones_like(t), t, t**2]
    white = whiten @ np.stack(columns, axis=1)
    inverse = np.linalg.inv(white.T @ white)
    coefficients = inverse @ white.T @ (whiten @ residual)
    length = float(x[-1] - x[0])
    return float(-coefficients[2] * length), float(np.sqrt(inverse[2, 2]) * length)
