"""Persson's real area of contact with a hardness, and the bearing curve of a Gaussian surface.

With growing magnification the pressure at a point spreads like a diffusing particle (Persson 2001): it
starts at the nominal pressure, is lost at zero (no contact) and stops at the hardness (plastic). Its
variance over all waves is (E* slope/2)^2.
"""

from statistics import NormalDist

import numpy as np

from ...quantity import Number, erf, where

_SHORT = 0.2
"""Variance over the square of the hardness [1] up to which images converge faster than waves."""


def contact_shares(pressure: Number, hardness: Number, spread: Number) -> tuple[Number, Number]:
    """Shares [1] of the nominal area in elastic and in plastic contact at pressures (...) [Pa].

    hardness : [Pa], above the pressure
    spread   : E* slope/2 [Pa], the pressure's standard deviation over all waves

    Elastic alone it is erf(p/(sqrt(2) spread)). The plastic share carries what the elastic one does not.
    """
    x = np.minimum(pressure / hardness, 1.0)
    t = (spread / hardness) ** 2
    early, late = _images(x, np.minimum(t, _SHORT)), _waves(x, np.maximum(t, _SHORT))
    elastic, load = (where(t < _SHORT, a, b) for a, b in zip(early, late, strict=True))
    return elastic, np.maximum(x - load, 0.0)


def _waves(x: Number, t: Number) -> tuple[Number, Number]:
    """Elastic share and its load over the hardness [1], by the modes between the two walls."""
    share: Number = 0.0
    load: Number = 0.0
    for n in range(1, 7):
        mode = 2.0 / (n * np.pi) * np.sin(n * np.pi * x) * np.exp(-0.5 * (n * np.pi) ** 2 * t)
        share = share + (1.0 - (-1.0) ** n) * mode
        load = load - (-1.0) ** n * mode
    return share, load


def _images(x: Number, t: Number) -> tuple[Number, Number]:
    """The same by images of the start in the two walls."""
    spread = np.sqrt(2.0 * t)
    share: Number = 0.0
    load: Number = 0.0
    for k in range(-2, 3):
        for sign in (1.0, -1.0):
            start = 2.0 * k + sign * x
            near, far = (0.0 - start) / spread, (1.0 - start) / spread
            part = 0.5 * (erf(far) - erf(near))
            tails = spread / (2.0 * np.sqrt(np.pi)) * (np.exp(-(near**2)) - np.exp(-(far**2)))
            share = share + sign * part
            load = load + sign * (start * part + tails)
    return share, load


def bearing_curve(share: Number) -> Number:
    """Slope [1] of ln(share) over the approach in rms heights, of the plane that cuts this share off a
    Gaussian surface (Abbott and Firestone 1933): phi(z)/Phi(-z); a perfectly plastic surface follows it.
    """
    inside = np.minimum(np.maximum(share, 1e-300), 1.0 - 1e-12)
    z = -np.vectorize(NormalDist().inv_cdf, otypes=[float])(inside)
    return np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi) / inside
