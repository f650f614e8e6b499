"""Interface law `roughness`: elastic contact of many spots, with a transition to few spots at small load.

The law has no sum over single spots: the combined rms height h of both surfaces determines the stiffness. For
many spots p ~ exp(approach/(gamma h)) (Persson 2007; Akarapu, Sharp, Robbins 2011), so the stiffness per area
is p/(gamma h), independent of the modulus. At small load only a few hills of the longest wave are in contact,
and the stiffness is larger (finite size; Pastewka and others 2013). Range of validity:
docs/validity_stiffness.md.
"""

from dataclasses import dataclass

import numpy as np

from ...quantity import CheckedParameters, Number, group_field, quantity_field
from ..interface import HardnessLimitedLaw
from ..powerlaw import PowerTerm, SpotDistribution
from ..roughness import MAX_ROUGHNESS_HEIGHT
from ..surface import ElasticConstants, contact_modulus, contact_shear_modulus
from .persson import bearing_curve_log_slope, elastic_and_plastic_area_shares

FEW_SPOTS_STIFFNESS_FACTOR = 0.3
"""Factor C [1] of the stiffness at small load, see `RoughnessLaw.spot_distribution`; fitted to boundary
elements (studies/validity_stiffness.py roughness)."""
STIFFNESS_ONSET_NORMALISED_LOAD = 1e-6
"""Load over E* h longest_wave [1] at which the stiffness begins: far below the load of a single hill."""
MIN_VALIDATED_NORMALISED_LOAD = 0.3
"""Smallest load over E* h longest_wave [1] at which the law was compared with boundary elements: below, a
single hill is in contact (docs/validity_stiffness.md).
"""
MAX_VALIDATED_NORMALISED_PRESSURE = 1.5
"""Largest pressure over E* h/longest_wave [1] at which the law was compared with boundary elements: above,
the longest wave is flattened."""
_SIZE_EXPONENT = 0.25
"""Exponent m [1] of the formal size distribution, smaller than the exponent of any quantity; m cancels."""


@dataclass(frozen=True, kw_only=True)
class RoughSurfaces:
    """Parameters of both rough surfaces together, for the law `roughness`: height, wavelength, slope."""

    h: float = quantity_field(
        "m",
        "combined rms height of both surfaces, of all wavelengths up to longest_wave",
        gt=0.0,
        le=1e3 * MAX_ROUGHNESS_HEIGHT,  # the law holds at any scale; this rejects wrong units
    )
    gamma: float = quantity_field(
        "1", "approach, divided by h, over which the pressure increases by a factor of e", gt=0.0
    )
    longest_wave: float = quantity_field("m", "longest wavelength of the roughness", gt=0.0)
    hurst: float = quantity_field("1", "Hurst exponent of the roughness", gt=0.0, lt=1.0)
    slope: float = quantity_field(
        "1", "combined rms slope of both surfaces; only the real contact area depends on it", gt=0.0
    )


@dataclass(frozen=True, kw_only=True)
class RoughnessLaw(HardnessLimitedLaw, RoughSurfaces, CheckedParameters):
    """Parameters of the interface law `roughness`: stiffness from the combined rms height of the surfaces."""

    side1: ElasticConstants = group_field("first body")
    side2: ElasticConstants = group_field("second body")
    H: float = quantity_field("Pa", "hardness of the softer body", gt=0.0)
    mu: float = quantity_field("1", "coefficient of static friction", gt=0.0)
    traction_ratio: float = quantity_field(
        "1", "ratio of shear force to friction limit, x = T/(mu P)", ge=0.0, lt=1.0
    )
    A_0: float = quantity_field("m2", "nominal contact area", gt=0.0)

    @property
    def hardness(self) -> Number:
        """Hardness H [Pa] of the softer body."""
        return self.H

    def spot_distribution(self) -> SpotDistribution:
        """Load, stiffness and energies of the nominal area A_0, as sums of powers of the pressure p.

        load         : [N] p A_0
        normal       : [N/m] stiffness p A_0/h (1/gamma + C x^(-hurst/(1 + hurst))), with
            C = FEW_SPOTS_STIFFNESS_FACTOR, x = p A_0/(E* h longest_wave) and the contact modulus E*
        tangential   : [N/m] stiffness, `shear_stiffness_ratio` times normal
        elastic_work : [J] gamma h p A_0, the energy of p ~ exp(approach/(gamma h))
        plastic_work : [J] 0: the surfaces have carried the load before

        In place of a log-area, the argument is u = ln(p/p_1), with p_1 of `stiffness_onset_pressure`.
        """
        p, A, rho = stiffness_onset_pressure(self), self.A_0, self.shear_stiffness_ratio()
        many_spots = p * A / (self.gamma * self.h)
        few_spots = (
            FEW_SPOTS_STIFFNESS_FACTOR
            * p
            * A
            / self.h
            * STIFFNESS_ONSET_NORMALISED_LOAD ** (-self.hurst / (1.0 + self.hurst))
        )
        power = 1.0 / (1.0 + self.hurst)
        return SpotDistribution(
            reference_area=A,
            size_exponent=_SIZE_EXPONENT,
            size_prefactor=1.0 / _SIZE_EXPONENT,
            regime_terms={
                "load": (_make_power_term_for_sum(p * A, 1.0),),
                "normal": (
                    _make_power_term_for_sum(many_spots, 1.0),
                    _make_power_term_for_sum(few_spots, power),
                ),
                "tangential": (
                    _make_power_term_for_sum(rho * many_spots, 1.0),
                    _make_power_term_for_sum(rho * few_spots, power),
                ),
                "elastic_work": (_make_power_term_for_sum(self.gamma * self.h * p * A, 1.0),),
                "plastic_work": (_make_power_term_for_sum(0.0, 1.0),),
            },
            onset_log_area=0.0,
            has_spot_area=False,
        )

    def real_area(self, pressure: Number) -> tuple[Number, Number]:
        """Real area (...) [m2] and its elastic fraction [1] at pressures (...) [Pa] (Persson 2001)."""
        deviation = 0.5 * contact_modulus(self.side1, self.side2) * self.slope
        elastic, plastic = elastic_and_plastic_area_shares(pressure, self.H, deviation)
        return self.A_0 * (elastic + plastic), elastic / (elastic + plastic)

    def find_range_violations(self, lowest_pressure: float, highest_pressure: float) -> list[str]:
        """Messages, one line each, if an interval of pressures [Pa] leaves the validated range."""
        scale = contact_modulus(self.side1, self.side2) * self.h
        min_pressure = MIN_VALIDATED_NORMALISED_LOAD * scale * self.longest_wave / self.A_0
        max_pressure = MAX_VALIDATED_NORMALISED_PRESSURE * scale / self.longest_wave
        messages = []
        if lowest_pressure < min_pressure:
            messages.append(
                f"a pressure of {lowest_pressure:.4g} Pa is below {min_pressure:.3g} Pa, the lower end of "
                "the checked range of the law roughness: few asperities carry the load, and surfaces of "
                "equal roughness differ by 50 % and more (docs/validity.md)"
            )
        if highest_pressure > max_pressure:
            messages.append(
                f"a pressure of {highest_pressure:.4g} Pa is above {max_pressure:.3g} Pa, the upper end of "
                "the checked range of the law roughness: the longest waves are pressed flat, results are an "
                "extrapolation (docs/validity.md)"
            )
        return messages

    def shear_stiffness_ratio(self) -> Number:
        """Ratio rho = K_T/K_N [1] of tangential to normal stiffness without slip: 4 G'/E*.

        G', E*: contact shear modulus and contact modulus. For equal materials with the Poisson ratio nu, rho
        is 2 (1 - nu)/(2 - nu) (Mindlin 1949).
        """
        return 4.0 * contact_shear_modulus(self.side1, self.side2) / contact_modulus(self.side1, self.side2)

    def loss_factor(self) -> Number:
        """Loss factor eta_t [1] of tangential motion at the traction ratio."""
        return loss_factor(self.traction_ratio)

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities of the nominal area A_0 at u = ln(p/p_1) [1]; p_1: `stiffness_onset_pressure`.

        F [N] load, approach [m]; K_N, K_T [N/m] stiffness for small motions, also on unloading of a plastic
        contact; K_loading [N/m] stiffness at first loading, when spots yield: elastic compliance plus that of
        the bearing curve, weighted by the share of the load on plastic spots; A_r [m2] real area;
        elastic_fraction of A_r [1]; eta_n = 0 and eta_t [1] loss factors; friction_limit = mu F [N];
        slip_length s_0 = mu gamma h/rho [m] of the contact of many spots, rho: `shear_stiffness_ratio`.
        """
        s, p = self.spot_distribution(), stiffness_onset_pressure(self) * np.exp(largest_log_area)
        F, K_N = s.sum_over_spots("load", largest_log_area), s.sum_over_spots("normal", largest_log_area)
        A_r, elastic = self.real_area(p)
        flowing = np.minimum((1.0 - elastic) * A_r * self.H / F, 1.0)
        loading = 1.0 / (1.0 / K_N + flowing * self.h / (F * bearing_curve_log_slope(p / self.H)))
        return {
            "F": F,
            "K_N": K_N,
            "K_T": s.sum_over_spots("tangential", largest_log_area),
            "A_r": A_r,
            "eta_n": 0.0 * F,
            "eta_t": self.loss_factor() + 0.0 * F,
            "K_loading": loading,
            "approach": approach(self, p),
            "elastic_fraction": elastic,
            "friction_limit": self.mu * F,
            "slip_length": self.mu * self.gamma * self.h / self.shear_stiffness_ratio() + 0.0 * F,
        }


def stiffness_onset_pressure(law_parameters: RoughnessLaw) -> Number:
    """Pressure p_1 [Pa] at which the stiffness begins; the law at a pressure p is evaluated at u = ln(p/p_1).

    p_1 = STIFFNESS_ONSET_NORMALISED_LOAD E* h longest_wave/A_0, with the contact modulus E*.
    """
    return (
        STIFFNESS_ONSET_NORMALISED_LOAD
        * contact_modulus(law_parameters.side1, law_parameters.side2)
        * law_parameters.h
        * law_parameters.longest_wave
        / law_parameters.A_0
    )


def _make_power_term_for_sum(sum_coefficient: Number, sum_exponent: Number) -> PowerTerm:
    """Power law of one spot such that the sum over all spots is sum_coefficient exp(sum_exponent u).

    u = ln(p/p_1), with the pressure p and the unit pressure p_1 of the law. The other laws sum a quantity
    over contact spots with a size distribution; this law gives the sum directly. To have the same form, it
    uses fictitious spots whose size distribution has the exponent _SIZE_EXPONENT.
    """
    return PowerTerm(sum_coefficient * (sum_exponent - _SIZE_EXPONENT), sum_exponent)


def loss_factor(traction_ratio: Number) -> Number:
    """Loss factor eta_t [1] of a shear cycle of many spots at the traction ratio: W/(2 pi U).

    W is the loss of a cycle and U = T s/2 the energy at its ends, with the amplitudes T = x mu F of the
    tangential force and s of the displacement; x is the traction ratio, mu F the friction limit. With
    p ~ exp(approach/(gamma h)) the spots slip one after the other: T = mu F (1 - exp(-s/s_0)), with the slip
    length s_0. By Masing's rule W = -4 mu F s_0 ((2 - x) ln(1 - x) + 2x), so
    eta_t = (4/pi) (2/x - 1 + 2/ln(1 - x)). Below x = 0.01, where this form cancels, its power series
    2x/(3 pi) + ... is used.
    """
    series = traction_ratio * (
        1.0 / 6.0
        + traction_ratio
        * (
            1.0 / 12.0
            + traction_ratio
            * (19.0 / 360.0 + traction_ratio * (3.0 / 80.0 + traction_ratio * 863.0 / 30240.0))
        )
    )
    small = traction_ratio < 0.01
    safe = np.where(small, 0.01, traction_ratio)
    closed_form = 2.0 / safe - 1.0 + 2.0 / np.log1p(-safe)
    return 4.0 / np.pi * np.where(small, series, closed_form)


def approach(law_parameters: RoughnessLaw, pressure: Number) -> Number:
    """Approach [m] of the two bodies from zero pressure to a pressure p [Pa]: integral of dp/k.

    k [N/m3]: stiffness per nominal area.
    """
    x = (
        pressure
        * law_parameters.A_0
        / (
            contact_modulus(law_parameters.side1, law_parameters.side2)
            * law_parameters.h
            * law_parameters.longest_wave
        )
    )
    bend = law_parameters.hurst / (1.0 + law_parameters.hurst)
    return (
        law_parameters.gamma
        * law_parameters.h
        / bend
        * np.log1p(x**bend / (law_parameters.gamma * FEW_SPOTS_STIFFNESS_FACTOR))
    )
