"""Uncertainty of the toy joint: force of the spring over its elongation."""

import numpy as np
from jointfmu_tools.studies.uncertainty.curves import LoadCurves

from .. import KIND

UNCERTAINTY_CURVES = LoadCurves(
    fmu_name="ToySpring",
    ramped_input=KIND.variables["s_rel"],
    outputs=(KIND.variables["f"],),
    default_ramp_end=lambda spring: 1e-3,
    max_load=lambda spring: np.inf,
)
