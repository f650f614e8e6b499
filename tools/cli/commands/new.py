"""`jointfmu new`: make a joint from its drawing, or print a shipped table.

`jointfmu catalogue`: list the bought joints.
"""

import argparse
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from jointfmu.files.outputs import PARAMETER_FILE
from jointfmu.joints import KINDS
from jointfmu.quantity.units import conversion_factor

from ...api.joint import Joint
from ...api.make import make_from_drawing
from ...common.joint_parts import load_tool_module
from ...common.pressure import judge_joint_stiffness
from ...common.shown import align_columns, facts_to_json, format_facts
from ...inputs.catalogue import CatalogueColumn, CatalogueEntry
from ...inputs.drawing.part import NewJointCommand
from ...joints.harmonic_drive.catalogue import CATALOGUE_COLUMNS, list_drives
from ...joints.harmonic_drive.new_cycloidal import NEW_CYCLOIDAL_DRIVE_COMMAND
from ..command import CommandResult, Parser, SubParsers, declare_argument, declare_command, format_sentence
from ..outputs import declare_output
from . import declare_option


def add_command(command_parsers: SubParsers) -> None:
    """Declare `jointfmu new`, with a sub-command for each joint and for each table."""
    text = "make the parameter file of a joint from the data on its drawing"
    top = command_parsers.add_parser("new", help=text, description=format_sentence(text))
    things = top.add_subparsers(dest="thing", required=True, metavar="JOINT", parser_class=Parser)
    for kind in KINDS.values():
        if module := load_tool_module(kind, "new"):
            _declare_joint(things, kind.name.replace("_", "-"), module.NEW_JOINT_COMMAND)
    _declare_joint(things, "cycloidal-drive", NEW_CYCLOIDAL_DRIVE_COMMAND)
    for name, rows in PRINTED_TABLES.items():
        declare_command(things, name, partial(_run_table, rows), f"print the table of known {name}")


def _declare_joint(joint_parsers: SubParsers, joint_name: str, joint_command: NewJointCommand) -> None:
    """Declare the sub-command of `jointfmu new` for one joint."""
    sub = declare_command(
        joint_parsers, joint_name, partial(_run_new, joint_command), f"make {joint_command.description}"
    )
    sub.example = f"new {joint_name} {joint_command.example} --out my.toml"
    for option in joint_command.options:
        declare_option(sub, option)
    declare_argument(sub, "--name", str, "name of the parameter set (default: made of its sizes)")
    declare_output(sub, "--out", PARAMETER_FILE, "write the parameter file (TOML)")


def _run_new(joint_command: NewJointCommand, args: argparse.Namespace) -> CommandResult:
    """Make a joint from the dimensions of its drawing, given as options."""
    joint = make_from_drawing(
        joint_command, {option.name: getattr(args, option.name) for option in joint_command.options}
    )
    if args.name:
        joint = replace(joint, file=replace(joint.file, name=args.name))
    if args.out:
        joint.save(args.out, force=args.force)
    judgement = judge_joint_stiffness(joint.file).with_warnings(joint.notes)
    end = f"wrote {args.out}" if args.out else "nothing is written: state --out FILE"
    return CommandResult(
        json_document=_joint_to_json(joint)
        | judgement.to_json()
        | {"written": [str(args.out)] if args.out else []},
        lines=[*format_facts(joint.facts), *judgement.format_lines(), end],
        notes=[f"warning: {text}" for text in judgement.warnings],
    )


def _joint_to_json(joint: Joint) -> dict[str, object]:
    """JSON object of a new joint: name, facts, parameters, warnings."""
    return {
        "joint": joint.file.joint,
        "law": joint.file.law,
        "name": joint.file.name,
        "parameters": joint.file.values_by_name,
        "inputs": joint.file.inputs,
        "facts": facts_to_json(joint.facts),
    }


def _run_table(
    iterate_rows: Callable[[], Iterator[dict[str, Any]]], args: argparse.Namespace
) -> CommandResult:
    """Print a table that `jointfmu new` offers: bolts, materials or finishes."""
    content = list(iterate_rows())
    cells = [[*content[0]], *([_format_cell(cell) for cell in row.values()] for row in content)]
    return CommandResult(json_document=content, lines=align_columns(cells))


def _format_cell(value: object) -> str:
    """Format a cell of a printed table: number, text or empty."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


_MATERIAL_COLUMNS = {
    "E [GPa]": ("E", 1e-9),
    "nu": ("nu", 1.0),
    "density [kg/m3]": ("density", 1.0),
    "alpha [1e-6/K]": ("alpha", 1e6),
    "H [MPa]": ("H", 1e-6),
}
"""Columns of the printed table of materials: {heading: (column of the table, factor from SI)}."""
_FINISH_COLUMNS = {
    "Ra [um]": ("Ra", 1e6),
    "from": ("Ra_low", 1e6),
    "to": ("Ra_high", 1e6),
    "slope": ("slope", 1.0),
}
"""Columns of the printed table of finishes: {heading: (column of the table, factor from SI)}."""


def _iterate_table_rows(
    table_name: str, column_scales: Mapping[str, tuple[str, float]], source_format: str
) -> Iterator[dict[str, object]]:
    """Yield the rows of the printed table of materials or of finishes.

    column_scales : {heading: (column of the table, factor from SI to the printed unit)}
    source_format : format string for the column `source_format`, filled with the numbers of the row
    """
    from ...inputs.drawing.tables import read_table

    for row in read_table(table_name).values():
        numbers = {
            head: round(row.numbers[column].value * scale, 9)
            for head, (column, scale) in column_scales.items()
        }
        also = {"also": ", ".join(row.aliases), "source": source_format.format(**row.numbers)}
        yield {"name": row.name, **numbers, **also}


def _iterate_bolt_table_rows() -> Iterator[dict[str, object]]:
    """Yield the rows of the printed table of bolts."""
    from ...inputs.drawing.tables import property_class_strength, read_property_classes, read_threads
    from ...inputs.drawing.vdi2230 import assembly_preload, stress_area

    for thread in read_threads().values():
        yield {
            "name": thread.name,
            "pitch [mm]": thread.pitch * 1e3,
            "hole [mm]": thread.hole * 1e3,
            "hexagon [mm]": thread.hexagon * 1e3,
            "socket [mm]": thread.socket * 1e3,
            "A_s [mm2]": stress_area(thread) * 1e6,
            **{
                f"preload {name} [kN]": assembly_preload(
                    thread, property_class_strength(name, "yield", thread)
                )
                / 1e3
                for name in read_property_classes()
            },
        }


PRINTED_TABLES: dict[str, Callable[[], Iterator[dict[str, Any]]]] = {
    "materials": partial(_iterate_table_rows, "materials", _MATERIAL_COLUMNS, "{E.source}; H: {H.source}"),
    "finishes": partial(_iterate_table_rows, "finishes", _FINISH_COLUMNS, "{Ra_low.source}"),
    "bolts": _iterate_bolt_table_rows,
}
"""{name of a table: function that yields its rows}."""


def add_catalogue_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu catalogue` with its options."""
    sub = declare_command(
        command_parsers, "catalogue", _run_catalogue, "list the bought joints that jointfmu new knows"
    )
    text = "part of the name, for example CSG-17, csg25-100 or csg 25 100"
    declare_argument(sub, "words", str, text, "WORD", nargs="*")


def _run_catalogue(args: argparse.Namespace) -> CommandResult:
    """List the bought joints whose names contain the words. Raises ValueError if there is none."""
    found = [item for item in list_drives() if _contains_words(args.words, item.name)]
    if not found:
        word = " ".join(args.words)
        raise ValueError(f"no drive in the catalogue has {word!r} in its name (jointfmu catalogue)")
    lines = [f"{'harmonic-drive':13}  {'  '.join(map(_format_heading, CATALOGUE_COLUMNS))}"]
    for item in found:
        numbers = "  ".join(_format_number(item, column) for column in CATALOGUE_COLUMNS)
        lines.append(f"{item.name:13}  {numbers}".rstrip())
    if any(number.origin == "estimate" for item in found for number in item.numbers.values()):
        lines.append("~ is an estimate, < an upper limit; --json has the source of each number")
    return CommandResult(
        json_document=[_entry_to_json(CATALOGUE_COLUMNS, item) for item in found], lines=lines
    )


def _contains_words(words: Sequence[str], entry_name: str) -> bool:
    """Whether the name of a catalogue entry contains the joined words. Case, signs and spaces are ignored."""
    searched, plain_name = (re.sub(r"[^a-z0-9]", "", text.lower()) for text in ("".join(words), entry_name))
    return searched in plain_name


def _format_heading(column: CatalogueColumn) -> str:
    """Format the heading of a column of the printed catalogue: name and unit."""
    return f"{column.name}{'' if column.display_unit == '1' else f' [{column.display_unit}]'}"


def _format_number(catalogue_entry: CatalogueEntry, column: CatalogueColumn) -> str:
    """Format one number of a catalogue entry, at least as wide as the heading of its column."""
    width = len(_format_heading(column))
    if (number := catalogue_entry.numbers.get(column.name)) is None:
        return f"{'-':{width}}"
    mark = ("~" if number.origin == "estimate" else "") + ("<" if number.is_upper_limit else "")
    return (
        f"{mark + format(number.value * conversion_factor(column.unit, column.display_unit), '.4g'):{width}}"
    )


def _entry_to_json(columns: Sequence[CatalogueColumn], catalogue_entry: CatalogueEntry) -> dict[str, Any]:
    """JSON object of a catalogue entry: numbers in SI units, with origin and source."""
    units = {column.name: column.unit for column in columns}
    numbers = {
        name: {
            "value": number.value,
            "kind": number.origin,
            "source": number.source,
            "is_upper_limit": number.is_upper_limit,
            "interval": number.interval,
            "unit": units[name],
        }
        for name, number in catalogue_entry.numbers.items()
    }
    return {"joint": "harmonic_drive", "name": catalogue_entry.name, "numbers": numbers}
