"""Friction with memory by few sliders: how many heights do backbone, loops and combined motions need?

python benchmarks/friction_sliders.py

The contact is Mindlin's sphere in units in which its load is the approach to the power 1.5. What is exact is
either a closed form or a foundation of many springs, each with one touch and one friction limit.
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
"""First approach [m] of the table and its nodes."""
RANGE = (1e-4, (3e-2, 0.5))
"""Least and working loads of the heights over the largest load [1]."""
STEPS = (0.8, 0.4, 0.2, 0.1, 0.05)
"""Steps of the heights in the logarithm of the load."""
APPROACH = 0.4
"""Approach [m] of the loops under constant load."""
AMPLITUDES = (0.1, 0.2, 0.5, 0.9)
"""Force of the loops over the friction [1]."""
TURNS, CIRCLE, TURN_STEPS = 3, 1.5, (6, 12, 24, 48, 96, 4096)
"""Turns of a circle, its radius over gross slip, and steps of each; the last are taken as exact."""
SPRINGS, ALONG = 20_000, 400
"""Springs, and steps of a round of a combined motion."""


def load(approach: ArrayLike) -> Array:
    """Load [N] of the sphere at an approach [m]."""
    return np.asarray(np.maximum(approach, 0.0) ** 1.5)


def stiffness(approach: ArrayLike) -> Array:
    """Derivative of the load [N/m]."""
    return np.asarray(1.5 * np.sqrt(np.maximum(approach, 0.0)))


def sphere() -> Curve:
    """The table of the load."""
    x = np.concatenate([[0.0], np.geomspace(FIRST, 1.0, NODES)])
    bend = 0.75 / np.sqrt(x[1:])
    return Curve(x, load(x), stiffness(x), np.concatenate([2.0 * bend[:1], bend[:-1]]), bend)


def levels(lowest: float, working: tuple[float, float], step: float) -> Array:
    """Loads of heights over the load at the end of a curve, from 0 to 1 [1].

    Neighbours differ by the factor exp(step) in the range of working loads, by exp(2 step) between it and
    `lowest` and between it and the end.
    """
    ends = np.log([lowest, *working, 1.0])
    parts = [np.zeros(1)]
    for low, high, by in zip(ends[:-1], ends[1:], (2.0 * step, step, 2.0 * step), strict=True):
        count = int(np.ceil((high - low) / by))
        parts.append(np.exp(np.linspace(low, high, count + 1)[:-1]))
    return np.concatenate([*parts, np.ones(1)])


def at_levels(curve: Curve, ratio: float, friction: float, level: ArrayLike) -> Foundation:
    """Sliders of a curve; `level` are the loads of the heights over the one at its end."""
    return Foundation(curve, ratio, friction, curve.inverse(np.asarray(level) * curve.end[1]))


def foundation(step: float) -> Foundation:
    """Sliders of the sphere."""
    return at_levels(sphere(), RATIO, FRICTION, levels(*RANGE, step))


def backbone(approach: float, along: ArrayLike) -> Array:
    """Force [N] at a displacement [m] from rest under constant load (Cattaneo 1938, Mindlin 1949)."""
    return FRICTION * (load(approach) - load(approach - RATIO * np.asarray(along) / FRICTION))


def displacement(approach: float, part: ArrayLike) -> Array:
    """Displacement [m] at which the force is a part [1] of the friction: the backbone's inverse."""
    return np.asarray(FRICTION * approach / RATIO * (1.0 - (1.0 - np.asarray(part)) ** (2.0 / 3.0)))


def loop_area(approach: float, part: ArrayLike) -> Array:
    """Loss [J] of a loop between +- a part [1] of the friction (Mindlin and Deresiewicz 1953)."""
    x = np.asarray(part)
    bracket = 1.0 - (1.0 - x) ** (5.0 / 3.0) - 5.0 / 6.0 * x * (1.0 + (1.0 - x) ** (2.0 / 3.0))
    return np.asarray(4.8 * FRICTION**2 * load(approach) * approach / RATIO * bracket)


@dataclass(slots=True)
class Springs:
    """A foundation of many springs of the sphere, which touch one after the other.

    height, normal : (n) [m], [N/m] where a spring touches, its normal stiffness
    force          : (2, n) [N] along the surface
    work           : [J] put in along the surface
    """

    height: Array
    normal: Array
    force: Array = field(init=False)
    work: float = 0.0

    def __post_init__(self) -> None:
        self.force = np.zeros((2, self.height.size))

    @classmethod
    def of(cls, count: int) -> "Springs":
        """Springs that are dense where the sphere touches first."""
        edge = np.linspace(0.0, 1.0, count + 1) ** 2
        return cls(0.5 * (edge[1:] + edge[:-1]), np.diff(stiffness(edge)))

    @property
    def traction(self) -> Array:
        """Force (2) [N]."""
        return np.asarray(np.sum(self.force, axis=1))

    @property
    def loss(self) -> float:
        """Work [J] that is not stored."""
        return self.work - float(np.sum(self.force**2 / (2.0 * RATIO * self.normal)))

    def move(self, before: float, after: float, shift: Sequence[float]) -> None:
        """Along a short straight path."""
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


def walk(
    sliders: Foundation, path: Array, steps: int = 1, force: Array | None = None
) -> tuple[Array, Array, Array]:
    """Forces (m, 2) [N] and losses (m) [J] on the way along a path (m + 1, 3) of approach and displacements
    [m] in `steps` steps per part, and the sliders' forces at its end."""
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


def combined(phase: float, mean: float, swing: float, along: float, rounds: int = 2) -> Array:
    """Path (m, 3) [m] of an approach that swings about its mean, and a displacement with a phase [rad]."""
    angle = np.linspace(0.0, 2.0 * np.pi * rounds, rounds * ALONG + 1)
    x = along * FRICTION * mean / RATIO * np.sin(angle + phase)
    return np.column_stack([mean + swing * np.sin(angle), x - x[0], np.zeros_like(x)])


def of_springs(path: Array) -> tuple[Array, float]:
    """Forces (m, 2) [N] on the way along a path (m + 1, 3) and the loss [J] of many springs."""
    springs, forces = Springs.of(SPRINGS), []
    springs.move(0.0, path[0, 0], (0.0, 0.0))
    for a, b in pairwise(path):
        springs.move(a[0], b[0], b[1:] - a[1:])
        forces.append(springs.traction)
    return np.array(forces), springs.loss


MOTIONS = {
    "in phase": combined(0.0, 0.3, 0.15, 0.8),
    "a quarter behind": combined(0.5 * np.pi, 0.3, 0.15, 0.8),
    "hardly slipping": combined(0.0, 0.3, 0.15, 0.3),
    "lifting off": combined(0.25 * np.pi, 0.1, 0.15, 1.0),
}


def main() -> None:
    """Print the tables."""
    for table in (print_loops, print_motions, print_turns):
        table()
        print()


def print_loops() -> None:
    """Deviation of the backbone over the friction, and of loops' areas."""
    friction = FRICTION * float(load(APPROACH))
    print("| sliders | backbone | " + " | ".join(f"loop {part:g}" for part in AMPLITUDES) + " |")
    print("|---" * (2 + len(AMPLITUDES)) + "|")
    way = np.linspace(0.0, 1.2 * FRICTION * APPROACH / RATIO, 121)
    for step in STEPS:
        sliders = foundation(step)
        straight = np.column_stack([np.full_like(way, APPROACH), way, 0.0 * way])
        found = walk(sliders, straight)[0][:, 0]
        worst = np.max(np.abs(found - backbone(APPROACH, way[1:]))) / friction
        areas = []
        for part in AMPLITUDES:
            u = float(displacement(APPROACH, part))
            path = np.array([[APPROACH, x, 0.0] for x in (0.0, u, -u, u)])
            areas.append(np.sum(walk(sliders, path)[1][1:]) / loop_area(APPROACH, part) - 1.0)
        print(f"| {sliders.slider_count} | {worst:.1e} | " + " | ".join(f"{a:+.1%}" for a in areas) + " |")


def print_motions() -> None:
    """Deviations of combined motions: force over the largest friction, loss."""
    print("| sliders | " + " | ".join(f"{name}: force | loss" for name in MOTIONS) + " |")
    print("|---" * (1 + 2 * len(MOTIONS)) + "|")
    exact = {name: of_springs(path) for name, path in MOTIONS.items()}
    for step in STEPS:
        sliders, cells = foundation(step), []
        for name, path in MOTIONS.items():
            tractions, losses, _ = walk(sliders, path)
            largest = FRICTION * float(load(np.max(path[:, 0])))
            worst = np.max(np.abs(tractions - exact[name][0])) / largest
            cells.append(f"{worst:.1e} | {np.sum(losses) / exact[name][1] - 1.0:+.1%}")
        print(f"| {sliders.slider_count} | " + " | ".join(cells) + " |")


def print_turns() -> None:
    """Circles of 1.5 times gross slip, once it is steady: loss of a turn, force over the friction."""
    print("| steps a turn | loss | force |\n|---|---|---|")
    sliders, gross = foundation(0.2), FRICTION * APPROACH / RATIO

    def around(steps: int) -> tuple[Array, float]:
        angle = np.linspace(0.0, 2.0 * np.pi * TURNS, TURNS * steps + 1)
        x, y = CIRCLE * gross * np.array([np.cos(angle) - 1.0, np.sin(angle)])
        tractions, losses, _ = walk(sliders, np.column_stack([np.full_like(x, APPROACH), x, y]))
        return tractions[-1], float(np.sum(losses[-steps:]))

    force, loss = around(TURN_STEPS[-1])
    for steps in TURN_STEPS[:-1]:
        found, lost = around(steps)
        off = np.hypot(*(found - force)) / (FRICTION * load(APPROACH))
        print(f"| {steps} | {lost / loss - 1.0:+.2%} | {off:.1e} |")


if __name__ == "__main__":
    main()
