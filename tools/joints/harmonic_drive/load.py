"""Harmonic drive under load: export, pressure on the contact pair."""

from typing import TYPE_CHECKING

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.harmonic_drive import KIND
from jointfmu.joints.harmonic_drive.drive import DriveParameters
from jointfmu.joints.harmonic_drive.law import (
    HarmonicDriveParameters,
    RoughHarmonicDriveParameters,
    contact_pair_stiffness,
    peak_pressure,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

from ...common.pressure import NominalPressureModel
from ...exchange.export.exports import JointExports, LoadCurveExport

if TYPE_CHECKING:
    from ...exchange.export.tables import LoadTable


def _torque_table(
    drive_parameters: DriveParameters, _working_point: None, max_table_error: float
) -> "LoadTable":
    """Table of the torque [N.m] as a function of the wind-up [rad], for other solvers."""
    from ...exchange.export.tables import tabulate_odd_curve

    return tabulate_odd_curve(HarmonicDriveSpring.tabulate(drive_parameters).curve, max_table_error)


EXPORTS = JointExports(
    curve=LoadCurveExport(
        curve_meaning="torque over wind-up at the output, wave generator locked",
        curve_variables=tuple(KIND.variables[name] for name in ("phi_rel", "tau", "K_WTS")),
        table_name="torque",
        compute_table=_torque_table,
    ),
    missing_reasons={
        "contact": "its stiffness is a sum over the nodes of a mesh, not over an area; export its curve"
    },
)
"""Exports that the harmonic drive offers."""


_ContactPairDrive = HarmonicDriveParameters | RoughHarmonicDriveParameters
"""Drive whose stiffness follows from the contact pair of flexspline and bearing."""


def _peak_pressure(drive_parameters: _ContactPairDrive, torque: float) -> float:
    """Largest pressure [Pa] of the contact pair at a torque [N.m]."""
    return float(peak_pressure(drive_parameters, torque)[0])


def _mean_pressure(drive_parameters: _ContactPairDrive, torque: float) -> float:
    """Mean pressure [Pa] of the contact pair at a torque [N.m]."""
    return drive_parameters.mean_over_peak * _peak_pressure(drive_parameters, torque)


def _joint_to_law_stiffness_ratio(drive_parameters: _ContactPairDrive, torque: float) -> float:
    """Torsional stiffness of the contact pair over tangential stiffness of its law times radius^2 [1]."""
    tangential = evaluate_at_pressure(drive_parameters.law, _mean_pressure(drive_parameters, torque))["K_T"]
    return float(
        contact_pair_stiffness(drive_parameters, torque)[0] / (tangential * drive_parameters.radius**2)
    )


NOMINAL_PRESSURE = NominalPressureModel(
    load_variable="tau",
    default_load=lambda drive: drive.rated_torque,
    mean_pressure=_mean_pressure,
    peak_pressure=_peak_pressure,
    joint_to_law_stiffness_ratio=_joint_to_law_stiffness_ratio,
)
"""Nominal pressure of the contact pair over the torque."""
