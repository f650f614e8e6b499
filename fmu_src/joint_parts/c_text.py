"""C source text of numbers, strings, comments and arrays."""

import math
import re
from collections.abc import Iterable


def format_array_definition(array_declaration: str, array_row_texts: Iterable[str]) -> str:
    """Format the definition of a C array with one row per line.

    array_declaration : C type, name and sizes
    """
    return f"{array_declaration} = {{\n" + "".join(f"    {row},\n" for row in array_row_texts) + "};\n"


def format_double_literal(real_number: float) -> str:
    """Format a double as a C literal, exact to the last bit."""
    if math.isinf(real_number):
        return "INFINITY" if real_number > 0 else "-INFINITY"
    return repr(float(real_number))


def format_string_literal(unescaped_text: str) -> str:
    """Format a text as a C string literal in ASCII without trigraphs.

    Other characters are octal escapes of their UTF-8 bytes.
    """
    return (
        '"'
        + re.sub(rb'[^ -~]|["\\]|(?<=\?)\?', _escape_literal_byte, unescaped_text.encode()).decode("ascii")
        + '"'
    )


def escape_c_comment(comment_text: str) -> str:
    """Escape a text for a C comment: printable ASCII without comment delimiters and trigraphs."""
    plain = re.sub(r"[^ -~]", "?", comment_text)
    return re.sub(r"\*(?=/)|/(?=\*)|\?(?=\?)", r"\g<0> ", plain)


def _escape_literal_byte(character_match: re.Match[bytes]) -> bytes:
    """Escape one byte of a C string literal: a backslash before quotes, an octal number for others."""
    character = character_match[0]
    return b"\\" + character if character in b'"\\?' else b"\\%03o" % ord(character)
