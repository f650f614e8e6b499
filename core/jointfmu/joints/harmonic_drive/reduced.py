"""Repeats `spring.torque_curve` for many samples at once: K_WTS and wind-up along a torque ramp.

The law is evaluated at a few pressures per sample: HEIGHTS x AROUND points of the lobe, for some peak
pressures between which log K_TS is a polynomial in the log of the peak.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as series
from numpy.typing import NDArray
from scipy.special import roots_jacobi

from ...batch import chebyshev
from ...batch.samples import columns
from ...interface import largest_spot
from ..reduced import Reduced
from . import KIND
from .law import HarmonicDrive, contact_length, in_series, lobe_point, local, peak_pressure
from .spring import HarmonicDriveSpring

Array = NDArray[np.float64]

AROUND, HEIGHTS = 8, 2
"""Points of the lobe around and along [1]."""
RAMP = 25
"""Torques [1] between which K_WTS is a polynomial in asinh(T/T_s)."""
_POWER = 0.57
"""The stiffness grows about like this power of the pressure; what is left is a smooth factor."""


def _around(count: int) -> tuple[Array, Array]:
    """cos t (count) of the points around and their weights of `dt`, for the lobe's pressure ~ cos^2 t.

    With q = cos^2 t the sum over the lobe is an integral of k(q) dq/(2 sqrt(1 - q)) with k ~ q^POWER:
    Gauss-Jacobi.
    """
    x, weights = roots_jacobi(count, -0.5, _POWER)
    q = 0.5 * (1.0 + x)
    return np.sqrt(q), weights / 2.0 ** (_POWER + 1.5) / q ** (_POWER + 0.5)


_COSINE, _WEIGHTS = _around(AROUND)
_ALONG = np.polynomial.legendre.leggauss(HEIGHTS)


def pair_stiffness(drive: HarmonicDrive, peak: Array) -> Array:
    """K_TS (n, k) [N.m/rad] on the paper's scale at peak pressures (n, k) [Pa]; parameters (n, 1, 1, 1)."""
    peak = peak[:, :, None, None]
    z = contact_length(drive) * 0.5 * (1.0 + _ALONG[0][:, None])
    axis = local(drive, peak, z)
    point = lobe_point(drive, np.sqrt(1.0 - _COSINE**2), _COSINE, z, axis)
    spots, u = drive.law.spots(), largest_spot(drive.law, point.pressure)
    share = 0.5 * _ALONG[1][:, None] * 2.0 / np.pi * _WEIGHTS * point.stretch
    along = point.along**2
    each = spots.total("normal", u) * along + spots.total("tangential", u) * (point.square - along)
    pair = drive.pair_scale * np.sum(share * each, axis=(2, 3), keepdims=True)
    return np.asarray(pair[:, :, 0, 0])


def evaluate(values: Mapping[str, Any], loads: Array, factor: Array) -> dict[str, Array]:
    """K_WTS [N.m/rad] and phi_rel [rad] (n, m) at the torques factor (n, 1) times loads (m) [N.m].

    values : by structured name, numbers or samples (n)
    """
    drive, deep = columns(HarmonicDrive, values, 1), columns(HarmonicDrive, values, 3)
    smoothing = float(np.median(drive.torque_smoothing))
    xi = np.arcsinh(loads / smoothing)
    span = xi[-1] * chebyshev.nodes(RAMP)
    rate = smoothing * xi[-1] * np.cosh(span)
    peak = np.asarray(peak_pressure(drive, factor * smoothing * np.sinh(span))[0])
    pair = _between(deep, peak)
    K = np.broadcast_to(in_series(drive, pair, 0.0)[0], (factor.size, RAMP))
    return {
        "K_WTS": K @ chebyshev.interpolation(RAMP, xi / xi[-1]),
        "phi_rel": factor * ((rate / K) @ chebyshev.integration(RAMP, xi / xi[-1])),
    }


def _between(deep: HarmonicDrive, peak: Array) -> Array:
    """`pair_stiffness` at ascending peak pressures (n, k) [Pa], log-polynomials through a few of them."""
    low = np.log(peak[:, :1])
    span = np.log(peak[:, -1:]) - low
    count = int(np.clip(np.ceil(4.0 + 1.5 * np.max(span)), 5, 20))
    logs = np.log(pair_stiffness(deep, np.exp(low + span * chebyshev.nodes(count))))
    where = np.clip(2.0 * (np.log(peak) - low) / span - 1.0, -1.0, 1.0)
    return np.asarray(
        np.exp(series.chebval(where, (logs @ chebyshev.coefficients(count)).T[:, :, None], False))
    )


def exact(joint: HarmonicDrive, loads: Array) -> dict[str, Array]:
    """K_WTS and phi_rel (m) of the exported spring at torques (m) [N.m]."""
    state = HarmonicDriveSpring.of(joint).windup(loads)
    return {name: state[name] for name in REDUCED.units}


REDUCED = Reduced(
    load=KIND.variables["tau"],
    outputs=tuple(KIND.variables[name] for name in ("K_WTS", "phi_rel")),
    to=lambda drive: float(drive.rated_torque),
    most=lambda drive: drive.max_torque,
    evaluate=evaluate,
    exact=exact,
)
