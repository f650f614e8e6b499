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

LawParameters = Mapping[str, Any]
"""Values of the parameters of a law, by structured name."""
SpotFunction = Callable[[float], float]
"""Quantity of one contact spot as a function of its area [m2]."""

_QUADRATURE_SETTINGS = {"epsabs": 0.0, "epsrel": 1e-12, "limit": 400}
"""Settings of the quadrature: relative accuracy and number of subdivisions."""
_LOG_INTEGRAL_OVER_NEGLECTED_PART = 40.0
"""Logarithm of the ratio of a whole integral to a part that is left out [1]: 4e-18."""
_KOGUT_ETSION_STAGE1, _KOGUT_ETSION_STAGE2 = (0.93, 1.136, 1.03, 1.425), (0.94, 1.146, 1.40, 1.263)
"""Kogut and Etsion 2002: area/a_c = m (w/w_c)^n, load/f_c = c (w/w_c)^d as (m, n, c, d)."""
_STAGE1_END_DEFORMATION, _STAGE2_END_DEFORMATION = 6.0, 110.0
"""Deformations w/w_c [1] at the ends of both stages."""


def _contact_moduli(parameters: LawParameters) -> tuple[float, float]:
    """Contact modulus E* and contact shear modulus G' [Pa] of the two bodies of a contact."""
    sides = [(parameters[f"{side}.E"], parameters[f"{side}.nu"]) for side in ("side1", "side2")]
    return (
        1.0 / sum((1.0 - nu**2) / E for E, nu in sides),
        1.0 / sum((2.0 - nu) * 2.0 * (1.0 + nu) / E for E, nu in sides),
    )


def _integrate_over_spots(
    spot_quantity: SpotFunction, spot_density: SpotFunction, area_limits: Sequence[float]
) -> float:
    """Integral of spot_quantity(a) spot_density(a) over ln a, with the spot area a.

    area_limits : ascending areas [m2], from the lower to the upper limit; between two of them, the integrand
        is smooth
    """
    total = 0.0
    for low, high in pairwise(area_limits):
        if high > low:
            total += quad(
                lambda t: spot_quantity(exp(t)) * spot_density(exp(t)),
                log(low),
                log(high),
                **_QUADRATURE_SETTINGS,
            )[0]
    return total


def _integrate_over_sticking_spots(
    spot_quantity: SpotFunction,
    traction_ratio: SpotFunction,
    spot_density: SpotFunction,
    min_area: float,
    max_area: float,
) -> float:
    """Integral of spot_quantity(a) (1 - x(a))^(1/3) over the spots that do not slip, with the spot area a.

    traction_ratio : tangential force over friction limit x(a) [1] of a spot, decreasing with its area;
        spots with x >= 1 slip
    """
    if max_area <= min_area or traction_ratio(max_area) >= 1.0:
        return 0.0
    onset = (
        min_area
        if traction_ratio(min_area) <= 1.0
        else exp(brentq(lambda t: traction_ratio(exp(t)) - 1.0, log(min_area), log(max_area), xtol=1e-14))
    )

    def integrand(
        cube_root_of_log_ratio: float,
    ) -> float:  # ln a = ln onset + y^3 removes the cube root at the onset
        """Integrand after the substitution ln(a / onset) = y^3, which removes a cube root at the onset."""
        a = onset * exp(cube_root_of_log_ratio**3)
        return (
            3.0
            * cube_root_of_log_ratio**2
            * spot_quantity(a)
            * max(1.0 - traction_ratio(a), 0.0) ** (1.0 / 3.0)
            * spot_density(a)
        )

    return float(quad(integrand, 0.0, log(max_area / onset) ** (1.0 / 3.0), **_QUADRATURE_SETTINGS)[0])


def _evaluate_zhao2018(parameters: LawParameters, largest_area: float) -> dict[str, float]:
    """Pressure, stiffnesses, damping by Zhao 2018, at the truncated area a'_L [m2] of the largest spot."""
    D, G, H, x = (
        parameters["surface.D"],
        parameters["surface.G"],
        parameters["H"],
        parameters["traction_ratio"],
    )
    root = sqrt(log(parameters["surface.gamma"]))
    E, shear = _contact_moduli(parameters)

    def domain_extension_residual(extension_factor: float) -> float:
        """Difference of both sides of Eq. 3 of Zhao 2018 for a domain extension factor psi [1]."""
        return (
            extension_factor ** (1.0 - D / 2.0)
            - (1.0 + extension_factor ** (-D / 2.0)) ** ((D - 2.0) / D)
            - (2.0 - D) / D
        )

    psi = brentq(domain_extension_residual, 1.5, 3.0, xtol=1e-15)

    def deformation(a: float) -> float:
        """Deformation [m] of a contact spot of truncated area a [m2] (Zhao 2018, Eq. 5)."""
        return 2.0 ** (3.0 - D) * G ** (D - 1.0) * root * pi ** (D / 2.0 - 1.0) * a ** (1.0 - D / 2.0)

    def radius(a: float) -> float:
        """Radius of curvature [m] of a contact spot of truncated area a [m2] (Zhao 2018, Eq. 6)."""
        return a ** (D / 2.0) / (2.0 ** (4.0 - D) * pi ** (D / 2.0) * G ** (D - 1.0) * root)

    def elastic_load(a: float) -> float:
        """Normal load [N] of an elastic contact spot of truncated area a [m2] (Zhao 2018, Eq. 7)."""
        return 4.0 / 3.0 * E * sqrt(radius(a)) * deformation(a) ** 1.5

    def critical_area_residual(a: float) -> float:
        """Residual of the equation for the area between elastic and plastic spots, at an area a [m2].

        The residual is log(left side/right side).

        The parameter `critical_area` selects the equation.
        """
        if parameters["critical_area"] == "continuity":
            return log(elastic_load(a) / (H * a))
        strength = 0.454 + 0.41 * parameters["side1.nu"]
        return log((pi * strength * H / (2.0 * E)) ** 2 * radius(a) / deformation(a))

    if parameters["critical_area"] == "printed":
        critical = 2.0 * (2.0 * E / H) ** (2.0 / (D - 1.0)) * G**2  # Eq. 4
    else:
        critical = exp(brentq(lambda t: critical_area_residual(exp(t)), -150.0, 50.0, xtol=1e-14))

    def spot_density(a: float) -> float:
        """Number of contact spots per unit of ln(area), at a truncated area a [m2] (Zhao 2018, Eq. 2)."""
        return D / 2.0 * psi ** (1.0 - D / 2.0) * (largest_area / a) ** (D / 2.0)

    def normal_stiffness(a: float) -> float:
        """Normal stiffness [N/m] of an elastic contact spot of truncated area a [m2].

        Eq. 13 of Zhao 2018, or 2 E* r with the contact modulus E* and the radius r of the real contact.
        """
        if parameters["spot_stiffness"] == "family":
            return 4.0 * E * (3.0 - D) / (3.0 * sqrt(2.0 * pi) * (2.0 - D)) * sqrt(a)
        return 2.0 * E * sqrt(a / (2.0 * pi))

    end = min(critical, largest_area)

    def sum_plastic_spots(spot_quantity: SpotFunction, integrand_exponent: float) -> float:
        """Sum of a quantity of a spot over all plastic spots."""
        return _integrate_over_spots(
            spot_quantity,
            spot_density,
            [end * exp(-_LOG_INTEGRAL_OVER_NEGLECTED_PART / integrand_exponent), end],
        )

    def sum_elastic_spots(spot_quantity: SpotFunction) -> float:
        """Sum of a quantity of a spot over all elastic spots."""
        return _integrate_over_spots(spot_quantity, spot_density, [critical, largest_area])

    load = sum_plastic_spots(lambda a: H * a, 1.0 - D / 2.0) + sum_elastic_spots(elastic_load)
    area = sum_plastic_spots(lambda a: a, 1.0 - D / 2.0) + sum_elastic_spots(lambda a: a / 2.0)
    plastic_work = sum_plastic_spots(lambda a: H * a * deformation(a), 2.0 - D)  # Eq. 15
    elastic_work = sum_elastic_spots(
        lambda a: 8.0 / 15.0 * E * sqrt(radius(a)) * deformation(a) ** 2.5
    )  # Eq. 17
    K_N = sum_elastic_spots(normal_stiffness)
    K_T = sum_elastic_spots(lambda a: 8.0 * shear * sqrt(a / (2.0 * pi)) * (1.0 - x) ** (1.0 / 3.0))  # Eq. 21
    eta_n = plastic_work / elastic_work
    H1 = 1.0 - (1.0 - x) ** (5.0 / 3.0) - 5.0 * x / 6.0 * (1.0 + (1.0 - x) ** (2.0 / 3.0))
    H2 = 0.6 + 0.4 * (1.0 - x) ** (5.0 / 3.0) - (1.0 - x) ** (2.0 / 3.0)
    eta_t = 1.0 / (5.0 * pi / 12.0 * H2 / H1 - 1.0)
    return {
        "pressure": load / parameters["A_0"],
        "largest_spot": largest_area,
        "K_N": K_N,
        "K_T": K_T,
        "A_r": area,
        "W_NP": plastic_work,
        "W_NE": elastic_work,
        "C_N": eta_n * sqrt(parameters["mass"] * K_N),
        "C_T": eta_t * sqrt(parameters["mass"] * K_T),
        "eta_t": eta_t,
    }


def _evaluate_hu2023(parameters: LawParameters, largest_area: float) -> dict[str, float]:
    """Pressure, stiffnesses and real area by Hu 2023, at the area s_l [m2] of the largest contact spot."""
    D, s_min, A_0 = parameters["surface.D"], parameters["surface.s_min"], parameters["A_0"]
    E, shear = _contact_moduli(parameters)
    k, H = 0.454 + 0.41 * parameters["side1.nu"], 2.8 * parameters["sigma_y"]
    height = parameters["surface.G"] ** (D - 2.0) * sqrt(log(parameters["surface.gamma"]))
    R = parameters["surface.r_m"] ** (D - 1.0) / (2.0 ** (3.0 - D) * pi**2 * height)  # Eq. 5
    first_yield = (pi * k * H / (2.0 * E)) ** 2 * R  # Eq. 7
    s_ec = pi * R * first_yield
    f_ec = 4.0 / 3.0 * E * sqrt(R) * first_yield**1.5  # Eq. 9
    (m1, n1, c1, d1), (m2, n2, c2, d2) = _KOGUT_ETSION_STAGE1, _KOGUT_ETSION_STAGE2
    s1, s2 = m1 * _STAGE1_END_DEFORMATION**n1 * s_ec, m2 * _STAGE2_END_DEFORMATION**n2 * s_ec
    psi = 5.454 * exp((1.0 - D) / 0.628) + 1.499
    x = parameters["traction_ratio"]

    def spot_density(s: float) -> float:
        """Number of contact spots per unit of ln(area), at a spot area s [m2] (Hu 2023, Eq. 17)."""
        return (D - 1.0) / 2.0 * psi ** (1.5 - D / 2.0) * (largest_area / s) ** (D / 2.0 - 0.5)

    def elastic_load(s: float) -> float:
        """Normal load [N] of an elastic contact spot of area s [m2] (Hu 2023, Eq. 9)."""
        return 4.0 / 3.0 * E * (s / pi) ** 1.5 / R

    def spot_load(s: float) -> float:
        """Normal load [N] of a contact spot of area s [m2]: elastic, elastic-plastic or plastic.

        Hu 2023, Eqs. 9, 11, 12, 16.
        """
        if s <= s_ec:
            return elastic_load(s)
        if s <= s1:
            return f_ec * c1 * (s / (m1 * s_ec)) ** (d1 / n1)
        return f_ec * c2 * (s / (m2 * s_ec)) ** (d2 / n2) if s <= s2 else H * s

    def normal_stiffness(s: float) -> float:
        """Normal stiffness [N/m] of a contact spot of area s [m2], elastic or elastic-plastic.

        Hu 2023, Eqs. 29, 31, 32.
        """
        if s <= s_ec:
            return 2.0 * E * sqrt(s / pi)
        m, n, c, d = _KOGUT_ETSION_STAGE1 if s <= s1 else _KOGUT_ETSION_STAGE2
        return f_ec / first_yield * c * d * (s / (m * s_ec)) ** ((d - 1.0) / n)

    def full_stick_stiffness(s: float) -> float:
        """Tangential stiffness [N/m] of a contact spot of area s [m2] without slip."""
        return 8.0 * shear * sqrt(s / pi)

    def make_traction_ratio(load_function: SpotFunction) -> SpotFunction:
        """Make the function: spot area -> shear force over friction limit [1] of a spot.

        load_function : normal load [N] as a function of the spot area [m2]
        """
        return lambda s: parameters["shear_traction"] * s / (parameters["mu"] * load_function(s))

    def sum_all_spots(spot_quantity: SpotFunction, integrand_exponent: float) -> float:
        """Sum of a quantity over all spots, from zero area on."""
        low = min(s_ec, largest_area) * exp(
            -_LOG_INTEGRAL_OVER_NEGLECTED_PART / (integrand_exponent + 0.5 - D / 2.0)
        )
        return _integrate_over_spots(
            spot_quantity, spot_density, [low, *(min(e, largest_area) for e in (s_ec, s1, s2)), largest_area]
        )

    area = sum_all_spots(lambda s: s, 1.0)
    if (
        parameters["reading"] == "printed"
    ):  # Eq. 30: the antiderivative at s_l, that is minus the integral beyond it
        far = largest_area * exp(_LOG_INTEGRAL_OVER_NEGLECTED_PART / (D / 2.0 - 1.0))
        pressure = 4.0 * E * (3.0 - D) / (3.0 * pi**1.5 * R * (4.0 - D)) * sqrt(largest_area)
        near = largest_area * exp(-_LOG_INTEGRAL_OVER_NEGLECTED_PART)
        return {
            "pressure": pressure,
            "K_N": _integrate_over_spots(lambda s: 2.0 * E * sqrt(s / pi), spot_density, [largest_area, far]),
            "K_T": _integrate_over_spots(
                lambda s: full_stick_stiffness(s) * (1.0 - x) ** (1.0 / 3.0),
                spot_density,
                [largest_area, far],
            )
            if parameters["traction"] == "ratio"
            else _integrate_over_sticking_spots(
                full_stick_stiffness, make_traction_ratio(elastic_load), spot_density, near, largest_area
            ),
            "A_r": area,
        }
    edges = [max(s_min, min(e, largest_area)) for e in (s_min, s_ec, s1, s2)]
    if parameters["traction"] == "ratio":
        K_T = _integrate_over_spots(
            lambda s: full_stick_stiffness(s) * (1.0 - x) ** (1.0 / 3.0), spot_density, edges
        )
    else:
        K_T = sum(
            _integrate_over_sticking_spots(
                full_stick_stiffness, make_traction_ratio(spot_load), spot_density, low, high
            )
            for low, high in pairwise(edges)
        )
    return {
        "pressure": sum_all_spots(spot_load, 1.5) / A_0,
        "largest_spot": largest_area,
        "K_N": _integrate_over_spots(normal_stiffness, spot_density, edges),
        "K_T": K_T,
        "A_r": area,
    }


def _evaluate_yu2022(parameters: LawParameters, largest_area: float) -> dict[str, float]:
    """Pressure, normal stiffness, real area by Yu 2022, at the real area a_l [m2] of the largest spot."""
    e, root = parameters["e"], sqrt(log(parameters["surface.gamma"]))
    compliance = (1.0 - parameters["side1.nu"] ** 2) / parameters["side1.E"]
    if not parameters["rigid_flat"]:
        compliance += (1.0 - parameters["side2.nu"] ** 2) / parameters["side2.E"]
    E, H, k = 1.0 / compliance, 2.8 * parameters["sigma_y"], 0.454 + 0.41 * parameters["side1.nu"]
    first, second = ellipk(e**2), ellipe(e**2)
    slender = sqrt(1.0 - e**2)
    f1, f2 = second / (first * slender), pi * sqrt(second) / (2.0 * first**1.5 * slender)  # Eqs. 22-23
    exponent = slender / 2.0 * (parameters["surface1.D"] + parameters["surface2.D"]) / 2.0  # Eqs. 42-43

    def spot_density(a: float) -> float:
        """Number of contact spots per unit of ln(area), at a spot area a [m2].

        The number is lambda times Eq. 44 of Yu 2022, with the parameter `lambda`.
        """
        return parameters["lambda"] * exponent * (largest_area / a) ** exponent

    def radius(a: float) -> float:
        """Mean radius of curvature [m] of a contact spot of area a [m2] (Yu 2022, Eqs. 12, 13, 15)."""
        curvature = 0.0
        for side, sign in (("surface1", -1.0), ("surface2", 1.0)):
            D, G = parameters[f"{side}.D"], parameters[f"{side}.G"]
            axis = a ** (D / 2.0) * (1.0 - e**2) ** (sign * D / 4.0)
            curvature += 2.0 ** (4.0 - D) * pi ** (D / 2.0) * G ** (D - 1.0) * root / axis
        return 2.0 / curvature

    def yield_deformation(a: float) -> float:
        """Deformation at first yield [m] of a contact spot of area a [m2] (Yu 2022, Eq. 27)."""
        return first * second * radius(a) * (k * H / E) ** 2

    def area_over_yield_area(a: float) -> float:
        """Area of a spot over the area at which a spot of its curvature yields first [1]."""
        return a / (f1 * pi * radius(a) * yield_deformation(a))

    def stage_end_area(max_area_ratio: float) -> float:
        """Area [m2] of one spot at the end of the elastic stage or of an elastic-plastic stage.

        max_area_ratio : `area_over_yield_area` at this limit
        """
        return exp(
            brentq(lambda t: log(area_over_yield_area(exp(t)) / max_area_ratio), -250.0, 250.0, xtol=1e-13)
        )

    geometric = parameters["plastic_area"] == "geometric"
    (m1, n1, *_), (m2, n2, *_) = _KOGUT_ETSION_STAGE1, _KOGUT_ETSION_STAGE2
    limits = (
        (_STAGE1_END_DEFORMATION, _STAGE2_END_DEFORMATION)
        if geometric
        else (m1 * _STAGE1_END_DEFORMATION**n1, m2 * _STAGE2_END_DEFORMATION**n2)
    )
    a_nec, a_nepc, a_npc = stage_end_area(1.0), stage_end_area(limits[0]), stage_end_area(limits[1])

    def deformation(a: float) -> tuple[float, float, float]:
        """Deformation over yield deformation, w [1], of an elastic-plastic spot; constants c, d of its load.

        The load over the load at first yield is c w^d, with c and d of each stage (Kogut and Etsion 2002).
        """
        m, n, c, d = _KOGUT_ETSION_STAGE1 if a > a_nepc else _KOGUT_ETSION_STAGE2
        return (
            (area_over_yield_area(a), c, d)
            if geometric
            else ((area_over_yield_area(a) / m) ** (1.0 / n), c, d)
        )

    def spot_load(a: float) -> float:
        """Load [N] of a spot of area a: elastic, elastic-plastic in two stages, or plastic."""
        if a <= a_npc:
            return float(H * a)
        hertz = f2 * 4.0 / 3.0 * E * sqrt(radius(a))
        if a > a_nec:
            return float(hertz * (a / (f1 * pi * radius(a))) ** 1.5)
        w, c, d = deformation(a)
        return float(hertz * yield_deformation(a) ** 1.5 * c * w**d)

    def normal_stiffness(a: float) -> float:
        """Normal stiffness [N/m] of a spot of area a, elastic or elastic-plastic."""
        if a > a_nec:
            return float(2.0 * f2 * E * sqrt(a / (f1 * pi)))
        w, c, d = deformation(a)
        return float(f2 * 4.0 / 3.0 * E * sqrt(radius(a) * yield_deformation(a)) * c * d * w ** (d - 1.0))

    start = min(a_npc, largest_area) * exp(-_LOG_INTEGRAL_OVER_NEGLECTED_PART / (1.0 - exponent))
    edges = [min(a, largest_area) for a in (start, a_npc, a_nepc, a_nec, largest_area)]
    area = _integrate_over_spots(lambda a: a, spot_density, edges)
    return {
        "pressure": _integrate_over_spots(spot_load, spot_density, edges) / parameters["A_0"],
        "largest_spot": largest_area,
        "K_N": _integrate_over_spots(normal_stiffness, spot_density, edges[1:]),
        "A_r": area,
        "elastic_fraction": _integrate_over_spots(lambda a: a, spot_density, edges[3:]) / area,
    }


def _evaluate_roughness_law(parameters: LawParameters, pressure: float) -> dict[str, float]:
    """Stiffnesses and further quantities of the interface law `roughness` at a nominal pressure [Pa]."""
    E, shear = _contact_moduli(parameters)
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
    start = log(pressure) - 6.0 * _LOG_INTEGRAL_OVER_NEGLECTED_PART
    s = -log(1.0 - x)  # loop of T = 1 - exp(-s) by Masing's rule
    loop = -2.0 * quad(lambda d: x - 2.0 * (1.0 - exp((d - s) / 2.0)), -s, s, **_QUADRATURE_SETTINGS)[0]
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


def _evaluate_interface_table(parameters: LawParameters, pressure: float) -> dict[str, float]:
    """Stiffnesses and further quantities of the interface law `table` at a nominal pressure [Pa]."""
    u, y = np.log(parameters["table.pressure"]), np.log(parameters["table.stiffness"])
    chords = np.diff(y) / np.diff(u)
    slopes = PchipInterpolator(u, y).derivative()(u)
    slopes[[0, -1]] = min(chords[0], 1.0), chords[-1]
    inside = min(max(log(pressure), u[0]), u[-1])
    below = slopes[0] * min(log(pressure) - u[0], 0.0)
    K_N = (
        parameters["A_0"] * parameters["table.factor"] * exp(CubicHermiteSpline(u, y, slopes)(inside) + below)
    )
    mu, x, n = parameters["mu"], parameters["traction_ratio"], (y[-1] - y[0]) / (u[-1] - u[0])

    def shear_displacement(shear_force: float) -> float:
        """Tangential displacement at a shear force, both dimensionless, for the loss factor.

        shear_force : shear force over friction limit [1]

        The displacement is divided by friction limit over tangential stiffness.
        """
        return (1.0 - (1.0 - shear_force) ** (1.0 - n)) / (1.0 - n)

    # Masing's loop between -x and x, at forces over mu F
    loop = quad(lambda t: 4.0 * shear_displacement((x + t) / 2.0), -x, x, **_QUADRATURE_SETTINGS)[
        0
    ] - 4.0 * x * shear_displacement(x)
    return {
        "pressure": pressure,
        "K_N": K_N,
        "K_T": parameters["table.ratio"] * K_N,
        "eta_t": -loop / (pi * x * shear_displacement(x)),
        "friction_limit": mu * pressure * parameters["A_0"],
    }


def _evaluate_catalogue_drive(parameters: LawParameters, wind_up: float) -> dict[str, float]:
    """Torque [N.m] and stiffness [N.m/rad] of a catalogue drive at a wind-up [rad]."""
    first = parameters["T1"] / parameters["K1"]
    second = first + (parameters["T2"] - parameters["T1"]) / parameters["K2"]

    def stiffness(wind_up_angle: float) -> float:
        """Stiffness [N.m/rad] of the catalogue lines with smoothed corners at an angle [rad]."""
        value = parameters["K1"]
        for corner, before, after in ((first, "K1", "K2"), (second, "K2", "K3")):
            t = min(
                max(
                    (wind_up_angle / corner - 1.0 + parameters["corner"]) / (2.0 * parameters["corner"]), 0.0
                ),
                1.0,
            )
            value += (parameters[after] - parameters[before]) * t**2 * (3.0 - 2.0 * t)
        return float(value)

    ends = [0.0, *(c * (1.0 + s * parameters["corner"]) for c in (first, second) for s in (-1.0, 1.0)), inf]
    edges = [min(e, wind_up) for e in ends]
    torque = sum(quad(stiffness, a, b, **_QUADRATURE_SETTINGS)[0] for a, b in pairwise(edges) if b > a)
    return {"wind_up": wind_up, "tau": torque, "K_WTS": stiffness(wind_up)}


def _evaluate_measured_drive(parameters: LawParameters, wind_up: float) -> dict[str, float]:
    """Torque [N.m] and stiffness [N.m/rad] of a drive with a measured torque-angle table, at a wind-up [rad].

    The curve is a quintic Hermite spline through the points of the table. Its stiffness at a point is that of
    PCHIP, and its second derivative is continuous there.
    """
    x, y = (np.array([0.0, *parameters[name]]) for name in ("table.angle", "table.torque"))
    odd = PchipInterpolator(np.concatenate([-x[:0:-1], x]), np.concatenate([-y[:0:-1], y]))
    stiffness = odd(x, 1)
    bends = [odd(x[:-1] + 1e-9 * np.diff(x), 2), odd(x[1:] - 1e-9 * np.diff(x), 2)]  # both ends of segments
    h = np.diff(x)
    inner = (h[1:] * bends[1][:-1] + h[:-1] * bends[0][1:]) / (h[:-1] + h[1:])
    bend = np.concatenate([[0.0], inner, bends[1][-1:]])
    curve = BPoly.from_derivatives(x, np.column_stack([y, stiffness, bend]))
    return {"wind_up": wind_up, "tau": float(curve(wind_up)), "K_WTS": float(curve(wind_up, 1))}


_STEEL_PAIR_CONSTANTS = {"side1.E": 2.06e11, "side1.nu": 0.26, "side2.E": 2.19e11, "side2.nu": 0.3}
"""Elastic constants of the two bodies in several cases."""
_ZHAO2018_PARAMETERS = {
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
_HU2023_PARAMETERS = {
    "surface.D": 2.5304,
    "surface.G": 2.4248e-7,
    "surface.gamma": 1.5,
    "surface.r_m": 2e-5,
    "surface.s_min": 1e-17,
    **_STEEL_PAIR_CONSTANTS,
    "sigma_y": 835e6,
    "mu": 0.15,
    "traction_ratio": 0.4,
    "shear_traction": 5e7,
    "A_0": 1e-3,
    "traction": "ratio",
    "reading": "corrected",
}
"""Parameters of the cases of Hu 2023."""
_YU2022_PARAMETERS = {
    "surface1.D": 1.46,
    "surface1.G": 1e-10,
    "surface2.D": 1.56,
    "surface2.G": 3e-10,
    "surface.gamma": 1.5,
    "e": 0.2,
    "lambda": 0.6,
    **_STEEL_PAIR_CONSTANTS,
    "sigma_y": 235e6,
    "mu": 0.1,
    "traction_ratio": 0.3,
    "A_0": 1e-4,
    "rigid_flat": True,
    "plastic_area": "geometric",
}
"""Parameters of the cases of Yu 2022."""
_ROUGHNESS_LAW_PARAMETERS = {
    "h": 1.5e-6,
    "gamma": 0.45,
    "longest_wave": 1e-3,
    "hurst": 0.8,
    "slope": 0.005,
    **_STEEL_PAIR_CONSTANTS,
    "H": 2e9,
    "mu": 0.15,
    "traction_ratio": 0.3,
    "A_0": 1e-3,
}
"""Parameters of the cases of the law `roughness`."""
_INTERFACE_TABLE_PARAMETERS = {
    "table.pressure": [1e5, 4e5, 1e6, 5e6, 2e7],
    "table.stiffness": [4e11, 1.1e12, 1.6e12, 1.6e12, 9e12],
    "table.ratio": 0.7,
    "table.factor": 1.2,
    "mu": 0.15,
    "traction_ratio": 0.3,
    "A_0": 1e-3,
}
"""Parameters of the cases of the interface law `table`."""
_CATALOGUE_DRIVE_PARAMETERS = {"K1": 4700.0, "K2": 6100.0, "K3": 7100.0, "T1": 2.0, "T2": 6.9, "corner": 0.04}
"""Parameters of the case of a catalogue drive."""
_MEASURED_DRIVE_PARAMETERS = {
    "table.torque": [0.5, 1.0, 2.0, 4.0, 7.0, 10.0],
    "table.angle": [2.2e-4, 4.1e-4, 7.2e-4, 1.2e-3, 1.75e-3, 2.2e-3],
}
"""Parameters of the case of a measured drive."""
_ReferenceCase = tuple[
    str, Callable[[LawParameters, float], dict[str, float]], LawParameters, Sequence[float]
]
"""Case of the reference table: law, function, parameters, arguments."""
_REFERENCE_CASES: Sequence[_ReferenceCase] = (
    ("zhao2018", _evaluate_zhao2018, _ZHAO2018_PARAMETERS, (4e-9, 2e-8, 1e-6, 1e-4)),
    ("zhao2018", _evaluate_zhao2018, _ZHAO2018_PARAMETERS | {"critical_area": "printed"}, (3e-6, 1e-4)),
    (
        "zhao2018",
        _evaluate_zhao2018,
        _ZHAO2018_PARAMETERS | {"critical_area": "yield", "spot_stiffness": "family"},
        (3e-5, 1e-3),
    ),
    ("hu2023", _evaluate_hu2023, _HU2023_PARAMETERS, (1e-14, 1e-12, 1e-10, 1e-8)),
    ("hu2023", _evaluate_hu2023, _HU2023_PARAMETERS | {"traction": "real_area"}, (1e-12, 1e-10, 1e-8)),
    ("hu2023", _evaluate_hu2023, _HU2023_PARAMETERS | {"reading": "printed"}, (1e-14, 1e-12)),
    (
        "hu2023",
        _evaluate_hu2023,
        _HU2023_PARAMETERS | {"reading": "printed", "traction": "real_area"},
        (1e-12, 1e-10),
    ),
    ("yu2022", _evaluate_yu2022, _YU2022_PARAMETERS, (1e-12, 1e-10, 1e-7, 1e-4)),
    (
        "yu2022",
        _evaluate_yu2022,
        _YU2022_PARAMETERS | {"rigid_flat": False, "plastic_area": "kogut_etsion", "e": 0.5},
        (1e-10, 1e-7),
    ),
    ("roughness", _evaluate_roughness_law, _ROUGHNESS_LAW_PARAMETERS, (1e4, 1e6, 1e8)),
    ("roughness", _evaluate_roughness_law, _ROUGHNESS_LAW_PARAMETERS | {"slope": 0.02}, (1e6, 1e8)),
    ("table", _evaluate_interface_table, _INTERFACE_TABLE_PARAMETERS, (1e4, 3e5, 8e5, 2e6, 1e7, 5e7)),
    ("catalogue", _evaluate_catalogue_drive, _CATALOGUE_DRIVE_PARAMETERS, (2e-4, 4.2e-4, 9e-4, 1.2e-3, 2e-3)),
    ("table", _evaluate_measured_drive, _MEASURED_DRIVE_PARAMETERS, (2.2e-4, 3e-4, 9e-4, 1.2e-3, 1.5e-3)),
)
"""(law, function, parameters, arguments of the function) of each case; every choice of a law has one."""
_FILE_HEADER = """\
# Reference values of all laws, without the package: the equations of the papers with the corrections of
# docs/errata.md, summed by quadrature. Made by
#   python -m jointfmu_tools.studies.published.law_quadrature
# SI units; the first column of each case is the argument.
"""
"""Head of the file models/reference/laws.toml."""


def format_reference_table() -> Iterator[str]:
    """Lines of models/reference/laws.toml: reference values of all laws."""
    yield _FILE_HEADER
    for law, evaluate, parameters, arguments in _REFERENCE_CASES:
        rows = [evaluate(parameters, argument) for argument in arguments]
        yield f'[[case]]\nlaw = "{law}"\n[case.parameters]'
        yield from (f'"{name}" = {_format_toml(value)}' for name, value in parameters.items())
        yield "[case.values]"
        yield from (f"{name} = {_format_toml([row[name] for row in rows])}" for name in rows[0])
        yield ""


def _format_toml(toml_value: object) -> str:
    if isinstance(toml_value, list):
        return f"[{', '.join(map(_format_toml, toml_value))}]"
    if isinstance(toml_value, bool):
        return str(toml_value).lower()
    return f'"{toml_value}"' if isinstance(toml_value, str) else f"{toml_value:.13g}" if toml_value else "0.0"


if __name__ == "__main__":
    print("\n".join(format_reference_table()), end="")
