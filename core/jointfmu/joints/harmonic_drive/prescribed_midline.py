"""Harmonic drives with a prescribed midline: three lines of a catalogue, or a measured table.

Their midline (torque over wind-up) is a spline through nodes, without a model of the contact pair.
"""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from ...quantity import (
    Array,
    Interval,
    Number,
    ParameterLimit,
    check_fields,
    group_field,
    quantity_field,
    select,
    series_field,
)
from .drive import PLAY_TORQUE_OVER_RATED_TORQUE, DriveParameters, lost_motion_angle

DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP = 0.04
"""Default half-width of a smoothed corner over its wind-up [1]: for catalogue drives the angle at a corner is
then within 0.4 % of the lines."""
MIN_CORNER_HALF_WIDTH_OVER_WIND_UP = 1e-6
"""Smallest half-width of a corner over its wind-up [1], used if `corner` is 0.

The angle at a corner is within 1e-7 of the lines."""
MAX_DRIVE_STIFFNESS = 1e12
"""Largest stiffness of a drive [N.m/rad]: more than a solid steel shaft of its size has."""
MAX_TABLE_POINTS = 1000
"""Largest number of points of a measured table."""
MIN_END_OVER_MEAN_STIFFNESS, MAX_END_OVER_MEAN_STIFFNESS = 1.0 / 3.0, 3.0
"""Bounds of the stiffness at the last point over the mean stiffness of the last segment [1]."""
MIN_INNER_OVER_END_STIFFNESS = 0.5
"""Smallest stiffness inside a segment, over its mean or its end stiffness [1], for which the derivative of
the stiffness is made continuous at its points."""
PLAY_NODE_COUNT = 60
"""Number of nodes for the lost motion on the first line of a catalogue drive [1].

The torque error is below 1e-8 rated_torque."""
PLAY_END_TORQUE_OVER_PLAY_TORQUE = 8.0
"""Torque over T_p at which the lost motion has ended [1]: 2e-7 of lost_motion is then missing.

T_p is the torque of PLAY_TORQUE_OVER_RATED_TORQUE."""
_SEGMENT_SAMPLE_POINTS = np.linspace(0.0, 1.0, 33)
"""Relative positions in a segment [1] at which the stiffness of the midline is checked."""


class SplineNode(NamedTuple):
    """Node of the quintic spline of a drive's midline: torque as a function of wind-up.

    angle, torque, stiffness : wind-up [rad], torque [N.m] and stiffness [N.m/rad]
    stiffness_slope_before, stiffness_slope_after : derivative of the stiffness [N.m/rad2] on the side of
        smaller and larger angle
    """

    angle: Number
    torque: Number
    stiffness: Number
    stiffness_slope_before: Number = 0.0
    stiffness_slope_after: Number = 0.0


@dataclass(frozen=True, kw_only=True)
class PrescribedDriveParameters(DriveParameters):
    """Parameters of a harmonic drive whose midline, torque as a function of wind-up, is a stated spline.

    The parts K_FTS (circular spline and flexspline) and K_TS (contact pair) of the drive's stiffness K_WTS
    are unknown. K_FTS is set to twice the largest K_WTS: so K_TS equals K_FTS where the drive is stiffest,
    and is finite everywhere. The contact pressure is unknown and set to 0.
    """

    unknown_outputs: ClassVar[tuple[str, ...]] = ("K_TS",)
    """Outputs that a prescribed midline does not determine; they are not drawn."""

    @abstractmethod
    def make_midline_nodes(self) -> Sequence[SplineNode]:
        """Make the nodes between which the midline (torque over wind-up, wind-ups >= 0) is interpolated."""

    @property
    def law(self) -> None:
        """Interface law of the contact pair: None, a prescribed midline has none."""
        return

    @property
    def ramp_torque(self) -> Number:
        """Torque [N.m] at the end of load ramps: the last torque of the midline's table."""
        return self.max_table_torque

    def pressure(self, torque: Number) -> Number:
        """Contact pressure (...) [Pa]: set to 0, as a prescribed midline does not determine it."""
        return 0.0 * torque


@dataclass(frozen=True, kw_only=True)
class CatalogueDriveParameters(PrescribedDriveParameters):
    """Parameters of a harmonic drive with the stiffnesses K1, K2, K3 of its catalogue.

    The wind-up as a function of the torque consists of three lines, with the slope 1/K1 up to the torque T1,
    1/K2 up to T2, and 1/K3 beyond. Around the corner at the wind-up theta_i, within theta_i (1 +- corner),
    the stiffness changes from one line to the next by a smooth step. Outside this range torque and angle are
    exactly those of the lines. The torque is twice continuously differentiable everywhere. With corner = 0
    the angles are those of the lines, and the stiffness jumps at T1 and T2 (within
    MIN_CORNER_HALF_WIDTH_OVER_WIND_UP): a kink without an event.
    """

    K1: float = quantity_field("N.m/rad", "stiffness below T1", gt=0.0, le=MAX_DRIVE_STIFFNESS)
    K2: float = quantity_field("N.m/rad", "stiffness between T1 and T2", gt=0.0, le=MAX_DRIVE_STIFFNESS)
    K3: float = quantity_field("N.m/rad", "stiffness above T2", gt=0.0, le=MAX_DRIVE_STIFFNESS)
    T1: float = quantity_field("N.m", "torque at the first corner", gt=0.0)
    T2: float = quantity_field("N.m", "torque at the second corner", gt=0.0)
    corner: float = quantity_field(
        "1",
        "half-width of the smooth corners at T1 and T2, divided by the wind-up there; 0: sharp corners",
        ge=0.0,
        lt=1.0,
        default=DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP,
    )
    max_torque: float = quantity_field(
        "N.m", "largest torque of the tabulated law, above the second corner", gt=0.0
    )

    def find_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of those parameters whose allowed interval depends on other parameters."""
        first, second = self.corner_wind_ups
        return [
            *super().find_parameter_limits(),
            ParameterLimit("T2", Interval.from_bounds(gt=self.T1), "it must exceed T1"),
            ParameterLimit(
                "K1",
                Interval.from_bounds(gt=self._min_first_stiffness, le=MAX_DRIVE_STIFFNESS),
                "it is too far below K2 for smooth corners at T1 and T2; check the value and the unit of K1",
            ),
            ParameterLimit(
                "corner",
                Interval.from_bounds(ge=0.0, lt=(second - first) / (second + first)),
                "the corners at T1 and T2 must not overlap; check first that T1 and T2 are right",
            ),
            ParameterLimit(
                "lost_motion",
                Interval.from_bounds(
                    ge=0.0,
                    le=select(
                        self._first_line_torque
                        > PLAY_END_TORQUE_OVER_PLAY_TORQUE
                        * PLAY_TORQUE_OVER_RATED_TORQUE
                        * self.rated_torque,
                        1.0,
                        0.0,
                    ),
                ),
                "with lost motion, T1 must be above "
                f"{PLAY_END_TORQUE_OVER_PLAY_TORQUE * PLAY_TORQUE_OVER_RATED_TORQUE:g} rated_torque, where "
                "the play ends",
            ),
        ]

    @property
    def corner_wind_ups(self) -> tuple[Number, Number]:
        """Wind-ups [rad] of the catalogue's lines at the corners, at the torques T1 and T2."""
        first = self.T1 / self.K1
        return first, first + (self.T2 - self.T1) / self.K2

    @property
    def _min_first_stiffness(self) -> Number:
        """Smallest stiffness K1 [N.m/rad] at which the rounded corners at T1 and T2 do not overlap.

        The half-width of a corner is the share `corner` of its wind-up, here at most the default share. The
        wind-up grows as K1 falls.
        """
        corner = np.minimum(self.corner, DEFAULT_CORNER_HALF_WIDTH_OVER_WIND_UP)
        torque_ratio = self.T1 / np.maximum(self.T2 - self.T1, self.T1)
        return 2.0 * corner / (1.0 - corner) * self.K2 * torque_ratio

    @property
    def corner_half_width_over_wind_up(self) -> Number:
        """Half-width of a smoothed corner divided by the wind-up at the corner [1].

        At least MIN_CORNER_HALF_WIDTH_OVER_WIND_UP.
        """
        return np.maximum(self.corner, MIN_CORNER_HALF_WIDTH_OVER_WIND_UP)

    @property
    def max_table_torque(self) -> Number:
        """Torque [N.m] at the end of the midline: max_torque, but at least that at the end of corner T2."""
        return np.maximum(
            self.max_torque,
            self.T2 + 2.0 * self.corner_half_width_over_wind_up * self.corner_wind_ups[1] * self.K3,
        )

    @property
    def K_FTS(self) -> Number:
        """Stiffness K_FTS [N.m/rad] of circular spline and flexspline.

        The catalogue does not state it. It is set to twice the largest of K1, K2 and K3: K_TS then equals
        K_FTS where the drive is stiffest, and is finite everywhere.
        """
        return 2.0 * np.maximum(np.maximum(self.K1, self.K2), self.K3)

    @property
    def _first_line_torque(self) -> Number:
        """Torque [N.m] at the end of the catalogue's first line, where the first smoothed corner begins."""
        return self.T1 - self.K1 * self.corner_half_width_over_wind_up * self.corner_wind_ups[0]

    def make_midline_nodes(self) -> list[SplineNode]:
        """Make the nodes of the midline: lost motion, both ends of each corner, end of the table."""
        (first, second), (K1, K2, K3) = self.corner_wind_ups, (self.K1, self.K2, self.K3)
        first_width = self.corner_half_width_over_wind_up * first
        second_width = self.corner_half_width_over_wind_up * second
        end = self.max_table_torque
        play_angle = lost_motion_angle(self, self._first_line_torque)[0]
        return [
            *self._play_spline_nodes(),
            SplineNode(first - first_width + play_angle, self._first_line_torque, K1),
            SplineNode(first + first_width + play_angle, self.T1 + K2 * first_width, K2),
            SplineNode(second - second_width + play_angle, self.T2 - K2 * second_width, K2),
            SplineNode(second + second_width + play_angle, self.T2 + K3 * second_width, K3),
            SplineNode(second + (end - self.T2) / K3 + play_angle, end, K3),
        ]

    def _play_spline_nodes(self) -> list[SplineNode]:
        """Spline nodes of the first catalogue line in series with lost motion; denser at small torque."""
        end_torque = np.minimum(
            PLAY_END_TORQUE_OVER_PLAY_TORQUE * PLAY_TORQUE_OVER_RATED_TORQUE * self.rated_torque,
            self._first_line_torque,
        )
        nodes = []
        for position in np.arange(PLAY_NODE_COUNT) / PLAY_NODE_COUNT:
            torque = end_torque * float(position) ** 2
            angle, compliance, change = lost_motion_angle(self, torque)
            softer = 1.0 + self.K1 * compliance
            bend = -(self.K1**3) * change / softer**3
            nodes.append(SplineNode(torque / self.K1 + angle, torque, self.K1 / softer, bend, bend))
        return nodes


@dataclass(frozen=True, kw_only=True)
class MeasuredMidline:
    """Measured points of the midline: torque and wind-up, both increasing, without the point at zero load.

    Raises ValueError if both columns do not have the same number of points, 2 to MAX_TABLE_POINTS, or do not
    increase.
    """

    torque: tuple[float, ...] = series_field("N.m", "torque of each point, increasing", gt=0.0)
    angle: tuple[float, ...] = series_field("rad", "wind-up of each point, increasing", gt=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        counts = len(self.torque), len(self.angle)
        if counts[0] != counts[1] or not 2 <= counts[0] <= MAX_TABLE_POINTS:
            raise ValueError(
                f"table.torque and table.angle have {counts[0]} and {counts[1]} numbers; "
                f"expected the same number, from 2 to {MAX_TABLE_POINTS}"
            )
        for name, unit in (("torque", "N.m"), ("angle", "rad")):
            values = getattr(self, name)
            for i in np.flatnonzero(np.diff(values) <= 0.0).tolist():
                raise ValueError(
                    f"table.{name}[{i + 1}] = {values[i + 1]:.10g} {unit} is outside "
                    f"({values[i]:.10g}, inf): torque and angle must increase from point to point"
                )


class MeasuredDriveParameters(PrescribedDriveParameters):
    """Harmonic drive with measured torque over wind-up (midline), which already contains the lost motion."""

    def find_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of those parameters whose allowed interval depends on other parameters."""
        no_play = ParameterLimit(
            "lost_motion", Interval.from_bounds(ge=0.0, le=0.0), "the measured midline contains it already"
        )
        return [*super().find_parameter_limits(), no_play]


@dataclass(frozen=True, kw_only=True)
class TableDriveParameters(MeasuredDriveParameters):
    """Parameters of a harmonic drive with a measured midline, a table of torque and angle.

    The torque between the points is a monotone spline with the stiffnesses of Fritsch and Butland 1984
    (PCHIP) at the points. The derivative of the stiffness is made continuous at a point if the stiffness then
    stays well above zero (MIN_INNER_OVER_END_STIFFNESS).
    """

    table: MeasuredMidline = group_field("measured midline, without the point at zero load")

    @property
    def max_table_torque(self) -> float:
        """Torque [N.m] at the last point of the measured table."""
        return self.table.torque[-1]

    @property
    def max_torque(self) -> float:
        """Torque [N.m] at the last point of the measured table."""
        return self.max_table_torque

    @cached_property
    def K_FTS(self) -> float:
        """Stiffness K_FTS [N.m/rad] of circular spline and flexspline: twice the largest of the midline."""
        columns = np.array(self.make_midline_nodes(), dtype=np.float64).T
        x, y, s, slope_before, slope_after = columns
        return 2.0 * float(
            np.max(_sample_stiffness(np.diff(x), np.diff(y), s, slope_after[:-1], slope_before[1:]))
        )

    def make_midline_nodes(self) -> list[SplineNode]:
        """Make the nodes of the midline: at zero, and at each point of the measured table."""
        x, y = (np.array([0.0, *values]) for values in (self.table.angle, self.table.torque))
        h, torque_steps = np.diff(x), np.diff(y)
        s = _node_stiffness(h, torque_steps / h)
        slope_after = (
            6.0 * torque_steps / h - 4.0 * s[:-1] - 2.0 * s[1:]
        ) / h  # of the cubic Hermite segments
        slope_before = (-6.0 * torque_steps / h + 2.0 * s[:-1] + 4.0 * s[1:]) / h
        mean = (h[1:] * slope_before[:-1] + h[:-1] * slope_after[1:]) / (h[:-1] + h[1:])
        common_slope = np.concatenate([[0.0], mean, slope_before[-1:]])
        smallest = np.min(_sample_stiffness(h, torque_steps, s, common_slope[:-1], common_slope[1:]), axis=0)
        is_stiff = smallest > MIN_INNER_OVER_END_STIFFNESS * np.minimum(
            np.minimum(s[:-1], s[1:]), torque_steps / h
        )
        slope_after = np.where(is_stiff, common_slope[:-1], slope_after)
        slope_before = np.where(is_stiff, common_slope[1:], slope_before)
        ends = np.concatenate([[0.0], slope_before]), np.concatenate([slope_after, [0.0]])
        return [SplineNode(*row) for row in np.column_stack([x, y, s, *ends]).tolist()]


def _node_stiffness(segment_widths: Array, secant_stiffnesses: Array) -> Array:
    """Stiffness (n + 1) [N.m/rad] at the nodes of an odd midline of n segments.

    segment_widths, secant_stiffnesses : (n) [rad], [N.m/rad] of the segments
    """
    weight_left = 2.0 * segment_widths[1:] + segment_widths[:-1]
    weight_right = segment_widths[1:] + 2.0 * segment_widths[:-1]
    inner = (weight_left + weight_right) / (
        weight_left / secant_stiffnesses[:-1] + weight_right / secant_stiffnesses[1:]
    )
    end_stiffness = (
        (2.0 * segment_widths[-1] + segment_widths[-2]) * secant_stiffnesses[-1]
        - segment_widths[-1] * secant_stiffnesses[-2]
    ) / (segment_widths[-1] + segment_widths[-2])
    return np.concatenate(
        [
            secant_stiffnesses[:1],
            inner,
            [
                np.clip(
                    end_stiffness,
                    MIN_END_OVER_MEAN_STIFFNESS * secant_stiffnesses[-1],
                    MAX_END_OVER_MEAN_STIFFNESS * secant_stiffnesses[-1],
                )
            ],
        ]
    )


def _sample_stiffness(
    segment_widths: Array,
    torque_increments: Array,
    node_stiffness: Array,
    stiffness_slope_after: Array,
    stiffness_slope_before: Array,
) -> Array:
    """Stiffness (m, n) of the midline at m sample points inside each of n quintic segments.

    segment_widths, torque_increments             : (n) widths and torque increments of the segments
    node_stiffness                                : (n + 1) stiffness at the nodes
    stiffness_slope_after, stiffness_slope_before : (n) derivative of the stiffness at the start and at the
                                                    end of each segment
    """
    t = _SEGMENT_SAMPLE_POINTS[:, None]
    first, last = node_stiffness[:-1], node_stiffness[1:]
    a2 = torque_increments / segment_widths
    c0 = 0.5 * segment_widths * stiffness_slope_after
    c1 = 0.5 * segment_widths * stiffness_slope_before
    cubic = 30.0 * a2 - 18.0 * first - 12.0 * last - 9.0 * c0 + 3.0 * c1
    quartic = -60.0 * a2 + 32.0 * first + 28.0 * last + 12.0 * c0 - 8.0 * c1
    quintic = 30.0 * a2 - 15.0 * first - 15.0 * last - 5.0 * c0 + 5.0 * c1
    return np.asarray(first + t * (2.0 * c0 + t * (cubic + t * (quartic + t * quintic))))
