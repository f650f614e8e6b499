"""Tabulated monotone force laws: load as a function of displacement, with exact stiffness and energy.

A table is a quintic Hermite spline through load, stiffness and derivative of the stiffness at the nodes. The
load is twice continuously differentiable. Stiffness and energy are its exact derivative and integral.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from math import factorial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..contact.interface import (
    MAX_INVERSION_ITERATIONS,
    NEWTON_TOLERANCE,
    ONE_SIDED_DERIVATIVE_OFFSET,
    InterfaceLaw,
    get_checked_spot_distribution,
    solve_largest_spot,
)
from ..contact.powerlaw import SpotDistribution
from ..quantity import Array, Number

MAX_INTERPOLATION_ERROR = 1e-8
"""Largest allowed relative interpolation error of load and stiffness in a table [1]."""
MAX_TABLE_NODES = 2600
"""Largest number of nodes of a table [1], limited by the memory of an FMU instance."""
MAX_STEP_COUNT_FACTOR = 16
"""Largest number of steps of a table over its initial number [1]; ratios 1, 2, 4, ... are tried."""
MIN_STEPS_PER_LOG_AREA = 12
"""Initial number of steps of the pressure-approach curve per unit of the logarithm of the area of the largest
spot [1]; it is doubled until the curve is accurate."""
MIN_STEP_FACTOR_BETWEEN_KINKS = 2
"""Smallest number of steps between two kinks of a law, over the number per unit of log-area [1]."""
CONTACT_CLOSING_STEPS = 48
"""Number of steps of the table while the contact closes [1]: from first contact to some elastic spots."""
GAUSS_NODES_AND_WEIGHTS = np.polynomial.legendre.leggauss(5)
"""Nodes and weights of the Gauss-Legendre quadrature for the approach, the integral of d(pressure)/stiffness.
"""
_HERMITE_TO_POLYNOMIAL = np.array(  # (y0, s0, c0, y1, s1, c1) on [0, 1] -> coefficients of 1, t, ... t^5
    [
        [1, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 0],
        [0, 0, 0.5, 0, 0, 0],
        [-10, -6, -1.5, 10, -4, 0.5],
        [15, 8, 1.5, -15, 7, -1],
        [-6, -3, -0.5, 6, -3, 0.5],
    ]
)
_MONOMIAL_MEANS = 1.0 / np.arange(1.0, 7.0)
"""Means of 1, t, ... t^5 over [0, 1]."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Table of a monotone load as a function of displacement; linear extrapolation with the end tangents.

    displacement, load, stiffness : (n) values at the nodes, in any consistent units
    stiffness_slope_start, stiffness_slope_end : (n - 1) derivative of the stiffness at the start and at the
        end of each segment
    interpolation_error : [1] largest relative interpolation error of load and stiffness, measured when the
        table was built
    """

    displacement: Array
    load: Array
    stiffness: Array
    stiffness_slope_start: Array
    stiffness_slope_end: Array
    interpolation_error: float = 0.0
    _coefficients: Array = field(init=False, repr=False)
    _node_energies: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        h = np.diff(self.displacement)
        y, s = self.load, self.stiffness
        data = np.stack(
            [
                y[:-1],
                s[:-1] * h,
                self.stiffness_slope_start * h**2,
                y[1:],
                s[1:] * h,
                self.stiffness_slope_end * h**2,
            ]
        )
        object.__setattr__(self, "_coefficients", _HERMITE_TO_POLYNOMIAL @ data)
        areas = h * (_MONOMIAL_MEANS @ self._coefficients)
        object.__setattr__(self, "_node_energies", np.concatenate([[0.0], np.cumsum(areas)]))

    @property
    def closing_end_pressure(self) -> float:
        """Contact pressure [Pa] at approach 0, at which the closing phase of a pressure-approach curve ends.

        The law of rough contact begins there, with a pressure above 0. At negative approach, the table has
        a smooth transition from pressure 0 to this pressure.
        """
        return float(self.load[np.searchsorted(self.displacement, 0.0)])

    @property
    def end_point(self) -> tuple[float, float]:
        """Displacement and load at the end of the table."""
        return float(self.displacement[-1]), float(self.load[-1])

    def derivatives(self, displacement: ArrayLike, max_derivative_order: int = 1) -> list[Array]:
        """Load, and its derivatives up to an order, at displacements (...): order + 1 arrays (...)."""
        displacement = np.asarray(displacement, dtype=np.float64)
        nodes = self.displacement
        i = _find_segment(nodes, displacement)
        inside = np.minimum(np.maximum(displacement, nodes[0]), nodes[-1])
        first = nodes[i]
        h = nodes[i + 1] - first
        t = (inside - first) / h
        top, *rest = self._coefficients[::-1]
        out = [top[i], *(np.zeros(displacement.shape) for _ in range(max_derivative_order))]
        for coefficient in rest:  # Horner's scheme for the load and its derivatives divided by factorials
            for n in range(max_derivative_order, 0, -1):
                out[n] = out[n] * t + out[n - 1]
            out[0] = out[0] * t + coefficient[i]
        out = [value * (factorial(n) / h**n) for n, value in enumerate(out)]
        is_outside = displacement != inside
        if not is_outside.any():
            return out
        slope = out[1] if max_derivative_order else self.derivatives(inside, 1)[1]
        out[0] = out[0] + (displacement - inside) * slope
        return out[:2] + [np.where(is_outside, 0.0, value) for value in out[2:]]

    def energy(self, displacement: ArrayLike) -> Array:
        """Integral (...) of the load from the first node to displacements (...)."""
        displacement = np.asarray(displacement, dtype=np.float64)
        nodes = self.displacement
        i = _find_segment(nodes, displacement)
        inside = np.minimum(np.maximum(displacement, nodes[0]), nodes[-1])
        step = inside - nodes[i]
        t = step / (nodes[i + 1] - nodes[i])
        mean = np.zeros_like(t)
        for monomial_mean, coefficient in zip(
            _MONOMIAL_MEANS[::-1], self._coefficients[::-1, i], strict=True
        ):
            mean = mean * t + monomial_mean * coefficient
        energy = np.asarray(self._node_energies[i] + step * mean)
        excess = displacement - inside
        if not excess.any():
            return energy
        load, stiffness = self.derivatives(inside, 1)
        return np.asarray(energy + excess * (load + 0.5 * excess * stiffness))

    def odd_inverse(self, target_load: ArrayLike) -> Array:
        """Displacement (...) at loads (...) of either sign, for an odd curve tabulated from zero on."""
        y = np.asarray(target_load, dtype=np.float64)
        return np.asarray(np.copysign(self.inverse(np.abs(y)), y))

    def inverse(self, target_load: ArrayLike) -> Array:
        """Displacement (...) at loads (...), accurate to round-off.

        Safeguarded Newton iteration inside the segment. Loads at or below the first node give the first node,
        if the stiffness there is zero.
        """
        y = np.asarray(target_load, dtype=np.float64)
        nodes, displacements = self.load, self.displacement
        i = _find_segment(nodes, y)
        inside = np.minimum(np.maximum(y, nodes[0]), nodes[-1])
        first, h = displacements[i], displacements[i + 1] - displacements[i]
        low, high = np.zeros(y.shape), np.ones(y.shape)
        t = (inside - nodes[i]) / (nodes[i + 1] - nodes[i])
        top, *rest = self._coefficients[::-1, i]
        for _ in range(MAX_INVERSION_ITERATIONS):
            value, slope = top, np.zeros(y.shape)
            for coefficient in rest:
                slope = slope * t + value
                value = value * t + coefficient
            residual = inside - value
            is_below = residual > 0.0
            low, high = np.where(is_below, t, low), np.where(is_below, high, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = t + residual / slope
            newton = (step >= low) & (step <= high)
            new = np.where(newton, step, 0.5 * (low + high))
            is_converged = np.all(np.abs(new - t) <= np.where(newton, NEWTON_TOLERANCE, 4e-16) * t)
            t = new
            if is_converged:
                break
        x = first + t * h
        edge = np.where(y > nodes[-1], self.stiffness[-1], self.stiffness[0])
        flat = edge == 0.0
        x = np.where(y <= nodes[0], self.displacement[0], x)
        return np.asarray(x + np.where(flat, 0.0, (y - inside) / np.where(flat, 1.0, edge)))


def _find_segment(node_abscissas: Array, query_abscissas: Array) -> NDArray[np.intp]:
    """Index (...) of the segment of nodes (n) that contains an abscissa (...), or of the nearest segment."""
    return np.minimum(
        np.maximum(node_abscissas.searchsorted(query_abscissas, side="right") - 1, 0), node_abscissas.size - 2
    )


def assemble_curve(
    curve_pieces: list[tuple[Array, Array, Array, Array]], relative_data_error: float = 0.0
) -> Curve:
    """Join pieces of a curve; estimate the interpolation error.

    curve_pieces : (displacement, load, stiffness, derivative of the stiffness), arrays of an odd number of
        nodes. The last node of a piece is the first of the next. The derivative may jump from piece to piece.
    relative_data_error : [1] relative error of the data themselves

    The error is half the largest relative deviation from the curve through every second node: the order of
    convergence is at least one, also at a kink. It is measured at the quarter points of the segments, because
    the spline is more accurate at their middle.
    """
    every_second = [tuple(column[::2] for column in piece) for piece in curve_pieces]
    fine, coarse = _join_curve_pieces(curve_pieces), _join_curve_pieces(every_second)  # type: ignore[arg-type]
    nodes = fine.displacement
    points = np.concatenate([nodes[:-1] + fraction * np.diff(nodes) for fraction in (0.25, 0.5, 0.75)])
    worst = relative_data_error
    for value, coarse_value in zip(fine.derivatives(points), coarse.derivatives(points), strict=True):
        loaded = value > 0.0
        worst = max(worst, float(np.max(np.abs(coarse_value - value)[loaded] / value[loaded])) / 2.0)
    return Curve(
        nodes, fine.load, fine.stiffness, fine.stiffness_slope_start, fine.stiffness_slope_end, worst
    )


def refine_curve(tabulate_curve: Callable[[int], Curve], initial_step_count: int) -> Curve:
    """Refine a table until its error is at most MAX_INTERPOLATION_ERROR.

    tabulate_curve     : function, number of steps -> table
    initial_step_count : initial number of steps, doubled up to MAX_STEP_COUNT_FACTOR times as many

    Raises RuntimeError if the table then is still inaccurate, or has more than MAX_TABLE_NODES nodes.
    """
    factor = 1
    while factor <= MAX_STEP_COUNT_FACTOR:
        curve = tabulate_curve(initial_step_count * factor)
        factor *= 2
        if curve.load.size > MAX_TABLE_NODES:
            raise RuntimeError(
                f"the table of the law needs more than {MAX_TABLE_NODES} nodes: the law is not smooth "
                "enough with these parameters; check them for extreme values"
            )
        if curve.interpolation_error <= MAX_INTERPOLATION_ERROR:
            return curve
    raise RuntimeError(
        f"the table of the law has an interpolation error of {curve.interpolation_error:.2g} with "
        f"{curve.load.size} nodes, allowed is {MAX_INTERPOLATION_ERROR:g}: the law is not smooth enough "
        "with these parameters; check them for extreme values"
    )


def _join_curve_pieces(curve_pieces: list[tuple[Array, Array, Array, Array]]) -> Curve:
    """Join pieces of a curve at their common nodes into one table."""
    x, y, s = (
        np.concatenate([piece[k][bool(i) :] for i, piece in enumerate(curve_pieces)]) for k in range(3)
    )
    start = np.concatenate([piece[3][:-1] for piece in curve_pieces])
    end = np.concatenate([piece[3][1:] for piece in curve_pieces])
    return Curve(x, y, s, start, end)


CLOSING_END_OVER_PLASTIC_SPOT_AREA = 20.0
"""Area of the largest spot over area of the largest plastic spot [1] at the end of the closing."""


def closing_pressure(
    end_pressure: Number,
    end_stiffness: Number,
    end_stiffness_slope: Number,
    displacement_over_closing_length: Number,
) -> tuple[Number, Number, Number, Number]:
    """Pressure as a function of approach while the contact closes: from zero pressure to the contact law.

    end_pressure, end_stiffness, end_stiffness_slope : pressure p [Pa], stiffness k = dp/d(approach) [N/m3]
        and its derivative [N/m4] at the end of the closing, where the contact law begins
    displacement_over_closing_length : z (...) [1] displacement from first contact over the length of the
        closing, 0 to 1

    Returns displacement from the end of the closing [m], pressure, stiffness and its derivative at z.

    Interface laws have zero stiffness while all spots are plastic, at a finite pressure. The approach, the
    integral of dp/k, would start at minus infinity. So the law is used only above the point where the largest
    spot is CLOSING_END_OVER_PLASTIC_SPOT_AREA times the largest plastic spot. Below, the pressure is p z^3 (a
    + b z + c z^2) along a length n p/k. The coefficients a, b, c make it twice continuously differentiable at
    both ends. n is 4. If k grows with a power of p below 0.75, this length would make the pressure negative;
    n is then the largest value that does not.
    """
    reach = closing_length_ratio(end_pressure, end_stiffness, end_stiffness_slope)
    length = reach * end_pressure / end_stiffness
    c = 0.5 * end_stiffness_slope * length**2 / end_pressure - 3.0 * reach + 6.0
    a, b = 4.0 - reach + c, reach - 3.0 - 2.0 * c
    z = displacement_over_closing_length
    load = end_pressure * z**3 * (a + b * z + c * z**2)
    stiffness = end_pressure / length * z**2 * (3.0 * a + 4.0 * b * z + 5.0 * c * z**2)
    slope = end_pressure / length**2 * z * (6.0 * a + 12.0 * b * z + 20.0 * c * z**2)
    return (z - 1.0) * length, load, stiffness, slope


def closing_length_ratio(end_pressure: Number, end_stiffness: Number, end_stiffness_slope: Number) -> Number:
    """Length of the closing of a contact [1], divided by pressure over stiffness at its end.

    Closing: range of the approach from zero pressure to the point where the contact law begins. Pressure
    [Pa], stiffness [N/m3] and its derivative [N/m4] are those at this point, see `closing_pressure`.
    """
    return 40.0 / (
        8.0 + np.sqrt(np.maximum(64.0 - 80.0 * end_stiffness_slope * end_pressure / end_stiffness**2, 4.0))
    )


def tabulate_approach(interface_law: InterfaceLaw) -> Curve:
    """Table of the pressure p [Pa] of an interface as a function of the approach [m].

    The approach is the integral of dp/k, with the stiffness k [N/m3] of the interface law at the pressure p.
    Each step is integrated with five Gauss-Legendre nodes. The law begins at zero approach. At negative
    approach, the pressure rises from zero as `closing_pressure` computes it. The nodes are spaced evenly in
    the logarithm u of the area of the largest spot, because load and stiffness are explicit in u. The last
    node is at the largest pressure of the law.

    Raises
    ------
    ValueError   : all spots are plastic (no stiffness) at every pressure up to the largest
    RuntimeError : the table does not reach the accuracy, see `refine_curve`
    """
    spots, area = get_checked_spot_distribution(interface_law), interface_law.A_0
    first = float(spots.stiffness_onset_log_area + np.log(CLOSING_END_OVER_PLASTIC_SPOT_AREA))
    last = float(solve_largest_spot(interface_law, interface_law.max_pressure))
    if not last > first:
        p = float(spots.sum_over_spots("load", first)) / area
        raise ValueError(
            f"at every pressure up to the hardness, {float(interface_law.max_pressure):.3g} Pa, all contact "
            f"spots are plastic, so the interface has no stiffness (it would start at {p:.3g} Pa); check "
            "surface.D and surface.G (G in m)"
        )
    return refine_curve(
        lambda steps: _tabulate_between_log_areas(spots, area, first, last, steps), MIN_STEPS_PER_LOG_AREA
    )


def _tabulate_between_log_areas(
    spot_distribution: SpotDistribution,
    nominal_area: float,
    start_log_area: float,
    end_log_area: float,
    steps_per_log_area: int,
) -> Curve:
    """Table of pressure as a function of approach: closing, then the law between two largest-spot areas.

    start_log_area, end_log_area : natural logarithm of the area [m2] of the largest spot, at both ends
    steps_per_log_area : number of steps per unit of this logarithm
    """
    ends = [
        start_log_area,
        *(b for b in spot_distribution.sorted_regime_end_log_areas if start_log_area < b < end_log_area),
        end_log_area,
    ]
    pieces, offset = [], 0.0
    for start, end in pairwise(ends):
        least = (
            MIN_STEP_FACTOR_BETWEEN_KINKS * steps_per_log_area
            if start >= spot_distribution.first_kink_log_area
            else 2
        )
        n = max(2 * int(np.ceil(0.5 * steps_per_log_area * (end - start))), least)
        u = np.linspace(start, end, n + 1)
        half = 0.5 * (u[1] - u[0])
        inner = u[:-1, None] + half * (1.0 + GAUSS_NODES_AND_WEIGHTS[0])
        increments = (
            half
            * (
                spot_distribution.sum_over_spots_derivative("load", inner)
                / spot_distribution.sum_over_spots("normal", inner)
            )
            @ GAUSS_NODES_AND_WEIGHTS[1]
        )
        x = offset + np.concatenate([[0.0], np.cumsum(increments)])
        offset = x[-1]
        side = np.clip(
            u, start + ONE_SIDED_DERIVATIVE_OFFSET, end - ONE_SIDED_DERIVATIVE_OFFSET
        )  # one-sided derivative where a regime ends
        k = spot_distribution.sum_over_spots("normal", u) / nominal_area
        bend = (
            k
            * spot_distribution.sum_over_spots_derivative("normal", side)
            / spot_distribution.sum_over_spots_derivative("load", side)
        )
        pieces.append((x, spot_distribution.sum_over_spots("load", u) / nominal_area, k, bend))
    _, p, k, bend = (float(column[0]) for column in pieces[0])
    return assemble_curve(
        [closing_pressure(p, k, bend, np.linspace(0.0, 1.0, CONTACT_CLOSING_STEPS + 1)), *pieces]
    )
