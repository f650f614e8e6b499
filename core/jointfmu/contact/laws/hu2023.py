"""Interface law of Hu et al. 2023 (doi:10.3389/fmats.2023.1211019): one base radius, four spot regimes.

Equation numbers are those of the paper; misprints are corrected (docs/errata.md). D is the dimension of the
surface (2 < D < 3); areas are real contact areas. The choice `reading` is the meaning of the pressure in
Eq. 28:

corrected : load over nominal area, F_r/A_0; four regimes, stiffness of the spots above s_min
printed   : load over real area, F_r/S_r; all spots are elastic, and the stiffness of one set of spots is the
    magnitude of Eq. 30, proportional to the pressure. Valid up to `elastic_pressure`.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...quantity import CheckedParameters, Number, choice_field, group_field, quantity_field
from ..interface import HardnessLimitedLaw
from ..powerlaw import PartialSlipTerm, PowerTerm, RegimeTerm, SpotDistribution
from ..surface import (
    ArealSurface,
    ElasticConstants,
    contact_modulus,
    contact_shear_modulus,
    domain_extension_fit,
    hardness_coefficient,
)
from . import mindlin
from .kogut_etsion import (
    FIRST_ELASTIC_PLASTIC_STAGE,
    FULL_PLASTIC_OVER_YIELD_AREA,
    SECOND_ELASTIC_PLASTIC_STAGE,
    SECOND_STAGE_OVER_YIELD_AREA,
    eliminate_deformation,
)


@dataclass(frozen=True, kw_only=True)
class Hu2023(HardnessLimitedLaw, CheckedParameters):
    """Parameters of the fractal interface law of Hu 2023; `side1` is the softer body."""

    surface: ArealSurface = group_field("equivalent rough surface")
    side1: ElasticConstants = group_field("softer body")
    side2: ElasticConstants = group_field("harder body")
    sigma_y: float = quantity_field("Pa", "yield strength of the softer body", gt=0.0)
    mu: float = quantity_field("1", "coefficient of static friction", gt=0.0)
    traction_ratio: float = quantity_field(
        "1", "ratio of shear force to friction limit, x = T/(mu P)", ge=0.0, lt=1.0
    )
    A_0: float = quantity_field("m2", "nominal contact area", gt=0.0)
    shear_traction: float = quantity_field(
        "Pa", "shear traction on the real area, used if traction is real_area", gt=0.0
    )
    traction: str = choice_field(
        "ratio",
        "real_area",
        doc="shear of a spot: from traction_ratio (ratio), or shear_traction on the real area (real_area)",
    )

    reading: str = choice_field(
        "corrected",
        "printed",
        doc="pressure in Eq. 28: load divided by the nominal area, or by the real area as printed",
    )

    @property
    def hardness(self) -> Number:
        """Hardness H = 2.8 sigma_y [Pa], below Eq. 7 (sigma_s there)."""
        return 2.8 * self.sigma_y

    def spot_distribution(self) -> SpotDistribution:
        """Size distribution of the spots (Eq. 17), and load and stiffness of a spot in each regime.

        The parameter `reading` selects the law as printed, or the corrected law. The reference area is the
        area s_min of the smallest spot.
        """
        return (
            corrected_spot_distribution(self)
            if self.reading == "corrected"
            else spot_distribution_as_printed(self)
        )

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities at the log-area u [1] of the largest spot.

        F: load [N], Eq. 27, or P A_0 as printed; K_N, K_T: normal and tangential stiffness [N/m], Eqs. 35 and
        44; A_r: real area [m2], Eq. 22.
        """
        s = self.spot_distribution()
        names = {"F": "load", "K_N": "normal", "K_T": "tangential", "A_r": "area"}
        return {symbol: s.sum_over_spots(name, largest_log_area) for symbol, name in names.items()}


def curvature_radius(law_parameters: Hu2023) -> Number:
    """Radius of curvature R [m] at the peak of an asperity, Eq. 5."""
    s = law_parameters.surface
    root = np.sqrt(np.log(s.gamma))
    return s.r_m ** (s.D - 1.0) / (2.0 ** (3.0 - s.D) * np.pi**2 * s.G ** (s.D - 2.0) * root)


def critical_deformation(law_parameters: Hu2023) -> Number:
    """Critical deformation epsilon_ec [m] at the end of the elastic regime, Eq. 7."""
    modulus = contact_modulus(law_parameters.side1, law_parameters.side2)
    onset = 0.5 * np.pi * hardness_coefficient(law_parameters.side1.nu) * law_parameters.hardness / modulus
    return onset**2 * curvature_radius(law_parameters)


def critical_area(law_parameters: Hu2023) -> Number:
    """Critical spot area s_ec [m2] at the end of the elastic regime, Eq. 10.

    The two elastic-plastic stages end at 7.1197 s_ec and 205.38 s_ec (Eqs. 13-14).
    """
    return np.pi * curvature_radius(law_parameters) * critical_deformation(law_parameters)


def critical_load(law_parameters: Hu2023) -> Number:
    """Load f_ec [N] of a spot of critical area s_ec: (2/3) k H s_ec, Eq. 9.

    k: `hardness_coefficient`, H: hardness of the softer body.
    """
    return (
        2.0
        / 3.0
        * hardness_coefficient(law_parameters.side1.nu)
        * law_parameters.hardness
        * critical_area(law_parameters)
    )


def elastic_pressure(law_parameters: Hu2023) -> Number:
    """Largest mean pressure on the real area [Pa] without yielding spots.

    Load over real area, F_r/S_r, if the largest spot has the critical area s_ec; Eqs. 9, 18, 23.
    """
    D = law_parameters.surface.D
    return (
        2.0
        / 3.0
        * hardness_coefficient(law_parameters.side1.nu)
        * law_parameters.hardness
        * (3.0 - D)
        / (4.0 - D)
    )


def spot_distribution_as_printed(law_parameters: Hu2023) -> SpotDistribution:
    r"""Load, stiffness and area of the spots by the law as printed: all spots are elastic.

    With the area s_l of the largest spot, the pressure P is the load F_r divided by the real area S_r

        P = F_r/S_r = \frac{4 E (3 - D)}{3 pi^{3/2} R (4 - D)} s_l^{1/2}    (Eqs. 9, 18, 23, 28)

    (E: contact modulus, D: fractal dimension, R: radius of curvature). The stiffness K is the magnitude of
    Eq. 30 with s_l as the upper limit, also ~ s_l^(1/2). So K is proportional to P, and E cancels. K is the
    stiffness of one set of spots, independent of the nominal area A_0.

    Quantities: load P A_0 [N]; normal and tangential stiffness [N/m]; area, elastic_area [m2].
    """
    s, E = law_parameters.surface, contact_modulus(law_parameters.side1, law_parameters.side2)
    m, weight = 0.5 * s.D - 0.5, domain_extension_fit(s.D) ** (1.5 - 0.5 * s.D)
    edge = np.sqrt(s.s_min / np.pi)
    P = 4.0 / 3.0 * E * (3.0 - s.D) / (4.0 - s.D) * edge / (np.pi * curvature_radius(law_parameters))
    full_stick = 8.0 * contact_shear_modulus(law_parameters.side1, law_parameters.side2) * edge
    if law_parameters.traction == "ratio":
        tangential: RegimeTerm = PowerTerm(
            0.0 - full_stick * mindlin.stick_radius_ratio(law_parameters.traction_ratio)[0], 0.5
        )
    else:
        slip = (
            law_parameters.shear_traction
            * s.s_min
            / (law_parameters.mu * _smallest_spot_load(law_parameters))
        )
        tangential = PartialSlipTerm(
            coefficient=full_stick,
            exponent=0.5,
            slip_coefficient=slip,
            slip_exponent=0.5,
            lower_log_area=-np.inf,
            upper_log_area=np.inf,
        )
    terms: dict[str, tuple[RegimeTerm, ...]] = {
        "load": (PowerTerm(law_parameters.A_0 * P * (0.5 - m) / (m * weight), 0.5),),
        "normal": (PowerTerm(-2.0 * E * edge, 0.5),),
        "tangential": (tangential,),
        "area": (PowerTerm(s.s_min, 1.0),),
        "elastic_area": (PowerTerm(s.s_min, 1.0),),
    }
    return SpotDistribution(
        reference_area=s.s_min, size_exponent=m, size_prefactor=weight, regime_terms=terms
    )


def _smallest_spot_load(law_parameters: Hu2023) -> Number:
    """Elastic load f_e [N] of the smallest spot, whose area is s_min, Eq. 9."""
    s_min, E = law_parameters.surface.s_min, contact_modulus(law_parameters.side1, law_parameters.side2)
    return 4.0 / 3.0 * E * (s_min / np.pi) ** 1.5 / curvature_radius(law_parameters)


def corrected_spot_distribution(law_parameters: Hu2023) -> SpotDistribution:
    """Load, stiffness and area of the spots by the corrected law: size distribution (Eq. 17), four regimes.

    Load and area are sums over all spots (Eqs. 18-27). The stiffness is the sum over the spots above s_min;
    without this limit its integrals diverge or are undefined (Eqs. 30, 41, corrected).

    The regimes are elastic, two elastic-plastic stages and plastic; s_min is the area of the smallest spot.

    Quantities: load [N]; normal and tangential stiffness [N/m]; area, elastic_area [m2].
    """
    s_min, s_ec = law_parameters.surface.s_min, critical_area(law_parameters)
    f_ec, H = critical_load(law_parameters), law_parameters.hardness
    k_ec = f_ec / critical_deformation(law_parameters)
    edge = np.log(s_ec / s_min)  # log-area of the end of the elastic regime
    ends = [
        edge,
        edge + np.log(SECOND_STAGE_OVER_YIELD_AREA),
        edge + np.log(FULL_PLASTIC_OVER_YIELD_AREA),
    ]
    bounds = [None, *ends]
    stages = [
        eliminate_deformation(FIRST_ELASTIC_PLASTIC_STAGE),
        eliminate_deformation(SECOND_ELASTIC_PLASTIC_STAGE),
    ]

    def make_regime_term(
        power_law_coefficient: Number,
        power_law_exponent: float,
        regime_index: int,
        first_regime_lower_log_area: Number = None,
    ) -> PowerTerm:
        """Load or stiffness of a contact spot in one regime: coefficient times (s/s_ec)^exponent.

        s is the area of the spot, s_ec the largest area of an elastic spot, s_min the smallest spot area. The
        result is a function of the log-area ln(s/s_min).

        power_law_coefficient       : load [N] or stiffness [N/m] at s = s_ec, by this power law
        regime_index                : 0 elastic, 1 and 2 elastic-plastic, 3 plastic
        first_regime_lower_log_area : log-area at which regime 0 begins; None: minus infinity
        """
        lower = bounds[regime_index] if regime_index else first_regime_lower_log_area
        upper = bounds[regime_index + 1] if regime_index < 3 else None
        return PowerTerm(
            power_law_coefficient * np.exp(-power_law_exponent * edge), power_law_exponent, lower, upper
        )

    load = [
        make_regime_term(f_ec, 1.5, 0),
        *(make_regime_term(f_ec * st.load_factor, st.load_exponent, i + 1) for i, st in enumerate(stages)),
    ]
    normal = [make_regime_term(1.5 * k_ec, 0.5, 0, 0.0)]
    normal += [
        make_regime_term(k_ec * st.stiffness_factor, st.stiffness_exponent, i + 1)
        for i, st in enumerate(stages)
    ]
    normal = [
        replace(
            t,
            lower_log_area=np.maximum(t.lower_log_area, 0.0),
            upper_log_area=np.maximum(t.upper_log_area, 0.0),
        )
        for t in normal
    ]
    terms: dict[str, tuple[RegimeTerm, ...]] = {
        "load": (*load, make_regime_term(H * s_ec, 1.0, 3)),
        "normal": tuple(normal),
        "tangential": _tangential_stiffness_terms(law_parameters, load, bounds),
        "area": (PowerTerm(s_min, 1.0),),
        "elastic_area": (PowerTerm(s_min, 1.0, None, bounds[1]),),
    }
    D = law_parameters.surface.D
    weight = domain_extension_fit(D) ** (1.5 - 0.5 * D)
    return SpotDistribution(
        reference_area=s_min, size_exponent=0.5 * D - 0.5, size_prefactor=weight, regime_terms=terms
    )


def _tangential_stiffness_terms(
    law_parameters: Hu2023, spot_load_terms: list[PowerTerm], regime_end_log_areas: list[Number]
) -> tuple[RegimeTerm, ...]:
    """Tangential stiffness k_t [N/m] of a spot in the three regimes that are not fully plastic.

    spot_load_terms : load of a spot in each of these regimes
    regime_end_log_areas : log-areas of the ends of the regimes

    k_t = 8 G' r (1 - t/(mu f))^(1/3), Eqs. 39, 41-43, with contact shear modulus G', and radius r, shear
    force t and load f of the spot of area s. The shear force depends on the parameter `traction`:

    ratio     : every spot has the traction ratio t/(mu f) = traction_ratio
    real_area : constant shear traction tau on the real area, t = tau s; the traction ratio tau s/(mu f(s))
        differs from spot to spot and is clipped to full slip
    """
    full_stick = (
        8.0
        * contact_shear_modulus(law_parameters.side1, law_parameters.side2)
        * np.sqrt(law_parameters.surface.s_min / np.pi)
    )
    if law_parameters.traction == "ratio":
        stick, _ = mindlin.stick_radius_ratio(law_parameters.traction_ratio)
        return (PowerTerm(full_stick * stick, 0.5, 0.0, np.maximum(regime_end_log_areas[3], 0.0)),)
    return tuple(
        PartialSlipTerm(
            coefficient=full_stick,
            exponent=0.5,
            slip_coefficient=law_parameters.shear_traction
            * law_parameters.surface.s_min
            / (law_parameters.mu * term.coefficient),
            slip_exponent=term.exponent - 1.0,
            lower_log_area=0.0 if term.lower_log_area is None else np.maximum(term.lower_log_area, 0.0),
            upper_log_area=np.maximum(term.upper_log_area, 0.0),
        )
        for term in spot_load_terms
    )
