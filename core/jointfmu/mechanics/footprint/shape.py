"""What a bolted contact's pressure looks like, and the shape that comes as numbers: a nodal field."""

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...quantity import Array, check, quantity, series

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

    def part(self, nodes: "slice | NDArray[np.intp]") -> "PressureShape":
        """Some of the nodes, with their shares."""
        return PressureShape(self.share[nodes], self.position[nodes], self.equal[nodes], self.tilt[nodes])

    def as_patches(self) -> "FrictionPatches":
        """Each node as a patch of friction without a size of its own."""
        return FrictionPatches(self.share, self.position, self.equal, self.tilt, np.zeros_like(self.share))

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
class FrictionPatches(PressureShape):
    """Patches that carry the friction of a contact, each for the nodes around it.

    radius : (n) [m] of the circle around a patch on which its sliders stand, below 0 where they are opposite
    """

    radius: Array


def growing(share: Array, y: Array, equal: Array) -> Array:
    """What a moment of 1 N.m on 1 m2 adds to the pressure (n) [1/m] if it grows from the centre of pressure.

    share, y, equal are (n) of a PressureShape. equal (y - y_p)/sum(share equal (y - y_p)^2), y_p the centre.

    Raises ValueError if all nodes that touch have the same y.
    """
    force = share * equal
    away = y - force @ y
    spread = float(force @ away**2)
    if not spread > 0.0:
        raise ValueError("all nodes that touch have the same y, expected a contact across the bolt rows")
    return np.asarray(equal * away / spread)


BOLT_MEANS = ("bolt_x", "bolt_y", "bolt_x2", "bolt_y2", "bolt_xy")
"""What a field says of its bolts, in the order of `means`."""
Means: TypeAlias = tuple[float, float, float, float, float]


def means(points: Array) -> Means:
    """Means of x, y, x^2, y^2 and x y of points (n, 2)."""
    x, y = points.T
    first, second, xx, yy, xy = (float(np.mean(values)) for values in (x, y, x * x, y * y, x * y))
    return first, second, xx, yy, xy


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


_POINTS = ("share", "x", "y", "equal", "tilt")
"""What a point of a field has."""
PATCH = "patch_"
"""Begins the names of what a patch has."""
PATCHES = 22
"""Most points that carry the friction of a joint [1], each with sliders."""


def as_lists(shape: PressureShape) -> dict[str, tuple[float, ...]]:
    """What a field has of its points, or of its patches."""
    rows = dict(zip(_POINTS, (shape.share, *shape.position.T, shape.equal, shape.tilt), strict=True))
    if isinstance(shape, FrictionPatches):
        rows = {PATCH + name: row for name, row in (rows | {"radius": shape.radius}).items()}
    return {name: tuple(row.tolist()) for name, row in rows.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class NodalField:
    """The pressure of a bolted contact at points that stand for a nodal contact result.

    Raises ValueError if the points, or the patches of friction where there are some, are not equally many in
    every entry or do not balance: shares that sum to 1, the centroid at the origin, a mean of 1 of `equal`
    and of 0 of `tilt`, within BALANCE.
    """

    share: tuple[float, ...] = series("1", "parts of the nominal area, which sum to 1", gt=0.0)
    x: tuple[float, ...] = series("m", "positions along the bolt rows, from the centroid")
    y: tuple[float, ...] = series("m", "positions across the bolt rows, from the centroid")
    equal: tuple[float, ...] = series("1", "pressures over mean pressure with equal bolt forces", ge=0.0)
    tilt: tuple[float, ...] = series(
        "1", "pressures that a moment adds, over the mean pressure of one row's share of it"
    )
    patch_share: tuple[float, ...] = series("1", "the same of the patches of friction", gt=0.0, optional=True)
    patch_x: tuple[float, ...] = series("m", "places of the patches along the bolt rows", optional=True)
    patch_y: tuple[float, ...] = series("m", "places of the patches across the bolt rows", optional=True)
    patch_equal: tuple[float, ...] = series("1", "`equal` of the patches", ge=0.0, optional=True)
    patch_tilt: tuple[float, ...] = series("1", "`tilt` of the patches", optional=True)
    patch_radius: tuple[float, ...] = series(
        "m",
        "radii of the circles around the patches on which their sliders stand, below 0 where opposite",
        optional=True,
    )
    bolt_x: float = quantity("m", "mean of the bolts' places along the rows, from the centroid", default=0.0)
    bolt_y: float = quantity("m", "mean of the bolts' places across the rows, from the centroid", default=0.0)
    bolt_x2: float = quantity(
        "m2", "mean square of the bolts' distances along the rows, from the centroid", ge=0.0, default=0.0
    )
    bolt_y2: float = quantity(
        "m2", "mean square of the bolts' distances across the rows, from the centroid", ge=0.0, default=0.0
    )
    bolt_xy: float = quantity(
        "m2", "mean product of the bolts' places along and across the rows", default=0.0
    )
    each_bolt_x: tuple[float, ...] = series(
        "m", "position of each bolt along the rows, from the centroid", optional=True
    )
    each_bolt_y: tuple[float, ...] = series(
        "m", "position of each bolt across the rows, from the centroid", optional=True
    )

    def __post_init__(self) -> None:
        check(self)
        for prefix in ("", PATCH):
            self._check_points(prefix)
        if (count := len(self.patch_share)) > PATCHES:
            raise ValueError(f"patch_share has {count} numbers, expected at most {PATCHES}")
        if len(self.each_bolt_y) != (count := len(self.each_bolt_x)):
            raise ValueError(
                f"each_bolt_y has {len(self.each_bolt_y)} numbers, expected {count}: one per each_bolt_x"
            )

    def _check_points(self, prefix: str) -> None:
        """Raise ValueError if the points, or the patches, do not balance."""
        count = len(getattr(self, f"{prefix}share"))
        for name in (*_POINTS, "radius") if prefix and self.patch_radius else _POINTS:
            if (given := len(getattr(self, prefix + name))) != count:
                raise ValueError(
                    f"{prefix}{name} has {given} numbers, expected as many as {prefix}share has: {count}"
                )
        if not count:
            return
        shape, what = self._points(prefix), "of the patches" if prefix else ""
        reach = float(np.max(np.abs(shape.position)))
        x, y = shape.share @ shape.position
        steep = max(float(np.max(np.abs(shape.tilt))), 1.0)
        for text, value, expected, size in (
            (f"the sum of {prefix}share", float(np.sum(shape.share)), 1.0, 1.0),
            ("x of the centroid", float(x), 0.0, reach),
            ("y of the centroid", float(y), 0.0, reach),
            (f"the mean of {prefix}equal", float(shape.share @ shape.equal), 1.0, 1.0),
            (f"the mean of {prefix}tilt", float(shape.share @ shape.tilt), 0.0, steep),
        ):
            if not abs(value - expected) <= BALANCE * size:
                text = f"{text} {what}".rstrip() if "centroid" in text else text
                raise ValueError(f"{text} is {value:.9g}, expected {expected:g} within {BALANCE * size:.1g}")

    @property
    def bolt_means(self) -> Means:
        """Means of x, y [m], x^2, y^2, x y [m2] of the bolts, from the centroid of the contact."""
        return self.bolt_x, self.bolt_y, self.bolt_x2, self.bolt_y2, self.bolt_xy

    @property
    def bolt_positions(self) -> Array:
        """Positions (n, 2) [m] of the bolts, from the centroid of the contact; none where it has no list."""
        return np.stack([self.each_bolt_x, self.each_bolt_y], axis=-1)

    def shape(self) -> PressureShape:
        """The points as arrays."""
        return self._points("")

    def patches(self) -> FrictionPatches | None:
        """Those of its friction, where the field has some of all its nodes."""
        if not self.patch_share:
            return None
        patches = self._points(PATCH).as_patches()
        return replace(patches, radius=np.array(self.patch_radius)) if self.patch_radius else patches

    def _points(self, prefix: str) -> PressureShape:
        share, x, y, equal, tilt = (np.array(getattr(self, prefix + name)) for name in _POINTS)
        return PressureShape(share, np.column_stack([x, y]), equal, tilt)
