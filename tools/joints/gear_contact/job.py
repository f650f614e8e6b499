"""The ramp of the gear contact in the main job: what must hold of it, and the figure of the report."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import quad

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.gear_contact.spring import GearContact
from jointfmu.parameters import default

from ...job.checks import deviation
from ...ramps.ramp import RampResult
from ...report.figure import Figure, Panel, Series


def _approach(folder: Path, result: RampResult) -> tuple[str, float]:
    law = default("gear_contact").values
    assert isinstance(law, GearContact)

    def compliance(f: float) -> float:
        return float(1.0 / (law.A_0 * stiffness_curve(law, f / law.A_0)[0]))

    c, at = result.columns, [1, 10, 100, 300]
    approach = [
        quad(compliance, c["f"][i], c["f"][j], epsabs=0.0, epsrel=1e-9, limit=400)[0] for i, j in pairwise(at)
    ]
    return "s_rel against the integral of df/K of the law (scipy, quad)", deviation(
        np.diff(c["s_rel"][at]), approach
    )


RAMPS = {"GearContact": _approach}
"""{FMU: (folder, its ramp) -> (what is compared, largest relative deviation)}."""


def figures(outcome: Any) -> list[Figure]:
    """The figure of an outcome of the main job."""
    c = outcome.ramps["GearContact"].columns
    load = c["f"] / 1e3
    panels = [
        Panel("Stiffness over load", "load [kN]", "K_N [N/um]", [Series("K_N", load, c["K_N"] / 1e6)]),
        Panel("Approach over load", "load [kN]", "s_rel [um]", [Series("s_rel", load, c["s_rel"] * 1e6)]),
    ]
    text = "Up to about a tenth of the nominal area in real contact."
    return [Figure("Stiffness and approach over load", text, panels, data="GearContact.csv")]
