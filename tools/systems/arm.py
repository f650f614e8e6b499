"""A serial arm of rigid links with six or any number of axes: forward kinematics and inverse dynamics.

At zero angles the arm stands upright: every link lies along z, and turns about z or y against the one before.
Newton-Euler recursion (Luh, Walker and Paul, J. Dyn. Sys. Meas. Control 102, 1980) in the ground's frame.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jointfmu_fmu_src.partners.laws import GRAVITY
from numpy.typing import ArrayLike

from jointfmu.quantity import Array, check, quantity, smooth_step, smooth_step_slopes

AXES: Mapping[str, Array] = {"y": np.array([0.0, 1.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}


@dataclass(frozen=True, kw_only=True)
class Link:
    """One link behind its axis."""

    length: float = quantity("m", "from this axis to the next one, or to the tip", ge=0.0)
    mass: float = quantity("kg", "mass of the link with the next drive", gt=0.0)
    centre: float = quantity("m", "from the axis to the centre of mass", ge=0.0)
    J_along: float = quantity("kg.m2", "moment of inertia about the link's own line", gt=0.0)
    J_across: float = quantity("kg.m2", "the same across it, about the centre of mass", gt=0.0)
    travel: float = quantity("rad", "angle of the motion")

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Arm:
    """An arm and one motion of it: all axes from upright to their travel, along a quintic from rest to rest.

    names, axes, links : of the axes, from the ground on; axes are keys of AXES
    start, duration    : of the motion [s]
    """

    names: Sequence[str]
    axes: Sequence[str]
    links: Sequence[Link]
    start: float
    duration: float

    def motion(self, time: ArrayLike) -> tuple[Array, Array, Array]:
        """Angles [rad], speeds [rad/s], accelerations [rad/s2] of all axes, (times, axes)."""
        x = (np.asarray(time, dtype=np.float64)[:, None] - self.start) / self.duration
        travel = np.array([link.travel for link in self.links])
        rate, bend = smooth_step_slopes(x)
        return (
            travel * smooth_step(x),
            travel * rate / self.duration,
            travel * bend / self.duration**2,
        )

    def frames(self, q: Array) -> tuple[list[Array], list[Array], Array]:
        """Turns of the links (n, 3, 3), places of axes and tip (n, 3) [m] at angles (n, axes) [rad]."""
        turn, place = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        turns, places = [], []
        for k, (axis, link) in enumerate(zip(self.axes, self.links, strict=True)):
            turn = turn @ _rotation(axis, q[:, k])
            turns.append(turn)
            places.append(place)
            place = place + link.length * turn[:, :, 2]
        return turns, places, place

    def tip(self, q: Array) -> Array:
        """Place of the tip (n, 3) [m] at angles (n, axes) [rad]."""
        return self.frames(q)[2]

    def torques(self, q: Array, speed: Array, acceleration: Array, gravity: float = GRAVITY) -> Array:
        """Torques (n, axes) [N.m] that move the links so against their inertia and weight."""
        turns, places, tip = self.frames(q)
        n = len(q)
        w, alpha = np.zeros((n, 3)), np.zeros((n, 3))
        a = np.broadcast_to(np.array([0.0, 0.0, gravity]), (n, 3))
        forces, moments, centres = [], [], []
        for k, (axis, link) in enumerate(zip(self.axes, self.links, strict=True)):
            if k:
                arm = places[k] - places[k - 1]
                a = a + np.cross(alpha, arm) + np.cross(w, np.cross(w, arm))
            along = turns[k] @ AXES[axis]
            turning = along * speed[:, k, None]
            alpha = alpha + along * acceleration[:, k, None] + np.cross(w, turning)
            w = w + turning
            centre = link.centre * turns[k][:, :, 2]
            forces.append(link.mass * (a + np.cross(alpha, centre) + np.cross(w, np.cross(w, centre))))
            inertia = np.diag([link.J_across, link.J_across, link.J_along])
            inertia = turns[k] @ inertia @ turns[k].transpose(0, 2, 1)
            moments.append(_of(inertia, alpha) + np.cross(w, _of(inertia, w)))
            centres.append(centre)
        found = np.empty((n, len(self.links)))
        force, moment, after = np.zeros((n, 3)), np.zeros((n, 3)), tip
        for k in reversed(range(len(self.links))):
            arm = after - places[k]
            moment = moments[k] + np.cross(centres[k], forces[k]) + moment + np.cross(arm, force)
            force, after = force + forces[k], places[k]
            found[:, k] = np.sum(moment * (turns[k] @ AXES[self.axes[k]]), axis=1)
        return found

    def inertias(self, q: Array) -> Array:
        """Inertia (axes) [kg.m2] that each axis turns at angles (axes), the others held."""
        count = len(self.links)
        held = np.broadcast_to(q, (count, count))
        return np.asarray(np.diag(self.torques(held, np.zeros((count, count)), np.eye(count), 0.0)))


def _rotation(axis: str, angle: Array) -> Array:
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = {
        "y": [[c, zero, s], [zero, one, zero], [-s, zero, c]],
        "z": [[c, -s, zero], [s, c, zero], [zero, zero, one]],
    }[axis]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _of(matrices: Array, vectors: Array) -> Array:
    """A matrix times a vector, for each of many."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])
