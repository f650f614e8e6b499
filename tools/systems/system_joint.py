"""Parameter file of a joint, as named in a section of a system file."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_parameter_file

from ..common.joint_parts import load_tool_module

PARAMETER_FILE_KEYS = {"parameters", "catalogue"}
"""Entries that select a parameter file: a path relative to the system file, or a name in the catalogue."""


def load_joint_file(
    system_folder: Path, section_name: str, joint_kind: str, component_section: Mapping[str, Any]
) -> ParameterFile | None:
    """Load the parameter file that a section of a system file names for a joint.

    None : the section names no file.

    system_folder : folder of the system file
    joint_kind    : kind of joint

    Raises ValueError with one line that names the entry and what is allowed.
    """
    entries = {key: value for key, value in component_section.items() if key in PARAMETER_FILE_KEYS}
    if len(entries) > 1:
        raise ValueError(f"{section_name} has {' and '.join(sorted(entries))}, state one of them")
    for key, value in entries.items():
        if not isinstance(value, str):
            raise ValueError(f"{section_name}.{key} = {value!r}, expected a text")
    if "catalogue" in entries:
        return _make_catalogue_item(section_name, joint_kind, entries["catalogue"])
    return load_parameter_file(system_folder / entries["parameters"], joint_kind) if entries else None


def _make_catalogue_item(section_name: str, joint_kind: str, catalogue_item_name: str) -> ParameterFile:
    """Make the parameter file of the catalogue item that a section of the system file names.

    The file is that of `jointfmu new`. Raises ValueError if the item is unknown.
    """
    tool_module = load_tool_module(KINDS[joint_kind], "new")
    if tool_module is None or "catalogue" not in {
        option.name for option in tool_module.NEW_JOINT_COMMAND.command_options
    }:
        raise ValueError(
            f"{section_name}.catalogue = {catalogue_item_name!r}, but a {joint_kind} has no catalogue; "
            "remove the entry"
        )
    try:
        return _make_catalogue_file(joint_kind, catalogue_item_name)
    except ValueError as error:
        raise ValueError(f"{section_name}: {error}") from None


@cache
def _make_catalogue_file(joint_kind: str, catalogue_item_name: str) -> ParameterFile:
    """Make the parameter file of a catalogue item; cached, as an arm needs it twice (first for its ratio)."""
    tool_module = load_tool_module(KINDS[joint_kind], "new")
    assert tool_module is not None
    options = {option.name: None for option in tool_module.NEW_JOINT_COMMAND.command_options}
    file = tool_module.NEW_JOINT_COMMAND.make_joint(
        options | {"catalogue": catalogue_item_name}
    ).parameter_file
    assert isinstance(file, ParameterFile)
    return file
