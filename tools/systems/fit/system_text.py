"""Text of a system file with new values. Comments of the original file are not kept."""

import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jointfmu.files.text import format_toml_string
from jointfmu.parameters import ParameterFile, read_document

_BARE_KEY_PATTERN = re.compile(r"[\w-]+", re.ASCII)
"""Pattern of a TOML key that needs no quotes."""


def format_fitted_system(
    path: Path, fitted_values: ParameterFile, fitted_units: Mapping[str, str], target_path: Path
) -> str:
    """Text of a system file with fitted values.

    path          : the original system file
    fitted_values : parameters of all components, with origins and sources
    fitted_units  : {COMPONENT.PARAMETER: SI unit} of the values to write; other names are states
    target_path   : file to write; paths of parameter files become relative to its folder

    Raises ValueError as `check_sections`.
    """
    document = check_sections(path, fitted_units)
    for section in document.values():
        _move_paths(section, path.parent, target_path.parent)
    for name in fitted_units.keys() & fitted_values.values_by_name.keys():
        component, _, parameter = name.partition(".")
        entries = document[component]
        *groups, leaf = parameter.split(".")
        for group in groups:
            entries = entries.setdefault(group, {})
        kind, source = fitted_values.describe_source(name)
        value = float(fitted_values.values_by_name[name])
        entries[leaf] = {"value": value, "unit": fitted_units[name], "kind": kind, "source": source}
    return _format_document(document)


def check_sections(path: Path, names: Iterable[str]) -> dict[str, Any]:
    """Read the document of a system file, which must have a section for each COMPONENT.PARAMETER.

    Raises ValueError for a component without its own section: those that a section [arm] makes.
    """
    document = read_document(path, "a system's file")
    for name in names:
        component = name.partition(".")[0]
        if component not in document:
            raise ValueError(
                f"{path}: has no section [{component}] for {name}, so no file can be written; "
                "expected a component with a section of its own"
            )
    return document


def _move_paths(section: Any, folder: Path, new_folder: Path) -> None:
    """Make paths of parameter files that are relative to `folder` relative to `new_folder`, in place."""
    if isinstance(section, dict):
        for key, value in section.items():
            if key == "parameters" and isinstance(value, str) and not Path(value).is_absolute():
                section[key] = Path(os.path.relpath(folder / value, new_folder)).as_posix()
            _move_paths(value, folder, new_folder)


def _format_document(document: Mapping[str, Any]) -> str:
    """TOML text of a document: values, then a section for each table, whose items have one line each."""
    values = {key: value for key, value in document.items() if not isinstance(value, dict)}
    lines = [f"{_format_key(key)} = {_format_value(value)}" for key, value in values.items()]
    for name, section in document.items():
        if name not in values:
            lines += ["", f"[{_format_key(name)}]"]
            lines += [f"{_format_key(key)} = {_format_value(value)}" for key, value in section.items()]
    return "\n".join(lines) + "\n"


def _format_key(key: str) -> str:
    """TOML text of a key, with quotes if it needs them."""
    return key if _BARE_KEY_PATTERN.fullmatch(key) else format_toml_string(key)


def _format_value(value: Any) -> str:
    """TOML text of a value on one line; tables and arrays may contain others."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return format_toml_string(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_format_value, value))}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_format_key(k)} = {_format_value(v)}' for k, v in value.items())} }}"
    return repr(value)
