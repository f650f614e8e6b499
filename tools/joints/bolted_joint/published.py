"""Published values of Zhao 2018: how to compute each quantity, and which values calibrate parameters."""

from dataclasses import replace

import numpy as np

from jointfmu.contact.laws import mindlin
from jointfmu.contact.laws import zhao2018 as zhao
from jointfmu.contact.surface import domain_extension
from jointfmu.joints.bolted_joint.law import (
    BoltedJointParameters,
    get_bolted_frame,
    preload_pressure,
    row_forces,
)
from jointfmu.mechanics.footprint.bolts import bolt_pressures, divide_frame_into_cells, pressure_distribution

from ...inputs.fractal import rms_height
from ...studies.published.computed import CalibrationFit, PublishedNumbers


def largest_pressure(joint_parameters: BoltedJointParameters, preload: float) -> float:
    """Largest nodal contact pressure [Pa] of the box specimen at a preload [N] per bolt."""
    return float(
        np.max(
            preload_pressure(joint_parameters, pressure_distribution(joint_parameters.pattern), preload, 0.0)
        )
    )


def pressure_between_bolts(joint_parameters: BoltedJointParameters, preload: float) -> float:
    """Pressure [Pa] midway between a corner bolt and the next bolt of the other row.

    preload : [N] per bolt
    """
    pattern = get_bolted_frame(joint_parameters)
    areas, nodes = divide_frame_into_cells(pattern)
    middle = pattern.bolt_positions_from_middle[[0, 3]].mean(axis=0)[None, :]
    unit = float(bolt_pressures(pattern, areas, nodes, middle).sum())
    return unit * preload * joint_parameters.n_bolts / 8.0 * float(areas.sum()) / joint_parameters.A_0


def bolt_row_force(joint_parameters: BoltedJointParameters, preload: float, moment: float, row: int) -> float:
    """Force [N] of a bolt in row 1 or 2 of the joint, at a preload [N] per bolt and a moment [N.m]."""
    return row_forces(joint_parameters, preload, moment)[row - 1]


def critical_area(joint_parameters: BoltedJointParameters, choice: str) -> float:
    """Area [m2] of a contact spot below which it is plastic, by the equation that `choice` selects."""
    return float(zhao.critical_area(replace(joint_parameters, critical_area=choice)))


def spot_stiffness_ratio(joint_parameters: BoltedJointParameters) -> float:
    """Ratio [1] of the normal stiffnesses of a contact spot by the equations `family` and `hertz`."""
    family, hertz = (
        zhao.normal_stiffness(replace(joint_parameters, spot_stiffness=kind), 1e-6)
        for kind in ("family", "hertz")
    )
    return float(family / hertz)


def surface_rms_height(joint_parameters: BoltedJointParameters, longest_wave: float) -> float:
    """Rms height [m] of the joint's fractal surface with wavelengths up to `longest_wave` [m]."""
    return float(rms_height(joint_parameters.surface.D, joint_parameters.surface.G, longest_wave))


def evaluate_mindlin(joint_parameters: BoltedJointParameters, function: str, x: float) -> float:
    """One of Mindlin's functions [1] of a contact spot in partial slip; x: shear force over friction limit.

    function : "loop" (H1, dissipated energy), "storage" (H2, stored energy) or "loss_ratio" (dissipated
               energy of a cycle over 2 pi times the stored energy)
    """
    table = {
        "loop": mindlin.dissipated_energy_function,
        "storage": mindlin.stored_energy_function,
        "loss_ratio": mindlin.loss_ratio,
    }
    return float(table[function](x))


def domain_extension_factor(joint_parameters: BoltedJointParameters, D: float) -> float:
    """Domain extension factor psi [1] for a fractal dimension D of the profile."""
    return float(domain_extension(D))


def frequency_error(joint_parameters: BoltedJointParameters, predicted: float, measured: float) -> float:
    """Error [%] of a predicted frequency relative to the measured one [Hz]."""
    return 100.0 * (predicted / measured - 1.0)


PUBLISHED_NUMBERS = PublishedNumbers(
    paper_names=("zhao2018",),
    observable_functions={
        "p_max": largest_pressure,
        "p_between": pressure_between_bolts,
        "row_force": bolt_row_force,
        "critical_area": critical_area,
        "spot_stiffness_ratio": spot_stiffness_ratio,
        "rms_height": surface_rms_height,
        "mindlin": evaluate_mindlin,
        "psi": domain_extension_factor,
        "frequency_error": frequency_error,
    },
    calibration_fits=(
        CalibrationFit(
            {"pattern.decay_length": 0.01, "pattern.decay_exponent": 1.0},
            ("p_max.9kN", "p_between.9kN"),
        ),
    ),
)
"""{quantity of a reference file: function that computes it}, and fits that calibrate parameters."""
