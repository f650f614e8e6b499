"""C source text of numbers, strings, comments and arrays."""

import math
import re
from collections.abc import Iterable


def format_array(declaration: str, row_texts: Iterable[str]) -> str:
    """Format the definition of a C array with one row per line.

    declaration : C type, name and sizes
    """
    return f"{declaration} = {{\n" + "".join(f"    {row},\n" for row in row_texts) + "};\n"


def format_number(value: float) -> str:
    """Format a double as a C literal, exact to the last bit."""
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def format_string(text: str) -> str:
    """Format a text as a C string literal in ASCII without trigraphs.

    Other characters are octal escapes of their UTF-8 bytes.
    """
    return '"' + re.sub(rb'[^ -~]|["\\]|(?<=\?)\?', _escape_bytes, text.encode()).decode("ascii") + '"'


def escape_comment(text: str) -> str:
    """Escape a text for a C comment: printable ASCII without comment delimiters and trigraphs."""
    plain = re.sub(r"[^ -~]", "?", text)
    return re.sub(r"\*(?=/)|/(?=\*)|\?(?=\?)", r"\g<0> ", plain)


def _escape_bytes(bytes_match: re.Match[bytes]) -> bytes:
    """Escape one byte of a C string literal: a backslash before quotes, an octal number for others."""
    character = bytes_match[0]
    return b"\\" + character if character in b'"\\?' else b"\\%03o" % ord(character)
