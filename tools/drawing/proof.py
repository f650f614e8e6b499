"""What a bolt bears at most, as far as its hole tells."""

from .tables import classes, threads
from .vdi2230 import stress_area

STRONGEST = "12.9"
"""The strongest property class of ISO 898-1."""
LARGE = 16e-3
"""Diameter [m] above which a property class has its second proof stress."""


def proof_load(hole: float) -> tuple[float, str] | None:
    """Proof load [N] of the largest bolt that passes a hole [m], and what that is; None if none is known."""
    fitting = [thread for thread in threads().values() if thread.d < hole]
    largest = max(threads().values(), key=lambda thread: thread.d)
    if not fitting or hole > 1.2 * largest.d:
        return None
    bolt = max(fitting, key=lambda thread: thread.d)
    load = classes()[STRONGEST]["proof"][int(bolt.d > LARGE)] * stress_area(bolt)
    name = f"{bolt.name}, class {STRONGEST} (ISO 898-1)"
    return load, f"the proof load of {name}, the largest bolt that passes the hole"
