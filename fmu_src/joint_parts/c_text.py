"""Numbers, texts and arrays as C writes them."""

import math
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
    """A string literal."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
