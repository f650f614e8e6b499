"""Fit of the self-affine law to a structure function or spectrum by generalised least squares.

The range of scales is given, or a search finds the longest range in which the surface is self-affine.
"""

from bisect import bisect_left
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from jointfmu.quantity import Array

from .spectrum import ScaleSeries

MIN_ASSUMED_LAW_DEVIATION = 0.03
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
MIN_HURST_DISTANCE_FROM_BOUNDS = 0.02
"""Smallest distance of the fitted H from 0 and from 1 [1]."""
MAX_LAW_DEVIATION = 0.25
"""Largest standard deviation of ln(value) from the law over a self-affine range [1]."""
MIN_RANGE_DECADES = 0.5
"""Shortest range [decades] that the search considers."""
COVARIANCE_CORRECTION_FACTOR = 1.15
"""Factor on the covariance of H and log_height_variance [1], from simulation
(studies/surfaces_explanation.py)."""
OFFSET_PRIOR_DEVIATION = 2.0
"""Prior standard deviation of the constant added to the law, over the value at the shortest scale [1]."""
MAX_LOG_VALUE_VARIANCE = 0.3
"""Largest variance of ln(value) of a scale [1]; scales with a larger variance are left out of the fit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfAffineLaw:
    """Self-affine law (power law of height variance) fitted to a structure function or spectrum.

    The law is Phi ~ frequency^(-2H): height variance Phi [m2] per unit of ln(frequency).

    H                    : Hurst exponent [1]
    log_height_variance  : ln(Phi) at the wavelength `reference_wavelength`, Phi in m2
    reference_wavelength : [m]
    parameter_covariance : (2, 2) of (H, log_height_variance)
    relative_offset      : constant added to the law, over its value at the shortest lag or wavelength [1]:
                           > 0 for noise, < 0 for missing short waves
    excess_deviation     : standard deviation of ln(value) from the law beyond statistical scatter [1]
    dimension_drift      : change of the fractal dimension D over the range of the fit [1]
    dimension_drift_standard_error : standard error of `dimension_drift` [1]
    min_scale, max_scale : range of the fit: lags or wavelengths [m]
    is_range_too_short_for_drift   : whether D covers its whole interval 1 to 2 over all lags or wavelengths,
                                     and the range of the fit is shorter than SUFFICIENT_RANGE_DECADES
    """

    H: float
    log_height_variance: float
    reference_wavelength: float
    parameter_covariance: Array
    relative_offset: float
    excess_deviation: float
    dimension_drift: float
    dimension_drift_standard_error: float
    min_scale: float
    max_scale: float
    is_range_too_short_for_drift: bool = False

    @property
    def is_self_affine(self) -> bool:
        """Whether the law holds over the range: drift and deviation are within their limits."""
        allowed = max(
            MAX_DIMENSION_DRIFT, min(2.0 * self.dimension_drift_standard_error, MAX_UNCERTAIN_DIMENSION_DRIFT)
        )
        return (
            abs(self.dimension_drift) <= allowed
            and self.excess_deviation <= MAX_LAW_DEVIATION
            and not self.is_range_too_short_for_drift
        )

    @property
    def is_at_bound(self) -> bool:
        """Whether H lies at an end of its interval; its standard error is then invalid."""
        return not 1.5 * MIN_HURST_DISTANCE_FROM_BOUNDS < self.H < 1.0 - 1.5 * MIN_HURST_DISTANCE_FROM_BOUNDS

    @property
    def range_decades(self) -> float:
        """Length of the range of scales [decades]."""
        return float(np.log10(self.max_scale / self.min_scale))


def fit_self_affine_law(
    scale_series: ScaleSeries, min_scale: float | None = None, max_scale: float | None = None
) -> SelfAffineLaw:
    """Fit the self-affine law over a range of lags or wavelengths [m], or over the longest self-affine range.

    Raises ValueError if the given range has fewer than four values.
    """
    sure = np.diag(scale_series.log_value_covariance(0.5)) < MAX_LOG_VALUE_VARIANCE
    if min_scale is not None and max_scale is not None:
        inside = (scale_series.lag_or_wavelength >= min_scale * (1 - 1e-9)) & (
            scale_series.lag_or_wavelength <= max_scale * (1 + 1e-9)
        )
        if (inside & sure).sum() < 4:
            raise ValueError(
                f"range {min_scale:g} to {max_scale:g} m holds {int((inside & sure).sum())} values of the "
                f"{scale_series.series_method} method, at least 4 are needed; state a range within "
                f"{scale_series.lag_or_wavelength[sure][0]:.3g} to "
                f"{scale_series.lag_or_wavelength[sure][-1]:.3g} m"
            )
        return _fit_law_to_series(scale_series.select_scales(inside & sure))
    return _fit_longest_self_affine_range(scale_series.select_scales(sure))


def _fit_longest_self_affine_range(scale_series: ScaleSeries) -> SelfAffineLaw:
    """Fit the self-affine law over the longest range in which it holds.

    If it holds over no range, use the range with the smallest sum of two numbers: change of the fractal
    dimension over the range, and `excess_deviation`.
    """
    n = scale_series.lag_or_wavelength.size
    step = max(1, n // 10)
    starts, ends = range(0, n - 3, step), range(n, 3, -step)
    windows = sorted(
        (
            (np.log10(scale_series.lag_or_wavelength[j - 1] / scale_series.lag_or_wavelength[i]), -i, j)
            for i in starts
            for j in ends
            if j - i >= 4
        ),
        reverse=True,
    )
    complete = _fit_law_to_series(scale_series)
    covers_interval = abs(complete.dimension_drift) > max(
        FULL_INTERVAL_DIMENSION_DRIFT, 2.0 * complete.dimension_drift_standard_error
    )
    candidates: list[SelfAffineLaw] = []
    for length, negative_start, j in windows:
        if length < MIN_RANGE_DECADES and candidates:
            break
        candidate = _fit_law_to_series(scale_series.select_scales(np.arange(-negative_start, j)))
        is_range_short = candidate.range_decades < SUFFICIENT_RANGE_DECADES
        candidate = replace(candidate, is_range_too_short_for_drift=covers_interval and is_range_short)
        if candidate.is_self_affine:
            return candidate
        candidates.append(candidate)
    return min(candidates, key=lambda law: abs(law.dimension_drift) + law.excess_deviation)


def _fit_law_to_series(scale_series: ScaleSeries) -> SelfAffineLaw:
    """Fit the self-affine law to a whole series by generalised least squares with iterated covariance."""
    x, y = np.log(scale_series.lag_or_wavelength), np.log(scale_series.smoothed_value)
    reference = float(np.exp(x.mean()))
    offset = scale_series.series_method == "structure"
    start = np.array([0.5, 0.0, 0.0][: 3 if offset else 2])
    scatter = scale_series.log_value_covariance(0.5)

    def log_self_affine_law(law_parameters: Array) -> Array:
        """Logarithm of the self-affine law at all lags or wavelengths.

        law_parameters : Hurst exponent, `log_height_variance`, and for structure functions the relative
                         offset
        """
        expected = scale_series.expected_value(law_parameters[0]) * reference ** (-2.0 * law_parameters[0])
        return np.asarray(
            np.log(expected + (law_parameters[2] * expected[0] if offset else 0.0)) + law_parameters[1]
        )

    start[1] = np.mean(y - log_self_affine_law(start))
    deviation, p = MIN_ASSUMED_LAW_DEVIATION, start
    for _ in range(3):
        whiten = _whitening_matrix(scatter + deviation**2 * _correlation_matrix(x))
        unbiased = y + 0.5 * np.diag(scatter)

        def whitened_residuals(
            law_parameters: Array, whitening_matrix: Array = whiten, log_values: Array = unbiased
        ) -> Array:
            """Residuals of the law with covariance 1 (whitened); for structure functions also of the offset.

            The last one is the relative offset over its prior standard deviation.
            """
            white = whitening_matrix @ (log_values - log_self_affine_law(law_parameters))
            return (
                np.append(white, law_parameters[2] / OFFSET_PRIOR_DEVIATION) if offset else np.asarray(white)
            )

        bounds = (
            [MIN_HURST_DISTANCE_FROM_BOUNDS, -np.inf, -0.9][: p.size],
            [1.0 - MIN_HURST_DISTANCE_FROM_BOUNDS, np.inf, np.inf][: p.size],
        )
        result = least_squares(
            whitened_residuals, p, bounds=bounds, x_scale=np.array([0.1, 0.1, 0.1])[: p.size]
        )
        p = result.x
        scatter = scale_series.log_value_covariance(float(np.clip(p[0], 0.05, 0.95)))
        deviation = _excess_deviation(unbiased - log_self_affine_law(p), scatter, x, p.size)
    drift, drift_error = _estimate_dimension_drift(x, unbiased - log_self_affine_law(p), scatter)
    covariance = COVARIANCE_CORRECTION_FACTOR * np.linalg.inv(result.jac.T @ result.jac)[:2, :2]
    return SelfAffineLaw(
        H=float(p[0]),
        log_height_variance=float(p[1]),
        reference_wavelength=reference,
        parameter_covariance=covariance,
        relative_offset=float(p[2]) if offset else 0.0,
        excess_deviation=deviation,
        dimension_drift=drift,
        dimension_drift_standard_error=drift_error,
        min_scale=float(scale_series.lag_or_wavelength[0]),
        max_scale=float(scale_series.lag_or_wavelength[-1]),
    )


def _whitening_matrix(residual_covariance: Array) -> Array:
    """Matrix that transforms residuals with this covariance to independent ones of variance 1.

    The inverse is computed: for matrices this small, the threads of scipy's triangular solver take fifty
    times as long.
    """
    return np.asarray(np.linalg.inv(np.linalg.cholesky(residual_covariance)))


def _correlation_matrix(log_lag_or_wavelength: Array) -> Array:
    """Correlation matrix (n, n) [1] of the deviations from the self-affine law at n lags or wavelengths.

    log_lag_or_wavelength : (n) natural logarithms
    """
    return np.asarray(
        np.exp(
            -np.abs(log_lag_or_wavelength[:, None] - log_lag_or_wavelength) / CORRELATION_LENGTH_IN_LN_SCALE
        )
    )


def _excess_deviation(
    law_residuals: Array, statistical_covariance: Array, log_lag_or_wavelength: Array, parameter_count: int
) -> float:
    """Standard deviation [1] of ln(value) from the self-affine law, in excess of the statistical scatter.

    With this deviation, chi-squared has its expected value.

    statistical_covariance : covariance (n, n) of the residual from statistics
    """
    degrees_of_freedom = max(log_lag_or_wavelength.size - parameter_count, 1)
    correlation, deviations = (
        _correlation_matrix(log_lag_or_wavelength),
        np.geomspace(MIN_ASSUMED_LAW_DEVIATION, 3.0, 60),
    )

    def is_deviation_sufficient(trial_deviation: float) -> bool:
        """Whether a standard deviation from the law lowers chi-squared to its expected value or below.

        trial_deviation : standard deviation [1] of ln(value) in excess of the statistical scatter
        """
        chi_squared = law_residuals @ np.linalg.solve(
            statistical_covariance + trial_deviation**2 * correlation, law_residuals
        )
        return bool(chi_squared <= degrees_of_freedom)

    return float(
        deviations[min(bisect_left(deviations, True, key=is_deviation_sufficient), deviations.size - 1)]
    )


def _estimate_dimension_drift(
    log_lag_or_wavelength: Array, law_residuals: Array, statistical_covariance: Array
) -> tuple[float, float]:
    """Change of the fractal dimension D over the range of lags or wavelengths, and its standard error.

    Both come from an additional quadratic term in ln(scale).
    """
    whiten = _whitening_matrix(
        statistical_covariance + MIN_ASSUMED_LAW_DEVIATION**2 * _correlation_matrix(log_lag_or_wavelength)
    )
    t = log_lag_or_wavelength - log_lag_or_wavelength.mean()
    columns = [np.ones_like(t), t, t**2]
    white = whiten @ np.stack(columns, axis=1)
    inverse = np.linalg.inv(white.T @ white)
    coefficients = inverse @ white.T @ (whiten @ law_residuals)
    length = float(log_lag_or_wavelength[-1] - log_lag_or_wavelength[0])
    return float(-coefficients[2] * length), float(np.sqrt(inverse[2, 2]) * length)
