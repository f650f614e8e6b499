"""Conversion of names of drives to valid names of plugins and files."""

import re
from collections.abc import Mapping

from jointfmu_fmu_src.naming import is_reserved_word

from jointfmu.parameters import ParameterFile, format_parameter_file


def make_identifier(original_name: str) -> str:
    """Convert a name to an identifier of letters, digits and _.

    It is no keyword of a programming language, and no file name that Windows reserves (CON, NUL).
    """
    return re.sub(
        r"\W",
        "_",
        f"_{original_name}"
        if not original_name[:1].isalpha() or is_reserved_word(original_name)
        else original_name,
        flags=re.ASCII,
    )


def check_plugin_names(drive_files: Mapping[str, ParameterFile]) -> None:
    """Raise ValueError if two drives have the same name but different parameters: one name is one plugin.

    drive_files : {joint: parameter file of its drive}
    """
    first: dict[str, tuple[str, ParameterFile]] = {}
    for joint, file in drive_files.items():
        other, known = first.setdefault(make_identifier(file.name), (joint, file))
        if format_parameter_file(known) != format_parameter_file(file):
            raise ValueError(
                f"the drives of {other} and {joint} are both named {file.name!r} but differ; "
                "change the name in one of their files"
            )
