"""Builder data of the toy joint: an equation with one flange."""

from pathlib import Path

from jointfmu_fmu_src.joint_parts import FmuParts, load_equations_definition
from jointfmu_fmu_src.joint_parts.terminals import TRANSLATIONAL_FLANGE_CLASS, Terminal

WIRES = {"s": ("s_rel", "signal"), "f": ("f", "outflow")}
FLANGES = (Terminal("flange", TRANSLATIONAL_FLANGE_CLASS, "b", "side 2, side 1 fixed", WIRES),)
FMU_PARTS = FmuParts(
    folder=Path(__file__).parent, native=load_equations_definition, terminals={"ToySpring": FLANGES}
)
