"""Builder data of the gear mesh."""

from pathlib import Path

from ...joint_parts import FmuBuildData, RampPanel, make_native_definition_loader
from ...joint_parts.terminals import make_shaft_flange

FMU_BUILD_DATA = FmuBuildData(
    joint_folder=Path(__file__).parent,
    load_native_definition=make_native_definition_loader(__name__),
    load_ramp_panels={"GearMesh": (RampPanel("phi1", ("f",)), RampPanel("s_rel", ("K",)))},
    terminals={"GearMesh": (make_shaft_flange(1, "a", "wheel 1"), make_shaft_flange(2, "b", "wheel 2"))},
)
"""Builder data of the gear mesh."""
