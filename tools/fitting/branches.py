"""Measured loops, cut into branches at their turning points, against a law with memory.

Where the measurement has its zero is not known: of the force each branch has a level of its own, and of the
motion the place of rest, about which the elastic force is odd, is found for each law.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid
from scipy.signal import find_peaks

from jointfmu.quantity import Array

from .hysteresis import HysteresisLaw

PROMINENCE = 0.02
"""Least reversal of the motion, over its range [1], that is a turning point."""
NOISE = 8.0
"""The same in standard deviations of the motion's noise [1]."""
AROUND = 5.0
"""Samples this near to a turning point, in standard deviations of the noise [1], say where it is."""
LEAST = 5
"""Fewest samples of a branch."""
CREATED = 4.0
"""Energy that a loop may create, in its own standard deviations [1]."""
ROUNDING = 1e-9
"""The same over the energy of the loop's box [1], for data without noise."""
CLOSED = 0.9
"""Motion that two branches share over that of the longer one [1] from which on they close a loop."""
_GRID = 200
_SEARCH, _WIDTH = 6, 1e-4
"""Steps to the place of rest, and half the width of its differences over the range of the motion [1]."""


@dataclass(frozen=True, slots=True)
class Loops:
    """Branches of loops, one after the other.

    motion, force : (n) samples
    branch : (n) number of the branch of a sample
    start, doubt : (branches) motion at the turning point from which each begins, and its standard deviation
    run    : (n) number of its run
    areas  : measured area [J] and range of motion of the widest loop of each run that has one
    """

    motion: Array
    force: Array
    branch: NDArray[np.int64]
    start: Array
    doubt: Array
    run: NDArray[np.int64]
    areas: Sequence[tuple[float, float]]

    @property
    def groups(self) -> NDArray[np.int64]:
        """Samples of the same noise: those of a run."""
        return self.run

    @property
    def scale(self) -> Array:
        """Size (n) of the force in the run of a sample."""
        return np.array([np.ptp(self.force[self.run == k]) for k in range(self.run[-1] + 1)])[self.run]

    @property
    def nuisances(self) -> int:
        """Force and motion at the turning point of each branch, and the place of rest."""
        return 2 * self.start.size + 1

    @property
    def rest_stiffness(self) -> float:
        """Stiffness [N/m or N.m/rad] just after a turning point, roughly: the steepest of the parabolas."""
        slopes = []
        for k, start in enumerate(self.start):
            way, force = self.motion[self.branch == k] - start, self.force[self.branch == k]
            slopes.append(float(np.polyfit(np.abs(way), np.sign(way) * force, 2)[1]))
        return max(slopes)

    def fitted(self, law: HysteresisLaw, scale: Array) -> tuple[Array, Array, Array]:
        """Force and motion (branches) at the turning points that suit the samples best, and misfit (n)."""
        rest, lever = self._shifted(law, 0.0), self._shifted(law, 1.0)
        lever = (lever - rest) / self.doubt[self.branch]
        force, level = self._means(rest), self._means(lever)
        rest, lever = rest - force[self.branch], lever - level[self.branch]
        weight = scale**-2.0
        shift = -self._sums(weight * rest * lever) / (self._sums(weight * lever**2) + self.doubt**-2.0)
        return force + level * shift, self.start + shift, rest + lever * shift[self.branch]

    def rest(self, law: HysteresisLaw, scale: Array) -> float:
        """Motion at which the elastic force is zero: the least squares of the misfit, by Gauss and Newton.

        Begins at zero or in the middle of the motion. A law that is linear there leaves it where it begins.
        """
        if law.elastic is None:
            return 0.0
        force = law.elastic.force
        slipped = self._shifted(replace(law, elastic=None), 0.0)
        size = float(np.ptp(self.motion))

        def misfit(rest: float) -> Array:
            left = slipped - force(self.motion - rest) + force(self.start - rest)[self.branch]
            return np.asarray((left - self._means(left)[self.branch]) / scale)

        middle = 0.5 * float(np.max(self.motion) + np.min(self.motion))
        found = min((0.0, middle), key=lambda rest: float(np.sum(misfit(rest) ** 2)))
        for _ in range(_SEARCH):
            high, low = (misfit(found + way * _WIDTH * size) for way in (1.0, -1.0))
            slope = (high - low) / (2.0 * _WIDTH)
            step = -float(misfit(found) @ slope) / (float(slope @ slope) + 1.0)
            found += size * float(np.clip(step, -0.5, 0.5))
        return found

    def residuals(self, law: HysteresisLaw, scale: Array) -> Array:
        """Misfit over the scale (n), then the shifts of the turning points over their doubt (branches)."""
        _, start, rest = self.fitted(law.about(self.rest(law, scale)), scale)
        return np.concatenate([rest / scale, (start - self.start) / self.doubt])

    def _shifted(self, law: HysteresisLaw, doubts: float) -> Array:
        """Force (n) less its change from turning points that are moved by some standard deviations."""
        return self.force - law.change(self.motion, (self.start + doubts * self.doubt)[self.branch])

    def _sums(self, values: Array) -> Array:
        return np.asarray(np.bincount(self.branch, values), dtype=np.float64)

    def _means(self, values: Array) -> Array:
        return np.asarray(self._sums(values) / np.bincount(self.branch))


def cut(runs: Sequence[tuple[str, Array, Array]]) -> Loops:
    """The branches of measured runs: how a message calls a run, its motion and force in their order.

    What comes before the first turning point has no known history and is left out; so is what passes
    the turning point before.

    Raises ValueError: no branch, a force that falls with the motion, a loop that creates energy.
    """
    parts: list[tuple[Array, Array, float, float, int]] = []
    areas = []
    for number, (name, motion, force) in enumerate(runs):
        turns = turning_points(motion)
        if not turns.size:
            raise ValueError(f"{name}the motion does not turn around; expected loops")
        _check_sign(name, motion, force)
        ends = [*turns.tolist(), motion.size - 1]
        areas += _check_energy(name, motion, force, ends)
        found = [(*part, number) for part in _run(motion, force, ends)]
        if not found:
            raise ValueError(f"{name}no branch after a turning point has {LEAST} samples; expected loops")
        parts += found
    sizes = [part[0].size for part in parts]
    return Loops(
        motion=np.concatenate([part[0] for part in parts]),
        force=np.concatenate([part[1] for part in parts]),
        branch=np.repeat(np.arange(len(parts)), sizes),
        start=np.array([part[2] for part in parts]),
        doubt=np.array([part[3] for part in parts]),
        run=np.repeat([part[4] for part in parts], sizes),
        areas=areas,
    )


def _run(motion: Array, force: Array, ends: Sequence[int]) -> Iterator[tuple[Array, Array, float, float]]:
    """Motion and force of the branches of a run, and the motion at their turning points with its doubt."""
    noisy = noise(motion)
    at = [turning_value(motion, k, noisy) for k in ends]
    for k, (first, last) in enumerate(pairwise(ends)):
        u, F = motion[first + 1 : last + 1], force[first + 1 : last + 1]
        inside = np.abs(u - at[k]) <= (abs(at[k - 1] - at[k]) if k else np.inf)
        if np.count_nonzero(inside) >= LEAST:
            step = 0.25 * (abs(motion[first + 1] - motion[first]) + abs(motion[first] - motion[first - 1]))
            doubt = max(float(np.hypot(step, noisy)), ROUNDING * float(np.ptp(motion)))
            yield u[inside], F[inside], at[k], doubt


def turning_points(motion: Array) -> NDArray[np.int64]:
    """Places where the motion turns around."""
    least = max(PROMINENCE * float(np.ptp(motion)), NOISE * noise(motion))
    if not least > 0.0:
        return np.array([], dtype=np.int64)
    return extremes(motion, least)


def extremes(signal: Array, least: float) -> NDArray[np.int64]:
    """Places where a signal turns around by `least` or more."""
    return np.sort(np.concatenate([find_peaks(way * signal, prominence=least)[0] for way in (1.0, -1.0)]))


def turning_value(motion: Array, turn: int, noisy: float) -> float:
    """The motion at a turning point, from a parabola through the samples that noise hardly tells apart.

    The largest of some noisy samples alone would lie too far out.
    """
    apart = np.abs(motion - motion[turn]) > AROUND * noisy
    before, after = np.flatnonzero(apart[:turn]), np.flatnonzero(apart[turn:])
    width = min(
        turn - int(before[-1]) if before.size else turn,
        int(after[0]) if after.size else motion.size - 1 - turn,
    )
    if width < 2:
        return float(motion[turn])
    place = np.arange(-width, width + 1)
    c, b, a = np.polyfit(place, motion[turn - width : turn + width + 1], 2)
    return float(a - b**2 / (4.0 * c) if c else a)


def noise(signal: Array) -> float:
    """Standard deviation of independent noise on a smooth signal, from its second differences.

    The curvature of the signal itself counts as noise, so the value is an upper bound.
    """
    if signal.size < 3:
        return 0.0
    return float(np.median(np.abs(np.diff(signal, 2))) / 0.6745 / np.sqrt(6.0))


def _check_sign(name: str, motion: Array, force: Array) -> None:
    if np.sum((motion - motion.mean()) * (force - force.mean())) <= 0.0:
        raise ValueError(f"{name}the force falls as the motion rises; reverse the sign of one column")


def _check_energy(name: str, motion: Array, force: Array, ends: Sequence[int]) -> list[tuple[float, float]]:
    """Area and range of the run's widest closed loop; refuse loops that create energy beyond their noise."""
    sides = [(motion[a : b + 1], force[a : b + 1]) for a, b in pairwise(ends)]
    found = [loop for one, other in pairwise(sides) if (loop := _area(one, other))]
    if not found:
        return []
    areas, ranges, _ = np.array(found).T
    area, size = float(np.mean(areas)), float(np.max(ranges))
    slope = float(np.ptp(force) / np.ptp(motion))
    spread = np.hypot(noise(force), slope * noise(motion)) * size / np.sqrt(0.5 * motion.size)
    if area < -max(CREATED * spread, ROUNDING * size * float(np.ptp(force))):
        raise ValueError(
            f"{name}the loop creates energy, area = {area:.3g} J, expected is 0 or more: the force has to "
            "lead the motion; reverse the order of the rows if they run back in time"
        )
    closed = [(work, shared) for work, shared, longer in found if shared >= CLOSED * longer]
    return [max(closed, key=lambda loop: loop[1])] if closed else []


def _area(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[float, float, float] | None:
    """Area [J] between two branches that follow each other, the range that they share and that of the longer
    one."""
    (u, F), (v, G) = (one, other) if one[0][-1] > one[0][0] else (other, one)
    low, high = max(u.min(), v.min()), min(u.max(), v.max())
    if not high > low or min(u.size, v.size) < LEAST:
        return None
    grid = np.linspace(low, high, _GRID)
    up, down = (np.interp(grid, *ordered(x, y)) for x, y in ((u, F), (v, G)))
    return float(trapezoid(up - down, grid)), float(high - low), float(max(np.ptp(u), np.ptp(v)))


def ordered(x: Array, y: Array) -> tuple[Array, Array]:
    """Points (n) by rising x."""
    order = np.argsort(x, kind="stable")
    return x[order], y[order]
