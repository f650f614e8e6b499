"""Few patches for all nodes of a bolted contact: how far are force, stiffness and friction from those of all?

python benchmarks/patch_reduction.py
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from friction_sliders import at_levels, levels
from numpy.typing import NDArray
from scipy.stats import qmc

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.kinematics import tangential_displacement
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import FrictionPatches, NodalField, PressureDistribution
from jointfmu.mechanics.footprint.patch_reduction import reduce_patches
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.mechanics.footprint.point_reduction import reduce_points
from jointfmu.mechanics.jenkins import SliderUpdate
from jointfmu.mechanics.sliders import FOUNDATION_SLIDERS, sum_slider_forces, torsion_directions
from jointfmu.parameters import load_default

Array = NDArray[np.float64]

COUNTS = (48, 120, 160)
PRELOAD = 9e3
"""Of a bolt of the default joint [N]."""
ROUND = 400
"""Nodes of the field."""
SEED = 3
PATCHES = (16, 22)
FINE = levels(1e-6, (1e-5, 2e-2), 0.12)
"""Loads of the heights for all nodes over the hardness [1]."""
WAYS = 1.5 * np.linspace(0.0, 1.0, 25)[1:] ** 2
AMPLITUDES = (0.15, 0.3, 0.6, 1.2)
"""Ways over that of gross slip under the largest pressure [1]: 0.6 to 1 of the friction."""


@dataclass(frozen=True, slots=True)
class Range:
    """States of a joint: the largest of each.

    moment : factor of tilt in the shape [1]
    apart  : least and largest normal motion over the largest approach [1]
    tilt   : motion of the edge by each rotation over the largest approach [1]
    """

    moment: float
    apart: tuple[float, float] = (-0.05, 0.05)
    tilt: float = 0.0


@dataclass(frozen=True, slots=True)
class Motion:
    """Along y and about the normal; factor of tilt in the shape [1], and motion by a tilt at the radius of
    gyration over the largest approach [1]. The turn is the part of it at the radius of gyration [1]."""

    turn: float = 0.0
    moment: float = 0.0
    tilt: float = 0.0


MOTIONS = {
    "along": Motion(),
    "along, moment": Motion(moment=0.3),
    "along, tilt 0.1": Motion(tilt=0.1),
    "turning": Motion(turn=1.0),
    "turning, tilt 0.1": Motion(turn=1.0, tilt=0.1),
    "turning, tilt 0.1 back": Motion(turn=1.0, tilt=-0.1),
    "both, tilt 0.1": Motion(turn=0.8, tilt=0.1),
}
"""Columns of the table of the friction."""
PLATES = 12
"""Random plates."""
POLES = 400
"""Turns in gross slip about poles at random nodes of the contact, and beside them."""
MANY = {"22 nodes": (22, reduce_points), "22": (22, reduce_patches), "40": (40, reduce_patches)}
MANY |= {"60": (60, reduce_patches), "120 nodes": (120, reduce_points)}
"""Patches of the last table, fitted or some of the nodes."""


def ranges(moment: float) -> dict[str, Range]:
    """What the table has columns for; at `moment` the first nodes that touch open."""
    return {
        "no tilt": Range(0.9 * moment),
        "tilt 0.1": Range(0.9 * moment, tilt=0.1),
        "tilt 0.2": Range(0.9 * moment, tilt=0.2),
        "opening": Range(1.2 * moment, (0.0, 0.4), 0.4),
    }


def opening_moment(shape: PressureDistribution) -> float:
    """Factor of tilt [1] at which the first node that touches opens."""
    touches = (shape.preload_shape > 0.0) & (shape.moment_shape != 0.0)
    return float(np.min(shape.preload_shape[touches] / np.abs(shape.moment_shape[touches])))


def deviation(
    curve: Curve,
    mean: float,
    shape: PressureDistribution,
    points: PressureDistribution,
    states: Range,
    count: int = 64,
) -> tuple[float, float]:
    """Largest deviations [1] of forces and moments, and of stiffnesses, of points from those of a shape.

    The sums of share times p, p x, p y and k, k x, k y, k x^2, k x y, k y^2, each over the sum of its sizes
    now or at tightening, whichever is larger, at `count` random states with 0.5 to 1.5 times the mean
    pressure [Pa].
    """
    worst, reach = np.zeros(9), np.max(np.abs(shape.position), axis=0)
    low = [0.5, -states.moment, states.apart[0], -states.tilt, -states.tilt]
    high = [1.5, states.moment, states.apart[1], states.tilt, states.tilt]
    unit = qmc.Sobol(5, rng=SEED).random(count)
    for preload, moment, *motion in low + unit * (np.array(high) - low):
        load = preload * mean, moment
        start = tightened(curve, shape, load)
        scale = (np.max(start) - curve.displacement[0]) * np.array(motion) / [1.0, reach[1], reach[0]]
        there, size = sums(curve, shape, start, scale, reach)
        few, _ = sums(curve, points, tightened(curve, points, load), scale, reach)
        worst = np.maximum(worst, np.abs(few - there) / size)
    return float(np.max(worst[:3])), float(np.max(worst[3:]))


def tightened(curve: Curve, shape: PressureDistribution, load: tuple[float, float]) -> Array:
    """Approaches (n) [m] under a mean pressure [Pa] and a factor of tilt [1]."""
    return curve.inverse(load[0] * np.maximum(shape.preload_shape + load[1] * shape.moment_shape, 0.0))


def sums(
    curve: Curve, shape: PressureDistribution, start: Array, motion: Array, reach: Array
) -> tuple[Array, Array]:
    """The nine sums and their sizes, of nodes that begin at approaches (n) [m] and move by normal motion [m]
    and rotations [rad] about x and y."""
    x, y = shape.position.T
    now = curve.derivatives(start - (motion[0] + motion[1] * y - motion[2] * x))
    x, y = x / reach[0], y / reach[1]
    factors = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
    values = [np.concatenate([p * factors[:3], k * factors]) for p, k in (now, curve.derivatives(start))]
    sizes = [np.abs(each) @ shape.area_share for each in values]
    return values[0] @ shape.area_share, np.maximum(*sizes)


def field() -> PressureDistribution:
    """A nodal field without symmetry: one half of a plate that touches around three bolts."""
    unit = qmc.Sobol(2, rng=SEED).random(512)[:ROUND] - 0.5
    x, y = 0.2 * unit[:, 0], 0.1 * unit[:, 1]
    bolts = ((-0.06, 0.02), (0.01, -0.025), (0.07, 0.015))
    near = [np.exp(-((x - a) ** 2 + (y - b) ** 2) / 0.03**2) for a, b in bolts]
    share = np.full(ROUND, 1.0 / ROUND)
    x, y = x - share @ x, y - share @ y
    equal = sum(near) / np.mean(sum(near))
    tilt = near[0] - near[1] + near[2]
    tilt = tilt - np.mean(tilt)
    rows = (tuple(values.tolist()) for values in (share, x, y, equal, tilt))
    return NodalField(
        **dict(zip(("share", "x", "y", "equal", "tilt"), rows, strict=True))
    ).pressure_distribution()


def plate(
    *bolts: tuple[float, float], size: tuple[float, float], hole: float, cone: float
) -> PressureDistribution:
    """Of a plate with bolts [m]."""
    x, y = zip(*bolts, strict=True)
    return BoltedPlate(
        length=size[0], width=size[1], x=x, y=y, hole_diameter=hole, cone_diameter=cone
    ).pressure_distribution()


def contacts() -> Iterator[tuple[str, PressureDistribution]]:
    """Contacts of the table."""
    yield "frame, 8 bolts", pressure_distribution(load_default("bolted_joint").values.pattern)
    four = ((-0.1, 0.02), (0.0, -0.03), (0.1, 0.02), (0.1, -0.02))
    yield "plate, 4 bolts", plate(*four, size=(0.3, 0.1), hole=0.011, cone=0.03)
    square = ((-0.08, -0.03), (0.08, -0.03), (0.08, 0.03), (-0.08, 0.03))
    yield "plate, 4 x M12", plate(*square, size=(0.2, 0.1), hole=0.0135, cone=0.05)
    three = ((-0.03, 0.0), (0.0, 0.0), (0.03, 0.0))
    yield "plate, a row", plate(*three, size=(0.12, 0.025), hole=0.0085, cone=0.02)
    yield "field", field()
    yield "annulus", annulus()


def annulus(around: int = 96, across: int = 8) -> PressureDistribution:
    """A field of nodes of equal area on a ring, whose pressure falls from the inner to the outer edge."""
    inner, outer = 0.02, 0.05
    edge = np.linspace(inner**2, outer**2, 2 * across + 1)[1::2]
    radius, angle = np.meshgrid(np.sqrt(edge), 2.0 * np.pi * np.arange(around) / around)
    x, y = (radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel()
    share = np.full(x.size, 1.0 / x.size)
    equal = 1.0 - 0.7 * (radius.ravel() - inner) / (outer - inner)
    equal /= share @ equal
    return PressureDistribution(
        share, np.column_stack([x, y]), equal, equal * y / (share @ (equal * y * y)) * outer
    )


def random_plate(seed: int) -> PressureDistribution:
    """With three to eight bolts anywhere."""
    rng = np.random.default_rng(seed)
    hole = rng.uniform(0.006, 0.02)
    cone = hole * rng.uniform(1.8, 3.0)
    length = cone * rng.uniform(3.0, 9.0)
    size = length * np.array([1.0, rng.uniform(0.3, 1.0)])
    bolts: list[Array] = []
    count, tries = int(rng.integers(3, 9)), iter(rng.uniform(-0.5, 0.5, (20000, 2)))
    while len(bolts) < count and (place := next(tries, None)) is not None:
        bolt = place * (size - 1.6 * hole)
        if all(np.hypot(*(bolt - other)) > 1.5 * hole for other in bolts):
            bolts.append(bolt)
    return plate(*((float(x), float(y)) for x, y in bolts), size=(size[0], size[1]), hole=hole, cone=cone)


def sheared() -> Iterator[tuple[str, list[PressureDistribution]]]:
    """Contacts of the table of the friction; of several the largest deviations are printed."""
    yield from ((name, [shape]) for name, shape in contacts())
    yield f"{PLATES} random plates", [random_plate(seed) for seed in range(PLATES)]


def friction(
    spring: BoltedJointSpring, shape: PressureDistribution, fine: bool, largest: float, motion: Motion
) -> tuple[Array, Array]:
    """Force or moment on 1 m2 [N], [N.m] from rest to the WAYS, and losses [J] of loops of the AMPLITUDES.

    The joint's sliders, or fine ones, stand on a shape under the preload; `largest` [m] is the largest
    approach, over which the ways and the tilt are.
    """
    ratio = float(spring.joint.shear_stiffness_ratio())
    patches = shape if isinstance(shape, FrictionPatches) else shape.as_patches()
    gyration = np.sqrt(
        shape.area_share @ np.sum(shape.position**2, axis=1) + shape.area_share @ patches.radius**2
    )
    start = tightened(spring.curve, shape, (mean_pressure(spring), motion.moment))
    approach = start - motion.tilt * largest * shape.position[:, 0] / gyration
    q = np.array([0.0, np.sqrt(1.0 - motion.turn**2), 0.0, 0.0, 0.0, motion.turn / gyration])
    along = tangential_displacement(patches, q)
    sliders = spring.on_nodes(shape).friction.foundation(start)
    if fine:
        sliders = at_levels(spring.curve, ratio, spring.joint.mu, FINE)
    gross = spring.joint.mu / ratio * largest * along

    def moved(force: Array, way: float) -> SliderUpdate:
        return sliders.advance(force, approach, approach, way * gross)

    rest, losses = sliders.virgin_forces(approach.size), []
    forces = [
        shape.area_share @ np.sum(sum_slider_forces(moved(rest, way).force) * along, axis=1) for way in WAYS
    ]
    for size in AMPLITUDES:
        back = moved(moved(rest, size).force, -2.0 * size)
        losses.append(
            shape.area_share @ (back.dissipated_energy + moved(back.force, 2.0 * size).dissipated_energy)
        )
    return np.array(forces), np.array(losses)


def poles_inside(shape: PressureDistribution, count: int) -> Array:
    """Places (count, 2) [m] at random nodes of a contact, and beside them."""
    rng = np.random.default_rng(1)
    poles = shape.position[rng.choice(shape.area_share.size, count, p=shape.area_share)]
    return poles + 0.5 * np.sqrt(
        np.prod(np.ptp(shape.position, axis=0)) / shape.area_share.size
    ) * rng.uniform(-1.0, 1.0, poles.shape)


def gross_slip(points: FrictionPatches, friction: Array, poles: Array) -> Array:
    """Forces (p, 2) along turns about poles (p, 2) [m] of points with a friction (n)."""
    x, y = torsion_directions(FOUNDATION_SLIDERS if np.any(points.radius) else 2)
    places = points.position + points.radius[:, None] * np.column_stack([y, -x])[:, None]
    arm = places - poles[:, None, None]
    way = np.stack([-arm[..., 1], arm[..., 0]], axis=-1) / np.linalg.norm(arm, axis=-1)[..., None]
    return np.asarray(np.einsum("n,pkni->pi", friction, way)) / len(x)


def pole_deviations(shape: PressureDistribution, patches: FrictionPatches) -> Array:
    """(2) deviation of the force over the friction [1] in gross slip about POLES poles inside the contact: of
    95 %, largest."""
    poles = poles_inside(shape, POLES)
    both = (
        gross_slip(points, points.area_share * points.preload_shape, poles)
        for points in (shape.as_patches(), patches)
    )
    off = np.linalg.norm(np.subtract(*both), axis=1)
    return np.quantile(off, [0.95, 1.0])


def print_poles() -> None:
    """Deviation of the force in gross slip about any pole over the number of patches, also of patches that
    were points: of 95 %, largest."""
    print("| contact | patches | | points |\n|---|---|---|---|")
    for name, shape in contacts():
        for label, (count, reduced) in MANY.items():
            patches = reduced(shape, count)
            points = patches.as_patches()
            both = (patches if isinstance(patches, FrictionPatches) else points), points
            cells = ["{:.1%}, {:.1%}".format(*pole_deviations(shape, each)) for each in both]
            print(f"| {name} | {label} | " + " | ".join(cells) + " |", flush=True)


def mean_pressure(spring: BoltedJointSpring) -> float:
    """Of the tightened joint [Pa]."""
    return float(PRELOAD * spring.joint.n_bolts / spring.joint.A_0)


def print_normal(spring: BoltedJointSpring) -> None:
    """Deviation of forces and of stiffnesses from those of all nodes."""
    names = list(ranges(1.0))
    print("| contact | nodes | points | s | " + " | ".join(names) + " |\n" + "|---" * (4 + len(names)) + "|")
    for name, shape in contacts():
        for count in COUNTS:
            start = time.perf_counter()
            points = reduce_points(shape, count)
            took = time.perf_counter() - start
            cells = [
                "{:.0e}, {:.0e}".format(
                    *deviation(spring.curve, mean_pressure(spring), shape, points, states)
                )
                for states in ranges(opening_moment(shape)).values()
            ]
            row = [name, str(shape.area_share.size), str(points.area_share.size), f"{took:.1f}", *cells]
            print("| " + " | ".join(row) + " |", flush=True)


def print_friction(spring: BoltedJointSpring) -> None:
    """Deviation of friction, over gross slip, and of loops from all nodes with fine heights."""
    heads = ["contact", "patches", *MOTIONS, "any pole: 95 %, all"]
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    for name, shapes in sheared():
        found = [friction_deviations(spring, shape) for shape in shapes]
        for count, worst in zip(PATCHES, np.max(found, axis=0), strict=True):
            poles = [pole_deviations(shape, reduce_patches(shape, count)) for shape in shapes]
            cells = [f"{force:.1e}, {area:.1%}" for force, area in worst]
            cells.append("{:.1%}, {:.1%}".format(*np.max(poles, axis=0)))
            print(f"| {name} | {count} | " + " | ".join(cells) + " |", flush=True)


def friction_deviations(spring: BoltedJointSpring, shape: PressureDistribution) -> Array:
    """Largest deviations (counts, motions, 2) [1] of force over gross slip, and of areas of loops."""
    largest = float(np.max(tightened(spring.curve, shape, (mean_pressure(spring), 0.0))))
    largest -= float(spring.curve.displacement[0])
    exact = [friction(spring, shape, True, largest, motion) for motion in MOTIONS.values()]
    found = []
    for count in PATCHES:
        patches = reduce_patches(shape, count)
        for (force, loss), motion in zip(exact, MOTIONS.values(), strict=True):
            few, lost = friction(spring, patches, False, largest, motion)
            worst = np.max(np.abs(few - force)) / np.max(np.abs(force))
            found.append((worst, np.max(np.abs(lost / loss - 1.0))))
    return np.reshape(found, (len(PATCHES), len(MOTIONS), 2))


def main() -> None:
    """Print the tables."""
    spring = BoltedJointSpring.of(load_default("bolted_joint").values)
    print_normal(spring)
    print()
    print_friction(spring)
    print()
    print_poles()


if __name__ == "__main__":
    main()
