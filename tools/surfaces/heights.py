"""Height data on a uniform grid: a profile or an areal map, never one for the other."""

from dataclasses import dataclass, replace

import numpy as np

from jointfmu.quantity import Array

FORMS = ("tilt", "mean", "curvature")
"""What is removed before anything else: a plane (default), the mean height, a surface of second order."""
LEAST_PROFILE = 128
"""Least number of points of a profile: the lags used then span 0.9 decades."""
LEAST_AREAL = 64
"""Least number of points along either side of an areal map."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Heights along a line.

    z : (n,) [m], NaN where missing; dx : spacing [m]; name : for messages
    """

    z: Array
    dx: float
    name: str

    def __post_init__(self) -> None:
        if self.z.size < LEAST_PROFILE:
            raise ValueError(f"{self.name}: {self.z.size} points, a profile needs at least {LEAST_PROFILE}")
        _check(self.name, self.z, self.dx)

    @property
    def lengths(self) -> tuple[float, ...]:
        """Evaluation length [m]."""
        return (self.z.size * self.dx,)

    def with_heights(self, z: Array) -> "Profile":
        """The same line with other heights."""
        return replace(self, z=z)


@dataclass(frozen=True, slots=True, kw_only=True)
class Areal:
    """Heights over a rectangle.

    z : (ny, nx) [m], NaN where missing; dx, dy : spacing [m]; name : for messages
    """

    z: Array
    dx: float
    dy: float
    name: str

    def __post_init__(self) -> None:
        if min(self.z.shape) < LEAST_AREAL:
            shape = " x ".join(str(n) for n in self.z.shape[::-1])
            raise ValueError(
                f"{self.name}: {shape} points, an areal map needs at least {LEAST_AREAL} x {LEAST_AREAL}"
            )
        _check(self.name, self.z, self.dx, self.dy)

    @property
    def lengths(self) -> tuple[float, ...]:
        """Side lengths along x and y [m]."""
        return self.z.shape[1] * self.dx, self.z.shape[0] * self.dy

    def with_heights(self, z: Array) -> "Areal":
        """The same map with other heights."""
        return replace(self, z=z)


Heights = Profile | Areal


def _check(name: str, z: Array, *spacings: float) -> None:
    for spacing in spacings:
        if not (np.isfinite(spacing) and spacing > 0.0):
            raise ValueError(f"{name}: spacing = {spacing:g} m is outside (0, inf)")
    valid = z[np.isfinite(z)]
    if valid.size == 0:
        raise ValueError(f"{name}: all {z.size} heights are missing or NaN")
    low, high = float(valid.min()), float(valid.max())
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        raise ValueError(f"{name}: all heights are {low:g} m, a constant surface has no D and no G")
