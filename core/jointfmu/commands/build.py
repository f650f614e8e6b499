"""`jointfmu build`: FMUs from parameters."""

import argparse
import json
from pathlib import Path
from typing import Any

from ..parameters import load
from .common import command, without_package


def add(commands: Any) -> None:
    """Declare the command."""
    make = command(commands, "build", _build, "build FMUs")
    make.add_argument("names", nargs="*", metavar="NAME", help="FMUs to build (default: all)")
    make.add_argument(
        "--flavour",
        nargs="+",
        default=["fmi2", "fmi3"],
        metavar="FLAVOUR",
        help="flavours to build: fmi2, fmi3 (default: both), python",
    )
    make.add_argument("--params", type=Path, metavar="FILE", help="parameter file with other defaults (TOML)")
    make.add_argument(
        "--systems", action="store_true", help="build the example systems (SSP) with the FMUs that they need"
    )
    make.add_argument("--out", type=Path, default=Path("dist"), metavar="DIR", help="folder (default: dist)")


def _build(args: argparse.Namespace) -> int:
    file = load(args.params) if args.params else None
    try:
        from jointfmu_fmu_src import building, ssp

        built = []
        if args.names or not args.systems:
            built += building.build(args.names, args.flavour, file, args.out)
        if args.systems:
            built += ssp.build_systems(args.out, file)
    except ImportError as error:
        raise without_package(error, "build") from None
    if args.json:
        print(json.dumps({"built": [str(path) for path in built]}))
    else:
        print("\n".join(f"built {path}" for path in built))
    return 0
