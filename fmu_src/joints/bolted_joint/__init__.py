"""What the builders know of the bolted joint."""

from pathlib import Path

from ...joint_parts import Parts, native_of
from .data import DATA
from .page import DRAWINGS, PANELS
from .terminals import TERMINALS

PARTS = Parts(
    folder=Path(__file__).parent,
    native=native_of(__name__),
    data=DATA,
    drawings=DRAWINGS,
    panels=PANELS,
    terminals=TERMINALS,
)
