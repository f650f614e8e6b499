"""What every harmonic drive has, whatever law its stiffness follows."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from ...quantity import Limit, Number, check, check_limits, quantity


@dataclass(frozen=True, kw_only=True)
class Drive(ABC):
    """Parameters of a harmonic drive but for the law of its midline, the torque over the wind-up."""

    ratio: float = quantity("1", "speed ratio of wave generator and output", gt=0.0)
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

    def __post_init__(self) -> None:
        check(self)
        check_limits(self, self.limits())

    @property
    @abstractmethod
    def law(self) -> Any:
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
    def pair_units(self) -> Number:
        """K_TS on the drive's scale over that of a paper's figures [1]."""
        return 1.0

    def limits(self) -> list[Limit]:
        """Intervals that other parameters decide."""
        return []

    def table_limits(self) -> list[Limit]:
        """Intervals that the tabulated law needs beside."""
        return []
