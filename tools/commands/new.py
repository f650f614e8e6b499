"""`jointfmu new`: a joint from its drawing; the shipped tables; `jointfmu catalogue`: the bought joints."""

import argparse
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from jointfmu.files.outputs import PARAMETERS
from jointfmu.joints import KINDS
from jointfmu.quantity.units import factor

from ..catalogue import Column, Item
from ..command_line.common import Answer, Commands, Parser, argument, command
from ..command_line.outputs import output
from ..drawing.part import Drawing
from ..interface.joint import Joint
from ..interface.make import made
from ..joint_parts import part
from ..pressure import judge_file
from ..shown import aligned, fact_document, fact_lines
from . import declare


def add(commands: Commands) -> None:
    """Declare the command, the joints that it makes, and the tables."""
    text = "make a joint's parameter file from what stands on its drawing"
    top = commands.add_parser("new", help=text, description=text)
    things = top.add_subparsers(dest="thing", required=True, metavar="JOINT", parser_class=Parser)
    for kind in KINDS.values():
        if found := part(kind, "new"):
            _declare(things, kind.name.replace("_", "-"), found.NEW)
    for name, rows in TABLES.items():
        command(things, name, partial(_table, rows), f"print the {name} that drawings may name")


def _declare(things: Commands, name: str, drawing: Drawing) -> None:
    """Declare one joint."""
    sub = command(things, name, partial(_make, drawing), f"make {drawing.text}")
    sub.example = f"new {name} {drawing.example} --out my.toml"
    for option in drawing.options:
        declare(sub, option)
    argument(sub, "--name", str, "of the parameter set (default: by its sizes)")
    output(sub, "--out", PARAMETERS, "write the parameter file (TOML)")


def _make(drawing: Drawing, args: argparse.Namespace) -> Answer:
    """Make the joint."""
    joint = made(drawing, {option.name: getattr(args, option.name) for option in drawing.options})
    if args.name:
        joint = replace(joint, file=replace(joint.file, name=args.name))
    if args.out:
        joint.save(args.out, force=args.force)
    found = judge_file(joint.file).with_warnings(joint.notes)
    end = f"wrote {args.out}" if args.out else "nothing is written: state --out FILE"
    return Answer(
        document=_document(joint) | found.document() | {"written": [str(args.out)] if args.out else []},
        lines=[*fact_lines(joint.facts), *found.lines(), end],
        notes=[f"warning: {text}" for text in found.warnings],
    )


def _document(joint: Joint) -> dict[str, object]:
    return {
        "joint": joint.file.joint,
        "law": joint.file.law,
        "name": joint.file.name,
        "parameters": joint.file.flat,
        "inputs": joint.file.inputs,
        "facts": fact_document(joint.facts),
    }


def _table(rows: Callable[[], Iterator[dict[str, Any]]], args: argparse.Namespace) -> Answer:
    """A table."""
    content = list(rows())
    cells = [[*content[0]], *([_shown(cell) for cell in row.values()] for row in content)]
    return Answer(document=content, lines=aligned(cells))


def _shown(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


_MATERIAL = {
    "E [GPa]": ("E", 1e-9),
    "nu": ("nu", 1.0),
    "density [kg/m3]": ("density", 1.0),
    "H [MPa]": ("H", 1e-6),
}
_FINISH = {"Ra [um]": ("Ra", 1e6), "from": ("Ra_low", 1e6), "to": ("Ra_high", 1e6), "slope": ("slope", 1.0)}
"""{head: column, its number over that in SI}."""


def _rows(name: str, heads: Mapping[str, tuple[str, float]], source: str) -> Iterator[dict[str, object]]:
    """The rows of `materials` or `finishes`; `source` is made of those of their numbers."""
    from ..drawing.tables import table

    for row in table(name).values():
        numbers = {
            head: round(row.numbers[column].value * times, 9) for head, (column, times) in heads.items()
        }
        also = {"also": ", ".join(row.also), "source": source.format(**row.numbers)}
        yield {"name": row.name, **numbers, **also}


def _bolts() -> Iterator[dict[str, object]]:
    from ..drawing.tables import classes, strength, threads
    from ..drawing.vdi2230 import assembly_preload, stress_area

    for thread in threads().values():
        yield {
            "name": thread.name,
            "pitch [mm]": thread.pitch * 1e3,
            "hole [mm]": thread.hole * 1e3,
            "hexagon [mm]": thread.hexagon * 1e3,
            "socket [mm]": thread.socket * 1e3,
            "A_s [mm2]": stress_area(thread) * 1e6,
            **{
                f"preload {name} [kN]": assembly_preload(thread, strength(name, "yield", thread)) / 1e3
                for name in classes()
            },
        }


TABLES: dict[str, Callable[[], Iterator[dict[str, Any]]]] = {
    "materials": partial(_rows, "materials", _MATERIAL, "{E.source}; H: {H.source}"),
    "finishes": partial(_rows, "finishes", _FINISH, "{Ra_low.source}"),
    "bolts": _bolts,
}
"""{name: its rows}."""


def add_catalogue(commands: Commands) -> None:
    """Declare the command."""
    sub = command(commands, "catalogue", _catalogue, "list the bought joints that jointfmu new knows")
    argument(sub, "words", str, "parts of a name, as CSG-17, csg25-100 or csg 25 100", "WORD", nargs="*")


def _catalogue(args: argparse.Namespace) -> Answer:
    """The joints whose names have the word in them."""
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
    lines, shown = [], None
    for joint, columns, item in found:
        if joint != shown:
            lines.append(f"{joint.replace('_', '-'):13}  {'  '.join(map(_head, columns))}")
            shown = joint
        lines.append(f"{item.name:13}  {'  '.join(_cell(item, column) for column in columns)}".rstrip())
    if any(number.kind == "estimate" for _, _, item in found for number in item.numbers.values()):
        lines.append("~ is an estimate, < an upper limit; --json tells where each number comes from")
    return Answer(document=[_item_document(*row) for row in found], lines=lines)


def _in(words: Sequence[str], name: str) -> bool:
    """Whether the words are in a name one after the other, whatever their case, signs and spaces."""
    wanted, own = (re.sub(r"[^a-z0-9]", "", text.lower()) for text in ("".join(words), name))
    return wanted in own


def _head(column: Column) -> str:
    return f"{column.name}{'' if column.shown == '1' else f' [{column.shown}]'}"


def _cell(item: Item, column: Column) -> str:
    """As wide as the column's head."""
    width = len(_head(column))
    if (number := item.numbers.get(column.name)) is None:
        return f"{'-':{width}}"
    mark = ("~" if number.kind == "estimate" else "") + ("<" if number.bound else "")
    return f"{mark + format(number.value * factor(column.unit, column.shown), '.4g'):{width}}"


def _item_document(joint: str, columns: Any, item: Item) -> dict[str, Any]:
    """A joint with the origin of each number, SI units."""
    units = {column.name: column.unit for column in columns}
    numbers = {name: number._asdict() | {"unit": units[name]} for name, number in item.numbers.items()}
    return {"joint": joint, "name": item.name, "numbers": numbers}
