"""Structure function of a profile or a map, and what a self-affine surface would give."""

from collections.abc import Callable
from functools import cache

import numpy as np

from jointfmu.contact.fractal import second_difference, structure_constant
from jointfmu.quantity import Array

from .heights import Areal, Heights
from .series import KERNEL, LEAST, ScaleSeries

MODES = 256
"""Fourier modes per direction that enter a covariance; shorter waves hardly contribute."""


def structure(heights: Heights, direction: str) -> ScaleSeries:
    """Structure function along a profile, along x or y of a map, or the mean of both ("areal").

    S(tau) = <(z(x + tau) - z(x))^2>, V(tau) = <(z(x + tau) - 2 z(x) + z(x - tau))^2>. Pairs with a
    missing point are left out. Lags from 2 spacings to an eighth of the length.
    """
    if direction == "areal" and isinstance(heights, Areal):
        return _mean_of_directions(heights)
    z = np.atleast_2d(heights.z)
    z, spacing = (z.T, heights.dy) if isinstance(heights, Areal) and direction == "y" else (z, heights.dx)
    lags, value, raw = _differences(z)
    length = z.shape[1] * spacing
    lag = lags * spacing
    return _smoothed(direction, lag, value, raw, _line_covariance(lag, length))


def _differences(z: Array) -> tuple[Array, Array, Array]:
    """Lags in points, V and S at them, averaged over the rows."""
    lags = np.unique(np.round(np.exp(np.arange(np.log(2.0), np.log(z.shape[1] // 8), 0.08))).astype(int))
    value, raw = np.empty(lags.size), np.empty(lags.size)
    for i, lag in enumerate(lags):
        step = z[:, lag:] - z[:, :-lag]
        raw[i] = _mean_square(step)
        value[i] = _mean_square(step[:, lag:] - step[:, :-lag])
    return lags.astype(float), np.maximum(value, LEAST), np.maximum(raw, LEAST)


def _smoothed(
    direction: str, lag: Array, value: Array, raw: Array, covariance: Callable[[float], Array]
) -> ScaleSeries:
    """The structure function smoothed over ln(lag) as the spectrum is over ln(frequency)."""
    x = np.log(lag)
    scale = np.exp(np.arange(x[0] + KERNEL, x[-1], 0.2))
    weight = np.exp(-0.5 * ((np.log(scale)[:, None] - x) / KERNEL) ** 2) * np.gradient(x)
    weight = weight / weight.sum(axis=1, keepdims=True)

    @cache
    def spread(H: float) -> Array:
        law = weight * power_law(lag, H)
        law = law / law.sum(axis=1, keepdims=True)
        return np.asarray(law @ covariance(H) @ law.T)

    return ScaleSeries(
        method="structure",
        direction=direction,
        scale=scale,
        value=weight @ value,
        raw=weight @ raw,
        expected=lambda H: np.asarray(weight @ power_law(lag, H)),
        covariance=spread,
    )


def _mean_square(step: Array) -> float:
    total = float(np.einsum("ij,ij->", step, step) / step.size)
    if np.isfinite(total):
        return total
    known = step[np.isfinite(step)]
    return float(np.einsum("i,i->", known, known) / known.size)


def power_law(scale: Array, H: float) -> Array:
    """V [m2] at lags [m] where Phi(frequency) = frequency^(-2H)."""
    return np.asarray(2.0 * structure_constant(H) * second_difference(H) * scale ** (2.0 * H))


def _response(scale: Array, frequency: Array) -> Array:
    """Weight of a wave in V: (1 - cos 2 pi f tau)^2."""
    return np.asarray((1.0 - np.cos(2.0 * np.pi * np.multiply.outer(scale, frequency))) ** 2)


def _line_covariance(scale: Array, length: float) -> Callable[[float], Array]:
    """Over H, of one line; several lines of a map are taken as one, which is safe for a texture too."""
    frequency = np.arange(1, 4 * MODES) / length
    response = _response(scale, frequency)

    def covariance(H: float) -> Array:
        weight = response * frequency ** (-1.0 - 2.0 * H)
        weight = weight / weight.sum(axis=1, keepdims=True)
        return _times(weight, weight)

    return covariance


def _areal_covariance(scale: Array, lengths: tuple[float, ...]) -> Callable[[float], Array]:
    """Over H, of the mean over all lines along x and along y of an isotropic surface."""
    fx, fy = (np.arange(1, MODES) / length for length in lengths)
    wx, wy = _response(scale, fx), _response(scale, fy)
    square = fx[None, :] ** 2 + fy[:, None] ** 2

    def covariance(H: float) -> Array:
        power = square ** (-1.0 - H)  # a quarter of the plane; two of them count
        squared = power**2
        both = _times(_times(wx, squared), wy)
        total = _times(wx * squared.sum(axis=0), wx) + _times(wy * squared.sum(axis=1), wy) + both + both.T
        mean = wx @ power.sum(axis=0) + wy @ power.sum(axis=1)
        return np.asarray(0.5 * total / np.multiply.outer(mean, mean))

    return covariance


def _times(a: Array, b: Array) -> Array:
    """a b', by one thread: those that BLAS wakes for so small matrices cost ten times the product."""
    return np.asarray(np.einsum("ik,jk->ij", a, b))


def _mean_of_directions(heights: Areal) -> ScaleSeries:
    """V and S averaged over x and y, at the lags along x that y has too."""
    lag_x, *along_x = _differences(heights.z)
    lag_y, *along_y = _differences(heights.z.T)
    lag, lag_y = lag_x * heights.dx, lag_y * heights.dy
    both = (lag >= lag_y[0] * 0.999) & (lag <= lag_y[-1] * 1.001)
    lag = lag[both]
    value, raw = (
        0.5 * (x[both] + _interpolate(lag, lag_y, y)) for x, y in zip(along_x, along_y, strict=True)
    )
    return _smoothed("areal", lag, value, raw, _areal_covariance(lag, heights.lengths))


def _interpolate(at: Array, scale: Array, value: Array) -> Array:
    return np.asarray(np.exp(np.interp(np.log(at), np.log(scale), np.log(value))))
