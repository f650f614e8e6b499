"""Load ramp of the gear contact: check and figure of the main job, evaluation of many samples at once."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.gear_contact import KIND
from jointfmu.joints.gear_contact.spring import ContactParameters, GearContact, GearContactSpring
from jointfmu.parameters import load_default
from jointfmu.quantity import Array

from ...pages.report.figure import Figure, Panel, Series
from ...run.ramps.ramp import RampResult
from ...studies.batch.approach import columns, held, tabulate
from ...studies.checks import integrate_logarithmically, relative_deviation
from ...studies.uncertainty.problem import ReducedCurves


def _check_approach(folder: Path, result: RampResult) -> tuple[str, float]:
    law = load_default("gear_contact").values
    assert isinstance(law, GearContact)

    def compliance(f: Array) -> Array:
        return 1.0 / (law.A_0 * stiffness_curve(law, f / law.A_0)[0])

    c, at = result.columns, [1, 10, 100, 300]
    miss = relative_deviation(np.diff(c["s_rel"][at]), integrate_logarithmically(compliance, c["f"][at]))
    return "s_rel against the integral of df/K of the law (scipy, Simpson)", miss


RAMPS = {"GearContact": _check_approach}
"""{FMU: check}, a check being (folder, ramp of the FMU) -> (text, largest relative deviation [1])."""


def figures(job_result: Any) -> list[Figure]:
    """Figure of the gear contact, from the results of the main job (`JobResult`)."""
    c = job_result.ramps["GearContact"].columns
    load = c["f"] / 1e3
    panels = [
        Panel("Stiffness over load", "load [kN]", "K_N [N/um]", [Series("K_N", load, c["K_N"] / 1e6)]),
        Panel("Approach over load", "load [kN]", "s_rel [um]", [Series("s_rel", load, c["s_rel"] * 1e6)]),
    ]
    text = "Up to a real contact area of about a tenth of the nominal area."
    return [Figure("Stiffness and approach over load", text, panels, data_file="GearContact.csv")]


def evaluate(
    parameters: type[ContactParameters], values: Mapping[str, object], loads: Array, factor: Array
) -> dict[str, Array]:
    """Stiffness K_N (n, m) [N/m] and approach s_rel (n, m) [m] at the forces factor times loads.

    parameters : class of the parameter set
    values     : {structured name: number, or samples (n)}
    loads      : (m) [N], ascending
    factor     : (n, 1) [1], one for each sample
    """
    contact = columns(parameters, values, 1)
    scale = factor / contact.A_0
    touching = loads > 0.0
    rows, _ = tabulate(contact, scale * np.min(loads[touching]), scale * loads[-1])
    logs = held(rows, np.log(loads[touching]), np.log(scale), np.log(contact.hardness))
    K, s = np.zeros((2, factor.size, loads.size))
    K[:, touching], s[:, touching] = contact.A_0 * np.exp(logs["k"]), np.exp(logs["s"])
    return {"K_N": K, "s_rel": s}


def evaluate_exported(joint: ContactParameters, loads: Array) -> dict[str, Array]:
    """K_N (m) [N/m] and s_rel (m) [m] of the exported joint at forces (m) [N]; both are 0 at zero force."""
    state = GearContactSpring.tabulate(joint).evaluate(loads)
    return {name: np.where(loads > 0.0, state[name], 0.0) for name in REDUCED.units}


REDUCED = ReducedCurves(
    load=KIND.variables["f"],
    outputs=tuple(KIND.variables[name] for name in ("K_N", "s_rel")),
    default_end=lambda contact: 3e3,
    max_load=lambda contact: contact.hardness * contact.A_0,
    evaluate=evaluate,
    exact=evaluate_exported,
)
