"""The spring for many samples at once: force over elongation."""

import numpy as np
from jointfmu_tools.studies.uncertainty.problem import ReducedCurves

from .. import KIND

REDUCED = ReducedCurves(
    load=KIND.variables["s_rel"],
    outputs=(KIND.variables["f"],),
    default_end=lambda spring: 1e-3,
    max_load=lambda spring: np.inf,
    evaluate=lambda _, values, loads, factor: {"f": -np.reshape(values["c"], (-1, 1)) * factor * loads},
    exact=lambda spring, loads: {"f": -spring.c * loads},
)
