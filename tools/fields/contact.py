"""A nodal contact result on a plane joint."""

from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array


@dataclass(frozen=True, slots=True)
class ContactField:
    """Pressure at the nodes of a plane contact, whatever made it.

    area     : (n)    [m2] part of the contact that the node stands for, > 0
    position : (n, 2) [m]  in the joint's plane, any origin
    pressure : (n)    [Pa] >= 0; 0 where the contact is open
    """

    area: Array
    position: Array
    pressure: Array

    @property
    def force(self) -> float:
        """Total normal force [N]."""
        return float(np.sum(self.area * self.pressure))

    @property
    def centroid(self) -> Array:
        """Centroid of the contact (2) [m]."""
        return np.asarray(np.average(self.position, axis=0, weights=self.area))
