"""Harmonic drives whose midline is given: the three lines of a catalogue, or a measured table.

Neither knows of a contact pair. What they export of one is stated in `Given`.
"""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...quantity import Array, Interval, Limit, Number, check, group, quantity, series, where
from .drive import WIDTH, Drive, play

CORNER = 0.04
"""Usual half-width of a corner over its wind-up [1]: at the corners of catalogue drives the angle then is
within 0.4 % of the lines."""
SHARPEST = 1e-6
"""Half-width [1] that stands for none: the angle at a corner then is within 1e-7 of the lines."""
STIFFEST = 1e12
"""Largest stiffness of a drive [N.m/rad]: more than a solid shaft of steel of its size has."""
MOST_POINTS = 1000
"""Most points of a measured table."""
LEAST_SLOPE, LARGEST_SLOPE = 1.0 / 3.0, 3.0
"""Stiffness at the last point over that from the point before [1]."""
SOFTEST = 0.5
"""Least stiffness [1] of a segment that bends as its neighbours do, over its mean or that at an end."""
PLAY_NODES = 60
"""Nodes of the play on a catalogue's first line: torque within 1e-8 of the rated one."""
SPENT = 8.0
"""Torque over that of the play [1] where nothing is left of it: 2e-7."""
_INNER = np.linspace(0.0, 1.0, 33)


class Node(NamedTuple):
    """A node of the midline's quintic spline: wind-up [rad], torque [N.m], stiffness [N.m/rad], and the
    derivative of the stiffness [N.m/rad2] before and after it.
    """

    angle: Number
    torque: Number
    stiffness: Number
    before: Number = 0.0
    after: Number = 0.0


@dataclass(frozen=True, kw_only=True)
class Given(Drive):
    """A drive whose midline is the quintic spline through nodes.

    Nothing tells the parts of its stiffness apart. K_FTS is twice the largest K_WTS, so that both parts are
    equal where the drive is stiffest and K_TS is finite everywhere. There is no contact pressure: it is 0.
    """

    @abstractmethod
    def nodes(self) -> Sequence[Node]:
        """Nodes of the midline, from wind-up zero on; the midline is odd."""

    @property
    def law(self) -> None:
        """None: it has no interface law."""
        return

    @property
    def ramp_torque(self) -> Number:
        """reach: all that is given."""
        return self.reach

    def pressure(self, torque: Number) -> Number:
        """0 [Pa]."""
        return 0.0 * torque


@dataclass(frozen=True, kw_only=True)
class CatalogueDrive(Given):
    """Parameters of a harmonic drive with the stiffness of its catalogue row.

    The angle is theta(T) = T/K1 up to T1, then grows by 1/K2 and beyond T2 by 1/K3. Around its corner at
    wind-up theta_i the stiffness goes from one line's to the next by the smooth step 3 t^2 - 2 t^3 over
    theta_i (1 +- corner): outside of it torque and angle are exactly those of the lines, and the torque is
    twice continuously differentiable everywhere. Without a corner (0) the printed angles are met everywhere
    and the stiffness jumps at T1 and T2, within SHARPEST: a kink of the torque, of which no event tells.
    """

    K1: float = quantity("N.m/rad", "stiffness below T1", gt=0.0, le=STIFFEST)
    K2: float = quantity("N.m/rad", "stiffness between T1 and T2", gt=0.0, le=STIFFEST)
    K3: float = quantity("N.m/rad", "stiffness above T2", gt=0.0, le=STIFFEST)
    T1: float = quantity("N.m", "torque at the first corner", gt=0.0)
    T2: float = quantity("N.m", "torque at the second corner", gt=0.0)
    corner: float = quantity(
        "1",
        "half-width of the two smooth corners over their wind-up; 0: the lines themselves, with kinks",
        ge=0.0,
        lt=1.0,
        default=CORNER,
    )
    max_torque: float = quantity("N.m", "end of the tabulated law, at least past the second corner", gt=0.0)

    def limits(self) -> list[Limit]:
        """Intervals that other parameters decide."""
        first, second = self.corners
        return [
            *super().limits(),
            Limit("T2", Interval.of(gt=self.T1), "it must exceed T1"),
            Limit(
                "corner",
                Interval.of(ge=0.0, lt=(second - first) / (second + first)),
                "corners must not meet",
            ),
            Limit(
                "lost_motion",
                Interval.of(ge=0.0, le=where(self._straight > SPENT * WIDTH * self.rated_torque, 1.0, 0.0)),
                f"the first line must reach beyond {SPENT * WIDTH:g} rated_torque, where play ends",
            ),
        ]

    @property
    def corners(self) -> tuple[Number, Number]:
        """Wind-up [rad] at T1 and T2 on the lines."""
        first = self.T1 / self.K1
        return first, first + (self.T2 - self.T1) / self.K2

    @property
    def half_width(self) -> Number:
        """Of the corners over their wind-up [1]."""
        return np.maximum(self.corner, SHARPEST)

    @property
    def reach(self) -> Number:
        """max_torque, or twice as far beyond T2 as its corner reaches."""
        return np.maximum(self.max_torque, self.T2 + 2.0 * self.half_width * self.corners[1] * self.K3)

    @property
    def K_FTS(self) -> Number:
        """Twice the largest of K1, K2 and K3."""
        return 2.0 * np.maximum(np.maximum(self.K1, self.K2), self.K3)

    @property
    def _straight(self) -> Number:
        """Torque [N.m] at the end of the first line, where its corner begins."""
        return self.T1 - self.K1 * self.half_width * self.corners[0]

    def nodes(self) -> list[Node]:
        """Those of the play on the first line, then five: of the corners, where the stiffness does not bend,
        and of the end."""
        (first, second), (K1, K2, K3) = self.corners, (self.K1, self.K2, self.K3)
        one, two, end = self.half_width * first, self.half_width * second, self.reach
        far = play(self, self._straight)[0]
        return [
            *self._with_play(),
            Node(first - one + far, self._straight, K1),
            Node(first + one + far, self.T1 + K2 * one, K2),
            Node(second - two + far, self.T2 - K2 * two, K2),
            Node(second + two + far, self.T2 + K3 * two, K3),
            Node(second + (end - self.T2) / K3 + far, end, K3),
        ]

    def _with_play(self) -> list[Node]:
        """On the first line, closer where the torque is small."""
        most, nodes = np.minimum(SPENT * WIDTH * self.rated_torque, self._straight), []
        for part in np.arange(PLAY_NODES) / PLAY_NODES:
            torque = most * float(part) ** 2
            angle, compliance, change = play(self, torque)
            softer = 1.0 + self.K1 * compliance
            bend = -(self.K1**3) * change / softer**3
            nodes.append(Node(torque / self.K1 + angle, torque, self.K1 / softer, bend, bend))
        return nodes


@dataclass(frozen=True, kw_only=True)
class TorqueAngle:
    """Points of a measured midline beside the unloaded drive, both columns rising."""

    torque: tuple[float, ...] = series("N.m", "torque of each point, rising", gt=0.0)
    angle: tuple[float, ...] = series("rad", "wind-up of each point, rising", gt=0.0)

    def __post_init__(self) -> None:
        check(self)
        counts = len(self.torque), len(self.angle)
        if counts[0] != counts[1] or not 2 <= counts[0] <= MOST_POINTS:
            raise ValueError(
                f"table.torque and table.angle have {counts[0]} and {counts[1]} points, "
                f"allowed is 2 to {MOST_POINTS}, the same of both"
            )
        for name, unit in (("torque", "N.m"), ("angle", "rad")):
            values = getattr(self, name)
            for i in np.flatnonzero(np.diff(values) <= 0.0).tolist():
                raise ValueError(
                    f"table.{name}[{i + 1}] = {values[i + 1]:.10g} {unit} is outside "
                    f"({values[i]:.10g}, inf): torque and angle rise from point to point"
                )


class Measured(Given):
    """A drive whose midline was measured."""

    def limits(self) -> list[Limit]:
        """Intervals that other parameters decide."""
        none = Limit("lost_motion", Interval.of(ge=0.0, le=0.0), "a measured midline has it already")
        return [*super().limits(), none]


@dataclass(frozen=True, kw_only=True)
class TableDrive(Measured):
    """Parameters of a harmonic drive with a measured midline.

    Between the points the torque follows a monotone spline: stiffnesses at the points by Fritsch and Butland
    1984 (PCHIP), and the bends on both sides of a point made equal where the stiffness stays well above zero.
    """

    table: TorqueAngle = group("measured midline: the point without load is left out")

    @property
    def reach(self) -> float:
        """Torque [N.m] at the last point."""
        return self.table.torque[-1]

    @property
    def max_torque(self) -> float:
        """Torque [N.m] at the last point."""
        return self.reach

    @cached_property
    def K_FTS(self) -> float:
        """Twice the largest stiffness of the table."""
        columns = np.array(self.nodes(), dtype=np.float64).T
        x, y, s, before, after = columns
        return 2.0 * float(np.max(_stiffness(np.diff(x), np.diff(y), s, after[:-1], before[1:])))

    def nodes(self) -> list[Node]:
        """One at zero and one at each point."""
        x, y = (np.array([0.0, *values]) for values in (self.table.angle, self.table.torque))
        h, rise = np.diff(x), np.diff(y)
        s = _slopes(h, rise / h)
        after = (6.0 * rise / h - 4.0 * s[:-1] - 2.0 * s[1:]) / h  # of the cubic of each segment
        before = (-6.0 * rise / h + 2.0 * s[:-1] + 4.0 * s[1:]) / h
        mean = (h[1:] * before[:-1] + h[:-1] * after[1:]) / (h[:-1] + h[1:])
        even = np.concatenate([[0.0], mean, before[-1:]])
        least = np.min(_stiffness(h, rise, s, even[:-1], even[1:]), axis=0)
        firm = least > SOFTEST * np.minimum(np.minimum(s[:-1], s[1:]), rise / h)
        after, before = np.where(firm, even[:-1], after), np.where(firm, even[1:], before)
        ends = np.concatenate([[0.0], before]), np.concatenate([after, [0.0]])
        return [Node(*row) for row in np.column_stack([x, y, s, *ends]).tolist()]


def _slopes(h: Array, d: Array) -> Array:
    """Stiffness (n + 1) at the points of segments h, with secants d (n); the curve is odd."""
    one, two = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    inner = (one + two) / (one / d[:-1] + two / d[1:])
    last = ((2.0 * h[-1] + h[-2]) * d[-1] - h[-1] * d[-2]) / (h[-1] + h[-2])
    return np.concatenate([d[:1], inner, [np.clip(last, LEAST_SLOPE * d[-1], LARGEST_SLOPE * d[-1])]])


def _stiffness(h: Array, rise: Array, s: Array, after: Array, before: Array) -> Array:
    """Stiffness (m, n) within the quintics of n segments."""
    t = _INNER[:, None]
    first, last = s[:-1], s[1:]
    a2, c0, c1 = rise / h, 0.5 * h * after, 0.5 * h * before
    cubic = 30.0 * a2 - 18.0 * first - 12.0 * last - 9.0 * c0 + 3.0 * c1
    quartic = -60.0 * a2 + 32.0 * first + 28.0 * last + 12.0 * c0 - 8.0 * c1
    quintic = 30.0 * a2 - 15.0 * first - 15.0 * last - 5.0 * c0 + 5.0 * c1
    return np.asarray(first + t * (2.0 * c0 + t * (cubic + t * (quartic + t * quintic))))
