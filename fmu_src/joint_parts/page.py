"""What a joint says of its documentation page."""

from typing import NamedTuple


class Panel(NamedTuple):
    """One panel of the plot of the ramp: quantities of one unit over an input or output."""

    over: str
    quantities: tuple[str, ...]
