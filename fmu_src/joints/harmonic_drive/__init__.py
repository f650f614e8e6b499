"""What the builders know of the harmonic drive."""

from pathlib import Path
from typing import TYPE_CHECKING

from ...joint_parts import Parts
from .data import DATA
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
    data=DATA,
    panels=PANELS,
    terminals=TERMINALS,
)
