"""Finite elements: the contact of two bolted bodies and the modes of the assembly."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def require_fem_packages(calculation_name: str) -> Iterator[None]:
    """Context manager for finite-element calculations: a missing package or library raises ValueError.

    calculation_name : name of the calculation in the message

    Inside, BLAS uses one thread. More threads gain little, and they wait for each other if other processes
    share the cores.
    """
    try:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1, "blas"):
            yield
    except ImportError as error:
        raise ValueError(
            f"{calculation_name} needs the finite elements (extra fem), which are not installed, "
            f"{error.name or error} is missing: pip install 'jointfmu[fem]'"
        ) from None
    except OSError as error:
        raise ValueError(
            f"{calculation_name} needs libraries of the system that are missing ({error}); on Debian and "
            "Ubuntu install libglu1-mesa libgl1 libgomp1 libxcursor1 libxft2 libxinerama1"
        ) from None
