"""Builder data of the partners: FMUs of inertia, mass and loads that a system needs besides its joints."""

from pathlib import Path

from ..joint_parts import Parts, equations
from ..joint_parts.terminals import ROTATIONAL, TRANSLATIONAL, Terminal
from .models import PARTNERS, parameters


def _body(motion: str, rate: str, flow: str, kind: str, body: str) -> tuple[Terminal, ...]:
    """Two flanges of an inertia or mass; each has its own load input."""
    members = {motion: (motion, "signal"), rate: (rate, "signal")}
    loads = {side: f"{flow}_{side}" for side in ("a", "b")}
    return tuple(
        Terminal(f"flange_{side}", kind, side, f"{body}, load {load}", members | {flow: (load, "inflow")})
        for side, load in loads.items()
    )


PARTS = Parts(
    folder=Path(__file__).parent,
    native=equations,
    terminals={  # a load over time has no motion and so no flange
        "RotationalInertia": _body("phi", "w", "tau", ROTATIONAL, "the inertia"),
        "TranslationalMass": _body("s", "v", "f", TRANSLATIONAL, "the mass"),
    },
)

__all__ = ["PARTNERS", "PARTS", "parameters"]
