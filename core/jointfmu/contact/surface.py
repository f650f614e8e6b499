"""Parameters of rough surfaces and materials, and constants derived from them."""

from dataclasses import dataclass

import numpy as np

from ..quantity import CheckedParameters, Number, quantity_field


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankSurface(CheckedParameters):
    """Fractal parameters of one tooth flank or one direction of a surface texture (Yu 2022)."""

    D: float = quantity_field("1", "fractal dimension of the profile", gt=1.0, lt=2.0)
    G: float = quantity_field("m", "fractal roughness", gt=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileSurface(FlankSurface):
    """Self-affine surface, with the fractal parameters of a profile (Zhao 2018, Yu 2022)."""

    gamma: float = quantity_field("1", "frequency ratio of the Weierstrass-Mandelbrot function", gt=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealSurface(CheckedParameters):
    """Self-affine surface, with the fractal parameters of the surface (Hu 2023).

    The fractal dimension D of the surface is 1 + that of a profile.
    """

    D: float = quantity_field("1", "fractal dimension of the surface", gt=2.0, lt=3.0)
    G: float = quantity_field("m", "fractal roughness", gt=0.0)
    gamma: float = quantity_field("1", "frequency ratio of the Weierstrass-Mandelbrot function", gt=1.0)
    r_m: float = quantity_field("m", "base radius of an asperity", gt=0.0)
    s_min: float = quantity_field("m2", "area of the smallest spot", gt=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class CommonFlankParameters(CheckedParameters):
    """Frequency ratio gamma of the Weierstrass-Mandelbrot function, which both flanks have in common."""

    gamma: float = quantity_field("1", "frequency ratio of the Weierstrass-Mandelbrot function", gt=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticConstants(CheckedParameters):
    """Isotropic linear elastic constants of one body."""

    E: float = quantity_field("Pa", "Young's modulus", gt=0.0)
    nu: float = quantity_field("1", "Poisson ratio", gt=-1.0, le=0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticPlasticConstants(ElasticConstants):
    """Isotropic linear elastic constants and yield strength of one body."""

    sigma_y: float = quantity_field("Pa", "yield strength", gt=0.0)


def contact_modulus(side1: ElasticConstants, side2: ElasticConstants) -> Number:
    """Contact modulus E* [Pa] of two bodies, 1/E* = sum (1 - nu_i^2)/E_i.

    E_i, nu_i: Young's modulus and Poisson ratio of a body. Zhao 2018 below Eq. 8; Hu 2023 below Eq. 7; Yu
    2022, Eq. 21.
    """
    return 1.0 / ((1.0 - side1.nu**2) / side1.E + (1.0 - side2.nu**2) / side2.E)


def contact_shear_modulus(side1: ElasticConstants, side2: ElasticConstants) -> Number:
    """Contact shear modulus G' [Pa] of two bodies, 1/G' = sum (2 - nu_i)/G_i.

    G_i = E_i/(2 (1 + nu_i)): shear modulus, with Young's modulus E_i and Poisson ratio nu_i of a body.

    Zhao 2018 below Eq. 21.
    """
    compliance = sum((2.0 - s.nu) * 2.0 * (1.0 + s.nu) / s.E for s in (side1, side2))
    return 1.0 / compliance


def hardness_coefficient(nu: Number) -> Number:
    """Hardness coefficient k = 0.454 + 0.41 nu [1]: yield begins at the peak Hertz pressure k times hardness.

    nu: Poisson ratio of the softer body.

    Hu 2023 below Eq. 7.
    """
    return 0.454 + 0.41 * nu


def domain_extension(D: Number) -> Number:
    r"""Domain extension factor psi [1] of the size distribution of spots, for a profile dimension 1 < D < 2.

    Root of Zhao 2018, Eq. 3.

    With q = (2 - D)/D and A = (D/2) ln psi the equation reads
    `(exp(q A) - (1 + exp(-A))^-q)/q = 1`; `expm1` handles its removable singularity at D = 2.
    Newton's method starts from the line between the solutions at the two ends (A = ln golden ratio at D = 1,
    ln(e - 1) at D = 2) and reaches round-off after four steps.
    """
    q = (2.0 - D) / D
    A = np.log(np.e - 1.0) + q * (np.log(0.5 + np.sqrt(1.25)) - np.log(np.e - 1.0))
    q = np.maximum(q, 1e-300)
    for _ in range(4):
        B = -np.log1p(np.exp(-A))
        high, low = np.exp(q * A), np.exp(q * B)
        residual = low * np.expm1(q * (A - B)) / q - 1.0
        A = A - residual / (high - low / (1.0 + np.exp(A)))
    return np.exp(2.0 * A / D)


def domain_extension_fit(D: Number) -> Number:
    """Domain extension factor psi [1] of the size distribution, for a surface dimension 2 < D < 3.

    Fit of Hu 2023 below Eq. 17.

    The fit is within 0.38 % of the root that `domain_extension` finds.
    """
    return 5.454 * np.exp((1.0 - D) / 0.628) + 1.499


def complete_elliptic_integrals(e: Number) -> tuple[Number, Number]:
    """Complete elliptic integrals K(e) and E(e) [1] of the modulus e, 0 <= e < 1 (Yu 2022, Eqs. 19-20).

    The arithmetic-geometric mean gives both integrals; eight steps reach round-off for e <= 1 - 1e-12.
    """
    a: Number = 1.0
    b: Number = np.sqrt((1.0 - e) * (1.0 + e))
    total: Number = 0.5 * e**2
    power = 0.5
    for _ in range(8):
        a, b, c = 0.5 * (a + b), np.sqrt(a * b), 0.5 * (a - b)
        power *= 2.0
        total = total + power * c**2
    K = 0.5 * np.pi / a
    return K, K * (1.0 - total)
