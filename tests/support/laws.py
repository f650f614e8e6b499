"""Default and random laws of the tests, and the quadrature against which they are compared."""

from collections.abc import Callable, Mapping
from itertools import pairwise
from math import exp, log
from typing import Any, TypeVar

from hypothesis import strategies as st
from scipy.integrate import quad

from jointfmu.contact.laws.hu2023 import Hu2023
from jointfmu.contact.laws.yu2022 import Yu2022
from jointfmu.contact.laws.zhao2018 import Zhao2018
from jointfmu.contact.surface import (
    ArealSurface,
    CommonFlankParameters,
    ElasticConstants,
    FlankSurface,
    ProfileSurface,
)
from jointfmu.quantity import build_parameter_set, flatten_parameters

T = TypeVar("T")

QUAD = 1e-9
"""Relative tolerance against `over_spots`: 100 times the requested tolerance of the adaptive quadrature."""

# Table 1 and section 2 of Zhao 2018; friction, area and mass are not published.
ZHAO = Zhao2018(
    surface=ProfileSurface(D=1.42, G=1.21e-8, gamma=1.5),
    side1=ElasticConstants(E=1.5e11, nu=0.28),
    side2=ElasticConstants(E=1.5e11, nu=0.28),
    H=1.96e9,
    mu=0.3,
    traction_ratio=0.5,
    A_0=0.045,
    mass=60.0,
    spot_stiffness="family",  # Eq. 13
)

# Section 2.3 of Hu 2023; gamma, base radius, smallest spot and yield strength are not published.
HU = Hu2023(
    surface=ArealSurface(D=2.5304, G=2.4248e-7, gamma=1.5, r_m=2e-5, s_min=1e-17),
    side1=ElasticConstants(E=2.09e11, nu=0.295),
    side2=ElasticConstants(E=2.19e11, nu=0.3),
    sigma_y=835e6,
    mu=0.15,
    traction_ratio=0.4,
    shear_traction=5e7,
    A_0=1e-3,
)

# Table 1 and section 5.2 of Yu 2022; gamma, lambda, friction and the area are not published.
YU = Yu2022(
    surface1=FlankSurface(D=1.46, G=1e-10),
    surface2=FlankSurface(D=1.46, G=1e-10),
    surface=CommonFlankParameters(gamma=1.5),
    e=0.2,
    lambda_=0.6,
    side1=ElasticConstants(E=2.06e11, nu=0.26),
    side2=ElasticConstants(E=2.06e11, nu=0.26),
    sigma_y=235e6,
    mu=0.1,
    traction_ratio=0.3,
    A_0=1e-4,
)

LAWS = {"zhao": ZHAO, "hu": HU, "yu": YU}


def changed(law: T, values: Mapping[str, Any]) -> T:
    """Copy of a law with other values, by structured name."""
    return build_parameter_set(type(law), flatten_parameters(law) | dict(values))


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(log(low), log(high)).map(exp)


def bodies() -> dict[str, st.SearchStrategy[float]]:
    moduli, ratios = decades(1e10, 1e12), st.floats(0.0, 0.45)
    return {"side1.E": moduli, "side1.nu": ratios, "side2.E": moduli, "side2.nu": ratios}


# Small D spreads the regimes over tens of decades: D >= 1.1 keeps the plain areas inside floats.
zhao_laws = st.fixed_dictionaries(
    {
        "surface.D": st.floats(1.1, 1.8),
        "surface.G": decades(1e-12, 1e-7),
        "surface.gamma": st.floats(1.1, 5.0),
        **bodies(),
        "H": decades(3e8, 1e10),
        "mu": st.floats(0.05, 1.0),
        "traction_ratio": st.floats(0.0, 0.99),
        "A_0": decades(1e-6, 1.0),
        "mass": decades(0.1, 1e4),
        "critical_area": st.sampled_from(["continuity", "printed", "yield"]),
        "spot_stiffness": st.sampled_from(["family", "hertz"]),
    }
).map(lambda values: changed(ZHAO, values))

hu_laws = st.fixed_dictionaries(
    {
        "surface.D": st.floats(2.05, 2.95),
        "surface.G": decades(1e-9, 1e-6),
        "surface.gamma": st.floats(1.1, 5.0),
        "surface.r_m": decades(1e-6, 1e-4),
        "surface.s_min": decades(1e-22, 1e-11),
        **bodies(),
        "sigma_y": decades(1e8, 3e9),
        "mu": st.floats(0.05, 1.0),
        "traction_ratio": st.floats(0.0, 0.99),
        "A_0": decades(1e-6, 1.0),
    }
).map(lambda values: changed(HU, values))

yu_laws = st.fixed_dictionaries(
    {
        "surface1.D": st.floats(1.1, 1.8),
        "surface1.G": decades(1e-12, 1e-8),
        "surface2.D": st.floats(1.1, 1.8),
        "surface2.G": decades(1e-12, 1e-8),
        "surface.gamma": st.floats(1.1, 5.0),
        **bodies(),
        "e": st.floats(0.0, 0.95),
        "lambda": st.floats(0.05, 1.0),
        "sigma_y": decades(1e8, 3e9),
        "A_0": decades(1e-6, 1.0),
        "rigid_flat": st.booleans(),
        "plastic_area": st.sampled_from(["geometric", "kogut_etsion"]),
    }
).map(lambda values: changed(YU, values))

RANDOM = {"zhao": zhao_laws, "hu": hu_laws, "yu": yu_laws}


def over_spots(
    spot: Callable[[float], float],
    count: Callable[[float], float],
    edges: list[float],
    largest: float,
) -> float:
    """Sum of spot(a) over all spots: adaptive quadrature in ln a between the edges, up to the largest spot.

    count : a n(a), the number of spots per unit of ln a
    """

    def integrand(t: float) -> float:
        a = exp(t)
        return spot(a) * count(a)

    logs = [log(min(edge, largest)) for edge in (*edges, largest)]
    options = {"epsabs": 0.0, "epsrel": 1e-11, "limit": 200}
    return sum(quad(integrand, low, high, **options)[0] for low, high in pairwise(logs) if high > low)


def open_end(edge: float, exponent: float) -> float:
    """Area below which exp(exponent ln a) contributes less than 1e-16 of the integral up to the edge."""
    return edge * exp(-37.0 / exponent)
