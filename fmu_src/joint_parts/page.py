"""What a joint says of its documentation page."""

from typing import NamedTuple


class RampPanel(NamedTuple):
    """One chart of the ramp: quantities of one unit over an input or output."""

    over: str
    quantities: tuple[str, ...]
