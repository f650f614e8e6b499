"""`jointfmu new`: make a joint from its drawing, or print a shipped table.

`jointfmu catalogue`: list the bought joints.
"""

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
from ..command_line.common import Answer, Commands, Parser, argument, command, sentence
from ..command_line.outputs import output
from ..drawing.part import Drawing
from ..interface.joint import Joint
from ..interface.make import made
from ..joint_parts import part
from ..pressure import judge_file
from ..shown import aligned, fact_document, fact_lines
from . import declare


def add(commands: Commands) -> None:
    """Declare `jointfmu new`, with a sub-command for each joint and for each table."""
    text = "make the parameter file of a joint from the data on its drawing"
    top = commands.add_parser("new", help=text, description=sentence(text))
    things = top.add_subparsers(dest="thing", required=True, metavar="JOINT", parser_class=Parser)
    for kind in KINDS.values():
        if module := part(kind, "new"):
            _declare(things, kind.name.replace("_", "-"), module.NEW)
    for name, rows in TABLES.items():
        command(things, name, partial(_table, rows), f"print the table of known {name}")


def _declare(things: Commands, name: str, drawing: Drawing) -> None:
    """Declare the sub-command of one joint."""
    sub = command(things, name, partial(_make, drawing), f"make {drawing.text}")
    sub.example = f"new {name} {drawing.example} --out my.toml"
    for option in drawing.options:
        declare(sub, option)
    argument(sub, "--name", str, "name of the parameter set (default: made of its sizes)")
    output(sub, "--out", PARAMETERS, "write the parameter file (TOML)")


def _make(drawing: Drawing, args: argparse.Namespace) -> Answer:
    """Make a joint from the options of its drawing."""
    joint = made(drawing, {option.name: getattr(args, option.name) for option in drawing.options})
    if args.name:
        joint = replace(joint, file=replace(joint.file, name=args.name))
    if args.out:
        joint.save(args.out, force=args.force)
    judgement = judge_file(joint.file).with_warnings(joint.notes)
    end = f"wrote {args.out}" if args.out else "nothing is written: state --out FILE"
    return Answer(
        document=_document(joint) | judgement.document() | {"written": [str(args.out)] if args.out else []},
        lines=[*fact_lines(joint.facts), *judgement.lines(), end],
        notes=[f"warning: {text}" for text in judgement.warnings],
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
    """Print a table: bolts, materials or finishes."""
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
"""Columns of the printed tables: {heading: (column of the table, factor from SI to the printed unit)}."""


def _rows(name: str, heads: Mapping[str, tuple[str, float]], source: str) -> Iterator[dict[str, object]]:
    """Yield the rows of `materials` or `finishes`.

    column_scales : {heading: (column of the table, factor from SI to the printed unit)}
    source        : format string for the column `source`, filled with the numbers of the row
    """
    from ..drawing.tables import table

    for row in table(name).values():
        numbers = {
            head: round(row.numbers[column].value * scale, 9) for head, (column, scale) in heads.items()
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
"""{name of a table: function that yields its rows}."""


def add_catalogue(commands: Commands) -> None:
    """Declare the command `jointfmu catalogue` with its options."""
    sub = command(commands, "catalogue", _catalogue, "list the bought joints that jointfmu new knows")
    text = "part of the name, for example CSG-17, csg25-100 or csg 25 100"
    argument(sub, "words", str, text, "WORD", nargs="*")


def _catalogue(args: argparse.Namespace) -> Answer:
    """List the bought joints whose names contain the words. Raises ValueError if there is none."""
    rows = [
        (kind.name, module.CATALOGUE.columns, item)
        for kind in KINDS.values()
        if (module := part(kind, "catalogue"))
        for item in module.CATALOGUE.items()
        if _in(args.words, item.name)
    ]
    if not rows:
        word = " ".join(args.words)
        raise ValueError(f"no joint of the catalogues has {word!r} in its name (jointfmu catalogue)")
    lines, last_joint = [], None
    for joint, columns, item in rows:
        if joint != last_joint:
            lines.append(f"{joint.replace('_', '-'):13}  {'  '.join(map(_head, columns))}")
            last_joint = joint
        lines.append(f"{item.name:13}  {'  '.join(_cell(item, column) for column in columns)}".rstrip())
    if any(number.kind == "estimate" for _, _, item in rows for number in item.numbers.values()):
        lines.append("~ is an estimate, < an upper limit; --json has the source of each number")
    return Answer(document=[_item_document(*row) for row in rows], lines=lines)


def _in(words: Sequence[str], name: str) -> bool:
    """Return whether a name contains the joined words. Case, signs and spaces are ignored."""
    searched, plain_name = (re.sub(r"[^a-z0-9]", "", text.lower()) for text in ("".join(words), name))
    return searched in plain_name


def _head(column: Column) -> str:
    return f"{column.name}{'' if column.shown == '1' else f' [{column.shown}]'}"


def _cell(item: Item, column: Column) -> str:
    """Format one number of a catalogue entry, at least as wide as the heading of its column."""
    width = len(_head(column))
    if (number := item.numbers.get(column.name)) is None:
        return f"{'-':{width}}"
    mark = ("~" if number.kind == "estimate" else "") + ("<" if number.bound else "")
    return f"{mark + format(number.value * factor(column.unit, column.shown), '.4g'):{width}}"


def _item_document(joint: str, columns: Any, item: Item) -> dict[str, Any]:
    """JSON object of a catalogue entry: numbers in SI units, with origin and source."""
    units = {column.name: column.unit for column in columns}
    numbers = {name: number._asdict() | {"unit": units[name]} for name, number in item.numbers.items()}
    return {"joint": joint, "name": item.name, "numbers": numbers}
