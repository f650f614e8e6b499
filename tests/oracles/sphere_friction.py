"""Friction of Mindlin's sphere: closed forms, and a foundation of many independent springs.

The units are such that the load of the sphere is the approach to the power 1.5. Each spring touches at one
approach and has one friction limit. The module also makes the package's sliders of the sphere, and moves
them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.sliders import Foundation

Array = NDArray[np.float64]

FRICTION, RATIO = 0.3, 0.8
FIRST, NODES = 1e-5, 600
"""First approach [m] of the tabulated load, and number of nodes."""
RANGE = (1e-4, (3e-2, 0.5))
"""Smallest load, and range of working loads, of the slider heights over the largest load [1]."""
SPRING_COUNT, STEPS_PER_CYCLE = 20_000, 400
"""Number of springs, and steps of a cycle of a combined motion."""


def load(approach: ArrayLike) -> Array:
    """Load [N] of the sphere at an approach [m]."""
    return np.asarray(np.maximum(approach, 0.0) ** 1.5)


def stiffness(approach: ArrayLike) -> Array:
    """Normal stiffness of the sphere [N/m]: derivative of the load with respect to the approach."""
    return np.asarray(1.5 * np.sqrt(np.maximum(approach, 0.0)))


def sphere() -> Curve:
    """Tabulated load of the sphere over the approach."""
    x = np.concatenate([[0.0], np.geomspace(FIRST, 1.0, NODES)])
    bend = 0.75 / np.sqrt(x[1:])
    return Curve(x, load(x), stiffness(x), np.concatenate([2.0 * bend[:1], bend[:-1]]), bend)


def load_levels(lowest: float, working: tuple[float, float], step: float) -> Array:
    """Loads at the slider heights over the load at the end of a curve, from 0 to 1 [1].

    Neighbours differ by the factor exp(step) in the range of working loads, by exp(2 step) between it and
    `lowest` and between it and the end.
    """
    ends = np.log([lowest, *working, 1.0])
    parts = [np.zeros(1)]
    for low, high, by in zip(ends[:-1], ends[1:], (2.0 * step, step, 2.0 * step), strict=True):
        count = int(np.ceil((high - low) / by))
        parts.append(np.exp(np.linspace(low, high, count + 1)[:-1]))
    return np.concatenate([*parts, np.ones(1)])


def sliders_at_levels(curve: Curve, ratio: float, friction: float, level: ArrayLike) -> Foundation:
    """Sliders of a curve with heights at the loads `level` over the load at its end."""
    return Foundation(curve, ratio, friction, curve.inverse(np.asarray(level) * curve.end_point[1]))


def foundation(step: float) -> Foundation:
    """Sliders of the sphere."""
    return sliders_at_levels(sphere(), RATIO, FRICTION, load_levels(*RANGE, step))


def backbone(approach: float, along: ArrayLike) -> Array:
    """Shear force [N] at a displacement [m] from rest under constant load (Cattaneo 1938, Mindlin 1949)."""
    return FRICTION * (load(approach) - load(approach - RATIO * np.asarray(along) / FRICTION))


def displacement(approach: float, part: ArrayLike) -> Array:
    """Displacement [m] at which the force is a fraction `part` [1] of the friction limit."""
    return np.asarray(FRICTION * approach / RATIO * (1.0 - (1.0 - np.asarray(part)) ** (2.0 / 3.0)))


def loop_area(approach: float, part: ArrayLike) -> Array:
    """Loss [J] of a loop with a fraction `part` [1] of the friction limit as amplitude (Mindlin, Deresiewicz
    1953)."""
    x = np.asarray(part)
    bracket = 1.0 - (1.0 - x) ** (5.0 / 3.0) - 5.0 / 6.0 * x * (1.0 + (1.0 - x) ** (2.0 / 3.0))
    return np.asarray(4.8 * FRICTION**2 * load(approach) * approach / RATIO * bracket)


@dataclass(slots=True)
class Springs:
    """Foundation of many springs of the sphere that come into contact one after the other.

    height, normal : (n) [m], [N/m] approach at which a spring touches, its normal stiffness
    force          : (2, n) [N] tangential forces
    work           : [J] of the tangential forces
    """

    height: Array
    normal: Array
    force: Array = field(init=False)
    work: float = 0.0

    def __post_init__(self) -> None:
        self.force = np.zeros((2, self.height.size))

    @classmethod
    def of(cls, count: int) -> "Springs":
        """Foundation of `count` springs, dense near first contact."""
        edge = np.linspace(0.0, 1.0, count + 1) ** 2
        return cls(0.5 * (edge[1:] + edge[:-1]), np.diff(stiffness(edge)))

    @property
    def traction(self) -> Array:
        """Tangential force (2) [N]."""
        return np.asarray(np.sum(self.force, axis=1))

    @property
    def loss(self) -> float:
        """Dissipated energy [J]: work that is not stored."""
        return self.work - float(np.sum(self.force**2 / (2.0 * RATIO * self.normal)))

    def move(self, before: float, after: float, shift: Sequence[float]) -> None:
        """Move along a short straight path: new approach [m], tangential increment (2) [m]."""
        old, now = before > self.height, after > self.height
        part = np.where(
            old, 1.0, np.divide(after - self.height, after - before, where=now & ~old, out=0.0 * self.normal)
        )
        trial = np.where(now, self.force + RATIO * self.normal * part * np.asarray(shift)[:, None], 0.0)
        limit = FRICTION * self.normal * np.maximum(after - self.height, 0.0)
        size = np.hypot(*trial)
        force = trial * np.divide(limit, size, where=size > limit, out=np.ones_like(size))
        self.work += float(np.sum(0.5 * (self.force + force) * np.asarray(shift)[:, None]))
        self.force = force


def follow_path(
    sliders: Foundation, path: Array, steps: int = 1, force: Array | None = None
) -> tuple[Array, Array, Array]:
    """Move sliders along a path (m + 1, 3) of approach and displacements [m], in `steps` steps per part.

    Returns tractions (m, 2) [N], losses (m) [J] and the sliders' forces at the end.
    """
    now = sliders.virgin_forces() if force is None else force
    tractions, losses = [], []
    for start, end in pairwise(path):
        loss = 0.0
        for a, b in pairwise(np.linspace(start, end, steps + 1)):
            moved = sliders.advance(now, a[0], b[0], b[1:] - a[1:])
            now, loss = moved.force, loss + float(moved.dissipated_energy)
        tractions.append(moved.traction)
        losses.append(loss)
    return np.array(tractions), np.array(losses), now


def combined_motion(phase: float, mean: float, swing: float, along: float, cycles: int = 2) -> Array:
    """Path (m, 3) [m]: oscillating approach, and tangential displacement with a phase lag [rad]."""
    angle = np.linspace(0.0, 2.0 * np.pi * cycles, cycles * STEPS_PER_CYCLE + 1)
    x = along * FRICTION * mean / RATIO * np.sin(angle + phase)
    return np.column_stack([mean + swing * np.sin(angle), x - x[0], np.zeros_like(x)])


def follow_springs(path: Array) -> tuple[Array, float]:
    """Move many springs along a path (m + 1, 3) [m]; returns forces (m, 2) [N] and the loss [J]."""
    springs, forces = Springs.of(SPRING_COUNT), []
    springs.move(0.0, path[0, 0], (0.0, 0.0))
    for a, b in pairwise(path):
        springs.move(a[0], b[0], b[1:] - a[1:])
        forces.append(springs.traction)
    return np.array(forces), springs.loss


MOTIONS = {
    "in phase": combined_motion(0.0, 0.3, 0.15, 0.8),
    "a quarter behind": combined_motion(0.5 * np.pi, 0.3, 0.15, 0.8),
    "hardly slipping": combined_motion(0.0, 0.3, 0.15, 0.3),
    "lifting off": combined_motion(0.25 * np.pi, 0.1, 0.15, 1.0),
}
