"""What the builders know of the gear mesh."""

from pathlib import Path
from typing import TYPE_CHECKING

from ...joint_parts import Parts
from .page import PANELS
from .terminals import TERMINALS

if TYPE_CHECKING:
    from ...joint_parts.native import NativePart


def _native() -> "NativePart":
    from .native import PART

    return PART


PARTS = Parts(
    folder=Path(__file__).parent,
    native=_native,
    panels=PANELS,
    terminals=TERMINALS,
)
