"""Fit of the self-affine law to a structure function or spectrum by generalised least squares.

The range of scales is given, or a search finds the longest range in which the surface is self-affine.
"""

from bisect import bisect_left
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from jointfmu.quantity import Array

from .spectrum import ScaleSeries

MIN_LAW_DEVIATION = 0.03
"""Least standard deviation [1] of ln(value) from the law that the fit assumes, at each scale."""
CORRELATION_LENGTH_IN_LN_SCALE = 0.5
"""Correlation length in ln(scale) [1] of the deviations from the law."""
MAX_DIMENSION_DRIFT = 0.1
"""Largest drift of D over a self-affine range [1]; a larger one is allowed within two standard errors."""
MAX_UNCERTAIN_DIMENSION_DRIFT = 0.7
"""Largest drift of D over a self-affine range [1] for any standard error; well below the interval 1 to 2."""
FULL_INTERVAL_DIMENSION_DRIFT = 0.8
"""Drift of D over all scales [1], above which D covers the whole interval from 1 to 2 (no fractal)."""
SUFFICIENT_RANGE_DECADES = 1.5
"""Shortest range [decades] that counts as self-affine if D covers its whole interval over all scales."""
HURST_MARGIN = 0.02
"""Smallest distance of the fitted H from 0 and from 1 [1]."""
MAX_LAW_DEVIATION = 0.25
"""Largest standard deviation of ln(value) from the law over a self-affine range [1]."""
MIN_RANGE_DECADES = 0.5
"""Shortest range [decades] that the search considers."""
COVARIANCE_CORRECTION_FACTOR = 1.15
"""Factor on the covariance of H and log_power [1], from simulation (studies/surfaces_explanation.py)."""
OFFSET_PRIOR_DEVIATION = 2.0
"""Prior standard deviation of the constant added to the law, over the value at the shortest scale [1]."""
MAX_LOG_VARIANCE = 0.3
"""Largest variance of ln(value) of a scale [1]; scales with a larger variance are left out of the fit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfAffineLaw:
    """Self-affine law (power law of height variance) fitted to a structure function or spectrum.

    H           : Hurst exponent [1]
    log_power   : ln(Phi) at the wavelength `reference_wavelength`, Phi in m2
    reference_wavelength : [m]
    covariance  : (2, 2) of (H, log_power)
    relative_offset : constant added to the law, over its value at the shortest scale [1]: > 0 for noise, < 0
                  for missing short waves
    excess_deviation : standard deviation of ln(value) from the law beyond statistical scatter [1]
    dimension_drift : change of D over the range [1]
    drift_error : standard error of the drift [1]
    min_scale, max_scale : range of scales [m]
    drift_covers_dimensions : whether D covers its whole interval 1 to 2 over all scales, and this range is
        short
    """

    H: float
    log_power: float
    reference_wavelength: float
    covariance: Array
    relative_offset: float
    excess_deviation: float
    dimension_drift: float
    drift_error: float
    min_scale: float
    max_scale: float
    drift_covers_dimensions: bool = False

    @property
    def is_self_affine(self) -> bool:
        """Whether the law holds over the range: drift and deviation are within their limits."""
        allowed = max(MAX_DIMENSION_DRIFT, min(2.0 * self.drift_error, MAX_UNCERTAIN_DIMENSION_DRIFT))
        return (
            abs(self.dimension_drift) <= allowed
            and self.excess_deviation <= MAX_LAW_DEVIATION
            and not self.drift_covers_dimensions
        )

    @property
    def is_at_bound(self) -> bool:
        """Whether H lies at an end of its interval; its standard error is then invalid."""
        return not 1.5 * HURST_MARGIN < self.H < 1.0 - 1.5 * HURST_MARGIN

    @property
    def range_decades(self) -> float:
        """Length of the range of scales [decades]."""
        return float(np.log10(self.max_scale / self.min_scale))


def fit_law(
    series: ScaleSeries, min_scale: float | None = None, max_scale: float | None = None
) -> SelfAffineLaw:
    """Fit the self-affine law over a range of scales [m], or over the longest self-affine range.

    Raises ValueError if the given range has fewer than four values.
    """
    sure = np.diag(series.covariance(0.5)) < MAX_LOG_VARIANCE
    if min_scale is not None and max_scale is not None:
        inside = (series.scale >= min_scale * (1 - 1e-9)) & (series.scale <= max_scale * (1 + 1e-9))
        if (inside & sure).sum() < 4:
            raise ValueError(
                f"range {min_scale:g} {max_scale:g} m holds {int((inside & sure).sum())} values of the "
                f"{series.method} "
                f"method, at least 4 are needed; allowed is within {series.scale[sure][0]:.3g} "
                f"{series.scale[sure][-1]:.3g} m"
            )
        return _fit_series(series.select_scales(inside & sure))
    return _search_range(series.select_scales(sure))


def _search_range(series: ScaleSeries) -> SelfAffineLaw:
    """Fit the self-affine law over the longest range in which it holds.

    If it holds over no range: fit over the range with the smallest sum of drift and deviation.
    """
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
    complete = _fit_series(series)
    covers_interval = abs(complete.dimension_drift) > max(
        FULL_INTERVAL_DIMENSION_DRIFT, 2.0 * complete.drift_error
    )
    candidates: list[SelfAffineLaw] = []
    for length, negative_start, j in windows:
        if length < MIN_RANGE_DECADES and candidates:
            break
        candidate = _fit_series(series.select_scales(np.arange(-negative_start, j)))
        is_range_short = candidate.range_decades < SUFFICIENT_RANGE_DECADES
        candidate = replace(candidate, drift_covers_dimensions=covers_interval and is_range_short)
        if candidate.is_self_affine:
            return candidate
        candidates.append(candidate)
    return min(candidates, key=lambda law: abs(law.dimension_drift) + law.excess_deviation)


def _fit_series(series: ScaleSeries) -> SelfAffineLaw:
    """Fit the law to all values of a series, by generalised least squares with iterated covariance."""
    x, y = np.log(series.scale), np.log(series.value)
    reference = float(np.exp(x.mean()))
    offset = series.method == "structure"
    start = np.array([0.5, 0.0, 0.0][: 3 if offset else 2])
    scatter = series.covariance(0.5)

    def log_law(law_parameters: Array) -> Array:
        """Logarithm of the self-affine law at all scales; parameters (Hurst exponent, log_power, offset)."""
        expected = series.expected_value(law_parameters[0]) * reference ** (-2.0 * law_parameters[0])
        return np.asarray(
            np.log(expected + (law_parameters[2] * expected[0] if offset else 0.0)) + law_parameters[1]
        )

    start[1] = np.mean(y - log_law(start))
    deviation, p = MIN_LAW_DEVIATION, start
    for _ in range(3):
        whiten = _whitening_matrix(scatter + deviation**2 * _correlation_matrix(x))
        unbiased = y + 0.5 * np.diag(scatter)

        def residual(law_parameters: Array, whitening: Array = whiten, log_values: Array = unbiased) -> Array:
            """Whitened residual of the law, then of the prior of the offset."""
            white = whitening @ (log_values - log_law(law_parameters))
            return (
                np.append(white, law_parameters[2] / OFFSET_PRIOR_DEVIATION) if offset else np.asarray(white)
            )

        bounds = ([HURST_MARGIN, -np.inf, -0.9][: p.size], [1.0 - HURST_MARGIN, np.inf, np.inf][: p.size])
        result = least_squares(residual, p, bounds=bounds, x_scale=np.array([0.1, 0.1, 0.1])[: p.size])
        p = result.x
        scatter = series.covariance(float(np.clip(p[0], 0.05, 0.95)))
        deviation = _excess_deviation(unbiased - log_law(p), scatter, x, p.size)
    drift, drift_error = _estimate_drift(x, unbiased - log_law(p), scatter)
    covariance = COVARIANCE_CORRECTION_FACTOR * np.linalg.inv(result.jac.T @ result.jac)[:2, :2]
    return SelfAffineLaw(
        H=float(p[0]),
        log_power=float(p[1]),
        reference_wavelength=reference,
        covariance=covariance,
        relative_offset=float(p[2]) if offset else 0.0,
        excess_deviation=deviation,
        dimension_drift=drift,
        drift_error=drift_error,
        min_scale=float(series.scale[0]),
        max_scale=float(series.scale[-1]),
    )


def _whitening_matrix(covariance: Array) -> Array:
    """Matrix that transforms residuals with this covariance to independent ones of variance 1.

    The inverse is computed: for matrices this small, the threads of scipy's triangular solver take fifty
    times as long.
    """
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))


def _correlation_matrix(log_scale: Array) -> Array:
    """Correlation matrix (n, n) [1] of the deviations from the law at ln(scale) x (n)."""
    return np.asarray(np.exp(-np.abs(log_scale[:, None] - log_scale) / CORRELATION_LENGTH_IN_LN_SCALE))


def _excess_deviation(
    residual: Array, statistical_covariance: Array, log_scale: Array, parameter_count: int
) -> float:
    """Standard deviation [1] of ln(value) from the law in excess of the statistical scatter.

    With this deviation, chi-squared has its expected value.

    statistical_covariance : covariance (n, n) of the residual from statistics
    """
    degrees_of_freedom = max(log_scale.size - parameter_count, 1)
    correlation, deviations = _correlation_matrix(log_scale), np.geomspace(MIN_LAW_DEVIATION, 3.0, 60)

    def is_sufficient(deviation: float) -> bool:
        """Whether this excess deviation lowers chi-squared to its expected value or below."""
        chi_squared = residual @ np.linalg.solve(
            statistical_covariance + deviation**2 * correlation, residual
        )
        return bool(chi_squared <= degrees_of_freedom)

    return float(deviations[min(bisect_left(deviations, True, key=is_sufficient), deviations.size - 1)])


def _estimate_drift(log_scale: Array, residual: Array, statistical_covariance: Array) -> tuple[float, float]:
    """Change of D over the range of scales, and its standard error.

    Both come from an additional quadratic term in ln(scale).
    """
    whiten = _whitening_matrix(statistical_covariance + MIN_LAW_DEVIATION**2 * _correlation_matrix(log_scale))
    t = log_scale - log_scale.mean()
    columns = [np.ones_like(t), t, t**2]
    white = whiten @ np.stack(columns, axis=1)
    inverse = np.linalg.inv(white.T @ white)
    coefficients = inverse @ white.T @ (whiten @ residual)
    length = float(log_scale[-1] - log_scale[0])
    return float(-coefficients[2] * length), float(np.sqrt(inverse[2, 2]) * length)
