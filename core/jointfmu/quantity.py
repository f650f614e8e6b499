"""The one place where a physical field declares its SI unit, open or closed interval and meaning."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass
from math import inf
from typing import Any, TypeAlias, TypeVar, get_type_hints

import numpy as np

Number: TypeAlias = Any
"""A float, an array of floats, or a symbol of a computer-algebra tool: what a law accepts."""

T = TypeVar("T")


def quantity(
    unit: str,
    doc: str,
    *,
    gt: float = -inf,
    ge: float = -inf,
    lt: float = inf,
    le: float = inf,
    calibration: bool = False,
    whole: bool = False,
) -> Any:
    """Declare a number [unit] inside an interval.

    `calibration` marks a value that was fitted, `whole` one that counts.
    """
    meta = {"unit": unit, "doc": doc, "gt": gt, "ge": ge, "lt": lt, "le": le}
    return field(metadata={**meta, "calibration": calibration, "whole": whole})


def series(
    unit: str, doc: str, *, gt: float = -inf, ge: float = -inf, lt: float = inf, le: float = inf
) -> Any:
    """Declare a tuple of numbers [unit], every one inside an interval."""
    meta = {"unit": unit, "doc": doc, "gt": gt, "ge": ge, "lt": lt, "le": le}
    return field(metadata={**meta, "calibration": False, "whole": False, "series": True})


def choice(*allowed: str | bool, doc: str) -> Any:
    """Declare a named choice; the first is the default."""
    return field(default=allowed[0], metadata={"allowed": allowed, "doc": doc})


def group(doc: str, **either: type[Any]) -> Any:
    """Declare a nested group of quantities (`surface`, `side1`, ...).

    either : names and classes of which a parameter set has one, instead of the field's own
    """
    return field(metadata={"group": True, "doc": doc, "either": either})


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """An interval of a parameter that other parameters decide; `ends` as in (0, 1], `doc` says why."""

    name: str
    low: Number = -inf
    high: Number = inf
    ends: str = "()"
    doc: str

    def problem(self, value: Number, unit: str) -> str | None:
        """One line as from `problem` below; None if the value is inside, or a symbol."""
        if any(is_symbol(x) for x in (value, self.low, self.high)):
            return None
        low, high = self.ends[0], self.ends[1]
        above = value >= self.low if low == "[" else value > self.low
        below = value <= self.high if high == "]" else value < self.high
        if above and below:
            return None
        unit = "" if unit == "1" else f" {unit}"
        return f"{self.name} = {value:g}{unit} is outside {low}{self.low:g}, {self.high:g}{high}: {self.doc}"


def is_symbol(value: Any) -> bool:
    """Whether a value is a symbol of a computer-algebra tool (CasADi)."""
    return type(value).__module__.startswith("casadi")


def either(condition: Any, one: Number, other: Number) -> Number:
    """`one` where the condition holds, else `other`; plain values stay as they are."""
    if isinstance(condition, bool | np.bool_):
        return one if condition else other
    return np.where(condition, one, other)


def label(item: Field[Any]) -> str:
    """Public name of a field (`lambda_` is `lambda`, a Python keyword)."""
    return item.name.rstrip("_")


def sections(item: Field[Any], own: Any) -> dict[str, type[Any]]:
    """Names and classes that a group may have; `own` is the field's type."""
    return item.metadata["either"] or {label(item): own}


def section(item: Field[Any], value: Any) -> str:
    """Name of a group that is there."""
    either = item.metadata["either"]
    return next((name for name, cls in either.items() if isinstance(value, cls)), label(item))


def chosen(item: Field[Any], own: Any, prefix: str, values: Iterable[str]) -> str:
    """Name of the group that most of the parameter names speak of; the first if none does."""
    heads = [name.removeprefix(prefix).partition(".")[0] for name in values if name.startswith(prefix)]
    return max(sections(item, own), key=heads.count)


def interval(item: Field[Any]) -> str:
    """The allowed interval as text, e.g. `[0, 1)`."""
    meta = item.metadata
    low, high = max(meta["gt"], meta["ge"]), min(meta["lt"], meta["le"])
    left = "[" if low == meta["ge"] and low > -inf else "("
    right = "]" if high == meta["le"] and high < inf else ")"
    return f"{left}{low:g}, {high:g}{right}"


def problem(name: str, value: Any, item: Field[Any]) -> str | None:
    """One line that names the thing, the value with its unit, and what is allowed; None if fine."""
    meta = item.metadata
    if is_symbol(value):
        return None
    if "allowed" in meta:
        if any(value is option or (type(value) is str and value == option) for option in meta["allowed"]):
            return None
        return f"{name} = {value!r} is not one of {', '.join(str(a).lower() for a in meta['allowed'])}"
    unit = "" if meta["unit"] == "1" else f" {meta['unit']}"
    if "series" in meta:
        return _series_problem(name, value, item)
    number = isinstance(value, int | float | np.ndarray | np.number) and not isinstance(value, bool)
    array = np.asarray(value)
    if not number or array.dtype.kind not in "fiu":
        shown = " ".join(repr(value).split())[:80]
        kind = "real number" if number else "number"
        return f"{name} = {shown} is not a {kind}{unit and f' in{unit}'}: {meta['doc']}"
    inside = (array > meta["gt"]) & (array >= meta["ge"]) & (array < meta["lt"]) & (array <= meta["le"])
    inside &= np.isfinite(array)
    if np.all(inside):
        if not meta["whole"] or np.all(array % 1.0 == 0.0):
            return None
        first = array[array % 1.0 != 0.0].flat[0]
        return f"{name} = {first:g} is no whole number, allowed are 1, 2, 3, ..."
    first = array[~inside].flat[0]
    return f"{name} = {first:.10g}{unit} is outside {interval(item)}: {meta['doc']}"


def _series_problem(name: str, values: Any, item: Field[Any]) -> str | None:
    """As `problem`, of the first of some numbers that is wrong."""
    if not isinstance(values, list | tuple) or not values:
        shown = " ".join(repr(values).split())[:80]
        return f"{name} = {shown} is no list of numbers: {item.metadata['doc']}"
    one = {key: value for key, value in item.metadata.items() if key != "series"}
    single = field(metadata=one)
    found = (problem(f"{name}[{i}]", value, single) for i, value in enumerate(values))
    return next((text for text in found if text), None)


def check(obj: Any) -> None:
    """Raise ValueError naming every field of `obj` outside its interval (NaN and infinity included)."""
    found = (problem(label(f), getattr(obj, f.name), f) for f in fields(obj) if "group" not in f.metadata)
    if problems := [text for text in found if text]:
        raise ValueError("; ".join(problems))


def check_limits(obj: Any, limits: Iterable[Limit]) -> None:
    """Raise ValueError for the first parameter of `obj` outside an interval that others decide."""
    units = {name: item.metadata["unit"] for name, item in flat_fields(type(obj)) if "unit" in item.metadata}
    values = flatten(obj)
    for limit in limits:
        if text := limit.problem(values[limit.name], units[limit.name]):
            raise ValueError(text)


def flat_fields(cls: type[Any], prefix: str = "") -> Iterator[tuple[str, Field[Any]]]:
    """Structured names and fields of every number and choice of `cls`, groups opened."""
    hints = get_type_hints(cls)
    for item in fields(cls):
        if "group" in item.metadata:
            for name, one in sections(item, hints[item.name]).items():
                yield from flat_fields(one, f"{prefix}{name}.")
        elif item.metadata:
            yield prefix + label(item), item


def flatten(obj: Any) -> dict[str, Any]:
    """{structured name: value} of a parameter set."""
    values: dict[str, Any] = {}
    for item in fields(obj):
        value = getattr(obj, item.name)
        if is_dataclass(value) and "group" in item.metadata:
            values |= {f"{section(item, value)}.{name}": v for name, v in flatten(value).items()}
        elif item.metadata:
            values[label(item)] = value
    return values


def build(cls: type[T], values: Mapping[str, Any]) -> T:
    """Make the parameter set `cls` from {structured name: value}.

    Raises ValueError, one line, naming every unknown or missing name and every value that is no
    number or lies outside its interval.
    """
    left_out = _left_out(cls, values)
    everything = dict(flat_fields(cls))
    known = {name: item for name, item in everything.items() if not name.startswith(tuple(left_out))}
    required = {name for name, item in known.items() if item.default is MISSING}
    beside = [name for name in values if name in everything and name not in known]
    problems = [f"{name} is no parameter of a set that has [{left_out[_head(name)]}]" for name in beside]
    problems += [f"unknown name {name!r}" for name in values if name not in everything]
    if problems:
        problems.append(f"allowed are {', '.join(known)}")
    if missing := sorted(required - values.keys()):
        problems.append(f"missing {', '.join(missing)}")
    found = (problem(name, value, known[name]) for name, value in values.items() if name in known)
    problems += [text for text in found if text]
    if problems:
        raise ValueError("; ".join(problems))
    return _assemble(cls, dict(values), "")


def _left_out(cls: type[Any], values: Iterable[str]) -> dict[str, str]:
    """{prefix: name of the group that is there} of the groups that a parameter set does not have."""
    found: dict[str, str] = {}
    hints = get_type_hints(cls)
    for item in fields(cls):
        if item.metadata.get("either"):
            one = chosen(item, hints[item.name], "", values)
            found |= {f"{name}.": one for name in item.metadata["either"] if name != one}
    return found


def _head(name: str) -> str:
    return name.partition(".")[0] + "."


def _assemble(cls: type[T], values: dict[str, Any], prefix: str) -> T:
    hints = get_type_hints(cls)
    arguments: dict[str, Any] = {}
    for item in fields(cls):  # type: ignore[arg-type]
        name = prefix + label(item)
        if "group" in item.metadata:
            one = chosen(item, hints[item.name], prefix, values)
            inner = sections(item, hints[item.name])[one]
            arguments[item.name] = _assemble(inner, values, f"{prefix}{one}.")
        elif name in values:
            arguments[item.name] = _plain(values[name])
    return cls(**arguments)


def _plain(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return tuple(float(one) for one in value)
    return float(value) if type(value) is int else value
