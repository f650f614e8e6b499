"""Numbers and texts as Modelica writes them, and the templates that they go to."""

import re
from pathlib import Path

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from numpy.typing import NDArray

GIVEN, COMPUTED = 15, 10
"""Digits of numbers that a file gives, and of those computed from them: later digits depend on the
processor, and the tables err by 1e-7."""


def number(value: float, digits: int = GIVEN) -> str:
    """A number, or a Boolean."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value + 0.0:.{digits}g}"


def matrix(rows: NDArray[np.float64]) -> str:
    """A matrix of computed numbers, one row per line."""
    lines = (", ".join(number(x, COMPUTED) for x in row) for row in rows)
    return "[\n      " + ";\n      ".join(lines) + "]"


def text(content: str) -> str:
    """The inside of a Modelica string."""
    return content.replace("\\", "\\\\").replace('"', '\\"')


def identifier(name: str) -> str:
    """A Modelica identifier of a title."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return words[0].upper() + words[1:] if words[:1].isalpha() else f"Joint_{words}"


def environment(*folders: Path) -> Environment:
    """Templates of the folders, then those of the library; an unknown name is an error."""
    return Environment(
        loader=FileSystemLoader([*folders, Path(__file__).parent / "templates"]),
        undefined=StrictUndefined,
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        comment_start_string="<#",
        comment_end_string="#>",
        keep_trailing_newline=True,
        autoescape=False,
    )
