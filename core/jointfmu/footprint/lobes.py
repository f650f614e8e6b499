"""Two-lobe pressure on the elliptical cone between flexspline and bearing ring."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..quantity import Number
from .nodes import Footprint

Array = NDArray[np.float64]

_AROUND = np.polynomial.legendre.leggauss(16)
_ALONG = np.polynomial.legendre.leggauss(6)
_CROWDING = 3

PLACES = 1.0 - (0.5 * (1.0 - _AROUND[0])) ** _CROWDING
"""Nodes around [1] on a piece of a lobe from 0 to 1, crowded towards 1: the stiffness falls with a
broken power of the pressure there."""
WEIGHTS = 0.5 * _CROWDING * (0.5 * (1.0 - _AROUND[0])) ** (_CROWDING - 1) * _AROUND[1]
"""Their weights [1], sum 1."""
HEIGHTS, HEIGHT_WEIGHTS = 0.5 * (1.0 + _ALONG[0]), 0.5 * _ALONG[1]
"""Nodes along the contact from 0 to 1 and their weights [1]."""


class Lobe(NamedTuple):
    """One point of the contact: pressure [Pa], position [m], unit normal [1], d theta/d t [1]."""

    pressure: Number
    x: Number
    y: Number
    normal_x: Number
    normal_y: Number
    normal_z: Number
    stretch: Number

    @property
    def along(self) -> Number:
        """Normal part [m] of the displacement by a unit twist about the drive's axis."""
        return self.x * self.normal_y - self.y * self.normal_x

    @property
    def square(self) -> Number:
        """Square [m2] of that displacement."""
        return self.x**2 + self.y**2


def lobe(
    sine_t: Number,
    cosine_t: Number,
    z: Number,
    local: Number,
    *,
    mismatch: Number,
    radius: Number,
    deformation: Number,
    cup: Number,
) -> Lobe:
    """The point at height z [m] whose angle theta from the major axis has sin theta = edge sin t.

    `local` [Pa] is the pressure on the major axis at that height, `edge` the sine at the lobe's edge.
    """
    depth = np.minimum(local, mismatch)
    edge = np.sqrt(depth / mismatch)
    sine = edge * sine_t
    cosine = np.hypot(cosine_t, np.sqrt(1.0 - edge**2) * sine_t)
    w = deformation * (1.0 - z / cup)
    a, b = radius + w, radius - w
    slope = deformation / cup * (cosine**2 - sine**2)
    flat = 1.0 / np.sqrt(1.0 + slope**2)
    across = flat / np.hypot(b * cosine, a * sine)
    return Lobe(
        pressure=(local - depth) + depth * cosine_t**2,
        x=a * cosine,
        y=b * sine,
        normal_x=across * b * cosine,
        normal_y=across * a * sine,
        normal_z=slope * flat,
        stretch=edge * cosine_t / cosine,
    )


def two_lobes(
    peak: Array,
    breaks: Array,
    *,
    mismatch: float,
    radius: float,
    deformation: float,
    length: float,
    cup: float,
) -> Footprint:
    """One quarter of the contact at load cases (...), shares counted for the whole.

    Elastic-foundation contact of the oval wave generator: at the angle theta from the major axis and
    the distance z from the cup's opening

        p = peak (1 - z/cup) - mismatch sin^2(theta), where positive,

    so each lobe widens as it grows. Nodes follow the lobe (sin theta = sin(edge) sin t) and sit
    between the pressures at which the interface law changes its regime, around and along, hence a
    sum over the nodes is smooth in the peak: 16 Gauss-Legendre nodes per regime around, 6 along.

    peak        : (...) [Pa] pressure on the major axis at the opening, > 0
    breaks      : (k) [Pa] pressures at which the law changes its regime
    mismatch    : [Pa] pressure lost from the major to the minor axis
    radius      : [m]  mean radius; deformation: [m] radial deformation w
    length, cup : [m]  axial length of the contact and of the cup that tapers the deformation
    """
    pieces = list(
        lobe_pieces(
            peak, breaks, mismatch=mismatch, radius=radius, deformation=deformation, length=length, cup=cup
        )
    )

    def flat(*parts: Callable[[Piece], Array]) -> Array:
        """Numbers of all nodes (..., n), or vectors of them (..., n, parts)."""
        rows = [np.concatenate([part(piece) for piece in pieces], axis=-1) for part in parts]
        shape = (*np.shape(peak), -1)
        return np.stack([row.reshape(shape) for row in rows], axis=-1)

    return Footprint(
        share=flat(lambda piece: piece.share)[..., 0],
        position=flat(lambda p: p.point.x, lambda p: p.point.y, lambda p: p.spread(p.height)),
        normal=flat(
            lambda p: p.point.normal_x, lambda p: p.point.normal_y, lambda p: p.spread(p.point.normal_z)
        ),
        pressure=flat(lambda piece: piece.point.pressure)[..., 0],
    )


class Piece(NamedTuple):
    """Nodes (..., heights, n) around a lobe between two breaks of the law; shares count for the whole.

    height : (..., heights, 1) [m]; axis: (..., heights, 1) [Pa] pressure on the major axis there
    """

    point: Lobe
    share: Array
    height: Array
    axis: Array

    def spread(self, value: Array) -> Array:
        """The same value at every node."""
        return np.broadcast_to(value, self.share.shape)


def lobe_pieces(
    peak: ArrayLike,
    breaks: Array,
    *,
    mismatch: float,
    radius: float,
    deformation: float,
    length: float,
    cup: float,
) -> Iterator[Piece]:
    """The quadrature of `two_lobes`, from the major axis outward: above the highest break first."""
    peaks = np.asarray(peak, dtype=np.float64)
    z, axial = (column[..., None] for column in heights(peaks, breaks, length, cup))
    axis = peaks[..., None, None] * (1.0 - z / cup)
    limits = piece_ends(axis, breaks, mismatch)
    for i in range(limits.shape[-1] - 1):
        width = np.diff(limits[..., i : i + 2])
        t = limits[..., i : i + 1] + width * PLACES
        point = lobe(
            np.sin(t), np.cos(t), z, axis, mismatch=mismatch, radius=radius, deformation=deformation, cup=cup
        )
        yield Piece(point, 2.0 / np.pi * axial * width * WEIGHTS * point.stretch, z, axis)


def height_at(peak: Number, pressure: Number, length: Number, cup: Number) -> Number:
    """z [m] on the contact at which the major axis has a pressure [Pa]; the nearest end if none."""
    return np.minimum(np.maximum(cup * (1.0 - pressure / peak), 0.0), length)


def angle_at(local: Number, pressure: Number, mismatch: Number) -> Number:
    """t [1] at which a lobe of pressure `local` on its axis has a pressure [Pa]; 0 or pi/2 if none."""
    part = (local - pressure) / np.minimum(local, mismatch)
    return np.arcsin(np.sqrt(np.minimum(np.maximum(part, 0.0), 1.0)))


def heights(peak: Array, breaks: Array, length: float, cup: float) -> tuple[Array, Array]:
    """z (..., n) [m] of the nodes along the contact and their weights [1], sum 1, at peaks (...) [Pa].

    Six per piece between the heights at which the pressure on the major axis passes a break.
    """
    falling = np.sort(np.asarray(breaks, dtype=np.float64))[::-1]
    falling = falling[(falling < np.max(peak)) & (falling > np.min(peak) * (1.0 - length / cup))]
    ends = height_at(np.asarray(peak)[..., None], falling, length, cup)
    edge = np.zeros((*ends.shape[:-1], 1))
    limits = np.concatenate([edge, ends, edge + length], axis=-1)
    width = np.diff(limits)[..., None]
    return _flat(limits[..., :-1, None] + width * HEIGHTS), _flat(width / length * HEIGHT_WEIGHTS)


def piece_ends(local: Array, breaks: Array, mismatch: float) -> Array:
    """t (..., k + 2) from the axis to the edge, 0 to pi/2: where the pressure passes the breaks.

    local : (..., 1) [Pa] pressure on the major axis; pieces that lie above it have no width.
    """
    falling = np.sort(np.asarray(breaks, dtype=np.float64))[::-1]
    ends = angle_at(local, falling, mismatch)
    axis = np.zeros((*ends.shape[:-1], 1))
    return np.concatenate([axis, ends, axis + 0.5 * np.pi], axis=-1)


def _flat(nodes: Array) -> Array:
    """Nodes (..., pieces, n) as (..., pieces n)."""
    return nodes.reshape(*nodes.shape[:-2], -1)
