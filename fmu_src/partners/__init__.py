"""The partners' FMUs: inertia, mass and loads that a system model needs beside a joint."""

from pathlib import Path

from ..joint_parts import Parts, equations
from ..joint_parts.terminals import ROTATIONAL, TRANSLATIONAL, Terminal
from .models import PARTNERS, parameters


def _body(motion: str, rate: str, flow: str, kind: str, body: str) -> tuple[Terminal, ...]:
    """Both flanges of a partner that moves; each takes a load of its own."""
    known = {motion: (motion, "signal"), rate: (rate, "signal")}
    loads = {side: f"{flow}_{side}" for side in ("a", "b")}
    return tuple(
        Terminal(f"flange_{side}", kind, side, f"{body}, load {load}", known | {flow: (load, "inflow")})
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
