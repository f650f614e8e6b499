"""`jointfmu modelica`: the Modelica library, from parameters."""

import argparse
import json
from pathlib import Path
from typing import Any

from ..parameters import load
from .common import command, without_package


def add(commands: Any) -> None:
    """Declare the command."""
    make = command(commands, "modelica", _modelica, "write the Modelica library JointStiffness")
    make.add_argument("--params", type=Path, metavar="FILE", help="parameter file of one joint (TOML)")
    make.add_argument(
        "--preload", type=float, nargs="+", default=[], metavar="F", help="bolted joint: preload per bolt [N]"
    )
    make.add_argument(
        "--moment", type=float, metavar="M", help="bolted joint: bending moment [N.m] (default: 0)"
    )
    make.add_argument("--out", type=Path, default=Path("dist"), metavar="DIR", help="folder (default: dist)")


def _modelica(args: argparse.Namespace) -> int:
    file = load(args.params) if args.params else None
    if args.moment is not None and not args.preload:
        raise ValueError("--moment needs --preload, the force of each bolt [N]")
    try:
        from jointfmu_fmu_src.modelica import library

        states = [(force, args.moment or 0.0) for force in args.preload]
        written = library.write(args.out, file, states)
    except ImportError as error:
        raise without_package(error, "write the library") from None
    if args.json:
        print(json.dumps({"written": [str(path) for path in written]}))
    else:
        print(f"wrote {args.out / library.NAME}: {len(written)} files")
    return 0
