"""Sums over the contact of the bolted joint: its normal side, and shear with and without memory."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...mechanics.footprint.shape import FrictionPatches, PressureShape
from ...mechanics.sliders import Foundation
from ...quantity import Array, Number, where


@dataclass(frozen=True, slots=True)
class Place:
    """Where side 2 is, from the tightened state.

    six : (6) shift s_rel [m] along x, y, z and small turn theta [rad] about them
    """

    six: Array

    @property
    def rigid(self) -> Array:
        """Shift x, y and turn about the normal (3)."""
        return self.six[[0, 1, 5]]

    @property
    def normal(self) -> Array:
        """Shift z and turns about x and y (3)."""
        return self.six[2:5]

    def apart(self, shape: PressureShape) -> Array:
        """How far the sides of the nodes are apart (n) [m]."""
        (x, y), (shift, about_x, about_y) = shape.position.T, self.normal
        return np.asarray(shift + about_x * y - about_y * x)


def along(shape: PressureShape, rigid: Array) -> Array:
    """Shift along the surface at the nodes (n, 2) [m] of a shift x, y and a turn about the normal (3)."""
    x, y = shape.position.T
    return np.stack([rigid[0] - rigid[2] * y, rigid[1] + rigid[2] * x], axis=-1)


def shifts(patches: FrictionPatches, rigid: Array) -> Array:
    """The same of patches, and around their centres: (n, 3) [m]."""
    return np.column_stack([along(patches, rigid), rigid[2] * patches.radius])


def over_plane(shape: PressureShape, name: str, value: Array) -> dict[str, Number]:
    """Sum of a value (n) per area, and times x and y."""
    each = shape.share * value
    return {
        name: np.sum(each),
        f"{name}_x": each @ shape.position[:, 0],
        f"{name}_y": each @ shape.position[:, 1],
    }


def about(shape: PressureShape, name: str, value: Array) -> dict[str, Number]:
    """Sums of a value (n) per area times y^2 and x^2."""
    each = shape.share * value
    x, y = shape.position.T
    return {f"{name}about_x": each @ y**2, f"{name}about_y": each @ x**2}


IDLE = 0.01
"""Pressure over the mean one [1] that counts beside a point's own where its force is shared: of what does not
touch as well."""
ROUNDS = 100
"""How often the parts are balanced [1], once of all patches and once of those that are kept."""
LEAST_PART, MOST_PARTS = 0.02, 8
"""Least part of a point that a patch has [1], and to how many patches a point presses at most."""
PART_DIGITS = 4
"""Decimals of these parts."""
FAR = 300.0
"""Square distance over the mean one [1] beyond which a patch is as far as any."""


def parts(points: PressureShape, patches: FrictionPatches) -> Array:
    """Parts (m, n) [1] of the normal force of points that press on patches: all of it, to the last decimal.

    Each patch has the force that it stands for under equal bolts, each point presses on the patches around
    it: the transport of force from points to patches over a short way (entropic, by Sinkhorn's iteration),
    with the mean square distance of the force from the nearest patch as its width.
    """
    square = np.sum((patches.position[:, None] - points.position) ** 2, axis=2)
    nearest, (force, aim) = np.min(square, axis=0), (at.share * (at.equal + IDLE) for at in (points, patches))
    width = force @ nearest / np.sum(force)
    near = np.exp(-np.minimum((square - nearest) / np.maximum(width, np.finfo(float).tiny), FAR))
    pull = np.ones_like(aim)
    for _ in range(2):
        for _ in range(ROUNDS):
            part = pull[:, None] * near
            part = part / np.sum(part, axis=0)
            pull = pull * aim / (part @ force)
        least = np.maximum(np.sort(part, axis=0)[-MOST_PARTS:][0], LEAST_PART)
        near = np.where((part >= least) | (part == np.max(part, axis=1, keepdims=True)), near, 0.0)
    rounded = np.maximum(np.round(part, PART_DIGITS), 10.0**-PART_DIGITS)
    return np.asarray(np.where(near > 0.0, rounded, 0.0))


def pressing(points: PressureShape, patches: FrictionPatches) -> Array:
    """Pressure of patches over that of points (m, n) [1], by these parts."""
    return parts(points, patches) * points.share / patches.share[:, None]


_TRACTIONS, _TANGENTS = ("traction_x", "traction_y", "torsion"), ("tangent_x", "tangent_y", "tangent_z")
STICKS = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
"""Tangent of sliders that stick, over their stiffness [1]."""


def _motions(patches: FrictionPatches) -> list[Array]:
    """`shifts` by a shift along x, one along y and a turn about the normal."""
    return [shifts(patches, motion) for motion in np.eye(3)]


def _along(tangent: Array, motion: Array) -> Array:
    """Stiffness (n) of tangents (n, 6) against motions (n, 3)."""
    (xx, xy, yy, xt, yt, tt), (u, v, w) = tangent.T, motion.T
    return np.asarray(xx * u**2 + yy * v**2 + tt * w**2 + 2.0 * (xy * u * v + xt * u * w + yt * v * w))


def traction_sums(patches: FrictionPatches, traction: Array) -> dict[str, Number]:
    """Sums of a traction (n, 3) against the shift, see `together`."""
    sums = [patches.share @ np.sum(traction * motion, axis=1) for motion in _motions(patches)]
    return dict(zip(_TRACTIONS, sums, strict=True))


def tangent_sums(patches: FrictionPatches, tangent: Array) -> dict[str, Number]:
    """Sums of the tangent (n, 6) of a traction, see `Moved`."""
    sums = [patches.share @ _along(tangent, motion) for motion in _motions(patches)]
    return dict(zip(_TANGENTS, sums, strict=True))


def further_tangent(
    patches: FrictionPatches, stick: Array, tangent: Array, traction: Array
) -> dict[str, Number]:
    """Sums of the stiffness against a further shift along x, along y and a further turn.

    Each is that of the direction in which more slips on: sliders at their limits do where the traction of
    their patch goes along the motion, and stick elsewhere.

    stick    : (n) [Pa/m] of all sliders
    tangent  : (n, 6) [Pa/m] with all sliders at their limits slipping on
    traction : (n, 3) [Pa] against the shift
    """
    less, found = stick[:, None] * STICKS - tangent, {}
    for name, motion in zip(_TANGENTS, _motions(patches), strict=True):
        spent, centred = patches.share * _along(less, motion), motion * [1.0, 1.0, 0.0]
        with_it = patches.share * _along(less, centred)  # around its centre as many slip on either way
        with_it = np.where(np.sum(traction * centred, axis=1) < 0.0, -with_it, with_it)
        stuck = patches.share @ (stick * np.sum(motion**2, axis=1))
        found[name] = stuck - 0.5 * (np.sum(spent) + abs(np.sum(with_it)))
    return found


def normal_sums(
    shape: PressureShape, lifted: Array, stiffer: Array, derivatives: list[Array]
) -> dict[str, Number]:
    """Sums of the normal side: pressure and stiffness (n), and what shear adds to them (n) [Pa, Pa/m]."""
    p, k = derivatives[:2]
    x, y = shape.position.T
    return {
        **over_plane(shape, "normal", p + lifted),
        "normal_stiffness": shape.share @ (k + stiffer),
        **about(shape, "normal_", k + stiffer),
        "pressure": shape.share @ p,
        **over_plane(shape, "stiffness", k),
        **about(shape, "", k),
        "about_xy": (shape.share * k) @ (x * y),
    }


def elastic_shear(
    limit: Number, rho: Number, derivatives: Sequence[Number], u_x: Number, u_y: Number
) -> tuple[Number, ...]:
    """Shear of a node without memory, from the potential per area

        S = t u^2/(1 + R),    R = sqrt(1 + (t u/l)^2),    t = rho k.

    limit       : l [Pa], mu times the pressure at tightening: the traction t u/R grows to it
    derivatives : pressure [Pa] over the approach and its first three derivatives; k is the first
    u_x, u_y    : [m] shift

    Returned are the traction along x and y [Pa], its derivatives xx, xy, yy in the shift [Pa/m], and what
    shear adds to the normal traction [Pa], rho k' u^2/(R (1 + R)) <= l^2 k'/(rho k^2), and stiffness [Pa/m].
    """
    _, k, bend, twist = derivatives
    carries, touches = limit > 0.0, k > 0.0
    t, square = rho * k, u_x * u_x + u_y * u_y
    per = where(carries, t / where(carries, limit, 1.0), 0.0 * t) ** 2
    R = np.sqrt(1.0 + per * square)
    secant, turn = where(carries, t / R, 0.0 * t), per / (R * R)
    g = where(carries, square / (R * (1.0 + R)), 0.0 * square)
    slope = -g * g * per * (1.0 + 2.0 * R) / R * where(touches, bend / where(touches, k, 1.0), 0.0 * k)
    return (
        secant * u_x,
        secant * u_y,
        secant * (1.0 - turn * u_x * u_x),
        -secant * turn * u_x * u_y,
        secant * (1.0 - turn * u_y * u_y),
        rho * bend * g,
        rho * (twist * g + bend * slope),
    )


def loop_sums(foundation: Foundation, share: Array, approach: Array, size: Array) -> dict[str, Number]:
    """Sums of `Foundation.loop` over amplitudes (n) [m] at approaches (n) [m]."""
    loss, stored = foundation.loop(approach, size)
    return {"loop_work": share @ loss, "loop_energy": share @ stored}
