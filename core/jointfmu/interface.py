"""From nominal pressure to the largest spot to stiffness, damping and real area of an interface."""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .powerlaw import Spots
from .quantity import Number

Array = NDArray[np.float64]

TOLERANCE = 1e-13
"""Relative residual of the load at which the inversion stops [1]."""
RATIOS = ("eta_n", "eta_t", "elastic_fraction")
"""Quantities that are no sums over the area."""
_STEEPEST, _BLOCK, _MAX_STEPS, _SMALLEST = 2.5, 16384, 200, -300.0


class Law(Protocol):
    """An interface law: parameters that give spots and quantities."""

    @property
    def A_0(self) -> float:
        """Nominal area [m2]."""

    @property
    def hardness(self) -> Number:
        """Hardness of the softer body [Pa]."""

    def spots(self) -> Spots:
        """Regimes of one spot and size distribution."""

    def state(self, u: Number) -> dict[str, Number]:
        """Quantities for a largest spot of log-area u."""


def log_area(spots: Spots, v: Number) -> tuple[Number, Number]:
    """Log-area u of the largest spot and du/dv for the unknown v of the inversion.

    With a smallest spot, a_L = a_ref (1 + e^v): u stays positive and exact as the load vanishes.
    """
    if not spots.cutoff:
        return v, 1.0
    return np.logaddexp(0.0, v), 1.0 / (1.0 + np.exp(-v))


def newton_step(spots: Spots, v: Number, log_load: Number) -> tuple[Number, Number, Number, Number]:
    """One safeguarded Newton step in logarithms: (step, lower, upper, residual), all relative to v.

    ln F is monotone in v with a slope between m/2 and 2.5, so every evaluation brackets the root.
    """
    u, stretch = log_area(spots, v)
    value, slope = spots.log_total("load", u)
    residual = log_load - value
    a, b = residual / (0.5 * spots.m), residual / _STEEPEST
    lower, upper = np.minimum(a, b), np.maximum(a, b)
    step = np.minimum(np.maximum(residual / (slope * stretch), lower), upper)
    return step, lower, upper, residual


def largest_spot(law: Law, pressure: ArrayLike) -> Array:
    """Log-area u = ln(a_L/a_ref) [1] of the largest spot under a nominal pressure.

    Parameters
    ----------
    law      : interface law; its parameters may be arrays that broadcast with the pressure
    pressure : (...) [Pa], >= 0 and finite

    Returns
    -------
    u : (...) [1], minus infinity (or 0 with a smallest spot) at zero pressure. The relative residual
        of the load is at most 1e-12; all points are solved at once, in blocks that fit the cache.

    Raises
    ------
    ValueError : a pressure is negative, NaN or infinite
    RuntimeError : the inversion did not converge
    """
    p = np.asarray(pressure, dtype=np.float64)
    bad = ~(np.isfinite(p) & (p >= 0.0))
    if np.any(bad):
        raise ValueError(f"pressure = {p[bad].flat[0]:g} Pa is outside [0, inf): nominal contact pressure")
    spots = checked_spots(law)
    load = p * law.A_0
    parameters = np.shape(spots.log_total("load", 1.0)[0])
    shape = np.broadcast_shapes(load.shape, parameters)
    if load.size > _BLOCK and parameters == ():
        flat = load.ravel()
        parts = [_solve(spots, flat[i : i + _BLOCK]) for i in range(0, flat.size, _BLOCK)]
        return np.concatenate(parts).reshape(shape)
    return _solve(spots, np.broadcast_to(load, shape))


def checked_spots(law: Law) -> Spots:
    """The law's spots, unless their reference area or load over- or underflows (D close to 1).

    Raises ValueError.
    """
    with np.errstate(all="ignore"):
        spots = law.spots()
        value, slope = spots.log_total("load", np.asarray(1.0))
    if not np.all(np.isfinite(value) & np.isfinite(slope) & (spots.reference > 0.0)):
        raise ValueError(
            f"D, G and the material give a critical spot area of {np.max(spots.reference):g} m2: "
            "not representable, D is too close to the end of its interval"
        )
    return spots


def _solve(spots: Spots, load: Array) -> Array:
    empty = load <= 0.0
    target = np.log(np.where(empty, 1.0, load))
    v = np.zeros_like(target)
    low, high = np.full_like(target, -np.inf), np.full_like(target, np.inf)
    for _ in range(_MAX_STEPS):
        step, lower, upper, residual = newton_step(spots, v, target)
        if np.max(np.abs(residual), initial=0.0) <= TOLERANCE:
            break
        low, high = np.maximum(low, v + lower), np.minimum(high, v + upper)
        v = np.minimum(np.maximum(v + step, low), high)
    else:
        if np.max(np.abs(residual)) > 1e-12:
            raise RuntimeError(
                f"the inversion of the pressure stopped at a residual of {np.max(np.abs(residual)):.2g}"
            )
    u, _ = log_area(spots, np.where(empty, -np.inf, v))
    return np.asarray(u, dtype=np.float64)


def evaluate(law: Law, u: Number) -> dict[str, Number]:
    """All quantities of the whole area A_0 at the log-area u, with the spot and the pressure.

    Without load (u minus infinity) sums are zero and ratios have their limit.
    """
    empty = np.isneginf(u)
    state = law.state(np.where(empty, _SMALLEST, u))
    zero = np.where(empty, 0.0, 1.0)
    state = {name: value if name in RATIOS else zero * value for name, value in state.items()}
    spot = law.spots().reference * np.exp(u)
    return {"largest_spot": spot, "pressure": state["F"] / law.A_0, **state}


def at_pressure(law: Law, pressure: ArrayLike) -> dict[str, Number]:
    """All quantities of the whole area A_0 under a nominal pressure (...) [Pa]."""
    return evaluate(law, largest_spot(law, pressure))


def at_largest_spot(law: Law, area: ArrayLike) -> dict[str, Number]:
    """All quantities of the whole area A_0 for a largest spot of the given area (...) [m2].

    The area is the paper's: truncated for Zhao 2018, real for Hu 2023 and Yu 2022.
    """
    a = np.asarray(area, dtype=np.float64)
    spots = checked_spots(law)
    smallest = spots.reference if spots.cutoff else 0.0
    bad = ~(np.isfinite(a) & (a > smallest))
    if np.any(bad):
        low = np.min(smallest)
        raise ValueError(f"largest spot = {a[bad].flat[0]:g} m2 is outside ({low:g}, inf): area of a spot")
    return evaluate(law, np.log(a / spots.reference))


def stiffness_curve(law: Law, pressure: ArrayLike, name: str = "normal") -> tuple[Array, Array]:
    """Stiffness per nominal area k [N/m3] and dk/dp [1/m] at pressures (...) [Pa] > 0.

    The derivative is exact: (dK/du)/(dF/du) of the same integral.
    """
    spots = law.spots()
    u = largest_spot(law, pressure)
    k = spots.total(name, u) / law.A_0
    return k, spots.slope(name, u) / spots.slope("load", u)
