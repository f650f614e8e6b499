r"""What every harmonic drive has, whatever law its stiffness follows: its parameters, its errors of position.

Kinematic error: the output runs ahead and behind as the wave generator turns.

    phi_error = sum of error_n sin(n phi1 + error_n_phase),   n = HARMONICS

phi1 counts from the housing, which holds the circular spline: each of the wave generator's two lobes passes
every tooth once per turn, so what the teeth do to the motion comes twice. The wind-up is what is left of the
motion, phi_rel = phi2 - phi1/ratio - phi_error, and by virtual work the torque of the spring on the wave
generator is tau (1/ratio + dphi_error/dphi1).

Lost motion: the play that the output runs through at next to no torque.

The teeth never let go, so play is soft, not empty: beside the wind-up of the law

    phi_p(T) = lost_motion/2 tanh(T/T_p),   T_p = WIDTH rated_torque,

smooth, odd and in series, so that the torque over the wind-up stays a curve with one stiffness everywhere.
Catalogues state as lost motion the angle between +4 % and -4 % of rated torque, midway between the branches
of the loop through rated torque. Of that, 2 phi(0.04 rated_torque) is the wind-up of the law; `lost_motion`
is what is left.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from ...quantity import Interval, Limit, Number, check, check_limits, quantity, where

HARMONICS = (1, 2, 4)
"""Periods of the kinematic error per turn of the wave generator."""
WIDTH = 0.01
"""Torque over rated torque [1] in which the play is run through: at 4 % all but 0.07 % of it is."""
MOST_COEFFICIENT = 0.2
"""Most change of friction per kelvin over its value [1/K]: twice that of the thickest cylinder oil."""


@dataclass(frozen=True, kw_only=True)
class Drive(ABC):
    """Parameters of a harmonic drive but for the law of its midline, the torque over the wind-up."""

    ratio: float = quantity(
        "1", "speed ratio of wave generator and output; negative: they turn in opposite senses; not 0"
    )
    d: float = quantity("N.m.s/rad", "viscous damping at the output", ge=0.0)
    rated_torque: float = quantity("N.m", "rated torque", gt=0.0)
    hysteresis_loss: float = quantity(
        "rad", "angle between the branches at zero torque, after rated torque; 0: none", ge=0.0, default=0.0
    )
    hysteresis_stiffness: float = quantity(
        "N.m/rad",
        "extra stiffness of tiny motions, before friction slips; 0: as K_WTS at zero torque or as needed",
        ge=0.0,
        default=0.0,
    )
    lost_motion: float = quantity(
        "rad", "play of the output at next to no torque, between its ends; 0: none", ge=0.0, default=0.0
    )
    friction_coulomb: float = quantity("N.m", "dry friction at the wave generator", ge=0.0, default=0.0)
    friction_stribeck: float = quantity(
        "N.m", "further dry friction at rest, which speed takes away", ge=0.0, default=0.0
    )
    stribeck_speed: float = quantity(
        "rad/s", "speed of the wave generator that leaves 1/e of friction_stribeck", gt=0.0, default=10.0
    )
    friction_viscous: float = quantity(
        "N.m.s/rad", "friction at the wave generator over its speed", ge=0.0, default=0.0
    )
    load_loss: float = quantity(
        "1", "dry friction at the wave generator over the torque transmitted to it", ge=0.0, default=0.0
    )
    load_loss_back: float = quantity(
        "1", "the same where the load drives the motor; negative: as load_loss", default=-1.0
    )
    presliding: float = quantity(
        "rad",
        "angle of the wave generator over which dry friction builds up to 1 - 1/e",
        gt=0.0,
        default=0.01,
    )
    temperature_factor: float = quantity("1", "factor of all friction", ge=0.0, default=1.0)
    viscous_temperature_coefficient: float = quantity(
        "1/K",
        "fall of friction_viscous per kelvin above 293.15 K, over its value; 0: none",
        ge=-MOST_COEFFICIENT,
        le=MOST_COEFFICIENT,
        default=0.0,
    )
    dry_temperature_coefficient: float = quantity(
        "1/K",
        "fall of dry friction per kelvin above 293.15 K, over its value; 0: none",
        ge=-MOST_COEFFICIENT,
        le=MOST_COEFFICIENT,
        default=0.0,
    )
    inertia1: float = quantity(
        "kg.m2",
        "of the motor on the wave generator, for the stable steps alone; 0: held",
        ge=0.0,
        default=0.0,
    )
    inertia2: float = quantity(
        "kg.m2", "of the body on the output, for the stable steps alone; 0: held", ge=0.0, default=1.0
    )
    error_1: float = quantity(
        "rad",
        "kinematic error at the output, amplitude, one period per turn of the wave generator",
        default=0.0,
    )
    error_1_phase: float = quantity("rad", "phase of error_1 at phi1 = 0", default=0.0)
    error_2: float = quantity("rad", "the same with two periods per turn", default=0.0)
    error_2_phase: float = quantity("rad", "phase of error_2 at phi1 = 0", default=0.0)
    error_4: float = quantity("rad", "the same with four periods per turn", default=0.0)
    error_4_phase: float = quantity("rad", "phase of error_4 at phi1 = 0", default=0.0)

    def __post_init__(self) -> None:
        check(self)
        check_limits(self, self.limits())

    @property
    @abstractmethod
    def law(self) -> object:
        """Its interface law; None if it has none."""

    @property
    @abstractmethod
    def reach(self) -> Number:
        """Torque [N.m] at the end of the midline's table."""

    @property
    def ramp_torque(self) -> Number:
        """Torque [N.m] that load ramps reach: the rated one."""
        return self.rated_torque

    @property
    @abstractmethod
    def K_FTS(self) -> Number:
        """K_FTS [N.m/rad], the part of K_WTS that the torque does not change; more than any K_WTS."""

    @abstractmethod
    def pressure(self, torque: Number) -> Number:
        """Peak pressure (...) [Pa] of the contact pair at a torque; 0 of a law without a pair."""

    @property
    def loss_back(self) -> Number:
        """load_loss_back [1], or load_loss where that is negative."""
        return where(self.load_loss_back < 0.0, self.load_loss, self.load_loss_back)

    @property
    def pair_units(self) -> Number:
        """K_TS on the drive's scale over that of a paper's figures [1]."""
        return 1.0

    def limits(self) -> list[Limit]:
        """Intervals that other parameters decide."""
        any_sign = Interval.of(gt=np.minimum(2.0 * self.ratio, 0.0))
        return [Limit("ratio", any_sign, "allowed are (-inf, 0) and (0, inf)")]

    def table_limits(self) -> list[Limit]:
        """Intervals that the tabulated law needs beside."""
        return []


def amplitudes(drive: Drive) -> list[Number]:
    """[rad] of the harmonics; all zero without kinematic error."""
    return [getattr(drive, f"error_{n}") for n in HARMONICS]


def kinematic_error(drive: Drive, phi1: Number) -> tuple[Number, Number, Number]:
    """phi_error (...) [rad] at angles (...) [rad] of the wave generator, and its derivatives [1], [1/rad]."""
    error = slope = bend = 0.0
    for n, amplitude in zip(HARMONICS, amplitudes(drive), strict=True):
        angle = n * phi1 + getattr(drive, f"error_{n}_phase")
        wave, rise = amplitude * np.sin(angle), n * amplitude * np.cos(angle)
        error, slope, bend = error + wave, slope + rise, bend - n * n * wave
    return error, slope, bend


def play(drive: Drive, torque: Number) -> tuple[Number, Number, Number]:
    """phi_p (...) [rad] at torques (...) [N.m], and its derivatives [rad/(N.m)], [rad/(N.m)2]."""
    width, half = WIDTH * drive.rated_torque, 0.5 * drive.lost_motion
    part = np.tanh(torque / width)
    slope = half * (1.0 - part * part) / width
    return half * part, slope, -2.0 * part * slope / width
