"""Finite elements: the contact of two bolted bodies and the modes of the assembly."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def installed(what: str) -> Iterator[None]:
    """ValueError, one line, where a package, or a system library of gmsh, is missing inside.

    BLAS has one thread there: more gain little, and spin for each other where other work shares the cores.
    """
    try:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1, "blas"):
            yield
    except (ImportError, OSError) as error:
        raise ValueError(
            f"{what} needs what is missing here ({error}); install it with: pip install 'jointfmu[fem]', "
            "and on Linux libglu1-mesa libgl1 libgomp1 libxcursor1 libxft2 libxinerama1"
        ) from None
