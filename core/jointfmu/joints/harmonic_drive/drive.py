r"""Harmonic drive with any law of its stiffness: parameters, kinematic error and lost motion.

Kinematic error: deviation of the output angle from phi1/ratio, periodic in the angle of the wave generator.

    phi_error = sum of error_n sin(n phi1 + error_n_phase),   n = KINEMATIC_ERROR_HARMONICS

phi1 is measured from the housing, which holds the circular spline. Each of the two lobes of the wave
generator passes every tooth once per turn, so errors of the teeth have two periods per turn. The wind-up is
the elastic part of the motion, phi_rel = phi2 - phi1/ratio - phi_error. By virtual work the torque of the
spring on the wave generator is tau (1/ratio + dphi_error/dphi1).

Lost motion: additional angle of the output around zero torque.

The teeth never separate, so lost motion is a soft range, not a gap. Its angle is in series with the wind-up
of the law,

    phi_p(T) = lost_motion/2 tanh(T/T_p),   T_p = PLAY_TORQUE_OVER_RATED_TORQUE rated_torque,

smooth and odd, so that torque over wind-up stays a curve with a finite stiffness everywhere. Catalogues state
as lost motion the angle between +4 % and -4 % of rated torque, midway between the branches of the loop
through rated torque. This angle is the wind-up of the law, 2 phi(0.04 rated_torque), plus `lost_motion`.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...quantity import Interval, Number, ParameterLimit, check_fields, check_limits, quantity_field, select

FRICTION_HARMONICS = (1, 2)
"""Periods of the dry friction per turn of the wave generator."""
KINEMATIC_ERROR_HARMONICS = (1, 2, 4)
"""Periods of the kinematic error per turn of the wave generator."""
PLAY_TORQUE_OVER_RATED_TORQUE = 0.01
"""T_p over rated torque [1]: at 4 % of rated torque the play has reached 99.93 % of its final value."""
MAX_TEMPERATURE_COEFFICIENT = 0.2
"""Largest relative change of friction per kelvin [1/K]: twice that of the most viscous cylinder oil."""


@dataclass(frozen=True, kw_only=True)
class DriveParameters(ABC):
    """Parameters of a harmonic drive, except its midline: torque-wind-up curve without hysteresis."""

    ratio: float = quantity_field(
        "1", "speed ratio of wave generator and output; negative: they turn in opposite senses; not 0"
    )
    d: float = quantity_field("N.m.s/rad", "viscous damping at the output", ge=0.0)
    rated_torque: float = quantity_field("N.m", "rated torque", gt=0.0)
    hysteresis_loss: float = quantity_field(
        "rad",
        "angle between the loading and unloading branches at zero torque, after rated torque; 0: none",
        ge=0.0,
        default=0.0,
    )
    hysteresis_stiffness: float = quantity_field(
        "N.m/rad",
        "additional stiffness for small motions, before the hysteresis friction slips; 0: K_WTS at zero "
        "torque, or more if needed",
        ge=0.0,
        default=0.0,
    )
    lost_motion: float = quantity_field(
        "rad",
        "total play of the output around zero torque, in addition to the wind-up; 0: none",
        ge=0.0,
        default=0.0,
    )
    friction_coulomb: float = quantity_field(
        "N.m", "dry friction torque at the wave generator, independent of speed and load", ge=0.0, default=0.0
    )
    friction_stribeck: float = quantity_field(
        "N.m", "extra dry friction at standstill that vanishes with speed (Stribeck)", ge=0.0, default=0.0
    )
    stribeck_speed: float = quantity_field(
        "rad/s",
        "speed of the wave generator at which friction_stribeck has decreased to 1/e",
        gt=0.0,
        default=10.0,
    )
    friction_viscous: float = quantity_field(
        "N.m.s/rad", "viscous friction coefficient at the wave generator", ge=0.0, default=0.0
    )
    load_loss: float = quantity_field(
        "1",
        "load-dependent dry friction torque divided by the torque transmitted to the wave generator",
        ge=0.0,
        default=0.0,
    )
    load_loss_back: float = quantity_field(
        "1", "load_loss while the load drives the motor; negative: equal to load_loss", default=-1.0
    )
    friction_1: float = quantity_field(
        "N.m",
        "amplitude of friction_coulomb, one period per turn of the wave generator",
        ge=0.0,
        default=0.0,
    )
    friction_1_phase: float = quantity_field("rad", "phase of friction_1 at phi1 = 0", default=0.0)
    friction_2: float = quantity_field(
        "N.m",
        "amplitude of friction_coulomb, two periods per turn of the wave generator",
        ge=0.0,
        default=0.0,
    )
    friction_2_phase: float = quantity_field("rad", "phase of friction_2 at phi1 = 0", default=0.0)
    presliding: float = quantity_field(
        "rad",
        "angle of the wave generator over which dry friction builds up to 1 - 1/e",
        gt=0.0,
        default=0.01,
    )
    temperature_factor: float = quantity_field(
        "1", "factor that multiplies all friction", ge=0.0, default=1.0
    )
    viscous_temperature_coefficient: float = quantity_field(
        "1/K",
        "relative decrease of friction_viscous per kelvin above 293.15 K; 0: none",
        ge=-MAX_TEMPERATURE_COEFFICIENT,
        le=MAX_TEMPERATURE_COEFFICIENT,
        default=0.0,
    )
    dry_temperature_coefficient: float = quantity_field(
        "1/K",
        "relative decrease of dry friction per kelvin above 293.15 K; 0: none",
        ge=-MAX_TEMPERATURE_COEFFICIENT,
        le=MAX_TEMPERATURE_COEFFICIENT,
        default=0.0,
    )
    inertia1: float = quantity_field(
        "kg.m2",
        "inertia of the motor on the wave generator, used only for the outputs of stable steps; 0: fixed",
        ge=0.0,
        default=0.0,
    )
    inertia2: float = quantity_field(
        "kg.m2",
        "inertia of the body on the output, used only for the outputs of stable steps; 0: fixed",
        ge=0.0,
        default=1.0,
    )
    error_1: float = quantity_field(
        "rad",
        "kinematic error at the output, amplitude, one period per turn of the wave generator",
        default=0.0,
    )
    error_1_phase: float = quantity_field("rad", "phase of error_1 at phi1 = 0", default=0.0)
    error_2: float = quantity_field(
        "rad", "kinematic error at the output, amplitude, two periods per turn", default=0.0
    )
    error_2_phase: float = quantity_field("rad", "phase of error_2 at phi1 = 0", default=0.0)
    error_4: float = quantity_field(
        "rad", "kinematic error at the output, amplitude, four periods per turn", default=0.0
    )
    error_4_phase: float = quantity_field("rad", "phase of error_4 at phi1 = 0", default=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        check_limits(self, self.find_parameter_limits())

    @property
    @abstractmethod
    def law(self) -> object:
        """Interface law of the contact pair: flexspline and outer ring of the flexible bearing.

        None if the stiffness of the drive follows from no interface law.
        """

    @property
    @abstractmethod
    def max_table_torque(self) -> Number:
        """Torque [N.m] at the end of the midline's table, torque as a function of wind-up."""

    @property
    def ramp_torque(self) -> Number:
        """Torque [N.m] at the end of load ramps: the rated torque."""
        return self.rated_torque

    @property
    @abstractmethod
    def K_FTS(self) -> Number:
        """Stiffness K_FTS [N.m/rad] of circular spline and flexspline.

        K_FTS is in series with the stiffness K_TS of the contact pair of flexspline and bearing: both give
        the stiffness K_WTS of the drive. K_FTS is independent of the torque, and larger than any K_WTS.
        """

    @abstractmethod
    def pressure(self, torque: Number) -> Number:
        """Peak pressure (...) [Pa] of the contact pair at torques (...) [N.m]; 0 without a contact pair."""

    @property
    def effective_load_loss_back(self) -> Number:
        """Share of the load torque [1] lost by friction if the load drives the motor: load_loss_back.

        A negative load_loss_back stands for load_loss.
        """
        return select(self.load_loss_back < 0.0, self.load_loss, self.load_loss_back)

    @property
    def contact_pair_stiffness_scale(self) -> Number:
        """Stiffness K_TS of the contact pair, divided by that in the figures of the paper (K_TS_pair) [1]."""
        return 1.0

    def find_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of those parameters whose allowed interval depends on other parameters."""
        any_sign = Interval.from_bounds(gt=np.minimum(2.0 * self.ratio, 0.0))
        positive_friction = Interval.from_bounds(ge=0.0, le=self.friction_coulomb - self.friction_2)
        return [
            ParameterLimit("ratio", any_sign, "allowed are (-inf, 0) and (0, inf)"),
            ParameterLimit(
                "friction_1", positive_friction, "friction_1 + friction_2 must not exceed friction_coulomb"
            ),
        ]

    def find_table_parameter_limits(self) -> list[ParameterLimit]:
        """Limits of parameters under which the midline can be tabulated up to its last torque."""
        return []


def kinematic_error_amplitudes(drive_parameters: DriveParameters) -> list[Number]:
    """Amplitudes [rad] of the kinematic error, one for each of KINEMATIC_ERROR_HARMONICS."""
    return [getattr(drive_parameters, f"error_{n}") for n in KINEMATIC_ERROR_HARMONICS]


def kinematic_error(drive_parameters: DriveParameters, phi1: Number) -> tuple[Number, Number, Number]:
    """Kinematic error (...) [rad] at wave generator angles phi1 (...) [rad], and two derivatives.

    Returns also the first [1] and the second derivative [1/rad] with respect to phi1.
    """
    error = slope = bend = 0.0
    harmonics = compute_sines_and_cosines(phi1, KINEMATIC_ERROR_HARMONICS)
    for (n, (sine, cosine)), amplitude in zip(
        harmonics.items(), kinematic_error_amplitudes(drive_parameters), strict=True
    ):
        phase = getattr(drive_parameters, f"error_{n}_phase")
        wave = amplitude * (sine * np.cos(phase) + cosine * np.sin(phase))
        wave_slope = n * amplitude * (cosine * np.cos(phase) - sine * np.sin(phase))
        error, slope, bend = error + wave, slope + wave_slope, bend - n * n * wave
    return error, slope, bend


def compute_sines_and_cosines(
    shaft_angle: Number, harmonic_orders: Sequence[int]
) -> dict[int, tuple[Number, Number]]:
    """Compute sines and cosines of multiples of an angle: {n: (sin(n angle), cos(n angle))}.

    The orders n are powers of 2, for the formulas of the double angle. Sine and cosine are evaluated once:
    they take a large part of the computing time of a drive.
    """
    order, sine, cosine = 1, np.sin(shaft_angle), np.cos(shaft_angle)
    harmonics = {order: (sine, cosine)}
    while order < max(harmonic_orders):
        order, sine, cosine = 2 * order, 2.0 * sine * cosine, (cosine - sine) * (cosine + sine)
        harmonics[order] = sine, cosine
    return {n: harmonics[n] for n in harmonic_orders}


def lost_motion_angle(drive_parameters: DriveParameters, torque: Number) -> tuple[Number, Number, Number]:
    """Wind-up (...) [rad] of the lost motion (play) at torques (...) [N.m]: half of lost_motion at most.

    Returns also the first [rad/(N.m)] and second derivative [rad/(N.m)2] with respect to the torque.
    """
    width, half = (
        PLAY_TORQUE_OVER_RATED_TORQUE * drive_parameters.rated_torque,
        0.5 * drive_parameters.lost_motion,
    )
    share = np.tanh(torque / width)
    slope = half * (1.0 - share * share) / width
    return half * share, slope, -2.0 * share * slope / width
