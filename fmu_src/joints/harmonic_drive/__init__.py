"""What the builders know of the harmonic drive."""

from pathlib import Path

from ...joint_parts import Parts, RampPanel, native_of
from ...joint_parts.terminals import ROTATIONAL, Terminal, shaft
from .data import DATA

_STIFFNESS = RampPanel("tau", ("K_WTS", "K_TS"))
_LOCKED = {"phi": ("phi_rel", "signal"), "tau": ("tau", "inflow")}

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    data=DATA,
    panels={
        "HarmonicDriveSpring": (RampPanel("phi_rel", ("tau",)), _STIFFNESS),
        "HarmonicDriveCompliance": (RampPanel("tau", ("phi_rel",)), _STIFFNESS),
    },
    terminals={
        "HarmonicDriveSpring": (shaft(1, "a", "wave generator (motor)"), shaft(2, "b", "output")),
        "HarmonicDriveCompliance": (
            Terminal("flange", ROTATIONAL, "b", "output, wave generator locked", _LOCKED),
        ),
    },
)
