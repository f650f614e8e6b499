"""Parameter sets whose numbers are columns of samples, and which samples lie inside all intervals."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Limit, assemble, flat_fields, flatten

Mask = NDArray[np.bool_]
T = TypeVar("T")


def columns(cls: type[T], values: Mapping[str, object], axes: int = 0) -> T:
    """The parameter set `cls` with samples (n) among its values, as (n, 1, ...) with `axes` ones.

    Unchecked: `inside` tells the samples apart.
    """
    shaped = {k: v.reshape(-1, *[1] * axes) if isinstance(v, np.ndarray) else v for k, v in values.items()}
    return assemble(cls, shaped, _unchecked)


def _unchecked(cls: type[object], arguments: Mapping[str, object]) -> object:
    """A frozen instance without its checks, which take no samples."""
    instance = object.__new__(cls)
    for name, value in arguments.items():
        object.__setattr__(instance, name, value)
    return instance


def inside(joint: object, count: int) -> Mask:
    """Which of `count` samples have every parameter in its interval, those that others decide included."""
    good = np.ones(count, dtype=bool)
    values = flatten(joint)
    for name, item in flat_fields(type(joint)):
        meta, value = item.metadata, values.get(name)
        if "allowed" in meta or not isinstance(value, np.ndarray):
            continue
        good &= meta["interval"].contains(value)
        if meta["whole"]:
            good &= value % 1.0 == 0.0
    with np.errstate(all="ignore"):
        for which in ("limits", "table_limits"):
            limits = getattr(joint, which, None)
            good &= within(values, limits() if limits else [], count)
    return good


def within(values: Mapping[str, object], limits: Iterable[Limit], count: int) -> Mask:
    """Which samples lie between the limits that other parameters decide."""
    good = np.ones(count, dtype=bool)
    for limit in limits:
        good &= limit.interval.contains(np.asarray(values[limit.name]))
    return good
