"""The harmonic drive in the laboratory: its published points, and where its hysteresis is to be sought."""

from ...laboratory.part import Bench, Shown

_SPANS = {"hysteresis_loss": (0.0, 1e-3), "hysteresis_stiffness": (0.0, 2e4)}
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
