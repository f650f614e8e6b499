"""Tools for joints: drawings, surfaces, fits, fields, finite elements, exports, systems, pages."""

from collections.abc import Callable

from jointfmu.files.results import set_result_store

from .joints import PARTS

__all__ = ["PARTS"]


def _get_stored_result(key: str, compute_result: Callable[[], bytes]) -> bytes:
    """Return the result that the cache has under `key`; if there is none, compute and store it."""
    from jointfmu_fmu_src.native.compiled.compiled_models import get_stored_result

    return get_stored_result(key, compute_result)


set_result_store(_get_stored_result)
