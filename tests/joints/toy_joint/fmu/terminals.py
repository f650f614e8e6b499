"""Its flange."""

from jointfmu_fmu_src.native.terminals import TRANSLATIONAL, Terminal

MEMBERS = {"s": ("s_rel", "signal"), "f": ("f", "outflow")}
TERMINALS = {"ToySpring": (Terminal("flange", TRANSLATIONAL, "b", "side 2, side 1 fixed", MEMBERS),)}
