"""What the builders know of the gear mesh."""

from pathlib import Path
from typing import TYPE_CHECKING

from ...joint_parts import Parts
from ...joint_parts.page import RampPanel
from ...joint_parts.terminals import shaft

if TYPE_CHECKING:
    from ...joint_parts.native import NativePart


def _native() -> "NativePart":
    from .native import PART

    return PART


PANELS = {"GearMesh": (RampPanel("phi1", ("f",)), RampPanel("s_rel", ("K",)))}
"""What the page's plot of the load ramp shows."""

TERMINALS = {"GearMesh": (shaft(1, "a", "wheel 1"), shaft(2, "b", "wheel 2"))}

PARTS = Parts(
    folder=Path(__file__).parent,
    native=_native,
    panels=PANELS,
    terminals=TERMINALS,
)
