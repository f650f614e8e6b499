"""Builder data of the gear contact."""

from pathlib import Path

from ...joint_parts import FmuParts, RampPanel, make_native_definition_loader
from ...joint_parts.terminals import TRANSLATIONAL_FLANGE_CLASS, Terminal

_FLANGE_DOC = "one flank pressed on the other, along the normal"
"""Description of the flange of the gear contact."""
_FLANGE_MEMBERS = {"s": ("s_rel", "signal"), "f": ("f", "inflow")}
"""{Modelica variable of the flange: (variable of the FMU, variableKind of FMI)}."""

FMU_PARTS = FmuParts(
    folder=Path(__file__).parent,
    native=make_native_definition_loader(__name__),
    ramp_panels={"GearContact": (RampPanel("f", ("s_rel",)), RampPanel("f", ("K_N",)))},
    terminals={
        "GearContact": (Terminal("flange", TRANSLATIONAL_FLANGE_CLASS, "a", _FLANGE_DOC, _FLANGE_MEMBERS),)
    },
)
"""Builder data of the gear contact."""
