"""A row of a catalogue: three straight lines of the angle over the torque.

Catalogue practice: K1 up to T1, K2 up to T2, K3 beyond,

    theta(T) = T1/K1 + (T2 - T1)/K2 + (T - T2)/K3   for T > T2.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.quantity import check, quantity
from jointfmu.quantity.units import factor

from ....fitting.least_squares import Array
from . import drive

PRINTED = ("1e4 N.m/rad", "N.m/arcmin", "kN.m/rad", "kgf.m/arcmin", "N.m/mrad", "N.mm/rad")
"""Units in which catalogues print stiffness."""


def _likely(angle: float) -> str:
    """The unit that brings the wind-up at T2 [rad] nearest to what is usual, the middle of WINDUP."""
    usual = np.sqrt(np.prod(drive.WINDUP))
    sizes = {u: factor(u, "N.m/rad") for u in PRINTED}
    best = min(sizes, key=lambda u: abs(np.log(angle / sizes[u] / usual)))
    if not 0.1 < angle / sizes[best] / usual < 10.0:
        return "no usual unit explains it"
    return f"likely they are in {best}: times {sizes[best]:g} (--stiffness-unit)"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A row of a catalogue."""

    K1: float = quantity("N.m/rad", "stiffness below T1", gt=0.0)
    K2: float = quantity("N.m/rad", "stiffness between T1 and T2", gt=0.0)
    K3: float = quantity("N.m/rad", "stiffness above T2", gt=0.0)
    T1: float = quantity("N.m", "torque at the first corner", gt=0.0)
    T2: float = quantity("N.m", "torque at the second corner", gt=0.0)
    rated: float = quantity("N.m", "rated torque", gt=0.0)

    def __post_init__(self) -> None:
        check(self)
        for low, high in (("K1", "K2"), ("K2", "K3")):
            if not getattr(self, low) <= getattr(self, high):
                raise ValueError(
                    f"{high} = {getattr(self, high):g} N.m/rad is outside [{getattr(self, low):g}, inf): "
                    f"the drive stiffens, {high} is at least {low}"
                )
        if not self.T1 < self.T2:
            raise ValueError(f"T2 = {self.T2:g} N.m is outside ({self.T1:g}, inf): T2 exceeds T1")
        least, most = drive.WINDUP
        angle, at_T2 = (float(self.angle(T)) for T in (self.rated, self.T2))
        if not least <= angle <= most:
            raise ValueError(
                f"K1 = {self.K1:g} N.m/rad winds up {angle:.3g} rad at the rated torque {self.rated:g} N.m, "
                f"allowed are {least:g} to {most:g} rad: are K1, K2 and K3 in N.m/rad? {_likely(at_T2)}"
            )

    def angle(self, torque: ArrayLike) -> Array:
        """theta (...) [rad] at torques (...) >= 0 [N.m]."""
        T = np.asarray(torque, dtype=np.float64)
        first, second = np.minimum(T, self.T1), np.clip(T - self.T1, 0.0, self.T2 - self.T1)
        return np.asarray(first / self.K1 + second / self.K2 + np.maximum(T - self.T2, 0.0) / self.K3)

    def stiffness(self, torque: ArrayLike) -> Array:
        """K (...) [N.m/rad] at torques (...) >= 0 [N.m]: the steps, that of the line below at a corner."""
        T = np.asarray(torque, dtype=np.float64)
        return np.where(T <= self.T1, self.K1, np.where(T <= self.T2, self.K2, self.K3))

    @property
    def kept(self) -> Array:
        """The torques [N.m], ascending, at which the law keeps the angle."""
        return np.unique([self.T1, self.T2, self.rated])

    def __str__(self) -> str:
        return (
            f"K1 = {self.K1:g}, K2 = {self.K2:g}, K3 = {self.K3:g} N.m/rad, "
            f"T1 = {self.T1:g}, T2 = {self.T2:g} N.m"
        )
