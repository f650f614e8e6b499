"""The harmonic drive in the laboratory: its published points, and where its hysteresis is to be sought."""

from ...laboratory.part import Bench, Shown

_SPANS = {
    "hysteresis_loss": (0.0, 1e-3),
    "hysteresis_stiffness": (0.0, 2e4),
    "lost_motion": (0.0, 1e-3),
    "friction_coulomb": (0.0, 0.1),
    "friction_stribeck": (0.0, 0.1),
    "friction_viscous": (0.0, 1e-3),
    "error_1": (0.0, 1e-3),
    "error_2": (0.0, 1e-3),
    "error_4": (0.0, 1e-3),
    **dict.fromkeys(("error_1_phase", "error_2_phase", "error_4_phase"), (-3.2, 3.2)),
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
