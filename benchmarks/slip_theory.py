"""What a normal curve says of shear at a constant load. The friction is 1: it scales forces and shifts alike.

Jaeger, Ciavarella: q(u) = P(delta) - P(delta - kappa u), kappa = K_T/K_N; the way back is the way there,
twice as large (Masing). The same by the package's sliders, and a guess that knows the first slope alone.
"""

import numpy as np
from friction_sliders import at_levels
from scipy.interpolate import PchipInterpolator

from jointfmu.mechanics.curve import Curve

STATIONS = np.polynomial.legendre.leggauss(6)
"""On each branch of a loop, and their weights."""
HEIGHTS = np.linspace(0.0, 1.0, 33)
"""Loads of the heights of the package's sliders over the load of the contact [1]."""


def masing(force, u, stations=STATIONS):
    """Area of a loop of amplitude u whose branches are twice the backbone force(u)."""
    x, weight = stations
    back = force(np.array([u])) - 2.0 * force(0.5 * u * (1.0 + x))
    return -2.0 * u * float(weight @ back)


def sphere(load, slope):
    """Backbone of Mindlin's sphere with a friction limit and a first slope."""
    return lambda u: load * (1.0 - np.maximum(1.0 - slope * u / (1.5 * load), 0.0) ** 1.5)


def sphere_shift(load, slope, part):
    """Displacement of that sphere at a part of its limit."""
    return 1.5 * load / slope * (1.0 - (1.0 - part) ** (2.0 / 3.0))


def convex(approach, load):
    """Curve of loads (n) from the first touch on: a stiffness that never falls, scaled to the last load."""
    middle = 0.5 * (approach[1:] + approach[:-1])
    k = np.maximum.accumulate(np.diff(load) / np.diff(approach))
    last = k[-1] + (k[-1] - k[-2]) / (middle[-1] - middle[-2]) * (approach[-1] - middle[-1])
    nodes = np.concatenate([approach[:1], middle, approach[-1:]])
    stiffness = PchipInterpolator(nodes, np.concatenate([[0.0], k, [last]]))
    scale = load[-1] / stiffness.integrate(nodes[0], nodes[-1])
    inside = nodes[1:] - 1e-9 * np.diff(nodes)
    bends = (scale * stiffness(at, 1) for at in (nodes[:-1], inside))
    return Curve(nodes, scale * stiffness.antiderivative()(nodes), scale * stiffness(nodes), *bends)


def sliders(curve, ratio, amplitudes):
    """Loop areas (amplitudes) of the package's sliders at the end of a curve."""
    foundation = at_levels(curve, ratio, 1.0, HEIGHTS)
    delta, areas = curve.end[0], []
    for u in amplitudes:
        there = foundation.advance(foundation.virgin_forces(), delta, delta, [u, 0.0])
        back = foundation.advance(there.force, delta, delta, [-2.0 * u, 0.0])
        again = foundation.advance(back.force, delta, delta, [2.0 * u, 0.0])
        areas.append(float(back.dissipated_energy + again.dissipated_energy))
    return np.array(areas)
