"""What the builders know of the bolted joint."""

from pathlib import Path

from ...joint_parts import Parts, native_of
from ...joint_parts.terminals import axis, rotation
from .data import DATA
from .page import DRAWINGS, PANELS

_AXES = zip("xyz", (75.0, 45.0, 15.0), strict=True)
_TURNS = zip("xyz", (-15.0, -45.0, -75.0), strict=True)

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    data=DATA,
    drawings=DRAWINGS,
    panels=PANELS,
    terminals={"BoltedJoint": (*(axis(*row) for row in _AXES), *(rotation(*row) for row in _TURNS))},
)
