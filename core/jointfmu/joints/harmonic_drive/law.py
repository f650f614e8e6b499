"""Harmonic drive with a midline from the contact pair of flexspline and flexible bearing (Hu 2023)."""

from abc import abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from ...contact.laws.hu2023 import Hu2023, elastic_pressure
from ...contact.laws.roughness import RoughnessLaw, RoughSurfaces
from ...contact.surface import ArealSurface, ElasticConstants, ElasticPlasticConstants
from ...quantity import Interval, Number, ParameterLimit, choice_field, group_field, quantity_field, select
from .drive import DriveParameters, lost_motion_angle

SATURATION_TORQUE_OVER_RATED_TORQUE = 2.0
"""Torque T_m over rated torque [1] at which the contact pressure saturates: for larger torques the pressure
tends to the value that it would have at T_m without saturation."""
_SURFACE_SCAN_LENGTH = 0.5e-3
"""Scan length [m] of the profile in Hu 2023, section 2.3."""


@dataclass(frozen=True, kw_only=True)
class ContactPairDriveParameters(DriveParameters):
    """Parameters of a harmonic drive whose stiffness follows from the contact of flexspline and bearing.

    The parameters of the interface law are added by subclasses.

    Fields with is_calibrated=True were fitted to published points.
    """

    mu: float = quantity_field("1", "coefficient of static friction, if traction is real_area", gt=0.0)
    traction_ratio: float = quantity_field(
        "1", "ratio of shear force to friction limit, x = T/(mu P)", ge=0.0, lt=1.0
    )
    A_0: float = quantity_field("m2", "nominal area of the contact pair", gt=0.0)
    mean_over_peak: float = quantity_field("1", "ratio of mean to peak contact pressure", gt=0.0, le=1.0)
    radius: float = quantity_field("m", "mean radius of the contact pair", gt=0.0)
    radial_deformation: float = quantity_field("m", "radial deformation w of the flexspline", gt=0.0, lt=2e-3)
    eccentricity: float = quantity_field(
        "m", "installation eccentricity of flexspline and bearing", ge=0.0, lt=1e-3
    )
    K_FTS0: float = quantity_field(
        "N.m/rad", "stiffness K_FTS of circular spline and flexspline", gt=0.0, is_calibrated=True
    )
    max_torque: float = quantity_field("N.m", "largest torque of the tabulated law", gt=0.0)
    zero_torque_pressure: float = quantity_field(
        "Pa", "peak contact pressure without torque, at the optimum deformation", gt=0.0, is_calibrated=True
    )
    rated_pressure: float = quantity_field(
        "Pa", "peak contact pressure at rated torque, at the optimum deformation", gt=0.0, is_calibrated=True
    )
    torque_smoothing: float = quantity_field(
        "N.m", "torque below which the pressure hardly increases", gt=0.0
    )
    optimum_deformation: float = quantity_field(
        "m", "radial deformation at which the pressure is largest", gt=0.0
    )
    deformation_loss: float = quantity_field(
        "Pa/m2",
        "loss of peak pressure per squared offset of radial_deformation from its optimum",
        ge=0.0,
        is_calibrated=True,
    )
    eccentricity_loss: float = quantity_field(
        "Pa/m", "loss of peak pressure per unit of eccentricity", ge=0.0, is_calibrated=True
    )

    @property
    @abstractmethod
    def contact_pair_law(self) -> Hu2023 | RoughnessLaw:
        """Interface law of the contact between flexspline and bearing.

        Its load is a power of the area of the largest spot.
        """

    @property
    @abstractmethod
    def contact_pair_stiffness_factor(self) -> Number:
        """Torsional stiffness K_TS [N.m/rad] of the contact pair per tangential stiffness of its law [m2]."""

    @property
    def max_table_torque(self) -> Number:
        """Largest torque [N.m] in the table of the hysteresis loop's midline: the parameter max_torque."""
        return self.max_torque

    @property
    def K_FTS(self) -> Number:
        """Stiffness K_FTS [N.m/rad] of circular spline and flexspline: the parameter K_FTS0."""
        return self.K_FTS0

    def pressure(self, torque: Number) -> Number:
        """Peak contact pressure (...) [Pa] at torques (...) [N.m]."""
        return peak_pressure(self, torque)[0]

    def find_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of those parameters whose allowed interval depends on other parameters."""
        no_contact = "outside this range the contact pair is open at zero torque"
        zero, loss, best = self.zero_torque_pressure, self.deformation_loss, self.optimum_deformation
        with np.errstate(over="ignore"):
            reach = np.sqrt(zero / np.maximum(loss, 1e-290))
            reserve = (zero - self._deformation_pressure_reduction) / np.maximum(
                self.eccentricity_loss, 1e-290
            )
        return [
            *super().find_parameter_limits(),
            ParameterLimit(
                "rated_pressure", Interval.from_bounds(gt=zero), "it must exceed zero_torque_pressure"
            ),
            ParameterLimit(
                "radial_deformation", Interval.from_bounds(gt=best - reach, lt=best + reach), no_contact
            ),
            ParameterLimit("eccentricity", Interval.from_bounds(ge=0.0, lt=reserve), no_contact),
        ]

    @property
    def _deformation_pressure_reduction(self) -> float:
        """Reduction of the peak pressure [Pa] by a radial deformation that is not the optimum."""
        return self.deformation_loss * (self.radial_deformation - self.optimum_deformation) ** 2

    @property
    def peak_pressure_reduction(self) -> float:
        """Reduction of the peak pressure [Pa] by non-optimal radial deformation and by eccentricity."""
        return self._deformation_pressure_reduction + self.eccentricity_loss * self.eccentricity


@dataclass(frozen=True, kw_only=True)
class HarmonicDriveParameters(ContactPairDriveParameters):
    """Parameters of the harmonic drive with the law of Hu 2023, read as printed."""

    surface: ArealSurface = group_field("equivalent rough surface of the contact pair")
    flexspline: ElasticPlasticConstants = group_field("flexspline")
    bearing: ElasticPlasticConstants = group_field("outer ring of the flexible bearing")
    shear_traction: float = quantity_field(
        "Pa", "shear traction on the real area, used if traction is real_area", gt=0.0
    )
    node_area: float = quantity_field(
        "m2", "nominal area of a mesh node in Eq. 45, which has its own set of spots", gt=0.0
    )
    drive_scale: float = quantity_field("1", "ratio of K_TS in Eq. 46 to the published K_TS", gt=0.0)
    traction: str = choice_field(
        "ratio",
        "real_area",
        doc="shear of a spot: from traction_ratio (ratio), or shear_traction on the real area (real_area)",
    )

    @property
    def contact_pair_law(self) -> Hu2023:
        """Law of Hu 2023 as printed, for the contact area of one node of the paper's finite-element mesh.

        It gives force and stiffness as functions of the real contact area of this node.
        side1 is the body with the lower yield strength.
        """
        cup, ring = self.flexspline, self.bearing
        swap = ring.sigma_y < cup.sigma_y
        E, nu = select(swap, ring.E, cup.E), select(swap, ring.nu, cup.nu)
        return Hu2023(
            surface=self.surface,
            side1=ElasticConstants(E=E, nu=nu),
            side2=ElasticConstants(E=select(swap, cup.E, ring.E), nu=select(swap, cup.nu, ring.nu)),
            sigma_y=np.minimum(cup.sigma_y, ring.sigma_y),
            mu=self.mu,
            traction_ratio=self.traction_ratio,
            shear_traction=self.shear_traction,
            traction=self.traction,
            A_0=self.node_area,
            reading="printed",
        )

    @property
    def law(self) -> Hu2023:
        """Corrected law of Hu 2023 for the whole nominal contact area.

        The stiffness of the drive does not come from it, but from `contact_pair_law`.

        Its base radius r_m is half of the scan length: with r_m of the paper no spot would have stiffness.
        """
        surface = replace(self.surface, r_m=0.5 * _SURFACE_SCAN_LENGTH)
        return replace(self.contact_pair_law, surface=surface, A_0=self.A_0, reading="corrected")

    @property
    def contact_pair_stiffness_factor(self) -> Number:
        """Factor [m] from the tangential stiffness K_T of a mesh node to K_TS of the contact pair.

        The factor is the product of drive_scale, number of nodes and diameter: Eq. 45 as printed. The sum of
        Eq. 45 has the unit newton; the paper reads it as N.m/rad, and so does this class.
        """
        return self.drive_scale * 2.0 * self.radius * self.A_0 / self.node_area

    @property
    def contact_pair_stiffness_scale(self) -> Number:
        """Ratio [1] of the contact pair's stiffness K_TS to K_TS in the figures of the paper: drive_scale."""
        return self.drive_scale

    def find_table_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of the yield strengths above which all spots stay elastic up to max_torque.

        The printed law assumes elastic spots.
        """
        highest = peak_pressure(self, self.max_torque)[0]
        law = self.contact_pair_law
        min_yield_strength = highest * law.sigma_y / elastic_pressure(law)
        why = "spots of the contact pair would yield below max_torque"
        return [
            ParameterLimit(f"{side}.sigma_y", Interval.from_bounds(gt=min_yield_strength), why)
            for side in ("flexspline", "bearing")
        ]


@dataclass(frozen=True, kw_only=True)
class RoughHarmonicDriveParameters(RoughSurfaces, ContactPairDriveParameters):
    """Parameters of the harmonic drive with the law `roughness`; K_TS has no fitted scale factor."""

    H: float = quantity_field("Pa", "hardness of the softer body", gt=0.0)
    flexspline: ElasticConstants = group_field("flexspline")
    bearing: ElasticConstants = group_field("outer ring of the flexible bearing")

    @property
    def contact_pair_law(self) -> RoughnessLaw:
        """Law `roughness` of the whole contact pair, evaluated at its mean pressure."""
        return RoughnessLaw(
            h=self.h,
            gamma=self.gamma,
            longest_wave=self.longest_wave,
            hurst=self.hurst,
            slope=self.slope,
            side1=self.flexspline,
            side2=self.bearing,
            H=self.H,
            mu=self.mu,
            traction_ratio=self.traction_ratio,
            A_0=self.A_0,
        )

    law = contact_pair_law

    @property
    def contact_pair_stiffness_factor(self) -> Number:
        """Factor [m2] from the tangential stiffness K_T of the contact to K_TS of the pair: radius squared.

        The normal stiffness adds less than 1e-3 to K_TS.
        """
        return self.radius**2


def peak_pressure(drive_parameters: ContactPairDriveParameters, torque: Number) -> tuple[Number, Number]:
    """Peak contact pressure (...) [Pa] at torques T (...) [N.m], and its derivative [Pa/(N.m)].

    Pressure at the major axis and the opening of the cup,
    `sqrt(p_0^2 + (p_r^2 - p_0^2) g(t(T))/g(t(T_r))) - loss` with `g(t) = sqrt(t^2 + T_s^2) - T_s`.
    Here p_0 and p_r are the pressures at zero and at rated torque T_r, T_s is torque_smoothing, and loss is
    `peak_pressure_reduction`. The peak pressure of a line contact grows with the square root of its load.
    Here the load has a constant part and a part proportional to |T|, which is smoothed around T = 0.
    `t(T) = T/(1 + (T/T_m)^4)^(1/4)` tends to T_m, SATURATION_TORQUE_OVER_RATED_TORQUE times the rated torque:
    the stiffness of catalogue drives becomes constant. Beyond rated torque this is an extrapolation.
    """
    smoothing, saturation = (
        drive_parameters.torque_smoothing,
        SATURATION_TORQUE_OVER_RATED_TORQUE * drive_parameters.rated_torque,
    )

    def saturate_torque(torque: Number) -> tuple[Number, Number]:
        """Squared saturated torque t^2 [(N.m)^2] and t dt/dT [N.m] at a torque T.

        t = s x/(1 + x^4)^(1/4) with x = T/s: t = T at small torques; its magnitude tends to the saturation
        torque s at large ones.
        """
        x = np.minimum(np.maximum(torque / saturation, -1e3), 1e3)
        bend = 1.0 + x**4
        root = np.sqrt(bend)
        return (saturation * x) ** 2 / root, saturation * x / (bend * root)

    def smoothed_torque(squared_torque: Number) -> Number:
        """Magnitude sqrt(t^2 + T_s^2) [N.m] of the saturated torque t, smoothed around zero over T_s."""
        return np.maximum(np.sqrt(squared_torque + smoothing**2), smoothing)  # if smoothing**2 underflows

    def smoothed_torque_increase(squared_torque: Number) -> Number:
        """Smoothed magnitude [N.m] of the saturated torque t, less its value at t = 0; argument t^2."""
        return squared_torque / (smoothed_torque(squared_torque) + smoothing)

    zero, rated = drive_parameters.zero_torque_pressure, drive_parameters.rated_pressure
    factor = (rated**2 - zero**2) / smoothed_torque_increase(
        saturate_torque(drive_parameters.rated_torque)[0]
    )
    square, square_slope = saturate_torque(torque)
    unreduced = np.sqrt(zero**2 + factor * smoothed_torque_increase(square))
    return (
        unreduced - drive_parameters.peak_pressure_reduction,
        0.5 * factor * square_slope / smoothed_torque(square) / unreduced,
    )


def contact_pair_log_area(drive_parameters: ContactPairDriveParameters, torque: Number) -> Number:
    """Log-area (...) [1] of the largest contact spot of flexspline and bearing at torques (...) [N.m].

    ln(area of the spot/reference area of the law), from the mean pressure of the contact pair.
    """
    law = drive_parameters.contact_pair_law
    start, power = law.spot_distribution().log_sum_over_spots("load", 0.0)
    return (
        np.log(drive_parameters.mean_over_peak * peak_pressure(drive_parameters, torque)[0] * law.A_0) - start
    ) / power


def contact_pair_stiffness(
    drive_parameters: ContactPairDriveParameters, torque: Number
) -> tuple[Number, Number]:
    """Stiffness K_TS (...) [N.m/rad] of the contact pair at torques (...) [N.m], and dK_TS/dT [1/rad].

    K_TS is computed from the mean pressure, as the tangential stiffness of a point is nearly proportional to
    its pressure.
    """
    peak, pressure_slope = peak_pressure(drive_parameters, torque)
    spots, u = (
        drive_parameters.contact_pair_law.spot_distribution(),
        contact_pair_log_area(drive_parameters, torque),
    )
    power = spots.log_sum_over_spots("load", 0.0)[1]
    slope = spots.sum_over_spots_derivative("tangential", u) / (power * peak)
    return drive_parameters.contact_pair_stiffness_factor * spots.sum_over_spots(
        "tangential", u
    ), drive_parameters.contact_pair_stiffness_factor * slope * pressure_slope


def drive_stiffness(drive_parameters: ContactPairDriveParameters, torque: Number) -> tuple[Number, Number]:
    """Stiffness K_WTS (...) [N.m/rad] of the drive without lost motion, Eq. 46, and dK_WTS/dT [1/rad].

    1/K_WTS = 1/K_FTS + 1/K_TS: circular spline and flexspline in series with the contact pair.
    """
    pair, growth = contact_pair_stiffness(drive_parameters, torque)
    total = 1.0 / (1.0 / drive_parameters.K_FTS0 + 1.0 / pair)
    return total, (total / pair) ** 2 * growth


def stiffness_with_play(
    drive_parameters: ContactPairDriveParameters, torque: Number
) -> tuple[Number, Number]:
    """Stiffness K_WTS (...) [N.m/rad] of the drive with its lost motion in series, and dK_WTS/dT [1/rad]."""
    K, growth = drive_stiffness(drive_parameters, torque)
    _, compliance, change = lost_motion_angle(drive_parameters, torque)
    softer = 1.0 + K * compliance
    return K / softer, (growth - K * K * change) / softer**2
