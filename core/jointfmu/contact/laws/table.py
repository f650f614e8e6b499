r"""Interface law `table`: measured or published normal stiffness at some contact pressures.

Between the points (p_i, K_i) ln K is a monotone cubic spline of ln p (Fritsch and Butland 1984, PCHIP), so K
is positive, never falls, and has a continuous derivative. At the first and at the last point the spline has
the slope of the chord to its neighbour. Below the first point

.. math::  K = K_1 (p/p_1)^n, \quad n = \min(\ln(K_2/K_1)/\ln(p_2/p_1), 1)

and above the last point K is constant: an extrapolation, as above the hardness in the other laws. The
approach is the integral of dp/K. Points of a power law K ~ p^n with n <= 1 give this power law.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...quantity import (
    Array,
    CheckedParameters,
    Number,
    check_fields,
    group_field,
    quantity_field,
    series_field,
)
from ..powerlaw import PowerTerm, SpotDistribution, exp_integral, integrate_gauss

MAX_TABLE_POINTS = 32
"""Largest number of points of a table [1], limited by the compiled code of the FMUs."""
MAX_STIFFNESS_EXPONENT_BELOW_FIRST_POINT = 1.0
"""Largest exponent n of K ~ p^n [1] below the first point, as for a contact of many spots. With a larger
one, the approach from first contact to the first point would depend on the pressure of first contact."""
ONSET_PRESSURE_OVER_FIRST_POINT_PRESSURE = 1e-6
"""Pressure at which the stiffness begins, over the pressure of the first point [1]."""
MIN_TRACTION_OVER_FRICTION_LIMIT = 1e-7
"""Tangential force over friction limit [1] below which the loss factor is proportional to it (round-off)."""
MAX_STIFFNESS_EXPONENT = 5.0
"""Largest exponent of K ~ p^n between two points [1]: contact of rough surfaces has up to about 1."""
MIN_PRESSURE_RATIO_OF_NEIGHBOURING_POINTS = 1.001
"""Smallest ratio of the pressures of neighbouring points [1]."""
_MIN_SEGMENT_LENGTH = 1e-100
"""Smallest length of a spline segment in ln p [1], for segments that only fill up the data of an FMU."""
_SIZE_EXPONENT = 0.25
"""Exponent m [1] of the formal size distribution, smaller than the exponent of any load; m cancels."""


class LogSpline(NamedTuple):
    """Monotone spline of the log-stiffness y = ln(K/K_1) as a function of the log-pressure u = ln(p/p_1).

    K_1 and p_1 are stiffness and pressure of the first point of the table, where y = u = 0.

    log_pressures, log_stiffnesses : (n) u and y at the n points [1]
    exponents                      : (n) slopes dy/du = d(ln K)/d(ln p) at the points [1]
    """

    log_pressures: Sequence[Number]
    log_stiffnesses: Sequence[Number]
    exponents: Sequence[Number]

    def evaluate_log_stiffness(self, log_pressure: Number) -> tuple[Number, Number]:
        """Log-stiffness y and its slope dy/du at log-pressures u, extrapolated below and above the points."""
        below = np.minimum(log_pressure, 0.0)
        y, slope = self.exponents[0] * below, self.exponents[0]
        for i in range(len(self.log_pressures) - 1):
            length = np.maximum(self.log_pressures[i + 1] - self.log_pressures[i], _MIN_SEGMENT_LENGTH)
            rise, first, last = (
                self.log_stiffnesses[i + 1] - self.log_stiffnesses[i],
                self.exponents[i],
                self.exponents[i + 1],
            )
            a = 3.0 * rise / length - 2.0 * first - last
            b = first + last - 2.0 * rise / length
            t = np.minimum(np.maximum((log_pressure - self.log_pressures[i]) / length, 0.0), 1.0)
            y = y + length * t * (first + t * (a + t * b))
            slope = slope + t * (2.0 * a + 3.0 * b * t)
        return y, np.where(log_pressure < self.log_pressures[-1], slope, 0.0)


def monotone_spline(point_pressures: Array, point_stiffnesses: Array) -> LogSpline:
    """Spline of ln(stiffness) as a function of ln(pressure) through n points, with non-negative slopes.

    point_pressures, point_stiffnesses : (n) [Pa], [Pa/m] increasing

    The slope at an inner point is that of Fritsch and Butland (1984): the weighted harmonic mean of the
    slopes of both adjacent chords, 0 if one of them is 0.
    """
    u, y = np.log(point_pressures / point_pressures[0]), np.log(point_stiffnesses / point_stiffnesses[0])
    length = np.diff(u)
    chord = np.diff(y) / length
    weight = 2.0 * length[1:] + length[:-1], length[1:] + 2.0 * length[:-1]
    both = np.minimum(chord[:-1], chord[1:]) > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (weight[0] + weight[1]) / (weight[0] / chord[:-1] + weight[1] / chord[1:])
    slopes = [min(chord[0], MAX_STIFFNESS_EXPONENT_BELOW_FIRST_POINT), *np.where(both, mean, 0.0), chord[-1]]
    return LogSpline(u.tolist(), y.tolist(), [float(slope) for slope in slopes])


@dataclass(frozen=True, slots=True, kw_only=True)
class StiffnessTable:
    """Measured or published points: normal stiffness per area as a function of the contact pressure.

    Raises ValueError if the points are too few or too many, or do not rise.
    """

    pressure: tuple[float, ...] = series_field("Pa", "contact pressures of the points, increasing", gt=0.0)
    stiffness: tuple[float, ...] = series_field(
        "Pa/m", "normal stiffness per area at these pressures, not decreasing", gt=0.0
    )
    ratio: float = quantity_field("1", "ratio of tangential to normal stiffness, K_T/K_N", gt=0.0)
    factor: float = quantity_field("1", "factor of the stiffness at all points", gt=0.0, default=1.0)

    def __post_init__(self) -> None:
        check_fields(self)
        count = len(self.pressure)
        if len(self.stiffness) != count or not 2 <= count <= MAX_TABLE_POINTS:
            raise ValueError(
                f"table.pressure has {count} numbers and table.stiffness {len(self.stiffness)}; expected "
                f"the same number, from 2 to {MAX_TABLE_POINTS}"
            )
        for i in range(1, count):
            (p, q), (K, L) = self.pressure[i - 1 : i + 1], self.stiffness[i - 1 : i + 1]
            if not q >= MIN_PRESSURE_RATIO_OF_NEIGHBOURING_POINTS * p:
                raise ValueError(
                    f"table.pressure[{i}] = {q:g} Pa follows {p:g} Pa; expected increasing pressures, each "
                    f"at least {MIN_PRESSURE_RATIO_OF_NEIGHBOURING_POINTS - 1.0:.1%} above the one before it"
                )
            if not L >= K:
                raise ValueError(
                    f"table.stiffness[{i}] = {L:g} Pa/m is below the one before it, {K:g} Pa/m: the "
                    "stiffness must not fall as the pressure rises"
                )
            if (exponent := np.log(L / K) / np.log(q / p)) > MAX_STIFFNESS_EXPONENT:
                raise ValueError(
                    f"table.stiffness[{i}] = {L:g} Pa/m rises from {K:g} Pa/m with power {exponent:.3g} of "
                    f"the pressure, allowed is up to {MAX_STIFFNESS_EXPONENT:g}: smooth the points, "
                    "or leave some out"
                )

    @property
    def first_point(self) -> tuple[Number, Number]:
        """Pressure [Pa] and stiffness [Pa/m] of the first point."""
        return self.pressure[0], self.stiffness[0]

    @property
    def last_pressure(self) -> Number:
        """Pressure of the last point [Pa]."""
        return self.pressure[-1]

    @property
    def spline(self) -> LogSpline:
        """Spline of the log-stiffness as a function of the log-pressure, through the points of the table."""
        return monotone_spline(np.array(self.pressure), np.array(self.stiffness))


@dataclass(frozen=True, slots=True)
class _StiffnessSplineTerm:
    """Term of one spot whose sum over all spots is the tabulated stiffness of the whole area.

    coefficient : [N/m] stiffness at the first point of the table

    The law has no real spots; its size distribution, with the exponent _SIZE_EXPONENT, only brings the law
    into the form of the others.
    """

    stiffness_spline: LogSpline
    coefficient: Number
    lower_log_area: Number = None
    upper_log_area: Number = None

    def evaluate_spot(self, log_area: Number) -> Number:
        y, slope = self.stiffness_spline.evaluate_log_stiffness(log_area)
        return self.coefficient * np.exp(y) * (slope - _SIZE_EXPONENT)

    def integrate_over_spots(self, size_exponent: Number, largest_log_area: Number) -> Number:
        return self.coefficient * np.exp(
            self.stiffness_spline.evaluate_log_stiffness(largest_log_area)[0]
            - size_exponent * largest_log_area
        )


@dataclass(frozen=True, kw_only=True)
class TableLaw(CheckedParameters):
    """Parameters of the interface law `table`: stiffness from points at some pressures, friction, area."""

    table: StiffnessTable = group_field("points of the stiffness over the pressure")
    mu: float = quantity_field("1", "coefficient of static friction", gt=0.0)
    traction_ratio: float = quantity_field(
        "1", "ratio of shear force to friction limit, x = T/(mu P)", ge=0.0, lt=1.0
    )
    A_0: float = quantity_field("m2", "nominal contact area", gt=0.0)

    @property
    def max_pressure(self) -> Number:
        """Pressure of the last point [Pa]."""
        return self.table.last_pressure

    def spot_distribution(self) -> SpotDistribution:
        """Load and stiffness of the nominal area A_0 as functions of u = ln(p/p_1).

        p_1, K_1: pressure and stiffness per area of the first point

        load         : [N] p A_0
        normal       : [N/m] stiffness, `factor` times the tabulated K(p) times A_0
        tangential   : [N/m] stiffness, `ratio` times normal
        elastic_work : [J] p p_1/K_1 A_0, a scale of the energy; only its product with eta_n = 0 is used
        plastic_work : [J] 0: the stiffness is that of small motions
        """
        (p, K), area, spline = self.table.first_point, self.A_0, self.table.spline
        normal = self.table.factor * K * area

        def make_pressure_proportional_term(sum_coefficient: Number) -> PowerTerm:
            """Load or energy of a spot whose sum over all spots is proportional to the pressure p."""
            return PowerTerm(sum_coefficient * (1.0 - _SIZE_EXPONENT), 1.0)

        return SpotDistribution(
            reference_area=area,
            size_exponent=_SIZE_EXPONENT,
            size_prefactor=1.0 / _SIZE_EXPONENT,
            regime_terms={
                "load": (make_pressure_proportional_term(p * area),),
                "normal": (_StiffnessSplineTerm(spline, normal),),
                "tangential": (_StiffnessSplineTerm(spline, self.table.ratio * normal),),
                "elastic_work": (make_pressure_proportional_term(p * area * p / K),),
                "plastic_work": (make_pressure_proportional_term(0.0),),
            },
            onset_log_area=float(np.log(ONSET_PRESSURE_OVER_FIRST_POINT_PRESSURE)),
            has_spot_area=False,
            kink_log_areas=tuple(spline.log_pressures[:-1]),
        )

    def find_range_violations(self, lowest_pressure: float, highest_pressure: float) -> list[str]:
        """Messages, one line each, if an interval of pressures [Pa] leaves the range of the table."""
        first, last = self.table.pressure[0], self.table.last_pressure
        messages = []
        if lowest_pressure < first:
            messages.append(
                f"a pressure of {lowest_pressure:.4g} Pa is below the first point of the law table, "
                f"{first:.4g} Pa: the stiffness there is a power law through the first two points"
            )
        if highest_pressure > last:
            messages.append(
                f"a pressure of {highest_pressure:.4g} Pa is above the last point of the law table, "
                f"{last:.4g} Pa: the stiffness there is that of the last point"
            )
        return messages

    def shear_stiffness_ratio(self) -> Number:
        """Stiffness ratio K_T/K_N [1] without slip."""
        return self.table.ratio

    def loss_factor(self) -> Number:
        """Loss factor eta_t [1] of a shear cycle at the parameter `traction_ratio`.

        The exponent n of stiffness ~ pressure^n is the mean from the first to the last point of the table.
        """
        spline = self.table.spline
        return loss_factor(self.traction_ratio, spline.log_stiffnesses[-1] / spline.log_pressures[-1])

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities of the nominal area A_0 at u = ln(p/p_1), p_1: pressure of the first point.

        F: load [N]; K_N, K_T: normal and tangential stiffness [N/m]; A_r: real area, not known (NaN);
        eta_n = 0 and eta_t: loss factors [1]; friction_limit = mu F [N].
        """
        s = self.spot_distribution()
        F = s.sum_over_spots("load", largest_log_area)
        return {
            "F": F,
            "K_N": s.sum_over_spots("normal", largest_log_area),
            "K_T": s.sum_over_spots("tangential", largest_log_area),
            "A_r": np.nan * F,
            "eta_n": 0.0 * F,
            "eta_t": self.loss_factor() + 0.0 * F,
            "friction_limit": self.mu * F,
        }


def loss_factor(traction_ratio: Number, stiffness_exponent: Number) -> Number:
    """Loss factor eta_t [1] of a shear cycle, for a normal stiffness K ~ p^n at the pressure p.

    traction_ratio     : x [1], amplitude of the tangential force divided by the friction limit mu F
    stiffness_exponent : n [1]

    The tangential stiffness on first loading to the share t of mu F is that of the pressure p (1 - t) (Jaeger
    1995, Ciavarella 1998), so the displacement is s ~ integral of (1 - t)^-n dt from 0 to x. By Masing's rule
    eta_t = (4/pi) [integral of (2 t - x) (1 - t)^-n dt]/(x s), both from 0 to x. With n = 1 this is the loss
    factor of the law `roughness`; small x give 2 n x/(3 pi).
    """
    x = np.maximum(traction_ratio, MIN_TRACTION_OVER_FRICTION_LIMIT)
    end = 0.0 - np.log1p(0.0 - x)  # t = 1 - exp(-v)
    rest = stiffness_exponent - 1.0
    moment = integrate_gauss(lambda v: (0.0 - 2.0 * np.expm1(0.0 - v) - x) * np.exp(rest * v), 0.0 * end, end)
    return 4.0 / np.pi * moment / (x * exp_integral(rest, 0.0, end)) * (traction_ratio / x)
