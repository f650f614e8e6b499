"""A physical field declares its SI unit, open or closed interval and meaning, and is checked against them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, Field, field, fields
from typing import Any

import numpy as np

from .interval import Interval, is_symbol


def quantity(
    unit: str,
    doc: str,
    *,
    calibration: bool = False,
    whole: bool = False,
    default: float | None = None,
    **ends: float,
) -> Any:
    """Declare a number [unit] inside an interval with the ends gt, ge, lt, le of `Interval.of`.

    `calibration` marks a value that was fitted, `whole` one that counts; without `default` it must be given.
    """
    meta = {"unit": unit, "doc": doc, "interval": Interval.of(**ends)}
    meta |= {"calibration": calibration, "whole": whole}
    return field(metadata=meta, default=MISSING if default is None else default)


def series(unit: str, doc: str, *, optional: bool = False, **ends: float) -> Any:
    """Declare a tuple of numbers [unit], every one inside an interval, see `quantity`.

    optional : without any it is not stated
    """
    meta = {"unit": unit, "doc": doc, "interval": Interval.of(**ends)}
    default: Any = () if optional else MISSING
    return field(default=default, metadata={**meta, "calibration": False, "whole": False, "series": True})


def span(values: Sequence[float]) -> str:
    """How many numbers a series has, and from where to where they go, in words."""
    return f"{len(values)} numbers from {min(values):.6g} to {max(values):.6g}" if len(values) else "none"


def choice(*allowed: str | bool, doc: str) -> Any:
    """Declare a named choice; the first is the default."""
    return field(default=allowed[0], metadata={"allowed": allowed, "doc": doc})


def group(doc: str, **alternatives: type[Any]) -> Any:
    """Declare a nested group of quantities (`surface`, `side1`, ...).

    alternatives : names and classes of which a parameter set has one, instead of the field's own; the first
        is the default if it has no fields
    """
    first = next(iter(alternatives.values()), None)
    metadata = {"group": True, "doc": doc, "alternatives": alternatives}
    if first is None or fields(first):
        return field(metadata=metadata)
    return field(metadata=metadata, default_factory=first)


def label(item: Field[Any]) -> str:
    """Public name of a field (`lambda_` is `lambda`, a Python keyword)."""
    return item.name.rstrip("_")


def problem(name: str, value: object, item: Field[object]) -> str | None:
    """One line that names the thing, the value with its unit, and what is allowed; None if fine."""
    meta = item.metadata
    if is_symbol(value):
        return None
    if "allowed" in meta:
        if any(value is option or (type(value) is str and value == option) for option in meta["allowed"]):
            return None
        return f"{name} = {value!r} is not one of {', '.join(str(a).lower() for a in meta['allowed'])}"
    if "series" in meta:
        return _series_problem(name, value, item)
    if type(value) is float and not meta["whole"] and meta["interval"].contains(value):
        return None
    unit = "" if meta["unit"] == "1" else f" {meta['unit']}"
    number = isinstance(value, int | float | np.ndarray | np.number) and not isinstance(value, bool)
    array = np.asarray(value)
    if not number or array.dtype.kind not in "fiu":
        expected = "real number" if number else "number"
        return f"{name} = {_shown(value)} is not a {expected}{unit and f' in{unit}'}: {meta['doc']}"
    inside = meta["interval"].contains(array)
    if not np.all(inside):
        first = array[~inside].flat[0]
        return f"{name} = {first:.10g}{unit} is outside {meta['interval']}: {meta['doc']}"
    if meta["whole"] and np.any(broken := array % 1.0 != 0.0):
        return f"{name} = {array[broken].flat[0]:g} is no whole number, allowed are 1, 2, 3, ..."
    return None


def problems(
    values: Mapping[str, object], declared: Mapping[str, Field[Any]], missing: Collection[str] = ()
) -> list[str]:
    """Texts of all that is wrong with {name: value}: unknown names, missing ones, and what `problem` says."""
    texts = [f"unknown name {name!r}" for name in values if name not in declared]
    if texts:
        texts.append(f"allowed are {', '.join(declared)}")
    if missing:
        texts.append(f"missing {', '.join(missing)}")
    known = (problem(name, value, declared[name]) for name, value in values.items() if name in declared)
    return texts + [text for text in known if text]


def _series_problem(name: str, values: object, item: Field[object]) -> str | None:
    """As `problem`, of the first of some numbers that is wrong."""
    if values == () and item.default == ():
        return None
    if not isinstance(values, list | tuple) or not values:
        return f"{name} = {_shown(values)} is no list of numbers: {item.metadata['doc']}"
    if all(type(value) is float for value in values) and np.all(
        item.metadata["interval"].contains(np.array(values))
    ):
        return None
    number = field(metadata={key: value for key, value in item.metadata.items() if key != "series"})
    texts = (problem(f"{name}[{i}]", value, number) for i, value in enumerate(values))
    return next((text for text in texts if text), None)


def _shown(value: object) -> str:
    """A value of any type on one short line."""
    return " ".join(repr(value).split())[:80]


def check(obj: Any) -> None:
    """Raise ValueError naming every field of `obj` outside its interval (NaN and infinity included)."""
    own = {label(item): item for item in fields(obj) if "group" not in item.metadata}
    if texts := problems({name: getattr(obj, item.name) for name, item in own.items()}, own):
        raise ValueError("; ".join(texts))


class Checked:
    """A parameter set, or a group of one, whose numbers are checked when it is made."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check(self)
