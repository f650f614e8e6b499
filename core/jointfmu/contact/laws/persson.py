"""Real contact area by Persson's theory with a hardness, and the bearing curve of a Gaussian surface.

With growing magnification the distribution of the local pressure spreads by diffusion (Persson 2001). It
starts at the nominal pressure and is absorbed at zero (no contact) and at the hardness (plastic contact). The
variance over all wavelengths is (E* slope/2)^2.
"""

from statistics import NormalDist

import numpy as np

from ...quantity import Number, erf, select

_MAX_VARIANCE_OVER_SQUARED_HARDNESS = 0.2
"""Variance of the pressure over squared hardness [1] up to which the series of image sources is faster."""


def elastic_and_plastic_area_shares(
    pressure: Number, hardness: Number, pressure_standard_deviation: Number
) -> tuple[Number, Number]:
    """Shares [1] of the nominal area in elastic and in plastic contact at nominal pressures p (...) [Pa].

    hardness                    : [Pa], above the pressure
    pressure_standard_deviation : [Pa] of the local pressure, with the roughness of all wavelengths: contact
        modulus E* times combined rms slope/2

    Without plastic contact the elastic share is erf(p/(sqrt(2) standard deviation)). The plastic share
    carries the rest of the load.
    """
    x = np.minimum(pressure / hardness, 1.0)
    t = (pressure_standard_deviation / hardness) ** 2
    image_series = _image_source_series(x, np.minimum(t, _MAX_VARIANCE_OVER_SQUARED_HARDNESS))
    mode_series = _diffusion_mode_series(x, np.maximum(t, _MAX_VARIANCE_OVER_SQUARED_HARDNESS))
    elastic, load = (
        select(t < _MAX_VARIANCE_OVER_SQUARED_HARDNESS, a, b)
        for a, b in zip(image_series, mode_series, strict=True)
    )
    return elastic, np.maximum(x - load, 0.0)


def _diffusion_mode_series(
    pressure_over_hardness: Number, variance_over_squared_hardness: Number
) -> tuple[Number, Number]:
    """Share of the nominal area A_0 in elastic contact, and its load divided by hardness times A_0 [1].

    Sum of a series of diffusion modes of the distribution of the local pressure.

    pressure_over_hardness : nominal pressure divided by hardness [1]
    variance_over_squared_hardness : variance of the local pressure divided by the squared hardness [1]
    """
    share: Number = 0.0
    load: Number = 0.0
    for n in range(1, 7):
        mode = (
            2.0
            / (n * np.pi)
            * np.sin(n * np.pi * pressure_over_hardness)
            * np.exp(-0.5 * (n * np.pi) ** 2 * variance_over_squared_hardness)
        )
        share = share + (1.0 - (-1.0) ** n) * mode
        load = load - (-1.0) ** n * mode
    return share, load


def _image_source_series(
    pressure_over_hardness: Number, variance_over_squared_hardness: Number
) -> tuple[Number, Number]:
    """Share of the nominal area A_0 in elastic contact, and its load divided by hardness times A_0 [1].

    Sum of a series of image sources of the distribution of the local pressure. Arguments and result as in
    `_diffusion_mode_series`; this series converges faster for a small variance.
    """
    spread = np.sqrt(2.0 * variance_over_squared_hardness)
    share: Number = 0.0
    load: Number = 0.0
    for k in range(-2, 3):
        for sign in (1.0, -1.0):
            start = 2.0 * k + sign * pressure_over_hardness
            to_zero, to_hardness = (0.0 - start) / spread, (1.0 - start) / spread
            weight = 0.5 * (erf(to_hardness) - erf(to_zero))
            tails = spread / (2.0 * np.sqrt(np.pi)) * (np.exp(-(to_zero**2)) - np.exp(-(to_hardness**2)))
            share = share + sign * weight
            load = load + sign * (start * weight + tails)
    return share, load


def bearing_curve_log_slope(area_share_above_plane: Number) -> Number:
    """Log-slope of the bearing curve of a Gaussian surface: d ln(area share)/d(approach/rms height) [1].

    area_share_above_plane : [1] part of the surface above a plane at the height z times the rms height
        (bearing curve, Abbott and Firestone 1933): Phi(-z). The log-slope is phi(z)/Phi(-z), with density phi
        and distribution function Phi of the normal distribution.

    The contact area of a perfectly plastic surface follows the bearing curve.
    """
    inside = np.minimum(np.maximum(area_share_above_plane, 1e-300), 1.0 - 1e-12)
    z = -np.vectorize(NormalDist().inv_cdf, otypes=[float])(inside)
    return np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi) / inside
