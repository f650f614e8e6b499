"""Gear mesh: rough flanks and bending teeth in series, for every tooth pair in contact."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ...contact.laws.roughness import Roughness
from ...contact.laws.yu2022 import Yu2022
from ...mechanics.curve import Curve, approach_curve, assemble, refined
from ...mechanics.steps import mobility, stable_steps
from ...quantity import Array, Number, quantity, smooth_step, smooth_step_integral, smooth_step_slopes

CLOSING_STEPS = 96
"""Steps of a pair's table while the contact closes, doubled until it is accurate enough."""


@dataclass(frozen=True, kw_only=True)
class Wheels:
    """The wheels of a gear mesh and their teeth."""

    r_b1: float = quantity("m", "base radius of wheel 1", gt=0.0)
    r_b2: float = quantity("m", "base radius of wheel 2", gt=0.0)
    teeth1: float = quantity("1", "number of teeth of wheel 1", ge=1.0, whole=True)
    backlash: float = quantity("m", "backlash along the line of action", ge=0.0)
    K_tooth: float = quantity("N/m", "bending stiffness of one tooth pair, in series with its flanks", gt=0.0)
    contact_ratio: float = quantity("1", "mean number of tooth pairs in contact", ge=1.0, lt=3.0)
    engagement: float = quantity(
        "1",
        "time in which a pair takes up its load, over the shorter of the times with and without it",
        gt=0.0,
        le=1.0,
    )
    d: float = quantity("N.s/m", "damping along the line of action while the flanks touch", ge=0.0)
    overlap_ratio: float = quantity(
        "1", "face width over the axial pitch of a helical mesh, 0 of a spur one", ge=0.0, default=0.0
    )
    inertia1: float = quantity(
        "kg.m2", "of wheel 1 with all on it, for the stable steps alone; 0: held", ge=0.0, default=0.0
    )
    inertia2: float = quantity(
        "kg.m2", "of wheel 2 with all on it, for the stable steps alone; 0: held", ge=0.0, default=1.0
    )


@dataclass(frozen=True, kw_only=True)
class GearMesh(Wheels, Yu2022):
    """Parameters of the gear mesh; its flanks obey the law of Yu 2022."""


@dataclass(frozen=True, kw_only=True)
class RoughGearMesh(Wheels, Roughness):
    """The same with the law `roughness`."""


Mesh: TypeAlias = GearMesh | RoughGearMesh
"""A gear mesh with any law of its flanks."""


def base_pitch(mesh: Mesh) -> Number:
    """Distance of two teeth along the line of action [m]."""
    return 2.0 * np.pi * mesh.r_b1 / mesh.teeth1


def deflection(mesh: Mesh, motion: Sequence[Number]) -> Number:
    """s_rel [m] for phi1, w1, phi2, w2: beyond half the backlash, 0 inside it."""
    phi1, _, phi2, _ = motion
    along = mesh.r_b1 * phi1 + mesh.r_b2 * phi2
    half = 0.5 * mesh.backlash
    return along - np.minimum(np.maximum(along, 0.0 - half), half)


def phase(mesh: Mesh, motion: Sequence[Number]) -> Number:
    """Place in the mesh cycle [1] for phi1, w1, phi2, w2: mean way of both wheels over the base pitch."""
    phi1, _, phi2, _ = motion
    return 0.5 * (mesh.r_b1 * phi1 - mesh.r_b2 * phi2) / base_pitch(mesh)


def in_series(
    mesh: Mesh, approach: Number, pressure: Number, stiffness: Number, bend: Number
) -> tuple[Number, Number, Number, Number]:
    """Deflection [m], load [N], stiffness [N/m] and its derivative [N/m2] of a tooth pair.

    Given are the approach [m] of its flanks from first touch, the pressure [Pa] there, and this one's
    first [N/m3] and second [N/m5] derivative in the approach.
    """
    load, contact = mesh.A_0 * pressure, mesh.A_0 * stiffness
    share = mesh.K_tooth / (contact + mesh.K_tooth)  # of the contact in the deflection
    return approach + load / mesh.K_tooth, load, contact * share, mesh.A_0 * bend * share**3


def pair_curve(mesh: Mesh) -> tuple[Curve, float]:
    """Load [N] over deflection [m] of a tooth pair from first touch, and the deflection [m] where the
    closing of the contact ends.

    The nodes are those of the flanks' curve, where load, stiffness and its derivative are exact, with
    steps that shrink towards first touch while the contact closes.

    Raises ValueError and RuntimeError as `curve.approach_curve` and `curve.refined`.
    """
    flanks = approach_curve(mesh)
    length = -flanks.displacement[0]
    closing = in_series(mesh, length, flanks.closed, 0.0, 0.0)[0]
    return refined(lambda parts: _tabulate(mesh, flanks, parts), 1), float(closing)


def _tabulate(mesh: Mesh, flanks: Curve, parts: int) -> Curve:
    """The table of a pair with every step in so many parts."""
    nodes = flanks.displacement
    closed = int(np.searchsorted(nodes, 0.0))
    t = np.linspace(0.0, 1.0, CLOSING_STEPS * parts + 1)
    kinks = 1 + np.flatnonzero(flanks.bend_end[:-1] != flanks.bend_start[1:])
    ends = [closed, *(int(i) for i in kinks if i > closed), nodes.size - 1]
    places = [(t**2 - 1.0) * -nodes[0]]
    for first, last in pairwise(ends):
        steps = np.diff(nodes[first : last + 1])[:, None] * np.arange(parts) / parts
        places.append(np.append((nodes[first:last, None] + steps).ravel(), nodes[last]))
    pieces = []
    for x, last in zip(places, ends, strict=True):
        pressure, stiffness, bend = flanks.derivatives(x, 2)
        bend[-1] = flanks.bend_end[last - 1]  # from below, where a regime ends
        pieces.append(in_series(mesh, x - nodes[0], pressure, stiffness, bend))
    return assemble(pieces, flanks.error)


@dataclass(frozen=True, slots=True)
class GearMeshSpring:
    """The exported mesh: motion of the wheels in, torque out.

    With V(s) the energy of a pair and N(xi) the number of pairs at the phase xi of the mesh cycle, the
    torques are the gradient of the potential

        U(phi1, phi2) = N(xi) V(|s_rel|),

    besides the damping, which acts while the flanks touch and comes in over the closing of the contact.

    curve   : load over deflection of one pair
    closing : [m] deflection at which the closing of the contact ends
    """

    joint: Mesh
    curve: Curve
    closing: float

    @classmethod
    def of(cls, mesh: Mesh) -> "GearMeshSpring":
        """Tabulate a mesh."""
        return cls(mesh, *pair_curve(mesh))

    def motion(self, phi1: ArrayLike, w1: ArrayLike, phi2: ArrayLike, w2: ArrayLike) -> dict[str, Array]:
        """Torques, force and stiffness at wheel angles [rad] and speeds [rad/s] (...)."""
        motion = tuple(np.asarray(x, dtype=np.float64) for x in (phi1, w1, phi2, w2))
        s = np.abs(deflection(self.joint, motion))
        load, stiffness = self.curve.derivatives(s, 1)
        return torques(self.joint, motion, load, stiffness, self.curve.energy(s), self.closing)


def torques(
    mesh: Mesh,
    motion: Sequence[Number],
    load: Number,
    stiffness: Number,
    energy: Number,
    closing: Number,
) -> dict[str, Number]:
    """What the mesh exports at a motion phi1, w1, phi2, w2.

    Given are load [N], stiffness [N/m] and energy [J] of one pair at |s_rel|, and the deflection [m] at
    which the closing of the contact ends.
    """
    _, w1, _, w2 = motion
    s = deflection(mesh, motion)
    count, slope = pairs(mesh.contact_ratio, mesh.engagement, mesh.overlap_ratio, phase(mesh, motion))
    touching = smooth_step(np.abs(s) / closing)
    force = count * load * np.sign(s) + mesh.d * touching * (mesh.r_b1 * w1 + mesh.r_b2 * w2)
    w = mobility(mesh.inertia1, mesh.r_b1) + mobility(mesh.inertia2, mesh.r_b2)
    at_once, side_by_side = stable_steps(count * stiffness, mesh.d * touching, w)
    change = 0.5 * slope * energy / base_pitch(mesh)  # -dU along the rolling, per way of one base circle
    return {
        "tau1": 0.0 - mesh.r_b1 * (force + change),
        "tau2": 0.0 - mesh.r_b2 * (force - change),
        "s_rel": s,
        "f": force,
        "K": count * stiffness,
        "pairs": count,
        "E": count * energy,
        "step_at_once": at_once,
        "step_side_by_side": side_by_side,
    }


_NARROW = 1e-6
"""Overlap ratio [1] below which the mean over it differs from the middle by less than the round-off of
a difference over it: 1/24 of its square times the curvature, at most 6/width^2.
"""


def pairs(
    contact_ratio: Number, engagement: Number, overlap_ratio: Number, phase: Number
) -> tuple[Number, Number]:
    """Tooth pairs in contact [1] at a phase (...) [1] of the mesh cycle, and their slope in the phase.

    The pairs of a helical mesh are counted in lines of contact over the full width. Each of its
    transverse sections is a spur mesh, see `_section`, and the sections are spread evenly over
    `overlap_ratio` cycles. So the number is the mean of a section's over that length, which keeps its
    mean over a cycle, the contact ratio, and takes from its fluctuation.
    """
    helical = overlap_ratio > _NARROW
    length = np.where(helical, overlap_ratio, 1.0)
    here, slope, _ = _section(contact_ratio, engagement, phase)
    after, _, to = _section(contact_ratio, engagement, phase + 0.5 * length)
    before, _, since = _section(contact_ratio, engagement, phase - 0.5 * length)
    mean = contact_ratio + (to - since) / length
    return np.where(helical, mean, here), np.where(helical, (after - before) / length, slope)


def _section(contact_ratio: Number, engagement: Number, phase: Number) -> tuple[Number, Number, Number]:
    """Tooth pairs in a transverse section [1], their slope, and their integral less that of the mean.

    Of the contact ratio the whole part is always in contact, and one pair more during the rest of the
    cycle, centred at whole phases. It comes and goes by `smooth_step`, centred at the ends of that time, over
    `engagement` times the shorter of the times with and without it. Even in the phase, and the
    contact ratio on average over a cycle.
    """
    least = np.floor(contact_ratio)
    part = contact_ratio - least
    width = engagement * np.minimum(part, 1.0 - part)
    changing = width > 0.0
    length = np.where(changing, width, 1.0)
    away = phase - np.floor(phase + 0.5)
    first = 0.5 + 0.5 * part / length
    place = first - np.abs(away) / length
    share, (slope, _) = smooth_step(place), smooth_step_slopes(place)
    passed = length * (first - 0.5 - smooth_step_integral(place)) - part * np.abs(away)
    return (
        least + np.where(changing, share, 0.0),
        np.where(changing, -np.sign(away) * slope / length, 0.0),
        np.where(changing, np.sign(away) * passed, 0.0),
    )
