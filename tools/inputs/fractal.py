"""Formulas of Weierstrass-Mandelbrot surfaces: spectrum, structure function, rms height from D and G.

All lengths are SI. H is the Hurst exponent: H = 2 - D of a profile, H = 3 - D of a surface.
The derivations are in docs/surfaces_reference.md.
"""

import numpy as np

from jointfmu.quantity import Number


def height_variance_density(spatial_frequency: Number, H: Number, G: Number) -> Number:
    """Height variance Phi [m2] of a self-affine surface per unit of ln(frequency); frequency [1/m].

    Phi = G^(2(1-H)) frequency^(-2H)/2 with the Hurst exponent H and the roughness G [m].

    A wave of length l has the amplitude G^(1-H) sqrt(ln gamma) l^H (Hu 2023, Eqs. 1-3; Zhao 2018,
    Eq. 5; Yu 2022, Eq. 4), with the frequency ratio gamma of neighbouring waves: there is one wave in
    every ln(gamma). Phi/frequency is the one-sided power spectral density of Zhao 2018, Eq. 30, without its
    1/ln(gamma).
    """
    return 0.5 * G ** (2.0 * (1.0 - H)) * spatial_frequency ** (-2.0 * H)


def structure_function_constant(H: Number) -> Number:
    """Constant C [1] of the structure function S(tau) = C G^(2(1-H)) tau^(2H) of a profile, 0 < H < 1.

    The symbols are lag tau [m], Hurst exponent H [1] and fractal roughness G [m].

    C = (2 pi)^(2H) integral_0^inf u^(-1-2H) (1 - cos u) du = (2 pi)^(2H) pi/(2 Gamma(1+2H) sin(pi H)).
    """
    from scipy.special import gammaln  # slow to import, and every command imports this module

    log = 2.0 * H * np.log(2.0 * np.pi) - gammaln(1.0 + 2.0 * H)
    return 0.5 * np.pi * np.exp(log) / np.sin(np.pi * H)


def second_difference_ratio(H: Number) -> Number:
    """Ratio V/S = 4 - 4^H [1] of two structure functions of heights, for a power law S(tau) ~ tau^(2 H).

    S is the mean square of the first difference of heights at the lag tau, V(tau) = 4 S(tau) - S(2 tau) the
    mean square of the second difference, H the Hurst exponent.
    """
    return 4.0 - 4.0**H


def profile_variance_ratio(H: Number) -> Number:
    """Ratio kappa [1] of the height variance Phi of a profile to the variance of its isotropic surface.

    kappa is the mean of |cos a|^(2H) over all directions a, which is Gamma(H + 1/2)/(sqrt(pi) Gamma(H + 1)),
    with the Hurst exponent H. A wave that crosses the profile at an angle appears longer in the profile.
    """
    from scipy.special import gammaln  # slow to import, and every command imports this module

    return np.exp(gammaln(H + 0.5) - gammaln(H + 1.0)) / np.sqrt(np.pi)


def areal_fractal_roughness(G: Number, H: Number) -> Number:
    """Fractal roughness [m] of an isotropic surface (Hu 2023, Eq. 1), from that of its profiles, G [m].

    H : Hurst exponent [1]
    """
    return G * profile_variance_ratio(H) ** (-0.5 / (1.0 - H))


def zhao_fractal_roughness(G: Number, H: Number, gamma: Number) -> Number:
    """Fractal roughness [m] as defined in Zhao 2018, Eqs. 1 and 30, from G [m] of this package.

    The waves in Zhao 2018 do not have the factor sqrt(ln gamma); gamma is the frequency ratio of neighbouring
    waves, H the Hurst exponent.
    """
    return G * np.log(gamma) ** (0.5 / (1.0 - H))


def hurst_exponent(D: Number, is_areal: bool = False) -> Number:
    """Hurst exponent H [1] from the fractal dimension D: 2 - D of a profile, 3 - D of a surface."""
    return (3.0 if is_areal else 2.0) - D


def rms_height(
    D: Number, G: Number, longest_wave: Number, is_areal: bool = False, gamma: Number | None = None
) -> Number:
    """Rms height h [m] of an isotropic fractal surface, for all waves up to the longest one.

    D, G         : fractal dimension [1] and fractal roughness [m]
    longest_wave : longest wavelength L [m]
    is_areal     : whether D and G are those of the surface (Hu 2023, Eq. 1) or of its profiles (Zhao 2018,
                   Eq. 5; Yu 2022, Eq. 4)
    gamma        : frequency ratio of a Weierstrass-Mandelbrot function with a wave of exactly the length L:
                   h^2 = Phi ln(gamma)/(1 - gamma^(-2H)). None: the continuous spectrum, h^2 = Phi/(2H), which
                   is the mean over all positions of the waves

    Phi = G_s^(2(1-H)) L^(2H)/2 is `height_variance_density` at 1/L, with the fractal roughness G_s of the
    surface and the Hurst exponent H. Every profile of the surface has the same height if the surface has no
    longer waves.
    """
    H = hurst_exponent(D, is_areal)
    power = height_variance_density(1.0 / longest_wave, H, _convert_to_areal_roughness(G, H, is_areal))
    share = 0.5 / H if gamma is None else np.log(gamma) / (1.0 - gamma ** (-2.0 * H))
    return np.sqrt(power * share)


def _convert_to_areal_roughness(G: Number, H: Number, is_areal: bool) -> Number:
    """Fractal roughness G [m] of the isotropic surface, from G [m] of the surface or of its profiles."""
    return G if is_areal else areal_fractal_roughness(G, H)
