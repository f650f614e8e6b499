"""The parser of the commands."""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from jointfmu import __version__
from jointfmu.commands.common import IMPLIED, Parser, nearest

COMMANDS = (
    "new",
    "catalogue",
    "law",
    "parameters",
    "build",
    "cache",
    "modelica",
    "export",
    "footprint",
    "modes",
    "report",
    "ramp",
    "prove",
    "ring",
    "system",
    "surface",
    "fit",
    "uncertainty",
    "sweep",
    "validate",
)
"""Each is declared by the module of its name, which `commands` has."""
KERNEL = ("law", "parameters", "ramp")
"""Those that lie in the kernel, as they need no tool."""


class CommandLine(Parser):
    """The parser of commands; a sub-command may be left out."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse does, with the sub-command that the words imply, and the nearest of its options."""
        words = _explicit(list(sys.argv[1:] if args is None else args))
        found, rest = super().parse_known_args(words, namespace)
        if rest:
            hint = nearest(rest[0].partition("=")[0], _options(self, words))
            self.error(f"unrecognized arguments: {' '.join(rest)}{hint}")
        return found


def _options(parser: argparse.ArgumentParser, words: Sequence[str]) -> list[str]:
    """Long options of the command that words begin with."""
    for word in words:
        subs = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction) and word in a.choices]
        if not subs:
            break
        parser = subs[0].choices[word]
    return [name for action in parser._actions for name in action.option_strings if name.startswith("--")]


def _explicit(words: list[str]) -> list[str]:
    """The words with the sub-command that they imply."""
    names = IMPLIED.get(words[0]) if words else None
    if names is None or (words[1:2] and words[1] in (*names, "-h", "--help")):
        return words
    return [words[0], names[0], *words[1:]]


def parser(words: Sequence[str] = ()) -> CommandLine:
    """The parser of the command that words begin with; without one of all commands, which takes longer."""
    top = CommandLine(prog="jointfmu", description="Joint stiffness from fractal surface roughness.")
    top.add_argument("--version", action="version", version=f"jointfmu {__version__}")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)
    for name in words[:1] if {*words[:1]} & {*COMMANDS} else COMMANDS:
        package = "jointfmu.commands" if name in KERNEL else "jointfmu_tools.commands"
        import_module(f"{package}.{name}").add(commands)
    return top
