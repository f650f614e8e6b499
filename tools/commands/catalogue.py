"""`jointfmu catalogue`: the bought joints whose published numbers ship with the package."""

import argparse
import json
import re
from collections.abc import Sequence
from typing import Any

from jointfmu.joints import KINDS
from jointfmu.quantity.units import factor

from ..catalogue import Column, Item
from ..command_line.common import Commands, command
from ..joint_parts import part


def add(commands: Commands) -> None:
    """Declare the command."""
    sub = command(commands, "catalogue", _catalogue, "list the bought joints that jointfmu new knows")
    text = "parts of a name, as CSG-17, csg25-100 or csg 25 100"
    sub.add_argument("words", nargs="*", metavar="WORD", help=text)


def _catalogue(args: argparse.Namespace) -> int:
    """Print the joints whose names have the word in them."""
    found = [
        (kind.name, own.CATALOGUE.columns, item)
        for kind in KINDS.values()
        if (own := part(kind, "catalogue"))
        for item in own.CATALOGUE.items()
        if _in(args.words, item.name)
    ]
    if not found:
        word = " ".join(args.words)
        raise ValueError(f"no joint of the catalogues has {word!r} in its name (jointfmu catalogue)")
    if args.json:
        print(json.dumps([_document(*row) for row in found]))
        return 0
    shown = None
    for joint, columns, item in found:
        if joint != shown:
            head = (f"{c.name}{'' if c.shown == '1' else f' [{c.shown}]'}" for c in columns)
            print(f"{joint.replace('_', '-'):13}  {'  '.join(head)}")
            shown = joint
        print(f"{item.name:13}  {'  '.join(map(_cell(item), columns))}".rstrip())
    if any(number.kind == "estimate" for _, _, item in found for number in item.numbers.values()):
        print("~ is an estimate, < an upper limit; --json tells where each number comes from")
    return 0


def _in(words: Sequence[str], name: str) -> bool:
    """Whether the words are in a name one after the other, whatever their case, signs and spaces."""
    wanted, own = (re.sub(r"[^a-z0-9]", "", text.lower()) for text in ("".join(words), name))
    return wanted in own


def _cell(item: Item) -> Any:
    """What makes a cell of a column, as wide as the column's head."""

    def cell(column: Column) -> str:
        width = len(f"{column.name}{'' if column.shown == '1' else f' [{column.shown}]'}")
        if (number := item.numbers.get(column.name)) is None:
            return f"{'-':{width}}"
        mark = ("~" if number.kind == "estimate" else "") + ("<" if number.bound else "")
        return f"{mark + format(number.value * factor(column.unit, column.shown), '.4g'):{width}}"

    return cell


def _document(joint: str, columns: Any, item: Item) -> dict[str, Any]:
    """A joint with the origin of each number, SI units."""
    units = {column.name: column.unit for column in columns}
    numbers = {name: number._asdict() | {"unit": units[name]} for name, number in item.numbers.items()}
    return {"joint": joint, "name": item.name, "numbers": numbers}
