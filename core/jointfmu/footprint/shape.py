"""What a bolted contact's pressure looks like, and the shape that comes as numbers: a nodal field."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ..quantity import check, series

Array = NDArray[np.float64]

BALANCE = 1e-6
"""Largest error of a field's sums [1]: what the reduction of a field keeps."""


ALIKE = 11
"""Decimals to which `equal` and `tilt` of nodes agree that symmetry makes equal: they are numbers near 1."""


@dataclass(frozen=True, slots=True)
class PressureShape:
    """Nodes of the bolted contact and the pressure that unit bolt forces make.

    share    : (n)    [1] part of the nominal area, sums to 1
    position : (n, 2) [m] relative to the centroid of the contact
    equal    : (n)    [1] pressure over mean pressure with equal bolt forces
    tilt     : (n)    [1] the same for +1 on the row y > 0 and -1 on the row y < 0, over the mean
                          pressure of one row
    """

    share: Array
    position: Array
    equal: Array
    tilt: Array

    def merged(self, moment: bool = True) -> "MergedShape":
        """Nodes that have the same pressure under every preload and moment as one.

        Without `moment` they are those that have it under every preload.
        """
        tilt = self.tilt if moment else 0.0 * self.tilt
        keys = np.round(np.column_stack([self.equal, tilt]), ALIKE)
        _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        share = np.asarray(np.bincount(group.ravel(), self.share), dtype=np.float64)
        x2, y2 = (np.bincount(group.ravel(), self.share * x**2) / share for x in self.position.T)
        return MergedShape(share, self.equal[first], tilt[first], x2, y2)


@dataclass(frozen=True, slots=True)
class MergedShape:
    """Nodes of different pressure; share, equal and tilt as in PressureShape.

    x2, y2 : (n) [m2] means of the squared distances from the centroid along and across the bolt rows
    """

    share: Array
    equal: Array
    tilt: Array
    x2: Array
    y2: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class NodalField:
    """The pressure of a bolted contact at points that stand for a nodal contact result.

    Raises ValueError if the points are not equally many in every entry or do not balance: shares that
    sum to 1, the centroid at the origin, a mean of 1 of `equal` and of 0 of `tilt`, within BALANCE.
    """

    share: tuple[float, ...] = series("1", "parts of the nominal area, which sum to 1", gt=0.0)
    x: tuple[float, ...] = series("m", "positions along the bolt rows, from the centroid")
    y: tuple[float, ...] = series("m", "positions across the bolt rows, from the centroid")
    equal: tuple[float, ...] = series("1", "pressures over mean pressure with equal bolt forces", ge=0.0)
    tilt: tuple[float, ...] = series(
        "1", "pressures that a moment adds, over the mean pressure of one row's share of it"
    )

    def __post_init__(self) -> None:
        check(self)
        for item in fields(self):
            if (count := len(getattr(self, item.name))) != len(self.share):
                raise ValueError(
                    f"{item.name} has {count} numbers, expected as many as share has: {len(self.share)}"
                )
        shape = self.shape()
        reach = float(np.max(np.abs(shape.position)))
        x, y = shape.share @ shape.position
        steep = max(float(np.max(np.abs(shape.tilt))), 1.0)
        for text, value, expected, size in (
            ("the sum of share", float(np.sum(shape.share)), 1.0, 1.0),
            ("x of the centroid", float(x), 0.0, reach),
            ("y of the centroid", float(y), 0.0, reach),
            ("the mean of equal", float(shape.share @ shape.equal), 1.0, 1.0),
            ("the mean of tilt", float(shape.share @ shape.tilt), 0.0, steep),
        ):
            if not abs(value - expected) <= BALANCE * size:
                raise ValueError(f"{text} is {value:.9g}, expected {expected:g} within {BALANCE * size:.1g}")

    def shape(self) -> PressureShape:
        """The points as arrays."""
        share, x, y, equal, tilt = (np.array(getattr(self, item.name)) for item in fields(self))
        return PressureShape(share, np.column_stack([x, y]), equal, tilt)
