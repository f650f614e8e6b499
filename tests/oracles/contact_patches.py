"""Force, stiffness and friction of a bolted contact: all nodes against few points or patches."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.kinematics import tangential_displacement
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import FrictionPatches, NodalField, PressureDistribution
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.mechanics.jenkins import SliderUpdate
from jointfmu.mechanics.sliders import FOUNDATION_SLIDER_COUNT, sum_slider_forces, torsion_directions
from jointfmu.parameters import load_default

from .sphere_friction import load_levels, sliders_at_levels

Array = NDArray[np.float64]

PRELOAD = 9e3
"""Preload of a bolt of the default joint [N]."""
FIELD_NODES = 400
"""Number of nodes of the nodal field."""
SEED = 3
FINE = load_levels(1e-6, (1e-5, 2e-2), 0.12)
"""Loads at the slider heights of the fine reference on all nodes, over the hardness [1]."""
DISPLACEMENTS = 1.5 * np.linspace(0.0, 1.0, 25)[1:] ** 2
AMPLITUDES = (0.15, 0.3, 0.6, 1.2)
"""Amplitudes of loops over the displacement of gross slip under the largest pressure [1]: the friction force
is 0.6 to 1 times its limit."""


@dataclass(frozen=True, slots=True)
class StateRange:
    """Range of random states of a joint.

    moment  : largest factor of the moment shape of the pressure [1]
    opening : smallest and largest normal motion over the largest approach [1]
    tilt    : largest motion of the edge by each rotation over the largest approach [1]
    """

    moment: float
    opening: tuple[float, float] = (-0.05, 0.05)
    tilt: float = 0.0


@dataclass(frozen=True, slots=True)
class Motion:
    """Tangential motion along y and about the normal, with a moment and a tilt.

    turn   : share of the rotation about the normal, at the radius of gyration [1]
    moment : factor of the moment shape of the pressure [1]
    tilt   : normal motion by a tilt at the radius of gyration, over the largest approach [1]
    """

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
"""Motions for which friction is compared."""
POLE_COUNT = 400
"""Number of poles of rotations in gross slip, at random places near nodes of the contact."""


def ranges(moment: float) -> dict[str, StateRange]:
    """Ranges of states; `moment` is the moment at which the first node in contact opens."""
    return {
        "no tilt": StateRange(0.9 * moment),
        "tilt 0.1": StateRange(0.9 * moment, tilt=0.1),
        "tilt 0.2": StateRange(0.9 * moment, tilt=0.2),
        "opening": StateRange(1.2 * moment, (0.0, 0.4), 0.4),
    }


def opening_moment(shape: PressureDistribution) -> float:
    """Factor of the moment shape [1] at which the first node in contact opens."""
    touches = (shape.preload_pressure_ratio > 0.0) & (shape.moment_pressure_ratio != 0.0)
    return float(np.min(shape.preload_pressure_ratio[touches] / np.abs(shape.moment_pressure_ratio[touches])))


def deviation(
    curve: Curve,
    mean: float,
    shape: PressureDistribution,
    points: PressureDistribution,
    states: StateRange,
    count: int = 64,
) -> tuple[float, float]:
    """Largest deviations [1] of the points from the full distribution: of forces and moments, and of
    stiffnesses.

    The sums of share times p, p x, p y and k, k x, k y, k x^2, k x y, k y^2, each over the sum of its sizes
    now or at tightening, whichever is larger, at `count` random states with 0.5 to 1.5 times the mean
    pressure [Pa].
    """
    worst, reach = np.zeros(9), np.max(np.abs(shape.position), axis=0)
    low = [0.5, -states.moment, states.opening[0], -states.tilt, -states.tilt]
    high = [1.5, states.moment, states.opening[1], states.tilt, states.tilt]
    unit = qmc.Sobol(5, rng=SEED).random(count)
    for preload, moment, *motion in low + unit * (np.array(high) - low):
        load = preload * mean, moment
        start = preloaded_approaches(curve, shape, load)
        scale = (np.max(start) - curve.displacement[0]) * np.array(motion) / [1.0, reach[1], reach[0]]
        there, size = pressure_moments(curve, shape, start, scale, reach)
        few, _ = pressure_moments(curve, points, preloaded_approaches(curve, points, load), scale, reach)
        worst = np.maximum(worst, np.abs(few - there) / size)
    return float(np.max(worst[:3])), float(np.max(worst[3:]))


def preloaded_approaches(curve: Curve, shape: PressureDistribution, load: tuple[float, float]) -> Array:
    """Approaches (n) [m] under a mean pressure [Pa] and a factor of the moment shape [1]."""
    return curve.inverse(
        load[0] * np.maximum(shape.preload_pressure_ratio + load[1] * shape.moment_pressure_ratio, 0.0)
    )


def pressure_moments(
    curve: Curve, shape: PressureDistribution, start: Array, motion: Array, reach: Array
) -> tuple[Array, Array]:
    """Nine moments of pressure and stiffness, and their magnitudes.

    The nodes start at approaches (n) [m] and move by a normal motion [m] and rotations [rad] about x and y.
    """
    x, y = shape.position.T
    now = curve.derivatives(start - (motion[0] + motion[1] * y - motion[2] * x))
    x, y = x / reach[0], y / reach[1]
    factors = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y])
    values = [np.concatenate([p * factors[:3], k * factors]) for p, k in (now, curve.derivatives(start))]
    sizes = [np.abs(each) @ shape.area_share for each in values]
    return values[0] @ shape.area_share, np.maximum(*sizes)


def nodal_field() -> PressureDistribution:
    """Nodal pressure field without symmetry: a plate in contact around three bolts."""
    unit = qmc.Sobol(2, rng=SEED).random(512)[:FIELD_NODES] - 0.5
    x, y = 0.2 * unit[:, 0], 0.1 * unit[:, 1]
    bolts = ((-0.06, 0.02), (0.01, -0.025), (0.07, 0.015))
    near = [np.exp(-((x - a) ** 2 + (y - b) ** 2) / 0.03**2) for a, b in bolts]
    share = np.full(FIELD_NODES, 1.0 / FIELD_NODES)
    x, y = x - share @ x, y - share @ y
    equal = sum(near) / np.mean(sum(near))
    tilt = near[0] - near[1] + near[2]
    tilt = tilt - np.mean(tilt)
    rows = (tuple(values.tolist()) for values in (share, x, y, equal, tilt))
    return NodalField(
        **dict(zip(("share", "x", "y", "equal", "tilt"), rows, strict=True))
    ).pressure_distribution()


def bolted_plate(
    *bolts: tuple[float, float], size: tuple[float, float], hole: float, cone: float
) -> PressureDistribution:
    """Pressure distribution of a plate with bolts at places [m]."""
    x, y = zip(*bolts, strict=True)
    return BoltedPlate(
        length=size[0], width=size[1], x=x, y=y, hole_diameter=hole, cone_diameter=cone
    ).pressure_distribution()


def contacts() -> Iterator[tuple[str, PressureDistribution]]:
    """Contacts that are compared: {name: pressure distribution}."""
    yield "frame, 8 bolts", pressure_distribution(load_default("bolted_joint").values.pattern)
    four = ((-0.1, 0.02), (0.0, -0.03), (0.1, 0.02), (0.1, -0.02))
    yield "plate, 4 bolts", bolted_plate(*four, size=(0.3, 0.1), hole=0.011, cone=0.03)
    square = ((-0.08, -0.03), (0.08, -0.03), (0.08, 0.03), (-0.08, 0.03))
    yield "plate, 4 x M12", bolted_plate(*square, size=(0.2, 0.1), hole=0.0135, cone=0.05)
    three = ((-0.03, 0.0), (0.0, 0.0), (0.03, 0.0))
    yield "plate, a row", bolted_plate(*three, size=(0.12, 0.025), hole=0.0085, cone=0.02)
    yield "field", nodal_field()
    yield "annulus", annulus()


def annulus(around: int = 96, across: int = 8) -> PressureDistribution:
    """Nodes of equal area on a ring; the pressure decreases from the inner to the outer edge."""
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
    """Plate with three to eight bolts at random places."""
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
    return bolted_plate(
        *((float(x), float(y)) for x, y in bolts), size=(size[0], size[1]), hole=hole, cone=cone
    )


def friction_and_losses(
    spring: BoltedJointSpring,
    shape: PressureDistribution,
    fine: bool,
    largest: float,
    motion: Motion,
    ways: Array = DISPLACEMENTS,
) -> tuple[Array, Array]:
    """Force or moment on 1 m2 [N], [N.m] at displacements `ways` from rest, and losses [J] of loops of the
    AMPLITUDES.

    fine    : many sliders at each node of the shape, in place of the joint's sliders
    largest : largest approach [m], the unit of displacements and tilt
    """
    ratio = float(spring.joint.shear_stiffness_ratio())
    patches = shape if isinstance(shape, FrictionPatches) else shape.make_friction_patches()
    gyration = np.sqrt(
        shape.area_share @ np.sum(shape.position**2, axis=1)
        + shape.area_share @ patches.slider_circle_radius**2
    )
    start = preloaded_approaches(spring.curve, shape, (mean_pressure(spring), motion.moment))
    approach = start - motion.tilt * largest * shape.position[:, 0] / gyration
    q = np.array([0.0, np.sqrt(1.0 - motion.turn**2), 0.0, 0.0, 0.0, motion.turn / gyration])
    along = tangential_displacement(patches, q)
    sliders = spring.with_nodes(shape).friction_law.foundation(start)
    if fine:
        sliders = sliders_at_levels(spring.curve, ratio, spring.joint.mu, FINE)
    gross = spring.joint.mu / ratio * largest * along

    def displace(force: Array, way: float) -> SliderUpdate:
        return sliders.advance(force, approach, approach, way * gross)

    rest, losses = sliders.virgin_forces(approach.size), []
    forces = [
        shape.area_share @ np.sum(sum_slider_forces(displace(rest, way).force) * along, axis=1)
        for way in ways
    ]
    for size in AMPLITUDES:
        back = displace(displace(rest, size).force, -2.0 * size)
        losses.append(
            shape.area_share @ (back.dissipated_energy + displace(back.force, 2.0 * size).dissipated_energy)
        )
    return np.array(forces), np.array(losses)


def random_poles(shape: PressureDistribution, count: int) -> Array:
    """Poles (count, 2) [m] at random places near nodes of a contact."""
    rng = np.random.default_rng(1)
    poles = shape.position[rng.choice(shape.area_share.size, count, p=shape.area_share)]
    return poles + 0.5 * np.sqrt(
        np.prod(np.ptp(shape.position, axis=0)) / shape.area_share.size
    ) * rng.uniform(-1.0, 1.0, poles.shape)


def gross_slip_forces(points: FrictionPatches, friction: Array, poles: Array) -> Array:
    """Friction forces (p, 2) of points with friction limits (n) in rotations about poles (p, 2) [m]."""
    x, y = torsion_directions(FOUNDATION_SLIDER_COUNT if np.any(points.slider_circle_radius) else 2)
    places = points.position + points.slider_circle_radius[:, None] * np.column_stack([y, -x])[:, None]
    arm = places - poles[:, None, None]
    way = np.stack([-arm[..., 1], arm[..., 0]], axis=-1) / np.linalg.norm(arm, axis=-1)[..., None]
    return np.asarray(np.einsum("n,pkni->pi", friction, way)) / len(x)


def pole_deviations(shape: PressureDistribution, patches: FrictionPatches) -> Array:
    """Deviation of the force in gross slip about random poles: 95 % quantile, largest.

    Over the friction limit [1].
    """
    poles = random_poles(shape, POLE_COUNT)
    both = (
        gross_slip_forces(points, points.area_share * points.preload_pressure_ratio, poles)
        for points in (shape.make_friction_patches(), patches)
    )
    off = np.linalg.norm(np.subtract(*both), axis=1)
    return np.quantile(off, [0.95, 1.0])


def mean_pressure(spring: BoltedJointSpring) -> float:
    """Mean pressure of the preloaded joint [Pa]."""
    return float(PRELOAD * spring.joint.n_bolts / spring.joint.A_0)
