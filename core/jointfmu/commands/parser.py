"""The parser of all commands."""

import sys
from typing import Any

from .. import __version__
from . import (
    build,
    catalogue,
    export,
    fit,
    footprint,
    law,
    modelica,
    modes,
    new,
    parameters,
    prove,
    ramp,
    report,
    ring,
    surface,
    sweep,
    system,
    uncertainty,
    validate,
)
from .common import Parser

COMMANDS = (
    new,
    catalogue,
    law,
    parameters,
    build,
    modelica,
    export,
    footprint,
    modes,
    report,
    ramp,
    prove,
    ring,
    system,
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
