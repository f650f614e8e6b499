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
    system_path: Path, fitted_values: ParameterFile, fitted_units: Mapping[str, str], target_path: Path
) -> str:
    """Text of a system file with fitted values.

    system_path   : the original system file
    fitted_values : parameters of all components, with origins and sources
    fitted_units  : {COMPONENT.PARAMETER: SI unit}; names that are no parameters are initial states and are
                    not written
    target_path   : file to write; paths of parameter files become relative to its folder

    Raises ValueError if a component with a fitted value has no section of its own in the file.
    """
    document = read_document_with_sections(system_path, fitted_units)
    for section in document.values():
        _rebase_parameter_file_paths(section, system_path.parent, target_path.parent)
    for name in fitted_units.keys() & fitted_values.values_by_name.keys():
        component, _, parameter = name.partition(".")
        entries = document[component]
        *groups, leaf = parameter.split(".")
        for group in groups:
            entries = entries.setdefault(group, {})
        kind, source = fitted_values.describe_source(name)
        value = float(fitted_values.values_by_name[name])
        entries[leaf] = {"value": value, "unit": fitted_units[name], "kind": kind, "source": source}
    return _format_toml_document(document)


def read_document_with_sections(system_path: Path, parameter_names: Iterable[str]) -> dict[str, Any]:
    """Read a system file (TOML) and check that the components of the given parameters have sections in it.

    parameter_names : names COMPONENT.PARAMETER

    Raises ValueError for a component without its own section, for example a link of a robot arm: the file
    declares all links in the one section [arm].
    """
    document = read_document(system_path, "a system's file")
    for name in parameter_names:
        component = name.partition(".")[0]
        if component not in document:
            raise ValueError(
                f"{system_path}: has no section [{component}] for {name}, so no file can be written; "
                "expected a component with a section of its own"
            )
    return document


def _rebase_parameter_file_paths(toml_section: Any, old_folder: Path, new_folder: Path) -> None:
    """Make paths of parameter files that are relative to `old_folder` relative to `new_folder`, in place."""
    if isinstance(toml_section, dict):
        for key, value in toml_section.items():
            if key == "parameters" and isinstance(value, str) and not Path(value).is_absolute():
                toml_section[key] = Path(os.path.relpath(old_folder / value, new_folder)).as_posix()
            _rebase_parameter_file_paths(value, old_folder, new_folder)


def _format_toml_document(toml_document: Mapping[str, Any]) -> str:
    """TOML text of a document: values, then a section for each table, whose items have one line each."""
    values = {key: value for key, value in toml_document.items() if not isinstance(value, dict)}
    lines = [f"{_format_toml_key(key)} = {_format_toml_value(value)}" for key, value in values.items()]
    for name, section in toml_document.items():
        if name not in values:
            lines += ["", f"[{_format_toml_key(name)}]"]
            lines += [
                f"{_format_toml_key(key)} = {_format_toml_value(value)}" for key, value in section.items()
            ]
    return "\n".join(lines) + "\n"


def _format_toml_key(toml_key: str) -> str:
    """TOML text of a key, with quotes if it needs them."""
    return toml_key if _BARE_KEY_PATTERN.fullmatch(toml_key) else format_toml_string(toml_key)


def _format_toml_value(toml_value: Any) -> str:
    """TOML text of a value on one line; tables and arrays may contain others."""
    if isinstance(toml_value, bool):
        return str(toml_value).lower()
    if isinstance(toml_value, str):
        return format_toml_string(toml_value)
    if isinstance(toml_value, list):
        return f"[{', '.join(map(_format_toml_value, toml_value))}]"
    if isinstance(toml_value, dict):
        items = (f"{_format_toml_key(k)} = {_format_toml_value(v)}" for k, v in toml_value.items())
        return f"{{ {', '.join(items)} }}"
    return repr(toml_value)
