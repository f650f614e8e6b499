"""Builder data of the gear contact."""

from pathlib import Path

from ...joint_parts import FmuBuildData, RampPanel, make_native_definition_loader
from ...joint_parts.terminals import TRANSLATIONAL_FLANGE_CLASS, Terminal

_FLANGE_DESCRIPTION = "one flank pressed on the other, along the normal"
"""Description of the flange of the gear contact."""
_FLANGE_MEMBER_VARIABLES = {"s": ("s_rel", "signal"), "f": ("f", "inflow")}
"""{Modelica variable of the flange: (variable of the FMU, variableKind of FMI)}."""

FMU_BUILD_DATA = FmuBuildData(
    joint_folder=Path(__file__).parent,
    load_native_definition=make_native_definition_loader(__name__),
    load_ramp_panels={"GearContact": (RampPanel("f", ("s_rel",)), RampPanel("f", ("K_N",)))},
    terminals={
        "GearContact": (
            Terminal(
                "flange", TRANSLATIONAL_FLANGE_CLASS, "a", _FLANGE_DESCRIPTION, _FLANGE_MEMBER_VARIABLES
            ),
        )
    },
)
"""Builder data of the gear contact."""
