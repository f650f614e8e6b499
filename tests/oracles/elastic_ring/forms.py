"""Closed forms for rings, and the same problems by finite elements."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import brentq

from .contact import Contact, Spring, equilibrium, linear_contact
from .ring import Circle, Ring

Array = NDArray[np.float64]

_HALVES = (0.05, 1.5)
"""Range of the half angle [1] of the free part, for the search of its edge."""


class OnOval(NamedTuple):
    """Contact of a ring with a rigid oval, per width."""

    edge: float
    """Angle [1] from the major axis at which the ring leaves the oval."""
    peak: float
    """Pressure [Pa] on the major axis."""
    edge_pressure: float
    """Pressure [Pa] at the edge, where a line force acts next to it."""
    edge_force: float
    """Line force [N/m] at each of the four edges."""
    lobe_force: float
    """Resultant [N/m] of one lobe along the major axis."""


def opposite_forces(ring: Ring, radius: float, force: float) -> float:
    """Radial displacement [m] of the loaded points of a ring under two opposite forces [N/m] outward.

    Bending F r^3/D (pi/8 - 1/pi) and stretching F r/A pi/8.
    """
    return force * radius * (radius**2 / ring.D * (np.pi / 8.0 - 1.0 / np.pi) + np.pi / 8.0 / ring.A)


def on_oval(ring: Ring, radius: float, deformation: float) -> OnOval:
    """Ring that is pressed without friction onto the rigid oval r + w cos(2 theta) of the same perimeter.

    With N the hoop force and M = -D (u'' + u)/r^2 the moment (' by the angle), equilibrium is
    M'' + M = C - p r^2, r N = C - M. On the oval p = D w/r^4 (9 cos(2 theta) + c) with c = C r^2/(D w);
    off it, with x from the minor axis, u/w = -c + A cos x + B x sin x. Displacement, slope and moment
    go on at the edge and the ring is longer by N/A on average, which leaves one equation for the edge.
    (thickness/radius)^2/12 is neglected against 1.

    Raises ValueError if the ring is so thin, or so thick, that it lies on all or hardly any of the oval.
    """

    def free_part_constants(half: float) -> tuple[float, float, float]:
        """Constants A, B, c of the free part within +-half about the minor axis."""
        sine, cosine = np.sin(half), np.cos(half)
        slopes = [[-sine, sine + half * cosine], [-cosine, 2.0 * cosine - half * sine]]
        a, b = np.linalg.solve(slopes, [2.0 * np.sin(2.0 * half), 4.0 * np.cos(2.0 * half)])
        return float(a), float(b), float(a * cosine + b * half * sine + np.cos(2.0 * half))

    def stiffness_ratio_at(half: float) -> float:
        """Ratio D/(A r^2) at which the ring leaves the oval at this angle."""
        a, b, c = free_part_constants(half)
        off = -c * half + a * np.sin(half) + b * (np.sin(half) - half * np.cos(half))
        return float((off + 0.5 * np.sin(2.0 * half)) / (0.5 * np.pi * c))

    share, low, high = (
        ring.D / (ring.A * radius**2),
        stiffness_ratio_at(_HALVES[0]),
        stiffness_ratio_at(_HALVES[1]),
    )
    if not low < share < high:
        raise ValueError(f"D/(A r^2) = {share:g} is outside ({low:.2g}, {high:.2g}): a thin ring that bends")
    half = brentq(lambda x: stiffness_ratio_at(x) - share, *_HALVES, xtol=1e-14)
    a, b, c = free_part_constants(half)
    third = a * np.sin(half) - b * (3.0 * np.sin(half) + half * np.cos(half))
    unit = ring.D * deformation / radius**4
    return OnOval(
        edge=0.5 * np.pi - half,
        peak=unit * (9.0 + c),
        edge_pressure=unit * (c - 9.0 * np.cos(2.0 * half)),
        edge_force=unit * radius * abs(third + 8.0 * np.sin(2.0 * half)),
        lobe_force=4.0 * b * unit * radius,
    )


def opposite_forces_in_elements(ring: Ring, radius: float, force: float, elements: int) -> float:
    """Result of `opposite_forces` by an even number of finite elements."""
    circle = Circle.of(radius, elements)
    n = 2 * elements
    load, apart = np.zeros((2, 2 * n))
    load[[0, elements]], apart[[0, elements]] = force, (0.5, -0.5)
    # both loaded points keep their place along the ring; the spring, without force, theirs together
    held = [n, n + elements]
    x = equilibrium(circle.stiffness(ring), load, [], np.zeros(2 * n), held, [Spring(apart, ring.A / radius)])
    return float(x[0])


def on_oval_in_elements(
    ring: Ring, radius: float, deformation: float, modulus: float, elements: int
) -> tuple[Circle, Array]:
    """Pressure [Pa] at the points of the circle, by elements on the oval of `on_oval` with an elastic
    foundation [Pa/m]."""
    circle, w = Circle.of(radius, elements), deformation
    contact = Contact(
        rows=sparse.hstack([-circle.value, sparse.csr_matrix(circle.value.shape)]).tocsr(),
        start=w * np.cos(2.0 * circle.theta),
        weight=circle.weight,
        law=linear_contact(modulus),
    )
    radial = circle.unknowns(lambda t: w * (np.cos(2.0 * t) - 1e-3), lambda t: -2.0 * w * np.sin(2.0 * t))
    along = circle.unknowns(lambda t: -0.5 * w * np.sin(2.0 * t), lambda t: -w * np.cos(2.0 * t))
    start = np.concatenate([radial, along])
    x = equilibrium(circle.stiffness(ring), np.zeros_like(start), [contact], start, [2 * elements])
    return circle, contact.load(x)
