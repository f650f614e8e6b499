"""Valid names of FMUs and components, which become file names, C functions and Modelica classes."""

import re
from keyword import iskeyword

MAX_FMU_NAME_LENGTH = 63
"""Largest length of a name [1]: C compilers need not distinguish more characters."""
FMU_NAME_RULE = (
    f"at most {MAX_FMU_NAME_LENGTH} letters, digits and _, no digit first, no word of C, Python or Modelica, "
    "no device of Windows (con, nul, com1)"
)
"""Rule for valid names, as error messages print it."""


def check_fmu_name(fmu_name: str) -> str:
    """Return the name of an FMU if it is valid, see `is_valid_fmu_name`.

    Raises ValueError if it is not valid.
    """
    if not is_valid_fmu_name(fmu_name):
        shown = fmu_name if len(fmu_name) <= 80 else f"{fmu_name[:77]}..."
        raise ValueError(f"name {shown!r} is not a model identifier, allowed are {FMU_NAME_RULE}")
    return fmu_name


def is_valid_fmu_name(candidate_name: str) -> bool:
    """Whether a name of an FMU is valid in C, Python, Modelica and Windows, and not too long."""
    return (
        bool(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", candidate_name))
        and len(candidate_name) <= MAX_FMU_NAME_LENGTH
        and not is_reserved_word(candidate_name)
    )


def is_reserved_word(candidate_name: str) -> bool:
    """Whether a name is a keyword of C, Python or Modelica, or a device name of Windows."""
    return (
        iskeyword(candidate_name)
        or candidate_name in _C_KEYWORDS
        or candidate_name in _MODELICA_KEYWORDS
        or candidate_name.lower() in _WINDOWS_DEVICE_NAMES
    )


_C_KEYWORD_LIST_TEXT = """auto break case char const continue default do double else enum extern float for
goto if inline int long register restrict return short signed sizeof static struct switch typedef union
unsigned void volatile while"""
_C_KEYWORDS = frozenset(_C_KEYWORD_LIST_TEXT.split())
"""Keywords of C, which are no valid names."""
_MODELICA_KEYWORD_TEXT = """algorithm and annotation block break class connect connector constant
constrainedby der discrete each else elseif elsewhen encapsulated end enumeration equation expandable extends
external false final flow for function if import impure in initial inner input loop model not operator or
outer output package parameter partial protected public pure record redeclare replaceable return stream then
time true type when while within"""
_MODELICA_KEYWORDS = frozenset(_MODELICA_KEYWORD_TEXT.split())
"""Keywords of Modelica, which are no valid names."""
_WINDOWS_DEVICE_NAMES = frozenset(
    ["con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(10))]
)
"""Names of devices on Windows, which are no valid file names."""
