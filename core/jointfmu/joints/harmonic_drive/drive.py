"""What every harmonic drive has, whatever law its stiffness follows."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from ...quantity import Interval, Limit, Number, check, check_limits, quantity, where

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
