"""C source text of numbers, strings, comments and arrays."""

import math
import re
from collections.abc import Iterable


def format_array(declaration: str, row_texts: Iterable[str]) -> str:
    """Define a C array with one row per line."""
    return f"{declaration} = {{\n" + "".join(f"    {row},\n" for row in row_texts) + "};\n"


def format_number(value: float) -> str:
    """C literal of a double, exact to the last bit."""
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def format_string(text: str) -> str:
    """C string literal in ASCII without trigraphs; other characters as octal escapes of UTF-8 bytes."""
    return '"' + re.sub(rb'[^ -~]|["\\]|(?<=\?)\?', _escape_bytes, text.encode()).decode("ascii") + '"'


def escape_comment(text: str) -> str:
    """Text for the inside of a C comment: printable ASCII without comment delimiters and trigraphs."""
    plain = re.sub(r"[^ -~]", "?", text)
    return re.sub(r"\*(?=/)|/(?=\*)|\?(?=\?)", r"\g<0> ", plain)


def _escape_bytes(bytes_match: re.Match[bytes]) -> bytes:
    character = bytes_match[0]
    return b"\\" + character if character in b'"\\?' else b"\\%03o" % ord(character)
