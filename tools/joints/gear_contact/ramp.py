"""Load ramp of the gear contact: check and figure of the main job."""

from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.gear_contact.spring import GearContactParameters
from jointfmu.parameters import load_default
from jointfmu.quantity import Array

from ...pages.report.figure import Figure, Panel, Series
from ...run.ramps.ramp import RampResult
from ...studies.checks import integrate_logarithmically, relative_deviation


def _check_approach(fmu_folder: Path, ramp_result: RampResult) -> tuple[str, float]:
    """Compare the approach along the load ramp of the FMU with the integral of the law's compliance."""
    law = load_default("gear_contact").values
    assert isinstance(law, GearContactParameters)

    def compliance(normal_force: Array) -> Array:
        """Compliance 1/K_N [m/N] at normal forces [N]."""
        return 1.0 / (law.A_0 * stiffness_curve(law, normal_force / law.A_0)[0])

    c, at = ramp_result.variable_columns, [1, 10, 100, 300]
    miss = relative_deviation(np.diff(c["s_rel"][at]), integrate_logarithmically(compliance, c["f"][at]))
    return "s_rel against the integral of df/K of the law (scipy, Simpson)", miss


RAMP_CHECKS = {"GearContact": _check_approach}
"""{FMU: check of its load ramp}.

A check is a function: (folder, ramp of the FMU) -> (name of the compared
quantity, largest relative deviation [1])."""


def make_figures(pipeline_result: Any) -> list[Figure]:
    """Make the figure of the gear contact, from the results of building all FMUs (`PipelineResult`)."""
    c = pipeline_result.load_ramps["GearContact"].variable_columns
    load = c["f"] / 1e3
    panels = [
        Panel("Stiffness over load", "load [kN]", "K_N [N/um]", [Series("K_N", load, c["K_N"] / 1e6)]),
        Panel("Approach over load", "load [kN]", "s_rel [um]", [Series("s_rel", load, c["s_rel"] * 1e6)]),
    ]
    text = "Up to a real contact area of about a tenth of the nominal area."
    return [Figure("Stiffness and approach over load", text, panels, data_file="GearContact.csv")]
