"""Parameter sets whose numbers are columns of samples, and which samples lie inside all intervals."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any, TypeVar, get_type_hints

import numpy as np
from numpy.typing import NDArray

from ..quantity import Limit, chosen, flat_fields, flatten, label, sections

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
T = TypeVar("T")


def columns(cls: type[T], values: Mapping[str, Any], axes: int = 0) -> T:
    """The parameter set `cls` with samples (n) among its values, as (n, 1, ...) with `axes` ones.

    Unchecked: `inside` tells the samples apart.
    """
    shaped = {k: v.reshape(-1, *[1] * axes) if isinstance(v, np.ndarray) else v for k, v in values.items()}
    return _columns(cls, shaped, "")


def _columns(cls: type[T], values: Mapping[str, Any], prefix: str) -> T:
    hints = get_type_hints(cls)
    one = object.__new__(cls)
    for item in fields(cls):  # type: ignore[arg-type]
        name = prefix + label(item)
        if "group" in item.metadata:
            own = hints[item.name]
            section = chosen(item, own, prefix, values)
            inner = _columns(sections(item, own)[section], values, f"{prefix}{section}.")
            object.__setattr__(one, item.name, inner)
        else:
            object.__setattr__(one, item.name, values[name])
    return one


def inside(joint: Any, count: int) -> Mask:
    """Which of `count` samples have every parameter in its interval, those that others decide included."""
    good = np.ones(count, dtype=bool)
    values = flatten(joint)
    for name, item in flat_fields(type(joint)):
        meta, value = item.metadata, values.get(name)
        if "allowed" in meta or not isinstance(value, np.ndarray):
            continue
        good &= np.isfinite(value) & (value > meta["gt"]) & (value >= meta["ge"])
        good &= (value < meta["lt"]) & (value <= meta["le"])
        if meta["whole"]:
            good &= value % 1.0 == 0.0
    with np.errstate(all="ignore"):
        for which in ("limits", "table_limits"):
            limits = getattr(joint, which, None)
            good &= within(values, limits() if limits else [], count)
    return good


def within(values: Mapping[str, Any], limits: Iterable[Limit], count: int) -> Mask:
    """Which samples lie between the limits that other parameters decide."""
    good = np.ones(count, dtype=bool)
    for limit in limits:
        value = np.asarray(values[limit.name])
        good &= value >= limit.low if limit.ends[0] == "[" else value > limit.low
        good &= value <= limit.high if limit.ends[1] == "]" else value < limit.high
    return good
