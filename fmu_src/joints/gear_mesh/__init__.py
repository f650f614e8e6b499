"""Builder data of the gear mesh."""

from pathlib import Path

from ...joint_parts import Parts, RampPanel, native_of
from ...joint_parts.terminals import shaft

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    panels={"GearMesh": (RampPanel("phi1", ("f",)), RampPanel("s_rel", ("K",)))},
    terminals={"GearMesh": (shaft(1, "a", "wheel 1"), shaft(2, "b", "wheel 2"))},
)
