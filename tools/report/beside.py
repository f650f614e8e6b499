"""A published number of a joint beside what the joint does: a row of its page."""

from typing import NamedTuple

SET, OWN, PREDICTED = "set by it", "a parameter of its own", "predicted"
"""What the published number is for the file: a parameter comes from it; one is of the same meaning, but does
not come from it; none of the two."""


class Beside(NamedTuple):
    """Numbers in the SI unit `unit`.

    bound : the published number is an upper limit
    role  : SET, OWN or PREDICTED
    """

    name: str
    unit: str
    published: float
    bound: bool
    computed: float
    role: str
    source: str
