"""Friction of the bolted joint on few patches with few sliders: how far from what its normal law says?

python benchmarks/friction_foundation.py

Under constant load the force along one direction is mu [F_N(s_z) - F_N(s_z + K_T/K_N u/mu)] (Jaeger 1995,
Ciavarella 1998), the loop's area follows from it by Masing's rule; F_N is that of all nodes of the contact.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from patch_reduction import pole_deviations
from scipy.optimize import brentq

from jointfmu.joints.bolted_joint import joint as joint_
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import Bolted, preload_pressure
from jointfmu.mechanics import sliders as sliders_
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.parameters import load_default

Array = NDArray[np.float64]

PRELOADS = (2e3, 4.3e3, 9e3, 13e3, 25e3)
"""Of a bolt [N]."""
MOMENTS = (0.0, 1200.0)
"""Of the joint [N.m]."""
FIRST = (1.0, 0.8, 1.25, 0.5, 2.0)
"""Preloads under which the joint first moved over the present ones [1]."""
AMPLITUDES = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 0.999)
"""Force of the loops over the friction [1]."""
SWUNG, SWING, CYCLES = 9e3, 0.3, (1, 2, 20, 100)
"""Preload [N] at which the normal force swings by this part of it, at a shift that stays, and so often."""
COUNTS = ((22, 10, 7), (40, 5, 3), (60, 3, 2))
"""Patches, heights below and above the reference, of as many sliders together; first those of the joint."""
ALONG = 20
"""Displacements up to gross slip at which the force is compared."""


@dataclass(frozen=True, slots=True)
class Theorem:
    """The joint under one preload and moment, by all its nodes.

    share, approach : (n) of the nodes [1], [m]
    """

    spring: BoltedJointSpring
    share: Array
    approach: Array

    @classmethod
    def of(cls, spring: BoltedJointSpring, preload: float, moment: float) -> "Theorem":
        """Tightened."""
        shape = pressure_distribution(spring.joint.pattern)
        return cls(
            spring,
            shape.area_share,
            spring.curve.inverse(preload_pressure(spring.joint, shape, preload, moment)),
        )

    def force(self, along: float) -> float:
        """Per area [Pa], at a displacement [m] from rest."""
        law = self.spring.friction.foundation()
        return float(self.share @ law.virgin_traction(self.approach, along))

    @property
    def gross(self) -> float:
        """Displacement [m] from which on all of it slips."""
        law = self.spring.friction.foundation()
        return float(
            law.friction_coefficient
            * (np.max(self.approach) - self.spring.curve.displacement[0])
            / law.stiffness_ratio
        )

    def displacement(self, part: float) -> float:
        """At which the force is a part of the friction [m]."""
        limit = self.force(self.gross)
        return float(brentq(lambda u: self.force(u) - part * limit, 0.0, self.gross))

    def area(self, size: float) -> float:
        """Loss of a loop of an amplitude [m], per area [J/m2]."""
        return float(self.share @ self.spring.friction.foundation().cycle_energies(self.approach, size)[0])


def deviations(
    spring: BoltedJointSpring, preload: float, moment: float, first: float = 1.0
) -> tuple[float, Array]:
    """Largest deviation of the force over the friction [1], and of the areas (m) of the loops [1].

    first : preload under which the joint first moved over the present one [1]
    """
    theorem, patches = Theorem.of(spring, preload, moment), spring.patches
    approach = spring.curve.inverse(preload_pressure(spring.joint, patches, preload, moment))
    before = spring.curve.inverse(preload_pressure(spring.joint, patches, first * preload, first * moment))
    law = spring.friction.foundation(before)

    def along(*ways: float) -> tuple[float, float]:
        force, loss = law.virgin_forces(approach.size), 0.0
        for way in ways:
            moved = law.advance(force, approach, approach, np.tile([way, 0.0], (approach.size, 1)))
            force, loss = moved.force, float(patches.area_share @ moved.dissipated_energy)
        return float(patches.area_share @ moved.traction[:, 0]), loss

    ways, limit = np.linspace(0.0, theorem.gross, ALONG + 1)[1:], theorem.force(theorem.gross)
    worst = max(abs(along(u)[0] - theorem.force(u)) for u in ways.tolist()) / limit
    sizes = [theorem.displacement(part) for part in AMPLITUDES]
    areas = [2.0 * along(u, -2.0 * u, 2.0 * u)[1] / theorem.area(u) for u in sizes]
    return worst, np.abs(np.array(areas) - 1.0)


def joints() -> Iterator[tuple[str, Bolted]]:
    """The box specimen with both laws."""
    yield "zhao2018", load_default("bolted_joint").values
    yield "roughness", load_default("bolted_joint", "roughness").values


def print_counts() -> None:
    """The same number of sliders on more patches: the first table for each, and turns about poles."""
    shape = pressure_distribution(load_default("bolted_joint").values.pattern)
    print("| patches | sliders each | force | " + " | ".join(f"loop {x:g}" for x in AMPLITUDES), end="")
    print(" | any pole: 95 %, all |\n" + "|---" * (4 + len(AMPLITUDES)) + "|")
    for counts in COUNTS:
        use(*counts)
        spring = BoltedJointSpring.of(load_default("bolted_joint").values)
        found = [deviations(spring, preload, moment) for preload in PRELOADS for moment in MOMENTS]
        cells = [f"{x:.1%}" for x in np.max([a for _, a in found], axis=0)]
        poles = "{:.1%}, {:.1%}".format(*pole_deviations(shape, spring.patches))
        row = [
            str(counts[0]),
            str(spring.friction.foundation().slider_count),
            f"{max(f for f, _ in found):.2%}",
        ]
        print("| " + " | ".join([*row, *cells, poles]) + " |", flush=True)
    use(*COUNTS[0])
    print()


def use(patches: int, below: int, above: int) -> None:
    """Joints from now on have so many patches and heights."""
    joint_.MAX_PATCHES, sliders_.HEIGHTS_BELOW, sliders_.HEIGHTS_ABOVE = patches, below, above
    joint_.friction_patches_of.cache_clear()


def main() -> None:
    """Print the largest deviations over preloads and moments."""
    print("| law | first | force | " + " | ".join(f"loop {x:g}" for x in AMPLITUDES) + " |")
    print("|---" * (3 + len(AMPLITUDES)) + "|")
    for name, joint in joints():
        spring = BoltedJointSpring.of(joint)
        for first in FIRST:
            found = [deviations(spring, preload, moment, first) for preload in PRELOADS for moment in MOMENTS]
            areas = np.max([a for _, a in found], axis=0)
            cells = [f"{max(f for f, _ in found):.2%}", *(f"{a:.1%}" for a in areas)]
            print("| " + " | ".join([name, f"{first:g}", *cells]) + " |", flush=True)
    print(
        f"{spring.patches.area_share.size} patches, {spring.friction.foundation().slider_count} "
        "sliders each\n"
    )
    print_counts()
    print_swings()


def print_swings() -> None:
    """Shear of the default joint at a shift that stays, while the normal force swings: over the first one."""
    spring = BoltedJointSpring.of(load_default("bolted_joint").values)
    share, whole = spring.patches.area_share, spring.friction.foundation()
    start = spring.curve.inverse(preload_pressure(spring.joint, spring.patches, SWUNG, 0.0))

    def load(apart: float) -> float:
        return float(share @ spring.curve.derivatives(start - apart, 0)[0])

    apart = brentq(lambda x: load(x) - (1.0 - SWING) * load(0.0), 0.0, float(np.ptp(start)) + 1e-6)
    low, sliders = start - apart, spring.friction.foundation(start)
    print("| shear over friction | by the theorem | " + " | ".join(f"{n} cycles" for n in CYCLES) + " |")
    print("|---" * (2 + len(CYCLES)) + "|")
    for part in (0.5, 0.7, 0.9):
        limit = spring.joint.mu * load(0.0)
        shift = brentq(lambda u, most=part * limit: share @ whole.virgin_traction(start, u) - most, 0.0, 1e-5)
        exact = share @ whole.virgin_traction(low, shift) / (share @ whole.virgin_traction(start, shift))
        along = np.outer(np.ones(share.size), [shift, 0.0])
        moved = sliders.advance(sliders.virgin_forces(share.size), start, start, along)
        first, found, lowest = share @ moved.traction[:, 0], [], start
        for cycle in range(1, CYCLES[-1] + 1):
            for before, after in ((start, low), (low, start)):
                lowest = np.minimum(lowest, before)
                moved = spring.friction.foundation(start, lowest).advance(
                    moved.force, before, after, 0.0 * along
                )
            if cycle in CYCLES:
                found.append(share @ moved.traction[:, 0] / first)
        print(f"| {part:g} | {exact:.4f} | " + " | ".join(f"{x:.4f}" for x in found) + " |", flush=True)


if __name__ == "__main__":
    main()
