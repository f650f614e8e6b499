"""Sums over the contact of the bolted joint: its normal side, and shear with and without memory."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...mechanics.footprint.shape import FrictionPatches, PressureDistribution
from ...mechanics.sliders import Foundation
from ...quantity import Array, Number, select


@dataclass(frozen=True, slots=True)
class RelativeDisplacement:
    """Where side 2 is, from the tightened state.

    six : (6) shift s_rel [m] along x, y, z and small turn theta [rad] about them
    """

    components: Array

    @property
    def tangential(self) -> Array:
        """Shift x, y and turn about the normal (3)."""
        return self.components[[0, 1, 5]]

    @property
    def normal(self) -> Array:
        """Shift z and turns about x and y (3)."""
        return self.components[2:5]

    def opening(self, shape: PressureDistribution) -> Array:
        """How far the sides of the nodes are apart (n) [m]."""
        (x, y), (shift, about_x, about_y) = shape.position.T, self.normal
        return np.asarray(shift + about_x * y - about_y * x)


def node_displacement(shape: PressureDistribution, tangential: Array) -> Array:
    """Shift along the surface at the nodes (n, 2) [m] of a shift x, y and a turn about the normal (3)."""
    x, y = shape.position.T
    return np.stack([tangential[0] - tangential[2] * y, tangential[1] + tangential[2] * x], axis=-1)


def patch_displacement(patches: FrictionPatches, tangential: Array) -> Array:
    """The same of patches, and around their centres: (n, 3) [m]."""
    return np.column_stack([node_displacement(patches, tangential), tangential[2] * patches.radius])


def first_moments(shape: PressureDistribution, name: str, value: Array) -> dict[str, Number]:
    """Sum of a value (n) per area, and times x and y."""
    each = shape.share * value
    return {
        name: np.sum(each),
        f"{name}_x": each @ shape.position[:, 0],
        f"{name}_y": each @ shape.position[:, 1],
    }


def second_moments(shape: PressureDistribution, name: str, value: Array) -> dict[str, Number]:
    """Sums of a value (n) per area times y^2 and x^2."""
    each = shape.share * value
    x, y = shape.position.T
    return {f"{name}about_x": each @ y**2, f"{name}about_y": each @ x**2}


MIN_PRESSURE_RATIO = 0.01
"""Pressure over the mean one [1] that counts beside a point's own where its force is shared: of what does not
touch as well."""
BALANCE_ITERATIONS = 100
"""How often the parts are balanced [1], once of all patches and once of those that are kept."""
MIN_TRANSFER_SHARE, MAX_PATCHES_PER_POINT = 0.02, 8
"""Least part of a point that a patch has [1], and to how many patches a point presses at most."""
TRANSFER_DECIMALS = 4
"""Decimals of these parts."""
MAX_SQUARE_DISTANCE_RATIO = 300.0
"""Square distance over the mean one [1] beyond which a patch is as far as any."""


def force_transfer(points: PressureDistribution, patches: FrictionPatches) -> Array:
    """Parts (m, n) [1] of the normal force of points that press on patches: all of it, to the last decimal.

    Each patch has the force that it stands for under equal bolts, each point presses on the patches around
    it: the transport of force from points to patches over a short way (entropic, by Sinkhorn's iteration),
    with the mean square distance of the force from the nearest patch as its width.
    """
    square = np.sum((patches.position[:, None] - points.position) ** 2, axis=2)
    nearest, (force, aim) = (
        np.min(square, axis=0),
        (at.share * (at.preload_shape + MIN_PRESSURE_RATIO) for at in (points, patches)),
    )
    width = force @ nearest / np.sum(force)
    near = np.exp(
        -np.minimum((square - nearest) / np.maximum(width, np.finfo(float).tiny), MAX_SQUARE_DISTANCE_RATIO)
    )
    pull = np.ones_like(aim)
    for _ in range(2):
        for _ in range(BALANCE_ITERATIONS):
            part = pull[:, None] * near
            part = part / np.sum(part, axis=0)
            pull = pull * aim / (part @ force)
        least = np.maximum(np.sort(part, axis=0)[-MAX_PATCHES_PER_POINT:][0], MIN_TRANSFER_SHARE)
        near = np.where((part >= least) | (part == np.max(part, axis=1, keepdims=True)), near, 0.0)
    rounded = np.maximum(np.round(part, TRANSFER_DECIMALS), 10.0**-TRANSFER_DECIMALS)
    return np.asarray(np.where(near > 0.0, rounded, 0.0))


def pressure_transfer(points: PressureDistribution, patches: FrictionPatches) -> Array:
    """Pressure of patches over that of points (m, n) [1], by these parts."""
    return force_transfer(points, patches) * points.share / patches.share[:, None]


_TRACTIONS, _TANGENTS = ("traction_x", "traction_y", "torsion"), ("tangent_x", "tangent_y", "tangent_z")
STICK_TANGENT = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
"""Tangent of sliders that stick, over their stiffness [1]."""


def _unit_displacements(patches: FrictionPatches) -> list[Array]:
    """`shifts` by a shift along x, one along y and a turn about the normal."""
    return [patch_displacement(patches, motion) for motion in np.eye(3)]


def _directional_stiffness(tangent: Array, displacement: Array) -> Array:
    """Stiffness (n) of tangents (n, 6) against motions (n, 3)."""
    (xx, xy, yy, xt, yt, tt), (u, v, w) = tangent.T, displacement.T
    return np.asarray(xx * u**2 + yy * v**2 + tt * w**2 + 2.0 * (xy * u * v + xt * u * w + yt * v * w))


def traction_sums(patches: FrictionPatches, traction: Array) -> dict[str, Number]:
    """Sums of a traction (n, 3) against the shift, see `together`."""
    sums = [patches.share @ np.sum(traction * motion, axis=1) for motion in _unit_displacements(patches)]
    return dict(zip(_TRACTIONS, sums, strict=True))


def tangent_sums(patches: FrictionPatches, tangent: Array) -> dict[str, Number]:
    """Sums of the tangent (n, 6) of a traction, see `Moved`."""
    sums = [
        patches.share @ _directional_stiffness(tangent, motion) for motion in _unit_displacements(patches)
    ]
    return dict(zip(_TANGENTS, sums, strict=True))


def consistent_tangent(
    patches: FrictionPatches, stick_stiffness: Array, tangent: Array, traction: Array
) -> dict[str, Number]:
    """Sums of the stiffness against a further shift along x, along y and a further turn.

    Each is that of the direction in which more slips on: sliders at their limits do where the traction of
    their patch goes along the motion, and stick elsewhere.

    stick    : (n) [Pa/m] of all sliders
    tangent  : (n, 6) [Pa/m] with all sliders at their limits slipping on
    traction : (n, 3) [Pa] against the shift
    """
    less, found = stick_stiffness[:, None] * STICK_TANGENT - tangent, {}
    for name, motion in zip(_TANGENTS, _unit_displacements(patches), strict=True):
        spent, centred = patches.share * _directional_stiffness(less, motion), motion * [1.0, 1.0, 0.0]
        with_it = patches.share * _directional_stiffness(
            less, centred
        )  # around its centre as many slip on either way
        with_it = np.where(np.sum(traction * centred, axis=1) < 0.0, -with_it, with_it)
        stuck = patches.share @ (stick_stiffness * np.sum(motion**2, axis=1))
        found[name] = stuck - 0.5 * (np.sum(spent) + abs(np.sum(with_it)))
    return found


def normal_sums(
    shape: PressureDistribution, added_pressure: Array, added_stiffness: Array, derivatives: list[Array]
) -> dict[str, Number]:
    """Sums of the normal side: pressure and stiffness (n), and what shear adds to them (n) [Pa, Pa/m]."""
    p, k = derivatives[:2]
    x, y = shape.position.T
    return {
        **first_moments(shape, "normal", p + added_pressure),
        "normal_stiffness": shape.share @ (k + added_stiffness),
        **second_moments(shape, "normal_", k + added_stiffness),
        "pressure": shape.share @ p,
        **first_moments(shape, "stiffness", k),
        **second_moments(shape, "", k),
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
    per = select(carries, t / select(carries, limit, 1.0), 0.0 * t) ** 2
    R = np.sqrt(1.0 + per * square)
    secant, turn = select(carries, t / R, 0.0 * t), per / (R * R)
    g = select(carries, square / (R * (1.0 + R)), 0.0 * square)
    slope = -g * g * per * (1.0 + 2.0 * R) / R * select(touches, bend / select(touches, k, 1.0), 0.0 * k)
    return (
        secant * u_x,
        secant * u_y,
        secant * (1.0 - turn * u_x * u_x),
        -secant * turn * u_x * u_y,
        secant * (1.0 - turn * u_y * u_y),
        rho * bend * g,
        rho * (twist * g + bend * slope),
    )


def cycle_sums(foundation: Foundation, share: Array, approach: Array, amplitude: Array) -> dict[str, Number]:
    """Sums of `Foundation.loop` over amplitudes (n) [m] at approaches (n) [m]."""
    loss, stored = foundation.cycle_energies(approach, amplitude)
    return {"loop_work": share @ loss, "loop_energy": share @ stored}
