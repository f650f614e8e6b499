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

    variable_shapes : {name: shape}; the shape of a single number is ()
    """

    variable_shapes: Mapping[str, tuple[int, ...]]
    _variable_slices: tuple[tuple[str, int, int, tuple[int, ...]], ...] = field(
        init=False, repr=False, compare=False
    )
    """(name, index of the first value, index after the last, shape) of the variables."""

    def __post_init__(self) -> None:
        ends = [*accumulate(map(prod, self.variable_shapes.values()))]
        places = zip(self.variable_shapes, [0, *ends], ends, self.variable_shapes.values(), strict=False)
        object.__setattr__(self, "_variable_slices", tuple(places))

    def __or__(self, other_layout: "HistoryLayout") -> "HistoryLayout":
        return HistoryLayout({**self.variable_shapes, **other_layout.variable_shapes})

    @property
    def value_count(self) -> int:
        """Total number of values [1]."""
        return self._variable_slices[-1][2] if self._variable_slices else 0

    @property
    def first_value_indices(self) -> dict[str, int]:
        """{name: index of its first value in the array}."""
        return {name: start for name, start, _, _ in self._variable_slices}

    def virgin_history(self) -> Array:
        """History variables of the virgin state, in one array (value_count): zeros."""
        return np.zeros(self.value_count)

    def split(self, history: Array) -> dict[str, Array]:
        """Split arrays of history variables (..., n) into views {name: variable (..., *shape)}."""
        rows = history.shape[:-1]
        return {
            name: history[..., start:end].reshape(rows + shape)
            for name, start, end, shape in self._variable_slices
        }

    def join(self, variable_by_name: Mapping[str, ArrayLike], *leading_shape: int) -> Array:
        """Join history variables {name: variable (..., *its shape)} to an array (*shape, n)."""
        memory = np.empty((*leading_shape, self.value_count))
        for name, view in self.split(memory).items():
            view[...] = variable_by_name[name]
        return memory
