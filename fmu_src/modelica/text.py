"""Numbers and texts as Modelica writes them."""

import re

import numpy as np
from numpy.typing import NDArray


def number(value: float) -> str:
    """A number, to 15 digits."""
    return f"{value + 0.0:.15g}"


def matrix(rows: NDArray[np.float64]) -> str:
    """A matrix, one row per line."""
    return "[\n      " + ";\n      ".join(", ".join(number(x) for x in row) for row in rows) + "]"


def text(content: str) -> str:
    """The inside of a Modelica string."""
    return content.replace("\\", "\\\\").replace('"', '\\"')


def identifier(name: str) -> str:
    """A Modelica identifier of a title."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return words[0].upper() + words[1:] if words[:1].isalpha() else f"Joint_{words}"
