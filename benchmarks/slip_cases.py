"""What benchmarks/partial_slip.py compares: boundary elements in partial slip, and the normal curve alone."""

from dataclasses import dataclass

import band_of_waves
import numpy as np
import slip_theory as theory
from scipy.interpolate import PchipInterpolator
from slip_solver import Contact, lone, periodic

FORCES = (0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
"""Forces over the friction limit [1] at which displacements are compared."""
AMPLITUDES = (0.1, 0.2, 0.5, 0.9)
"""Of them the amplitudes of loops."""
APPROACHES = 24
"""From the first touch to the load: the normal curve."""
FINEST = 4
"""Spacings in the shortest wave."""
POINTS = 128
"""Along a side."""


@dataclass(frozen=True)
class Foretold:
    """What the normal curve of a contact says of its shear.

    ratio        : K_T/K_N [1]; load : mean pressure; slope : of the force at no displacement
    shift        : (forces) displacements that belong to FORCES
    drops, falls : (n) of approach and load, from none to all
    amplitudes   : of AMPLITUDES; areas : {"theory", "sliders", "sphere": (amplitudes)} of loops
    """

    ratio: float
    load: float
    slope: float
    shift: np.ndarray
    drops: np.ndarray
    falls: np.ndarray
    amplitudes: tuple[float, ...]
    areas: dict[str, np.ndarray]

    def shifted(self, part):
        """Displacements at parts of the friction limit."""
        return PchipInterpolator(self.falls, self.drops)(part * self.load) / self.ratio


@dataclass(frozen=True)
class Compared:
    """One contact in shear by boundary elements, and what was foretold, over it.

    area, load     : real over nominal area [1], mean pressure of the nominal one [E*]
    shift          : (forces) displacements, of the side; force, across : (forces) along them and across, over
                     the friction limit
    theory, sphere : (forces) displacements foretold for these forces, over the true ones
    loss           : (amplitudes) areas of loops
    loop_theory, loop_sliders, loop_sphere : (amplitudes) areas foretold, over the true ones
    open           : largest miss of a loop's end, over its amplitude
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
    """A closed path of the shift between two opposite ones.

    amplitude : of the shift; area; open : miss of the force at the end over that at the start
    back, again : (stations) forces on the two branches
    """

    amplitude: float
    area: float
    open: float
    back: np.ndarray
    again: np.ndarray


def heights(hurst, roll_off, seed, points=POINTS, stretch=1):
    """Rough square: waves from its side/roll_off to FINEST spacings; `stretch` times shorter along x."""
    band = (1.0 / roll_off, FINEST * stretch / points)
    z = band_of_waves.periodic(1.0, points, 3.0 - hurst, 1e-6, band, seed).z
    return z[(stretch * np.arange(points)) % points]


def rough(z, nu, separation=1.0):
    """Periodic contact whose mean planes are `separation` rms heights apart."""
    return Contact.at(periodic(len(z), nu), z - z.mean(), -separation * z.std())


def sphere_misses(points, nu, radius=0.4, curvature=0.1):
    """Errors of a sphere over Cattaneo and Mindlin: load, displacements (forces), loop areas (amplitudes).

    radius, curvature : of the contact and of the sphere, in sides of the square
    """
    x = (np.arange(points) + 0.5) / points - 0.5
    z = -0.5 * curvature * (x[:, None] ** 2 + x**2)
    contact = Contact.at(lone(points, nu), z, curvature * radius**2)
    stations = np.polynomial.legendre.leggauss(40)
    load, slope = 4.0 * curvature * radius**3 / 3.0, 2.0 * contact.space.ratio * radius
    shifts = theory.sphere_shift(load, slope, np.array(FORCES))
    states = backbone(contact, shifts, 0)
    force = np.array([state.force[0] for state in states]) / load
    starts = [FORCES.index(a) for a in AMPLITUDES]
    area = np.array([loop(contact, states[i], 0).area for i in starts])
    exact = np.array([theory.masing(theory.sphere(load, slope), shifts[i], stations) for i in starts])
    return (
        contact.load / load - 1.0,
        shifts / theory.sphere_shift(load, slope, force) - 1.0,
        area / exact - 1.0,
    )


def foretold(contact, amplitudes=AMPLITUDES):
    """Displacements and loops by the normal curve alone: loads of the contact under smaller approaches."""
    ratio, load = contact.space.ratio, contact.load
    end = contact.approach + contact.heights.max()
    drops = end * np.linspace(0.0, 1.0, APPROACHES + 1) ** 2
    falls = np.append(load - contact.lighter(drops[:-1]), load)
    shift = PchipInterpolator(falls, drops)(np.array(FORCES) * load) / ratio
    slope = ratio * falls[1] / drops[1]
    far = [shift[FORCES.index(a)] for a in amplitudes]
    curve = theory.convex((contact.approach - drops)[::-1], (load - falls)[::-1])
    shapes = {"theory": lambda u: load - contact.lighter(ratio * u), "sphere": theory.sphere(load, slope)}
    areas = {name: np.array([theory.masing(shape, u) for u in far]) for name, shape in shapes.items()}
    areas["sliders"] = theory.sliders(curve, ratio, far)
    more = load - contact.lighter(ratio * shift)
    order = np.argsort(np.concatenate([drops, ratio * shift]))
    every = (np.concatenate(pair)[order] for pair in ((drops, ratio * shift), (falls, more)))
    return Foretold(ratio, load, slope, shift, *every, amplitudes, areas)


def compared(contact, told, axis=0):
    """The contact sheared along an axis by boundary elements, beside what was foretold."""
    states = backbone(contact, told.shift, axis)
    force = np.array([state.force[axis] for state in states]) / told.load
    loops = [loop(contact, states[FORCES.index(a)], axis) for a in told.amplitudes]
    loss = np.array([one.area for one in loops])
    return Compared(
        area=contact.area,
        load=contact.load,
        shift=told.shift,
        force=force,
        across=np.array([state.force[1 - axis] for state in states]) / told.load,
        theory=told.shifted(force) / told.shift,
        sphere=theory.sphere_shift(told.load, told.slope, force) / told.shift,
        loss=loss,
        loop_theory=told.areas["theory"] / loss,
        loop_sliders=told.areas["sliders"] / loss,
        loop_sphere=told.areas["sphere"] / loss,
        open=max(one.open for one in loops),
    )


def backbone(contact, shifts, axis):
    """States of a contact that is sheared for the first time."""
    states, state = [], contact.at_rest()
    for u in shifts:
        state = contact.moved(state, u * np.eye(2)[axis])
        states.append(state)
    return states


def loop(contact, state, axis, stations=theory.STATIONS):
    """From a state to its opposite and back."""
    u, start, forces = float(state.shift[axis]), float(state.force[axis]), []
    for way in (-1.0, 1.0):
        for x in (*stations[0], 1.0):
            state = contact.moved(state, way * x * u * np.eye(2)[axis])
            forces.append(float(state.force[axis]))
    back, again = np.reshape(forces, (2, -1))[:, :-1]
    return Loop(u, float(u * (again - back) @ stations[1]), abs(forces[-1] / start - 1.0), back, again)
