"""Computed results that are stored between processes, for example on the disk.

The package `jointfmu` (kernel: laws and joints without tools) stores none itself. The tools set a store when
they are imported; a python FMU has none.
"""

from collections.abc import Callable, Sequence
from hashlib import sha256
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..quantity import Array

ResultStore = Callable[[str, Callable[[], bytes]], bytes]
"""Function (key, function that computes the bytes) -> bytes, kept or computed."""
_stores: list[ResultStore] = []
"""Store of computed results of this process, at most one."""


def set_result_store(result_store: ResultStore | None) -> None:
    """Set the store of computed results that this process uses; None: it computes every result anew."""
    _stores[:] = [] if result_store is None else [result_store]


def compute_or_load_array(
    function_name: str, function_arguments: "Sequence[Array]", compute_array: "Callable[[], Array]"
) -> "Array":
    """Compute an array (...) of float64, or take it from the result store if it has one for these arguments.

    function_name      : name of the computation, and all other numbers on which the result depends
    function_arguments : arrays on which the result depends
    compute_array      : function without arguments that computes the array
    """
    import numpy as np  # here: the tools import this module before they can report an interrupt

    if not _stores:
        return compute_array()
    digest = sha256(function_name.encode())
    for argument in function_arguments:
        digest.update(f"\0{argument.shape} ".encode() + np.ascontiguousarray(argument, "<f8").tobytes())

    def compute_bytes() -> bytes:
        """Compute the array and encode it for the store: a line with its shape, then its float64 values."""
        result = compute_array()
        return f"{' '.join(map(str, result.shape))}\n".encode() + result.astype("<f8").tobytes()

    head, _, content = _stores[0](digest.hexdigest(), compute_bytes).partition(b"\n")
    return np.frombuffer(content, "<f8").reshape(tuple(map(int, head.split()))).astype(np.float64)
