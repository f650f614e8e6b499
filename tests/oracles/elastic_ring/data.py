"""Data of the ring model in addition to the drive's parameters, and its loads."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.harmonic_drive.law import HarmonicDriveParameters
from jointfmu.quantity import check_fields, quantity_field

Array = NDArray[np.float64]
Traction = Callable[[Array], tuple[Array, Array]]
"""Function: angles (q) [1] -> radial and tangential traction (q) [Pa] on the flexspline."""


@dataclass(frozen=True, kw_only=True)
class Rings:
    """Data of the ring model in addition to the parameters of the drive."""

    wall: float = quantity_field("m", "thickness of the flexspline under its teeth, these smeared", gt=0.0)
    race: float = quantity_field("m", "thickness of the bearing's outer ring", gt=0.0)
    cup_length: float = quantity_field("m", "length over which the radial deformation tapers to zero", gt=0.0)
    balls: int = quantity_field("1", "number of balls", ge=3.0, is_integer=True)
    ball_diameter: float = quantity_field("m", "diameter of a ball", gt=0.0)
    first_ball: float = quantity_field("1", "angle of a ball from the major axis")
    interference: float = quantity_field("m", "radius of the bearing ring over that of the flexspline's bore")
    zone: float = quantity_field("1", "half of the angle in which teeth carry load", gt=0.0, le=0.5 * np.pi)
    zone_centre: float = quantity_field("1", "angle of the most loaded tooth from the major axis")
    pressure_angle: float = quantity_field(
        "1", "angle of the tooth force from the tangent", ge=0.0, lt=0.5 * np.pi
    )
    eccentric_angle: float = quantity_field("1", "angle of the drive's eccentricity from the major axis")
    lateral_stiffness: float = quantity_field("N/m", "of the cup's opening against its bottom", gt=0.0)
    elements_per_ball: int = quantity_field(
        "1", "elements of a ring from ball to ball", ge=2.0, is_integer=True
    )

    def __post_init__(self) -> None:
        check_fields(self)


SIZE_14 = Rings(
    wall=0.4e-3 * 1.67 ** (1.0 / 3.0),
    race=1.0e-3,
    cup_length=0.02,
    balls=23,
    ball_diameter=2.5e-3,
    first_ball=0.0,
    interference=0.0,
    zone=np.radians(45.0),
    zone_centre=0.0,
    pressure_angle=np.radians(20.0),
    eccentric_angle=0.0,
    lateral_stiffness=3e5,
    elements_per_ball=12,
)
"""Estimated data of a drive of size 14. For the CD-14-100 only the factor 1.67^(1/3) of the wall under the
teeth is published (Hu 2023, section 2.3). docs/harmonic_drive_field.md gives the sources."""


def contact_length(drive: HarmonicDriveParameters) -> float:
    """Length [m] of the contact along the drive's axis."""
    return drive.A_0 / (2.0 * np.pi * drive.radius)


def tooth_traction(drive: HarmonicDriveParameters, rings: Rings, torque: float) -> Traction:
    """Cosine-shaped tooth load on both meshing zones, in equilibrium with a uniform shear flow in the cup.

    Tangential q cos(pi (theta - centre)/(2 zone)), radial tan(pressure angle) times that, inward:
    the assumption of the design literature (Ivanov 1981; Shen and Ye 1985).
    """
    if not np.isfinite(torque):
        raise ValueError(f"torque = {torque:g} N.m is outside (-inf, inf): torque at the output")
    area = drive.radius**2 * contact_length(drive)
    peak = np.pi * torque / (8.0 * rings.zone * area)

    def traction(theta: Array) -> tuple[Array, Array]:
        off = (theta - rings.zone_centre + 0.5 * np.pi) % np.pi - 0.5 * np.pi
        shape = np.where(np.abs(off) < rings.zone, np.cos(0.5 * np.pi * off / rings.zone), 0.0)
        return -abs(peak) * np.tan(rings.pressure_angle) * shape, peak * shape - torque / (2.0 * np.pi * area)

    return traction


def ball_stiffness(drive: HarmonicDriveParameters, rings: Rings) -> float:
    """Force over approach^(3/2) [N/m^1.5] of a ball between two flat races (Hertz, both contacts)."""
    modulus = drive.bearing.E / (1.0 - drive.bearing.nu**2) / 2.0
    return float(4.0 / 3.0 * modulus * np.sqrt(0.5 * rings.ball_diameter) / 2.0**1.5)
