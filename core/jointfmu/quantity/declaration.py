"""Declarations of dataclass fields: SI unit, interval and meaning; values are checked against them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, Field, field, fields
from functools import cache
from typing import Any

import numpy as np

from .interval import Interval, is_casadi_symbol


def quantity_field(
    unit: str,
    doc: str,
    *,
    is_calibrated: bool = False,
    is_integer: bool = False,
    default: float | None = None,
    **bounds: float,
) -> Any:
    """Declare a number of a parameter set: dataclass field with unit, meaning and interval.

    unit        : SI unit
    doc         : meaning, one line
    is_calibrated : whether the value in the shipped parameter file was fitted to published points
    is_integer  : whether only whole numbers are allowed
    default     : value of a parameter set that does not state one; None: the value is required
    bounds      : allowed interval: gt (>), ge (>=), lt (<), le (<=)
    """
    meta = {"unit": unit, "doc": doc, "interval": Interval.from_bounds(**bounds)}
    meta |= {"calibration": is_calibrated, "whole": is_integer}
    return field(metadata=meta, default=MISSING if default is None else default)


def series_field(unit: str, doc: str, *, is_optional: bool = False, **bounds: float) -> Any:
    """Declare a tuple of numbers, all inside one interval: dataclass field; arguments as in `quantity_field`.

    is_optional : the tuple may be empty, which is the default
    """
    meta = {"unit": unit, "doc": doc, "interval": Interval.from_bounds(**bounds)}
    default: Any = () if is_optional else MISSING
    return field(default=default, metadata={**meta, "calibration": False, "whole": False, "series": True})


def describe_range(described_numbers: Sequence[float]) -> str:
    """Describe numbers by their count, the smallest and the largest: "3 numbers from 1 to 5"."""
    return (
        f"{len(described_numbers)} numbers from {min(described_numbers):.6g} to {max(described_numbers):.6g}"
        if len(described_numbers)
        else "none"
    )


def choice_field(*allowed_values: str | bool, doc: str) -> Any:
    """Declare a choice between some names or booleans: dataclass field; the first one is the default."""
    return field(default=allowed_values[0], metadata={"allowed": allowed_values, "doc": doc})


def group_field(doc: str, **alternatives: type[Any]) -> Any:
    """Declare a nested group of quantities (`surface`, `side1`, ...): dataclass field.

    alternatives : {section name: class}; a parameter set has exactly one of these sections. Without
        alternatives the section has the name and the class of the field. The first alternative is the default
        if all its fields have defaults.
    """
    first = next(iter(alternatives.values()), None)
    metadata = {"group": True, "doc": doc, "alternatives": alternatives}
    if first is None or any(item.default is MISSING for item in fields(first)):
        return field(metadata=metadata)
    return field(metadata=metadata, default_factory=first)


def name_in_parameter_file(declared_field: Field[Any]) -> str:
    """Name of a field in parameter files: without the underscore that avoids a Python keyword (`lambda_`)."""
    return declared_field.name.rstrip("_")


def find_problem(parameter_name: str, parameter_value: object, declared_field: Field[object]) -> str | None:
    """Error message for the value of a declared field, one line; None if the value is valid.

    The message has name, value, unit and allowed values.
    """
    meta = declared_field.metadata
    is_real = not meta.get("whole", True) and "series" not in meta
    if is_real and type(parameter_value) is float and meta["interval"].contains(parameter_value):
        return None
    if is_casadi_symbol(parameter_value):
        return None
    if "allowed" in meta:
        if any(
            parameter_value is option or (type(parameter_value) is str and parameter_value == option)
            for option in meta["allowed"]
        ):
            return None
        allowed = ", ".join(str(option).lower() for option in meta["allowed"])
        return f"{parameter_name} = {parameter_value!r} is not one of {allowed}"
    if "series" in meta:
        return _find_series_problem(parameter_name, parameter_value, declared_field)
    unit = "" if meta["unit"] == "1" else f" {meta['unit']}"
    number = isinstance(parameter_value, int | float | np.ndarray | np.number) and not isinstance(
        parameter_value, bool
    )
    array = np.asarray(parameter_value)
    if not number or array.dtype.kind not in "fiu":
        expected = "real number" if number else "number"
        text = f"{parameter_name} = {_shorten_repr(parameter_value)} is not a {expected}"
        return f"{text}{unit and f' in{unit}'}: {meta['doc']}"
    inside = meta["interval"].contains(array)
    if not np.all(inside):
        first = array[~inside].flat[0]
        return f"{parameter_name} = {first:.10g}{unit} is outside {meta['interval']}: {meta['doc']}"
    if meta["whole"] and np.any(is_fractional := array % 1.0 != 0.0):
        fractional = array[is_fractional].flat[0]
        return f"{parameter_name} = {fractional:g} is not a whole number, allowed are 1, 2, 3, ..."
    return None


def find_problems(
    value_by_name: Mapping[str, object],
    declared_fields: Mapping[str, Field[Any]],
    missing_names: Collection[str] = (),
) -> list[str]:
    """Error messages for {name: value} of a parameter set, one line for each problem.

    declared_fields : {name: field} of all allowed names
    missing_names   : required names that are not stated

    Problems are unknown and missing names, and values outside their intervals.
    """
    texts = [f"unknown name {name!r}" for name in value_by_name if name not in declared_fields]
    if texts:
        texts.append(f"allowed are {', '.join(declared_fields)}")
    if missing_names:
        texts.append(f"missing {', '.join(missing_names)}")
    messages = (
        find_problem(name, value, declared_fields[name])
        for name, value in value_by_name.items()
        if name in declared_fields
    )
    return texts + [text for text in messages if text]


def _find_series_problem(
    parameter_name: str, number_series: object, declared_field: Field[object]
) -> str | None:
    """Error message for the first invalid number of a series, see `find_problem`; None if all are valid."""
    if number_series == () and declared_field.default == ():
        return None
    if not isinstance(number_series, list | tuple) or not number_series:
        doc = declared_field.metadata["doc"]
        return f"{parameter_name} = {_shorten_repr(number_series)} is not a list of numbers: {doc}"
    if all(type(value) is float for value in number_series) and np.all(
        declared_field.metadata["interval"].contains(np.array(number_series))
    ):
        return None
    number = field(metadata={key: value for key, value in declared_field.metadata.items() if key != "series"})
    texts = (find_problem(f"{parameter_name}[{i}]", value, number) for i, value in enumerate(number_series))
    return next((text for text in texts if text), None)


def _shorten_repr(shown_value: object) -> str:
    """`repr` of a value on one line, cut to 80 characters, for error messages."""
    return " ".join(repr(shown_value).split())[:80]


def check_fields(parameter_set: Any) -> None:
    """Raise ValueError, which names all of them, if values of a parameter set are outside their intervals."""
    declared = _checked_fields(type(parameter_set))  # type: ignore[arg-type]
    if texts := find_problems(
        {name: getattr(parameter_set, item.name) for name, item in declared.items()}, declared
    ):
        raise ValueError("; ".join(texts))


@cache
def _checked_fields(cls: Any) -> dict[str, Field[Any]]:
    """Declared fields {name in parameter files: field} of a parameter set class, without its groups."""
    return {name_in_parameter_file(item): item for item in fields(cls) if "group" not in item.metadata}


class CheckedParameters:
    """Base class of a parameter set or a group of it: checks all values on construction."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check_fields(self)
