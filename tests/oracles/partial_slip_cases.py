"""Partial slip of rough contacts: boundary elements against the prediction from the normal curve.

The friction coefficient is 1: it scales forces and displacements alike. Jaeger and Ciavarella predict the
force q(u) = P(delta) - P(delta - kappa u), kappa = K_T/K_N, at a constant load. The unloading branch of a
loop is the backbone, twice as large (Masing). Two more predictions: the package's sliders, and Mindlin's
sphere with the same load and initial stiffness.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from jointfmu.mechanics.curve import Curve

from . import rough_surfaces
from .partial_slip import Contact, periodic, single_square
from .sphere_friction import sliders_at_levels

STATIONS = np.polynomial.legendre.leggauss(6)
"""Gauss points and weights on each branch of a loop."""
HEIGHTS = np.linspace(0.0, 1.0, 33)
"""Loads at the slider heights of the package's sliders over the load of the contact [1]."""
FORCES = (0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
"""Forces over the friction limit [1] at which displacements are compared."""
AMPLITUDES = (0.1, 0.2, 0.5, 0.9)
"""Amplitudes of the loops over the friction limit [1]; a subset of FORCES."""
APPROACHES = 24
"""Number of points of the normal curve, from first contact to the load."""
SPACINGS_PER_WAVE = 4
"""Grid spacings in the shortest wave."""
POINTS = 128
"""Grid points along a side."""


@dataclass(frozen=True)
class Prediction:
    """Prediction of the shear of a contact from its normal curve.

    ratio             : K_T/K_N [1]; load : mean pressure
    initial_stiffness : tangential stiffness of small displacements
    shift             : (forces) displacements at FORCES
    approach_drops, load_drops : (n) decrease of approach and load, from zero to full unloading
    amplitudes        : values of AMPLITUDES that have loops
    areas             : {"theory", "sliders", "sphere": (amplitudes)} loop areas by the three predictions
    """

    ratio: float
    load: float
    initial_stiffness: float
    shift: np.ndarray
    approach_drops: np.ndarray
    load_drops: np.ndarray
    amplitudes: tuple[float, ...]
    areas: dict[str, np.ndarray]

    def displacement_at(self, part):
        """Displacements at fractions of the friction limit."""
        return PchipInterpolator(self.load_drops, self.approach_drops)(part * self.load) / self.ratio


@dataclass(frozen=True)
class Comparison:
    """Results for a contact sheared by boundary elements, and predictions over these results.

    area, load     : real over nominal area [1], mean pressure on the nominal area [E*]
    shift          : (forces) displacements over the side
    force, across  : (forces) over the friction limit, along the displacement and across it
    theory, sphere : (forces) predicted over computed displacements at these forces [1]
    loss           : (amplitudes) loop areas
    loop_theory, loop_sliders, loop_sphere : (amplitudes) predicted over computed loop areas [1]
    open           : largest force by which a loop does not close, over its amplitude [1]
    """

    area: float
    load: float
    shift: np.ndarray
    force: np.ndarray
    across: np.ndarray
    theory: np.ndarray
    sphere: np.ndarray
    loss: np.ndarray
    loop_theory: np.ndarray
    loop_sliders: np.ndarray
    loop_sphere: np.ndarray
    open: float


@dataclass(frozen=True)
class Loop:
    """Friction loop between two opposite displacements.

    amplitude   : amplitude of the displacement; `area`: area of the loop
    open        : difference of the force between end and start, over the force at the start [1]
    back, again : (stations) forces on the two branches
    """

    amplitude: float
    area: float
    open: float
    back: np.ndarray
    again: np.ndarray


def masing_loop_area(force, u, stations=STATIONS):
    """Area of a loop with amplitude u whose branches double the backbone force(u) (Masing)."""
    x, weight = stations
    back = force(np.array([u])) - 2.0 * force(0.5 * u * (1.0 + x))
    return -2.0 * u * float(weight @ back)


def sphere_backbone(load, stiffness):
    """Force over displacement of Mindlin's sphere with a friction limit `load` and an initial stiffness."""
    return lambda u: load * (1.0 - np.maximum(1.0 - stiffness * u / (1.5 * load), 0.0) ** 1.5)


def sphere_displacement(load, stiffness, part):
    """Displacement of Mindlin's sphere at a fraction `part` of its friction limit."""
    return 1.5 * load / stiffness * (1.0 - (1.0 - part) ** (2.0 / 3.0))


def convex_curve(approach, load):
    """Normal curve through loads (n) from first touch on, with a stiffness that never decreases."""
    middle = 0.5 * (approach[1:] + approach[:-1])
    k = np.maximum.accumulate(np.diff(load) / np.diff(approach))
    last = k[-1] + (k[-1] - k[-2]) / (middle[-1] - middle[-2]) * (approach[-1] - middle[-1])
    nodes = np.concatenate([approach[:1], middle, approach[-1:]])
    stiffness = PchipInterpolator(nodes, np.concatenate([[0.0], k, [last]]))
    scale = load[-1] / stiffness.integrate(nodes[0], nodes[-1])
    inside = nodes[1:] - 1e-9 * np.diff(nodes)
    bends = (scale * stiffness(at, 1) for at in (nodes[:-1], inside))
    return Curve(nodes, scale * stiffness.antiderivative()(nodes), scale * stiffness(nodes), *bends)


def slider_loop_areas(curve, ratio, amplitudes):
    """Loop areas (amplitudes) of the package's sliders at the end of a normal curve."""
    foundation = sliders_at_levels(curve, ratio, 1.0, HEIGHTS)
    delta, areas = curve.end_point[0], []
    for u in amplitudes:
        there = foundation.advance(foundation.virgin_forces(), delta, delta, [u, 0.0])
        back = foundation.advance(there.force, delta, delta, [-2.0 * u, 0.0])
        again = foundation.advance(back.force, delta, delta, [2.0 * u, 0.0])
        areas.append(float(back.dissipated_energy + again.dissipated_energy))
    return np.array(areas)


def heights(hurst, roll_off, seed, points=POINTS, stretch=1):
    """Heights of a rough square of side 1 with waves up to side/roll_off, `stretch` times shorter along x."""
    band = (1.0 / roll_off, SPACINGS_PER_WAVE * stretch / points)
    z = rough_surfaces.periodic(1.0, points, 3.0 - hurst, 1e-6, band, seed).z
    return z[(stretch * np.arange(points)) % points]


def rough_contact(z, nu, separation=1.0):
    """Periodic contact with mean planes `separation` rms heights apart."""
    return Contact.at_approach(periodic(len(z), nu), z - z.mean(), -separation * z.std())


def sphere_errors(points, nu, radius=0.4, curvature=0.1):
    """Relative errors of a sphere against Cattaneo and Mindlin: load, displacements (at forces), loop areas
    (at amplitudes).

    radius, curvature : radius of the contact and curvature of the sphere, in lengths of a side
    """
    x = (np.arange(points) + 0.5) / points - 0.5
    z = -0.5 * curvature * (x[:, None] ** 2 + x**2)
    contact = Contact.at_approach(single_square(points, nu), z, curvature * radius**2)
    stations = np.polynomial.legendre.leggauss(40)
    load, slope = 4.0 * curvature * radius**3 / 3.0, 2.0 * contact.space.stiffness_ratio * radius
    shifts = sphere_displacement(load, slope, np.array(FORCES))
    states = backbone(contact, shifts, 0)
    force = np.array([state.force[0] for state in states]) / load
    starts = [FORCES.index(a) for a in AMPLITUDES]
    area = np.array([follow_loop(contact, states[i], 0).area for i in starts])
    exact = np.array([masing_loop_area(sphere_backbone(load, slope), shifts[i], stations) for i in starts])
    return (
        contact.load / load - 1.0,
        shifts / sphere_displacement(load, slope, force) - 1.0,
        area / exact - 1.0,
    )


def predict(contact, amplitudes=AMPLITUDES):
    """Predict displacements and loop areas from the loads of the contact at smaller approaches."""
    ratio, load = contact.space.stiffness_ratio, contact.load
    end = contact.approach + contact.heights.max()
    drops = end * np.linspace(0.0, 1.0, APPROACHES + 1) ** 2
    falls = np.append(load - contact.loads_unloaded(drops[:-1]), load)
    shift = PchipInterpolator(falls, drops)(np.array(FORCES) * load) / ratio
    slope = ratio * falls[1] / drops[1]
    far = [shift[FORCES.index(a)] for a in amplitudes]
    curve = convex_curve((contact.approach - drops)[::-1], (load - falls)[::-1])
    shapes = {
        "theory": lambda u: load - contact.loads_unloaded(ratio * u),
        "sphere": sphere_backbone(load, slope),
    }
    areas = {name: np.array([masing_loop_area(shape, u) for u in far]) for name, shape in shapes.items()}
    areas["sliders"] = slider_loop_areas(curve, ratio, far)
    more = load - contact.loads_unloaded(ratio * shift)
    order = np.argsort(np.concatenate([drops, ratio * shift]))
    every = (np.concatenate(pair)[order] for pair in ((drops, ratio * shift), (falls, more)))
    return Prediction(ratio, load, slope, shift, *every, amplitudes, areas)


def compare(contact, prediction, axis=0):
    """Shear the contact along an axis by boundary elements, and compare with the prediction."""
    states = backbone(contact, prediction.shift, axis)
    force = np.array([state.force[axis] for state in states]) / prediction.load
    loops = [follow_loop(contact, states[FORCES.index(a)], axis) for a in prediction.amplitudes]
    loss = np.array([one.area for one in loops])
    return Comparison(
        area=contact.area,
        load=contact.load,
        shift=prediction.shift,
        force=force,
        across=np.array([state.force[1 - axis] for state in states]) / prediction.load,
        theory=prediction.displacement_at(force) / prediction.shift,
        sphere=sphere_displacement(prediction.load, prediction.initial_stiffness, force) / prediction.shift,
        loss=loss,
        loop_theory=prediction.areas["theory"] / loss,
        loop_sliders=prediction.areas["sliders"] / loss,
        loop_sphere=prediction.areas["sphere"] / loss,
        open=max(one.open for one in loops),
    )


def backbone(contact, shifts, axis):
    """States of the contact on first loading to displacements along an axis."""
    states, state = [], contact.unsheared()
    for u in shifts:
        state = contact.shear_to(state, u * np.eye(2)[axis])
        states.append(state)
    return states


def follow_loop(contact, state, axis, stations=STATIONS):
    """Loop from a state to the opposite displacement and back."""
    u, start, forces = float(state.shift[axis]), float(state.force[axis]), []
    for way in (-1.0, 1.0):
        for x in (*stations[0], 1.0):
            state = contact.shear_to(state, way * x * u * np.eye(2)[axis])
            forces.append(float(state.force[axis]))
    back, again = np.reshape(forces, (2, -1))[:, :-1]
    return Loop(u, float(u * (again - back) @ stations[1]), abs(forces[-1] / start - 1.0), back, again)
