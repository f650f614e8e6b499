"""Units as the pages show them: one for all stiffnesses, spelled as people write them."""

import re

from jointfmu.quantity.units import display_unit

STIFFNESSES = {"N.m/rad": "N.m/rad", "N/m": "N/um"}
"""{SI unit: the one in which every page shows it}; others have that in which they read best."""


def shown_unit(unit: str, typical: float) -> str:
    """The display unit of a variable of a typical size."""
    return STIFFNESSES.get(unit) or display_unit(unit, typical)


def spelled(unit: str) -> str:
    """A unit as it is read: N m, µm; nothing for 1."""
    return "" if unit == "1" else re.sub(r"\bu(?=[mNsJr])", "µ", unit.replace(".", " "))
