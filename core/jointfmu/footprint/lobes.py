"""Two-lobe pressure on the elliptical cone between flexspline and bearing ring."""

import numpy as np
from numpy.typing import NDArray

from .nodes import Footprint

Array = NDArray[np.float64]

_AROUND = np.polynomial.legendre.leggauss(16)
_ALONG = np.polynomial.legendre.leggauss(6)
_CROWDING = 3


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
    between the pressures at which the interface law changes its regime, hence a sum over the nodes
    is smooth in the peak: 16 Gauss-Legendre nodes per regime around, 6 along.

    peak        : (...) [Pa] pressure on the major axis at the opening, > 0
    breaks      : (k) [Pa] pressures at which the law changes its regime
    mismatch    : [Pa] pressure lost from the major to the minor axis
    radius      : [m]  mean radius; deformation: [m] radial deformation w
    length, cup : [m]  axial length of the contact and of the cup that tapers the deformation
    """
    z = 0.5 * length * (1.0 + _ALONG[0])
    axial = 0.5 * _ALONG[1]
    local = np.asarray(peak, dtype=np.float64)[..., None, None] * (1.0 - z / cup)[:, None]
    depth = np.minimum(local, mismatch)
    edge = np.sqrt(depth / mismatch)
    t, weight = _between(np.arcsin(_sine_at(breaks, local, depth)))
    sine = edge * np.sin(t)
    theta = np.arcsin(sine)
    cosine = np.hypot(np.cos(t), np.sqrt(1.0 - edge**2) * np.sin(t))  # of theta
    stretch = edge * np.cos(t) / cosine  # d theta/d t
    share = 4.0 * axial[:, None] * weight * stretch / (2.0 * np.pi)
    pressure = (local - depth) + depth * np.cos(t) ** 2
    height = np.broadcast_to(z[:, None], theta.shape)
    taper = deformation * (1.0 - height / cup)
    slope = np.arctan(deformation * np.cos(2.0 * theta) / cup)
    position, normal = _ellipse(theta, radius, taper, slope, height)
    shape = (*np.shape(peak), -1)
    return Footprint(
        share=share.reshape(shape),
        position=position.reshape(*shape, 3),
        normal=normal.reshape(*shape, 3),
        pressure=pressure.reshape(shape),
    )


def _sine_at(breaks: Array, local: Array, depth: Array) -> Array:
    """sin t (..., k) where the pressure `local - depth sin^2 t` passes the breaks, within [0, 1]."""
    falling = np.sort(np.asarray(breaks, dtype=np.float64))[::-1]
    return np.sqrt(np.clip((local - falling) / depth, 0.0, 1.0))


def _between(ends: Array) -> tuple[Array, Array]:
    """Nodes and weights (..., n) on [0, pi/2], Gauss-Legendre pieced together at ends (..., k).

    The stiffness falls with a broken power of the pressure, so in each piece the nodes crowd towards
    its end by `1 - (1 - r)^3`.
    """
    edge = np.zeros((*ends.shape[:-1], 1))
    limits = np.concatenate([edge, ends, edge + 0.5 * np.pi], axis=-1)
    rest = 0.5 * (1.0 - _AROUND[0])
    place, weight = 1.0 - rest**_CROWDING, 0.5 * _CROWDING * rest ** (_CROWDING - 1) * _AROUND[1]
    width = np.diff(limits)[..., None]
    shape = (*ends.shape[:-1], -1)
    return (limits[..., :-1, None] + width * place).reshape(shape), (width * weight).reshape(shape)


def _ellipse(theta: Array, radius: float, w: Array, slope: Array, z: Array) -> tuple[Array, Array]:
    """Points and unit normals of the elliptical cone with half axes radius +- w."""
    a, b = radius + w, radius - w
    position = np.stack([a * np.cos(theta), b * np.sin(theta), z], axis=-1)
    tilt = np.arctan2(a * np.sin(theta), b * np.cos(theta))
    flat = np.stack([np.cos(slope) * np.cos(tilt), np.cos(slope) * np.sin(tilt), np.sin(slope)], axis=-1)
    return position, flat
