"""Harmonic drive under load: Python object, transmission of a robot, export, pressure on the contact pair."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.harmonic_drive import KIND
from jointfmu.joints.harmonic_drive.drive import HARMONICS, Drive
from jointfmu.joints.harmonic_drive.law import (
    HarmonicDrive,
    RoughHarmonicDrive,
    pair_stiffness,
    peak_pressure,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.mechanics.curve import Curve
from jointfmu.quantity import Array

from ...export.exports import Exports, LoadCurve
from ...interface.joint import Joint
from ...pressure import NominalPressure
from ...robots.transmission import Transmission

if TYPE_CHECKING:
    from ...export.tables import LoadTable


class DriveJoint(Joint):
    """Harmonic drive.

    `wind_up`, `torque` and `stiffness` describe the midline of the hysteresis loop, with the wave generator
    locked. Above max_torque the midline continues with its last tangent; then `messages` of `evaluate` and
    `follow` have a warning.

    >>> import jointfmu
    >>> drive = jointfmu.drive("CSG-25-100")
    >>> float(drive.torque(drive.wind_up(48.0))).__round__(9)
    48.0
    """

    def wind_up(self, torque: ArrayLike) -> Array:
        """Wind-up (n) [rad] of the output under torques (n) [N.m]; odd in the torque."""
        return self._midline.odd_inverse(torque)[()]

    def torque(self, wind_up: ArrayLike) -> Array:
        """Torque (n) [N.m] at wind-ups (n) [rad]; odd in the wind-up."""
        phi = np.asarray(wind_up, dtype=np.float64)
        return np.asarray(np.copysign(self._midline.derivatives(np.abs(phi), 1)[0], phi))[()]

    def stiffness(self, torque: ArrayLike) -> Array:
        """Tangent stiffness K_WTS (n) [N.m/rad] under torques (n) [N.m]."""
        return np.asarray(self._midline.derivatives(np.abs(self.wind_up(torque)), 1)[1])[()]

    @property
    def _midline(self) -> Curve:
        """Midline: torque over wind-up, for positive values."""
        curve = self.spring.curve
        assert isinstance(curve, Curve)
        return curve


CLASS = DriveJoint


def TRANSMISSION(name: str, drive: Drive) -> Transmission:
    """Transmission of a robot with the spring and friction of a drive."""
    spring = HarmonicDriveSpring.tabulate(drive)

    def wind_up(torques: ArrayLike) -> Array:
        memory, found = spring.initial_history(), []
        for torque in np.asarray(torques, dtype=np.float64):
            out, memory = spring.advance_torque(torque, memory)
            found.append(float(out["phi_rel"]))
        return np.array(found)

    return Transmission(
        name=name,
        ratio=drive.ratio,
        damping=drive.d,
        rated_torque=drive.rated_torque,
        max_torque=float(spring.curve.end[1]),
        dry_friction=drive.friction_coulomb,
        viscous_friction=drive.friction_viscous,
        static_friction=drive.friction_coulomb + drive.friction_stribeck,
        stribeck_speed=drive.stribeck_speed,
        presliding_angle=drive.presliding,
        compute_wind_up=wind_up,
        omitted_effects=tuple(_list_missing_effects(drive)),
    )


def _list_missing_effects(drive: Drive) -> Iterator[str]:
    """Effects of the drive that the model `Transmission` lacks, as text."""
    if drive.load_loss or drive.effective_load_loss_back:
        loss, back = (
            share * drive.rated_torque / abs(drive.ratio)
            for share in (drive.load_loss, drive.effective_load_loss_back)
        )
        yield (
            "friction that grows with the load: at rated torque "
            f"{loss:.4g} N.m at the motor where it drives, {back:.4g} N.m where the load does"
        )
    if drive.friction_coulomb or drive.friction_viscous:
        yield "the temperature of the lubricant: friction is that at 20 degrees C"
    error = sum(abs(getattr(drive, f"error_{n}")) for n in HARMONICS)
    if error:
        yield f"the kinematic error, up to {error:.3g} rad"


def _torque_table(drive: Drive, _: None, max_error: float) -> "LoadTable":
    from ...export.tables import tabulate_odd_curve

    return tabulate_odd_curve(HarmonicDriveSpring.tabulate(drive).curve, max_error)


EXPORTS = Exports(
    curve=LoadCurve(
        meaning="torque over wind-up at the output, wave generator locked",
        columns=tuple(KIND.variables[name] for name in ("phi_rel", "tau", "K_WTS")),
        name="torque",
        compute_table=_torque_table,
    ),
    missing_reasons={
        "contact": "its stiffness is a sum over the nodes of a mesh, not over an area; export its curve"
    },
)


_ContactPairDrive = HarmonicDrive | RoughHarmonicDrive


def _peak_pressure(drive: _ContactPairDrive, torque: float) -> float:
    return float(peak_pressure(drive, torque)[0])


def _mean_pressure(drive: _ContactPairDrive, torque: float) -> float:
    return drive.mean_over_peak * _peak_pressure(drive, torque)


def _stiffness_ratio(drive: _ContactPairDrive, torque: float) -> float:
    """Torsional stiffness K_TS of the drive over K_T radius^2 [1]; K_T: tangential stiffness of the law."""
    tangential = evaluate_at_pressure(drive.law, _mean_pressure(drive, torque))["K_T"]
    return float(pair_stiffness(drive, torque)[0] / (tangential * drive.radius**2))


PRESSURE = NominalPressure(
    load_variable="tau",
    default_load=lambda drive: drive.rated_torque,
    mean_pressure=_mean_pressure,
    peak_pressure=_peak_pressure,
    stiffness_ratio=_stiffness_ratio,
)
