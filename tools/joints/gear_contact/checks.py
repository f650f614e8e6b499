"""What must hold of the contact's ramp."""

from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.integrate import quad

from jointfmu.contact.interface import stiffness_curve
from jointfmu.fmi.ramp import RampResult
from jointfmu.joints.gear_contact.spring import GearContact
from jointfmu.parameters import default

from ...job.checks import deviation


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
