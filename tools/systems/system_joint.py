"""The parameters of a joint that a section of a system's file names."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_parameter_file

from ..joint_parts import load_tool_module

KEYS = {"parameters", "catalogue"}
"""Entries that name them: a parameter file beside the system's, or the joint's name in its catalogue."""


def joint_file(folder: Path, name: str, joint: str, section: Mapping[str, Any]) -> ParameterFile | None:
    """The parameters that the section `name` gives a joint of a kind; None: those of its model.

    folder : of the system's file

    Raises ValueError with one line that names the entry and what is allowed.
    """
    given = {key: value for key, value in section.items() if key in KEYS}
    if len(given) > 1:
        raise ValueError(f"{name} has {' and '.join(sorted(given))}, allowed is one of them")
    for key, value in given.items():
        if not isinstance(value, str):
            raise ValueError(f"{name}.{key} = {value!r}, expected a text")
    if "catalogue" in given:
        return _bought(name, joint, given["catalogue"])
    return load_parameter_file(folder / given["parameters"], joint) if given else None


def _bought(name: str, joint: str, wanted: str) -> ParameterFile:
    """As `jointfmu new` makes it."""
    found = load_tool_module(KINDS[joint], "new")
    if found is None or "catalogue" not in {option.name for option in found.NEW.options}:
        raise ValueError(f"{name}.catalogue = {wanted!r}, expected none of a {joint}: it has no catalogue")
    try:
        return _catalogue_file(joint, wanted)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


@cache
def _catalogue_file(joint: str, wanted: str) -> ParameterFile:
    """Parameters of a joint in its catalogue; an arm asks for them twice, for the ratio first."""
    found = load_tool_module(KINDS[joint], "new")
    assert found is not None
    options = {option.name: None for option in found.NEW.options} | {"catalogue": wanted}
    file = found.NEW.make_joint(options).file
    assert isinstance(file, ParameterFile)
    return file
