"""Evaluation of interface laws: stiffness, damping and real area at a nominal pressure or largest spot."""

from abc import ABC, abstractmethod
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from ..quantity import Array, Number
from .powerlaw import SpotDistribution

RELATIVE_LOAD_TOLERANCE = 1e-13
"""Relative residual of the load at which the inversion stops [1]."""
DIMENSIONLESS_QUANTITY_NAMES = ("eta_n", "eta_t", "elastic_fraction")
"""Names of the contact quantities that are ratios [1]; all others are sums over the nominal area."""
MIN_LOG_AREA, MAX_LOG_AREA = -600.0, 300.0
"""Range of u = ln(area of the largest spot/reference area) [1] in which laws are evaluated: 260 decades below
the reference area, 130 above."""
MIN_PRESSURE = 1e-200
"""Pressure [Pa] below which the load counts as zero."""
MIN_LOG_LOAD_SLOPE, MAX_LOG_LOAD_SLOPE = 0.5, 2.5
"""Bounds of d(ln F)/du [1] used in the inversion; the lower one is divided by m."""
NEWTON_TOLERANCE = 1e-8
"""Relative residual or step [1] below which one more Newton step reaches round-off."""
MAX_INVERSION_ITERATIONS = 200
"""Largest number of iterations of an inversion [1], far above the usual number."""
ONE_SIDED_DERIVATIVE_OFFSET = 1e-9
"""Distance in log-area [1] from the end of a regime, at which the one-sided derivative is evaluated."""
_NOT_REPRESENTABLE_SPOTS_MESSAGE = (
    "the critical spot area, {} m2, or a contact load is too small or too large to be computed; check the "
    "parameters: D close to an end of its interval, or an extreme value of G or h"
)
"""Error of a law whose critical area or load over- or underflows; the gap takes the area [m2]."""
_LOADS_PER_INVERSION_BLOCK = 16384
"""Number of points [1] whose loads are inverted at once: their arrays fit the processor's cache."""


class InterfaceLaw(Protocol):
    """Interface law of two rough surfaces: load, stiffness, real area as functions of the largest spot."""

    @property
    def A_0(self) -> float:
        """Nominal area [m2]."""

    @property
    def max_pressure(self) -> Number:
        """Largest pressure of the law [Pa]; tables of joints end there."""

    def spot_distribution(self) -> SpotDistribution:
        """Contact spots: size distribution; load, stiffness and area of a spot as functions of its size."""

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities {symbol: value} of the nominal area A_0: at least the load F [N].

        Most laws add stiffness [N/m], real area [m2] and loss factors [1].

        largest_log_area : u = ln(area of the largest spot/reference area) [1]
        """


class HardnessLimitedLaw(ABC):
    """Interface law that ends where the whole contact yields: at the hardness of the softer body."""

    @property
    @abstractmethod
    def hardness(self) -> Number:
        """Hardness of the softer body [Pa]."""

    @property
    def max_pressure(self) -> Number:
        """Largest pressure of the law [Pa]: the hardness."""
        return self.hardness


@runtime_checkable
class LawWithPressureRange(Protocol):
    """Interface law with a range of pressures in which it was validated."""

    def find_range_violations(self, lowest_pressure: float, highest_pressure: float) -> list[str]:
        """Messages, one line each, if an interval of pressures [Pa] leaves the validated range."""


def compute_newton_step(
    spot_distribution: SpotDistribution, largest_log_area: Number, log_load: Number
) -> tuple[Number, Number, Number, Number]:
    """One safeguarded Newton step for the log-area u [1] of the largest spot at a given log-load ln F.

    largest_log_area : present estimate of u
    log_load         : ln F of the load F [N] that all spots together must carry

    Returns step, lower and upper bound of the root (all relative to u), and residual in ln F [1]. The
    derivative d(ln F)/du lies between MIN_LOG_LOAD_SLOPE times the exponent m of the size distribution and
    MAX_LOG_LOAD_SLOPE, so every evaluation brackets the root.
    """
    value, slope = spot_distribution.log_sum_over_spots("load", largest_log_area)
    residual = log_load - value
    a, b = residual / (MIN_LOG_LOAD_SLOPE * spot_distribution.size_exponent), residual / MAX_LOG_LOAD_SLOPE
    lower, upper = np.minimum(a, b), np.maximum(a, b)
    step = np.minimum(np.maximum(residual / slope, lower), upper)
    return step, lower, upper, residual


def solve_largest_spot(interface_law: InterfaceLaw, pressure: ArrayLike) -> Array:
    """Log-area u [1] of the largest spot under a nominal pressure: ln(its area/reference area of the law).

    Parameters
    ----------
    interface_law : interface law; its parameters may be arrays that broadcast with the pressure
    pressure : (...) [Pa], >= 0 and finite

    Returns
    -------
    Array (...) [1], minus infinity at zero pressure. The relative residual of the load is at most
        1e-12; all points are solved at once, in blocks that fit the cache.

    Raises
    ------
    ValueError : a pressure is negative, NaN, infinite, or its largest spot is not representable
    RuntimeError : the inversion did not converge
    """
    p = np.asarray(pressure, dtype=np.float64)
    invalid = ~(np.isfinite(p) & (p >= 0.0))
    if np.any(invalid):
        raise ValueError(
            f"pressure = {p[invalid].flat[0]:g} Pa is outside [0, inf): nominal contact pressure"
        )
    spots, (min_load, _, max_load) = _check_distribution_loads(interface_law)
    load = np.where(p < MIN_PRESSURE, 0.0, p) * interface_law.A_0
    if np.any(invalid := (load > max_load) | ((load > 0.0) & (load < min_load))):
        raise ValueError(
            f"pressure = {np.broadcast_to(p, invalid.shape)[invalid].flat[0]:g} Pa is outside "
            f"[{np.max(min_load / interface_law.A_0):.3g}, {np.min(max_load / interface_law.A_0):.3g}]: the "
            "largest contact spot is too small or too large to be computed (critical area of the surface: "
            f"{np.max(spots.reference_area):.3g} m2)"
        )
    parameters = np.shape(min_load)
    shape = np.broadcast_shapes(load.shape, parameters)
    if load.size > _LOADS_PER_INVERSION_BLOCK and parameters == ():
        flat = load.ravel()
        blocks = [
            _solve_log_area(spots, flat[i : i + _LOADS_PER_INVERSION_BLOCK])
            for i in range(0, flat.size, _LOADS_PER_INVERSION_BLOCK)
        ]
        return np.concatenate(blocks).reshape(shape)
    return _solve_log_area(spots, np.broadcast_to(load, shape))


def get_checked_spot_distribution(interface_law: InterfaceLaw) -> SpotDistribution:
    """Contact spots of a law, after a check that their reference area and loads are representable as floats.

    Raises ValueError if the reference area or a load over- or underflows (fractal dimension D near 1).
    """
    return _check_distribution_loads(interface_law)[0]


def _check_distribution_loads(interface_law: InterfaceLaw) -> tuple[SpotDistribution, list[Number]]:
    """Check the total loads [N] of the contact spots at the log-areas MIN_LOG_AREA, 0 and MAX_LOG_AREA.

    Raises ValueError if a load or the reference area is not representable as a float.
    """
    ends = (MIN_LOG_AREA, 0.0, MAX_LOG_AREA)
    with np.errstate(all="ignore"):
        try:
            spots = interface_law.spot_distribution()
        except (OverflowError, ZeroDivisionError):
            raise ValueError(_NOT_REPRESENTABLE_SPOTS_MESSAGE.format("inf")) from None
        logs = [spots.log_sum_over_spots("load", u) for u in ends]
        loads = [np.exp(log) for log, _ in logs]
        values = [*loads, *(x for log in logs for x in log), *(np.exp(spots.size_exponent * u) for u in ends)]
        representable = np.all([np.all(np.isfinite(x)) for x in values])
        positive = np.all((spots.reference_area > 0.0) & np.isfinite(1.0 / spots.reference_area))
    if not (representable and positive):
        raise ValueError(_NOT_REPRESENTABLE_SPOTS_MESSAGE.format(f"{np.max(spots.reference_area):g}"))
    return spots, loads


def _solve_log_area(spot_distribution: SpotDistribution, target_load: Array) -> Array:
    """Log-areas (...) [1] of the largest spot at target loads (...) [N], by a bracketed Newton iteration."""
    empty = target_load <= 0.0
    target = np.log(np.where(empty, 1.0, target_load))
    u = np.zeros_like(target)
    low, high = np.full_like(target, -np.inf), np.full_like(target, np.inf)
    for _ in range(MAX_INVERSION_ITERATIONS):
        step, lower, upper, residual = compute_newton_step(spot_distribution, u, target)
        if np.max(np.abs(residual), initial=0.0) <= RELATIVE_LOAD_TOLERANCE:
            break
        low, high = np.maximum(low, u + lower), np.minimum(high, u + upper)
        u = np.minimum(np.maximum(u + step, low), high)
    else:
        if np.max(np.abs(residual)) > 1e-12:
            raise RuntimeError(
                "the iteration for the largest contact spot did not converge: relative error of the load "
                f"{np.max(np.abs(residual)):.2g}, expected at most 1e-12; check parameters and pressure"
            )
    return np.where(empty, -np.inf, u)


def evaluate_at_log_area(interface_law: InterfaceLaw, largest_log_area: Number) -> dict[str, Number]:
    """Contact quantities of the nominal area A_0 at the log-area u [1] of the largest spot.

    Returns {symbol: value} with the area `largest_spot` [m2], the nominal `pressure` [Pa] and the contact
    quantities of the law. At zero load (u = minus infinity) load, stiffness and area are zero; ratios such
    as loss factors have their limit.
    """
    empty = np.isneginf(largest_log_area)
    state = interface_law.contact_quantities(np.where(empty, MIN_LOG_AREA, largest_log_area))
    zero = np.where(empty, 0.0, 1.0)
    state = {
        name: value if name in DIMENSIONLESS_QUANTITY_NAMES else zero * value for name, value in state.items()
    }
    spots = interface_law.spot_distribution()
    spot = (
        spots.reference_area * np.exp(largest_log_area) if spots.has_spot_area else np.nan * largest_log_area
    )
    return {"largest_spot": spot, "pressure": state["F"] / interface_law.A_0, **state}


def evaluate_at_pressure(interface_law: InterfaceLaw, pressure: ArrayLike) -> dict[str, Number]:
    """Contact quantities {symbol: value} of the nominal area A_0 at nominal pressures (...) [Pa]."""
    return evaluate_at_log_area(interface_law, solve_largest_spot(interface_law, pressure))


def evaluate_at_largest_spot(interface_law: InterfaceLaw, spot_area: ArrayLike) -> dict[str, Number]:
    """Contact quantities {symbol: value} of the nominal area A_0 for a largest spot with the area (...) [m2].

    The spot area is defined as in the paper of the law: truncated area for Zhao
    2018, real area for Hu 2023 and Yu 2022. Raises ValueError for a law without spot areas, and for an area
    that is not positive, or outside the representable range.
    """
    a = np.asarray(spot_area, dtype=np.float64)
    spots = get_checked_spot_distribution(interface_law)
    if not spots.has_spot_area:
        raise ValueError("the law has no largest spot with an area; state a pressure instead")
    bad = ~(np.isfinite(a) & (a > 0.0))
    if np.any(bad):
        raise ValueError(f"largest spot = {a[bad].flat[0]:g} m2 is outside (0, inf): area of a spot")
    u = np.log(a) - np.log(spots.reference_area)
    if np.any(bad := (u < MIN_LOG_AREA) | (u > MAX_LOG_AREA)):
        raise ValueError(
            f"largest spot = {np.broadcast_to(a, bad.shape)[bad].flat[0]:g} m2 is too far from the critical "
            f"area, {np.max(spots.reference_area):g} m2; allowed are 1e-260 to 1e130 times that area"
        )
    return evaluate_at_log_area(interface_law, u)


def stiffness_curve(
    interface_law: InterfaceLaw, pressure: ArrayLike, stiffness_direction: str = "normal"
) -> tuple[Array, Array]:
    """Stiffness per nominal area k (...) [N/m3] and dk/dp (...) [1/m] at pressures p (...) [Pa] > 0.

    stiffness_direction : "normal" or "tangential" stiffness

    The derivative is exact: (dK/du)/(dF/du), with stiffness K, load F and log-area u of the largest spot.
    """
    spots = interface_law.spot_distribution()
    u = solve_largest_spot(interface_law, pressure)
    k = spots.sum_over_spots(stiffness_direction, u) / interface_law.A_0
    return k, spots.sum_over_spots_derivative(stiffness_direction, u) / spots.sum_over_spots_derivative(
        "load", u
    )


def find_validity_violations(
    interface_law: InterfaceLaw, pressure: float, lowest_pressure: float | None = None
) -> list[str]:
    """Warnings, one line each, if a law is outside its validity at a nominal pressure [Pa]; usually none.

    pressure        : [Pa] largest pressure of interest
    lowest_pressure : [Pa] smallest pressure of interest, for laws with a lower end of the validated range;
        None: `pressure`

    Above the hardness of the softer body the contact yields as a whole. A real area above the nominal one
    means that spots overlap. Results beyond these limits are extrapolations.
    """
    messages = []
    if isinstance(interface_law, HardnessLimitedLaw) and pressure > float(interface_law.hardness):
        messages.append(
            f"a pressure of {pressure:.4g} Pa is above the hardness of the softer body, "
            f"{interface_law.hardness:.4g} Pa, where the interface law ends: above it the whole contact "
            "yields, and the numbers are an extrapolation"
        )
    limit = _full_contact_pressure(interface_law, pressure)
    if limit is not None:
        messages.append(
            f"at a pressure of {pressure:.4g} Pa the interface law gives a real contact area above the "
            f"nominal area, {interface_law.A_0:.4g} m2: above {limit:.3g} Pa its results are an "
            "extrapolation"
        )
    if isinstance(interface_law, LawWithPressureRange):
        messages += interface_law.find_range_violations(
            pressure if lowest_pressure is None else lowest_pressure, pressure
        )
    return messages


def _full_contact_pressure(interface_law: InterfaceLaw, pressure: float) -> float | None:
    """Nominal pressure [Pa] at which the real area reaches the nominal area A_0.

    None if the real area at `pressure` is smaller than A_0.
    """
    with np.errstate(over="ignore"):
        if not float(evaluate_at_pressure(interface_law, pressure)["A_r"]) > interface_law.A_0:
            return None
        lower_pressures = np.geomspace(1e-6 * pressure, pressure, 400)
        area = evaluate_at_pressure(interface_law, lower_pressures)["A_r"]
    return float(np.exp(np.interp(np.log(interface_law.A_0), np.log(area), np.log(lower_pressures))))
