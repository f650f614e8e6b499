"""Power spectral density of a profile or a map, and what a self-affine surface would give."""

import numpy as np

from jointfmu.quantity import Array

from .heights import Areal, Heights
from .series import KERNEL, LEAST, ScaleSeries

HANN = 35.0 / 18.0
"""Neighbouring Fourier modes of a Hann window that count as one, per direction."""


def psd(heights: Heights, direction: str) -> ScaleSeries:
    """Power spectral density of a profile, of the lines along x or y, or radial ("areal").

    Hann window; Phi = frequency times one-sided density, smoothed over ln(frequency) with a Gaussian
    kernel. Wavelengths from 5 spacings to a third of the length. `heights` must have no missing point.
    """
    z = np.atleast_2d(heights.z)
    if direction == "areal" and isinstance(heights, Areal):
        frequency, power, share, spacing = _areal_modes(z, heights.dx, heights.dy)
        length, per_mode = min(heights.lengths), HANN**2
    else:
        spacing = heights.dy if isinstance(heights, Areal) and direction == "y" else heights.dx
        frequency, power, share = _line_modes(z.T if direction == "y" else z, spacing)
        length, per_mode = 1.0 / frequency[0], HANN
    bins = np.floor(np.log(frequency / frequency.min()) / 0.02).astype(int)
    used = np.bincount(bins) > 0
    count = np.bincount(bins)[used].astype(float)
    power, share, logs = (
        np.asarray(np.bincount(bins, weights)[used], dtype=np.float64)
        for weights in (power, share, np.log(frequency))
    )
    f = np.exp(logs / count)
    wavelength = np.exp(np.arange(np.log(5.0 * spacing), np.log(length / 3.0), 0.2))
    kernel = np.exp(-0.5 * (np.log(wavelength[:, None] * f) / KERNEL) ** 2)
    norm = kernel @ share
    areal = direction == "areal"

    def law(H: float) -> Array:
        return np.asarray(share * f ** (-2.0 * H) * _broadening(f * length, H, areal))

    def covariance(H: float) -> Array:
        weight = kernel * law(H)
        weight = weight / weight.sum(axis=1, keepdims=True)
        return np.asarray((weight * (per_mode / count)) @ weight.T)

    value = np.maximum(kernel @ power / norm, LEAST)
    return ScaleSeries(
        method="psd",
        direction=direction,
        scale=wavelength,
        value=value,
        raw=value * wavelength,
        expected=lambda H: np.asarray(kernel @ law(H) / norm),
        covariance=covariance,
    )


def _broadening(k: Array, H: float, areal: bool) -> Array:
    """What a Hann window makes of a power law at k waves per length: it mixes a mode with its neighbours.

    Along a line (1/6, 2/3, 1/6) of modes k - 1, k, k + 1; over an area the second order of that.
    """
    k = np.maximum(k, 2.0)
    if areal:
        return np.asarray(1.0 + (2.0 + 2.0 * H) ** 2 / (6.0 * k**2))
    s = 1.0 + 2.0 * H
    return np.asarray(2.0 / 3.0 + ((1.0 - 1.0 / k) ** -s + (1.0 + 1.0 / k) ** -s) / 6.0)


def _window(n: int) -> Array:
    """Hann window with a mean square of 1."""
    window = np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2
    return np.asarray(window / np.sqrt(np.mean(window**2)))


def _line_modes(z: Array, spacing: float) -> tuple[Array, Array, Array]:
    """Frequency [1/m], variance [m2] and df/f [1] of every mode but the mean, averaged over lines."""
    n = z.shape[1]
    window = _window(n)
    level = (z @ window) / window.sum()
    modes = np.fft.rfft((z - level[:, None]) * window, axis=1)[:, 1:]
    power = 2.0 * np.mean(np.abs(modes) ** 2, axis=0) / n**2
    k = np.arange(1, power.size + 1)
    return k / (n * spacing), power, 1.0 / k


def _areal_modes(z: Array, dx: float, dy: float) -> tuple[Array, Array, Array, float]:
    """Frequency, variance and share df_x df_y/(pi f^2) of the modes of half the plane, and max(dx, dy)."""
    ny, nx = z.shape
    window = np.multiply.outer(_window(ny), _window(nx))
    level = float(np.sum(z * window) / np.sum(window))
    power = 2.0 * np.abs(np.fft.rfft2((z - level) * window)) ** 2 / (nx * ny) ** 2
    fx, fy = np.fft.rfftfreq(nx, dx)[None, :], np.fft.fftfreq(ny, dy)[:, None]
    frequency = np.hypot(fx, fy)
    inside = (fx > 0.0) & (frequency < 0.5 / max(dx, dy)) & np.ones_like(fy, dtype=bool)
    f = frequency[inside]
    share = 1.0 / (nx * dx * ny * dy * np.pi * f**2)
    return f, power[inside], share, max(dx, dy)
