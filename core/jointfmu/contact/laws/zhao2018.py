"""Interface law of Zhao et al. 2018: elastic and plastic spots, stiffness and damping.

Areas are truncated areas a' = 2a, as in the paper. Equation numbers are those of the paper; misprints are
corrected (docs/errata.md).
"""

from dataclasses import dataclass

import numpy as np

from ...quantity import CheckedParameters, Number, choice_field, group_field, quantity_field
from ..interface import HardnessLimitedLaw
from ..powerlaw import PowerTerm, SpotDistribution
from ..surface import (
    ElasticConstants,
    ProfileSurface,
    contact_modulus,
    contact_shear_modulus,
    domain_extension,
    hardness_coefficient,
)
from . import mindlin


@dataclass(frozen=True, kw_only=True)
class Zhao2018(HardnessLimitedLaw, CheckedParameters):
    """Parameters of the fractal interface law of Zhao 2018, with its stiffness, energies and damping."""

    surface: ProfileSurface = group_field("equivalent rough surface")
    side1: ElasticConstants = group_field("first body")
    side2: ElasticConstants = group_field("second body")
    H: float = quantity_field("Pa", "hardness of the softer body", gt=0.0)
    mu: float = quantity_field("1", "coefficient of static friction", gt=0.0)
    traction_ratio: float = quantity_field(
        "1", "ratio of shear force to friction limit, x = T/(mu P)", ge=0.0, lt=1.0
    )
    A_0: float = quantity_field("m2", "nominal contact area", gt=0.0)
    mass: float = quantity_field(
        "kg", "mass of the structure, used for the equivalent viscous damping C_N, C_T", gt=0.0
    )
    critical_area: str = choice_field(
        "continuity", "printed", "yield", doc="area below which a spot is plastic (Eq. 4)"
    )
    spot_stiffness: str = choice_field(
        "hertz", "family", doc="stiffness of an elastic spot: Hertz, or along the size family (Eq. 13)"
    )

    @property
    def hardness(self) -> Number:
        """Hardness H [Pa] of the softer body."""
        return self.H

    def spot_distribution(self) -> SpotDistribution:
        """Size distribution of the spots (Eq. 2), and regimes of a spot: elastic or plastic.

        The log-area t of a spot is relative to the critical area a'_c; elastic for t > 0, plastic for t <= 0.

        Quantities: load [N]; normal and tangential stiffness [N/m]; real area [m2]; plastic_work [J]
        (Eq. 15); elastic_work [J] (Eq. 17); loop_area [m3], a'^(3/2) of elastic spots, for the energies of a
        shear cycle (Eqs. 24 and 26).
        """
        D = self.surface.D
        a = critical_area(self)
        delta, radius = spot_deformation(self, a), curvature_radius(self, a)
        modulus = contact_modulus(self.side1, self.side2)
        work = 8.0 / 15.0 * modulus * np.sqrt(radius) * delta**2.5
        terms = {
            "load": (
                PowerTerm(self.H * a, 1.0, upper_log_area=0.0),
                PowerTerm(elastic_load(self, a), 1.5 - 0.5 * D, 0.0),
            ),
            "normal": (PowerTerm(normal_stiffness(self, a), 0.5, 0.0),),
            "tangential": (PowerTerm(tangential_stiffness(self, a), 0.5, 0.0),),
            "area": (PowerTerm(a, 1.0, upper_log_area=0.0), PowerTerm(0.5 * a, 1.0, 0.0)),
            "plastic_work": (PowerTerm(self.H * a * delta, 2.0 - 0.5 * D, upper_log_area=0.0),),
            "elastic_work": (PowerTerm(work, 2.5 - D, 0.0),),
            "loop_area": (PowerTerm(a**1.5, 1.5, 0.0),),
        }
        weight = domain_extension(D) ** (1.0 - 0.5 * D)
        return SpotDistribution(
            reference_area=a, size_exponent=0.5 * D, size_prefactor=weight, regime_terms=terms
        )

    def shear_stiffness_ratio(self) -> Number:
        """Ratio K_T/K_N [1] of tangential to normal stiffness, independent of the pressure.

        Both stiffnesses are proportional to the sum of sqrt(spot area) over the elastic spots.
        """
        return tangential_stiffness(self, 1.0) / normal_stiffness(self, 1.0)

    def loss_factor(self) -> Number:
        """Loss factor eta_t [1] of tangential motion at the traction ratio, Eqs. 27-29."""
        return mindlin.loss_factor(self.traction_ratio)

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities of the nominal area A_0 for a largest spot of log-area u [1], relative to a'_c.

        F: load [N], Eqs. 9-10; K_N, K_T: normal and tangential stiffness [N/m], Eqs. 14 and 22; A_r: real
        area [m2], Eq. 11; W_NP, W_NE: plastic and elastic work of normal loading [J], Eqs. 16, 18; W_d, W,
        W_e: dissipated energy, 2 pi times the stored energy, and their difference W - W_d [J] of a shear
        cycle, Eqs. 24, 26, 27; eta_n, eta_t: normal and tangential loss factor [1], Eqs. 19 and 28; C_N, C_T:
        equivalent viscous damping [N.s/m], eta_n sqrt(mass K_N) (Eq. 20) and eta_t sqrt(mass K_T). Where no
        spot is elastic (u <= 0) the stiffness is zero and eta_n infinite.
        """
        s = self.spot_distribution()
        F, A_r, K_N, K_T = (
            s.sum_over_spots(name, largest_log_area) for name in ("load", "area", "normal", "tangential")
        )
        plastic = s.sum_over_spots("plastic_work", largest_log_area)
        elastic = s.sum_over_spots("elastic_work", largest_log_area)
        with np.errstate(divide="ignore", invalid="ignore"):
            eta_n = np.where(elastic > 0.0, plastic / np.where(elastic > 0.0, elastic, 1.0), np.inf)
            C_N = np.where(K_N > 0.0, mindlin.equivalent_damping(eta_n, self.mass, K_N), 0.0)
        W_d, W = shear_energies(self, F, A_r, s.sum_over_spots("loop_area", largest_log_area))
        eta_t = self.loss_factor()
        return {
            "F": F,
            "K_N": K_N,
            "K_T": K_T,
            "A_r": A_r,
            "W_NP": plastic,
            "W_NE": elastic,
            "eta_n": eta_n,
            "C_N": C_N,
            "W_d": W_d,
            "W": W,
            "W_e": W - W_d,
            "eta_t": eta_t + 0.0 * F,
            "C_T": mindlin.equivalent_damping(eta_t, self.mass, K_T),
        }


def critical_area(law_parameters: Zhao2018) -> Number:
    """Critical area a'_c [m2]: smaller spots are plastic, larger ones elastic, Eq. 4.

    The critical area depends on the parameter `critical_area`:

    continuity : the elastic load of the spot equals hardness H times its area (default: the only choice
        without a jump of the force)
    printed    : Eq. 4 as printed
    yield      : onset of yield at a Hertz pressure k H, at the deformation (pi k H/2E*)^2 R, with
        k: `hardness_coefficient`, E*: contact modulus, R: radius of curvature
    """
    D, G, log_gamma = law_parameters.surface.D, law_parameters.surface.G, np.log(law_parameters.surface.gamma)
    ratio = contact_modulus(law_parameters.side1, law_parameters.side2) / law_parameters.H
    if law_parameters.critical_area == "printed":
        return 2.0 * (2.0 * ratio) ** (2.0 / (D - 1.0)) * G**2
    if law_parameters.critical_area == "yield":
        onset = 0.5 * np.pi * hardness_coefficient(law_parameters.side1.nu) / ratio
        root = 2.0 ** (7.0 - 2.0 * D) * log_gamma * np.pi ** (D - 1.0) / onset**2
        return root ** (1.0 / (D - 1.0)) * G**2
    root = 2.0 ** (9.0 - 2.0 * D) * ratio**2 * log_gamma / (9.0 * np.pi ** (3.0 - D))
    return root ** (1.0 / (D - 1.0)) * G**2


def spot_deformation(law_parameters: Zhao2018, truncated_area: Number) -> Number:
    """Deformation delta [m] of a spot of truncated area a' [m2], Eq. 5."""
    D, G = law_parameters.surface.D, law_parameters.surface.G
    root = np.sqrt(np.log(law_parameters.surface.gamma))
    factor = 2.0 ** (3.0 - D) * G ** (D - 1.0) * root * np.pi ** (0.5 * D - 1.0)
    return factor * truncated_area ** (1.0 - 0.5 * D)


def curvature_radius(law_parameters: Zhao2018, truncated_area: Number) -> Number:
    """Radius of curvature R [m] of a spot of truncated area a' [m2], Eq. 6."""
    D, G = law_parameters.surface.D, law_parameters.surface.G
    root = np.sqrt(np.log(law_parameters.surface.gamma))
    return truncated_area ** (0.5 * D) / (2.0 ** (4.0 - D) * np.pi ** (0.5 * D) * G ** (D - 1.0) * root)


def elastic_load(law_parameters: Zhao2018, truncated_area: Number) -> Number:
    """Load f_e [N] of an elastic spot of truncated area a' [m2], Eq. 7."""
    modulus = contact_modulus(law_parameters.side1, law_parameters.side2)
    return (
        4.0
        / 3.0
        * modulus
        * np.sqrt(curvature_radius(law_parameters, truncated_area))
        * spot_deformation(law_parameters, truncated_area) ** 1.5
    )


def normal_stiffness(law_parameters: Zhao2018, truncated_area: Number) -> Number:
    """Normal stiffness k_n [N/m] of an elastic spot of truncated area a' [m2].

    The stiffness depends on the parameter `spot_stiffness`:

    family : (df/da')/(d delta/da') of load f and deformation delta, Eq. 13: the radius of curvature R changes
        with the area
    hertz  : 2 E* r at fixed R, with contact modulus E* and contact radius r; `family` is 2(3-D)/(3(2-D))
        times this, with the fractal dimension D
    """
    hertz = (
        2.0
        * contact_modulus(law_parameters.side1, law_parameters.side2)
        * np.sqrt(truncated_area / (2.0 * np.pi))
    )
    if law_parameters.spot_stiffness == "hertz":
        return hertz
    return 2.0 * (3.0 - law_parameters.surface.D) / (3.0 * (2.0 - law_parameters.surface.D)) * hertz


def tangential_stiffness(law_parameters: Zhao2018, truncated_area: Number) -> Number:
    """Tangential stiffness k_t = 8 G' r (1 - x)^(1/3) [N/m] of an elastic spot, Eqs. 21-22.

    G': contact shear modulus, r: contact radius, x: traction ratio.
    """
    modulus = contact_shear_modulus(law_parameters.side1, law_parameters.side2)
    stick, _ = mindlin.stick_radius_ratio(law_parameters.traction_ratio)
    return 8.0 * modulus * np.sqrt(truncated_area / (2.0 * np.pi)) * stick


def shear_energies(
    law_parameters: Zhao2018, F: Number, A_r: Number, spot_area_power_sum: Number
) -> tuple[Number, Number]:
    """Energies [J] of a shear cycle: the dissipated energy W_d (Eq. 24), and W (Eq. 26).

    W is 2 pi times the stored energy.

    F, A_r              : load [N] and real area [m2] of the contact
    spot_area_power_sum : [m3] sum of a'^(3/2) over elastic spots of truncated area a', as in Eq. 24 with its
        factor 9 sqrt(2 pi)/40 left out
    """
    traction = law_parameters.mu * F / A_r
    common = (
        traction**2
        * np.sqrt(np.pi / 8.0)
        / contact_shear_modulus(law_parameters.side1, law_parameters.side2)
        * spot_area_power_sum
    )
    dissipated = 0.9 * common * mindlin.dissipated_energy_function(law_parameters.traction_ratio)
    stored = 0.375 * np.pi * common * mindlin.stored_energy_function(law_parameters.traction_ratio)
    return dissipated, stored
