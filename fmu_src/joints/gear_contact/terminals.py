"""Flange of the gear contact."""

from ...joint_parts.terminals import TRANSLATIONAL, Terminal

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
