"""The command line `jointfmu COMMAND`.

Exit status 0: done; 1: the work failed its check; 2: bad input, one line on standard error.
"""

import os
import sys
from collections.abc import Sequence
from typing import Any

from . import __version__
from .commands import (
    build,
    export,
    fit,
    footprint,
    law,
    modelica,
    modes,
    ramp,
    ring,
    surface,
    sweep,
    uncertainty,
    validate,
)
from .commands.common import Parser, option
from .refusal import Refusal

COMMANDS = (
    law,
    build,
    modelica,
    export,
    footprint,
    modes,
    ramp,
    ring,
    surface,
    fit,
    uncertainty,
    sweep,
    validate,
)


IMPLIED = {"surface": surface.SUBCOMMANDS}
"""{command: its sub-commands}, of which the first runs where none is named."""


class CommandLine(Parser):
    """The parser of all commands; a sub-command may be left out."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse does, with the sub-command that the words imply."""
        return super().parse_args(_explicit(list(sys.argv[1:] if args is None else args)), namespace)


def _explicit(words: list[str]) -> list[str]:
    """The words with the sub-command that they imply."""
    names = IMPLIED.get(words[0]) if words else None
    if names is None or (words[1:2] and words[1] in (*names, "-h", "--help")):
        return words
    return [words[0], names[0], *words[1:]]


def parser() -> CommandLine:
    """The parser of all commands."""
    top = CommandLine(prog="jointfmu", description="Joint stiffness from fractal surface roughness.")
    top.add_argument("--version", action="version", version=f"jointfmu {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    for command in COMMANDS:
        command.add(commands)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    args = parser().parse_args(argv)
    try:
        status = int(args.run(args))
        print(end="", flush=True)
        return status
    except (ValueError, RuntimeError) as error:
        hint = [f"({option(args, error.setting)})"] if isinstance(error, Refusal) else []
        print(f"jointfmu {args.command}:", *str(error).splitlines(), *hint, file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        print(f"jointfmu {args.command}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # What is still buffered goes nowhere, else the interpreter reports it at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


if __name__ == "__main__":
    sys.exit(main())
