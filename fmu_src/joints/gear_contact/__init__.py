"""What the builders know of the gear contact."""

from pathlib import Path

from ...joint_parts import Parts, native_of
from ...joint_parts.page import RampPanel
from ...joint_parts.terminals import TRANSLATIONAL, Terminal

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
    native=native_of(__name__),
    panels=PANELS,
    terminals=TERMINALS,
)
