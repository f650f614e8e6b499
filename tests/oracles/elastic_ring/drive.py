"""Contact of flexspline and bearing ring from a ring model of the harmonic drive.

Each section across the axis holds two thin rings: the flexspline, pressed outward by the bearing's outer
ring, which sits on the balls of the wave generator. Between the rings the interface law gives the
pressure over the overlap, a ball pushes by Hertz's law; both contacts open freely. The teeth load the
flexspline around the major axis, the cup takes the torque away as a uniform shear flow.

Neglected are the cup's stiffness against coning (the sections are independent), friction between the rings,
the distance of the teeth from the neutral line, the thickness compared with the radius, and bending of the
inner ring.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.harmonic_drive.law import HarmonicDriveParameters
from jointfmu.mechanics.curve import Curve, tabulate_approach

from .contact import Contact, ContactLaw, Spring, equilibrium, hertz_contact
from .data import Rings, Traction, ball_stiffness, contact_length, tooth_traction
from .nodes import Footprint
from .ring import Circle, Ring

Array = NDArray[np.float64]
_SECTION_QUADRATURE = np.polynomial.legendre.leggauss(6)
HEIGHTS, HEIGHT_WEIGHTS = 0.5 * (1.0 + _SECTION_QUADRATURE[0]), 0.5 * _SECTION_QUADRATURE[1]
"""Sections along the contact from 0 to 1 and their weights [1]."""
_START_OVERLAP = 5e-6
"""Overlap [m] of the balls at the start of Newton's method; a tenth of it between the rings."""


@dataclass(frozen=True, slots=True)
class Section:
    """Equilibrium of one section across the axis.

    theta, weight : (q) angles [1] and arc lengths [m]; pressure : (q) [Pa] between the rings
    push   : [N/m] sum of the balls' forces per width
    torque : [N] torque per width that the wave generator needs against these forces
    """

    theta: Array
    weight: Array
    pressure: Array
    push: float
    torque: float


def section(
    drive: HarmonicDriveParameters,
    rings: Rings,
    height: float,
    traction: Traction,
    curve: Curve | None = None,
) -> Section:
    """Equilibrium of the section at a height [m] from the opening of the cup, under a traction.

    curve : pressure [Pa] over approach [m] of the interface; made from the drive's law if not given

    Raises ValueError if the height is not on the cup, RuntimeError if the equilibrium is not found.
    """
    if not 0.0 <= height < rings.cup_length:
        raise ValueError(
            f"height = {height:g} m is outside [0, {rings.cup_length:g}): distance from the opening"
        )
    circle = _circle(drive.radius, rings.balls * rings.elements_per_ball)
    w = drive.radial_deformation * (1.0 - height / rings.cup_length)
    cam = _Cam(w, drive.eccentricity, rings.eccentric_angle)
    flexspline = Ring.of(drive.flexspline.E, drive.flexspline.nu, rings.wall)
    bearing = Ring.of(drive.bearing.E, drive.bearing.nu, rings.race)
    stiffness = sparse.block_diag([circle.stiffness(flexspline), circle.stiffness(bearing)]).tocsr()
    none = sparse.csr_matrix(circle.value.shape)
    between = Contact(
        rows=sparse.hstack([-circle.value, none, circle.value, none]).tocsr(),
        start=np.full(circle.theta.size, rings.interference),
        weight=circle.weight,
        law=_interface(curve or tabulate_approach(drive.law)),
    )
    n = circle.value.shape[1]
    nodes = rings.elements_per_ball * np.arange(rings.balls)
    at = circle.nodes[nodes] + rings.first_ball
    balls = Contact(
        rows=sparse.csr_matrix(
            (-np.ones(nodes.size), (np.arange(nodes.size), 2 * n + 2 * nodes)), (nodes.size, 4 * n)
        ),
        start=cam.radial(at),
        weight=np.ones(nodes.size),
        law=hertz_contact(ball_stiffness(drive, rings) / contact_length(drive)),
    )
    theta = circle.theta + rings.first_ball
    load = np.concatenate([circle.load(*traction(theta)), np.zeros(2 * n)])
    x = equilibrium(
        stiffness,
        load,
        [between, balls],
        _start(circle, cam, rings.first_ball),
        held=[n, 3 * n],  # a ring may turn freely: its loads have no moment
        springs=_lateral(circle, rings.lateral_stiffness / contact_length(drive), rings.first_ball),
    )
    push = balls.load(x)
    return Section(theta, circle.weight, between.load(x), float(np.sum(push)), -float(push @ cam.slope(at)))


def field(
    drive: HarmonicDriveParameters, rings: Rings, traction: Traction
) -> tuple[Footprint, list[Section]]:
    """Nodes (n) of the whole contact under a traction, from six sections, and these sections."""
    curve = tabulate_approach(drive.law)
    z = HEIGHTS * contact_length(drive)
    sections = [section(drive, rings, height, traction, curve) for height in z.tolist()]
    return footprint(drive, rings, sections, z, HEIGHT_WEIGHTS), sections


def footprint(
    drive: HarmonicDriveParameters, rings: Rings, sections: list[Section], z: Array, axial: Array
) -> Footprint:
    """Nodes (n) of sections at heights z (k) [m], each of which represents a share `axial` (k) [1] of the
    length."""
    theta = np.stack([s.theta for s in sections])
    height = np.broadcast_to(z[:, None], theta.shape)
    position, normal = oval(drive, rings, theta, height)
    share = axial[:, None] * np.stack([s.weight for s in sections]) / (2.0 * np.pi * drive.radius)
    return Footprint(
        share=share.ravel(),
        position=position.reshape(-1, 3),
        normal=normal.reshape(-1, 3),
        pressure=np.stack([s.pressure for s in sections]).ravel(),
    )


def oval(drive: HarmonicDriveParameters, rings: Rings, theta: Array, height: Array) -> tuple[Array, Array]:
    """Positions [m] and unit normals (..., 3) on the elliptical cone, at angles and heights (...) [m]."""
    w = drive.radial_deformation * (1.0 - height / rings.cup_length)
    a, b = drive.radius + w, drive.radius - w
    slope = drive.radial_deformation / rings.cup_length * np.cos(2.0 * theta)
    flat = 1.0 / np.hypot(1.0, slope)
    across = flat / np.hypot(b * np.cos(theta), a * np.sin(theta))
    position = np.stack([a * np.cos(theta), b * np.sin(theta), height], axis=-1)
    return position, np.stack([across * b * np.cos(theta), across * a * np.sin(theta), slope * flat], axis=-1)


def torsional_stiffness(drive: HarmonicDriveParameters, nodes: Footprint) -> float:
    """K_TS [N.m/rad] of nodes by Eq. 45 and the law, both corrected, without scale factor."""
    state = evaluate_at_pressure(drive.law, nodes.pressure)
    return float(nodes.rotation(state["K_N"], state["K_T"], (0.0, 0.0, 1.0)))


def ring_model_stiffness(drive: HarmonicDriveParameters, rings: Rings, torque: float) -> float:
    """K_TS [N.m/rad] of the ring model at a torque [N.m], without scale factor."""
    return torsional_stiffness(drive, field(drive, rings, tooth_traction(drive, rings, torque))[0])


class _Cam(NamedTuple):
    """Radial profile of the wave generator relative to the free radius of the rings, at one height.

    w cos(2 theta) + e cos(theta - angle): its perimeter is that of the free ring to first order.
    """

    w: float
    e: float
    angle: float

    def radial(self, theta: Array) -> Array:
        """Radial profile [m] over the angle."""
        return self.w * np.cos(2.0 * theta) + self.e * np.cos(theta - self.angle)

    def slope(self, theta: Array) -> Array:
        """Derivative [m] of the radial profile with respect to the angle."""
        return -2.0 * self.w * np.sin(2.0 * theta) - self.e * np.sin(theta - self.angle)

    def tangential(self, theta: Array) -> Array:
        """Tangential displacement [m] of a ring that follows the profile without stretching."""
        return -0.5 * self.w * np.sin(2.0 * theta) - self.e * np.sin(theta - self.angle)

    def tangential_slope(self, theta: Array) -> Array:
        """Derivative [m] of the tangential displacement with respect to the angle."""
        return -self.radial(theta)


def _interface(curve: Curve) -> ContactLaw:
    """Contact law of the interface: pressure over the overlap from first contact."""
    touch = float(curve.displacement[0])

    def law(overlap: Array) -> tuple[Array, Array]:
        load, slope = curve.derivatives(np.maximum(overlap, 0.0) + touch, 1)
        return np.maximum(load, 0.0), slope  # round-off where the table begins

    return law


def _start(circle: Circle, cam: _Cam, turn: float) -> Array:
    """Start values of Newton's method: both rings in the shape of the profile, with small overlaps."""

    def unknowns(value: Callable[[Array], Array], slope: Callable[[Array], Array], less: float) -> Array:
        return circle.unknowns(lambda t: value(t + turn) - less, lambda t: slope(t + turn))

    v = unknowns(cam.tangential, cam.tangential_slope, 0.0)
    flexspline, bearing = (
        unknowns(cam.radial, cam.slope, less) for less in (1.1 * _START_OVERLAP, _START_OVERLAP)
    )
    return np.concatenate([flexspline, v, bearing, v])


def _lateral(circle: Circle, stiffness: float, turn: float) -> list[Spring]:
    """Springs of the cup against the mean displacement of the flexspline along both axes."""
    springs = []
    for axis in (0.0, 0.5 * np.pi):
        across = circle.theta + turn - axis
        even = circle.load(np.cos(across), -np.sin(across)) / (2.0 * np.pi * circle.radius)
        springs.append(Spring(np.concatenate([even, np.zeros_like(even)]), stiffness))
    return springs


@lru_cache(maxsize=4)
def _circle(radius: float, elements: int) -> Circle:
    return Circle.of(radius, elements)
