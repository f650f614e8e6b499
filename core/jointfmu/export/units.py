"""Units of what is written: SI inside, one consistent set outside.

Both sets keep newton, second and radian, so a conversion is a power of the length.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T", float, NDArray[np.float64])

POWERS = {
    "m": 1,
    "m2": 2,
    "N": 0,
    "Pa": -2,
    "N/m": -1,
    "N/m3": -3,
    "N.s/m": -1,
    "N.m": 1,
    "rad": 0,
    "N.m/rad": 1,
}
"""Power of the length in each SI unit that is written."""


@dataclass(frozen=True, slots=True)
class Units:
    """A consistent set of units.

    name      : length, force, pressure and mass
    per_metre : [1] its lengths in a metre
    symbols   : its own names {SI unit: symbol}, where they differ
    """

    name: str
    per_metre: float
    symbols: Mapping[str, str]

    def of(self, value: T, unit: str) -> T:
        """A value given in an SI unit, in this set."""
        return value * float(self.per_metre ** POWERS[unit])

    def symbol(self, unit: str) -> str:
        """How the set writes an SI unit."""
        return self.symbols.get(unit, unit)


_MM = {
    "m": "mm",
    "m2": "mm2",
    "Pa": "MPa",
    "N/m": "N/mm",
    "N/m3": "N/mm3",
    "N.s/m": "N.s/mm",
    "N.m": "N.mm",
    "N.m/rad": "N.mm/rad",
}
SI = Units("m-N-Pa-kg", 1.0, {})
UNITS = {one.name: one for one in (SI, Units("mm-N-MPa-t", 1e3, _MM))}
"""The sets by name, SI first; the second is the one usual in finite elements."""
