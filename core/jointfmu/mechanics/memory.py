"""What a joint with memory remembers, declared once for Python and C: named parts of one array."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate
from math import prod

import numpy as np
from numpy.typing import ArrayLike

from ..quantity import Array


@dataclass(frozen=True, slots=True)
class Layout:
    """Parts of a memory, one after the other.

    shapes : {name: shape}, () of a single number
    """

    shapes: Mapping[str, tuple[int, ...]]

    def __or__(self, other: "Layout") -> "Layout":
        return Layout({**self.shapes, **other.shapes})

    @property
    def size(self) -> int:
        """How many numbers."""
        return sum(map(prod, self.shapes.values()))

    @property
    def places(self) -> dict[str, int]:
        """{name: place of its first number}."""
        return dict(zip(self.shapes, accumulate(map(prod, self.shapes.values()), initial=0), strict=False))

    def rest(self) -> Array:
        """The memory (n) of a joint that has not moved."""
        return np.zeros(self.size)

    def split(self, memory: Array) -> dict[str, Array]:
        """{name: part (..., *shape)} of memories (..., n)."""
        return {
            name: memory[..., at : at + prod(shape)].reshape(memory.shape[:-1] + shape)
            for (name, shape), at in zip(self.shapes.items(), self.places.values(), strict=True)
        }

    def joined(self, parts: Mapping[str, ArrayLike], *shape: int) -> Array:
        """Memories (*shape, n) of parts (..., *own shape)."""
        memory = np.empty((*shape, self.size))
        for name, place in self.split(memory).items():
            place[...] = parts[name]
        return memory
