"""Conversion of parameter sets (nested dataclasses) from and to {structured name: value}.

A structured name joins the names of groups and field with dots: `surface.D`.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from functools import cache, lru_cache
from typing import Any, TypeVar, get_type_hints

from .declaration import find_problems, name_in_parameter_file
from .interval import Interval, Number

ParameterSet = TypeVar("ParameterSet")


@cache
def _type_hints(cls: object) -> dict[str, object]:
    """Type hints {field: type} of the fields of a parameter set class, cached."""
    return get_type_hints(cls)


@dataclass(frozen=True, slots=True)
class ParameterLimit:
    """Allowed interval of one parameter that depends on other parameters.

    name : structured name of the limited parameter, such as `surface.D`
    doc  : reason for the interval, for the error message
    """

    name: str
    interval: Interval
    doc: str

    def find_problem(self, parameter_value: Number, unit: str) -> str | None:
        """Error message, one line, for a value outside the interval; None if it is inside or a symbol."""
        if self.interval.contains(parameter_value):
            return None
        unit = "" if unit == "1" else f" {unit}"
        if self.interval.is_empty:
            fault = ": the other parameters leave no value for it"
        else:
            fault = f" is outside {self.interval}"
        return f"{self.name} = {parameter_value:g}{unit}{fault}: {self.doc}"


def check_limits(parameter_set: object, parameter_limits: Iterable[ParameterLimit]) -> None:
    """Raise ValueError if a parameter of a set lies outside its limit; the message names the first one."""
    units = {
        name: item.metadata["unit"]
        for name, item in flatten_fields(type(parameter_set))
        if "unit" in item.metadata
    }
    values = flatten_parameters(parameter_set)
    for limit in parameter_limits:
        if text := limit.find_problem(values[limit.name], units[limit.name]):
            raise ValueError(text)


def flatten_fields(
    cls: type[Any], name_prefix: str = "", parameter_names: Collection[str] | None = None
) -> Iterator[tuple[str, Field[Any]]]:
    """Structured names and fields of all numbers and choices of a parameter set class, groups included.

    A structured name, such as `surface.D`, starts with the names of the groups.

    name_prefix     : names of the outer groups, with points
    parameter_names : stated parameters, which select one alternative of each group; None: all alternatives
    """
    if parameter_names is None:
        yield from ((name_prefix + name, item) for name, item in _cached_flattened_fields(cls))  # type: ignore[arg-type]
        return
    hints = _type_hints(cls)  # type: ignore[arg-type]
    for item in fields(cls):
        if "group" in item.metadata:
            sections = _group_sections(item, hints[item.name])
            section = _select_section(sections, name_prefix, parameter_names)
            yield from flatten_fields(sections[section], f"{name_prefix}{section}.", parameter_names)
        elif item.metadata:
            yield name_prefix + name_in_parameter_file(item), item


@cache
def _cached_flattened_fields(cls: Any) -> tuple[tuple[str, Field[object]], ...]:
    """Result of `flatten_fields` with all alternatives of each group, cached."""
    hints, found_fields = _type_hints(cls), list[tuple[str, Field[Any]]]()
    for item in fields(cls):
        if "group" in item.metadata:
            for name, inner in _group_sections(item, hints[item.name]).items():
                found_fields += flatten_fields(inner, f"{name}.")
        elif item.metadata:
            found_fields.append((name_in_parameter_file(item), item))
    return tuple(found_fields)


def flatten_parameters(parameter_set: Any) -> dict[str, Any]:
    """Convert a parameter set to {structured name: value}; names such as `surface.D` start with the group."""
    values: dict[str, Any] = {}
    for item, name in _named_fields(type(parameter_set)):  # type: ignore[arg-type]
        value = getattr(parameter_set, item.name)
        if "group" in item.metadata and is_dataclass(value):
            section = _section_name(item, value)
            values |= {f"{section}.{inner}": v for inner, v in flatten_parameters(value).items()}
        else:
            values[name] = value
    return values


@cache
def _named_fields(cls: Any) -> tuple[tuple[Field[Any], str], ...]:
    """Fields of a parameter set class with their names in parameter files, cached."""
    return tuple((item, name_in_parameter_file(item)) for item in fields(cls) if item.metadata)


@lru_cache(maxsize=256)
def _selected_fields(cls: Any, parameter_names: tuple[str, ...]) -> dict[str, Field[Any]]:
    """Fields {structured name: field} of a parameter set class with the selected alternatives only, cached.

    parameter_names : stated parameters, which select one alternative of each group of fields
    """
    return dict(flatten_fields(cls, parameter_names=parameter_names))


def build_parameter_set(cls: type[ParameterSet], value_by_name: Mapping[str, object]) -> ParameterSet:
    """Build a parameter set of the class `cls` from {structured name: value}, and check it.

    Raises ValueError, one line, that names every unknown or missing name and every value that is not a number
    or lies outside its interval; also if names belong to two alternatives of a group.
    """
    declared = _selected_fields(cls, tuple(value_by_name))  # type: ignore[arg-type]
    required = {name for name, item in declared.items() if item.default is MISSING}
    if texts := find_problems(value_by_name, declared, sorted(required - value_by_name.keys())):
        raise ValueError("; ".join(texts))
    plain = {name: _to_float(value) for name, value in value_by_name.items()}
    return assemble_parameter_set(cls, plain, lambda part, arguments: part(**arguments))


def replace_values(parameter_set: ParameterSet, new_values: Mapping[str, object]) -> ParameterSet:
    """Copy of a parameter set with some values replaced, by structured name.

    Raises ValueError as `build_parameter_set` does, and for a name of a group alternative that the set does
    not have.
    """
    values = flatten_parameters(parameter_set)
    unknown = [name for name in new_values if name not in values]
    all_names = {name for name, _ in flatten_fields(type(parameter_set))} if unknown else set()
    if foreign := [name for name in unknown if name in all_names]:
        texts = [
            f"{name} is not a parameter of a set that has [{_find_alternative_section(parameter_set, name)}]"
            for name in foreign
        ]
        raise ValueError("; ".join([*texts, f"allowed are {', '.join(values)}"]))
    return build_parameter_set(type(parameter_set), values | dict(new_values))


def assemble_parameter_set(
    cls: type[ParameterSet],
    value_by_name: Mapping[str, object],
    make_instance: Callable[[type[Any], dict[str, Any]], Any],
    name_prefix: str = "",
) -> ParameterSet:
    """Build a parameter set of the class `cls` from {structured name: value} without checks.

    make_instance : function (class, {field name: value}) -> instance, for the set and each of its groups
    name_prefix   : names of the outer groups, with points
    """
    hints = _type_hints(cls)  # type: ignore[arg-type]
    arguments: dict[str, Any] = {}
    for item in fields(cls):  # type: ignore[arg-type]
        name = name_prefix + name_in_parameter_file(item)
        if "group" in item.metadata:
            sections = _group_sections(item, hints[item.name])
            section = _select_section(sections, name_prefix, value_by_name)
            arguments[item.name] = assemble_parameter_set(
                sections[section], value_by_name, make_instance, f"{name_prefix}{section}."
            )
        elif name in value_by_name:
            arguments[item.name] = value_by_name[name]
    instance: ParameterSet = make_instance(cls, arguments)
    return instance


def _group_sections(group_field: Field[object], declared_group_type: object) -> dict[str, type[object]]:
    """List the alternative file sections of a group of parameters: {section name: class}.

    declared_group_type : declared type of the field of the group
    """
    return group_field.metadata["alternatives"] or {name_in_parameter_file(group_field): declared_group_type}


def _select_section(
    alternative_sections: Iterable[str], name_prefix: str, parameter_names: Collection[str]
) -> str:
    """Select the alternative file section of a group that contains stated parameters; else the first one.

    Raises ValueError, which lists the names, if two alternatives contain stated parameters.
    """
    first, *others = alternative_sections
    if not others:
        return first
    names_by_section = {
        section: [name for name in parameter_names if name.startswith(f"{name_prefix}{section}.")]
        for section in alternative_sections
    }
    present = [section for section, section_names in names_by_section.items() if section_names]
    if len(present) > 1:
        given = " together with ".join(", ".join(names_by_section[section]) for section in present)
        *others, last = (f"[{name_prefix}{section}]" for section in names_by_section)
        raise ValueError(f"{given}: state parameters of only one section, {', '.join(others)} or {last}")
    return present[0] if present else first


def _section_name(group_field: Field[object], group_value: object) -> str:
    """Name of the file section for the value of a group: that of the alternative with the value's class."""
    alternatives = group_field.metadata["alternatives"].items()
    return next(
        (name for name, cls in alternatives if isinstance(group_value, cls)),
        name_in_parameter_file(group_field),
    )


def _find_alternative_section(parameter_set: Any, name_in_missing_section: str) -> str:
    """Name of the section that a parameter set has instead of the section of a missing parameter name.

    The two sections are alternatives of one group; a parameter set has only one of them.
    """
    head, _, rest = name_in_missing_section.partition(".")
    groups = [item for item in fields(parameter_set) if "group" in item.metadata]
    sections = {_section_name(item, getattr(parameter_set, item.name)): item for item in groups}
    if head in sections:
        return f"{head}.{_find_alternative_section(getattr(parameter_set, sections[head].name), rest)}"
    return next(name for name, item in sections.items() if head in item.metadata["alternatives"])


def _to_float(parameter_value: object) -> object:
    """Convert an integer, or a list of numbers, to floats; other values are unchanged."""
    if isinstance(parameter_value, list | tuple):
        return tuple(float(number) for number in parameter_value)
    return float(parameter_value) if type(parameter_value) is int else parameter_value
