"""`jointfmu export`: the joint for finite elements, Modelica tables and CSV."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..export.forms import ERROR, FORMS, WHAT
from ..export.placing import AXES, Placing
from ..export.units import SI, UNITS
from ..joints import KINDS
from ..parameters import ParameterFile, check_writable, default, load, write_text
from .common import command

if TYPE_CHECKING:
    from ..export.files import Written

_NUMBERED = {"first": ("ansys", "calculix", "abaqus"), "first_set": ("ansys",)}
_ABOVE = {
    "first": "a number above all elements of your model",
    "first_set": "a number above all element types and sets of real constants of your model",
}
_SI = {"K_": "N/m", "C_": "N.s/m"}


def add(commands: Any) -> None:
    """Declare the command."""
    export = command(commands, "export", _export, "write the joint for another solver")
    export.add_argument("form", choices=list(FORMS), metavar="FORMAT", help=f"one of {', '.join(FORMS)}")
    export.add_argument(
        "what",
        choices=WHAT,
        metavar="WHAT",
        help="springs: springs and dashpots between node pairs (bolted joint); contact: pressure over "
        "overclosure; curve: load over displacement of the whole joint",
    )
    joint = export.add_mutually_exclusive_group()
    joint.add_argument("--params", type=Path, metavar="FILE", help="parameter file of the joint (TOML)")
    joint.add_argument(
        "--joint", choices=list(KINDS), default="bolted_joint", help="a default joint (bolted_joint)"
    )
    export.add_argument("--preload", type=float, metavar="F", help="bolted joint: preload per bolt [N]")
    export.add_argument("--moment", type=float, metavar="M", help="bolted joint: bending moment [N.m] (0)")
    export.add_argument(
        "--nodes",
        type=Path,
        metavar="CSV",
        help="springs: your node pairs: node_1 [1], node_2 [1], x [mm], y [mm], area [mm2], and with "
        "pressure [MPa] instead of --preload",
    )
    export.add_argument(
        "--first", type=int, metavar="N", help="springs: first number free for elements and nodes (1)"
    )
    export.add_argument(
        "--first-set",
        type=int,
        metavar="N",
        help="ansys: first number free for element types and sets of real constants (1)",
    )
    export.add_argument("--normal", choices=list(AXES), help="springs: axis along the joint's normal (z)")
    export.add_argument(
        "--units", choices=list(UNITS), default=SI.name, help=f"units of the file ({SI.name})"
    )
    export.add_argument(
        "--error", type=float, metavar="E", help=f"tables: largest error by straight lines ({ERROR:g})"
    )
    export.add_argument("--out", type=Path, required=True, metavar="FILE", help="file to write")


def _export(args: argparse.Namespace) -> int:
    if args.what not in FORMS[args.form]:
        raise ValueError(
            f"{args.form} {args.what} cannot be written; {args.form} has {', '.join(FORMS[args.form])}"
        )
    check_writable(args.out)
    file = load(args.params) if args.params else default(args.joint)
    _refuse_idle(args, file)
    written = _written(args, file)
    write_text(args.out, written.text)
    facts = {"written": str(args.out), "format": args.form, "what": args.what, "units": args.units}
    if args.json:
        print(json.dumps({**facts, **written.facts}))
        return 0
    print(f"wrote {args.out}: {args.what} for {args.form}, {args.units}")
    for name, value in written.facts.items():
        number = f"{value:.6g}" if isinstance(value, float) else value
        print(f"  {name:<24}  {number} {_SI.get(name[:2], '')}".rstrip())
    return 0


def _written(args: argparse.Namespace, file: ParameterFile) -> "Written":
    from ..export import files
    from ..export.mesh import read_pairs

    units = UNITS[args.units]
    error = ERROR if args.error is None else args.error
    if args.what == "contact":
        return files.contact(args.form, file, units, error)
    state = None if args.preload is None else files.State(args.preload, args.moment or 0.0)
    if args.what == "curve":
        return files.curve(args.form, file, state, units, error)
    mesh = read_pairs(args.nodes) if args.nodes else None
    if mesh is not None and mesh.pressure is not None and state is not None:
        raise ValueError(f"{mesh.path} states the pressures; leave out --preload, or its column 'pressure'")
    if (mesh is None or mesh.pressure is None) and state is None:
        raise ValueError("springs need --preload, the force of each bolt [N], or --nodes with a pressure")
    placing = Placing(units, args.normal or "z", args.first or 1, args.first_set or 1, own=mesh is None)
    return files.springs(args.form, file, state, mesh, placing)


def _refuse_idle(args: argparse.Namespace, file: ParameterFile) -> None:
    """Refuse options that would do nothing, or are missing."""
    springs, bolted = args.what == "springs", file.joint == "bolted_joint"
    if springs and not bolted:
        raise ValueError(f"springs of a {file.joint} cannot be written; allowed is a bolted_joint")
    if args.moment is not None and args.preload is None:
        raise ValueError("--moment needs --preload, the force of each bolt [N]")
    if args.preload is not None and (args.what == "contact" or not bolted):
        raise ValueError(f"--preload has no meaning for the {args.what} of a {file.joint}")
    if args.what == "curve" and bolted and args.preload is None:
        raise ValueError("the curve of a bolted_joint needs --preload, the force of each bolt [N]")
    for name in ("nodes", "first", "normal"):
        if getattr(args, name) is not None and not springs:
            raise ValueError(f"--{name} has no meaning for a {args.what}; it is for springs")
    if args.error is not None and springs:
        raise ValueError("--error has no meaning for springs; it is for tables")
    if args.first_set is not None and args.form != "ansys":
        raise ValueError(f"--first-set has no meaning for {args.form}; it is for ansys")
    for name, highest in (("first", 10_000_000), ("first_set", 100_000)):
        value, option = getattr(args, name), "--" + name.replace("_", "-")
        if value is not None and not 1 <= value <= highest:
            raise ValueError(f"{option} = {value} is outside [1, {highest}]")
        if value is None and args.nodes is not None and args.form in _NUMBERED[name]:
            raise ValueError(f"--nodes needs {option}, {_ABOVE[name]}")
    if args.form == "modelica" and args.units != SI.name:
        raise ValueError(f"--units = {args.units}: a Modelica table is in {SI.name}")
