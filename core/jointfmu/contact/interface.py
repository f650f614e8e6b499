"""From nominal pressure to the largest spot to stiffness, damping and real area of an interface."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from ..quantity import Array, Number
from .powerlaw import Spots

TOLERANCE = 1e-13
"""Relative residual of the load at which the inversion stops [1]."""
RATIOS = ("eta_n", "eta_t", "elastic_fraction")
"""Quantities that are no sums over the area."""
LEAST, MOST = -600.0, 300.0
"""Log-areas [1] between which the laws are evaluated: 260 decades of area below the reference, 130 above."""
NOTHING = 1e-200
"""Pressure [Pa] below which there is no load."""
FLATTEST, STEEPEST = 0.5, 2.5
"""Bounds of the slope of ln F over u [1]; the first in units of m."""
CLOSE = 1e-8
"""Relative residual or step [1] from which one more Newton step reaches round-off."""
MOST_STEPS = 200
"""Steps of an inversion [1], far beyond what any takes."""
SIDE = 1e-9
"""Where a regime ends its derivative is taken this far inside, in log-area [1]."""
_NOT_REPRESENTABLE = (
    "the parameters give a reference area of {} m2 or a load that is not representable; "
    "is D close to the end of its interval, or G, h or another one extreme?"
)
_BLOCK = 16384


class InterfaceLaw(Protocol):
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


@runtime_checkable
class Bounded(Protocol):
    """A law whose range of pressures was set by a proof."""

    def unproven(self, least: float, most: float) -> list[str]:
        """What pressures [Pa] from the least to the most leave of the range, one line each."""


def newton_step(spots: Spots, u: Number, log_load: Number) -> tuple[Number, Number, Number, Number]:
    """One safeguarded Newton step in logarithms: (step, lower, upper, residual), all relative to u.

    ln F is monotone in u with a slope between FLATTEST m and STEEPEST, so every evaluation brackets the root.
    """
    value, slope = spots.log_total("load", u)
    residual = log_load - value
    a, b = residual / (FLATTEST * spots.m), residual / STEEPEST
    lower, upper = np.minimum(a, b), np.maximum(a, b)
    step = np.minimum(np.maximum(residual / slope, lower), upper)
    return step, lower, upper, residual


def largest_spot(law: InterfaceLaw, pressure: ArrayLike) -> Array:
    """Log-area u = ln(a_L/a_ref) [1] of the largest spot under a nominal pressure.

    Parameters
    ----------
    law      : interface law; its parameters may be arrays that broadcast with the pressure
    pressure : (...) [Pa], >= 0 and finite

    Returns
    -------
    u : (...) [1], minus infinity at zero pressure. The relative residual of the load is at most
        1e-12; all points are solved at once, in blocks that fit the cache.

    Raises
    ------
    ValueError : a pressure is negative, NaN, infinite, or its largest spot is not representable
    RuntimeError : the inversion did not converge
    """
    p = np.asarray(pressure, dtype=np.float64)
    bad = ~(np.isfinite(p) & (p >= 0.0))
    if np.any(bad):
        raise ValueError(f"pressure = {p[bad].flat[0]:g} Pa is outside [0, inf): nominal contact pressure")
    spots, (least, _, most) = _checked(law)
    load = np.where(p < NOTHING, 0.0, p) * law.A_0
    if np.any(bad := (load > most) | ((load > 0.0) & (load < least))):
        raise ValueError(
            f"pressure = {np.broadcast_to(p, bad.shape)[bad].flat[0]:g} Pa is outside "
            f"[{np.max(least / law.A_0):.3g}, {np.min(most / law.A_0):.3g}]: its largest spot is not "
            f"representable beside the critical area {np.max(spots.reference):.3g} m2 of this surface"
        )
    parameters = np.shape(least)
    shape = np.broadcast_shapes(load.shape, parameters)
    if load.size > _BLOCK and parameters == ():
        flat = load.ravel()
        parts = [_solve(spots, flat[i : i + _BLOCK]) for i in range(0, flat.size, _BLOCK)]
        return np.concatenate(parts).reshape(shape)
    return _solve(spots, np.broadcast_to(load, shape))


def checked_spots(law: InterfaceLaw) -> Spots:
    """The law's spots, unless their reference area or load over- or underflows (D close to 1).

    Raises ValueError.
    """
    return _checked(law)[0]


def _checked(law: InterfaceLaw) -> tuple[Spots, list[Number]]:
    """The same, and the loads [N] at the log-areas LEAST, 0 and MOST."""
    ends = (LEAST, 0.0, MOST)
    with np.errstate(all="ignore"):
        try:
            spots = law.spots()
        except (OverflowError, ZeroDivisionError):
            raise ValueError(_NOT_REPRESENTABLE.format("inf")) from None
        logs = [spots.log_total("load", u) for u in ends]
        loads = [np.exp(log) for log, _ in logs]
        values = [*loads, *(x for log in logs for x in log), *(np.exp(spots.m * u) for u in ends)]
        representable = np.all([np.all(np.isfinite(x)) for x in values])
        positive = np.all((spots.reference > 0.0) & np.isfinite(1.0 / spots.reference))
    if not (representable and positive):
        raise ValueError(_NOT_REPRESENTABLE.format(f"{np.max(spots.reference):g}"))
    return spots, loads


def _solve(spots: Spots, load: Array) -> Array:
    empty = load <= 0.0
    target = np.log(np.where(empty, 1.0, load))
    u = np.zeros_like(target)
    low, high = np.full_like(target, -np.inf), np.full_like(target, np.inf)
    for _ in range(MOST_STEPS):
        step, lower, upper, residual = newton_step(spots, u, target)
        if np.max(np.abs(residual), initial=0.0) <= TOLERANCE:
            break
        low, high = np.maximum(low, u + lower), np.minimum(high, u + upper)
        u = np.minimum(np.maximum(u + step, low), high)
    else:
        if np.max(np.abs(residual)) > 1e-12:
            raise RuntimeError(
                f"the inversion of the pressure stopped at a residual of {np.max(np.abs(residual)):.2g}"
            )
    return np.where(empty, -np.inf, u)


def evaluate(law: InterfaceLaw, u: Number) -> dict[str, Number]:
    """All quantities of the whole area A_0 at the log-area u, with the spot and the pressure.

    Without load (u minus infinity) sums are zero and ratios have their limit.
    """
    empty = np.isneginf(u)
    state = law.state(np.where(empty, LEAST, u))
    zero = np.where(empty, 0.0, 1.0)
    state = {name: value if name in RATIOS else zero * value for name, value in state.items()}
    spots = law.spots()
    spot = spots.reference * np.exp(u) if spots.sized else np.nan * u
    return {"largest_spot": spot, "pressure": state["F"] / law.A_0, **state}


def at_pressure(law: InterfaceLaw, pressure: ArrayLike) -> dict[str, Number]:
    """All quantities of the whole area A_0 under a nominal pressure (...) [Pa]."""
    return evaluate(law, largest_spot(law, pressure))


def at_largest_spot(law: InterfaceLaw, area: ArrayLike) -> dict[str, Number]:
    """All quantities of the whole area A_0 for a largest spot of the given area (...) [m2].

    The area is the paper's: truncated for Zhao 2018, real for Hu 2023 and Yu 2022.
    """
    a = np.asarray(area, dtype=np.float64)
    spots = checked_spots(law)
    if not spots.sized:
        raise ValueError("the law knows no largest spot; expected a pressure")
    bad = ~(np.isfinite(a) & (a > 0.0))
    if np.any(bad):
        raise ValueError(f"largest spot = {a[bad].flat[0]:g} m2 is outside (0, inf): area of a spot")
    u = np.log(a) - np.log(spots.reference)
    if np.any(bad := (u < LEAST) | (u > MOST)):
        raise ValueError(
            f"largest spot = {np.broadcast_to(a, bad.shape)[bad].flat[0]:g} m2 is not representable beside "
            f"the critical area {np.max(spots.reference):g} m2, allowed are 260 decades below to 130 above"
        )
    return evaluate(law, u)


def stiffness_curve(law: InterfaceLaw, pressure: ArrayLike, name: str = "normal") -> tuple[Array, Array]:
    """Stiffness per nominal area k [N/m3] and dk/dp [1/m] at pressures (...) [Pa] > 0.

    The derivative is exact: (dK/du)/(dF/du) of the same integral.
    """
    spots = law.spots()
    u = largest_spot(law, pressure)
    k = spots.total(name, u) / law.A_0
    return k, spots.slope(name, u) / spots.slope("load", u)


def beyond(law: InterfaceLaw, pressure: float, least: float | None = None) -> list[str]:
    """What a law no longer means at a nominal pressure [Pa], one line each with its limit; mostly nothing.

    least : [Pa] where a law is not proven for too small a load; None: as the pressure

    Above the hardness of the softer body the contact yields as a whole; a real area beyond the nominal one
    says that the spots have run into each other. The numbers there are extrapolations.
    """
    found = []
    hardness = float(law.hardness)
    if pressure > hardness:
        found.append(
            f"a pressure of {pressure:.4g} Pa is above the hardness of the softer body, {hardness:.4g} Pa, "
            "where the interface law ends: the contact yields as a whole, the numbers are an extrapolation"
        )
    limit = _full_contact(law, pressure)
    if limit is not None:
        found.append(
            f"a pressure of {pressure:.4g} Pa gives a real area beyond the nominal one, {law.A_0:.4g} m2, "
            f"which the interface law reaches at {limit:.3g} Pa"
        )
    if isinstance(law, Bounded):
        found += law.unproven(pressure if least is None else least, pressure)
    return found


def _full_contact(law: InterfaceLaw, pressure: float) -> float | None:
    """Pressure [Pa] at which the real area is A_0; None if it is less at the given one."""
    with np.errstate(over="ignore"):
        if not float(at_pressure(law, pressure)["A_r"]) > law.A_0:
            return None
        below = np.geomspace(1e-6 * pressure, pressure, 400)
        area = at_pressure(law, below)["A_r"]
    return float(np.exp(np.interp(np.log(law.A_0), np.log(area), np.log(below))))
