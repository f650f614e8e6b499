"""Valid names of FMUs and components, which become file names, C functions and Modelica classes."""

import re
from keyword import iskeyword

LONGEST = 63
"""Largest length of a name [1]: C compilers need not distinguish more characters."""
NAME_RULE = (
    f"at most {LONGEST} letters, digits and _, no digit first, no word of C, Python or Modelica, no device "
    "of Windows (con, nul, com1)"
)
"""Rule for valid names, as error messages print it."""


def checked_name(name: str) -> str:
    """Return the name if it is a valid identifier.

    Raises ValueError if it is not, see `is_identifier`.
    """
    if not is_identifier(name):
        shown = name if len(name) <= 80 else f"{name[:77]}..."
        raise ValueError(f"name {shown!r} is not a model identifier, allowed are {NAME_RULE}")
    return name


def is_identifier(name: str) -> bool:
    """Whether a name is valid in C, Python, Modelica and Windows, and not too long."""
    return bool(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name)) and len(name) <= LONGEST and not reserved(name)


def reserved(name: str) -> bool:
    """Whether a name is a keyword of C, Python or Modelica, or a device name of Windows."""
    return iskeyword(name) or name in _C or name in _MODELICA or name.lower() in _DEVICES


_WORDS = """auto break case char const continue default do double else enum extern float for goto if
inline int long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while"""
_C = frozenset(_WORDS.split())
_MODELICA_WORDS = """algorithm and annotation block break class connect connector constant constrainedby der
discrete each else elseif elsewhen encapsulated end enumeration equation expandable extends external false
final flow for function if import impure in initial inner input loop model not operator or outer
output package parameter partial protected public pure record redeclare replaceable return stream
then time true type when while within"""
_MODELICA = frozenset(_MODELICA_WORDS.split())
_DEVICES = frozenset(
    ["con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(10))]
)
