"""What the published numbers of Hu 2023 mean for a harmonic drive, and which of them calibrate it."""

from dataclasses import replace

import numpy as np

from jointfmu.contact.interface import at_largest_spot
from jointfmu.contact.laws import hu2023 as hu
from jointfmu.contact.laws import kogut_etsion
from jointfmu.contact.surface import hardness_coefficient
from jointfmu.joints.harmonic_drive.law import HarmonicDrive, drive_stiffness, pair_stiffness, peak_pressure

from ...published.computed import CalibrationFit, Published


def K_TS(
    drive: HarmonicDrive, torque: float, deformation: float | None = None, eccentricity: float = 0.0
) -> float:
    """K_TS [N.m/rad] on the paper's scale at a torque [N.m], radial deformation and eccentricity [m]."""
    w = drive.radial_deformation if deformation is None else deformation
    there = replace(drive, radial_deformation=w, eccentricity=eccentricity)
    return float(pair_stiffness(there, torque)[0] / drive.drive_scale)


def K_TS_least(drive: HarmonicDrive, torque: float, lower: float, upper: float) -> float:
    """Least K_TS [N.m/rad] over 41 radial deformations of an interval [m]."""
    return min(K_TS(drive, torque, w) for w in np.linspace(lower, upper, 41).tolist())


def K_TS_change(drive: HarmonicDrive, torque: float, eccentricity: float) -> float:
    """Change of K_TS [%] by an eccentricity [m] at the nominal radial deformation."""
    return 100.0 * (K_TS(drive, torque, eccentricity=eccentricity) / K_TS(drive, torque) - 1.0)


def K_WTS(drive: HarmonicDrive, torque: float) -> float:
    """K_WTS [N.m/rad] at a torque [N.m]."""
    return float(drive_stiffness(drive, torque)[0])


def drive_peak_pressure(drive: HarmonicDrive, torque: float) -> float:
    """Peak contact pressure [Pa] at a torque [N.m]."""
    return float(peak_pressure(drive, torque)[0])


def kogut_etsion_product(drive: HarmonicDrive, product: str, stage: int) -> float:
    """Constants [1] of the elastic-plastic stages by area: load, stiffness, or where the stage ends."""
    if product == "area":
        return float((kogut_etsion.SECOND_AREA, kogut_etsion.PLASTIC_AREA)[stage - 1])
    powers = kogut_etsion.by_area((kogut_etsion.FIRST, kogut_etsion.SECOND)[stage - 1])
    return powers.A if product == "load" else powers.B


def plastic_onset_pressure(drive: HarmonicDrive, nu: float) -> float:
    """Mean pressure over hardness [1] of a spot of Kogut and Etsion at the onset of full plasticity."""
    stage, w = kogut_etsion.SECOND, kogut_etsion.PLASTIC_ONSET
    load_per_area = stage.c * w**stage.d / (stage.m * w**stage.n)
    return float(2.0 / 3.0 * hardness_coefficient(nu) * load_per_area)


def shear_over_friction(drive: HarmonicDrive, stage: str) -> float:
    """t/(mu f) [1] of a spot at the end of a stage if its area carries tau_b = sigma_s/sqrt(3)."""
    law = drive.law
    first, second = (kogut_etsion.by_area(s) for s in (kogut_etsion.FIRST, kogut_etsion.SECOND))
    load, area = {
        "elastic": (1.0, 1.0),
        "first": (first.A * kogut_etsion.SECOND_AREA**first.p, kogut_etsion.SECOND_AREA),
        "second": (second.A * kogut_etsion.PLASTIC_AREA**second.p, kogut_etsion.PLASTIC_AREA),
    }[stage]
    pressure = 2.0 / 3.0 * hardness_coefficient(law.side1.nu) * law.hardness * load / area
    return float(law.sigma_y / np.sqrt(3.0) / (law.mu * pressure))


def least_mean_pressure(drive: HarmonicDrive) -> float:
    """F_r/S_r [Pa] of purely elastic spots, largest spot s_ec: the least F_r/S_r of larger ones."""
    state = at_largest_spot(drive.law, hu.critical_area(drive.law))
    return float(state["F"] / state["A_r"])


PUBLISHED = Published(
    papers=("hu2023",),
    observables={
        "K_TS": K_TS,
        "K_TS_least": K_TS_least,
        "K_TS_change": K_TS_change,
        "K_WTS": K_WTS,
        "peak_pressure": drive_peak_pressure,
        "kogut_etsion": kogut_etsion_product,
        "plastic_onset_pressure": plastic_onset_pressure,
        "shear_over_friction": shear_over_friction,
        "least_mean_pressure": least_mean_pressure,
    },
    calibration=(
        CalibrationFit(
            {
                "zero_torque_pressure": 30e6,
                "rated_pressure": 101e6,
                "deformation_loss": 3e16,
                "radial_deformation": 0.196e-3,
                "eccentricity_loss": 5e11,
                "K_FTS0": 2e4,
            },
            (
                "K_WTS.theory.0.5",
                "K_TS.max.5",
                "K_TS.min.5",
                "K_TS.nominal.5",
                "K_TS.eccentricity.5",
                "K_WTS.measured.5",
            ),
        ),
    ),
)
"""{quantity of a reference file: function}, and the fit."""
