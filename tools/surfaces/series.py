"""Values over scale of height data, with what a self-affine surface would give.

A `ScaleSeries` holds values over scale together with the expectation and the covariance that a Gaussian
self-affine surface of the same size and sampling has, so that the fit knows how sure each value is.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

METHODS = ("structure", "psd")
SIDES = ("1", "2", "both")
"""What one scan stands for: a side of the contact on a smooth other one, or both alike."""
LEAST = 1e-200
"""Least value of a series [m2], so that lines of one height have a logarithm."""
KERNEL = 0.3
"""Width of the Gaussian kernel in ln(frequency): it smooths the separate waves up to gamma = 2."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaleSeries:
    """Values over scale.

    method : "structure" or "psd"; direction : "profile", "x", "y" or "areal"
    scale  : (J,) [m] lag or wavelength, rising
    value  : (J,) [m2] V(tau) = 4 S(tau) - S(2 tau), or Phi = frequency times power spectral density
    raw    : (J,) [m2] or [m3] what is plotted: S(tau), or the power spectral density
    expected   : H -> (J,) value where Phi(frequency) = frequency^(-2H)
    covariance : H -> (J, J) [1] of ln(value)
    """

    method: str
    direction: str
    scale: Array
    value: Array
    raw: Array
    expected: Callable[[float], Array]
    covariance: Callable[[float], Array]

    def within(self, keep: NDArray[Any]) -> "ScaleSeries":
        """The values of a boolean or index array."""
        return replace(
            self,
            scale=self.scale[keep],
            value=self.value[keep],
            raw=self.raw[keep],
            expected=lambda H: self.expected(H)[keep],
            covariance=lambda H: self.covariance(H)[np.ix_(keep, keep)],
        )
