"""`jointfmu new`: a joint from what stands on its drawing; the tables of materials, finishes and bolts."""

import argparse
import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from jointfmu.files.writing import check_writable
from jointfmu.joints import KINDS

from ..command_line.common import Commands, Parser, command, flag, tell
from ..drawing.part import Drawing, Option
from ..interface.joint import Joint
from ..interface.make import made
from ..joint_parts import part
from ..pressure import judge_file


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
        _option(sub, option)
    sub.add_argument("--name", metavar="NAME", help="of the parameter set (default: by its sizes)")
    sub.add_argument("--out", type=Path, metavar="FILE", help="write the parameter file (TOML)")


def _option(sub: argparse.ArgumentParser, option: Option) -> None:
    if option.flag:
        sub.add_argument(flag(option.name), action="store_true", help=option.text)
        return
    sub.add_argument(
        flag(option.name),
        nargs="+" if option.many else None,
        choices=option.choices or None,
        required=option.required,
        metavar=None if option.choices else option.metavar,
        help=option.text,
    )


def _make(drawing: Drawing, args: argparse.Namespace) -> int:
    """Check what is to be written before the work, and make the joint."""
    if args.out:
        check_writable(args.out)
    joint = made(drawing, {option.name: getattr(args, option.name) for option in drawing.options})
    if args.name:
        joint = replace(joint, file=replace(joint.file, name=args.name))
    if args.out:
        joint.save(args.out)
    if args.json:
        print(json.dumps(_document(args, joint)))
        return 0
    for name, (value, unit, text) in joint.facts.items():
        print(f"{name:18} {value:.4g}{'' if unit == '1' else f' {unit}'}  {text}")
    tell(judge_file(joint.file).with_warnings(joint.notes))
    print(f"wrote {args.out}" if args.out else "nothing is written: state --out FILE")
    return 0


def _document(args: argparse.Namespace, joint: Joint) -> dict[str, object]:
    return {
        "joint": joint.file.joint,
        "law": joint.file.law,
        "name": joint.file.name,
        "parameters": joint.file.flat,
        "inputs": joint.file.inputs,
        "facts": {name: {"value": v, "unit": u, "text": t} for name, (v, u, t) in joint.facts.items()},
        **judge_file(joint.file).with_warnings(joint.notes).document(),
        "written": [str(args.out)] if args.out else [],
    }


def _table(rows: Callable[[], Iterator[dict[str, Any]]], args: argparse.Namespace) -> int:
    """Print a table."""
    content = list(rows())
    if args.json:
        print(json.dumps(content))
        return 0
    widths = {key: max(len(_shown(row[key])) for row in [*content, {key: key}]) for key in content[0]}
    print("  ".join(f"{key:{width}}" for key, width in widths.items()).rstrip())
    for row in content:
        print("  ".join(f"{_shown(row[key]):{width}}" for key, width in widths.items()).rstrip())
    return 0


def _shown(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _materials() -> Iterator[dict[str, object]]:
    from ..drawing.tables import table

    for row in table("materials").values():
        known = row.numbers
        yield {
            "name": row.name,
            "E [GPa]": known["E"].value / 1e9,
            "nu": known["nu"].value,
            "density [kg/m3]": known["density"].value,
            "H [MPa]": known["H"].value / 1e6,
            "also": ", ".join(row.also),
            "source": f"{known['E'].source}; H: {known['H'].source}",
        }


def _finishes() -> Iterator[dict[str, object]]:
    from ..drawing.tables import table

    for row in table("finishes").values():
        known = row.numbers
        yield {
            "name": row.name,
            "Ra [um]": known["Ra"].value * 1e6,
            "from": known["Ra_low"].value * 1e6,
            "to": known["Ra_high"].value * 1e6,
            "slope": known["slope"].value,
            "also": ", ".join(row.also),
            "source": known["Ra_low"].source,
        }


def _bolts() -> Iterator[dict[str, object]]:
    from ..drawing.tables import classes, threads
    from ..drawing.vdi2230 import assembly_preload, stress_area

    for thread in threads().values():
        large = int(thread.d > 16e-3)
        yield {
            "name": thread.name,
            "pitch [mm]": thread.pitch * 1e3,
            "hole [mm]": thread.hole * 1e3,
            "hexagon [mm]": thread.hexagon * 1e3,
            "socket [mm]": thread.socket * 1e3,
            "A_s [mm2]": stress_area(thread) * 1e6,
            **{
                f"preload {name} [kN]": assembly_preload(thread, strength["yield"][large]) / 1e3
                for name, strength in classes().items()
            },
        }


TABLES = {"materials": _materials, "finishes": _finishes, "bolts": _bolts}
"""{name: its rows}."""
