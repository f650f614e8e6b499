"""Names that users give FMUs and components: they name files, functions in C and classes in Modelica."""

import re
from keyword import iskeyword

LONGEST = 63
"""Letters of a name [1]; what C tells apart everywhere."""
ALLOWED = (
    f"at most {LONGEST} letters, digits and _, no digit first, no word of C, Python or Modelica, no device "
    "of Windows (con, nul, com1)"
)
"""Names that are allowed, for errors."""


def checked_name(name: str) -> str:
    """The name.

    Raises ValueError if `is_identifier` says no.
    """
    if not is_identifier(name):
        shown = name if len(name) <= 80 else f"{name[:77]}..."
        raise ValueError(f"name {shown!r} is no model identifier, allowed are {ALLOWED}")
    return name


def is_identifier(name: str) -> bool:
    """Whether C, Python, Modelica and Windows all take the name, and it is not too long."""
    return bool(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name)) and len(name) <= LONGEST and not reserved(name)


def reserved(name: str) -> bool:
    """Whether a language, or Windows for a device, keeps the name for itself."""
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
