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
from ...api.make import make_joint_from_drawing
from ...common.joint_parts import load_tool_module
from ...common.pressure import judge_joint_stiffness
from ...common.shown import align_columns, derived_values_to_json, format_derived_values
from ...inputs.catalogue import CatalogueColumn, CatalogueEntry
from ...inputs.drawing.part import NewJointCommand
from ...joints.harmonic_drive.catalogue import CATALOGUE_COLUMNS, list_drives
from ...joints.harmonic_drive.new_cycloidal import NEW_CYCLOIDAL_DRIVE_COMMAND
from ..command import CommandResult, Parser, SubParsers, declare_argument, declare_command, format_sentence
from ..outputs import declare_output
from . import declare_option


def add_command(command_parsers: SubParsers) -> None:
    """Declare `jointfmu new`, with a sub-command for each joint and for each table."""
    text = "make the parameter file of a joint from the data of its drawing or catalogue"
    top = command_parsers.add_parser("new", help=text, description=format_sentence(text))
    things = top.add_subparsers(dest="thing", required=True, metavar="JOINT", parser_class=Parser)
    for kind in KINDS.values():
        if module := load_tool_module(kind, "new"):
            _declare_joint_command(things, kind.name.replace("_", "-"), module.NEW_JOINT_COMMAND)
    _declare_joint_command(things, "cycloidal-drive", NEW_CYCLOIDAL_DRIVE_COMMAND)
    for name, rows in PRINTED_TABLES.items():
        declare_command(
            things,
            name,
            partial(_print_table, rows),
            f"print the {name} that jointfmu new knows, with their numbers",
        )


def _declare_joint_command(
    joint_parsers: SubParsers, joint_name: str, new_joint_command: NewJointCommand
) -> None:
    """Declare the sub-command of `jointfmu new` for one joint."""
    sub = declare_command(
        joint_parsers,
        joint_name,
        partial(_run_new, new_joint_command),
        f"make {new_joint_command.joint_description}",
    )
    sub.example_arguments = f"new {joint_name} {new_joint_command.example_options} --out my.toml"
    for option in new_joint_command.command_options:
        declare_option(sub, option)
    declare_argument(
        sub, "--name", str, "name of the joint in the parameter file (default: made of its sizes)"
    )
    declare_output(sub, "--out", PARAMETER_FILE, "write the parameter file (TOML)")


def _run_new(new_joint_command: NewJointCommand, args: argparse.Namespace) -> CommandResult:
    """Make a joint from the dimensions of its drawing, given as options."""
    joint = make_joint_from_drawing(
        new_joint_command,
        {option.name: getattr(args, option.name) for option in new_joint_command.command_options},
    )
    if args.name:
        joint = replace(joint, file=replace(joint.file, name=args.name))
    if args.out:
        joint.save(args.out, force=args.force)
    judgement = judge_joint_stiffness(joint.file).prepend_warnings(joint.notes)
    end = f"wrote {args.out}" if args.out else "nothing is written: state --out FILE"
    return CommandResult(
        json_document=_joint_to_json(joint)
        | judgement.to_json()
        | {"written": [str(args.out)] if args.out else []},
        output_lines=[*format_derived_values(joint.facts), *judgement.format_lines(), end],
        stderr_lines=[f"warning: {text}" for text in judgement.warnings],
    )


def _joint_to_json(new_joint: Joint) -> dict[str, object]:
    """JSON object of a new joint: joint, law, name, parameters, start values of inputs, derived numbers."""
    return {
        "joint": new_joint.file.joint,
        "law": new_joint.file.law,
        "name": new_joint.file.name,
        "parameters": new_joint.file.values_by_name,
        "inputs": new_joint.file.inputs,
        "facts": derived_values_to_json(new_joint.facts),
    }


def _print_table(
    iterate_table_rows: Callable[[], Iterator[dict[str, Any]]], args: argparse.Namespace
) -> CommandResult:
    """Print a table that `jointfmu new` offers: bolts, materials or finishes."""
    content = list(iterate_table_rows())
    cells = [[*content[0]], *([_format_table_cell(cell) for cell in row.values()] for row in content)]
    return CommandResult(json_document=content, output_lines=align_columns(cells))


def _format_table_cell(cell_value: object) -> str:
    """Format a cell of a printed table: number, text or empty."""
    return f"{cell_value:.4g}" if isinstance(cell_value, float) else str(cell_value)


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
    source_format : format string for the source of a row, filled with the numbers of the row
    """
    from ...inputs.drawing.tables import read_material_or_finish_table

    for row in read_material_or_finish_table(table_name).values():
        numbers = {
            head: round(row.sourced_numbers[column].si_value * scale, 9)
            for head, (column, scale) in column_scales.items()
        }
        also = {"also": ", ".join(row.row_aliases), "source": source_format.format(**row.sourced_numbers)}
        yield {"name": row.row_name, **numbers, **also}


def _iterate_bolt_table_rows() -> Iterator[dict[str, object]]:
    """Yield the rows of the printed table of bolts."""
    from ...inputs.drawing.tables import property_class_strength, read_property_classes, read_threads
    from ...inputs.drawing.vdi2230 import assembly_preload, stress_area

    for thread in read_threads().values():
        yield {
            "name": thread.thread_name,
            "pitch [mm]": thread.pitch * 1e3,
            "hole [mm]": thread.hole_diameter * 1e3,
            "hexagon [mm]": thread.hexagon_bearing_diameter * 1e3,
            "socket [mm]": thread.socket_bearing_diameter * 1e3,
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
    "materials": partial(
        _iterate_table_rows, "materials", _MATERIAL_COLUMNS, ("{E.value_source}; H: {H.value_source}")
    ),
    "finishes": partial(_iterate_table_rows, "finishes", _FINISH_COLUMNS, "{Ra_low.value_source}"),
    "bolts": _iterate_bolt_table_rows,
}
"""{name of a table: function that yields its rows}."""


def add_catalogue_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu catalogue` with its options."""
    sub = declare_command(
        command_parsers,
        "catalogue",
        _run_catalogue,
        "list the harmonic drives that jointfmu new knows by name",
    )
    text = "part of the name, for example CSG-17, csg25-100 or csg 25 100 (default: list all)"
    declare_argument(sub, "words", str, text, "WORD", nargs="*")


def _run_catalogue(args: argparse.Namespace) -> CommandResult:
    """List the drives of the catalogue whose names contain the words. Raises ValueError if there is none."""
    found = [item for item in list_drives() if _name_contains_words(args.words, item.joint_name)]
    if not found:
        word = " ".join(args.words)
        raise ValueError(
            f"no drive in the catalogue has {word!r} in its name; jointfmu catalogue without words lists "
            "all drives"
        )
    lines = [f"{'harmonic-drive':13}  {'  '.join(map(_format_catalogue_heading, CATALOGUE_COLUMNS))}"]
    for item in found:
        numbers = "  ".join(_format_catalogue_number(item, column) for column in CATALOGUE_COLUMNS)
        lines.append(f"{item.joint_name:13}  {numbers}".rstrip())
    if any(number.value_origin == "estimate" for item in found for number in item.known_numbers.values()):
        lines.append("~ is an estimate, < an upper limit; --json has the source of each number")
    return CommandResult(
        json_document=[_entry_to_json(CATALOGUE_COLUMNS, item) for item in found], output_lines=lines
    )


def _name_contains_words(search_words: Sequence[str], entry_name: str) -> bool:
    """Whether the name of a catalogue entry contains the joined words. Case, signs and spaces are ignored."""
    searched, plain_name = (
        re.sub(r"[^a-z0-9]", "", text.lower()) for text in ("".join(search_words), entry_name)
    )
    return searched in plain_name


def _format_catalogue_heading(catalogue_column: CatalogueColumn) -> str:
    """Format the heading of a column of the printed catalogue: name and unit."""
    unit = catalogue_column.display_unit
    return f"{catalogue_column.column_name}{'' if unit == '1' else f' [{unit}]'}"


def _format_catalogue_number(catalogue_entry: CatalogueEntry, catalogue_column: CatalogueColumn) -> str:
    """Format one number of a catalogue entry, at least as wide as the heading of its column."""
    width = len(_format_catalogue_heading(catalogue_column))
    if (number := catalogue_entry.known_numbers.get(catalogue_column.column_name)) is None:
        return f"{'-':{width}}"
    mark = ("~" if number.value_origin == "estimate" else "") + ("<" if number.is_upper_limit else "")
    factor = conversion_factor(catalogue_column.si_unit, catalogue_column.display_unit)
    return f"{mark + format(number.si_value * factor, '.4g'):{width}}"


def _entry_to_json(
    catalogue_columns: Sequence[CatalogueColumn], catalogue_entry: CatalogueEntry
) -> dict[str, Any]:
    """JSON object of a catalogue entry: numbers in SI units, with origin and source."""
    units = {column.column_name: column.si_unit for column in catalogue_columns}
    numbers = {
        name: {
            "value": number.si_value,
            "kind": number.value_origin,
            "source": number.value_source,
            "is_upper_limit": number.is_upper_limit,
            "interval": number.estimate_interval,
            "unit": units[name],
        }
        for name, number in catalogue_entry.known_numbers.items()
    }
    return {"joint": "harmonic_drive", "name": catalogue_entry.joint_name, "numbers": numbers}
