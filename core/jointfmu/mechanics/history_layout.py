"""Layout of history variables in one array, declared once for Python and C."""

from collections.abc import Mapping
from dataclasses import dataclass
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

    def __or__(self, right: "HistoryLayout") -> "HistoryLayout":
        return HistoryLayout({**self.shapes, **right.shapes})

    @property
    def size(self) -> int:
        """Total number of values [1]."""
        return sum(map(prod, self.shapes.values()))

    @property
    def offsets(self) -> dict[str, int]:
        """{name: index of its first value in the array}."""
        return dict(zip(self.shapes, accumulate(map(prod, self.shapes.values()), initial=0), strict=False))

    def virgin_history(self) -> Array:
        """Array (n) of history variables in the virgin state: zeros."""
        return np.zeros(self.size)

    def split(self, history: Array) -> dict[str, Array]:
        """Views {name: variable (..., *shape)} into arrays of history variables (..., n)."""
        return {
            name: history[..., start : start + prod(shape)].reshape(history.shape[:-1] + shape)
            for (name, shape), start in zip(self.shapes.items(), self.offsets.values(), strict=True)
        }

    def join(self, variables: Mapping[str, ArrayLike], *leading_shape: int) -> Array:
        """Array (*shape, n) of history variables from {name: variable (..., *its shape)}."""
        memory = np.empty((*leading_shape, self.size))
        for name, view in self.split(memory).items():
            view[...] = variables[name]
        return memory
