"""Builder data of the gear contact."""

from pathlib import Path

from ...joint_parts import Parts, RampPanel, native_of
from ...joint_parts.terminals import TRANSLATIONAL, Terminal

_DOC = "one flank pressed on the other, along the normal"
_MEMBERS = {"s": ("s_rel", "signal"), "f": ("f", "inflow")}

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    panels={"GearContact": (RampPanel("f", ("s_rel",)), RampPanel("f", ("K_N",)))},
    terminals={"GearContact": (Terminal("flange", TRANSLATIONAL, "a", _DOC, _MEMBERS),)},
)
