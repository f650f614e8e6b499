"""Pressure distribution of a bolted contact: nodes, friction patches, nodal fields of parameter files."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...quantity import Array, check_fields, quantity_field, series_field

NODAL_FIELD_SUM_TOLERANCE = 1e-6
"""Largest error of the sums and means that a nodal pressure field of a file must have [1]."""
PRESSURE_COMPARISON_DECIMALS = 11
"""Decimals to which pressures of nodes are compared [1]: symmetric nodes then agree."""


@dataclass(frozen=True, slots=True)
class PressureDistribution:
    """Pressure distribution of a bolted contact at n nodes.

    area_share             : (n)    [1] share of the node in the nominal area, with the sum 1
    position               : (n, 2) [m] relative to the centroid of the contact
    preload_pressure_ratio : (n)    [1] pressure over mean pressure for equal bolt forces
    moment_pressure_ratio  : (n)    [1] pressure by a moment about x (bolt forces +1 in the row y > 0, -1 in
                             the row y < 0) over the mean pressure of one row
    """

    area_share: Array
    position: Array
    preload_pressure_ratio: Array
    moment_pressure_ratio: Array

    @property
    def rows(self) -> list[Array]:
        """One array (n) for each number of a node: area share, x, y, and the other fields in their order."""
        share, position, *others = (getattr(self, item.name) for item in fields(self))
        return [share, *position.T, *others]

    @classmethod
    def from_rows(cls, node_rows: Sequence[Array] | Array) -> Self:
        """Make a pressure distribution from arrays (n) of all numbers of its nodes, in the order of `rows`.

        The order is share, x, y, pressure ratios of preload and of moment; for patches also the radius.
        """
        share, x, y, *others = node_rows
        return cls(share, np.column_stack([x, y]), *others)

    def select_nodes(self, node_indices: "slice | NDArray[np.intp]") -> "PressureDistribution":
        """Select a subset of the nodes, with unchanged shares; returns a new distribution."""
        return PressureDistribution(
            self.area_share[node_indices],
            self.position[node_indices],
            self.preload_pressure_ratio[node_indices],
            self.moment_pressure_ratio[node_indices],
        )

    def make_friction_patches(self) -> "FrictionPatches":
        """Friction patches, one per node, with slider circles of radius 0."""
        return FrictionPatches(
            self.area_share,
            self.position,
            self.preload_pressure_ratio,
            self.moment_pressure_ratio,
            np.zeros_like(self.area_share),
        )

    def merge_nodes(self, keeps_moment_pressure: bool = True) -> "MergedDistribution":
        """Merge nodes that have the same pressure at every preload and moment.

        keeps_moment_pressure : False: ignore the pressure by moments, and merge all nodes with the same
            pressure at every preload
        """
        tilt = self.moment_pressure_ratio if keeps_moment_pressure else 0.0 * self.moment_pressure_ratio
        keys = np.round(np.column_stack([self.preload_pressure_ratio, tilt]), PRESSURE_COMPARISON_DECIMALS)
        _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        share = np.asarray(np.bincount(group.ravel(), self.area_share), dtype=np.float64)
        x2, y2 = (np.bincount(group.ravel(), self.area_share * x**2) / share for x in self.position.T)
        return MergedDistribution(share, self.preload_pressure_ratio[first], tilt[first], x2, y2)


@dataclass(frozen=True, slots=True)
class FrictionPatches(PressureDistribution):
    """Patches that represent the friction of a contact, each for the nodes around it.

    slider_circle_radius : (n) [m] radius of the circle around the centre of a patch on which its sliders lie;
        negative: the circle is turned by 180 degrees
    """

    slider_circle_radius: Array


def moment_pressure(area_share: Array, y: Array, preload_pressure_ratio: Array) -> Array:
    """Pressure (n) [1/m] by a moment of 1 N.m on an area of 1 m2, linear in the distance from the centre.

    The pressure is p (y - y_p)/sum(area_share p (y - y_p)^2), p = preload_pressure_ratio, y_p centre of
    pressure.

    area_share, y [m], preload_pressure_ratio : (n) as in PressureDistribution

    Raises ValueError if all nodes in contact have the same y.
    """
    force = area_share * preload_pressure_ratio
    distances = y - force @ y
    second_moment = float(force @ distances**2)
    if not second_moment > 0.0:
        raise ValueError(
            "all nodes in contact have the same y; expected a contact that extends across the bolt rows"
        )
    return np.asarray(preload_pressure_ratio * distances / second_moment)


BOLT_POSITION_MEAN_NAMES = ("bolt_x", "bolt_y", "bolt_x2", "bolt_y2", "bolt_xy")
"""Keys of the section [field] for the means of its bolt positions, in the order of `position_means`."""
PositionMeans: TypeAlias = tuple[float, float, float, float, float]


def position_means(positions: Array) -> PositionMeans:
    """Means of x, y [m], x^2, y^2 and x y [m2] of points (n, 2) [m]."""
    x, y = positions.T
    first, second, xx, yy, xy = (float(np.mean(values)) for values in (x, y, x * x, y * y, x * y))
    return first, second, xx, yy, xy


@dataclass(frozen=True, slots=True)
class MergedDistribution:
    """Pressure distribution in which nodes of equal pressure are merged; fields as in PressureDistribution.

    mean_square_x, mean_square_y : (n) [m2] mean squared distances from the centroid along and across the bolt
        rows
    """

    area_share: Array
    preload_pressure_ratio: Array
    moment_pressure_ratio: Array
    mean_square_x: Array
    mean_square_y: Array


_CONTACT_POINT_ENTRY_NAMES = ("share", "x", "y", "equal", "tilt")
"""Keys of the section [field] of a parameter file for the contact points."""
PATCH_KEY_PREFIX = "patch_"
"""Prefix of the keys of the section [field] of a parameter file for the friction patches."""
MAX_PATCHES = 22
"""Largest number of friction patches of a joint [1], each with sliders."""


def encode_nodal_field(pressure_distribution: PressureDistribution) -> dict[str, tuple[float, ...]]:
    """Encode points or friction patches as entries {name: values} of [field] in a parameter file."""
    rows = dict(
        zip(
            _CONTACT_POINT_ENTRY_NAMES,
            (
                pressure_distribution.area_share,
                *pressure_distribution.position.T,
                pressure_distribution.preload_pressure_ratio,
                pressure_distribution.moment_pressure_ratio,
            ),
            strict=True,
        )
    )
    if isinstance(pressure_distribution, FrictionPatches):
        rows = {
            PATCH_KEY_PREFIX + name: row
            for name, row in (rows | {"radius": pressure_distribution.slider_circle_radius}).items()
        }
    return {name: tuple(row.tolist()) for name, row in rows.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class NodalField:
    """Pressure of a bolted contact at points that represent the result of a contact analysis.

    Optional friction patches represent the friction.

    Raises ValueError if the entries of the points, or of the patches, have different lengths or do not
    balance. Balanced within NODAL_FIELD_SUM_TOLERANCE: the sum of shares is 1, the centroid is the
    origin, the mean of `equal` (pressure ratio under equal bolt forces) is 1, and the mean of `tilt`
    (pressure ratio under a moment) is 0.
    """

    share: tuple[float, ...] = series_field(
        "1", "shares of the points in the nominal area, which sum to 1", gt=0.0
    )
    x: tuple[float, ...] = series_field("m", "positions along the bolt rows, from the centroid")
    y: tuple[float, ...] = series_field("m", "positions across the bolt rows, from the centroid")
    equal: tuple[float, ...] = series_field(
        "1", "pressures over mean pressure with equal bolt forces", ge=0.0
    )
    tilt: tuple[float, ...] = series_field(
        "1", "pressures that a moment adds, over the mean pressure of one row's share of it"
    )
    patch_share: tuple[float, ...] = series_field(
        "1", "shares of the friction patches in the nominal area, which sum to 1", gt=0.0, is_optional=True
    )
    patch_x: tuple[float, ...] = series_field(
        "m", "positions of the friction patches along the bolt rows, from the centroid", is_optional=True
    )
    patch_y: tuple[float, ...] = series_field(
        "m", "positions of the friction patches across the bolt rows, from the centroid", is_optional=True
    )
    patch_equal: tuple[float, ...] = series_field(
        "1",
        "pressures at the friction patches over mean pressure with equal bolt forces",
        ge=0.0,
        is_optional=True,
    )
    patch_tilt: tuple[float, ...] = series_field(
        "1", "pressures at the friction patches that a moment adds, as tilt", is_optional=True
    )
    patch_radius: tuple[float, ...] = series_field(
        "m",
        "radii of the circles on which the sliders of a patch lie; negative: circle turned by 180 degrees",
        is_optional=True,
    )
    bolt_x: float = quantity_field(
        "m", "mean position of the bolts along the rows, from the centroid", default=0.0
    )
    bolt_y: float = quantity_field(
        "m", "mean position of the bolts across the rows, from the centroid", default=0.0
    )
    bolt_x2: float = quantity_field(
        "m2", "mean square of the bolts' distances along the rows, from the centroid", ge=0.0, default=0.0
    )
    bolt_y2: float = quantity_field(
        "m2", "mean square of the bolts' distances across the rows, from the centroid", ge=0.0, default=0.0
    )
    bolt_xy: float = quantity_field(
        "m2", "mean product of the bolts' positions along and across the rows, from the centroid", default=0.0
    )
    each_bolt_x: tuple[float, ...] = series_field(
        "m", "position of each bolt along the rows, from the centroid", is_optional=True
    )
    each_bolt_y: tuple[float, ...] = series_field(
        "m", "position of each bolt across the rows, from the centroid", is_optional=True
    )

    def __post_init__(self) -> None:
        check_fields(self)
        for prefix in ("", PATCH_KEY_PREFIX):
            self._check_points(prefix)
        if (count := len(self.patch_share)) > MAX_PATCHES:
            raise ValueError(f"patch_share has {count} friction patches, expected at most {MAX_PATCHES}")
        if len(self.each_bolt_y) != (count := len(self.each_bolt_x)):
            raise ValueError(
                f"each_bolt_y has {len(self.each_bolt_y)} numbers, expected {count}: one per each_bolt_x"
            )

    def _check_points(self, entry_prefix: str) -> None:
        """Raise ValueError if the lists of the points or patches differ in length, or a sum is wrong.

        The area shares add up to 1, their centroid is the origin, and the means of the pressure shapes are
        1 (preload) and 0 (moment).

        entry_prefix : prefix of the names of the lists: "" for the points, PATCH_KEY_PREFIX for the patches
        """
        count = len(getattr(self, f"{entry_prefix}share"))
        for name in (
            (*_CONTACT_POINT_ENTRY_NAMES, "radius")
            if entry_prefix and self.patch_radius
            else _CONTACT_POINT_ENTRY_NAMES
        ):
            if (length := len(getattr(self, entry_prefix + name))) != count:
                raise ValueError(
                    f"{entry_prefix}{name} has {length} numbers, expected as many as "
                    f"{entry_prefix}share has: {count}"
                )
        if not count:
            return
        shape, owner = self._make_distribution(entry_prefix), "patches" if entry_prefix else "points"
        reach = float(np.max(np.abs(shape.position)))
        x, y = shape.area_share @ shape.position
        steep = max(float(np.max(np.abs(shape.moment_pressure_ratio))), 1.0)
        for text, value, expected, size in (
            (f"the sum of {entry_prefix}share", float(np.sum(shape.area_share)), 1.0, 1.0),
            ("x [m] of the centroid", float(x), 0.0, reach),
            ("y [m] of the centroid", float(y), 0.0, reach),
            (
                f"the mean of {entry_prefix}equal over the area",
                float(shape.area_share @ shape.preload_pressure_ratio),
                1.0,
                1.0,
            ),
            (
                f"the mean of {entry_prefix}tilt over the area",
                float(shape.area_share @ shape.moment_pressure_ratio),
                0.0,
                steep,
            ),
        ):
            if not abs(value - expected) <= NODAL_FIELD_SUM_TOLERANCE * size:
                text = f"{text} of the {owner}" if "centroid" in text else text
                raise ValueError(
                    f"{text} is {value:.9g}, expected {expected:g} within "
                    f"{NODAL_FIELD_SUM_TOLERANCE * size:.1g}"
                )

    @property
    def bolt_position_means(self) -> PositionMeans:
        """Means of x, y [m], x^2, y^2, x y [m2] of the bolt positions, from the centroid of the contact."""
        return self.bolt_x, self.bolt_y, self.bolt_x2, self.bolt_y2, self.bolt_xy

    @property
    def bolt_positions(self) -> Array:
        """Positions (n, 2) [m] of the bolts, from the centroid of the contact; empty if none are stated."""
        return np.stack([self.each_bolt_x, self.each_bolt_y], axis=-1)

    def pressure_distribution(self) -> PressureDistribution:
        """Pressure distribution of the field, with its points as nodes."""
        return self._make_distribution("")

    def friction_patches(self) -> FrictionPatches | None:
        """Friction patches; None if the field states none."""
        if not self.patch_share:
            return None
        patches = self._make_distribution(PATCH_KEY_PREFIX).make_friction_patches()
        return (
            replace(patches, slider_circle_radius=np.array(self.patch_radius))
            if self.patch_radius
            else patches
        )

    def _make_distribution(self, entry_prefix: str) -> PressureDistribution:
        """Make the pressure distribution of the points (prefix "") or of the friction patches."""
        share, x, y, equal, tilt = (
            np.array(getattr(self, entry_prefix + name)) for name in _CONTACT_POINT_ENTRY_NAMES
        )
        return PressureDistribution(share, np.column_stack([x, y]), equal, tilt)
