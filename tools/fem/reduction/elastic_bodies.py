"""Both bodies of a joint between their attachments, reduced to the modes that friction and opening need.

The modes are the deformations that the `states` of the joint need most, by their energy (proper orthogonal
decomposition). What a mode does at a point of the joint is its mean over the point's cell, by the stiffness
there. Few points miss what it does inside the cells; their means are changed in common, so that the tightened
interface is as stiff against all modes as that of the finite elements. At the patches they are then fitted to
the work of friction (`patch_work`).
"""

from typing import Any

import numpy as np
import scipy.linalg as la

from jointfmu.joints.bolted_joint.bodies import DIGITS, MODES, ElasticBodies
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.quantity import Array

from ..whole_joint import AXES, Linear
from .patch_work import (
    LinearContact,
    PatchWork,
    Shears,
    Surface,
    into_slip,
    moved,
    on_circles,
    rigid_shifts,
    stiffness,
    turned,
    work_of,
)
from .states import cell_means, closed_by, states

LEAST = 1e-3
"""Amplitude of the least mode over that of the largest [1], of states with as much energy each."""
OPENING = 0.5
"""Amplitude of states that open the contact, over that of those that shear it alone [1], where modes are
found: the loss in partial slip needs finer ones."""
STIFFNESS_DIGITS = 6
"""Digits of the stiffness of a mode [1]: more than those of what it moves, fewer than processors agree in."""
GAIN = 10.0
"""Most by which what a mode does at the points is changed [1]."""


def elastic_bodies(linear: Linear, spring: BoltedJointSpring, normal: Array, preload: float) -> ElasticBodies:
    """The bodies' modes at the points, patches and bolts of a joint under a preload [N] of each bolt.

    linear : by finite elements
    normal : (q) [Pa/m] stiffness of the tightened interface at the points of the finite elements

    Raises RuntimeError if a body can move freely.
    """
    joint = linear.joint
    at = joint.interface
    bolts = joint.bolts - at.centroid
    motions, deformed = states(linear, spring, normal, preload)
    fields = _modes(linear, deformed, motions)
    stretch = joint.stretch.T @ fields
    patches = spring.patches
    start = spring.tightened(preload, 0.0)
    tight, few = spring.curve.derivatives(start, 1)[1], spring.pressed(start)
    ratio = spring.foundation().ratio
    shear = ratio * spring.curve.derivatives(few, 1)[1]
    x, y = patches.position.T
    traces = [joint.apart(axis) @ fields for axis in AXES]
    area, weight = at.area * normal, spring.joint.A_0
    opening = _matched(
        cell_means(joint, spring.shape.position, normal) @ traces[2],
        _planes(spring.shape.position),
        weight * spring.shape.share * tight,
        _planes(at.centred),
        traces[2],
        area,
    )
    slip = into_slip(motions)
    bent = -(deformed @ slip.T)
    shears = Shears((slip @ motions)[:, (0, 1, 5)], (fields.T @ (linear.bodies @ bent)).T)
    law, closed = spring.foundation(), closed_by(spring, normal)
    every, along = Surface(at.area, closed, rigid_shifts(at.centred)), np.concatenate(traces[:2])
    aim = work_of(law, shears, every, along)
    means = cell_means(joint, patches.position, normal)
    both = _matched(
        np.concatenate([means @ traces[0], means @ traces[1]]),
        rigid_shifts(patches.position),
        np.tile(weight * patches.share * shear, 2),
        every.rigid,
        along,
        np.tile(ratio * area, 2),
    )
    turns = turned(at.centred, patches, means, traces)
    unit = Shears(np.eye(6)[:, (0, 1, 5)], ((linear.bodies @ (linear.moved - linear.rigid)).T @ fields))
    tightened = LinearContact(
        unit, stiffness(moved(law, unit, every, along)[1], at.area), linear.stiffness.diagonal()
    )
    both = PatchWork(law, shears, *on_circles(patches, weight, few, turns), aim, tightened).fitted(both)
    moves = {"opening": opening, "stretch": stretch}
    moves |= dict(zip(("patch_x", "patch_y"), np.split(both, 2), strict=True))
    moves["patch_around"] = patches.radius[:, None] * turns
    most, listed = _rounded(moves)
    places = {"x": x, "y": y, "bolt_x": bolts[:, 0], "bolt_y": bolts[:, 1]}
    listed |= {name: _listed(each) for name, each in places.items()}
    stiffness_of_each = tuple(float(f"{each:.{STIFFNESS_DIGITS}g}") for each in 1.0 / most**2)
    return ElasticBodies(stiffness=stiffness_of_each, **listed)


def _rounded(moves: dict[str, Array]) -> tuple[Array, dict[str, Any]]:
    """The most (k) that each mode moves, and what it moves over it, rounded: the first that is most is 1, as
    a mode and its opposite are alike, and a processor's last bits would choose between them."""
    most = np.max(np.abs(np.concatenate(list(moves.values()))), axis=0)
    rounded = {name: np.round(rows / most, DIGITS) for name, rows in moves.items()}
    every = np.concatenate(list(rounded.values()))
    first = np.argmax(np.abs(every), axis=0)
    sign = np.sign(every[first, np.arange(len(first))])
    return most, {name: _listed((sign * rows).ravel()) for name, rows in rounded.items()}


def _listed(values: Array) -> tuple[float, ...]:
    return tuple((values + 0.0).tolist())


def _modes(linear: Linear, states: Array, motions: Array) -> Array:
    """Displacements (n, k) of unit energy: those of the linear joint, and what states (n, s) need most, which
    moved by (s, 6) [m, rad]."""
    first = _unit(_of_unit_energy(linear.moved - linear.rigid, linear), linear)
    states = _of_unit_energy(states, linear)
    for _ in range(2):  # twice is enough
        states = states - first @ (first.T @ (linear.bodies @ states))
    weight = np.where(np.any(motions[:, 2:5], axis=1), OPENING, 1.0)
    rest = _unit(weight * states, linear)[:, : MODES - first.shape[1]]
    return np.concatenate([first, rest], axis=1)


def _of_unit_energy(fields: Array, linear: Linear) -> Array:
    """Displacements (n, s) [m] over the root of twice their energy."""
    return np.asarray(fields / np.sqrt(np.sum(fields * (linear.bodies @ fields), axis=0)))


def _unit(fields: Array, linear: Linear) -> Array:
    """Displacements (n, k) of unit energy norm that span fields (n, s), those that they need most first."""
    energy, vectors = np.linalg.eigh(fields.T @ (linear.bodies @ fields))
    energy, vectors = energy[::-1], vectors[:, ::-1]
    count = int(np.sum(energy > LEAST**2 * energy[0]))
    return np.asarray(fields @ (vectors[:, :count] / np.sqrt(energy[:count])))


def _planes(place: Array) -> Array:
    """Openings (n, 3) of places (n, 2) under motions without deformation."""
    x, y = place.T
    return np.stack([np.ones_like(x), y, -x], axis=1)


def _matched(
    means: Array, rigid: Array, weight: Array, all_rigid: Array, trace: Array, springs: Array
) -> Array:
    """Means (n, k) of modes, changed in common: springs of weight (n) [N/m] become as stiff as all springs.

    rigid     : (n, 3) motion of the points without deformation; all_rigid (q, 3) of all springs
    trace     : (q, k) motion of all springs by the modes, which have a stiffness (q) [N/m]
    """
    along = np.linalg.solve(rigid.T @ (weight[:, None] * rigid), rigid.T @ (weight[:, None] * means))
    given = np.linalg.solve(
        all_rigid.T @ (springs[:, None] * all_rigid), all_rigid.T @ (springs[:, None] * trace)
    )
    rest, bent = means - rigid @ along, trace - all_rigid @ given
    target = bent.T @ (springs[:, None] * bent)
    target += 1e-6 * np.trace(target) / len(target) * np.eye(len(target))
    has, vectors = la.eigh(rest.T @ (weight[:, None] * rest), target)
    gain = np.minimum(1.0 / np.sqrt(np.maximum(has, GAIN**-2)), GAIN)
    return np.asarray(rigid @ given + rest @ (vectors * gain) @ vectors.T @ target)
