"""Page on the public interface `import jointfmu`: signatures and help of Python."""

import inspect
import re
from functools import cached_property
from typing import Any

from jointfmu_tools.api.drive_joint import DriveJoint

import jointfmu

WIDTH = 90
"""Largest number of letters of a signature in one line."""
BREAK = ",\n    "
_LIST_ITEM_PATTERN = re.compile(r"^(\w[\w, ]*?) +: (.*)")
"""Pattern of a list item in a docstring: names and their meaning."""


def page() -> str:
    """Page (Markdown) with every public name, the classes of joints, and the public members of classes."""
    items = {f"jointfmu.{name}": getattr(jointfmu, name) for name in jointfmu.__all__}
    items |= {DriveJoint.__name__: DriveJoint}
    parts = ["# Reference", "Everything that `import jointfmu` has. Numbers are in SI units, unless stated."]
    for name, item in items.items():
        parts += entry(name, item, "##")
        if inspect.isclass(item):
            for member in members(item):
                parts += entry(f"{item.__name__}.{member}", getattr(item, member), "###")
    return "\n\n".join(parts) + "\n"


def members(item: type) -> list[str]:
    """Public methods and properties that a class declares itself."""
    mine = vars(item).items()
    kinds = (property, cached_property)
    return [name for name, x in mine if name[0] != "_" and (inspect.isfunction(x) or isinstance(x, kinds))]


def entry(name: str, item: Any, level: str) -> list[str]:
    """Heading, signature and help of one public name; a property has no arguments."""
    call = [f"```python\n{name.rpartition('.')[2]}{_signature(item)}\n```"] if callable(item) else []
    return [f"{level} {name}", *call, markdown(inspect.getdoc(item) or "")]


def _signature(item: Any) -> str:
    """Arguments of a function in one line, or one per line if they are too long; without types."""
    found = [p for p in inspect.signature(item).parameters.values() if p.name != "self"]
    line = str(inspect.Signature([p.replace(annotation=p.empty) for p in found]))
    return line if len(line) < WIDTH else f"(\n    {line[1:-1].replace(', ', BREAK)}\n)"


def markdown(text: str) -> str:
    """A docstring as Markdown: its lists as bullets, its examples as code."""
    blocks = []
    for block in text.split("\n\n"):
        if block.startswith(">>>"):
            blocks.append(f"```pycon\n{block}\n```")
        elif _LIST_ITEM_PATTERN.match(block):
            blocks.append(_bullets(block))
        else:
            blocks.append(block)
    return "\n\n".join(blocks)


def _bullets(block: str) -> str:
    """Convert lines `names : meaning`, with continuation lines, to a bullet list."""
    lines = []
    for line in block.splitlines():
        if match := _LIST_ITEM_PATTERN.match(line):
            lines.append(f"- `{match[1].strip()}`: {match[2]}")
        else:
            lines.append(f"  {line.strip()}")
    return "\n".join(lines)
