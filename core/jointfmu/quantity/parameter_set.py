"""Conversion of parameter sets (nested dataclasses) from and to {structured name: value}.

A structured name joins the names of groups and field with dots: `surface.D`.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from functools import cache, lru_cache
from typing import Any, TypeVar, get_type_hints

from .declaration import find_problems, name_in_file
from .interval import Interval, Number

ParameterSet = TypeVar("ParameterSet")


@cache
def _type_hints(cls: object) -> dict[str, object]:
    """Type hints {field: type} of the fields of a parameter set class, cached."""
    return get_type_hints(cls)


@dataclass(frozen=True, slots=True)
class ParameterLimit:
    """Allowed interval of one parameter, which depends on other parameters; `doc` is the reason."""

    name: str
    interval: Interval
    doc: str

    def find_problem(self, value: Number, unit: str) -> str | None:
        """Error message, one line, for a value outside the interval; None if it is inside or a symbol."""
        if self.interval.contains(value):
            return None
        unit = "" if unit == "1" else f" {unit}"
        if self.interval.is_empty:
            return f"{self.name} = {value:g}{unit}: the other parameters leave no value for it: {self.doc}"
        return f"{self.name} = {value:g}{unit} is outside {self.interval}: {self.doc}"


def check_limits(parameters: object, limits: Iterable[ParameterLimit]) -> None:
    """Raise ValueError if a parameter of a set lies outside its limit; the message names the first one."""
    units = {
        name: item.metadata["unit"]
        for name, item in flatten_fields(type(parameters))
        if "unit" in item.metadata
    }
    values = flatten_parameters(parameters)
    for limit in limits:
        if text := limit.find_problem(values[limit.name], units[limit.name]):
            raise ValueError(text)


def flatten_fields(
    cls: type[Any], prefix: str = "", parameter_names: Collection[str] | None = None
) -> Iterator[tuple[str, Field[Any]]]:
    """Structured names and fields of all numbers and choices of a parameter set class, groups included.

    parameter_names : parameter names that select one alternative of each group; None: all alternatives
    """
    if parameter_names is None:
        yield from ((prefix + name, item) for name, item in _cached_flattened_fields(cls))  # type: ignore[arg-type]
        return
    hints = _type_hints(cls)  # type: ignore[arg-type]
    for item in fields(cls):
        if "group" in item.metadata:
            sections = _group_sections(item, hints[item.name])
            section = _select_section(sections, prefix, parameter_names)
            yield from flatten_fields(sections[section], f"{prefix}{section}.", parameter_names)
        elif item.metadata:
            yield prefix + name_in_file(item), item


@cache
def _cached_flattened_fields(cls: Any) -> tuple[tuple[str, Field[object]], ...]:
    """Result of `flatten_fields` with all alternatives of each group, cached."""
    hints, found_fields = _type_hints(cls), list[tuple[str, Field[Any]]]()
    for item in fields(cls):
        if "group" in item.metadata:
            for name, inner in _group_sections(item, hints[item.name]).items():
                found_fields += flatten_fields(inner, f"{name}.")
        elif item.metadata:
            found_fields.append((name_in_file(item), item))
    return tuple(found_fields)


def flatten_parameters(parameters: Any) -> dict[str, Any]:
    """Convert a parameter set to {structured name: value}."""
    values: dict[str, Any] = {}
    for item, name in _named_fields(type(parameters)):  # type: ignore[arg-type]
        value = getattr(parameters, item.name)
        if "group" in item.metadata and is_dataclass(value):
            section = _section_name(item, value)
            values |= {f"{section}.{inner}": v for inner, v in flatten_parameters(value).items()}
        else:
            values[name] = value
    return values


@cache
def _named_fields(cls: Any) -> tuple[tuple[Field[Any], str], ...]:
    """Fields of a parameter set class with their names in parameter files, cached."""
    return tuple((item, name_in_file(item)) for item in fields(cls) if item.metadata)


@lru_cache(maxsize=256)
def _selected_fields(cls: Any, parameter_names: tuple[str, ...]) -> dict[str, Field[Any]]:
    """{structured name: field} of the alternatives that parameter names select, cached."""
    return dict(flatten_fields(cls, parameter_names=parameter_names))


def build_parameter_set(cls: type[ParameterSet], value_by_name: Mapping[str, object]) -> ParameterSet:
    """Build and check the parameter set `cls` from {structured name: value}.

    Raises ValueError, one line, that names every unknown or missing name and every value that is not a number
    or lies outside its interval; also if names belong to two alternatives of a group.
    """
    declared = _selected_fields(cls, tuple(value_by_name))  # type: ignore[arg-type]
    required = {name for name, item in declared.items() if item.default is MISSING}
    if texts := find_problems(value_by_name, declared, sorted(required - value_by_name.keys())):
        raise ValueError("; ".join(texts))
    plain = {name: _to_float(value) for name, value in value_by_name.items()}
    return assemble_parameter_set(cls, plain, lambda part, arguments: part(**arguments))


def replace_values(parameters: ParameterSet, new_values: Mapping[str, object]) -> ParameterSet:
    """Copy of a parameter set with some values replaced, by structured name.

    Raises ValueError as `build_parameter_set` does, and for names of a missing alternative.
    """
    values = flatten_parameters(parameters)
    unknown = [name for name in new_values if name not in values]
    all_names = {name for name, _ in flatten_fields(type(parameters))} if unknown else set()
    if foreign := [name for name in unknown if name in all_names]:
        texts = [
            f"{name} is not a parameter of a set that has [{_find_present_section(parameters, name)}]"
            for name in foreign
        ]
        raise ValueError("; ".join([*texts, f"allowed are {', '.join(values)}"]))
    return build_parameter_set(type(parameters), values | dict(new_values))


def assemble_parameter_set(
    cls: type[ParameterSet],
    value_by_name: Mapping[str, object],
    make_instance: Callable[[type[Any], dict[str, Any]], Any],
    prefix: str = "",
) -> ParameterSet:
    """Build the parameter set `cls` from {structured name: value} without checks.

    make_instance : (class, {field name: value}) -> instance
    """
    hints = _type_hints(cls)  # type: ignore[arg-type]
    arguments: dict[str, Any] = {}
    for item in fields(cls):  # type: ignore[arg-type]
        name = prefix + name_in_file(item)
        if "group" in item.metadata:
            sections = _group_sections(item, hints[item.name])
            section = _select_section(sections, prefix, value_by_name)
            arguments[item.name] = assemble_parameter_set(
                sections[section], value_by_name, make_instance, f"{prefix}{section}."
            )
        elif name in value_by_name:
            arguments[item.name] = value_by_name[name]
    instance: ParameterSet = make_instance(cls, arguments)
    return instance


def _group_sections(group_field: Field[object], default_type: object) -> dict[str, type[object]]:
    """List the file sections that a group of parameters may have: {section name: class}.

    default_type : declared type of the field of the group
    """
    return group_field.metadata["alternatives"] or {name_in_file(group_field): default_type}


def _select_section(sections: Iterable[str], prefix: str, parameter_names: Collection[str]) -> str:
    """Select the alternative of a group that the parameter names belong to; the first one if none matches.

    Raises ValueError, which lists the names, if they belong to two alternatives.
    """
    first, *others = sections
    if not others:
        return first
    names_by_section = {
        section: [name for name in parameter_names if name.startswith(f"{prefix}{section}.")]
        for section in sections
    }
    present = [section for section, section_names in names_by_section.items() if section_names]
    if len(present) > 1:
        given = " with ".join(", ".join(names_by_section[section]) for section in present)
        raise ValueError(
            f"{given}: allowed is one of {', '.join(f'[{prefix}{name}]' for name in names_by_section)}"
        )
    return present[0] if present else first


def _section_name(group_field: Field[object], group_value: object) -> str:
    """Name of the file section of a value: its class says which alternative of the group it is."""
    alternatives = group_field.metadata["alternatives"].items()
    return next(
        (name for name, cls in alternatives if isinstance(group_value, cls)), name_in_file(group_field)
    )


def _find_present_section(parameters: Any, name_in_missing_section: str) -> str:
    """File section that a parameter set has as the alternative to the section of a missing name.

    Two sections are alternatives of one group.
    """
    head, _, rest = name_in_missing_section.partition(".")
    groups = [item for item in fields(parameters) if "group" in item.metadata]
    sections = {_section_name(item, getattr(parameters, item.name)): item for item in groups}
    if head in sections:
        return f"{head}.{_find_present_section(getattr(parameters, sections[head].name), rest)}"
    return next(name for name, item in sections.items() if head in item.metadata["alternatives"])


def _to_float(value: object) -> object:
    """Convert an integer, or a list of numbers, to floats; other values are unchanged."""
    if isinstance(value, list | tuple):
        return tuple(float(number) for number in value)
    return float(value) if type(value) is int else value
