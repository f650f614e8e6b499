"""Units of what is written: SI inside, one consistent set outside."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity.units import factor, rewritten

T = TypeVar("T", float, NDArray[np.float64])


@dataclass(frozen=True, slots=True)
class Units:
    """A consistent set of units.

    name    : length, force, pressure and mass
    symbols : {SI symbol: its own} where they differ
    """

    name: str
    symbols: Mapping[str, str]

    def of(self, value: T, unit: str) -> T:
        """A value given in an SI unit, in this set."""
        return value * factor(unit, self.symbol(unit))

    def symbol(self, unit: str) -> str:
        """How the set writes an SI unit."""
        return rewritten(unit, self.symbols)


SI = Units("m-N-Pa-kg", {})
UNITS = {units.name: units for units in (SI, Units("mm-N-MPa-t", {"m": "mm", "Pa": "MPa", "kg": "t"}))}
"""The sets by name, SI first; the second is the one usual in finite elements."""
