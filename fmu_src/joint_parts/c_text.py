"""Numbers, texts and arrays as C writes them."""

import math
import re
from collections.abc import Iterable


def array(declaration: str, rows: Iterable[str]) -> str:
    """The definition of an array, one row per line."""
    return f"{declaration} = {{\n" + "".join(f"    {row},\n" for row in rows) + "};\n"


def number(value: float) -> str:
    """A double, exact to the last bit."""
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def string(text: str) -> str:
    """A string literal: plain ASCII without trigraphs; other characters as the bytes of UTF-8."""
    return '"' + re.sub(rb'[^ -~]|["\\]|(?<=\?)\?', _escaped, text.encode()).decode("ascii") + '"'


def comment(text: str) -> str:
    """A text inside a comment: printable ASCII that neither ends nor begins a comment."""
    plain = re.sub(r"[^ -~]", "?", text)
    return re.sub(r"\*(?=/)|/(?=\*)|\?(?=\?)", r"\g<0> ", plain)


def _escaped(found: re.Match[bytes]) -> bytes:
    character = found[0]
    return b"\\" + character if character in b'"\\?' else b"\\%03o" % ord(character)
