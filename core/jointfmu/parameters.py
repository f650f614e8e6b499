"""TOML files <-> parameter sets: the only reader and writer of models/*.toml.

A file is `schema = 1`, `joint = KIND`, `law = LAW` (absent: the joint's first one), `name = ...` and one
entry per parameter,

    [surface]
    D = { value = 1.42, unit = "1", kind = "published", source = "Zhao 2018, section 2" }

`kind` is one of ORIGINS; the unit must be the SI unit that the code declares, nothing is converted.
A section `[inputs]` of the same form gives start values of the joint's inputs; others start at their own.
A section `[roughness]` states what is known of the surfaces, see `roughness`: a law with a height takes it
from there. Another law has none; there `[comparison]` states the same, and the level is judged by it.
"""

import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import Field, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

from .contact import roughness
from .files.reading import read_bytes
from .files.text import MAX_NAME_LENGTH, check_document, check_text, toml_string
from .joints import KINDS
from .quantity import build, changed, flat_fields, flatten, problem, problems, quantity

T = TypeVar("T")

SCHEMA = 1
ORIGINS = ("published", "derived", "catalogue", "estimate", "calibration", "user")
"""Where a value comes from: printed in the paper, computed from printed values, a catalogue,
an engineering estimate, fitted to calibration points, or set by the user."""
_PER_LINE = 5
"""Numbers of a list on a line."""
_INPUTS = "inputs."
"""Prefix of the names of start values."""
SAME_HEIGHT = 0.01
"""How far h of a law may be from what the roughnesses beside it make [1]: they are printed in two digits."""
_ACTS, _JUDGES = "roughness.", "comparison."
"""Prefixes of the names of roughnesses: beside a law with a height, and beside another."""


@dataclass(frozen=True, slots=True)
class ParameterFile:
    """A parameter set with where it comes from.

    joint   : a key of joints.KINDS
    name    : of this parameter set; it and the sources are lines that `check_text` allows, else ValueError
    values  : the parameter set, an instance of a value of KINDS[joint].laws
    origins, sources : {structured name: one of ORIGINS, text}, also of `inputs.NAME`, `roughness.NAME` or
        `comparison.NAME`
    inputs  : {input: start value in its SI unit}, where it is given
    roughness : {name: height [m]} of the surfaces, where it is known: names of `roughness.DECLARED`
    ranges  : {structured name: least and greatest value} of what is known no better, by the same source
    flat    : {structured name: value} of `values`, opened once
    """

    joint: str
    name: str
    values: Any
    origins: Mapping[str, str]
    sources: Mapping[str, str]
    inputs: Mapping[str, float] = field(default_factory=dict)
    roughness: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    flat: Mapping[str, Any] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_text("name", self.name, MAX_NAME_LENGTH)
        for name, text in self.sources.items():
            check_text(f"{name}: source", text)
        object.__setattr__(self, "flat", flatten(self.values))

    @property
    def law(self) -> str:
        """Name of its interface law."""
        return KINDS[self.joint].law(self.values)

    @property
    def surfaces(self) -> str:
        """Prefix of the names of its roughnesses."""
        return _prefix(type(self.values))

    def start(self, name: str) -> float:
        """Start value of an input, in its SI unit: the joint's own unless it is given."""
        own = KINDS[self.joint].variables.get(name) if self.joint in KINDS else None
        return self.inputs.get(name, own.start if own else 0.0)

    def with_values(self, changes: Mapping[str, object], origin: str, source: str) -> "ParameterFile":
        """The same file with some values changed; names and intervals are checked.

        A height of the law stands in place of the roughnesses that made it.
        """
        gone = {*self.roughness} if any(map(is_height, changes)) else set[str]()
        texts = {self.surfaces + name for name in gone}
        return replace(
            self,
            values=changed(self.values, changes),
            origins=_without(texts, self.origins) | dict.fromkeys(changes, origin),
            sources=_without(texts, self.sources) | dict.fromkeys(changes, source),
            roughness=_without(gone, self.roughness),
            ranges=_without(changes, self.ranges),
        )

    def with_roughness(self, stated: Mapping[str, float], origin: str, source: str) -> "ParameterFile":
        """The same file with heights [m] of the surfaces; what spoke of the same side is replaced, and the
        height of a law is that of all of them.

        Raises ValueError as `roughness.check`.
        """
        heights = roughness.check(stated, self.surfaces)
        gone = {other for name in heights for other in roughness.excluded(name)}
        texts = {self.surfaces + name for name in gone}
        names = [self.surfaces + name for name in heights]
        known = _without(gone, self.roughness) | heights
        origins = _without(texts, self.origins) | dict.fromkeys(names, origin)
        sources = _without(texts, self.sources) | dict.fromkeys(names, source)
        of_law = {name: roughness.height(known) for name in self.flat if is_height(name)}
        return replace(
            self,
            values=changed(self.values, of_law),
            roughness=known,
            origins=origins | dict.fromkeys(of_law, "derived"),
            sources=sources | dict.fromkeys(of_law, _made_of(self.surfaces, known, sources)),
            ranges=_without(of_law, self.ranges),
        )


def load(path: str | Path, joint: str | None = None) -> ParameterFile:
    """Read and check a parameter file.

    Raises ValueError with one line that names the file, the entry, its value and what is allowed:
    a missing or broken file, another joint's file, an unknown or missing name, a foreign unit, a
    value of the wrong type or outside its interval, one that contradicts another; the same for the start
    values of inputs.
    """
    path = Path(path)
    document = read_document(path, "a parameter file")
    stated = document.get("joint")
    if not isinstance(stated, str) or stated not in KINDS:
        raise ValueError(f"{path}: joint = {stated!r}, allowed are {', '.join(KINDS)}")
    if joint is not None and stated != joint:
        raise ValueError(f"{path}: joint = {stated!r}, expected a parameter file of a {joint!r}")
    laws = KINDS[stated].laws
    law = document.get("law", next(iter(laws)))
    if not isinstance(law, str) or law not in laws:
        raise ValueError(f"{path}: law = {law!r}, allowed are {', '.join(laws)}")
    body = {k: v for k, v in document.items() if k not in ("schema", "joint", "law", "name")}
    cls = laws[law]
    prefix = _prefix(cls)
    if prefix == _JUDGES and _ACTS[:-1] in body:
        raise ValueError(
            f"{path}: [roughness] does not act on law = {law!r}; allowed are [roughness] beside a law with a "
            "height, and [comparison] for what the level is judged by"
        )
    declared = declared_entries(stated, cls)
    keys = ("value", "unit", "kind", "source", "range")
    values, origins, sources = entries(path, declared, body, keys)
    given, surfaces = _section(values, _INPUTS), _section(values, prefix)
    try:
        inputs, heights = _start_values(stated, given), roughness.check(surfaces, prefix)
        of_law = _height_of_law(declared, values, heights)
        parameters = build(cls, values | of_law)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    for text in KINDS[stated].contradictions(parameters):
        raise ValueError(f"{path}: {text}")
    name = str(document.get("name", path.stem))
    origins |= dict.fromkeys(of_law, "derived")
    sources |= dict.fromkeys(of_law, _made_of(prefix, heights, sources))
    return ParameterFile(
        stated, name, parameters, origins, sources, inputs, heights, _ranges(path, declared, body)
    )


def declared_entries(joint: str, cls: type) -> dict[str, Field[Any]]:
    """{structured name: field} of every entry that a parameter file with the parameter set `cls` may have."""
    return dict(flat_fields(cls)) | _input_fields(joint) | _roughness_fields(_prefix(cls))


def _without(gone: Collection[str], named: Mapping[str, T]) -> dict[str, T]:
    return {name: value for name, value in named.items() if name not in gone}


def _made_of(prefix: str, heights: Iterable[str], sources: Mapping[str, str]) -> str:
    """Source of the height of a law that comes from those of the surfaces."""
    names = [prefix + height for height in heights]
    return f"from {', '.join(names)}: {'; '.join(dict.fromkeys(sources[name] for name in names))}"


def _height_of_law(
    declared: Mapping[str, object], values: Mapping[str, Any], heights: Mapping[str, float]
) -> dict[str, float]:
    """{name: h [m]} of the law that takes one, where the file states it by its roughnesses alone.

    Raises ValueError if it states another h beside them.
    """
    stated = roughness.height(heights)
    name = next((name for name in declared if is_height(name)), None)
    if stated is None or name is None:
        return {}
    if name not in values:
        return {name: stated}
    if not abs(values[name] / stated - 1.0) <= SAME_HEIGHT:
        makers = ", ".join(_ACTS + height for height in heights)
        raise ValueError(
            f"{name} = {values[name]:g} m beside {makers}, which make {stated:.4g} m: expected one of them, "
            f"or both within {SAME_HEIGHT:.1%}"
        )
    return {}


def read_document(path: Path, expected: str) -> dict[str, Any]:
    """A TOML document of our schema; `expected` names what it should be.

    Raises ValueError with one line if the file cannot be read, is no TOML or of another schema, or if a key
    or a text is too long or has control characters.
    """
    try:
        document = tomllib.loads(read_bytes(path, expected).decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text file; expected {expected} (TOML, UTF-8)") from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{path}: is no valid TOML ({error})") from None
    try:
        check_document(document)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if type(document.get("schema")) is not int or document["schema"] != SCHEMA:
        raise ValueError(f"{path}: schema = {document.get('schema')!r}, allowed is {SCHEMA}")
    return document


def entries(
    path: Path,
    declared: Mapping[str, Field[Any]],
    body: Mapping[str, object],
    keys: tuple[str, ...] = ("value", "unit", "kind", "source"),
) -> tuple[dict[str, Any], dict[str, str], dict[str, str]]:
    """Values, origins and sources by structured name; every unit checked against the field `declared`."""
    values: dict[str, Any] = {}
    origins: dict[str, str] = {}
    sources: dict[str, str] = {}
    for name, entry in leaves(body):
        if not isinstance(entry, Mapping):
            raise ValueError(f"{path}: {name} = {entry!r}, expected a table {{ value, unit, kind, source }}")
        if unknown := set(entry) - set(keys):
            raise ValueError(
                f"{path}: {name} has an unknown key {sorted(unknown)[0]!r}, allowed are {', '.join(keys)}"
            )
        if name in declared:
            unit = declared[name].metadata.get("unit")
            if entry.get("unit") != unit:
                raise ValueError(f"{path}: {name}: unit {entry.get('unit')!r}, expected {unit!r}")
        if entry.get("kind") not in ORIGINS:
            raise ValueError(
                f"{path}: {name}: kind = {entry.get('kind')!r}, allowed are {', '.join(ORIGINS)}"
            )
        source = entry.get("source")
        if not isinstance(source, str) or not source.strip():
            raise ValueError(f"{path}: {name}: source = {source!r}, expected where the value comes from")
        values[name], origins[name], sources[name] = entry.get("value"), str(entry["kind"]), source
    return values, origins, sources


def _ranges(
    path: Path, declared: Mapping[str, Field[Any]], body: Mapping[str, Any]
) -> dict[str, tuple[float, float]]:
    """{structured name: least and greatest value} of the parameters whose entries state a range."""
    found: dict[str, tuple[float, float]] = {}
    for name, entry in leaves(body):
        if "range" not in entry:
            continue
        ends, value = entry["range"], entry.get("value")
        numbers = isinstance(ends, list) and len(ends) == 2 and all(type(x) in (int, float) for x in ends)
        if not numbers or type(value) not in (int, float) or not ends[0] <= value <= ends[1] > ends[0]:
            raise ValueError(f"{path}: {name}: range = {ends!r}, expected [LOW, HIGH] around {value!r}")
        for text in (problem(name, float(end), declared[name]) for end in ends):
            if text:
                raise ValueError(f"{path}: range of {text}")
        found[name] = (float(ends[0]), float(ends[1]))
    return found


def leaves(table: Mapping[str, object], prefix: str = "") -> list[tuple[str, Any]]:
    """Entries by structured name: those with a value, and whatever is no table."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        if isinstance(value, Mapping) and value and "value" not in value:
            found += leaves(value, f"{prefix}{key}.")
        else:
            found.append((prefix + key, value))
    return found


def _input_fields(joint: str) -> dict[str, Field[Any]]:
    """Fields of the inputs of all models of a joint, named as their start values."""
    inputs = (v for model in KINDS[joint].models for v in model.inputs)
    return {_INPUTS + v.name: quantity(v.unit, v.doc, ge=v.low) for v in inputs}


def _prefix(cls: type) -> str:
    """Of the names of roughnesses beside a parameter set of a class."""
    return _ACTS if any(is_height(name) for name, _ in flat_fields(cls)) else _JUDGES


def is_height(name: str) -> bool:
    """Whether a parameter is the rms height of both surfaces."""
    return name.split(".")[-1] == "h" and not name.startswith((_ACTS, _JUDGES))


def _roughness_fields(prefix: str) -> dict[str, Field[Any]]:
    """Fields of the roughnesses, named as in a parameter file."""
    return {prefix + name: item for name, item in roughness.DECLARED.items()}


def _section(values: dict[str, Any], prefix: str) -> dict[str, Any]:
    """What stands in a section, taken out of values by structured name: {name in the section: value}."""
    return {n.removeprefix(prefix): values.pop(n) for n in list(values) if n.startswith(prefix)}


def _start_values(joint: str, given: Mapping[str, Any]) -> dict[str, float]:
    """{input: start value}, checked.

    Raises ValueError, one line, naming every unknown name and every value outside its interval.
    """
    named = {_INPUTS + name: value for name, value in given.items()}
    if texts := problems(named, _input_fields(joint)):
        raise ValueError("; ".join(texts))
    return {name: float(value) for name, value in given.items()}


def dump(parameters: ParameterFile) -> str:
    """The parameter set, with roughnesses and the start values of inputs, as the text of a parameter file."""
    declared = dict(flat_fields(type(parameters.values))) | _roughness_fields(parameters.surfaces)
    values = sorted(parameters.flat.items(), key=lambda item: "." in item[0])
    values += [(parameters.surfaces + name, value) for name, value in parameters.roughness.items()]
    if parameters.inputs:
        declared |= _input_fields(parameters.joint)
        values += [(_INPUTS + name, value) for name, value in parameters.inputs.items()]
    lines = [f"schema = {SCHEMA}", f'joint = "{parameters.joint}"']
    if parameters.joint in KINDS:  # else a partner of a joint
        lines.append(f'law = "{parameters.law}"')
    lines.append(f"name = {toml_string(parameters.name)}")
    section = ""
    for name, value in values:
        if value == ():  # not stated
            continue
        head, _, leaf = name.rpartition(".")
        if head != section:
            lines += ["", f"[{head}]"]
            section = head
        unit = declared[name].metadata.get("unit")
        fields = [f"value = {_toml(value)}", *([f'unit = "{unit}"'] if unit else [])]
        if name in parameters.ranges:
            fields += [f"range = [{', '.join(map(repr, parameters.ranges[name]))}]"]
        fields += [f'kind = "{parameters.origins.get(name, "user")}"']
        fields += [f"source = {toml_string(parameters.sources.get(name, 'default choice'))}"]
        lines.append(f"{leaf} = {{ {', '.join(fields)} }}")
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        rows = [", ".join(map(repr, value[i : i + _PER_LINE])) for i in range(0, len(value), _PER_LINE)]
        return "[\n  " + ",\n  ".join(rows) + ",\n]"
    return toml_string(value) if isinstance(value, str) else repr(float(value))


def default(joint: str, law: str | None = None) -> ParameterFile:
    """The default parameter set of a joint, shipped with the package; with its first law, or another."""
    return load(KINDS[joint].default_file(law), joint)
