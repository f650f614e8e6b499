"""Layout of history variables in one array, declared once for Python and C."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import accumulate
from math import prod

import numpy as np
from numpy.typing import ArrayLike

from ..quantity import Array


@dataclass(frozen=True, slots=True)
class HistoryLayout:
    """Order and shapes of history variables that are stored one after the other in an array.

    shapes : {name: shape}; the shape of a single number is ()
    """

    shapes: Mapping[str, tuple[int, ...]]
    _variable_slices: tuple[tuple[str, int, int, tuple[int, ...]], ...] = field(
        init=False, repr=False, compare=False
    )
    """(name, index of the first value, index after the last, shape) of the variables."""

    def __post_init__(self) -> None:
        ends = [*accumulate(map(prod, self.shapes.values()))]
        places = zip(self.shapes, [0, *ends], ends, self.shapes.values(), strict=False)
        object.__setattr__(self, "_variable_slices", tuple(places))

    def __or__(self, other_layout: "HistoryLayout") -> "HistoryLayout":
        return HistoryLayout({**self.shapes, **other_layout.shapes})

    @property
    def size(self) -> int:
        """Total number of values [1]."""
        return self._variable_slices[-1][2] if self._variable_slices else 0

    @property
    def offsets(self) -> dict[str, int]:
        """{name: index of its first value in the array}."""
        return {name: start for name, start, _, _ in self._variable_slices}

    def virgin_history(self) -> Array:
        """Array (n) of history variables in the virgin state: zeros."""
        return np.zeros(self.size)

    def split(self, history: Array) -> dict[str, Array]:
        """Split arrays of history variables (..., n) into views {name: variable (..., *shape)}."""
        rows = history.shape[:-1]
        return {
            name: history[..., start:end].reshape(rows + shape)
            for name, start, end, shape in self._variable_slices
        }

    def join(self, variables: Mapping[str, ArrayLike], *leading_shape: int) -> Array:
        """Join history variables {name: variable (..., *its shape)} to an array (*shape, n)."""
        memory = np.empty((*leading_shape, self.size))
        for name, view in self.split(memory).items():
            view[...] = variables[name]
        return memory
