"""The command line: `jointfmu law | build | ramp | validate`.

Exit status 0: done; 1: the work failed its check; 2: bad input, one line on standard error.
"""

import argparse
import json
import math
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from . import __version__, ramp, validation
from .asperity.hu2023 import Hu2023
from .asperity.yu2022 import Yu2022
from .asperity.zhao2018 import Zhao2018
from .interface import at_largest_spot, at_pressure
from .parameters import ParameterFile, check_writable, default, load, parse_setting, write_text
from .quantity import build, flat_fields, flatten

LAWS: dict[str, tuple[type[Any], str]] = {
    "zhao2018": (Zhao2018, "bolted_joint"),
    "hu2023": (Hu2023, "harmonic_drive"),
    "yu2022": (Yu2022, "gear_contact"),
}
ROW = ("largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t")
"""Columns of every law; a law that does not define one gives null."""


class Parser(argparse.ArgumentParser):
    """argparse with one line for an error, and negative numbers in any notation."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._negative_number_matcher = re.compile(r"^-(\d|\.\d|inf|nan)", re.IGNORECASE)

    def error(self, message: str) -> NoReturn:
        """Print one line and exit with 2."""
        print(f"{self.prog}: {message}", file=sys.stderr)
        raise SystemExit(2)


def law_parameters(law: str, file: ParameterFile | None, settings: dict[str, Any]) -> Any:
    """The law's parameter set from a joint's parameter file (default: the joint's own) and settings."""
    cls, joint = LAWS[law]
    values = (file or default(joint)).values
    known = flatten(values.law if law == "hu2023" else values)
    names = {name for name, _ in flat_fields(cls)}
    return build(cls, {k: v for k, v in known.items() if k in names} | settings)


def _law(args: argparse.Namespace) -> int:
    joint = LAWS[args.law][1]
    file = load(args.params, joint) if args.params else None
    law = law_parameters(args.law, file, dict(args.settings))
    with np.errstate(over="ignore"):
        if args.pressure is not None:
            state = at_pressure(law, np.array(args.pressure))
        else:
            state = at_largest_spot(law, np.array(args.largest_spot))
    names = [*ROW, *(name for name in state if name not in ROW)]
    count = len(args.pressure or args.largest_spot)
    rows = [{n: _json_number(state[n], i) if n in state else None for n in names} for i in range(count)]
    if args.json:
        print(json.dumps({"law": args.law, "parameters": flatten(law), "rows": rows}))
        return 0
    print("  ".join(f"{name:>12}" for name in names))
    for row in rows:
        cells = ("-" if row[n] is None else f"{row[n]:.6g}" for n in names)
        print("  ".join(f"{cell:>12}" for cell in cells))
    return 0


def _json_number(column: Any, i: int) -> float | None:
    value = float(np.broadcast_to(column, (i + 1,) if np.ndim(column) == 0 else np.shape(column))[i])
    return value if math.isfinite(value) else None


def _build(args: argparse.Namespace) -> int:
    file = load(args.params) if args.params else None
    try:
        from jointfmu_fmus import building

        built = building.build(args.names, args.flavour, file, args.out)
    except ImportError as error:
        raise ValueError(
            f"the package {error.name or error} is missing, needed to build; "
            "install it with: pip install 'jointfmu[build]'"
        ) from None
    if args.json:
        print(json.dumps({"built": [str(path) for path in built]}))
    else:
        print("\n".join(f"built {path}" for path in built))
    return 0


def _ramp(args: argparse.Namespace) -> int:
    if args.csv:
        check_writable(args.csv)
    result = ramp.run(args.fmu, args.input, args.to, args.step, dict(args.settings))
    for message in result.messages:
        print(message, file=sys.stderr)
    if args.csv:
        write_text(args.csv, result.csv())
    if args.json:
        columns = {name: column.tolist() for name, column in result.columns.items()}
        print(json.dumps({"fmu": str(args.fmu), "units": result.units, "columns": columns}))
    elif args.csv:
        print(f"wrote {args.csv}: {len(next(iter(result.columns.values())))} points")
    else:
        sys.stdout.write(result.csv())
    return 0


def _validate(args: argparse.Namespace) -> int:
    rows = validation.validate()
    misses = validation.missed(rows)
    if args.json:
        print(json.dumps({"rows": [row.as_dict() for row in rows], "missed": len(misses)}))
        return int(bool(misses))
    print(validation.table(rows))
    print(validation.summary(rows))
    return int(bool(misses))


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    top = Parser(prog="jointfmu", description="Joint stiffness from fractal surface roughness.")
    top.add_argument("--version", action="version", version=f"jointfmu {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)

    def command(name: str, run: Any, text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text)
        sub.set_defaults(run=run)
        sub.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
        return sub

    def settings(sub: argparse.ArgumentParser) -> None:
        sub.add_argument(
            "--set",
            dest="settings",
            nargs="+",
            action="extend",
            type=_setting,
            default=[],
            metavar="NAME=VALUE",
            help="set parameters (SI units)",
        )

    law = command("law", _law, "evaluate one interface law at pressures or largest spots")
    law.add_argument("law", choices=list(LAWS), metavar="LAW", help=f"one of {', '.join(LAWS)}")
    at = law.add_mutually_exclusive_group(required=True)
    at.add_argument("--pressure", type=float, nargs="+", metavar="P", help="nominal pressure [Pa]")
    at.add_argument(
        "--largest-spot", type=float, nargs="+", metavar="A", help="area of the largest spot [m2]"
    )
    law.add_argument("--params", type=Path, metavar="FILE", help="parameter file of the joint (TOML)")
    settings(law)

    make = command("build", _build, "build FMUs")
    make.add_argument("names", nargs="*", metavar="NAME", help="FMUs to build (default: all)")
    make.add_argument(
        "--flavour",
        nargs="+",
        default=["fmi2", "fmi3"],
        metavar="FLAVOUR",
        help="flavours to build: fmi2, fmi3 (default: both), python",
    )
    make.add_argument("--params", type=Path, metavar="FILE", help="parameter file with other defaults (TOML)")
    make.add_argument("--out", type=Path, default=Path("dist"), metavar="DIR", help="folder (default: dist)")

    drive = command("ramp", _ramp, "run an FMU along a load ramp from zero and print every output")
    drive.add_argument("fmu", type=Path, metavar="FMU", help="path of the FMU")
    drive.add_argument("--input", required=True, metavar="NAME", help="input to drive")
    drive.add_argument("--to", type=float, required=True, metavar="VALUE", help="end of the ramp (SI)")
    drive.add_argument("--step", type=float, required=True, metavar="VALUE", help="step of the ramp (SI)")
    settings(drive)
    drive.add_argument("--csv", type=Path, metavar="FILE", help="write the ramp to a file")

    command("validate", _validate, "compare every published number with the computed one")
    return top


def _setting(text: str) -> tuple[str, Any]:
    try:
        return parse_setting(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    args = parser().parse_args(argv)
    try:
        return int(args.run(args))
    except (ValueError, RuntimeError) as error:
        print(f"jointfmu {args.command}:", *str(error).splitlines(), file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        print(f"jointfmu {args.command}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 0


if __name__ == "__main__":
    sys.exit(main())
