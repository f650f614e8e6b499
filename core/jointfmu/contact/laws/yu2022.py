"""Interface law of Yu et al. 2022 (doi:10.3390/app12084071): elliptical asperities, curved tooth flanks.

Equation numbers are those of the paper; misprints are corrected (docs/errata.md). Areas are real contact
areas. Small spots are plastic. With growing area a spot has four regimes: plastic, second elastic-plastic
stage, first elastic-plastic stage, elastic.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...quantity import CheckedParameters, Number, choice_field, group_field, quantity_field, select
from ..interface import HardnessLimitedLaw
from ..powerlaw import PowerTerm, SmoothFunctionTerm, SpotDistribution
from ..surface import (
    CommonFlankParameters,
    ElasticConstants,
    FlankSurface,
    complete_elliptic_integrals,
    contact_modulus,
    hardness_coefficient,
)
from .kogut_etsion import (
    FIRST_ELASTIC_PLASTIC_STAGE,
    FULL_PLASTIC_OVER_YIELD_AREA,
    FULL_PLASTIC_OVER_YIELD_DEFORMATION,
    SECOND_ELASTIC_PLASTIC_STAGE,
    SECOND_STAGE_OVER_YIELD_AREA,
    SECOND_STAGE_OVER_YIELD_DEFORMATION,
    ElasticPlasticStage,
)


@dataclass(frozen=True, kw_only=True)
class Yu2022(HardnessLimitedLaw, CheckedParameters):
    """Parameters of the fractal interface law of Yu 2022, for elliptical contact spots of curved flanks."""

    surface1: FlankSurface = group_field("fractal parameters along the major axis")
    surface2: FlankSurface = group_field("fractal parameters along the minor axis")
    surface: CommonFlankParameters = group_field("frequency ratio of both directions")
    e: float = quantity_field("1", "eccentricity of the contact ellipses", ge=0.0, lt=1.0)
    lambda_: float = quantity_field("1", "contact coefficient of the curved flanks", gt=0.0, le=1.0)
    side1: ElasticConstants = group_field("first body")
    side2: ElasticConstants = group_field("second body")
    sigma_y: float = quantity_field("Pa", "yield strength of the softer body", gt=0.0)
    mu: float = quantity_field("1", "coefficient of static friction; without effect in this law", gt=0.0)
    traction_ratio: float = quantity_field(
        "1", "ratio of shear force to friction limit; without effect in this law", ge=0.0, lt=1.0
    )
    A_0: float = quantity_field("m2", "nominal contact area", gt=0.0)
    rigid_flat: bool = choice_field(
        True, False, doc="true: body 1 touches a rigid flat; false: both bodies deform (Eq. 21)"
    )
    plastic_area: str = choice_field(
        "geometric",
        "kogut_etsion",
        doc="how the area of an elastic-plastic spot gives its deformation",
    )

    @property
    def hardness(self) -> Number:
        """Hardness H = 2.8 sigma_y [Pa], Eq. 25."""
        return 2.8 * self.sigma_y

    def spot_distribution(self) -> SpotDistribution:
        """Size distribution of the spots (Eqs. 44, 46) and regimes of a spot.

        The reference area a_nec is the area of a spot at the onset of yield.
        """
        return self._cached_spot_distribution

    @cached_property
    def _cached_spot_distribution(self) -> SpotDistribution:
        """Size distribution (lambda_ times Eq. 44), and load and stiffness of a spot in four regimes, cached.

        Quantities: load [N], Eqs. 38, 36, 34, 64; normal stiffness [N/m], Eqs. 72-75; area, elastic_area
        [m2].
        """
        stages, areas = _elastic_plastic_stages(self)
        log_nec = critical_log_area(self, 1.0)
        plastic, middle = (critical_log_area(self, area) - log_nec for area in areas)
        a = np.exp(log_nec)
        f1, f2 = ellipse_factors(self.e)
        E = effective_modulus(self)
        (b1, p1), (b2, p2) = curvature_terms(self)
        c1, c2 = b1 * np.exp(-p1 * log_nec), b2 * np.exp(-p2 * log_nec)
        elastic = 2.0 * f2 * E / 3.0 * (a / (np.pi * f1)) ** 1.5
        hertz = 2.0 * f2 * E * np.sqrt(a / (np.pi * f1))

        def curvature_ratio(log_area: Number) -> Number:
            """Sum of both curvatures of a spot, divided by this sum for a spot at the onset of yield [1].

            log_area : ln(area of the spot/area at the onset of yield)
            """
            return (c1 * np.exp(-p1 * log_area) + c2 * np.exp(-p2 * log_area)) / (c1 + c2)

        def make_stage_load(
            elastic_plastic_stage: ElasticPlasticStage, lower_log_area: Number, upper_log_area: Number
        ) -> SmoothFunctionTerm:
            """Load [N] of a spot in one elastic-plastic stage, between two log-areas."""

            def spot_load(log_area: Number) -> Number:
                sharp = curvature_ratio(log_area)
                ratio = np.exp(log_area) * sharp**2  # a/a_nec of this spot's own curvature
                return (
                    elastic
                    * (c1 + c2)
                    * elastic_plastic_stage.load_factor
                    * (ratio / elastic_plastic_stage.area_factor)
                    ** (elastic_plastic_stage.load_exponent / elastic_plastic_stage.area_exponent)
                    / sharp**2
                )

            return SmoothFunctionTerm(spot_load, lower_log_area, upper_log_area)

        def make_stage_stiffness(
            elastic_plastic_stage: ElasticPlasticStage, lower_log_area: Number, upper_log_area: Number
        ) -> SmoothFunctionTerm:
            """Normal stiffness [N/m] of a spot in one elastic-plastic stage, between two log-areas."""

            def spot_stiffness(log_area: Number) -> Number:
                sharp = curvature_ratio(log_area)
                ratio = np.exp(log_area) * sharp**2
                power = (ratio / elastic_plastic_stage.area_factor) ** (
                    (elastic_plastic_stage.load_exponent - 1.0) / elastic_plastic_stage.area_exponent
                )
                return (
                    hertz
                    / 1.5
                    * elastic_plastic_stage.load_factor
                    * elastic_plastic_stage.load_exponent
                    * power
                    / sharp
                )

            return SmoothFunctionTerm(spot_stiffness, lower_log_area, upper_log_area)

        first, second = stages
        H = self.hardness
        return SpotDistribution(
            reference_area=a,
            size_exponent=size_exponent(self),
            size_prefactor=self.lambda_,
            regime_terms={
                "load": (
                    PowerTerm(H * a, 1.0, upper_log_area=plastic),
                    make_stage_load(second, plastic, middle),
                    make_stage_load(first, middle, 0.0),
                    PowerTerm(elastic * c1, 1.5 - p1, 0.0),
                    PowerTerm(elastic * c2, 1.5 - p2, 0.0),
                ),
                "normal": (
                    make_stage_stiffness(second, plastic, middle),
                    make_stage_stiffness(first, middle, 0.0),
                    PowerTerm(hertz, 0.5, 0.0),
                ),
                "area": (PowerTerm(a, 1.0),),
                "elastic_area": (PowerTerm(a, 1.0, 0.0),),
            },
        )

    def contact_quantities(self, largest_log_area: Number) -> dict[str, Number]:
        """Contact quantities at the log-area u [1] of the largest spot.

        F: load [N], Eq. 60; K_N: normal stiffness [N/m], Eq. 76; A_r: real area [m2], Eq. 54;
        elastic_fraction: elastic share of the real area [1].
        """
        s = self.spot_distribution()
        area, elastic = real_area(s, largest_log_area)
        return {
            "F": s.sum_over_spots("load", largest_log_area),
            "K_N": s.sum_over_spots("normal", largest_log_area),
            "A_r": area,
            "elastic_fraction": elastic,
        }


def real_area(spot_distribution: SpotDistribution, largest_log_area: Number) -> tuple[Number, Number]:
    """Real contact area [m2], Eq. 54, and the fraction of it on elastic spots [1]."""
    area = spot_distribution.sum_over_spots("area", largest_log_area)
    return area, spot_distribution.sum_over_spots("elastic_area", largest_log_area) / area


def effective_modulus(law_parameters: Yu2022) -> Number:
    """Contact modulus E' [Pa], Eq. 21; with a rigid flat only the first body deforms."""
    single_body = law_parameters.side1.E / (1.0 - law_parameters.side1.nu**2)
    return select(
        law_parameters.rigid_flat, single_body, contact_modulus(law_parameters.side1, law_parameters.side2)
    )


def ellipse_factors(eccentricity: Number) -> tuple[Number, Number]:
    """Factors f1, f2 [1] of an elliptical elastic contact, Eqs. 22-23; both are 1 for a circle (e = 0)."""
    K, E = complete_elliptic_integrals(eccentricity)
    slender = np.sqrt((1.0 - eccentricity) * (1.0 + eccentricity))
    f1 = E / (K * slender)
    return f1, 0.5 * np.pi * np.sqrt(E) / (K**1.5 * slender)


def size_exponent(law_parameters: Yu2022) -> Number:
    """Exponent m [1] of the size distribution of the spots: sqrt(1 - e^2)/2 (D1 + D2)/2, Eqs. 42-43.

    D1, D2: fractal dimensions along both axes of the contact ellipses of eccentricity e.
    """
    zeta = 0.5 * np.sqrt((1.0 - law_parameters.e) * (1.0 + law_parameters.e))
    return 0.5 * zeta * (law_parameters.surface1.D + law_parameters.surface2.D)


def curvature_terms(law_parameters: Yu2022) -> tuple[tuple[Number, Number], tuple[Number, Number]]:
    """Factors and exponents ((b1, p1), (b2, p2)) of the curvatures of a spot of area a, Eqs. 12-13.

    1/R_x = b1 a^-p1 and 1/R_y = b2 a^-p2 [1/m], along the major axis x and the minor axis y.
    """
    root = np.sqrt(np.log(law_parameters.surface.gamma))
    log_axes = 0.25 * np.log1p(-(law_parameters.e**2))

    def make_curvature_term(surface: FlankSurface, exponent_sign: float) -> tuple[Number, Number]:
        """Factor b and exponent p of the curvature b a^-p [1/m] of a spot of area a, along one axis."""
        b = 2.0 ** (4.0 - surface.D) * np.pi ** (0.5 * surface.D) * surface.G ** (surface.D - 1.0) * root
        return b * np.exp(exponent_sign * surface.D * log_axes), 0.5 * surface.D

    return make_curvature_term(law_parameters.surface1, 1.0), make_curvature_term(
        law_parameters.surface2, -1.0
    )


def yield_onset_parameter(law_parameters: Yu2022) -> Number:
    """Value of a (1/R_x + 1/R_y)^2 [1] at the onset of yield: 4 pi f1 K(e) E(e) (k H/E')^2, Eq. 28.

    a is the area of the spot; R_x and R_y are its radii of curvature. f1: first of `ellipse_factors`; K(e)
    and E(e): elliptic integrals; k: `hardness_coefficient` (K in Eq. 28); H: hardness; E': contact modulus.
    """
    K, E = complete_elliptic_integrals(law_parameters.e)
    f1, _ = ellipse_factors(law_parameters.e)
    strain = (
        hardness_coefficient(law_parameters.side1.nu)
        * law_parameters.hardness
        / effective_modulus(law_parameters)
    )
    return 4.0 * np.pi * f1 * K * E * strain**2


def critical_log_area(law_parameters: Yu2022, yield_parameter_over_onset: float) -> Number:
    """Log-area ln a [ln m2] of the spot with a given value of a (1/R_x + 1/R_y)^2, Eqs. 28, 31, 32.

    a is the area of the spot; R_x and R_y are its radii of curvature.

    yield_parameter_over_onset : a (1/R_x + 1/R_y)^2 divided by its value at the onset of yield [1]

    Newton's method in ln a. The function is convex and decreases with a slope between 1 - max(D1, D2) and
    1 - min(D1, D2), D1 and D2: fractal dimensions along both axes. So twelve steps reach round-off.
    """
    (b1, p1), (b2, p2) = curvature_terms(law_parameters)
    target = np.log(yield_parameter_over_onset * yield_onset_parameter(law_parameters))
    mean = 0.5 * (p1 + p2)
    t = (target - 2.0 * np.log(b1 + b2)) / (1.0 - 2.0 * mean)
    for _ in range(12):
        first, second = b1 * np.exp(-p1 * t), b2 * np.exp(-p2 * t)
        value = t + 2.0 * np.log(first + second) - target
        t = t - value / (1.0 - 2.0 * (p1 * first + p2 * second) / (first + second))
    return t


def _elastic_plastic_stages(
    law_parameters: Yu2022,
) -> tuple[tuple[ElasticPlasticStage, ElasticPlasticStage], tuple[float, float]]:
    """Two elastic-plastic stages, and the relative areas [1] at the ends of the second and of the first.

    The areas are divided by a_nec(R_m), the area at the onset of yield for the mean radius R_m of curvature.
    Stages and areas depend on the parameter `plastic_area`, the relation between area a and deformation w
    (w_nec: deformation at the onset of yield):

    geometric    : elastic relation a = f1 pi R_m w, so w/w_nec = a/a_nec(R_m), which is (a/a_nec)^-(D - 1)
                   for D1 = D2 = D; areas 110 and 6 of Eqs. 31-32
    kogut_etsion : a = a_nec(R_m) m (w/w_nec)^n as in Eqs. 33 and 35, with area_factor m and area_exponent n
                   of the stage; areas 205.38 and 7.1197
    """
    if law_parameters.plastic_area == "kogut_etsion":
        return (FIRST_ELASTIC_PLASTIC_STAGE, SECOND_ELASTIC_PLASTIC_STAGE), (
            FULL_PLASTIC_OVER_YIELD_AREA,
            SECOND_STAGE_OVER_YIELD_AREA,
        )
    plain = (
        FIRST_ELASTIC_PLASTIC_STAGE._replace(area_factor=1.0, area_exponent=1.0),
        SECOND_ELASTIC_PLASTIC_STAGE._replace(area_factor=1.0, area_exponent=1.0),
    )
    return plain, (FULL_PLASTIC_OVER_YIELD_DEFORMATION, SECOND_STAGE_OVER_YIELD_DEFORMATION)
