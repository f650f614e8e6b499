"""Covariance of least-squares parameters if the residuals are correlated in time.

An autoregressive model describes the residuals of each measured column: Yule-Walker equations, order by the
Bayesian information criterion (Brockwell and Davis, Time Series: Theory and Methods, 1991, sections 8.1 and
9.3). With the covariance R of the residuals that follows from it, the covariance of the parameters is
(J^T J)^-1 J^T R J (J^T J)^-1. Different columns count as independent.
"""

from collections.abc import Sequence

import numpy as np
from scipy import stats
from scipy.linalg import solve_toeplitz

from jointfmu.quantity import Array

CONFIDENCE_LEVEL = 0.95
"""Confidence level of the intervals [1]."""
MAX_MODEL_ORDER_PER_DECADE = 10.0
"""Largest order of an autoregressive model over the decimal logarithm of the number of residuals [1]."""


def estimate_spectrum(residuals: Array) -> Array:
    """Estimate the power spectrum of residuals (n) [1] at the frequencies of `numpy.fft.fft` of 2 n points.

    Its mean is the variance; it is constant for independent residuals.
    """
    n = residuals.size
    max_order = min(int(MAX_MODEL_ORDER_PER_DECADE * np.log10(n)), n // 4)
    autocovariance = np.fft.irfft(np.abs(np.fft.rfft(residuals, 2 * n)) ** 2)[: max_order + 1] / n
    autocovariance[0] = max(autocovariance[0], np.finfo(float).tiny) * (1.0 + 1e-12)
    models = []
    for order in range(max_order + 1):
        lags = autocovariance[1 : order + 1]
        coefficients = solve_toeplitz(autocovariance[:order], lags) if order else lags
        variance = autocovariance[0] - coefficients @ lags
        if variance > 0.0:
            models.append((n * np.log(variance) + np.log(n) * order, variance, coefficients))
    _, variance, coefficients = min(models, key=lambda model: model[0])
    transfer = np.fft.fft(np.concatenate([[1.0], -coefficients]), 2 * n)
    return np.asarray(variance / np.abs(transfer) ** 2)


def whiten_jacobian(jacobian: Array, residuals: Sequence[Array]) -> tuple[Array, float]:
    """Jacobian (k, k) of k independent residuals of variance 1 that gives the covariance of the parameters.

    The covariance allows for residuals that are correlated in time.

    jacobian  : derivatives (n, k) [1] of all residuals, column after column
    residuals : residuals of each measured column [1], at the solution

    Returns also the quantile of Student's t for CONFIDENCE_LEVEL. It has the degrees of freedom of the
    estimated variance of correlated residuals: n (mean spectrum)^2 / (mean squared spectrum).
    """
    u, s, rows = np.linalg.svd(jacobian, full_matrices=False)
    middle, degrees_of_freedom, first = np.zeros((s.size, s.size)), -float(s.size), 0
    for column in residuals:
        spectrum = estimate_spectrum(column)
        transformed = np.fft.fft(u[first : first + column.size], 2 * column.size, axis=0)
        middle += ((transformed.conj().T * spectrum) @ transformed).real / spectrum.size
        degrees_of_freedom += column.size * float(np.mean(spectrum) ** 2 / np.mean(spectrum**2))
        first += column.size
    middle *= first / (first - s.size)
    reduced = np.linalg.solve(np.linalg.cholesky(middle), s[:, None] * rows)
    return reduced, float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE_LEVEL, max(degrees_of_freedom, 1.0)))
