"""A contact as nodes with area share, position and normal; rigid-body stiffness from local stiffness."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Footprint:
    """Pressure at the nodes of a contact; `...` are load cases.

    share    : (..., n)    [1]  part of the nominal area A_0 that the node stands for
    position : (..., n, 3) [m]
    normal   : (..., n, 3) [1]  unit normal of the contact surface
    pressure : (..., n)    [Pa]
    """

    share: Array
    position: Array
    normal: Array
    pressure: Array

    @property
    def mean_pressure(self) -> Array:
        """Load over nominal area [Pa]."""
        return np.asarray(np.sum(self.share * self.pressure, axis=-1))

    def translation(self, stiffness: Array) -> Array:
        """Stiffness per displacement: local stiffnesses (..., n), each scaled to the area A_0, weighted by
        area share."""
        return np.asarray(np.sum(self.share * stiffness, axis=-1))

    def rotation(self, normal: Array, tangential: Array, axis: ArrayLike) -> Array:
        """Stiffness [N.m/rad] against a rigid rotation about an axis through the origin.

        A unit twist moves a node by d = axis x position; its energy gives
        `sum share (K_N (d.n)^2 + K_T (|d|^2 - (d.n)^2))`: Hu 2023, Eq. 45, corrected.
        """
        along, square = self.projection(axis)
        return np.asarray(
            np.sum(self.share * (normal * along**2 + tangential * (square - along**2)), axis=-1)
        )

    def projection(self, axis: ArrayLike) -> tuple[Array, Array]:
        """Projections d.n [m] and |d|^2 [m2] of the displacement d = axis x position for a unit rotation."""
        d = np.cross(np.asarray(axis, dtype=np.float64), self.position)
        return np.sum(d * self.normal, axis=-1), np.sum(d * d, axis=-1)
