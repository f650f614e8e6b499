"""The harmonic drive in the laboratory: its published points, and where its parameters are sought."""

import math

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.drive import HARMONICS

from ...laboratory.part import Example, LaboratoryModel, Shown, Turn
from .efficiency import parameters, printed_drives

_SPANS = {
    "hysteresis_loss": (0.0, 1e-3),
    "hysteresis_stiffness": (0.0, 2e4),
    "lost_motion": (0.0, 1e-3),
    "friction_coulomb": (0.0, 0.1),
    "friction_stribeck": (0.0, 0.1),
    "friction_viscous": (0.0, 1e-3),
    "load_loss": (0.0, 0.5),
    "load_loss_back": (-1.0, 0.5),
    "temperature_factor": (0.5, 5.0),
    "viscous_temperature_coefficient": (0.0, 0.1),
    "dry_temperature_coefficient": (0.0, 0.1),
    "temperature": (253.15, 353.15),
    "phi1": (-0.1, 0.1),
    **{f"error_{n}": (0.0, 1e-3) for n in HARMONICS},
    **{f"error_{n}_phase": (-math.pi, math.pi) for n in HARMONICS},
}
_ARGUMENTS = {"torque": "tau", "deformation": "radial_deformation", "eccentricity": "eccentricity"}

_TURN = Turn(
    driven="phi1",
    speed="w1",
    follower="phi2",
    follower_speed="w2",
    torque="tau1",
    load="tau",
    error="phi_error",
    ratio="ratio",
    rated="rated_torque",
    usual=200.0,
)
_LOOP = MODELS["HarmonicDriveSpring"].loop
_PRINTED = printed_drives()[0]
_EXAMPLE = Example(
    f"friction of the catalogue's {_PRINTED.name}, 1 arcmin of hysteresis and of kinematic error",
    {k: v for k, v in parameters(_PRINTED).items() if k != "ratio"}
    | {k: float(v) for k, v in (_LOOP.settings if _LOOP else {}).items()}
    | {"error_2": 1.5e-4},
)

LABORATORY = {
    "HarmonicDriveSpring": LaboratoryModel(spans=_SPANS, path=("phi2",), turn=_TURN, example=_EXAMPLE),
    "HarmonicDriveCompliance": LaboratoryModel(
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
