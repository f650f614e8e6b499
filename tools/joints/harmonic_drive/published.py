"""Published values of Hu 2023: how to compute each quantity, and which values calibrate parameters."""

from dataclasses import replace

import numpy as np

from jointfmu.contact.interface import evaluate_at_largest_spot
from jointfmu.contact.laws import hu2023 as hu
from jointfmu.contact.laws import kogut_etsion
from jointfmu.contact.surface import hardness_coefficient
from jointfmu.joints.harmonic_drive.law import (
    HarmonicDriveParameters,
    contact_pair_stiffness,
    drive_stiffness,
    peak_pressure,
)

from ...studies.published.computed import CalibrationFit, PublishedNumbers


def K_TS(
    drive_parameters: HarmonicDriveParameters,
    torque: float,
    deformation: float | None = None,
    eccentricity: float = 0.0,
) -> float:
    """Torsional stiffness K_TS [N.m/rad] of the contact of flexspline and bearing, over `drive_scale`.

    The quotient is on the scale of the figures in Hu 2023.

    torque       : [N.m]
    deformation  : [m] radial deformation of the flexspline; None: that of the drive
    eccentricity : [m] between flexspline and bearing
    """
    w = drive_parameters.radial_deformation if deformation is None else deformation
    changed = replace(drive_parameters, radial_deformation=w, eccentricity=eccentricity)
    return float(contact_pair_stiffness(changed, torque)[0] / drive_parameters.drive_scale)


def smallest_K_TS(
    drive_parameters: HarmonicDriveParameters, torque: float, lower: float, upper: float
) -> float:
    """Smallest torsional stiffness K_TS [N.m/rad] of the contact of flexspline and bearing in a range.

    lower, upper : ends of the range of the flexspline's radial deformation [m]
    """
    return min(K_TS(drive_parameters, torque, w) for w in np.linspace(lower, upper, 41).tolist())


def relative_K_TS_change(
    drive_parameters: HarmonicDriveParameters, torque: float, eccentricity: float
) -> float:
    """Relative change [%] of the torsional stiffness K_TS of flexspline and bearing by eccentricity [m]."""
    return 100.0 * (
        K_TS(drive_parameters, torque, eccentricity=eccentricity) / K_TS(drive_parameters, torque) - 1.0
    )


def K_WTS(drive_parameters: HarmonicDriveParameters, torque: float) -> float:
    """Torsional stiffness K_WTS [N.m/rad] of the whole drive at a torque [N.m]."""
    return float(drive_stiffness(drive_parameters, torque)[0])


def drive_peak_pressure(drive_parameters: HarmonicDriveParameters, torque: float) -> float:
    """Peak contact pressure [Pa] of flexspline and bearing at a torque [N.m]."""
    return float(peak_pressure(drive_parameters, torque)[0])


def kogut_etsion_constant(drive_parameters: HarmonicDriveParameters, product: str, stage: int) -> float:
    """Constant [1] of an elastic-plastic stage of Kogut and Etsion, written as a function of the spot area.

    product : "load" or "stiffness": factor of the power law; "area": area at the end of the stage over area
              at the onset of yield
    stage   : 1 or 2
    """
    if product == "area":
        return float(
            (kogut_etsion.SECOND_STAGE_OVER_YIELD_AREA, kogut_etsion.FULL_PLASTIC_OVER_YIELD_AREA)[stage - 1]
        )
    powers = kogut_etsion.eliminate_deformation(
        (kogut_etsion.FIRST_ELASTIC_PLASTIC_STAGE, kogut_etsion.SECOND_ELASTIC_PLASTIC_STAGE)[stage - 1]
    )
    return powers.load_factor if product == "load" else powers.stiffness_factor


def plastic_onset_pressure(drive_parameters: HarmonicDriveParameters, nu: float) -> float:
    """Mean pressure over hardness [1] of a spot at the onset of full plasticity, by Kogut and Etsion.

    nu : Poisson's ratio [1]
    """
    stage, w = kogut_etsion.SECOND_ELASTIC_PLASTIC_STAGE, kogut_etsion.FULL_PLASTIC_OVER_YIELD_DEFORMATION
    load_per_area = stage.load_factor * w**stage.load_exponent / (stage.area_factor * w**stage.area_exponent)
    return float(2.0 / 3.0 * hardness_coefficient(nu) * load_per_area)


def shear_over_friction(drive_parameters: HarmonicDriveParameters, stage: str) -> float:
    """Shear force of a contact spot over its friction limit [1], at the end of a stage of its deformation.

    The shear stress on the spot is the yield stress over sqrt(3).

    stage : "elastic", or the "first" or "second" elastic-plastic stage
    """
    law = drive_parameters.law
    first, second = (
        kogut_etsion.eliminate_deformation(s)
        for s in (kogut_etsion.FIRST_ELASTIC_PLASTIC_STAGE, kogut_etsion.SECOND_ELASTIC_PLASTIC_STAGE)
    )
    load, area = {
        "elastic": (1.0, 1.0),
        "first": (
            first.load_factor * kogut_etsion.SECOND_STAGE_OVER_YIELD_AREA**first.load_exponent,
            kogut_etsion.SECOND_STAGE_OVER_YIELD_AREA,
        ),
        "second": (
            second.load_factor * kogut_etsion.FULL_PLASTIC_OVER_YIELD_AREA**second.load_exponent,
            kogut_etsion.FULL_PLASTIC_OVER_YIELD_AREA,
        ),
    }[stage]
    pressure = 2.0 / 3.0 * hardness_coefficient(law.side1.nu) * law.hardness * load / area
    return float(law.sigma_y / np.sqrt(3.0) / (law.mu * pressure))


def smallest_mean_pressure(drive_parameters: HarmonicDriveParameters) -> float:
    """Load over real contact area [Pa], if the largest spot has the area at the limit of elastic deformation.

    Then all spots are elastic. A larger largest spot gives a larger load over real area.
    """
    state = evaluate_at_largest_spot(drive_parameters.law, hu.critical_area(drive_parameters.law))
    return float(state["F"] / state["A_r"])


PUBLISHED_NUMBERS = PublishedNumbers(
    paper_names=("hu2023",),
    observable_functions={
        "K_TS": K_TS,
        "K_TS_least": smallest_K_TS,
        "K_TS_change": relative_K_TS_change,
        "K_WTS": K_WTS,
        "peak_pressure": drive_peak_pressure,
        "kogut_etsion": kogut_etsion_constant,
        "plastic_onset_pressure": plastic_onset_pressure,
        "shear_over_friction": shear_over_friction,
        "least_mean_pressure": smallest_mean_pressure,
    },
    calibration_fits=(
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
"""{quantity of a reference file: function that computes it}, and the fit that calibrates parameters."""
