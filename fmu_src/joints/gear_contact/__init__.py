"""What the builders know of the gear contact."""

from pathlib import Path
from typing import TYPE_CHECKING

from ...joint_parts import Parts
from ...joint_parts.page import RampPanel
from ...joint_parts.terminals import TRANSLATIONAL, Terminal

if TYPE_CHECKING:
    from ...joint_parts.native import NativePart


def _native() -> "NativePart":
    from .native import PART

    return PART


PANELS = {"GearContact": (RampPanel("f", ("s_rel",)), RampPanel("f", ("K_N",)))}
"""What the page's plot of the load ramp shows."""

TERMINALS = {
    "GearContact": (
        Terminal(
            "flange",
            TRANSLATIONAL,
            "a",
            "one flank pressed on the other, along the normal",
            {"s": ("s_rel", "signal"), "f": ("f", "inflow")},
        ),
    )
}

PARTS = Parts(
    folder=Path(__file__).parent,
    native=_native,
    panels=PANELS,
    terminals=TERMINALS,
)
