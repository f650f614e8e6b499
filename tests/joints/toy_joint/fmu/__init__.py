"""Builder data of the toy joint: an equation with one flange."""

from pathlib import Path

from jointfmu_fmu_src.joint_parts import FmuBuildData, load_explicit_equations_definition
from jointfmu_fmu_src.joint_parts.terminals import TRANSLATIONAL_FLANGE_CLASS, Terminal

WIRES = {"s": ("s_rel", "signal"), "f": ("f", "outflow")}
FLANGES = (Terminal("flange", TRANSLATIONAL_FLANGE_CLASS, "b", "side 2, side 1 fixed", WIRES),)
FMU_BUILD_DATA = FmuBuildData(
    joint_folder=Path(__file__).parent,
    load_native_definition=load_explicit_equations_definition,
    terminals={"ToySpring": FLANGES},
)
