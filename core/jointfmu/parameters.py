"""Reader and writer of parameter files: TOML text from and to parameter sets.

A file is `schema = 1`, `joint = KIND`, `law = LAW` (absent: the joint's first one), `name = ...` and one
entry per parameter,

    [surface]
    D = { value = 1.42, unit = "1", kind = "paper", source = "Zhao 2018, section 2" }

`kind` is one of VALUE_ORIGINS. The unit must be the SI unit that the code declares; nothing is converted.
A section `[inputs]` of the same form gives start values of the joint's inputs; other inputs start at their
default values. A section `[roughness]` states measured heights of the surfaces, see `contact.roughness`; a
law with the rms height h as a parameter computes h from them. For a law without h the section is called
`[comparison]`: its heights do not act, the stiffness of the law is only compared with the one they predict.
"""

import textwrap
import tomllib
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import Field, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

from .contact import roughness
from .files.reading import read_bytes
from .files.text import MAX_NAME_LENGTH, check_text, check_toml_texts, format_toml_string
from .joints import KINDS
from .quantity import (
    build_parameter_set,
    find_problem,
    find_problems,
    flatten_fields,
    flatten_parameters,
    quantity_field,
    replace_values,
)
from .quantity.units import conversion_factor

EntryValue = TypeVar("EntryValue")

SCHEMA_VERSION = 1
"""Version of the format of parameter files: their entry `schema`."""
VALUE_ORIGINS = (
    *("paper", "standard", "catalogue", "measured", "derived", "estimate", "calibration"),
    *("default", "user"),
)
"""Origin of a value (`kind`): printed in a paper or handbook, a standard, a maker's catalogue, measured,
computed from other values, an engineering estimate, fitted to points, a default, or set by the user."""
VALUE_ORIGIN_BY_FORMER_NAME = {"published": "paper"}
"""{former name of an origin: its name}."""
_DEFAULT_SOURCE_TEXT = "default choice"
"""Beginning of the source text of a value that is a default."""
_TOO_DEEP_NESTING_MESSAGE = (
    "has too many brackets or tables inside each other; expected sections with entries"
)
"""Error of a file whose tables are nested too deeply for the TOML parser."""
_MAX_SHOWN_VALUE_LENGTH = 60
"""Largest number of characters [1] of a wrong value in a message."""
_NUMBERS_PER_LINE = 5
"""Numbers of a list per line of the file [1]."""
_INPUTS_SECTION_PREFIX = "inputs."
"""Prefix of the structured names of the start values of inputs."""
RELATIVE_HEIGHT_TOLERANCE = 0.01
"""Largest relative difference [1] between h of a law and the h computed from the section [roughness]: heights
are printed with two digits."""
_ROUGHNESS_SECTION_PREFIX, _COMPARISON_SECTION_PREFIX = "roughness.", "comparison."
"""Prefixes of the names of surface heights: for a law with the parameter h, and for a law without it."""


@dataclass(frozen=True, slots=True)
class ParameterFile:
    """Content of a parameter file: a parameter set with the origin and source of each value.

    joint   : name of the kind of joint, a key of joints.KINDS
    name    : name of the parameter set
    values  : the parameter set, an instance of a class in KINDS[joint].laws
    origins : {structured name: one of VALUE_ORIGINS}, also for start values (`inputs.NAME`) and surface
        heights (`roughness.NAME` if the law depends on them, else `comparison.NAME`)
    sources : {structured name: text that states the source}, for the same names
    inputs  : {input: start value in its SI unit} of the inputs that the file states
    roughness : {name: roughness height [m]} that the file states: Ra1, Ra2, Rq1, Rq2 or h
    ranges  : {structured name: (smallest, largest value)} of the uncertain values, from the same source
    values_by_name : {structured name: value} of `values`; a structured name is such as `surface.D`

    Raises ValueError if the name or a source is too long or has a control character.
    """

    joint: str
    name: str
    values: Any
    origins: Mapping[str, str]
    sources: Mapping[str, str]
    inputs: Mapping[str, float] = field(default_factory=dict)
    roughness: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    values_by_name: Mapping[str, Any] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_text("name", self.name, MAX_NAME_LENGTH)
        for name, text in self.sources.items():
            check_text(f"{name}: source", text)
        origins = {
            name: _convert_former_origin(kind, self.sources.get(name, ""))
            for name, kind in self.origins.items()
        }
        object.__setattr__(self, "origins", origins)
        object.__setattr__(self, "values_by_name", flatten_parameters(self.values))

    @property
    def law(self) -> str:
        """Name of the interface law of the parameter set."""
        return KINDS[self.joint].law_name(self.values)

    @property
    def heights_prefix(self) -> str:
        """Prefix of surface heights in the file: `roughness.` if the law uses them, else `comparison.`."""
        return _heights_prefix(type(self.values))

    def describe_source(self, value_name: str) -> tuple[str, str]:
        """Origin and source of a value, by its structured name; a default if the file states none."""
        return self.origins.get(value_name, "default"), self.sources.get(value_name, _DEFAULT_SOURCE_TEXT)

    def start_value(self, input_name: str) -> float:
        """Start value of an input in its SI unit: stated in the file, else the default of the joint."""
        variable = KINDS[self.joint].variables.get(input_name) if self.joint in KINDS else None
        return self.inputs.get(input_name, variable.start if variable else 0.0)

    def with_values(
        self, new_values: Mapping[str, object], value_origin: str, value_source: str
    ) -> "ParameterFile":
        """Copy of the file with new values, {structured name: value}; names and intervals are checked.

        A new height h of the law removes the heights of the surfaces from which h was computed.
        """
        removed = {*self.roughness} if any(map(is_combined_height, new_values)) else set[str]()
        removed_names = {self.heights_prefix + name for name in removed}
        return replace(
            self,
            values=replace_values(self.values, new_values),
            origins=_drop_entries(removed_names, self.origins) | dict.fromkeys(new_values, value_origin),
            sources=_drop_entries(removed_names, self.sources) | dict.fromkeys(new_values, value_source),
            roughness=_drop_entries(removed, self.roughness),
            ranges=_drop_entries(new_values, self.ranges),
        )

    def with_roughness(
        self, surface_heights: Mapping[str, float], height_origin: str, height_source: str
    ) -> "ParameterFile":
        """Copy of the file with new roughness heights [m] of the two surfaces, {name: height}: Ra, Rq or Sq.

        Roughness heights that the file has for the same surface are removed. If the law has the parameter h
        (combined roughness height of both surfaces), h is computed from the roughness heights.

        Raises ValueError as `roughness.check_heights` does.
        """
        new_heights = roughness.check_heights(surface_heights, self.heights_prefix)
        replaced = {other for name in new_heights for other in roughness.find_conflicting_height_names(name)}
        replaced_names = {self.heights_prefix + name for name in replaced}
        new_names = [self.heights_prefix + name for name in new_heights]
        all_heights = _drop_entries(replaced, self.roughness) | new_heights
        origins = _drop_entries(replaced_names, self.origins) | dict.fromkeys(new_names, height_origin)
        sources = _drop_entries(replaced_names, self.sources) | dict.fromkeys(new_names, height_source)
        law_height = {
            name: roughness.combined_height(all_heights)
            for name in self.values_by_name
            if is_combined_height(name)
        }
        return replace(
            self,
            values=replace_values(self.values, law_height),
            roughness=all_heights,
            origins=origins | dict.fromkeys(law_height, "derived"),
            sources=sources
            | dict.fromkeys(law_height, _format_height_source(self.heights_prefix, all_heights, sources)),
            ranges=_drop_entries(law_height, self.ranges),
        )


def _convert_former_origin(value_origin: str, source_text: str) -> str:
    """Convert the origin of a value in a file of an earlier version to its current name in VALUE_ORIGINS.

    `user` becomes `default` if the source says that the value is a default.
    """
    if value_origin == "user" and source_text.startswith(_DEFAULT_SOURCE_TEXT):
        return "default"
    return VALUE_ORIGIN_BY_FORMER_NAME.get(value_origin, value_origin)


def load_parameter_file(parameter_path: str | Path, joint_name: str | None = None) -> ParameterFile:
    """Read and check a parameter file.

    joint_name : kind of joint that the file must have; None: any

    Raises ValueError with one line that names the file, the entry, its value and what is allowed: a missing
    or broken file, a file of another joint, an unknown or missing name, a wrong unit, a value of the wrong
    type or outside its interval, a value that contradicts another one; the same for start values of inputs.
    """
    parameter_path = Path(parameter_path)
    document = read_document(parameter_path, "a parameter file")
    stated = document.get("joint")
    if not isinstance(stated, str) or stated not in KINDS:
        raise ValueError(f"{parameter_path}: joint = {stated!r}, allowed are {', '.join(KINDS)}")
    if joint_name is not None and stated != joint_name:
        raise ValueError(f"{parameter_path}: joint = {stated!r}, expected a file with joint = {joint_name!r}")
    laws = KINDS[stated].laws
    law = document.get("law", next(iter(laws)))
    if not isinstance(law, str) or law not in laws:
        raise ValueError(f"{parameter_path}: law = {law!r}, allowed are {', '.join(laws)}")
    body = {k: v for k, v in document.items() if k not in ("schema", "joint", "law", "name")}
    cls = laws[law]
    prefix = _heights_prefix(cls)
    if prefix == _COMPARISON_SECTION_PREFIX and _ROUGHNESS_SECTION_PREFIX[:-1] in body:
        raise ValueError(
            f"{parameter_path}: [roughness] has no effect on law = {law!r}, which has no height h; rename "
            "the section to [comparison]: its heights only serve to judge the stiffness"
        )
    declared = declared_entries(stated, cls)
    keys = ("value", "unit", "kind", "source", "range")
    values, origins, sources = read_entries(parameter_path, declared, body, keys)
    input_values, surface_heights = _pop_section(values, _INPUTS_SECTION_PREFIX), _pop_section(values, prefix)
    try:
        inputs = _check_start_values(stated, input_values)
        heights = roughness.check_heights(surface_heights, prefix)
        of_law = _compute_law_height(declared, values, heights)
        parameters = build_parameter_set(cls, values | of_law)
    except ValueError as error:
        raise ValueError(f"{parameter_path}: {error}") from None
    for text in KINDS[stated].find_contradictions(parameters):
        raise ValueError(f"{parameter_path}: {text}")
    name = str(document.get("name", parameter_path.stem))
    origins |= dict.fromkeys(of_law, "derived")
    sources |= dict.fromkeys(of_law, _format_height_source(prefix, heights, sources))
    return ParameterFile(
        stated,
        name,
        parameters,
        origins,
        sources,
        inputs,
        heights,
        _read_ranges(parameter_path, declared, body),
    )


def declared_entries(joint_name: str, cls: type) -> dict[str, Field[Any]]:
    """Declared fields {structured name: field} of all entries that a parameter file of a joint may have.

    These are parameters, start values of inputs and surface heights.

    cls : class of the parameter set
    """
    return dict(flatten_fields(cls)) | _input_fields(joint_name) | _roughness_fields(_heights_prefix(cls))


def _drop_entries(
    removed_names: Collection[str], values_by_name: Mapping[str, EntryValue]
) -> dict[str, EntryValue]:
    """Copy of {structured name: value} without the removed names."""
    return {name: value for name, value in values_by_name.items() if name not in removed_names}


def _format_height_source(
    height_name_prefix: str, surface_heights: Iterable[str], height_sources: Mapping[str, str]
) -> str:
    """Source text of a height h that was computed from the heights of the surfaces."""
    names = [height_name_prefix + height for height in surface_heights]
    return f"from {', '.join(names)}: {'; '.join(dict.fromkeys(height_sources[name] for name in names))}"


def _compute_law_height(
    declared_fields: Mapping[str, object],
    entry_values: Mapping[str, Any],
    surface_heights: Mapping[str, float],
) -> dict[str, float]:
    """Combined rms height h [m] of a law, {structured name: h}, from the heights of the single surfaces.

    Empty if the file states h, or for a law without the parameter h. Raises ValueError if the file states
    both and they differ by more than RELATIVE_HEIGHT_TOLERANCE.
    """
    stated = roughness.combined_height(surface_heights)
    name = next((name for name in declared_fields if is_combined_height(name)), None)
    if stated is None or name is None:
        return {}
    if name not in entry_values:
        return {name: stated}
    if not abs(entry_values[name] / stated - 1.0) <= RELATIVE_HEIGHT_TOLERANCE:
        makers = ", ".join(_ROUGHNESS_SECTION_PREFIX + height for height in surface_heights)
        raise ValueError(
            f"{name} = {entry_values[name]:g} m does not agree with {makers}, which give {stated:.4g} m: "
            f"state one of them, or both within {RELATIVE_HEIGHT_TOLERANCE:.1%}"
        )
    return {}


def read_document(document_path: Path, expected_content: str) -> dict[str, Any]:
    """Read a TOML document that has the entry `schema` with the version SCHEMA_VERSION of this package.

    expected_content : what the file should be, for the error

    Raises ValueError with one line if the file cannot be read, is not TOML or of another schema, or if a key
    or a text is too long or has control characters.
    """
    content = read_bytes(document_path, expected_content)
    try:
        document = tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise ValueError(
            f"{document_path}: is not a text file; expected {expected_content} (TOML, UTF-8)"
        ) from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{document_path}: is not valid TOML ({error})") from None
    except RecursionError:
        raise ValueError(f"{document_path}: {_TOO_DEEP_NESTING_MESSAGE}") from None
    except ValueError:  # of int(): Python limits the digits
        raise ValueError(
            f"{document_path}: has an integer of too many digits; expected numbers up to 1.8e308"
        ) from None
    try:
        check_toml_texts(document)
    except RecursionError:
        raise ValueError(f"{document_path}: {_TOO_DEEP_NESTING_MESSAGE}") from None
    except ValueError as error:
        raise ValueError(f"{document_path}: {error}") from None
    if type(document.get("schema")) is not int or document["schema"] != SCHEMA_VERSION:
        stated = textwrap.shorten(repr(document.get("schema")), _MAX_SHOWN_VALUE_LENGTH, placeholder="...")
        raise ValueError(f"{document_path}: schema = {stated}, expected the line schema = {SCHEMA_VERSION}")
    return document


def _format_converted_value(toml_entry: Mapping[str, Any], si_unit: Any) -> str:
    """Text with the value of an entry in its SI unit; empty if the entry has no unit of this quantity."""
    value, stated_unit = toml_entry.get("value"), toml_entry.get("unit")
    if isinstance(value, int | float) and isinstance(stated_unit, str) and isinstance(si_unit, str):
        with suppress(ValueError):
            return f"; write value = {value * conversion_factor(stated_unit, si_unit):.9g}"
    return ""


def read_entries(
    parameter_path: Path,
    declared_fields: Mapping[str, Field[Any]],
    toml_sections: Mapping[str, object],
    allowed_keys: tuple[str, ...] = ("value", "unit", "kind", "source"),
) -> tuple[dict[str, Any], dict[str, str], dict[str, str]]:
    """Read values, origins and sources of the entries of a parameter file: three {structured name: ...}.

    declared_fields : {structured name: field}; the unit of each entry is checked against its field
    toml_sections   : nested sections and entries of the document
    allowed_keys    : keys that an entry may have

    Raises ValueError, one line, for an entry that is not a table, or has an unknown key, a wrong unit, an
    unknown kind or no source. Unknown names and the values themselves are not checked here.
    """
    values: dict[str, Any] = {}
    origins: dict[str, str] = {}
    sources: dict[str, str] = {}
    for name, entry in list_entries(toml_sections):
        if not isinstance(entry, Mapping):
            raise ValueError(
                f"{parameter_path}: {name} = {entry!r}, expected a table {{ value, unit, kind, source }}"
            )
        if unknown := set(entry) - set(allowed_keys):
            raise ValueError(
                f"{parameter_path}: {name} has an unknown key {sorted(unknown)[0]!r}, allowed are "
                f"{', '.join(allowed_keys)}"
            )
        if name in declared_fields:
            unit = declared_fields[name].metadata.get("unit")
            if entry.get("unit") != unit:
                raise ValueError(
                    f"{parameter_path}: {name}: unit {entry.get('unit')!r}, expected {unit!r}"
                    f"{_format_converted_value(entry, unit)}"
                )
        if entry.get("kind") not in (*VALUE_ORIGINS, *VALUE_ORIGIN_BY_FORMER_NAME):
            raise ValueError(
                f"{parameter_path}: {name}: kind = {entry.get('kind')!r}, allowed are "
                f"{', '.join(VALUE_ORIGINS)}"
            )
        source = entry.get("source")
        if not isinstance(source, str) or not source.strip():
            raise ValueError(
                f"{parameter_path}: {name}: source = {source!r}, state where the value comes from"
            )
        values[name], origins[name], sources[name] = entry.get("value"), str(entry["kind"]), source
    return values, origins, sources


def _read_ranges(
    parameter_path: Path, declared_fields: Mapping[str, Field[Any]], toml_sections: Mapping[str, Any]
) -> dict[str, tuple[float, float]]:
    """Read {structured name: (smallest, largest value)} of the entries that state a range.

    Raises ValueError, one line, if the range does not contain the value or is outside the field's interval.
    """
    ranges: dict[str, tuple[float, float]] = {}
    for name, entry in list_entries(toml_sections):
        if "range" not in entry:
            continue
        ends, value = entry["range"], entry.get("value")
        numbers = isinstance(ends, list) and len(ends) == 2 and all(type(x) in (int, float) for x in ends)
        if not numbers or type(value) not in (int, float) or not ends[0] <= value <= ends[1] > ends[0]:
            raise ValueError(
                f"{parameter_path}: {name}: range = {ends!r}, expected [LOW, HIGH] around {value!r}"
            )
        for text in (find_problem(name, float(end), declared_fields[name]) for end in ends):
            if text:
                raise ValueError(f"{parameter_path}: range of {text}")
        ranges[name] = (float(ends[0]), float(ends[1]))
    return ranges


def list_entries(toml_sections: Mapping[str, object], name_prefix: str = "") -> list[tuple[str, Any]]:
    """List (structured name, entry) of each innermost item of the nested tables of a parameter file.

    Innermost items are tables with a key `value`, empty tables and all items that are no table.
    """
    items: list[tuple[str, Any]] = []
    for key, value in toml_sections.items():
        if isinstance(value, Mapping) and value and "value" not in value:
            items += list_entries(value, f"{name_prefix}{key}.")
        else:
            items.append((name_prefix + key, value))
    return items


def _input_fields(joint_name: str) -> dict[str, Field[Any]]:
    """Declared fields {`inputs.NAME`: field} of the inputs of all models of a joint."""
    inputs = (v for model in KINDS[joint_name].models for v in model.inputs)
    return {_INPUTS_SECTION_PREFIX + v.name: quantity_field(v.unit, v.doc, ge=v.minimum) for v in inputs}


def _heights_prefix(cls: type) -> str:
    """Prefix of surface heights in a file: `roughness.` if the law depends on them, else `comparison.`."""
    return (
        _ROUGHNESS_SECTION_PREFIX
        if any(is_combined_height(name) for name, _ in flatten_fields(cls))
        else _COMPARISON_SECTION_PREFIX
    )


def is_combined_height(parameter_name: str) -> bool:
    """Whether a parameter of a law is the combined rms height h of both surfaces."""
    return parameter_name.split(".")[-1] == "h" and not parameter_name.startswith(
        (_ROUGHNESS_SECTION_PREFIX, _COMPARISON_SECTION_PREFIX)
    )


def _roughness_fields(name_prefix: str) -> dict[str, Field[Any]]:
    """Declared fields {name_prefix + name: field} of the roughness heights that a file may state."""
    return {name_prefix + name: item for name, item in roughness.HEIGHT_FIELDS.items()}


def _pop_section(values_by_name: dict[str, Any], section_prefix: str) -> dict[str, Any]:
    """Remove the entries of a file section from {structured name: value}, and return them.

    Returns {name in the section: value}.
    """
    return {
        n.removeprefix(section_prefix): values_by_name.pop(n)
        for n in list(values_by_name)
        if n.startswith(section_prefix)
    }


def _check_start_values(joint_name: str, start_values: Mapping[str, Any]) -> dict[str, float]:
    """Check start values, {input: value}; return them as floats.

    Raises ValueError, one line, naming every unknown name and every value outside its interval.
    """
    named = {_INPUTS_SECTION_PREFIX + name: value for name, value in start_values.items()}
    if texts := find_problems(named, _input_fields(joint_name)):
        raise ValueError("; ".join(texts))
    return {name: float(value) for name, value in start_values.items()}


def format_parameter_file(parameter_file: ParameterFile) -> str:
    """Text of a parameter file (TOML), with the heights of the surfaces and the start values of inputs."""
    declared = dict(flatten_fields(type(parameter_file.values))) | _roughness_fields(
        parameter_file.heights_prefix
    )
    values = sorted(parameter_file.values_by_name.items(), key=lambda item: "." in item[0])
    values += [
        (parameter_file.heights_prefix + name, value) for name, value in parameter_file.roughness.items()
    ]
    if parameter_file.inputs:
        declared |= _input_fields(parameter_file.joint)
        values += [(_INPUTS_SECTION_PREFIX + name, value) for name, value in parameter_file.inputs.items()]
    lines = [f"schema = {SCHEMA_VERSION}", f'joint = "{parameter_file.joint}"']
    if parameter_file.joint in KINDS:  # else a partner of a joint
        lines.append(f'law = "{parameter_file.law}"')
    lines.append(f"name = {format_toml_string(parameter_file.name)}")
    section = ""
    for name, value in values:
        if value == ():  # not stated
            continue
        head, _, leaf = name.rpartition(".")
        if head != section:
            lines += ["", f"[{head}]"]
            section = head
        unit = declared[name].metadata.get("unit")
        fields = [f"value = {_format_toml(value)}", *([f'unit = "{unit}"'] if unit else [])]
        if name in parameter_file.ranges:
            fields += [f"range = [{', '.join(map(repr, parameter_file.ranges[name]))}]"]
        kind, source = parameter_file.describe_source(name)
        fields += [f'kind = "{kind}"', f"source = {format_toml_string(source)}"]
        lines.append(f"{leaf} = {{ {', '.join(fields)} }}")
    return "\n".join(lines) + "\n"


def _format_toml(toml_value: Any) -> str:
    """Format a value as TOML: number, text, boolean or list."""
    if isinstance(toml_value, bool):
        return str(toml_value).lower()
    if isinstance(toml_value, tuple):
        rows = [
            ", ".join(map(repr, toml_value[i : i + _NUMBERS_PER_LINE]))
            for i in range(0, len(toml_value), _NUMBERS_PER_LINE)
        ]
        return "[\n  " + ",\n  ".join(rows) + ",\n]"
    return format_toml_string(toml_value) if isinstance(toml_value, str) else repr(float(toml_value))


def load_default(joint_name: str, law_name: str | None = None) -> ParameterFile:
    """Read the default parameter file of a joint with an interface law; None: the joint's first law."""
    return load_parameter_file(KINDS[joint_name].default_file(law_name), joint_name)
