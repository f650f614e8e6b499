"""The harmonic drive in the laboratory: its published points, and where its parameters are sought."""

import math

from jointfmu.joints.harmonic_drive.kinematic_error import HARMONICS

from ...laboratory.part import Bench, Shown

_SPANS = {
    "hysteresis_loss": (0.0, 1e-3),
    "hysteresis_stiffness": (0.0, 2e4),
    "lost_motion": (0.0, 1e-3),
    "friction_coulomb": (0.0, 0.1),
    "friction_stribeck": (0.0, 0.1),
    "friction_viscous": (0.0, 1e-3),
    "load_loss": (0.0, 0.5),
    **{f"error_{n}": (0.0, 1e-3) for n in HARMONICS},
    **{f"error_{n}_phase": (-math.pi, math.pi) for n in HARMONICS},
}
_ARGUMENTS = {
    "torque": "tau",
    "deformation": "radial_deformation",
    "eccentricity": "eccentricity",
}

LABORATORY = {
    "HarmonicDriveSpring": Bench(spans=_SPANS, path=("phi2",)),
    "HarmonicDriveCompliance": Bench(
        spans=_SPANS,
        path=("tau",),
        points={
            "K_TS": Shown("K_TS_pair", _ARGUMENTS),
            "K_WTS": Shown("K_WTS", _ARGUMENTS),
            "peak_pressure": Shown("p_max", _ARGUMENTS),
        },
    ),
}
"""{FMU: what the page shows beside its variables}."""
