"""Builder data of the partners: FMUs that a system needs besides its joints.

A partner is an inertia, a mass, a load or a prescribed motion that is connected to a joint.
"""

from pathlib import Path

from ..joint_parts import FmuBuildData, load_explicit_equations_definition
from ..joint_parts.terminals import ROTATIONAL_FLANGE_CLASS, TRANSLATIONAL_FLANGE_CLASS, Terminal
from .models import PARTNERS, load_partner_parameters


def _make_body_flanges(
    position_name: str, speed_name: str, load_name: str, connector_class: str, body_name: str
) -> tuple[Terminal, ...]:
    """Make the two flanges of an inertia or mass; each flange has its own load input."""
    members = {position_name: (position_name, "signal"), speed_name: (speed_name, "signal")}
    loads = {side: f"{load_name}_{side}" for side in ("a", "b")}
    return tuple(
        Terminal(
            f"flange_{side}",
            connector_class,
            side,
            f"{body_name}, load {load}",
            members | {load_name: (load, "inflow")},
        )
        for side, load in loads.items()
    )


FMU_BUILD_DATA = FmuBuildData(
    joint_folder=Path(__file__).parent,
    load_native_definition=load_explicit_equations_definition,
    terminals={  # a load over time has no motion and so no flange
        "RotationalInertia": _make_body_flanges("phi", "w", "tau", ROTATIONAL_FLANGE_CLASS, "the inertia"),
        "TranslationalMass": _make_body_flanges("s", "v", "f", TRANSLATIONAL_FLANGE_CLASS, "the mass"),
    },
)
"""Builder data of the partners."""

__all__ = ["FMU_BUILD_DATA", "PARTNERS", "load_partner_parameters"]
