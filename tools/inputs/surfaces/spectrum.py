"""Power spectral density and structure function of a profile or an areal map.

A `ScaleSeries` has values over scale. It also has the expectation and the covariance of these values for a
Gaussian self-affine surface of the same size and sampling, with which the fit weights each value.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from ..fractal import second_difference_ratio, structure_function_constant
from .heights import ArealMap, ScanHeights

SERIES_METHODS = ("structure", "psd")
"""Methods to describe heights over scale: structure function, power spectral density."""
CONTACT_SIDES = ("1", "2", "both")
"""Side of the contact that a single scan represents: 1 or 2 (the other side is smooth), or both (alike)."""
MIN_SERIES_VALUE = 1e-200
"""Smallest value of a series [m2]: constant heights also have a logarithm."""
SMOOTHING_KERNEL_WIDTH = 0.3
"""Standard deviation of the Gaussian kernel in ln(frequency) [1]; it smooths discrete waves with a frequency
ratio up to 2."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaleSeries:
    """Structure function or spectrum of heights over J lags or wavelengths, and its statistics.

    series_method        : "structure" or "psd"
    scan_direction       : "profile", "x", "y" or "areal"
    lag_or_wavelength    : (J,) [m], increasing
    smoothed_value       : (J,) [m2] V(tau) = 4 S(tau) - S(2 tau), or Phi = frequency times power spectral
                           density
    structure_or_psd     : (J,) S(tau) [m2], or power spectral density [m3]
    expected_value       : function of the Hurst exponent H: `smoothed_value` (J,) for Phi = frequency^(-2H)
    log_value_covariance : function of the Hurst exponent H: covariance (J, J) [1] of ln(smoothed_value)
    """

    series_method: str
    scan_direction: str
    lag_or_wavelength: Array
    smoothed_value: Array
    structure_or_psd: Array
    expected_value: Callable[[float], Array]
    log_value_covariance: Callable[[float], Array]

    def select_scales(self, scale_selection: NDArray[Any]) -> "ScaleSeries":
        """Select scales of the series by mask or indices; returns a new series."""
        return replace(
            self,
            lag_or_wavelength=self.lag_or_wavelength[scale_selection],
            smoothed_value=self.smoothed_value[scale_selection],
            structure_or_psd=self.structure_or_psd[scale_selection],
            expected_value=lambda H: self.expected_value(H)[scale_selection],
            log_value_covariance=lambda H: self.log_value_covariance(H)[
                np.ix_(scale_selection, scale_selection)
            ],
        )


COVARIANCE_MODE_COUNT = 256
"""Number of Fourier modes per direction in a covariance; shorter waves hardly contribute."""


def structure_function(heights: ScanHeights, scan_direction: str) -> ScaleSeries:
    """Structure function along a profile, along x or y of a map, or the mean of both directions ("areal").

    S(tau) = <(z(x + tau) - z(x))^2>, V(tau) = <(z(x + tau) - 2 z(x) + z(x - tau))^2>. Pairs with a missing
    point are left out. Lags tau are from 2 spacings to an eighth of the length.
    """
    if scan_direction == "areal" and isinstance(heights, ArealMap):
        return _average_structure_functions(heights)
    z = np.atleast_2d(heights.z)
    z, spacing = (
        (z.T, heights.dy) if isinstance(heights, ArealMap) and scan_direction == "y" else (z, heights.dx)
    )
    lags, value, raw = _mean_square_differences(z)
    length = z.shape[1] * spacing
    lag = lags * spacing
    return _smooth_structure_function(scan_direction, lag, value, raw, _line_covariance(lag, length))


def _mean_square_differences(z: Array) -> tuple[Array, Array, Array]:
    """Lags [points], and mean square of second and of first differences of the heights, V and S [m2].

    S(lag) is the structure function; a tilt of the surface cancels from V(lag). Both are averaged over the
    rows of z.
    """
    lags = np.unique(np.round(np.exp(np.arange(np.log(2.0), np.log(z.shape[1] // 8), 0.08))).astype(int))
    value, raw = np.empty(lags.size), np.empty(lags.size)
    for i, lag in enumerate(lags):
        step = z[:, lag:] - z[:, :-lag]
        raw[i] = _mean_square_of_finite(step)
        value[i] = _mean_square_of_finite(step[:, lag:] - step[:, :-lag])
    return lags.astype(float), np.maximum(value, MIN_SERIES_VALUE), np.maximum(raw, MIN_SERIES_VALUE)


def _smooth_structure_function(
    scan_direction: str,
    lag: Array,
    second_difference_squares: Array,
    structure_function_values: Array,
    covariance: Callable[[float], Array],
) -> ScaleSeries:
    """Smooth a structure function over ln(lag), with the same Gaussian kernel as the spectrum.

    second_difference_squares, structure_function_values : mean squares [m2] of second and of first
        differences of the heights at the lags [m]
    covariance : function of the Hurst exponent: covariance of ln(second_difference_squares)
    """
    x = np.log(lag)
    scale = np.exp(np.arange(x[0] + SMOOTHING_KERNEL_WIDTH, x[-1], 0.2))
    weight = np.exp(-0.5 * ((np.log(scale)[:, None] - x) / SMOOTHING_KERNEL_WIDTH) ** 2) * np.gradient(x)
    weight = weight / weight.sum(axis=1, keepdims=True)

    @cache
    def smoothed_covariance(H: float) -> Array:
        """Covariance of ln(value) after smoothing, for the Hurst exponent H."""
        law = weight * second_difference_power_law(lag, H)
        law = law / law.sum(axis=1, keepdims=True)
        return np.asarray(law @ covariance(H) @ law.T)

    return ScaleSeries(
        series_method="structure",
        scan_direction=scan_direction,
        lag_or_wavelength=scale,
        smoothed_value=weight @ second_difference_squares,
        structure_or_psd=weight @ structure_function_values,
        expected_value=lambda H: np.asarray(weight @ second_difference_power_law(lag, H)),
        log_value_covariance=smoothed_covariance,
    )


def _mean_square_of_finite(differences: Array) -> float:
    """Mean square of the finite values."""
    mean = float(np.einsum("ij,ij->", differences, differences) / differences.size)
    if np.isfinite(mean):
        return mean
    finite = differences[np.isfinite(differences)]
    return float(np.einsum("i,i->", finite, finite) / finite.size)


def second_difference_power_law(lags: Array, H: float) -> Array:
    """Mean square V [m2] of second differences of heights at lags [m], for Phi(frequency) = frequency^(-2H).

    Phi is the height variance per ln(frequency), H the Hurst exponent.
    """
    return np.asarray(2.0 * structure_function_constant(H) * second_difference_ratio(H) * lags ** (2.0 * H))


def _wave_contributions(lags: Array, spatial_frequency: Array) -> Array:
    """Contribution (lags, frequencies) [1] of a wave of unit power to V(tau): (1 - cos 2 pi f tau)^2.

    V(tau) = 4 S(tau) - S(2 tau) comes from the structure function S at lag tau [m]; f is the frequency [1/m].
    """
    return np.asarray((1.0 - np.cos(2.0 * np.pi * np.multiply.outer(lags, spatial_frequency))) ** 2)


def _line_covariance(lags: Array, line_length: float) -> Callable[[float], Array]:
    """Covariance of ln(V) at lags [m] as a function of H, for one line of a length [m].

    V is the mean square of the second difference of the heights, H the Hurst exponent. Several lines of a map
    count as one line, which is conservative also for a textured map.
    """
    frequency = np.arange(1, 4 * COVARIANCE_MODE_COUNT) / line_length
    response = _wave_contributions(lags, frequency)

    def covariance(H: float) -> Array:
        """Covariance of ln(V) at all lags, for the Hurst exponent H."""
        weight = response * frequency ** (-1.0 - 2.0 * H)
        weight = weight / weight.sum(axis=1, keepdims=True)
        return _multiply_transposed(weight, weight)

    return covariance


def _areal_covariance(lags: Array, side_lengths: tuple[float, ...]) -> Callable[[float], Array]:
    """Covariance of ln(V) at lags [m] as a function of H, for the mean over all lines along x and y.

    V is the mean square of the second difference of the heights, H the Hurst exponent. The map is isotropic,
    with side lengths [m].
    """
    fx, fy = (np.arange(1, COVARIANCE_MODE_COUNT) / length for length in side_lengths)
    wx, wy = _wave_contributions(lags, fx), _wave_contributions(lags, fy)
    square = fx[None, :] ** 2 + fy[:, None] ** 2

    def covariance(H: float) -> Array:
        """Covariance of ln(V) at all lags, for the Hurst exponent H."""
        power = square ** (-1.0 - H)  # a quarter of the plane; two quarters are independent
        squared = power**2
        cross = _multiply_transposed(_multiply_transposed(wx, squared), wy)
        total = (
            _multiply_transposed(wx * squared.sum(axis=0), wx)
            + _multiply_transposed(wy * squared.sum(axis=1), wy)
            + cross
            + cross.T
        )
        mean = wx @ power.sum(axis=0) + wy @ power.sum(axis=1)
        return np.asarray(0.5 * total / np.multiply.outer(mean, mean))

    return covariance


def _multiply_transposed(left_matrix: Array, right_matrix: Array) -> Array:
    """Matrix product a b^T in one thread. For small matrices, the threads of BLAS take ten times as long."""
    return np.asarray(np.einsum("ik,jk->ij", left_matrix, right_matrix))


def _average_structure_functions(heights: ArealMap) -> ScaleSeries:
    """Structure function averaged over the directions x and y, at the lags that both directions have."""
    lag_x, *along_x = _mean_square_differences(heights.z)
    lag_y, *along_y = _mean_square_differences(heights.z.T)
    lag, lag_y = lag_x * heights.dx, lag_y * heights.dy
    common = (lag >= lag_y[0] * 0.999) & (lag <= lag_y[-1] * 1.001)
    lag = lag[common]
    value, raw = (
        0.5 * (x[common] + np.exp(np.interp(np.log(lag), np.log(lag_y), np.log(y))))
        for x, y in zip(along_x, along_y, strict=True)
    )
    return _smooth_structure_function("areal", lag, value, raw, _areal_covariance(lag, heights.side_lengths))


HANN_CORRELATED_MODES = 35.0 / 18.0
"""Number of neighbouring Fourier modes per direction that count as one with a Hann window [1]."""


def power_spectrum(heights: ScanHeights, scan_direction: str) -> ScaleSeries:
    """Frequency times the one-sided power spectral density: Phi [m2], the variance per ln(frequency).

    The spectrum is that of a profile, of the lines along x or y of a map, or the average over all directions
    ("areal"). It is computed with a Hann window, and smoothed over ln(frequency) with a Gaussian kernel.
    Wavelengths are from 5 spacings to a third of the length. `heights` must have no missing points.
    """
    z = np.atleast_2d(heights.z)
    if scan_direction == "areal" and isinstance(heights, ArealMap):
        frequency, power, share, spacing = _areal_fourier_modes(z, heights.dx, heights.dy)
        length, per_mode = min(heights.side_lengths), HANN_CORRELATED_MODES**2
    else:
        spacing = heights.dy if isinstance(heights, ArealMap) and scan_direction == "y" else heights.dx
        frequency, power, share = _line_fourier_modes(z.T if scan_direction == "y" else z, spacing)
        length, per_mode = 1.0 / frequency[0], HANN_CORRELATED_MODES
    bins = np.floor(np.log(frequency / frequency.min()) / 0.02).astype(int)
    used = np.bincount(bins) > 0
    count = np.bincount(bins)[used].astype(float)
    power, share, logs = (
        np.asarray(np.bincount(bins, weights)[used], dtype=np.float64)
        for weights in (power, share, np.log(frequency))
    )
    f = np.exp(logs / count)
    wavelength = np.exp(np.arange(np.log(5.0 * spacing), np.log(length / 3.0), 0.2))
    kernel = np.exp(-0.5 * (np.log(wavelength[:, None] * f) / SMOOTHING_KERNEL_WIDTH) ** 2)
    norm = kernel @ share
    areal = scan_direction == "areal"

    def expected_power(H: float) -> Array:
        """Expected height variances of the Fourier modes for the spectrum frequency^(-2H)."""
        return np.asarray(share * f ** (-2.0 * H) * _hann_window_factor(f * length, H, areal))

    def covariance(H: float) -> Array:
        """Covariance of ln(value) of the smoothed spectrum, for the Hurst exponent H."""
        weight = kernel * expected_power(H)
        weight = weight / weight.sum(axis=1, keepdims=True)
        return np.asarray((weight * (per_mode / count)) @ weight.T)

    value = np.maximum(kernel @ power / norm, MIN_SERIES_VALUE)
    return ScaleSeries(
        series_method="psd",
        scan_direction=scan_direction,
        lag_or_wavelength=wavelength,
        smoothed_value=value,
        structure_or_psd=value * wavelength,
        expected_value=lambda H: np.asarray(kernel @ expected_power(H) / norm),
        log_value_covariance=covariance,
    )


def _hann_window_factor(mode_index: Array, H: float, is_areal: bool) -> Array:
    """Factor [1] by which a Hann window changes a power-law spectrum, because it mixes neighbouring modes.

    mode_index : number k of waves per length
    H          : Hurst exponent of the power law frequency^(-2H)

    Along a line, the weights of the modes k - 1, k, k + 1 are 1/6, 2/3, 1/6. Over an area, the factor is the
    second-order expansion.
    """
    mode_index = np.maximum(mode_index, 2.0)
    if is_areal:
        return np.asarray(1.0 + (2.0 + 2.0 * H) ** 2 / (6.0 * mode_index**2))
    s = 1.0 + 2.0 * H
    return np.asarray(2.0 / 3.0 + ((1.0 - 1.0 / mode_index) ** -s + (1.0 + 1.0 / mode_index) ** -s) / 6.0)


def _hann_window(window_length: int) -> Array:
    """Hann window (n,) with a mean square of 1."""
    window = np.sin(np.pi * (np.arange(window_length) + 0.5) / window_length) ** 2
    return np.asarray(window / np.sqrt(np.mean(window**2)))


def _line_fourier_modes(z: Array, point_spacing: float) -> tuple[Array, Array, Array]:
    """Fourier modes of lines of heights: frequency f > 0 [1/m], variance [m2] and df/f [1].

    Variances are averaged over the lines.
    """
    n = z.shape[1]
    window = _hann_window(n)
    level = (z @ window) / window.sum()
    modes = np.fft.rfft((z - level[:, None]) * window, axis=1)[:, 1:]
    power = 2.0 * np.mean(np.abs(modes) ** 2, axis=0) / n**2
    k = np.arange(1, power.size + 1)
    return k / (n * point_spacing), power, 1.0 / k


def _areal_fourier_modes(z: Array, dx: float, dy: float) -> tuple[Array, Array, Array, float]:
    """Power of the Fourier modes of a height map, in half of the frequency plane.

    Returns frequency f [1/m] and height variance [m2] of each mode, the share df_x df_y/(pi f^2) [1] of each
    mode in a ring of the frequency plane, and the larger spacing max(dx, dy) [m].
    """
    ny, nx = z.shape
    window = np.multiply.outer(_hann_window(ny), _hann_window(nx))
    level = float(np.sum(z * window) / np.sum(window))
    power = 2.0 * np.abs(np.fft.rfft2((z - level) * window)) ** 2 / (nx * ny) ** 2
    fx, fy = np.fft.rfftfreq(nx, dx)[None, :], np.fft.fftfreq(ny, dy)[:, None]
    frequency = np.hypot(fx, fy)
    inside = (fx > 0.0) & (frequency < 0.5 / max(dx, dy)) & np.ones_like(fy, dtype=bool)
    f = frequency[inside]
    share = 1.0 / (nx * dx * ny * dy * np.pi * f**2)
    return f, power[inside], share, max(dx, dy)
