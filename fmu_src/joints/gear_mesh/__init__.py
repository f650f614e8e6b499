"""What the builders know of the gear mesh."""

from pathlib import Path

from ...joint_parts import Parts, native_of
from ...joint_parts.page import RampPanel
from ...joint_parts.terminals import shaft

PANELS = {"GearMesh": (RampPanel("phi1", ("f",)), RampPanel("s_rel", ("K",)))}
"""What the page's plot of the load ramp shows."""

TERMINALS = {"GearMesh": (shaft(1, "a", "wheel 1"), shaft(2, "b", "wheel 2"))}

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    panels=PANELS,
    terminals=TERMINALS,
)
