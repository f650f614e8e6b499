"""The name that a user gives an FMU: FMI's model identifier, which names files and, in C, functions."""

import re
from keyword import iskeyword

LONGEST = 63
"""Letters of a name [1]; what C tells apart everywhere."""


def checked_name(name: str) -> str:
    """The name.

    Raises ValueError if it is no identifier of C and Python, or too long.
    """
    allowed = f"allowed are at most {LONGEST} letters, digits and _, no digit first, no word of C or Python"
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) or len(name) > LONGEST or reserved(name):
        shown = name if len(name) <= 80 else f"{name[:77]}..."
        raise ValueError(f"name {shown!r} is no model identifier, {allowed}")
    return name


def reserved(name: str) -> bool:
    """Whether a language keeps the name for itself."""
    return iskeyword(name) or name in _C


_WORDS = """auto break case char const continue default do double else enum extern float for goto if
inline int long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while"""
_C = frozenset(_WORDS.split())
