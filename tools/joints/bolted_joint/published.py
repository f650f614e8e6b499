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
from jointfmu.mechanics.footprint.bolts import bolt_pressures, frame_cells, pressure_distribution

from ...inputs.fractal import rms_height
from ...studies.published.computed import CalibrationFit, PublishedNumbers


def largest_pressure(joint: BoltedJointParameters, preload: float) -> float:
    """Largest nodal contact pressure [Pa] of the box specimen at a preload [N] per bolt."""
    return float(np.max(preload_pressure(joint, pressure_distribution(joint.pattern), preload, 0.0)))


def pressure_between_bolts(joint: BoltedJointParameters, preload: float) -> float:
    """Pressure [Pa] midway between a corner bolt and the next bolt of the other row.

    preload : [N] per bolt
    """
    pattern = get_bolted_frame(joint)
    areas, nodes = frame_cells(pattern)
    middle = pattern.bolts_from_middle[[0, 3]].mean(axis=0)[None, :]
    unit = float(bolt_pressures(pattern, areas, nodes, middle).sum())
    return unit * preload * joint.n_bolts / 8.0 * float(areas.sum()) / joint.A_0


def row_force(joint: BoltedJointParameters, preload: float, moment: float, row: int) -> float:
    """Force [N] of a bolt in row 1 or 2, at a preload [N] per bolt and a moment [N.m]."""
    return row_forces(joint, preload, moment)[row - 1]


def critical_area(joint: BoltedJointParameters, choice: str) -> float:
    """Critical area a'_c [m2] of a contact spot, by the equation that `choice` selects."""
    return float(zhao.critical_area(replace(joint, critical_area=choice)))


def spot_stiffness_ratio(joint: BoltedJointParameters) -> float:
    """Stiffness of a contact spot by the choice `family` over its stiffness by the choice `hertz` [1]."""
    family, hertz = (
        zhao.normal_stiffness(replace(joint, spot_stiffness=kind), 1e-6) for kind in ("family", "hertz")
    )
    return float(family / hertz)


def surface_rms_height(joint: BoltedJointParameters, longest_wave: float) -> float:
    """Rms height h [m] of the fractal surface (D, G) with wavelengths up to `longest_wave` [m]."""
    return float(rms_height(joint.surface.D, joint.surface.G, longest_wave))


def evaluate_mindlin(joint: BoltedJointParameters, function: str, x: float) -> float:
    """One of Mindlin's functions of a contact spot in partial slip [1], at a traction ratio x [1].

    function : "loop" (H1, dissipation), "storage" (H2, stored energy) or "loss_ratio" (W_d/W)
    """
    table = {
        "loop": mindlin.dissipation_function,
        "storage": mindlin.storage_function,
        "loss_ratio": mindlin.loss_ratio,
    }
    return float(table[function](x))


def domain_extension_factor(joint: BoltedJointParameters, D: float) -> float:
    """Domain extension factor psi [1] for a fractal dimension D of the profile."""
    return float(domain_extension(D))


def frequency_error(joint: BoltedJointParameters, predicted: float, measured: float) -> float:
    """Error [%] of a predicted frequency relative to the measured one [Hz]."""
    return 100.0 * (predicted / measured - 1.0)


PUBLISHED_NUMBERS = PublishedNumbers(
    papers=("zhao2018",),
    observable_functions={
        "p_max": largest_pressure,
        "p_between": pressure_between_bolts,
        "row_force": row_force,
        "critical_area": critical_area,
        "spot_stiffness_ratio": spot_stiffness_ratio,
        "rms_height": surface_rms_height,
        "mindlin": evaluate_mindlin,
        "psi": domain_extension_factor,
        "frequency_error": frequency_error,
    },
    calibration=(
        CalibrationFit(
            {"pattern.decay_length": 0.01, "pattern.decay_exponent": 1.0},
            ("p_max.9kN", "p_between.9kN"),
        ),
    ),
)
"""{quantity of a reference file: function that computes it}, and fits that calibrate parameters."""
