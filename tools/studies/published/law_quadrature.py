"""Reference values of all laws: their printed equations, summed by quadrature. Nothing of the laws is called.

    python -m jointfmu_tools.studies.published.law_quadrature > models/reference/laws.toml

The equations are those of the papers with the corrections of docs/errata.md. `jointfmu validate` compares the
laws with the frozen table.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import exp, inf, log, pi, sqrt
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.interpolate import BPoly, CubicHermiteSpline, PchipInterpolator
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from scipy.stats import norm

Parameters = Mapping[str, Any]
"""Values of the parameters of a law, by structured name."""
SpotFunction = Callable[[float], float]
"""Quantity of one contact spot as a function of its area [m2]."""

_QUADRATURE = {"epsabs": 0.0, "epsrel": 1e-12, "limit": 400}
"""Settings of the quadrature: relative accuracy and number of subdivisions."""
_NEGLIGIBLE_LOG = 40.0
"""Logarithm of the ratio of a whole integral to a part that is left out [1]: 4e-18."""
_FIRST_STAGE, _SECOND_STAGE = (0.93, 1.136, 1.03, 1.425), (0.94, 1.146, 1.40, 1.263)
"""Kogut and Etsion 2002: area/a_c = m (w/w_c)^n, load/f_c = c (w/w_c)^d as (m, n, c, d)."""
_FIRST_END, _SECOND_END = 6.0, 110.0
"""Deformations w/w_c [1] at the ends of both stages."""


def _bodies(p: Parameters) -> tuple[float, float]:
    """Contact modulus E* and contact shear modulus G' [Pa] of the two bodies with parameters p."""
    sides = [(p[f"{side}.E"], p[f"{side}.nu"]) for side in ("side1", "side2")]
    return (
        1.0 / sum((1.0 - nu**2) / E for E, nu in sides),
        1.0 / sum((2.0 - nu) * 2.0 * (1.0 + nu) / E for E, nu in sides),
    )


def _sum_spots(spot_quantity: SpotFunction, spot_density: SpotFunction, edges: Sequence[float]) -> float:
    """Integral of spot_quantity(a) spot_density(a) over ln a, between successive spot areas `edges` [m2]."""
    total = 0.0
    for low, high in pairwise(edges):
        if high > low:
            total += quad(
                lambda t: spot_quantity(exp(t)) * spot_density(exp(t)), log(low), log(high), **_QUADRATURE
            )[0]
    return total


def _stick_sum(
    spot_quantity: SpotFunction, x: SpotFunction, spot_density: SpotFunction, low: float, high: float
) -> float:
    """Sum of spot_quantity(a) (1 - x(a))^(1/3) over the spots that do not slip.

    x : function of the area a [m2]: tangential force over friction limit [1] of a spot, decreasing with a;
        spots with x >= 1 slip
    """
    if high <= low or x(high) >= 1.0:
        return 0.0
    onset = low if x(low) <= 1.0 else exp(brentq(lambda t: x(exp(t)) - 1.0, log(low), log(high), xtol=1e-14))

    def integrand(y: float) -> float:  # ln a = ln onset + y^3 removes the cube root at the onset
        """Integrand after a substitution that removes the cube root at the end of slip."""
        a = onset * exp(y**3)
        return 3.0 * y**2 * spot_quantity(a) * max(1.0 - x(a), 0.0) ** (1.0 / 3.0) * spot_density(a)

    return float(quad(integrand, 0.0, log(high / onset) ** (1.0 / 3.0), **_QUADRATURE)[0])


def _evaluate_zhao2018(p: Parameters, largest: float) -> dict[str, float]:
    """Quantities of Zhao 2018 at the truncated area a'_L [m2] of the largest spot."""
    D, G, H, x = p["surface.D"], p["surface.G"], p["H"], p["traction_ratio"]
    root = sqrt(log(p["surface.gamma"]))
    E, shear = _bodies(p)

    def domain_extension_residual(psi: float) -> float:
        """Difference of both sides of Eq. 3 for a domain extension factor psi."""
        return psi ** (1.0 - D / 2.0) - (1.0 + psi ** (-D / 2.0)) ** ((D - 2.0) / D) - (2.0 - D) / D

    psi = brentq(domain_extension_residual, 1.5, 3.0, xtol=1e-15)

    def deformation(a: float) -> float:
        """Deformation [m] of a spot of area a, Eq. 5."""
        return 2.0 ** (3.0 - D) * G ** (D - 1.0) * root * pi ** (D / 2.0 - 1.0) * a ** (1.0 - D / 2.0)

    def radius(a: float) -> float:
        """Radius of curvature [m] of a spot of area a, Eq. 6."""
        return a ** (D / 2.0) / (2.0 ** (4.0 - D) * pi ** (D / 2.0) * G ** (D - 1.0) * root)

    def elastic_load(a: float) -> float:
        """Elastic load [N] of a spot of area a, Eq. 7."""
        return 4.0 / 3.0 * E * sqrt(radius(a)) * deformation(a) ** 1.5

    def critical_area_residual(a: float) -> float:
        """Logarithm of the ratio of both sides of the equation for the critical area, at a spot area a.

        The equation depends on the parameter `critical_area`. The function is 0 at the critical area: root
        finding.
        """
        if p["critical_area"] == "continuity":
            return log(elastic_load(a) / (H * a))
        strength = 0.454 + 0.41 * p["side1.nu"]
        return log((pi * strength * H / (2.0 * E)) ** 2 * radius(a) / deformation(a))

    if p["critical_area"] == "printed":
        critical = 2.0 * (2.0 * E / H) ** (2.0 / (D - 1.0)) * G**2  # Eq. 4
    else:
        critical = exp(brentq(lambda t: critical_area_residual(exp(t)), -150.0, 50.0, xtol=1e-14))

    def spot_density(a: float) -> float:
        """Number of spots per unit of ln(area), a' n(a') of Eq. 2."""
        return D / 2.0 * psi ** (1.0 - D / 2.0) * (largest / a) ** (D / 2.0)

    def normal_stiffness(a: float) -> float:
        """Normal stiffness [N/m] of an elastic spot of area a: Eq. 13, or 2 E* r."""
        if p["spot_stiffness"] == "family":
            return 4.0 * E * (3.0 - D) / (3.0 * sqrt(2.0 * pi) * (2.0 - D)) * sqrt(a)
        return 2.0 * E * sqrt(a / (2.0 * pi))

    end = min(critical, largest)

    def plastic_sum(spot_quantity: SpotFunction, exponent: float) -> float:
        """Sum of a quantity over the plastic spots."""
        return _sum_spots(spot_quantity, spot_density, [end * exp(-_NEGLIGIBLE_LOG / exponent), end])

    def elastic_sum(spot_quantity: SpotFunction) -> float:
        """Sum of a quantity over the elastic spots."""
        return _sum_spots(spot_quantity, spot_density, [critical, largest])

    load = plastic_sum(lambda a: H * a, 1.0 - D / 2.0) + elastic_sum(elastic_load)
    area = plastic_sum(lambda a: a, 1.0 - D / 2.0) + elastic_sum(lambda a: a / 2.0)
    plastic_work = plastic_sum(lambda a: H * a * deformation(a), 2.0 - D)  # Eq. 15
    elastic_work = elastic_sum(lambda a: 8.0 / 15.0 * E * sqrt(radius(a)) * deformation(a) ** 2.5)  # Eq. 17
    K_N = elastic_sum(normal_stiffness)
    K_T = elastic_sum(lambda a: 8.0 * shear * sqrt(a / (2.0 * pi)) * (1.0 - x) ** (1.0 / 3.0))  # Eq. 21
    eta_n = plastic_work / elastic_work
    H1 = 1.0 - (1.0 - x) ** (5.0 / 3.0) - 5.0 * x / 6.0 * (1.0 + (1.0 - x) ** (2.0 / 3.0))
    H2 = 0.6 + 0.4 * (1.0 - x) ** (5.0 / 3.0) - (1.0 - x) ** (2.0 / 3.0)
    eta_t = 1.0 / (5.0 * pi / 12.0 * H2 / H1 - 1.0)
    return {
        "pressure": load / p["A_0"],
        "largest_spot": largest,
        "K_N": K_N,
        "K_T": K_T,
        "A_r": area,
        "W_NP": plastic_work,
        "W_NE": elastic_work,
        "C_N": eta_n * sqrt(p["mass"] * K_N),
        "C_T": eta_t * sqrt(p["mass"] * K_T),
        "eta_t": eta_t,
    }


def _evaluate_hu2023(p: Parameters, largest: float) -> dict[str, float]:
    """Quantities of Hu 2023 at the area s_l [m2] of the largest spot."""
    D, s_min, A_0 = p["surface.D"], p["surface.s_min"], p["A_0"]
    E, shear = _bodies(p)
    k, H = 0.454 + 0.41 * p["side1.nu"], 2.8 * p["sigma_y"]
    height = p["surface.G"] ** (D - 2.0) * sqrt(log(p["surface.gamma"]))
    R = p["surface.r_m"] ** (D - 1.0) / (2.0 ** (3.0 - D) * pi**2 * height)  # Eq. 5
    first_yield = (pi * k * H / (2.0 * E)) ** 2 * R  # Eq. 7
    s_ec = pi * R * first_yield
    f_ec = 4.0 / 3.0 * E * sqrt(R) * first_yield**1.5  # Eq. 9
    (m1, n1, c1, d1), (m2, n2, c2, d2) = _FIRST_STAGE, _SECOND_STAGE
    s1, s2 = m1 * _FIRST_END**n1 * s_ec, m2 * _SECOND_END**n2 * s_ec
    psi = 5.454 * exp((1.0 - D) / 0.628) + 1.499
    x = p["traction_ratio"]

    def spot_density(s: float) -> float:
        """Number of spots per unit of ln(area), s n(s) of Eq. 17."""
        return (D - 1.0) / 2.0 * psi ** (1.5 - D / 2.0) * (largest / s) ** (D / 2.0 - 0.5)

    def elastic_load(s: float) -> float:
        """Elastic load [N] of a spot of area s, Eq. 9."""
        return 4.0 / 3.0 * E * (s / pi) ** 1.5 / R

    def load(s: float) -> float:
        """Load [N] of a spot of area s in its regime, Eqs. 9, 11, 12, 16."""
        if s <= s_ec:
            return elastic_load(s)
        if s <= s1:
            return f_ec * c1 * (s / (m1 * s_ec)) ** (d1 / n1)
        return f_ec * c2 * (s / (m2 * s_ec)) ** (d2 / n2) if s <= s2 else H * s

    def normal_stiffness(s: float) -> float:
        """Normal stiffness [N/m] of a spot of area s in its regime, Eqs. 29, 31, 32."""
        if s <= s_ec:
            return 2.0 * E * sqrt(s / pi)
        m, n, c, d = _FIRST_STAGE if s <= s1 else _SECOND_STAGE
        return f_ec / first_yield * c * d * (s / (m * s_ec)) ** ((d - 1.0) / n)

    def full_stick_stiffness(s: float) -> float:
        """Tangential stiffness [N/m] of a spot of area s without slip."""
        return 8.0 * shear * sqrt(s / pi)

    def make_traction_ratio(spot_load: SpotFunction) -> SpotFunction:
        """Traction ratio t/(mu f) [1] under the shear traction, as a function of the spot area."""
        return lambda s: p["shear_traction"] * s / (p["mu"] * spot_load(s))

    def sum_from_zero(spot_quantity: SpotFunction, exponent: float) -> float:
        """Sum of a quantity over all spots, from zero area on."""
        low = min(s_ec, largest) * exp(-_NEGLIGIBLE_LOG / (exponent + 0.5 - D / 2.0))
        return _sum_spots(
            spot_quantity, spot_density, [low, *(min(e, largest) for e in (s_ec, s1, s2)), largest]
        )

    area = sum_from_zero(lambda s: s, 1.0)
    if p["reading"] == "printed":  # Eq. 30: the antiderivative at s_l, that is minus the integral beyond it
        far = largest * exp(_NEGLIGIBLE_LOG / (D / 2.0 - 1.0))
        pressure = 4.0 * E * (3.0 - D) / (3.0 * pi**1.5 * R * (4.0 - D)) * sqrt(largest)
        near = largest * exp(-_NEGLIGIBLE_LOG)
        return {
            "pressure": pressure,
            "K_N": _sum_spots(lambda s: 2.0 * E * sqrt(s / pi), spot_density, [largest, far]),
            "K_T": _sum_spots(
                lambda s: full_stick_stiffness(s) * (1.0 - x) ** (1.0 / 3.0), spot_density, [largest, far]
            )
            if p["traction"] == "ratio"
            else _stick_sum(
                full_stick_stiffness, make_traction_ratio(elastic_load), spot_density, near, largest
            ),
            "A_r": area,
        }
    edges = [max(s_min, min(e, largest)) for e in (s_min, s_ec, s1, s2)]
    if p["traction"] == "ratio":
        K_T = _sum_spots(lambda s: full_stick_stiffness(s) * (1.0 - x) ** (1.0 / 3.0), spot_density, edges)
    else:
        K_T = sum(
            _stick_sum(full_stick_stiffness, make_traction_ratio(load), spot_density, low, high)
            for low, high in pairwise(edges)
        )
    return {
        "pressure": sum_from_zero(load, 1.5) / A_0,
        "largest_spot": largest,
        "K_N": _sum_spots(normal_stiffness, spot_density, edges),
        "K_T": K_T,
        "A_r": area,
    }


def _evaluate_yu2022(p: Parameters, largest: float) -> dict[str, float]:
    """Quantities of Yu 2022 at the real area a_l [m2] of the largest spot."""
    e, root = p["e"], sqrt(log(p["surface.gamma"]))
    compliance = (1.0 - p["side1.nu"] ** 2) / p["side1.E"]
    if not p["rigid_flat"]:
        compliance += (1.0 - p["side2.nu"] ** 2) / p["side2.E"]
    E, H, k = 1.0 / compliance, 2.8 * p["sigma_y"], 0.454 + 0.41 * p["side1.nu"]
    first, second = ellipk(e**2), ellipe(e**2)
    slender = sqrt(1.0 - e**2)
    f1, f2 = second / (first * slender), pi * sqrt(second) / (2.0 * first**1.5 * slender)  # Eqs. 22-23
    exponent = slender / 2.0 * (p["surface1.D"] + p["surface2.D"]) / 2.0  # Eqs. 42-43

    def spot_density(a: float) -> float:
        """Number of spots per unit of ln(area): lambda times Eq. 44, times a."""
        return p["lambda"] * exponent * (largest / a) ** exponent

    def radius(a: float) -> float:
        """Mean radius of curvature R_m [m] of a spot of area a, Eqs. 12, 13, 15."""
        curvature = 0.0
        for side, sign in (("surface1", -1.0), ("surface2", 1.0)):
            D, G = p[f"{side}.D"], p[f"{side}.G"]
            axis = a ** (D / 2.0) * (1.0 - e**2) ** (sign * D / 4.0)
            curvature += 2.0 ** (4.0 - D) * pi ** (D / 2.0) * G ** (D - 1.0) * root / axis
        return 2.0 / curvature

    def yield_deformation(a: float) -> float:
        """Deformation at first yield [m] of a spot of area a, Eq. 27."""
        return first * second * radius(a) * (k * H / E) ** 2

    def area_ratio(a: float) -> float:
        """Area of a spot over the area at which a spot of its curvature yields first [1]."""
        return a / (f1 * pi * radius(a) * yield_deformation(a))

    def stage_end_area(max_area_ratio: float) -> float:
        """Spot area [m2] at which `area_ratio` reaches a limit: the end of a stage."""
        return exp(brentq(lambda t: log(area_ratio(exp(t)) / max_area_ratio), -250.0, 250.0, xtol=1e-13))

    geometric = p["plastic_area"] == "geometric"
    (m1, n1, *_), (m2, n2, *_) = _FIRST_STAGE, _SECOND_STAGE
    limits = (_FIRST_END, _SECOND_END) if geometric else (m1 * _FIRST_END**n1, m2 * _SECOND_END**n2)
    a_nec, a_nepc, a_npc = stage_end_area(1.0), stage_end_area(limits[0]), stage_end_area(limits[1])

    def deformation(a: float) -> tuple[float, float, float]:
        """Deformation over yield deformation [1]; factor and exponent of the load in the spot's stage."""
        m, n, c, d = _FIRST_STAGE if a > a_nepc else _SECOND_STAGE
        return (area_ratio(a), c, d) if geometric else ((area_ratio(a) / m) ** (1.0 / n), c, d)

    def load(a: float) -> float:
        """Load [N] of a spot of area a in its stage."""
        if a <= a_npc:
            return float(H * a)
        hertz = f2 * 4.0 / 3.0 * E * sqrt(radius(a))
        if a > a_nec:
            return float(hertz * (a / (f1 * pi * radius(a))) ** 1.5)
        w, c, d = deformation(a)
        return float(hertz * yield_deformation(a) ** 1.5 * c * w**d)

    def normal_stiffness(a: float) -> float:
        """Normal stiffness [N/m] of a spot of area a in its stage."""
        if a > a_nec:
            return float(2.0 * f2 * E * sqrt(a / (f1 * pi)))
        w, c, d = deformation(a)
        return float(f2 * 4.0 / 3.0 * E * sqrt(radius(a) * yield_deformation(a)) * c * d * w ** (d - 1.0))

    start = min(a_npc, largest) * exp(-_NEGLIGIBLE_LOG / (1.0 - exponent))
    edges = [min(a, largest) for a in (start, a_npc, a_nepc, a_nec, largest)]
    area = _sum_spots(lambda a: a, spot_density, edges)
    return {
        "pressure": _sum_spots(load, spot_density, edges) / p["A_0"],
        "largest_spot": largest,
        "K_N": _sum_spots(normal_stiffness, spot_density, edges[1:]),
        "A_r": area,
        "elastic_fraction": _sum_spots(lambda a: a, spot_density, edges[3:]) / area,
    }


def _evaluate_roughness_law(parameters: Parameters, pressure: float) -> dict[str, float]:
    """Quantities of the law `roughness` at a nominal pressure [Pa]."""
    E, shear = _bodies(parameters)
    h, gamma, wave, hurst, A_0, H = (
        parameters[n] for n in ("h", "gamma", "longest_wave", "hurst", "A_0", "H")
    )
    mu, x = parameters["mu"], parameters["traction_ratio"]

    def stiffness(pressure: float) -> float:
        """Normal stiffness [N/m] of the nominal area at a pressure [Pa]."""
        few = 0.3 * (pressure * A_0 / (E * h * wave)) ** (-hurst / (1.0 + hurst))
        return float(pressure * A_0 / h * (1.0 / gamma + few))

    # Persson's diffusion of the pressure between the walls 0 and H, by 400 modes
    n = np.arange(1, 401)
    decay = 2.0 / (n * pi) * np.exp(-0.5 * (n * pi * E * parameters["slope"] / (2.0 * H)) ** 2)
    mode = decay * np.sin(n * pi * pressure / H)
    elastic, elastic_load = float(np.sum(mode[::2]) * 2.0), float(-np.sum((-1.0) ** n * mode))
    plastic = max(pressure / H - elastic_load, 0.0)
    yielding = 1.0 - elastic_load / (pressure / H)
    bearing = norm.pdf(norm.isf(pressure / H)) / (pressure / H)
    K_N = stiffness(pressure)
    start = log(pressure) - 6.0 * _NEGLIGIBLE_LOG
    s = -log(1.0 - x)  # loop of T = 1 - exp(-s) by Masing's rule
    loop = -2.0 * quad(lambda d: x - 2.0 * (1.0 - exp((d - s) / 2.0)), -s, s, **_QUADRATURE)[0]
    rho = 4.0 * shear / E
    return {
        "pressure": pressure,
        "K_N": K_N,
        "K_T": rho * K_N,
        "A_r": A_0 * (elastic + plastic),
        "elastic_fraction": elastic / (elastic + plastic),
        "K_loading": 1.0 / (1.0 / K_N + yielding * h / (pressure * A_0 * bearing)),
        "approach": quad(
            lambda t: exp(t) * A_0 / stiffness(exp(t)), start, log(pressure), epsrel=1e-12, limit=2000
        )[0],
        "eta_t": loop / (pi * x * s),
        "friction_limit": mu * pressure * A_0,
        "slip_length": mu * gamma * h / rho,
    }


def _evaluate_interface_table(p: Parameters, pressure: float) -> dict[str, float]:
    """Quantities of the interface law `table` at a nominal pressure [Pa]."""
    u, y = np.log(p["table.pressure"]), np.log(p["table.stiffness"])
    chords = np.diff(y) / np.diff(u)
    slopes = PchipInterpolator(u, y).derivative()(u)
    slopes[[0, -1]] = min(chords[0], 1.0), chords[-1]
    inside = min(max(log(pressure), u[0]), u[-1])
    below = slopes[0] * min(log(pressure) - u[0], 0.0)
    K_N = p["A_0"] * p["table.factor"] * exp(CubicHermiteSpline(u, y, slopes)(inside) + below)
    mu, x, n = p["mu"], p["traction_ratio"], (y[-1] - y[0]) / (u[-1] - u[0])

    def shear_displacement(force: float) -> float:
        """Tangential displacement [m] at a shear force [N], for the loss factor."""
        return (1.0 - (1.0 - force) ** (1.0 - n)) / (1.0 - n)

    # Masing's loop between -x and x, at forces over mu F
    loop = quad(lambda t: 4.0 * shear_displacement((x + t) / 2.0), -x, x, **_QUADRATURE)[
        0
    ] - 4.0 * x * shear_displacement(x)
    return {
        "pressure": pressure,
        "K_N": K_N,
        "K_T": p["table.ratio"] * K_N,
        "eta_t": -loop / (pi * x * shear_displacement(x)),
        "friction_limit": mu * pressure * p["A_0"],
    }


def _evaluate_catalogue_drive(p: Parameters, wind_up: float) -> dict[str, float]:
    """Torque [N.m] and stiffness [N.m/rad] of a catalogue drive at a wind-up [rad]."""
    first = p["T1"] / p["K1"]
    second = first + (p["T2"] - p["T1"]) / p["K2"]

    def stiffness(angle: float) -> float:
        """Stiffness [N.m/rad] of the catalogue lines with smoothed corners at an angle [rad]."""
        value = p["K1"]
        for corner, before, after in ((first, "K1", "K2"), (second, "K2", "K3")):
            t = min(max((angle / corner - 1.0 + p["corner"]) / (2.0 * p["corner"]), 0.0), 1.0)
            value += (p[after] - p[before]) * t**2 * (3.0 - 2.0 * t)
        return float(value)

    ends = [0.0, *(c * (1.0 + s * p["corner"]) for c in (first, second) for s in (-1.0, 1.0)), inf]
    edges = [min(e, wind_up) for e in ends]
    torque = sum(quad(stiffness, a, b, **_QUADRATURE)[0] for a, b in pairwise(edges) if b > a)
    return {"wind_up": wind_up, "tau": torque, "K_WTS": stiffness(wind_up)}


def _evaluate_measured_drive(p: Parameters, wind_up: float) -> dict[str, float]:
    """Torque [N.m] and stiffness [N.m/rad] of a drive with a measured torque-angle table, at a wind-up [rad].

    The curve is a quintic Hermite spline. The stiffnesses at the points are those of PCHIP; where it stays
    monotone, the second derivative is then made continuous.
    """
    x, y = (np.array([0.0, *p[name]]) for name in ("table.angle", "table.torque"))
    odd = PchipInterpolator(np.concatenate([-x[:0:-1], x]), np.concatenate([-y[:0:-1], y]))
    stiffness = odd(x, 1)
    bends = [odd(x[:-1] + 1e-9 * np.diff(x), 2), odd(x[1:] - 1e-9 * np.diff(x), 2)]  # both ends of segments
    h = np.diff(x)
    inner = (h[1:] * bends[1][:-1] + h[:-1] * bends[0][1:]) / (h[:-1] + h[1:])
    bend = np.concatenate([[0.0], inner, bends[1][-1:]])
    curve = BPoly.from_derivatives(x, np.column_stack([y, stiffness, bend]))
    return {"wind_up": wind_up, "tau": float(curve(wind_up)), "K_WTS": float(curve(wind_up, 1))}


_STEEL = {"side1.E": 2.06e11, "side1.nu": 0.26, "side2.E": 2.19e11, "side2.nu": 0.3}
"""Elastic constants of the two bodies in several cases."""
_ZHAO = {
    "surface.D": 1.42,
    "surface.G": 1.21e-8,
    "surface.gamma": 1.5,
    "side1.E": 1.5e11,
    "side1.nu": 0.28,
    "side2.E": 2.1e11,
    "side2.nu": 0.3,
    "H": 1.96e9,
    "mu": 0.3,
    "traction_ratio": 0.5,
    "A_0": 0.045,
    "mass": 60.0,
    "critical_area": "continuity",
    "spot_stiffness": "hertz",
}
"""Parameters of the cases of Zhao 2018."""
_HU = {
    "surface.D": 2.5304,
    "surface.G": 2.4248e-7,
    "surface.gamma": 1.5,
    "surface.r_m": 2e-5,
    "surface.s_min": 1e-17,
    **_STEEL,
    "sigma_y": 835e6,
    "mu": 0.15,
    "traction_ratio": 0.4,
    "shear_traction": 5e7,
    "A_0": 1e-3,
    "traction": "ratio",
    "reading": "corrected",
}
"""Parameters of the cases of Hu 2023."""
_YU = {
    "surface1.D": 1.46,
    "surface1.G": 1e-10,
    "surface2.D": 1.56,
    "surface2.G": 3e-10,
    "surface.gamma": 1.5,
    "e": 0.2,
    "lambda": 0.6,
    **_STEEL,
    "sigma_y": 235e6,
    "mu": 0.1,
    "traction_ratio": 0.3,
    "A_0": 1e-4,
    "rigid_flat": True,
    "plastic_area": "geometric",
}
"""Parameters of the cases of Yu 2022."""
_ROUGHNESS = {
    "h": 1.5e-6,
    "gamma": 0.45,
    "longest_wave": 1e-3,
    "hurst": 0.8,
    "slope": 0.005,
    **_STEEL,
    "H": 2e9,
    "mu": 0.15,
    "traction_ratio": 0.3,
    "A_0": 1e-3,
}
"""Parameters of the cases of the law `roughness`."""
_INTERFACE_TABLE = {
    "table.pressure": [1e5, 4e5, 1e6, 5e6, 2e7],
    "table.stiffness": [4e11, 1.1e12, 1.6e12, 1.6e12, 9e12],
    "table.ratio": 0.7,
    "table.factor": 1.2,
    "mu": 0.15,
    "traction_ratio": 0.3,
    "A_0": 1e-3,
}
"""Parameters of the cases of the interface law `table`."""
_CATALOGUE = {"K1": 4700.0, "K2": 6100.0, "K3": 7100.0, "T1": 2.0, "T2": 6.9, "corner": 0.04}
"""Parameters of the case of a catalogue drive."""
_TABLE = {
    "table.torque": [0.5, 1.0, 2.0, 4.0, 7.0, 10.0],
    "table.angle": [2.2e-4, 4.1e-4, 7.2e-4, 1.2e-3, 1.75e-3, 2.2e-3],
}
"""Parameters of the case of a measured drive."""
_Case = tuple[str, Callable[[Parameters, float], dict[str, float]], Parameters, Sequence[float]]
"""Case of the reference table: law, function, parameters, arguments."""
_CASES: Sequence[_Case] = (
    ("zhao2018", _evaluate_zhao2018, _ZHAO, (4e-9, 2e-8, 1e-6, 1e-4)),
    ("zhao2018", _evaluate_zhao2018, _ZHAO | {"critical_area": "printed"}, (3e-6, 1e-4)),
    (
        "zhao2018",
        _evaluate_zhao2018,
        _ZHAO | {"critical_area": "yield", "spot_stiffness": "family"},
        (3e-5, 1e-3),
    ),
    ("hu2023", _evaluate_hu2023, _HU, (1e-14, 1e-12, 1e-10, 1e-8)),
    ("hu2023", _evaluate_hu2023, _HU | {"traction": "real_area"}, (1e-12, 1e-10, 1e-8)),
    ("hu2023", _evaluate_hu2023, _HU | {"reading": "printed"}, (1e-14, 1e-12)),
    ("hu2023", _evaluate_hu2023, _HU | {"reading": "printed", "traction": "real_area"}, (1e-12, 1e-10)),
    ("yu2022", _evaluate_yu2022, _YU, (1e-12, 1e-10, 1e-7, 1e-4)),
    (
        "yu2022",
        _evaluate_yu2022,
        _YU | {"rigid_flat": False, "plastic_area": "kogut_etsion", "e": 0.5},
        (1e-10, 1e-7),
    ),
    ("roughness", _evaluate_roughness_law, _ROUGHNESS, (1e4, 1e6, 1e8)),
    ("roughness", _evaluate_roughness_law, _ROUGHNESS | {"slope": 0.02}, (1e6, 1e8)),
    ("table", _evaluate_interface_table, _INTERFACE_TABLE, (1e4, 3e5, 8e5, 2e6, 1e7, 5e7)),
    ("catalogue", _evaluate_catalogue_drive, _CATALOGUE, (2e-4, 4.2e-4, 9e-4, 1.2e-3, 2e-3)),
    ("table", _evaluate_measured_drive, _TABLE, (2.2e-4, 3e-4, 9e-4, 1.2e-3, 1.5e-3)),
)
"""(law, function, parameters, arguments of the function) of each case; every choice of a law has one."""
_HEAD = """\
# Reference values of all laws, without the package: the equations of the papers with the corrections of
# docs/errata.md, summed by quadrature. Made by
#   python -m jointfmu_tools.studies.published.law_quadrature
# SI units; the first column of each case is the argument.
"""
"""Head of the file models/reference/laws.toml."""


def format_reference_table() -> Iterator[str]:
    """Lines of models/reference/laws.toml: reference values of all laws."""
    yield _HEAD
    for law, evaluate, parameters, arguments in _CASES:
        rows = [evaluate(parameters, argument) for argument in arguments]
        yield f'[[case]]\nlaw = "{law}"\n[case.parameters]'
        yield from (f'"{name}" = {_format_toml(value)}' for name, value in parameters.items())
        yield "[case.values]"
        yield from (f"{name} = {_format_toml([row[name] for row in rows])}" for name in rows[0])
        yield ""


def _format_toml(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_format_toml, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else f"{value:.13g}" if value else "0.0"


if __name__ == "__main__":
    print("\n".join(format_reference_table()), end="")
